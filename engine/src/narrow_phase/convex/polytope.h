/* Convex polyhedra swept by a ball, as the narrow phase sees them: a box, a hull, a capsule (a
 * segment swept by its radius) and a sphere (a point). Vertices, edges and faces are those of the
 * core, in the body's axes, whose origin lies inside.
 *
 * The separation of two cores is the largest value, over the unit directions n, of the distance
 * from the last point of the first core along n to the first point of the second. A positive
 * separation is the distance of the cores. A negative one is minus the length of the minimum
 * translation vector that parts them. */
#ifndef PE_POLYTOPE_H
#define PE_POLYTOPE_H

#include "narrow_phase/collide.h"

/* The core of a convex shape, and the radius of the ball that sweeps it. */
typedef struct pe_polytope {
    int vertex_count, edge_count, face_count;
    const pe_vec3 *vertices;
    const pe_edge *edges; /* a segment's one edge has no faces: -1 */
    const pe_face *faces;
    const int *corners, *vertex_first, *vertex_edges; /* as in pe_geometry */
    double radius;                                    /* m, of the ball */
    double inner;                                     /* m: |x| <= inner lies in the core */
    pe_vec3 own_vertices[8];                          /* of a shape that is not a hull */
    pe_face own_faces[6];
} pe_polytope;

/* Two polytopes and their relative pose. */
typedef struct pe_polytope_pair {
    pe_polytope a, b;
    const pe_pose *pose_a, *pose_b;
    pe_transform b_in_a, a_in_b; /* b in a's axes, a in b's axes */
    double size;                 /* m, of the smaller shape: the scale of tolerances */
} pe_polytope_pair;

/* Corner i of a box: bit k of i is set where it lies on the positive side of axis k. */
static inline pe_vec3 pe_box_corner(pe_vec3 half, int i)
{
    return pe_v3(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
}

/* Describes the core of a sphere, box, capsule or hull. *p points into itself: do not copy it. */
void pe_polytope_make(pe_placed placed, pe_polytope *p);

/* Describes the pair. Do not copy it. */
void pe_polytope_pair_make(pe_placed a, pe_placed b, pe_polytope_pair *pair);

/* A vertex farthest along d. The hill climb starts at vertex `from`; -1: at any. */
int pe_polytope_support(const pe_polytope *p, pe_vec3 d, int from);

/* Of the faces at the support vertex along the unit direction d, the one that looks most along d;
 * if an edge is the support, one of its two faces. *cosine is that of the angle between them. Ties
 * go to the lower index. Not for points and segments. */
int pe_polytope_facing(const pe_polytope *p, pe_vec3 d, double *cosine);

/* A face with more than PE_FACE_CORNERS vertices is represented by that many of them, evenly
 * spaced. */
enum { PE_FACE_CORNERS = 64 };

/* The number of vertices that represent a face. */
int pe_face_corners(const pe_face *face);

/* The index of vertex k of them, in order around the face. */
int pe_face_corner(const pe_polytope *p, const pe_face *face, int k);

/* A direction and the separation of two cores along it. */
typedef struct pe_separation {
    double distance; /* m, of the cores along the normal */
    pe_vec3 normal;  /* unit, in a's axes, from a to b */
    enum { PE_OF_FACE_A, PE_OF_FACE_B, PE_OF_EDGES, PE_OF_LINE, PE_OF_POINTS } kind;
    int a, b; /* the face; the edge of each */
    /* Except of edges and lines: nearest points along the normal, in a's axes (the point of a face may lie
     * outside it), and the first and last of the vertices that they lie among (0 for a face). */
    pe_vec3 on_a, on_b;
    int ends_a[2], ends_b[2];
} pe_separation;

/* The best face of either core. False as soon as one separates by more than `limit` (m). */
bool pe_polytope_best_face(const pe_polytope_pair *pair, double limit, pe_separation *best);

/* Replaces *best, a face, by the pair of edges that separates more, if any. With the faces this is
 * the separation of cores that overlap. False as soon as a pair separates by more than `limit`. */
bool pe_polytope_best_edges(const pe_polytope_pair *pair, double limit, pe_separation *best);

/* The distance and the nearest points of cores that `start` separates or touches along. */
pe_separation pe_polytope_distance(const pe_polytope_pair *pair, const pe_separation *start);

/* Fills the manifold of two boxes or hulls that touch along parallel edges: see polytope_edges.c.
 * False: they do not, and the manifold is as it was. */
bool pe_collide_meeting_edges(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold);

/* The separation of the cores along the unit direction n in a's axes. */
double pe_polytope_separation_along(const pe_polytope_pair *pair, pe_vec3 n);

/* Whether s / sqrt(square) > t, for square > 0, without the root. */
static inline bool pe_quotient_exceeds(double s, double square, double t)
{
    return t < 0 ? s >= 0 || s * s < t * t * square : s > 0 && s * s > t * t * square;
}

#endif
