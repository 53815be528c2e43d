#include "analysis_bootstrap.h"

#include "base/random.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>

/* So many repeats tell their own scatter. */
enum { ENOUGH = 10 };

/* A scene's replicates. */
typedef struct resampling {
    const pl_sweep_point *points; /* (count) */
    int count;
    double noise;             /* of the scene; 0: none is known */
    bool *needed;             /* (count): can be on a front in some replicate */
    pl_random *random;        /* (count) */
    pl_sweep_sample *medians; /* (count): of this replicate */
    int *order;               /* (count) */
    pl_sweep_sample *front;   /* (count) */
    double *scratch;          /* two numbers for each repeat of the point with most */
} resampling;

static double largest_error(const pl_sweep_point *point)
{
    double largest = 0;
    for (int i = 0; i < point->sample_count; ++i) {
        largest = fmax(largest, point->samples[i].error);
    }
    return largest;
}

static double smallest_error(const pl_sweep_point *point)
{
    double smallest = (double)INFINITY;
    for (int i = 0; i < point->sample_count; ++i) {
        smallest = fmin(smallest, point->samples[i].error);
    }
    return smallest;
}

/* What a repeat of the point that is drawn is moved by, as a standard deviation of ln(cost). */
static double noise_of(const resampling *d, const pl_sweep_point *point)
{
    return point->sample_count < ENOUGH ? d->noise : 0;
}

/* Whether q is ahead of p in every replicate, so that p is on no front. */
static bool always_ahead(const resampling *d, const pl_sweep_point *q, const pl_sweep_point *p)
{
    const double most = PL_RANDOM_MOST_NORMAL * (noise_of(d, q) + noise_of(d, p));
    return q->state == PL_SWEEP_OK &&
           q->samples[q->sample_count - 1].cost * exp(most) < p->samples[0].cost &&
           largest_error(q) <= smallest_error(p);
}

/* Marks the points that the fronts of profiles need; those of whole engines need no others. */
static void mark_needed(resampling *d)
{
    for (int i = 0; i < d->count; ++i) {
        const pl_sweep_point *point = &d->points[i];
        d->needed[i] = point->state == PL_SWEEP_OK;
        for (int k = 0; k < d->count && d->needed[i]; ++k) {
            d->needed[i] = d->points[k].engines[1] != point->engines[1] ||
                           !always_ahead(d, &d->points[k], point);
        }
    }
}

static void resample(resampling *d)
{
    for (int i = 0; i < d->count; ++i) {
        const pl_sweep_point *point = &d->points[i];
        const int repeats = point->sample_count;
        double *costs = d->scratch, *errors = d->scratch + repeats;
        if (!d->needed[i]) {
            continue;
        }
        const double by = noise_of(d, point);
        for (int k = 0; k < repeats; ++k) {
            int chosen = (int)(pl_random_unit(&d->random[i]) * repeats);
            costs[k] = point->samples[chosen].cost;
            costs[k] *= by > 0 ? exp(by * pl_random_normal(&d->random[i])) : 1;
            errors[k] = point->samples[chosen].error;
        }
        d->medians[i].cost = pl_median(costs, repeats);
        d->medians[i].error = pl_median(errors, repeats);
    }
}

static void read_front(resampling *d, int engine, pl_front_reading *reading)
{
    int count = 0;
    for (int i = 0; i < d->count; ++i) {
        if (d->needed[i] && pl_sweep_point_is_of(&d->points[i], engine)) {
            d->order[count++] = i;
        }
    }
    count = pl_front_find(d->medians, d->order, count);
    for (int i = 0; i < count; ++i) {
        d->front[i] = d->medians[d->order[i]];
    }
    pl_front_read(d->front, count, reading);
}

static bool prepare(resampling *d)
{
    int most = 1;
    for (int i = 0; i < d->count; ++i) {
        most = d->points[i].sample_count > most ? d->points[i].sample_count : most;
    }
    size_t count = (size_t)d->count + 1;
    d->needed = calloc(count, sizeof *d->needed);
    d->random = calloc(count, sizeof *d->random);
    d->medians = calloc(count, sizeof *d->medians);
    d->order = calloc(count, sizeof *d->order);
    d->front = calloc(count, sizeof *d->front);
    d->scratch = calloc(2 * (size_t)most, sizeof *d->scratch);
    return d->needed != NULL && d->random != NULL && d->medians != NULL && d->order != NULL &&
           d->front != NULL && d->scratch != NULL;
}

pl_status pl_bootstrap(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                       pl_front_reading *readings, pl_error *error)
{
    pl_status status = PL_OK;
    resampling d = {.points = analysis->points + scene->first,
                    .count = scene->count,
                    .noise = isnan(scene->noise) ? 0 : scene->noise};
    if (!prepare(&d)) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory to resample %d points", d.count);
        goto cleanup;
    }
    mark_needed(&d);
    for (int i = 0; i < d.count; ++i) {
        d.random[i].state = d.points[i].hash;
    }
    for (int replicate = 0; replicate < PL_BOOTSTRAP_REPLICATES; ++replicate) {
        resample(&d);
        for (int e = 0; e < analysis->engine_count; ++e) {
            if (scene->curves[e].ok > 0) {
                read_front(&d, e,
                           &readings[(size_t)e * PL_BOOTSTRAP_REPLICATES + (size_t)replicate]);
            }
        }
    }

cleanup:
    free(d.needed);
    free(d.random);
    free(d.medians);
    free(d.order);
    free(d.front);
    free(d.scratch);
    return status;
}

void pl_bootstrap_interval(double *values, int count, double *low, double *high)
{
    int known = 0;
    for (int i = 0; i < count; ++i) {
        if (!isnan(values[i])) {
            values[known++] = values[i];
        }
    }
    *low = *high = (double)NAN;
    if (known == 0 || known < 0.95 * count) {
        return;
    }
    pl_sort_numbers(values, known);
    int cut = (int)(0.025 * known);
    *low = values[cut];
    *high = values[known - 1 - cut];
}
