/* The timer of an engine's calls measures what clocks read next to it measure. */
#include "check.h"
#include "engine_run.h"
#include "runner/resource_usage.h"

#include <math.h>
#include <time.h>

/* s of CPU time: so long that the timer's own calls are nothing next to it. */
static const double WORK = 0.02;

static double seconds_of(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* What two clocks say, s. */
typedef struct reading {
    double cpu, wall;
} reading;

static reading read_clocks(void)
{
    return (reading){seconds_of(CLOCK_PROCESS_CPUTIME_ID), seconds_of(CLOCK_MONOTONIC)};
}

static reading since(reading start)
{
    const reading now = read_clocks();
    return (reading){now.cpu - start.cpu, now.wall - start.wall};
}

static void compute(void)
{
    const double start = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    while (seconds_of(CLOCK_PROCESS_CPUTIME_ID) - start < WORK) {}
}

static void sleep_a_while(void)
{
    const struct timespec pause = {.tv_nsec = (long)(WORK * 1e9)};
    nanosleep(&pause, NULL);
}

/* The timer counts at least what is measured within it, and at most what is measured around it. */
static void check_bounds(void (*work)(void))
{
    pl_call_timer timer = pl_call_timer_open();
    for (int i = 0; i < 3; ++i) {
        const reading outer_start = read_clocks();
        pl_call_timer_begin(&timer);
        const reading inner_start = read_clocks();
        work();
        const reading inner = since(inner_start);
        const pl_call_cost cost = pl_call_timer_end(&timer);
        const reading outer = since(outer_start);
        assert_at_most(inner.cpu, cost.cpu_time);
        assert_at_most(cost.cpu_time, outer.cpu);
        assert_at_most(inner.wall, cost.wall_time);
        assert_at_most(cost.wall_time, outer.wall);
    }
    pl_call_timer_close(&timer);
}

static void test_times_of_work_are_those_of_clocks(void **state)
{
    (void)state;
    check_bounds(compute);
}

/* Sleep takes wall time, and no CPU time. */
static void test_times_of_sleep_are_those_of_clocks(void **state)
{
    (void)state;
    check_bounds(sleep_a_while);
}

static void test_session_adds_up_what_its_steps_cost(void **state)
{
    (void)state;
    pl_engine_choice choice;
    assert_int_equal(pl_engine_choose("plumb", &choice, NULL), PL_OK);
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    engine_run r;
    engine_start(&r, &choice, &scene);
    double cpu = 0, wall = 0;
    for (int i = 0; i < 50; ++i) {
        pl_call_cost cost;
        assert_int_equal(pl_session_step(&r.session, &r.stats, &cost, NULL), PL_OK);
        cpu += cost.cpu_time;
        wall += cost.wall_time;
    }
    assert_true(cpu > 0 && wall > 0);
    assert_close(r.session.cost[PL_CALLS_STEP].cpu_time, cpu, 0, 1e-12);
    assert_close(r.session.cost[PL_CALLS_STEP].wall_time, wall, 0, 1e-12);
    engine_finish(&r);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_times_of_work_are_those_of_clocks),
        cmocka_unit_test(test_times_of_sleep_are_those_of_clocks),
        cmocka_unit_test(test_session_adds_up_what_its_steps_cost),
    };
    return cmocka_run_group_tests_name("resource usage", tests, NULL, NULL);
}
