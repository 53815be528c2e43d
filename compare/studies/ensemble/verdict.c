/* Permutation tests of all pairs of ensembles, with Holm's correction, and their wording. */
#include "verdict.h"

#include "base/heap.h"
#include "studies/study.h"
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
    int pairs = 0, observables = 0;
    for (int a = 0; a < ensembles->count; ++a) {
        for (int b = a + 1; b < ensembles->count; ++b) {
            pairs += comparable(&ensembles->items[a], &ensembles->items[b]);
        }
    }
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        observables += pl_is_observable(i);
    }
    return pairs * observables;
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

/* The difference as a sentence: "bullet:si spreads 12 % farther in x than ode:quick (...)". */
static json_t *sentence(const pl_ensemble_view *a, const pl_ensemble_view *b, int observable,
                        double p)
{
    const pl_metric_info *info = &pl_metric_table[observable];
    const bool a_is_more =
        !(a->observed.samples[observable].mean < b->observed.samples[observable].mean);
    const pl_ensemble_view *more = a_is_more ? a : b, *less = a_is_more ? b : a;
    const pl_sample *high = &more->observed.samples[observable];
    const pl_sample *low = &less->observed.samples[observable];
    const double excess = high->mean - low->mean;
    char amount[64];
    if (!(excess > notable_share * fabs(low->mean))) {
        return json_sprintf(
            "%s and %s have about the same mean %s (%.3g and %.3g %s) but not the same "
            "distribution: standard deviations %.3g and %.3g %s (p = %.2g)",
            more->name, less->name, info->name, high->mean, low->mean, info->unit, high->deviation,
            low->deviation, info->unit, p);
    }
    if (low->mean > 0 && excess <= 2 * low->mean) {
        snprintf(amount, sizeof amount, "%.2g %%", 100 * excess / low->mean);
    } else {
        snprintf(amount, sizeof amount, "%.3g %s", excess, info->unit);
    }
    return json_sprintf("%s %s %s %s than %s (%s: means %.3g and %.3g %s, p = %.2g)", more->name,
                        info->more[0], amount, info->more[1], less->name, info->name, high->mean,
                        low->mean, info->unit, p);
}

/* A distance over its floor; null where there is no floor. */
static json_t *ratio(double value, double floor)
{
    return pl_json_number_or_null(floor > 0 ? value / floor : (double)NAN);
}

/* Compares an observable of the ensembles a and b, without the correction. */
static json_t *compare(const pl_ensemble_view *views, int a, int b, int observable)
{
    const pl_sample *of_a = &views[a].observed.samples[observable];
    const pl_sample *of_b = &views[b].observed.samples[observable];
    const pl_noise noise_a =
        pl_split_half_noise(of_a->values, of_a->count, of_a->count, of_b->count);
    const pl_noise noise_b =
        pl_split_half_noise(of_b->values, of_b->count, of_a->count, of_b->count);
    pl_pool pool = pl_pool_make(of_a->values, of_a->count, of_b->values, of_b->count);
    const double energy = pl_energy_distance(&pool), ks = pl_kolmogorov_smirnov(&pool);
    const double energy_floor = fmax(noise_a.energy, noise_b.energy);
    const double ks_floor = fmax(noise_a.ks, noise_b.ks);
    json_t *comparison = json_pack(
        "{s:i, s:i, s:s, s:f, s:o, s:o, s:f, s:o, s:o, s:f}", "a", a, "b", b, "observable",
        pl_metric_table[observable].name, "energy_distance", energy, "energy_distance_floor",
        pl_json_number_or_null(energy_floor), "energy_distance_ratio", ratio(energy, energy_floor),
        "ks", ks, "ks_floor", pl_json_number_or_null(ks_floor), "ks_ratio", ratio(ks, ks_floor),
        "p", pl_permutation_p(&pool));
    pl_pool_free(&pool);
    return comparison;
}

/* Corrects the chances of all comparisons, of these observables, and says which tell the two apart. */
static void correct(const pl_ensemble_view *views, const int *observables, json_t *comparisons)
{
    const size_t count = json_array_size(comparisons);
    double *p = pl_heap_new(count, sizeof *p), *corrected = pl_heap_new(count, sizeof *corrected);
    size_t i;
    json_t *c;
    json_array_foreach(comparisons, i, c)
    {
        p[i] = pl_study_number(c, "p");
    }
    pl_holm(p, (int)count, corrected);
    json_array_foreach(comparisons, i, c)
    {
        const bool apart = corrected[i] < pl_significance;
        const pl_ensemble_view *a = &views[pl_study_integer(c, "a")];
        const pl_ensemble_view *b = &views[pl_study_integer(c, "b")];
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): each comparison has an observable */
        json_t *finding = apart ? sentence(a, b, observables[i], corrected[i]) : json_null();
        json_t *told = json_pack("{s:f, s:s, s:o}", "p_corrected", corrected[i], "verdict",
                                 apart ? "told apart" : "not told apart", "finding", finding);
        json_object_update(c, told);
        json_decref(told);
    }
    free(p);
    free(corrected);
}

json_t *pl_verdicts_reach(const pl_ensemble_view *views, int count)
{
    json_t *comparisons = json_array();
    int *observables = NULL, known = 0;
    for (int pair = 0; pair < count * count; ++pair) {
        const int a = pair / count, b = pair % count;
        for (int i = 0; i < PL_METRIC_COUNT && a < b; ++i) {
            const pl_sample *of_a = &views[a].observed.samples[i];
            const pl_sample *of_b = &views[b].observed.samples[i];
            if (comparable(&views[a].ensemble, &views[b].ensemble) && of_a->count > 1 &&
                of_b->count > 1 && !all_equal(of_a, of_b)) {
                json_array_append_new(comparisons, compare(views, a, b, i));
                pl_push(&observables, &known, &i, sizeof i);
            }
        }
    }
    correct(views, observables, comparisons);
    free(observables);
    return comparisons;
}
