/* What `plumb list scenarios` shows of each scenario, as JSON and as a page. */
#include "check.h"
#include "plumb/scenario.h"
#include "plumb_process.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *list(const char *directory, const char *option, const char *value)
{
    const char *const arguments[] = {"list", "scenarios", option, value, NULL};
    plumb_output output = run_plumb(directory, arguments);
    assert_int_equal(output.code, 0);
    char *text = output.out;
    output.out = NULL;
    free_output(&output);
    return text;
}

static void test_list_has_the_behaviour_of_a_right_engine(void **state)
{
    (void)state;
    char *directory = make_directory(), *text = list(directory, "--json", NULL);
    json_t *array = json_loads(text, 0, NULL);
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    assert_int_equal(json_array_size(array), count);
    for (int i = 0; i < count; ++i) {
        const json_t *item = json_array_get(array, (size_t)i);
        assert_string_equal(result_text(item, "name"), scenarios[i]->name);
        assert_string_equal(result_text(item, "expected"), scenarios[i]->expected);
        assert_string_equal(result_text(item, "reference"), scenarios[i]->reference);
        assert_string_equal(result_text(item, "source"), scenarios[i]->source);
        const json_t *acceptance = json_object_get(item, "acceptance");
        assert_close(json_number_value(json_object_get(acceptance, "bound")),
                     scenarios[i]->acceptance, 0, 0);
        assert_string_equal(result_text(acceptance, "reason"), scenarios[i]->acceptance_reason);
    }
    json_decref(array);
    free(text);
    remove_directory(directory);
}

/* An array of the data of the catalogue's page. The caller releases it. */
static json_t *array_of(const char *page, const char *key)
{
    static const char open[] = "<script type=\"application/json\" id=\"data\">";
    const char *begin = strstr(page, open);
    assert_non_null(begin);
    begin += strlen(open);
    json_t *data = json_loadb(begin, (size_t)(strstr(begin, "</script>") - begin), 0, NULL);
    json_t *array = json_object_get(json_object_get(data, "study"), key);
    assert_true(json_is_array(array));
    json_incref(array);
    json_decref(data);
    return array;
}

static void test_page_has_every_scenario_with_its_scene(void **state)
{
    (void)state;
    char *directory = make_directory(), *page = list(directory, "--page", "-");
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    json_t *found = array_of(page, "scenarios"), *scenes = array_of(page, "scenes");
    assert_int_equal(json_array_size(found), count);
    for (int i = 0; i < count; ++i) {
        const json_t *item = json_array_get(found, (size_t)i);
        const json_t *bodies = json_object_get(json_array_get(scenes, (size_t)i), "bodies");
        assert_string_equal(result_text(item, "name"), scenarios[i]->name);
        assert_int_equal(strncmp(result_text(item, "expected"), "ok: ", 4), 0);
        assert_true(json_array_size(bodies) > 0);
    }
    json_decref(found);
    json_decref(scenes);
    free(page);
    remove_directory(directory);
}

static void test_page_names_the_published_figures(void **state)
{
    (void)state;
    static const char *const names[] = {"rocket", "falling-cubes", "slope-tip", "multi-tower"};
    char *directory = make_directory(), *page = list(directory, "--page", "-");
    json_t *found = array_of(page, "scenarios");
    int figures = 0;
    for (int i = 0; i < 4; ++i) {
        char text[64];
        snprintf(text, sizeof text, "Figure %d of the source paper", i + 1);
        for (size_t k = 0; k < json_array_size(found); ++k) {
            const json_t *item = json_array_get(found, k);
            const char *description = result_text(item, "description");
            if (strcmp(result_text(item, "name"), names[i]) == 0) {
                assert_contains(description, text);
            }
            figures += i == 0 && strstr(description, "of the source paper, ") != NULL;
        }
    }
    json_decref(found);
    assert_int_equal(figures, 4);
    free(page);
    remove_directory(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_list_has_the_behaviour_of_a_right_engine),
        cmocka_unit_test(test_page_has_every_scenario_with_its_scene),
        cmocka_unit_test(test_page_names_the_published_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
