/* The laws of a step in random worlds, and of the public interface in random sequences of its calls: in a few
 * hundred, or in as many worlds and sequences as the arguments say. */
#include "random_calls.h"
#include "random_worlds.h"

#include "check.h"

#include <stdlib.h>

static int worlds = 200, sequences = 40;

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

enum { CALL_BYTES = 600 };

static void test_random_calls_obey_the_laws(void **state)
{
    (void)state;
    random_calls_found found = {.broken = ""};
    for (int seed = 1; seed <= sequences; ++seed) {
        check_random random = {(uint64_t)seed * 0x9e3779b97f4a7c15u | 1};
        uint8_t bytes[CALL_BYTES];
        for (int i = 0; i < CALL_BYTES; ++i) {
            bytes[i] = (uint8_t)check_uniform(&random, 0, 256);
        }
        for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
            random_calls_run(bytes, CALL_BYTES, (pe_profile)profile, &found);
            if (found.broken[0] != '\0') {
                fail_msg("seed %d, profile %d: %s", seed, profile, found.broken);
            }
        }
    }
    print_message(
        "%d calls, %d refused; %d steps, %d undone, %d with sleep, %d with overlap; %d bodies "
        "destroyed, %d contacts\n",
        found.calls, found.refused, found.steps, found.undone, found.slept, found.overlapping,
        found.destroyed, found.contacts);
    assert_true(found.steps > 10 * sequences && found.contacts > 10 * sequences);
    assert_true(found.refused > sequences && found.undone > 0 && found.destroyed > sequences);
    assert_true(found.overlapping > sequences);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        worlds = (int)strtol(argv[1], NULL, 10);
    }
    if (argc > 2) {
        sequences = (int)strtol(argv[2], NULL, 10);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps_of_random_worlds_are_bounded),
        cmocka_unit_test(test_unsolved_island_keeps_finite_state),
        cmocka_unit_test(test_random_calls_obey_the_laws),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
