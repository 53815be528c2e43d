/* A compact trajectory: where the dynamic bodies' centres of mass are, at most 60 times a second.
 *
 * The file has a header, then a double for each axis of each dynamic body: the start in m, and for each
 * sample the displacement from it, in the byte order of the machine. Samples are written
 * whole, so that a run that ends early leaves whole samples. */
#ifndef PLUMB_POSITIONS_H
#define PLUMB_POSITIONS_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"

#include <stdio.h>

/* The number of steps from one sample to the next: the least that gives at most 60 samples a
 * second. */
long pl_positions_stride(double dt);

/* The number of dynamic bodies of a scene. */
int pl_positions_bodies(const pl_scene *scene);

/* A file that is being written; {0} is one that was never opened. */
typedef struct pl_positions_writer {
    FILE *file;
    const char *path;
    const pl_scene *scene;
    long stride;
    double *start;  /* (3 x bodies) */
    double *sample; /* (3 x bodies) */
} pl_positions_writer;

/* Opens `path`, which is replaced; it and `scene` must outlive the writer. A sample is written every
 * `stride` steps; 0: every pl_positions_stride. PL_IO. */
pl_status pl_positions_create(const char *path, const pl_scene *scene, long stride,
                              pl_positions_writer *writer, pl_error *error);

/* Writes the state after step `step` (0: before the first) if a sample is due. PL_IO. */
pl_status pl_positions_write(pl_positions_writer *writer, long step, const pl_frame *frame,
                             pl_error *error);

/* Closes the file, if one was opened. */
void pl_positions_end(pl_positions_writer *writer);

/* A file that is being read; {0} is one that was never opened. */
typedef struct pl_positions_reader {
    FILE *file;
    int bodies;      /* dynamic ones */
    double interval; /* s, from one sample to the next */
    double *start;   /* (3 x bodies): m */
} pl_positions_reader;

/* Opens a file for reading; false where there is none that is whole. */
bool pl_positions_open(const char *path, pl_positions_reader *reader);

/* Reads the next sample, (3 x bodies); false at the end of the file. */
bool pl_positions_read(pl_positions_reader *reader, double *sample);

/* Closes the file, if one was opened. */
void pl_positions_close(pl_positions_reader *reader);

/* Removes all such files of a folder, and the folder if that leaves it empty. */
void pl_positions_clear(const char *folder);

#endif
