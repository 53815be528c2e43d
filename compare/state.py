"""Writes STATE.md, the state of the engines, from what compare/state measured: state.py FOLDER."""
import glob
import json
import re
import sys
from collections import Counter, defaultdict

folder = sys.argv[1]


def lines_of(name):
    with open(f"{folder}/{name}") as file:
        return [json.loads(line) for line in file]


def document(name):
    with open(f"{folder}/{name}") as file:
        return json.load(file)


runs = lines_of("runs/results.jsonl")
engines = {engine["name"]: engine for engine in document("engines.json")}
conformance = {entry["label"]: entry for path in glob.glob(f"{folder}/conformance-*.json") for entry in json.load(open(path))["engines"]}
labels = sorted({run["label"] for run in runs}, key=lambda label: (label.split(":")[0] != "plumb", label))
SUITES = ["canonical", "analytic", "hard", "chaotic"]
TITLES = {"plumb": "plumb", "ode": "ODE", "bullet": "Bullet", "mujoco": "MuJoCo 2", "dart": "DART", "mujoco3": "MuJoCo 3", "rapier": "Rapier",
          "rapier-deterministic": "Rapier, deterministic build", "jolt": "Jolt", "physx": "PhysX", "havok": "Havok", "cannon": "cannon-es"}
OBJECT = {"ode": "https://bitbucket.org/odedevs/ode", "bullet": "https://github.com/bulletphysics/bullet3", "mujoco": "https://github.com/google-deepmind/mujoco",
          "dart": "https://github.com/dartsim/dart", "mujoco3": "https://github.com/google-deepmind/mujoco", "rapier": "https://github.com/dimforge/rapier.js",
          "rapier-deterministic": "https://github.com/dimforge/rapier.js", "jolt": "https://github.com/jrouwe/JoltPhysics.js",
          "physx": "https://github.com/fabmax/physx-js-webidl", "havok": "https://github.com/BabylonJS/havok", "cannon": "https://github.com/pmndrs/cannon-es"}


def write(*lines):
    print("\n".join(lines))


def table(heads, rows):
    write("| " + " | ".join(heads) + " |", "|" + "---|" * len(heads))
    for row in rows:
        write("| " + " | ".join(str(cell) for cell in row) + " |")
    write("")


def verdict(run):
    return run["verdict"] or ("unsupported" if run["outcome"] == "unsupported" else "not judged")


def judged(label):
    return [run for run in runs if run["label"] == label]


def checks_of(label):
    entry = conformance.get(label)
    if entry is None:
        return "not checked"
    failed = [check["check"] for check in entry["checks"] if check["outcome"] == "failed"]
    made = sum(check["outcome"] != "skipped" for check in entry["checks"])
    return f"{made} passed" if not failed else f"{len(failed)} of {made} failed: {', '.join(failed)}"


def number(value):
    return "–" if value is None else f"{value:.3g}"


def findings():
    """Case, engine, error, cause and evidence of each run that is not accurate, as the report has them."""
    with open(f"{folder}/runs/summary.md") as file:
        text = file.read()
    part = text[text.index("\n## Findings"):]
    part = part[:part.index("\n## ", 5)]
    rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in part.splitlines() if line.startswith("| ")]
    return [row for row in rows[1:] if not row[1].startswith("plumb")]


def introduction(found):
    known = sum(row[3] != "cause not known" for row in found)
    hosts = {run["host"]["cpu"] for run in runs}
    best = Counter()
    for label in labels:
        best[label] = sum(verdict(run) == "accurate" for run in judged(label))
    others = [label for label in best if not label.startswith("plumb:")]
    first = max(others, key=lambda label: best[label])
    worst = min(others, key=lambda label: best[label])
    total = len(judged(labels[0]))
    write("# The state of the engines", "",
          f"Twelve engines, in {len(labels)} configurations, ran {total} scenes that have a right answer: a closed form, a conservation law, a known resting place or converged statistics. "
          f"Plumb's own engine is accurate on {best['plumb:default']} of them. Of the others {first} is accurate on the most, {best[first]}, and {worst} on the fewest, {best[worst]}.", "",
          "![How the engines end a collapsing wall, and the matrix of all scenes](report/state.png)", "",
          "`./compare/state` makes this page and all of its numbers. It takes half an hour on two cores and goes on where it was stopped. "
          "`plumb view state/runs` opens the whole report: a replay of every run, curves and tables.", "",
          f"Measured with plumb {runs[0]['plumb']['version']} on {', '.join(sorted(hosts))}. A run may take 20 s of CPU time. "
          f"{known} of {len(found)} findings have a cause that an experiment shows; of the others the cause is not known.", "")


