#!/usr/bin/env python3
"""Makes arm.msh, circle.csv and still.csv: a square arm of hexahedra with three chambers along it, a circle for its tip,
and a place where it is to be at rest.

    python3 examples/drive/make_arm.py [FOLDER]
"""
import math
import pathlib
import sys

WIDTH, LENGTH = 0.030, 0.200  # [m]
ACROSS, ALONG = 5, 16
CHAMBERS = {"chamber_a": (1, 1), "chamber_b": (3, 1), "chamber_c": (2, 3)}


def node(i, j, k):
    return 1 + i + (ACROSS + 1) * (j + (ACROSS + 1) * k)


def sides(i, j, k):
    """The six faces of a cell, by the cell behind each."""
    n = [node(i + a, j + b, k + c) for c in (0, 1) for b in (0, 1) for a in (0, 1)]
    return {
        (i - 1, j, k): (n[0], n[2], n[6], n[4]), (i + 1, j, k): (n[1], n[3], n[7], n[5]),
        (i, j - 1, k): (n[0], n[1], n[5], n[4]), (i, j + 1, k): (n[2], n[3], n[7], n[6]),
        (i, j, k - 1): (n[0], n[1], n[3], n[2]), (i, j, k + 1): (n[4], n[5], n[7], n[6]),
    }


def arm():
    empty = {(i, j, k): name for name, (i, j) in CHAMBERS.items() for k in range(1, ALONG - 1)}
    cells = [(i, j, k) for k in range(ALONG) for j in range(ACROSS) for i in range(ACROSS) if (i, j, k) not in empty]
    names = ["clamped", *CHAMBERS]
    elements = []
    for i, j, k in cells:
        for behind, face in sides(i, j, k).items():
            if behind in empty:
                elements.append((3, 1 + names.index(empty[behind]), face))
        if k == 0:
            elements.append((3, 1, sides(i, j, k)[i, j, -1]))
        low = [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)]
        high = [n + (ACROSS + 1) ** 2 for n in low]
        elements.append((5, 1 + len(names), low + high))
    yield "$MeshFormat\n2.2 0 8\n$EndMeshFormat"
    yield f"$PhysicalNames\n{len(names) + 1}"
    for n, name in enumerate(names):
        yield f'2 {n + 1} "{name}"'
    yield f'3 {len(names) + 1} "body"\n$EndPhysicalNames'
    yield f"$Nodes\n{(ACROSS + 1) ** 2 * (ALONG + 1)}"
    for k in range(ALONG + 1):
        for j in range(ACROSS + 1):
            for i in range(ACROSS + 1):
                x, y, z = (WIDTH * (i / ACROSS - 0.5), WIDTH * (j / ACROSS - 0.5), LENGTH * k / ALONG)
                yield f"{node(i, j, k)} {x:.9g} {y:.9g} {z:.9g}"
    yield f"$EndNodes\n$Elements\n{len(elements)}"
    for n, (kind, group, nodes) in enumerate(elements):
        yield f"{n + 1} {kind} 2 {group} {group} " + " ".join(map(str, nodes))
    yield "$EndElements"


def circle(radius=0.005, steps=24):
    """In the first two steps to its rim, then around; how far the tip rises is left open."""
    yield "time,tip.x,tip.y"
    yield f"1,{radius / 2:.9g},0"
    for n in range(steps + 1):
        angle = 2 * math.pi * n / steps
        yield f"{n + 2},{radius * math.cos(angle):.9g},{radius * math.sin(angle):.9g}"


def still(aside=0.010, arrives=0.5, leaves=0.7, step=0.02):
    """At one place at each of several increments: there and not moving."""
    yield "time,tip.x,tip.y"
    for n in range(round((leaves - arrives) / step) + 1):
        yield f"{arrives + n * step:.9g},{aside:.9g},0"


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent
    (folder / "arm.msh").write_text("\n".join(arm()) + "\n")
    (folder / "circle.csv").write_text("\n".join(circle()) + "\n")
    (folder / "still.csv").write_text("\n".join(still()) + "\n")
