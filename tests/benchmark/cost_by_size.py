#!/usr/bin/env python3
"""What a step costs from 10 to 100,000 bodies, on plumb and on bullet:si: a table in Markdown and a plot.

    cost_by_size.py [--plumb PROGRAM] [--least N] [--most N] [--svg FILE] [SCENE ...]

SCENE is blocks, pile or multi-tower; without one, all. A run is one simulated second, 60 steps of 1/60 s, and
counts with the CPU time of a step, its mean over the run. The two engines run in turns, A B A B; the table
and the plot have the median of each one's runs, 5 up to 1000 bodies, 3 up to 20,000 and 2 beyond. All takes a
quarter of an hour on a free machine.

    blocks       boxes apart on the floor, at rest; default profile
    pile         spheres and boxes in about four layers fall and land: the first after 0.3 s, the last before
                 the end; profile fast
    multi-tower  towers of 10 cubes, at rest; default profile

The first steps of a second at rest cost more than those that follow, so the table also has the ratio of the
median steps."""
import argparse
import json
import math
import statistics
import subprocess
import sys

SIZES = [size * 10**decade for decade in range(1, 6) for size in (1, 2, 5) if size * 10**decade <= 100000]
RIVAL = "bullet:si"
LAYERS = 4  # of the pile's lattice at its start
TOWER = 10  # cubes


def blocks(bodies):
    return bodies, [f"n={bodies}", "mesh=0"]


def pile(bodies):
    return bodies, [f"n={bodies}", f"columns={math.ceil(math.sqrt(bodies / LAYERS))}"]


def multi_tower(bodies):
    side = max(1, round(math.sqrt(bodies / TOWER)))
    return side * side * TOWER, [f"k={side}", f"n={TOWER}"]


# Scene, its number of bodies and settings near a size, and the engine that is measured.
SCENES = {"blocks": (blocks, "plumb"), "pile": (pile, "plumb:fast"), "multi-tower": (multi_tower, "plumb")}


