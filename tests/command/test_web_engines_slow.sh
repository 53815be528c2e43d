#!/usr/bin/env bash
# Engines from npm and DART run a reduced suite; absent ones are named.
set -eu
source "$SOURCE/tests/support/command.sh"
engines=(dart mujoco3 rapier rapier-deterministic jolt physx havok cannon)

"$PLUMB" doctor >doctor || note_failure "doctor: exit code $?"
present=()
for engine in "${engines[@]}"; do
    grep -qE "^$engine +" doctor || note_failure "doctor does not name $engine"
    if grep -qE "^$engine +absent" doctor; then
        command=run expect 2 "engine $engine is absent: ./compare/run --with $engine gets it" tower --engine "$engine"
        command=compare expect 0 "engine $engine is absent" tower --duration 0.1 --engine plumb --with "$engine" --out "without-$engine"
    else
        present+=("$engine")
    fi
done
[[ ${#present[@]} -gt 0 ]] || exit $((failed ? failed : 77))

# What every adapter must get right, whatever its engine does.
for check in initial-position quaternion-order frame-of-step gravity angular-velocity given-inertia repeats; do
    checks+=(--check "$check")
done
"$PLUMB" check-engine "${present[@]}" "${checks[@]}" --timeout 60 --quiet >checked 2>&1 || note_failure "$(cat checked)"

with=$(IFS=,; echo "${present[*]}")
"$PLUMB" compare tower slope-slide bounce --duration 1 --engine plumb --with "$with" --no-reference --out reduced >/dev/null 2>err ||
    note_failure "compare: $(cat err)"
python3 - "${present[@]}" >wrong <<'END'
import json, sys
rows = [json.loads(line) for line in open("reduced/results.jsonl")]
for engine in sys.argv[1:]:
    mine = [r for r in rows if r["engine"] == engine]
    profiles = {r["profile"] for r in mine}
    if len(mine) != 3 * len(profiles) or any(r["outcome"] not in ("ok", "unsupported", "collapsed") for r in mine):
        print(engine, [(r["scenario"], r["outcome"], r["reason"]) for r in mine])
END
[[ ! -s wrong ]] || note_failure "$(cat wrong)"
exit $failed
