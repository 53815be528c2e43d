/* The laws of a step in random worlds: in a few hundred, or in as many as the argument says. */
#include "random_worlds.h"

#include "check.h"

#include <stdlib.h>

static int worlds = 200;

static void test_steps_of_random_worlds_are_bounded(void **state)
{
    (void)state;
    random_worlds_found found = random_worlds_run(1, worlds);
    assert_int_equal(found.too_far, 0);
    assert_int_equal(found.not_finite, 0);
    assert_int_equal(found.too_fast, 0);
    assert_int_equal(found.failed, 0);
    assert_true(found.unparted > 0); /* the worlds are as bad as they should be */
}

/* A world in which a solver failed with velocities that were not finite. */
static void test_unsolved_island_keeps_finite_state(void **state)
{
    (void)state;
    random_worlds_found found = random_worlds_run(26867, 1);
    assert_int_equal(found.failed, 0);
    assert_int_equal(found.not_finite, 0);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        worlds = (int)strtol(argv[1], NULL, 10);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps_of_random_worlds_are_bounded),
        cmocka_unit_test(test_unsolved_island_keeps_finite_state),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
