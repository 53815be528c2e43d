/* A scene as MJCF, the model format of MuJoCo. Needs no MuJoCo.
 *
 * The model is complete, and loads in MuJoCo's own tools: nothing in it is left to be inferred,
 * bounded, merged or balanced by MuJoCo's compiler. It has what MuJoCo has by default where a scene
 * says nothing, such as the softness of contacts.
 *
 * - Each body of the scene is a geom of its name: that of a plane in the world, each other in a body
 *   of the model, which also has the name. The frame of that body is the principal frame: at the
 *   centre of mass, along the principal axes. MuJoCo numbers the geoms of the world first and those
 *   of bodies next, both in the scene's order.
 * - The keyframe "start" has the initial velocities, where a body moves at the start. MuJoCo 2.2
 *   reads those of at most 166 bodies; the velocities of more are left out, and a comment says so.
 * - MuJoCo takes the larger friction of two geoms. Two bodies whose coefficient is another are a
 *   pair element. Frictionless contacts have condim 1, because MuJoCo raises every coefficient to 1e-5.
 * - Applied forces and expected results have no place in MJCF and are left out. */
#ifndef PLUMB_MJCF_H
#define PLUMB_MJCF_H

#include "base/text_buffer.h"
#include "plumb/base.h"
#include "plumb/scene.h"

/* The most pair elements written: MuJoCo tests each of them in every step. */
enum { PL_MJCF_MAX_PAIRS = 20000 };

/* The most bodies: MuJoCo keeps the numbers of two bodies in 32 bits. */
enum { PL_MJCF_MAX_BODIES = 32766 };

/* Appends the model of the scene. All numbers read back as the same doubles. PL_UNSUPPORTED with the
 * reason: the scene has restitution, a mesh that is no hull, or more bodies or pairs than the
 * limits. */
pl_status pl_mjcf_write(const pl_scene *scene, pl_text_buffer *out, pl_error *error);

/* The velocity of a moving body as that of a free joint: of the centre of mass in the world frame
 * (m/s), and the angular velocity in the body's principal frame (rad/s). */
void pl_mjcf_velocity(const pl_body *body, double velocity[6]);

/* ---- The memory that MuJoCo 2.2 must reserve for a scene before it runs (mujoco_sizes.c) ---- */

/* The sizes of a model, as its element `size` has them. */
typedef struct pl_mujoco_sizes {
    int contacts; /* with a force */
    int nconmax;  /* contacts, also those that only touch and have no rows */
    int njmax;    /* constraint rows: 4 of a contact, which a pyramidal cone takes */
    int nstack;   /* numbers of 8 bytes that the functions of a step allocate */
    double bytes; /* at most what MuJoCo allocates for them */
} pl_mujoco_sizes;

/* The sizes for `contacts` contacts, or for fewer where they would not fit: MuJoCo counts the bytes
 * of its main buffer, which is quadratic in the rows, in an int. contacts 0: the bodies alone are too
 * many. */
pl_mujoco_sizes pl_mujoco_sizes_for(const pl_scene *scene, int contacts);

/* The number of contacts to begin with. */
int pl_mujoco_first_contacts(const pl_scene *scene);

#endif
