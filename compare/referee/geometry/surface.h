/* The surface of a solid with flat faces: the distance of a point or of another surface, which side
 * of it a point is on, and where the edges of another surface pierce it.
 *
 * The triangles are in a tree of boxes, so that the cost of a query is about the logarithm of their
 * number plus the number of triangles near the query. Points are in the shape's own frame, m. */
#ifndef PLUMB_SURFACE_H
#define PLUMB_SURFACE_H

#include "base/arena.h"
#include "plumb/scene.h"
#include "plumb/vec.h"

#include <stdbool.h>

/* ---- Distances of points, segments and triangles (segment.c) ----
 *
 * A segment may have no length, and a triangle no area. Source: Ericson 2005, ch. 5. */

/* A line segment; m. */
typedef struct pl_segment {
    pl_vec start, end;
} pl_segment;

/* A triangle, counter-clockwise seen from outside where it bounds a solid; m. */
typedef struct pl_triangle {
    pl_vec corner[3];
} pl_triangle;

/* The feature of a triangle on which a point lies. */
typedef enum pl_feature {
    PL_CORNER_0,   /* + k: corner k */
    PL_EDGE_0 = 3, /* + k: within the edge from corner k to the next */
    PL_FACE = 6
} pl_feature;

/* The distance of two segments, m. */
double pl_segment_distance(const pl_segment *a, const pl_segment *b);

/* The point of a triangle nearest to `point`, and the feature that it lies on (NULL allowed). */
pl_vec pl_triangle_nearest(const pl_triangle *triangle, pl_vec point, pl_feature *feature);

/* Whether a segment crosses a triangle in one point, and where: the fraction of the segment's
 * length from its start, 0 .. 1. False for a segment in the triangle's plane. */
bool pl_triangle_pierced(const pl_triangle *triangle, const pl_segment *segment, double *fraction);

/* The distance of two triangles, m; 0 if they meet. */
double pl_triangle_distance(const pl_triangle *a, const pl_triangle *b);

/* ---- Surfaces ---- */

/* An edge of a surface, shared by its triangles. */
typedef struct pl_surface_edge {
    int start, end; /* vertices */
    int triangle;   /* the first triangle with this edge */
    pl_vec normal;  /* sum of the unit normals of the triangles with this edge */
} pl_surface_edge;

/* A box around some triangles. The first child of a branch is the next node, the second is
 * `second`. */
typedef struct pl_surface_node {
    pl_vec centre, half;
    int first, count; /* of a leaf, in `order`; a branch has count 0 */
    int second;
} pl_surface_node;

/* A surface of triangles in the frame of its body, m, with its edges and a tree of boxes. */
typedef struct pl_surface {
    bool closed; /* bounds a solid */
    int vertex_count, triangle_count, edge_count, node_count;
    pl_vec *vertices;
    int (*triangles)[3]; /* counter-clockwise seen from outside */
    pl_vec *normals;     /* (triangle_count) unit */
    int (*sides)[3];     /* (triangle_count) edges; side k runs from corner k to the next */
    pl_surface_edge *edges;
    pl_vec *vertex_normals; /* (vertex_count) sums over the faces, weighted by their angles */
    int *ring_start;        /* (vertex_count + 1) start of each vertex's edges in `ring` */
    int *ring;              /* (2 edge_count) edges */
    int *parts;             /* (part_count) one vertex of each connected part */
    int part_count;
    pl_surface_node *nodes;
    int *order; /* (triangle_count) */
} pl_surface;

/* The surface of a box, a hull or a mesh, or of the core of a capsule, which is a triangle without
 * area that bounds no solid; NULL for another shape. It copies the shape's data into memory of the arena. */
const pl_surface *pl_surface_create(const pl_shape *shape, pl_arena *arena);

/* The nearest point of a surface to a query point. */
typedef struct pl_surface_point {
    double distance; /* m; negative if the query point is inside */
    pl_vec point;    /* on the surface */
    int triangle;
} pl_surface_point;

/* The point of the surface nearest to `point`. The sign of the distance follows from the normal of
 * the feature that it lies on, the angle-weighted sum of the normals around it. Source: Baerentzen
 * and Aanaes 2005. */
pl_surface_point pl_surface_nearest(const pl_surface *surface, pl_vec point);

/* Whether a point is in the box around all triangles, enlarged by `margin` (m) on all sides. */
bool pl_surface_box_holds(const pl_surface *surface, pl_vec point, double margin);

/* The corners of a triangle. */
pl_triangle pl_surface_triangle(const pl_surface *surface, int triangle);

/* Calls `see` with each triangle whose box overlaps the box of `centre` and half size `half`. */
void pl_surface_each_near(const pl_surface *surface, pl_vec centre, pl_vec half,
                          void (*see)(void *context, int triangle), void *context);

/* ---- Pairs of surfaces ---- */

/* Two surfaces and their relative pose. */
typedef struct pl_surface_pair {
    const pl_surface *a, *b;
    pl_axes axes;  /* b's axes in a's frame */
    pl_vec offset; /* b's origin in a's frame, m */
} pl_surface_pair;

/* The distance of the surfaces (not of their solids), m; 0 if they cross; HUGE_VAL if it is above
 * `within`. */
double pl_surface_pair_distance(const pl_surface_pair *pair, double within);

/* A point where an edge of one surface pierces a triangle of the other. */
typedef struct pl_piercing {
    int of;          /* 0: an edge of a pierces b; 1: an edge of b pierces a */
    int edge;        /* of the one surface */
    int triangle;    /* of the other */
    double fraction; /* of the edge's length from its start, 0 .. 1 */
} pl_piercing;

/* All piercings, ordered by `of`, edge and fraction. NULL if there are none; the caller frees it. */
pl_piercing *pl_surface_pair_piercings(const pl_surface_pair *pair, int *count);

#endif
