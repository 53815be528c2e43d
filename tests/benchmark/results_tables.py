#!/usr/bin/env python3
"""Runs the commands of compare/RESULTS.md and prints its tables in Markdown, each below its commands:

    results_tables.py [--plumb PROGRAM] [--out DIRECTORY] [TABLE ...]

TABLE is canonical, paper, blocks, shapes, analytic, hard, thresholds or metamorphic; without one, all.
DIRECTORY keeps the results (default: results_tables). The tables of sweeps and
solvers are printed by plumb sweep and plumb solve themselves."""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys

PROFILES = ["plumb:accurate", "plumb", "plumb:fast"]
OTHERS = ["ode:quick", "bullet:si"]
# Each engine as shipped, and as its authors recommend.
CONFIGURATIONS = ["plumb", "ode:quick", "ode:recommended", "bullet:si", "bullet:recommended", "mujoco:default",
                  "mujoco:recommended"]
VERDICTS = ["accurate", "inaccurate", "failed"]
NOT_RUN = "not run"

# Label, arguments, repeats.
CANONICAL = [
    ("tower of 10, 10 s", "tower", 3),
    ("tower of 25", "tower --set n=25", 3),
    ("tower of 100", "tower --set n=100", 3),
    ("tower of 1000", "tower --set n=1000", 1),
    ("wall 25 × 40 at rest, 10 s", "wall --set rows=25 --set columns=40", 1),
    ("mass-ratio 100 : 1, 10 s", "mass-ratio --set k=2", 3),
    ("mass-ratio 10 000 : 1, 10 s", "mass-ratio --set k=4", 3),
    ("slope-stick, 60 s", "slope-stick", 3),
    ("slope-slide, 2 s: distance, relative", "slope-slide", 3),
    ("slide-to-stop, 3 s: distance, relative", "slide-to-stop", 3),
    ("pile of 100, 4 s: chaotic_error", "pile", 1),
    ("wall-collapse 10 × 10, 5 s: chaotic_error", "wall-collapse", 3),
    ("wall-collapse 25 × 40, 5 s: chaotic_error", "wall-collapse --set rows=25 --set columns=40", 1),
]
SHAPES = [
    ("rest-shape: cylinder on its cap", "rest-shape --set shape=1"),
    ("cylinder on its side", "rest-shape --set shape=2"),
    ("capsule", "rest-shape --set shape=3"),
    ("tetrahedron, a hull", "rest-shape --set shape=4"),
    ("icosahedron, a hull", "rest-shape --set shape=5"),
    ("L, a mesh", "rest-shape --set shape=6"),
    ("torus, a mesh", "rest-shape --set shape=7"),
    ("linked-rings", "linked-rings"),
    ("roll-slope: sphere, 2 s", "roll-slope"),
    ("cylinder", "roll-slope --set shape=1"),
    ("thin-wall: sphere at 200 m/s", "thin-wall"),
    ("plate at 200 m/s", "thin-wall --set shape=1"),
    ("rocket, thrust on the axis", "rocket"),
    ("thrust off the axis", "rocket --set offset=0.05"),
]
THRESHOLDS = ["slope-threshold", "slope-tip", "ladder", "overhang", "sphere-pyramid", "cylinder-pyramid", "arch"]
# Scene, arguments, and rows: label and the beginnings of the names of checks.
METAMORPHIC = [
    ("wall 10 × 10", "wall --set rows=10 --set columns=10 --duration 3",
     [("turned, mirrored, other orders", ("rotate", "mirror", "order")), ("a copy far away", ("far",)),
      ("1e6 m from the origin", ("shift-1e6",)), ("a new instance from half time", ("restart",))]),
    ("slope-slide", "slope-slide", [("turned by 45°", ("rotate-z45",))]),
    ("slide-to-stop", "slide-to-stop", [("turned by 45°", ("rotate-z45",)), ("mirrored", ("mirror",))]),
]


