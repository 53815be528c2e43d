#!/usr/bin/env bash
# plumb gate as a user meets it: exit codes, formats, the baseline file, and files that cannot be written.
set -eu
command=gate
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# same FILE: the baseline is as it was kept.
same() {
    cmp -s "$1" kept.json || note_failure "$1 changed, or is not whole"
}

# Results with faults of known size.
cat >make.py <<'END'
import json, random

def row(scenario, label, repeat=0, factor=1.0, noise=0.0, **changes):
    noisy = lambda: 1 + noise * draw.uniform(-1, 1)
    metrics = {"penetration_max": 1e-3, "drift": 2e-5, "settle_time": 0.5}
    metrics.update(changes.pop("metrics", {}))
    made = {"schema": "plumb.result/1", "run": f"{scenario} {label} {repeat}", "scenario": scenario,
            "params": {"n": 12} if scenario == "tower" else {}, "scene_hash": "cafe", "label": label,
            "engine": label.split(":")[0], "seed": 0, "repeat": repeat, "outcome": "ok",
            "reason": None, "settings": {"dt": 1 / 60, "duration": 10.0},
            "metrics": {name: {"value": value} for name, value in metrics.items()}}
    time = 1e-5 * noisy() * (factor if label.startswith("mine") else 2)
    made["metrics"]["time_per_step"] = {"value": time, "deterministic": False}
    made.update(changes)
    return made

def write(name, rows):
    with open(name + ".jsonl", "w") as file:
        file.writelines(json.dumps(row) + "\n" for row in rows)

def runs(**options):
    return [row(scenario, label, repeat, **options) for repeat in range(7)
            for scenario in ("tower", "bounce") for label in ("mine:p", "bullet:si")]

draw = random.Random(1)
write("base", runs(noise=0.01))
for i in range(20):
    write(f"again{i}", runs(noise=0.01))
write("slow", runs(noise=0.01, factor=1.2))
write("slow_noisy", runs(noise=0.4, factor=1.2))
write("worse", runs(metrics={"penetration_max": 1.01e-3}))
write("better", runs(metrics={"penetration_max": 0.99e-3}))
write("removed", [r for r in runs() if r["scenario"] != "bounce"])
fallen = dict(outcome="collapsed", reason="body b1 fell")
write("fallen", [r | (fallen if r["label"] == "mine:p" and r["scenario"] == "tower" else {})
                 for r in runs()])
write("more", runs() + [row("top", "mine:p")])
write("empty", [])
hostile = "<a href=\"x\">'&\n::error::%0A,]]> \u00e9|`*"
write("hostile", [row(hostile, hostile, outcome="crashed", reason=hostile)])
write("hostile_before", [row(hostile, hostile)])
write("large", [row(f"scene {i}", "mine:p", metrics={f"metric_{k}": 1.0 for k in range(50)})
                for i in range(1000)])
END
python3 make.py

# Usage.
expect 2 'which results\?'
expect 2 'against what\?' base.jsonl
expect 2 'needs --baseline' base.jsonl --update-baseline
expect 2 'judges nothing' base.jsonl --update-baseline --baseline b.json --fail-if 'drift>1'
expect 2 'did you mean --baseline' base.jsonl --basline b.json
expect 2 'text, junit, github or json' base.jsonl --fail-if 'drift>1' --format xml
expect 2 'did you mean lift' base.jsonl --baseline b.json --tolerance lfit=1
expect 2 '--time-limit takes per cent' base.jsonl --baseline b.json --time-limit -1
expect 2 'column 7: a relative rule needs --baseline' base.jsonl --fail-if 'drift>+10%'
expect 2 'column 8: there is no metric dritf; did you mean' base.jsonl --fail-if 'tower: dritf>1'
expect 2 'did you mean bullet:si' base.jsonl --fail-if 'drift>1' --reference bulet:si
expect 2 'b.json: expected a baseline file, found none to read' base.jsonl --baseline b.json
expect 3 'none.jsonl: No such file' none.jsonl --fail-if 'drift>1'

# Update, and the same again, 20 times.
expect 0 '4 rows written to b.json' base.jsonl --baseline b.json --update-baseline
cp b.json kept.json
expect 0 'gate passed: .* of 4 rows, 0 notices' base.jsonl --baseline b.json
for i in $(seq 0 19); do
    expect 0 'gate passed: .* of 4 rows, 0 notices' "again$i.jsonl" --baseline b.json
