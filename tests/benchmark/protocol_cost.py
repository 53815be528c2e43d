#!/usr/bin/env python3
"""What the process protocol costs: a built-in engine with and without it, in turn, on 1000 bricks and a ball.

    protocol_cost.py BUILD [ENGINE]... [--times N]

BUILD is the folder in which plumb and process_server were built; ENGINE is bullet:si and ode:quick by default. The
table has medians of the CPU time of a step, of reading the state after it, and what both together take more through
the protocol, as a share of the step. Exits with 1 if the two do not give the same bits.
"""

import argparse
import json
import statistics
import subprocess
import sys

SCENE = ["wall-collapse", "--set", "rows=25", "--set", "columns=40", "--duration", "1"]


def measure(build, engine):
    """CPU time of a step and of reading after it, s, contacts a step, and the hash of the final state."""
    command = [f"{build}/plumb", "run", *SCENE, "--engine", engine, "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        metrics = json.loads(done.stdout)["metrics"]
    except json.JSONDecodeError:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}\n{done.stderr}")
    values = {name: metrics.get(name, {}).get("value") for name in ("time_per_step", "time_read", "contacts_mean", "state_hash")}
    return [values[name] for name in values]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("engines", nargs="*", default=["bullet:si", "ode:quick"])
    parser.add_argument("--times", type=int, default=5, help="runs of each kind (5)")
    arguments = parser.parse_args()
    differ = False
    print(f"{'engine':12} {'step, ms':>16} {'read, ms':>16} {'protocol / step':>16}  same bits")
    for engine in arguments.engines:
        name, _, profile = engine.partition(":")
        served = f"exec:{arguments.build}/process_server {name}" + (f":{profile}" if profile else "")
        rows = [(measure(arguments.build, engine), measure(arguments.build, served)) for _ in range(arguments.times)]
        (step, step_served), (read, read_served) = ([statistics.median(pair[side][column] for pair in rows) for side in (0, 1)]
                                                    for column in (0, 1))
        cost = statistics.median((b[0] + b[1] - a[0] - a[1]) / a[0] for a, b in rows)
        same = all(a[3] == b[3] and a[3] is not None for a, b in rows)
        differ |= not same
        print(f"{engine:12} {1e3 * step:7.3g} {1e3 * step_served:8.3g} {1e3 * read:7.3g} {1e3 * read_served:8.3g} {100 * cost:14.1f} %  {'yes' if same else 'NO'}")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
