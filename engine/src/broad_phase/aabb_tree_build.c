/* Builds an AABB tree, or the part of it that changes have marked, from above. */
#include "aabb_tree_nodes.h"

#include "base/pool.h"
#include "base/vec3.h"

#include <string.h>

enum {
    /* A tree that was built at once is lower than log 2^31 to the base 4/3, 75. */
    MAX_RANGES = 96,
    /* Ranges that threads share, and subtrees for which that pays. */
    SHARED_RANGES = 64,
    LEAST_SHARED = 2048
};

/* A subtree that is to be put under new nodes. */
typedef struct subtree {
    double centre[3];
    int node;
} subtree;

/* All subtrees. If the whole tree is rebuilt they are copies of its leaves, else `leaf` is NULL. */
typedef struct forest {
    subtree *item;
    int count;
    pe_tree_node *leaf;
    int *stack; /* (count + 1) nodes */
    int *fresh; /* (2 count + 1) the nodes to build with */
} forest;

/* 0 for an interval without a midpoint, because it has no end. */
static double midpoint_of(double low, double high)
{
    double middle = 0.5 * low + 0.5 * high;
    return isfinite(middle) ? middle : 0;
}

static void add_subtree(forest *p, int node, const pe_aabb *box)
{
    subtree *added = &p->item[p->count++];
    added->node = node;
    for (int k = 0; k < 3; ++k) {
        added->centre[k] = midpoint_of(box->low[k], box->high[k]);
    }
}

/* Removes the marked inner nodes and lists the subtrees that are left. */
static void take_apart(pe_tree *tree, forest *p)
{
    const pe_tree_node *nodes = nodes_of(tree);
    int stacked = 0;
    p->stack[stacked++] = tree->root;
    while (stacked > 0) {
        int i = p->stack[--stacked];
        if (nodes[i].marked && !is_leaf(&nodes[i])) {
            p->stack[stacked++] = nodes[i].child[1];
            p->stack[stacked++] = nodes[i].child[0];
            release_node(tree, i);
        } else if (is_leaf(&nodes[i]) && nodes[i].child[1] == NONE) {
            tree->leaf_count -= 1;
            release_node(tree, i);
        } else {
            add_subtree(p, i, &nodes[i].box);
        }
    }
}

/* Removes all nodes, and lists copies of the leaves. */
static void take_all(pe_tree *tree, forest *p)
{
    const pe_tree_node *nodes = nodes_of(tree);
    for (int i = 1; i <= tree->node_count; ++i) {
        if (is_leaf(&nodes[i]) && nodes[i].child[1] != NONE) {
            p->leaf[p->count] = nodes[i];
            add_subtree(p, p->count, &nodes[i].box);
        }
    }
    tree->leaf_count = p->count;
    tree->node_count = 0;
    tree->first_free = NONE;
}

static void swap(subtree *a, subtree *b)
{
    subtree c = *a;
    *a = *b;
    *b = c;
}

/* The axis along which the centres are spread widest, and the middle of their range on it. */
static int widest_axis(const subtree *subtrees, int count, double *middle)
{
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = high[k] = subtrees[0].centre[k];
    }
    for (int i = 1; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            low[k] = pe_min(low[k], subtrees[i].centre[k]);
            high[k] = pe_max(high[k], subtrees[i].centre[k]);
        }
    }
    double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    *middle = midpoint_of(low[axis], high[axis]);
    return axis;
}

/* Puts the subtrees with centres below the value first; returns how many they are. */
static int cut_at(subtree *subtrees, int count, int axis, double value)
{
    int below = 0;
    for (int i = 0; i < count; ++i) {
        if (subtrees[i].centre[axis] < value) {
            swap(&subtrees[i], &subtrees[below++]);
        }
    }
    return below;
}

/* Puts the lower half before the upper one (quickselect, Hoare 1961). Equal ones may go to either
 * half. */
