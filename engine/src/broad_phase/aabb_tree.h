/* A dynamic tree of axis-aligned boxes, by which pairs that overlap are found.
 *
 * Binary; the box of an inner node holds those of its children. A leaf that is added, moved or
 * removed marks its way to the root, and nothing else happens until pe_tree_update takes the marked
 * inner nodes away. What is left are the largest subtrees without a change; new nodes are built
 * over them from above: the centres are cut at the middle of the axis along which they are spread
 * widest, or, where that would leave less than a quarter of them on one side, at the median. So one
 * change costs what its way to the root does. Where many leaves have changed all nodes are made
 * anew, in depth-first order. (The partial rebuild is that of Catto's Box2D 3, 2023.) */
#ifndef PE_AABB_TREE_H
#define PE_AABB_TREE_H

#include "broad_phase_pairs.h"

typedef struct pe_box {
    double low[3], high[3]; /* world axes, m */
} pe_box;

/* Boxes that touch overlap. One that is not a number overlaps none. */
static inline bool pe_box_overlaps(const pe_box *a, const pe_box *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
           b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

static inline bool pe_aabb_contains(const pe_box *outer, const pe_box *inner)
{
    return outer->low[0] <= inner->low[0] && inner->high[0] <= outer->high[0] &&
           outer->low[1] <= inner->low[1] && inner->high[1] <= outer->high[1] &&
           outer->low[2] <= inner->low[2] && inner->high[2] <= outer->high[2];
}

/* A cache line. */
typedef struct pe_tree_node {
    pe_box box;
    int parent;   /* 0: the root; of a free node: the next free one, 0 ends the list */
    int child[2]; /* of a leaf: 0 and its item; 0 and 0: a leaf that was removed, or a free node */
    int16_t height;
    bool marked; /* changed since pe_tree_unmark, or with such a leaf below */
} pe_tree_node;

/* All zero is the empty tree. Nodes are counted from 1. */
typedef struct pe_tree {
    pe_array node_array, leaf_array; /* (node_count + 1); (item_count): nodes of the items */
    int node_count, item_count;      /* free nodes included */
    int first_free, root;            /* nodes; 0: none */
    int leaf_count, marked_count;    /* leaves, those removed since the last update included */
} pe_tree;

void pe_tree_free(pe_tree *tree, const pe_allocator *allocator);

/* Adds a leaf for an item > 0, which names it. Boxes must hold no NaN. On PE_NO_MEMORY the tree is
 * as it was. */
pe_status pe_tree_add(pe_tree *tree, const pe_allocator *allocator, int item, const pe_box *box,
                      pe_error *error);
void pe_tree_move(pe_tree *tree, int item, const pe_box *box);
void pe_tree_remove(pe_tree *tree, int item);

/* Marks every leaf. */
void pe_tree_invalidate(pe_tree *tree);

static inline const pe_box *pe_tree_box(const pe_tree *tree, int item)
{
    const pe_tree_node *nodes = tree->node_array.items;
    return &nodes[((const int *)tree->leaf_array.items)[item]].box;
}

/* Puts the tree in order after changes. On PE_NO_MEMORY it is as it was: to be updated. */
pe_status pe_tree_update(pe_tree *tree, pe_workspace work, pe_error *error);

/* Appends all pairs of items whose boxes overlap, one of each tree, or both of one where they are
 * the same; only those with a marked leaf. Each comes once. The trees must be updated. */
pe_status pe_tree_query_pairs(const pe_tree *a, const pe_tree *b, pe_pair_list *pairs,
                              pe_error *error);

/* Ends what pe_tree_add, pe_tree_move and pe_tree_invalidate began. The tree must be updated. */
void pe_tree_unmark(pe_tree *tree);

#endif
