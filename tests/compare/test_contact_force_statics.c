/* Statics by the contact forces that engines report: the load at each joint of a stack. */
#include "referee/metrics/modules.h"

#include "check.h"
#include "plumb/scenario.h"
#include "run_result.h"
#include "runner/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An engine in a scene of the catalogue, and the contacts of its last step. */
typedef struct stand {
    pl_scene scene;
    pl_engine_choice choice;
    pl_session session;
    pl_frame frame;
    pl_body_state *before; /* of the last step */
    pl_contact *contacts;
    int count, capacity;
    pl_arena arena;
    pl_run_view view;
    void *force; /* the state of pl_contact_force_module */
    long steps;
} stand;

static bool has_engine(const char *spec)
{
    pl_engine_choice choice;
    return pl_engine_choose(spec, &choice, NULL) == PL_OK;
}

/* `stand` must stay where it is: the engine borrows its scene. */
static void stand_begin(stand *s, const char *scenario, const char *const *settings, int count,
                        const char *spec)
{
    *s = (stand){.steps = 0};
    double values[PL_MAX_PARAMS];
    const pl_scenario *found = pl_scenario_find(scenario, NULL);
    assert_non_null(found);
    assert_int_equal(pl_scenario_values(found, settings, count, values, NULL), PL_OK);
    assert_int_equal(pl_scenario_build(found, values, 0, &s->scene, NULL), PL_OK);
    assert_int_equal(pl_engine_choose(spec, &s->choice, NULL), PL_OK);
    s->frame.body_count = s->scene.body_count;
    s->frame.bodies = calloc((size_t)s->scene.body_count, sizeof *s->frame.bodies);
    s->before = calloc((size_t)s->scene.body_count, sizeof *s->before);
    s->capacity = 64 * s->scene.body_count;
    s->contacts = calloc((size_t)s->capacity, sizeof *s->contacts);
    s->view.scene = &s->scene;
    pl_make_series(&s->view, &s->arena);
    s->force = pl_contact_force_module.create(&s->view, &s->arena);
    assert_true(s->frame.bodies != NULL && s->before != NULL && s->contacts != NULL &&
                s->force != NULL);
    s->session = pl_session_begin(&s->choice);
    assert_int_equal(pl_session_load(&s->session, NULL), PL_OK);
    assert_int_equal(pl_session_create(&s->session, &s->scene, NULL), PL_OK);
    pl_session_read_frame(&s->session, &s->frame);
}

static void stand_step(stand *s)
{
    pl_step_stats stats;
    memcpy(s->before, s->frame.bodies, (size_t)s->scene.body_count * sizeof *s->before);
    assert_int_equal(pl_session_step(&s->session, &stats, NULL, NULL), PL_OK);
    pl_session_read_frame(&s->session, &s->frame);
    assert_int_equal(
        pl_session_read_contacts(&s->session, &s->contacts, &s->capacity, &s->count, NULL), PL_OK);
    s->steps += 1;
    s->view.step = (pl_step){.number = s->steps,
                             .before = s->before,
                             .after = s->frame.bodies,
                             .contacts = s->contacts,
                             .contact_count = s->count};
    pl_contact_force_module.see(s->force, &s->view);
}

/* Over all steps. The integrator does not matter, because no force turns. */
static double stand_balance(const stand *s)
{
    const pl_series *balance = &s->view.series[PL_METRIC_FORCE_BALANCE][PL_SEMI_IMPLICIT];
    assert_int_equal(balance->count, s->steps);
    return balance->max;
}

static void stand_end(stand *s)
{
    pl_session_end(&s->session);
    pl_arena_free(&s->arena);
    pl_scene_free(&s->scene);
    free(s->frame.bodies);
    free(s->before);
    free(s->contacts);
}

/* The force on body b of the contacts between a and b, mean over the last step: N, world frame. */
static pl_vec force_between(const stand *s, int a, int b)
{
    pl_vec sum = {0, 0, 0};
    for (int i = 0; i < s->count; ++i) {
        const pl_contact *c = &s->contacts[i];
        if ((c->body_a == a && c->body_b == b) || (c->body_a == b && c->body_b == a)) {
            sum = pl_vec_mad(sum, (c->body_b == b ? 1 : -1) / s->scene.dt, pl_vec_of(c->impulse));
        }
    }
    return sum;
}

enum { FLOOR = 0 };

static double weight_of(const stand *s, int from)
{
    double mass = 0;
    for (int i = from; i < s->scene.body_count; ++i) {
        mass += s->scene.bodies[i].is_static ? 0 : s->scene.bodies[i].mass;
    }
    return mass * -s->scene.gravity[2];
}

/* Bodies 1 .. n form a stack from the floor up: the joint under body i bears its weight and all
 * weight above. The largest error of a joint in units of its load; *sideways is that of the
 * horizontal part. */
