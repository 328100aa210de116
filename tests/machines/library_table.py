#!/usr/bin/env python3
"""Every scene of the library on 1 to 4 ranks against the engine alone: the table of docs/machines.md.

    python3 tests/machines/library_table.py [BUILD_FOLDER] [--ranks N,N,...] [--only SCENE,SCENE,...] [--jobs N]

BUILD_FOLDER (build-petsc) has isochor and isochor_compare_ranks. Exit 1 where a scene differs by more than 1e-8 of its length
or by more than one iteration of Newton's method a step, is refused, fails, or its ranks have different bits.
"""
import argparse
import concurrent.futures
import os
import re
import subprocess
import sys

# Scenes of many steps, or of large meshes, as they are cut short; all others run whole.
SHORT = {
    # Of the finger Newton's method may leave 1e-9 of the forces, which moves its bellows by 1e-8 on one process as well.
    "finger": "@analysis.force_tolerance=1e-10@steps 2",
    "tube": "@steps 3",
    "cushion": "@steps 3",
    "bubble": "@steps 3",
    "thick_tube_volume": "@steps 4",
    "thick_sphere": "@steps 2",
    "thick_sphere_volume": "@steps 2",
    "torsion": "@steps 2",
    "cable_finger": "@steps 4",
    "gas_tube": "@steps 4",
    "finger_lattice": "@steps 1",
    "two_chambers": "@steps 3",
    "puck": "@steps 3",
    "puck_skin": "@steps 3",
    "painted_arm": "@steps 3",
    "ball_drop": "@bodies[0].mesh.file=meshes/ball_small.msh@steps 24",
    "incline": "@steps 12",
    "squeezed_block": "@steps 10",
    "gripper": "@steps 4",
    "indented_puck": "@steps 1",
    "bellows": "@steps 4",
    "colliding_balls": "@steps 24",
    "elbow": "@steps 3",
}
SECONDS = 900  # of one scene at one number of ranks
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMP_NUM_THREADS": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}


def output(command, seconds):
    """Its text and whether it succeeded."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=seconds,
                              env={**os.environ, **ENVIRONMENT})
    except subprocess.TimeoutExpired:
        return f"took more than {seconds} s", False
    return done.stdout, done.returncode == 0


def names(build):
    text, good = output([os.path.join(build, "isochor"), "list"], 60)
    found = re.findall(r"^(\w+)  +\S", text, re.MULTILINE)[1:]
    if not good or not found:
        sys.exit(f"{build}/isochor list: no scenes; build isochor_cli and isochor_compare_ranks there first")
    return found


def compare(build, scene, ranks):
    """Difference, iterations, iterations alone; and what went wrong, or nothing."""
    text, good = output(["mpirun", "-n", str(ranks), os.path.join(build, "tests", "isochor_compare_ranks"),
                         scene + SHORT.get(scene, "")], SECONDS)
    m = re.search(r"difference ([\d.e+-]+|nan|inf) of the length, (\d+) iterations \(alone (\d+)\), (\d+) steps", text)
    trouble = "" if good and m else (text.strip().splitlines() or ["nothing said"])[-1].strip()
    return (m.groups() if m else None), trouble


def row(build, scene, numbers):
    results = [compare(build, scene, n) for n in numbers]
    known = [r for r, _ in results if r]
    cells = [scene, known[0][3] if known else "-", known[0][2] if known else "-"]
    cells += [f"{r[0]}, {r[1]}" + (" **differs**" if trouble else "") if r else "**failed**" for r, trouble in results]
    troubles = [f"{scene} on {n}: {trouble}" for n, (_, trouble) in zip(numbers, results) if trouble]
    return "| " + " | ".join(cells) + " |", troubles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default="build-petsc")
    parser.add_argument("--ranks", default="1,2,3,4")
    parser.add_argument("--only", default="")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    numbers = [int(n) for n in arguments.ranks.split(",")]
    known = names(arguments.build)
    scenes = arguments.only.split(",") if arguments.only else known
    if strangers := [s for s in scenes + list(SHORT) if s not in known]:
        sys.exit(f"no scenes of the library: {', '.join(strangers)}; see isochor list")
    print("| scene | steps | iterations alone | " + " | ".join(f"{n} rank{'s' * (n > 1)}" for n in numbers) + " |")
    print("|---|---|---|" + "---|" * len(numbers), flush=True)
    troubles = []
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for line, wrong in pool.map(lambda s: row(arguments.build, s, numbers), scenes):
            print(line, flush=True)
            troubles += wrong
    for trouble in troubles:
        print(trouble, file=sys.stderr)
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
