"""Writes STATE.md, the state of the engines, from what compare/state measured: state.py FOLDER."""
import glob
import json
import os
import re
import sys
from collections import Counter, defaultdict

FOLDER = sys.argv[1]
NOTES = os.path.join(os.path.dirname(sys.argv[0]), "state_notes.md")
SUITES = ["canonical", "analytic", "hard", "chaotic", "reported", "field"]
UNKNOWN = "cause not known"
ADAPTERS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "adapters")


def read_engines():
    """The descriptions of engines by their names, in the order of reports."""
    engines = []
    for path in glob.glob(os.path.join(ADAPTERS, "*", "engine.json")):
        with open(path, encoding="utf-8") as file:
            engines.append(json.load(file))
    return {engine["name"]: engine for engine in sorted(engines, key=lambda engine: engine["place"])}


ENGINES = read_engines()


def text_of(name):
    with open(os.path.join(FOLDER, name), encoding="utf-8") as file:
        return file.read()


def lines_of(name):
    return [json.loads(line) for line in text_of(name).splitlines()]


def write(*lines):
    print("\n".join(lines))


def paragraph(text):
    """Prints a text on one line, however it is folded here, and an empty line."""
    write(" ".join(text.split()), "")


def table(heads, rows):
    write("| " + " | ".join(heads) + " |", "|" + "---|" * len(heads))
    for row in rows:
        write("| " + " | ".join(str(cell) for cell in row) + " |")
    write("")


def engine_of(label):
    return label.split(":")[0]


def number_of(text):
    """The number of a setting, such as 0.5 or 1/240."""
    above, _, below = text.partition("/")
    return float(above) / float(below or 1)


class State:
    """What was measured."""

    def __init__(self):
        self.runs = lines_of("runs/results.jsonl")
        self.engines = {engine["name"]: engine for engine in json.loads(text_of("engines.json"))}
        self.labels = sorted({run["label"] for run in self.runs}, key=place_of)
        self.suites_of = defaultdict(set)  # of a case of a suite, such as "tower n=100"
        for suite in json.loads(text_of("suites.json")):
            for case in suite["scenarios"]:
                self.suites_of[case].add(suite["name"])
        self.scenarios = json.loads(text_of("scenarios.json"))
        self.conformance = {}
        for path in glob.glob(os.path.join(FOLDER, "conformance-*.json")):
            with open(path, encoding="utf-8") as file:
                self.conformance.update({entry["label"]: entry for entry in json.load(file)["engines"]})
        self.findings = read_findings()

    def case_of(self, run):
        """The case of a suite that has the most of the run's parameters."""

        def values(case):
            return [setting.split("=") for setting in case.partition(" ")[2].split(",") if setting]

        def fits(case):
            params = run["params"]
            return case.split()[0] == run["scenario"] and all(
                float(params.get(key, "nan")) == number_of(value) for key, value in values(case)
            )

        return max(filter(fits, self.suites_of), key=lambda case: len(values(case)))

    def counts(self, label, suite=None):
        """How many runs have each verdict, or each outcome where there is no verdict."""
        return Counter(
            run["verdict"] or run["outcome"]
            for run in self.runs
            if run["label"] == label and (suite is None or suite in self.suites_of[self.case_of(run)])
        )

    def checks(self, label):
        """What plumb check-engine found, in words; None: it was not asked."""
        profile = label.split(":")[1]
        if label not in self.conformance:
            return None
        checks = [check for check in self.conformance[label]["checks"] if check["outcome"] != "skipped"]
        failed = [check["check"] for check in checks if check["outcome"] == "failed"]
        if not failed:
            return f"`{profile}` passed {len(checks)}"
        return f"`{profile}` failed {len(failed)} of {len(checks)}: {', '.join(failed)}"


def place_of(label):
    """Sorts labels: engines in their order, what is recommended last."""
    return list(ENGINES).index(engine_of(label)), label.endswith(":recommended"), label


