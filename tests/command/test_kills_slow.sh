#!/usr/bin/env bash
# Studies that are killed at random moments and resumed lose nothing, double nothing and leave no process.
#     test_kills_slow.sh [KILLS]    so many kills of each kind (default 4)
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

for means in jobs parallel mpirun; do
    actual=0
    python3 "$SOURCE/tests/support/kill_and_resume.py" "$PLUMB" "$means" "${1:-4}" || actual=$?
    [[ $actual == 0 || $actual == 77 ]] || note_failure "$means: see above"
    rm -rf kept
done
exit $failed
