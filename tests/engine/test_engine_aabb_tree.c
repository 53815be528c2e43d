/* The tree of boxes against all pairs. */
#include "base/pool.h"
#include "base/vec3.h"
#include "broad_phase/aabb_tree.h"
#include "check.h"
#include "counting_allocator.h"

#include <string.h>

enum { ITEMS = 200 };

/* Boxes by item, and which of them changed since pairs were found. */
typedef struct forest {
    pe_tree tree;
    pe_aabb box[ITEMS];
    bool there[ITEMS], changed[ITEMS];
    pe_arena arena;
    pe_allocator allocator;
} forest;

static pe_aabb random_box(check_random *random)
{
    pe_aabb box;
    double size = check_uniform(random, 0, 1) < 0.02 ? 1e6 : 1;
    for (int k = 0; k < 3; ++k) {
        box.low[k] = check_uniform(random, -3, 3) * size;
        box.high[k] = box.low[k] + check_uniform(random, 0, 2) * size;
    }
    return box;
}

static void add(forest *f, int item, check_random *random)
{
    f->box[item] = random_box(random);
    f->there[item] = f->changed[item] = true;
    assert_int_equal(pe_tree_add(&f->tree, &f->allocator, item, &f->box[item], NULL), PE_OK);
}

static void change(forest *f, int item, check_random *random)
{
    if (!f->there[item]) {
        add(f, item, random);
    } else if (check_uniform(random, 0, 1) < 0.3) {
        pe_tree_remove(&f->tree, item);
        f->there[item] = false;
    } else {
        f->box[item] = random_box(random);
        f->changed[item] = true;
        pe_tree_count_marked(&f->tree, pe_tree_set_box(&f->tree, item, &f->box[item]));
    }
}

/* Marks the pairs that the tree tells. */
static void find(forest *f, char (*listed)[ITEMS])
{
    pe_arena_reset(&f->arena, &f->allocator);
    pe_pair_list pairs = {.work = {&f->arena, &f->allocator, NULL}};
    assert_int_equal(pe_tree_update(&f->tree, pairs.work, NULL), PE_OK);
    pe_node_pair starts[PE_MOST_STARTS];
    const int count = pe_tree_query_starts(&f->tree, &f->tree, PE_MOST_STARTS, starts);
    assert_true(count <= PE_MOST_STARTS);
    for (int i = 0; i < count; ++i) {
        assert_int_equal(pe_tree_query_from(&f->tree, &f->tree, starts[i], &pairs, NULL), PE_OK);
    }
    memset(listed, 0, ITEMS * sizeof *listed);
    for (int i = 0; i < pairs.count; ++i) {
        listed[pairs.items[i].a][pairs.items[i].b] += 1;
    }
    pe_tree_unmark(&f->tree, NULL);
}

static void test_pairs_are_overlaps_of_changed_boxes_once(void **state)
{
    (void)state;
    static char listed[ITEMS][ITEMS];
    check_random random = {31};
    forest f = {.allocator = pe_allocator_default()};
    long found = 0;
    for (int round = 0; round < 400; ++round) {
        /* From one change to all of them, so that every kind of rebuild is covered. */
        int changes = round % 3 == 0 ? 1 : round % 3 == 1 ? 12 : ITEMS - 1;
        memset(f.changed, 0, sizeof f.changed);
        for (int i = 0; i < changes; ++i) {
            change(&f, 1 + (int)check_uniform(&random, 0, ITEMS - 1), &random);
        }
        find(&f, listed);
        for (int a = 1; a < ITEMS; ++a) {
            for (int b = a + 1; b < ITEMS; ++b) {
                bool meet = f.there[a] && f.there[b] && (f.changed[a] || f.changed[b]) &&
                            pe_aabb_overlaps(&f.box[a], &f.box[b]);
                assert_int_equal(listed[a][b], meet);
                found += meet;
            }
        }
    }
    assert_true(found > 10000);
    pe_tree_free(&f.tree, &f.allocator);
    pe_arena_free(&f.arena, &f.allocator);
}

