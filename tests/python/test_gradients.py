"""Gradients of equilibria: what World.gradients of C++ knows is known here, with the numbers of differences."""

import functools
import re

import numpy as np
import pytest

import isochor as iso
from conftest import MESHES, SOURCE, sentence
from isochor import Output, Parameter

TIGHT = {"scheme": "statics", "threads": 1, "force_tolerance": 1e-13, "row_tolerance": 1e-13}
PUSHED, PUSH = (1, 1 / 3, 1 / 3), (1, 4, 6)
KNOBS = {
    "young": 1e4,
    "poisson": 0.45,
    "density": 1000.0,
    "gravity": -2.0,
    "clamp": 1.0,
    "cavity": 400.0,
    "spring": 900.0,
    "push": 1.0,
    "shape": 0.0,
    "stiffness": 1.0,
    "rope": 0.97,
}


def hollow_mesh():
    """3 x 3 x 3 cubes of tets without the one in the middle, whose sides are the surface "hollow"."""
    box = iso.box_mesh(divisions=(3, 3, 3))
    middle = box.points[box.cells].mean(axis=1)
    inside = ((middle > 1 / 3) & (middle < 2 / 3)).all(axis=1)
    faces = {}
    for cell in box.cells[inside]:
        for side in ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)):
            face = cell[list(side)]
            faces.setdefault(tuple(sorted(face)), []).append(face)
    hollow = [found[0] for found in faces.values() if len(found) == 1]
    return iso.Mesh(box.points, box.cells[~inside], surfaces={**box.surfaces, "hollow": hollow})


MESH = hollow_mesh()
X, Y, Z = np.array(MESH.points).T


def motion(x, y, z):
    return np.stack((0.3 * x + 0.1 * y * z, 0.2 * x**2 - 0.1 * z, 0.4 * z * x + 0.1 * y), axis=-1)


MOTION = motion(X, Y, Z)
TIP = int(np.argmin(((MESH.points - 1) ** 2).sum(axis=1)))
NEXT = int(np.argmin(((MESH.points - (1, 0, 1)) ** 2).sum(axis=1)))


class Hollow:
    """A block with a chamber, held, blown up, pulled by a cable, pushed and heavy: all depends on all."""

    def __init__(self, **knobs):
        k = self.knobs = {**KNOBS, **knobs}
        self.world = iso.World(gravity=(0, 0, k["gravity"]), **TIGHT)
        mesh = iso.Mesh(MESH.points + k["shape"] * MOTION, MESH.cells, surfaces=MESH.surfaces)
        rubber = iso.neo_hookean(young=k["young"] * k["stiffness"], poisson=k["poisson"], density=k["density"])
        self.body = self.world.add_body(mesh, rubber, element="tet4", name="block")
        self.rows = self.world.add(iso.volume(self.body))
        self.clamp = self.world.add(
            iso.dirichlet(self.body, surfaces="x0", displacement=(0, 0.02, 0.01), amount=k["clamp"], name="clamp")
        )
        self.air = self.world.add(iso.cavity(self.body, surfaces="hollow", amount=k["cavity"], name="air"))
        points = [(0.1, 0.5, 0.9), (0.5, 0.45, 0.85), (0.9, 0.5, 0.85)]
        self.rope = self.world.add(
            iso.cable(self.body, points=points, from_=(-0.2, 0.5, 1), amount=k["rope"], stiffness=k["spring"], name="rope")
        )
        pushed = PUSHED + k["shape"] * motion(*PUSHED)
        self.world.add_force_at(self.body, pushed, k["push"] * np.array(PUSH, float))
        self.world.advance(1)

    def rope_of(self, stiffness):
        return self.rope.description.with_keys(stiffness=stiffness)


def spread(x):
    """The sum of squares of distances from the first node, and its gradient."""
    off = 2 * (x - x[0])
    off[0] = -off.sum(axis=0)
    return 0.25 * (off[1:] ** 2).sum(), off


