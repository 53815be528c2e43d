/* Finds where the home engine is worse than the best other one.
 *
 * Each of its runs is compared with the other engines' runs of the same case whose outcome is ok,
 * metric by metric. The best of them may be a different one for each metric, which is the hardest
 * test. */
#include "report_document.h"

#include "base/heap.h"
#include "sections.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Values below the floor of a metric (SI) are equal; add_rule says why. Double precision resolves 1.4e-14
 * m at 100 m; over 10^4 steps such errors add up to about 1e-10. A nanometre is far below what a simulation needs. */
static const double value_floor = 1e-9, relative_noise = 0.1;

/* Of two values below this (SI) the ratio means nothing: such a value is the residual that a solver
 * ended with, such as 1e-8 m/s, or rounding. */
static const double near_rounding_level = 1e-7;

static double floor_of(const pl_result_row *row, int metric)
{
    return fmax(fmax(value_floor, pl_metric_table[metric].noise),
                pl_metric_is(metric, PL_TRAIT_TO_ONE_STEP) ? row->dt : 0);
}

static bool is_measured(int metric)
{
    return pl_metric_is(metric, PL_TRAIT_MEASURED);
}

/* Times and memory of different machines are not compared. */
static bool comparable(const pl_result_cell *a, const pl_result_cell *b, int metric)
{
    return !is_measured(metric) ||
           (!a->hosts_differ && !b->hosts_differ && strcmp(a->worst->cpu, b->worst->cpu) == 0);
}

/* Whether the value is worse than `best` by more than noise. */
static bool is_worse(const pl_result_row *row, int metric, double value, double best)
{
    double level = fmax(best, floor_of(row, metric));
    return value - best > pl_metric_table[metric].noise &&
           value > (is_measured(metric) ? level * (1 + relative_noise) : level);
}

/* A case, and a metric of its cells. */
typedef struct comparison {
    const pl_result_table *results;
    const pl_result_case *test_case;
    int metric;
    pl_metric_summary *summaries; /* (count of cells) */
} comparison;

static const pl_result_configuration *configuration_of(const comparison *of, int cell)
{
    return &of->results->configurations[of->test_case->cells[cell].configuration];
}

/* Whether the cell is a run of another engine that ended ok. */
static bool is_good_other(const comparison *of, int cell)
{
    return !configuration_of(of, cell)->is_home &&
           pl_result_cell_is_ok(&of->test_case->cells[cell]);
}

/* Returns the cell of the other engine's ok run with the least value of the metric; -1: none. */
static int best_other(const comparison *of, int home)
{
    const pl_result_cell *cells = of->test_case->cells;
    int best = -1;
    for (int i = 0; i < of->test_case->count; ++i) {
        if (is_good_other(of, i) && of->summaries[i].state == PL_METRIC_VALUE &&
            !(is_measured(of->metric) && configuration_of(of, i)->runtime != NULL) &&
            comparable(&cells[home], &cells[i], of->metric) &&
            (best < 0 || of->summaries[i].value < of->summaries[best].value)) {
            best = i;
        }
    }
    return best;
}

static int first_good_other(const comparison *of)
{
    for (int i = 0; i < of->test_case->count; ++i) {
        if (is_good_other(of, i)) {
            return i;
        }
    }
    return -1;
}

static void add_loss(const comparison *of, int home, int best, pl_loss loss, pl_losses *losses)
{
    loss.metric = of->metric;
    loss.home = &of->test_case->cells[home];
    loss.best = &of->test_case->cells[best];
    pl_push(&losses->items, &losses->count, &loss, sizeof loss);
}

/* Compares a metric of a run that ended ok. */
static void compare_metric(const comparison *of, int home, pl_losses *losses)
{
    const pl_metric_summary *own = &of->summaries[home];
    const int best = own->state == PL_METRIC_ABSENT ? -1 : best_other(of, home);
    if (best < 0) {
        return;
    }
    const pl_result_row *row = of->test_case->row;
    const double best_value = of->summaries[best].value;
    ++losses->comparisons;
    if (own->state != PL_METRIC_VALUE) {
        add_loss(of, home, best, (pl_loss){.kind = PL_LOSS_NO_VALUE, .ratio = (double)INFINITY},
                 losses);
    } else if (is_worse(row, of->metric, own->value, best_value)) {
        const pl_loss loss = {.kind = PL_LOSS_VALUE,
                              .ratio = own->value / fmax(best_value, floor_of(row, of->metric)),
                              .near_rounding =
                                  !is_measured(of->metric) && own->value < near_rounding_level};
        add_loss(of, home, best, loss, losses);
    }
}

