"""Finds the moduli of two layers of a strip from where its markers are, and then a design: how thick it is to be.

Each step of Gauss and Newton solves an equilibrium and asks it for gradients, by adjoints or tangents with the factors
at hand. They are what ``scipy.optimize.least_squares`` takes as ``fun`` and ``jac``, without needing it.
"""

import numpy as np

import isochor as iso

LENGTH, WIDTH, HEIGHT = 0.12, 0.02, 0.012
LAYERS = ("soft", "hard")


def make_strip(young, scale=1.0):
    """Clamped at x = 0, heavy, pulled to the side at its end; the layers lie on top of each other."""
    world = iso.World(scheme="statics", gravity=(0, 0, -9.81))
    box = iso.box_mesh((0, 0, 0), (LENGTH, WIDTH, HEIGHT), divisions=(8, 2, 2))
    layer = (box.points[box.cells][:, :, 2].mean(axis=1) > HEIGHT / 2).astype(int)
    points = box.points * (1, 1, scale)
    mesh = iso.Mesh(points, box.cells, cell_region=layer, regions=LAYERS, surfaces=box.surfaces)
    strip = world.add_body(mesh, [rubber(E, name) for E, name in zip(young, LAYERS)])
    world.add(iso.volume(strip))
    world.add(iso.dirichlet(strip, surfaces="x0"))
    world.add_force_at(strip, (LENGTH, WIDTH, 0), (0.03, 0.02, 0))
    world.advance(1)
    return world, strip


def rubber(young, region):
    return iso.neo_hookean(young=young, poisson=0.49, density=1070, region=region)


def markers(strip):
    """The nodes of the edge that a camera sees."""
    x, y, z = strip.rest_positions.T
    return np.flatnonzero((y == 0) & (z == 0) & (x > 0))


def fit(measured, young, most=20):
    """The moduli by Gauss and Newton, in their logarithms."""
    world, strip = make_strip(young)
    nodes = markers(strip)
    outputs = [iso.Output.node(strip, n, axis) for n in nodes for axis in np.eye(3)]
    young = np.array(young, float)
    for step in range(1, most + 1):
        told = world.gradients(outputs, [iso.Parameter.material(strip, "young", region=name) for name in LAYERS])
        miss = measured.ravel() - told.values
        change = np.linalg.lstsq(told.jacobian * young, miss, rcond=None)[0]
        if np.abs(change).max() < 1e-9:
            break
        young *= np.exp(np.clip(change, -0.7, 0.7))
        for E, name in zip(young, LAYERS):
            strip.set_material(rubber(E, name))
        world.advance(1)
    return young, step


def droop(young, scale):
    """Of the end [m], and how it changes with the thickness: rest positions move along z."""
    world, strip = make_strip(young, scale)
    end = iso.Output.material_point(strip, (LENGTH, WIDTH, 0), (0, 0, 1))
    thicker = strip.rest_positions * (0, 0, 1 / scale)
    told = world.gradients([end], [iso.Parameter.shape(strip, thicker)])
    return told.values[0], told.jacobian[0, 0]


def design(young, wanted, scale=1.0, most=20):
    """The thickness, as a multiple, with which the end droops by so much, by Newton's method."""
    for step in range(1, most + 1):
        z, by_scale = droop(young, scale)
        if abs(wanted - z) < 1e-9:
            break
        scale += (wanted - z) / by_scale
    return scale, step


def main():
    true = np.array((60e3, 240e3))
    _, strip = make_strip(true)
    measured = strip.positions[markers(strip)]
    young, steps = fit(measured, (120e3, 120e3))
    print(f"moduli {young[0] / 1e3:.3f} and {young[1] / 1e3:.3f} kPa after {steps} steps")
    thick, steps_of_design = design(young, wanted=-0.01)
    print(f"thicker by a factor of {thick:.4f} the end droops by 10 mm, after {steps_of_design} steps")
    return np.abs(young / true - 1).max(), steps, steps_of_design


if __name__ == "__main__":
    main()