def outputs(made):
    """Every kind of output, by the name of the function that makes it."""
    weights = np.zeros((2, 3))
    weights[:, 2] = 1, -1
    return {
        "node": Output.node(made.body, TIP, (0.3, -0.2, 1)),
        "positions": Output.positions(made.body, [TIP, NEXT], weights),
        "material_point": Output.material_point(made.body, (0.9, 0.4, 0.8), (0, 1, 1)),
        "distance": Output.distance(made.body, [TIP, NEXT], [(1.1, 1, 1.2), (1, 0.1, 1)]),
        "gauge": Output.gauge(made.air, "volume"),
        "reaction": Output.reaction(made.clamp, (1, 0.5, -0.2), (0.1, 0.2, 0.3)),
        "elastic_energy": Output.elastic_energy(),
        "energy": Output.energy("potential"),
        "square": Output.square(made.body, [TIP, NEXT], weights, 0.2),
        "stress": Output.stress(made.body, 40, "von_mises"),
        "effect_force": Output.effect_force(made.rope, made.body, (1, 0.2, 0.5)),
        "of_positions": Output.of_positions(made.body, spread),
    }


def parameters(made):
    """Every kind of parameter, by the name of the function that makes it: its knob, and itself."""
    return {
        "amount_of": [("cavity", Parameter.amount_of(made.air)), ("clamp", made.clamp)],
        "force_at": [("push", Parameter.force_at(made.body, PUSHED, PUSH)), ("push", (made.body, PUSHED, PUSH))],
        "gravity": [("gravity", Parameter.gravity((0, 0, 1)))],
        "density": [("density", Parameter.density(made.body))],
        "material": [
            ("young", Parameter.material(made.body, "young")),
            (
                "poisson",
                Parameter.material(made.body, lambda v: iso.neo_hookean(young=KNOBS["young"], poisson=v), value=0.45),
            ),
        ],
        "stiffness": [("stiffness", Parameter.stiffness(made.body))],
        "cell_stiffness": [],  # not a number: in a test of its own
        "constant_of": [
            ("spring", Parameter.constant_of(made.rope, "stiffness")),
            ("spring", Parameter.constant_of(made.rope, made.rope_of, value=900)),
        ],
        "shape": [("shape", Parameter.shape(made.body, MOTION))],
        "curve_point": [("rope", Parameter.curve_point(made.rope, [(0, made.knobs["rope"])], 0))],
    }


@pytest.fixture(scope="module")
def hollow():
    return Hollow()


def values(**knobs):
    made = Hollow(**knobs)
    return made.world.gradients(list(outputs(made).values()), []).values


def difference(knob):
    h = 2e-3 * (abs(KNOBS[knob]) or 0.1)
    there = [values(**{knob: KNOBS[knob] + step * h}) for step in (-2, -1, 1, 2)]
    return np.array((1, -8, 8, -1)) @ there / (12 * h)


def test_every_output_by_every_parameter_is_what_differences_say(hollow):
    names = list(outputs(hollow))
    asked = [one for several in parameters(hollow).values() for one in several]
    query = list(outputs(hollow).values()), [parameter for _, parameter in asked]
    before = hollow.world.state_hash
    adjoint = hollow.world.gradients(*query, mode="adjoint")
    tangent = hollow.world.gradients(*query, mode="tangent")
    assert hollow.world.state_hash == before
    assert adjoint.adjoint and not tangent.adjoint
    assert adjoint.regular and adjoint.note == "" and adjoint.undecided == ()
    assert np.array_equal(adjoint.values, tangent.values)
    assert adjoint.jacobian.shape == (len(names), len(asked))
    size = np.array([abs(KNOBS[knob]) or 0.1 for knob, _ in asked])
    scale = np.abs(adjoint.jacobian * size).max(axis=1)[:, None] / size
    assert (np.abs(adjoint.jacobian - tangent.jacobian) <= 1e-10 * scale).all()
    judges = {knob: difference(knob) for knob in dict(asked)}
    wanted = np.column_stack([judges[knob] for knob, _ in asked])
    off = np.abs(adjoint.jacobian - wanted) / scale
    # Points inside of cells stay where they are in the mesh, and the judge looks them up anew.
    off[names.index("material_point"), [knob == "shape" for knob, _ in asked]] = 0
    assert off.max() <= 1e-6, (names[off.max(axis=1).argmax()], asked[off.max(axis=0).argmax()][0], off.max())


