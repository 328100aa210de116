"""The problems that all programs are given: arrays, a Gmsh file and a scene of each.

A case has points [m], tets, `mu` [Pa] and `region` a tet, triangles `held` (clamped) and `loaded`, and one load: a
dead `traction` [Pa], a follower `pressure` [Pa], or `gravity` [m/s^2] on `density` [kg/m^3]. Programs report where the
node `probe` ends.
"""
import json
import os

import meshio
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
MESHES = os.path.join(HERE, "..", "..", "scenes", "meshes")
NAMES = ["cantilever", "cook", "finger"]
NU_OF_DISPLACEMENTS = 0.499  # for programs without a mixed form of this order


class Case:
    def __init__(self, name, points, tets, region, mu, held, loaded, probe, steps, **load):
        self.name, self.points, self.tets, self.region, self.mu = name, points, tets, region, mu
        self.held, self.loaded, self.steps, self.load = held, loaded, steps, load
        self.probe = int(np.argmin(np.linalg.norm(points - np.array(probe), axis=1)))

    @property
    def length(self):
        return float(np.max(np.ptp(self.points, axis=0)))

    def write_mesh(self, path):
        """Gmsh 2.2: surfaces `held` (1) and `loaded` (2), regions `part0` (11), `part1` (12)."""
        regions = sorted(set(self.region))
        with open(path, "w") as f:
            f.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n2 1 \"held\"\n2 2 \"loaded\"\n"
                    % (2 + len(regions)))
            for r in regions:
                f.write('3 %d "part%d"\n' % (11 + r, r))
            f.write("$EndPhysicalNames\n$Nodes\n%d\n" % len(self.points))
            for i, p in enumerate(self.points):
                f.write("%d %.17g %.17g %.17g\n" % (i + 1, *p))
            f.write("$EndNodes\n$Elements\n%d\n" % (len(self.held) + len(self.loaded) + len(self.tets)))
            number = 0
            for kind, tags, cells in ((2, [1] * len(self.held), self.held), (2, [2] * len(self.loaded), self.loaded),
                                      (4, [11 + r for r in self.region], self.tets)):
                for tag, cell in zip(tags, cells):
                    number += 1
                    f.write("%d %d 2 %d %d %s\n" % (number, kind, tag, tag, " ".join(str(n + 1) for n in cell)))
            f.write("$EndElements\n")

    def scene(self, mesh, nu, steps):
        """A scene for `isochor run`; Tet10 with straight edges has the displacements of P2 on the same tets."""
        materials = []
        for r in sorted(set(self.region)):
            mu = float(self.mu[np.flatnonzero(self.region == r)[0]])
            materials.append({"region": "part%d" % r, "young": 2 * (1 + nu) * mu, "poisson": nu,
                              "density": self.load.get("density", 1000)})
        out = {
            "name": self.name, "title": self.name, "description": "As the peers have it.",
            "bodies": [{"name": "body", "mesh": {"file": mesh}, "element": "tet10", "materials": materials}],
            "analysis": {"steps": steps},
            "dirichlet": [{"name": "clamp", "where": {"surfaces": ["held"]}}],
            "probes": [{"name": "probe", "point": [float(v) for v in self.points[self.probe]]}],
        }
        if "gravity" in self.load:
            out["gravity"], out["gravity_amount"] = self.load["gravity"], 1
        elif "traction" in self.load:
            out["tractions"] = [{"name": "load", "surface": "loaded", "traction": self.load["traction"], "amount": 1}]
        else:
            out["cavities"] = [{"name": "load", "surfaces": ["loaded"], "amount": self.load["pressure"]}]
        return json.dumps(out, indent=1)


def _named(file):
    """Points, and cells by the name of their group."""
    mesh = meshio.read(os.path.join(MESHES, file))
    names = {int(v[0]): k for k, v in mesh.field_data.items()}
    groups = {}
    for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"]):
        for tag in np.unique(tags):
            groups.setdefault(names[int(tag)], []).append(block.data[tags == tag])
    return mesh.points, {k: np.concatenate(v) for k, v in groups.items()}


def _box(upper, n):
    """Kuhn's six tets a cell; the triangles of the face x = 0."""
    axes = [np.linspace(0, u, k + 1) for u, k in zip(upper, n)]
    points = np.array([(x, y, z) for x in axes[0] for y in axes[1] for z in axes[2]])
    index = lambda i, j, k: (i * (n[1] + 1) + j) * (n[2] + 1) + k
    tets = []
    for i in range(n[0]):
        for j in range(n[1]):
            for k in range(n[2]):
                for a, b, c in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)):
                    at, path = np.array([i, j, k]), []
                    for axis in (None, a, b, c):
                        if axis is not None:
                            at = at + np.eye(3, dtype=int)[axis]
                        path.append(index(*at))
                    p = points[path]
                    if np.linalg.det(p[1:] - p[0]) < 0:
                        path[2], path[3] = path[3], path[2]
                    tets.append(path)
    tets = np.array(tets)
    faces = {}
    for t in tets:
        for f in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)):
            faces.setdefault(tuple(sorted(t[list(f)])), []).append(t[list(f)])
    wall = np.array([f[0] for key, f in faces.items() if len(f) == 1 and np.all(points[list(key), 0] == 0)])
    return points, tets, wall


def make(name, quick=False):
    none = np.zeros((0, 3), dtype=int)
    if name == "cantilever":  # hangs down under its weight
        points, tets, wall = _box((1, 0.1, 0.1), (20, 2, 2) if quick else (40, 4, 4))
        region = np.zeros(len(tets), dtype=int)
        return Case(name, points, tets, region, np.full(len(tets), 266000 / 3), wall, none, (1, 0, 0), (1, 2, 4, 8, 16),
                    gravity=[0, -9.8, 0], density=1070)
    if name == "cook":
        points, groups = _named("cook3d_1.msh" if quick else "cook3d_3.msh")
        tets = groups["body"]
        return Case(name, points, tets, np.zeros(len(tets), dtype=int), np.full(len(tets), 80194000.0),
                    groups["clamped"], groups["loaded"], (0.048, 0.06, 0.005), (1, 2, 4, 8, 16),
                    traction=[0, 6250000, 0])
    if name == "finger":
        points, groups = _named("finger.msh" if quick else "finger_large.msh")
        body, layer = groups["body"], groups["limiting_layer"]
        tets = np.concatenate([body, layer])
        region = np.repeat([0, 1], [len(body), len(layer)])
        return Case(name, points, tets, region, np.where(region == 0, 1e5 / 3, 3e6 / 3), groups["clamped"],
                    groups["chamber"], (0.11, 0, 0), (2, 4, 8, 16, 32), pressure=10000)
    raise ValueError("no case '%s': %s" % (name, ", ".join(NAMES)))


def report(case, program, seconds, steps, iterations, unknowns, end):
    print(json.dumps({"program": program, "case": case.name, "tets": len(case.tets), "unknowns": int(unknowns),
                      "seconds": seconds, "steps": steps, "iterations": int(iterations),
                      "probe": [float(v) for v in end]}))


def ways(case, solve):
    """The fewest equal load steps with which `solve(steps)` arrives; what it returns, and the steps. Attempts that fail
    are not counted: each program is given the number that suits it."""
    for steps in case.steps:
        found = solve(steps)
        if found is not None:
            return found, steps
    return None, case.steps[-1]