/* Adds a run that failed: one loss, not one for each metric. */
static void add_failure(const comparison *of, int home, pl_losses *losses)
{
    const int best = best_other(of, home);
    ++losses->comparisons;
    add_loss(of, home, best < 0 ? first_good_other(of) : best,
             (pl_loss){.kind = PL_LOSS_OUTCOME, .ratio = (double)INFINITY}, losses);
}

/* Compares the runs of a case by one metric; failed runs by the primary error. */
static void compare_by(comparison *of, int metric, pl_losses *losses)
{
    const bool is_shown =
        pl_metric_is(metric, PL_TRAIT_COMPARED) && !pl_case_primary_is(of->test_case, metric);
    of->metric = metric; /* reference_error is the primary error once more */
    for (int i = 0; i < of->test_case->count; ++i) {
        of->summaries[i] = pl_result_cell_metric(&of->test_case->cells[i], metric);
    }
    for (int i = 0; i < of->test_case->count; ++i) {
        const bool is_ok = pl_result_cell_is_ok(&of->test_case->cells[i]);
        if (configuration_of(of, i)->is_home && is_ok && is_shown) {
            compare_metric(of, i, losses);
        } else if (configuration_of(of, i)->is_home && !is_ok &&
                   metric == PL_METRIC_REFERENCE_ERROR) {
            add_failure(of, i, losses);
        }
    }
}

static void compare_case(const pl_result_table *results, const pl_result_case *test_case,
                         pl_losses *losses)
{
    comparison of = {.results = results,
                     .test_case = test_case,
                     .summaries = pl_heap_new((size_t)test_case->count, sizeof *of.summaries)};
    const int before = losses->comparisons;
    const bool has_home = results->configurations[test_case->cells[0].configuration].is_home;
    for (int id = 0; id < PL_METRIC_COUNT && has_home && first_good_other(&of) >= 0; ++id) {
        compare_by(&of, id, losses);
    }
    losses->cases += losses->comparisons > before;
    free(of.summaries);
}

/* What matters most to a user comes first: 0. */
static int rank_of(const pl_loss *loss)
{
    if (loss->kind == PL_LOSS_OUTCOME) {
        return 0;
    }
    if (loss->near_rounding) {
        return 3;
    }
    return loss->metric == PL_METRIC_REFERENCE_ERROR || loss->metric == PL_METRIC_TIME_PER_STEP ? 1
                                                                                                : 2;
}

static int compare_losses(const void *left, const void *right)
{
    const pl_loss *a = left, *b = right;
    int order = rank_of(a) - rank_of(b);
    order = order != 0 ? order : (a->ratio < b->ratio) - (a->ratio > b->ratio);
    order = order != 0 ? order : a->home->test_case - b->home->test_case;
    order = order != 0 ? order : a->metric - b->metric;
    return order != 0 ? order : a->home->configuration - b->home->configuration;
}

void pl_losses_find(const pl_result_table *results, pl_losses *losses)
{
    *losses = (pl_losses){.results = results};
    for (int i = 0; i < results->case_count; ++i) {
        compare_case(results, &results->cases[i], losses);
    }
    if (losses->count > 0) {
        qsort(losses->items, (size_t)losses->count, sizeof *losses->items, compare_losses);
    }
}

/* ---- In words ---- */

static bool has_others(const pl_result_table *results)
{
    for (int i = 0; i < results->configuration_count; ++i) {
        if (!results->configurations[i].is_home) {
            return true;
        }
    }
    return false;
}

static void add_statement(const pl_losses *losses, pl_document *document)
{
    const char *home = losses->results->home;
    if (losses->comparisons == 0) {
        pl_document_paragraph(document,
                              has_others(losses->results)
                                  ? "Nothing was compared: there is no case that %s was run on and "
                                    "that another engine ended with outcome ok."
                                  : "Nothing was compared: these results hold no engine but %s.",
                              home);
        return;
    }
    char *own = pl_engine_names(losses->results, true);
    char *others = pl_engine_names(losses->results, false);
    char *count = losses->count == 0
                      ? pl_heap_format("No losses: in none of %d comparisons is %s worse than the "
                                       "best other engine",
                                       losses->comparisons, home)
                      : pl_heap_format("%s is worse than the best other engine in %d of %d "
                                       "comparisons",
                                       home, losses->count, losses->comparisons);
    pl_document_paragraph(document, "%s, over %d %s: %s against the best of %s.", count,
                          losses->cases, losses->cases == 1 ? "case" : "cases", own, others);
    free(count);
    free(own);
    free(others);
}

