# Sourced after command.sh by tests that run other programs than plumb.

# quietly COMMAND...: what it prints is shown where it fails.
quietly() {
    "$@" >log 2>&1 || note_failure "$*: $(tail -n 30 log)"
}

# gives PATTERN COMMAND...: it succeeds, and prints PATTERN.
gives() {
    local pattern=$1 printed
    shift
    printed=$("$@" 2>&1) || note_failure "$* failed: $printed"
    grep -qE -- "$pattern" <<<"$printed" || note_failure "$*: no \"$pattern\" in: $printed"
}
