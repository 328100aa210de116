"""Worlds: bodies and effects that are stepped through time, and the handles of what is in them."""

from __future__ import annotations

import weakref
from typing import Any, Callable, Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _isochor, gradients as _gradients, keys as _keys
from .effects import Effect, arguments
from .errors import Cancelled, Error, NotConverged
from .materials import Material
from .mesh import Mesh
from .reports import (
    BodyMeasures,
    ContactPair,
    Contacts,
    Energies,
    Fields,
    Gauge,
    Orientation,
    Progress,
    Reaction,
    Response,
    Size,
    StepReport,
)

Amount = Any  # a number, or points [(time, value), ...]


class Body:
    """A body of a world; made by ``World.add_body``."""

    def __init__(self, world: World, core_id: Any, name: str, described: dict[str, Any], mesh: Mesh | None) -> None:
        self._world = world
        self._id = core_id
        self._name = name
        self._described = described
        self._given = mesh
        self._mesh: Mesh | None = None

    @property
    def name(self) -> str:
        return self._name

    @property
    def world(self) -> World:
        return self._world

    @property
    def materials(self) -> list[Material]:
        return [Material(dict(keys)) for keys in self._described["materials"]]

    @property
    def mesh(self) -> Mesh:
        """The mesh as the engine uses it: raised to tet10 where the element asked for it."""
        if self._mesh is None:
            self._world.compile()
            self._mesh = Mesh._of(self._world._core.mesh(self._id))
        return self._mesh

    @property
    def rest_positions(self) -> np.ndarray:
        """Positions at rest [m], shape (n, 3), read-only; the same array at each call."""
        return self.mesh.points

    @property
    def positions(self) -> np.ndarray:
        """As ``World.positions(body)``; assigning is ``World.set_positions``."""
        return self._world.positions(self)

    @positions.setter
    def positions(self, values: ArrayLike) -> None:
        self._world.set_positions(self, values)

    @property
    def velocities(self) -> np.ndarray:
        """As ``World.velocities(body)``; assigning is ``World.set_velocities``."""
        return self._world.velocities(self)

    @velocities.setter
    def velocities(self, values: ArrayLike) -> None:
        self._world.set_velocities(self, values)

    @property
    def displacements(self) -> np.ndarray:
        """Positions minus those at rest [m], shape (n, 3); a new array."""
        return self.positions - self.rest_positions

    def set_material(self, material: Material, region: str | None = None) -> None:
        """Another material from the next step on, in a region or, by default, where the material says.

        Costs new numbers and no new ordering. The density of the body changes where the material names one.
        """
        self._world._set_material(self, material, material.region if region is None else region)

    def remove(self) -> None:
        """Takes the body out of its world; refused while an effect names it."""
        self._world.remove(self)

    def measures(self) -> BodyMeasures:
        """Volume, mass, center, momentum now, of the body and its regions."""
        return self._world.measures(self)

    def fields(self) -> Fields:
        """Stresses and pressures now, at nodes and cells."""
        return self._world.fields(self)

    def __repr__(self) -> str:
        return f'<isochor.Body "{self._name}">'


