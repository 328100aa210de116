"""Batches: many worlds of one scene, side by side."""

from __future__ import annotations

from typing import Iterator

import numpy as np
from numpy.typing import ArrayLike

from . import _isochor
from .errors import Error
from .reports import StepReport
from .world import Body, LiveEffect, World


class WorldBatch:
    """``count`` clones of a world at its present state, each with the bits that it has alone.

    Tables and the ordering of the factors are shared. All arrays begin with the dimension of the worlds, and are
    read and set without a loop in Python. ``threads``: how many worlds are worked on at once; 0: all of the machine.
    Handles of bodies and effects of the world are those of the batch.
    """

    def __init__(self, world: World, count: int, *, threads: int = 0) -> None:
        if not isinstance(world, World):
            raise Error(f"WorldBatch: a value of type {type(world).__name__}; give an isochor.World")
        self._core = _isochor.WorldBatch(world._ready(), int(count), int(threads))
        self._like = world._like(None)  # handles as they are now
        self._worlds: dict[int, World] = {}

    def __len__(self) -> int:
        return self._core.size()

    @property
    def threads(self) -> int:
        return self._core.threads()

    def __getitem__(self, number: int) -> World:
        """One of the worlds, for everything that is set or asked of one alone. It keeps the batch alive."""
        if not 0 <= number < len(self):
            raise IndexError(f"world {number} of a batch of {len(self)}; give 0 to {len(self) - 1}")
        if number not in self._worlds:
            self._worlds[number] = self._like._like(self._core.world(int(number)))
        return self._worlds[number]

    def __iter__(self) -> Iterator[World]:
        return (self[number] for number in range(len(self)))

    def advance(self, h: float) -> list[StepReport]:
        """All worlds by ``h`` seconds; one report each.

        A world that fails does not keep the others from going on: nothing is raised, its report says ``rejected``.
        """
        return [StepReport(**raw) for raw in self._core.advance(float(h))]

    def step(self, h: float, *, iterations: int = 0, seconds: float = 0.0) -> list[StepReport]:
        """One increment of all worlds; one report each, as of ``World.step``."""
        return [StepReport(**raw) for raw in self._core.step(float(h), int(iterations), float(seconds))]

    def reset(self, marked: ArrayLike | None = None) -> None:
        """The worlds that are marked (flags of shape (worlds,)), or all, go back to the beginning."""
        self._core.reset(marked)

    def set_amounts(self, effect: LiveEffect, amounts: ArrayLike) -> None:
        """One amount a world, shape (worlds,)."""
        self._core.set_amounts(effect._id, amounts)

    def positions(self, body: Body) -> np.ndarray:
        """Positions now [m], shape (worlds, n, 3); a copy."""
        return self._core.positions(body._id)

    def velocities(self, body: Body) -> np.ndarray:
        """Velocities now [m/s], shape (worlds, n, 3); a copy."""
        return self._core.velocities(body._id)

    def set_positions(self, body: Body, positions: ArrayLike) -> None:
        """[m], shape (worlds, n, 3); the bodies are at rest there."""
        self._core.set_positions(body._id, positions)

    def set_velocities(self, body: Body, velocities: ArrayLike) -> None:
        """[m/s], shape (worlds, n, 3)."""
        self._core.set_velocities(body._id, velocities)

    def set_forces(self, body: Body, forces: ArrayLike) -> None:
        """Dead forces on nodes [N], shape (worlds, n, 3)."""
        self._core.set_forces(body._id, forces)

    def set_gravity(self, gravity: ArrayLike) -> None:
        """[m/s^2], shape (worlds, 3)."""
        self._core.set_gravity(gravity)

    def gauges(self, effect: LiveEffect) -> dict[str, np.ndarray]:
        """What an effect reports now, by quantity, each of shape (worlds,)."""
        return {quantity: values for name, quantity, values in self._core.gauges() if name == effect.name}

    @property
    def state_hashes(self) -> list[int]:
        """Of each world, as ``World.state_hash``."""
        return self._core.state_hashes()

    @property
    def memory(self) -> dict[str, int]:
        """Bytes that each world takes for itself, and those that all share."""
        each, shared = self._core.memory()
        return {"each": each, "shared": shared}

    def __repr__(self) -> str:
        return f"<isochor.WorldBatch: {len(self)} worlds>"

