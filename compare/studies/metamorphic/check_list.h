/* The checks of an engine that need no reference. Each transforms a scene and says how the two runs
 * must agree. */
#ifndef PLUMB_CHECK_LIST_H
#define PLUMB_CHECK_LIST_H

#include "transform.h"

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

/* All checks in the order of reports. Static storage. */
const pl_check *pl_checks(int *count);

/* Chooses the checks of these names and families, all where there are none: (*chosen)[i] of pl_checks, which the caller
 * frees. PL_BAD_INPUT suggests the nearest name. */
pl_status pl_checks_choose(const char *const *names, int count, bool **chosen, pl_error *error);

/* The check's transform of this scene: the identity where the scene is changed otherwise. False, with the
 * reason, where the transform does not apply to the scene. */
bool pl_check_transform(const pl_check *check, const pl_scene *scene, pl_transform *transform,
                        const char **reason);

/* The scene of the check, which the caller frees, and its transform. Where the check does not apply to the scene,
 * *reason says why, and there is no scene; nor is there one of a restart, which begins from the states of a run. */
pl_status pl_check_scene(const pl_check *check, const pl_scene *plain, pl_transform *transform,
                         pl_scene *scene, const char **reason, pl_error *error);

#endif