def engine_table():
    write("## Engines", "", "Each is as its makers ship it. `plumb list engines` prints every setting with its source.", "")
    rows = []
    for name, engine in engines.items():
        if not engine["present"]:
            rows.append([TITLES[name], "absent", "", "", ""])
            continue
        label = f"{name}:{engine['profiles'][0]['name']}"
        rows.append([TITLES[name], engine["version"], engine["runtime"], engine["precision"], checks_of(label)])
    table(["engine", "version", "runs in", "precision", "`plumb check-engine`"], rows)
    write("A failed check is the engine's own behaviour. These programs, which need the engine alone, show it: [adapters/web/behaviour](adapters/web/behaviour), "
          "[adapters/dart/behaviour](adapters/dart/behaviour).", "")


def verdict_table():
    write("## Verdicts", "", "Accurate / inaccurate / failed, of the scenes of each suite. What an engine does not support is not counted.", "")
    suites = {suite: set() for suite in SUITES}
    for suite in document("suites.json"):
        if suite["name"] in suites:
            suites[suite["name"]] = {entry.split()[0] for entry in suite["scenarios"]}
    rows = []
    for label in labels:
        cells = []
        for suite in SUITES:
            counts = Counter(verdict(run) for run in judged(label) if run["scenario"] in suites[suite])
            cells.append(f"{counts['accurate']} / {counts['inaccurate']} / {counts['failed']}")
        counts = Counter(verdict(run) for run in judged(label))
        rows.append([f"`{label}`", *cells, f"{counts['accurate']} / {counts['inaccurate']} / {counts['failed']}", counts["unsupported"] or ""])
    table(["configuration", *SUITES, "all", "unsupported"], rows)


def threshold_table():
    write("## Thresholds", "", "At which angle a block slides or tips, how far blocks hang over, with which friction spheres stack: the critical value that the engine has, over that of statics.",
          "1 is right; a word says that the engine holds always or never, or fails.", "")
    values = defaultdict(dict)
    scenarios = []
    for row in lines_of("thresholds.json"):
        if row["scenario"] not in scenarios:
            scenarios.append(row["scenario"])
        right = row["closed_form"]
        values[row["label"]][row["scenario"]] = f"{row['value'] / right:.4g}" if row["value"] is not None and right else row["finding"]
    table(["configuration", *scenarios], [[f"`{label}`", *(values[label].get(scenario, "–") for scenario in scenarios)] for label in labels if label in values])
    write("`plumb threshold slope-threshold slope-tip overhang sphere-pyramid --with all --cpu-limit 20 --timeout 90`", "")


def speed_table():
    sweep = document("speed/sweep.json")
    names = [engine["name"] for engine in sweep["engines"]]
    write("## Speed at equal error, of native engines", "",
          "How many times the CPU time of plumb another engine needs for the same error, at the best of its settings; in brackets on how many of the scenes both reach it. Times in WebAssembly are not comparable, and are left out.", "")
    rows = []
    for pair in sweep["pairs"]:
        if ":" in names[pair["other"]] or ":" in names[pair["ours"]]:
            continue
        cells = []
        for level in pair["levels"]:
            speed = level["mean_speed"]
            value = speed["value"] if isinstance(speed, dict) else speed
            cells.append("–" if value is None else f"{value:.3g} ({level['both']})")
        rows.append([names[pair["other"]], *cells])
    levels = [f"error {level['level']:.0e}" for level in sweep["pairs"][0]["levels"]] if sweep["pairs"] else []
    table(["engine", *levels], rows)
    write("`plumb sweep tower slope-slide slope-tip rocket --engine plumb --engine ode --engine bullet --engine mujoco --engine dart:recommended --cpu-limit 20 --timeout 90 --jobs 2 --out speed`", "")


def engine_findings(found):
    write("## Findings", "", "Every run that is not accurate, with the cause where an experiment has shown it. `plumb compare SCENARIO --engine CONFIGURATION --cpu-limit 20` repeats a number; "
          "errors repeat to the last bit.", "")
    for name in engines:
        mine = [row for row in found if row[1].split(":")[0] == name]
        if not mine:
            continue
        write(f"### {TITLES[name]}", "")
        groups = defaultdict(list)
        for case, label, error, cause, evidence in mine:
            groups[cause, evidence].append(f"{case} ({label.split(':', 1)[1]}: {error})")
        for (cause, evidence), cases in sorted(groups.items(), key=lambda group: group[0][0] == "cause not known"):
            write(f"- **{cause[0].upper()}{cause[1:]}.**" + ("" if evidence in ("–", "") else f" {evidence}."), f"  {'; '.join(cases)}", "")
        write(f"To object: {OBJECT[name]} has the makers' tracker, and this project's own takes corrections of the adapter. A correction needs one scene file, one command and the number it gives.", "")


found = findings()
introduction(found)
engine_table()
verdict_table()
threshold_table()
speed_table()
with open(sys.argv[0].replace("state.py", "state_notes.md")) as notes:
    write(notes.read())
engine_findings(found)
