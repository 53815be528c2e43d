#!/usr/bin/env bash
# Replays an experiment of each cause in compare/report/known_causes.json, from known_causes_experiments.json; all
# where REPLAY=all, as compare/state does. What no experiment shows is named there by `by`: a modified adapter, a
# debugger, a run that takes minutes. Fails with the name of a cause when an outcome or a number is not the recorded one, or
# when a statement covers a profile or the end of a range in which nobody ran it.
set -eu
exec python3 - "$PLUMB" "$SOURCE/compare/report/known_causes.json" \
    "$SOURCE/tests/compare/known_causes_experiments.json" <<'END'
import concurrent.futures
import json
import os
import re
import subprocess
import sys

plumb, path, experiments_path = sys.argv[1:]
with open(path) as file, open(experiments_path) as experiments_file:
    known = json.load(file)
    shown = json.load(experiments_file)
for cause in known["causes"]:
    cause.update(shown[cause["id"]])
listed = subprocess.run([plumb, "list", "engines"], capture_output=True, text=True, check=True).stdout
versions = dict(re.findall(r"^([a-z0-9-]+) +([0-9][0-9.]*) ", listed, re.M))
profiles = [f"{engine}:{profile}" for engine, names in known["profiles"].items() for profile in names]
failures = []


def name(cause):
    return f"{cause['engine']}, {'/'.join(cause['scenarios'])}: {cause['cause'] or 'cause not known'}"


def number(value):
    """A number, also as a text with a fraction."""
    numerator, _, denominator = str(value).partition("/")
    return float(numerator) / float(denominator or 1)


def is_replayed(cause):
    oldest, newest = cause.get("versions", known["versions"][cause["engine"]])
    return versions.get(cause["engine"]) in (oldest, newest)


def required_runs(cause):
    """(scenario, parameters, engine) in which a statement must have been tried: each end of its ranges."""
    specs = [spec for spec in profiles if spec.startswith(cause["engine"] + ":") and
             cause.get("profile", spec.split(":")[1]) == spec.split(":")[1]]
    for scenario, ranges in cause["scenarios"].items():
        ends = [{key: number(end)} for key, pair in ranges.items() for end in pair] or [{}]
        for spec in specs:
            for end in ends:
                yield *off_default(scenario, end), spec


def off_default(scenario, parameters):
    step = 0.1 if scenario == "large-step" else 1 / 60
    return scenario, {key: value for key, value in parameters.items() if (key, round(value, 9)) != ("dt", round(step, 9))}


def parsed(run):
    scenario, *settings = run.split()
    return off_default(scenario, {key: number(value) for key, value in (text.split("=") for text in settings)})


def result_of(job):
    """What one run gives: its result, or the message of a command that failed."""
    run, spec = job
    scenario, *settings = run.split()
    command = [plumb, "run", scenario, "--engine", spec, "--timeout", "100", "--json", "-"]
    for setting in settings:
        command += ["--duration", setting[9:]] if setting.startswith("duration=") else ["--set", setting]
    done = subprocess.run(command, capture_output=True, text=True)
    return json.loads(done.stdout) if done.stdout else done.stderr.strip()


def faults_of(experiment, result):
    if isinstance(result, str):
        return [result]
    faults = []
    if result["outcome"] != experiment["outcome"]:
        faults.append(f"outcome: expected {experiment['outcome']}, found {result['outcome']}")
    for metric, (least, largest) in experiment.get("metrics", {}).items():
        value = result["metrics"].get(metric, {}).get("value")
        if not isinstance(value, (int, float)) or not least <= value <= largest:
            faults.append(f"{metric}: expected {least:g} to {largest:g}, found {value}")
    return faults


experiments = []
for cause in known["causes"]:
    if not is_replayed(cause):
        print(f"not replayed, found with another version: {name(cause)}")
        continue
    tried = [(*parsed(e["run"]), spec) for e in cause["experiments"] for spec in e["engines"]]
    for scenario, end, spec in required_runs(cause) if cause.get("outcome") != "timeout" else ():
        if (scenario, end, spec) not in tried:
            failures.append(f"{name(cause)}: no experiment for {scenario} {end} on {spec}")
    if not cause["experiments"] and "by" not in cause:
        failures.append(f"{name(cause)}: no experiment")
    replayed = [(cause, e, spec) for e in cause["experiments"] for spec in e["engines"]]
    experiments += replayed if os.environ.get("REPLAY") == "all" else replayed[:1]

# A run that shows two causes is made once.
jobs = sorted({(experiment["run"], spec) for _, experiment, spec in experiments})
with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
    results = dict(zip(jobs, pool.map(result_of, jobs)))
for cause, experiment, spec in experiments:
    failures += [f"{name(cause)}: {experiment['run']} on {spec}: {fault}"
                 for fault in faults_of(experiment, results[experiment["run"], spec])]
print(f"{len(jobs)} runs")
sys.exit("\n".join(failures) if failures else 0)
END
