/* The estimated error of converged references against the true one: catalogue scenes of which a closed
 * form knows where a body ends, and which the reference is not told. */
#include "check.h"
#include "plumb_process.h"
#include "studies/reference/converged_reference.h"

#include <math.h>
#include <stdlib.h>

typedef struct withheld {
    const char *scenario;
    const char *settings[3]; /* up to the first NULL */
} withheld;

/* Of each the path of a body ends at a position in closed form. In the first seven the error of the
 * engine is mostly above the floor; in the others it is rounding, and must not be taken for more. */
static const withheld scenes[] = {
    {"bowling", {NULL}},
    {"bowling", {"speed=8", NULL}},
    {"slide-and-spin", {NULL}},
    {"painleve", {"duration=0.2", NULL}},
    {"spinning-coin", {NULL}},
    {"slide-to-stop", {"dt=1/20", NULL}},
    {"slide-to-stop", {"azimuth=70", "speed=3", "friction=0.2"}},
    {"isotropy", {NULL}},
    {"carried-balls", {NULL}},
    {"projectile", {NULL}},
};
enum { SCENES = sizeof scenes / sizeof scenes[0] };

/* Adds the square of what a body's displacement lacks along an expected direction. */
static double missing(const double moved[3], const double direction[3], double expected)
{
    const double along =
        moved[0] * direction[0] + moved[1] * direction[1] + moved[2] * direction[2];
    return (along - expected) * (along - expected);
}

/* The distance of a body's end from its closed form, m; NAN where it has none. */
static double true_error(const pl_scene *known, int body, const double moved[3])
{
    double square = 0;
    bool any = false;
    for (int i = 0; i < known->travel_count; ++i) {
        const pl_expect_travel *t = &known->travels[i];
        if (t->body == body) {
            double lacks = 0;
            for (int k = 0; k < 3; ++k) {
                const double d = moved[k] - t->distance * t->direction[k];
                lacks += d * d;
            }
            square += lacks;
            any = true;
        }
    }
    for (int i = 0; i < known->value_count; ++i) {
        const pl_expect_value *v = &known->values[i];
        if (v->body == body && v->quantity == PL_QUANTITY_POSITION &&
            fabs(v->until - known->duration) < 1e-9) {
            square += missing(moved, v->direction, v->value);
            any = true;
        }
    }
    return any ? sqrt(square) : (double)NAN;
}

/* Adds the scene of a case as a file in `folder`, without anything expected. */
static void withhold(const pl_case *known, const char *folder, pl_plan *plan)
{
    pl_scene scene = known->scene;
    char *path = path_in(folder, "withheld.json");
    const pl_scenario *file = NULL;
    scene.rest_count = scene.travel_count = scene.value_count = scene.statistic_count = 0;
    scene.primary_error[0] = '\0';
    scene.acceptance = scene.collapse_distance = (double)INFINITY;
    char *text = pl_scene_to_text(&scene);
    write_text(path, text);
    assert_int_equal(pl_plan_open_file(plan, path, &file, NULL), PL_OK);
    assert_int_equal(pl_plan_add_scenario(plan, file, NULL, 0, NULL), PL_OK);
    assert_true(pl_reference_applies(&plan->cases[0]));
    free(text);
    free(path);
}

static int count_settings(const withheld *scene)
{
    int count = 0;
    while (count < 3 && scene->settings[count] != NULL) {
        ++count;
    }
    return count;
}

/* The largest estimate and the largest true error of all bodies with a closed form, at the end. */
static void compare(const withheld *scene, double *estimate, double *truth, double *floor)
{
    pl_plan known = {.repeats = 1}, plan = {.repeats = 1};
    const pl_scenario *scenario = pl_scenario_find(scene->scenario, NULL);
    pl_error error = {.message = ""};
    char *folder = make_directory();
    json_t *provenance = json_object();
    assert_non_null(scenario);
    const int count = count_settings(scene);
    assert_int_equal(pl_plan_add_scenario(&known, scenario, scene->settings, count, NULL), PL_OK);
    withhold(&known.cases[0], folder, &plan);
    pl_reference_work work = {.original = &plan.cases[0],
                              .execution = {.plan = &plan,
                                            .jobs = 2,
                                            .limits = {.timeout = 100},
                                            .positions = folder,
                                            .provenance = provenance},
                              .error = &error};
    pl_reference reference;
    pl_reference_make(&work, &reference);
    if (work.status != PL_OK) {
        fail_msg("%s", error.message);
    }
    assert_true(reference.known);
    const pl_body_paths *paths = pl_reference_paths(&reference);
    const size_t last = (size_t)(reference.samples - 1) * (size_t)reference.bodies;
    *estimate = *truth = 0;
    *floor = reference.floor;
    for (int b = 0; b < reference.bodies; ++b) {
        const double found = true_error(&known.cases[0].scene, reference.body[b],
                                        &paths->moved[3 * (last + (size_t)b)]);
        if (!isnan(found)) {
            *truth = fmax(*truth, found);
            *estimate = fmax(*estimate, reference.error[last + (size_t)b]);
        }
    }
    pl_reference_free(&reference);
    pl_plan_free(&plan);
    pl_plan_free(&known);
    json_decref(provenance);
    remove_directory(folder);
}

static void test_estimates_are_right_within_factor_three(void **state)
{
    (void)state;
    int above = 0;
    for (int i = 0; i < SCENES; ++i) {
        double estimate, truth, floor;
        compare(&scenes[i], &estimate, &truth, &floor);
        print_message("%s: estimated %.3g m, true %.3g m, floor %.3g m\n", scenes[i].scenario,
                      estimate, truth, floor);
        assert_at_most(estimate, 3 * fmax(truth, floor));
        assert_at_most(truth, 3 * fmax(estimate, floor));
        above += truth > floor;
    }
    /* Otherwise nothing but the floor would be tested. */
    assert_true(above >= 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_estimates_are_right_within_factor_three),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
