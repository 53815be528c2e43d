/* JSON to shapes: those of "shapes", by name, and those of bodies. */
#ifndef PLUMB_SCENE_READ_SHAPE_H
#define PLUMB_SCENE_READ_SHAPE_H

#include "base/diagnostic.h"
#include "base/name_index.h"
#include "plumb/scene.h"

#include <jansson.h>

/* One of "shapes". */
typedef struct pl_named_shape {
    char name[PL_NAME_SIZE];
    pl_shape shape;
} pl_named_shape;

/* Reads shapes into a scene. */
typedef struct pl_shape_reader {
    pl_scene *scene;        /* takes the polyhedra */
    const char *folder;     /* where a mesh's "file" is looked for, with a / at its end where it is
                             * not the working directory; NULL: nowhere */
    pl_named_shape *shapes; /* (index.count) */
    pl_name_index index;
    pl_diagnostic *diagnostic;
    size_t file_bytes; /* of the files read */
    long triangles;    /* of the polyhedra read */
} pl_shape_reader;

/* Reads "shapes" of a scene, which is optional. False after a diagnostic. */
bool pl_read_shapes(pl_shape_reader *r, const json_t *scene);

/* Reads "shape" of a body: an object, or the name of one of "shapes". False after a diagnostic. */
bool pl_read_body_shape(pl_shape_reader *r, const json_t *body, pl_shape *shape);

/* Frees the shapes and the index. The polyhedra stay the scene's. */
void pl_shape_reader_free(pl_shape_reader *r);

#endif
