/* Permutation tests of all pairs of ensembles, with Holm's correction, and their wording. */
#include "verdict.h"

#include "base/heap.h"
#include "two_sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const double pl_significance = 0.05;

/* A smaller relative difference of means is reported as equal means. */
static const double notable_share = 0.005;

/* Engines as asked are compared with each other, and each engine in another setting with itself as
 * asked. Further comparisons would only weaken the correction. */
static bool comparable(const pl_ensemble *a, const pl_ensemble *b)
{
    return a->test_case == b->test_case && (a->setting == 0 || b->setting == 0) &&
           (a->setting == b->setting || a->configuration == b->configuration);
}

int pl_verdicts_planned(const pl_ensembles *ensembles)
{
    int pairs = 0;
    for (int a = 0; a < ensembles->count; ++a) {
        for (int b = a + 1; b < ensembles->count; ++b) {
            pairs += comparable(&ensembles->items[a], &ensembles->items[b]);
        }
    }
    return pairs * pl_observable_count();
}

pl_status pl_verdicts_possible(const pl_ensembles *ensembles, pl_error *error)
{
    const int tests = pl_verdicts_planned(ensembles), members = ensembles->members;
    const double level = 100 * pl_significance;
    const int needed =
        tests > 0 ? pl_permutation_least_count(tests, pl_significance, members) : members;
    if (needed == members) {
        return PL_OK;
    }
    if (needed == 0) {
        return pl_fail(error, PL_BAD_INPUT,
                       "no number of members is enough for any of %d comparisons to be significant "
                       "at %g %%: compare fewer scenarios or engines at a time",
                       tests, level);
    }
    return pl_fail(error, PL_BAD_INPUT,
                   "--members %d: with %d members no difference could be significant; at least %d "
                   "are needed for %d comparisons at %g %%",
                   members, members, needed, tests, level);
}

/* Compares an observable of two ensembles, without the correction. */
static void compare(const pl_sample *a, const pl_sample *b, pl_sample_test *comparison)
{
    const pl_noise noise_a = pl_split_half_noise(a->values, a->count, a->count, b->count),
                   noise_b = pl_split_half_noise(b->values, b->count, a->count, b->count);
    pl_pool pool = pl_pool_make(a->values, a->count, b->values, b->count);
    comparison->energy = pl_energy_distance(&pool);
    comparison->ks = pl_kolmogorov_smirnov(&pool);
    comparison->p = pl_permutation_p(&pool);
    comparison->energy_floor = fmax(noise_a.energy, noise_b.energy);
    comparison->ks_floor = fmax(noise_a.ks, noise_b.ks);
    pl_pool_free(&pool);
}

static void correct(pl_verdicts *verdicts)
{
    const size_t count = (size_t)verdicts->count;
    double *p = pl_heap_new(count, sizeof *p), *corrected = pl_heap_new(count, sizeof *corrected);
    for (int i = 0; i < verdicts->count; ++i) {
        p[i] = verdicts->items[i].p;
    }
    pl_holm(p, verdicts->count, corrected);
    for (int i = 0; i < verdicts->count; ++i) {
        verdicts->items[i].corrected = corrected[i];
        verdicts->items[i].apart = corrected[i] < pl_significance;
    }
    free(p);
    free(corrected);
}

/* Whether there is nothing to compare, such as the time of settling where no member settled. Such
 * tests may be left out of the correction, because the criterion does not depend on which ensemble
 * has which value. */
static bool all_equal(const pl_sample *a, const pl_sample *b)
{
    bool equal = true;
    for (int i = 0; i < a->count; ++i) {
        equal = equal && a->values[i] == a->values[0];
    }
    for (int i = 0; i < b->count; ++i) {
        equal = equal && b->values[i] == a->values[0];
    }
    return equal;
}

/* Adds the tests of all observables of two ensembles. */
static void add_pair(const pl_ensemble_view *views, int a, int b, pl_verdicts *verdicts)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_sample *of_a = &views[a].observed.samples[i];
        const pl_sample *of_b = &views[b].observed.samples[i];
        if (of_a->count > 1 && of_b->count > 1 && !all_equal(of_a, of_b)) {
            pl_sample_test *comparison = &verdicts->items[verdicts->count];
            *comparison = (pl_sample_test){.a = a, .b = b, .observable = i};
            compare(of_a, of_b, comparison);
            verdicts->count += 1;
        }
    }
}

pl_verdicts pl_verdicts_reach(const pl_ensemble_view *views, int count)
{
    const size_t most = (size_t)count * (size_t)count / 2 * PL_METRIC_COUNT;
    pl_verdicts verdicts = {.items = pl_heap_new(most, sizeof *verdicts.items)};
    for (int a = 0; a < count; ++a) {
        for (int b = a + 1; b < count; ++b) {
            if (comparable(&views[a].ensemble, &views[b].ensemble)) {
                add_pair(views, a, b, &verdicts);
            }
        }
    }
    correct(&verdicts);
    return verdicts;
}

void pl_verdicts_free(pl_verdicts *verdicts)
{
    free(verdicts->items);
    *verdicts = (pl_verdicts){.count = 0};
}

void pl_sample_test_sentence(const pl_ensemble_view *views, const pl_sample_test *comparison,
                             char *text, size_t size)
{
    const pl_metric_info *info = &pl_metric_table[comparison->observable];
    const pl_ensemble_view *more = &views[comparison->a], *less = &views[comparison->b];
    if (more->observed.samples[comparison->observable].mean <
        less->observed.samples[comparison->observable].mean) {
        more = &views[comparison->b];
        less = &views[comparison->a];
    }
    const pl_sample *high = &more->observed.samples[comparison->observable];
    const pl_sample *low = &less->observed.samples[comparison->observable];
    const double excess = high->mean - low->mean;
    char amount[64];
    if (!(excess > notable_share * fabs(low->mean))) {
        snprintf(text, size,
                 "%s and %s have about the same mean %s (%.3g and %.3g %s) but not the same "
                 "distribution: standard deviations %.3g and %.3g %s (p = %.2g)",
                 more->name, less->name, info->name, high->mean, low->mean, info->unit,
                 high->deviation, low->deviation, info->unit, comparison->corrected);
        return;
    }
    if (low->mean > 0 && excess <= 2 * low->mean) {
        snprintf(amount, sizeof amount, "%.2g %%", 100 * excess / low->mean);
    } else {
        snprintf(amount, sizeof amount, "%.3g %s", excess, info->unit);
    }
    snprintf(text, size, "%s %s %s %s than %s (%s: means %.3g and %.3g %s, p = %.2g)", more->name,
             info->more[0], amount, info->more[1], less->name, info->name, high->mean, low->mean,
             info->unit, comparison->corrected);
}
