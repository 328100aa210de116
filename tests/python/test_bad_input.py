"""Bad input: one sentence, and nothing is lost."""

import resource

import numpy as np
import pytest

import isochor as iso
from conftest import Block, sentence

NAN = float("nan")


def strange(made):
    """Calls by what is wrong with them, and words of the sentence."""
    w, b = made.world, made.body
    other = Block()
    return {
        "shape": (lambda: w.set_positions(b, np.zeros((27, 2))), "an array of shape (27, 2); give one of shape (n, 3)"),
        "length": (lambda: w.set_positions(b, np.zeros((3, 3))), "3 positions for the 27 nodes"),
        "dtype": (lambda: w.set_velocities(b, np.zeros((27, 3), complex)), "an array of type complex128"),
        "bool": (lambda: w.set_velocities(b, np.zeros((27, 3), bool)), "an array of type bool"),
        "objects": (lambda: w.set_forces(b, [[None] * 3] * 27), "an array of type object"),
        "nan": (lambda: w.set_positions(b, np.full((27, 3), NAN)), "row 0 holds nan"),
        "inf": (lambda: w.set_forces(b, np.full((27, 3), np.inf)), "row 0 holds inf"),
        "two numbers": (lambda: w.add_force(b, 0, (1, 2)), "force: an array of shape (2,); give three numbers"),
        "node": (lambda: w.add_force(b, 99, (1, 2, 3)), "99"),
        "outside": (lambda: w.add_force_at(b, (5, 5, 5), (1, 2, 3)), "add_force_at"),
        "gravity": (lambda: setattr(w, "gravity", (0, NAN, 0)), "gravity: entry 1 holds nan"),
        "amount": (lambda: setattr(made.clamp, "amount", NAN), "finite"),
        "amount text": (lambda: setattr(made.clamp, "amount", "much"), "amount is 'much'; give a number"),
        "no amount": (lambda: setattr(made.volume, "amount", 1.0), "has no amount"),
        "step": (lambda: w.advance(-1), "advance"),
        "step nan": (lambda: w.step(NAN), "step"),
        "step text": (lambda: w.advance("soon"), "advance: h is 'soon'; give a number"),
        "other world's body": (lambda: w.positions(other.body), "another world"),
        "other world's effect": (lambda: w.add(iso.volume(other.body)), "another world"),
        "not a body": (lambda: w.positions("block"), "a value of type str; give a body"),
        "not a mesh": (lambda: w.add_body("finger.msh", iso.neo_hookean(young=1)), "the mesh is of type str"),
        "not a material": (lambda: w.add_body(iso.box_mesh(), "rubber"), "materials must be"),
        "not an effect": (lambda: w.add("volume"), "a value of type str; give an effect"),
        "name taken": (lambda: w.add(iso.volume(b, name="clamp")), 'has the name "clamp" already'),
        "body's name taken": (
            lambda: w.add_body(iso.box_mesh(), iso.neo_hookean(young=1e4), name="block"),
            'has the name "block" already',
        ),
        "poisson": (lambda: w.add_body(iso.box_mesh(), iso.neo_hookean(young=1e4, poisson=0.6)), "poisson"),
        "no stiffness": (lambda: w.add_body(iso.box_mesh(), iso.neo_hookean(poisson=0.3)), "neo_hookean"),
        "element": (
            lambda: w.add_body(iso.box_mesh(), iso.neo_hookean(young=1e4), element="tet5"),
            "tet5",
        ),
        "unknown key of a body": (
            lambda: w.add_body(iso.box_mesh(), iso.neo_hookean(young=1e4), guard_stifness=1),
            "guard_stifness",
        ),
        "unknown key of a live effect": (lambda: setattr(made.clamp, "frction", 1), 'unknown key "frction"'),
        "read only": (lambda: setattr(made.clamp, "reaction", 1), "reaction is read, not set"),
        "value of a live effect": (lambda: setattr(made.clamp, "treatment", "soft"), "treatment"),
        "orientation": (lambda: w.orientation(b, surfaces="nowhere"), "nowhere"),
        "load": (lambda: w.load(b"state"), "load"),
        "load text": (lambda: w.load("state"), "give the bytes"),
        "follow": (lambda: w.follow(0.1), "continuation"),
        "derivatives": (lambda: w.derivatives("air"), "give effects, or tuples"),
        "clone": (lambda: w.clone(threads=-1), "threads"),
    }


@pytest.mark.parametrize("case", strange(Block()))
def test_bad_calls_get_one_sentence_and_nothing_is_lost(case):
    made = Block()
    made.world.advance(0.01)
    before = made.world.state_hash
    call, words = strange(made)[case]
    with pytest.raises(iso.Error) as error:
        call()
    assert words in sentence(error)
    assert made.world.state_hash == before and made.world.effects == (made.volume, made.clamp)
    assert made.world.advance(0.01).converged


DESCRIPTIONS = {
    "unknown key": (lambda: iso.cavity(surfces="x"), 'cavity: unknown key "surfces", did you mean "surfaces"?'),
    "unknown constant": (lambda: iso.neo_hookean(c1=1), 'neo_hookean: unknown key "c1"'),
    "positional": (lambda: iso.neo_hookean(1e5), "neo_hookean: 1 positional arguments; give constants by name"),
    "two positional": (lambda: iso.cavity(None, "chamber"), "cavity: 2 positional arguments"),
    "nan": (lambda: iso.cavity(surfaces="x", ambient=NAN), "cavity: ambient: nan"),
    "array with nan": (lambda: iso.cable(points=np.array([[0, 0, NAN]])), "cable: points: entry [0, 2] is nan"),
    "object": (lambda: iso.cavity(surfaces=object()), "cavity: surfaces: a value of type object"),
    "option": (lambda: iso.World(metod="x"), "metod"),
    "scheme": (lambda: iso.World(scheme="explicit"), "explicit"),
    "gravity": (lambda: iso.World(gravity=(0, 0)), "gravity"),
    "threads": (lambda: iso.World(threads=-1), "threads"),
    "tolerance": (lambda: iso.World(force_tolerance=-1.0), "tolerances must be positive"),
}


@pytest.mark.parametrize("case", DESCRIPTIONS)
def test_bad_descriptions_get_one_sentence(case):
    call, words = DESCRIPTIONS[case]
    with pytest.raises(iso.Error) as error:
        call()
    assert words in sentence(error)


def test_layouts_of_arrays_do_not_matter(block):
    given = np.arange(81.0).reshape(27, 3) * 1e-6 + block.body.rest_positions
    for values in (given, np.asfortranarray(given), np.repeat(given, 2, axis=0)[::2], given[::-1][::-1], given.tolist()):
        block.world.set_positions(block.body, np.zeros((27, 3)))
        block.world.set_positions(block.body, values)
        assert np.array_equal(block.body.positions, given)


def test_a_gauge_or_key_that_there_is_not_names_those_that_are(finger):
    with pytest.raises(AttributeError) as error:
        finger.air.presure
    assert "gauges: pressure, volume" in str(error.value)


def test_memory_that_runs_out_is_a_memory_error():
    with open("/proc/self/statm") as f:
        in_use = int(f.read().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (in_use + 64_000_000, hard))
    try:
        with pytest.raises(MemoryError, match=r"box mesh of 200 x 200 x 200 divisions.* take at least .* are free"):
            iso.box_mesh(divisions=(200, 200, 200), cell_type="hex8")
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    assert iso.box_mesh(divisions=(1, 1, 1)).cells.shape == (6, 4)
