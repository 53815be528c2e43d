#!/usr/bin/env bash
# plumb tune as a user meets it: settings that meet a target, the profile they are saved as, exit codes.
set -eu
command=tune
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
further=(--force)

target='reference_error<=1e-3'
expect 2 'which scenario' --engine plumb --target "$target"
expect 2 'one engine is tuned at a time' tower --target "$target"
expect 2 'one engine is tuned at a time' tower --engine plumb --engine plumb:fast --target "$target"
expect 2 'to what' tower --engine plumb
expect 2 'did you mean reference_error' tower --engine plumb --target 'reference_eror<=1'
expect 2 'METRIC<=VALUE' tower --engine plumb --target 'reference_error>=1'
expect 2 'did you mean slop' tower --engine plumb --target "$target" --vary slip=1..2
expect 2 'is empty' tower --engine plumb --target "$target" --vary slop=1e-3..1e-4
expect 2 '--budget takes an integer' tower --engine plumb --target "$target" --budget 0
expect 2 'unknown engine|there is no engine' tower --engine plumg --target "$target"
expect 4 'does not do' slope-stick --engine "$BUILD/faulty_engine.so:refuse" --target "$target"

# An engine of free fall: its error is that of its step, 0.495 dt.
cp "$BUILD/faulty_engine.so" gone.so
fall=(free-fall --engine ./gone.so:good --duration 1 --target 'value_error<=0.004')
expect 0 'the cheapest found' "${fall[@]}" --budget 16 --json fall.json --out saved
[[ -s saved/faulty.profile.json ]] || note_failure "no profile was saved: $(ls -R)"
python3 - <<'END' || note_failure "the JSON is wrong: $(cat fall.json)"
import json
found = json.load(open("fall.json"))
assert found["schema"] == "plumb.tuning/1" and found["met"] is True
assert found["cost"] > 0 and found["validation"]
assert found["sensitivity"] and all(moved["cost_ratio"] > 0 for moved in found["sensitivity"])
assert len(found["trials"]) <= 16
values = [tuple(sorted(trial["values"].items())) for trial in found["trials"]]
assert len(set(values)) == len(values)
assert found["on"][0]["metrics"]["value_error"] <= 0.004
assert 0 < found["setting"]["dt"] <= 1 / 123, found["setting"]
assert found["validated"] == (len(found["validation"]) > 0 and
                              all(check["excess"] <= 0 for check in found["validation"]))
END

# All of it follows from the results, without the engine; and other settings of the study do not mix with them.
further=()
expect 2 'results of another tuning' "${fall[@]}" --budget 17 --out saved --resume
expect 2 'results of another tuning' "${fall[@]}" --budget 16 --seed 1 --out saved --resume
rm gone.so
"$PLUMB" report saved --out reported >report.text 2>/dev/null || note_failure "plumb report failed"
for file in tune.json tune.md tune.html; do
    cmp "saved/$file" "reported/$file" || note_failure "plumb report makes another $file"
done
cmp saved/tune.json fall.json || note_failure "--json is not tune.json"
grep -q 'the cheapest found for value_error' report.text || note_failure "plumb report says nothing: $(cat report.text)"
# What is not finished is concluded as far as it came.
mkdir part
head -n 30 saved/results.jsonl >part/results.jsonl
"$PLUMB" report part --out concluded >/dev/null 2>err || note_failure "a part is not concluded: $(cat err)"
grep -q 'not come to its end' concluded/tune.md || note_failure "a part is not marked: $(cat concluded/tune.md)"
grep -q 'not come to its end' saved/tune.md && note_failure "a whole tuning is marked as a part"
head -n 1 saved/results.jsonl >part/results.jsonl
"$PLUMB" report part --out none >/dev/null 2>err && note_failure "one result was concluded"
grep -q 'no trial yet' err || note_failure "one result: $(cat err)"
python3 - <<'END' || note_failure "the runs are not what they should be"
import json
rows = [json.loads(line) for line in open("saved/results.jsonl")]
found = json.load(open("saved/tune.json"))
part = json.load(open("concluded/tune.json"))
assert found["finished"] is True and part["finished"] is False
studies = [row["study"] for row in rows]
assert found["runs"] == len(rows) == len({row["run"] for row in rows})
assert part["trials"] == found["trials"][:len(part["trials"]) - 1] + part["trials"][-1:]
assert {study["phase"] for study in studies} == {"search", "final", "sensitivity"}
# A time is compared to one of the default settings that was measured next to it.
if found["search_cost"] == "cpu_time":
    trials = {study["trial"] for study in studies if study["phase"] == "search" and study["values"]}
    beside = {study["trial"] for study in studies if study["phase"] == "search" and study["values"] is None}
    assert beside - {None} == trials, (trials, beside)
assert sum(study["phase"] == "final" and study["values"] is None for study in studies) == 5
END
further=(--force)

# None: said so, with the nearest.
expect 3 'no settings found meet value_error<1e-09; the nearest' free-fall \
    --engine "$BUILD/faulty_engine.so:good" --duration 1 --target 'value_error<1e-9' --budget 10

# Our own engine, its API, and its profile, which is the same settings by another name.
expect 0 'pe_world_step\(world, 1\.0 / [0-9]+' tower slope-stick --engine plumb:fast --duration 0.2 \
    --set n=2 --target 'reference_error<=1e-3' --target 'penetration_max<1e-2' --budget 4 --fix \
    impact_bodies=2 --vary dt=1/120..1/30 --out profiles
profile=profiles/plumb.profile.json
"$PLUMB" run tower --duration 0.1 --engine plumb:tuned --profiles "$profile" --json by_name.json >/dev/null
PLUMB_PROFILES=$profile "$PLUMB" run tower --duration 0.1 --engine plumb:tuned --json by_env.json >/dev/null
python3 - <<'END' || note_failure "the profile is not what was tuned: $(cat profiles/plumb.profile.json)"
import json
profile = json.load(open("profiles/plumb.profile.json"))
for name in "by_name.json", "by_env.json":
    run = json.load(open(name))
    assert run["outcome"] == "ok" and run["profile"] == "fast" == profile["profile"]
    for option, value in profile["options"].items():
        assert run["settings"][option] == value, option
END
expect 2 'unknown profile' tower --engine plumb:tuend --target "$target"

exit $failed
