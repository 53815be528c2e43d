/* Closed surfaces of triangles by known construction, for tests of hulls and meshes. */
#ifndef PLUMB_TEST_SOLID_FORMS_H
#define PLUMB_TEST_SOLID_FORMS_H

#include "base/vec3.h"
#include "check.h"

enum { FORM_VERTICES = 256, FORM_TRIANGLES = 512 };

typedef struct form {
    int vertex_count, triangle_count;
    pe_vec3 vertices[FORM_VERTICES];
    uint32_t triangles[FORM_TRIANGLES][3]; /* counter-clockwise seen from outside */
} form;

/* A regular polygon of 3 to 80 sides at z = -1, circumradius 1, and the same scaled by `top` at
 * z = 1, its centre moved by `shift` along x. Sides are planar. */
form form_frustum(int sides, double top, double shift);

/* The prism over a polygon, counter-clockwise, from z = low to high. All of the polygon must be
 * visible from its first corner. */
form form_prism(const double (*outline)[2], int count, double low, double high);

/* The convex hull of at most 24 points, no four of which lie in a plane of its surface. */
form form_hull(const pe_vec3 *points, int count);

form form_tetrahedron(void);
form form_icosahedron(void);

/* An icosahedron whose triangles are cut in four, twice, with the new corners on the sphere: 320
 * faces. */
form form_icosphere(void);
form form_cube(void);
form form_random_hull(check_random *random, int count);

/* An L of three unit squares, half a unit thick. */
form form_l_shape(void);

/* A torus about z, by the radii of its ring and its tube. At most 256 vertices. */
form form_torus(double major, double minor, int around, int across);

void form_scale(form *f, pe_vec3 factors); /* all positive */

#endif
