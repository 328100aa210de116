"""One case by CalculiX: C3D10, displacements alone, so that Poisson's ratio stays below a half (0.499), and the law is
its own neo-Hookean one, whose stretches are isochoric: the answer is near that of the others, not the same. Its own load
steps. Seconds are of the processor, of the whole program with its reading and writing, which it cannot be told apart from."""
import os
import resource
import subprocess
import sys
import tempfile

import case as cases
import numpy as np

case = cases.make(sys.argv[1], "--quick" in sys.argv)
NU = cases.NU_OF_DISPLACEMENTS

# Middle nodes, in the order of C3D10: 12, 23, 31, 14, 24, 34.
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
middle, points = {}, [tuple(p) for p in case.points]


def between(a, b):
    key = (min(a, b), max(a, b))
    if key not in middle:
        middle[key] = len(points)
        points.append(tuple((case.points[a] + case.points[b]) / 2))
    return middle[key]


cells = [list(t) + [between(t[a], t[b]) for a, b in EDGES] for t in case.tets]
SIDES = {frozenset((0, 1, 2)): 1, frozenset((0, 1, 3)): 2, frozenset((1, 2, 3)): 3, frozenset((0, 2, 3)): 4}
side_of = {}
for number, t in enumerate(case.tets):
    for corners, side in SIDES.items():
        side_of.setdefault(frozenset(int(t[i]) for i in corners), []).append((number + 1, side))
held = sorted({n for t in case.held for n in t} | {between(a, b) for t in case.held for a, b in
                                                 ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))})


def lines(values):
    return ",\n".join(", ".join(str(v) for v in values[i:i + 12]) for i in range(0, len(values), 12))


def deck(first):
    out = ["*NODE, NSET=ALL"] + ["%d, %.15g, %.15g, %.15g" % (i + 1, *p) for i, p in enumerate(points)]
    out += ["*ELEMENT, TYPE=C3D10, ELSET=ALL"] + ["%d, %s" % (i + 1, ", ".join(str(n + 1) for n in c))
                                                 for i, c in enumerate(cells)]
    for r in sorted(set(case.region)):
        mu = float(case.mu[np.flatnonzero(case.region == r)[0]])
        bulk = 2 * mu * (1 + NU) / (3 * (1 - 2 * NU))
        out += ["*ELSET, ELSET=PART%d" % r, lines([int(i) + 1 for i in np.flatnonzero(case.region == r)]),
                "*MATERIAL, NAME=M%d" % r, "*HYPERELASTIC, NEO HOOKE", "%.15g, %.15g" % (mu / 2, 2 / bulk),
                "*DENSITY", "%g" % case.load.get("density", 1000),
                "*SOLID SECTION, ELSET=PART%d, MATERIAL=M%d" % (r, r)]
    out += ["*NSET, NSET=HELD", lines([n + 1 for n in held]), "*NSET, NSET=PROBE", str(case.probe + 1),
            "*BOUNDARY", "HELD, 1, 3", "*STEP, NLGEOM, INC=400", "*STATIC", "%g, 1., 1e-4" % first]
    if "gravity" in case.load:
        g = np.array(case.load["gravity"])
        out += ["*DLOAD", "ALL, GRAV, %g, %g, %g, %g" % (np.linalg.norm(g), *(g / np.linalg.norm(g)))]
    elif "traction" in case.load:
        force = {}
        for t in case.loaded:  # a quadratic triangle gives its middle nodes a third each, its corners nothing
            p = case.points[t]
            area = np.linalg.norm(np.cross(p[1] - p[0], p[2] - p[0])) / 2
            for a, b in ((0, 1), (1, 2), (2, 0)):
                n = between(t[a], t[b])
                force[n] = force.get(n, 0) + np.array(case.load["traction"]) * area / 3
        out += ["*CLOAD"] + ["%d, %d, %.15g" % (n + 1, c + 1, f[c]) for n, f in force.items() for c in range(3) if f[c]]
    else:
        out += ["*DLOAD"]
        for t in case.loaded:
            sides = side_of[frozenset(int(n) for n in t)]
            out += ["%d, P%d, %.15g" % (*sides[0], case.load["pressure"])]
    return "\n".join(out + ["*NODE PRINT, NSET=PROBE, FREQUENCY=1000", "U", "*END STEP", ""])


def solve(steps):
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "case.inp"), "w") as f:
            f.write(deck(1 / steps))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        ran = subprocess.run(["ccx", "case"], cwd=folder, capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if "Job finished" not in ran.stdout or "*ERROR" in ran.stdout:
            return None
        with open(os.path.join(folder, "case.dat"), encoding="utf-8") as f:
            rows = [line.split() for line in f if len(line.split()) == 4]
        with open(os.path.join(folder, "case.sta"), encoding="utf-8") as f:
            counts = [line.split() for line in f if line.strip() and line.split()[0].isdigit()]
    return seconds, sum(int(c[3]) for c in counts), np.array([float(v) for v in rows[-1][1:]]), len(counts)


found, _ = cases.ways(case, solve)
if found is None:
    sys.exit("CalculiX: %s did not arrive" % case.name)
cases.report(case, "CalculiX", found[0], found[3], found[1], 3 * len(points), case.points[case.probe] + found[2])
