/* Work that several threads share. */
#include "base/parallel.h"
#include "check.h"

#include <pthread.h>
#include <stdatomic.h>

enum { ITEMS = 1000, MOST_THREADS = 5 };

/* How often each item was worked on, and by how many threads at a time. */
typedef struct tally {
    int calls[ITEMS];
    atomic_int at_work, most_at_work;
} tally;

static void count_call(void *context, int item)
{
    tally *t = context;
    const int now = atomic_fetch_add(&t->at_work, 1) + 1;
    int most = atomic_load(&t->most_at_work);
    while (now > most && !atomic_compare_exchange_weak(&t->most_at_work, &most, now)) {}
    t->calls[item] += 1;
    atomic_fetch_sub(&t->at_work, 1);
}

static void test_each_item_is_worked_on_once(void **state)
{
    (void)state;
    static const int counts[] = {0, 1, 2, ITEMS};
    for (int threads = 0; threads <= MOST_THREADS; ++threads) {
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i) {
            tally t = {.calls = {0}};
            pl_share_work(threads, counts[i], count_call, &t);
            for (int k = 0; k < ITEMS; ++k) {
                assert_int_equal(t.calls[k], k < counts[i]);
            }
            assert_in_range(atomic_load(&t.most_at_work), 0, threads < 1 ? 1 : threads);
        }
    }
}

/* Two items that wait for each other. */
static void meet(void *context, int item)
{
    assert_in_range(item, 0, 1);
    pthread_barrier_wait(context);
}

static void test_items_run_at_the_same_time(void **state)
{
    (void)state;
    pthread_barrier_t barrier;
    pthread_barrier_init(&barrier, NULL, 2);
    pl_share_work(2, 2, meet, &barrier);
    pthread_barrier_destroy(&barrier);
}

static void test_a_process_has_a_usable_cpu(void **state)
{
    (void)state;
    assert_in_range(pl_usable_cpus(), 1, 1 << 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_item_is_worked_on_once),
        cmocka_unit_test(test_items_run_at_the_same_time),
        cmocka_unit_test(test_a_process_has_a_usable_cpu),
    };
    return cmocka_run_group_tests_name("parallel", tests, NULL, NULL);
}
