# Sourced by compare/run and tests/run: installs what is missing from Debian's packages, or names it.
#
#   need PACKAGE PROBE...      PROBE is a command that succeeds when the package is there
#   want PACKAGE PROBE...      the same for what can be left out, and said so, where it cannot be had
#   want_engine ENGINE         wants the Debian packages of an engine
#   install_packages           after the list: installs what is missing of both
#
# What it knows of engines comes from adapters/NAME/engine.json.

adapters=$(cd "$(dirname "${BASH_SOURCE[0]}")/adapters" && pwd)
missing_needed=()
missing_wanted=()

need() {
    local package=$1
    shift
    "$@" >/dev/null 2>&1 || missing_needed+=("$package")
}

want() {
    local package=$1
    shift
    "$@" >/dev/null 2>&1 || missing_wanted+=("$package")
}

# engine_member ENGINE KEY: prints that member of the engine's description, a text or a number; nothing if there is none.
engine_member() {
    sed -nE "s/^ \"$2\": \"?([^\"]*[^\",])\"?,?\$/\1/p" "$adapters/$1/engine.json"
}

# engines KIND...: the names of the engines whose adapter is "linked", a "module" or a "script", in the order of reports.
engines() {
    local file name
    for file in "$adapters"/*/engine.json; do
        name=${file%/engine.json}
        name=${name##*/}
        [[ " $* " != *" $(engine_member "$name" adapter) "* ]] || echo "$(engine_member "$name" place) $name"
    done | sort -n | cut -d ' ' -f 2
}

want_engine() {
    local package probe
    while read -r package probe; do
        case $probe in
        */*) want "$package" test -e "/usr/include/$probe" ;;
        *) want "$package" has_module "$probe" ;;
        esac
    done < <(sed -nE 's/^  \{"package": "(.*)", "probe": "(.*)"\},?$/\1 \2/p' "$adapters/$1/engine.json")
}

has_module() {
    command -v pkg-config >/dev/null && pkg-config --exists "$1"
}

as_root() {
    if [[ $(id -u) -eq 0 ]]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        return 1
    fi
}

apt_install() {
    command -v apt-get >/dev/null || return 1
    echo "installing: $*" >&2
    local log
    log=$(mktemp)
    if as_root env DEBIAN_FRONTEND=noninteractive sh -c \
        'apt-get update -qq && apt-get install -y -qq --no-install-recommends "$@"' \
        apt_install "$@" >"$log" 2>&1; then
        rm -f "$log"
        return 0
    fi
    tail -n 5 "$log" >&2
    rm -f "$log"
    return 1
}

install_packages() {
    if [[ ${#missing_needed[@]} -gt 0 ]] && ! apt_install "${missing_needed[@]}"; then
        echo "please install what these Debian packages hold: ${missing_needed[*]}" >&2
        return 3
    fi
    if [[ ${#missing_wanted[@]} -gt 0 ]] && ! apt_install "${missing_wanted[@]}"; then
        echo "not installed, so what needs them is left out: ${missing_wanted[*]}" >&2
    fi
}

common_packages() {
    local engine
    need gcc command -v gcc
    need g++ command -v g++
    need cmake command -v cmake
    need ninja-build command -v ninja
    need pkg-config command -v pkg-config
    need git command -v git
    need libc6-dev test -e /usr/include/stdio.h
    need libjansson-dev has_module jansson
    need libccd-dev has_module ccd
    need libqhull-dev has_module qhull_r
    need libnlopt-dev has_module nlopt
    need libutf8proc-dev has_module libutf8proc
    need zlib1g-dev has_module zlib
    command -v npm >/dev/null || need esbuild command -v esbuild
    want libsuitesparse-dev test -e /usr/include/suitesparse/amd.h
    for engine in $(engines linked); do
        want_engine "$engine"
    done
}
