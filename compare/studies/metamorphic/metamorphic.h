/* Metamorphic checks: for each scene and engine a plain run, and for each check the run of a
 * transformed scene that must agree with it. */
#ifndef PLUMB_METAMORPHIC_H
#define PLUMB_METAMORPHIC_H

#include "runner/execute.h"
#include "studies/study.h"
#include "transform.h"

#include <stdio.h>

/* ---- The checks ---- */

/* The kinds of checks, by the change of the scene. */
typedef enum pl_check_kind {
    PL_CHECK_ROTATE,
    PL_CHECK_SHIFT,
    PL_CHECK_SCALE,
    PL_CHECK_ORDER,
    PL_CHECK_FAR,
    PL_CHECK_MIRROR,
    PL_CHECK_AGAIN,      /* the same scene a second time */
    PL_CHECK_RESTART,    /* a new instance continues from the state at half time */
    PL_CHECK_SPLIT,      /* each static box is two flush boxes */
    PL_CHECK_TESSELLATE, /* each static box is a closed mesh */
    PL_CHECK_LATE        /* the start lies a fraction of a step later on the same motion */
} pl_check_kind;

/* A metamorphic check: a change of the scene under which the motion should stay the same. */
typedef struct pl_check {
    const char *name;   /* "rotate-z90" */
    const char *family; /* "rotate" */
    pl_check_kind kind;
    double amount; /* eighths of a turn, m, scale, pl_body_order, sizes of the scene, rectangles
                      along an edge, or fraction of a step */
    int axis;      /* rotate, split: 0, 1, 2 */
} pl_check;

enum { PL_CHECK_COUNT = 24 };

/* All checks in the order of reports. */
extern const pl_check pl_checks[PL_CHECK_COUNT];

/* Chooses the checks of these names and families, all where there are none: (*chosen)[i] of pl_checks, which the caller
 * frees. PL_BAD_INPUT suggests the nearest name. */
pl_status pl_checks_choose(const char *const *names, int count, bool **chosen, pl_error *error);

/* Sets the check's transform of this scene: the identity where the scene is changed otherwise. Returns why the
 * transform does not apply to the scene, in static storage; NULL: it does. */
const char *pl_check_transform(const pl_check *check, const pl_scene *scene,
                               pl_transform *transform);

/* The scene of the check, which the caller frees, and its transform. Where the check does not apply to the scene,
 * *reason says why, and there is no scene; nor is there one of a restart, which begins from the states of a run. */
pl_status pl_check_scene(const pl_check *check, const pl_scene *plain, pl_transform *transform,
                         pl_scene *scene, const char **reason, pl_error *error);

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

/* ---- The study ---- */

/* Makes the plain run of each case of how->plan on each configuration, and the checks of it that are chosen[] of
 * pl_checks. A check is made once the plain run has come to its end; one that does
 * not apply to the scene gets the outcome `unsupported` without a run. What the frames say is added to each result as
 * the object `agreement` (results/SCHEMA.md). A signal ends it as in pl_execute. PL_FAILED: a plain run that is made
 * again, because its frames are needed, does not come to its end as it did before. */
pl_status pl_metamorphic_run(const bool *chosen, const pl_execution_def *how, int *signal_number,
                             pl_error *error);

/* The study: its conclusion is an array of plumb.metamorphic/1 (results/SCHEMA.md). */
extern const pl_study pl_metamorphic_study;

#endif
