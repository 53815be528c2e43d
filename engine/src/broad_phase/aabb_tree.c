#include "aabb_tree.h"

#include "base/vec3.h"

#include <string.h>

enum {
    NONE = 0,
    MAX_HEIGHT = 96, /* a tree that is higher is rebuilt as a whole */
    /* A tree that was built at once is lower than log 2^31 to the base 4/3, 75. */
    MAX_RANGES = 96,
    /* Every step down leaves one pair of nodes on the stack, or two inside of one node. */
    MAX_NODE_PAIRS = 4 * (MAX_HEIGHT + 1)
};

static pe_tree_node *nodes_of(const pe_tree *tree)
{
    return tree->node_array.items;
}

static int *leaves_of(const pe_tree *tree)
{
    return tree->leaf_array.items;
}

static bool is_leaf(const pe_tree_node *node)
{
    return node->child[0] == NONE;
}

/* Whether a pass over all nodes costs no more than to follow the marks. */
static bool is_mostly_marked(const pe_tree *tree)
{
    return 8 * tree->marked_count > tree->leaf_count;
}

void pe_tree_free(pe_tree *tree, const pe_allocator *allocator)
{
    pe_array_free(&tree->node_array, allocator);
    pe_array_free(&tree->leaf_array, allocator);
    *tree = (pe_tree){0};
}

/* ---- Changes ---- */

static int take_node(pe_tree *tree)
{
    int node = tree->first_free;
    if (node == NONE) {
        return ++tree->node_count;
    }
    tree->first_free = nodes_of(tree)[node].parent;
    return node;
}

static void release_node(pe_tree *tree, int node)
{
    nodes_of(tree)[node] = (pe_tree_node){.parent = tree->first_free};
    tree->first_free = node;
}

/* Everything above a marked node is marked. */
static void mark(pe_tree *tree, int leaf)
{
    pe_tree_node *nodes = nodes_of(tree);
    tree->marked_count += !nodes[leaf].marked;
    for (int node = leaf; node != NONE && !nodes[node].marked; node = nodes[node].parent) {
        nodes[node].marked = true;
    }
}

/* Makes room for two nodes more, and for the item. */
static pe_status reserve(pe_tree *tree, const pe_allocator *allocator, int item, pe_error *error)
{
    size_t nodes = tree->node_count > 0 ? (size_t)tree->node_count + 1 : 0;
    pe_status status = pe_array_reserve(&tree->node_array, allocator, sizeof(pe_tree_node),
                                        nodes + 3, nodes, error);
    return status == PE_OK ? pe_array_reserve(&tree->leaf_array, allocator, sizeof(int),
                                              (size_t)item + 1, (size_t)tree->item_count, error)
                           : status;
}

pe_status pe_tree_add(pe_tree *tree, const pe_allocator *allocator, int item, const pe_aabb *box,
                      pe_error *error)
{
    pe_status status = reserve(tree, allocator, item, error);
    if (status != PE_OK) {
        return status;
    }
    pe_tree_node *nodes = nodes_of(tree);
    int added = take_node(tree), root = tree->root;
    nodes[added] =
        (pe_tree_node){.box = *box, .parent = NONE, .child = {NONE, item}, .marked = true};
    tree->root = added;
    if (root != NONE) { /* a new root over both, until the update */
        int above = take_node(tree);
        nodes[above] = (pe_tree_node){.parent = NONE, .child = {root, added}, .marked = true};
        nodes[root].parent = nodes[added].parent = above;
        tree->root = above;
    }
    tree->leaf_count += 1;
    tree->marked_count += 1;
    tree->item_count = item < tree->item_count ? tree->item_count : item + 1;
    leaves_of(tree)[item] = added;
    return PE_OK;
}

void pe_tree_move(pe_tree *tree, int item, const pe_aabb *box)
{
    int leaf = leaves_of(tree)[item];
    nodes_of(tree)[leaf].box = *box;
    mark(tree, leaf);
}

void pe_tree_remove(pe_tree *tree, int item)
{
    int leaf = leaves_of(tree)[item];
    nodes_of(tree)[leaf].child[1] = NONE;
    mark(tree, leaf);
}

/* Visits the nodes below `node` in depth-first order, by the links to the parents. Returns the node
 * after this one, with `over` the one after its subtree; NONE at the end. */
