"""Worlds, descriptions and exceptions can be pickled."""

import concurrent.futures
import copy
import multiprocessing
import pickle

import pytest

import isochor as iso
from conftest import Block, bits


def test_a_world_goes_on_with_the_same_bits(finger):
    for frame in range(3):
        finger.air.amount = 300.0 * frame
        finger.world.advance(1 / 60)
    other = pickle.loads(pickle.dumps(finger.world))
    assert other.state_hash == finger.world.state_hash and other.time == finger.world.time
    air = other["cavity"]
    assert air.amount == 600.0 and air.pressure == finger.air.pressure
    for world in (finger.world, other):
        world["cavity"].amount = 700.0
        world.advance(1 / 60)
    assert other.state_hash == finger.world.state_hash
    assert bits(other["body"].positions) == bits(finger.body.positions)


def test_a_world_that_was_never_compiled():
    made = Block()
    other = pickle.loads(pickle.dumps(made.world))
    made.world.advance(0.01)
    other.advance(0.01)
    assert other.state_hash == made.world.state_hash


def test_an_empty_world():
    other = pickle.loads(pickle.dumps(iso.World(gravity=(0, 0, -1), scheme="statics")))
    assert other.bodies == () and tuple(other.gravity) == (0, 0, -1)


def test_a_world_that_has_changed(block):
    block.world.advance(0.01)
    block.world.add(iso.dirichlet(block.body, nearest=[(0, 0, 0)], name="grab"))
    block.world.advance(0.01)
    block.world["grab"].remove()
    block.body.set_material(iso.neo_hookean(young=2e4, poisson=0.5))
    block.world.gravity = (0, 0, -5)
    block.world.add_force(block.body, 0, (1e-4, 0, 0))
    block.world.advance(0.01)
    other = pickle.loads(pickle.dumps(block.world))
    assert tuple(other.gravity) == (0, 0, -5) and [e.name for e in other.effects] == ["volume", "clamp"]
    assert bits(other["block"].positions) == bits(block.body.positions)
    for world in (block.world, other):
        world.advance(0.01)
    assert bits(other["block"].positions) == bits(block.body.positions)


def test_a_copy_is_another_world(block):
    block.world.advance(0.01)
    other = copy.deepcopy(block.world)
    other.advance(0.01)
    assert other.time > block.world.time


def test_descriptions_and_reports(block):
    air = iso.cavity(surfaces="chamber", control="gas")
    back = pickle.loads(pickle.dumps(air))
    assert repr(back) == repr(air)
    material = iso.ogden(terms=[{"mu": 1e3, "alpha": 2}], poisson=0.5)
    assert pickle.loads(pickle.dumps(material)) == material
    report = block.world.advance(0.01)
    assert pickle.loads(pickle.dumps(report)) == report


def test_exceptions_keep_their_report(block):
    block.world.add_force(block.body, 0, (1e12, 0, 0))
    with pytest.raises(iso.NotConverged) as error:
        block.world.step(0.01)
    back = pickle.loads(pickle.dumps(error.value))
    assert str(back) == str(error.value) and back.report == error.value.report


def step_elsewhere(world):
    world.advance(0.01)
    return world.state_hash


def test_worlds_travel_to_other_processes():
    made = Block()
    made.world.advance(0.01)
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        there = pool.submit(step_elsewhere, made.world).result()
    made.world.advance(0.01)
    assert there == made.world.state_hash
