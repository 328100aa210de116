"""Views: no copy, the state of now, read-only, and never dangling."""

import gc

import numpy as np
import pytest

import isochor as iso
from conftest import Block, bits


def test_a_view_shows_the_state_after_each_step(block):
    x, v = block.world.positions(block.body), block.world.velocities(block.body)
    rest = block.body.rest_positions
    assert x.shape == rest.shape and x.dtype == np.float64 and np.array_equal(x, rest)
    address = x.ctypes.data
    for _ in range(3):
        before = x.copy()
        block.world.advance(0.01)
        assert not np.array_equal(x, before) and v.any()
        assert block.world.positions(block.body).ctypes.data == address
    kept = x.copy()
    saved = block.world.save()
    block.world.advance(0.01)
    block.world.load(saved)
    assert bits(x) == bits(kept)
    block.world.reset()
    assert np.array_equal(x, rest) and not v.any()


def test_a_view_is_not_a_copy_and_cannot_be_written(block):
    x = block.world.positions(block.body)
    assert not x.flags.owndata and not x.flags.writeable
    with pytest.raises(ValueError):
        x[0] = 0
    with pytest.raises(ValueError):
        x.flags.writeable = True


def test_a_view_shows_what_is_set(block):
    x, v = block.world.positions(block.body), block.world.velocities(block.body)
    moved = block.body.rest_positions + (0, 0, 0.001)
    block.body.positions = moved
    assert bits(x) == bits(moved)
    block.body.velocities = np.ones_like(moved)
    assert (v == 1).all()


def test_a_rejected_step_leaves_the_view(block):
    x = block.world.positions(block.body)
    block.world.advance(0.01)
    before = x.copy()
    block.world.add_force(block.body, 0, (1e12, 0, 0))
    with pytest.raises(iso.NotConverged):
        block.world.step(0.01)
    assert bits(x) == bits(before)


def test_a_view_outlives_its_world():
    made = Block()
    made.world.advance(0.01)
    x = made.world.positions(made.body)
    part = x[1:]
    before = x.copy()
    del made
    gc.collect()
    others = [Block() for _ in range(20)]  # would take the place of what was freed
    for other in others:
        other.world.advance(0.01)
    assert bits(x) == bits(before) and bits(part) == bits(before[1:])


def test_views_keep_their_last_numbers_where_bodies_come_and_go(block):
    block.world.advance(0.01)
    x = block.world.positions(block.body)
    before = x.copy()
    mesh = iso.box_mesh((1, 0, 0), (1.02, 0.02, 0.02))
    other = block.world.add_body(mesh, iso.neo_hookean(young=1e4, poisson=0.3))
    block.world.advance(0.01)
    # The world has other memory now: the old view stays as it was, a new one shows the state.
    assert bits(x) == bits(before)
    now = block.world.positions(block.body)
    assert not np.array_equal(now, x)
    gone = block.world.positions(other)
    last = gone.copy()
    other.remove()
    block.world.advance(0.01)
    assert bits(gone) == bits(last)
    with pytest.raises(iso.Error, match="was removed"):
        block.world.positions(other)


def test_changes_of_constants_leave_views_in_place(block):
    x = block.world.positions(block.body)
    block.world.advance(0.01)
    block.body.set_material(iso.neo_hookean(young=2e4, poisson=0.5))
    report = block.world.advance(0.01)
    assert report.compile_work == "numbers"
    assert block.world.positions(block.body).ctypes.data == x.ctypes.data
    assert bits(x) == bits(block.world.positions(block.body))
