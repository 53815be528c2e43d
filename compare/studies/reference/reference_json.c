/* A judged case as an item of `cases` of plumb.reference/1. */
#include "adapters/built_in.h"
#include "reference_verdict.h"

#include <math.h>
#include <string.h>

enum { MOST_TIMES = 100 };

json_t *pl_reference_runs_json(const pl_plan *plan, const pl_case *test_case)
{
    json_t *runs = json_array();
    pl_plan own = {.repeats = 1, .seed = plan->seed};
    pl_plan_add_engine(&own, pl_reference_engine, NULL);
    for (int i = 0; i <= plan->configuration_count; ++i) {
        const pl_configuration *configuration =
            i < plan->configuration_count ? &plan->configurations[i] : own.configurations;
        char run[17];
        pl_reference_hash(plan, test_case, configuration, run);
        json_array_append_new(runs, json_string(run));
    }
    pl_plan_free(&own);
    return runs;
}

static json_t *text_or_null(const char *text)
{
    return text[0] == '\0' ? json_null() : pl_json_text(text);
}

static json_t *numbers(const double *values, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, pl_json_number_or_null(values[i]));
    }
    return array;
}

/* The engines with the steps that they were run at. */
static json_t *engines_json(const pl_reference *reference)
{
    json_t *engines = json_array();
    for (int i = 0; i < reference->engine_count; ++i) {
        const pl_reference_runs *runs = &reference->engines[i];
        double steps[PL_REFERENCE_LEVELS];
        for (int k = 0; k < runs->count; ++k) {
            steps[k] = reference->dt / (1 << k);
        }
        const char *role = i == 0 ? "reference" : i == reference->second ? "confirms" : "candidate";
        json_array_append_new(engines,
                              json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "label", runs->label,
                                        "role", role, "steps", numbers(steps, runs->count),
                                        "changes", numbers(runs->change, runs->count), "apart",
                                        pl_json_number_or_null(i == 0 ? (double)NAN : runs->apart),
                                        "reason", text_or_null(runs->reason)));
    }
    return engines;
}

/* The largest error of all bodies over time. Each of at most MOST_TIMES stretches of time has the
 * largest error in it, at its last sample, so that no peak is lost. */
static json_t *error_json(const pl_reference *reference)
{
    json_t *times = json_array(), *values = json_array();
    const long samples = reference->samples;
    const long stretches = samples < MOST_TIMES ? samples : MOST_TIMES;
    for (long k = 0; k < stretches; ++k) {
        const long first = k * samples / stretches, end = (k + 1) * samples / stretches;
        double largest = 0;
        for (long i = first * reference->bodies; i < end * reference->bodies; ++i) {
            largest = fmax(largest, reference->error[i]);
        }
        json_array_append_new(times, json_real((double)(end - 1) * reference->interval));
        json_array_append_new(values, json_real(largest));
    }
    return json_pack("{s:o, s:o}", "time", times, "value", values);
}

static json_t *horizon_json(const pl_reference *reference, long sample)
{
    return sample < reference->samples ? json_real((double)sample * reference->interval)
                                       : json_null();
}

static json_t *configurations_json(const pl_reference_verdict *verdict, int body)
{
    json_t *array = json_array();
    for (int i = 0; i < verdict->engine_count; ++i) {
        const pl_engine_verdict *engine = &verdict->engines[i];
        if (engine->bodies == NULL) {
            continue;
        }
        const pl_body_verdict *b = &engine->bodies[body];
        json_array_append_new(
            array, json_pack("{s:s, s:s, s:b, s:o, s:o, s:f, s:o, s:o}", "label", engine->label,
                             "run", engine->run, "completed", (int)engine->completed,
                             "final_distance", pl_json_number_or_null(b->final), "largest_distance",
                             pl_json_number_or_null(b->largest), "until", b->until, "differs_from",
                             pl_json_number_or_null(b->differs_from), "strays_at",
                             pl_json_number_or_null(b->strays_at)));
    }
    return array;
}

static json_t *bodies_json(const pl_reference_verdict *verdict)
{
    const pl_reference *reference = verdict->reference;
    json_t *array = json_array();
    for (int b = 0; b < reference->bodies; ++b) {
        const char *name = verdict->test_case->scene.bodies[reference->body[b]].name;
        double final = (double)NAN, largest = 0;
        for (long i = 0; i < reference->samples; ++i) {
            final = reference->error[i * reference->bodies + b];
            largest = fmax(largest, final);
        }
        json_array_append_new(
            array,
            json_pack("{s:o, s:f, s:o, s:o, s:o, s:b, s:o}", "name", pl_json_text(name), "bound",
                      reference->bounds[b], "final_error", pl_json_number_or_null(final),
                      "largest_error", pl_json_number_or_null(largest), "horizon",
                      horizon_json(reference, reference->horizon[b]), "contradicted",
                      (int)pl_reference_is_contradicted(verdict, b, NULL, NULL), "configurations",
                      configurations_json(verdict, b)));
    }
    return array;
}

static json_t *ensemble_json(const pl_reference_verdict *verdict)
{
    static const char *const axes[] = {"x", "y", "z"};
    const pl_reference *reference = verdict->reference;
    const pl_after_horizon *after = &verdict->after;
    if (after->from == reference->samples) {
        return json_null();
    }
    json_t *tests = json_array();
    for (int i = 0; i < after->test_count; ++i) {
        const pl_end_test *t = &after->tests[i];
        const char *name = verdict->test_case->scene.bodies[reference->body[t->body]].name;
        json_array_append_new(tests, json_pack("{s:s, s:o, s:s, s:f, s:f, s:f}", "label",
                                               verdict->engines[t->engine].label, "body",
                                               pl_json_text(name), "axis", axes[t->axis], "ks",
                                               t->ks, "p", t->p, "p_corrected", t->corrected));
    }
    return json_pack("{s:i, s:f, s:b, s:b, s:o, s:o, s:o}", "members", PL_REFERENCE_MEMBERS,
                     "reference_dt", reference->dt / PL_REFERENCE_MEMBER_REFINEMENT, "made",
                     (int)after->made, "chaotic", (int)after->chaotic, "parted",
                     pl_json_number_or_null(after->parted), "reason", text_or_null(after->reason),
                     "tests", tests);
}

json_t *pl_reference_case_json(const pl_reference_work *work, const pl_reference *reference,
                               const pl_reference_verdict *verdict, json_t *sentences)
{
    const pl_case *test_case = work->original;
    json_t *item = json_pack(
        "{s:o, s:s, s:f, s:f, s:o, s:b, s:o, s:o, s:O}", "name", pl_json_text(test_case->name),
        "scene_hash", test_case->scene_hash, "dt", test_case->scene.dt, "duration",
        test_case->scene.duration, "runs", pl_reference_runs_json(work->execution.plan, test_case),
        "known", (int)reference->known, "reason", text_or_null(reference->reason), "engines",
        engines_json(reference), "sentences", sentences);
    if (verdict != NULL) {
        json_t *more =
            json_pack("{s:f, s:o, s:o, s:i, s:o, s:o, s:o}", "floor", reference->floor,
                      "estimated_error", error_json(reference), "confirmed_within",
                      pl_json_number_or_null(reference->confirmed), "disputed_bodies",
                      reference->disputed, "horizon", horizon_json(reference, verdict->after.from),
                      "bodies", bodies_json(verdict), "ensemble", ensemble_json(verdict));
        json_object_update_new(item, more);
    }
    return item;
}
