/* The reader of scene texts, for scene_file.c. */
#ifndef PLUMB_SCENE_READ_H
#define PLUMB_SCENE_READ_H

#include "plumb/scene.h"

/* A text of JSON, borrowed. */
typedef struct pl_scene_text {
    const char *text; /* (length) */
    size_t length;
    const char *label;    /* for the file's name, in messages */
    const char *folder;   /* of files that it names, with a / at its end; "": the working directory;
                             NULL: it may name none */
    const double *values; /* of its parameters, in their order; NULL: their defaults */
} pl_scene_text;

/* Reads a scene, as pl_scene_read_text does. On failure *scene is empty. */
pl_status pl_scene_read(const pl_scene_text *source, pl_scene *scene, pl_error *error);

#endif
