/* The suites of reported symptoms: what each scene cites, and its right answer by another way than the
 * builder's: energy balances, sums of steps and turning bodies integrated here. */
#include "check.h"
#include "scenario_scene.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double g = 9.81; /* m/s^2 */

/* ---- What is cited ---- */

/* Whether the text is "OWNER/NAME#NUMBER, ...". */
static bool names_threads(const char *text)
{
    while (*text != '\0') {
        const size_t owner = strcspn(text, "/,# "), name = strcspn(text + owner, "#, ");
        const char *number = text + owner + name;
        if (owner == 0 || text[owner] != '/' || name < 2 || *number++ != '#' || !isdigit(*number)) {
            return false;
        }
        number += strspn(number, "0123456789");
        if (*number != '\0' && strncmp(number, ", ", 2) != 0) {
            return false;
        }
        text = *number == '\0' ? number : number + 2;
    }
    return true;
}

static bool is_in_suite(const pl_suite *suite, const char *scenario)
{
    bool found = false;
    for (int i = 0; i < suite->entry_count; ++i) {
        found = found || strcmp(suite->entries[i].scenario, scenario) == 0;
    }
    return found;
}

static void test_reported_scenarios_have_symptoms_and_threads(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    const pl_suite *suite = pl_suite_find("reported", NULL);
    assert_non_null(suite);
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        const bool reported = s->symptom != NULL && s->threads != NULL;
        if (is_in_suite(suite, s->name) != reported ||
            (reported && (strlen(s->symptom) < 10 || !names_threads(s->threads)))) {
            fail_msg("%s: symptom \"%s\", threads \"%s\"", s->name,
                     s->symptom == NULL ? "" : s->symptom, s->threads == NULL ? "" : s->threads);
        }
    }
}

/* ---- Values ---- */

static int body_named(const pl_scene *scene, const char *name)
{
    for (int i = 0; i < scene->body_count; ++i) {
        if (strcmp(scene->bodies[i].name, name) == 0) {
            return i;
        }
    }
    fail_msg("there is no body %s", name);
    return -1;
}

/* The value of the body's first expectation of this quantity. */
static const pl_expect_value *first_value(const pl_scene *scene, int body, pl_quantity quantity)
{
    for (int i = 0; i < scene->value_count; ++i) {
        if (scene->values[i].body == body && scene->values[i].quantity == quantity) {
            return &scene->values[i];
        }
    }
    fail_msg("body %d has no such value", body);
    return NULL;
}

/* A tolerance and the scene's acceptance say the same of each value, so that the primary error and the
 * verdict agree. */
static void test_tolerances_of_values_are_the_acceptance(void **state)
{
    (void)state;
    static const char *const names[] = {"drop-coefficients", "ramp-grid",    "fast-marble",
                                        "flipping-box",      "tumbling-box", "no-rebound"};
    for (size_t n = 0; n < sizeof names / sizeof *names; ++n) {
        pl_scene scene = scenario_scene(names[n], NULL);
        for (int i = 0; i < scene.value_count; ++i) {
            const pl_expect_value *value = &scene.values[i];
            assert_true(value->tolerance > 0);
            assert_close(value->scale * scene.acceptance, value->tolerance, 0, 1e-15);
        }
        pl_scene_free(&scene);
    }
}

/* The energy after an impact is e^2 of that before it. */
static void test_first_apex_has_the_energy_after_impact(void **state)
{
    (void)state;
    static const double restitutions[] = {0.3, 0.5, 0.8, 0.95};
    pl_scene scene = scenario_scene("drop-coefficients", NULL);
    for (int i = 0; i < 4; ++i) {
        char name[PL_NAME_SIZE];
        snprintf(name, sizeof name, "e %g", restitutions[i]);
        const int ball = body_named(&scene, name);
        double friction, e;
        pl_scene_pair(&scene, scene.bodies[0].material, scene.bodies[ball].material, &friction, &e);
        assert_close(e, restitutions[i], 0, 0);
        const double speed = e * sqrt(2 * g * 2), rise = speed * speed / 2 / g;
        assert_close(first_value(&scene, ball, PL_QUANTITY_APEX)->value, rise - 2, 1e-12, 0);
    }
    pl_scene_free(&scene);
}

static void test_late_apexes_have_the_energy_after_impacts(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("late-bounces", NULL);
    double speed = sqrt(2 * g * 2);
    int found = 0;
    for (int i = 0; i < scene.value_count; ++i) {
        const pl_expect_value *value = &scene.values[i];
        if (value->quantity == PL_QUANTITY_APEX) {
            speed *= 0.5;
            found += 1;
            assert_close(value->number, found, 0, 0);
            assert_close(value->value, speed * speed / 2 / g - 2, 1e-12, 0);
        }
    }
    assert_int_equal(found, 3);
    pl_scene_free(&scene);
}

/* Friction takes mu m g from m a in many small steps of time. */
static double slide(double v, double braking, double time)
{
    const double h = 1e-6;
    double x = 0;
    for (double t = 0; t < time && v > 0; t += h) {
        x += h * (v - braking * h / 2);
        v -= braking * h;
    }
    return x;
}

static void test_stops_are_where_summed_steps_end(void **state)
{
    (void)state;
    static const double frictions[] = {0.2, 0.4, 0.7};
    pl_scene scene = scenario_scene("stopping-distances", NULL);
    for (int i = 0; i < 3; ++i) {
        char name[PL_NAME_SIZE];
        snprintf(name, sizeof name, "cube %g", frictions[i]);
        const pl_expect_value *value =
            first_value(&scene, body_named(&scene, name), PL_QUANTITY_POSITION);
        assert_close(value->value, slide(2, frictions[i] * g, 2), 1e-5, 0);
    }
    pl_scene_free(&scene);
}

