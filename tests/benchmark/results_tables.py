#!/usr/bin/env python3
"""Runs the commands of compare/RESULTS.md and prints its tables in Markdown, each below its commands:

    results_tables.py [--plumb PROGRAM] [--out DIRECTORY] [TABLE ...]

TABLE is canonical, paper, blocks, shapes, analytic, hard, chaotic, heaps, heap_speed, losses, thresholds,
metamorphic, sweep or solvers; without one, all. DIRECTORY keeps the results (default: results_tables); sweeps and a
benchmark of solvers that are there are not repeated."""
import argparse
import json
import pathlib
import shlex
import statistics
import subprocess
import sys

PROFILES = ["plumb:accurate", "plumb", "plumb:fast"]
OTHERS = ["ode:quick", "bullet:si"]
DESCRIPTIONS = sorted((json.loads(path.read_text(encoding="utf-8")) for path in
                       pathlib.Path(__file__).parents[2].glob("compare/adapters/*/engine.json")), key=lambda e: e["place"])
# Each engine as shipped, and as its authors recommend.
CONFIGURATIONS = [spec for engine in DESCRIPTIONS for spec in engine.get("results", ())]
LINKED = [engine["name"] for engine in DESCRIPTIONS if engine["adapter"] == "linked"]
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
    ("pile of 100, 4 s: chaotic_error", "pile", 3),
    ("wall-collapse 10 × 10, 5 s: chaotic_error", "wall-collapse", 3),
    ("wall-collapse 25 × 40, 5 s: chaotic_error", "wall-collapse --set rows=25 --set columns=40", 1),
]
# Label, arguments, repeats.
HEAPS = [
    ("wall-collapse 10 × 10, 5 s", "wall-collapse", 5),
    ("wall-collapse 25 × 40, 5 s", "wall-collapse --set rows=25 --set columns=40", 1),
    ("falling-cubes, 4 s", "falling-cubes", 5),
    ("pile of 100, 20 s", "pile --duration 20", 3),
    ("pile of 1000, 4 s", "pile --set n=1000", 1),
    ("container of 100 boxes, 4 s", "container --duration 4", 3),
    ("the same, 30 s", "container", 3),
    ("medley of 80 shapes, 6 s", "medley", 1),
    ("rubble of 300 hulls, 6 s", "rubble", 1),
    ("domino-spiral of 150, 12 s", "domino-spiral", 3),
    ("yawed tower of 20, 10 s", "tower --set n=20 --set yaw=0.1", 5),
]
HEAP_ENGINES = ["plumb", "plumb:accurate", "bullet:si", "ode:quick"]
OVERLAPS = [5e-3, 1e-3, 2e-4]
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
        self.call(command, *arguments.split(), *engine_options(engines), "--json", out, "--out", self.file(""))
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
    plain = value == 0 or 1e-4 <= abs(value) < 1e6
    text = f"{float(f'{value:.2g}'):g}" if plain else f"{value:.1e}".replace("e-0", "e-")
    return f"{text} {unit}".strip()


def power(level):
    return f"{level:.0e}".replace("e-0", "e-")


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


def print_table(columns, rows, align="---:"):
    print("\n| " + " | ".join(columns) + " |\n|---" + f"|{align}" * (len(columns) - 1) + "|")
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


def chaotic(program):
    """chaotic_error and what dominates it, with plumb at three values of its slop."""
    slops = ["1e-5", "1e-4", "1e-3"]
    ours = [f"{profile},slop={slop}" for profile in PROFILES[:2] for slop in slops]
    others = ["plumb:fast", *CONFIGURATIONS[1:]]
    rows = []
    for scenario in ("falling-cubes", "pile", "wall-collapse"):
        (runs,) = program.compare(f"{scenario} --cpu-limit 60", ours + others).values()
        # Labels leave out an option that has its default, but the results are in the order of the command.
        cells = [f"{error(results)} {part(results[0])}".strip() for results in runs.values()]
        rows.append([scenario, ", ".join(cells[:3]), ", ".join(cells[3:6]), *cells[6:]])
    print_table(["scenario", f"plumb:accurate, slop {', '.join(slops)} m", "plumb, the same", *others], rows)


def part(result):
    """The part of a chaotic error that dominates it, as the first letter of its metric."""
    letters = {"penetration_p99": "o", "penetration_max": "d", "statistics_error": "s", "energy_gain": "e",
               "momentum_error": "m", "free_flight_error": "f"}
    return letters.get(result["metrics"].get("chaotic_error", {}).get("part"), "")


