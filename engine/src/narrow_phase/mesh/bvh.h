/* Two trees of boxes descended together: which leaves come near each other.
 *
 * Boxes are oriented (Gottschalk, Lin, Manocha 1996). The gap of two is bounded from below by that
 * of the spheres about them, and by the distance, along the axes of either one, to the box that
 * holds the other: six of their 15 axes, put together by Pythagoras. */
#ifndef PE_BVH_H
#define PE_BVH_H

#include "model/geometry.h"

/* Tree a as tree b sees it: x_b = turn x_a + offset. */
typedef struct pe_bvh_pair {
    const pe_node *a, *b;
    pe_mat3 turn;
    pe_vec3 offset; /* m */
    /* A direction that about parts the two, in the axes of b and of a; all of a lies below `most_a`
     * along it and all of b above `least_b` (m, in b's axes). What of either is farther from the
     * other's bound than the pairs in question is left out at once. Zero: none. */
    pe_vec3 parting, parting_a;
    double most_a, least_b;
} pe_bvh_pair;

/* Without a parting direction. */
pe_bvh_pair pe_bvh_pair_of(const pe_node *a, const pe_node *b, const pe_mat3 *turn, pe_vec3 offset);

/* How far the box reaches from its centre along d, in the body's axes. */
double pe_node_reach(const pe_node *node, pe_vec3 d);

/* The deepest tree halves 2^28 triangles down to single ones; each level leaves one entry. */
enum { PE_BVH_STACK = 64 };

typedef struct pe_bvh_walk {
    int depth;
    struct pe_bvh_entry {
        int a, b;
        double gap2; /* m^2, lower bound */
    } stack[PE_BVH_STACK];
} pe_bvh_walk;

void pe_bvh_begin(const pe_bvh_pair *pair, pe_bvh_walk *walk);

/* The next pair of leaves whose boxes may be within `bound` (m, >= 0), the nearer branch first;
 * false: no more. The bound may shrink from call to call. */
bool pe_bvh_next(const pe_bvh_pair *pair, pe_bvh_walk *walk, double bound, const pe_node **a,
                 const pe_node **b);

/* Which leaves of the one tree, of a or of b, may be within `limit` of anything of the other: fills
 * `leaves` with their nodes' indices. Returns how many there are; -1: more than `most`. */
int pe_bvh_leaves(const pe_bvh_pair *pair, bool of_a, double limit, int *leaves, int most);

#endif
