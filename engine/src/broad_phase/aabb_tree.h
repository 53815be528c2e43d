/* A dynamic tree of axis-aligned bounding boxes (AABBs), which finds the pairs that overlap.
 *
 * The tree is binary; the box of an inner node holds those of its children. A leaf that is added,
 * moved or removed marks its ancestors, and nothing else happens until pe_tree_update removes the
 * marked inner nodes. The largest subtrees without a change are left. New nodes are built over them
 * from above: the centres are cut at the middle of the axis along which they are spread widest, or,
 * where that would leave less than a quarter of them on one side, at the median. So a change costs
 * as much as its path to the root is long. Where many leaves have changed the whole tree is
 * rebuilt, in depth-first order. (The partial rebuild is that of Catto's Box2D 3, 2023.) */
#ifndef PE_AABB_TREE_H
#define PE_AABB_TREE_H

#include "base/memory.h"

/* An axis-aligned bounding box. */
typedef struct pe_aabb {
    double low[3], high[3]; /* world axes, m */
} pe_aabb;

/* Boxes that touch overlap. A box with a NaN overlaps none. */
static inline bool pe_aabb_overlaps(const pe_aabb *a, const pe_aabb *b)
{
    return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
           b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

/* Whether `inner` lies within `outer`; boxes with a NaN are contained in none. */
static inline bool pe_aabb_contains(const pe_aabb *outer, const pe_aabb *inner)
{
    return outer->low[0] <= inner->low[0] && inner->high[0] <= outer->high[0] &&
           outer->low[1] <= inner->low[1] && inner->high[1] <= outer->high[1] &&
           outer->low[2] <= inner->low[2] && inner->high[2] <= outer->high[2];
}

/* Two bodies that are near each other. */
typedef struct pe_pair {
    int a, b; /* slots, a < b, not both static */
} pe_pair;

/* A growing list in memory of the step. All zero except `work` is the empty one. */
typedef struct pe_pair_list {
    pe_workspace work;
    pe_pair *items;
    int count, capacity;
} pe_pair_list;

/* Appends the pair with the smaller slot first. PE_NO_MEMORY leaves the list as it was. */
pe_status pe_pair_list_add(pe_pair_list *list, int a, int b, pe_error *error);

/* Sorts by (a, b) the pairs of slots below `slots`, in O(count + slots): a radix sort with the
 * slots for digits. PE_NO_MEMORY leaves the list as it was. */
pe_status pe_pair_list_sort(pe_pair_list *list, int slots, pe_error *error);

/* A node fills one cache line. */
typedef struct pe_tree_node {
    pe_aabb box;
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

/* Releases the memory; the tree is empty then. */
void pe_tree_free(pe_tree *tree, const pe_allocator *allocator);

/* Adds a leaf with this box for an item > 0. The box must hold no NaN. On PE_NO_MEMORY the tree is
 * as it was. */
pe_status pe_tree_add(pe_tree *tree, const pe_allocator *allocator, int item, const pe_aabb *box,
                      pe_error *error);

/* Gives the leaf of an item another box, which must hold no NaN, and marks it. Returns whether it was not marked
 * yet, for pe_tree_count_marked. Threads may do so for different items at the same time. */
bool pe_tree_set_box(pe_tree *tree, int item, const pe_aabb *box);

/* Counts leaves for which pe_tree_set_box returned true. */
void pe_tree_count_marked(pe_tree *tree, int leaves);

/* Removes the leaf of an item. */
void pe_tree_remove(pe_tree *tree, int item);

/* Marks every leaf as changed. */
void pe_tree_invalidate(pe_tree *tree);

/* The box of an item. */
static inline const pe_aabb *pe_tree_box(const pe_tree *tree, int item)
{
    const pe_tree_node *nodes = tree->node_array.items;
    return &nodes[((const int *)tree->leaf_array.items)[item]].box;
}

/* Rebuilds what changes have marked, by the threads of the workspace. On PE_NO_MEMORY the tree is as it was, still to be updated. */
pe_status pe_tree_update(pe_tree *tree, pe_workspace work, pe_error *error);

/* Two nodes, one of each tree, below which pairs are looked for. */
typedef struct pe_node_pair {
    int p, q;
} pe_node_pair;

enum { PE_MOST_STARTS = 256 };

/* Divides a query: fills starts (most, PE_MOST_STARTS or fewer) with nodes below which all pairs are, and
 * returns how many there are. The trees may be the same, and must be updated. */
int pe_tree_query_starts(const pe_tree *a, const pe_tree *b, int most, pe_node_pair *starts);

/* Appends all pairs of items below the start, one of each tree, whose boxes overlap and of which one has
 * a marked leaf. Each pair comes once, from one of the starts. */
pe_status pe_tree_query_from(const pe_tree *a, const pe_tree *b, pe_node_pair start,
                             pe_pair_list *pairs, pe_error *error);

/* Clears the marks of all leaves, by the threads of the pool. The tree must be updated. */
void pe_tree_unmark(pe_tree *tree, pe_pool *pool);

#endif
