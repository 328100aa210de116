"""Batches: arrays of shape (worlds, ...), each world with the bits it has alone."""

import numpy as np
import pytest

import isochor as iso
from conftest import Finger, bits, sentence


def alone(amount, frames):
    made = Finger()
    for _ in range(frames):
        made.air.amount = amount
        made.world.advance(1 / 60)
    return made


def test_each_world_has_the_bits_that_it_has_alone(finger):
    batch = iso.WorldBatch(finger.world, 3, threads=2)
    assert len(batch) == 3 and batch.threads == 2
    amounts = np.array([100.0, 300.0, 500.0])
    for _ in range(2):
        batch.set_amounts(finger.air, amounts)
        reports = batch.advance(1 / 60)
    assert [r.status for r in reports] == ["converged"] * 3
    x, v = batch.positions(finger.body), batch.velocities(finger.body)
    assert x.shape == v.shape == (3, 485, 3) and x.dtype == np.float64
    for k, amount in enumerate(amounts):
        one = alone(amount, 2)
        assert bits(x[k]) == bits(one.body.positions) and bits(v[k]) == bits(one.body.velocities)
        assert batch.state_hashes[k] == one.world.state_hash
    gauges = batch.gauges(finger.air)
    assert np.allclose(gauges["pressure"], amounts) and gauges["volume"].shape == (3,)
    assert gauges["volume"][0] < gauges["volume"][1] < gauges["volume"][2]


def test_worlds_of_a_batch_have_parameters_of_their_own(finger):
    batch = iso.WorldBatch(finger.world, 2, threads=1)
    stiff = iso.neo_hookean(young=200e3, poisson=0.5, density=1070)
    batch[1][finger.body.name].set_material(stiff)
    assert batch[1].bodies[0].materials == [iso.neo_hookean(young=200e3, poisson=0.5, density=1070)]
    batch.set_amounts(finger.air, [1000.0, 1000.0])
    batch.advance(1 / 60)
    x = batch.positions(finger.body) - finger.body.rest_positions
    assert np.abs(x[0]).max() > 1.2 * np.abs(x[1]).max()
    memory = batch.memory
    assert memory["each"] > 0 and memory["shared"] > 0


def test_arrays_set_all_worlds(finger):
    batch = iso.WorldBatch(finger.world, 2, threads=1)
    batch.set_gravity([(0, 0, 0), (0, -9.81, 0)])
    batch.set_velocities(finger.body, np.zeros((2, 485, 3)))
    forces = np.zeros((2, 485, 3))
    batch.set_forces(finger.body, forces)
    batch.advance(1 / 60)
    x = batch.positions(finger.body) - finger.body.rest_positions
    assert np.abs(x[0]).max() < 1e-9 < np.abs(x[1]).max()
    batch.set_positions(finger.body, np.broadcast_to(finger.body.rest_positions, (2, 485, 3)))
    assert not (batch.positions(finger.body) - finger.body.rest_positions).any()


def test_marked_worlds_go_back(finger):
    batch = iso.WorldBatch(finger.world, 3, threads=1)
    start = batch.state_hashes[0]
    batch.set_amounts(finger.air, [100.0] * 3)
    batch.advance(1 / 60)
    batch.reset([False, True, False])
    hashes = batch.state_hashes
    assert hashes[1] == start and hashes[0] == hashes[2] != start
    batch.reset()
    assert batch.state_hashes == [start] * 3


def test_a_world_that_fails_does_not_stop_the_others(finger):
    batch = iso.WorldBatch(finger.world, 2, threads=1)
    forces = np.zeros((2, 485, 3))
    forces[1, 400] = (1e12, 0, 0)
    batch.set_forces(finger.body, forces)
    reports = batch.step(1 / 60)
    assert [r.status for r in reports] == ["converged", "rejected"] and reports[1].reason


def test_a_world_keeps_its_batch_alive(finger):
    world = iso.WorldBatch(finger.world, 2, threads=1)[1]
    assert world.advance(1 / 60).converged
    x = world.positions(world.bodies[0])
    del world
    assert np.isfinite(x).all()


def test_bad_arrays_get_one_sentence(finger):
    batch = iso.WorldBatch(finger.world, 2, threads=1)
    other = Finger()
    body = finger.body
    cases = [
        (lambda: iso.WorldBatch("world", 2), "a value of type str"),
        (lambda: iso.WorldBatch(finger.world, 0), "batch: 0 worlds"),
        (lambda: batch.set_amounts(finger.air, [1.0]), "1"),
        (lambda: batch.set_amounts(finger.air, [1.0, np.nan]), "entry 1 holds nan"),
        (lambda: batch.set_amounts(finger.clamp, "ab"), "an array of type"),
        (lambda: batch.set_forces(body, np.zeros((485, 3))), "an array of shape (485, 3); give one of shape (2, n, 3)"),
        (lambda: batch.set_forces(body, np.zeros((2, 4, 3))), "world 0 of the batch"),
        (lambda: batch.set_gravity([(0, 0, 0)]), "give one of shape (2, 3)"),
        (lambda: batch.reset([True]), "give one a world"),
        (lambda: batch.positions(other.body), "another world"),
    ]
    before = batch.state_hashes
    for call, words in cases:
        with pytest.raises(iso.Error) as error:
            call()
        assert words in sentence(error)
    assert batch.state_hashes == before
    with pytest.raises(IndexError):
        batch[2]
