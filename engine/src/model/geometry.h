/* The solid of a hull or a mesh: its surface, its mass properties and its bounding volumes.
 *
 * Everything is in the body's axes: the principal axes through the centre of mass. `frame` leads
 * back to the frame of the caller's vertices: x_caller = centre + R(orientation) x_body. Immutable
 * once made. */
#ifndef PE_GEOMETRY_H
#define PE_GEOMETRY_H

#include "base/memory.h"
#include "base/vec3.h"

/* A face: connected triangles of one plane. Those of a convex solid are convex polygons. */
typedef struct pe_face {
    pe_vec3 normal;                 /* unit, outwards */
    double offset;                  /* m: n.x = offset in the plane */
    int first_corner, corner_count; /* convex solids: corners in order; others: 0, 0 */
} pe_face;

/* An edge between two faces. Triangle sides inside a flat face are not edges. It runs from
 * vertex[0] to vertex[1] in the order of face[0], counter-clockwise seen from outside, and back in
 * that of face[1]. */
typedef struct pe_edge {
    int vertex[2];
    int face[2];
    bool convex; /* the solid lies within both faces' half-spaces near the edge */
} pe_edge;

/* A node of the tree of triangles, in depth-first order: the left child comes next. */
typedef struct pe_node {
    pe_mat3 axes;         /* of its box, in rows, in the body's axes */
    pe_vec3 centre, half; /* of the box; `half` along its own axes, m */
    double radius;        /* |half| */
    int right;            /* inner node: index of the right child; leaf: -1 */
    int first, count;     /* of its triangles, which are consecutive in `triangles` */
} pe_node;

/* The solid of a hull or a mesh in its frame of principal axes, with its faces, edges and a tree of
 * boxes. */
typedef struct pe_geometry {
    bool convex; /* detected; a hull must be */
    int vertex_count, triangle_count, face_count, edge_count, corner_count, node_count;
    pe_vec3 *vertices;        /* (vertex_count), m */
    int (*triangles)[3];      /* (triangle_count), in the order of the tree's leaves */
    int (*triangle_edges)[3]; /* (triangle_count): edge from corner k to corner k + 1; -1: flat */
    int *triangle_face;       /* (triangle_count) */
    /* (triangle_count): bit k: corner k, bit 3 + k: the edge from corner k. Every vertex with edges
     * and every convex edge is owned by one triangle, an edge by one of its face[0], so that pairs
     * of triangles give each pair of features once. */
    unsigned char *triangle_owns;
    pe_face *faces;                   /* (face_count) */
    pe_edge *edges;                   /* (edge_count) */
    int *corners;                     /* (corner_count): vertices of the faces of a convex solid */
    int *vertex_first, *vertex_edges; /* (vertex_count + 1), (2 edge_count): edges at a vertex */
    pe_node *nodes;                   /* (node_count): root first */
    pe_geometry_frame frame;
    pe_mat3 rotation;             /* of frame.orientation */
    double bounding_radius;       /* about the centre of mass, m */
    double size;                  /* m, half the least extent of a box along the body's axes */
    pe_vec3 box_centre, box_half; /* of that box, m */
    pe_arena arena;               /* holds the arrays above */
} pe_geometry;

/* Whether a hull or mesh is collided as a convex polyhedron: it is convex, and has so few faces
 * that separating axes are quicker than a tree. */
static inline bool pe_geometry_is_polytope(const pe_geometry *g)
{
    enum { MOST_FACES = 512 };
    return g != NULL && g->convex && g->face_count <= MOST_FACES;
}

/* The geometry of an id; NULL: the id is not of this world. */
const pe_geometry *pe_geometry_of(const struct pe_world *world, pe_geometry_id id);

/* NULL is allowed. */
void pe_geometry_free(pe_geometry *geometry, const pe_allocator *allocator);

/* Makes *geometry from the def. The caller frees it with pe_geometry_free. Errors are those of
 * pe_geometry_create. */
pe_status pe_geometry_make(const pe_geometry_def *def, const pe_allocator *allocator,
                           pe_geometry **geometry, pe_error *error);

#endif
