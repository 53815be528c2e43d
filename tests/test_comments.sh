#!/usr/bin/env bash
# Every declaration of a header has a comment, and every comment of the public headers is well formed:
# doxygen reads them, and a warning is an error. Comments are plain C comments; a filter marks them for doxygen.
set -eu
command -v doxygen >/dev/null || exit 77
cd "$SOURCE"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The first comment documents the file, without which doxygen passes over its functions. A comment that begins
# a line documents what follows, one after code documents what stands before it. A rule
# such as /* ---- Title ---- */ documents nothing, nor does the comment of a #include or #endif.
cat >"$folder/filter" <<'AWK'
NR == 1 && /^\/\*/ { n = split(FILENAME, part, "/"); sub(/\/\*/, "/** @file " part[n] " "); print; next }
/^#/ { print; next }
/^ *\/\* ----/ { print ""; next }
/^ *\/\*/ && !/\/\*\*/ { sub(/\/\*/, "/**") }
/[;,{(][^\/]*\/\*/ && !/\/\*\*/ { sub(/\/\*/, "/**<") }
/[A-Za-z0-9_] *\/\*/ && !/\/\*\*/ { sub(/\/\*/, "/**<") }
{ print }
AWK

# read_headers WHAT HEADER...: doxygen's warnings of these headers.
read_headers() {
    {
        cat <<CONFIGURATION
PROJECT_NAME = Plumb
OUTPUT_DIRECTORY = $folder/out
GENERATE_LATEX = NO
GENERATE_HTML = YES
OPTIMIZE_OUTPUT_FOR_C = YES
JAVADOC_AUTOBRIEF = YES
MARKDOWN_SUPPORT = NO
AUTOLINK_SUPPORT = NO
EXTRACT_ALL = NO
QUIET = YES
WARNINGS = YES
WARN_IF_UNDOCUMENTED = YES
WARN_NO_PARAMDOC = NO
WARN_FORMAT = "\$file:\$line: \$text"
FILTER_PATTERNS = *.h="awk -f $folder/filter"
ENABLE_PREPROCESSING = YES
MACRO_EXPANSION = YES
EXPAND_ONLY_PREDEF = YES
PREDEFINED = __attribute__(x)=
HAVE_DOT = NO
CONFIGURATION
        printf 'INPUT = %s\n' "$*"
    } >"$folder/Doxyfile"
    doxygen "$folder/Doxyfile" 2>&1 >/dev/null | sed "s#^$SOURCE/##"
}

mapfile -t public < <(find engine/include scenarios/include compare/include -name '*.h' | sort)
mapfile -t inner < <(find engine/src engine/tools scenarios compare -name "*.h" -not -path '*/include/*' | sort)
read_headers "${public[@]}" >"$folder/warnings"
# Of the inner headers, functions and types must be documented; fields explain themselves where they have no comment.
read_headers "${inner[@]}" | grep -vE 'Member .*\(variable\)|Member .*\(enumvalue\)|Member .*\(macro definition\)' >>"$folder/warnings" || true
if [[ -s $folder/warnings ]]; then
    cat "$folder/warnings" >&2
    echo "$(wc -l <"$folder/warnings") warnings of doxygen" >&2
    exit 1
fi