def read_findings():
    """Case, label, error, cause and evidence of each run that is not accurate, as the report has them."""
    text = text_of("runs/summary.md")
    part = text[text.index("\n## Findings"):]
    part = part[: part.index("\n## ", 5)]
    lines = [line for line in part.splitlines() if line.startswith("| ")]
    rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]
    return [row for row in rows[1:] if engine_of(row[1]) != "plumb"]


def write_introduction(state):
    accurate = {label: state.counts(label)["accurate"] for label in state.labels}
    others = [label for label in state.labels if engine_of(label) != "plumb"]
    best, worst = (choose(others, key=accurate.get) for choose in (max, min))
    known = sum(row[3] != UNKNOWN for row in state.findings)
    cpus = sorted({run["host"]["cpu"] for run in state.runs})
    present = sum(engine["present"] for engine in state.engines.values())
    scenes = len({state.case_of(run) for run in state.runs})
    write("# The state of the engines", "")
    missed = sorted({state.case_of(run) for run in state.runs
                     if run["label"] == "plumb:default" and run["verdict"] in ("inaccurate", "failed")})
    paragraph(f"""{present} engines in {len(state.labels)} configurations ran {scenes} scenes. Each scene has a right
        answer: a closed form, a conservation law, a known resting place or converged statistics. The engine that this
        project ships, in `plumb:default`, misses {', '.join(f'`{case}`' for case in missed) or 'none'}. Of the other
        engines `{best}` is accurate on the most scenes, {accurate[best]}, and `{worst}` on the fewest,
        {accurate[worst]}. All run at the step of the scene. The other engines run
        with sleeping off, and the project's own skips islands at rest.""")
    write("![The first screen of the report: a sentence of verdict for each engine, and the matrix of all scenes and engines, coloured by error](report/state.png)", "")
    paragraph("""`./compare/state` makes this page and all of its numbers, in an hour on two cores. It can be
        stopped, and continues when it is started again. `plumb view state/runs` opens the whole report: a replay of every run, curves and
        tables.""")
    paragraph(f"""Measured with plumb {state.runs[0]['plumb']['version']} on {', '.join(cpus)}. A run ends after 20 s of
        the engine's CPU time. Of {len(state.findings)} findings {known} have a cause that an experiment shows.""")


def write_engines(state):
    write("## Engines", "")
    paragraph("""The first profile of an engine has its makers' own defaults, `recommended` what they advise for stacking
        and accuracy. `plumb list engines NAME` prints every setting with its source.""")
    rows = []
    for name, engine in state.engines.items():
        checks = [state.checks(f"{name}:{profile['name']}") for profile in engine.get("profiles", ())]
        rows.append(
            [
                f"[{ENGINES[name]['title']}](adapters/{name})",
                engine["version"] if engine["present"] else "absent",
                engine.get("runtime", ""),
                engine.get("precision", ""),
                "; ".join(filter(None, checks)) or "not checked",
            ]
        )
    table(["engine and its adapter", "version", "runs in", "precision", "checks of `plumb check-engine`"], rows)
    paragraph("""Each failed check is the engine's own behaviour. Programs of at most 30 lines, which need the engine
        alone, show it; they are in the folder `behaviour` of the adapter, whose README says what they print.""")


def write_verdicts(state):
    write("## Verdicts", "")
    paragraph("Accurate / inaccurate / failed, of the scenes of each suite. An unsupported scene is not counted.")
    rows = []
    for label in state.labels:
        cells = [state.counts(label, suite) for suite in (*SUITES, None)]
        texts = [f"{cell['accurate']} / {cell['inaccurate']} / {cell['failed']}" for cell in cells]
        rows.append([f"`{label}`", *texts, cells[-1]["unsupported"] or ""])
    table(["configuration", *SUITES, "all", "unsupported"], rows)


