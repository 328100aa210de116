"""Outputs and parameters of ``World.gradients``, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import effects as _effects
from . import keys as _keys
from . import materials as _materials
from . import world as _world
from .errors import Error

_MODES = ("automatic", "adjoint", "tangent")


class Output:
    """A number that an equilibrium shows; its functions make the kinds that there are.

    Linear functions of positions are ``positions``, and of those ``node`` and ``material_point``; ``distance`` and
    ``square`` are quadratic. Arrays are looked at by ``World.gradients``.
    """

    __slots__ = ("kind", "_of", "_given")

    def __init__(self, kind: str, of: Any, *given: Any) -> None:
        self.kind = kind
        self._of = of
        self._given = given

    @staticmethod
    def positions(body: _world.Body, nodes: ArrayLike | None, weights: ArrayLike) -> Output:
        """The sum of weight . x over nodes [m]: every linear function of positions.

        ``nodes``: shape (n,); None: all nodes of the body. ``weights``: shape (n, 3), or (3,) for every node the same.
        """
        return Output("positions", _body(body, "Output.positions"), _listed(nodes), weights, _ndim(weights) == 1)

    @staticmethod
    def node(body: _world.Body, node: int, direction: ArrayLike) -> Output:
        """direction . x of a node [m]."""
        return Output("node", _body(body, "Output.node"), node, direction)

    @staticmethod
    def material_point(body: _world.Body, point: ArrayLike, direction: ArrayLike) -> Output:
        """direction . x of the material point that is at ``point`` at rest [m]."""
        return Output("material_point", _body(body, "Output.material_point"), point, direction)

    @staticmethod
    def distance(body: _world.Body, nodes: ArrayLike | None, targets: ArrayLike) -> Output:
        """Half the sum of |x - target|^2 over nodes [m^2]; ``nodes`` and ``targets`` as of ``positions``."""
        return Output("distance", _body(body, "Output.distance"), _listed(nodes), targets, _ndim(targets) == 1)

    @staticmethod
    def gauge(effect: _world.LiveEffect, quantity: str) -> Output:
        """A gauge of an effect: "volume" or "pressure" of a cavity, "length" or "tension" of a cable."""
        return Output("gauge", _effect(effect, "Output.gauge"), str(quantity))

    @staticmethod
    def reaction(effect: _world.LiveEffect, force: ArrayLike, moment: ArrayLike = (0.0, 0.0, 0.0)) -> Output:
        """force . F + moment . M of the reaction of a support: its force F [N] and moment M about the origin [N m]."""
        return Output("reaction", _effect(effect, "Output.reaction"), force, moment)

    @staticmethod
    def elastic_energy() -> Output:
        """Of the world [J], as ``World.energies().elastic``."""
        return Output("elastic_energy", None)

    @staticmethod
    def energy(part: str) -> Output:
        """Of the world [J]: "elastic", "gravity", "loads", "pressures", "potential"; of ways "kinetic", "total"."""
        return Output("energy", None, str(part))

    @staticmethod
    def square(body: _world.Body, nodes: ArrayLike | None, weights: ArrayLike, target: float) -> Output:
        """Half the square of (the sum of weight . x over nodes - target) [m^2]: quadratic functions are sums of these.

        ``nodes`` and ``weights`` as of ``positions``.
        """
        who = "Output.square"
        number = _world._number(target, f"{who}: target")
        return Output("square", _body(body, who), _listed(nodes), weights, _ndim(weights) == 1, number)

    @staticmethod
    def stress(body: _world.Body, cell: int, measure: str) -> Output:
        """Cauchy stress in a cell as ``Body.fields`` has it [Pa]: "von_mises", "pressure", "xx", "yy", ... "zx"."""
        return Output("stress", _body(body, "Output.stress"), _whole(cell, "Output.stress: cell"), str(measure))

    @staticmethod
    def effect_force(effect: _world.LiveEffect, body: _world.Body, direction: ArrayLike) -> Output:
        """direction . F, F being all that an effect does to a body [N]: a contact, a cable, a cavity, springs."""
        who = "Output.effect_force"
        return Output("effect_force", _effect(effect, who), _body(body, who)._id, direction)

    @staticmethod
    def of_positions(
        body: _world.Body, function: Callable[[np.ndarray], tuple[float, ArrayLike]]
    ) -> Output:
        """What a function makes of the positions of a body, shape (n, 3): a number, and its gradient of that shape."""
        who = "Output.of_positions"
        if not callable(function):
            raise Error(f"{who}: a value of type {type(function).__name__}; give a function")
        return Output("of_positions", _body(body, who), function)

    def _raw(self) -> tuple[Any, ...]:
        return (self.kind, None if self._of is None else self._of._id, *self._given)

    def __repr__(self) -> str:
        return f"<isochor.Output {self.kind}{_whose(self._of)}>"


class Parameter:
    """A number of the scene, or a list of them; its functions make the kinds that there are."""

    __slots__ = ("kind", "_of", "_given", "_step")

    def __init__(self, kind: str, of: Any, *given: Any, step: float = 0.0) -> None:
        self.kind = kind
        self._of = of
        self._given = given
        self._step = _world._number(step, f"Parameter.{kind}: step")

    @staticmethod
    def amount_of(effect: _world.LiveEffect, *, step: float = 0.0) -> Parameter:
        """The amount of an effect, in its unit. In a list of parameters the effect itself says the same.

        ``step``: how far it is moved where a difference is taken; 0: 1e-4 of the amount, or of 1.
        """
        return Parameter("amount_of", _effect(effect, "Parameter.amount_of"), step=step)

    @staticmethod
    def curve_point(
        effect: _world.LiveEffect, curve: Sequence[tuple[float, float]], number: int, *, step: float = 0.0
    ) -> Parameter:
        """The value of one point, from 0, of the curve that the amount of an effect follows: (time, value) pairs."""
        who = "Parameter.curve_point"
        pairs = [tuple(_world._number(v, f"{who}: curve[{k}]") for v in pair) for k, pair in enumerate(curve)]
        return Parameter("curve_point", _effect(effect, who), pairs, _whole(number, f"{who}: number"), step=step)

    @staticmethod
    def force_at(body: _world.Body, point: ArrayLike, force: ArrayLike) -> Parameter:
        """A factor on a dead force [N] at a point of a body at rest [m], as (body, point, force) in a list."""
        return Parameter("force_at", _body(body, "Parameter.force_at"), point, force)

    @staticmethod
    def gravity(direction: ArrayLike) -> Parameter:
        """Gravity along a direction, whose length is the unit [m/s^2]."""
        return Parameter("gravity", None, direction)

    @staticmethod
    def density(body: _world.Body, region: str = "") -> Parameter:
        """The density of a region, or of all of the body [kg/m^3]."""
        return Parameter("density", _body(body, "Parameter.density"), str(region))

    @staticmethod
    def material(
        body: _world.Body,
        what: str | Callable[[float], _materials.Material],
        *,
        value: float | None = None,
        region: str | None = None,
        step: float = 0.0,
    ) -> Parameter:
        """A constant of a material.

        ``what``: a key of it, "young" or "terms[0].mu", or a function that makes the material of a ``value``, which
        is where the constant is now: what it makes there must be what the body has. It may refuse values on one side
        by raising :class:`isochor.Error`. ``region``: None where the body has one material. ``step``: how far the
        value is moved where a difference is taken; 0: 1e-4 of it.
        """
        who = "Parameter.material"
        keys, region = _material_of(_body(body, who), region)
        if callable(what):
            return Parameter("material", body, region, _value(value, who), _maker(what, _material_text), step=step)
        law = str(keys.get("law", "neo_hookean"))
        known = {key.python_name: key for key in _materials.arguments(law)}
        path, keys = _key(what, keys, known, law, who)
        return Parameter("material", body, region, path, _keys.text(keys), step=step)

    @staticmethod
    def stiffness(body: _world.Body, region: str = "") -> Parameter:
        """A factor on the stiffness of a region, or of all of the body, at 1: energy and bulk modulus."""
        return Parameter("stiffness", _body(body, "Parameter.stiffness"), str(region))

    @staticmethod
    def cell_stiffness(body: _world.Body) -> Parameter:
        """The same of each cell by itself: as many numbers as the mesh has cells. By the adjoint alone."""
        return Parameter("cell_stiffness", _body(body, "Parameter.cell_stiffness"))

    @staticmethod
    def constant_of(
        effect: _world.LiveEffect,
        what: str | Callable[[float], _effects.Effect],
        *,
        value: float | None = None,
        step: float = 0.0,
    ) -> Parameter:
        """A constant of an effect: a key of it, or a function that makes it of a ``value``, as of ``material``."""
        who = "Parameter.constant_of"
        kind, keys = _effect(effect, who).kind, effect.world._with_body(effect.description)
        if callable(what):
            text = lambda made: _effect_text(effect, made)
            return Parameter("constant_of", effect, kind, _value(value, who), _maker(what, text), step=step)
        known = {key.python_name: key for key, inner in _effects.arguments(kind) if not inner}
        path, keys = _key(what, keys, known, kind, who)
        return Parameter("constant_of", effect, kind, path, _keys.text(keys), step=step)

    @staticmethod
    def shape(body: _world.Body, motion: ArrayLike) -> Parameter:
        """Rest positions move by this times ``motion``, one vector a node, shape (n, 3).

        Of shape (m, n, 3) they are m numbers.
        """
        return Parameter("shape", _body(body, "Parameter.shape"), motion, _ndim(motion) == 3)

    @staticmethod
    def initial_velocity(body: _world.Body, motion: ArrayLike) -> Parameter:
        """Of trajectories: velocities at the start change by this times ``motion``; shapes as of ``shape``."""
        return Parameter(
            "initial_velocity", _body(body, "Parameter.initial_velocity"), motion, _ndim(motion) == 3
        )

    def _raw(self) -> list[tuple[Any, ...]]:
        """As many as it has numbers; one for those of cells."""
        whose = None if self._of is None else self._of._id
        if self._several():
            return [(self.kind, whose, self._step, motion) for motion in self._given[0]]
        return [(self.kind, whose, self._step, *self._given)]

    def _several(self) -> bool:
        return self.kind in ("shape", "initial_velocity") and self._given[1]

    def _is_number(self) -> bool:
        return self.kind != "cell_stiffness" and not self._several()

    def __repr__(self) -> str:
        return f"<isochor.Parameter {self.kind}{_whose(self._of)}>"


@dataclass(frozen=True)
class Gradients:
    """Outputs of an equilibrium or of a way through time, and their derivatives by parameters."""

    values: np.ndarray
    """(outputs,)"""
    jacobian: np.ndarray
    """(outputs, numbers): d output / d number, of all numbers of all parameters in their order"""
    by: tuple[np.ndarray, ...]
    """The columns of each parameter: (outputs,), and (outputs, numbers) of cells and of several shapes; views"""
    regular: bool
    """False: of one side only, since rows are about to touch or to let go, or with friction; ``note`` says which."""
    note: str
    undecided: tuple[str, ...]
    """Names of the effects of such rows"""
    adjoint: bool
    """How it was found: one solve an output, else one a parameter"""
    kept_states: int = 0
    """Of trajectories: how many states of the way were kept at most at a time"""
    steps_again: int = 0
    """How many steps were made again"""
    state_bytes: int = 0
    """What one state takes"""


def ask(world: _world.World, outputs: Any, parameters: Any, mode: str, unstable: bool) -> Gradients:
    """``World.gradients``."""
    who = "gradients"
    number = _mode(mode, who)
    shown = [_output(one, f"{who}: outputs[{k}]") for k, one in enumerate(_list(outputs, "outputs", who))]
    asked = _parameters(parameters, who)
    raw, places = _flat(asked)
    told = world._ready().gradients([one._raw() for one in shown], raw, places, number, bool(unstable))
    return _told(told, len(shown), asked)


def follow(
    world: _world.World, steps: Any, outputs: Any, parameters: Any, mode: str, kept_states: int
) -> Gradients:
    """``World.trajectory_gradients``."""
    who = "trajectory_gradients"
    number = _mode(mode, who)
    lengths = [_world._number(h, f"{who}: steps[{k}]") for k, h in enumerate(_sequence(steps, "steps", who))]
    shown = [_terms(one, f"{who}: outputs[{k}]") for k, one in enumerate(_list(outputs, "outputs", who))]
    asked = _parameters(parameters, who)
    raw, places = _flat(asked)
    kept = _whole(kept_states, f"{who}: kept_states")
    terms = [[(step, one._raw()) for step, one in output] for output in shown]
    told = world._ready().trajectory_gradients(lengths, terms, raw, places, number, kept)
    return _told(told, len(shown), asked)


def _mode(mode: str, who: str) -> int:
    if mode not in _MODES:
        raise Error(f'{who}: mode is "{mode}"; give "automatic", "adjoint" or "tangent"')
    return _MODES.index(mode)


def _parameters(parameters: Any, who: str) -> list[Parameter]:
    return [_parameter(one, f"{who}: parameters[{k}]") for k, one in enumerate(_list(parameters, "parameters", who))]


def _flat(asked: list[Parameter]) -> tuple[list[tuple[Any, ...]], list[int]]:
    """All numbers one after the other, and the parameter that each is of."""
    raw = [numbers for parameter in asked for numbers in parameter._raw()]
    return raw, [k for k, parameter in enumerate(asked) for _ in parameter._raw()]


def _terms(given: Any, who: str) -> list[tuple[int, Output]]:
    """(step, output), or a list of these, which add up."""
    terms = [given] if isinstance(given, tuple) else list(_list(given, "the output", who))
    out = []
    for term in terms:
        if not isinstance(term, tuple) or len(term) != 2:
            raise Error(f"{who}: a value of type {type(term).__name__}; give (step, isochor.Output), or a list of them")
        out.append((_whole(term[0], f"{who}: step"), _output(term[1], who)))
    return out


def _whole(given: Any, who: str) -> int:
    if isinstance(given, bool) or not isinstance(given, (int, np.integer)) or abs(int(given)) > 2**31 - 1:
        raise Error(f"{who} = {given!r}; give a whole number")
    return int(given)


def _sequence(given: Any, name: str, who: str) -> Sequence[Any]:
    if isinstance(given, np.ndarray) and given.ndim == 1:
        return list(given)
    return _list(given, name, who)


def _told(told: dict[str, Any], shown: int, asked: list[Parameter]) -> Gradients:
    widths = told.pop("widths")
    jacobian = told["jacobian"].reshape(shown, sum(widths))
    by, column, at = [], 0, 0
    for parameter in asked:
        count = len(parameter._raw())
        width = sum(widths[at : at + count])
        by.append(jacobian[:, column] if parameter._is_number() else jacobian[:, column : column + width])
        column, at = column + width, at + count
    return Gradients(**{**told, "jacobian": jacobian, "by": tuple(by), "undecided": tuple(told["undecided"])})


def _list(given: Any, name: str, who: str) -> Sequence[Any]:
    if isinstance(given, (list, tuple)):
        return given
    raise Error(f"{who}: {name} is a value of type {type(given).__name__}; give a list")


def _output(given: Any, who: str) -> Output:
    if isinstance(given, Output):
        return given
    raise Error(
        f"{who}: a value of type {type(given).__name__}; give an isochor.Output, as isochor.Output.node() makes"
    )


def _parameter(given: Any, who: str) -> Parameter:
    if isinstance(given, Parameter):
        return given
    if isinstance(given, _world.LiveEffect):
        return Parameter.amount_of(given)
    if isinstance(given, tuple) and len(given) == 3 and isinstance(given[0], _world.Body):
        return Parameter.force_at(*given)
    raise Error(
        f"{who}: a value of type {type(given).__name__}; give an isochor.Parameter, an effect for its amount, or "
        "(body, point, force)"
    )


def _body(given: Any, who: str) -> _world.Body:
    if isinstance(given, _world.Body):
        return given
    raise Error(f"{who}: a value of type {type(given).__name__}; give a body of a world")


def _effect(given: Any, who: str) -> _world.LiveEffect:
    if isinstance(given, _world.LiveEffect):
        return given
    raise Error(f"{who}: a value of type {type(given).__name__}; give an effect of a world")


def _ndim(values: Any) -> int:
    """Of what numpy makes an array of; -1: of what it does not, which is refused where it is read."""
    try:
        return int(np.ndim(values))
    except ValueError:
        return -1


def _listed(nodes: ArrayLike | None) -> Any:
    return list(nodes) if isinstance(nodes, range) else nodes


def _whose(of: Any) -> str:
    return "" if of is None else f' of "{of.name}"'


def _value(value: Any, who: str) -> float:
    if value is None:
        raise Error(f"{who}: value is None; give the number that the scene was made with")
    return _world._number(value, f"{who}: value")


def _material_of(body: _world.Body, region: str | None) -> tuple[dict[str, Any], str]:
    """The keys of the material of a region, or of the one that there is, and the region's name."""
    described = {str(keys.get("region", "")): keys for keys in body._described["materials"]}
    if region is None and len(described) == 1:
        ((region, keys),) = described.items()
        return dict(keys), region
    if region is not None and (region in described or "" in described):
        return dict(described.get(region, described.get(""))), region  # type: ignore[arg-type]
    names = " and ".join(f'"{name}"' if name else "all others" for name in described)
    asked = "" if region is None else f'there is no region "{region}"; '
    raise Error(f'Parameter.material: {asked}body "{body.name}" has materials of the regions {names}; name the region')


