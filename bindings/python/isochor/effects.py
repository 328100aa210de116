"""Effects: one function a kind, whose keyword arguments are the keys of docs/scenes.md.

The functions are made from the table of keys when the package is imported. Each returns an :class:`Effect`, a
description that ``World.add`` makes live.
"""

from __future__ import annotations

import inspect
from typing import Any, Callable

from . import keys as _keys
from .errors import Error

__all__ = ["Effect"]


class Effect:
    """An effect as its author says it: its kind, and values by the keys of docs/scenes.md.

    It is in no world; the same description may be added to several.
    """

    __slots__ = ("kind", "keys", "body")

    def __init__(self, kind: str, keys: dict[str, Any], body: Any = None) -> None:
        self.kind = kind
        self.keys = keys
        self.body = body

    @property
    def name(self) -> str:
        """The name that it was given; empty: ``World.add`` finds one."""
        return str(self.keys.get("name", ""))

    def with_keys(self, **changes: Any) -> Effect:
        """The same effect with some keys changed; None takes a key away."""
        made = globals()[self.kind](self.body, **changes) if _has_body(self.kind) else globals()[self.kind](**changes)
        # The amount stays what it is, and is not that of an effect that was told nothing of it; but another control has
        # other amounts.
        if not {"amount", "control"} & set(changes):
            made.keys.pop("amount", None)
        merged = {**self.keys, **made.keys}
        if "where" in self.keys and "where" in made.keys:
            merged["where"] = {**self.keys["where"], **made.keys["where"]}
        for name, value in changes.items():
            if value is None:
                merged.pop(name.rstrip("_"), None)
        return Effect(self.kind, merged, self.body)

    def __repr__(self) -> str:
        parts = [] if self.body is None else [repr(getattr(self.body, "name", self.body))]
        parts += [f"{key}={value!r}" for key, value in self.keys.items()]
        return f"isochor.{self.kind}({', '.join(parts)})"


def _selection_key(kind: str) -> str | None:
    """The key that holds which nodes are meant; its own keys are arguments like the others."""
    for key in _keys.objects()[kind].keys:
        if key.type == "selection":
            return key.name
    return None


def _has_body(kind: str) -> bool:
    return _selection_key(kind) is not None or any(k.name == "body" for k in _keys.objects()[kind].keys)


def arguments(kind: str) -> list[tuple[_keys.Key, bool]]:
    """The keyword arguments of the function of a kind, and whether each is of the selection."""
    out: list[tuple[_keys.Key, bool]] = []
    for key in _keys.objects()[kind].keys:
        if key.type == "selection":
            out += [(inner, True) for inner in _keys.objects()["selection"].keys if inner.name != "body"]
        elif key.name != "body":
            out.append((key, False))
    return out


def _signature(kind: str) -> inspect.Signature:
    parameter = inspect.Parameter
    parameters = []
    if _has_body(kind):
        parameters.append(parameter("body", parameter.POSITIONAL_OR_KEYWORD, default=None))
    for key, _ in arguments(kind):
        parameters.append(parameter(key.python_name, parameter.KEYWORD_ONLY, default=key.default))
    return inspect.Signature(parameters)


def _document(kind: str) -> str:
    lines = [_keys.objects()[kind].what, "", "Parameters", "----------"]
    if _has_body(kind):
        lines += ["body:", "    A body of the world, or its name; None: the first."]
    for key, _ in arguments(kind):
        lines += [f"{key.python_name}:", f"    {key.doc}"]
        if key.name == "name":
            lines[-1] = "    of the effect; all effects of a world share one set of names (default: one is found)"
        if key.kind == "curve" and key.needed:
            lines[-1] += " (default: 0, or 1 where it is a ratio or what was supplied)"
    lines += [
        "",
        "Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an",
        "Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when",
        "the effect is added.",
    ]
    return "\n".join(lines)


# Absent in a scene file, the amount of these is an error; a program sets it later.
def _fill_amount(kind: str, keys: dict[str, Any]) -> None:
    for key, _ in arguments(kind):
        if key.name != "amount" or not key.needed or "amount" in keys:
            continue
        control = str(keys.get("control", ""))
        if control in ("volume", "length"):
            continue
        ratio = control in ("gas", "liquid") or control.endswith("_ratio") or (kind == "cable" and not control)
        keys["amount"] = 1.0 if ratio else 0.0


def _make(kind: str) -> Callable[..., Effect]:
    known = {key.python_name: (key, inner) for key, inner in arguments(kind)}
    where = _selection_key(kind)

    def effect(*args: Any, **given: Any) -> Effect:
        if len(args) > (1 if _has_body(kind) else 0):
            most = "the body" if _has_body(kind) else "nothing"
            raise Error(f"{kind}: {len(args)} positional arguments; give {most} by position, and keys by name")
        body = args[0] if args else given.pop("body", None) if _has_body(kind) else None
        keys: dict[str, Any] = {}
        for name, value in given.items():
            if name not in known:
                raise _keys.unknown(kind, name, known)
            if value is None:
                continue
            key, inner = known[name]
            place = keys.setdefault(where, {}) if inner and where else keys
            place[key.name] = _keys.plain(value, f"{kind}: {name}")
        _fill_amount(kind, keys)
        return Effect(kind, keys, body)

    effect.__name__ = effect.__qualname__ = kind
    effect.__module__ = "isochor"
    effect.__doc__ = _document(kind)
    effect.__signature__ = _signature(kind)  # type: ignore[attr-defined]
    return effect


for _kind in _keys.effect_types():
    globals()[_kind] = _make(_kind)
    __all__.append(_kind)