static int cut_in_halves(subtree *subtrees, int count, int axis)
{
    int half = count / 2;
    for (int begin = 0, end = count - 1; begin < end;) {
        double pivot = subtrees[begin + (end - begin) / 2].centre[axis];
        int i = begin, j = end;
        while (i <= j) {
            while (subtrees[i].centre[axis] < pivot) {
                ++i;
            }
            while (subtrees[j].centre[axis] > pivot) {
                --j;
            }
            if (i <= j) {
                swap(&subtrees[i++], &subtrees[j--]);
            }
        }
        if (half <= j) {
            end = j;
        } else if (half >= i) {
            begin = i;
        } else {
            break;
        }
    }
    return half;
}

/* Partitions 2 or more subtrees between two children; returns how many the first one gets. */
static int cut(subtree *subtrees, int count)
{
    double middle;
    int axis = widest_axis(subtrees, count, &middle);
    int below = cut_at(subtrees, count, axis, middle), above = count - below;
    return 4 * (below < above ? below : above) < count ? cut_in_halves(subtrees, count, axis)
                                                       : below;
}

/* Computes box, height and mark of an inner node from its children. */
static void fit(pe_tree_node *nodes, int node)
{
    pe_tree_node *n = &nodes[node];
    const pe_tree_node *p = &nodes[n->child[0]], *q = &nodes[n->child[1]];
    for (int k = 0; k < 3; ++k) {
        n->box.low[k] = pe_min(p->box.low[k], q->box.low[k]);
        n->box.high[k] = pe_max(p->box.high[k], q->box.high[k]);
    }
    n->height = (int16_t)(1 + (p->height > q->height ? p->height : q->height));
    n->marked = p->marked || q->marked;
}

/* Subtrees begin .. end - 1, which are still to be put under a node; of one subtree, its root. The nodes
 * below it are p->fresh[fresh] and those that follow. */
typedef struct range {
    int begin, end, node, fresh;
} range;

/* How many new nodes come below that of a range of so many subtrees. */
static int count_fresh(const forest *p, int subtrees)
{
    const int copies = p->leaf != NULL ? subtrees : 0;
    return subtrees > 1 ? subtrees - 2 + copies : 0;
}

/* A range with its node, of which the parent is set. The copy of a leaf gets a new node. */
static range make_range(pe_tree *tree, const forest *p, int begin, int end, int parent, int *fresh)
{
    const bool one = end - begin == 1;
    const int node = one && p->leaf == NULL ? p->item[begin].node : p->fresh[(*fresh)++];
    if (one && p->leaf != NULL) {
        const pe_tree_node *leaf = &p->leaf[p->item[begin].node];
        nodes_of(tree)[node] = *leaf;
        leaves_of(tree)[leaf->child[1]] = node;
    }
    nodes_of(tree)[node].parent = parent;
    return (range){begin, end, node, NONE};
}

/* Divides a range of two or more subtrees between two new ranges below it. Siblings lie next to each
 * other, because they are looked at together. */
static void divide(pe_tree *tree, const forest *p, range r, range below[2])
{
    const int middle = r.begin + cut(p->item + r.begin, r.end - r.begin);
    int fresh = r.fresh;
    below[0] = make_range(tree, p, r.begin, middle, r.node, &fresh);
    below[1] = make_range(tree, p, middle, r.end, r.node, &fresh);
    below[0].fresh = fresh;
    below[1].fresh = fresh + count_fresh(p, middle - r.begin);
    nodes_of(tree)[r.node].child[0] = below[0].node;
    nodes_of(tree)[r.node].child[1] = below[1].node;
}

/* Builds all nodes below that of a range, from above, and fits them. */
static void build_below(pe_tree *tree, const forest *p, range whole)
{
    range open[MAX_RANGES];
    int *made = p->stack + whole.begin; /* fewer than the subtrees */
    int open_count = 0, made_count = 0;
    open[open_count++] = whole;
    while (open_count > 0) {
        const range r = open[--open_count];
        if (r.end - r.begin > 1) {
            range below[2];
            divide(tree, p, r, below);
            open[open_count++] = below[1];
            open[open_count++] = below[0];
            made[made_count++] = r.node;
        }
    }
    while (made_count > 0) { /* children were made after their parents */
        fit(nodes_of(tree), made[--made_count]);
    }
}

