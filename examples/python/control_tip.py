"""Brings the tip of a soft arm to a target by three cables.

Each step of Gauss and Newton solves an equilibrium, and asks it how the tip answers to the tensions: derivatives by
solves with the factors at hand, no finite differences.
"""

import numpy as np

import isochor as iso

LENGTH, WIDTH = 0.12, 0.02
MOST = 3.0  # [N] that a cable can pull


def make_arm():
    world = iso.World(scheme="statics")
    mesh = iso.box_mesh((-WIDTH / 2, -WIDTH / 2, 0), (WIDTH / 2, WIDTH / 2, LENGTH), divisions=(3, 3, 12))
    arm = world.add_body(mesh, iso.neo_hookean(young=100e3, poisson=0.5, density=1070))
    world.add(iso.volume(arm))
    world.add(iso.dirichlet(arm, surfaces="z0"))
    cables = []
    for angle in np.radians((90, 210, 330)):
        x, y = 0.4 * WIDTH * np.cos(angle), 0.4 * WIDTH * np.sin(angle)
        points = [(x, y, z) for z in np.linspace(0, LENGTH, 13)]
        cables.append(world.add(iso.cable(arm, points=points, control="tension", amount=0)))
    return world, arm, cables


def middle_of_tip(arm):
    """Nodes and their weights: the tip is the mean of the four in the middle of the free end."""
    rest = arm.rest_positions
    middle = np.abs(rest[:, :2]).max(axis=1) < WIDTH / 4
    return np.flatnonzero(middle & (rest[:, 2] > 0.999 * LENGTH))


def reach(world, arm, cables, target, tolerance=1e-5, most=30):
    """Changes the tensions until the tip is within `tolerance` [m] of the target in x and y."""
    nodes = middle_of_tip(arm)
    for iteration in range(1, most + 1):
        tip = arm.positions[nodes].mean(axis=0)
        miss = target - tip[:2]
        if np.linalg.norm(miss) < tolerance:
            break
        responses = world.derivatives(*cables)
        jacobian = np.array([r.positions[arm.name][nodes].mean(axis=0)[:2] for r in responses]).T
        tensions = np.array([cable.amount for cable in cables])
        # The smallest change that leads there, no more than a quarter of the range at once.
        change = np.linalg.lstsq(jacobian, miss, rcond=None)[0]
        change *= min(1.0, 0.25 * MOST / np.abs(change).max())
        tensions = tensions + change
        tensions -= min(0.0, tensions.min())  # cables do not push; pulling all of them bends nothing
        for cable, tension in zip(cables, np.minimum(tensions, MOST)):
            cable.amount = tension
        world.advance(1)
    return iteration, float(np.linalg.norm(miss))


def main():
    world, arm, cables = make_arm()
    for target in ((0.02, 0.0), (-0.01, 0.025), (0.0, -0.03)):
        steps, off = reach(world, arm, cables, np.array(target))
        tensions = ", ".join(f"{cable.amount:.2f}" for cable in cables)
        print(f"target {target} m: off by {1e3 * off:.4f} mm after {steps} steps, tensions {tensions} N")
    return off


if __name__ == "__main__":
    main()
