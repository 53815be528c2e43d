/* The nodes of an AABB tree, for the files that change it. */
#ifndef PE_AABB_TREE_NODES_H
#define PE_AABB_TREE_NODES_H

#include "aabb_tree.h"

enum {
    NONE = 0,
    MAX_HEIGHT = 96 /* a tree that is higher is rebuilt as a whole */
};

/* The nodes, counted from 1. */
static inline pe_tree_node *nodes_of(const pe_tree *tree)
{
    return tree->node_array.items;
}

/* The node of each item. */
static inline int *leaves_of(const pe_tree *tree)
{
    return tree->leaf_array.items;
}

/* Whether the node has no children. */
static inline bool is_leaf(const pe_tree_node *node)
{
    return node->child[0] == NONE;
}

/* Whether a pass over all nodes costs no more than to follow the marks. */
static inline bool is_mostly_marked(const pe_tree *tree)
{
    return 8 * tree->marked_count > tree->leaf_count;
}

/* Takes a free node, or one at the end, for which there must be room. */
static inline int take_node(pe_tree *tree)
{
    int node = tree->first_free;
    if (node == NONE) {
        return ++tree->node_count;
    }
    tree->first_free = nodes_of(tree)[node].parent;
    return node;
}

/* Frees a node. */
static inline void release_node(pe_tree *tree, int node)
{
    nodes_of(tree)[node] = (pe_tree_node){.parent = tree->first_free};
    tree->first_free = node;
}

#endif
