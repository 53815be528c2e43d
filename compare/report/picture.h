/* Pictures of a scene as inline SVG for an HTML page, in four steps, each in its file:
 *
 * view.c            the orthographic view, one for all engines, so that they can be compared
 * facets.c          the surface of a body as flat facets, no finer than the picture shows
 * hidden_surface.c  which faces are seen, and the order in which to paint them
 * svg.c             the drawing
 *
 * Colours are those of page/page.css: classes d0..d5 (moving bodies, dark to light), s0..s5
 * (static), f0..f5 (fallen), fine (a facet of a body that is no box), ground, expected, start. */
#ifndef PLUMB_REPORT_PICTURE_H
#define PLUMB_REPORT_PICTURE_H

#include "base/text_buffer.h"
#include "plumb/scene.h"
#include "plumb/vec.h"

/* ---- View ---- */

/* A body's place as an item of `final_poses`: x, y, z, qw, qx, qy, qz. */
typedef struct pl_pose {
    double position[3];
    double orientation[4];
} pl_pose;

/* An orthographic view and its frame. */
typedef struct pl_view {
    pl_vec right, up, toward; /* world, orthonormal; toward the eye */
    double scale;             /* px/m */
    double left, top;         /* m: right and up coordinates of the picture's top left corner */
    double width, height;     /* px, whole numbers */
    pl_vec centre;            /* world, m: the mean of the moving bodies' centres at the start */
    double reach;             /* m: level distance from there of the farthest body in the frame */
} pl_view;

/* A point of a picture, px from its top left corner, y down. */
typedef struct pl_pixel {
    double x, y;
} pl_pixel;

/* Returns the pose of a body in the scene at t = 0. */
pl_pose pl_pose_of(const pl_body *body);

/* Lists where the scene's expectations put their bodies: rests first, then travels. `poses` and
 * `bodies` (indices) have room for rest_count + travel_count. Returns how many there are. */
int pl_expected_poses(const pl_scene *scene, pl_pose *poses, int *bodies);

/* Chooses directions and frame. A slope (tilted static plane or box) is seen exactly from the side,
 * running down to the right; everything else from the front, across its longest horizontal axis,
 * turned by 25 degrees and from 12 degrees above. The frame holds the start and the expected poses,
 * and the final poses runs[k][body_count] of `run_count` runs (a NULL is skipped) as far as they
 * stay within one picture's size of that. */
pl_view pl_view_choose(const pl_scene *scene, const pl_pose *const *runs, int run_count);

/* Projects a point of the world. */
pl_pixel pl_view_project(const pl_view *view, pl_vec point);

/* Twice the area of the triangle o a b, px^2; positive when it turns from x towards y. */
double pl_pixel_turn(pl_pixel o, pl_pixel a, pl_pixel b);

/* ---- Facets ---- */

/* Counter-clockwise seen from outside, in the shape's own frame, m. The last corner of a triangle
 * is there twice. */
typedef struct pl_facet {
    pl_vec corner[4];
    bool triangle;
} pl_facet;

/* Starts as {0}; the caller frees `items`. */
typedef struct pl_facets {
    pl_facet *items; /* (count) */
    int count;
    bool failed; /* out of memory */
} pl_facets;

/* Returns the facets of a box, capsule, cylinder, hull or mesh (of others none), without details
 * smaller than about `resolution` (m, > 0): vertices of a hull or mesh that share a grid cell of
 * that size become one, and triangles between fewer than three such cells are left out. */
pl_facets pl_facets_of(const pl_shape *shape, double resolution);

/* ---- Hidden-surface removal ---- */

/* A flat quadrilateral, a triangle, whose last corner is there twice, or a sphere's disc (corner 0
 * is its centre). */
typedef struct pl_face {
    pl_pixel corner[4];
    double depth[4]; /* px, of the corners; larger is nearer the eye */
    double radius;   /* px; 0 for a quadrilateral or triangle */
    char kind;       /* these are for the drawing only */
    int shade;
    bool triangle, fine;
} pl_face;

/* The faces of a picture. */
typedef struct pl_painting {
    pl_face *faces;
    int count;
} pl_painting;

/* Drops the faces that are hidden everywhere in a picture of width x height px, and sorts the
 * others so that, painted in their order, they show the nearest one at every sample. Deterministic.
 * False when out of memory: the painting is then in any order. Time: samples covered, summed over
 * faces. */
bool pl_painting_arrange(pl_painting *painting, double width, double height);

/* Whether some of the face is inside the picture, judged by its bounding rectangle. */
bool pl_face_inside(const pl_face *face, double width, double height);

/* ---- Drawing ---- */

/* Adds the dashed outlines of the expected poses, as a hidden svg element with one g element,
 * named `id`, that the pictures of this scene use. Where bodies are expected to travel, it has
 * their start as a dotted outline too. */
void pl_svg_expected(const pl_scene *scene, const pl_view *view, const char *id,
                     pl_text_buffer *out);

/* Adds one picture: ground, expected outlines, then the bodies at poses[body_count] from back to
 * front. A body of `rests` beyond scene.collapse_distance is drawn as fallen. `title` is the
 * picture's alternative text. Returns how many moving bodies lie wholly outside the frame. */
int pl_svg_picture(const pl_scene *scene, const pl_view *view, const pl_pose *poses,
                   const char *expected_id, const char *title, pl_text_buffer *out);

#endif
