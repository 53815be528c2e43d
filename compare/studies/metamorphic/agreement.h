/* How far a run of a transformed scene, mapped back, is from the plain run. */
#ifndef PLUMB_AGREEMENT_H
#define PLUMB_AGREEMENT_H

#include "trajectory.h"
#include "transform.h"

typedef enum pl_grade {
    PL_GRADE_BITWISE, /* every pose of every frame is the same number; +0 and -0 are one, as are
                         the two quaternions of a rotation */
    PL_GRADE_EXACT,   /* both differences at most 1e-9 */
    PL_GRADE_CLOSE,   /* at most 1e-3 */
    PL_GRADE_DIFFERS,
    PL_GRADE_FAILED,      /* one of the two runs came to no end */
    PL_GRADE_INAPPLICABLE /* the check cannot be made of this scene */
} pl_grade;

/* "bitwise" ... */
const char *pl_grade_name(pl_grade grade);

/* At one time: the largest over the dynamic bodies. */
typedef struct pl_difference {
    double position; /* over the size of the scene; 1 */
    double rotation; /* rad */
    bool same;       /* bitwise, up to that time */
} pl_difference;

typedef struct pl_agreement {
    pl_difference early; /* at a tenth of the run, before chaos has had its time */
    pl_difference end;
    double
        passes_at; /* s: the first frame where a position is off by 1e-6 of the size; NAN: none */
} pl_agreement;

/* What is compared. */
typedef struct pl_trajectory_pair {
    const pl_scene *scene; /* the plain one */
    const pl_transform *transform;
    double size;          /* m, of the plain scene */
    pl_trajectory *plain; /* a whole run of `scene` */
    pl_trajectory *other; /* of the transformed one, or of the rest of it */
    int other_body_count;
    long first; /* the frame of the plain run that the other's first frame is the same as */
} pl_trajectory_pair;

/* PL_FAILED: one of them has fewer frames than there are steps. */
pl_status pl_compare_trajectories(const pl_trajectory_pair *comparison, pl_agreement *agreement,
                                  pl_error *error);

pl_grade pl_difference_grade(const pl_difference *difference);

#endif