/* Ranges of one level of the tree, which the threads divide or build. */
typedef struct level {
    pe_tree *tree;
    const forest *forest;
    range ranges[SHARED_RANGES], below[SHARED_RANGES];
} level;

static void divide_ranges(void *context, int worker, int begin, int end)
{
    (void)worker;
    level *l = context;
    for (int i = begin; i < end; ++i) {
        divide(l->tree, l->forest, l->ranges[i], &l->below[2 * i]);
    }
}

static void build_ranges(void *context, int worker, int begin, int end)
{
    (void)worker;
    const level *l = context;
    for (int i = begin; i < end; ++i) {
        build_below(l->tree, l->forest, l->ranges[i]);
    }
}

/* Builds nodes over all subtrees. Threads divide the ranges of each level, until there are enough to build
 * them apart. */
static void build(pe_tree *tree, const forest *p, pe_pool *pool)
{
    level l = {.tree = tree, .forest = p};
    int above[SHARED_RANGES], above_count = 0, count = 1, fresh = 0;
    tree->root = NONE;
    if (p->count == 0) {
        return;
    }
    l.ranges[0] = make_range(tree, p, 0, p->count, NONE, &fresh);
    l.ranges[0].fresh = fresh;
    tree->root = l.ranges[0].node;
    bool shared = pool != NULL && p->count >= LEAST_SHARED;
    while (shared && 2 * count <= SHARED_RANGES) {
        pe_pool_run(pool, count, 1, divide_ranges, &l);
        for (int i = 0; i < count; ++i) {
            above[above_count++] = l.ranges[i].node;
        }
        count *= 2;
        memcpy(l.ranges, l.below, (size_t)count * sizeof *l.ranges);
        for (int i = 0; i < count; ++i) {
            shared = shared && l.ranges[i].end - l.ranges[i].begin > 1;
        }
    }
    pe_pool_run(pool, count, 1, build_ranges, &l);
    while (above_count > 0) {
        fit(nodes_of(tree), above[--above_count]);
    }
}

/* Takes all nodes that are built over the subtrees. */
static void take_fresh(pe_tree *tree, const forest *p)
{
    const int below = count_fresh(p, p->count);
    const int count = p->count > 1 || (p->count == 1 && p->leaf != NULL) ? below + 1 : 0;
    for (int i = 0; i < count; ++i) {
        p->fresh[i] = take_node(tree);
    }
}

static pe_status rebuild(pe_tree *tree, bool all, pe_workspace work, pe_error *error)
{
    pe_arena_mark before = pe_arena_fill(work.arena);
    size_t leaves = (size_t)tree->leaf_count;
    forest p = {
        .item = pe_take(work, leaves, sizeof *p.item),
        .leaf = all ? pe_take(work, leaves, sizeof *p.leaf) : NULL,
        .stack = pe_take(work, leaves + 1, sizeof *p.stack),
        .fresh = pe_take(work, 2 * leaves + 1, sizeof *p.fresh),
    };
    pe_status status = PE_OK;
    if (p.item == NULL || p.stack == NULL || p.fresh == NULL || (all && p.leaf == NULL)) {
        status = pe_fail(error, PE_NO_MEMORY, "no memory for a tree of %zu boxes", leaves);
    } else {
        if (all) {
            take_all(tree, &p);
        } else {
            take_apart(tree, &p);
        }
        take_fresh(tree, &p);
        build(tree, &p, work.pool);
    }
    pe_arena_rewind(work.arena, work.allocator, before);
    return status;
}

pe_status pe_tree_update(pe_tree *tree, pe_workspace work, pe_error *error)
{
    pe_status status = PE_OK;
    if (tree->marked_count > 0) {
        status = rebuild(tree, is_mostly_marked(tree), work, error);
    }
    if (status == PE_OK && tree->root != NONE && nodes_of(tree)[tree->root].height > MAX_HEIGHT) {
        status = rebuild(tree, true, work, error);
    }
    return status;
}
