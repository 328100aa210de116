"""What steps and worlds tell. All quantities are in SI units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np


@dataclass(frozen=True)
class StepReport:
    """What a step did and how it ended."""

    status: str
    """``converged``, or ``unfinished`` where a budget ran out; others are raised: ``rejected``,
    ``cancelled``, ``invalid``."""
    reason: str = ""
    """Empty when converged, else one sentence."""
    warning: str = ""
    """A sentence about an end that converged and is yet not to be taken as it is; empty: none."""
    time: float = 0.0
    """Of the state now [s]; in statics the load factor."""
    substeps: int = 0
    rejected_substeps: int = 0
    rescues: int = 0
    """Increments that only a damped motion brought to their equilibrium."""
    error_rejections: int = 0
    """Increments that converged and were taken back for ``time_error``."""
    negative_pivots: int = -1
    expected_negative_pivots: int = 0
    unstable_directions: int = -1
    """Of ``follow``: directions in which the equilibrium is unstable; -1: not known."""
    time_error: float = 0.0
    min_J: float = 1.0
    """Smallest ratio of volumes over all cells."""
    inverted_cells: int = 0
    force_residual: float = 0.0
    row_residual: float = 0.0
    linear_residual: float = 0.0
    compile_work: str = "nothing"
    """What changes since the last step cost: ``nothing``, ``numbers`` (the next step makes new factors, as every
    step does) or ``structure`` (patterns and the ordering are new as well)."""
    compile_seconds: float = 0.0
    """[s], without the ordering, which counts as ``seconds["analyze"]``."""
    iterations: int = 0
    """Newton iterations."""
    corrections: int = 0
    lagged: int = 0
    factorizations: int = 0
    trials: int = 0
    projected: int = 0
    shifted: int = 0
    dual_steps: int = 0
    stand_ins: int = 0
    dual_iterations: int = 0
    linear_iterations: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    """Wall time by stage [s]: analyze, evaluate, gather, factor, solve, line_search, total."""

    @property
    def converged(self) -> bool:
        return self.status == "converged"


class Progress(NamedTuple):
    """Told once an iteration while a step works."""

    time: float
    """Where the world is [s]."""
    target: float
    """End of the increment under way [s]."""
    iteration: int
    force_residual: float
    row_residual: float


class Gauge(NamedTuple):
    """A named number that an effect reports."""

    effect: str
    kind: str
    quantity: str
    unit: str
    value: float


@dataclass(frozen=True)
class Energies:
    """Energies of the whole world now [J]. Potentials are zero at rest positions."""

    kinetic: float
    elastic: float
    gravity: float
    loads: float
    """Of tractions and point forces."""
    pressures: float
    """Of given pressures and tensions, and of the gas in closed chambers."""

    @property
    def potential(self) -> float:
        return self.elastic + self.gravity + self.loads + self.pressures

    @property
    def total(self) -> float:
        return self.kinetic + self.potential


@dataclass(frozen=True)
class Volume:
    """Volume of a body or of one of its regions, now and at rest [m^3]."""

    name: str
    volume: float
    rest_volume: float
    min_J: float
    max_J: float

    @property
    def volume_change(self) -> float:
        """Relative, negative where volume was lost."""
        return self.volume / self.rest_volume - 1 if self.rest_volume > 0 else 0.0


@dataclass(frozen=True)
class BodyMeasures(Volume):
    """What the deformation and the motion of a body look like now."""

    volume_row_residual: float
    """What the volume rows leave over, relative; says nothing of volume that a compressible body lost."""
    center_of_mass: np.ndarray
    """(3,) [m]"""
    mass: float
    """[kg]"""
    linear_momentum: np.ndarray
    """(3,) [kg m/s]"""
    angular_momentum: np.ndarray
    """(3,), about the origin [kg m^2/s]"""
    regions: tuple[Volume, ...]

    @staticmethod
    def _of(values: dict[str, Any]) -> BodyMeasures:
        values["regions"] = tuple(Volume(**region) for region in values["regions"])
        return BodyMeasures(**values)


@dataclass(frozen=True)
class Fields:
    """Results at the n nodes and m cells of a body. Stresses are Cauchy's, tension positive [Pa]."""

    node_pressure: np.ndarray
    """(n,), tr(sigma)/3 [Pa]"""
    node_stress: np.ndarray
    """(n, 6): xx yy zz xy yz zx [Pa]"""
    cell_J: np.ndarray
    """(m,), ratio of volumes"""
    cell_pressure: np.ndarray
    """(m,) [Pa]"""
    cell_von_mises: np.ndarray
    """(m,) [Pa]"""
    cell_stress: np.ndarray
    """(m, 6) [Pa]"""
    cell_max_stretch: np.ndarray
    """(m,)"""
    node_contact_pressure: np.ndarray | None
    """(n,) [Pa]; None where no contact is about this body"""
    node_friction: np.ndarray | None
    """(n, 3) [Pa]; None likewise"""


