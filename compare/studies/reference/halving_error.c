#include "halving_error.h"

#include <math.h>
#include <stdlib.h>

const double pl_halving_window = 0.1;

static const double least_rate = 0.25;
static const double largest_rate = 0.70710678118654752;

long pl_halving_samples(const pl_body_paths *levels, int count)
{
    long samples = levels[0].samples;
    for (int k = 1; k < count; ++k) {
        samples = levels[k].samples < samples ? levels[k].samples : samples;
    }
    return samples;
}

/* changes[i] is the largest distance of a body between two levels within the window about i. */
static void windowed_changes(const pl_body_paths *fine, const pl_body_paths *coarse, int body,
                             long samples, long reach, double *changes)
{
    for (long i = 0; i < samples; ++i) {
        changes[i] = 0;
    }
    for (long i = 0; i < samples; ++i) {
        const double change = pl_body_paths_distance(fine, coarse, body, i);
        const long first = i > reach ? i - reach : 0;
        const long last = i + reach < samples ? i + reach : samples - 1;
        for (long k = first; k <= last; ++k) {
            changes[k] = fmax(changes[k], change);
        }
    }
}

pl_status pl_halving_error(const pl_body_paths *levels, int count, double interval, double *error,
                           pl_error *failure)
{
    const long samples = pl_halving_samples(levels, count);
    const long reach = (long)ceil(pl_halving_window / interval);
    const int bodies = levels[0].bodies;
    double *changes = calloc(2 * (size_t)samples + 1, sizeof *changes);
    if (changes == NULL) {
        return pl_fail(failure, PL_NO_MEMORY, "out of memory for the error of a reference");
    }
    for (int body = 0; body < bodies; ++body) {
        double *last = changes, *before = changes + samples;
        windowed_changes(&levels[count - 1], &levels[count - 2], body, samples, reach, last);
        if (count > 2) {
            windowed_changes(&levels[count - 2], &levels[count - 3], body, samples, reach, before);
        }
        for (long i = 0; i < samples; ++i) {
            const double observed = count > 2 && before[i] > 0 ? last[i] / before[i] : 0.5;
            const double rate = fmin(fmax(observed, least_rate), largest_rate);
            error[i * bodies + body] = last[i] * rate / (1 - rate);
        }
    }
    free(changes);
    return PL_OK;
}