def test_values_are_those_that_the_world_tells(hollow):
    x, found = hollow.body.positions, dict(zip(outputs(hollow), values()))
    assert found["node"] == pytest.approx(x[TIP] @ (0.3, -0.2, 1), rel=1e-12)
    assert found["positions"] == pytest.approx(x[TIP, 2] - x[NEXT, 2], rel=1e-9)
    assert found["gauge"] == pytest.approx(hollow.air.volume, rel=1e-12)
    force, moment = hollow.clamp.reaction.force, hollow.clamp.reaction.moment
    assert found["reaction"] == pytest.approx(force @ (1, 0.5, -0.2) + moment @ (0.1, 0.2, 0.3), rel=1e-9)
    energies = hollow.world.energies()
    assert found["elastic_energy"] == pytest.approx(energies.elastic, rel=1e-12)
    potential = energies.elastic + energies.gravity + energies.loads + energies.pressures
    assert found["energy"] == pytest.approx(potential, rel=1e-12)
    assert found["stress"] == pytest.approx(hollow.body.fields().cell_von_mises[40], rel=1e-12)
    assert found["of_positions"] == pytest.approx(((x - x[0]) ** 2).sum(), rel=1e-12)


def test_other_gauges_have_gradients_too(hollow):
    gauges = [(hollow.air, "pressure"), (hollow.rope, "tension"), (hollow.rope, "length")]
    told = hollow.world.gradients([Output.gauge(*gauge) for gauge in gauges], [hollow.air])
    assert told.values == pytest.approx([effect.gauges[quantity] for effect, quantity in gauges], rel=1e-12)
    assert told.jacobian[0, 0] == pytest.approx(1) and told.jacobian[1, 0] != 0 and told.jacobian[2, 0] != 0


def enumerated(struct, header):
    """Names of the functions that make a kind, in C++."""
    body = re.search(rf"struct ISOCHOR_API {struct} \{{(.*?)^\}};", header, re.S | re.M).group(1)
    kinds = re.search(r"enum class Kind[^{]*\{([^}]*)\}", body).group(1)
    return set(re.findall(rf"static {struct} (\w+)\(", body)), kinds


@pytest.mark.parametrize("struct, ours", [("Output", Output), ("Parameter", Parameter)])
def test_python_and_c_have_every_kind_that_cpp_has(struct, ours, hollow):
    include = SOURCE / "include" / "isochor"
    names, kinds = enumerated(struct, (include / "gradients.h").read_text(encoding="utf-8"))
    tested = outputs(hollow) if struct == "Output" else parameters(hollow)
    # Velocities are those of a way through time.
    of_ways = set() if struct == "Output" else {"initial_velocity"}
    assert names == {name for name, made in vars(ours).items() if isinstance(made, staticmethod)}
    assert names == set(tested) | of_ways
    in_c = re.findall(rf"\bISO_{struct.upper()}_(\w+) = ", (include / "isochor.h").read_text(encoding="utf-8"))
    assert {name.lower() for name in in_c} == names - {"node"}  # one of positions
    # Kinds are made by functions, points and nodes by those of a kind that has others.
    assert len(kinds.split(",")) == len(names) - (3 if struct == "Output" else 0)


