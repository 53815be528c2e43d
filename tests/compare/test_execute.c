/* What an execution makes of a plan, and what its bar says. */
#include "check.h"
#include "results/result.h"
#include "runner/execute.h"

#include <stdlib.h>

enum { REPEATS = 3 };

typedef struct seen {
    long results;
    bool is_enough; /* repeats are needless from the first result on */
} seen;

static bool is_needless(void *user, const char *run)
{
    const seen *s = user;
    (void)run;
    return s->is_enough && s->results > 0;
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    seen *s = user;
    (void)error;
    assert_string_equal(pl_json_get_text(result, "outcome"), "ok");
    s->results += 1;
    return PL_OK;
}

/* Runs a plan of three repeats; the bar as it is left. */
static pl_progress execute(seen *s, FILE *out)
{
    pl_plan plan = {.repeats = REPEATS};
    const char *const settings[] = {"duration=0.1"};
    const pl_scenario *scenario = pl_scenario_find("free-fall", NULL);
    assert_int_equal(pl_plan_add_scenario(&plan, scenario, settings, 1, NULL), PL_OK);
    assert_int_equal(pl_plan_add_engine(&plan, "plumb", NULL), PL_OK);
    pl_progress bar = pl_progress_begin(out, REPEATS, 0);
    json_t *provenance = json_object();
    const pl_execution_def def = {.plan = &plan,
                                  .jobs = 1,
                                  .limits = {.timeout = 60},
                                  .provenance = provenance,
                                  .bar = &bar,
                                  .user = s,
                                  .skip = is_needless,
                                  .take = keep};
    int signal_number = 0;
    assert_int_equal(pl_execution_due(&def, NULL), REPEATS);
    assert_int_equal(pl_execute(&def, &signal_number, NULL), PL_OK);
    json_decref(provenance);
    pl_plan_free(&plan);
    return bar;
}

static void test_progress_bar_leaves_out_skipped_runs(void **state)
{
    (void)state;
    for (int is_enough = 0; is_enough < 2; ++is_enough) {
        seen s = {.is_enough = is_enough};
        FILE *out = tmpfile();
        const pl_progress bar = execute(&s, out);
        assert_int_equal(s.results, is_enough ? 1 : REPEATS);
        assert_int_equal(bar.done, s.results);
        assert_int_equal(bar.total, s.results);
        fclose(out);
    }
}

/* The threads that the results say, in the order in which they came. */
typedef struct said {
    int threads[4], count;
} said;

static pl_status keep_threads(void *user, json_t *result, pl_error *error)
{
    said *s = user;
    (void)error;
    assert_string_equal(pl_json_get_text(result, "outcome"), "ok");
    assert_true(json_is_integer(json_object_get(json_object_get(result, "host"), "cpus")));
    assert_in_range(s->count, 0, 3);
    s->threads[s->count++] = pl_result_threads(result);
    return PL_OK;
}

/* One of them asks for more threads than any machine has: it is made alone. */
static void test_results_say_the_threads_asked_for(void **state)
{
    (void)state;
    static const char *const specs[] = {"plumb", "plumb,threads=2", "plumb,threads=64",
                                        "plumb:fast"};
    pl_plan plan = {.repeats = 1};
    const char *const settings[] = {"duration=0.1"};
    const pl_scenario *scenario = pl_scenario_find("free-fall", NULL);
    assert_int_equal(pl_plan_add_scenario(&plan, scenario, settings, 1, NULL), PL_OK);
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(pl_plan_add_engine(&plan, specs[i], NULL), PL_OK);
    }
    json_t *provenance = pl_provenance(0, NULL);
    said s = {.count = 0};
    const pl_execution_def def = {.plan = &plan,
                                  .jobs = 3,
                                  .limits = {.timeout = 60},
                                  .provenance = provenance,
                                  .user = &s,
                                  .take = keep_threads};
    int signal_number = 0, sum = 0;
    assert_int_equal(pl_execute(&def, &signal_number, NULL), PL_OK);
    assert_int_equal(s.count, 4);
    for (int i = 0; i < 4; ++i) {
        sum += s.threads[i];
    }
    assert_int_equal(sum, 1 + 2 + 64 + 1);
    json_decref(provenance);
    pl_plan_free(&plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_progress_bar_leaves_out_skipped_runs),
        cmocka_unit_test(test_results_say_the_threads_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
