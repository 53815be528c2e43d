#!/usr/bin/env bash
# plumb __complete finds all that can stand in the place of a word, and the functions for bash, zsh and fish offer
# the same. A shell that is absent is left out.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
scripts=$SOURCE/compare/completion
export PATH=${PLUMB%/*}:$PATH

# candidates WORD...: what may stand in the place of the last word, and a note of any error.
candidates() {
    "$PLUMB" __complete "$@" 2>err | cut -f1
    [[ ${PIPESTATUS[0]} == 0 && ! -s err ]] || echo "__complete $*: $(cat err)" >>errors
}

# same WHAT FOUND EXPECTED: two lists of words with the same members.
same() {
    [[ -n $3 && $(sort <<<"$2") == "$(sort <<<"$3")" ]] ||
        note_failure "$1: expected ${3//$'\n'/ }, found ${2//$'\n'/ }"
}

# ---- The tables ----

commands=$("$PLUMB" help | sed -nE 's/^  plumb ([a-z-]+) +[a-z].*/\1/p' | grep -v -e COMMAND -e --)
[[ $(wc -l <<<"$commands") -ge 15 ]] || note_failure "commands of plumb help: $commands"
same 'commands' "$(candidates '' | grep -v '^-')" "$commands"
same 'help' "$(candidates help '')" "$commands"
[[ $commands != *__complete* ]] || note_failure 'plumb help lists __complete'
for name in $commands; do
    [[ $name == help || $name == version ]] && continue
    options=$("$PLUMB" "$name" --help | sed -nE 's/^  (-.,|   ) (--[a-z-]+).*/\2/p')
    same "options of $name" "$(candidates "$name" -)" "$options"
done

scenarios=$("$PLUMB" list scenarios --json | sed -nE 's/^  "name": "(.*)",$/\1/p')
for name in compare run scene threshold; do
    same "scenarios after $name" "$(candidates "$name" '')" "$scenarios"
done
same 'scene to' "$(candidates scene to)" $'top\ntorque-free\ntouching-boxes\ntower'
same 'a second scenario' "$(candidates compare tower --dt 1/60 tow)" tower
[[ -z $(candidates scene tower '') ]] || note_failure 'scene takes a second scenario'
same 'suites' "$(candidates compare --suite '')" \
    "$("$PLUMB" list suites --json | sed -nE 's/^  "name": "(.*)",$/\1/p')"
same 'metrics' "$(candidates tune --target '')" \
    "$("$PLUMB" list metrics --json | sed -nE 's/^  "name": "(.*)",$/\1/p')"
same 'lists' "$(candidates list '')" $'scenarios\nengines\nmetrics\nsuites'
same 'engines of list' "$(candidates list engines plumb:f)" plumb:fast
[[ -z $(candidates list scenarios '') ]] || note_failure 'list scenarios takes an argument'

profiles=$("$PLUMB" list engines plumb | sed -nE 's/^  (plumb:[a-z]+) .*/\1/p' | grep -v ':tuned')
same 'profiles' "$(candidates run --engine plumb)" $'plumb\n'"$profiles"
same 'after =' "$(candidates run --engine=plumb:f)" --engine=plumb:fast
same 'an option of an engine' "$(candidates run --engine plumb:fast,iterations=5,toler)" \
    plumb:fast,iterations=5,tolerance=
same 'several names' "$(candidates compare --with rapier,jo)" rapier,jolt
same 'parameters' "$(candidates compare tower pile --set n)" n=
same 'a short option' "$(candidates check-engine -c mass-r)" mass-ratio

for format in $(candidates scene tower --format ''); do
    expect 0 mujoco\|plumb_scene scene tower --set n=2 --format "$format"
done
for format in $(candidates gate --format ''); do
    expect 3 'none: No such file' gate none --baseline none --format "$format"
done
for kind in $(candidates metamorphic --check ''); do
    "$PLUMB" metamorphic --help | grep -qE "\b$kind\b" || note_failure "metamorphic has no check $kind"
done

# ---- Files, and what is no option ----

same 'files' "$(candidates report x)" ':files '
same 'folders' "$(candidates new-engine '')" ':files /'
same 'folders of an option' "$(candidates compare --out=x)" ':files /'
same 'scene files' "$(candidates run ./x)" ':files .json'
same 'shared objects' "$(candidates run --engine ./x)" ':files .so'
same 'after --' "$(candidates compare -- --eng)" ':files .json'
for words in '' 'nothing x' 'compare --nothing=' 'compare --open=' 'help compare x' '-- x' 'compare = = ='; do
    # shellcheck disable=SC2086 # several words
    found=$(candidates $words | sed '/^:files/d')
    [[ -z $words || -z $found ]] || note_failure "candidates of nothing: $words: $found"
done

# ---- Shells ----

: >mine.json
: >'mine other.json'
: >minutes.txt
mkdir results
lines=('plumb ' 'plumb sc' 'plumb scene to' 'plumb run tower --engine=plumb:f' 'plumb run tower --engine plumb:'
    'plumb run --engine=' 'plumb compare tower --set n' 'plumb compare --json mine --suite can' 'plumb scene --format ')

# check_shell NAME: complete_NAME LINE prints what the shell's function offers at the end of the line.
check_shell() {
    local line words
    for line in "${lines[@]}"; do
        read -ra words <<<"$line"
        [[ $line != *' ' ]] || words+=('')
        same "$1: $line" "$("complete_$1" "$line" 2>&1)" "$(candidates "${words[@]:1}")"
    done
    same "$1: scene files" "$("complete_$1" 'plumb run mi' 2>&1 | grep -v '/$')" $'mine.json\nmine other.json'
    same "$1: folders" "$("complete_$1" 'plumb compare --out=re' 2>&1 | sed 's#/$##')" --out=results
}

# Divides the line as readline does, at blanks and around '=' and ':', and joins what it keeps with the candidate.
complete_bash() {
    (
        compopt() { :; }
        # shellcheck disable=SC1091
        source "$scripts/plumb.bash"
        COMP_LINE=$1 COMP_POINT=${#1} COMP_WORDBREAKS=$' \t\n"\'><=;|&(:'
        mapfile -t COMP_WORDS < <(sed -E 's/[=:]/\n&\n/g; s/ /\n/g' <<<"$1" | sed '/./!d')
        [[ $1 != *' ' ]] || COMP_WORDS+=('')
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        _plumb
        lead=${1##* }
        [[ $lead == *[=:]* ]] && lead=${lead%"${lead##*[=:]}"} || lead=''
        printf '%s\n' "${COMPREPLY[@]/#/"$lead"}"
    )
}
check_shell bash

# The functions of zsh's completion that the script calls, reduced to printing what they are given.
cat >complete.zsh <<'END'
words=("${(@s: :)1}") CURRENT=$#words PREFIX=$words[-1]
compset() { [[ $PREFIX != --*=* ]] || { kept=${PREFIX%%=*}= PREFIX=${PREFIX#*=} }; }
_files() {
    local -a files
    [[ $1 == -/ ]] && files=($PREFIX*(N/)) || files=($PREFIX${~2}(N))
    print -rl -- $kept$^files
}
_describe() {
    for entry in "${(@)closed}" "${(@)open}"; do
        entry=${entry//\\:/$'\1'}
        print -r -- ${${entry%%:*}//$'\1'/:}
    done
}
completed() { source $SCRIPT; }
completed
END
complete_zsh() { SCRIPT=$scripts/_plumb zsh -f complete.zsh "$1"; }
if command -v zsh >/dev/null; then check_shell zsh; fi

complete_fish() {
    HOME=$PWD LINE=$1 SCRIPT=$scripts/plumb.fish fish --no-config -c 'source $SCRIPT; complete -C $LINE' | cut -f1
}
if command -v fish >/dev/null; then check_shell fish; fi
[[ ! -e errors ]] || note_failure "$(cat errors)"
exit $failed
