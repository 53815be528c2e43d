#include "summary.h"

#include "permutation.h"
#include "plumb/jitter.h"
#include "text_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void number(double value, char text[32])
{
    if (isnan(value)) {
        snprintf(text, 32, "-");
    } else {
        snprintf(text, 32, "%.3g", value);
    }
}

/* "16 ok" or "14 ok, 2 crashed", and what is missing. */
static void outcomes_text(const pl_observations *observed, int members, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < PL_OUTCOME_COUNT && used < size; ++i) {
        if (observed->outcomes[i] > 0) {
            used += (size_t)snprintf(text + used, size - used, "%s%d %s", used == 0 ? "" : ", ",
                                     observed->outcomes[i], pl_outcome_name((pl_outcome)i));
        }
    }
    if (observed->results < members && used < size) {
        snprintf(text + used, size - used, "%s%d missing", used == 0 ? "" : ", ",
                 members - observed->results);
    }
}

static void horizon_text(const pl_horizon *horizon, char text[48])
{
    if (!horizon->known) {
        snprintf(text, 48, "unknown");
    } else if (isinf(horizon->time)) {
        snprintf(text, 48, "> %.3g s", horizon->last_time);
    } else {
        snprintf(text, 48, "%.3g s", horizon->time);
    }
}

static void add_engines(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                        int problem)
{
    static const char *const heads[] = {"Engine",     "Members",      "Horizon",   "Energy grew in",
                                        "by at most", "Fell through", "Not finite"};
    pl_text_table *table = pl_text_table_begin(heads, 7);
    for (int i = 0; i < all->count; ++i) {
        const pl_observations *observed = &views[i].observed;
        char outcomes[160], horizon[48], growth[32];
        if (all->items[i].problem != problem) {
            continue;
        }
        outcomes_text(observed, all->members, outcomes, sizeof outcomes);
        horizon_text(&views[i].horizon, horizon);
        number(observed->invariants.energy_growth, growth);
        pl_text_table_add(table, all->items[i].name);
        pl_text_table_add(table, outcomes);
        pl_text_table_add(table, horizon);
        pl_text_table_format(table, "%d", observed->invariants.energy_grew);
        pl_text_table_add(table, growth);
        pl_text_table_format(table, "%d", observed->invariants.fell_through);
        pl_text_table_format(table, "%d", observed->invariants.not_finite);
    }
    pl_text_table_end(table, out);
}

/* "value +- deviation" of every observable and ensemble. */
static void add_observables(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                            int problem)
{
    const char *heads[PL_OBSERVABLE_COUNT + 1] = {"Engine"};
    char head[PL_OBSERVABLE_COUNT][64];
    for (int i = 0; i < PL_OBSERVABLE_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[pl_observables[i]];
        snprintf(head[i], sizeof head[i], "%s (%s)", info->name, info->unit);
        heads[i + 1] = head[i];
    }
    pl_text_table *table = pl_text_table_begin(heads, PL_OBSERVABLE_COUNT + 1);
    for (int k = 0; k < all->count; ++k) {
        if (all->items[k].problem != problem) {
            continue;
        }
        pl_text_table_add(table, all->items[k].name);
        for (int i = 0; i < PL_OBSERVABLE_COUNT; ++i) {
            const pl_sample *sample = &views[k].observed.samples[i];
            char mean[32], deviation[32];
            number(sample->mean, mean);
            number(sample->deviation, deviation);
            if (sample->unsettled > 0) {
                pl_text_table_format(table, "%s ± %s (%d of %d never)", mean, deviation,
                                     sample->unsettled, sample->count);
            } else {
                pl_text_table_format(table, "%s ± %s", mean, deviation);
            }
        }
    }
    pl_text_table_end(table, out);
}

static void add_ratio(pl_text_table *table, double value, double floor)
{
    char text[32];
    number(floor > 0 ? value / floor : (double)NAN, text);
    pl_text_table_add(table, text);
}