/* A slab moves iff its weight along the ramp exceeds the friction of its weight across. */
static void test_ramps_hold_below_the_angle_of_friction(void **state)
{
    (void)state;
    static const double degrees[] = {3, 10, 20, 30, 40}, friction[] = {0.1, 0.3, 0.5, 0.7, 1};
    pl_scene scene = scenario_scene("ramp-grid", NULL);
    int held = 0;
    for (int i = 0; i < 25; ++i) {
        char name[PL_NAME_SIZE];
        const double angle = degrees[i % 5] * acos(-1) / 180, mu = friction[i / 5];
        snprintf(name, sizeof name, "friction %g at %g deg", mu, degrees[i % 5]);
        const pl_expect_value *value =
            first_value(&scene, body_named(&scene, name), PL_QUANTITY_POSITION);
        const double slip = sin(angle) - mu * cos(angle), t = value->until;
        held += value->value == 0;
        assert_close(value->value, slip > 0 ? g * slip * t * t / 2 : 0, 1e-12, 1e-12);
    }
    assert_int_equal(held, 15);
    pl_scene_free(&scene);
}

/* The lowest point of the tilted cylinder is under its place upright, and on the box. */
static void test_upright_cylinder_turns_about_its_lowest_point(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("upright-cylinder", NULL);
    const pl_body *body = &scene.bodies[1];
    const double tilt = 2 * asin(body->orientation[2]), r = 0.1, half = 0.2;
    double low[2] = {0, 1}; /* x, z */
    for (int i = 0; i < 2; ++i) {
        const double side = i == 0 ? -r : r;
        const double x = body->position[0] + side * cos(tilt) - half * sin(tilt);
        const double z = body->position[2] - side * sin(tilt) - half * cos(tilt);
        if (z < low[1]) {
            low[0] = x, low[1] = z;
        }
    }
    assert_close(tilt, 0.00776, 1e-12, 0);
    assert_close(low[1], 0.1, 1e-12, 0);
    assert_close(scene.rests[0].position[0] + r, low[0], 1e-12, 0);
    assert_close(scene.rests[0].position[0], -0.001555, 1e-6, 0);
    pl_scene_free(&scene);
}

/* ---- Free rotation ---- */

/* Euler's equations of the angular momentum in the body's axes: L' = L x w. */
static void momentum_rate(const void *context, double t, const double *y, double *rate)
{
    const double *inertia = context;
    (void)t;
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        rate[k] = y[i] * y[j] / inertia[j] - y[j] * y[i] / inertia[i];
    }
}

static void test_flips_repeat_after_the_elliptic_period(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("flipping-box", NULL);
    const pl_body *box = &scene.bodies[0];
    const double period = first_value(&scene, 0, PL_QUANTITY_PERIOD)->value;
    double y[3], start[3];
    for (int k = 0; k < 3; ++k) {
        y[k] = start[k] = box->inertia[k] * box->angular_velocity[k];
    }
    integrate(momentum_rate, box->inertia, 0, period / 2, 20000, 3, y);
    assert_close(y[1], -start[1], 1e-6, 0); /* half of it is a flip */
    integrate(momentum_rate, box->inertia, period / 2, period, 20000, 3, y);
    for (int k = 0; k < 3; ++k) {
        assert_close(y[k], start[k], 1e-6, 0);
    }
    assert_close(period, 6.05684, 1e-5, 0);
    assert_close(first_value(&scene, 0, PL_QUANTITY_ENERGY)->value, 8.546417, 1e-6, 0);
    pl_scene_free(&scene);
}

/* In the body's axes the momentum has turned; the spin there has the size of that in the world. */
static void test_tumbling_spin_has_the_integrated_size(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("tumbling-box", NULL);
    const pl_body *box = &scene.bodies[0];
    double y[3], size = 0, expected = 0, momentum[3];
    for (int k = 0; k < 3; ++k) {
        y[k] = momentum[k] = box->inertia[k] * box->angular_velocity[k];
    }
    integrate(momentum_rate, box->inertia, 0, 10, 40000, 3, y);
    double energy = 0, along = 0;
    for (int k = 0; k < 3; ++k) {
        const double spin = expected_value(&scene, 0, PL_QUANTITY_SPIN, k)->value;
        size += y[k] * y[k] / box->inertia[k] / box->inertia[k];
        energy += y[k] * y[k] / box->inertia[k];
        expected += spin * spin;
        along += momentum[k] * spin; /* 2 E = L . w in any axes */
    }
    assert_close(expected, size, 1e-7, 0);
    assert_close(along, energy, 1e-7, 0);
    assert_close(expected_value(&scene, 0, PL_QUANTITY_POSITION, 2)->value, -410, 1e-9, 0);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reported_scenarios_have_symptoms_and_threads),
        cmocka_unit_test(test_tolerances_of_values_are_the_acceptance),
        cmocka_unit_test(test_first_apex_has_the_energy_after_impact),
        cmocka_unit_test(test_late_apexes_have_the_energy_after_impacts),
        cmocka_unit_test(test_stops_are_where_summed_steps_end),
        cmocka_unit_test(test_ramps_hold_below_the_angle_of_friction),
        cmocka_unit_test(test_upright_cylinder_turns_about_its_lowest_point),
        cmocka_unit_test(test_flips_repeat_after_the_elliptic_period),
        cmocka_unit_test(test_tumbling_spin_has_the_integrated_size),
    };
    return cmocka_run_group_tests_name("catalogue_reported", tests, NULL, NULL);
}
