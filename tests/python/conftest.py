"""What tests share: a small world that steps in milliseconds, and where things are."""

import os
from pathlib import Path

import numpy as np
import pytest

import isochor as iso

SOURCE = Path(os.environ.get("ISOCHOR_SOURCE", Path(__file__).resolve().parents[2]))
BUILD = Path(os.environ.get("ISOCHOR_BUILD", SOURCE / "build"))
MESHES = SOURCE / "scenes" / "meshes"


class Block:
    """A block of rubber that hangs on its side z1, one thread, in dynamics by default."""

    def __init__(self, divisions=(2, 2, 2), size=0.02, **options):
        self.world = iso.World(**{"gravity": (0, 0, -9.81), "threads": 1, **options})
        mesh = iso.box_mesh((0, 0, 0), (size, size, size), divisions=divisions)
        self.body = self.world.add_body(mesh, iso.neo_hookean(young=1e4, poisson=0.5, density=1000), name="block")
        self.volume = self.world.add(iso.volume(self.body))
        self.clamp = self.world.add(iso.dirichlet(self.body, surfaces="z1", name="clamp"))


class Finger:
    """The small finger of examples/finger.cpp."""

    def __init__(self, threads=1, **options):
        self.world = iso.World(threads=threads, **options)
        silicone = iso.neo_hookean(young=100e3, poisson=0.5, density=1070)
        self.body = self.world.add_body(iso.read_mesh(MESHES / "finger_small.msh"), silicone)
        self.world.add(iso.volume(self.body))
        self.clamp = self.world.add(iso.dirichlet(self.body, surfaces="clamped"))
        self.air = self.world.add(iso.cavity(self.body, surfaces="chamber"))


@pytest.fixture
def block():
    return Block()


@pytest.fixture
def finger():
    return Finger()


@pytest.fixture(scope="session")
def source():
    return SOURCE


@pytest.fixture(scope="session")
def build():
    return BUILD


def bits(array):
    """The array as bytes: equal means equal to the last bit."""
    return np.ascontiguousarray(array).tobytes()


def sentence(error):
    """The message of an error, which is one sentence on one line."""
    text = str(error.value)
    assert text and "\n" not in text, text
    return text