def test_cells_and_several_shapes_are_arrays(hollow):
    cells = len(hollow.body.mesh.cells)
    out = [Output.node(hollow.body, TIP, (0, 0, 1)), Output.elastic_energy()]
    motions = np.stack((MOTION, -2 * MOTION, np.ones_like(MOTION)))
    asked = [
        hollow.air,
        Parameter.cell_stiffness(hollow.body),
        Parameter.shape(hollow.body, motions),
        Parameter.shape(hollow.body, MOTION),
        Parameter.stiffness(hollow.body),
    ]
    told = hollow.world.gradients(out, asked)
    assert [one.shape for one in told.by] == [(2,), (2, cells), (2, 3), (2,), (2,)]
    assert told.jacobian.shape == (2, 1 + cells + 3 + 1 + 1) and told.adjoint
    assert np.array_equal(told.by[1], told.jacobian[:, 1 : 1 + cells])
    assert np.shares_memory(told.by[1], told.jacobian) and not told.jacobian.flags.writeable
    assert np.allclose(told.by[1].sum(axis=1), told.by[4], rtol=1e-10)
    assert np.array_equal(told.by[2][:, 0], told.by[3]) and np.allclose(told.by[2][:, 1], -2 * told.by[3], rtol=1e-6)
    nothing = hollow.world.gradients([], [])
    assert nothing.values.shape == (0,) and nothing.jacobian.shape == (0, 0) and nothing.by == ()
    assert hollow.world.gradients(out, []).jacobian.shape == (2, 0)


def test_all_nodes_and_one_vector_for_all(hollow):
    n = len(hollow.body.rest_positions)
    out = [
        Output.positions(hollow.body, None, np.full((n, 3), 1 / n)),
        Output.positions(hollow.body, range(n), np.full(3, 1 / n)),
        Output.distance(hollow.body, None, hollow.body.rest_positions),
    ]
    told = hollow.world.gradients(out, [hollow.air])
    assert told.values[0] == told.values[1] == pytest.approx(hollow.body.positions.mean(axis=0).sum())
    assert told.jacobian[0] == told.jacobian[1]
    assert told.values[2] == pytest.approx(0.5 * (hollow.body.displacements**2).sum())


def test_a_thick_tube_has_the_sensitivities_of_the_closed_form():
    """Partial derivatives at inner stretch 1.25, per unit of length: docs/reference.md."""
    pressure, du, dV = 0.275711536803412, (0.733494721821, -0.20223295699), (9.84415175655, -2.71414620933)
    world = iso.World(**TIGHT)
    mesh = iso.read_mesh(MESHES / "thick_tube_1_hex.msh")
    rubber = iso.neo_hookean(young=3, poisson=0.5)  # mu = 1
    tube = world.add_body(mesh, rubber, element="hex8")
    world.add(iso.volume(tube, space="element"))
    for surface, direction in (("symmetry_x", (1, 0, 0)), ("symmetry_y", (0, 1, 0)), ("faces_z", (0, 0, 1))):
        world.add(iso.dirichlet(tube, surfaces=surface, directions=[direction]))
    air = world.add(iso.cavity(tube, surfaces="inner", amount=pressure))
    world.advance(1)
    outer = int(np.argmin(((tube.rest_positions - (2, 0, 0)) ** 2).sum(axis=1)))
    told = world.gradients(
        [Output.node(tube, outer, (1, 0, 0)), Output.gauge(air, "volume")], [air, Parameter.material(tube, "young")]
    )
    jacobian = told.jacobian * (1, 3)  # by mu
    quarter = tube.rest_positions[:, 2].max() / 4
    assert jacobian[0] == pytest.approx(du, rel=0.05)
    assert jacobian[1] / quarter == pytest.approx(dV, rel=0.05)
    # Only the pressure over the modulus counts.
    assert (pressure * jacobian[:, 0] + jacobian[:, 1]) / jacobian[:, 1] == pytest.approx(0, abs=1e-8)


def block(gap=0.001, down=0.05, friction=0.0, scheme="statics", **solving):
    world = iso.World(**{**TIGHT, "scheme": scheme, **solving})
    body = world.add_body(iso.box_mesh(divisions=(2, 2, 2)), iso.neo_hookean(young=1e4, poisson=0.4), element="tet4")
    top = world.add(iso.dirichlet(body, surfaces="z1", displacement=(0, 0, -1), amount=down, name="top"))
    plane = {"shape": "plane", "position": (0, 0, -gap), "axis": (0, 0, 1)}
    world.add(iso.contact(body, surfaces="z0", obstacle=plane, friction=friction, name="floor"))
    return world, body, top


