"""What a world costs in Python: the loop of examples/finger.cpp there and in C++, by turns.

    python3 bench/python_step.py [--frames 60] [--rounds 5] [--threads 1]

Prints the seconds of each loop, best of all rounds, and their ratio. Run it on a quiet machine after
`cmake --build build`.
"""

import argparse
import os
import re
import subprocess
import sys
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]
BUILD = Path(os.environ.get("ISOCHOR_BUILD", SOURCE / "build"))
sys.path.insert(0, str(BUILD / "python"))

import isochor as iso  # noqa: E402

MESH = SOURCE / "scenes" / "meshes" / "finger_small.msh"


def loop_in_python(frames, threads):
    world = iso.World(threads=threads)
    finger = world.add_body(iso.read_mesh(MESH), iso.neo_hookean(young=100e3, poisson=0.5, density=1070))
    world.add(iso.volume(finger))
    world.add(iso.dirichlet(finger, surfaces="clamped"))
    air = world.add(iso.cavity(finger, surfaces="chamber"))
    seconds = 0.0
    for frame in range(1, frames + 1):
        start = time.perf_counter()
        air.amount = 100.0 * frame
        world.advance(1 / 60)
        world.positions(finger)
        if frame > 1:
            seconds += time.perf_counter() - start
    return seconds, world.state_hash


def loop_in_cpp(frames, threads):
    done = subprocess.run(
        [BUILD / "tests" / "isochor_finger_loop", MESH, str(frames)],
        env={**os.environ, "ISOCHOR_THREADS": str(threads)},
        capture_output=True,
        text=True,
        check=True,
    )
    seconds = float(re.search(r"^seconds (.*)$", done.stdout, re.M)[1])
    return seconds, int(re.findall(r"^state (.*)$", done.stdout, re.M)[-1], 16)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    best = {"C++": float("inf"), "Python": float("inf")}
    for _ in range(options.rounds):
        cpp, cpp_hash = loop_in_cpp(options.frames, options.threads)
        python, python_hash = loop_in_python(options.frames, options.threads)
        if cpp_hash != python_hash:
            sys.exit("the two loops do not end with the same bits")
        best = {"C++": min(best["C++"], cpp), "Python": min(best["Python"], python)}
    for name, seconds in best.items():
        print(f"{name:7} {seconds:8.4f} s for {options.frames - 1} steps, {1e3 * seconds / (options.frames - 1):.3f} ms each")
    print(f"ratio   {best['Python'] / best['C++']:.3f}")


if __name__ == "__main__":
    main()
