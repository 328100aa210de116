"""Worlds that change while they live."""

import numpy as np
import pytest

import isochor as iso
from conftest import Block, bits, sentence


def on_the_floor():
    """A block that slides down an inclined floor, held by friction or not."""
    world = iso.World(gravity=(3.0, 0, -9.81), threads=1)
    mesh = iso.box_mesh((0, 0, 0), (0.02, 0.02, 0.02), divisions=(2, 2, 2))
    body = world.add_body(mesh, iso.neo_hookean(young=1e5, poisson=0.45))
    floor = world.add(iso.contact(body, surfaces="z0", name="floor", friction=0.8))
    return world, body, floor


def test_a_key_of_an_effect_is_set_in_its_place():
    world, body, floor = on_the_floor()
    for _ in range(5):
        world.advance(0.01)
    held = body.displacements[:, 0].max()
    assert floor.friction == 0.8
    floor.friction = 0.05
    assert floor.friction == 0.05
    report = world.advance(0.01)
    assert report.compile_work == "numbers"
    for _ in range(4):
        world.advance(0.01)
    assert body.displacements[:, 0].min() > held + 0.001
    assert world["floor"] is floor and len(world.effects) == 1


def test_several_keys_at_once_and_one_taken_away():
    world, body, floor = on_the_floor()
    floor.change(friction=0.5, static_friction=0.6)
    assert (floor.friction, floor.static_friction) == (0.5, 0.6)
    floor.change(static_friction=None)
    assert floor.static_friction == 0 and "static_friction" not in floor.description.keys
    assert world.advance(0.01).converged


def test_a_change_of_another_key_leaves_the_amount():
    rope = iso.cable(points=[(0, 0, 0), (0, 0, 1)], amount=0.9)
    assert rope.with_keys(stiffness=5.0).keys["amount"] == 0.9
    assert "amount" not in iso.cavity(surfaces="x", control="volume").with_keys(ambient=1e5).keys
    assert iso.cavity(surfaces="x", amount=400).with_keys(control="volume_ratio").keys["amount"] == 1


def test_selections_change_too():
    made = Block()
    made.clamp.surfaces = ["z1", "z0"]
    made.world.advance(0.01)
    low = made.body.mesh.surfaces["z0"].ravel()
    assert not made.body.displacements[low].any()


def test_effects_come_and_go(block):
    block.world.advance(0.01)
    grab = block.world.add(iso.dirichlet(block.body, nearest=[(0, 0, 0)], name="grab", displacement=(0.002, 0, 0)))
    corner = int(np.argmin(np.linalg.norm(block.body.rest_positions, axis=1)))
    report = block.world.advance(0.01)
    assert report.compile_work == "structure"
    assert np.allclose(block.body.displacements[corner], (0.002, 0, 0))
    grab.remove()
    for _ in range(5):
        block.world.advance(0.01)
    assert abs(block.body.displacements[corner, 0]) < 0.0015
    with pytest.raises(iso.Error) as error:
        grab.amount = 1
    assert "was removed" in sentence(error)
    with pytest.raises(KeyError):
        block.world["grab"]


def test_what_is_untouched_keeps_its_bits(block):
    other = Block()
    for made in (block, other):
        made.world.advance(0.01)
    mesh = iso.box_mesh((1, 0, 0), (1.02, 0.02, 0.02))
    body = block.world.add_body(mesh, iso.neo_hookean(young=1e4, poisson=0.3), name="beside")
    block.world.compile()
    assert bits(block.body.positions) == bits(other.body.positions)
    assert bits(block.body.velocities) == bits(other.body.velocities)
    body.remove()
    block.world.compile()
    assert bits(block.body.positions) == bits(other.body.positions)
    block.world.advance(0.01)
    other.world.advance(0.01)
    assert block.world.state_hash == other.world.state_hash


def test_a_body_that_an_effect_names_stays(block):
    with pytest.raises(iso.Error) as error:
        block.body.remove()
    assert 'is named by effect "volume"' in sentence(error)
    assert block.world.bodies == (block.body,)
    assert block.world.advance(0.01).converged


def test_a_change_that_fails_takes_the_handles_back(block):
    block.world.advance(0.01)
    before = block.world.state_hash
    block.clamp.treatment = "multiplier"
    wrong = block.world.add(iso.dirichlet(block.body, surfaces="nowhere", name="wrong"))
    with pytest.raises(iso.Error) as error:
        block.world.advance(0.01)
    assert "nowhere" in sentence(error)
    assert block.world.effects == (block.volume, block.clamp) and block.clamp.treatment == "eliminated"
    assert block.world.state_hash == before
    with pytest.raises(iso.Error):
        wrong.reaction
    assert block.world.advance(0.01).converged


