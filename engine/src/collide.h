/* Narrow phase: the contact points of a pair of placed shapes. */
#ifndef PE_COLLIDE_H
#define PE_COLLIDE_H

#include "world.h"

/* One point as a collider finds it. */
typedef struct pe_hit {
    pe_vec3 position; /* world, halfway between the surfaces */
    double separation;
    uint32_t feature;
} pe_hit;

/* The points of a pair share one normal. count 0: farther apart than the margin. */
typedef struct pe_hits {
    pe_vec3 normal;   /* unit, from the first shape to the second */
    bool normal_on_b; /* it turns with the second shape; else, at small turns, with the first */
    double least_margin, end_margin; /* m: the same points at every margin in [least, end) */
    int count;
    pe_hit item[PE_MAX_POINTS];
} pe_hits;

/* A shape where it is, with the scale of its tolerances. */
typedef struct pe_placed {
    const pe_shape *shape;
    const pe_pose *pose;
    double size; /* m, pe_shape_size */
} pe_placed;

/* Points of two shapes with a gap of at most `margin`. All shapes but plane against plane. */
void pe_collide(pe_placed a, pe_placed b, double margin, pe_hits *hits);

/* By pair of kinds, the first kind first. */
void pe_collide_plane_sphere(pe_placed plane, pe_placed sphere, double margin, pe_hits *hits);
void pe_collide_plane_box(pe_placed plane, pe_placed box, double margin, pe_hits *hits);
void pe_collide_sphere_sphere(pe_placed a, pe_placed b, double margin, pe_hits *hits);
void pe_collide_sphere_box(pe_placed sphere, pe_placed box, double margin, pe_hits *hits);
void pe_collide_box_box(pe_placed a, pe_placed b, double margin, pe_hits *hits);

#endif
