/* What the parts of the collider of meshes share: two solids, their features, and where they touch.
 *
 * Solid b is the mesh; a is the other shape: a mesh, a hull, a box, or the core of a rounded shape,
 * a point or a segment swept by a ball. All is worked out in b's axes. Normals point from a to b.
 * In the mesh a triangle's edges and vertices are tested for one triangle only (triangle_owns). */
#ifndef PE_COLLIDE_MESH_H
#define PE_COLLIDE_MESH_H

#include "bvh.h"
#include "narrow_phase/collide.h"

/* A solid of triangles as in pe_geometry. A core has one triangle without area and no faces. */
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

/* Room for the numbers of a solid that is no geometry. */
typedef struct pe_small_solid {
    pe_vec3 vertices[8];
    pe_face faces[6];
    pe_node nodes[11];
} pe_small_solid;

struct pe_facet;

/* A ball that holds a facet, and how far the facet reaches towards the other solid, along `parting`
 * of the pair's trees. */
typedef struct pe_facet_ball {
    pe_vec3 centre;
    double radius, along;
} pe_facet_ball;

typedef struct pe_solid_pair {
    pe_solid a, b;
    pe_bvh_pair trees;                /* with the pose of a in b's axes */
    pe_bvh_pair swapped;              /* b in a's axes */
    double radius;                    /* m, of the ball that sweeps a's core; 0: no core */
    double size;                      /* m, least size of the two: the scale of tolerances */
    double slack;                     /* m, see PE_SLACK */
    double band;                      /* m, see PE_BAND */
    double depth;                     /* m, see PE_DEPTH */
    struct pe_facet *near_a, *near_b; /* see pe_solid_pair_gather; NULL: not gathered */
    pe_facet_ball *balls_a, *balls_b;
    int near_count_a, near_count_b;
    pe_small_solid small;
} pe_solid_pair;

/* In units of `size`: a point this far beyond the rim of a face still lies on it. */
#define PE_SLACK 6e-9
/* In units of the margin: how much farther features are looked for, to know from which margin on
 * there would be more. */
#define PE_LOOK_AHEAD 0.1
/* In units of the smaller bounding radius: features whose gap exceeds the least one by more than
 * this are not looked for, whatever the margin. */
#define PE_BAND 0.25
/* In units of `size`: overlaps deeper than this are found from the vertices within alone; and a
 * vertex that far behind a dent at the rim of a face is still over that face. */
#define PE_DEPTH 0.05

pe_solid pe_solid_of_geometry(const pe_geometry *g);

/* The trees of two placed solids. */
pe_bvh_pair pe_bvh_pair_between(const pe_node *a, const pe_pose *pose_a, const pe_node *b,
                                const pe_pose *pose_b);

/* Describes the pair; `pair` must stay where it is. Not for planes and cylinders. */
void pe_solid_pair_make(pe_placed a, pe_placed b, pe_solid_pair *pair);

/* A leaf of one triangle with a box along its body's axes. */
pe_node pe_box_node(pe_vec3 centre, pe_vec3 half);

/* An edge that a facet owns, in b's axes. A core's has no normals. */
typedef struct pe_ridge {
    pe_vec3 x, along;  /* from its first vertex to the second */
    pe_vec3 normal[2]; /* of the faces it stands between, as in pe_edge */
    double length, length2;
    int edge;
} pe_ridge;

/* A triangle in b's axes. Of a core: all but the corners is zero. */
typedef struct pe_facet {
    pe_vec3 x[3], normal;
    double offset; /* n.x = offset in the plane */
    const int *vertices, *edges;
    int face;
    unsigned owns;
    int ridge_count; /* -1: not asked for so far, see pe_facet_ridges */
    pe_ridge ridges[3];
} pe_facet;

void pe_solid_facet(const pe_solid *solid, int triangle, pe_facet *facet); /* in its axes */
void pe_facet_of_a(const pe_solid_pair *pair, int triangle, pe_facet *facet);

/* Whether x, brought down to the facet's plane along its normal, lies on the facet, or beyond its
 * rim by at most `slack`. */
bool pe_facet_holds(const pe_facet *facet, pe_vec3 x, double slack);

/* The same, and also behind the face across a dent, by at most `past`, where the solid goes on;
 * *dent tells. `seen`: the solid's place in the axes of the facet; NULL: the same. */
