/* Samples of observables, and the invariants, of an ensemble's results. */
#include "sample.h"

#include "base/heap.h"
#include "plumb/vec.h"
#include "studies/study.h"

#include <stdlib.h>
#include <string.h>

const double pl_energy_growth = 1e-3;

bool pl_is_observable(int metric)
{
    return pl_metric_table[metric].more[0] != NULL;
}

/* Sets the mean and the standard deviation of the values. */
static void summarise(pl_sample *sample)
{
    double mean = 0, square = 0;
    for (int i = 0; i < sample->count; ++i) {
        mean += sample->values[i] / sample->count;
    }
    for (int i = 0; i < sample->count; ++i) {
        double d = sample->values[i] - mean;
        square += d * d;
    }
    sample->mean = sample->count > 0 ? mean : (double)NAN;
    sample->deviation = sample->count > 1 ? sqrt(square / (sample->count - 1)) : (double)NAN;
}

/* NAN where the result has no such number. */
static double value_of(const json_t *result, pl_metric_id id)
{
    return pl_result_metric(result, pl_metric_table[id].name);
}

/* Adds the values of a run that finished. */
static void add_values(pl_observations *observed, const json_t *result)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        pl_sample *sample = &observed->samples[i];
        double value = pl_is_observable(i) ? value_of(result, (pl_metric_id)i) : (double)NAN;
        if (i == PL_METRIC_SETTLE_TIME && isnan(value) &&
            pl_study_get(result, "metrics.settle_time") != NULL) {
            value = pl_study_number(result, "settings.duration");
            sample->unsettled += 1;
        }
        if (!isnan(value)) {
            sample->values[sample->count++] = value;
        }
    }
}

bool pl_fell_through(const pl_scene *scene, const json_t *result)
{
    const json_t *poses = json_object_get(result, "final_poses");
    for (int i = 0; i < scene->body_count; ++i) {
        pl_vec x;
        const bool moves =
            !scene->bodies[i].is_static &&
            json_unpack(json_array_get(poses, (size_t)i), "[F, F, F]", &x.x, &x.y, &x.z) == 0;
        for (int k = 0; k < scene->body_count && moves; ++k) {
            const pl_shape *shape = &scene->bodies[k].shape;
            if (shape->kind == PL_SHAPE_PLANE &&
                pl_vec_dot(pl_vec_of(shape->normal), x) < shape->offset) {
                return true;
            }
        }
    }
    return false;
}

static void count(json_t *counts, const char *key, bool counted)
{
    json_object_set_new(counts, key, json_integer(pl_study_integer(counts, key) + counted));
}

static void check_invariants(json_t *kept, const json_t *result, const char *outcome)
{
    /* fmax passes over a NAN. */
    const double growth =
        fmax(value_of(result, PL_METRIC_ENERGY_GAIN), value_of(result, PL_METRIC_ENERGY_STEP_GAIN));
    count(kept, "energy_grew", growth > pl_energy_growth);
    count(kept, "fell_through", json_is_true(pl_study_get(result, "ensemble.fell_through")));
    count(kept, "not_finite", strcmp(outcome, pl_outcome_name(PL_OUTCOME_NONFINITE)) == 0);
    json_object_set_new(
        kept, "energy_growth",
        pl_json_number_or_null(fmax(pl_study_number(kept, "energy_growth"), growth)));
}

void pl_observations_gather(const json_t *results, pl_observations *observed)
{
    size_t index;
    const json_t *result;
    *observed = (pl_observations){.outcomes = json_object(), .invariants = json_object()};
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        observed->samples[i].values = pl_heap_new(json_array_size(results), sizeof(double));
    }
    json_array_foreach((json_t *)results, index, result)
    {
        const char *outcome = pl_json_get_text(result, "outcome");
        count(observed->outcomes, outcome, true);
        check_invariants(observed->invariants, result, outcome);
        if (pl_study_ended(result)) {
            add_values(observed, result);
        }
    }
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        summarise(&observed->samples[i]);
    }
}

void pl_observations_free(pl_observations *observed)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        free(observed->samples[i].values);
    }
    json_decref(observed->outcomes);
    json_decref(observed->invariants);
}
