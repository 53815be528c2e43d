#!/usr/bin/env bash
# Free flight by semi-implicit Euler in 1, 2 and 4 sub-steps, in floats and in doubles: an engine that
# declares what it does is charged with none of it. One that hides it is, and so is an error that rounding
# does not explain.
set -eu
command=
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

export ASAN_OPTIONS=detect_leaks=0
small_engine double.so -DREAD_BACK=double -DULPS=0
small_engine float.so -DREAD_BACK=float -DULPS=0
small_engine hidden.so
small_engine drifting.so -DREAD_BACK=float -DULPS=0 -DDRIFT=1e-4

engines=()
for precision in double float; do
    for substeps in 1 2 4; do
        engines+=(--engine "./$precision.so:one,iterations=$substeps,label=$precision-$substeps")
    done
done
"$PLUMB" compare free-fall projectile "${engines[@]}" --engine ./hidden.so:one,iterations=4,label=hidden \
    --engine ./drifting.so:one,label=drifting --out results >out 2>&1 || note_failure "compare: $(cat out)"
python3 - <<'END' || failed=1
import json
rows = [json.loads(line) for line in open("results/results.jsonl")]
rows = [row for row in rows if "metrics" in row]
assert len(rows) == 16, len(rows)
for row in rows:
    label, values = row["label"], {k: m["value"] for k, m in row["metrics"].items()}
    where = row["scenario"], label, values
    if label == "hidden":
        assert values["energy_gain"] > 1e-3, where
        continue
    if label == "drifting":
        assert values["energy_gain"] > 1e-4, where
        continue
    assert values.get("integrator") == "semi-implicit Euler", where
    assert values["energy_gain"] <= 1e-6 and values["energy_step_gain"] <= 1e-6, where
    assert values["momentum_error"] <= 1e-6, where
    assert values["discrete_error"] <= (1e-9 if "double" in label else 1e-5), where
    assert values["value_error"] > 1e-4, where  # the time-stepping error, which discrete_error leaves out
END
exit $failed