static void test_without_changes_no_pair_is_found(void **state)
{
    (void)state;
    static char listed[ITEMS][ITEMS], none[ITEMS][ITEMS];
    check_random random = {32};
    forest f = {.allocator = pe_allocator_default()};
    find(&f, listed); /* empty, too */
    for (int i = 1; i < ITEMS; ++i) {
        add(&f, i, &random);
    }
    find(&f, listed);
    assert_memory_not_equal(listed, none, sizeof listed);
    find(&f, listed);
    assert_memory_equal(listed, none, sizeof listed);
    pe_tree_invalidate(&f.tree);
    find(&f, listed);
    assert_memory_not_equal(listed, none, sizeof listed);
    pe_tree_free(&f.tree, &f.allocator);
    pe_arena_free(&f.arena, &f.allocator);
}

/* Boxes at 2^-i need the most cuts, and equal ones cannot be cut at all. */
static void test_tree_height_stays_low_for_hard_boxes(void **state)
{
    (void)state;
    static char listed[ITEMS][ITEMS];
    for (int kind = 0; kind < 2; ++kind) {
        forest f = {.allocator = pe_allocator_default()};
        for (int i = 1; i < ITEMS; ++i) {
            double x = kind == 0 ? pow(0.5, i) : 1;
            f.box[i] = (pe_aabb){{x, x, x}, {x, x, x}};
            assert_int_equal(pe_tree_add(&f.tree, &f.allocator, i, &f.box[i], NULL), PE_OK);
        }
        find(&f, listed);
        const pe_tree_node *nodes = f.tree.node_array.items;
        assert_in_range(nodes[f.tree.root].height, 8, 19); /* log 199 to the base 2, and 4/3 */
        assert_int_equal(listed[1][2], kind);
        pe_tree_free(&f.tree, &f.allocator);
        pe_arena_free(&f.arena, &f.allocator);
    }
}

/* One leaf after the other moves a little, for many rounds: partial rebuilds alone. */
static void test_height_and_nodes_stay_bounded_under_single_moves(void **state)
{
    (void)state;
    static char listed[ITEMS][ITEMS];
    check_random random = {33};
    forest f = {.allocator = pe_allocator_default()};
    for (int i = 1; i < ITEMS; ++i) {
        add(&f, i, &random);
    }
    find(&f, listed);
    int nodes = f.tree.node_count;
    assert_int_equal(nodes, 2 * (ITEMS - 1) - 1);
    for (int round = 0; round < 20000; ++round) {
        int item = 1 + round * 7 % (ITEMS - 1);
        for (int k = 0; k < 3; ++k) {
            double shift = check_uniform(&random, -0.5, 0.5);
            f.box[item].low[k] += shift;
            f.box[item].high[k] += shift;
        }
        pe_tree_count_marked(&f.tree, pe_tree_set_box(&f.tree, item, &f.box[item]));
        assert_int_equal(
            pe_tree_update(&f.tree, (pe_workspace){&f.arena, &f.allocator, NULL}, NULL), PE_OK);
        pe_tree_unmark(&f.tree, NULL);
        const pe_tree_node *node = f.tree.node_array.items;
        assert_true(node[f.tree.root].height <= 96);
    }
    assert_int_equal(f.tree.node_count, nodes);
    pe_tree_free(&f.tree, &f.allocator);
    pe_arena_free(&f.arena, &f.allocator);
}

static void test_failed_update_can_be_repeated(void **state)
{
    (void)state;
    static char listed[ITEMS][ITEMS], expected[ITEMS][ITEMS];
    check_random random = {34};
    counter c = {.fail_at = -1};
    forest f = {.allocator = {count_allocate, count_release, &c}};
    for (int i = 1; i < ITEMS; ++i) {
        add(&f, i, &random);
    }
    c.fail_at = c.calls;
    pe_error error = {0};
    assert_int_equal(pe_tree_update(&f.tree, (pe_workspace){&f.arena, &f.allocator, NULL}, &error),
                     PE_NO_MEMORY);
    assert_contains(error.message, "199 boxes");
    c.fail_at = -1;
    find(&f, listed);
    for (int a = 1; a < ITEMS; ++a) {
        for (int b = a + 1; b < ITEMS; ++b) {
            expected[a][b] = pe_aabb_overlaps(&f.box[a], &f.box[b]);
        }
    }
    assert_memory_equal(listed, expected, sizeof listed);
    pe_tree_free(&f.tree, &f.allocator);
    pe_arena_free(&f.arena, &f.allocator);
    assert_int_equal(c.living, 0);
}

