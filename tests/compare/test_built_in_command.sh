#!/usr/bin/env bash
# The command of an engine from npm runs its script wherever the build is.
set -eu
source "$SOURCE/tests/support/command.sh"
folder="$directory/it's a \"build\" \$HOME"
mkdir "$folder" bin
cat >main.c <<'C'
#include "adapters/built_in.h"

#include <stdio.h>

const pl_built_in pl_built_in_table[] = {
    {.name = "mine", .package = "@a/mine", .libraries = "", .script = "mine.mjs in-test"}};
const int pl_built_in_count = 1;

int main(void)
{
    char command[4200];
    int count;
    const pl_built_in *mine = pl_built_in_engines(&count);
    return pl_built_in_command(mine, command, sizeof command) && puts(command) >= 0 ? 0 : 1;
}
C
# Prints what node gets from the command that the program in this folder makes.
node_gets() {
    (cd "$1" && PATH="$directory/bin:$PATH" sh -c "exec $(./main)" 2>&1) || true
}
"${CC:-cc}" -std=c17 -D_GNU_SOURCE -DPLUMB_LIBRARY_FOLDER='"../lib/plumb"' -I"$SOURCE/compare" \
    -I"$SOURCE/compare/include" -I"$SOURCE/scenarios" -I"$SOURCE/scenarios/include" -o "$folder/main" main.c \
    "$SOURCE/compare/adapters/built_in.c" "$SOURCE"/scenarios/base/*.c -ljansson -lm
printf '#!/bin/sh\nprintf "%%s|" "$@"\n' >bin/node
chmod +x bin/node
export XDG_DATA_HOME=$directory/data
found=$(node_gets "$folder")
[[ $found == "$folder/lib/plumb/web/mine.mjs|in-test|" ]] || note_failure "node gets: $found"
# The user's packages count where the program has none.
module=plumb/web/node_modules/@a/mine
mkdir -p "$XDG_DATA_HOME/$module"
touch "$XDG_DATA_HOME/$module/package.json"
found=$(node_gets "$folder")
[[ $found == "$XDG_DATA_HOME/plumb/web/mine.mjs|in-test|" ]] || note_failure "of the user, node gets: $found"
# An installed program has its folder of libraries beside its own.
mkdir -p usr/bin usr/lib/plumb/web
cp "$folder/main" usr/bin
touch usr/lib/plumb/web/package.json
unset XDG_DATA_HOME
found=$(HOME=$directory/nobody node_gets usr/bin)
[[ $found == "$directory/usr/bin/../lib/plumb/web/mine.mjs|in-test|" ]] || note_failure "installed, node gets: $found"
exit $failed
