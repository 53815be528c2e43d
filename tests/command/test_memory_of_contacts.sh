#!/usr/bin/env bash
# The room that the harness has for contacts is no memory of the engine, whether the engine says how many
# it has or not.
set -eu
command=
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

export ASAN_OPTIONS=detect_leaks=0
small_engine none.so
small_engine few.so -DCONTACTS=1
small_engine many.so -DCONTACTS=150000
small_engine silent.so -DCONTACTS=150000 -DSILENT

python3 - >scene.json <<'END'
import json
bodies = [{"name": f"ball {i}", "mass": 1, "shape": {"type": "sphere", "radius": 0.1},
           "position": [i % 100, i // 100, 0]} for i in range(10000)]
print(json.dumps({"plumb_scene": 1, "dt": 0.01, "duration": 0.03, "bodies": bodies}))
END
for engine in none few many silent; do
    expect 0 memory_peak run scene.json --engine "./$engine.so" --json "$engine.json"
done
python3 - <<'END' || failed=1
import json
memory = {name: json.load(open(f"{name}.json"))["metrics"]["memory_peak"]["value"]
          for name in ("none", "few", "many", "silent")}
# 150,000 contacts have 17 MB.
assert all(abs(bytes - memory["none"]) < 2e6 for bytes in memory.values()), memory
END
exit $failed
