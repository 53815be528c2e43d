/* The meter of a step: instructions where they are counted, and nothing where they are not. */
#include "check.h"
#include "runner/resource_usage.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>

enum { LOOPS = 1000000 };

static void *work(void *unused)
{
    for (volatile int i = 0; i < LOOPS; ++i) {}
    return unused;
}

static pl_call_cost measure_work(pl_call_timer *meter, int times)
{
    pl_call_timer_begin(meter);
    for (int i = 0; i < times; ++i) {
        work(NULL);
    }
    return pl_call_timer_end(meter);
}

/* A turn of the loop is a few instructions. */
static void check_cost(pl_call_cost cost, bool counts, double least_loops, double most_loops)
{
    assert_true(cost.cpu_time >= 0 && isfinite(cost.cpu_time));
    assert_int_equal(isfinite(cost.instructions), counts);
    if (counts) {
        assert_true(cost.instructions >= least_loops * LOOPS);
        assert_at_most(cost.instructions, most_loops * LOOPS);
    }
}

static void test_a_step_counts_its_own_instructions(void **state)
{
    (void)state;
    pl_call_timer meter = pl_call_timer_open();
    const bool counts = meter.counter >= 0;
    check_cost(measure_work(&meter, 1), counts, 1, 20);
    check_cost(measure_work(&meter, 3), counts, 3, 60);
    work(NULL); /* between steps: not counted */
    check_cost(measure_work(&meter, 0), counts, 0, 0.01);
    pl_call_timer_close(&meter);
}

static void test_threads_that_a_step_starts_are_counted(void **state)
{
    (void)state;
    pthread_t thread;
    pl_call_timer meter = pl_call_timer_open();
    const bool counts = meter.counter >= 0;
    pl_call_timer_begin(&meter);
    assert_int_equal(pthread_create(&thread, NULL, work, NULL), 0);
    work(NULL);
    assert_int_equal(pthread_join(thread, NULL), 0);
    check_cost(pl_call_timer_end(&meter), counts, 2, 41);
    pl_call_timer_close(&meter);
}

static void test_step_timer_works_without_a_counter(void **state)
{
    (void)state;
    pl_call_timer meter = {.counter = -1};
    check_cost(measure_work(&meter, 1), false, 0, 0);
    pl_call_timer_close(&meter);
    check_cost(measure_work(&meter, 1), false, 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_step_counts_its_own_instructions),
        cmocka_unit_test(test_threads_that_a_step_starts_are_counted),
        cmocka_unit_test(test_step_timer_works_without_a_counter),
    };
    return cmocka_run_group_tests_name("sweep instructions", tests, NULL, NULL);
}