def test_one_sided_derivatives_say_so():
    # A body that is carried and not strained has forces of rounding alone.
    world, body, top = block(gap=0.05 + 1e-8, force_tolerance=1e-10)
    world.advance(1)
    told = world.gradients([Output.reaction(top, (0, 0, 1))], [top])
    assert not told.regular and told.undecided == ("floor",) and "about to touch" in told.note
    world, body, top = block(friction=0.5)
    world.advance(1)
    told = world.gradients([Output.reaction(top, (0, 0, 1))], [top])
    assert not told.regular and "friction" in told.note and not told.adjoint
    back = world.gradients([Output.reaction(top, (0, 0, 1))], [top], mode="adjoint")
    assert back.adjoint and back.jacobian[0, 0] == pytest.approx(told.jacobian[0, 0], rel=1e-8)


def test_regions_and_keys_that_were_not_said_are_found():
    mesh = iso.box_mesh(divisions=(2, 1, 1))
    regions = (mesh.points[mesh.cells].mean(axis=1)[:, 0] > 0.5).astype(int)
    world = iso.World(gravity=(0, 0, -9.81), **TIGHT)
    two = iso.Mesh(mesh.points, mesh.cells, surfaces=mesh.surfaces, cell_region=regions, regions=["a", "b"])
    soft, hard = iso.neo_hookean(young=1e5, region="a"), iso.mooney_rivlin(c1=1e5, c2=2e4, poisson=0.3)
    body = world.add_body(two, [soft, hard], element="tet4", name="two")
    world.add(iso.dirichlet(body, surfaces="x0"))
    world.advance(1)
    out = [Output.node(body, int(np.argmax(body.rest_positions[:, 0])), (0, 0, 1))]

    def by(key, region):
        return world.gradients(out, [Parameter.material(body, key, region=region, step=1e-4)]).jacobian[0, 0]

    assert by("young", "a") > 0 and by("c2", "b") > 0 and by("poisson", "a") != 0
    with pytest.raises(iso.Error) as error:
        Parameter.material(body, "young")
    assert 'regions "a" and all others; name the region' in sentence(error)


@functools.lru_cache(maxsize=None)
def elsewhere():
    return Hollow()


