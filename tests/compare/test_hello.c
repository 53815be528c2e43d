/* The answer to hello: what is written of an engine is read as the same engine. */
#include "adapters/built_in.h"
#include "adapters/process/hello.h"
#include "check.h"

#include <string.h>

static void assert_same_text(const char *found, const char *expected)
{
    assert_int_equal(found == NULL, expected == NULL);
    if (expected != NULL) {
        assert_string_equal(found, expected);
    }
}

static void assert_same_options(const pl_engine *found, const pl_engine *expected)
{
    assert_int_equal(found->option_count, expected->option_count);
    for (int i = 0; i < expected->option_count; ++i) {
        const pl_engine_option *a = &found->options[i], *b = &expected->options[i];
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->unit, b->unit);
        assert_string_equal(a->help, b->help);
        assert_same_text(a->code, b->code);
        assert_int_equal(a->integer, b->integer);
        assert_memory_equal(&a->value, &b->value, 3 * sizeof a->value); /* value, min, max */
        assert_int_equal(a->tune_profiles, b->tune_profiles);
        if (b->tune_profiles != 0) {
            assert_memory_equal(&a->tune_min, &b->tune_min, 2 * sizeof a->tune_min);
            assert_int_equal(a->tune_logarithmic, b->tune_logarithmic);
        }
    }
}

static void assert_same_lists(const pl_engine *found, const pl_engine *expected)
{
    assert_int_equal(found->profile_count, expected->profile_count);
    for (int i = 0; i < expected->profile_count; ++i) {
        const pl_engine_profile *a = &found->profiles[i], *b = &expected->profiles[i];
        assert_string_equal(a->name, b->name);
        assert_string_equal(a->help, b->help);
        assert_same_text(a->step_code, b->step_code);
        assert_int_equal(a->in_default_comparison, b->in_default_comparison);
    }
    assert_int_equal(found->source_count, expected->source_count);
    for (int i = 0; i < expected->source_count; ++i) {
        assert_int_equal(found->sources[i].profile, expected->sources[i].profile);
        assert_same_text(found->sources[i].option, expected->sources[i].option);
        assert_string_equal(found->sources[i].text, expected->sources[i].text);
    }
}

static void assert_round_trip(const pl_engine *engine, const double *defaults)
{
    pl_hello hello = {.answer = NULL};
    pl_diagnostic diagnostic = {.status = PL_OK};
    json_t *answer = pl_hello_write(engine, defaults);
    assert_true(pl_hello_read(answer, &hello, &diagnostic));
    const pl_engine *found = &hello.table;
    assert_string_equal(found->name, engine->name);
    assert_string_equal(found->version, engine->version);
    assert_string_equal(found->description, engine->description);
    assert_string_equal(found->runtime, engine->runtime == NULL ? "native" : engine->runtime);
    assert_same_text(found->residual_unit, engine->residual_unit);
    assert_int_equal(found->capabilities, engine->capabilities);
    assert_int_equal(found->contacts, engine->contacts);
    assert_int_equal(found->precision, engine->precision);
    assert_int_equal(found->integrator, engine->integrator);
    assert_int_equal(found->gyroscopic, engine->gyroscopic);
    assert_int_equal(found->substeps, engine->substeps);
    assert_int_equal(hello.reads_settings, engine->read_settings != NULL);
    assert_int_equal(hello.reads_pairs, engine->read_pair != NULL);
    assert_same_lists(found, engine);
    assert_same_options(found, engine);
    for (int i = 0; i < engine->profile_count; ++i) {
        double values[PL_ENGINE_MAX_OPTIONS];
        for (int k = 0; k < engine->option_count; ++k) {
            values[k] = found->options[k].value;
        }
        pl_hello_profile_values(&hello, i, values);
        assert_memory_equal(values, defaults + i * engine->option_count,
                            (size_t)engine->option_count * sizeof *values);
    }
    pl_hello_free(&hello);
    json_decref(answer);
}

static void test_what_is_written_is_read(void **state)
{
    (void)state;
    int count = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    for (int e = 0; e < count; ++e) {
        const pl_engine *engine = known[e].entry == NULL ? NULL : known[e].entry();
        double defaults[PL_ENGINE_MAX_PROFILES * PL_ENGINE_MAX_OPTIONS];
        for (int i = 0; engine != NULL && i < engine->profile_count; ++i) {
            double *values = defaults + i * engine->option_count;
            for (int k = 0; k < engine->option_count; ++k) {
                values[k] = engine->options[k].value;
            }
            if (engine->profile_defaults != NULL) {
                engine->profile_defaults(i, values);
            }
        }
        if (engine != NULL) {
            assert_round_trip(engine, defaults);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_is_written_is_read)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
