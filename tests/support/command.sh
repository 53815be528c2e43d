# Sourced by tests that use plumb as a user does: they run in a directory of their own, which goes at
# their end, and end with `exit $failed`. Those that set `command` test that one.
failed=0
further=() # options that expect adds
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory"

note_failure() {
    echo "$1" >&2
    failed=1
}

# expect CODE PATTERN ARGUMENT...: `plumb [$command] ARGUMENT...` exits with CODE and prints PATTERN.
expect() {
    local code=$1 pattern=$2 actual=0 what
    shift 2
    what="${command:+$command }$*"
    "$PLUMB" ${command:+"$command"} "$@" "${further[@]}" >out 2>err || actual=$?
    [[ $actual == "$code" ]] || note_failure "$what: exit code $actual, expected $code: $(cat out err)"
    cat out err | grep -qE -- "$pattern" || note_failure "$what: no \"$pattern\" in: $(cat out err)"
}
