#!/usr/bin/env bash
# A plug-in is an engine like any other in all commands: list, tune with its saved profile, searches and
# studies; what it reads back is compared to its own precision, and its faults are reported.
set -eu
command=
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

export ASAN_OPTIONS=detect_leaks=0
small_engine mine.so
small_engine code.so -DCODE
cp "$BUILD/staged_engine.so" load-exit0.so

# ---- list
small_engine single.so -DREAD_BACK=float -DULPS=0
expect 0 'double precision, 1 sub-step a step, integrator semi-implicit Euler, contacts not reported' \
    list engines ./mine.so
expect 0 'float precision' list engines ./single.so
expect 0 'contacts with points, impulses' list engines plumb
expect 3 'load-exit0.so it called exit\(0\) while it was loaded' list engines ./load-exit0.so ./mine.so
expect 0 '"precision"' list engines ./single.so plumb --json
python3 - <<'END' || failed=1
import json
single, plumb = json.load(open("out"))
assert (single["precision"], single["substeps"], single["contacts"]) == ("float", 1, []), single
assert single["integrator"] == "semi-implicit Euler" and len(single["binary"]) == 16
assert [profile["name"] for profile in single["profiles"]] == ["one", "two"]
assert single["options"][0]["max"] == 64
assert plumb["contacts"] == ["points", "impulses"] and plumb["name"] == "plumb"
END

# ---- Read back: what was compared, and how exactly
reads() { # reads OUTCOME READ_BACK FILE
    local result
    "$PLUMB" run free-fall --duration 0.1 --engine "$3" --json read.json --force >/dev/null 2>&1 || true
    result=$(python3 -c 'import json; r = json.load(open("read.json")); print(r["outcome"], *r["read_back"], sep=",")')
    [[ $result == "$1$2" ]] || note_failure "$3: $result, not $1$2: $(cat read.json)"
}
build_reading() { # build_reading TYPE ULPS
    small_engine reading.so "-DREAD_BACK=$1" "-DULPS=$2"
}
reads ok '' ./mine.so
reads ok ,dt,mass ./single.so
build_reading float 15
reads ok ,dt,mass ./reading.so
build_reading float 17
reads unsupported ,dt,mass ./reading.so
build_reading double 0
reads ok ,dt,mass ./reading.so
build_reading double 1e-4
reads unsupported ,dt,mass ./reading.so
expect 0 ok run free-fall --duration 0.1 --engine ./single.so,iterations=4 --json steps.json
python3 -c 'import json; assert json.load(open("steps.json"))["substeps"] == 4' || note_failure "substeps: $(cat steps.json)"

# ---- tune: the engine's own API only where it says how; what is suggested loads
fall=(free-fall --duration 1 --target 'value_error<=0.004' --budget 12)
expect 0 'small_set_iterations\([0-9]+\);' tune "${fall[@]}" --engine ./code.so --fix dt=1/60 --out with_code
expect 0 'the cheapest found' tune "${fall[@]}" --engine ./mine.so --fix dt=1/60 --out saved
if grep -q 'own API' out; then
    note_failure "an engine that does not tell its API: $(cat out)"
fi
read -ra suggested <<<"$(sed -n 's/^plumb tune: .*: \(--engine .*\)$/\1/p' err)"
expect 0 'small:one,iterations=([2-9]|[1-9][0-9]+):' run free-fall --duration 0.1 "${suggested[@]}"
expect 3 'load-exit0.so: it called exit\(0\) while it was loaded' tune "${fall[@]}" --engine ./load-exit0.so

# ---- The others go on where one engine cannot be loaded
both=(--engine ./load-exit0.so --engine ./mine.so --duration 0.1)
expect 0 'load-exit0.so:default +crashed: it called exit\(0\)' threshold slope-threshold "${both[@]}"
grep -q 'small:one .*always holds' out || note_failure "threshold: $(cat out)"
expect 0 'failed: plain run crashed: it called exit\(0\)' metamorphic free-fall --check again "${both[@]}"
grep -q 'bitwise' out || note_failure "metamorphic: $(cat out)"
expect 0 'load-exit0.so:default +7 crashed' ensemble falling-cubes --set n=2 --members 7 --converged "${both[@]}"
grep -q 'small:one@converged *7 ok' out || note_failure "ensemble: $(cat out)"
expect 0 'crashed +it called exit\(0\)' sweep free-fall --vary iterations=1,2 "${both[@]}" --out swept
[[ $(grep -c '"outcome":"ok"' swept/results.jsonl) == 2 ]] || note_failure "sweep: $(cat out)"
expect 3 'load-exit0.so: it called exit\(0\) while it was loaded' sweep free-fall --vary iterations=1,2 \
    --engine ./load-exit0.so --out none
expect 0 'small:one .*accurate' compare free-fall --iterations-to-tolerance "${both[@]}" --out compared
grep -q '"iterations_to_tolerance":{[^}]*"value":[0-9]' compared/results.jsonl || note_failure "no iterations to tolerance"

exit $failed
