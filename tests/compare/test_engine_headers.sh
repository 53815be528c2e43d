#!/usr/bin/env bash
# The headers that engines are written against stand alone: each compiles as the first line of an otherwise
# empty file, as C and as C++, they include nothing but a few headers of the language and one
# another, and their functions need no symbol of plumb.
set -eu
headers="engine_abi.h adapter_helpers.h scene_data.h status.h"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed=0

# The only folder that the compiler is given holds these headers and no others.
mkdir "$folder/plumb"
for header in $headers; do
    cp "$SOURCE"/{compare,scenarios}/include/plumb/"$header" "$folder/plumb" 2>/dev/null || true
    while read -r included; do
        case $included in
        '<stddef.h>' | '<stdint.h>' | '<stdbool.h>') ;;
        *) [[ $included == \"plumb/*\" && " $headers " == *" ${included:7:-1} "* ]] ||
            { echo "$header includes $included" >&2; failed=1; } ;;
        esac
    done < <(sed -nE 's/^# *include *([^ ]+).*/\1/p' "$folder/plumb/$header")
done

# compile COMPILER LANGUAGE STANDARD FILE OUTPUT
compile() {
    "$1" -x "$2" "-std=$3" -Wall -Wextra -Wpedantic -Werror -I "$folder" -c "$4" -o "$5" 2>"$folder/messages" ||
        { echo "$1 -std=$3: $(cat "$4")" >&2; cat "$folder/messages" >&2; failed=1; }
}

# A file that calls every static inline function of the headers, with arguments of the right types.
{
    for header in $headers; do
        echo "#include \"plumb/$header\""
    done
    cat <<'CODE'
double use(const pl_engine_setup *setup, const pl_shape *shape, const pl_force *force, pl_error *error,
           const pl_body *body, pl_body_state *state);
double use(const pl_engine_setup *setup, const pl_shape *shape, const pl_force *force, pl_error *error,
           const pl_body *body, pl_body_state *state)
{
    const double q[4] = {1, 0, 0, 0};
    double a[3], b[3], m[3][3], p[4];
    pl_initial_state(body, state);
    pl_rotation_matrix(q, m);
    pl_quaternion_product(q, q, p);
    pl_vertex_in_principal(shape->polyhedron, 0, a);
    pl_rotate_to_world(q, a, b);
    pl_rotate_to_body(q, b, a);
    pl_to_principal_pose(shape, a, p);
    pl_to_shape_pose(shape, a, p);
    if (pl_force_at(force, 0, 1, p, a, b) && pl_force_acts(force, 0, 1)) {
        pl_engine_error(error, PL_FAILED, "failed");
    }
    return a[0] + b[0] + m[0][0] + p[0] + pl_setup_pair(setup, 0, 1).friction;
}
CODE
} >"$folder/calls"
for function in $(sed -nE 's/^static inline .*\b(pl_[a-z_]+)\(.*/\1/p' "$folder"/plumb/*.h); do
    grep -q "$function(" "$folder/calls" || { echo "this test does not call $function" >&2; failed=1; }
done

count=0
for compilers in "gcc g++" "clang clang++"; do
    read -r c cpp <<<"$compilers"
    command -v "$c" "$cpp" >/dev/null || { echo "$c or $cpp is not installed" >&2; continue; }
    for standard in c99 c17 c2x c++11 c++20; do
        compiler=$c language=c
        [[ $standard == c++* ]] && compiler=$cpp language=c++
        for header in $headers; do
            echo "#include \"plumb/$header\"" >"$folder/alone"
            compile "$compiler" "$language" "$standard" "$folder/alone" /dev/null
            count=$((count + 1))
        done
        compile "$compiler" "$language" "$standard" "$folder/calls" "$folder/calls.o"
        if nm -u "$folder/calls.o" | grep pl_; then
            echo "$compiler -std=$standard: the functions of the headers need these symbols" >&2
            failed=1
        fi
    done
done
[[ $count -ge 20 ]] || { echo "only $count headers were compiled" >&2; failed=1; }
exit $failed
