#!/usr/bin/env python3
"""The table of what is to be fast, remade by one command: machine, build, medians of interleaved runs, and the hash
of the last state, which must be the same in all runs of a row.

    python3 bench/table.py [BUILD_FOLDER] [--runs N] [--quick] [--only WORD]

BUILD_FOLDER (build) has isochor, isochor_bench_step and isochor_bench_iterative. --quick leaves out what takes more than
a minute or so; --only takes the rows whose name has the word in it. Seconds of processor time mean something on a busy
machine, too; steps a second do not. Exit 1 where a run fails, or a hash differs.
"""
import json
import os
import re
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
MESHES = os.path.join(HERE, "..", "scenes", "meshes")


def run(command):
    """Its output, processor seconds and peak memory in GiB."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        text = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return text, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 2**20, process.returncode


def scene(build, arguments):
    text, cpu, memory, code = run([os.path.join(build, "isochor"), "run", *arguments, "--json"])
    if code not in (0, 1):  # 1: a metric is off, as it is for other elements and steps than the scene's own
        return None
    r = json.loads(text)
    counts = f"{r['newton_iterations']} iterations, {r['factorizations']} matrices, {r['solves']} solves"
    return {"hash": r["state_hash"], "counts": counts, "cpu": cpu, "wall": r["wall_s"], "memory": memory}


def block(build, arguments):
    text, _, _, code = run([os.path.join(build, "bench", "isochor_bench_iterative"), *arguments])
    m = re.search(r"(\d+) directions of +(\d+) iterations and +(\d+) matrices, +(\d+) Krylov.*total +([\d.]+) s  cpu +"
                  r"([\d.]+) s.*peak +([\d.]+) GiB.*state (\w+)", text)
    if code != 0 or not m:
        return None
    counts = f"{m[2]} iterations, {m[3]} matrices, {m[1]} solves, {m[4]} Krylov directions"
    return {"hash": m[8], "counts": counts, "wall": float(m[5]), "cpu": float(m[6]), "memory": float(m[7])}


def robots(build, threads):
    """Rows of isochor_bench_step, by name."""
    text, _, _, code = run([os.path.join(build, "bench", "isochor_bench_step"), "--meshes", MESHES, "--threads", threads])
    rows = {}
    for m in re.finditer(r"dynamic, (\w+)\.msh, (\w+): (\d+) tets.*\n +([\d.]+) steps/s \(median step ([\d.]+) ms, worst "
                         r"([\d.]+) times that\), (.*), hash (\w+)", text):
        rows[f"interactive, {m[3]} {m[2]}, {threads} threads"] = {
            "hash": m[8], "counts": m[7], "rate": float(m[4]), "worst": float(m[6])}
    for m in re.finditer(r"static, (\w+): (\d+) tets.*\n +(.*), analysis.*total ([\d.]+) s, peak memory ([\d.]+) GiB, hash (\w+)\n"
                         r".*factor ([\d.]+), solve ([\d.]+)", text):
        rows[f"bar at rest, {m[2]} {m[1]}, {threads} threads"] = {
            "hash": m[6], "counts": f"{m[3]}; factorization {m[7]} ms", "wall": float(m[4]), "memory": float(m[5])}
    return rows if code == 0 else None


def table_rows(quick):
    """Name, function of the build folder, arguments; a function may return several rows."""
    rows = [
        ("finger, ten static steps, edge-smoothed", scene, ["finger"]),
        ("finger, two static steps, Tet10", scene, ["finger", "--set", "bodies[0].element=tet10", "--set", "analysis.steps=2"]),
        ("block of Tet10, automatic", block, ["--tet10", "automatic", "8" if quick else "13"]),
        ("block of Tet10, factors", block, ["--tet10", "multifrontal", "8" if quick else "13"]),
        ("block, 249k Tet4, iterative", block, ["iterative", "12" if quick else "24"]),
        ("robots, one thread", robots, "1"),
        ("robots, two threads", robots, "2"),
    ]
    if not quick:
        rows.insert(5, ("block, 988k Tet4, iterative", block, ["iterative", "38"]))
    return rows


def main(arguments):
    build, runs, quick, only = os.path.join(HERE, "..", "build"), 3, False, ""
    while arguments:
        word = arguments.pop(0)
        if word == "--quick":
            quick = True
        elif word == "--runs" and arguments and arguments[0].isdigit():
            runs = max(1, int(arguments.pop(0)))
        elif word == "--only" and arguments:
            only = arguments.pop(0)
        elif os.path.isdir(word):
            build = word
        else:
            sys.exit(f'table.py: "{word}" is no folder and no option; see the head of the file')
    chosen = [row for row in table_rows(quick) if only in row[0]]
    if not chosen:
        sys.exit(f'table.py: --only "{only}" is in the name of no row')
    found, failed = {}, []
    for _ in range(runs):
        for name, function, argument in chosen:
            result = function(build, argument)
            if result is None:
                failed.append(name)
            elif function is robots:
                for key, value in result.items():
                    found.setdefault(key, []).append(value)
            else:
                found.setdefault(name, []).append(result)
    version = json.loads(run([os.path.join(build, "isochor"), "run", "squeezed_block", "--json"])[0])
    print(f"{version['machine']}; isochor {version['version']}, {version['build']}; medians of {runs} runs in turns\n")
    print("| what | work | processor time [s] | wall time [s] | steps a second | worst step over the median | memory [GiB] | state |")
    print("|---|---|---|---|---|---|---|---|")
    for name, results in found.items():
        def median(key, form):
            numbers = [r[key] for r in results if key in r]
            return format(statistics.median(numbers), form) if numbers else ""
        hashes = {r["hash"] for r in results}
        if len(hashes) > 1:
            failed.append(name + " (another state in each run)")
        print(f"| {name} | {results[0]['counts']} | {median('cpu', '.2f')} | {median('wall', '.2f')} | {median('rate', '.1f')} | "
              f"{median('worst', '.1f')} | {median('memory', '.2f')} | {', '.join(sorted(hashes))} |")
    for name in failed:
        print(f"failed: {name}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