def heaps(program):
    """Time and overlap in heaps, and what else is asked of the engine there."""
    rows, laws = [], []
    names = ["momentum_error", "energy_step_gain", "drift"]
    for label, arguments, repeats in HEAPS:
        (runs,) = program.compare(f"{arguments} --timeout 600", HEAP_ENGINES, repeats).values()
        cells = []
        for spec in HEAP_ENGINES:
            found = runs[label_of(spec)]
            mean, middle = (relative(found, runs["bullet:si"], part) for part in ("value", "p50"))
            usual, deepest = (of_series(found, "penetration_max", part) for part in ("p95", "value"))
            cells.append(f"× {number(mean)}, × {number(middle)}<br>{millimetres(usual)}, {millimetres(deepest)} mm")
        rows.append([label, *cells])
        for spec in HEAP_ENGINES[:2]:
            found = runs[label_of(spec)]
            longest = of_series(found, "time_per_step", "p99") / of_series(found, "time_per_step", "p50")
            laws.append([label, spec, number(of_series(found, "residual_rms", "p95")),
                         *(number(metric(found, name)) for name in names), number(longest)])
    print_table(["scenario", *HEAP_ENGINES], rows)
    print_table(["scenario", "profile", "residual_rms, 95 % of steps", *names, "time: p99 over median"], laws)


def of_series(results, name, part):
    return median([result["metrics"].get(name, {}).get(part) for result in results])


def relative(found, base, part):
    time = of_series(found, "time_per_step", part)
    return time / of_series(base, "time_per_step", part) if time else None


def millimetres(distance):
    return number(None if distance is None else 1e3 * distance)


def heap_speed(program):
    """CPU time for a simulated second at the same overlap, relative to the fastest setting of plumb."""
    out = program.directory / "heap_speed"
    program.call("sweep", "wall-collapse", "falling-cubes", "pile", "container", "--duration", "4", "--changes", "0", "--home", "plumb",
                 "--jobs", "2", "--resume", "--out", str(out))
    best = {}
    for line in (out / "results.jsonl").read_text(encoding="utf-8").splitlines():
        result = json.loads(line)
        overlap = result["metrics"].get("penetration_max", {}).get("p95")
        time = result["metrics"].get("time_per_step", {}).get("value")
        if result["outcome"] == "ok" and overlap is not None and time is not None:
            label, _, varied = result["label"].partition(",")
            engine, dt = label.split(":")[0], result["settings"]["dt"]
            setting = f"{label}{' varied' if varied else ''}, 1/{round(1 / dt)} s"
            for level in OVERLAPS:
                if overlap <= level:
                    at = best.setdefault((result["scenario"], level), {})
                    at[engine] = min(at.get(engine, (float("inf"), "")), (time / dt, setting))
    rows = []
    for (scenario, level), at in sorted(best.items(), key=lambda item: (item[0][0], -item[0][1])):
        ours = at.get("plumb", (None, ""))[0]
        rows.append([scenario, number(1e3 * level, "mm"), at.get("plumb", (None, "–"))[1],
                     *(f"× {number(at[name][0] / ours)}<br>{at[name][1]}" if name in at and ours else "not reached"
                       for name in LINKED[1:])])
    print_table(["scenario", "overlap", *LINKED], rows)


def losses(program):
    """What a page on losses needs: other time steps, heaps of meshes, memory."""
    rows = []
    for scenario in ("rocking-block", "slide-and-spin", "top"):
        for dt in ("1/60", "1/240"):
            (runs,) = program.compare(f"{scenario} --dt {dt}", PROFILES[:1] + OTHERS).values()
            rows.append([f"{scenario}, {dt} s", *(error(runs[label_of(s)]) for s in PROFILES[:1] + OTHERS)])
    print_table(["scenario", "plumb:accurate", *OTHERS], rows)
    engines, rows = PROFILES + OTHERS, []
    for arguments in ("pile --set shape=3", "wall-collapse --set rows=25 --set columns=40"):
        (runs,) = program.compare(arguments, engines).values()
        base = metric(runs["bullet:si"], "time_per_step")
        rows.append([arguments] + [f"× {metric(runs[label_of(s)], 'time_per_step') / base:.2g}, "
                                   f"{number(metric(runs[label_of(s)], 'penetration_max'), 'm')}, "
                                   f"{metric(runs[label_of(s)], 'memory_peak') / 2**20:.0f} MiB" for s in engines])
    print_table(["scenario: time of a step, deepest overlap, memory", *engines], rows)


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


