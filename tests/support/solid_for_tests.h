/* Polyhedra with known volumes and moments, and what is independent of how they are measured. */
#ifndef PLUMB_TEST_SOLID_FOR_TESTS_H
#define PLUMB_TEST_SOLID_FOR_TESTS_H

#include "plumb/scene.h"

/* A surface in the making; zeroed at first. */
typedef struct solid_surface {
    double vertices[8192][3];
    int triangles[16384][3];
    int vertex_count, triangle_count;
} solid_surface;

void known_clear(solid_surface *s);
int known_add_vertex(solid_surface *s, double x, double y, double z);
void known_add_triangle(solid_surface *s, int a, int b, int c);

/* Replaces the surface by four vertices and four triangles. */
void known_make_tetrahedron(solid_surface *s, const double (*vertices)[3],
                            const int (*triangles)[3]);

/* A box about `centre`, its triangles outward, or inward. */
void known_add_box(solid_surface *s, const double centre[3], const double half[3], bool inward);

/* A ring of `sides` regular polygons about z, joined: ring j has radius[j] at height[j]. Closed
 * around, as a torus, where `around`; else capped at both ends, the lowest first. */
void known_add_rings(solid_surface *s, int sides, const double *radius, const double *height,
                     int rings, bool around);

/* Volume and moments of a solid. */
typedef struct solid_moments {
    double volume;
    double mean[3];      /* centre of mass */
    double square[3][3]; /* means of x_i x_j about the centre */
} solid_moments;

/* Of known_add_rings, from its slices: the area of a regular polygon of radius r with n sides is
 * n/2 r^2 sin(2 pi/n), its polar moment n/12 r^4 sin(2 pi/n) (2 + cos(2 pi/n)); over z by Gauss's
 * three points in each band, which is exact. */
solid_moments known_moments_of_rings(int sides, const double *radius, const double *height,
                                     int rings, bool around);

/* Of a sum of boxes that do not overlap; a negative volume is taken away. */
solid_moments known_moments_of_boxes(const double (*centres)[3], const double (*halves)[3],
                                     const int *signs, int count);

/* That volume, centre and the inertia tensor, with axes and principal values put together again,
 * are those of `expected`, the solid turned by `rotation` and then moved by `shift` (NULL: not). */
void known_check(const pl_polyhedron *actual, const solid_moments *expected,
                 const double rotation[4], const double shift[3], double relative);

/* The surface turned, then moved. */
void known_move(solid_surface *s, const double rotation[4], const double shift[3]);

#endif
