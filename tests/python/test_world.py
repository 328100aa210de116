"""Worlds: what is in them, steps, what they tell, and the C++ engine's bits."""

import math
import os
import re
import subprocess

import numpy as np
import pytest

import isochor as iso
from conftest import MESHES, SOURCE, Block, Finger, sentence


def test_the_example_of_the_readme_reads_as_it_says():
    world = iso.World(gravity=(0, -9.81, 0))
    mesh = iso.read_mesh(MESHES / "finger_small.msh")
    finger = world.add_body(mesh, iso.neo_hookean(young=100e3, poisson=0.5, density=1070))
    world.add(iso.volume(finger))
    world.add(iso.dirichlet(finger, surfaces="clamped"))
    air = world.add(iso.cavity(finger, surfaces="chamber"))
    for k in range(3):
        air.amount = 100.0 * k
        report = world.advance(1 / 60)
        x = world.positions(finger)
    assert report.converged and report.iterations > 0 and x.shape == (485, 3)
    assert air.amount == 200.0 and air.pressure == pytest.approx(200.0)
    assert world.time == pytest.approx(3 / 60)
    assert "implicit" not in world.method and world.method


def loop_of_cpp():
    """State hash after each ten frames, by the C++ program that does what inflate.py does."""
    program = os.environ.get("ISOCHOR_FINGER_LOOP")
    if program is None:
        pytest.fail("ISOCHOR_FINGER_LOOP names no program: run the tests by ctest")
    done = subprocess.run([program, MESHES / "finger_small.msh", "20"], capture_output=True, text=True, check=True)
    return [int(h, 16) for h in re.findall(r"^state ([0-9a-f]{16})$", done.stdout, re.M)]


def test_the_bits_are_those_of_the_cpp_example():
    made = Finger(threads=0)
    hashes = []
    for frame in range(1, 21):
        made.air.amount = 100.0 * frame
        made.world.advance(1 / 60)
        hashes.append(made.world.state_hash)
    expected = loop_of_cpp()
    assert len(expected) == 20 and hashes == expected


def test_a_report_tells_what_a_step_did(block):
    report = block.world.advance(0.01)
    assert report.status == "converged" and report.reason == "" and report.substeps >= 1
    assert report.time == block.world.time == pytest.approx(0.01)
    assert report.compile_work == "structure" and report.compile_seconds > 0
    assert set(report.seconds) == {"analyze", "evaluate", "gather", "factor", "solve", "line_search", "total"}
    assert report.force_residual < 1e-6 and report.min_J > 0
    assert block.world.advance(0.01).compile_work == "nothing"


def test_free_fall_is_free_fall():
    world = iso.World(gravity=(0, 0, -10), threads=1, scheme="implicit_midpoint")
    body = world.add_body(iso.box_mesh(), iso.neo_hookean(young=1e5, poisson=0.3))
    for _ in range(10):
        world.advance(0.01)
    assert np.allclose(body.displacements, (0, 0, -0.5 * 10 * 0.1**2), atol=1e-9)
    linear, angular = world.momentum()
    mass = body.measures().mass
    assert mass == pytest.approx(1000.0) and np.allclose(linear, (0, 0, -10 * 0.1 * mass))
    energies = world.energies()
    assert energies.kinetic == pytest.approx(0.5 * mass * 1.0, rel=1e-6)
    assert energies.kinetic + energies.gravity == pytest.approx(0, abs=1e-6 * energies.kinetic)
    assert energies.total == pytest.approx(energies.kinetic + energies.potential)


def test_measures_and_fields_have_their_shapes(block):
    block.world.advance(0.01)
    n, m = len(block.body.mesh.points), len(block.body.mesh.cells)
    measures = block.body.measures()
    assert measures.rest_volume == pytest.approx(0.02**3) and abs(measures.volume_change) < 1e-6
    assert measures.center_of_mass.shape == (3,) and [r.name for r in measures.regions] == ["body"]
    fields = block.body.fields()
    assert fields.node_stress.shape == (n, 6) and fields.cell_stress.shape == (m, 6)
    assert fields.cell_J.shape == fields.cell_von_mises.shape == (m,) and fields.node_contact_pressure is None
    weight = measures.mass * 9.81
    statics = Block(scheme="statics")
    statics.world.advance(1)
    assert statics.clamp.reaction.force[2] == pytest.approx(weight, rel=1e-6)
    size = block.world.size()
    assert size.nodes == n and size.matrix_size > 0


def test_tet10_meshes_are_those_of_the_engine():
    world = iso.World(threads=1)
    body = world.add_body(iso.box_mesh(), iso.neo_hookean(young=1e4, poisson=0.3), element="tet10")
    assert body.mesh.cell_type == "tet10" and world.positions(body).shape == (27, 3)
    assert body.rest_positions is body.mesh.points or np.array_equal(body.rest_positions, body.mesh.points)


def test_materials_by_region():
    world = iso.World(threads=1)
    mesh = iso.read_mesh(MESHES / "finger_small.msh")
    soft = iso.neo_hookean(young=1e5, poisson=0.5, region="body")
    stiff = iso.neo_hookean(young=3e6, poisson=0.5, region="limiting_layer")
    body = world.add_body(mesh, [soft, stiff])
    assert [m.region for m in body.materials] == ["body", "limiting_layer"] and body.materials[1] == stiff


