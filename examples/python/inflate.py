"""Inflates a soft finger in frames of 1/60 s, as examples/finger.cpp does.   inflate.py [mesh]"""

import sys
from pathlib import Path

import isochor as iso

MESHES = Path(__file__).resolve().parents[2] / "scenes" / "meshes"


def make_finger(mesh):
    world = iso.World()
    silicone = iso.neo_hookean(young=100e3, poisson=0.5, density=1070)  # incompressible: an ordinary input
    finger = world.add_body(iso.read_mesh(mesh), silicone)
    world.add(iso.volume(finger))  # pressures at the nodes
    world.add(iso.dirichlet(finger, surfaces="clamped"))
    air = world.add(iso.cavity(finger, surfaces="chamber"))
    return world, finger, air


def main(mesh=MESHES / "finger_small.msh"):
    world, finger, air = make_finger(mesh)
    x = world.positions(finger)  # a view: it shows the state after each step
    for frame in range(1, 61):
        air.amount = 100.0 * frame  # Pa
        world.advance(1 / 60)
        if frame % 10 == 0:
            tip = 1e3 * x[-1]
            print(f"{world.time:.2f} s  the last node is at ({tip[0]:.1f}, {tip[1]:.1f}, {tip[2]:.1f}) mm")
    return world


if __name__ == "__main__":
    main(*sys.argv[1:2])