static int next_node(const pe_tree_node *nodes, int node, bool over)
{
    if (!over && !is_leaf(&nodes[node])) {
        return nodes[node].child[0];
    }
    int parent = nodes[node].parent;
    while (parent != NONE && nodes[parent].child[1] == node) {
        node = parent;
        parent = nodes[node].parent;
    }
    return parent == NONE ? NONE : nodes[parent].child[1];
}

void pe_tree_invalidate(pe_tree *tree)
{
    pe_tree_node *nodes = nodes_of(tree);
    for (int i = tree->root; i != NONE; i = next_node(nodes, i, false)) {
        nodes[i].marked = true;
    }
    tree->marked_count = tree->leaf_count;
}

void pe_tree_unmark(pe_tree *tree)
{
    pe_tree_node *nodes = nodes_of(tree);
    for (int i = tree->root, next; i != NONE; i = next) {
        next = next_node(nodes, i, !nodes[i].marked);
        nodes[i].marked = false;
    }
    tree->marked_count = 0;
}

/* ---- Rebuilding ---- */

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

/* Subtrees begin .. end - 1, which are still to be put under a node; of one subtree, its root. */
typedef struct range {
    int begin, end, node;
} range;

/* A range with its node, of which the parent is set. The copy of a leaf gets a new node. */
static range make_range(pe_tree *tree, const forest *p, int begin, int end, int parent)
{
    const bool one = end - begin == 1;
    int node = one && p->leaf == NULL ? p->item[begin].node : take_node(tree);
    if (one && p->leaf != NULL) {
        const pe_tree_node *leaf = &p->leaf[p->item[begin].node];
        nodes_of(tree)[node] = *leaf;
        leaves_of(tree)[leaf->child[1]] = node;
    }
    nodes_of(tree)[node].parent = parent;
    return (range){begin, end, node};
}

/* Builds nodes over all subtrees, from above. Siblings lie next to each other, because they are looked at
 * together. */