def test_names_are_found_and_find():
    world = iso.World(threads=1)
    mesh = iso.box_mesh()
    one = world.add_body(mesh, iso.neo_hookean(young=1e4, poisson=0.3))
    two = world.add_body(mesh, iso.neo_hookean(young=1e4, poisson=0.3))
    assert (one.name, two.name) == ("body", "body 2") and world["body 2"] is two
    held = [world.add(iso.dirichlet(b, surfaces="z0")) for b in (one, two)]
    assert [e.name for e in held] == ["dirichlet", "dirichlet 2"]
    assert world.bodies == (one, two) and world.effects == tuple(held)
    with pytest.raises(KeyError, match="there are:"):
        world["nobody"]


def test_amounts_over_time():
    made = Block(scheme="statics", gravity=(0, 0, 0))
    pull = made.world.add(iso.traction(made.body, surface="z0", traction=(0, 0, -50), amount=[(0, 0), (1, 2)]))
    made.world.advance(1)
    assert made.clamp.reaction.force[2] == pytest.approx(50 * 2 * 0.02**2, rel=1e-6)
    pull.amount = 1
    made.world.advance(1)
    assert made.clamp.reaction.force[2] == pytest.approx(50 * 0.02**2, rel=1e-6)


def test_a_step_that_finds_nothing_carries_its_report(block):
    block.world.advance(0.01)
    before, time = block.world.state_hash, block.world.time
    block.world.add_force(block.body, 0, (1e12, 0, 0))
    with pytest.raises(iso.NotConverged) as error:
        block.world.step(0.01)
    report = error.value.report
    assert report.status == "rejected" and report.reason == sentence(error) and report.time == time
    block.world.clear_forces()
    assert block.world.state_hash == before
    assert block.world.advance(0.01).converged


def test_a_budget_leaves_a_step_unfinished(finger):
    finger.air.amount = 500.0
    report = finger.world.step(1 / 60, iterations=1)
    assert report.status == "unfinished" and not report.converged
    assert finger.world.advance(1 / 60).converged


def test_a_path_is_followed():
    made = Block(scheme="continuation", gravity=(0, 0, 0))
    made.world.add(iso.traction(made.body, surface="z0", traction=(0, 0, -2000)))
    report = made.world.follow(0.001)
    assert report.converged and report.unstable_directions == 0 and made.world.time > 0


def test_orientation(block):
    turned = block.body.rest_positions[:, [1, 0, 2]] * (-1, 1, 1)  # a quarter turn about z
    block.body.positions = turned
    o = block.world.orientation(block.body, surfaces="x1")
    assert o.angle == pytest.approx(math.pi / 2) and np.allclose(o.axis, (0, 0, 1))
    assert np.allclose(o.normal, (0, 1, 0)) and o.misfit < 1e-12


def test_derivatives_are_those_of_differences():
    def tip(pressure, force):
        made = Finger(scheme="statics")
        made.air.amount = pressure
        made.world.set_forces(made.body, [(0, 0, 0)] * 485)
        made.world.add_force(made.body, 484, (0, force, 0))
        made.world.advance(1)
        return made

    made = tip(1000.0, 0.0)
    point = made.body.rest_positions[484]
    by_air, by_force = made.world.derivatives(made.air, (made.body, point, (0, 1, 0)))
    for response, other in ((by_air, tip(1001.0, 0.0)), (by_force, tip(1000.0, 1e-5))):
        step = 1.0 if response is by_air else 1e-5
        difference = (other.body.positions - made.body.positions) / step
        scale = np.abs(difference).max()
        assert np.allclose(response.positions[made.body.name], difference, atol=2e-3 * scale)
        assert response.regular and response.note == ""
    assert by_air.gauges[made.air.name]["pressure"] == pytest.approx(1.0)
    assert by_force.reactions[made.clamp.name].force[1] == pytest.approx(-1.0, rel=1e-6)


def test_a_world_that_cannot_be_compiled_says_so_each_time(block):
    block.world.add(iso.dirichlet(block.body, surfaces="nowhere"))
    for _ in range(2):
        with pytest.raises(iso.Error) as error:
            block.world.advance(0.01)
        assert "nowhere" in sentence(error)
    assert len(block.world.effects) == 3


def test_contacts_hold_the_weight():
    world = iso.World(scheme="statics", gravity=(0, 0, -9.81), threads=1)
    mesh = iso.box_mesh((0, 0, 0), (0.02, 0.02, 0.02), divisions=(2, 2, 2))
    body = world.add_body(mesh, iso.neo_hookean(young=1e5, poisson=0.45), name="block")
    world.add(iso.dirichlet(body, surfaces="z0", directions="xy", name="guide"))
    world.add(iso.contact(body, surfaces="z0", name="floor"))
    assert len(world.contacts()) == 0
    world.advance(1)
    weight = body.measures().mass * 9.81
    points, (pair,) = world.contacts(), world.contact_pairs()
    assert len(points) == pair.points == 9 and set(points.effects) == {"floor"} and set(points.bodies) == {"block"}
    assert np.allclose(points.normal_forces.sum(axis=0), (0, 0, weight), rtol=1e-6, atol=1e-9)
    assert np.allclose(points.normals, (0, 0, 1)) and np.allclose(points.gaps, 0, atol=1e-9)
    assert pair.force[2] == pytest.approx(weight, rel=1e-6) and pair.normal == pytest.approx(weight, rel=1e-6)
    assert np.allclose(points.positions, body.positions[points.nodes])


def test_warnings_reach_the_log(caplog):
    world = iso.World(threads=1)
    mesh = iso.box_mesh((0, 0, 0), (5000, 5000, 5000))
    with caplog.at_level("WARNING", "isochor"):
        world.add_body(mesh, iso.neo_hookean(young=1e5, poisson=0.3))
        world.compile()
    said = [record.message for record in caplog.records if "millimeters" in record.message]
    assert len(said) == 1 and world.warnings == said