bool pe_facet_holds_dented(const pe_solid *solid, const pe_bvh_pair *seen, const pe_facet *facet,
                           pe_vec3 x, double slack, double past, bool *dent);

/* Gathers the facets of either solid that may be within `limit` of the other in `work`, if they are
 * few: then each with each is quicker than the trees. False: out of memory. */
bool pe_solid_pair_gather(pe_solid_pair *pair, double limit, pe_workspace work);

/* What is done with two facets; false: no more are wanted. */
typedef bool pe_take_facets(void *context, pe_facet *a, pe_facet *b);

/* Hands over all that may be within *bound, which may shrink on the way; it must not be above the
 * limit of what was gathered. */
void pe_near_facets(const pe_solid_pair *pair, const double *bound, pe_take_facets *take,
                    void *context);

/* Signed heights of the corners of `of` over the plane of `over`; false: all are above `bound`, or
 * all below -bound, so that the two are farther apart than that. */
bool pe_facet_heights(const pe_facet *over, const pe_facet *of, double bound, double height[3]);

/* Where the edges of either facet pass through the other, by the heights of each one's corners over
 * the other; 0: they do not cross. What is within `slack` of touching counts; with 0, edges that
 * only touch may count or not. */
enum { PE_MOST_PIERCINGS = 6 };
int pe_facets_cross(const pe_facet *a, const double above_b[3], const pe_facet *b,
                    const double above_a[3], double slack, pe_vec3 where[PE_MOST_PIERCINGS]);

/* Fills the facet's ridges, once. `seen`: the solid's place in the axes of the facet; NULL: the
 * same.
 */
void pe_facet_ridges(const pe_solid *solid, const pe_bvh_pair *seen, pe_facet *facet);

/* Whether the direction n, of the given length, lies between the normals of the ridge's faces, or
 * beyond by an angle of at most that sine: it rises along neither face. */
bool pe_ridge_faces(const pe_ridge *ridge, pe_vec3 n, double length, double sine);

/* Nearest points x + s u and y + t v of two segments, s and t in 0 .. 1. */
void pe_segments_nearest(pe_vec3 x, pe_vec3 u, pe_vec3 y, pe_vec3 v, double *s, double *t);

typedef enum pe_touch_kind {
    PE_VERTEX_FACE, /* of a, of b */
    PE_FACE_VERTEX,
    PE_EDGE_EDGE,
    PE_EDGE_VERTEX,
    PE_VERTEX_EDGE,
    PE_VERTEX_VERTEX
} pe_touch_kind;

/* Two features that touch or are near. */
typedef struct pe_touch {
    uint64_t feature;
    pe_touch_kind kind;
    pe_vec3 normal;           /* unit */
    pe_vec3 on_a;             /* a's core's point; b's is on_a + (separation + radius) normal */
    double separation;        /* m, of the surfaces: the ball's radius is taken off */
    pe_vec3 along_a, along_b; /* of two edges */
    bool dent;                /* the vertex lies behind a dent at the rim of the face */
    bool strict;              /* both features face each other but for rounding */
    bool merged;              /* has found its patch, or its better */
} pe_touch;

/* A kind, the feature of a and that of b; for PE_FACE_VERTEX b's comes first, so that the contacts
 * of one vertex stand together in order. */
uint64_t pe_touch_feature(pe_touch_kind kind, int first, int second);
int pe_touch_first(uint64_t feature);
int pe_touch_second(uint64_t feature);

/* A list that grows in the step's memory. */
typedef struct pe_touches {
    pe_touch *items;
    int count, capacity;
    pe_workspace work;
    bool failed; /* out of memory */
} pe_touches;

void pe_touches_add(pe_touches *list, const pe_touch *touch);
void pe_touches_sort(pe_touches *list); /* by feature */

/* The nearest points of the two surfaces, cores without their balls. */
typedef struct pe_nearest {
    double distance; /* m; the bound where none is below it */
    bool found;
    bool inside;    /* by the side of the face: a's core lies in b, or b in a */
    bool cross;     /* the surfaces pass through each other: no more was looked for */
    pe_touch touch; /* all but its separation; apart: the normal is along the line */
} pe_nearest;

