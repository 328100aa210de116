"""Fits, drives and designs: constants from measurements, amounts for targets, shapes and stiffnesses for targets."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import Any, Callable, Iterator, Union

import numpy as np

from . import _isochor, materials as _materials
from .errors import Error
from .scene import Scene

Table = Union[str, os.PathLike, Mapping[str, Any]]
"""A CSV file, or columns by name: numbers, nan (or None) where there is none."""
Watch = Callable[[int, float], None]


class Constant:
    """A number that was fitted: ``value`` ± ``half_width``."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.name: str = values.get("name", values.get("path", ""))
        """Of a scene its path, ``"bodies[0].materials[0].young"``."""
        self.unit: str = values.get("unit", "")
        self.value: float = _number(values["value"])
        self.half_width: float = _number(values["half_width_95"], math.inf)
        """Of the 95 % interval from the Gauss-Newton matrix; infinite where the data do not tell."""
        self.at_bound: bool = values["at_bound"]
        self.start: float | None = values.get("start")
        """Of a scene: where the search began."""

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval."""
        return self.value - self.half_width, self.value + self.half_width

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        return f"<isochor.Constant {self.name}: {self.value:.6g} ± {self.half_width:.2g}{' ' * bool(self.unit)}{self.unit}>"


class LawFit:
    """What ``fit()`` found for a law."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.law: str = values["law"]
        self.converged: bool = values["status"] == "converged"
        self.reason: str = values["reason"]
        """Empty when converged, else one sentence."""
        self.constants: dict[str, Constant] = {c["name"]: Constant(c) for c in values["constants"]}
        self.keys: dict[str, Any] | None = values["material"]
        """The entry of a scene's ``materials``; None: the law has no such material."""
        self.shear_modulus: float = _number(values["shear_modulus"])
        """At rest [Pa]."""
        self.r2: float = _number(values["r2"])
        self.rms: float = _number(values["rms"])
        """Root mean square of the errors of stress [Pa]."""
        self.worst: float = _number(values["worst"])
        """Largest error of stress [Pa]."""
        self.stable: tuple[float, float] = tuple(_number(s) for s in values["stable"])  # type: ignore[assignment]
        """Stretches around 1 between which the stress rises in all modes."""
        self.stable_in_data: bool = values["stable_in_data"]
        self.uncertainty: dict[str, float] = {k: _number(v, math.inf) for k, v in values["uncertainty_95"].items()}
        """Of the predicted stress, relative, in modes that were not measured."""
        self.warnings: list[str] = values["warnings"]

    def material(self, **other: Any) -> _materials.Material:
        """The material with these constants; ``other``: keys beside them, as ``density=1070``.

        Raises :class:`isochor.Error` where the law has none.
        """
        if self.keys is None:
            raise Error(f"{self.law}: it was not fitted, so that it has no material: {self.reason}")
        keys = {**self.keys, **other}
        return getattr(_materials, keys.pop("law"))(**keys)

    def __repr__(self) -> str:
        found = ", ".join(f"{c.name} {c.value:.4g}" for c in self.constants.values())
        return f"<isochor.LawFit {self.law}: {found}, R2 {self.r2:.4f}>"


class Fits(Mapping[str, LawFit]):
    """Fits by law, the least error first; laws that turn over inside the data, and failures, behind the others."""

    def __init__(self, fits: Sequence[LawFit]) -> None:
        order = sorted(fits, key=lambda f: (not f.converged, not f.stable_in_data, _number(f.rms, math.inf)))
        self._fits = {f.law: f for f in order}

    @property
    def best(self) -> LawFit:
        """The first of them."""
        return next(iter(self._fits.values()))

    def __getitem__(self, law: str) -> LawFit:
        if law not in self._fits:
            raise KeyError(f'no law is called "{law}"; there are: {", ".join(self._fits)}')
        return self._fits[law]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fits)

    def __len__(self) -> int:
        return len(self._fits)

    def __repr__(self) -> str:
        return f"<isochor.Fits: {', '.join(self._fits)}>"


