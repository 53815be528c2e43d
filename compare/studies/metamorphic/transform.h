/* Transforms of a scene that leave the laws of mechanics unchanged, and the inverse for the states
 * of its bodies. Pure functions: a scene in, a new scene out.
 *
 * A position x becomes s M x + d, with M orthogonal. Length scales with s, mass with s^3 and time
 * with sqrt(s), so that gravity and the coefficients of friction and restitution do not change:
 * velocities become sqrt(s) M v, angular velocities det(M) M w / sqrt(s) (they are pseudovectors),
 * forces s^3 M f, inertias s^5. */
#ifndef PLUMB_TRANSFORM_H
#define PLUMB_TRANSFORM_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"

/* The order in which the bodies of the new scene are listed. */
typedef enum pl_body_order { PL_ORDER_SAME, PL_ORDER_REVERSED, PL_ORDER_SHUFFLED } pl_body_order;

/* A change of a scene: positions go from x to s M x + d. */
typedef struct pl_transform {
    double matrix[3][3]; /* M, by rows; quarter turns and the mirror hold exact 0 and +-1 */
    double turn[4];      /* M as a unit quaternion (w, x, y, z); the identity for the mirror */
    bool mirrored;       /* M is y -> -y */
    double scale;        /* s > 0 */
    double shift[3];     /* d, m */
    pl_body_order order;
    bool has_copy;         /* all bodies except planes exist twice, and their forces */
    double copy_offset[3]; /* m, in the original scene; planes must map to themselves under it */
} pl_transform;

/* The transform that changes nothing. */
pl_transform pl_transform_identity(void);

/* A rotation about axis 0, 1 or 2 (x, y, z) by `eighths` of a turn, -7 .. 7. */
pl_transform pl_transform_rotation(int axis, int eighths);

/* y -> -y */
pl_transform pl_transform_mirror(void);

/* The state in which a body starts. */
pl_body_state pl_body_start(const pl_body *body);

/* Lets the body start in that state. */
void pl_body_set_start(pl_body *body, const pl_body_state *state);

/* A deep copy of a valid scene, without its expectations. Forces come in the order of their bodies; polyhedra
 * with neither a name nor a body are left out. The caller frees *to, which is left empty on failure. */
pl_status pl_scene_copy_unjudged(const pl_scene *from, pl_scene *to, pl_error *error);

/* The transformed scene, without the original's expectations. The caller frees *to, which is left
 * empty on failure. PL_BAD_INPUT when there are too many bodies with the copies, or
 * their names are taken. */
pl_status pl_transform_scene(const pl_transform *transform, const pl_scene *from, pl_scene *to,
                             pl_error *error);

/* The index in the transformed scene of body `body` of a scene of body_count bodies. */
int pl_transform_index(const pl_transform *transform, int body, int body_count);

/* Maps the state of a body of the transformed scene back to the original scene. Not in place. */
void pl_transform_state_back(const pl_transform *transform, const pl_body_state *from,
                             pl_body_state *to);

/* The rest of the scene's run after `step` steps, 0 < step < pl_scene_steps, from these states of
 * its bodies. Times count from there. Forces that have ended are gone, and so are expectations. The
 * caller frees *to, which is left empty on failure. */
pl_status pl_restart_scene(const pl_scene *from, const pl_body_state *states, long step,
                           pl_scene *to, pl_error *error);

/* The diagonal of the axis-aligned box around the bounding spheres of the dynamic bodies at the
 * start, m; 1 m where there are none. */
double pl_scene_size(const pl_scene *scene);

/* An offset of `sizes` times pl_scene_size for a copy that does not touch the original: every plane
 * of the scene maps to itself along it. It is horizontal where possible. False when there is none,
 * because planes face all directions. */
bool pl_far_offset(const pl_scene *scene, double sizes, double offset[3]);

/* ---- Other forms of the same static boxes ----
 *
 * The solid that bodies meet stays the same, so that their motion must too. */

/* The number of static boxes of a scene. */
int pl_static_box_count(const pl_scene *scene);

/* The scene with each static box split in two flush boxes of half the size along its own axis 0, 1 or 2
 * (x, y, z). The second halves follow all other bodies. Without the original's expectations. The caller
 * frees *to, which is left empty on failure. PL_BAD_INPUT when there are too many bodies, or
 * their names are taken. */
pl_status pl_split_boxes(const pl_scene *from, int axis, pl_scene *to, pl_error *error);

/* The scene with a closed mesh in the place of each static box, whose faces are divided into n x n
 * rectangles of two triangles. Otherwise as pl_split_boxes; PL_BAD_INPUT when there are too many
 * triangles. */
pl_status pl_tessellate_boxes(const pl_scene *from, int n, pl_scene *to, pl_error *error);

/* ---- Late starts ----
 *
 * A later run makes its steps at other times, and must follow the same path. */

/* The scene that starts `fraction` (0 to 1) of a step later and ends at a whole step before its end, without the
 * original's expectations, if the motion of every dynamic body is known over that time. It is for bodies
 *
 *   in free flight: they reach no other body in that time, and do not spin or keep their spin (it is
 *     along a principal axis, or the principal moments are equal);
 *   at rest: they do not move, and the scene expects that they stay;
 *   in uniform motion on static bodies whose flat, level tops are at one height: they slide without
 *     friction and without spin, or are spheres that roll.
 *
 * A scene with forces has none. Where it is not known, *reason says why, in static storage, and else is NULL. The caller
 * frees *to, which is left empty without such a scene. */
pl_status pl_late_start(const pl_scene *from, double fraction, pl_scene *to, const char **reason,
                        pl_error *error);

/* The state of a body `fraction` of a step of dt (s) after `now`, with the mean accelerations of the step to
 * `next`: exact under constant forces. */
void pl_state_between(const pl_body *body, const pl_body_state *now, const pl_body_state *next,
                      double dt, double fraction, pl_body_state *at);

#endif
