#!/usr/bin/env bash
# Where the command of a process engine ends, how it is run, and which of its files are hashed.
set -eu
source "$SOURCE/tests/support/command.sh"
"$PLUMB" new-engine --process toy >/dev/null

# ---- The hash ----

hash_of() { # hash_of SPEC
    "$PLUMB" list engines "$1" --json 2>err | python3 -c 'import json, sys; print(json.load(sys.stdin)[0].get("binary"))' ||
        note_failure "$1: $(cat err)"
}
mkdir "other folder"
(cat toy/engine.py && echo '# changed') >"other folder/engine.py"
first=$(hash_of "exec:python3 toy/engine.py")
second=$(hash_of "exec:python3 'other folder/engine.py'")
[[ $first =~ ^[0-9a-f]{16}$ && $first != "$second" ]] || note_failure "two scripts have the hashes $first and $second"
for quoted in "'toy/engine.py'" '"toy/engine.py"' 'to\y/engine.py' "to'y/eng'ine.py"; do
    [[ $(hash_of "exec:python3 $quoted") == "$first" ]] || note_failure "$quoted has another hash than toy/engine.py"
done
for quoted in '"other folder/engine.py"' 'other\ folder/engine.py'; do
    [[ $(hash_of "exec:python3 $quoted") == "$second" ]] || note_failure "$quoted has another hash"
done
one=$(hash_of "exec:sh -c 'exec python3 toy/engine.py'")
two=$(hash_of "exec:sh -c 'exec python3 \"other folder/engine.py\"'")
[[ $one != "$two" ]] || note_failure "two scripts that sh -c runs have one hash"

# ---- The end of the command ----

cat >wrapper.py <<'END'
"""Runs the toy engine where the arguments are those of WANTED, which are separated by '|'."""
import os, sys
if os.environ.get("WANTED", "") != "|".join(sys.argv[1:]):
    sys.exit(f"found the arguments {sys.argv[1:]}")
os.execvp("python3", ["python3", "toy/engine.py"])
END
# runs ARGUMENTS LABEL SPEC: the SPEC runs the wrapper with those arguments, and has that label.
runs() {
    WANTED=$1 "$PLUMB" compare cradle --duration 0.02 --engine "$3" --no-reference --out ran >ran.txt 2>&1 ||
        note_failure "$3: $(cat ran.txt)"
    python3 - "$2" <<'END' || note_failure "$3: has another label than $2, or failed"
import json, sys
row = json.loads(open("ran/results.jsonl").readlines()[-1])
assert row["outcome"] == "ok" and row["label"] == sys.argv[1], (row["outcome"], row["reason"], row["label"])
END
    rm -rf ran
}
command=run
runs '' toy:default 'exec:python3 wrapper.py'
runs '' toy:default 'exec:python3 wrapper.py:default'
runs '' toy:default,iterations=7 'exec:python3 wrapper.py,iterations=7'
runs '' toy:default,iterations=7 'exec:python3 wrapper.py:default,iterations=7'
runs '' 'my toy' 'exec:python3 wrapper.py,label=my toy'
runs 'localhost:8080' toy:default 'exec:python3 wrapper.py localhost:8080:default'
runs 'a:b c,d=e' toy:default "exec:python3 wrapper.py 'a:b c,d=e'"
runs 'x,iterations=many' toy:default 'exec:python3 wrapper.py x,iterations=many'
runs 'x,iterations=7' toy:default,iterations=8 'exec:python3 wrapper.py x,iterations=7:default,iterations=8'
runs '--mode=fast|a:b c' toy:default 'exec:python3 wrapper.py --mode=fast "a:b c"'
expect 2 'unknown profile of engine toy, whose command is .*python3 wrapper.py x localhost, "8080"' \
    cradle --engine 'exec:env WANTED="x|localhost" python3 wrapper.py x localhost:8080'

# ---- How it is run ----

runs 'a' toy:default 'exec:WANTED=a python3 wrapper.py a'
runs 'a b' toy:default "exec: WANTED='a b' UNUSED=1 python3 wrapper.py 'a b'"
expect 2 'expected a command after "exec:"' cradle --engine exec:
expect 2 'expected a command after "exec:"' cradle --engine 'exec:  ,iterations=7'
exit $failed
