/* Convex polyhedra swept by a ball, as collision sees them: a box, a hull, a capsule (a segment
 * swept by its radius) and a sphere (a point). Vertices, edges and faces are those of the core, in
 * the body's axes, whose origin lies inside.
 *
 * The separation of two cores is the largest value, over the unit directions n, of the distance
 * from the last point of the first one along n to the first point of the second. Where it is
 * positive it is their distance; where negative, less the shortest translation that parts them. */
#ifndef PE_POLYTOPE_H
#define PE_POLYTOPE_H

#include "narrow_phase/collide.h"

typedef struct pe_polytope {
    int vertex_count, edge_count, face_count;
    const pe_vec3 *vertices;
    const pe_edge *edges; /* a segment's one edge has no faces */
    const pe_face *faces;
    const int *corners, *vertex_first, *vertex_edges; /* as in pe_geometry */
    double radius;                                    /* m, of the ball */
    double inner;                                     /* m: |x| <= inner lies in the core */
    pe_vec3 own_vertices[8];                          /* of a shape that is no hull */
    pe_face own_faces[6];
} pe_polytope;

/* Points of one body in the axes of another: x = turn x_other + offset. */
typedef struct pe_seen {
    pe_mat3 turn;
    pe_vec3 offset;
} pe_seen;

typedef struct pe_polytope_pair {
    pe_polytope a, b;
    const pe_pose *pose_a, *pose_b;
    pe_seen b_from_a, a_from_b; /* b in a's axes, a in b's axes */
    double size;                /* m, of the smaller shape: the scale of tolerances */
} pe_polytope_pair;

/* Describes the core of a sphere, box, capsule or hull. Not to be copied. */
void pe_polytope_make(pe_placed placed, pe_polytope *p);

/* Describes the pair. Not to be copied. */
void pe_polytope_pair_make(pe_placed a, pe_placed b, pe_polytope_pair *pair);

/* A vertex farthest along d; the climb starts at vertex `from`, or anywhere if it is -1. */
int pe_polytope_support(const pe_polytope *p, pe_vec3 d, int from);

/* The face at the last vertex along the unit direction d that looks most along it, with the cosine
 * between them; where an edge is last, one of its two. Ties go to the lower index. Not for points
 * and segments. */
int pe_polytope_facing(const pe_polytope *p, pe_vec3 d, double *cosine);

/* Vertices of a face, in order: of more than PE_FACE_CORNERS so many, evenly spaced. */
enum { PE_FACE_CORNERS = 64 };
int pe_face_corners(const pe_face *face);
int pe_face_corner(const pe_polytope *p, const pe_face *face, int k);

/* A direction with what is known about it. */
typedef struct pe_separation {
    double distance; /* m, of the cores along the normal */
    pe_vec3 normal;  /* unit, in a's axes, from a to b */
    enum { PE_OF_FACE_A, PE_OF_FACE_B, PE_OF_EDGES, PE_OF_POINTS } kind;
    int a, b; /* the face; the edge of each */
    /* Not of edges: nearest points along the normal, in a's axes, that of a face perhaps beside it,
     * and the first and last of the vertices that they lie among (0 for a face). */
    pe_vec3 on_a, on_b;
    int ends_a[2], ends_b[2];
} pe_separation;

/* The best face of either core; false as soon as one separates by more than `limit`. */
bool pe_polytope_best_face(const pe_polytope_pair *pair, double limit, pe_separation *best);

/* Replaces *best, a face, by the pair of edges that separates more, if any; false as soon as one
 * separates by more than `limit`. With the faces this is the separation of cores that overlap. */
bool pe_polytope_best_edges(const pe_polytope_pair *pair, double limit, pe_separation *best);

/* The distance of cores that `start` separates or touches along, with the nearest points. */
pe_separation pe_polytope_distance(const pe_polytope_pair *pair, const pe_separation *start);

/* The least distance of the cores along the unit direction n in a's axes. */
double pe_polytope_separation_along(const pe_polytope_pair *pair, pe_vec3 n);

/* Points of two shapes whose cores `start` separates. */
void pe_collide_polytopes_apart(const pe_polytope_pair *pair, const pe_separation *start,
                                double margin, pe_pair_manifold *hits);

#endif
