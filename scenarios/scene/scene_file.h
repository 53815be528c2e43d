/* A scene file in memory: its scene is read as often as its parameters change. */
#ifndef PLUMB_SCENE_FILE_H
#define PLUMB_SCENE_FILE_H

#include "scene_parameters.h"

/* An open scene file. */
typedef struct pl_scene_file {
    char *path; /* as given; "-": standard input */
    char *folder;
    char *text;
    size_t length;
    pl_scene_parameters parameters;
} pl_scene_file;

/* Reads the text of a scene file ("-" is standard input) and its parameters. PL_BAD_INPUT, PL_IO and
 * PL_NO_MEMORY as pl_scene_read_file. The caller closes *file; on failure there is nothing to close. */
pl_status pl_scene_file_open(const char *path, pl_scene_file **file, pl_error *error);

/* Reads the scene for `values` of the parameters, in their order; NULL: their defaults. PL_BAD_INPUT as
 * pl_scene_read_file; on failure *scene is empty. The caller frees *scene. */
pl_status pl_scene_file_read(const pl_scene_file *file, const double *values, pl_scene *scene,
                             pl_error *error);

/* Frees the file. NULL is allowed. */
void pl_scene_file_close(pl_scene_file *file);

#endif