done
mkdir report
cp base.jsonl report/results.jsonl
expect 0 'gate passed' report base.jsonl --baseline b.json
python3 - <<'END' || note_failure "the baseline is not sorted, or lost digits"
import json
text = open("b.json").read()
baseline = json.loads(text)
keys = [(r["scenario"], r["engine"]) for r in baseline["rows"]]
assert keys == sorted(keys) and len(keys) == 4
assert json.dumps(baseline, sort_keys=True) == json.dumps(json.loads(text))
assert baseline["rows"][0]["dt"] == 1 / 60 and baseline["schema"] == "plumb.baseline/1"
assert sum(line.strip().startswith('"drift":') for line in text.splitlines()) == 4
END
same b.json

# Faults.
expect 1 'FAIL  tower n=12 / mine:p: penetration_max: 0.001 m -> 0.00101 m, allowed: a difference of 1e-09 m \(worse by 1 %\)' \
    worse.jsonl --baseline b.json
grep -q 'gate failed: 4 failures in .* comparisons of 4 rows' out || note_failure "no summary line"
expect 0 'better by 1 %: --update-baseline' better.jsonl --baseline b.json
expect 0 'gate passed' worse.jsonl --baseline b.json --tolerance penetration_max=0.02
expect 0 'note .* time_per_step: not compared: the baseline has another reference' \
    slow.jsonl --baseline b.json --reference mine:p
expect 1 'FAIL  bounce / mine:p: outcome: ok -> missing' removed.jsonl --baseline b.json
expect 1 'FAIL  tower n=12 / mine:p: outcome: ok -> collapsed, .*body b1 fell' \
    fallen.jsonl --baseline b.json
grep -q '1 failure in' out || note_failure "a run that fell is not one failure: $(cat out)"
expect 0 'note  top / mine:p: outcome: none -> ok' more.jsonl --baseline b.json
expect 1 "FAIL  tower n=12 / mine:p: time_per_step: 0.[0-9]* times bullet:si's -> .*costlier" \
    slow.jsonl --baseline b.json
expect 0 'gate passed' slow.jsonl --baseline b.json --time-limit 40
expect 0 'note  .*time_per_step: .*inconclusive' slow_noisy.jsonl --baseline b.json
expect 4 'the results are empty' empty.jsonl --baseline b.json
expect 4 'the results are empty' empty.jsonl --baseline b.json --update-baseline
same b.json
echo '{"schema": "plumb.baseline/1", "rows": []}' >nothing.json
expect 4 'nothing was compared' base.jsonl --baseline nothing.json

# Rules, without a baseline and with one.
expect 0 'gate passed: 4 comparisons' base.jsonl --fail-if 'penetration_max>1.5e-3'
expect 1 "FAIL  tower n=12 / mine:p: penetration_max: 0.001 m, allowed: not tower/mine: pen" \
    base.jsonl --fail-if 'tower/mine: penetration_max>=1e-3'
expect 1 'the rule judges nothing' base.jsonl --fail-if 'twoer: drift>1'
expect 1 'costlier' slow.jsonl --baseline b.json --time-limit 50 --fail-if 'time_per_step>+10%'
expect 1 "times bullet:si's, allowed: not tower/mine" slow.jsonl --fail-if 'tower/mine: time_ratio>0.55'

# Baselines that are wrong, at their place.
for text in '{' '' '[]' '{"schema": "x", "rows": []}' '{"schema": "plumb.baseline/1"}'; do
    echo "$text" >bad.json
    expect 2 '^plumb gate: bad.json:[0-9]+:[0-9]+: ' base.jsonl --baseline bad.json
done
sed 's/"drift": 2.*/"drift": [1],/' b.json >bad.json
expect 2 'bad.json:8:14: rows\[0\].metrics.drift: expected a number, a text or null' base.jsonl \
    --baseline bad.json
sed 's/"repeats": 7/"repeats": -7/' b.json >bad.json
expect 2 'bad.json:.*repeats: expected a whole number above 0, found -7' base.jsonl --baseline bad.json
python3 - <<'END'
import json
baseline = json.load(open("b.json"))
baseline["rows"].append(baseline["rows"][1])
json.dump(baseline, open("bad.json", "w"))
END
expect 2 'bad.json:1:[0-9]+: rows\[4\]: expected another run than rows\[1\], found the same' base.jsonl \
    --baseline bad.json