pe_nearest pe_solids_nearest(const pe_solid_pair *pair, double bound);

/* A vertex that is farthest along d, in the solid's own axes. */
pe_vec3 pe_solid_support(const pe_solid *solid, pe_vec3 d);

/* Looks for a direction that parts the hulls of the two, for pair->trees, in a few steps (Gilbert
 * 1966). False: it parts them by more than `limit`. */
bool pe_solid_pair_part(pe_solid_pair *pair, double limit);

/* The point of the surface nearest to x, in the solid's own axes. */
pe_vec3 pe_solid_nearest_point(const pe_solid *solid, pe_vec3 x);

/* Whether the point (in the axes of `solid`) lies in the solid. */
bool pe_solid_holds(const pe_solid *solid, pe_vec3 x);

/* How far it is from x, along d, to where the surface is crossed outwards, in units of d; 0: it is
 * not crossed within d. What is met within the slack counts, so that rounding does not decide. */
double pe_solid_way_to_exit(const pe_solid *solid, pe_vec3 x, pe_vec3 d, double slack);

/* A box about a segment or a point, and the tree of a solid in whose axes it is. */
pe_bvh_pair pe_solid_around(const pe_node *node, const pe_solid *solid);

/* Two triangles that cross, and where. */
typedef struct pe_crossing {
    const pe_facet *a, *b;
    const double *above_a, *above_b; /* heights of the other's corners */
    int count;
    const pe_vec3 *where; /* (count), see pe_facets_cross */
} pe_crossing;

typedef void pe_take_crossing(void *context, const pe_crossing *c);

/* Hands over each two triangles that cross or touch. */
void pe_solids_each_crossing(const pe_solid_pair *pair, pe_take_crossing *take, void *context);

/* Adds the features with a gap of at most `reach` or, where `depth` is not 0, an overlap of at most
 * that (m, of the cores): see collide_mesh.c. */
void pe_touches_find(const pe_solid_pair *pair, double reach, double depth, pe_touches *list);

/* Adds the vertices of either solid that lie deeper in the other one than `depth`, as far as the
 * surfaces lead to them from where they cross, or, with `all`, all. */
void pe_touches_find_deep(const pe_solid_pair *pair, double depth, bool all, pe_touches *list);

/* Whether a vertex may take the normal of a face of the other solid, n in its own axes and away
 * from that face: no edge leads from it towards the face, but for a small angle; *strict: for
 * rounding alone. */
bool pe_vertex_faces(const pe_solid *solid, int vertex, pe_vec3 normal, bool *strict);

/* Whether a vertex that lies under a face is parted from it by another part of the surface. */
bool pe_touch_is_blocked(const pe_solid_pair *pair, const pe_touch *touch);

/* One way out of an overlap, where the features show none. */
void pe_touches_find_translation(const pe_solid_pair *pair, const pe_nearest *nearest,
                                 pe_touches *list);

/* Drops the overlaps beside which another touch, at about the same place and in another direction,
 * says that the solids overlap less there, or are apart, by no more than PE_DEPTH. `radius`,
 * `size`: as in pe_solid_pair. */
void pe_touches_settle(pe_touches *list, double radius, double size);

/* The least separation; HUGE_VAL: none. */
double pe_touches_least(const pe_touches *list);

/* A cylinder, by pe_collide_cylinder_hull: see collide_mesh_cylinder.c. As pe_collide_with_mesh. */
int pe_collide_cylinder_mesh(pe_placed cylinder, pe_placed mesh, double margin, pe_workspace work,
                             pe_pair_manifold *patches);

/* How touches become patches. */
typedef struct pe_solver_manifold_rules {
    double size, radius; /* m, as in pe_solid_pair */
    double margin;       /* m: what is farther is dropped */
    double limit;        /* m: the same at any margin */
    double least;        /* m: no separation is smaller; -HUGE_VAL: unknown */
    double end_margin;   /* m: from this margin on there may be more touches */
} pe_solver_manifold_rules;

/* Makes patches of the touches (sorted by feature, each once) and returns their number. Normals and
 * positions are in the world if `pose` is that of the touches' axes. */
int pe_touches_make_patches(pe_touches *list, const pe_solver_manifold_rules *rules,
                            const pe_pose *pose, pe_pair_manifold *patches);

#endif
