/* The critical values of scenarios at rest, against a limit analysis of their scenes by linear
 * programming, which knows none of the formulas; and that these scenes are what they say. */
#include "check.h"
#include "plumb/scenario.h"
#include "statics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const pl_scenario *find(const char *name)
{
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    assert_non_null(scenario);
    return scenario;
}

static int param_of(const pl_scenario *scenario, const char *name)
{
    for (int i = 0; i < scenario->param_count; ++i) {
        if (strcmp(scenario->params[i].name, name) == 0) {
            return i;
        }
    }
    fail_msg("%s has no parameter %s", scenario->name, name);
    return -1;
}

static void build(const pl_scenario *scenario, const double *values, pl_scene *scene)
{
    pl_error error = {.message = ""};
    if (pl_scenario_build(scenario, values, 0, scene, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
}

/* Builds the scene of the defaults and these settings, and returns the values it has. */
static void build_with(const pl_scenario *scenario, const char *const *settings, int count,
                       double *values, pl_scene *scene)
{
    assert_int_equal(pl_scenario_values(scenario, settings, count, values, NULL), PL_OK);
    build(scenario, values, scene);
}

static bool balanced_at(const pl_scenario *scenario, double *values, double value)
{
    pl_scene scene;
    values[param_of(scenario, scenario->threshold->param)] = value;
    build(scenario, values, &scene);
    bool balanced = is_in_balance(&scene);
    pl_scene_free(&scene);
    return balanced;
}

/* Bisects where the scene's own contacts stop to carry it. */
static double limit_of(const pl_scenario *scenario, double *values)
{
    const pl_threshold *t = scenario->threshold;
    double low = t->low, high = t->high;
    if (balanced_at(scenario, values, low) != t->holds_below ||
        balanced_at(scenario, values, high) == t->holds_below) {
        fail_msg("%s: the limit of balance is not between %g and %g", scenario->name, low, high);
    }
    while (high - low > 1e-9 * high) {
        const double middle = low + (high - low) / 2;
        *(balanced_at(scenario, values, middle) == t->holds_below ? &low : &high) = middle;
    }
    return low + (high - low) / 2;
}

typedef struct limit_case {
    const char *scenario, *settings[2];
} limit_case;

static void test_closed_forms_are_the_limits_of_balance(void **state)
{
    (void)state;
    static const limit_case cases[] = {
        {"slope-threshold", {"friction=0.5", NULL}},
        {"slope-threshold", {"friction=1.5", NULL}},
        {"slope-tip", {"friction=1", NULL}},
        {"slope-tip", {"friction=0.3", NULL}},
        {"slope-tip", {"friction=0.9", "slenderness=0.8"}},
        {"ladder", {"friction=0.5", NULL}},
        {"ladder", {"friction=1.7", "thickness=0.05"}},
        {"ladder", {"friction=0.1", "thickness=0.001"}},
        {"overhang", {"n=1", NULL}},
        {"overhang", {"n=5", NULL}},
        {"overhang", {"n=20", NULL}},
        {"cylinder-pyramid", {NULL, NULL}},
        {"cylinder-pyramid", {"floor_friction=0.0894", NULL}},
        {"arch", {"n=5", NULL}},
        {"arch", {"n=12", NULL}},
        {"arch", {"n=20", NULL}},
        {"arch", {"n=21", NULL}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const limit_case *c = &cases[i];
        const pl_scenario *scenario = find(c->scenario);
        const int count = c->settings[0] == NULL ? 0 : c->settings[1] == NULL ? 1 : 2;
        double values[PL_MAX_PARAMS];
        assert_int_equal(pl_scenario_values(scenario, c->settings, count, values, NULL), PL_OK);
        const double critical = scenario->threshold->critical(values);
        const double limit = limit_of(scenario, values);
        if (!(fabs(limit - critical) < 1e-7 * critical)) {
            fail_msg("%s %s: closed form %.12g, limit of balance %.12g", c->scenario,
                     count > 0 ? c->settings[0] : "", critical, limit);
        }
    }
}

/* What the floor must hold, when there is friction enough between the bodies. */
static void test_cylinders_need_a_third_friction_on_the_floor(void **state)
{
    (void)state;
    const pl_scenario *scenario = find("cylinder-pyramid");
    double values[PL_MAX_PARAMS], low = 0, high = 1;
    const int floor_friction = param_of(scenario, "floor_friction");
    assert_int_equal(pl_scenario_values(scenario, NULL, 0, values, NULL), PL_OK);
    while (high - low > 1e-10) {
        values[floor_friction] = low + (high - low) / 2;
        *(balanced_at(scenario, values, 0.5) ? &high : &low) = values[floor_friction];
    }
    assert_close(low, (2 - sqrt(3)) / 3, 0, 1e-8);
    values[floor_friction] = 0.0893;
    assert_true(isnan(scenario->threshold->critical(values)));
}

/* Of many voussoirs the limit is that of the continuous arch with radial joints, 0.1075
 * (Milankovitch 1907); its further digits are found in test_catalogue_rest.c. */
static void test_arch_of_many_voussoirs_reaches_continuous_limit(void **state)
{
    (void)state;
    const pl_scenario *scenario = find("arch");
    double values[PL_MAX_PARAMS], before = 1;
    static const char *const settings[] = {"n=20", "n=40", "n=80", "n=200"};
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(pl_scenario_values(scenario, &settings[i], 1, values, NULL), PL_OK);
        const double off = fabs(scenario->threshold->critical(values) - 0.107478);
        assert_true(off < before);
        before = off;
    }
    assert_true(before < 2e-5);
}

/* ---- Spheres ---- */

enum { SPHERES = 4, GENERATORS = 12, SPHERE_ROWS = 6 * SPHERES, SPHERE_COLUMNS = 9 * GENERATORS };

typedef struct sphere_problem {
    double a[SPHERE_ROWS * SPHERE_COLUMNS], b[SPHERE_ROWS];
    int columns;
} sphere_problem;

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; ++k) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        c[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static void put_column(sphere_problem *p, int sphere, const double arm[3], const double f[3],
                       double sign)
{
    double moment[3];
    cross(arm, f, moment);
    for (int k = 0; k < 3; ++k) {
        p->a[(6 * sphere + k) * SPHERE_COLUMNS + p->columns] = sign * f[k];
        p->a[(6 * sphere + 3 + k) * SPHERE_COLUMNS + p->columns] = sign * moment[k];
    }
}

/* A contact on sphere b, whose normal points to it from sphere a (-1: the floor), of radius 1/2.
 * The cone is replaced by generators on it, one of them straight up along the contact: less than
 * the cone, but as much in the planes of symmetry. */
static void put_cone(sphere_problem *p, int a, int b, const double normal[3], double friction,
                     const double outward[3])
{
    double across[3], along[3], arm_b[3], arm_a[3];
    const double *hint = a < 0 ? outward : (const double[]){0, 0, 1};
    cross(normal, hint, across);
    const double size = sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
    for (int k = 0; k < 3; ++k) {
        across[k] /= size;
        arm_b[k] = -normal[k] / 2;
        arm_a[k] = normal[k] / 2;
    }
    cross(across, normal, along);
    for (int g = 0; g < GENERATORS; ++g) {
        const double turn = 2 * 3.1415926535897931 * g / GENERATORS;
        double f[3];
        for (int k = 0; k < 3; ++k) {
            f[k] = normal[k] + friction * (cos(turn) * along[k] + sin(turn) * across[k]);
        }
        put_column(p, b, arm_b, f, 1);
        if (a >= 0) {
            put_column(p, a, arm_a, f, -1);
        }
        ++p->columns;
    }
}

static bool spheres_balanced(const pl_scene *scene, double friction, double floor_friction)
{
    static sphere_problem p;
    p = (sphere_problem){.columns = 0};
    const pl_body *s = &scene->bodies[1];
    for (int i = 0; i < SPHERES; ++i) {
        const double up[3] = {0, 0, 1};
        p.b[6 * i + 2] = 9.81;
        if (s[i].position[2] < 0.51) {
            put_cone(&p, -1, i, up, floor_friction, s[i].position);
        }
        for (int k = 0; k < i; ++k) {
            double normal[3];
            for (int d = 0; d < 3; ++d) {
                normal[d] = s[i].position[d] - s[k].position[d];
            }
            /* The radius is 1/2, so centres of spheres that touch are 1 m apart. */
            const double square =
                normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
            assert_close(square, 1, 0, 1e-14);
            put_cone(&p, k, i, normal, friction, up);
        }
    }
    assert_int_equal(p.columns, SPHERE_COLUMNS);
    return has_nonnegative_solution(p.a, p.b, SPHERE_ROWS, SPHERE_COLUMNS);
}

static void test_spheres_need_a_quarter_friction_on_the_floor(void **state)
{
    (void)state;
    const pl_scenario *scenario = find("sphere-pyramid");
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    build_with(scenario, NULL, 0, values, &scene);
    double limit[2];
    for (int of_floor = 0; of_floor < 2; ++of_floor) {
        double low = 0, high = 1;
        while (high - low > 1e-10) {
            const double middle = low + (high - low) / 2;
            const bool balanced = of_floor ? spheres_balanced(&scene, 1, middle)
                                           : spheres_balanced(&scene, middle, 1);
            *(balanced ? &high : &low) = middle;
        }
        limit[of_floor] = low;
    }
    assert_close(limit[0], scenario->threshold->critical(values), 0, 1e-7);
    assert_close(limit[1], limit[0] / 4, 0, 1e-7);
    values[param_of(scenario, "floor_friction")] = 0.0794;
    assert_true(isnan(scenario->threshold->critical(values)));
    pl_scene_free(&scene);
}

/* ---- What else is said of the scenes ---- */

/* Inconsistent where a normal force at the lower end moves that end down: by Newton's and Euler's
 * laws on the scene's own rod, at the least friction over a dense search of angles. */
static void test_painleve_begins_at_four_thirds(void **state)
{
    (void)state;
    const pl_scenario *scenario = find("painleve");
    double values[PL_MAX_PARAMS], least = HUGE_VAL, worst = 0;
    assert_int_equal(pl_scenario_values(scenario, NULL, 0, values, NULL), PL_OK);
    for (double angle = 30; angle < 85; angle += 0.01) {
        pl_scene scene;
        values[param_of(scenario, "angle")] = angle;
        build(scenario, values, &scene);
        const pl_body *rod = &scene.bodies[1];
        const double *q = rod->orientation, *h = rod->shape.half_extents;
        /* The leading end of the underside, relative to the centre. */
        const double c = q[0] * q[0] - q[2] * q[2], s = 2 * q[0] * q[2];
        const double x = c * h[0] - s * h[2], z = -s * h[0] - c * h[2];
        assert_close(rod->position[2] + z, 0, 1e-15, 0);
        assert_true(rod->velocity[0] > 0 && x > 0);
        /* Upward acceleration of the end for N = 1, friction f against the slip: 1/m + x (x + z f)
         * / I; zero at: */
        const double inertia = rod->inertia[1];
        const double friction = -(1 / rod->mass + x * x / inertia) * inertia / (x * z);
        worst = friction < least ? angle : worst;
        least = fmin(least, friction);
        pl_scene_free(&scene);
    }
    /* The rod's thickness is 1 % of its length. */
    assert_close(least, 4.0 / 3, 0, 0.02);
    assert_close(tan(worst * 3.1415926535897931 / 180), 2, 0, 0.03);
}

static double top_of(const pl_body *body)
{
    return body->position[2] + body->shape.half_extents[2];
}

static void test_the_overhang_is_the_harmonic_sum(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=30", "factor=1"};
    const pl_scenario *scenario = find("overhang");
    double values[PL_MAX_PARAMS], sum = 0;
    pl_scene scene;
    build_with(scenario, settings, 2, values, &scene);
    for (int k = 1; k <= 30; ++k) {
        sum += 0.5 / k;
    }
    const pl_body *top = &scene.bodies[30];
    assert_close(top->position[0] + top->shape.half_extents[0], sum, 0, 1e-14);
    pl_scene_free(&scene);
}

/* Every cube overlaps the one below by what is asked, and belongs just on it. */
static void test_overlapping_cubes_belong_on_each_other(void **state)
{
    (void)state;
    const pl_scenario *scenario = find("initial-overlap");
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    build_with(scenario, NULL, 0, values, &scene);
    double below = 0;
    for (int i = 1; i < scene.body_count; ++i) {
        const pl_body *cube = &scene.bodies[i];
        assert_close(below - (cube->position[2] - cube->shape.half_extents[2]), 0.01, 0, 1e-12);
        assert_close(scene.rests[i - 1].position[2], i - 0.5, 0, 0);
        below = top_of(cube);
    }
    pl_scene_free(&scene);
}

/* Half the height of a box that is turned about y. */
static double half_rise(const pl_body *box)
{
    const double *q = box->orientation, *h = box->shape.half_extents;
    return fabs(2 * q[0] * q[2]) * h[0] + fabs(q[0] * q[0] - q[2] * q[2]) * h[2];
}

/* Every leaning card stands on the ground of its row and bears the level card, just so. The level
 * card ends 0.1 m beyond the middles of the outermost pairs. */
static void test_cards_touch_level_cards_exactly(void **state)
{
    (void)state;
    pl_scene scene;
    double values[PL_MAX_PARAMS], ground = 0;
    build_with(find("card-house"), NULL, 0, values, &scene);
    for (int row = 1; row <= 3; ++row) {
        double top = (double)NAN, next = (double)NAN, first = HUGE_VAL, last = -HUGE_VAL;
        int leaning = 0, level = 0;
        for (int i = 1; i < scene.body_count; ++i) {
            const pl_body *card = &scene.bodies[i];
            const double low = card->position[2] - half_rise(card);
            const double high = card->position[2] + half_rise(card);
            int of_row = 0;
            if (sscanf(card->name, "level %d", &of_row) == 1 && of_row == row) {
                assert_close(low, top, 1e-14, 0);
                next = high;
                level = i;
            } else if ((sscanf(card->name, "left %d", &of_row) == 1 ||
                        sscanf(card->name, "right %d", &of_row) == 1) &&
                       of_row == row) {
                assert_close(low, ground, 1e-14, 0);
                top = high;
                leaning += 1;
                if (card->name[0] == 'l') {
                    first = fmin(first, card->position[0]);
                    last = fmax(last, card->position[0]);
                }
            }
        }
        if (row < 3) {
            const double *half = scene.bodies[level].shape.half_extents;
            assert_close(half[0], (last - first) / 2 + 0.1, 1e-14, 0);
        }
        assert_int_equal(leaning, 2 * (4 - row));
        ground = next;
    }
    pl_scene_free(&scene);
}

/* The hard scenes in the plane stand by statics as they are built. */
static void test_stacks_and_houses_are_balanced(void **state)
{
    (void)state;
    static const limit_case cases[] = {{"card-house", {"friction=0.5", "storeys=2"}},
                                       {"card-house", {"friction=0.5", "storeys=3"}},
                                       {"pyramid", {"n=5", "gap=0.125"}},
                                       {"pyramid", {"n=4", "friction=0"}},
                                       {"arch", {"n=20", "friction=2"}}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const pl_scenario *scenario = find(cases[i].scenario);
        double values[PL_MAX_PARAMS];
        pl_scene scene;
        build_with(scenario, cases[i].settings, 2, values, &scene);
        assert_true(is_in_balance(&scene));
        pl_scene_free(&scene);
    }
}

/* The friction that the catalogue states of houses. */
static void test_houses_of_cards_need_the_stated_friction(void **state)
{
    (void)state;
    static const struct {
        const char *setting;
        double friction;
    } cases[] = {{"storeys=1", 0.171985}, {"storeys=2", 0.244929}, {"storeys=3", 0.269143}};
    for (int i = 0; i < 3; ++i) {
        double values[PL_MAX_PARAMS];
        const pl_scenario *scenario = find("card-house");
        assert_int_equal(pl_scenario_values(scenario, &cases[i].setting, 1, values, NULL), PL_OK);
        const double limit = limit_of(scenario, values);
        if (!(fabs(limit - cases[i].friction) < 1e-6)) {
            fail_msg("%s: %.9g", cases[i].setting, limit);
        }
    }
}

static void test_hard_scenes_describe_the_provoked_fault(void **state)
{
    (void)state;
    const pl_suite *suite = pl_suite_find("hard", NULL);
    assert_non_null(suite);
    for (int i = 0; i < suite->entry_count; ++i) {
        const char *provokes = find(suite->entries[i].scenario)->provokes;
        if (provokes == NULL || strstr(provokes, "right engine") == NULL) {
            fail_msg("%s: what does it provoke, and what does a right engine do?",
                     suite->entries[i].scenario);
        }
    }
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        const pl_threshold *t = scenarios[i]->threshold;
        if (t != NULL) {
            const pl_param *param = &scenarios[i]->params[param_of(scenarios[i], t->param)];
            assert_true(param->min <= t->low && t->low < t->high && t->high <= param->max);
            assert_true(t->tolerance > 0 && (t->critical == NULL) == (t->formula == NULL));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms_are_the_limits_of_balance),
        cmocka_unit_test(test_cylinders_need_a_third_friction_on_the_floor),
        cmocka_unit_test(test_arch_of_many_voussoirs_reaches_continuous_limit),
        cmocka_unit_test(test_spheres_need_a_quarter_friction_on_the_floor),
        cmocka_unit_test(test_painleve_begins_at_four_thirds),
        cmocka_unit_test(test_the_overhang_is_the_harmonic_sum),
        cmocka_unit_test(test_overlapping_cubes_belong_on_each_other),
        cmocka_unit_test(test_cards_touch_level_cards_exactly),
        cmocka_unit_test(test_stacks_and_houses_are_balanced),
        cmocka_unit_test(test_houses_of_cards_need_the_stated_friction),
        cmocka_unit_test(test_hard_scenes_describe_the_provoked_fault),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
