/* A solid as the mesh colliders see it, and its features: a mesh, a hull, a box, or the core of a
 * rounded shape (a point or a segment).
 *
 * A facet is a triangle, a ridge an edge that the facet owns. Each vertex and each convex edge of a
 * mesh is owned by one triangle (triangle_owns in geometry.h), so that each is tested once. */
#ifndef PE_MESH_SOLID_H
#define PE_MESH_SOLID_H

#include "narrow_phase/convex/polytope.h"

/* The arrays are as in pe_geometry. A core has one triangle without area and no faces. */
typedef struct pe_solid {
    bool core, convex;
    const pe_node *nodes;
    const pe_vec3 *vertices;
    const int (*triangles)[3], (*triangle_edges)[3];
    const int *triangle_face;
    const unsigned char *triangle_owns;
    const pe_face *faces;
    const pe_edge *edges;
    const int *vertex_first, *vertex_edges;
    int vertex_count, triangle_count;
    double volume; /* m^3; of a core 0 */
} pe_solid;

/* Storage for the arrays of a solid without geometry. */
typedef struct pe_small_solid {
    pe_polytope polytope;
    pe_node nodes[11];
} pe_small_solid;

/* The solid of a hull or mesh. It borrows the arrays of the geometry. */
pe_solid pe_solid_of_geometry(const pe_geometry *g);

/* The solid of a sphere, box, capsule, hull or mesh. It points into *small. */
pe_solid pe_solid_of(pe_placed placed, pe_small_solid *small);

/* An edge that a facet owns. That of a core has no normals. */
typedef struct pe_ridge {
    pe_vec3 x, along;  /* from its first vertex to the second */
    pe_vec3 normal[2]; /* of its faces, in the order of pe_edge */
    double length, length2;
    int edge;
} pe_ridge;

/* A triangle. For a core all fields except the corners are zero. */
typedef struct pe_facet {
    pe_vec3 x[3], normal;
    double offset; /* n.x = offset in the plane */
    const int *vertices, *edges;
    int face; /* -1: of a core */
    unsigned owns;
    int ridge_count; /* -1: not filled yet, see pe_facet_ridges */
    pe_ridge ridges[3];
} pe_facet;

/* Whether the facet owns its corner k. */
static inline bool pe_facet_owns_corner(const pe_facet *f, int k)
{
    return (f->owns >> k & 1) != 0;
}

/* Whether the facet owns its edge from corner k. */
static inline bool pe_facet_owns_edge(const pe_facet *f, int k)
{
    return (f->owns >> (3 + k) & 1) != 0;
}

/* A triangle in the solid's axes. */
void pe_solid_facet(const pe_solid *solid, int triangle, pe_facet *facet);

/* A triangle in the axes in which `placed` places the solid. */
void pe_solid_facet_placed(const pe_solid *solid, const pe_transform *placed, int triangle,
                           pe_facet *facet);

/* Fills the facet's ridges, if not done before. `placed`: as it was made; NULL: not placed. */
void pe_facet_ridges(const pe_solid *solid, const pe_transform *placed, pe_facet *facet);

/* Whether x, projected onto the facet's plane, lies on it or at most `slack` beyond its rim. Beyond a
 * border inside a face only rounding counts: the next triangle has the point. */
bool pe_facet_contains(const pe_facet *facet, pe_vec3 x, double slack);

/* The same without slack beyond edges of the solid: only for rounding at borders inside a face. */
bool pe_facet_covers(const pe_facet *facet, pe_vec3 x, double slack);

/* Where a point lies when it is projected onto the plane of a facet. */
typedef enum pe_facet_side { PE_OFF_FACET, PE_ON_FACET, PE_BEHIND_DENT } pe_facet_side;

/* The same test as pe_facet_contains, which also finds a point x that lies past a dent, at most
 * `past` (m) beyond the rim, and behind the face across it: there is solid there. */
pe_facet_side pe_facet_contains_dented(const pe_solid *solid, const pe_transform *placed,
                                       const pe_facet *facet, pe_vec3 x, double slack, double past);

/* Signed heights of the corners of two facets over each other's plane. */
typedef struct pe_facet_heights {
    double above_a[3], above_b[3]; /* of b's corners, of a's corners; above_a is 0 if a is a core */
} pe_facet_heights;

/* False if one facet lies above `bound` or below -bound over the other: they are farther apart. */
bool pe_facets_heights(const pe_facet *a, const pe_facet *b, double bound, pe_facet_heights *h);

/* The largest number of points that pe_facets_cross finds. */
enum { PE_MOST_PIERCINGS = 6 };

/* The points where edges of either facet pass through the other. Returns their number; 0: the
 * facets do not cross. Points within `slack` of touching count. With 0, edges that only touch may
 * count. */
int pe_facets_cross(const pe_facet *a, const pe_facet *b, const pe_facet_heights *h, double slack,
                    pe_vec3 where[PE_MOST_PIERCINGS]);

/* Whether the direction n, of the given length, lies between the normals of the ridge's faces, or
 * outside by an angle of at most that sine: it rises along neither face. */
bool pe_ridge_faces(const pe_ridge *ridge, pe_vec3 n, double length, double sine);

/* Whether no edge at the vertex falls along d, of the given length, by more than an angle of that
 * sine. d is in the solid's axes. */
bool pe_vertex_faces(const pe_solid *solid, int vertex, pe_vec3 d, double length, double sine);

/* Whether a vertex may take the normal of a face of another solid: no edge leads from the vertex
 * towards that face, except at a small angle. The normal is in the solid's axes and points away
 * from the face. *strict: at an angle of rounding at most. */
bool pe_vertex_takes_normal(const pe_solid *solid, int vertex, pe_vec3 normal, bool *strict);

/* Nearest points x + s u and y + t v of two segments, s and t in 0 .. 1. */
void pe_segments_nearest(pe_vec3 x, pe_vec3 u, pe_vec3 y, pe_vec3 v, double *s, double *t);

#endif