def fit(
    curves: Table | Sequence[Table],
    laws: str | Sequence[str] = (),
    *,
    lowest: float | None = None,
    highest: float | None = None,
    stress_unit: str = "",
    strain_column: str = "",
    stress_column: str = "",
    relative: bool = False,
) -> Fits:
    """Constants of material laws from measured curves, as ``isochor fit`` finds them (docs/fit.md).

    ``curves``: one or several, each a CSV file (``"pull.csv"``, ``"bulge.csv:equibiaxial"``) or a dict of two arrays,
    ``stretch`` or ``strain`` (engineering), and ``stress`` (nominal [Pa]), with ``mode`` ``"uniaxial"``, ``"equibiaxial"``
    or ``"pure_shear"`` (uniaxial). ``laws``: names; all where it is empty. ``lowest``, ``highest``: the range of engineering
    strain. ``relative``: errors count over the measured stress.

    Bad input raises :class:`isochor.Error`; a law that was not fitted says so in its ``converged`` and ``reason``.
    """
    given = [_curve(c, k) for k, c in enumerate([curves] if isinstance(curves, (str, os.PathLike, Mapping)) else curves)]
    names = [laws] if isinstance(laws, str) else list(laws)
    text = _isochor.fit_laws(given, names, lowest, highest, strain_column, stress_column, stress_unit, relative)
    return Fits([LawFit(f) for f in json.loads(text)["fits"]])


