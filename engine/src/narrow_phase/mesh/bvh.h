/* Two bounding volume hierarchies descended together, to find the leaves that come near each other.
 *
 * Boxes are oriented (Gottschalk, Lin, Manocha 1996). The gap of two boxes is bounded from below by
 * that of the spheres around them. It is also bounded by the distance, in the axes of either box,
 * to the bounds of the other: these are six of the 15 axes, combined by Pythagoras. */
#ifndef PE_BVH_H
#define PE_BVH_H

#include "narrow_phase/collide.h"

/* Two trees. Boxes are compared in the axes of b. */
typedef struct pe_bvh_pair {
    const pe_node *a, *b;
    pe_transform a_in_b;
    /* A direction that roughly parts the two trees, in the axes of b and of a; zero: none. All of a
     * lies below `most_a` along it, all of b above `least_b` (m, in b's axes). Nodes of either tree
     * that are farther from the other's bound than the limit are skipped at once. */
    pe_vec3 parting, parting_a;
    double most_a, least_b;
} pe_bvh_pair;

/* The transform from a's axes to b's. */
pe_transform pe_transform_between(const pe_pose *a, const pe_pose *b);

/* A leaf of one triangle with a box along its body's axes. */
pe_node pe_box_node(pe_vec3 centre, pe_vec3 half);

/* The extent of the box from its centre along d, in the body's axes. */
double pe_node_reach(const pe_node *node, pe_vec3 d);

static inline pe_vec3 pe_absolute(pe_vec3 v)
{
    return pe_v3(fabs(v.x), fabs(v.y), fabs(v.z));
}

/* The square of the distance from the origin to the box of half extents `half` about c. */
static inline double pe_square_to_box(pe_vec3 c, pe_vec3 half)
{
    double x = pe_max(0, fabs(c.x) - half.x), y = pe_max(0, fabs(c.y) - half.y);
    double z = pe_max(0, fabs(c.z) - half.z);
    return x * x + y * y + z * z;
}

/* The deepest tree halves 2^28 triangles down to single ones. Each level leaves one entry. */
enum { PE_BVH_STACK = 64 };

/* A traversal of two trees: the pairs of nodes that are still to be visited. */
typedef struct pe_bvh_walk {
    int depth;
    /* A node of each tree. */
    struct pe_bvh_entry {
        int a, b;
        double gap2; /* m^2, lower bound */
    } stack[PE_BVH_STACK];
} pe_bvh_walk;

/* Starts a traversal at the roots of both trees. */
void pe_bvh_begin(const pe_bvh_pair *pair, pe_bvh_walk *walk);

/* The next pair of leaves whose boxes may be within `bound` (m, >= 0), the nearer branch first.
 * False: there are no more. The bound may shrink from call to call. */
bool pe_bvh_next(const pe_bvh_pair *pair, pe_bvh_walk *walk, double bound, const pe_node **a,
                 const pe_node **b);

/* Fills `leaves` with the indices of the leaves of one tree, of a or of b, that may be within
 * `limit` of any part of the other. Returns their number; -1: more than `most`. */
int pe_bvh_leaves(const pe_bvh_pair *pair, bool of_a, double limit, int *leaves, int most);

#endif
