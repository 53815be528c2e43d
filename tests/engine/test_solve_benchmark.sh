#!/usr/bin/env bash
# solve_benchmark on problems that plumb captures: it prints losses first, writes every level, and refuses bad calls.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# benchmark CODE PATTERN ARGUMENT...: solve_benchmark ARGUMENT... exits with CODE and prints PATTERN.
benchmark() {
    local PLUMB=$BUILD/solve_benchmark
    expect "$@"
}

expect 0 '30 of 30 steps' run tower --set n=3 --duration 0.5 --engine plumb --capture 2:tower.json
expect 0 '30 of 30 steps' run wall-collapse --set rows=6 --set columns=6 --duration 0.5 --engine plumb \
    --capture 20:collapse.json
solvers=$("$BUILD/solve_benchmark" --help | sed -n '/^Solvers:/,$s/^  \([a-z_]*\) .*/\1/p')
[[ $(wc -l <<<"$solvers") -ge 5 ]] || note_failure "solvers of --help: $solvers"

benchmark 0 '^tower: 3 bodies, 3 manifolds, 12 contact points$' --json levels.jsonl tower.json collapse.json
[[ $(grep -nE '^(Not reached|Slower than|tower:|collapse:)' out | cut -d: -f2 | cut -d' ' -f1 | xargs) == \
    'Not Slower tower collapse' ]] || note_failure "the order of tables: $(cat out)"
grep -qE "^collapse +cold +newton +0.001 +[a-z]" out || note_failure "no loss of newton: $(cat out)"

# Every solver and start has levels up to the first that it missed, whose residuals are at most the level.
python3 - "$solvers" <<'END' || note_failure 'levels.jsonl: see above'
import json, sys
rows = [json.loads(line) for line in open("levels.jsonl")]
for problem in ("tower.json", "collapse.json"):
    for solver in sys.argv[1].split():
        for start in ("warm", "cold"):
            found = [r for r in rows if (r["problem"], r["solver"], r["start"]) == (problem, solver, start)]
            reached = [r["reached"] for r in found]
            assert [r["tolerance"] for r in found] == [1e-3, 1e-4, 1e-6, 1e-8][:len(found)], found
            assert reached in ([True] * 4, [True] * (len(found) - 1) + [False]), found
            assert all(r["residual_max"] <= r["tolerance"] for r in found if r["reached"]), found
cold = [r["start_residual"] for r in rows if r["start"] == "cold" and r["problem"] == "tower.json"]
assert max(abs(r - 9.81 / 60) for r in cold) < 1e-12, cold  # each cube falls for one step
END

benchmark 0 'Slower than direct' --solver direct --solver momentum tower.json
grep -q newton out && note_failure 'a solver that was not asked for'
benchmark 2 'there is no solver newtn' --solver newtn tower.json
benchmark 2 'expected the files of contact problems' --solver newton
benchmark 2 'unrecognized option' --solvr newton tower.json
sed 's/"mass":[0-9.]*/"mass":0/' tower.json >bad.json
benchmark 2 'bad.json: bodies\[0\].mass: expected a finite number above 0, found 0' tower.json bad.json
benchmark 3 'No such file' --json missing/x.jsonl tower.json
exit $failed
