/* Touches, which are pairs of features that touch or are near, and the manifolds made of them. */
#ifndef PE_TOUCHES_H
#define PE_TOUCHES_H

#include "mesh_solid.h"

/* The kinds of the two features of a touch. */
typedef enum pe_touch_kind {
    PE_VERTEX_FACE, /* of a, of b */
    PE_FACE_VERTEX,
    PE_EDGE_EDGE,
    PE_EDGE_VERTEX,
    PE_VERTEX_EDGE,
    PE_VERTEX_VERTEX
} pe_touch_kind;

/* Two features that are within the margin of each other. */
typedef struct pe_touch {
    uint64_t feature;
    pe_touch_kind kind;
    pe_vec3 normal;           /* unit */
    pe_vec3 on_a;             /* a's core's point; b's is on_a + (separation + radius) normal */
    double separation;        /* m, of the surfaces: the ball's radius is taken off */
    pe_vec3 along_a, along_b; /* of two edges */
    bool dent;                /* the vertex lies behind a dent at the rim of the face */
    bool strict;              /* both features face each other, except for rounding */
    bool merged;              /* already in a manifold, or to be dropped */
} pe_touch;

/* The feature id (see feature_id.h). Of PE_FACE_VERTEX the vertex of b is `first`, so that the
 * touches of one vertex are adjacent in sorted order. */
static inline uint64_t pe_touch_feature(pe_touch_kind kind, int first, int second)
{
    return (uint64_t)kind << 60 | (uint64_t)(uint32_t)first << 30 | (uint64_t)(uint32_t)second;
}

static inline int pe_touch_first(uint64_t feature)
{
    return (int)(feature >> 30 & ((1u << 30) - 1));
}

static inline int pe_touch_second(uint64_t feature)
{
    return (int)(feature & ((1u << 30) - 1));
}

/* A touch from its parts; `id` is its feature id. */
static inline pe_touch pe_touch_make(pe_touch_kind kind, uint64_t id, pe_vec3 on_a, pe_vec3 normal,
                                     double separation)
{
    return (pe_touch){
        .feature = id, .kind = kind, .normal = normal, .on_a = on_a, .separation = separation};
}

/* The touch of the vertex x at a height over a face. PE_VERTEX_FACE: the vertex is a's. */
pe_touch pe_touch_on_face(pe_touch_kind kind, int vertex, pe_vec3 x, const pe_facet *face,
                          double height);

/* A list that grows in the step's memory. */
typedef struct pe_touches {
    pe_touch *items;
    int count, capacity;
    pe_workspace work;
    bool failed; /* out of memory */
} pe_touches;

/* Adds a touch. Sets `failed` when out of memory. */
void pe_touches_add(pe_touches *list, const pe_touch *touch);

/* Sorts by feature id. */
void pe_touches_sort(pe_touches *list);

/* Removes the touches that are marked `merged`. */
void pe_touches_drop_merged(pe_touches *list);

/* Drops overlaps that another touch contradicts: one at about the same place, in another direction,
 * by which the solids overlap less, or are apart by at most PE_MESH_DEPTH. `radius` and `size` are
 * those of the pe_solid_pair. */
void pe_touches_drop_contradicted(pe_touches *list, double radius, double size);

/* The least separation; HUGE_VAL: the list is empty. */
double pe_touches_least(const pe_touches *list);

/* How touches become manifolds. */
typedef struct pe_manifold_rules {
    double size, radius; /* m, as in pe_solid_pair */
    double margin;       /* m: touches beyond it are dropped */
    double limit;        /* m: the same, at any margin */
    double least;        /* m: no separation is smaller; -HUGE_VAL: unknown */
    double end_margin;   /* m: from this margin on there may be more touches */
} pe_manifold_rules;

/* Fills `manifolds` with one manifold for each normal of the touches, which must be sorted and
 * unique by feature. Returns their number, or -1 when out of memory. Normals and positions are in
 * the world if `pose` is that of the touches' axes. */
int pe_touches_make_manifolds(pe_touches *list, const pe_manifold_rules *rules, const pe_pose *pose,
                              pe_pair_manifold *manifolds);

#endif
