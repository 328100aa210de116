"""Scenes: files and those of the library, read, changed and run; results as arrays over time and as a page."""

from __future__ import annotations

import html
import json
import os
import tempfile
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping

import numpy as np

from . import _isochor, keys as _keys
from .errors import Error
from .world import World

Overrides = Mapping[str, Any]
StepCallback = Callable[[int, int, float], None]
TrialCallback = Callable[[dict[str, Any]], None]


def _assignments(overrides: Overrides | None) -> list[str]:
    if overrides is None:
        return []
    if not isinstance(overrides, Mapping):
        raise Error(
            f"overrides of type {type(overrides).__name__}; give a dict, as in "
            '{"cavities.chamber.amount": 12000}'
        )
    return [f"{path}={json.dumps(_keys.plain(value, path))}" for path, value in overrides.items()]


class Scene:
    """A problem as data: bodies, effects, analysis, probes, metrics (docs/scenes.md)."""

    def __init__(self, core: Any) -> None:
        self._core = core

    @classmethod
    def load(cls, scene: str | os.PathLike[str], overrides: Overrides | None = None) -> Scene:
        """A scene file, or a scene of the library by its name (``isochor.library()``).

        ``overrides``: values by their place, as in ``{"cavities.chamber.amount": 12000, "bodies[0].element":
        "tet10"}``. Raises :class:`isochor.Error` with the place of what is wrong.
        """
        name, changes = os.fspath(scene), _assignments(overrides)
        if not os.path.exists(name):
            core = _isochor.Scene.from_library(name, changes)
            if core is not None:
                return cls(core)
            if not name.endswith(".json"):
                names = ", ".join(library())
                raise Error(f'Scene.load: there is no file "{name}" and no scene of the library; it has {names}')
        return cls(_isochor.Scene.read(name, changes))

    @classmethod
    def from_dict(cls, scene: Mapping[str, Any], folder: str | os.PathLike[str] = ".") -> Scene:
        """A scene from the keys of a scene file; relative paths of meshes start at ``folder``."""
        text = _keys.text(_keys.plain(scene, "scene"))
        return cls(_isochor.Scene.parse(text, "scene", os.fspath(folder), []))

    def override(self, overrides: Overrides) -> Scene:
        """The scene with some values changed; this one stays as it is."""
        return Scene(self._core.override(_assignments(overrides)))

    def to_dict(self) -> dict[str, Any]:
        """The keys as in a scene file; values at their defaults are left out."""
        found: dict[str, Any] = json.loads(self._core.json())
        return found

    def to_json(self) -> str:
        """The text of a scene file."""
        return self._core.json()

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def title(self) -> str:
        return self._core.title

    @property
    def folder(self) -> str:
        """Where relative paths start."""
        return self._core.folder

    @property
    def steps(self) -> int:
        """How many steps its analysis has."""
        return int(self._core.plan()[0])

    @property
    def step_length(self) -> float:
        """Of each of them [s]; in statics, of load factor."""
        return float(self._core.plan()[1])

    @property
    def path_step(self) -> float | None:
        """Length of a step of ``World.follow`` [m] where the analysis follows a path; else None."""
        return self._core.plan()[2]

    def world(self, *, threads: int = 0) -> World:
        """A compiled world of the scene, as often as asked, to be stepped and changed.

        Bodies and effects are found by their names in the file: ``world["chamber"].amount = 2e3``. With
        ``for _ in range(scene.steps): world.advance(scene.step_length)`` (or ``world.follow(scene.path_step)``) it goes
        where ``run()`` goes, with the same bits. ``threads``: 0 is all of the machine.
        Raises :class:`isochor.Error` for what cannot be built.
        """
        return World._of_scene(self, int(threads))

    def run(
        self,
        folder: str | os.PathLike[str] | None = None,
        *,
        threads: int = 0,
        budget: float | None = None,
        resume: bool = False,
        page: bool = True,
        on_step: StepCallback | None = None,
    ) -> Run:
        """Runs the scene and returns its results.

        ``folder``: where outputs go as from the command line; None: none are kept. ``threads``: 0 is all of the
        machine. ``budget``: wall time allowed [s]. ``resume``: goes on from the last checkpoint in ``folder``.
        ``page``: without a folder, whether the results page is made. ``on_step(step, steps, time)`` is called after
        each step; what it raises stops the run and is raised by it, as Ctrl-C is.

        A run that does not converge is no exception: ``status`` and ``reason`` of the result say so. Bad input
        raises :class:`isochor.Error`.
        """
        if folder is not None or not page:
            place = "" if folder is None else os.fspath(folder)
            return Run(self._core.run(place, threads, budget, resume, on_step), place)
        with tempfile.TemporaryDirectory() as place:
            # The page and nothing else.
            watched = self.override({"outputs.checkpoint_seconds": 0})
            made = Run(watched._core.run(place, threads, budget, resume, on_step), "")
            made._page = _read(Path(place) / "index.html")
        return made

    def solve_to(
        self,
        error: float | str,
        folder: str | os.PathLike[str] | None = None,
        *,
        threads: int = 0,
        budget: float | None = None,
        most_levels: int = 4,
        on_trial: TrialCallback | None = None,
    ) -> Search:
        """Finds element and mesh so that every metric and probe is within an error, and says how it knows.

        ``error``: relative, as ``0.01`` or ``"1%"``. ``folder``: where the outputs of the best run go; None: none
        are kept. ``budget``: wall time of all runs together [s]. ``most_levels``: of refinement of the whole mesh;
        three times as many where cells are refined that count. ``on_trial(trial)`` is called after each run with
        what it was: ``setting``, ``status``, ``reason``, ``elements``, ``unknowns``, ``seconds``, ``predicted_seconds``,
        ``indicator``, ``held_by``, ``how``.

        An error that is not reached is no exception: ``reached`` and ``sentence`` say so, and the best run is
        there. Bad input (a scene without metrics and probes, an error of 0) raises :class:`isochor.Error`.
        """
        place = "" if folder is None else os.fspath(folder)
        asked = error if isinstance(error, str) else float(error)
        return Search(self._core.solve_to(asked, place, threads, budget, most_levels, on_trial), place)

    def __repr__(self) -> str:
        return f'<isochor.Scene "{self.name}">'

    def __getstate__(self) -> dict[str, Any]:
        return {"json": self.to_json(), "name": self.name, "folder": self.folder}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._core = _isochor.Scene.parse(state["json"], state["name"], state["folder"], [])