def thread_links(threads):
    """Links to "OWNER/REPOSITORY#NUMBER, ...", by the repository and the number."""
    links = []
    for thread in threads.split(", "):
        repository, _, number = thread.partition("#")
        links.append(f"[{repository.split('/')[1]}#{number}](https://github.com/{repository}/issues/{number})")
    return ", ".join(links)


def what_is_off(runs):
    """The outcomes of runs that failed, and the quantities that are off in the others: "collapsed, turn"."""
    words = []
    for run in runs:
        words += [run["outcome"]] if run["verdict"] == "failed" and run["outcome"] != "ok" else []
        words += [off["what"].split(":")[0].split(" of ")[0] for off in run.get("off") or []]
    return ", ".join(dict.fromkeys(words)) or "verdict"


def by_engine(state, labels, detail=None):
    """Configurations, grouped by engine and version: "ODE 0.16.2 (quick, dantzig)"; with the details of each, if
    there are any: "ODE 0.16.2 (quick: turn; dantzig: apex)"."""
    profiles = defaultdict(list)
    for label in labels:
        engine, _, profile = label.partition(":")
        profiles[engine].append(f"{profile}: {detail[label]}" if detail else profile)
    between = "; " if detail else ", "
    return "; ".join(
        f"{ENGINES[engine]['title']} {state.engines[engine]['version']} ({between.join(names)})"
        for engine, names in profiles.items()
    )


def symptom_rows(state):
    """Each reported symptom, with the configurations that are wrong, right and unsupported on its scenes."""
    rows = []
    for scenario in state.scenarios:
        if "symptom" not in scenario:
            continue
        runs = [
            run
            for run in state.runs
            if run["scenario"] == scenario["name"] and "reported" in state.suites_of[state.case_of(run)]
        ]
        ran = {run["label"] for run in runs}
        wrong = {run["label"] for run in runs if run["verdict"] in ("inaccurate", "failed")}
        judged = {run["label"] for run in runs if run["verdict"] is not None}
        if runs:
            lists = [
                [label for label in state.labels if label in group]
                for group in (wrong, judged - wrong, ran - judged)
            ]
            wrong_runs = defaultdict(list)
            for run in runs:
                if run["verdict"] in ("inaccurate", "failed"):
                    wrong_runs[run["label"]].append(run)
            detail = {label: what_is_off(own) for label, own in wrong_runs.items()}
            rows.append((scenario, detail, *lists))
    # Symptoms of the engine that this project ships come first, then those of the most configurations.
    return sorted(rows, key=lambda row: (not any(engine_of(label) == "plumb" for label in row[2]), -len(row[2])))


def write_symptoms(state):
    rows = symptom_rows(state)
    if not rows:
        return
    write("## Reported symptoms in these versions", "")
    paragraph(f"""Users of engines reported these symptoms in public threads. The suite `reported` has scenes
        after these threads, each with a right answer. A configuration that is accurate on all settings of a scene does not show
        the symptom. One that is not accurate may show it, or fail the scene in another way. The table names the outcome,
        or the quantities that are off, the worst three of each run.
        {sum(bool(detail) for _, detail, *_ in rows)} of {len(rows)} scenes are missed by some configuration. The threads
        are about other engines than Plumb's own, and so this is no ranking: what its users would report is not among
        the scenes.""")
    table(
        ["scene", "symptom", "reported in", "not accurate", "accurate", "unsupported"],
        [
            [
                f"`{scenario['name']}`",
                scenario["symptom"],
                thread_links(scenario["threads"]),
                by_engine(state, wrong, detail) or "–",
                *(by_engine(state, labels) or "–" for labels in lists),
            ]
            for scenario, detail, wrong, *lists in rows
        ],
    )
    write("`plumb compare --suite reported --with all --cpu-limit 20 --timeout 90`", "")


