/* Verdicts against a converged reference, from paths that the test makes. */
#include "adapters/built_in.h"
#include "check.h"
#include "studies/reference/reference_verdict.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLES = 11 };

/* A reference of one body that stays at the origin, bound 1 cm. */
typedef struct staged {
    pl_reference reference;
    double moved[SAMPLES * 3], other[SAMPLES * 3], allowance[SAMPLES], bound;
    long horizon;
    int body;
} staged;

static void stage(staged *s)
{
    memset(s, 0, sizeof *s);
    s->bound = 0.01;
    s->horizon = SAMPLES;
    s->reference = (pl_reference){.engine_count = 1,
                                  .interval = 0.1,
                                  .bodies = 1,
                                  .body = &s->body,
                                  .bounds = &s->bound,
                                  .known = true,
                                  .samples = SAMPLES,
                                  .allowance = s->allowance,
                                  .horizon = &s->horizon};
    s->reference.engines[0].count = 1;
    s->reference.engines[0].levels[0] =
        (pl_body_paths){.samples = SAMPLES, .bodies = 1, .moved = s->moved, .completed = true};
}

static pl_body_verdict judged(staged *s)
{
    const pl_body_paths paths = {
        .samples = SAMPLES, .bodies = 1, .moved = s->other, .completed = true};
    return pl_body_judge(&s->reference, &paths, 0);
}

static void test_a_body_that_comes_back_has_strayed(void **state)
{
    (void)state;
    staged s;
    stage(&s);
    s.other[3 * 4] = 0.2;
    s.other[3 * 5 + 1] = 0.3;
    pl_body_verdict verdict = judged(&s);
    assert_true(isnan(verdict.differs_from));
    assert_close(verdict.stray, 0.3, 0, 0);
    assert_close(verdict.strays_at, 0.5, 1e-12, 0);
    s.other[3 * 10] = 0.1; /* away at the end: it differs */
    verdict = judged(&s);
    assert_close(verdict.differs_from, 1, 1e-12, 0);
    assert_true(isnan(verdict.strays_at));
    assert_close(verdict.off[0], 0.1, 0, 0);
}

/* Three engines whose body ends at these places, m, along x; `second` is the number of the engine that
 * confirms the reference at smaller steps, 0: none does. */
static bool contradicted_beside(int second, const char *const families[3], const double ends[3])
{
    staged s;
    stage(&s);
    s.reference.second = second;
    pl_body_verdict bodies[3];
    pl_engine_verdict engines[3] = {{0}};
    for (int i = 0; i < 3; ++i) {
        bodies[i] = (pl_body_verdict){.final = fabs(ends[i]),
                                      .off = {ends[i], 0, 0},
                                      .differs_from = fabs(ends[i]) > 0.01 ? 0.5 : (double)NAN};
        engines[i].bodies = &bodies[i];
        engines[i].completed = true;
        snprintf(engines[i].family, sizeof engines[i].family, "%s", families[i]);
    }
    const pl_reference_verdict verdict = {
        .reference = &s.reference, .engines = engines, .engine_count = 3};
    return pl_reference_is_contradicted(&verdict, 0, NULL, NULL);
}

static bool contradicted(const char *const families[3], const double ends[3])
{
    return contradicted_beside(0, families, ends);
}

/* Engines at the scene's own step share the error of that step, or fall in the same way. */
static void test_a_confirmed_reference_is_not_contradicted(void **state)
{
    (void)state;
    const char *const other[3] = {"plumb", "ode", "bullet"};
    assert_true(contradicted_beside(0, other, (double[3]){0, 1, 1}));
    assert_false(contradicted_beside(1, other, (double[3]){0, 1, 1}));
}

static void test_two_other_families_contradict_the_reference(void **state)
{
    (void)state;
    const char *const other[3] = {"plumb", "ode", "bullet"};
    const char *const kin[3] = {"plumb", "mujoco", "mujoco"};
    const char *const own[3] = {"plumb", "plumb", "bullet"};
    assert_true(contradicted(other, (double[3]){0, 12, 12.3}));
    assert_true(contradicted(other, (double[3]){0, 0.02, 0.029}));
    assert_false(contradicted(other, (double[3]){0, 12, 5}));
    assert_false(contradicted(other, (double[3]){0, 12, -12}));
    assert_false(contradicted(other, (double[3]){0, 12, 0.001}));
    assert_false(contradicted(kin, (double[3]){0, 12, 12}));
    assert_false(contradicted(own, (double[3]){0, 12, 12}));
}

static void assert_same_family(const char *one, const char *other, bool expected)
{
    char families[2][PL_FAMILY_SIZE];
    pl_engine_family(one, families[0]);
    pl_engine_family(other, families[1]);
    if ((strcmp(families[0], families[1]) == 0) != expected) {
        fail_msg("%s is of %s, %s of %s", one, families[0], other, families[1]);
    }
}

/* Of each other engine the name is all that is known: two builds of one are called alike. */
static void test_engines_that_share_code_are_one_family(void **state)
{
    (void)state;
    assert_same_family("mujoco", "mujoco3", true);
    assert_same_family("rapier", "rapier-deterministic", true);
    assert_same_family("ode", "dart", true);
    assert_same_family("mine", "mine-2", true);
    assert_same_family("ode", "bullet", false);
    assert_same_family("plumb", "bullet", false);
    assert_same_family("jolt", "physx", false);
    assert_same_family("mine", "jolt", false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_body_that_comes_back_has_strayed),
        cmocka_unit_test(test_a_confirmed_reference_is_not_contradicted),
        cmocka_unit_test(test_two_other_families_contradict_the_reference),
        cmocka_unit_test(test_engines_that_share_code_are_one_family),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
