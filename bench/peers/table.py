"""Runs each program on each case in turn, several times, and prints one table (bench/peers/run.sh)."""
import argparse
import json
import os
import re
import resource
import statistics
import subprocess
import sys

import case as cases
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.join(HERE, "..", "..")
OUT = os.path.join(ROOT, "out", "peers")


def isochor(name, quick, build, nu):
    """As the peers: its processor seconds are those of the whole program, reading, compiling and outputs included."""
    case = cases.make(name, quick)
    mesh = os.path.join(OUT, name + ".msh")
    case.write_mesh(mesh)
    scene = os.path.join(OUT, name + ".json")
    for steps in case.steps:
        with open(scene, "w", encoding="utf-8") as f:
            f.write(case.scene(mesh, nu, steps))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        ran = subprocess.run([os.path.join(build, "isochor"), "run", scene, "--threads", "1", "--json", "--out",
                              os.path.join(OUT, name)], capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if ran.returncode == 3:
            continue
        if ran.returncode != 0:
            sys.exit(ran.stderr)
        r = json.loads(ran.stdout)
        moved = np.array(r["probes"]["probe"])
        return {"program": "Isochor", "case": name, "tets": len(case.tets),
                "seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, "steps": steps,
                "iterations": r["newton_iterations"], "probe": list(case.points[case.probe] + moved)}
    return None


def peer(program, name, quick, limit):
    command = [sys.executable, os.path.join(HERE, program + "_case.py"), name] + (["--quick"] if quick else [])
    try:
        ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=limit)
    except subprocess.TimeoutExpired:
        return {"why": "no end within %d s" % limit}
    rows = [line for line in ran.stdout.splitlines() if line.startswith("{")]
    if ran.returncode != 0 or not rows:
        said = [line for line in ran.stderr.splitlines() if line.strip()]
        return {"why": said[-1] if said else "exit code %d" % ran.returncode}
    return json.loads(rows[-1])


def main():
    parser = argparse.ArgumentParser(prog="bench/peers/run.sh")
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(cases.NAMES))
    parser.add_argument("--quick", action="store_true", help="coarser meshes")
    parser.add_argument("--runs", type=int, default=3, help="of each, in turn; the median is printed")
    parser.add_argument("--build", default=os.path.join(ROOT, "build"), help="folder of isochor")
    parser.add_argument("--limit", type=int, default=1800, help="seconds that a peer may take")
    asked = parser.parse_args()
    for name in asked.cases:
        if name not in cases.NAMES:
            parser.error("no case '%s': %s" % (name, ", ".join(cases.NAMES)))
    if not os.path.exists(os.path.join(asked.build, "isochor")):
        parser.error("no isochor in %s: ./run builds it, --build names another folder" % asked.build)
    os.makedirs(OUT, exist_ok=True)
    programs = [("Isochor", lambda n: isochor(n, asked.quick, asked.build, 0.5))]
    programs += [(p, lambda n, p=p: peer(p, n, asked.quick, asked.limit)) for p in ("dolfinx", "getfem", "calculix")]
    with open("/proc/cpuinfo", encoding="utf-8") as f:
        processor = re.search(r"model name\s*: (.*)", f.read())
    lines = ["Processor: %s. Seconds of the processor, one thread, medians of %d runs." %
             (processor[1] if processor else "unknown", asked.runs), "",
             "| case | program | load steps | iterations | seconds | over Isochor | probe, off Isochor's by (of the length) |",
             "|---|---|---|---|---|---|---|"]
    for name in asked.cases or cases.NAMES:
        found = {}
        for _ in range(asked.runs):
            for program, run in programs:
                if "why" in found.get(program, [{}])[-1]:
                    continue
                print("%s, %s" % (name, program), file=sys.stderr, flush=True)
                found.setdefault(program, []).append(run(name) or {"why": "did not converge"})
        ours = statistics.median(r["seconds"] for r in found["Isochor"]) if "why" not in found["Isochor"][-1] else None
        case = cases.make(name, asked.quick)
        for program, rows in found.items():
            last = rows[-1]
            title = "%s, %d tets" % (name, len(case.tets))
            if "why" in last:
                lines.append("| %s | %s | | | | | %s |" % (title, program, last["why"]))
                continue
            seconds = statistics.median(r["seconds"] for r in rows)
            off = np.linalg.norm(np.array(last["probe"]) - found["Isochor"][-1].get("probe", np.nan)) / case.length
            lines.append("| %s | %s | %d | %d | %.2f | %s | %.1e |" % (
                title, last["program"], last["steps"], last["iterations"], seconds,
                "%.1f" % (seconds / ours) if ours else "", off))
    with open(os.path.join(OUT, "table.md"), "w", encoding="utf-8") as f:
        f.write("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