static void build(pe_tree *tree, const forest *p)
{
    pe_tree_node *nodes = nodes_of(tree);
    range open[MAX_RANGES];
    int open_count = 0, made_count = 0;
    tree->root = NONE;
    if (p->count > 0) {
        open[open_count] = make_range(tree, p, 0, p->count, NONE);
        tree->root = open[open_count++].node;
    }
    while (open_count > 0) {
        const range r = open[--open_count];
        if (r.end - r.begin > 1) {
            const int middle = r.begin + cut(p->item + r.begin, r.end - r.begin);
            const range first = make_range(tree, p, r.begin, middle, r.node);
            const range second = make_range(tree, p, middle, r.end, r.node);
            nodes[r.node].child[0] = first.node;
            nodes[r.node].child[1] = second.node;
            open[open_count++] = second;
            open[open_count++] = first;
            p->stack[made_count++] = r.node;
        }
    }
    while (made_count > 0) { /* children were made after their parents */
        fit(nodes, p->stack[--made_count]);
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
    };
    pe_status status = PE_OK;
    if (p.item == NULL || p.stack == NULL || (all && p.leaf == NULL)) {
        status = pe_fail(error, PE_NO_MEMORY, "no memory for a tree of %zu boxes", leaves);
    } else {
        if (all) {
            take_all(tree, &p);
        } else {
            take_apart(tree, &p);
        }
        build(tree, &p);
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

/* ---- Pairs ---- */

/* Nodes whose leaves are still to be tested against each other. */
typedef struct node_pairs {
    pe_node_pair *open; /* room for the three that one makes at most */
    int count;
} node_pairs;

/* A query is for the pairs of leaves of two trees, or of one. */
typedef struct query {
    const pe_tree_node *in_a, *in_b;
    bool same;
} query;

static query make_query(const pe_tree *a, const pe_tree *b)
{
    return (query){nodes_of(a), nodes_of(b), a == b};
}

static void push_overlapping(const query *y, node_pairs *m, int p, int q)
{
    const pe_tree_node *a = &y->in_a[p], *b = &y->in_b[q];
    if ((a->marked || b->marked) && pe_aabb_overlaps(&a->box, &b->box)) {
        m->open[m->count++] = (pe_node_pair){p, q};
    }
}

static bool are_leaves(const query *y, pe_node_pair now)
{
    return !(y->same && now.p == now.q) && is_leaf(&y->in_a[now.p]) && is_leaf(&y->in_b[now.q]);
}

/* Appends the pairs of nodes below a pair that is not of leaves. */
static void open_pair(const query *y, node_pairs *m, pe_node_pair now)
{
    const pe_tree_node *p = &y->in_a[now.p], *q = &y->in_b[now.q];
    if (y->same && now.p == now.q) {
        if (p->marked && !is_leaf(p)) {
            m->open[m->count++] = (pe_node_pair){p->child[1], p->child[1]};
            m->open[m->count++] = (pe_node_pair){p->child[0], p->child[0]};
            push_overlapping(y, m, p->child[0], p->child[1]);
        }
    } else if (p->height >= q->height) { /* a leaf has the height 0 */
        push_overlapping(y, m, p->child[1], now.q);
        push_overlapping(y, m, p->child[0], now.q);
    } else {
        push_overlapping(y, m, now.p, q->child[1]);
        push_overlapping(y, m, now.p, q->child[0]);
    }
}

int pe_tree_query_starts(const pe_tree *a, const pe_tree *b, int most, pe_node_pair *starts)
{
    if (a->root == NONE || b->root == NONE) {
        return 0;
    }
    const query y = make_query(a, b);
    node_pairs m = {starts, 0};
    if (y.same) {
        m.open[m.count++] = (pe_node_pair){a->root, a->root};
    } else {
        push_overlapping(&y, &m, a->root, b->root);
    }
    for (int pass = 0; pass < MAX_HEIGHT && 3 * m.count <= most; ++pass) {
        pe_node_pair old[PE_MOST_STARTS];
        const int count = m.count;
        memcpy(old, starts, (size_t)count * sizeof *old);
        m.count = 0;
        for (int i = 0; i < count; ++i) {
            if (are_leaves(&y, old[i])) {
                m.open[m.count++] = old[i];
            } else {
                open_pair(&y, &m, old[i]);
            }
        }
    }
    return m.count;
}

pe_status pe_tree_query_from(const pe_tree *a, const pe_tree *b, pe_node_pair start,
                             pe_pair_list *pairs, pe_error *error)
{
    const query y = make_query(a, b);
    pe_node_pair open[MAX_NODE_PAIRS];
    node_pairs m = {open, 0};
    pe_status status = PE_OK;
    m.open[m.count++] = start;
    while (m.count > 0 && status == PE_OK) {
        const pe_node_pair now = m.open[--m.count];
        if (are_leaves(&y, now)) {
            status = pe_pair_list_add(pairs, y.in_a[now.p].child[1], y.in_b[now.q].child[1], error);
        } else {
            open_pair(&y, &m, now);
        }
    }
    return status;
}

/* ---- Lists of pairs ---- */

pe_status pe_pair_list_add(pe_pair_list *list, int a, int b, pe_error *error)
{
    if (list->count == list->capacity) {
        int capacity = list->capacity < 64 ? 64 : list->capacity * 2;
        pe_pair *items = pe_take(list->work, (size_t)capacity, sizeof *items);
        if (items == NULL) {
            return pe_fail(error, PE_NO_MEMORY, "no memory for %d pairs", capacity);
        }
        if (list->count > 0) {
            memcpy(items, list->items, (size_t)list->count * sizeof *items);
        }
        list->items = items;
        list->capacity = capacity;
    }
    list->items[list->count++] = a < b ? (pe_pair){a, b} : (pe_pair){b, a};
    return PE_OK;
}

static int slot_of(pe_pair pair, bool b)
{
    return b ? pair.b : pair.a;
}

/* A stable counting sort by slot b, or by slot a. */
static void sort_by(bool b, const pe_pair *from, int count, int *start, int slots, pe_pair *to)
{
    memset(start, 0, ((size_t)slots + 1) * sizeof *start);
    for (int i = 0; i < count; ++i) {
        start[slot_of(from[i], b) + 1] += 1;
    }
    for (int s = 0; s < slots; ++s) {
        start[s + 1] += start[s];
    }
    for (int i = 0; i < count; ++i) {
        to[start[slot_of(from[i], b)]++] = from[i];
    }
}

pe_status pe_pair_list_sort(pe_pair_list *list, int slots, pe_error *error)
{
    if (list->count < 2) {
        return PE_OK;
    }
    int *start = pe_take(list->work, (size_t)slots + 1, sizeof *start);
    pe_pair *sorted = pe_take(list->work, (size_t)list->count, sizeof *sorted);
    if (start == NULL || sorted == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to sort %d pairs", list->count);
    }
    sort_by(true, list->items, list->count, start, slots, sorted);
    sort_by(false, sorted, list->count, start, slots, list->items);
    return PE_OK;
}