static bool are_same_nodes(const pe_tree_node *a, const pe_tree_node *b)
{
    return memcmp(&a->box, &b->box, sizeof a->box) == 0 && a->parent == b->parent &&
           a->child[0] == b->child[0] && a->child[1] == b->child[1] && a->height == b->height &&
           a->marked == b->marked;
}

/* From 2048 subtrees on threads build together: all of a tree, and the part that changes have marked. */
static void test_threads_build_the_same_tree(void **state)
{
    (void)state;
    enum { MANY = 20000, FEW = 2400, ROUNDS = 3 };
    check_random random = {35};
    const pe_allocator allocator = pe_allocator_default();
    pe_world_def def = pe_world_def_default();
    pe_tree trees[2] = {{.root = 0}, {.root = 0}};
    pe_arena arena = {0};
    pe_pool *pool;
    def.threads = 3;
    assert_int_equal(pe_pool_create(&def, &allocator, &pool, NULL), PE_OK);
    for (int round = 0; round < ROUNDS; ++round) {
        const int changes = round == 1 ? FEW : MANY;
        for (int i = 0; i < changes; ++i) {
            const int item = 1 + (round == 1 ? i * 8 : i);
            const pe_aabb box = random_box(&random);
            for (int t = 0; t < 2; ++t) {
                if (round == 0) {
                    assert_int_equal(pe_tree_add(&trees[t], &allocator, item, &box, NULL), PE_OK);
                } else {
                    pe_tree_count_marked(&trees[t], pe_tree_set_box(&trees[t], item, &box));
                }
            }
        }
        for (int t = 0; t < 2; ++t) {
            const pe_workspace work = {&arena, &allocator, t == 0 ? NULL : pool};
            assert_int_equal(pe_tree_update(&trees[t], work, NULL), PE_OK);
        }
        assert_int_equal(trees[0].root, trees[1].root);
        assert_int_equal(trees[0].node_count, trees[1].node_count);
        for (int i = 1; i <= trees[0].node_count; ++i) {
            const pe_tree_node *a = trees[0].node_array.items, *b = trees[1].node_array.items;
            assert_true(are_same_nodes(&a[i], &b[i]));
        }
        for (int t = 0; t < 2; ++t) {
            pe_tree_unmark(&trees[t], NULL);
        }
    }
    for (int t = 0; t < 2; ++t) {
        pe_tree_free(&trees[t], &allocator);
    }
    pe_pool_destroy(pool, &allocator);
    pe_arena_free(&arena, &allocator);
}

/* (a, b) in order, also where one slot has nearly all of them. */
static void test_pairs_are_sorted_by_both_slots(void **state)
{
    (void)state;
    pe_allocator allocator = pe_allocator_default();
    pe_arena arena = {0};
    pe_pair_list pairs = {.work = {&arena, &allocator, NULL}};
    for (int i = 0; i < 5000; ++i) {
        int b = 1 + i * 3571 % 4999;
        assert_int_equal(
            pe_pair_list_add(&pairs, i % 9 == 0 ? i * 77 % 5000 : b, i % 9 ? 0 : b, NULL), PE_OK);
    }
    assert_int_equal(pe_pair_list_sort(&pairs, 5000, NULL), PE_OK);
    assert_int_equal(pairs.count, 5000);
    for (int i = 1; i < pairs.count; ++i) {
        pe_pair p = pairs.items[i - 1], q = pairs.items[i];
        assert_true(p.a < q.a || (p.a == q.a && p.b <= q.b));
    }
    pe_arena_free(&arena, &allocator);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs_are_overlaps_of_changed_boxes_once),
        cmocka_unit_test(test_without_changes_no_pair_is_found),
        cmocka_unit_test(test_tree_height_stays_low_for_hard_boxes),
        cmocka_unit_test(test_height_and_nodes_stay_bounded_under_single_moves),
        cmocka_unit_test(test_failed_update_can_be_repeated),
        cmocka_unit_test(test_threads_build_the_same_tree),
        cmocka_unit_test(test_pairs_are_sorted_by_both_slots),
    };
    return cmocka_run_group_tests_name("engine_aabb_tree", tests, NULL, NULL);
}
