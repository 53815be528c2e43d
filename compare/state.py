"""Writes STATE.md, the state of the engines, from what compare/state measured: state.py FOLDER. The prose is in
state_notes.md."""
import glob
import json
import os
import re
import sys
from collections import Counter, defaultdict
from string import Template

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


def table(heads, rows):
    """A table in Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    text = "\n".join("| " + " | ".join(map(str, cells)) + " |" for cells in lines)
    return text.replace("| --- |", "|---|").replace(" --- |", "---|")


def engine_of(label):
    return label.split(":")[0]


def is_wrong(run):
    return run["verdict"] in ("inaccurate", "failed")


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


def missed_by(state, label):
    runs = [run for run in state.runs if run["label"] == label and is_wrong(run)]
    return ", ".join(f"`{case}`" for case in sorted({state.case_of(run) for run in runs})) or "none"


def engine_rows(state):
    for name, engine in state.engines.items():
        checks = [state.checks(f"{name}:{profile['name']}") for profile in engine.get("profiles", ())]
        yield [
            f"[{ENGINES[name]['title']}](adapters/{name})",
            engine["version"] if engine["present"] else "absent",
            engine.get("runtime", ""),
            engine.get("precision", ""),
            "; ".join(filter(None, checks)) or "not checked",
        ]


def verdict_rows(state):
    for label in state.labels:
        cells = [state.counts(label, suite) for suite in (*SUITES, None)]
        texts = [f"{cell['accurate']} / {cell['inaccurate']} / {cell['failed']}" for cell in cells]
        yield [f"`{label}`", *texts, cells[-1]["unsupported"] or ""]


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
        runs = defaultdict(list)
        for run in state.runs:
            if run["scenario"] == scenario["name"] and "reported" in state.suites_of[state.case_of(run)]:
                runs[run["label"]].append(run)
        if "symptom" in scenario and runs:
            judged = {label for label in runs if any(run["verdict"] is not None for run in runs[label])}
            wrong = {label: list(filter(is_wrong, own)) for label, own in runs.items() if any(map(is_wrong, own))}
            detail = {label: what_is_off(own) for label, own in wrong.items()}
            groups = (wrong, judged - wrong.keys(), runs.keys() - judged)
            lists = [[label for label in state.labels if label in group] for group in groups]
            rows.append((scenario, detail, *lists))
    # Symptoms of the engine that this project ships come first, then those of the most configurations.
    return sorted(rows, key=lambda row: (not any(engine_of(label) == "plumb" for label in row[2]), -len(row[2])))


def symptoms(state):
    rows = symptom_rows(state)
    cells = [
        [
            f"`{scenario['name']}`",
            scenario["symptom"],
            thread_links(scenario["threads"]),
            by_engine(state, wrong, detail) or "–",
            *(by_engine(state, labels) or "–" for labels in lists),
        ]
        for scenario, detail, wrong, *lists in rows
    ]
    heads = ["scene", "symptom", "reported in", "not accurate", "accurate", "unsupported"]
    return {
        "symptoms": table(heads, cells),
        "symptom_scenes": len(rows),
        "symptoms_missed": sum(bool(detail) for _, detail, *_ in rows),
    }


def thresholds(state):
    values = defaultdict(dict)
    for row in lines_of("thresholds.json"):
        is_found = row["value"] is not None and row["closed_form"]
        text = f"{row['value'] / row['closed_form']:.4g}" if is_found else row["finding"]
        values[row["label"]][row["scenario"]] = text
    scenarios = list(dict.fromkeys(scenario for row in values.values() for scenario in row))
    labels = [label for label in state.labels if label in values]
    rows = [[f"`{label}`", *(values[label].get(scenario, "–") for scenario in scenarios)] for label in labels]
    return table(["configuration", *scenarios], rows)


def speed():
    sweep = json.loads(text_of("speed/sweep.json"))
    names = [engine["name"] for engine in sweep["engines"]]
    rows = []
    for pair in sweep["pairs"]:
        if ":" in names[pair["second"]] or ":" in names[pair["first"]]:
            continue
        means = [(level["mean_speed"] or {}).get("value") for level in pair["levels"]]
        texts = [
            "–" if mean is None else f"{mean:.3g} ({level['both']})" for mean, level in zip(means, pair["levels"])
        ]
        rows.append([names[pair["second"]], *texts])
    return table(["engine", *(f"error {level['level']:.0e}" for level in sweep["pairs"][0]["levels"])], rows)


def findings_of(name, state):
    mine = [row for row in state.findings if engine_of(row[1]) == name]
    labels = [label for label in state.labels if engine_of(label) == name]
    causes = list(dict.fromkeys((cause, evidence) for _, _, _, cause, evidence in mine if cause != UNKNOWN))
    cells = defaultdict(dict)
    for case, label, error, cause, evidence in mine:
        mark = "?" if cause == UNKNOWN else causes.index((cause, evidence)) + 1
        cells[case][label] = f"{error.split(' (')[0]} [{mark}]"
    rows = [[case, *(row.get(label, "") for label in labels)] for case, row in cells.items()]
    notes = [
        f"- [{i + 1}] " + " ".join(f"{text[0].upper()}{text[1:]}." for text in texts if text != "–")
        for i, texts in enumerate(causes)
    ]
    lines = [f"### {ENGINES[name]['title']}", "", table(["case", *(f"`{label}`" for label in labels)], rows), "", *notes]
    return "\n".join([*lines, "", f"The tracker of its makers: {ENGINES[name].get('makers')}\n"]) if mine else ""


def values_of(state):
    """What stands for the names in the prose."""
    accurate = {label: state.counts(label)["accurate"] for label in state.labels}
    others = [label for label in state.labels if engine_of(label) != "plumb"]
    best, worst = (choose(others, key=accurate.get) for choose in (max, min))
    return {
        "present": sum(engine["present"] for engine in state.engines.values()),
        "configurations": len(state.labels),
        "scenes": len({state.case_of(run) for run in state.runs}),
        "missed": missed_by(state, "plumb:default"),
        "best": best,
        "most": accurate[best],
        "worst": worst,
        "fewest": accurate[worst],
        "version": state.runs[0]["plumb"]["version"],
        "cpus": ", ".join(sorted({run["host"]["cpu"] for run in state.runs})),
        "count": len(state.findings),
        "known": sum(row[3] != UNKNOWN for row in state.findings),
        "engines": table(
            ["engine and its adapter", "version", "runs in", "precision", "checks of `plumb check-engine`"],
            engine_rows(state),
        ),
        "verdicts": table(["configuration", *SUITES, "all", "unsupported"], verdict_rows(state)),
        **symptoms(state),
        "thresholds": thresholds(state),
        "speed": speed(),
        "speed_engines": " ".join(f"--engine {engine['speed']}" for engine in ENGINES.values() if "speed" in engine),
        "findings": "\n".join(filter(None, (findings_of(name, state) for name in ENGINES))),
    }


def main():
    with open(NOTES, encoding="utf-8") as notes:
        print(Template(notes.read()).substitute(values_of(State())), end="")


if __name__ == "__main__":
    main()