class Program:
    """Runs plumb, and prints each command once for the reader."""

    def __init__(self, path, directory):
        self.path, self.directory, self.runs = path, directory, 0

    def call(self, *arguments):
        print("   ", shlex.join(["plumb", *arguments]), flush=True)
        done = subprocess.run([self.path, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode not in (0, 3):
            sys.exit(done.stderr)

    def file(self, suffix):
        self.runs += 1
        return str(self.directory / f"{self.runs:03d}{suffix}")

    def compare(self, arguments, engines, repeats=1):
        """Results of plumb compare: case -> engine label -> list of repeats."""
        out = self.file("")
        extra = ["--repeat", str(repeats)] if repeats > 1 else []
        self.call("compare", *arguments.split(), *engine_options(engines), *extra, "--out", out)
        cases = {}
        for line in (pathlib.Path(out) / "results.jsonl").read_text(encoding="utf-8").splitlines():
            result = json.loads(line)
            case = (result["scenario"], json.dumps(result["params"], sort_keys=True))
            cases.setdefault(case, {}).setdefault(result["label"], []).append(result)
        return cases

    def json_lines(self, command, arguments, engines):
        out = self.file(".json")
        self.call(command, *arguments.split(), *engine_options(engines), "--json", out)
        text = pathlib.Path(out).read_text(encoding="utf-8")
        return json.loads(text) if text.startswith("[") else [json.loads(line) for line in text.splitlines()]


def engine_options(engines):
    return [word for spec in engines for word in ("--engine", spec)]


def label_of(spec):
    return "plumb:default" if spec == "plumb" else spec


def median(values):
    values = sorted(value for value in values if value is not None)
    return values[len(values) // 2] if values else None


def metric(results, name):
    return median([result["metrics"].get(name, {}).get("value") for result in results])


def number(value, unit=""):
    if value is None:
        return "–"
    text = f"{value:.2g}" if value == 0 or 1e-4 <= abs(value) < 1e6 else f"{value:.1e}".replace("e-0", "e-")
    return f"{text} {unit}".strip()


def error(results):
    """The primary error of a run: plain if it is accurate, slanted if it is not, bold where it failed."""
    if not results:
        return NOT_RUN
    worst = max(results, key=lambda result: VERDICTS.index(result["verdict"]) if result["verdict"] else -1)
    if worst["outcome"] != "ok":
        return worst["outcome"] if worst["verdict"] is None else f"**{worst['outcome']}**"
    unit = results[0]["metrics"].get("reference_error", {}).get("unit", "1").replace("1", "")
    text = number(metric(results, "reference_error"), unit)
    return {"accurate": text, "inaccurate": f"*{text}*", "failed": f"**{text}**", None: text}[worst["verdict"]]


def print_table(columns, rows):
    print("\n| " + " | ".join(columns) + " |\n|---" + "|---:" * (len(columns) - 1) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def canonical(program):
    engines, rows = [*PROFILES, "ode:quick", "ode:recommended", "bullet:si", "bullet:recommended"], []
    for label, arguments, repeats in CANONICAL:
        (runs,) = program.compare(arguments, engines, repeats).values()
        base = metric(runs["bullet:si"], "time_per_step")
        cells = []
        for spec in engines:
            time = metric(runs[label_of(spec)], "time_per_step")
            cells.append(error(runs[label_of(spec)]) + (f"<br>× {time / base:.2g}" if time and base else ""))
        rows.append([label, *cells])
    print_table(["scenario", *engines], rows)


def paper(program):
    engines, rows = PROFILES + ["bullet:si", "ode:quick"], []
    for (_, params), runs in program.compare("--suite paper", engines).items():
        cells = [f"{number(metric(runs[label_of(s)], 'iterations_mean'))}<br>{runs[label_of(s)][0]['outcome']}"
                 for s in engines]
        rows.append([f"tower n={json.loads(params)['n']:g}", *cells])
    print_table(["problem", *map(label_of, engines)], rows)


def blocks(program):
    engines, columns = ["plumb", *OTHERS], {}
    for kind, arguments in (("meshes", "--suite paper-blocks"), ("boxes", "--suite paper-blocks --set mesh=0")):
        for (_, params), runs in program.compare(arguments, engines, 3).items():
            row = columns.setdefault(json.loads(params)["n"], [])
            row += [number(1e3 * metric(runs[label_of(s)], "time_per_step")) for s in engines]
    heads = [f"{spec}, {kind}" for kind in ("meshes", "boxes") for spec in engines]
    print_table(["blocks: ms a step", *heads], [[f"{n:g}", *row] for n, row in columns.items()])


def shapes(program):
    engines = ["plumb", "plumb:fast", *OTHERS]
    rows = []
    for label, arguments in SHAPES:
        (runs,) = program.compare(arguments, engines).values()
        rows.append([label, *(error(runs[label_of(spec)]) for spec in engines)])
    print_table(["scenario", *engines], rows)


def suite(program, name):
    """The errors of a suite's scenes, and how many of them each engine got right."""
    cases = program.compare(f"--suite {name} --cpu-limit 20", CONFIGURATIONS)
    print_table(["scenario", *CONFIGURATIONS],
                [[scenario, *(error(runs.get(label_of(spec), [])) for spec in CONFIGURATIONS)]
                 for (scenario, _), runs in cases.items()])
    rows = []
    for spec in CONFIGURATIONS:
        verdicts = [runs[label_of(spec)][0]["verdict"] for runs in cases.values() if label_of(spec) in runs]
        rows.append([spec, *(str(verdicts.count(verdict)) for verdict in [*VERDICTS, None])])
    print_table(["engine", *VERDICTS, "not judged"], rows)


def analytic(program):
    suite(program, "analytic")


def hard(program):
    suite(program, "hard")


def thresholds(program):
    engines, rows = ["plumb:accurate", "ode:quick", "ode:dantzig", "bullet:si", "bullet:nncg"], []
    for scenario in THRESHOLDS:
        found = {row["label"]: row for row in program.json_lines("threshold", scenario, engines)}
        cells = []
        for spec in engines:
            row = found.get(spec)
            is_ours = spec.startswith("plumb") and row is not None and row["finding"] == "found"
            value = None if row is None else row["relative_error"] if is_ours else row["value"]
            cells.append(NOT_RUN if row is None else number(value) if is_ours else
                         f"{value:.5g}" if row["finding"] == "found" else row["finding"])
        form = found["plumb:accurate"]
        rows.append([f"{scenario}, {form['param']}", f"{form['closed_form']:.5g} {form['unit'].replace('1', '')}".strip(), *cells])
    print_table(["scenario", "closed form", "plumb:accurate, off by", *engines[1:]], rows)


def metamorphic(program):
    engines, rows = PROFILES + OTHERS, []
    for scene, arguments, wanted in METAMORPHIC:
        found = {row["label"]: row["checks"] for row in program.json_lines("metamorphic", arguments, engines)}
        for what, prefixes in wanted:
            cells = []
            for spec in engines:
                ends = [check["end"] for check in found[label_of(spec)] if check["check"].startswith(prefixes)]
                worst = max((end["position"] for end in ends), default=None)
                is_bitwise = ends and all(end["verdict"] == "bitwise" for end in ends)
                cells.append("bitwise" if is_bitwise else number(worst))
            rows.append([f"{scene}: {what}", *cells])
    print_table(["scene: what is changed", *engines], rows)


def main():
    tables = {f.__name__: f for f in (canonical, paper, blocks, shapes, analytic, hard, thresholds, metamorphic)}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plumb", default="build/compare/plumb")
    parser.add_argument("--out", default="results_tables", type=pathlib.Path)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=", ".join(tables))
    asked = parser.parse_args()
    unknown = [name for name in asked.tables if name not in tables]
    if unknown:
        parser.error(f"no table {unknown[0]}; there are {', '.join(tables)}")
    asked.out.mkdir(parents=True, exist_ok=True)
    program = Program(asked.plumb, asked.out)
    for name in asked.tables or tables:
        print(f"## {name}\n")
        tables[name](program)


main()