def library() -> dict[str, str]:
    """The scenes that come with the package: titles by names."""
    return dict(_isochor.library())


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


class Metric:
    """A number of a scene that has a name, where known with a reference."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.name: str = values["name"]
        self.value: float = values["value"]
        self.unit: str = values["unit"]
        self.reached: bool = values["reached"]
        self.reference: float | None = values["reference"]
        self.error: float | None = values["error"]
        """Relative to the reference; of a reference 0: absolute."""
        self.within_tolerance: bool | None = values["within_tolerance"]
        self.source: str = values["source"]

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"<isochor.Metric {self.name}: {self.value:.6g}{unit}>"


class Run(Mapping[str, np.ndarray]):
    """Results of a scene: arrays over time by name.

    ``run["time"]``, ``run["probes.tip"]`` (displacement [m], shape (steps + 1, 3)),
    ``run["cavities.chamber.pressure"]`` [Pa], ``run["reactions.clamp.force"]`` [N], ``run["energies.elastic"]`` [J],
    ``run["min_J"]``, ... The first entry is the rest state. In a notebook it shows itself as the results page.
    """

    def __init__(self, values: Mapping[str, Any], folder: str) -> None:
        self.status: str = values["status"]
        """``converged``, ``not_converged``, ``budget``, ``not_written``, ``out_of_memory``, ``failed``."""
        self.reason: str = values["reason"]
        """Empty when converged, else one sentence."""
        self.scene: str = values["scene"]
        self.steps_asked: int = values["steps_asked"]
        self.wall_s: float = values["wall_s"]
        self.state_hash: int = values["state_hash"]
        self.warnings: list[str] = values["warnings"]
        self.metrics: dict[str, Metric] = {m["name"]: Metric(m) for m in values["metrics"]}
        self.summary: dict[str, Any] = json.loads(values["summary"])
        """What summary.json holds, see docs/scenes.md."""
        self.folder = folder
        """Where outputs are; empty: nowhere."""
        self._arrays: dict[str, np.ndarray] = values["arrays"]
        self._page = ""

    @property
    def converged(self) -> bool:
        return self.status == "converged"

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._arrays:
            raise KeyError(f'no result is called "{name}"; there are: {", ".join(self._arrays)}')
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def page(self) -> str:
        """The results page: one HTML file that shows the run in any browser, without a network.

        Raises :class:`isochor.Error` where the run made none.
        """
        text = _read(Path(self.folder) / "index.html") if self.folder else self._page
        if not text:
            raise Error(
                f'run of "{self.scene}": it made no results page; run with page=True and outputs.page true, in a '
                "build that has the page"
            )
        return text

    def save_page(self, path: str | os.PathLike[str]) -> None:
        """Writes the results page to a file."""
        Path(path).write_text(self.page(), encoding="utf-8")

    def _repr_html_(self) -> str:
        try:
            page = self.page()
        except Error:
            return self._table()
        # A frame of its own: neither's styles nor scripts reach the other.
        source = html.escape(page, quote=True)
        return f'<iframe srcdoc="{source}" style="width:100%;height:720px;border:0" allowfullscreen></iframe>'

    def _table(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(m.name)}</td><td>{m.value:.6g} {html.escape(m.unit)}</td></tr>"
            for m in self.metrics.values()
        )
        return f"<p>{html.escape(repr(self))}</p><table>{rows}</table>"

    def __repr__(self) -> str:
        steps = len(self._arrays.get("time", (0,))) - 1
        why = f", {self.reason}" if self.reason else ""
        return f'<isochor.Run "{self.scene}": {self.status}, {steps} of {self.steps_asked} steps{why}>'


class Search:
    """What ``Scene.solve_to()`` found: the best run, what its numbers are worth, and the runs on the way."""

    def __init__(self, values: Mapping[str, Any], folder: str) -> None:
        self.end: str = values["end"]
        """``reached``, ``not_reached``, ``budget``, ``not_written``, ``failed``."""
        self.sentence: str = values["sentence"]
        """How the answer is known, or why there is none."""
        self.trials: list[dict[str, Any]] = values["trials"]
        self.best: int | None = values["best"]
        """Of the trials; None: no run converged."""
        self.overrides: str = values["overrides"]
        """What ``--set`` makes the best run out of the scene with, on the command line."""
        self.seconds: float = values["seconds"]
        self.errors: dict[str, dict[str, Any]] = {e["name"]: e for e in values["errors"]}
        """Of each metric, and of each probe as ``"probe NAME"``: ``value``, ``unit``, ``error`` in it, ``relative``
        (None of a value 0), and ``where`` on the mesh it comes from."""
        self.scene: Scene | None = None if values["scene"] is None else Scene(values["scene"])
        """As the best run has it."""
        self.run: Run | None = None if values["run"] is None else Run(values["run"], folder)

    @property
    def reached(self) -> bool:
        return self.end == "reached"

    def __repr__(self) -> str:
        return f"<isochor.Search {self.end}: {self.sentence}>"