def run(program, scene, settings, engine):
    """The result of a run; None, and a message, where there is none with a time."""
    command = [program, "run", scene, "--duration", "1", "--timeout", "1200", "--engine", engine, "--json", "-"]
    command += [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    try:
        result = json.loads(done.stdout)
    except json.JSONDecodeError:
        result = {"outcome": f"exit code {done.returncode}", "metrics": {}}
    if result["outcome"] != "ok":
        print(f"{' '.join(command)}: {result['outcome']} {done.stderr}", file=sys.stderr)
    return result if result["metrics"].get("time_per_step", {}).get("value") is not None else None


def median(results, name, part="value"):
    return statistics.median(result["metrics"][name][part] for result in results)


def measure(program, scene, bodies, settings, ours):
    """A point of the plot: bodies, seconds a step of both engines, the ratio of median steps, and contact points."""
    runs = {ours: [], RIVAL: []}
    for _ in range(5 if bodies <= 1000 else 3 if bodies <= 20000 else 2):
        for engine, results in runs.items():
            results.append(run(program, scene, settings, engine))
            if results[-1] is None:
                return None
    seconds = [median(results, "time_per_step") for results in runs.values()]
    middle = [median(results, "time_per_step", "p50") for results in runs.values()]
    return bodies, *seconds, middle[0] / middle[1], median(runs[ours], "contacts_mean")


def digits(value):
    return f"{float(f'{value:.2g}'):g}"


def table(scene, ours, points):
    print(f"\n| {scene}: bodies | contact points a body | {ours}, µs a body | {RIVAL}, µs a body | ratio | ratio of the "
          "median steps |\n|---:|---:|---:|---:|---:|---:|")
    for bodies, a, b, middle, contacts in points:
        cells = [contacts / bodies, 1e6 * a / bodies, 1e6 * b / bodies, a / b, middle]
        print(f"| {bodies} | " + " | ".join(map(digits, cells)) + " |")


# ---- The plot ----

STYLE = """
  svg { font: 13px system-ui, sans-serif; --paper: #ffffff; --ink: #1f2328; --grid: #d8dee4; --a: #0b62c4; --b: #b34700; }
  @media (prefers-color-scheme: dark) {
    svg { --paper: #0d1117; --ink: #e6edf3; --grid: #30363d; --a: #6cb2ff; --b: #ffa657; } }
  .paper { fill: var(--paper); } text { fill: var(--ink); } .grid { stroke: var(--grid); }
  .a, .b { fill: none; stroke-width: 2.5; } .a { stroke: var(--a); } .b { stroke: var(--b); stroke-dasharray: 7 4; }
  .dot-a { fill: var(--a); } .dot-b { fill: var(--b); }
"""
LEFT, TOP, WIDTH, HEIGHT, GAP = 64, 64, 260, 270, 44  # px; of a panel and around it
NAMES = {0.001: "1 ns", 0.01: "10 ns", 0.1: "100 ns", 1: "1 µs", 10: "10 µs", 100: "100 µs", 1000: "1 ms"}


def plot(curves):
    """The SVG of scene -> (label of ours, points): the cost of a body and step over bodies, both logarithmic."""
    costs = [1e6 * seconds / p[0] for _, points in curves.values() for p in points for seconds in p[1:3]]
    sizes = [p[0] for _, points in curves.values() for p in points]
    low, high = math.floor(math.log10(min(costs))), math.ceil(math.log10(max(costs)))
    first, last = math.floor(math.log10(min(sizes))), math.ceil(math.log10(max(sizes)))
    parts = []

    def text(x, y, content, anchor="middle", more=""):
        parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{content}</text>')

    def line(x1, y1, x2, y2, css):
        parts.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{css}"/>')

    def mark(x, y, css):
        shape = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4"' if css == "a" else \
            f'<rect x="{x - 3.5:.1f}" y="{y - 3.5:.1f}" width="7" height="7"'
        parts.append(f'{shape} class="dot-{css}"/>')

    def down(microseconds):
        return TOP + HEIGHT * (high - math.log10(microseconds)) / max(high - low, 1)

    for i, (scene, (ours, points)) in enumerate(curves.items()):
        left = LEFT + i * (WIDTH + GAP)

        def right(bodies, left=left):
            return left + WIDTH * (math.log10(bodies) - first) / max(last - first, 1)

        for decade in range(low, high + 1):
            line(left, down(10**decade), left + WIDTH, down(10**decade), "grid")
            if i == 0:
                text(left - 8, down(10**decade) + 4, NAMES.get(10**decade, f"1e{decade} µs"), "end")
        for decade in range(first, last + 1):
            line(right(10**decade), TOP, right(10**decade), TOP + HEIGHT, "grid")
            text(right(10**decade), TOP + HEIGHT + 18, f"{10**decade:,}")
        text(left + WIDTH / 2, TOP - 12, f"{scene} ({ours})", more=' font-weight="600"')
        for css, k in (("b", 2), ("a", 1)):
            places = [(right(p[0]), down(1e6 * p[k] / p[0])) for p in points]
            parts.append(f'<polyline class="{css}" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in places)}"/>')
            for x, y in places:
                mark(x, y, css)
    width, height = LEFT + len(curves) * (WIDTH + GAP), TOP + HEIGHT + 48
    text(width / 2, height - 10, "bodies")
    text(LEFT, 20, "CPU time of a step, divided by the number of bodies", "start", ' font-weight="600"')
    for x, css, name in ((width - 220, "a", "plumb"), (width - 130, "b", RIVAL)):
        line(x, 16, x + 30, 16, css)
        mark(x + 15, 16, css)
        text(x + 36, 20, name, "start")
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
            f'<style>{STYLE}</style>\n<rect class="paper" width="100%" height="100%"/>\n' + "\n".join(parts) + "\n</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plumb", default="build/compare/plumb", metavar="PROGRAM")
    parser.add_argument("--least", type=int, default=SIZES[0], metavar="N", help="bodies of the smallest scene")
    parser.add_argument("--most", type=int, default=SIZES[-1], metavar="N", help="bodies of the largest scene")
    parser.add_argument("--svg", default="cost_by_size.svg", metavar="FILE", help="the plot (default: cost_by_size.svg)")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    asked = parser.parse_args()
    unknown = [name for name in asked.scenes if name not in SCENES]
    if unknown:
        parser.error(f"no scene {unknown[0]}; there are {', '.join(SCENES)}")
    sizes = [size for size in SIZES if asked.least <= size <= asked.most]
    if not sizes:
        parser.error(f"no size from {asked.least} to {asked.most}; there are {', '.join(map(str, SIZES))}")
    curves = {}
    for scene in asked.scenes or SCENES:
        of_size, ours = SCENES[scene]
        scenes = dict(map(of_size, sizes))
        points = [measure(asked.plumb, scene, bodies, settings, ours) for bodies, settings in scenes.items()]
        curves[scene] = (ours, [point for point in points if point is not None])
        table(scene, ours, curves[scene][1])
    if not any(points for _, points in curves.values()):
        sys.exit("nothing was measured")
    with open(asked.svg, "w", encoding="utf-8") as file:
        file.write(plot(curves))


if __name__ == "__main__":
    main()