def test_materials_and_densities():
    made = Block(scheme="statics")
    made.world.advance(1)
    sag = made.body.displacements[:, 2].min()
    made.body.set_material(iso.neo_hookean(young=2e4, poisson=0.5))
    made.world.advance(1e-3)
    assert made.body.displacements[:, 2].min() == pytest.approx(sag / 2, rel=0.05)
    assert made.body.materials[0].keys["young"] == 2e4 and made.body.materials[0].keys["density"] == 1000
    made.body.set_material(iso.neo_hookean(young=2e4, poisson=0.5, density=2000))
    made.world.advance(1e-3)
    assert made.body.displacements[:, 2].min() == pytest.approx(sag, rel=0.05)
    assert made.body.measures().mass == pytest.approx(2000 * 0.02**3)


def test_gravity_and_forces():
    made = Block(scheme="statics")
    made.world.advance(1)
    weight = made.clamp.reaction.force.copy()
    made.world.gravity = (0, 0, -2 * 9.81)
    assert np.array_equal(made.world.gravity, (0, 0, -2 * 9.81))
    made.world.advance(1)
    assert np.allclose(made.clamp.reaction.force, 2 * weight, rtol=1e-6, atol=1e-9)
    made.world.gravity = (0, 0, 0)
    forces = np.zeros_like(made.body.positions)
    forces[0] = (0.001, 0, 0)
    made.world.set_forces(made.body, forces)
    made.world.add_force(made.body, 1, (0, 0.002, 0))
    made.world.add_force_at(made.body, (0.01, 0.01, 0.01), (0, 0, 0.003))
    made.world.advance(1)
    assert np.allclose(made.clamp.reaction.force, (-0.001, -0.002, -0.003), atol=1e-9)
    made.world.clear_forces()
    made.world.advance(1)
    assert np.allclose(made.clamp.reaction.force, 0, atol=1e-9)


def test_poses(block):
    block.clamp.set_pose(position=(0.001, 0, 0), turn=(0, 0, 0.1))
    block.world.advance(0.1)
    top = block.body.mesh.surfaces["z1"].ravel()
    c, s = np.cos(0.1), np.sin(0.1)
    turned = block.body.rest_positions[top] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + (0.001, 0, 0)
    assert np.allclose(block.body.positions[top], turned, atol=1e-12)
    with pytest.raises(iso.Error, match="no pose to set"):
        block.volume.set_pose()


def test_reset_has_the_bits_of_a_new_world(block):
    new = Block()
    new.world.compile()
    for _ in range(3):
        block.world.advance(0.01)
    block.world.gravity = (1, 0, 0)
    block.world.reset()
    assert block.world.time == 0 and np.array_equal(block.world.gravity, (0, 0, -9.81))
    assert block.world.state_hash == new.world.state_hash
    block.world.advance(0.01)
    new.world.advance(0.01)
    assert block.world.state_hash == new.world.state_hash


def test_a_clone_goes_on_with_the_same_bits_and_its_own_handles(finger):
    finger.air.amount = 300.0
    finger.world.advance(1 / 60)
    other = finger.world.clone()
    air = other["cavity"]
    assert air is not finger.air and air.amount == 300.0 and air.world is other
    finger.world.advance(1 / 60)
    other.advance(1 / 60)
    assert other.state_hash == finger.world.state_hash
    assert bits(other.positions(finger.body)) == bits(finger.body.positions)
    air.amount = 600.0
    other.advance(1 / 60)
    finger.world.advance(1 / 60)
    assert other.state_hash != finger.world.state_hash and finger.air.amount == 300.0


def test_saved_states(finger):
    finger.air.amount = 300.0
    finger.world.advance(1 / 60)
    saved, before = finger.world.save(), finger.world.state_hash
    finger.world.advance(1 / 60)
    after = finger.world.state_hash
    finger.world.load(saved)
    assert finger.world.state_hash == before
    finger.world.advance(1 / 60)
    assert finger.world.state_hash == after
    with pytest.raises(iso.Error) as error:
        finger.world.load(saved[:-9] + b"\0" * 9)
    assert "load" in sentence(error) and finger.world.state_hash == after