class SceneFit:
    """What ``fit_scene()`` found."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        told = json.loads(values["json"])
        self.converged: bool = told["status"] == "converged"
        self.reason: str = told["reason"]
        """Empty when converged, else one sentence."""
        self.constants: dict[str, Constant] = {c["path"]: Constant(c) for c in told["constants"]}
        self.rms: float = _number(told["rms"])
        """Of the errors, over the largest change of their kind."""
        self.experiment_rms: list[float] = [_number(e.get("rms")) for e in told["experiments"]]
        self.warnings: list[str] = told["warnings"]
        """Constants that cannot be told apart or are at a bound, and derivatives of one side."""
        self.iterations: int = told["iterations"]
        self.scenes: list[Scene] = [Scene(core) for core in values["scenes"]]
        """The scene of each experiment with the constants that were found."""
        self.fitted: list[dict[str, np.ndarray]] = [_columns(*table) for table in values["fitted"]]
        """Of each experiment by column: shape (n, 3) of time, measured and fitted."""

    @property
    def overrides(self) -> dict[str, float]:
        """For ``Scene.override``."""
        return {path: c.value for path, c in self.constants.items()}

    def __repr__(self) -> str:
        found = ", ".join(f"{path} {c.value:.6g}" for path, c in self.constants.items())
        return f"<isochor.SceneFit: {found}, errors {self.rms:.3g}>"


def fit_scene(
    experiments: Sequence[tuple[Any, ...]],
    constants: Mapping[str, tuple[float, float] | None] | Sequence[str],
    *,
    threads: int = 0,
    iterations: int = 100,
    on_iteration: Watch | None = None,
) -> SceneFit:
    """Constants of materials and effects in scenes, as ``isochor fit --scene`` finds them (docs/fit.md#scenes).

    ``experiments``: ``(scene, data)`` or ``(scene, data, weight)`` each, or one of them; data are a CSV file or a dict of
    columns, as ``{"time": [1], "tip.z": [-0.012]}``. ``constants``: paths, or a dict of paths with their bounds
    (None: the usual). ``on_iteration(iteration, error)`` is called after each step.

    A search that does not converge is no exception: ``converged`` and ``reason`` say so. Bad input raises
    :class:`isochor.Error`.
    """
    if isinstance(experiments, tuple):
        experiments = [experiments]
    given = []
    for k, one in enumerate(experiments):
        if not isinstance(one, (tuple, list)) or len(one) not in (2, 3):
            raise Error(f"fit_scene: experiments[{k}] is {type(one).__name__}; give (scene, data) or (scene, data, weight)")
        given.append((_scene(one[0])._core, *_table(one[1], f"data {k + 1}"), float(one[2]) if len(one) == 3 else 1.0))
    if isinstance(constants, str):
        constants = [constants]
    bounds = constants if isinstance(constants, Mapping) else dict.fromkeys(constants)
    sought = [(path, (None, None) if b is None else _pair(b, path)) for path, b in bounds.items()]
    return SceneFit(_isochor.fit_scene(given, sought, threads, iterations, on_iteration))


class Target:
    """How near a drive came at a time."""

    def __init__(self, values: Mapping[str, Any], amounts: Sequence[str], goals: Sequence[str]) -> None:
        self.time: float = values["time"]
        self.end: str = values["end"]
        """``reached``, ``nearest`` (to first order nothing within bounds and rates comes closer), ``not converged``."""
        self.distance: float = values["distance"]
        self.amounts: dict[str, float] = dict(zip(amounts, values["amounts"]))
        self.found: dict[str, float] = dict(zip(goals, values["positions"]))
        self.wanted: dict[str, float] = dict(zip(goals, values["targets"]))
        self.at_bound: list[str] = values["at_bound"]
        self.gradients: int = values["gradients"]
        """How many were taken."""

    @property
    def reached(self) -> bool:
        """Within the tolerance."""
        return self.end == "reached"

    def __repr__(self) -> str:
        return f"<isochor.Target at {self.time:.6g}: {self.end}, off by {self.distance:.3g}>"


class Drive:
    """What ``drive()`` found."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        told = json.loads(values["json"])
        names = [a["effect"] for a in told["amounts"]]
        self.reached: bool = told["all_reached"]
        """All targets are."""
        self.reason: str = told["reason"]
        """Why it ended before the last target; empty: it did not."""
        self.targets: list[Target] = [Target(s, names, told["goals"]) for s in told["steps"]]
        curves = told.get("curves") or [[[t.time, t.amounts[n]] for t in self.targets] for n in names]
        self.curves: dict[str, np.ndarray] = {n: np.array(c, dtype=float).reshape(-1, 2) for n, c in zip(names, curves)}
        """Of each effect, shape (points, 2): time and amount. Over a horizon from its beginning; else at the targets."""
        self.scene: Scene | None = None if values["scene"] is None else Scene(values["scene"])
        """With the amounts that were found, ready to run; None: no target was come to."""

    def __repr__(self) -> str:
        reached = sum(t.reached for t in self.targets)
        return f"<isochor.Drive: {reached} of {len(self.targets)} targets reached>"


def drive(
    scene: Scene | str | os.PathLike[str],
    targets: Table,
    amounts: Mapping[str, Sequence[float] | None],
    *,
    horizon: bool = False,
    tolerance: float = 1e-6,
    every: int = 1,
    smooth: float | None = None,
    iterations: int = 100,
    threads: int = 0,
    on_iteration: Watch | None = None,
) -> Drive:
    """Amounts that bring what a scene shows to targets, as ``isochor drive`` finds them (docs/drive.md).

    ``targets``: a CSV file or a dict of columns, as ``{"time": [1, 2], "tip.x": [0.005, 0.01]}``. ``amounts``: effects with
    ``(least, most)`` or ``(least, most, rate)``; None: without bounds. ``horizon``: all times together, in dynamics too,
    with a point of each curve every ``every`` increments; ``smooth``: how much changes count. ``on_iteration(gradients,
    distance)`` is called at each gradient of a horizon.

    Targets that are not reached are no exception: ``reached`` and each of ``targets`` say so. Bad input raises
    :class:`isochor.Error`.
    """
    for name, values in targets.items() if isinstance(targets, Mapping) else ():
        for k, value in enumerate(np.atleast_1d(np.asarray(values, object))):
            if value is None or (isinstance(value, (int, float)) and not math.isfinite(value)):
                raise Error(f'drive: targets["{name}"][{k}] is {value}; give a finite number at each time')
    given = []
    for name, bounds in amounts.items():
        limits = [-math.inf, math.inf, math.inf]
        if bounds is not None:
            if len(bounds) not in (2, 3):
                raise Error(f'drive: amounts["{name}"] has {len(bounds)} numbers; give (least, most) or (least, most, rate)')
            limits[: len(bounds)] = [float(b) for b in bounds]
        given.append((name, *limits))
    core = _scene(scene)._core
    return Drive(
        _isochor.drive(
            core, *_table(targets, "targets"), given, horizon, tolerance, every, smooth, iterations, threads, on_iteration
        )
    )


class Design:
    """What ``design()`` found."""

    def __init__(self, values: Mapping[str, Any], keeps: Any) -> None:
        told = json.loads(values["json"])
        self._keeps = keeps
        self.end: str = told["end"]
        """``reached``, ``nearest``, ``not converged``."""
        self.reason: str = told["reason"] or (told["note"] if told["end"] != "reached" else "")
        """Why it is not reached, where that is known; else empty."""
        self.noise: float = told["noise"]
        """Errors that count as met, over the largest change of their kind."""
        self.error: float = _number(told["error"]) * self.noise
        """Root mean square, over the largest change of their kind."""
        self.error_before: float = _number(told["error_before"]) * self.noise
        self.moves: dict[str, float] = {m["surface"]: m["value"] for m in told["moves"]}
        """Of each surface, as ``"finger:chamber"`` [m]."""
        self.at_bound: list[str] = [m["surface"] for m in told["moves"] if m["at_bound"]]
        self.quality: float = told.get("quality", 1.0)
        """Least Jacobian determinant of a cell over that of the mesh before."""
        self.volume: float | None = told.get("volume")
        """Of the body whose surfaces move [m^3]."""
        self.factor: np.ndarray = values["factor"]
        """On the stiffness of each cell; empty without a stiffness field."""
        self.deviation: np.ndarray = values["deviation"]
        """Of the logarithm of each factor, as the data leave it."""
        self.history: list[dict[str, Any]] = [
            dict(zip(("iteration", "error", "quality", "volume", "moves"), step)) for step in values["history"]
        ]
        self.scene: Scene = Scene(values["scene"])
        """As designed. Its mesh is a file in ``folder``, or is kept while this object is."""

    @property
    def reached(self) -> bool:
        """The targets are met."""
        return self.end == "reached"

    def __repr__(self) -> str:
        moves = "".join(f", {s} by {1e3 * v:.4g} mm" for s, v in self.moves.items())
        return f"<isochor.Design {self.end}: errors {self.error:.3g}{moves}>"


def design(
    scene: Scene | str | os.PathLike[str],
    targets: Table,
    *,
    move: Mapping[str, tuple[float, float]] | None = None,
    hold: Sequence[str] = (),
    stiffness: str | None = None,
    length: float | None = None,
    spread: float = 0.5,
    factors: tuple[float, float] = (0.01, 100.0),
    volume: tuple[float | None, float | None] = (None, None),
    quality: float = 0.2,
    noise: float | None = None,
    folder: str | os.PathLike[str] | None = None,
    iterations: int = 60,
    threads: int = 0,
    on_iteration: Watch | None = None,
) -> Design:
    """A shape or a stiffness field for targets, as ``isochor design`` finds them (docs/design.md).

    ``targets``: a CSV file or a dict of columns. ``move``: surfaces (``"chamber"``, ``"chamber.x"``) with how far they may go
    [m]; ``hold``: surfaces that stay. ``stiffness``: a body whose cells get factors, smooth over ``length`` [m], between
    ``factors``. ``volume``: bounds [m^3]; ``quality``: of the mesh. ``folder``: where meshes go; None: they are gone with
    the result. ``on_iteration(iteration, error)`` is called after each step, with the error over ``noise``.

    Targets that are not reached are no exception: ``end`` and ``reason`` say so. Bad input raises :class:`isochor.Error`.
    """
    keeps: Any = tempfile.TemporaryDirectory() if folder is None else None
    place = os.fspath(folder) if folder is not None else keeps.name
    os.makedirs(place, exist_ok=True)
    moves = [f"{name}={low!r}:{high!r}" for name, (low, high) in ((n, _pair(b, n)) for n, b in (move or {}).items())]
    field: dict[str, Any] = {}
    if stiffness is not None:
        if length is None:
            raise Error("design: a stiffness field needs the length over which it is smooth; give length [m]")
        least, most = _pair(factors, "factors")
        field = {"body": stiffness, "length": float(length), "spread": float(spread), "least": least, "most": most}
    limits = {"volume_least": volume[0], "volume_most": volume[1], "quality": float(quality), "noise": noise}
    core = _scene(scene)._core
    found = _isochor.design(
        core, *_table(targets, "targets"), moves, field, limits, list(hold), place, iterations, threads, on_iteration
    )
    return Design(found, keeps)


def _number(value: Any, absent: float = math.nan) -> float:
    return absent if value is None or (isinstance(value, float) and math.isnan(value)) else float(value)


def _pair(bounds: Any, what: str) -> tuple[float, float]:
    try:
        least, most = (float(b) for b in bounds)
    except (TypeError, ValueError):
        raise Error(f'"{what}": bounds {bounds!r}; give (least, most)') from None
    if not least < most:
        raise Error(f'"{what}": bounds {bounds!r}; the least value is not below the largest')
    return least, most


def _scene(scene: Scene | str | os.PathLike[str]) -> Scene:
    return scene if isinstance(scene, Scene) else Scene.load(scene)


def _text(columns: Mapping[str, Any], what: str) -> str:
    arrays = {}
    for name, values in columns.items():
        try:
            arrays[name] = np.array([math.nan if v is None else float(v) for v in np.atleast_1d(np.asarray(values, object))])
        except (TypeError, ValueError):
            raise Error(f'{what}: column "{name}" is {values!r}; give a list of numbers') from None
    lengths = {name: len(a) for name, a in arrays.items()}
    if len(set(lengths.values())) != 1 or not lengths:
        raise Error(f"{what}: columns of different lengths {lengths}; give a number in each, nan where there is none")
    for name in arrays:
        if "," in name or '"' in name or "\n" in name:
            raise Error(f'{what}: column "{name}" has a comma, a quote or a line break in its name')
    lines = [",".join(arrays)]
    for row in zip(*arrays.values()):
        lines.append(",".join("" if math.isnan(v) else repr(float(v)) for v in row))
    return "\n".join(lines) + "\n"


def _table(data: Table, what: str) -> tuple[str, str]:
    """Where data are from, and their text where that is no file."""
    if isinstance(data, Mapping):
        return what, _text(data, what)
    return os.fspath(data), ""


def _curve(curve: Table, number: int) -> tuple[str, str, str]:
    if not isinstance(curve, Mapping):
        return os.fspath(curve), "", ""
    what = f"curve {number + 1}"
    columns = {name: values for name, values in curve.items() if name != "mode"}
    if set(columns) not in ({"stretch", "stress"}, {"strain", "stress"}):
        raise Error(f"{what} has {sorted(columns)}; give stretch (or strain) and stress, and mode")
    unit = {"stretch": "stretch", "strain": "strain", "stress": "stress (Pa)"}
    text = _text({unit[name]: values for name, values in columns.items()}, what)
    return what, text, str(curve.get("mode", "uniaxial"))


def _columns(names: Sequence[str], times: Any, measured: Any, fitted: Any) -> dict[str, np.ndarray]:
    rows: dict[str, list[tuple[float, float, float]]] = {}
    for name, *row in zip(names, times, measured, fitted):
        rows.setdefault(name, []).append(tuple(row))
    return {name: np.array(row) for name, row in rows.items()}
