/* Random solids of every kind, pairs of them in poses of every kind, and references from support
 * functions and brute force. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_H
#define PLUMB_TEST_SHAPE_PAIRS_H

#include "check.h"
#include "convex_truth.h"
#include "narrow_phase/collide.h"
#include "random_pose.h"

/* A shape in its body's axes. */
typedef struct solid {
    pe_shape shape;
    pe_geometry *geometry; /* of a hull or mesh */
    int vertex_count, triangle_count;
    pe_vec3 *vertices;   /* (vertex_count), m: of a polyhedron, boxes included */
    int (*triangles)[3]; /* (triangle_count): counter-clockwise seen from outside */
    pe_vec3 *normals;    /* (triangle_count): unit, outwards */
    double size;         /* m, pe_shape_size; 0: a plane */
    double reach;        /* m, radius about the origin that holds it; 1 of a plane */
    bool convex;
} solid;

enum { POOL = 40 };

typedef struct shape_pool {
    solid item[PE_SHAPE_COUNT][POOL];
} shape_pool;

/* Lengths of 0.1 to 10 m, aspect ratios up to 20, in a tenth of the solids up to 1000. The same
 * seed gives the same pool. NULL: out of memory, or the engine refused a surface; it is printed. */
shape_pool *shape_pool_create(uint64_t seed);
void shape_pool_destroy(shape_pool *pool);

void solid_clear(solid *s);

/* A solid in the world. A plane is the half-space below its pose's xy plane. */
typedef struct placed {
    const solid *solid;
    pe_shape shape;
    pe_pose pose;
} placed;

void place(placed *p, pe_vec3 position, pe_quat orientation);

/* The same in a space scaled by `factor`. *larger is the solid, which the caller frees by
 * solid_clear. */
placed placed_scaled(const placed *from, double factor, solid *larger);

pe_placed as_placed(const placed *p);

/* The distance (m) of a point outside the solid; of convex polyhedra its height over the farthest
 * face plane; 0 inside. */
double outside(const placed *p, pe_vec3 x);

/* Kinds of a <= kind of b. */
typedef struct pair {
    placed a, b;
    double size; /* m, the smaller one's */
} pair;

typedef enum pair_pose {
    POSE_ANY,        /* centres at random within reach of each other */
    POSE_DEEP,       /* centres within the smaller size */
    POSE_SHALLOW,    /* depth of 1e-3 of the size */
    POSE_TOUCHING,   /* separation of rounding */
    POSE_CLOSE,      /* gap of 1e-6 to 0.1 of the size */
    POSE_FAR,        /* gap of up to a hundred times the reach */
    POSE_ALIGNED,    /* axes parallel, or nearly, faces, edges or centres in line, near touching */
    POSE_CONCENTRIC, /* centres coincident, axes at random, parallel or nearly */
    POSE_LEDGE,      /* above the other's rim, which is overhung or missed by little or nothing */
    POSE_COUNT
} pair_pose;

/* The signed distance of a pair and its direction, from a to b. */
typedef double pair_gap(const pair *p, pe_vec3 *normal);

/* A pair of the kinds. `gap` is used for poses at a given separation. */
pair random_pair(const shape_pool *pool, pe_shape_kind a, pe_shape_kind b, pair_pose pose,
                 check_random *random, pair_gap *gap);

/* Puts b to rest against a, touching: face to face if they have faces, with edges in line from a
 * common corner, or turned and moved. */
void pair_rest(pair *p, check_random *random, pair_gap *gap);

/* Moves b by `distance` along the unit vector n. */
void pair_part(pair *p, double distance, pe_vec3 n);

/* The pair as a whole turned, then moved. */
pair pair_moved(const pair *p, pe_quat turn, pe_vec3 by);

/* -f(n) of the head of convex_truth.h, m; of a plane -inf unless n is its normal to 1e-12. Both
 * convex. */
double pair_separation_along(const pair *p, pe_vec3 n);

/* Both convex: the proven interval of the signed distance. */
truth_distance pair_truth(const pair *p, double tolerance);

void pair_print(const pair *p);

pe_vec3 random_direction(check_random *random);

#endif