def write_thresholds(state):
    write("## Thresholds", "")
    paragraph("""At which angle a block slides or tips, how far blocks hang over, with which friction spheres stack: the
        critical value that the engine has, over that of statics. 1 is right; a word says that the scene holds always or
        never, or that the engine fails.""")
    values = defaultdict(dict)
    for row in lines_of("thresholds.json"):
        is_found = row["value"] is not None and row["closed_form"]
        text = f"{row['value'] / row['closed_form']:.4g}" if is_found else row["finding"]
        values[row["label"]][row["scenario"]] = text
    scenarios = list(dict.fromkeys(scenario for row in values.values() for scenario in row))
    labels = [label for label in state.labels if label in values]
    table(
        ["configuration", *scenarios],
        [[f"`{label}`", *(values[label].get(scenario, "–") for scenario in scenarios)] for label in labels],
    )
    write("`plumb threshold slope-threshold slope-tip overhang sphere-pyramid --with all --cpu-limit 20 --timeout 90`", "")


def write_speed():
    sweep = json.loads(text_of("speed/sweep.json"))
    names = [engine["name"] for engine in sweep["engines"]]
    write("## Speed at equal error, of native engines", "")
    paragraph("""How many times the CPU time of plumb another engine needs for the same error on `tower`, `slope-slide`,
        `slope-tip` and `rocket`, each at the best of its settings: the geometric mean over the scenes on which both
        reach that error, whose number is in brackets. Times in WebAssembly are left out.""")
    rows = []
    for pair in sweep["pairs"]:
        if ":" in names[pair["second"]] or ":" in names[pair["first"]]:
            continue
        means = [(level["mean_speed"] or {}).get("value") for level in pair["levels"]]
        texts = [
            "–" if mean is None else f"{mean:.3g} ({level['both']})" for mean, level in zip(means, pair["levels"])
        ]
        rows.append([names[pair["second"]], *texts])
    table(["engine", *(f"error {level['level']:.0e}" for level in sweep["pairs"][0]["levels"])], rows)
    engines = " ".join(f"--engine {engine['speed']}" for engine in ENGINES.values() if "speed" in engine)
    paragraph(f"""`plumb sweep tower slope-slide slope-tip rocket {engines} --cpu-limit 20 --timeout 90 --jobs 2
        --out speed`""")


def write_findings_of(name, state):
    title, tracker = ENGINES[name]["title"], ENGINES[name].get("makers")
    mine = [row for row in state.findings if engine_of(row[1]) == name]
    labels = [label for label in state.labels if engine_of(label) == name]
    causes = list(dict.fromkeys((cause, evidence) for _, _, _, cause, evidence in mine if cause != UNKNOWN))
    cells = defaultdict(dict)
    for case, label, error, cause, evidence in mine:
        mark = "?" if cause == UNKNOWN else causes.index((cause, evidence)) + 1
        cells[case][label] = f"{error.split(' (')[0]} [{mark}]"
    if not mine:
        return
    write(f"### {title}", "")
    table(
        ["case", *(f"`{label}`" for label in labels)],
        [[case, *(row.get(label, "") for label in labels)] for case, row in cells.items()],
    )
    for i, texts in enumerate(causes):
        write(f"- [{i + 1}] " + " ".join(f"{text[0].upper()}{text[1:]}." for text in texts if text != "–"))
    write("", f"The tracker of its makers: {tracker}", "")


def write_findings(state):
    write("## Findings", "")
    paragraph("""Every run that is not accurate. `plumb compare CASE --engine CONFIGURATION --cpu-limit 20` repeats a
        number, with `--set` before each parameter of the case; errors repeat to the last bit. A number in brackets names
        the cause below the table, which an experiment has shown; [?] is: cause not known. An empty cell is an accurate
        run or an unsupported scene.""")
    for name in ENGINES:
        write_findings_of(name, state)


def main():
    state = State()
    write_introduction(state)
    write_engines(state)
    write_verdicts(state)
    write_symptoms(state)
    write_thresholds(state)
    write_speed()
    with open(NOTES, encoding="utf-8") as notes:
        write(notes.read())
    write_findings(state)


if __name__ == "__main__":
    main()
