/* How many runs, and how many of their threads, there are at the same time. */
#include "check.h"
#include "runner/execute.h"

static void test_runs_of_one_thread_fill_the_jobs(void **state)
{
    (void)state;
    pl_schedule s = {.jobs = 3, .cpus = 8};
    for (int i = 0; i < 3; ++i) {
        assert_true(pl_schedule_has_room(&s, 1));
        assert_int_equal(pl_schedule_begin(&s, 1), 2);
    }
    assert_false(pl_schedule_has_room(&s, 1));
    pl_schedule_end(&s, 2);
    assert_true(pl_schedule_has_room(&s, 1));
}

static void test_jobs_are_no_more_than_the_cpus(void **state)
{
    (void)state;
    pl_schedule s = {.jobs = 5, .cpus = 2};
    assert_int_equal(pl_schedule_begin(&s, 1), 1);
    assert_int_equal(pl_schedule_begin(&s, 1), 1);
    assert_false(pl_schedule_has_room(&s, 1));
}

static void test_threads_of_runs_share_the_cpus(void **state)
{
    (void)state;
    pl_schedule s = {.jobs = 4, .cpus = 8};
    assert_int_equal(pl_schedule_begin(&s, 5), 5);
    assert_false(pl_schedule_has_room(&s, 4));
    assert_true(pl_schedule_has_room(&s, 3));
    /* Its share would be two, and two of three are free. */
    assert_int_equal(pl_schedule_begin(&s, 1), 2);
    assert_int_equal(pl_schedule_begin(&s, 1), 1);
    assert_false(pl_schedule_has_room(&s, 1));
    pl_schedule_end(&s, 5);
    assert_true(pl_schedule_has_room(&s, 5));
}

static void test_a_run_of_too_many_threads_is_alone(void **state)
{
    (void)state;
    pl_schedule s = {.jobs = 2, .cpus = 2};
    assert_int_equal(pl_schedule_begin(&s, 1), 1);
    assert_false(pl_schedule_has_room(&s, 8));
    pl_schedule_end(&s, 1);
    assert_true(pl_schedule_has_room(&s, 8));
    assert_int_equal(pl_schedule_begin(&s, 8), 2);
    assert_false(pl_schedule_has_room(&s, 1));
    pl_schedule_end(&s, 2);
    assert_int_equal(s.runs, 0);
    assert_int_equal(s.busy_cpus, 0);
}

/* All combinations of few runs: there are never more threads than CPUs, and never none. */
static void test_every_run_begins_at_last(void **state)
{
    (void)state;
    for (int jobs = 1; jobs <= 5; ++jobs) {
        for (int cpus = 1; cpus <= 6; ++cpus) {
            pl_schedule s = {.jobs = jobs, .cpus = cpus};
            int taken[64] = {0}, first = 0, next = 0;
            while (next < 64) {
                const int threads = 1 + next * 5 % 7;
                if (pl_schedule_has_room(&s, threads)) {
                    taken[next++] = pl_schedule_begin(&s, threads);
                } else {
                    assert_true(first < next);
                    pl_schedule_end(&s, taken[first++]);
                }
                assert_in_range(s.runs, 0, jobs);
                assert_in_range(s.busy_cpus, s.runs, cpus);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_runs_of_one_thread_fill_the_jobs),
        cmocka_unit_test(test_jobs_are_no_more_than_the_cpus),
        cmocka_unit_test(test_threads_of_runs_share_the_cpus),
        cmocka_unit_test(test_a_run_of_too_many_threads_is_alone),
        cmocka_unit_test(test_every_run_begins_at_last),
    };
    return cmocka_run_group_tests_name("schedule", tests, NULL, NULL);
}
