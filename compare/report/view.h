/* The orthographic view of a scene's pictures: one for all engines, so that they can be compared.
 */
#ifndef PLUMB_VIEW_H
#define PLUMB_VIEW_H

#include "plumb/scene.h"
#include "plumb/vec.h"

/* A body's place as a row of `final_poses`: x, y, z, qw, qx, qy, qz. */
typedef struct pl_pose {
    double position[3];
    double orientation[4];
} pl_pose;

typedef struct pl_view {
    pl_vec right, up, toward; /* world, orthonormal; toward the eye */
    double scale;             /* px/m */
    double left, top;         /* m: right and up coordinates of the picture's top left corner */
    double width, height;     /* px, whole numbers */
    pl_vec centre;            /* world, m: the mean of the moving bodies' middles at the start */
    double reach;             /* m: level distance from there of the farthest body in the frame */
} pl_view;

/* The pose of a body in the scene at t = 0. */
pl_pose pl_pose_of(const pl_body *body);

/* Where the scene's expectations put their bodies: rests first, then travels. `poses` has room for
 * rest_count + travel_count; bodies[i] is the body's index. Returns how many there are. */
int pl_expected_poses(const pl_scene *scene, pl_pose *poses, int *bodies);

/* Chooses directions and frame. A slope (tilted static plane or box) is seen exactly from the side,
 * running down to the right; everything else from the front, across its longest horizontal axis,
 * turned by 25 degrees and from 12 degrees above. The frame holds the start and the expected poses,
 * and the final poses runs[k][body_count] of `run_count` runs (a NULL is skipped) as far as they
 * stay within one picture's size of that. */
pl_view pl_view_choose(const pl_scene *scene, const pl_pose *const *runs, int run_count);

/* A point of a picture, px from its top left corner, y down. */
typedef struct pl_pixel {
    double x, y;
} pl_pixel;

pl_pixel pl_view_project(const pl_view *view, pl_vec point);

/* Twice the area of the triangle o a b, px^2; positive when it turns from x towards y. */
double pl_pixel_turn(pl_pixel o, pl_pixel a, pl_pixel b);

/* The corners, in the world, of the smallest box along a shape's own axes that holds it (of nothing
 * around a plane's origin). Bit k of the index says which side of axis k. */
void pl_shape_corners(const pl_shape *shape, const pl_pose *pose, pl_vec corners[8]);

#endif