def strange(made):
    """Queries by what is wrong with them, and words of the sentence."""
    body, air, world = made.body, made.air, made.world
    other = elsewhere()
    n = len(MESH.points)
    tip = Output.node(body, TIP, (0, 0, 1))
    ask = lambda outputs, parameters, **how: lambda: world.gradients(outputs, parameters, **how)
    young = lambda v: iso.neo_hookean(young=v, poisson=0.45)
    return {
        "outputs": (ask(tip, [air]), "outputs is a value of type Output; give a list"),
        "parameters": (ask([tip], air), "parameters is a value of type LiveEffect; give a list"),
        "output": (ask([tip, "tip"], [air]), "outputs[1]: a value of type str; give an isochor.Output"),
        "parameter": (ask([tip], ["young"]), "parameters[0]: a value of type str; give an isochor.Parameter"),
        "mode": (ask([tip], [air], mode="forward"), 'mode is "forward"; give "automatic", "adjoint" or "tangent"'),
        "cells by tangents": (ask([tip], [Parameter.cell_stiffness(body)], mode="tangent"), "adjoint"),
        "not a body": (lambda: Output.node("block", 0, (0, 0, 1)), "Output.node: a value of type str; give a body"),
        "not an effect": (lambda: Output.gauge(body, "volume"), "Output.gauge: a value of type Body; give an effect"),
        "other world's body": (ask([Output.node(other.body, 0, (0, 0, 1))], [air]), "outputs[0]: .*another world"),
        "other world's effect": (ask([tip], [air, other.air]), "parameters[1]: .*another world"),
        "node": (ask([Output.node(body, n, (0, 0, 1))], []), f"outputs[0]: nodes: entry 0 is {n}; give numbers from 0"),
        "negative node": (ask([Output.positions(body, [-1], [(0, 0, 1)])], []), "nodes: entry 0 is -1"),
        "nodes": (ask([Output.positions(body, [0.5], [(0, 0, 1)])], []), "nodes: an array of type float64"),
        "lengths": (ask([Output.positions(body, [0, 1], [(0, 0, 1)] * 3)], []), "2 nodes and 3 vectors"),
        "all nodes": (ask([Output.positions(body, None, [(0, 0, 1)] * 3)], []), f"{n} nodes and 3 vectors"),
        "no nodes": (ask([Output.positions(body, [], np.zeros((0, 3)))], []), "0 nodes"),
        "weights": (ask([Output.positions(body, [0], [(0, 1)])], []), "weights: an array of shape (1, 2)"),
        "nan": (ask([tip, Output.distance(body, [0], [(0, 0, np.nan)])], []), "outputs[1]: targets: row 0 holds nan"),
        "nan of a force": (
            ask([Output.reaction(made.clamp, (0, np.nan, 0))], []),
            "outputs[0]: force: entry 1 holds nan",
        ),
        "point": (ask([Output.material_point(body, (5, 5, 5), (0, 0, 1))], []), "outputs[0]: .*(5, 5, 5)"),
        "gauge": (
            ask([Output.gauge(air, "color")], []),
            'outputs[0]: gauge "color" of effect "air": there is no such gauge',
        ),
        "energy": (ask([Output.energy("heat")], []), 'outputs[0]: there is no energy "heat"'),
        "cell": (ask([Output.stress(body, 10**6, "xx")], []), "outputs[0]: .*there is no cell 1000000"),
        "measure": (ask([Output.stress(body, 0, "tresca")], []), "outputs[0]: .*none of that name"),
        "target": (lambda: Output.square(body, [0], [(0, 0, 1)], "far"), "Output.square: target"),
        "force of a support": (
            ask([Output.effect_force(made.clamp, body, (1, 0, 0))], []),
            "outputs[0]: .*take the reaction of a support",
        ),
        "function of positions": (lambda: Output.of_positions(body, 5), "a value of type int; give a function"),
        "gradient of a function": (
            ask([Output.of_positions(body, lambda x: (1.0, x[:3]))], []),
            "outputs[0]: .*its gradient has 3 vectors",
        ),
        "curve": (ask([tip], [Parameter.curve_point(made.rope, [(0, 0.5)], 0)]), "parameters[0]: .*the amount is 0.97"),
        "point of a curve": (
            ask([tip], [Parameter.curve_point(made.rope, [(0, 0.97)], 3)]),
            "parameters[0]: .*there is no point 3",
        ),
        "reaction": (ask([Output.reaction(air, (1, 0, 0))], []), 'outputs[0]: effect "air" has no reaction'),
        "no amount": (ask([tip], [made.rows]), 'parameters[0]: effect "volume" has no amount'),
        "region": (ask([tip], [Parameter.density(body, "steel")]), "parameters[0]: .*steel"),
        "gravity": (ask([tip], [Parameter.gravity((0, 0))]), "parameters[0]: direction: an array of shape (2,)"),
        "motion": (ask([tip], [Parameter.shape(body, MOTION[:5])]), "parameters[0]: shape: motion has 5 vectors"),
        "motion of a shape": (ask([tip], [Parameter.shape(body, MOTION[0])]), "motion: an array of shape (3,)"),
        "no motion": (ask([tip], [Parameter.shape(body, 0 * MOTION)]), "zero"),
        "key": (lambda: Parameter.material(body, "yuong"), 'neo_hookean: unknown key "yuong", did you mean "young"?'),
        "key without a number": (
            lambda: Parameter.material(body, "bulk_choice"),
            '"bulk_choice" is a word; name one that has a number',
        ),
        "key that is not given": (
            ask([tip], [Parameter.material(body, "mu")]),
            'parameters[0]: key "mu" is not among those that are given',
        ),
        "density": (ask([tip], [Parameter.material(body, "density")]), "parameters[0]: .*nothing depends on it"),
        "nothing depends on it": (
            ask([tip], [Parameter.material(body, lambda v: young(1e4), value=1e4)]),
            "parameters[0]: .*nothing depends on it: at 10000 and at ",
        ),
        "key of an effect": (lambda: Parameter.constant_of(air, "presure"), 'cavity: unknown key "presure"'),
        "no value": (
            lambda: Parameter.material(body, young),
            "value is None; give the number that the scene was made with",
        ),
        "another value": (
            ask([tip], [Parameter.material(body, young, value=2e4)]),
            "parameters[0]: .*not what the scene has",
        ),
        "not a material": (
            ask([tip], [Parameter.material(body, lambda v: v, value=1e4)]),
            "parameters[0]: .*a value of type float; it is to return a material",
        ),
        "not a function": (lambda: Parameter.material(body, 5), "a value of type int; give a key or a function"),
        "refused by the law": (
            ask([tip], [Parameter.material(body, lambda v: iso.neo_hookean(young=1e4, poisson=0.45 + v), value=1)]),
            "parameters[0]: .*poisson",
        ),
        "step": (ask([tip], [Parameter.amount_of(air, step=-1)]), "parameters[0]: step = -1"),
    }


