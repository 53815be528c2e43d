#!/usr/bin/env bash
# plumb scene as a user meets it: both formats, and what MJCF cannot hold.
set -eu
command=scene
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

expect 0 '"plumb_scene": 1' tower --set n=2
expect 0 '"plumb_scene": 1' tower --set n=2 --format json
expect 0 '<body name="cube 2"' tower --set n=2 --format mjcf
[[ ! -s err && $(head -c 7 out) == '<mujoco' && $(tail -n 1 out) == '</mujoco>' ]] ||
    note_failure "not a model alone: $(cat out err)"
expect 2 '--format mjcf: .*restitution 0.5' bounce --set restitution=0.5 --format mjcf
[[ ! -s out ]] || note_failure "a refused scene printed a model"
expect 2 '--format takes json or mjcf; found "xml"' tower --format xml
exit $failed