def solvers(program):
    """Problems solved from a cold start, of those that stand or slide and of collapses and piles, and times."""
    out = program.directory / "solvers"
    if not (out / "levels.jsonl").exists():
        captures = pathlib.Path(__file__).parent / "contact_problems.sh"
        subprocess.run([captures, program.path, out], check=True)
        benchmark = pathlib.Path(program.path).parent / "solve_benchmark"
        subprocess.run([benchmark, "--json", out / "levels.part", *sorted(out.glob("*.json"))], check=True,
                       stdout=subprocess.DEVNULL)
        (out / "levels.part").rename(out / "levels.jsonl")
    rows = [json.loads(line) for line in (out / "levels.jsonl").open(encoding="utf-8")]
    rows = [{**row, "problem": pathlib.Path(row["problem"]).stem} for row in rows if row["start"] == "cold"]
    levels = sorted({row["tolerance"] for row in rows}, reverse=True)
    names = list(dict.fromkeys(row["solver"] for row in rows))
    seconds = {(row["solver"], row["tolerance"], row["problem"]): row["seconds"] for row in rows if row["reached"]}
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    moving = {name for name in problems if name.startswith(("collapse", "pile"))}
    counts, means = [], []
    for solver in names:
        solved = [[name for name in problems if (solver, level, name) in seconds] for level in levels]
        counts.append([solver, *(f"{len(set(of) - moving)} / {len(set(of) & moving)}" for of in solved)])
        ratios = [[seconds[solver, level, name] / seconds["gauss_seidel", level, name]
                   for name in of if ("gauss_seidel", level, name) in seconds] for level, of in zip(levels, solved)]
        means.append([solver, *(number(statistics.geometric_mean(of)) if of else "–" for of in ratios)])
    heads = [f"to {power(level)} m/s" for level in levels]
    print(f"Of {len(problems) - len(moving)} that stand or slide / of {len(moving)} collapses and piles:")
    print_table(["solver", *heads], counts)
    print_table(["CPU time over gauss_seidel", *heads], means[1:])


SWEEP_LEVELS = [1e-2, 1e-3]


def two_digits(value):
    return f"{float(f'{value:.2g}'):g}"


def factor(at):
    """How many times as fast plumb is as the other engine at this error."""
    if at["first_point"] is None and at["second_point"] is None:
        return "neither"
    if at["speed"] is None:
        return "plumb alone" if at["second_point"] is None else "it alone"
    value, low, high = (two_digits(at["speed"][key]) for key in ("value", "low", "high"))
    return f"× {value} ({low} to {high})"


def settings_of(scene, sweep, best):
    """One row for each engine: its best point at the least error of SWEEP_LEVELS that it reaches."""
    rows = []
    for engine, points in best.items():
        level = min((level for level in SWEEP_LEVELS if points[level] is not None), default=None)
        name = sweep["engines"][engine]["name"]
        if level is None:
            (curve,) = [curve for curve in scene["curves"] if curve["engine"] == engine]
            rows.append([scene["name"], name, "–", f"not with {curve['settings']} settings"])
        else:
            point = sweep["points"][points[level]]
            label = point["label"].replace(",", ", ")
            rows.append([scene["name"], name, power(level), f"{label} at 1/{1 / point['dt']:.0f} s"])
    return rows


def sweep(program):
    """Speed at the same error, as shipped and at each engine's best, and the settings that were best."""
    out = program.directory / "sweep"
    program.call("sweep", "--suite", "canonical", "--jobs", "2", "--home", "plumb", "--resume", "--out", str(out))
    found = json.loads((out / "sweep.json").read_text(encoding="utf-8"))
    names = [engine["name"] for engine in found["engines"] if engine["all_profiles"] and not engine["home"]]
    factors, settings = [], []
    for scene in found["scenes"]:
        pairs = [pair for pair in scene["pairs"] if found["engines"][pair["second"]]["name"] in names]
        best = {}
        for wanted in SWEEP_LEVELS:
            row = [scene["name"], power(wanted)]
            for pair in pairs:
                (level,) = [level for level in pair["levels"] if level["level"] == wanted]
                row.append(f"{factor(level['as_shipped'])}<br>{factor(level)}")
                best.setdefault(pair["first"], {})[wanted] = level["first_point"]
                best.setdefault(pair["second"], {})[wanted] = level["second_point"]
            factors.append(row)
        settings += settings_of(scene, found, best)
    print_table(["scenario", "error", *names], factors)
    print_table(["scenario", "engine", "error", "best settings"], settings, align="---")


def main():
    tables = {f.__name__: f
              for f in (canonical, paper, blocks, shapes, analytic, hard, chaotic, heaps, heap_speed, losses,
                        thresholds, metamorphic, sweep, solvers)}
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
