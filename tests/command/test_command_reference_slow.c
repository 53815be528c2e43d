/* plumb compare on scene files that expect nothing: what it says of the engines. The scenes are in
 * the folder reference. */
#include "check.h"
#include "engines/registry.h"
#include "plumb_process.h"

#include <stdlib.h>
#include <string.h>

#define SCENES PLUMB_SOURCE_DIR "/tests/command/reference/"

static bool is_built_in(const char *engine)
{
    pl_engine_choice choice;
    return pl_engine_choose(engine, &choice, NULL) == PL_OK;
}

/* Compares a scene on engines (up to a NULL), and returns DIR/reference.json, NULL where there is
 * none. `text` (NULL allowed) gets what was printed. */
static json_t *compare(const workspace *f, const char *scene, const char *const *more, char **text)
{
    const char *arguments[32] = {"compare", scene, "--out", f->out};
    int count = 4;
    for (; *more != NULL; ++more) {
        arguments[count++] = *more;
    }
    plumb_output output = run_plumb(f->directory, arguments);
    if (output.code != 0) {
        print_error("%s", output.err);
    }
    assert_int_equal(output.code, 0);
    if (text != NULL) {
        *text = strdup(output.out);
    }
    free_output(&output);
    char *path = path_in(f->out, "reference.json");
    json_t *reference = json_load_file(path, 0, NULL);
    free(path);
    return reference;
}

static const json_t *case_of(const json_t *reference)
{
    const json_t *cases = json_object_get(reference, "cases");
    assert_int_equal(json_array_size(cases), 1);
    return json_array_get(cases, 0);
}

/* Whether a sentence contains all of the parts (up to a NULL). */
static bool has_sentence(const json_t *reference, const char *const *parts)
{
    size_t index;
    const json_t *sentence;
    json_array_foreach(json_object_get(reference, "sentences"), index, sentence)
    {
        bool all = true;
        for (const char *const *part = parts; *part != NULL; ++part) {
            all = all && strstr(json_string_value(sentence), *part) != NULL;
        }
        if (all) {
            return true;
        }
    }
    return false;
}

#define SAYS(reference, ...) has_sentence(reference, (const char *const[]){__VA_ARGS__, NULL})

static void test_tower_knocked_over_by_bullet_is_named(void **state)
{
    if (!is_built_in("bullet") || !is_built_in("ode")) {
        skip();
    }
    char *text = NULL;
    json_t *reference = compare(*state, SCENES "knocked_tower.json",
                                (const char *const[]){"--engine", "plumb", "--engine", "ode",
                                                      "--engine", "bullet:si", NULL},
                                &text);
    assert_non_null(reference);
    assert_true(SAYS(reference, "box b: bullet:si ends ", " m away from the others, from t = "));
    assert_false(SAYS(reference, "box b: ", "plumb:default ends ", "the others"));
    assert_false(SAYS(reference, "box b: ", "ode:quick ends ", "the others"));
    assert_true(json_is_null(json_object_get(case_of(reference), "horizon")));
    assert_before(text, "time/step", "box b: bullet:si ends ");
    json_decref(reference);
    free(text);
}

static void test_engines_that_agree_are_said_to(void **state)
{
    json_t *reference = compare(
        *state, SCENES "flight_and_rest.json",
        (const char *const[]){"--engine", "plumb", "--engine", "plumb:accurate", NULL}, NULL);
    assert_non_null(reference);
    assert_true(SAYS(reference, "All engines agree with the reference to within "));
    assert_false(SAYS(reference, " away from "));
    json_decref(reference);
}

static void test_every_engine_flies_and_rests_alike(void **state)
{
    json_t *reference =
        compare(*state, SCENES "flight_and_rest.json", (const char *const[]){NULL}, NULL);
    assert_non_null(reference);
    assert_true(SAYS(reference, "All engines agree with the reference to within "));
    json_decref(reference);
}

