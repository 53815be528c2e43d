#include "aabb_tree_nodes.h"

#include "base/pool.h"

#include <string.h>

/* Every step down leaves one pair of nodes on the stack, or two inside of one node. */
enum { MAX_NODE_PAIRS = 4 * (MAX_HEIGHT + 1), NODE_GRAIN = 2048 };

void pe_tree_free(pe_tree *tree, const pe_allocator *allocator)
{
    pe_array_free(&tree->node_array, allocator);
    pe_array_free(&tree->leaf_array, allocator);
    *tree = (pe_tree){0};
}

/* ---- Changes ---- */

/* Marks a leaf and all nodes above it, and returns whether the leaf was not marked yet. It ends at a marked node,
 * because all nodes above that are marked, or being marked by another thread. */
static bool mark(pe_tree *tree, int leaf)
{
    pe_tree_node *nodes = nodes_of(tree);
    const bool was_marked = nodes[leaf].marked;
    for (int node = leaf; node != NONE && !__atomic_load_n(&nodes[node].marked, __ATOMIC_RELAXED);
         node = nodes[node].parent) {
        __atomic_store_n(&nodes[node].marked, true, __ATOMIC_RELAXED);
    }
    return !was_marked;
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

bool pe_tree_set_box(pe_tree *tree, int item, const pe_aabb *box)
{
    const int leaf = leaves_of(tree)[item];
    nodes_of(tree)[leaf].box = *box;
    return mark(tree, leaf);
}

void pe_tree_count_marked(pe_tree *tree, int leaves)
{
    tree->marked_count += leaves;
}

void pe_tree_remove(pe_tree *tree, int item)
{
    int leaf = leaves_of(tree)[item];
    nodes_of(tree)[leaf].child[1] = NONE;
    tree->marked_count += mark(tree, leaf);
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

static void unmark_nodes(void *context, int worker, int begin, int end)
{
    (void)worker;
    pe_tree_node *nodes = context;
    for (int i = begin; i < end; ++i) {
        nodes[i].marked = false;
    }
}

void pe_tree_unmark(pe_tree *tree, pe_pool *pool)
{
    pe_tree_node *nodes = nodes_of(tree);
    if (is_mostly_marked(tree)) {
        pe_pool_run_range(pool, 1, tree->node_count + 1, NODE_GRAIN, unmark_nodes, nodes);
    } else {
        for (int i = tree->root, next; i != NONE; i = next) {
            next = next_node(nodes, i, !nodes[i].marked);
            nodes[i].marked = false;
        }
    }
    tree->marked_count = 0;
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
