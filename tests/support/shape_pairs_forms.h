/* Closed surfaces of triangles by known construction: what hulls and meshes are tested with. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_FORMS_H
#define PLUMB_TEST_SHAPE_PAIRS_FORMS_H

#include "base/vec3.h"
#include "check.h"

enum { FORM_VERTICES = 256, FORM_TRIANGLES = 512 };

typedef struct form {
    int vertex_count, triangle_count;
    pe_vec3 vertices[FORM_VERTICES];
    uint32_t triangles[FORM_TRIANGLES][3]; /* counter-clockwise seen from outside */
} form;

/* A regular polygon of 3 to 64 sides at z = -1, circumradius 1, and the same scaled by `top` at
 * z = 1, its centre moved by `shift` along x. Sides are planar. */
form form_frustum(int sides, double top, double shift);

/* The convex hull of points of which no four are in a plane of its surface; at most 24. */
form form_hull(const pe_vec3 *points, int count);

form form_tetrahedron(void);
form form_icosahedron(void);

/* Its triangles in four, twice, the new corners on the sphere: 320 faces. */
form form_icosphere(void);
form form_cube(void);
form form_random_hull(check_random *random, int count);

/* A plate of two unit squares and one more at their side, half a unit thick. */
form form_l_shape(void);

/* Around z: radii to the tube's middle and of the tube. At most 256 vertices. */
form form_torus(double major, double minor, int around, int across);

void form_scale(form *f, pe_vec3 factors); /* all positive */

#endif