def _key(
    path: Any, keys: dict[str, Any], known: dict[str, _keys.Key], kind: str, who: str
) -> tuple[str, dict[str, Any]]:
    """A key as scene files have it, and the keys with what it is by default where it was left out."""
    if not isinstance(path, str):
        raise Error(f"{who}: a value of type {type(path).__name__}; give a key or a function")
    name = path.split(".")[0].split("[")[0]
    if name not in known:
        raise _keys.unknown(kind, name, known)
    key = known[name]
    if key.kind in ("word", "text", "flag"):
        raise Error(f'{who}: key "{name}" is a {key.kind}; name one that has a number')
    if key.name not in keys and isinstance(key.default, (int, float)):
        keys = {**keys, key.name: key.default}
    return key.name + path[len(name) :], keys


def _maker(make: Callable[[float], Any], text: Callable[[Any], str]) -> Callable[[float], str]:
    return lambda value: text(make(value))


def _material_text(made: Any) -> str:
    if not isinstance(made, _materials.Material):
        raise Error(f"the function made a value of type {type(made).__name__}; it is to return a material")
    return _keys.text(made.keys)


def _effect_text(live: _world.LiveEffect, made: Any) -> str:
    if not isinstance(made, _effects.Effect):
        raise Error(f"the function made a value of type {type(made).__name__}; it is to return an effect")
    if made.kind != live.kind:
        raise Error(f'the function made a {made.kind} in the place of the {live.kind} "{live.name}"; it is to make one')
    # Its world is in a call, and is not asked.
    return _keys.text({**_world._with_body(made), "name": live.name})