static void add_comparisons(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                            const pl_verdicts *verdicts, int problem)
{
    static const char *const heads[] = {
        "Observable", "Engine A",   "Engine B",    "Mean A", "Mean B", "Energy distance / floor",
        "KS",         "KS / floor", "Corrected p", "Verdict"};
    pl_text_table *table = pl_text_table_begin(heads, 10);
    for (int k = 0; k < PL_OBSERVABLE_COUNT; ++k) {
        for (int i = 0; i < verdicts->count; ++i) {
            const pl_sample_test *c = &verdicts->items[i];
            if (c->observable != k || all->items[c->a].problem != problem) {
                continue;
            }
            pl_text_table_add(table, pl_metric_table[pl_observables[k]].name);
            pl_text_table_add(table, all->items[c->a].name);
            pl_text_table_add(table, all->items[c->b].name);
            pl_text_table_format(table, "%.4g", views[c->a].observed.samples[k].mean);
            pl_text_table_format(table, "%.4g", views[c->b].observed.samples[k].mean);
            add_ratio(table, c->energy, c->energy_floor);
            pl_text_table_format(table, "%.3g", c->ks);
            add_ratio(table, c->ks, c->ks_floor);
            pl_text_table_format(table, "%.2g", c->corrected);
            pl_text_table_add(table, c->apart ? "told apart" : "not told apart");
        }
    }
    pl_text_table_end(table, out);
}

static void add_differences(FILE *out, const pl_ensembles *all, const pl_ensemble_view *views,
                            const pl_verdicts *verdicts, int problem)
{
    int apart = 0, tests = 0;
    for (int i = 0; i < verdicts->count; ++i) {
        const pl_sample_test *c = &verdicts->items[i];
        if (all->items[c->a].problem != problem) {
            continue;
        }
        tests += 1;
        if (c->apart) {
            char sentence[512];
            pl_sample_test_sentence(views, c, sentence, sizeof sentence);
            fprintf(out, "- %s.\n", sentence);
            apart += 1;
        }
    }
    if (tests > 0) {
        fprintf(out, "%s%d of %d comparisons tell the two apart.\n\n", apart > 0 ? "\n" : "", apart,
                tests);
    }
}

/* The asked parameters, which two problems of one scenario differ by. */
static void add_title(FILE *out, const pl_case *problem)
{
    const pl_scenario *descriptor = problem->descriptor;
    fprintf(out, "## %s\n\n", problem->name);
    if (descriptor != NULL) {
        for (int i = 0; i < descriptor->param_count; ++i) {
            fprintf(out, "%s%s = %.6g", i == 0 ? "" : ", ", descriptor->params[i].name,
                    problem->params[i]);
        }
        fprintf(out, "\n\n");
    }
}

static void add_introduction(FILE *out, const pl_plan *plan, const pl_ensembles *all,
                             const pl_verdicts *verdicts)
{
    fprintf(out,
            "# Ensembles of %d members\n\n"
            "Every member starts with each body displaced by up to %g of its size along each axis\n"
            "and turned by up to %g rad, the same for every engine (seed %llu). Horizon: when the\n"
            "members of one engine lie farther apart than 1 %% of the smallest body. Energy grew:\n"
            "members in which it rose, in a step or above the start, by more than %g of the\n"
            "scene's. Fell through: members with a body beyond a plane. Means are followed by the\n"
            "standard deviation over members.\n\n"
            "Told apart: p below %g, by permutation of the energy distance, corrected (Holm) over\n"
            "all %d comparisons. The floor is what two ensembles of the same engine differ by on\n"
            "the mean, from its split halves: the larger of the two engines'.\n\n",
            all->members, pl_jitter_amplitude, pl_jitter_amplitude, (unsigned long long)plan->seed,
            pl_energy_growth, pl_significance, verdicts->count);
}

char *pl_ensemble_summary(const pl_plan *plan, const pl_ensembles *ensembles,
                          const pl_ensemble_view *views, const pl_verdicts *verdicts)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        return NULL;
    }
    add_introduction(out, plan, ensembles, verdicts);
    for (int p = 0; p < ensembles->problem_count; ++p) {
        const pl_ensemble *first = NULL;
        for (int i = 0; i < ensembles->count && first == NULL; ++i) {
            first = ensembles->items[i].problem == p ? &ensembles->items[i] : NULL;
        }
        if (first == NULL) {
            continue;
        }
        add_title(out, &plan->problems[first->problems[0]]);
        add_differences(out, ensembles, views, verdicts, p);
        add_engines(out, ensembles, views, p);
        add_observables(out, ensembles, views, p);
        add_comparisons(out, ensembles, views, verdicts, p);
    }
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}