@dataclass(frozen=True)
class Reaction:
    """What a support takes up."""

    force: np.ndarray
    """(3,) [N]"""
    moment: np.ndarray
    """(3,), about the origin [N m]"""


@dataclass(frozen=True)
class Size:
    """Unknowns and memory of a compiled world."""

    nodes: int
    displacement_unknowns: int
    multipliers: int
    matrix_size: int
    matrix_nonzeros: int
    factor_nonzeros: int
    engine_bytes: int
    table_bytes: int
    """Of tables that clones share."""


@dataclass(frozen=True)
class Finding:
    """Something that the checker of meshes has to say."""

    severity: str
    """``note``, ``warning`` or ``error``"""
    code: str
    message: str
    count: int


@dataclass(frozen=True)
class MeshReport:
    """What the checker of meshes found."""

    usable: bool
    """No finding is an error."""
    nodes: int
    cells: int
    parts: int
    """Connected components of cells."""
    volume: float
    """[m^3]"""
    box: np.ndarray
    """(2, 3): lower and upper corner [m]"""
    worst_quality: float
    smallest_dihedral_deg: float
    findings: tuple[Finding, ...]


@dataclass(frozen=True)
class Contacts:
    """Points of contacts that press, one entry a point. Forces are on the body that the point is of."""

    effects: list[str]
    bodies: list[str]
    partners: list[str]
    """What is touched: a body, a rigid body or an obstacle"""
    nodes: np.ndarray
    """(k,), of the body's mesh; -1 where the point is none of its nodes"""
    positions: np.ndarray
    """(k, 3) [m]"""
    gaps: np.ndarray
    """(k,), negative within a layer that gives way [m]"""
    normals: np.ndarray
    """(k, 3), unit vectors away from the partner"""
    normal_forces: np.ndarray
    """(k, 3) [N]"""
    frictions: np.ndarray
    """(k, 3) [N]"""
    areas: np.ndarray
    """(k,), at rest, that each point stands for; 0: edges [m^2]"""

    def __len__(self) -> int:
        return len(self.gaps)


class ContactPair(NamedTuple):
    """What two partners of all contacts do to each other."""

    body: str
    partner: str
    force: np.ndarray
    """(3,), on the body, friction included [N]"""
    normal: float
    """Sum of the magnitudes of the normal forces [N]"""
    points: int


@dataclass(frozen=True)
class Orientation:
    """How a set of nodes has turned and moved since rest: the rigid motion that fits it best."""

    angle: float
    """[rad], 0 to pi"""
    axis: np.ndarray
    """(3,), unit vector of the turn; zero for no turn"""
    displacement: np.ndarray
    """(3,), of the middle of the set [m]"""
    normal: np.ndarray
    """(3,), unit vector; of surfaces the mean normal of their faces now"""
    misfit: float
    """Root mean square distance from the shape at rest moved rigidly [m]"""


@dataclass(frozen=True)
class Response:
    """Derivatives of an equilibrium by one input: an amount, or a force on a point."""

    positions: dict[str, np.ndarray]
    """d x of the nodes, by name of the body, each of shape (n, 3)"""
    gauges: dict[str, dict[str, float]]
    """By name of the effect and quantity"""
    reactions: dict[str, Reaction]
    """By name of the effect"""
    regular: bool
    """False: of one side only, since a contact or a bounded row is about to close or to open; ``note`` says which."""
    note: str
    unstable_directions: int
    """Directions in which the equilibrium is unstable under fixed loads; -1: not known"""