/* Adds an engine and its value, marked if the run of another engine is inaccurate. */
static void add_value(const pl_result_table *results, const pl_loss *loss,
                      const pl_result_cell *cell, pl_table *table)
{
    char text[PL_METRIC_TEXT_SIZE];
    const bool is_inaccurate = cell == loss->best && cell->worst->verdict == PL_VERDICT_INACCURATE;
    const pl_metric_summary value = pl_result_cell_metric(cell, loss->metric);
    pl_metric_text(&value, text);
    pl_table_add(table, results->configurations[cell->configuration].name);
    if (loss->kind == PL_LOSS_OUTCOME) {
        pl_table_add(table, pl_outcome_name(cell->worst->outcome));
    } else {
        pl_table_format_cell(table, "%s%s", text, is_inaccurate ? " (inaccurate)" : "");
    }
}

static void add_row(const pl_result_table *results, const pl_loss *loss, pl_table *table)
{
    const char *primary = loss->home->worst->primary_error;
    char ratio[PL_QUANTITY_SIZE];
    pl_table_add(table, results->cases[loss->home->test_case].name);
    if (loss->kind == PL_LOSS_OUTCOME) {
        pl_table_add(table, "outcome");
    } else if (loss->metric == PL_METRIC_REFERENCE_ERROR && primary[0] != '\0') {
        pl_table_format_cell(table, "%s (%s)", pl_metric_table[loss->metric].name, primary);
    } else {
        pl_table_add(table, pl_metric_table[loss->metric].name);
    }
    add_value(results, loss, loss->home, table);
    add_value(results, loss, loss->best, table);
    pl_format_ratio(loss->ratio, ratio);
    pl_table_add(table, loss->near_rounding           ? "both near rounding"
                        : loss->kind == PL_LOSS_VALUE ? ratio
                                                      : pl_no_number);
    pl_table_style(table, "bad");
}

/* Adds which metrics count, and which differences do not. */
static void add_rule(pl_document *document)
{
    pl_text_buffer text = {0};
    pl_text_add(&text,
                "Compared, metric by metric and lower is better, with the best run of another "
                "engine whose outcome is ok: ");
    const char *separator = "";
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        if (!pl_metric_is(id, PL_TRAIT_COMPARED)) {
            continue;
        }
        pl_text_format(&text, "%s%s", separator, pl_metric_table[id].name);
        separator = ", ";
    }
    pl_text_add(
        &text,
        ". Iterations and residuals are left out: they mean different things to different solvers. "
        "Of the times, those of a step are compared. A difference below noise is no loss. A value "
        "below its floor counts as the "
        "floor, also in the ratio: 1e-9 for lengths (m), speeds (m/s), angles (rad) and relative "
        "numbers, since rounding in double precision over a run of thousands of steps reaches "
        "about 1e-10; one time step for settle_time, which is not known more closely; 256 KiB for "
        "memory_peak, since memory is counted in pages and taken ahead of need. Times and memory "
        "within 10 %, and memory within 256 KiB, are equal; both are compared only on one machine. "
        "A failed run of the home engine counts once. Failed runs come first, then the primary "
        "error and the "
        "time of a step, then other metrics, each by the ratio; last those of which both values "
        "are "
        "below 1e-7, near rounding and the tolerances of solvers.");
    pl_document_words(document, &text);
}

void pl_losses_describe(const pl_losses *losses, int shown, bool is_short, pl_document *document)
{
    pl_table table = {.last = shown};
    if (losses->results->home == NULL) {
        return;
    }
    pl_table_columns(&table, "case|metric|home|>value|best other|>value|>ratio");
    for (int i = 0; i < losses->count; ++i) {
        add_row(losses->results, &losses->items[i], &table);
    }
    pl_document_heading(document, "Where %s loses", losses->results->home);
    add_statement(losses, document);
    pl_document_table(document, "Comparisons that the home engine loses", &table);
    if (!is_short) {
        add_rule(document);
    }
}
