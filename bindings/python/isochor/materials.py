"""Materials: one function a law, whose keyword arguments are the keys of docs/scenes.md.

The functions are made from the table of keys when the package is imported. Each returns a :class:`Material` for
``World.add_body``.
"""

from __future__ import annotations

import inspect
from typing import Any, Callable

from . import keys as _keys
from .errors import Error

__all__ = ["Material"]

# Constants that single laws have. The table knows them by their meaning only.
_VOLUME = ("poisson", "bulk", "volume_energy")
_FAMILIES = {
    "mooney_rivlin": ("c1", "c2", "c20", "c11", "c02", *_VOLUME),
    "fung": ("mu0", "mu1", "gamma", *_VOLUME),
    "arruda_boyce": ("mu", "beta1", "beta2", "beta3", "beta4", "locking_stretch", *_VOLUME),
    "ogden": ("terms", *_VOLUME),
    "yeoh": ("c", *_VOLUME),
    "gent": ("mu", "jm", *_VOLUME),
    "veronda_westmann": ("c1", "c2", *_VOLUME),
    "holmes_mow": ("mu", "beta", *_VOLUME),
}
_OWN = {
    **_FAMILIES,
    **{f"isochoric_{law}": own for law, own in _FAMILIES.items()},
    "named": ("name", "poisson"),
    "stvk_resistant": ("young", "poisson", "mu", "lambda", "bulk", "bulk_choice", "resistance"),
    "isochoric_extended": ("young", "poisson", "mu", "lambda", "bulk", "bulk_choice", "threshold"),
}
_ELASTIC = ("young", "poisson", "mu", "lambda", "bulk", "bulk_choice")
_ALL = ("density", "region", "prony", "static_time", "mullins", "fibers", "compression_penalty", "stiffness_field", "poisson_field")


class Material:
    """A law with its constants and density: values by the keys of ``bodies[].materials[]``."""

    __slots__ = ("keys",)

    def __init__(self, keys: dict[str, Any]) -> None:
        self.keys = keys

    @property
    def law(self) -> str:
        return str(self.keys["law"])

    @property
    def region(self) -> str:
        """Of the mesh; empty: every region not named elsewhere."""
        return str(self.keys.get("region", ""))

    def with_keys(self, **changes: Any) -> Material:
        """The same material with some keys changed; None takes a key away."""
        return Material({k: v for k, v in {**self.keys, **_checked(self.law, changes)}.items() if v is not None})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Material) and self.keys == other.keys

    def __repr__(self) -> str:
        parts = [f"{key}={value!r}" for key, value in self.keys.items() if key != "law"]
        return f"isochor.{self.law}({', '.join(parts)})"


def laws() -> tuple[str, ...]:
    """Names of all laws."""
    return next(key.words for key in _keys.objects()["material"].keys if key.name == "law")


def arguments(law: str) -> list[_keys.Key]:
    """The keyword arguments of the function of a law."""
    own = _OWN.get(law, _ELASTIC)
    by_name = {key.name: key for key in _keys.objects()["material"].keys}
    return [by_name[name] for name in own + _ALL]


def _checked(law: str, given: dict[str, Any]) -> dict[str, Any]:
    known = {key.python_name: key for key in arguments(law)}
    keys: dict[str, Any] = {}
    for name, value in given.items():
        if name not in known:
            raise _keys.unknown(law, name, known)
        plain = None if value is None else _keys.plain(value, f"{law}: {name}")
        # Fields are objects in scene files, where they may be in files of their own.
        if name.endswith("_field") and isinstance(plain, list):
            plain = {"values": plain}
        keys[known[name].name] = plain
    return keys


def _document(law: str) -> str:
    lines = [f"The law {law}: see docs/materials.", "", "Parameters", "----------"]
    for key in arguments(law):
        lines += [f"{key.python_name}:", f"    {key.doc}"]
    lines += ["", "Values are looked at when the body is added. Raises isochor.Error for keys that there are not."]
    return "\n".join(lines)


def _make(law: str) -> Callable[..., Material]:
    def material(*args: Any, **given: Any) -> Material:
        if args:
            raise Error(f"{law}: {len(args)} positional arguments; give constants by name, as in {law}(young=1e5)")
        keys = {k: v for k, v in _checked(law, given).items() if v is not None}
        return Material({"law": law, **keys})

    parameter = inspect.Parameter
    material.__name__ = material.__qualname__ = law
    material.__module__ = "isochor"
    material.__doc__ = _document(law)
    material.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [parameter(k.python_name, parameter.KEYWORD_ONLY, default=k.default) for k in arguments(law)]
    )
    return material


for _law in laws():
    globals()[_law] = _make(_law)
    __all__.append(_law)
