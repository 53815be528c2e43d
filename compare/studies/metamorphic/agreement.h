/* Compares the run of a transformed scene, mapped back, with the plain run. */
#ifndef PLUMB_AGREEMENT_H
#define PLUMB_AGREEMENT_H

#include "transform.h"

#include <jansson.h>
#include <stdio.h>

/* ---- Trajectories ---- */

/* The frames of a run in its trajectory file (CSV with every digit), read one at a time, because
 * long runs of many bodies may not fit into memory. */
typedef struct pl_trajectory {
    FILE *file;
    pl_frame frame; /* the frame that was read last */
    char *line;
    size_t capacity;
} pl_trajectory;

/* Opens an empty temporary file for a run's frames, which is deleted when closed. PL_IO. */
pl_status pl_trajectory_open(pl_trajectory *trajectory, pl_error *error);
void pl_trajectory_close(pl_trajectory *trajectory); /* all zeros allowed */

/* Goes to the first frame of a scene with `body_count` bodies. */
void pl_trajectory_rewind(pl_trajectory *trajectory, int body_count);

/* Reads the next frame into trajectory->frame. False at the end, and where a run broke off. */
bool pl_trajectory_next(pl_trajectory *trajectory);

/* ---- Agreement ---- */

/* The two runs that are compared. */
typedef struct pl_trajectory_pair {
    const pl_scene *scene; /* the plain scene */
    const pl_transform *transform;
    double size;          /* m, of the plain scene */
    pl_trajectory *plain; /* a whole run of `scene` */
    pl_trajectory *other; /* of the transformed scene, or of the rest of it */
    int other_body_count;
    long first; /* the frame of the plain run that corresponds to the other's first frame */
    double
        later; /* steps, 0 to 1, by which the other's frames are later than these; the other run then
                     has a step less */
} pl_trajectory_pair;

/* How far a run agrees with the run of the transformed scene: a new object, as `agreement` of a result. "early" is at a
 * tenth of the run, before chaos sets in, and "end" at its end; each has the largest difference over the dynamic bodies
 * in "position" over the size of the scene, in "rotation" in rad, and a "verdict":
 *
 *   bitwise  every pose of every frame so far is the same number; +0 equals -0, and the two quaternions of a rotation
 *            are equal;
 *   exact    both differences are at most 1e-9;
 *   close    both are at most 1e-3;
 *   differs  elsewhere.
 *
 * "passes_at" is the time in s of the first frame with a position off by over 1e-6 of the size; null: none.
 * Where one of the runs has fewer frames than steps it is a "reason" alone. */
json_t *pl_agreement_of(const pl_trajectory_pair *comparison);

#endif
