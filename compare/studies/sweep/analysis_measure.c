/* What the repeats of a point say: its samples, and their medians. */
#include "analysis_rows.h"
#include "base/statistics.h"
#include "results/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A metric's number; NAN where there is none. */
static double metric_of(const json_t *row, const char *name)
{
    const json_t *metric = json_object_get(json_object_get(row, "metrics"), name);
    const json_t *value = json_object_get(metric, "value");
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static int by_cost(const void *left, const void *right)
{
    const pl_sweep_sample *a = left, *b = right;
    if (a->cost != b->cost) {
        return a->cost < b->cost ? -1 : 1;
    }
    return (a->error > b->error) - (a->error < b->error);
}

static bool is_cost(double value)
{
    return isfinite(value) && value > 0;
}

/* Why a point whose runs are all ok cannot be placed. */
static const char *what_is_missing(const json_t *row, int errors, int costs)
{
    if (pl_json_get_text(row, "primary_error")[0] == '\0') {
        return "the scenario has no primary error";
    }
    if (errors == 0) {
        return "the primary error has no value";
    }
    return costs == 0 ? "no time was measured" : "no repeat has both an error and a time";
}

static void take_medians(pl_sweep_point *point, double *scratch)
{
    int count = point->sample_count;
    for (int i = 0; i < count; ++i) {
        scratch[i] = point->samples[i].cost;
    }
    point->cost = pl_median(scratch, count);
    for (int i = 0; i < count; ++i) {
        scratch[i] = fabs(point->samples[i].cost - point->cost);
    }
    point->cost_mad = pl_median(scratch, count);
    for (int i = 0; i < count; ++i) {
        scratch[i] = point->samples[i].error;
    }
    point->error = pl_median(scratch, count);
}

pl_status pl_sweep_measure(const json_t *const *rows, int count, pl_sweep_point *point,
                           pl_error *error)
{
    point->row = rows[0];
    point->repeats = count;
    point->state = PL_SWEEP_OK;
    point->cost = point->cost_mad = point->error = point->raw_error = point->instructions =
        (double)NAN;
    for (int i = 0; i < count && point->state == PL_SWEEP_OK; ++i) {
        if (strcmp(pl_json_get_text(rows[i], "outcome"), "ok") != 0) {
            point->state = strcmp(pl_json_get_text(rows[i], "outcome"), "unsupported") == 0
                               ? PL_SWEEP_UNSUPPORTED
                               : PL_SWEEP_FAILED;
            point->row = rows[i];
        }
    }
    point->outcome = pl_json_get_text(point->row, "outcome");
    point->reason = pl_json_get_text(point->row, "reason");
    point->label = pl_json_get_text(point->row, "label");
    if (point->state != PL_SWEEP_OK) {
        return PL_OK;
    }
    point->samples = calloc((size_t)count, sizeof *point->samples);
    double *scratch = calloc(3 * (size_t)count, sizeof *scratch);
    if (point->samples == NULL || scratch == NULL) {
        free(scratch);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d repeats", count);
    }
    double *raw = scratch + count, *instructions = raw + count;
    int errors = 0, costs = 0, counted = 0;
    for (int i = 0; i < count; ++i) {
        double found = fabs(metric_of(rows[i], pl_json_get_text(rows[i], "primary_error")));
        double cost = metric_of(rows[i], "time_per_step") / point->dt;
        double counts = metric_of(rows[i], "instructions_per_step") / point->dt;
        errors += isfinite(found);
        costs += is_cost(cost);
        if (!isfinite(found) || !is_cost(cost)) {
            continue;
        }
        raw[point->sample_count] = found;
        point->samples[point->sample_count++] =
            (pl_sweep_sample){cost, fmax(found, pl_sweep_error_floor)};
        if (is_cost(counts)) {
            instructions[counted++] = counts;
        }
    }
    if (point->sample_count == 0) {
        point->state = PL_SWEEP_UNMEASURED;
        point->reason = what_is_missing(rows[0], errors, costs);
    } else {
        qsort(point->samples, (size_t)point->sample_count, sizeof *point->samples, by_cost);
        point->raw_error = pl_median(raw, point->sample_count);
        point->instructions = pl_median(instructions, counted);
        take_medians(point, scratch);
    }
    free(scratch);
    return PL_OK;
}
