#include "aabb_tree.h"

#include "vec.h"

enum {
    NONE = 0,
    MOST_HEIGHT = 96, /* over this everything is built anew */
    /* A tree that was built at once is lower than log 2^31 to the base 4/3, 75. */
    MOST_RANGES = 96,
    /* Every step down leaves one pair of nodes behind, inside of one node two. */
    MOST_MEETINGS = 4 * (MOST_HEIGHT + 1)
};

static pe_tree_node *nodes_of(const pe_tree *tree)
{
    return tree->node_array.items;
}

static bool is_leaf(const pe_tree_node *node)
{
    return node->child[0] == NONE;
}

void pe_tree_free(pe_tree *tree, const pe_allocator *allocator)
{
    pe_array_free(&tree->node_array, allocator);
    *tree = (pe_tree){0};
}

/* ---- Changes -----------------------------------------------------------------------------------
 */

static int take_node(pe_tree *tree)
{
    int node = tree->first_free;
    if (node == NONE) {
        return ++tree->node_count;
    }
    tree->first_free = nodes_of(tree)[node].parent;
    return node;
}

static void give_back(pe_tree *tree, int node)
{
    nodes_of(tree)[node].parent = tree->first_free;
    tree->first_free = node;
}

/* Everything above a marked node is marked. */
static void mark(pe_tree *tree, int node)
{
    pe_tree_node *nodes = nodes_of(tree);
    for (; node != NONE && !nodes[node].marked; node = nodes[node].parent) {
        nodes[node].marked = true;
    }
}

pe_status pe_tree_add(pe_tree *tree, const pe_allocator *allocator, int item, const pe_box *box,
                      int *leaf, pe_error *error)
{
    size_t used = tree->node_count > 0 ? (size_t)tree->node_count + 1 : 0;
    pe_status status =
        pe_array_reserve(&tree->node_array, allocator, sizeof(pe_tree_node), used + 3, used, error);
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
    *leaf = added;
    return PE_OK;
}

void pe_tree_move(pe_tree *tree, int leaf, const pe_box *box)
{
    nodes_of(tree)[leaf].box = *box;
    mark(tree, leaf);
}

void pe_tree_remove(pe_tree *tree, int leaf)
{
    nodes_of(tree)[leaf].child[1] = NONE;
    mark(tree, leaf);
}

/* Visits the nodes below `node` in depth-first order, by the links to the parents: the next one
 * after it, without what is below it if `over`; NONE at the end. */
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

void pe_tree_mark_all(pe_tree *tree)
{
    pe_tree_node *nodes = nodes_of(tree);
    for (int i = tree->root; i != NONE; i = next_node(nodes, i, false)) {
        nodes[i].marked = true;
    }
}

void pe_tree_unmark(pe_tree *tree)
{
    pe_tree_node *nodes = nodes_of(tree);
    for (int i = tree->root, next; i != NONE; i = next) {
        bool over = !nodes[i].marked;
        nodes[i].marked = false;
        next = next_node(nodes, i, over);
    }
}

/* ---- Rebuilding --------------------------------------------------------------------------------
 */

/* A subtree, to be put under new nodes. */
typedef struct part {
    double centre[3];
    int node;
} part;

/* The middle; 0 for a box without one, because it has no end. */
static double middle_of(double low, double high)
{
    double middle = 0.5 * low + 0.5 * high;
    return isfinite(middle) ? middle : 0;
}

static part part_of(const pe_tree_node *nodes, int node)
{
    const pe_box *box = &nodes[node].box;
    part p = {.node = node};
    for (int k = 0; k < 3; ++k) {
        p.centre[k] = middle_of(box->low[k], box->high[k]);
    }
    return p;
}

/* Takes the marked inner nodes away and lists what is left. The pile needs room for one node more
 * than are marked. Returns how many parts there are. */
static int take_apart(pe_tree *tree, int *pile, part *parts)
{
    const pe_tree_node *nodes = nodes_of(tree);
    int count = 0, piled = 0;
    pile[piled++] = tree->root;
    while (piled > 0) {
        int i = pile[--piled];
        if (nodes[i].marked && !is_leaf(&nodes[i])) {
            pile[piled++] = nodes[i].child[1];
            pile[piled++] = nodes[i].child[0];
            give_back(tree, i);
        } else if (is_leaf(&nodes[i]) && nodes[i].child[1] == NONE) {
            tree->leaf_count -= 1;
            give_back(tree, i);
        } else {
            parts[count++] = part_of(nodes, i);
        }
    }
    return count;
}

static void swap(part *a, part *b)
{
    part c = *a;
    *a = *b;
    *b = c;
}

/* The axis along which the centres are spread widest, and their middle on it. */
static int widest_axis(const part *parts, int count, double *middle)
{
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = high[k] = parts[0].centre[k];
    }
    for (int i = 1; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            low[k] = pe_min(low[k], parts[i].centre[k]);
            high[k] = pe_max(high[k], parts[i].centre[k]);
        }
    }
    double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    *middle = middle_of(low[axis], high[axis]);
    return axis;
}

/* Puts those below the value before the others; returns how many they are. */
static int cut_at(part *parts, int count, int axis, double value)
{
    int below = 0;
    for (int i = 0; i < count; ++i) {
        if (parts[i].centre[axis] < value) {
            swap(&parts[i], &parts[below++]);
        }
    }
    return below;
}

