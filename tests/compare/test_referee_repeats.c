/* A step that repeats the last one counts as any other. Runs whose steps repeat are compared with runs of
 * the same physics whose contacts change their order of bodies at every step. */
#include "check.h"
#include "referee/metrics/mechanics.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

static const double weight = 2 * 9.81; /* N */

enum { FLOOR, BOX, CORNERS = 4, STEPS = 48, ORDERS = 2 };

/* The corners of a box at the origin bear `share` of its weight; every other step may have A and B swapped. */
static void corners(pl_contact out[CORNERS], double share, bool swapped)
{
    const double sign = swapped ? -1 : 1;
    for (int i = 0; i < CORNERS; ++i) {
        out[i] = (pl_contact){.body_a = swapped ? BOX : FLOOR,
                              .body_b = swapped ? FLOOR : BOX,
                              .point = {i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, 0},
                              .normal = {0, 0, sign},
                              .impulse = {0, 0, sign * share * weight * H / CORNERS}};
    }
}

/* A box that stands still. A force lifts it from the middle of the run on. `share` of its weight is what
 * the contacts bear, from step `change` on one half of that. */
static void stand(run *r, bool alternates, double lift, double share, int change)
{
    run_prepare_box_on_floor(r, STEPS * H);
    if (lift != 0) {
        const pl_force force = {
            .body = BOX, .force = {0, 0, lift}, .from = STEPS / 2 * H, .until = HUGE_VAL};
        assert_int_equal(pl_scene_add_force(&r->scene, &force, &r->error), PL_OK);
    }
    run_begin(r);
    for (int n = 0; n < STEPS; ++n) {
        pl_contact c[CORNERS];
        corners(c, n < change ? share : share / 2, alternates && n % 2 == 1);
        assert_int_equal(run_step_with(r, c, CORNERS), PL_ENDING_OK);
    }
    (void)run_finish(r);
}

static void assert_same(const run *a, const run *b)
{
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const pl_metric *x = run_metric(a, (pl_metric_id)id), *y = run_metric(b, (pl_metric_id)id);
        if (x->state != y->state) {
            fail_msg("%s: %s, %s", pl_metric_table[id].name, x->reason, y->reason);
        }
        if (x->state == PL_METRIC_VALUE) {
            assert_close(x->value, y->value, 1e-14 + 1e-13 * fabs(y->value), id);
        }
    }
}

static void test_repeated_steps_count_as_any_other(void **state)
{
    (void)state;
    static const double lifts[] = {0, 3}, shares[] = {1, 0.9, 0};
    static const int changes[] = {STEPS, 1, 2, 17};
    for (size_t i = 0; i < 2 * 3 * 4; ++i) {
        run r[ORDERS];
        for (int k = 0; k < ORDERS; ++k) {
            stand(&r[k], k == 1, lifts[i % 2], shares[i / 2 % 3], changes[i / 6]);
        }
        assert_same(&r[0], &r[1]);
        run_end(&r[0]);
        run_end(&r[1]);
    }
}

/* The contacts bear nine tenths of the weight for 17 steps, and then half of that: the momentum error adds up
 * what they do not bear. */
static void test_momentum_error_adds_up_repeated_steps(void **state)
{
    (void)state;
    const int change = 17;
    run r;
    stand(&r, false, 0, 0.9, change);
    const pl_scale scale = pl_scale_of(&r.scene);
    const double missing = weight * H * (0.1 * change + 0.55 * (STEPS - change));
    assert_close(run_value(&r, PL_METRIC_MOMENTUM_ERROR), missing / scale.momentum, 1e-13, 0);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0.55, 1e-14, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_FORCE_BALANCE)->worst_step, change + 1);
    run_end(&r);
}

/* The box moves by a millimetre in one step in the middle of its rest, and sinks into the floor. */
static void test_step_between_repeated_ones_counts(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, STEPS * H);
    run_begin(&r);
    for (int n = 0; n < STEPS; ++n) {
        pl_contact c[CORNERS];
        corners(c, 1, false);
        r.state[BOX].position[2] = n < 20 ? 0.5 : 0.499;
        assert_int_equal(run_step_with(&r, c, CORNERS), PL_ENDING_OK);
    }
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 1e-3, 1e-15, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_PENETRATION_MAX)->worst_step, 21);
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_repeated_steps_count_as_any_other),
        cmocka_unit_test(test_momentum_error_adds_up_repeated_steps),
        cmocka_unit_test(test_step_between_repeated_ones_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
