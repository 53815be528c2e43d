#!/usr/bin/env bash
# The manual page has each command, option and environment variable, and man reads it without a warning.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
page=$BUILD/compare/plumb.1

# has WHAT TEXT: standard input has the text, as roff writes it.
has() { grep -qF -- "${2//-/\\-}" || note_failure "the page has no $1 $2"; }

commands=$("$PLUMB" help | sed -nE 's/^  plumb ([a-z-]+) +[a-z].*/\1/p' | grep -v -e COMMAND -e --)
[[ $(wc -l <<<"$commands") -ge 15 ]] || note_failure "commands of plumb help: $commands"
for name in $commands; do
    awk -v heading=".SS ${name//-/\\\\-}" '/^\.S[SH] /{ inside = $0 == heading } inside' "$page" >section
    has command "plumb $name" <section
    [[ $name == help || $name == version ]] && continue
    for option in $("$PLUMB" "$name" --help | sed -nE 's/^  (-.,|   ) (--[a-z-]+).*/\2/p'); do
        case $option in
        --help | --usage | --version) has option "$option" <"$page" ;;
        *) has "option of $name" "$option" <section ;;
        esac
    done
done

sed -n '/^\.SH ENVIRONMENT/,/^\.SH FILES/p' "$page" >section
for name in $(grep -rhoE '"(PLUMB|SLURM|OMPI|PMIX|PMI)_[A-Z_]+"|getenv\("[A-Z_]+"\)' \
    "$SOURCE/compare" "$SOURCE/scenarios" "$SOURCE/engine" --include='*.[ch]' --exclude=manual.c | grep -oE '[A-Z]{2,}[A-Z_]+' | sort -u); do
    has variable "$name" <section
done

(unset SOURCE_DATE_EPOCH && "$BUILD/plumb_manual" | grep -q '^\.TH PLUMB 1 "" ') || note_failure 'a date out of nothing'
SOURCE_DATE_EPOCH=86400 "$BUILD/plumb_manual" | grep -q '^\.TH PLUMB 1 "1970-01-02" ' ||
    note_failure 'SOURCE_DATE_EPOCH is not the date'

if command -v man >/dev/null && MANWIDTH=80 LC_ALL=C.UTF-8 man --warnings -l "$page" >out 2>err; then
    [[ ! -s err ]] || note_failure "man warns: $(cat err)"
    grep -qE '^ +plumb scene tower --set n=3 > mine\.json$' out || note_failure 'an example is not as it is typed'
    grep -qE 'PLUMB_ALLOW_FILES' out || note_failure 'the page is not shown to its end'
fi
exit $failed