@pytest.mark.parametrize("case", strange(elsewhere()))
def test_bad_queries_get_one_sentence_and_nothing_is_lost(case, hollow):
    before = hollow.world.state_hash
    call, words = strange(hollow)[case]
    with pytest.raises(iso.Error) as error:
        call()
    assert re.search(".*".join(map(re.escape, words.split(".*"))), sentence(error)), sentence(error)
    assert hollow.world.state_hash == before


def test_what_is_no_equilibrium_is_refused():
    world, body, top = block(gap=1)
    tip = [Output.node(body, 0, (0, 0, 1))]
    world.gravity = (0, 0, -9.81)
    world.step(1e-3)
    moved = body.positions * (1, 1, 1.01)
    world.set_positions(body, moved)
    with pytest.raises(iso.Error, match="gradients: the state is no equilibrium.*advance in statics"):
        world.gradients(tip, [top])
    world, body, top = block(scheme="implicit_euler")
    with pytest.raises(iso.Error, match="the scheme has inertia"):
        world.gradients([Output.node(body, 0, (0, 0, 1))], [top])


def test_what_a_function_raises_is_raised(hollow):
    tip = [Output.node(hollow.body, TIP, (0, 0, 1))]

    def fails(value):
        raise LookupError(f"no law for {value}")

    def asks(value):
        hollow.world.advance(1)

    with pytest.raises(LookupError, match="no law for 10000.0"):
        hollow.world.gradients(tip, [Parameter.material(hollow.body, fails, value=1e4)])
    with pytest.raises(LookupError, match="no law for"):
        hollow.world.gradients([Output.of_positions(hollow.body, lambda x: fails(len(x)))], [hollow.air])
    with pytest.raises(iso.Error, match="callback"):
        hollow.world.gradients(tip, [Parameter.constant_of(hollow.air, asks, value=400)])
    # A function may end: Poisson's ratios do at a half.
    assert hollow.world.gradients(tip, [hollow.air]).jacobian[0, 0] != 0


def test_handles_of_a_clone_and_of_its_original_are_good_in_both(hollow):
    clone = hollow.world.clone()
    asked = [Output.node(hollow.body, TIP, (0, 0, 1))], [hollow.air, Parameter.material(hollow.body, "young")]
    assert np.array_equal(clone.gradients(*asked).jacobian, hollow.world.gradients(*asked).jacobian)


STEPS = np.array((0.02, 0.03, 0.02))


