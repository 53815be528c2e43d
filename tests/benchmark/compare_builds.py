#!/usr/bin/env python3
"""Compares two builds of plumb: are the results the same bits, and what do they cost?

    compare_builds.py OLD NEW [--only GLOB]... [--times N] [--jobs N]

OLD and NEW are plumb executables. Every scenario of `OLD list scenarios` runs at default parameters on
all three profiles of plumb, once per build; the table names each run whose `state_hash` or outcome
differs. With --times N, four scenes also run N times per build, alternating A B A B, and the table shows
the median CPU time a step of each build and their ratio. Exits with 1 if any result differs.
"""

import argparse
import concurrent.futures
import fnmatch
import json
import re
import statistics
import subprocess
import sys

PROFILES = ("default", "accurate", "fast")
TIMED = (
    ("tower 100", ["tower", "--set", "n=100"]),
    ("wall 25 x 40", ["wall", "--set", "rows=25", "--set", "columns=40", "--duration", "1"]),
    ("wall-collapse 10 x 10", ["wall-collapse", "--set", "rows=10", "--set", "columns=10"]),
    ("pile 100", ["pile", "--set", "n=100", "--duration", "2"]),
)


def run(plumb, scene, profile):
    """The result of one run, as the command writes it; None if it wrote none."""
    command = [plumb, "run", *scene, "--engine", f"plumb:{profile}", "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        return json.loads(done.stdout)
    except json.JSONDecodeError:
        print(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}", file=sys.stderr)
        return None


def identity(result):
    """What two builds must agree on."""
    if result is None:
        return ("no result", None)
    return (result.get("outcome"), result["metrics"].get("state_hash", {}).get("value"))


def scenarios(plumb, globs):
    text = subprocess.run([plumb, "list", "scenarios"], capture_output=True, text=True, check=True).stdout
    names = re.findall(r"^([a-z][a-z0-9-]*)", text, re.MULTILINE)
    return [name for name in names if not globs or any(fnmatch.fnmatch(name, glob) for glob in globs)]


def compare_results(old, new, names, jobs):
    """Prints the table of results; the number of runs that differ."""
    cases = [(name, profile) for name in names for profile in PROFILES]

    def both(case):
        name, profile = case
        return case, identity(run(old, [name], profile)), identity(run(new, [name], profile))

    different = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for (name, profile), a, b in pool.map(both, cases):
            if a != b:
                different += 1
                print(f"{name:24} {profile:10} {a[0]} {a[1]}   ->   {b[0]} {b[1]}")
    print(f"{len(cases) - different} of {len(cases)} runs have the same outcome and state_hash")
    return different


def compare_times(old, new, times):
    print(f"{'median CPU time a step':24} {'profile':10} {'old':>12} {'new':>12} {'new/old':>8}")
    for label, scene in TIMED:
        for profile in PROFILES:
            seconds = {old: [], new: []}
            for _ in range(times):
                for plumb in (old, new):
                    result = run(plumb, scene, profile)
                    seconds[plumb].append(result["metrics"]["time_per_step"]["value"])
            a, b = statistics.median(seconds[old]), statistics.median(seconds[new])
            print(f"{label:24} {profile:10} {a * 1e6:9.2f} us {b * 1e6:9.2f} us {b / a:8.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--only", action="append", metavar="GLOB", help="scenarios to run (default: all)")
    parser.add_argument("--times", type=int, default=0, metavar="N", help="time four scenes N times a build")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at the same time (default: 1)")
    arguments = parser.parse_args()
    different = compare_results(arguments.old, arguments.new, scenarios(arguments.old, arguments.only),
                                arguments.jobs)
    if arguments.times > 0:
        compare_times(arguments.old, arguments.new, arguments.times)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
