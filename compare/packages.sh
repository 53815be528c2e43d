# Sourced by compare/run and tests/run: installs what is missing from Debian's packages, or names it.
#
#   need PACKAGE PROBE...      PROBE is a command that succeeds when the package is there
#   want PACKAGE PROBE...      the same for an engine: left out, and said so, where it cannot be had
#   install_packages           after the list: installs what is missing of both

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

install_packages() {
    local all=("${missing_needed[@]}" "${missing_wanted[@]}")
    [[ ${#all[@]} -eq 0 ]] && return 0
    if command -v apt-get >/dev/null; then
        echo "installing: ${all[*]}" >&2
        if as_root env DEBIAN_FRONTEND=noninteractive sh -c '
               apt-get update -qq && apt-get install -y -qq --no-install-recommends "$@"' \
               install "${all[@]}" >"${TMPDIR:-/tmp}/plumb-apt.log" 2>&1; then
            return 0
        fi
        tail -n 5 "${TMPDIR:-/tmp}/plumb-apt.log" >&2
    fi
    if [[ ${#missing_wanted[@]} -gt 0 ]]; then
        echo "not installed, so these engines are left out: ${missing_wanted[*]}" >&2
    fi
    if [[ ${#missing_needed[@]} -gt 0 ]]; then
        echo "please install what these Debian packages hold: ${missing_needed[*]}" >&2
        return 1
    fi
}

common_packages() {
    need gcc command -v gcc
    need g++ command -v g++
    need cmake command -v cmake
    need ninja-build command -v ninja
    need pkg-config command -v pkg-config
    need git command -v git
    need libjansson-dev has_module jansson
    need libccd-dev has_module ccd
    want libode-dev has_module ode
    want libbullet-dev has_module bullet
    want libbullet-extras-dev has_module bullet-float64
}
