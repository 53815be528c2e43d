/* Transforms of a scene under which the laws of mechanics do not change, and the way back for the
 * states of its bodies. Pure functions: a scene in, a new scene out.
 *
 * A place x becomes s M x + d, with M orthogonal. Length s goes with mass s^3 and time sqrt(s), so
 * that gravity and the coefficients of friction and restitution stay as they are: velocities become
 * sqrt(s) M v, angular velocities det(M) M w / sqrt(s) (they are pseudovectors), forces s^3 M f,
 * inertias s^5. */
#ifndef PLUMB_TRANSFORM_H
#define PLUMB_TRANSFORM_H

#include "plumb/engine_abi.h"

typedef enum pl_body_order { PL_ORDER_SAME, PL_ORDER_REVERSED, PL_ORDER_SHUFFLED } pl_body_order;

typedef struct pl_transform {
    double matrix[3][3]; /* M, by rows; quarter turns and the mirror hold exact 0 and +-1 */
    double turn[4];      /* M as a unit quaternion (w, x, y, z); the identity for the mirror */
    bool mirrored;       /* M is y -> -y */
    double scale;        /* s > 0 */
    double shift[3];     /* d, m */
    pl_body_order order;
    bool has_copy;         /* all bodies but planes a second time, and their forces */
    double copy_offset[3]; /* m, in the scene as it was; planes must map to themselves under it */
} pl_transform;

pl_transform pl_transform_identity(void);

/* About axis 0, 1 or 2 (x, y, z) by so many eighths of a turn, -7 .. 7. */
pl_transform pl_transform_rotation(int axis, int eighths);
pl_transform pl_transform_mirror(void); /* y -> -y */
pl_transform pl_transform_scaling(double scale);
pl_transform pl_transform_shift(double x, double y, double z);
pl_transform pl_transform_order(pl_body_order order);
pl_transform pl_transform_copy(const double offset[3]);

/* The transformed scene, without what was expected of the scene before. The caller frees *to, which
 * is left empty on failure. PL_NO_MEMORY; PL_BAD_INPUT when the copies are too many bodies, or
 * their names are taken. */
pl_status pl_transform_scene(const pl_transform *transform, const pl_scene *from, pl_scene *to,
                             pl_error *error);

/* Where body `body` of a scene of body_count bodies stands in the transformed scene. */
int pl_transform_index(const pl_transform *transform, int body, int body_count);

/* The state of a body of the transformed scene as one of the scene before. Not in place. */
void pl_transform_state_back(const pl_transform *transform, const pl_body_state *from,
                             pl_body_state *to);

/* A copy of a valid scene that shares nothing with it, without what is expected of it. Forces come
 * in the order of their bodies; polyhedra that have neither a name nor a body are left out. The
 * caller frees *to, which is left empty on failure. */
pl_status pl_scene_copy_problem(const pl_scene *from, pl_scene *to, pl_error *error);

#endif