expect 2 'expected a baseline file, found a directory' base.jsonl --baseline report
head -c 1000 base.jsonl >cut.jsonl
expect 0 'the last line is not whole, and left out' cut.jsonl --fail-if 'drift>1'
echo 'x' >bad.jsonl
expect 2 'bad.jsonl:1:' bad.jsonl --fail-if 'drift>1'

# Formats: each is what its readers take, with names and reasons that are markup to them.
expect 0 'written' hostile_before.jsonl --baseline h.json --update-baseline
for format in junit json; do
    expect 1 'gate failed' worse.jsonl --baseline b.json --format $format --out "worse.$format"
    expect 1 'gate failed' hostile.jsonl --baseline h.json --format $format --out "hostile.$format"
    expect 1 'gate failed' removed.jsonl --baseline b.json --format $format --out "removed.$format"
    expect 0 'gate passed' base.jsonl --baseline b.json --format $format --out "base.$format"
done
: >page.md
GITHUB_STEP_SUMMARY=page.md expect 1 '^::error title=tower n=12 / mine%3Ap::penetration_max: ' \
    worse.jsonl --baseline b.json --format github
GITHUB_STEP_SUMMARY=page.md expect 1 '^::error title=' hostile.jsonl --baseline h.json --format github
[[ $(grep -c '^::' out) == 1 && $(wc -l <out) == 2 ]] || note_failure "a reason ends its line: $(cat out)"
[[ $(grep -c '^### plumb gate failed' page.md) == 2 ]] || note_failure "the page is not appended to"
grep -qF '<a' page.md && note_failure "markup gets into the page"
GITHUB_STEP_SUMMARY=/dev/full expect 3 'No space left' worse.jsonl --baseline b.json --format github
python3 - <<'END' || note_failure "a format is wrong"
import json
import xml.etree.ElementTree as tree
for name, tests, failures in (("base", 4, 0), ("worse", 4, 4), ("removed", 4, 2), ("hostile", 1, 1)):
    suite = tree.parse(name + ".junit").getroot().find("testsuite")
    cases = suite.findall("testcase")
    found = sum(case.find("failure") is not None for case in cases)
    assert (len(cases), found) == (tests, failures), (name, len(cases), found)
    assert (int(suite.get("tests")), int(suite.get("failures"))) == (tests, failures)
    verdict = json.load(open(name + ".json"))
    assert verdict["schema"] == "plumb.gate/1" and len(verdict["failures"]) == failures
    assert verdict["verdict"] == ("failed" if failures else "passed")
    for failure in verdict["failures"]:
        assert failure["scenario"] and failure["engine"] and failure["metric"] and failure["allowed"]
END

# Disks that are full, and an update that is killed in the middle: the old file stays whole.
expect 3 'No space left' base.jsonl --baseline b.json --out /dev/full
expect 3 'No space left' base.jsonl --baseline /dev/full --update-baseline
expect 3 'Permission denied|No such file' base.jsonl --baseline none/b.json --update-baseline
actual=0
"$PLUMB" gate base.jsonl --baseline b.json >/dev/full 2>err || actual=$?
[[ $actual == 3 ]] || note_failure "standard output on a full disk: exit code $actual"
actual=0
(ulimit -f 8 -c 0; exec "$PLUMB" gate large.jsonl --baseline b.json --update-baseline) \
    >out 2>err || actual=$?
[[ $actual == 3 ]] && grep -q 'File too large' err || note_failure "a file that is too large: $actual $(cat err)"
same b.json
"$PLUMB" gate large.jsonl --baseline whole.json --update-baseline 2>err
for delay in 0.00 0.01 0.02 0.04 0.06 0.08 0.12; do
    cp kept.json b.json
    "$PLUMB" gate large.jsonl --baseline b.json --update-baseline 2>err &
    sleep $delay
    kill -KILL $! 2>err || true
    wait $! 2>err || true
    cmp -s b.json kept.json || cmp -s b.json whole.json || note_failure "killed: the baseline is not whole"
done
exit $failed
