/* The surface of a solid with flat faces, ready to be asked: where it is nearest to a point or to
 * another surface, which side of it a point is on, and where the edges of another pierce it.
 *
 * Its triangles are in a tree of boxes, so that a question costs about the logarithm of their
 * number and what is near. All points are in the shape's own frame, m. */
#ifndef PLUMB_SURFACE_H
#define PLUMB_SURFACE_H

#include "plumb/scene.h"
#include "segment.h"

typedef struct pl_surface_edge {
    int start, end; /* vertices */
    int triangle;   /* the first that has it */
    pl_vec normal;  /* sum of the unit normals of the triangles that have it */
} pl_surface_edge;

/* A box around some triangles. A branch's first child is the next node, its second is `second`. */
typedef struct pl_surface_node {
    pl_vec centre, half;
    int first, count; /* of a leaf, in `order`; a branch has count 0 */
    int second;
} pl_surface_node;

typedef struct pl_surface {
    bool closed; /* it bounds a solid */
    int vertex_count, triangle_count, edge_count, node_count;
    pl_vec *vertices;
    int (*triangles)[3]; /* counter-clockwise seen from outside */
    pl_vec *normals;     /* (triangle_count) unit */
    int (*sides)[3];     /* (triangle_count) edges; side k runs from corner k to the next */
    pl_surface_edge *edges;
    pl_vec *vertex_normals; /* (vertex_count) of the faces around, weighted by their angles */
    int *ring_start;        /* (vertex_count + 1) where each vertex's edges begin in `ring` */
    int *ring;              /* (2 edge_count) edges */
    int *parts;             /* (part_count) one vertex of each connected part */
    int part_count;
    pl_surface_node *nodes;
    int *order; /* (triangle_count) */
} pl_surface;

/* Of a box, a hull or a mesh; of a capsule its core, a triangle without area that bounds no solid.
 * A copy: the shape may go. *surface is NULL on failure. PL_UNSUPPORTED for another shape,
 * PL_NO_MEMORY. The caller frees it by pl_surface_destroy (NULL allowed). */
pl_status pl_surface_create(const pl_shape *shape, pl_surface **surface);
void pl_surface_destroy(pl_surface *surface);

typedef struct pl_surface_point {
    double distance; /* m; minus that if the point asked about is inside */
    pl_vec point;    /* on the surface */
    int triangle;
} pl_surface_point;

/* The point of the surface nearest to `point`. The side is told by the normal of the feature it
 * lies on, the sum of those around weighted by their angles. Source: Baerentzen and Aanaes 2005. */
pl_surface_point pl_surface_nearest(const pl_surface *surface, pl_vec point);

/* Whether a point is in the box around all triangles, widened by `margin`. */
bool pl_surface_box_holds(const pl_surface *surface, pl_vec point, double margin);

pl_triangle pl_surface_triangle(const pl_surface *surface, int triangle);

/* Calls `see` with each triangle whose box meets that of `centre` and `half`. */
void pl_surface_each_near(const pl_surface *surface, pl_vec centre, pl_vec half,
                          void (*see)(void *context, int triangle), void *context);

#endif
