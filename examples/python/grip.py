"""Two soft pads close around a ball on a table, lift it, and let it fall."""

import isochor as iso


def make_gripper():
    world = iso.World(gravity=(0, 0, -9.81))
    rubber = iso.neo_hookean(young=50e3, poisson=0.49, density=1000)
    pads, hands = [], []
    for side, inner, outer in ((-1, "x1", "x0"), (1, "x0", "x1")):
        near, far = 0.022 * side, 0.032 * side
        mesh = iso.box_mesh(
            (min(near, far), -0.015, 0.005), (max(near, far), 0.015, 0.035), divisions=(2, 4, 4)
        )
        pad = world.add_body(mesh, rubber)
        world.add(iso.volume(pad))
        hands.append(world.add(iso.dirichlet(pad, surfaces=outer)))
        pads.append((pad, inner))
    ball = world.add(
        iso.rigid_body(name="ball", shape={"shape": "sphere", "radius": 0.02, "position": (0, 0, 0.02)}, density=300)
    )
    world.add(iso.contact(name="table", rigid=ball, friction=0.5))
    for pad, inner in pads:
        world.add(iso.contact(pad, surfaces=inner, against=ball, friction=0.9))
    return world, hands


def move(world, hands, closed, height, frames):
    """Moves both hands to where they are `closed` [m] inward and lifted [m], over some frames."""
    at = getattr(move, "at", (0.0, 0.0))
    for frame in range(1, frames + 1):
        s = frame / frames
        x, z = at[0] + s * (closed - at[0]), at[1] + s * (height - at[1])
        hands[0].set_pose(position=(x, 0, z))
        hands[1].set_pose(position=(-x, 0, z))
        world.advance(1 / 60)
    move.at = (closed, height)
    return world["ball"].gauges


def main():
    world, hands = make_gripper()
    move.at = (0.0, 0.0)
    for what, closed, height, frames in (
        ("closed", 0.006, 0.0, 15),
        ("lifted", 0.006, 0.03, 30),
        ("held", 0.006, 0.03, 15),
        ("opened", 0.0, 0.03, 20),
    ):
        gauges = move(world, hands, closed, height, frames)
        force = sum(pair.normal for pair in world.contact_pairs())
        print(f"{what:7} ball at {1e3 * gauges['z']:5.1f} mm, contacts press with {force:.2f} N")
    return world


if __name__ == "__main__":
    main()
