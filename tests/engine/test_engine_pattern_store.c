/* Patterns that are kept from step to step. The reference is a pattern that is found again. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "dense_problem.h"
#include "sparse/pattern_store.h"

#include <string.h>

enum { BODIES = 9, MANIFOLDS = 14 };

/* A problem of the seed, with one manifold in three left out. */
typedef struct asked {
    pe_contact_problem *source;
    test_memory memory;
    pe_workspace work;
    pe_problem problem;
    bool counted[MANIFOLDS];
} asked;

static void begin(asked *a, uint64_t seed)
{
    a->source = problem_at_random(seed, BODIES, MANIFOLDS);
    a->work = test_memory_begin(&a->memory);
    a->problem = solver_problem(a->source, a->work);
    assert_int_equal(a->problem.manifold_count, MANIFOLDS);
    for (int i = 0; i < MANIFOLDS; ++i) {
        a->counted[i] = (i + (int)seed) % 3 != 0;
    }
}

static void end(asked *a)
{
    test_memory_end(&a->memory);
    pe_contact_problem_destroy(a->source);
}

static pe_pattern ask(pe_pattern_store *store, asked *a)
{
    pe_pattern pattern;
    assert_int_equal(pe_pattern_store_find(store, &a->problem, a->counted, a->work, &pattern, NULL),
                     PE_OK);
    return pattern;
}

static void check_against_anew(asked *a, const pe_pattern *kept)
{
    pe_pattern fresh;
    assert_int_equal(pe_pattern_find(&a->problem, a->counted, a->work, &fresh, NULL), PE_OK);
    size_t n = (size_t)fresh.count;
    assert_int_equal(kept->count, fresh.count);
    assert_memory_equal(kept->order, fresh.order, n * sizeof(int));
    assert_memory_equal(kept->place, fresh.place, n * sizeof(int));
    assert_memory_equal(kept->start, fresh.start, (n + 1) * sizeof(int));
    assert_memory_equal(kept->row, fresh.row, (size_t)fresh.start[n] * sizeof(int));
    assert_memory_equal(kept->couple, fresh.couple, MANIFOLDS * sizeof(int));
    assert_memory_equal(kept->counted, fresh.counted, sizeof a->counted);
    assert_int_equal(kept->depth, fresh.depth);
    assert_close(kept->mass_ratio, fresh.mass_ratio, 0, 0);
    assert_close(kept->flops, fresh.flops, 0, 0);
}

static void test_kept_pattern_equals_a_new_one(void **state)
{
    (void)state;
    asked a;
    pe_pattern_store store = {0};
    begin(&a, 1);
    pe_pattern first = ask(&store, &a), again = ask(&store, &a);
    check_against_anew(&a, &again);
    /* The second one comes from the store: the first was still in the workspace. */
    assert_ptr_not_equal(first.order, again.order);
    assert_ptr_equal(again.order, ask(&store, &a).order);
    pe_pattern_store_free(&store, a.work.allocator);
    end(&a);
}

static void test_other_pairs_have_their_own_pattern(void **state)
{
    (void)state;
    asked a;
    pe_pattern_store store = {0};
    begin(&a, 2);
    ask(&store, &a);
    for (int i = 0; i < MANIFOLDS; ++i) {
        a.counted[i] = !a.counted[i];
        ask(&store, &a);
        pe_pattern pattern = ask(&store, &a);
        check_against_anew(&a, &pattern);
        a.counted[i] = !a.counted[i];
    }
    pe_pattern_store_free(&store, a.work.allocator);
    end(&a);
}

static void test_least_recently_used_pattern_is_replaced(void **state)
{
    (void)state;
    enum { MANY = PE_KEPT_PATTERNS + 6 };
    static asked a[MANY];
    static pe_pattern_store store;
    for (int i = 0; i < MANY; ++i) {
        begin(&a[i], (uint64_t)i + 1);
        ask(&store, &a[i]);
        ask(&store, &a[0]); /* never the least recently used */
    }
    assert_ptr_equal(ask(&store, &a[0]).order, ask(&store, &a[0]).order);
    for (int i = 0; i < MANY; ++i) {
        pe_pattern pattern = ask(&store, &a[i]);
        check_against_anew(&a[i], &pattern);
    }
    pe_pattern_store_free(&store, a[0].work.allocator);
    for (int i = 0; i < MANY; ++i) {
        end(&a[i]);
    }
}

static void test_out_of_memory_leaves_the_store_valid(void **state)
{
    (void)state;
    bool failed = true;
    for (long k = 1; failed; ++k) {
        asked a;
        pe_pattern_store store = {0};
        pe_pattern pattern;
        pe_error error;
        begin(&a, 3);
        a.memory.fail_at = a.memory.made + k;
        pe_status status =
            pe_pattern_store_find(&store, &a.problem, a.counted, a.work, &pattern, &error);
        failed = status != PE_OK;
        assert_true(status == PE_OK || status == PE_NO_MEMORY);
        a.memory.fail_at = 0;
        pattern = ask(&store, &a);
        check_against_anew(&a, &pattern);
        pe_pattern_store_free(&store, a.work.allocator);
        end(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kept_pattern_equals_a_new_one),
        cmocka_unit_test(test_other_pairs_have_their_own_pattern),
        cmocka_unit_test(test_least_recently_used_pattern_is_replaced),
        cmocka_unit_test(test_out_of_memory_leaves_the_store_valid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
