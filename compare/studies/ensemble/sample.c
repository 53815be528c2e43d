/* Samples of observables, and the invariants, of an ensemble's results. */
#include "sample.h"

#include "base/heap.h"
#include "plumb/vec.h"
#include "studies/study.h"

#include <stdlib.h>

const double pl_energy_growth = 1e-3;

bool pl_is_observable(int metric)
{
    return pl_metric_table[metric].more[0] != NULL;
}

int pl_observable_count(void)
{
    int count = 0;
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        count += pl_is_observable(i);
    }
    return count;
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

static void check_invariants(pl_invariants *kept, pl_outcome outcome, const json_t *result)
{
    /* fmax passes over a NAN. */
    const double growth =
        fmax(value_of(result, PL_METRIC_ENERGY_GAIN), value_of(result, PL_METRIC_ENERGY_STEP_GAIN));
    kept->energy_growth = fmax(kept->energy_growth, growth);
    kept->energy_grew += growth > pl_energy_growth;
    kept->fell_through += json_is_true(pl_study_get(result, "ensemble.fell_through"));
    kept->not_finite += outcome == PL_OUTCOME_NONFINITE;
}

void pl_observations_gather(const json_t *results, pl_observations *observed)
{
    size_t index;
    const json_t *result;
    *observed = (pl_observations){.invariants = {.energy_growth = NAN}};
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        observed->samples[i].values = pl_heap_new(json_array_size(results), sizeof(double));
    }
    json_array_foreach((json_t *)results, index, result)
    {
        const pl_outcome outcome = pl_outcome_named(pl_json_get_text(result, "outcome"));
        observed->results += 1;
        observed->outcomes[outcome] += 1;
        check_invariants(&observed->invariants, outcome, result);
        if (outcome == PL_OUTCOME_OK || outcome == PL_OUTCOME_COLLAPSED) {
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
    *observed = (pl_observations){.results = 0};
}