static void test_chaotic_motion_is_compared_as_ensembles(void **state)
{
    json_t *reference = compare(*state, SCENES "colliding_balls.json",
                                (const char *const[]){"--engine", "plumb", NULL}, NULL);
    assert_non_null(reference);
    const json_t *item = case_of(reference);
    const double horizon = json_number_value(json_object_get(item, "horizon"));
    const double duration = json_number_value(json_object_get(item, "duration"));
    assert_true(horizon > 0 && horizon < duration);
    assert_true(SAYS(reference, "is chaotic from t = ", "as ensembles of 16 members, "));
    const json_t *ensemble = json_object_get(item, "ensemble");
    assert_true(json_is_true(json_object_get(ensemble, "chaotic")));
    /* Only bodies without a reference are tested, each along three axes. */
    size_t index, affected = 0;
    const json_t *body;
    json_array_foreach(json_object_get(item, "bodies"), index, body)
    {
        affected += json_is_number(json_object_get(body, "horizon"));
    }
    assert_true(affected > 0);
    assert_int_equal(json_array_size(json_object_get(ensemble, "tests")), 3 * affected);
    json_decref(reference);
}

static void test_error_over_time_is_thinned(void **state)
{
    json_t *reference = compare(*state, SCENES "colliding_balls.json",
                                (const char *const[]){"--engine", "plumb", NULL}, NULL);
    const json_t *error = json_object_get(case_of(reference), "estimated_error");
    const size_t count = json_array_size(json_object_get(error, "time"));
    assert_true(count > 10 && count <= 100);
    assert_int_equal(json_array_size(json_object_get(error, "value")), count);
    json_decref(reference);
}

static void test_resume_keeps_the_reference(void **state)
{
    const workspace *f = *state;
    static const char *const engines[] = {"--engine", "plumb", NULL};
    json_t *first = compare(f, SCENES "flight_and_rest.json", engines, NULL);
    char *path = path_in(f->out, "reference.json");
    /* A mark shows whether the case is kept or made again. */
    json_object_set_new(json_array_get(json_object_get(first, "cases"), 0), "mark", json_true());
    assert_int_equal(json_dump_file(first, path, 0), 0);
    json_t *kept = compare(f, SCENES "flight_and_rest.json",
                           (const char *const[]){"--engine", "plumb", "--resume", NULL}, NULL);
    assert_true(json_is_true(json_object_get(case_of(kept), "mark")));
    json_t *more = compare(
        f, SCENES "flight_and_rest.json",
        (const char *const[]){"--engine", "plumb", "--engine", "plumb:fast", "--resume", NULL},
        NULL);
    assert_null(json_object_get(case_of(more), "mark"));
    json_t *again = compare(f, SCENES "flight_and_rest.json",
                            (const char *const[]){"--engine", "plumb", "--force", NULL}, NULL);
    assert_null(json_object_get(case_of(again), "mark"));
    json_decref(first);
    json_decref(kept);
    json_decref(more);
    json_decref(again);
    free(path);
}

static void test_no_reference_where_none_is_wanted(void **state)
{
    static const char *const engines[] = {"--engine", "plumb", "--no-reference", NULL};
    char *text = NULL;
    assert_null(compare(*state, SCENES "flight_and_rest.json", engines, &text));
    assert_absent(text, "against a converged reference");
    free(text);
    /* A scene that expects something is judged by that. */
    assert_null(compare(*state, "free-fall",
                        (const char *const[]){"--engine", "plumb", "--force", NULL}, NULL));
}

static void test_an_engine_that_crashes_is_a_finding(void **state)
{
    const workspace *f = *state;
    static const char faulty[] = FAULTY ":abort";
    json_t *reference = compare(
        f, f->scene, (const char *const[]){"--engine", "plumb", "--engine", faulty, NULL}, NULL);
    assert_non_null(reference);
    assert_true(SAYS(reference, "faulty:abort is not compared, because it left no path"));
    json_decref(reference);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_tower_knocked_over_by_bullet_is_named, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_engines_that_agree_are_said_to, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_every_engine_flies_and_rests_alike, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_chaotic_motion_is_compared_as_ensembles,
                                        setup_workspace, teardown_workspace),
        cmocka_unit_test_setup_teardown(test_error_over_time_is_thinned, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_resume_keeps_the_reference, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_no_reference_where_none_is_wanted, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_an_engine_that_crashes_is_a_finding, setup_workspace,
                                        teardown_workspace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
