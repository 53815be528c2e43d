#!/usr/bin/env bash
# pandas reads the results in one line: each column has one type, missing values are NaN, and numbers agree with the
# JSON lines to the last bit.
set -eu
python3 -c 'import pandas' 2>/dev/null || exit 77
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# Two that run, one that crashes and one that lacks the scene's shapes.
expect 0 'crashed' compare tower free-fall --set n=2 --duration 0.1 --engine plumb --engine ode \
    --engine "$BUILD/faulty_engine.so:abort" --out report
python3 - <<'END' || failed=1
import pandas

runs = pandas.read_csv("report/runs.csv", float_precision="round_trip")
rows = pandas.read_csv("report/results.csv", float_precision="round_trip")
results = pandas.read_json("report/results.jsonl", lines=True, precise_float=True)
assert len(runs) == len(results) == 6 and rows.run.nunique() == 6

for table in runs, rows:
    for name, column in table.items():
        assert column.dropna().map(type).nunique() <= 1, f"{name} is mixed"
texts = {"integrator (rule)", "state_hash (hex)"}
first = runs.columns.get_loc("acceptance")
for name in set(runs.columns[first:]) - texts:
    assert runs[name].dtype == "float64", f"{name} is {runs[name].dtype}"
for name in "value", "p50", "p95", "p99", "acceptance":
    assert rows[name].dtype == "float64", f"{name} is {rows[name].dtype}"
assert runs[runs.outcome == "unsupported"]["reference_error"].isna().all()

metrics = pandas.json_normalize(results.metrics.tolist()).set_index(results.run)
assert (metrics["penetration_max.value"].dropna() == runs.set_index("run")["penetration_max (m)"].dropna()).all()
errors = rows[rows.metric == "reference_error"].set_index("run").value
assert (metrics["reference_error.value"].dropna() == errors.dropna()).all() and len(errors) >= 4
END
exit $failed
