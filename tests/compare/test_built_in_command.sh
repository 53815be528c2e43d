#!/usr/bin/env bash
# The command of an engine from npm runs its script wherever the build is.
set -eu
source "$SOURCE/tests/support/command.sh"
folder="$directory/it's a \"build\" \$HOME"
mkdir "$folder" bin
cat >main.c <<'C'
#include "adapters/built_in.h"

#include <stdio.h>
#include <string.h>

const pl_engine *pl_engine_plumb(void)
{
    return NULL;
}

int main(void)
{
    char command[4200];
    int count;
    const pl_built_in *all = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(all[i].name, "rapier-deterministic") == 0 &&
            pl_built_in_command(&all[i], command, sizeof command)) {
            puts(command);
            return 0;
        }
    }
    return 1;
}
C
python3 - "$folder" >folder.h <<'END_PYTHON'
import json, sys
print("#define PLUMB_WEB_FOLDER", json.dumps(sys.argv[1]))
END_PYTHON
"${CC:-cc}" -std=c17 -D_GNU_SOURCE -DPLUMB_DART_MODULE='""' -include folder.h -I"$SOURCE/compare" -I"$SOURCE/compare/include" \
    -I"$SOURCE/scenarios" -I"$SOURCE/scenarios/include" -o main main.c "$SOURCE/compare/adapters/built_in.c" \
    "$SOURCE"/scenarios/base/*.c -ljansson -lm
printf '#!/bin/sh\nprintf "%%s|" "$@"\n' >bin/node
chmod +x bin/node
found=$(PATH="$directory/bin:$PATH" sh -c "exec $(./main)" 2>&1) || true
[[ $found == "$folder/rapier.mjs|deterministic|" ]] || note_failure "node gets: $found"
exit $failed
