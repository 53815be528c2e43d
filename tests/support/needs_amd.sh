# Sourced by tests that compare results with recorded ones: they are skipped where SuiteSparse's AMD is absent,
# for its elimination order is part of the results.
grep -q '^AMD_LIBRARY:FILEPATH=/' "$BUILD/CMakeCache.txt" || {
    echo "SuiteSparse's AMD is absent: the recorded results are of a build with it" >&2
    exit 77
}
