/* Surfaces of triangles for scenarios with hulls and meshes. Lengths in m; triangles are
 * counter-clockwise seen from outside. */
#ifndef PLUMB_SOLIDS_H
#define PLUMB_SOLIDS_H

#include "scene_builder.h"

/* A closed surface. Without vertices it means out of memory. */
typedef struct pl_solid {
    double (*vertices)[3]; /* (vertex_count) */
    int (*triangles)[3];   /* (triangle_count) */
    int vertex_count;
    int triangle_count;
} pl_solid;

/* A box about the origin, along the axes. */
pl_solid pl_solid_box(double half_x, double half_y, double half_z);

/* A regular tetrahedron about the origin, with a face below, at z = -*height. */
pl_solid pl_solid_tetrahedron(double edge, double *height);

/* A regular icosahedron about the origin, with a face below, at z = -*height. */
pl_solid pl_solid_icosahedron(double edge, double *height);

/* A regular prism of `sides` sides with corners at `radius`, about the origin, its axis along z;
 * the faces of its sides look along x, and so on around. */
pl_solid pl_solid_prism(int sides, double radius, double half_height);

/* An L in x and z, of `length` and `thickness`, its corner at the origin and its foot on z = 0;
 * from 0 to `width` in y. */
pl_solid pl_solid_angle(double length, double thickness, double width);

/* A block with its top at z = 0, from -half to half in x and y and `depth` deep, and a crack along y in
 * its middle, from -half_width to half_width and 0.9 of the depth. */
pl_solid pl_solid_crack(double half, double half_width, double depth);

/* The same block with a square hole through it, from -half_width to half_width in x and y. */
pl_solid pl_solid_hole(double half, double half_width, double depth);

/* A box about the origin, along the axes, whose top and bottom are grids of n by n quads. */
pl_solid pl_solid_slab(double half_x, double half_y, double half_z, int n);

/* A torus about the origin, its axis along z: a ring of radius R made of `around` straight pieces
 * of a tube, each a prism with `sides` sides and corners at radius r. A flat side of a piece looks
 * along x; with `sides` a multiple of 4, others look up and down, and inwards. */
pl_solid pl_solid_torus(double ring_radius, double tube_radius, int around, int sides);

/* The distance from the axis of such a torus to the middle of an inner side, for `sides` a
 * multiple of 4. */
double pl_torus_hole(double ring_radius, double tube_radius, int around, int sides);

/* Half the height of such a torus, for `sides` a multiple of 4. */
double pl_torus_half_height(double tube_radius, int sides);

/* Frees the arrays. */
void pl_solid_free(pl_solid *solid);

/* Makes the scene's polyhedron of the solid, as the hull of its vertices or as a mesh, frees the
 * solid and returns the shape; a shape without polyhedron after a failure. */
pl_shape pl_build_solid(pl_builder *builder, pl_solid *solid, bool convex, const char *name);

/* Makes a stone the scene's and returns its shape: the hull of 14 random points on an ellipsoid
 * about the origin, whose half axes are random from `least` to `most` m. A shape without polyhedron
 * after a failure. */
pl_shape pl_build_stone(pl_builder *builder, const char *name, double least, double most);

#endif