class LiveEffect:
    """An effect of a world; made by ``World.add``.

    Its keys are attributes: ``floor.friction`` reads one, ``floor.friction = 0.3`` puts an effect with that key
    changed in its place before the next step. What it reports reads by name too: ``air.pressure`` and ``air.volume``
    of a cavity, ``rope.tension`` of a cable; ``gauges`` has all of it.
    """

    def __init__(self, world: World, core_id: Any, description: Effect) -> None:
        object.__setattr__(self, "_world", world)
        object.__setattr__(self, "_id", core_id)
        object.__setattr__(self, "_description", description)
        object.__setattr__(self, "_amount", None)

    _world: World
    _id: Any
    _description: Effect
    _amount: float | None

    @property
    def name(self) -> str:
        return self._description.name

    @property
    def kind(self) -> str:
        """Name of the function that described it: "cavity"."""
        return self._description.kind

    @property
    def world(self) -> World:
        return self._world

    @property
    def description(self) -> Effect:
        """The effect as it was said."""
        return self._description

    @property
    def amount(self) -> Any:
        """The last number set, or what the description says.

        A pressure [Pa], a volume [m^3], a ratio, or the scale of a motion or load. In statics the next step ramps
        from the old value to the new one, in dynamics the new one holds from the next step on. A number that is set
        takes the place of a curve.
        """
        if self._amount is not None:
            return self._amount
        return self._description.keys.get("amount")

    @property
    def gauges(self) -> dict[str, float]:
        """What the effect reports now, by quantity, in SI units."""
        return {gauge.quantity: gauge.value for gauge in self._world.gauges() if gauge.effect == self.name}

    @property
    def reaction(self) -> Reaction:
        """Force and moment that a support takes up."""
        force, moment = self._world._ready().reaction(self._id)
        return Reaction(force, moment)

    def set_pose(self, position: ArrayLike = (0.0, 0.0, 0.0), turn: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Where a support or an obstacle is from now on, instead of its displacement, motion or bone.

        ``position`` [m], ``turn`` axis times angle [rad], both from rest. It gets there in the course of the next
        increment.
        """
        self._world._ready().set_pose(self._id, position, turn)

    def change(self, **keys: Any) -> None:
        """Changes several keys at once; None takes one away."""
        self._world._change(self, keys)

    def remove(self) -> None:
        """Takes the effect out of its world."""
        self._world.remove(self)

    def __getattr__(self, attribute: str) -> Any:
        if attribute.startswith("_"):
            raise AttributeError(attribute)
        known = {key.python_name: (key, inner) for key, inner in arguments(self.kind)}
        if attribute in known:
            key, inner = known[attribute]
            keys = self._description.keys.get("where", {}) if inner else self._description.keys
            return keys.get(key.name, key.default)
        gauges = {quantity.replace(" ", "_"): value for quantity, value in self.gauges.items()}
        if attribute in gauges:
            return gauges[attribute]
        raise AttributeError(
            f'{self.kind} "{self.name}" has no key and no gauge "{attribute}"; keys: {", ".join(known)}; gauges: '
            + (", ".join(gauges) or "none")
        )

    def __setattr__(self, attribute: str, value: Any) -> None:
        if attribute == "amount" and np.ndim(value) == 0 and value is not None:
            number = _number(value, f'{self.kind} "{self.name}": amount')
            self._world._ready().set_amount(self._id, number)
            object.__setattr__(self, "_amount", number)
            return
        if isinstance(getattr(type(self), attribute, None), property) and attribute != "amount":
            raise Error(f'{self.kind} "{self.name}": {attribute} is read, not set')
        self.change(**{attribute: value})

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *(key.python_name for key, _ in arguments(self.kind))})

    def __repr__(self) -> str:
        return f'<isochor.LiveEffect {self.kind} "{self.name}">'


class World:
    """Bodies and effects, and how they are advanced.

    Parameters
    ----------
    gravity:
        [m/s^2], three numbers.
    scheme:
        "implicit_euler", "bdf2", "generalized_alpha", "newmark" or "implicit_midpoint"; "statics" for equilibria
        without inertia, "continuation" for paths of them.
    threads:
        0: all of the machine. The answer does not depend on it.
    progress:
        Called once an iteration with a :class:`Progress` while a step works. It may call ``cancel()`` and nothing
        else of the world; what it raises cancels the step and is raised by it.
    options:
        Keys of ``analysis`` in docs/scenes.md: ``method``, ``solver``, ``max_iterations``, ``force_tolerance``, ...

    A world is used by one thread at a time, other than ``cancel()``; another gets an :class:`isochor.Error`. Steps
    release the interpreter lock. Ctrl-C cancels a step and raises KeyboardInterrupt; the world is usable after.
    Worlds can be pickled: what is in them, and the state.
    """

    def __init__(
        self,
        *,
        gravity: ArrayLike = (0.0, 0.0, 0.0),
        scheme: str = "implicit_euler",
        threads: int = 0,
        progress: Callable[[Progress], None] | None = None,
        **options: Any,
    ) -> None:
        given = {"gravity": gravity, "scheme": scheme, "threads": threads, **options}
        self._options = {name: _keys.plain(value, f"World: {name}") for name, value in given.items()}
        self._begin(_isochor.World(_keys.text(self._options)))
        self.progress = progress

    @classmethod
    def _of_scene(cls, scene: Any, threads: int) -> World:
        core, bodies, effects = scene._core.world(threads)
        said = scene.to_dict()
        made = cls.__new__(cls)
        analysis = said.get("analysis", {})
        run_alone = ("type", "duration", "steps", "step", "path_step")
        made._options = {key: value for key, value in analysis.items() if key not in run_alone}
        if analysis.get("type", "static") == "static":
            made._options["scheme"] = "continuation" if scene.path_step else "statics"
        made._options["threads"] = threads
        made._options.update({key: said[key] for key in ("gravity", "gravity_amount") if key in said})
        made._begin(core)
        made._scene = scene
        made._lives = True
        for core_id, keys in zip(bodies, said["bodies"]):
            # The mesh has the surfaces and node sets that the file names by where they are.
            described = {k: v for k, v in keys.items() if k not in ("mesh", "surfaces", "node_sets")}
            described.setdefault("name", "body")
            made._bodies.append(Body(made, core_id, described["name"], described, None))
        if "volumes" not in said:
            said["volumes"] = [
                {"name": f"volume {b.name}" if k else "volume", "body": b.name} for k, b in enumerate(made._bodies)
            ]
        by_name = {keys["name"]: (kind, keys) for kind, keys in _effects_of(said)}
        for name, core_id in effects:
            kind, keys = by_name[name]
            made._effects.append(LiveEffect(made, core_id, _described(kind, keys)))
        return made

    def _begin(self, core: Any) -> None:
        self._core = core
        self._scene: Any = None  # that it is a world of, as long as nothing was added, removed or replaced
        self._bodies: list[Body] = []
        self._effects: list[LiveEffect] = []
        self._progress: Callable[[Progress], None] | None = None
        # What the world was when it was last compiled, to go back to where a change fails; None: no change waits.
        self._before: list[tuple[Any, ...]] | None = None
        self._compiled: list[tuple[str, float]] = []  # work and seconds since the last step
        self._lives = False  # has been compiled
        self._gravity = np.array(self._options.get("gravity", (0.0, 0.0, 0.0)), float)

    # ---- changes that wait for the next step ----

    def _changing(self) -> None:
        self._scene = None
        if self._before is None:
            self._before = [(b, b._described) for b in self._bodies]
            self._before += [(e, e._description) for e in self._effects]

    def _ready(self) -> Any:
        """The core with the changes made that waited; where they fail the handles are as before, too."""
        if self._before is not None:
            before, self._before = self._before, None
            known = self._core.compile_report()
            try:
                self._core.compile()
            except Error:
                # An error of the first compilation stays: there is nothing to go back to.
                if not self._lives:
                    raise
                self._bodies = [thing for thing, _ in before if isinstance(thing, Body)]
                self._effects = [thing for thing, _ in before if isinstance(thing, LiveEffect)]
                for thing, described in before:
                    object.__setattr__(thing, "_described" if isinstance(thing, Body) else "_description", described)
                raise
            self._lives = True
            # A step that compiled has told so already.
            if self._core.compile_report() != known:
                self._compiled.append(self._core.compile_report())
        return self._core

    # ---- what is in it ----

    def add_body(
        self,
        mesh: Mesh,
        materials: Material | Sequence[Material],
        *,
        name: str | None = None,
        element: str = "tet4_edge_smoothed",
        **keys: Any,
    ) -> Body:
        """Adds a body.

        ``materials``: one, or one a region. ``element``: "tet4", "tet4_edge_smoothed", "tet10" or "hex8".
        ``keys``: others of ``bodies[]`` in docs/scenes.md, such as ``surfaces`` and ``node_sets`` by place,
        ``guard_stiffness``, ``velocity`` [m/s] and ``angular_velocity`` [rad/s].
        Raises :class:`isochor.Error` for a mesh, material or key that cannot be.
        """
        if not isinstance(mesh, Mesh):
            raise Error(f"add_body: the mesh is of type {type(mesh).__name__}; give an isochor.Mesh")
        described = {name: _keys.plain(value, f"add_body: {name}") for name, value in keys.items()}
        described["element"] = element
        described["materials"] = [m.keys for m in _materials(materials)]
        described["name"] = name or _free("body", [b.name for b in self._bodies])
        if any(b.name == described["name"] for b in self._bodies):
            raise Error(f'add_body: a body has the name "{described["name"]}" already; give another')
        self._changing()
        core_id = self._core.add_body(mesh._core, _keys.text(described))
        body = Body(self, core_id, described["name"], described, mesh)
        self._bodies.append(body)
        return body

    def add(self, effect: Effect) -> LiveEffect:
        """Adds an effect, made by ``isochor.cavity`` and its like, and returns its handle."""
        if not isinstance(effect, Effect):
            raise Error(f"add: a value of type {type(effect).__name__}; give an effect, as isochor.volume(body) makes")
        keys = dict(effect.keys)
        taken = [e.name for e in self._effects]
        keys.setdefault("name", _free(effect.kind, taken))
        if keys["name"] in taken:
            raise Error(f'add: an effect has the name "{keys["name"]}" already; give another')
        named = Effect(effect.kind, keys, effect.body)
        self._changing()
        core_id = self._core.add(_keys.list_of(effect.kind), _keys.text(self._with_body(named)))
        live = LiveEffect(self, core_id, named)
        self._effects.append(live)
        return live

    def _with_body(self, effect: Effect) -> dict[str, Any]:
        """The keys as a scene file has them, with the body by its name."""
        if isinstance(effect.body, Body):
            why = self._core.why_not(effect.body._id)
            if why is not None:
                raise Error(f'{effect.kind} "{effect.name}": body "{effect.body.name}": {why}')
        return _with_body(effect)

    def remove(self, thing: Body | LiveEffect) -> None:
        """Takes an effect, or a body that no effect names, out of the world.

        What is untouched keeps its state bit for bit. Costs a new structure, see ``StepReport.compile_work``.
        """
        if not isinstance(thing, (Body, LiveEffect)):
            raise Error(f"remove: a value of type {type(thing).__name__}; give a body or an effect of this world")
        self._changing()
        if isinstance(thing, Body):
            self._core.remove_body(thing._id)
            self._bodies = [body for body in self._bodies if body.name != thing.name]
        else:
            self._core.remove_effect(thing._id)
            self._effects = [effect for effect in self._effects if effect.name != thing.name]

    def _change(self, effect: LiveEffect, keys: dict[str, Any]) -> None:
        if "name" in keys:
            raise Error(f'{effect.kind} "{effect.name}": the name of an effect stays; remove it and add another')
        described = effect._description.with_keys(**keys)
        self._changing()
        self._core.replace(effect._id, _keys.list_of(effect.kind), _keys.text(self._with_body(described)))
        object.__setattr__(effect, "_description", described)

    def _set_material(self, body: Body, material: Material, region: str) -> None:
        if not isinstance(material, Material):
            raise Error(
                f"set_material: a value of type {type(material).__name__}; give a material, as isochor.neo_hookean() makes"
            )
        keys = {**material.keys, "region": region}
        if not region:
            del keys["region"]
        self._changing()
        self._core.set_material(body._id, region, _keys.text(keys))
        old = [m for m in body._described["materials"] if m.get("region", "") == region]
        if "density" in keys:
            self._core.set_density(body._id, region, keys["density"])
        elif old and "density" in old[0]:
            keys["density"] = old[0]["density"]
        others = [m for m in body._described["materials"] if region and m.get("region", "") != region]
        body._described = {**body._described, "materials": [*others, keys]}

    @property
    def bodies(self) -> tuple[Body, ...]:
        return tuple(self._bodies)

    @property
    def effects(self) -> tuple[LiveEffect, ...]:
        return tuple(self._effects)

    def __getitem__(self, name: str) -> Body | LiveEffect:
        """The body or effect of this name."""
        for thing in self._things():
            if thing.name == name:
                return thing
        names = ", ".join(f'"{thing.name}"' for thing in self._things()) or "none"
        raise KeyError(f'no body or effect is called "{name}"; there are: {names}')

    def _things(self) -> Iterator[Body | LiveEffect]:
        yield from self._bodies
        yield from self._effects

    def _id_of(self, body: Body, call: str) -> Any:
        if not isinstance(body, Body):
            raise Error(f"{call}: a value of type {type(body).__name__}; give a body of this world")
        return body._id

    # ---- steps ----

    @property
    def progress(self) -> Callable[[Progress], None] | None:
        """Called once an iteration with a :class:`Progress` while a step works; None: nothing is."""
        return self._progress

    @progress.setter
    def progress(self, callback: Callable[[Progress], None] | None) -> None:
        self._progress = callback
        if callback is None:
            self._core.set_progress(None)
            return
        # The core must not keep the world alive that owns it.
        this = weakref.ref(self)

        def tell(*values: Any) -> None:
            world = this()
            if world is not None and world._progress is not None:
                world._progress(Progress(*values))

        self._core.set_progress(tell)

    def compile(self) -> None:
        """Builds the system, or what has changed of it; the next step does so too.

        Names that do not exist are refused here. Changes of a compiled world that fail are taken back, all of them
        since the last compilation, and the world goes on as it was.
        """
        self._changing()
        self._ready()

    def advance(self, h: float) -> StepReport:
        """Advances by ``h`` seconds (statics: of load factor) in as many increments as it takes.

        Raises :class:`isochor.NotConverged` where there is no equilibrium: the state is then the last one that
        converged, and the report's ``time`` says how far it got.
        """
        return self._ended(self._ready().advance(_number(h, "advance: h")))

    def step(self, h: float, *, iterations: int = 0, seconds: float = 0.0) -> StepReport:
        """One increment of ``h`` seconds, or :class:`isochor.NotConverged` and the state as it was.

        With a budget of Newton ``iterations`` or of wall time ``seconds``, a step that does not converge in time is
        kept where it got, and its report says ``unfinished``.
        """
        return self._ended(self._ready().step(_number(h, "step: h"), int(iterations), float(seconds)))

    def follow(self, length: float) -> StepReport:
        """Scheme "continuation": one step of this length [m] along the path of equilibria, through limit points."""
        return self._ended(self._ready().follow(_number(length, "follow: length")))

    def cancel(self) -> None:
        """Stops the step that runs, or else the next one, from any thread: it raises :class:`isochor.Cancelled`."""
        self._core.cancel()

    def _ended(self, raw: dict[str, Any]) -> StepReport:
        if self._compiled:
            works = [work for work, _ in self._compiled]
            raw["compile_work"] = max(works, key=("nothing", "numbers", "structure").index)
            raw["compile_seconds"] = sum(seconds for _, seconds in self._compiled)
            self._compiled.clear()
        report = StepReport(**raw)
        if report.status in ("converged", "unfinished"):
            return report
        if report.status == "invalid":
            raise Error(report.reason)
        if report.status == "cancelled":
            raise Cancelled(report.reason, report)
        raise NotConverged(report.reason, report)

    # ---- what it is like now ----

    @property
    def time(self) -> float:
        """[s]; in statics the load factor."""
        return self._core.time()

    def positions(self, body: Body) -> np.ndarray:
        """Positions now [m], shape (n, 3), float64: a read-only view without a copy.

        After a step the same array shows the new state; ``.copy()`` keeps one. It may outlive the world, and then
        shows the last numbers. Compiles the world if need be.
        """
        return self._ready().positions(self._id_of(body, "positions"))

    def velocities(self, body: Body) -> np.ndarray:
        """Velocities now [m/s], shape (n, 3), float64: a read-only view like that of ``positions``."""
        return self._ready().velocities(self._id_of(body, "velocities"))

    def rest_positions(self, body: Body) -> np.ndarray:
        """Positions at rest [m], shape (n, 3), read-only."""
        self._id_of(body, "rest_positions")
        return body.rest_positions

    def set_positions(self, body: Body, positions: ArrayLike) -> None:
        """Puts the nodes of a body somewhere else [m], shape (n, 3). It is at rest there."""
        self._ready().set_positions(self._id_of(body, "set_positions"), positions)

    def set_velocities(self, body: Body, velocities: ArrayLike) -> None:
        """Dynamics: how fast the nodes of a body move [m/s], shape (n, 3)."""
        self._ready().set_velocities(self._id_of(body, "set_velocities"), velocities)

    @property
    def gravity(self) -> np.ndarray:
        """[m/s^2]; setting it costs nothing. In statics the next increment ramps to it."""
        return self._gravity.copy()

    @gravity.setter
    def gravity(self, value: ArrayLike) -> None:
        self._core.set_gravity(value)
        self._gravity = np.array(value, float)

    def set_forces(self, body: Body, forces: ArrayLike) -> None:
        """Dead forces on all nodes of a body [N], shape (n, 3), until they are set anew or cleared."""
        self._ready().set_forces(self._id_of(body, "set_forces"), forces)

    def add_force(self, body: Body, node: int, force: ArrayLike) -> None:
        """A dead force on one node [N], on top of those that are there."""
        self._ready().add_force(self._id_of(body, "add_force"), int(node), force)

    def add_force_at(self, body: Body, point: ArrayLike, force: ArrayLike) -> None:
        """A dead force on a point of the body, given by where it is at rest [m], on top of those that are there [N]."""
        self._ready().add_force_at(self._id_of(body, "add_force_at"), point, force)

    def clear_forces(self) -> None:
        """No forces on nodes and points any more, of all bodies."""
        self._core.clear_forces()

    def measures(self, body: Body) -> BodyMeasures:
        """Volume, mass, center, momentum of a body now."""
        return BodyMeasures._of(self._ready().measures(self._id_of(body, "measures")))

    def fields(self, body: Body) -> Fields:
        """Stresses and pressures of a body now, at nodes and cells."""
        return Fields(**self._ready().fields(self._id_of(body, "fields")))

    def gauges(self) -> list[Gauge]:
        """What effects report now."""
        return [Gauge(*values) for values in self._ready().gauges()]

    def contacts(self) -> Contacts:
        """Points of contacts that press now, with gap, normal, forces and partner."""
        return Contacts(**self._ready().contacts())

    def contact_pairs(self) -> list[ContactPair]:
        """The total contact force of every two partners now."""
        return [ContactPair(*values) for values in self._ready().contact_pairs()]

    def energies(self) -> Energies:
        """Energies of the whole world now [J]."""
        return Energies(**self._ready().energies())

    def momentum(self) -> tuple[np.ndarray, np.ndarray]:
        """Linear [kg m/s] and, about the origin, angular momentum [kg m^2/s] of everything that has mass."""
        linear, angular = self._ready().momentum()
        return linear, angular

    def orientation(self, body: Body, **where: Any) -> Orientation:
        """How a face or another set of nodes has turned and moved since rest.

        ``where``: keys of ``orientations[].where`` in docs/scenes.md, such as ``surfaces``, ``nodes``, ``boxes``.
        """
        keys = {key.rstrip("_"): _keys.plain(value, f"orientation: {key}") for key, value in where.items()}
        self._id_of(body, "orientation")
        return Orientation(**self._ready().orientation(_keys.text({**keys, "body": body.name})))

    def derivatives(self, *inputs: LiveEffect | tuple[Body, ArrayLike, ArrayLike]) -> list[Response]:
        """How the equilibrium that the state is at answers to small changes; one :class:`Response` an input.

        An input is an effect, for its amount, or (body, point at rest [m], force [N]); derivatives are per unit of
        the amount, or of the force as it is given. Of dynamics it is the equilibrium without inertia. Costs one
        factorization, and two solves an input.
        """
        given: list[Any] = []
        for one in inputs:
            if isinstance(one, LiveEffect):
                given.append(one._id)
            elif isinstance(one, tuple) and len(one) == 3:
                given.append((self._id_of(one[0], "derivatives"), one[1], one[2]))
            else:
                raise Error(f"derivatives: {one!r}; give effects, or tuples (body, point, force)")
        responses = []
        for raw in self._ready().derivatives(given):
            gauges: dict[str, dict[str, float]] = {}
            for gauge in raw["gauges"]:
                gauges.setdefault(gauge[0], {})[gauge[2]] = gauge[4]
            raw["gauges"] = gauges
            raw["positions"] = dict(zip((body.name for body in self._bodies), raw["positions"]))
            raw["reactions"] = {e.name: Reaction(*two) for e, two in zip(self._effects, raw["reactions"])}
            responses.append(Response(**raw))
        return responses

    def gradients(
        self,
        outputs: Sequence[_gradients.Output],
        parameters: Sequence[_gradients.Parameter | LiveEffect | tuple[Body, ArrayLike, ArrayLike]],
        *,
        mode: str = "automatic",
        unstable: bool = False,
    ) -> _gradients.Gradients:
        """Numbers that an equilibrium of statics shows, and their derivatives by what the scene is made of.

        ``outputs``: made by :class:`isochor.Output`. ``parameters``: made by :class:`isochor.Parameter`; an effect
        stands for its amount, (body, point at rest [m], force [N]) for a factor on the force. ``mode``: "adjoint"
        takes one solve an output, "tangent" one a parameter, "automatic" whichever solves less. ``unstable``: of
        equilibria that are unstable under fixed loads, too. The state stays as it is.
        Raises :class:`isochor.Error` for what has no gradient: docs/derivatives.md.
        """
        return _gradients.ask(self, outputs, parameters, mode, unstable)

    def trajectory_gradients(
        self,
        steps: Sequence[float] | ArrayLike,
        outputs: Sequence[tuple[int, _gradients.Output] | list[tuple[int, _gradients.Output]]],
        parameters: Sequence[_gradients.Parameter | LiveEffect | tuple[Body, ArrayLike, ArrayLike]],
        *,
        mode: str = "automatic",
        kept_states: int = 0,
    ) -> _gradients.Gradients:
        """Numbers that are seen on a way through time, and their derivatives by what the scene is made of.

        ``steps``: lengths of the increments from where the world is [s]; it goes through them as ``step()`` does and is
        at their end then, or, where there is an error, where it was. ``outputs``: (step, :class:`isochor.Output`), seen
        at the end of a step, from 1, or 0 at the start; a list of these is their sum. ``parameters``, ``mode``: as of
        ``gradients()``. ``kept_states``: how many states of the way are kept, the others being made again; 0: all.
        Raises :class:`isochor.Error` for what has no gradient: docs/derivatives.md.
        """
        return _gradients.follow(self, steps, outputs, parameters, mode, kept_states)

    @property
    def constitutive_residual(self) -> float:
        """Largest |phi - target - C lambda| of all rows, relative to their measure."""
        return self._ready().constitutive_residual()

    @property
    def method(self) -> str:
        """How saddle points are solved and why, in words."""
        return self._ready().method()

    @property
    def warnings(self) -> list[str]:
        """What compile() noticed and took in its stride."""
        return self._ready().warnings()

    def size(self) -> Size:
        """Unknowns and memory."""
        return Size(**self._ready().size())

    @property
    def state_hash(self) -> int:
        """Of the state and the amounts that were set: worlds with equal hashes have the same bits."""
        return self._ready().state_hash()

    # ---- other lives ----

    def reset(self) -> None:
        """Back to rest at time 0, with the bits of a new world.

        Bodies, effects and materials stay as they are now; amounts, gravity, poses and forces that were set are
        forgotten.
        """
        self._ready().reset()
        self._forget()

    def _forget(self) -> None:
        self._gravity = np.array(self._options.get("gravity", (0.0, 0.0, 0.0)), float)
        for effect in self._effects:
            object.__setattr__(effect, "_amount", None)

    def clone(self, *, threads: int = 0) -> World:
        """Another world with the same scene and state, which goes on with the same bits.

        Tables that nobody changes are shared. Handles of this one are good there as well, and ``clone[name]`` finds
        its own. ``threads``: of its own; 0: as many as this world has.
        """
        return self._like(self._ready().clone(int(threads)))

    def _like(self, core: Any) -> World:
        made = World.__new__(World)
        made._options = dict(self._options)
        made._begin(core)
        made._gravity = self._gravity.copy()
        made._lives = self._lives
        made._scene = self._scene
        made._bodies = [Body(made, b._id, b._name, b._described, b._given) for b in self._bodies]
        made._effects = [LiveEffect(made, e._id, e._description) for e in self._effects]
        for mine, its in zip(self._effects, made._effects):
            object.__setattr__(its, "_amount", mine._amount)
        return made

    # ---- saved states ----

    def save(self) -> bytes:
        """Everything that survives a step. For the same build and machine, not for archives."""
        return self._ready().save()

    def load(self, state: bytes) -> None:
        """Takes what ``save()`` of a world with the same bodies and effects gave; goes on with the same bits."""
        if not isinstance(state, bytes):
            raise Error(f"load: a value of type {type(state).__name__}; give the bytes that save() returned")
        self._ready().load(state)
        for effect in self._effects:
            object.__setattr__(effect, "_amount", None)

    def __getstate__(self) -> dict[str, Any]:
        if self._scene is not None:
            return {
                "scene": self._scene,
                "threads": self._options["threads"],
                "amounts": [e._amount for e in self._effects],
                "state": self.save(),
                "gravity": self._gravity,
            }
        return {
            "options": self._options,
            "bodies": [(body._given or body.mesh, body._described) for body in self._bodies],
            "effects": [(e.kind, self._with_body(e._description), e._amount) for e in self._effects],
            "state": self.save() if self._bodies else None,
            "gravity": self._gravity,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        if "scene" in state:
            self.__dict__.update(World._of_scene(state["scene"], state["threads"]).__dict__)
            for thing in self._things():
                object.__setattr__(thing, "_world", self)
            for effect, amount in zip(self._effects, state["amounts"]):
                object.__setattr__(effect, "_amount", amount)
            self._ready().load(state["state"])
            self._gravity = state["gravity"]  # the state has it
            return
        self.__init__(**state["options"])  # type: ignore[misc]
        for mesh, described in state["bodies"]:
            body_id = self._core.add_body(mesh._core, _keys.text(described))
            self._bodies.append(Body(self, body_id, described["name"], described, mesh))
        for kind, keys, amount in state["effects"]:
            effect_id = self._core.add(_keys.list_of(kind), _keys.text(keys))
            effect = LiveEffect(self, effect_id, Effect(kind, keys))
            object.__setattr__(effect, "_amount", amount)
            self._effects.append(effect)
        if state["state"] is not None:
            self._ready().load(state["state"])
            self._gravity = state["gravity"]  # the state has it
        elif not np.array_equal(self._gravity, state["gravity"]):
            self.gravity = state["gravity"]

    def __repr__(self) -> str:
        return f"<isochor.World: {len(self._bodies)} bodies, {len(self._effects)} effects, t = {self.time:g}>"


def _effects_of(said: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Kinds and keys of the effects of a scene file."""
    for kind, name in _keys.effect_types().items():
        for keys in said.get(name, []):
            yield kind, keys


def _with_body(effect: Effect) -> dict[str, Any]:
    """The keys as a scene file has them, whatever world they are for."""
    keys = dict(effect.keys)
    if effect.body is not None:
        place = keys
        if any(key.type == "selection" for key in _keys.objects()[effect.kind].keys):
            place = keys["where"] = dict(keys.get("where", {}))
        place["body"] = _keys.plain(effect.body, f"{effect.kind}: body")
    return keys


def _described(kind: str, keys: dict[str, Any]) -> Effect:
    keys = dict(keys)
    body = keys.pop("body", None)
    if body is None and "body" in keys.get("where", {}):
        keys["where"] = dict(keys["where"])
        body = keys["where"].pop("body")
    return Effect(kind, keys, body)


def _materials(given: Material | Sequence[Material]) -> list[Material]:
    several = [given] if isinstance(given, Material) else list(given) if isinstance(given, (list, tuple)) else None
    if several is None or not all(isinstance(m, Material) for m in several):
        raise Error("add_body: materials must be one isochor.Material or a list of them, as isochor.neo_hookean() makes")
    return several


def _free(word: str, taken: Sequence[str]) -> str:
    if word not in taken:
        return word
    number = 2
    while f"{word} {number}" in taken:
        number += 1
    return f"{word} {number}"


def _number(value: Any, what: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise Error(f"{what} is {value!r}; give a number") from None
