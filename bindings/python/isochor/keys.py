"""Keys of scene files: the table that functions are made from, and values as scene files have them."""

from __future__ import annotations

import difflib
import functools
import json
import keyword
import math
from dataclasses import dataclass, field
from typing import Any, Iterable, Mapping

import numpy as np

from . import _isochor
from .errors import Error


@dataclass(frozen=True)
class Key:
    """One key of an object of a scene file."""

    name: str
    unit: str
    meaning: str
    kind: str
    default: Any
    """None: none, or what ``absent`` says."""
    absent: str
    type: str
    """Of an object or of the entries of a list: its name in :func:`objects`."""
    words: tuple[str, ...]
    needed: bool
    bounds: str

    @property
    def python_name(self) -> str:
        """``from`` and ``lambda`` are words of Python, so they are ``from_`` and ``lambda_`` there."""
        return self.name + "_" if keyword.iskeyword(self.name) else self.name

    @property
    def doc(self) -> str:
        """Unit, meaning, bounds and default in one line."""
        text = f"[{self.unit}] " if self.unit else ""
        text += self.meaning or "see the page of the effect"
        if self.bounds:
            text += f"; {self.bounds}"
        if self.words:
            text += ": " + ", ".join(f'"{word}"' for word in self.words)
        if self.absent:
            text += f" (default: {self.absent})"
        elif self.default is not None:
            text += f" (default: {json.dumps(self.default)})"
        return text


@dataclass(frozen=True)
class KeyObject:
    """An object of a scene file: what it is, and its keys."""

    type: str
    what: str
    keys: tuple[Key, ...]
    by_python_name: dict[str, Key] = field(repr=False)


def _bounds(raw: Mapping[str, Any]) -> str:
    parts = [
        f"{sign} {raw[name]:g}"
        for name, sign in (("least", ">="), ("above", ">"), ("most", "<="))
        if raw[name] is not None
    ]
    return ", ".join(parts)


def _key(raw: Mapping[str, Any]) -> Key:
    return Key(
        name=raw["name"],
        unit=raw["unit"],
        meaning=raw["meaning"],
        kind=raw["kind"],
        default=json.loads(raw["default"]) if raw["default"] else None,
        absent=raw["absent"],
        type=raw["type"],
        words=tuple(raw["words"]),
        needed=raw["needed"],
        bounds=_bounds(raw),
    )


@functools.lru_cache(maxsize=None)
def objects() -> dict[str, KeyObject]:
    """All objects of scene files by their names: "scene", "body", "cavity", ..."""
    found = {}
    for name, raw in _isochor.objects().items():
        keys = tuple(_key(key) for key in raw["keys"])
        found[name] = KeyObject(name, raw["what"], keys, {key.python_name: key for key in keys})
    return found


@functools.lru_cache(maxsize=None)
def effect_types() -> dict[str, str]:
    """Names of effects, and of the list of a scene file that holds each: "cavity" is in "cavities"."""
    lists = {key.name: key.type for key in objects()["scene"].keys if key.kind == "list"}
    return {lists[name]: name for name in _isochor.effect_lists()}


def list_of(kind: str) -> str:
    """The list of a scene file that holds effects of a kind."""
    return effect_types()[kind]


def unknown(what: str, name: str, known: Iterable[str]) -> Error:
    near = difflib.get_close_matches(name, list(known), 1)
    hint = f', did you mean "{near[0]}"?' if near else "; it knows " + ", ".join(known)
    return Error(f'{what}: unknown key "{name}"{hint}')


def plain(value: Any, place: str) -> Any:
    """The value as a scene file has it: lists, numbers, texts; handles by their names."""
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, float):
        return _finite_or_inf(value, place)
    if isinstance(value, np.generic):
        return plain(value.item(), place)
    if isinstance(value, np.ndarray):
        return _plain_array(value, place)
    if isinstance(value, Mapping):
        return {str(k).rstrip("_"): plain(v, f"{place}.{k}") for k, v in value.items() if v is not None}
    if isinstance(value, (list, tuple, range)):
        return [plain(v, f"{place}[{k}]") for k, v in enumerate(value)]
    name = getattr(value, "name", None)
    if isinstance(name, str):
        return name
    raise Error(
        f"{place}: a value of type {type(value).__name__}; give a number, a text, a list, an array, a dict or a "
        "handle"
    )


def _plain_array(value: np.ndarray, place: str) -> Any:
    if value.dtype.kind not in "biuf":
        raise Error(f"{place}: an array of type {value.dtype}; give numbers")
    if value.dtype.kind == "f" and not np.isfinite(value).all():
        first = np.unravel_index(int(np.argmin(np.isfinite(value))), value.shape)
        at = ", ".join(str(int(i)) for i in first)
        raise Error(f"{place}: entry [{at}] is {value[first]}; give finite numbers")
    return value.tolist()


def _finite_or_inf(value: float, place: str) -> Any:
    if math.isnan(value):
        raise Error(f"{place}: nan; give a number")
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return value


def text(values: Mapping[str, Any]) -> str:
    """The keys as JSON."""
    return json.dumps(values, allow_nan=False)
