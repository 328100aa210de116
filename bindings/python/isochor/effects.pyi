"""Effects. Made by bindings/python/make_stubs.py; edits are lost."""

from typing import Any, Literal, Mapping, Sequence, TypedDict, Union

from numpy.typing import ArrayLike

from .world import Body, LiveEffect

_Names = Union[str, Sequence[str]]
_Amount = Union[float, Sequence[tuple[float, float]], ArrayLike]

class Effect:
    kind: str
    keys: dict[str, Any]
    body: Any
    def __init__(self, kind: str, keys: dict[str, Any], body: Any = ...) -> None: ...
    @property
    def name(self) -> str: ...
    def with_keys(self, **changes: Any) -> Effect: ...

_Zone = TypedDict("_Zone", {"name": str, "regions": _Names, "cells": ArrayLike, "boxes": ArrayLike, "field": str, "compliance": float}, total=False)
_Rotation = TypedDict("_Rotation", {"point": ArrayLike, "axis": ArrayLike, "angle": float, "angle_deg": float}, total=False)
_Keyframe = TypedDict("_Keyframe", {"t": float, "position": ArrayLike, "turn": ArrayLike}, total=False)
_SkinBone = TypedDict("_SkinBone", {"motion": str, "keyframes": Sequence["_Keyframe"], "weights": ArrayLike, "field": str}, total=False)
_Prestretch = TypedDict("_Prestretch", {"along": float, "across": float, "direction": ArrayLike}, total=False)
_Rim = TypedDict("_Rim", {"surfaces": _Names, "node_sets": _Names, "nodes": ArrayLike, "boxes": ArrayLike, "everything": bool}, total=False)
_SheetFibers = TypedDict("_SheetFibers", {"direction": ArrayLike, "directions": ArrayLike, "law": Literal["exponential", "toe"], "k1": float, "k2": float, "dispersion": float, "exponent": float, "isochoric": bool, "straight_modulus": float, "straight_stretch": float}, total=False)
_Term = TypedDict("_Term", {"body": str, "point": ArrayLike, "direction": ArrayLike, "weight": float}, total=False)
_Obstacle = TypedDict("_Obstacle", {"shape": Literal["plane", "sphere", "capsule", "cylinder", "box", "mesh", "distance_field"], "position": ArrayLike, "axis": ArrayLike, "side": ArrayLike, "radius": float, "length": float, "size": ArrayLike, "rounding": float, "file": str, "scale": float, "spacing": float, "motion": str, "keyframes": Sequence["_Keyframe"]}, total=False)

def arguments(kind: str) -> list[tuple[Any, bool]]: ...

