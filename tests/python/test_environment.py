"""The environment for learning."""

import numpy as np
import pytest

import isochor as iso
from conftest import Finger, sentence


def make(**more):
    made = Finger()
    return iso.Environment(
        made.world,
        {made.air: (0.0, 800.0)},
        observe=lambda world: made.body.positions[-1],
        reward=lambda world: -float(np.linalg.norm(made.body.positions[-1])),
        **more,
    )


def episode(env, seed):
    observation, info = env.reset(seed=seed)
    seen = [observation]
    for _ in range(3):
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample(env.rng))
        seen.append(observation)
        assert not terminated and reward < 0 and info["report"].converged
    return np.array(seen), truncated


def test_episodes_repeat_to_the_last_bit():
    env = make(horizon=3)
    first, truncated = episode(env, 7)
    second, _ = episode(env, 7)
    third, _ = episode(env, 8)
    assert truncated and np.array_equal(first, second) and not np.array_equal(first, third)
    assert env.observation_space.shape == (3,) and env.action_space.contains([400.0])


def test_observations_are_copies():
    env = make()
    before, _ = env.reset(seed=1)
    kept = before.copy()
    env.step([800.0])
    assert np.array_equal(before, kept)


def test_amounts_outside_are_moved_inside():
    env = make()
    env.reset()
    env.step([1e9])
    assert env.world["cavity"].amount == 800.0


def test_an_episode_ends_where_it_is_done_or_finds_nothing():
    env = make(done=lambda world: world.time > 0.01)
    env.reset()
    assert env.step([0.0])[2]
    env = make(randomize=lambda world, rng: world.add_force(world.bodies[0], 400, (1e12, 0, 0)))
    env.reset()
    _, _, terminated, truncated, info = env.step([0.0])
    assert terminated and not truncated and info["not_converged"] and info["report"].status == "rejected"


def test_bad_actions_get_one_sentence():
    env = make()
    env.reset()
    for action in ([1.0, 2.0], [np.nan], 3.0):
        with pytest.raises(iso.Error) as error:
            env.step(action)
        assert "give 1 finite numbers, the amounts of cavity" in sentence(error)
    other = Finger()
    with pytest.raises(iso.Error, match="no effect of its world"):
        iso.Environment(env.world, {other.air: (0, 1)}, observe=lambda world: 0)
    with pytest.raises(iso.Error, match="lowest amount is above"):
        iso.Environment(env.world, {env.world["cavity"]: (1, 0)}, observe=lambda world: [0])