/* Puts the lower half before the upper one (Hoare 1961). Equal ones may go to either. */
static int cut_in_halves(part *parts, int count, int axis)
{
    int half = count / 2;
    for (int begin = 0, end = count - 1; begin < end;) {
        double pivot = parts[begin + (end - begin) / 2].centre[axis];
        int i = begin, j = end;
        while (i <= j) {
            while (parts[i].centre[axis] < pivot) {
                ++i;
            }
            while (parts[j].centre[axis] > pivot) {
                --j;
            }
            if (i <= j) {
                swap(&parts[i++], &parts[j--]);
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

/* Orders the parts, 2 or more, into those of either child; returns how many the first gets. */
static int cut(part *parts, int count)
{
    double middle;
    int axis = widest_axis(parts, count, &middle);
    int below = cut_at(parts, count, axis, middle), above = count - below;
    return 4 * (below < above ? below : above) < count ? cut_in_halves(parts, count, axis) : below;
}

/* Sets an inner node by its children. */
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

/* Parts that are still to be put under a node. */
typedef struct range {
    int begin, end, parent, side;
} range;

/* Builds nodes over all parts; `made` has room for as many. */
static void build(pe_tree *tree, part *parts, int count, int *made)
{
    pe_tree_node *nodes = nodes_of(tree);
    range open[MOST_RANGES];
    int open_count = 0, made_count = 0;
    tree->root = NONE;
    if (count > 0) {
        open[open_count++] = (range){0, count, NONE, 0};
    }
    while (open_count > 0) {
        range r = open[--open_count];
        bool one = r.end - r.begin == 1;
        int node = one ? parts[r.begin].node : take_node(tree);
        nodes[node].parent = r.parent;
        if (r.parent == NONE) {
            tree->root = node;
        } else {
            nodes[r.parent].child[r.side] = node;
        }
        if (!one) {
            int middle = r.begin + cut(parts + r.begin, r.end - r.begin);
            open[open_count++] = (range){middle, r.end, node, 1};
            open[open_count++] = (range){r.begin, middle, node, 0};
            made[made_count++] = node;
        }
    }
    while (made_count > 0) { /* children were made after their parents */
        fit(nodes, made[--made_count]);
    }
}

static pe_status rebuild_marked(pe_tree *tree, pe_workspace work, pe_error *error)
{
    if (tree->root == NONE || !nodes_of(tree)[tree->root].marked) {
        return PE_OK;
    }
    pe_arena_mark before = pe_arena_fill(work.arena);
    size_t leaves = (size_t)tree->leaf_count;
    part *parts = pe_take(work, leaves, sizeof *parts);
    int *pile = pe_take(work, leaves + 1, sizeof *pile);
    pe_status status = PE_OK;
    if (parts == NULL || pile == NULL) {
        status = pe_fail(error, PE_NO_MEMORY, "no memory for a tree of %zu boxes", leaves);
    } else {
        int count = take_apart(tree, pile, parts);
        build(tree, parts, count, pile);
    }
    pe_arena_rewind(work.arena, work.allocator, before);
    return status;
}

pe_status pe_tree_update(pe_tree *tree, pe_workspace work, pe_error *error)
{
    pe_status status = rebuild_marked(tree, work, error);
    if (status == PE_OK && tree->root != NONE && nodes_of(tree)[tree->root].height > MOST_HEIGHT) {
        pe_tree_mark_all(tree);
        status = rebuild_marked(tree, work, error);
    }
    return status;
}

/* ---- Pairs -------------------------------------------------------------------------------------
 */

/* Nodes whose leaves are still to be met with each other. */
typedef struct meeting {
    const pe_tree_node *p, *q;
} meeting;

typedef struct meetings {
    meeting open[MOST_MEETINGS];
    int count;
} meetings;

static void open_meeting(meetings *m, const pe_tree_node *p, const pe_tree_node *q)
{
    if ((p->marked || q->marked) && pe_box_overlaps(&p->box, &q->box)) {
        m->open[m->count++] = (meeting){p, q};
    }
}

static void open_inside(meetings *m, const pe_tree_node *nodes, const pe_tree_node *node)
{
    if (node->marked && !is_leaf(node)) {
        const pe_tree_node *p = &nodes[node->child[0]], *q = &nodes[node->child[1]];
        m->open[m->count++] = (meeting){q, q};
        m->open[m->count++] = (meeting){p, p};
        open_meeting(m, p, q);
    }
}

pe_status pe_tree_meet(const pe_tree *a, const pe_tree *b, pe_pair_list *pairs, pe_error *error)
{
    pe_status status = PE_OK;
    if (a->root == NONE || b->root == NONE) {
        return status;
    }
    const pe_tree_node *in_a = nodes_of(a), *in_b = nodes_of(b);
    meetings m = {.count = 0};
    if (a == b) {
        m.open[m.count++] = (meeting){&in_a[a->root], &in_a[a->root]};
    } else {
        open_meeting(&m, &in_a[a->root], &in_b[b->root]);
    }
    while (m.count > 0 && status == PE_OK) {
        meeting now = m.open[--m.count];
        const pe_tree_node *p = now.p, *q = now.q;
        if (p == q) {
            open_inside(&m, in_a, p);
        } else if (is_leaf(p) && is_leaf(q)) {
            status = pe_pair_list_add(pairs, p->child[1], q->child[1], error);
        } else if (p->height >= q->height) { /* a leaf has the height 0 */
            open_meeting(&m, &in_a[p->child[1]], q);
            open_meeting(&m, &in_a[p->child[0]], q);
        } else {
            open_meeting(&m, p, &in_b[q->child[1]]);
            open_meeting(&m, p, &in_b[q->child[0]]);
        }
    }
    return status;
}