def volume(
    body: Union[Body, str, None] = ...,
    *,
    name: str = ...,
    space: Literal["node", "element", "body", "ring", "zone", "none"] = ...,
    strain: Literal["by_law", "linear", "logarithmic", "mixed", "mean_logarithmic", "mean_mixed"] = ...,
    regions: Union[_Names, None] = ...,
    rings: int = ...,
    zones: Union[Sequence["_Zone"], None] = ...,
    unpainted: Literal["none", "nearest"] = ...,
    painted_surfaces: Union[_Names, None] = ...,
    across_regions: bool = ...,
    stabilization: float = ...,
    hard: bool = ...,
    carries_bulk: bool = ...,
    treatment: Literal["automatic", "saddle", "condensed", "bordered", "dual", "augmented"] = ...,
    lumped_compliance: bool = ...,
) -> Effect:
    """Rows that keep volume, see volume.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    space:
        what has a row each; none: no rows: "node", "element", "body", "ring", "zone", "none" (default: "node")
    strain:
        what a row measures, see volume: "by_law", "linear", "logarithmic", "mixed", "mean_logarithmic", "mean_mixed" (default: "by_law")
    regions:
        that have rows (default: all)
    rings:
        of cells around each node, for space ring; >= 1 (default: 1)
    zones:
        for space zone
    unpainted:
        cells without paint: left out of painted zones, or with the weights of the nearest painted cell: "none", "nearest" (default: "none")
    painted_surfaces:
        that fields are painted on (default: all of the boundary)
    across_regions:
        rows of the spaces body and zone may hold cells of several regions (default: false)
    stabilization:
        of nodal rows on linear tets; 0: off; >= 0 (default: 1)
    hard:
        no compliance, whatever the material (default: false)
    carries_bulk:
        false: the rows come on top of the complete energy or of other rows (default: true)
    treatment:
        how the linear systems take the rows: "automatic", "saddle", "condensed", "bordered", "dual", "augmented" (default: "automatic")
    lumped_compliance:
        rows at nodes with their compliance on the diagonal, without stabilization (default: false)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def growth(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    regions: Union[_Names, None] = ...,
    linear: float = ...,
    volume: float = ...,
    along: float = ...,
    across: float = ...,
    direction: ArrayLike = ...,
    strain: Union[ArrayLike, None] = ...,
    field: Union[str, None] = ...,
    factors: Union[ArrayLike, None] = ...,
    amount: _Amount = ...,
) -> Effect:
    """A stress-free state that is not that of the mesh: swelling, thermal expansion, growth, prestrain, see growth.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    regions:
        that grow (default: all)
    linear:
        strain in all directions at amount 1 (default: 0)
    volume:
        instead: change of volume over volume at amount 1 (default: 0)
    along:
        instead: strain along direction at amount 1 (default: 0)
    across:
        strain across it (default: 0)
    direction:
        of along (default: [1, 0, 0])
    strain:
        instead: xx, yy, zz, xy, yz, zx at amount 1, or six numbers a cell
    field:
        of the mesh in cells: factors on the strain, or strains with six components
    factors:
        on the strain, one a cell
    amount:
        scales the strain over time, a temperature for example (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def dirichlet(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    regions: Union[_Names, None] = ...,
    node_sets: Union[_Names, None] = ...,
    nodes: Union[ArrayLike, None] = ...,
    boxes: Union[ArrayLike, None] = ...,
    nearest: Union[ArrayLike, None] = ...,
    everything: bool = ...,
    directions: Union[Union[str, ArrayLike], None] = ...,
    displacement: ArrayLike = ...,
    rotation: Union["_Rotation", None] = ...,
    bone: Union[str, None] = ...,
    treatment: Literal["eliminated", "multiplier", "stiffness"] = ...,
    stiffness: float = ...,
    points: Union[ArrayLike, None] = ...,
    amount: _Amount = ...,
) -> Effect:
    """Prescribed positions, see dirichlet. Without displacement, rotation and bone the nodes are held.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    regions:
        of the mesh
    node_sets:
        of the mesh or of the body
    nodes:
        of the body's mesh, counted from 0
    boxes:
        [m] [[lower, upper], ...], rest positions
    nearest:
        [m] the node nearest to each point
    everything:
        all nodes of the body (default: false)
    directions:
        letters ("xz") or vectors (default: all)
    displacement:
        [m] at amount 1 (default: [0, 0, 0])
    rotation:
        at amount 1
    bone:
        instead: a file of poses that the nodes follow, lines t, x, y, z, qw, qx, qy, qz; the first is the pose at rest
    treatment:
        how they enter the system: no unknowns, hard rows, or springs: "eliminated", "multiplier", "stiffness" (default: "eliminated")
    stiffness:
        [N/m] of treatment stiffness: of all springs together; >= 0 (default: 0)
    points:
        [m] in the body, that are held too; not with treatment eliminated
    amount:
        scales displacement and rotation over time (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def driven(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    file: Union[str, None] = ...,
    nodes: Union[ArrayLike, None] = ...,
    times: Union[ArrayLike, None] = ...,
    positions: Union[Sequence[ArrayLike], None] = ...,
) -> Effect:
    """Nodes that follow data, see data.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    file:
        of lines t, node, x, y, z: frame after frame with the same nodes
    nodes:
        instead of a file: of the body's mesh, counted from 0
    times:
        [s] of the frames; statics: load factor
    positions:
        [m] [[point, point, ...], ...]: a list a frame, a point a node

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def skin(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    regions: Union[_Names, None] = ...,
    node_sets: Union[_Names, None] = ...,
    nodes: Union[ArrayLike, None] = ...,
    boxes: Union[ArrayLike, None] = ...,
    nearest: Union[ArrayLike, None] = ...,
    everything: bool = ...,
    bones: Union[Sequence["_SkinBone"], None] = ...,
) -> Effect:
    """Nodes that follow several bones by weights, see skins.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    regions:
        of the mesh
    node_sets:
        of the mesh or of the body
    nodes:
        of the body's mesh, counted from 0
    boxes:
        [m] [[lower, upper], ...], rest positions
    nearest:
        [m] the node nearest to each point
    everything:
        all nodes of the body (default: false)
    bones:
        that they follow

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def traction(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surface: Union[str, None] = ...,
    traction: ArrayLike = ...,
    total_force: ArrayLike = ...,
    field: Union[str, None] = ...,
    profile: Union[str, None] = ...,
    current_area: bool = ...,
    lagged: bool = ...,
    amount: _Amount = ...,
) -> Effect:
    """A load on faces that keeps its direction, see loads.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surface:
        one of the mesh or of the body
    traction:
        [Pa] force per area at rest (default: [0, 0, 0])
    total_force:
        [N] instead of traction (default: [0, 0, 0])
    field:
        of the mesh at nodes with one component: factors on the traction
    profile:
        a factor in space and time: a formula of x, y, z (at rest) and t, see profiles
    current_area:
        per area as it is, not at rest (default: false)
    lagged:
        of current_area: hold the area within an iteration, for symmetric systems (default: false)
    amount:
        scales it over time (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def pressure(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    amount: Union[_Amount, None] = ...,
    field: Union[str, None] = ...,
    profile: Union[str, None] = ...,
    lagged: bool = ...,
) -> Effect:
    """Pressure that follows any faces of the boundary, open or closed, see pressure.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    amount:
        [Pa] positive pushes inward (default: 0, or 1 where it is a ratio or what was supplied)
    field:
        of the mesh at nodes with one component: factors on the pressure
    profile:
        a factor in space and time: a formula of x, y, z (at rest) and t, see profiles
    lagged:
        hold what a free rim adds within an iteration: symmetric systems, linear convergence (default: false)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def force(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    regions: Union[_Names, None] = ...,
    node_sets: Union[_Names, None] = ...,
    nodes: Union[ArrayLike, None] = ...,
    boxes: Union[ArrayLike, None] = ...,
    nearest: Union[ArrayLike, None] = ...,
    everything: bool = ...,
    force: Union[ArrayLike, None] = ...,
    amount: _Amount = ...,
) -> Effect:
    """A dead force on nodes, see loads.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    regions:
        of the mesh
    node_sets:
        of the mesh or of the body
    nodes:
        of the body's mesh, counted from 0
    boxes:
        [m] [[lower, upper], ...], rest positions
    nearest:
        [m] the node nearest to each point
    everything:
        all nodes of the body (default: false)
    force:
        [N] shared equally by the nodes
    amount:
        scales it over time (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def damping(
    body: Union[Body, str, None] = ...,
    *,
    name: str = ...,
    regions: Union[_Names, None] = ...,
    viscosity: float = ...,
    mass_rate: float = ...,
) -> Effect:
    """In dynamics, on top of that of the time scheme, see damping.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    regions:
        that are damped (default: all)
    viscosity:
        [Pa s] Kelvin-Voigt; >= 0 (default: 0)
    mass_rate:
        [1/s] drag over momentum; >= 0 (default: 0)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def muscle(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    regions: Union[_Names, None] = ...,
    direction: ArrayLike = ...,
    directions: Union[ArrayLike, None] = ...,
    field: Union[str, None] = ...,
    amount: Union[_Amount, None] = ...,
    tension: Literal["nominal", "current"] = ...,
    optimal_stretch: float = ...,
    width: float = ...,
) -> Effect:
    """Active stress along fibers, see muscle.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    regions:
        that pull (default: all)
    direction:
        of the fibers at rest (default: [1, 0, 0])
    directions:
        instead: one a cell of the body's mesh
    field:
        instead: of the mesh in cells, with three components
    amount:
        [Pa] the active stress; positive pulls (default: 0, or 1 where it is a ratio or what was supplied)
    tension:
        the stress is per area at rest, or as it is: "nominal", "current" (default: "nominal")
    optimal_stretch:
        of the fibers where the muscle is strongest; > 0 (default: 1)
    width:
        how far from there it pulls; 0: everywhere alike; >= 0 (default: 0)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def epidermis(
    body: Union[Body, str, None] = ...,
    *,
    name: str = ...,
    surfaces: Union[_Names, None] = ...,
    young: Union[float, None] = ...,
    poisson: Union[float, None] = ...,
    thickness: Union[float, None] = ...,
    stiffness: Union[float, None] = ...,
    gamma: float = ...,
) -> Effect:
    """A layer that resists changes of area, see epidermis: young, poisson and thickness, or stiffness.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    young:
        [Pa] of the layer; > 0 (default: by stiffness)
    poisson:
        of the layer; > 0, <= 0.5 (default: by stiffness)
    thickness:
        [m] of the layer; > 0 (default: by stiffness)
    stiffness:
        [N/m] instead of these three; "inf" keeps every area (default: by the three)
    gamma:
        how soon it stiffens; >= 0 (default: 0)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def membrane(
    body: Union[Body, str, None] = ...,
    *,
    name: str = ...,
    surfaces: Union[_Names, None] = ...,
    young: Union[float, None] = ...,
    poisson: float = ...,
    thickness: Union[float, None] = ...,
    prestretch: Union["_Prestretch", None] = ...,
    amount: _Amount = ...,
) -> Effect:
    """A neo-Hookean membrane in plane stress, see epidermis.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    young:
        [Pa] of the membrane; > 0
    poisson:
        of the membrane; >= 0, <= 0.5 (default: 0.5)
    thickness:
        [m] of the membrane; > 0
    prestretch:
        how much it is stretched where the body is at rest
    amount:
        of the prestretch: stretches are 1 + amount (stretch - 1) (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def shell(
    body: Union[Body, str, None] = ...,
    *,
    name: str = ...,
    surfaces: Union[_Names, None] = ...,
    young: Union[float, None] = ...,
    poisson: float = ...,
    thickness: Union[float, None] = ...,
    density: float = ...,
    bending: float = ...,
    clamped: Union["_Rim", None] = ...,
    flat: bool = ...,
    prestretch: Union["_Prestretch", None] = ...,
    amount: _Amount = ...,
    fibers: Union[Sequence["_SheetFibers"], None] = ...,
    fiber_field: Union[str, None] = ...,
) -> Effect:
    """A thin sheet that stretches, shears and bends, see shells: what a thin body is made of, or a layer on a solid one.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body (default: all of a thin body)
    young:
        [Pa] of the sheet; > 0
    poisson:
        of the sheet; >= 0, <= 0.5 (default: 0.5)
    thickness:
        [m] of the sheet; > 0
    density:
        [kg/m^3] of the sheet; 0: a layer without mass, on solid bodies only; >= 0 (default: 0)
    bending:
        [N m] stiffness of a plate against bending; 0: that of a solid sheet; >= 0 (default: 0)
    clamped:
        edges at the rim with both ends there keep the direction in which the sheet leaves them; supports hold nodes
    flat:
        free of bending when flat, not as the mesh has it (default: false)
    prestretch:
        how much it is stretched where the body is at rest
    amount:
        of the prestretch: stretches are 1 + amount (stretch - 1) (default: 1)
    fibers:
        that only pull, in the plane of the sheet
    fiber_field:
        their directions: a field of the mesh in cells with three components

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def cavity(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    control: Literal["pressure", "volume", "volume_ratio", "gas", "liquid"] = ...,
    amount: Union[_Amount, None] = ...,
    polytropic: float = ...,
    ambient: float = ...,
    density: float = ...,
    cap_free_openings: bool = ...,
) -> Effect:
    """A chamber, see cavity.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        faces that bound it
    control:
        what is given: "pressure", "volume", "volume_ratio", "gas", "liquid" (default: "pressure")
    amount:
        [Pa, m^3 or 1] gauge pressure, volume, volume over rest volume; gas or liquid supplied so far over what fills the chamber at rest (default: 0, or 1 where it is a ratio or what was supplied)
    polytropic:
        exponent of a gas: p V^n; 1: isothermal; >= 1 (default: 1)
    ambient:
        [Pa] absolute pressure outside; > 0 (default: 101325)
    density:
        [kg/m^3] of a liquid that feels the gravity of the scene; >= 0 (default: 0)
    cap_free_openings:
        close openings that no support holds, too (default: false)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def valve(
    *,
    name: Union[str, None] = ...,
    from_: Union[Union[str, Body, LiveEffect, Effect], None] = ...,
    to: Union[Union[str, Body, LiveEffect, Effect], None] = ...,
    conductance: Union[float, None] = ...,
    amount: _Amount = ...,
) -> Effect:
    """Between two chambers of gas or of liquid, or a leak, see cavity.

    Parameters
    ----------
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    from_:
        a cavity of control gas or liquid
    to:
        another one (default: outside, a leak)
    conductance:
        [m^3/(s Pa)] flow over difference of pressures; > 0
    amount:
        opening; 0: shut (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def cable(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    points: Union[ArrayLike, None] = ...,
    from_: Union[ArrayLike, None] = ...,
    to: Union[ArrayLike, None] = ...,
    control: Literal["tension", "length", "length_ratio"] = ...,
    amount: Union[_Amount, None] = ...,
    stiffness: float = ...,
) -> Effect:
    """Pulls, never pushes, and slides through its points without friction, see cable.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    points:
        [m] in or on the body at rest, in order
    from_:
        [m] a fixed place that it comes from (default: none)
    to:
        [m] a fixed place that it goes to (default: none)
    control:
        what is given: "tension", "length", "length_ratio" (default: "length_ratio")
    amount:
        [N, m or 1] tension, length, or length over rest length (default: 0, or 1 where it is a ratio or what was supplied)
    stiffness:
        [N/m] of the whole cable when its length is given; 0: inextensible; >= 0 (default: 0)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def winding(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    paths: Union[Sequence[ArrayLike], None] = ...,
    stiffness: float = ...,
    slack: float = ...,
    pulls_only: bool = ...,
) -> Effect:
    """Threads bonded to the body along paths, see cable.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    paths:
        [m] [[point, point, ...], ...] in or on the body at rest
    stiffness:
        [N] tension over strain, E A; 0: inextensible; >= 0 (default: 0)
    slack:
        strain that is free; >= 0 (default: 0)
    pulls_only:
        false: it resists shortening too (default: true)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def spring(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    from_: Union[ArrayLike, None] = ...,
    to_body: Union[str, None] = ...,
    to: Union[ArrayLike, None] = ...,
    stiffness: Union[float, None] = ...,
    length: Union[float, None] = ...,
    pulls_only: bool = ...,
    amount: _Amount = ...,
) -> Effect:
    """Between two points of bodies or to a fixed place, see springs.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    from_:
        [m] in or on the body at rest
    to_body:
        the body that to is of (default: a fixed place)
    to:
        [m] the other end
    stiffness:
        [N/m] force over length; > 0
    length:
        [m] without tension; >= 0 (default: as at rest)
    pulls_only:
        slack where it is shorter (default: false)
    amount:
        factor on the length without tension over time (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def layer(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    stiffness: Union[float, None] = ...,
    slack: float = ...,
    pulls_only: bool = ...,
) -> Effect:
    """Fabric on a surface that resists stretching, see cable.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    stiffness:
        [N/m] Young's modulus times thickness; > 0
    slack:
        strain that is free; >= 0 (default: 0)
    pulls_only:
        false: it resists shortening too (default: true)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def linear_constraint(
    *,
    name: Union[str, None] = ...,
    terms: Union[Sequence["_Term"], None] = ...,
    stiffness: float = ...,
    value: float = ...,
    amount: _Amount = ...,
) -> Effect:
    """An equation between displacements of points, see linear constraints.

    Parameters
    ----------
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    terms:
        whose sum is given
    stiffness:
        [N/m] of a spring on the sum; 0: hard; >= 0 (default: 0)
    value:
        [m] what the sum is at amount 1 (default: 0)
    amount:
        scales it over time (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def tie(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    regions: Union[_Names, None] = ...,
    node_sets: Union[_Names, None] = ...,
    nodes: Union[ArrayLike, None] = ...,
    boxes: Union[ArrayLike, None] = ...,
    nearest: Union[ArrayLike, None] = ...,
    everything: bool = ...,
    to: Union[Union[str, Body, LiveEffect, Effect], None] = ...,
    stiffness: float = ...,
) -> Effect:
    """Holds nodes of one body to the points of another that they lie on at rest, see tie.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body
    regions:
        of the mesh
    node_sets:
        of the mesh or of the body
    nodes:
        of the body's mesh, counted from 0
    boxes:
        [m] [[lower, upper], ...], rest positions
    nearest:
        [m] the node nearest to each point
    everything:
        all nodes of the body (default: false)
    to:
        the body that holds them
    stiffness:
        [N/m] of all springs together; 0: hard; >= 0 (default: 0)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def rigid_body(
    *,
    name: Union[str, None] = ...,
    shape: Union["_Obstacle", None] = ...,
    density: float = ...,
) -> Effect:
    """Moves by the forces on it; dynamics only. It touches what contacts that name it say, see contact.

    Parameters
    ----------
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    shape:
        any but a plane, where it is at rest
    density:
        [kg/m^3] see the page of the effect; > 0 (default: 1000)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def contact(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    rigid: Union[Union[str, Body, LiveEffect, Effect], None] = ...,
    against: Union[Union[str, Body, LiveEffect, Effect], None] = ...,
    obstacle: Union["_Obstacle", None] = ...,
    compliance: float = ...,
    friction: float = ...,
    static_friction: float = ...,
    stick_stiffness: float = ...,
    coupling: Literal["lagged", "coupled"] = ...,
    restitution: float = ...,
    restitution_speed: float = ...,
    initial_overlap: Literal["report", "resolve"] = ...,
    resolve_time: float = ...,
) -> Effect:
    """Nodes of a surface do not enter an obstacle; it does not pull, see contact.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body (default: the whole boundary)
    rigid:
        the rigid body that touches, instead of body (default: none)
    against:
        the rigid body that is touched, instead of obstacle (default: none)
    obstacle:
        what is touched (default: the floor z = 0)
    compliance:
        [m/Pa] depth over pressure; 0: hard; >= 0 (default: 0)
    friction:
        coefficient of Coulomb friction; >= 0 (default: 0)
    static_friction:
        coefficient that it takes to break away, not below friction; 0: the same; >= 0 (default: 0)
    stick_stiffness:
        [Pa/m] shear stress over slip where friction sticks; 0: automatic; >= 0 (default: 0)
    coupling:
        whether the linear systems know how friction follows the normal force: unsymmetric ones then: "lagged", "coupled" (default: "lagged")
    restitution:
        Newton's coefficient; hard contact in dynamics; >= 0, <= 1 (default: 0)
    restitution_speed:
        [m/s] what closes more slowly does not bounce; >= 0 (default: 0.05)
    initial_overlap:
        what becomes of points that are inside at the start: refused, or pushed out little by little: "report", "resolve" (default: "report")
    resolve_time:
        [s] by which they are out; statics: load factor; > 0 (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """

def surface_contact(
    body: Union[Body, str, None] = ...,
    *,
    name: Union[str, None] = ...,
    surfaces: Union[_Names, None] = ...,
    against: Union[Union[str, Body, LiveEffect, Effect], None] = ...,
    against_surfaces: Union[_Names, None] = ...,
    compliance: Union[float, None] = ...,
    thickness: float = ...,
    friction: float = ...,
    static_friction: float = ...,
    stick_stiffness: float = ...,
    coupling: Literal["lagged", "coupled"] = ...,
    initial_overlap: Literal["report", "resolve"] = ...,
    resolve_time: float = ...,
) -> Effect:
    """Surfaces of soft bodies against each other, or of one body against itself, see contact.

    Parameters
    ----------
    body:
        A body of the world, or its name; None: the first.
    name:
        of the effect; all effects of a world share one set of names (default: one is found)
    surfaces:
        of the mesh or of the body (default: the whole boundary)
    against:
        the other body (default: the surfaces touch each other)
    against_surfaces:
        of the other body (default: its whole boundary)
    compliance:
        [m/Pa] depth over pressure; > 0 (default: that of a layer two percent of a face thick)
    thickness:
        [m] distance that the surfaces keep; >= 0 (default: 0)
    friction:
        coefficient of Coulomb friction; >= 0 (default: 0)
    static_friction:
        coefficient that it takes to break away, not below friction; 0: the same; >= 0 (default: 0)
    stick_stiffness:
        [Pa/m] shear stress over slip where friction sticks; 0: automatic; >= 0 (default: 0)
    coupling:
        whether the linear systems know how friction follows the normal force: unsymmetric ones then: "lagged", "coupled" (default: "lagged")
    initial_overlap:
        what becomes of points that are inside at the start: refused, or pushed out little by little: "report", "resolve" (default: "report")
    resolve_time:
        [s] by which they are out; statics: load factor; > 0 (default: 1)

    Amounts are numbers, or points [(time, value), ...] in between which they are linear. Returns an
    Effect for ``World.add``. Raises isochor.Error for keys that there are not; values are looked at when
    the effect is added.
    """
