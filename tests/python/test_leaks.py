"""Nothing is left of worlds that are gone."""

import gc
import os
import resource

import numpy as np
import pytest

import isochor as iso


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def live_once(mesh, material):
    world = iso.World(threads=1, gravity=(0, 0, -9.81))
    body = world.add_body(mesh, material)
    world.add(iso.dirichlet(body, surfaces="z0"))
    world.progress = lambda progress: None
    world.advance(0.01)
    x = world.positions(body)
    return float(x[0, 0])


def test_ten_thousand_worlds_leave_nothing():
    mesh, material = iso.box_mesh(), iso.neo_hookean(young=1e5, poisson=0.3)
    for _ in range(1000):
        live_once(mesh, material)
    gc.collect()
    before = resident()
    for _ in range(10_000):
        live_once(mesh, material)
    gc.collect()
    grown = resident() - before
    # A hundred bytes a world would be a megabyte; a leaked world has some hundred kilobytes.
    assert grown < 8e6, f"{grown / 1e6:.1f} MB more after 10,000 worlds"


def test_gradients_functions_and_exceptions_leave_nothing():
    world = iso.World(scheme="statics", threads=1)
    body = world.add_body(iso.box_mesh(divisions=(1, 1, 1)), iso.neo_hookean(young=1e5, poisson=0.3), element="tet4")
    clamp = world.add(iso.dirichlet(body, surfaces="z0"))
    world.advance(1)
    kept = np.zeros(1000)  # what a function holds on to must go with it

    def churn():
        large = kept.copy()
        out = [iso.Output.node(body, 7, (0, 0, 1)), iso.Output.positions(body, None, (0, 0, 1))]
        law = lambda young: iso.neo_hookean(young=young + large[0], poisson=0.3)
        young = iso.Parameter.material(body, law, value=1e5)
        held = world.gradients(out, [clamp, young, iso.Parameter.cell_stiffness(body)])
        try:
            world.gradients(out, [iso.Parameter.material(body, lambda young: large[2000], value=1e5)])
        except IndexError:
            pass
        return held.by[2]

    for _ in range(100):
        churn()
    gc.collect()
    before = resident()
    last = [churn() for _ in range(500)][-1]
    gc.collect()
    assert resident() - before < 2e6 and last.shape == (2, 6)


def test_scenes_clones_and_exceptions_leave_nothing():
    scene = iso.Scene.load("tube", {"analysis.steps": 1, "bodies[0].element": "tet4"})
    mesh = iso.box_mesh()
    world = iso.World(threads=1)
    body = world.add_body(mesh, iso.neo_hookean(young=1e5, poisson=0.3))
    world.compile()

    def churn():
        world.clone()
        iso.WorldBatch(world, 2)[0].advance(0.01)
        try:
            world.set_positions(body, [[0, 0]])
        except iso.Error:
            pass
        scene.override({"analysis.steps": 2}).to_dict()

    for _ in range(200):
        churn()
    gc.collect()
    before = resident()
    for _ in range(1000):
        churn()
    gc.collect()
    assert resident() - before < 16e6
