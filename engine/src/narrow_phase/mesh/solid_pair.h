/* Two solids and the pairs of their triangles that come near each other.
 *
 * Solid b is the mesh. Solid a is the other shape: a mesh, a hull, a box, or the core of a rounded
 * shape. A core is a point or a segment; the shape is the core swept by a ball. The work is done in
 * b's axes. Normals point from a to b. */
#ifndef PE_SOLID_PAIR_H
#define PE_SOLID_PAIR_H

#include "bvh.h"
#include "mesh_solid.h"

/* The facets of one solid that may be near the other, each with a bounding ball. */
typedef struct pe_near_facets {
    int count;
    pe_facet *facets; /* NULL: not gathered */
    /* A ball around a facet; m. */
    struct pe_facet_ball {
        pe_vec3 centre;
        double radius;
        double along; /* m: how far the facet reaches towards the other solid along `parting` */
    } * balls;
} pe_near_facets;

/* Two solids, their relative pose, and the tolerances of the pair. */
typedef struct pe_solid_pair {
    pe_solid a, b;
    pe_bvh_pair trees;             /* with the pose of a in b's axes */
    pe_transform b_in_a;           /* b in a's axes */
    double radius;                 /* m, of the ball that sweeps a's core; 0: a has no core */
    double size;                   /* m, of the smaller solid: the scale of tolerances */
    double slack;                  /* m, see PE_MESH_SLACK */
    double band;                   /* m, see PE_BAND */
    double depth;                  /* m, see PE_MESH_DEPTH */
    pe_near_facets near_a, near_b; /* see pe_solid_pair_gather */
    pe_small_solid small;
} pe_solid_pair;

/* Describes the pair of any shape, except a plane and a cylinder, and a mesh. *pair points into
 * itself: do not copy it. */
void pe_solid_pair_make(pe_placed a, pe_placed b, pe_solid_pair *pair);

/* Searches a direction that parts the hulls of the two, for pair->trees, in a few steps (Gilbert
 * 1966). False: it parts them by more than `limit`. */
bool pe_solid_pair_part(pe_solid_pair *pair, double limit);

/* Gathers the facets of either solid that may be within `limit` of the other, in `work`, if they
 * are few. Then testing each with each is quicker than the trees. False: out of memory. */
bool pe_solid_pair_gather(pe_solid_pair *pair, double limit, pe_workspace work);

/* Called with two facets in b's axes. Returns false to end the search. */
typedef bool pe_take_facets(void *context, pe_facet *a, pe_facet *b);

/* Calls `take` for all pairs of facets that may be within *bound, which may shrink during the
 * search. It must not exceed the limit of pe_solid_pair_gather. */
void pe_each_near_facets(const pe_solid_pair *pair, const double *bound, pe_take_facets *take,
                         void *context);

/* Two triangles that cross, and where. */
typedef struct pe_crossing {
    const pe_facet *a, *b;
    const pe_facet_heights *heights;
    int count;
    const pe_vec3 *where; /* (count), see pe_facets_cross */
} pe_crossing;

/* Called with each crossing, which is valid only during the call. */
typedef void pe_take_crossing(void *context, const pe_crossing *c);

/* Calls `take` for each pair of triangles that cross or touch. */
void pe_each_crossing(const pe_solid_pair *pair, pe_take_crossing *take, void *context);

#endif
