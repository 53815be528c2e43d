/* A compact trajectory: where the dynamic bodies' centres of mass are, at most 60 times a second.
 *
 * The file holds what a run of the same scene on the same machine needs to read it again: a header,
 * then for each sample a 32-bit float for each axis of each dynamic body, the way from its start
 * in m. A sample is written whole, so that a run that ends early leaves whole samples. */
#ifndef PLUMB_POSITIONS_H
#define PLUMB_POSITIONS_H

#include "plumb/engine_abi.h"

#include <stdio.h>

/* Every how many steps a sample is taken: the least number that makes at most 60 a second. */
long pl_positions_stride(double dt);

/* Dynamic bodies of a scene. */
int pl_positions_bodies(const pl_scene *scene);

typedef struct pl_positions_writer {
    FILE *file;
    const char *path;
    const pl_scene *scene;
    long stride;
    float *sample; /* (3 x bodies) */
} pl_positions_writer;

/* Opens `path`, which is replaced; it and `scene` must outlive the writer. PL_IO, PL_NO_MEMORY. */
pl_status pl_positions_create(const char *path, const pl_scene *scene, pl_positions_writer *writer,
                              pl_error *error);
/* The state after step number `step` (0: before the first); most are passed over. */
pl_status pl_positions_write(pl_positions_writer *writer, long step, const pl_frame *frame,
                             pl_error *error);
void pl_positions_end(pl_positions_writer *writer); /* of one never opened, too */

/* Opens such a file of a run of `scene` for pl_positions_read; NULL where there is none that fits.
 */
FILE *pl_positions_open(const char *path, const pl_scene *scene);
/* The next sample, (3 x bodies); false where the file ends. */
bool pl_positions_read(FILE *file, int bodies, float *sample);

#endif