def swing(**knobs):
    k = {"young": 2e5, "speed": 0.3, "pull": 1.0, **knobs}
    world = iso.World(
        scheme="generalized_alpha", gravity=(0, 0, -2.0), threads=1, force_tolerance=1e-13, row_tolerance=1e-13
    )
    body = world.add_body(iso.box_mesh(divisions=(2, 1, 1)), iso.neo_hookean(young=k["young"], poisson=0.45))
    world.add(iso.volume(body))
    world.add(iso.dirichlet(body, surfaces="x0"))
    load = world.add(iso.traction(body, surface="x1", traction=(0, 100, 50), amount=k["pull"]))
    x = body.rest_positions
    body.velocities = k["speed"] * (x * (0, 1, 1))
    return world, body, load


def seen(body):
    tip = body.rest_positions.shape[0] - 1
    near = Output.distance(body, [tip], [(1.1, 1.2, 0.9)])
    return [(3, Output.node(body, tip, (0, 1, 1))), [(1, near), (3, near)]]


def ask_swing(mode, kept=0, knobs=None, parameters=True):
    world, body, load = swing(**(knobs or {}))
    x = body.rest_positions
    asked = [
        Parameter.material(body, "young"),
        Parameter.initial_velocity(body, x * (0, 1, 1)),
        load,
        Parameter.initial_velocity(body, np.stack((x * (0, 1, 1), 2 * x * (0, 1, 1)))),
    ]
    told = world.trajectory_gradients(STEPS, seen(body), asked if parameters else [], mode=mode, kept_states=kept)
    assert world.time == pytest.approx(STEPS.sum())
    return told


def test_ways_through_time_are_what_differences_say():
    adjoint, tangent = ask_swing("adjoint"), ask_swing("tangent", kept=1)
    again = ask_swing("adjoint", kept=1)
    assert np.array_equal(again.jacobian, adjoint.jacobian)
    assert (adjoint.kept_states, adjoint.steps_again, tangent.kept_states) == (2, 0, 0)
    assert again.kept_states == 1 and again.steps_again == 0 and again.state_bytes > 0
    assert adjoint.adjoint and not tangent.adjoint and adjoint.regular
    assert [one.shape for one in adjoint.by] == [(2,), (2,), (2,), (2, 2)]
    assert np.allclose(adjoint.jacobian, tangent.jacobian, rtol=1e-9, atol=1e-12)
    assert np.allclose(adjoint.by[3][:, 1], 2 * adjoint.by[1], rtol=1e-12)
    for column, (knob, at) in enumerate((("young", 2e5), ("speed", 0.3), ("pull", 1.0))):
        h = 2e-3 * at
        sides = [ask_swing("automatic", knobs={knob: at + s * h}, parameters=False).values for s in (-2, -1, 1, 2)]
        wanted = (sides[0] - 8 * sides[1] + 8 * sides[2] - sides[3]) / (12 * h)
        assert adjoint.by[column] == pytest.approx(wanted, rel=1e-5)


def test_ways_that_are_refused():
    world, body, load = swing()
    before = world.state_hash
    out = seen(body)
    for steps, outputs, more, words in (
        ([], out, {}, "steps is empty"),
        ([0.01, -1], out, {}, "steps[1] = -1"),
        (0.01, out, {}, "steps is a value of type float"),
        ([0.01], [(5, out[0][1])], {}, "outputs[0]: step = 5"),
        ([0.01], [(1.5, out[0][1])], {}, "outputs[0]: step = 1.5"),
        ([0.01], [out[0][1]], {}, "outputs[0]: the output is a value of type Output"),
        ([0.01], [(1, "tip")], {}, "outputs[0]: a value of type str"),
        ([0.01], [(0, Output.elastic_energy())], {}, "outputs[0]: all but functions of positions"),
        ([0.01], [(1, out[0][1])], {"mode": "best"}, 'mode is "best"'),
        ([0.01], [(1, out[0][1])], {"kept_states": -1}, "kept_states = -1"),
    ):
        with pytest.raises(iso.Error) as caught:
            world.trajectory_gradients(steps, outputs, [load], **more)
        assert words in sentence(caught)
        assert world.state_hash == before
