"""Writes the stubs of what is made from the table of keys: isochor/effects.pyi and isochor/materials.pyi.

    PYTHONPATH=build/python python3 bindings/python/make_stubs.py [--check]

--check writes nothing and fails where a stub is not current.
"""

import sys
from pathlib import Path

sys.path.pop(0)  # the package beside this file has no module

from isochor import effects, materials  # noqa: E402
from isochor.keys import effect_types, objects  # noqa: E402

HERE = Path(__file__).resolve().parent / "isochor"
HEAD = '''"""{what} Made by bindings/python/make_stubs.py; edits are lost."""

from typing import Any, Literal, Mapping, Sequence, TypedDict, Union

from numpy.typing import ArrayLike
{imports}
_Names = Union[str, Sequence[str]]
_Amount = Union[float, Sequence[tuple[float, float]], ArrayLike]
'''

TYPES = {
    "number": "float",
    "number or inf": "float",
    "integer": "int",
    "flag": "bool",
    "text": "str",
    "names": "_Names",
    "vector": "ArrayLike",
    "integers": "Sequence[int]",
    "indices": "ArrayLike",
    "numbers": "ArrayLike",
    "points": "ArrayLike",
    "paths": "Sequence[ArrayLike]",
    "boxes": "ArrayLike",
    "box": "ArrayLike",
    "directions": "Union[str, ArrayLike]",
    "curve": "_Amount",
}
# Handles stand for the names of what they are handles of.
NAMED = ("against", "rigid", "from", "to")


def class_of(name):
    return "_" + "".join(part.capitalize() for part in name.split("_"))


def type_of(key):
    if key.kind == "word":
        return "Literal[" + ", ".join(f'"{word}"' for word in key.words) + "]"
    if key.kind == "object":
        inner = f'"{class_of(key.type)}"'
        return f"Union[{inner}, ArrayLike]" if key.type == "cell_field" else inner
    if key.kind == "list":
        return f'Sequence["{class_of(key.type)}"]'
    if key.kind == "text" and key.name in NAMED:
        return "Union[str, Body, LiveEffect, Effect]"
    return TYPES[key.kind]


def parameter(key):
    kind = type_of(key)
    if key.default is None:
        return f"    {key.python_name}: Union[{kind}, None] = ...,"
    return f"    {key.python_name}: {kind} = ...,"


def dictionaries(keys, seen):
    """Objects that are arguments, as typed dictionaries."""
    lines = []
    for key in keys:
        if not key.type or key.type in seen or key.type == "selection":
            continue
        seen.add(key.type)
        inner = objects()[key.type].keys
        lines += dictionaries(inner, seen)
        entries = ", ".join(f'"{k.name}": {type_of(k)}' for k in inner)
        lines.append(f'{class_of(key.type)} = TypedDict("{class_of(key.type)}", {{{entries}}}, total=False)')
    return lines


def documented(function):
    text = function.__doc__.replace("\\", "\\\\")
    first, *rest = text.split("\n")
    return ['    """' + first, *(("    " + line).rstrip() for line in rest), '    """']


def effects_stub():
    imports = "\nfrom .world import Body, LiveEffect\n"
    lines = [HEAD.format(what="Effects.", imports=imports)]
    lines += [
        "class Effect:",
        "    kind: str",
        "    keys: dict[str, Any]",
        "    body: Any",
        "    def __init__(self, kind: str, keys: dict[str, Any], body: Any = ...) -> None: ...",
        "    @property",
        "    def name(self) -> str: ...",
        "    def with_keys(self, **changes: Any) -> Effect: ...",
        "",
    ]
    seen = set()
    for kind in effect_types():
        lines += dictionaries([key for key, _ in effects.arguments(kind)], seen)
    lines += ["", "def arguments(kind: str) -> list[tuple[Any, bool]]: ...", ""]
    for kind in effect_types():
        function = getattr(effects, kind)
        lines.append(f"def {kind}(")
        if "body" in function.__signature__.parameters:
            lines.append("    body: Union[Body, str, None] = ...,")
        lines.append("    *,")
        lines += [parameter(key) for key, _ in effects.arguments(kind)]
        lines += [") -> Effect:", *documented(function), ""]
    return "\n".join(lines)


def materials_stub():
    lines = [HEAD.format(what="Materials.", imports="")]
    lines += [
        "class Material:",
        "    keys: dict[str, Any]",
        "    def __init__(self, keys: dict[str, Any]) -> None: ...",
        "    @property",
        "    def law(self) -> str: ...",
        "    @property",
        "    def region(self) -> str: ...",
        "    def with_keys(self, **changes: Any) -> Material: ...",
        "",
        *dictionaries(objects()["material"].keys, set()),
        "",
        "def laws() -> tuple[str, ...]: ...",
        "def arguments(law: str) -> list[Any]: ...",
        "",
    ]
    for law in materials.laws():
        function = getattr(materials, law)
        lines += [f"def {law}(", "    *,"]
        lines += [parameter(key) for key in materials.arguments(law)]
        lines += [") -> Material:", *documented(function), ""]
    return "\n".join(lines)


def stubs():
    return {"effects.pyi": effects_stub(), "materials.pyi": materials_stub()}


def main():
    old = []
    for name, text in stubs().items():
        path = HERE / name
        if path.exists() and path.read_text() == text:
            continue
        old.append(name)
        if "--check" not in sys.argv:
            path.write_text(text)
    if "--check" in sys.argv and old:
        sys.exit(f"not current: {', '.join(old)}; run bindings/python/make_stubs.py")
    print("current" if not old else f"wrote {', '.join(old)}")


if __name__ == "__main__":
    main()
