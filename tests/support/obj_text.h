/* Texts of .obj files for tests, and how to write one to a file. */
#ifndef PLUMB_TEST_OBJ_TEXT_H
#define PLUMB_TEST_OBJ_TEXT_H

#include "check.h"
#include "solids/obj.h"

#include <stdio.h>
#include <unistd.h>

/* A tetrahedron at the corner of a cube. */
#define FOUR "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
#define FOUR_FACES "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"

/* Corners of a cube of 2 m about the origin, and of a box of 2 x 3 x 4 m with one corner there. */
#define CUBE "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
#define BOX "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4\n"

/* Faces of a box whose corners are the first eight vertices, or the next eight. */
#define FACES "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
#define OTHER_FACES                                                                                \
    "f 9 12 11 10\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n"

/* Writes `length` bytes to a file of its own in the build folder; `path` is its name. */
static inline void write_obj(const char *name, const char *text, size_t length, char path[512])
{
    snprintf(path, 512, "%s/%s_%ld.obj", PLUMB_BINARY_DIR, name, (long)getpid());
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

/* Makes the solid of a file, given by its whole path. */
static inline pl_status read_obj(const char *path, pl_polyhedron **made, pl_error *error)
{
    size_t length = 0;
    return pl_polyhedron_of_file("/", path, made, &length, error);
}

#endif
