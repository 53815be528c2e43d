/* Work that is cut into pieces, on threads. */
#include "base/thread_pool.h"
#include "check.h"

#include <pthread.h>
#include <stdatomic.h>

enum { ITEMS = 1000, MOST_THREADS = 5 };

/* How often each item was worked on, and by how many threads at a time. */
typedef struct tally {
    int calls[ITEMS];
    atomic_int at_work, most_at_work;
} tally;

static void count_call(void *context, int begin, int end)
{
    tally *t = context;
    const int now = atomic_fetch_add(&t->at_work, 1) + 1;
    int most = atomic_load(&t->most_at_work);
    while (now > most && !atomic_compare_exchange_weak(&t->most_at_work, &most, now)) {}
    for (int i = begin; i < end; ++i) {
        t->calls[i] += 1;
    }
    atomic_fetch_sub(&t->at_work, 1);
}

static void test_each_item_is_worked_on_once(void **state)
{
    (void)state;
    static const int counts[] = {0, 1, 2, ITEMS};
    for (int threads = 1; threads <= MOST_THREADS; ++threads) {
        pl_thread_pool *pool = pl_thread_pool_create(threads);
        assert_true((pool == NULL) == (threads == 1));
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i) {
            tally t = {.calls = {0}};
            /* Many short calls in a row: a thread that wakes late must take no piece of the next. */
            for (int call = 0; call < 50; ++call) {
                pl_thread_pool_run(pool, counts[i], 1 + call % 7, count_call, &t);
            }
            for (int k = 0; k < ITEMS; ++k) {
                assert_int_equal(t.calls[k], k < counts[i] ? 50 : 0);
            }
            assert_in_range(atomic_load(&t.most_at_work), 0, threads);
        }
        pl_thread_pool_destroy(pool);
    }
}

/* Two pieces that wait for each other. */
static void meet(void *context, int begin, int end)
{
    assert_int_equal(end, begin + 1);
    pthread_barrier_wait(context);
}

static void test_pieces_run_at_the_same_time(void **state)
{
    (void)state;
    pthread_barrier_t barrier;
    pthread_barrier_init(&barrier, NULL, 2);
    pl_thread_pool *pool = pl_thread_pool_create(2);
    assert_non_null(pool);
    pl_thread_pool_run(pool, 2, 1, meet, &barrier);
    pl_thread_pool_destroy(pool);
    pthread_barrier_destroy(&barrier);
}

static void test_a_process_has_a_usable_cpu(void **state)
{
    (void)state;
    assert_in_range(pl_usable_cpus(), 1, 1 << 20);
    pl_thread_pool_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_item_is_worked_on_once),
        cmocka_unit_test(test_pieces_run_at_the_same_time),
        cmocka_unit_test(test_a_process_has_a_usable_cpu),
    };
    return cmocka_run_group_tests_name("thread pool", tests, NULL, NULL);
}
