/* An engine in which nothing moves is right in no scene in which something should move: plumb
 * compare with frozen_engine.c over the catalogue. */
#include "check.h"
#include "plumb_process.h"
#include "scenario_scene.h"

#include <stdlib.h>
#include <string.h>

#define FROZEN PLUMB_BINARY_DIR "/frozen_engine.so"

enum { MOST_WORDS = 128 };

/* Whether every expectation is a rest at the start, or the largest speed of a body that rests, so that a
 * frozen body is right. */
static bool expects_no_motion(const pl_scene *scene)
{
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *value = &scene->values[i];
        if (value->quantity != PL_QUANTITY_TOP_SPEED || value->bound != PL_BOUND_AT_MOST) {
            return false;
        }
    }
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        const pl_body *body = &scene->bodies[rest->body];
        if (memcmp(rest->position, body->position, sizeof rest->position) != 0 ||
            memcmp(rest->orientation, body->orientation, sizeof rest->orientation) != 0) {
            return false;
        }
    }
    return scene->rest_count > 0 && scene->travel_count == 0 &&
           strcmp(scene->primary_error, "rest_position_error") == 0;
}

/* Appends the names of the scenarios in which something moves; returns their number. */
static int add_moving(const char **words, int used)
{
    int count, moving = 0;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        pl_scene scene = scenario_scene(scenarios[i]->name, NULL);
        if (!expects_no_motion(&scene)) {
            assert_in_range(used, 1, MOST_WORDS - 2);
            words[used++] = scenarios[i]->name;
            ++moving;
        }
        pl_scene_free(&scene);
    }
    words[used] = NULL;
    return moving;
}

static void test_no_frozen_run_of_moving_bodies_is_accurate(void **state)
{
    (void)state;
    char *directory = make_directory(), *out = path_in(directory, "report");
    const char *words[MOST_WORDS] = {"compare",  "--json",        "-",        "--out",       out,
                                     "--engine", FROZEN ":still", "--engine", FROZEN ":kept"};
    const int moving = add_moving(words, 9);
    plumb_output output = run_plumb(directory, words);
    assert_int_equal(output.code, 0);
    json_t *results = json_loads(output.out, 0, NULL);
    assert_true(moving > 20);
    assert_int_equal(json_array_size(results), 2 * moving);
    bool right = true;
    for (size_t i = 0; i < json_array_size(results); ++i) {
        const json_t *result = json_array_get(results, i);
        const char *verdict = result_text(result, "verdict");
        if (strcmp(verdict, "inaccurate") != 0 && strcmp(verdict, "failed") != 0) {
            print_error("%s on %s: \"%s\" %s\n", result_text(result, "scenario"),
                        result_text(result, "label"), verdict,
                        result_text(result, "verdict_reason"));
            right = false;
        }
    }
    assert_true(right);
    json_decref(results);
    free_output(&output);
    remove_directory(directory);
    free(out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_frozen_run_of_moving_bodies_is_accurate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