static double ladder_error(const stand *s, double *sideways)
{
    double worst = 0;
    *sideways = 0;
    for (int i = 1; i < s->scene.body_count; ++i) {
        pl_vec f = force_between(s, i - 1, i);
        double due = weight_of(s, i);
        worst = fmax(worst, fabs(f.z / due - 1));
        *sideways = fmax(*sideways, hypot(f.x, f.y) / due);
    }
    return worst;
}

/* The total load of the floor in units of the weight, less 1. */
static double floor_error(const stand *s)
{
    double sum = 0;
    for (int i = 1; i < s->scene.body_count; ++i) {
        sum += force_between(s, FLOOR, i).z;
    }
    return sum / weight_of(s, 1) - 1;
}

/* The bound on the force balance of every engine: Newton's second law, by its own forces and
 * velocities. */
static const double balance = 1e-9;

static void test_tower_joint_force_is_the_weight_above(void **state)
{
    (void)state;
    const char *const towers[] = {"n=10", "top_mass=50"};
    for (int t = 0; t < 2; ++t) {
        stand s;
        stand_begin(&s, "tower", &towers[t], 1, "plumb:accurate");
        assert_int_equal(s.scene.body_count, 11);
        assert_true(s.scene.bodies[FLOOR].is_static);
        for (int n = 0; n < 120; ++n) {
            double sideways;
            stand_step(&s);
            assert_at_most(ladder_error(&s, &sideways), 1e-6);
            assert_at_most(sideways, 1e-6);
        }
        assert_at_most(stand_balance(&s), balance);
        stand_end(&s);
    }
}

static void test_floor_force_under_a_wall_is_its_weight(void **state)
{
    (void)state;
    const char *const small[] = {"rows=6", "columns=8"};
    stand s;
    stand_begin(&s, "wall", small, 2, "plumb:accurate");
    assert_true(s.scene.bodies[FLOOR].is_static);
    assert_close(weight_of(&s, 1), 6 * 8 * 9.81, 1e-10, 0);
    for (int n = 0; n < 120; ++n) {
        stand_step(&s);
        assert_close(floor_error(&s), 0, 1e-6, 0);
    }
    assert_at_most(stand_balance(&s), balance);
    stand_end(&s);
}

/* The errors of the loads of other engines are only printed, but their forces must account for the
 * motion. */
static void test_forces_of_all_engines_balance_the_motion(void **state)
{
    (void)state;
    const char *const engines[] = {"ode:quick", "bullet:si", "bullet:nncg"};
    const char *const scenarios[] = {"tower", "wall"};
    const char *const settings[] = {"n=10", "rows=6"};
    for (size_t i = 0; i < sizeof engines / sizeof engines[0]; ++i) {
        for (int k = 0; k < 2 && has_engine(engines[i]); ++k) {
            stand s;
            stand_begin(&s, scenarios[k], &settings[k], 1, engines[i]);
            double ladder = 0, sideways = 0, ground = 0;
            for (int n = 0; n < 60; ++n) {
                double aside;
                stand_step(&s);
                ladder = fmax(ladder, k == 0 ? ladder_error(&s, &aside) : 0);
                sideways = fmax(sideways, k == 0 ? aside : 0);
                ground = fmax(ground, fabs(floor_error(&s)));
            }
            print_message("    %s, %s, 1 s: floor off by %.1e of the weight", engines[i],
                          scenarios[k], ground);
            if (k == 0) {
                print_message("; a joint by %.1e, sideways %.1e", ladder, sideways);
            }
            print_message("\n");
            assert_at_most(stand_balance(&s), balance);
            stand_end(&s);
        }
    }
}

/* Spheres have the same inertia in every frame, so that the velocities of the frames are those that
 * the engine solved for. So the referee's natural map, computed from frames and reported impulses,
 * equals the engine's own residual, except for the effect of the energy guard. Time-of-impact
 * sub-steps are off: with them the velocities at the end of the step do not belong to the impulse
 * of the impact. */
static void test_natural_map_of_spheres_equals_the_reported_residual(void **state)
{
    (void)state;
    const char *const arguments[] = {
        "run",    "pile", "--engine",   "plumb:accurate,impact_bodies=0",
        "--set",  "n=20", "--set",      "shape=0",
        "--json", "-",    "--duration", "2",
        NULL};
    json_t *r = run_to_json(arguments);
    double reported = metric(r, "residual_max"), seen = metric(r, "natural_map");
    assert_true(reported > 1e-5);
    assert_close(seen, reported, 0, 0.02);
    assert_close(metric_percentile(r, "natural_map", "p95"),
                 metric_percentile(r, "residual_max", "p95"), 0, 0.05);
    json_decref(r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tower_joint_force_is_the_weight_above),
        cmocka_unit_test(test_floor_force_under_a_wall_is_its_weight),
        cmocka_unit_test(test_forces_of_all_engines_balance_the_motion),
        cmocka_unit_test(test_natural_map_of_spheres_equals_the_reported_residual),
    };
    return cmocka_run_group_tests_name("contact force statics", tests, NULL, NULL);
}
