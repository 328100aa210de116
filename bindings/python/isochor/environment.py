"""An environment for learning in the style of Gymnasium, which it does not need."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from .errors import Error, NotConverged
from .world import LiveEffect, World


@dataclass(frozen=True)
class Box:
    """Numbers between bounds: what Gymnasium calls a space."""

    low: np.ndarray
    high: np.ndarray

    @property
    def shape(self) -> tuple[int, ...]:
        return self.low.shape

    @property
    def dtype(self) -> np.dtype[Any]:
        return self.low.dtype

    def contains(self, value: ArrayLike) -> bool:
        array = np.asarray(value, float)
        return array.shape == self.shape and bool(np.all(array >= self.low) and np.all(array <= self.high))

    def sample(self, rng: np.random.Generator) -> np.ndarray:
        """Numbers spread evenly between finite bounds, from a normal distribution where there are none."""
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(bounded, self.low, 0.0), np.where(bounded, self.high, 1.0)
        return np.where(bounded, rng.uniform(low, high), rng.standard_normal(self.shape))


class Environment:
    """A world with amounts as actions: ``reset``, ``step``, ``observe``.

    Parameters
    ----------
    world:
        Where it is now is where each episode begins.
    actions:
        The lowest and the highest amount by effect, in the order of the numbers of an action.
    observe:
        Makes an array of the world.
    reward:
        Makes a number of the world; None: 0.
    done:
        Whether the episode has ended; None: never.
    dt:
        Seconds a step.
    horizon:
        Steps until an episode is cut off; 0: none.
    randomize:
        Called with the world and a random generator at each reset.

    ``step`` returns (observation, reward, terminated, truncated, info) and ``reset`` (observation, info), as
    Gymnasium wants them. A step that finds no equilibrium ends the episode with ``info["not_converged"]``; the
    world is where it got.
    """

    def __init__(
        self,
        world: World,
        actions: Mapping[LiveEffect, tuple[float, float]],
        observe: Callable[[World], ArrayLike],
        *,
        reward: Callable[[World], float] | None = None,
        done: Callable[[World], bool] | None = None,
        dt: float = 1 / 60,
        horizon: int = 0,
        randomize: Callable[[World, np.random.Generator], None] | None = None,
    ) -> None:
        for effect in actions:
            if not isinstance(effect, LiveEffect) or effect.world is not world:
                raise Error(f"Environment: {effect!r} is no effect of its world; give handles that world.add() returned")
        self.world = world
        self._effects = tuple(actions)
        self._observe, self._reward, self._done = observe, reward, done
        self.dt, self.horizon = dt, horizon
        self._randomize = randomize
        self.rng = np.random.default_rng()
        self._steps = 0
        world.compile()
        self._start = world.save()
        bounds = np.array([actions[effect] for effect in self._effects], float).reshape(len(actions), 2)
        if not np.all(bounds[:, 0] <= bounds[:, 1]):
            raise Error("Environment: a lowest amount is above the highest; give (low, high)")
        self.action_space = Box(bounds[:, 0].copy(), bounds[:, 1].copy())
        seen = self.observe()
        self.observation_space = Box(np.full(seen.shape, -np.inf), np.full(seen.shape, np.inf))

    def observe(self) -> np.ndarray:
        """What is seen of the world now; a copy."""
        return np.array(self._observe(self.world), dtype=float)

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[np.ndarray, dict[str, Any]]:
        """Back to the start. The same ``seed`` gives the same episode to the same actions."""
        del options
        if seed is not None:
            self.rng = np.random.default_rng(seed)
        self.world.load(self._start)
        self._steps = 0
        if self._randomize is not None:
            self._randomize(self.world, self.rng)
        return self.observe(), {"time": self.world.time}

    def step(self, action: ArrayLike) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Sets the amounts and advances by ``dt``. Amounts outside their bounds are moved to them."""
        numbers = np.asarray(action, float)
        if numbers.shape != self.action_space.shape or not np.isfinite(numbers).all():
            raise Error(
                f"step: an action of shape {numbers.shape}; give {len(self._effects)} finite numbers, the amounts of "
                + ", ".join(effect.name for effect in self._effects)
            )
        numbers = np.clip(numbers, self.action_space.low, self.action_space.high)
        for effect, amount in zip(self._effects, numbers):
            effect.amount = amount
        info: dict[str, Any] = {}
        failed = False
        try:
            info["report"] = self.world.advance(self.dt)
        except NotConverged as error:
            failed = True
            info.update(report=error.report, not_converged=str(error))
        self._steps += 1
        info["time"] = self.world.time
        reward = float(self._reward(self.world)) if self._reward is not None else 0.0
        terminated = failed or (self._done is not None and bool(self._done(self.world)))
        truncated = not terminated and 0 < self.horizon <= self._steps
        return self.observe(), reward, terminated, truncated, info
