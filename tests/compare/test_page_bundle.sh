#!/usr/bin/env bash
# The page is bundled without npm's packages, and without esbuild, and its policy names its script.
set -eu
source "$SOURCE/tests/support/command.sh"
esbuild=$BUILD/compare/report/page/node_modules/.bin/esbuild
[[ -x $esbuild ]] || esbuild=$(command -v esbuild || true)

# bundle FOLDER ESBUILD: makes FOLDER/page.html without three and Plot.
bundle() {
    mkdir "$1"
    cmake -DSOURCE="$SOURCE/compare/report/page" -DBUILD="$directory/$1" -DESBUILD="$2" -DFULL=OFF -DHUES='{}' \
        -P "$SOURCE/compare/report/page/bundle.cmake" >out 2>&1 || note_failure "$1: $(cat out)"
    local hash
    hash=$(python3 -c 'import base64, hashlib, sys; print(base64.b64encode(hashlib.sha256(open(sys.argv[1], "rb").read()).digest()).decode())' \
        "$1/main.js")
    grep -qF "script-src 'sha256-$hash'" "$1/page.html" || note_failure "$1: the policy names another script"
    [[ $(grep -c '<!--data-->' "$1/page.html") == 1 ]] || note_failure "$1: no place for the data"
}

bundle neither ""
grep -q 'This build of plumb has no page' neither/page.html || note_failure "no word of the missing page"
if [[ -n $esbuild ]]; then
    bundle without "$esbuild"
    grep -q 'There is no replay' without/page.html || note_failure "the page without replay is none"
    [[ $(wc -c <without/page.html) -lt 200000 ]] || note_failure "the page without packages has them"
fi
exit $failed
