# Sourced by tests that build small_engine.c. Needs $SOURCE.

# small_engine FILE FLAG...: builds it with these compiler flags into FILE.
small_engine() {
    local file=$1
    shift
    "${CC:-cc}" -std=gnu17 -O1 -shared -fPIC -I"$SOURCE/compare/include" -I"$SOURCE/scenarios/include" \
        -o "$file.new" "$SOURCE/tests/compare/small_engine.c" "$@"
    mv "$file.new" "$file"
}
