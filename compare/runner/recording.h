/* The recording of a run: poses, contact points and curves, for the replay and the plots of a report.
 *
 * The run's own process streams samples to a raw file. It allocates nothing after pl_recorder_create,
 * so that the memory that is measured is the engine's. When the run has ended, pl_recording_finish
 * turns the raw file into plumb.recording/1 (results/SCHEMA.md), which a report embeds. */
#ifndef PLUMB_RECORDING_H
#define PLUMB_RECORDING_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"
#include "referee/metrics/curves.h"

#include <jansson.h>
#include <stdio.h>

/* The first eight bytes of a raw file. */
#define PL_RAW_MAGIC "plumbrec"

/* A raw file that is being written; {0} is one that was never created. */
typedef struct pl_recorder {
    FILE *file; /* NULL between two records */
    const char *path;
    const pl_scene *scene;
    long stride, bucket; /* steps from frame to frame, and in a bucket of the curves */
    float *sample;       /* (7 x dynamic bodies) */
    long first;          /* step of the first value of the open bucket; 0: none */
    double value[PL_CURVE_COUNT];
} pl_recorder;

/* What is known of a frame. */
typedef struct pl_recorded_step {
    long step; /* 0: the start */
    const pl_frame *frame;
    const pl_contact *contacts; /* (contact_count) */
    int contact_count;          /* < 0: the engine reports none */
    bool has_impulses;
    double penetration;          /* m: the deepest overlap of the frame */
    double iterations, residual; /* NAN where the engine reports none */
} pl_recorded_step;

/* Opens `path`, which is replaced; it and `scene` must outlive the recorder. PL_IO. */
pl_status pl_recorder_create(const char *path, const pl_scene *scene, pl_recorder *recorder,
                             pl_error *error);

/* Takes the start and each step. A recording that cannot be written, because an engine has taken the
 * descriptors or the disk is full, ends there: it is no part of the result. */
void pl_recorder_step(pl_recorder *recorder, const pl_recorded_step *seen);

/* Frees the recorder; {0} is allowed. */
void pl_recorder_end(pl_recorder *recorder);

/* The path in that folder of a file of the run with this hash, whose name ends with "positions", or "raw" or "json" of
 * its recording: malloc'd. */
char *pl_run_file(const char *folder, const char *run, const char *ending);

/* Removes the files of that ending of a folder, but for those of the runs in the set `kept`; NULL: none. */
void pl_run_files_remove(const char *folder, const char *ending, const json_t *kept);

/* Removes the recordings and raw files of a folder, and nothing else, but for those of the runs in the
 * set `kept`; NULL: none. */
void pl_recordings_remove(const char *folder, const json_t *kept);

/* Turns the raw file of a run of `scene` into FOLDER/RUN.json and removes it. A raw file without a
 * frame leaves nothing. PL_IO. */
pl_status pl_recording_finish(const char *folder, const char *run, const pl_scene *scene,
                              pl_error *error);

#endif
