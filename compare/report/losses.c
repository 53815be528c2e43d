/* Finds where our engine is worse than the best other one.
 *
 * Each of our runs is compared with the other engines' runs of the same case whose outcome is ok,
 * metric by metric. The best of them may be a different one for each metric, which is the hardest
 * test. */
#include "losses.h"

#include "number_format.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Values below the floor of a metric are equal.
 *
 * Lengths, speeds, angles and relative numbers: 1e-9 (SI). Double precision resolves 1.4e-14 m at
 * 100 m; over 10^4 steps such errors add up to about 1e-10. So a smaller value is rounding, of the
 * engine or of the referee, and a nanometre is far below what a simulation needs.
 *
 * Memory is counted in whole pages, and the allocator takes some ahead of need: 256 KiB. The time
 * to rest is known to one step. */
static const double value_floor = 1e-9, relative_noise = 0.1;

/* Of two values below this (SI) the ratio means nothing: such a value is the residual that a solver
 * ended with, as ours at a tolerance of 1e-8 m/s, or rounding. */
static const double near_rounding_level = 1e-7;

static double floor_of(const pl_case *test_case, int metric)
{
    const json_t *settings = json_object_get(test_case->result, "settings");
    const double step = json_number_value(json_object_get(settings, "dt"));
    return fmax(fmax(value_floor, pl_metric_table[metric].noise),
                pl_metric_is(metric, PL_TRAIT_TO_ONE_STEP) ? step : 0);
}

static bool is_measured(int metric)
{
    return pl_metric_is(metric, PL_TRAIT_MEASURED);
}

/* Times and memory of different machines are not compared. */
static bool comparable(const pl_cell *a, const pl_cell *b, int metric)
{
    return !is_measured(metric) || (!a->mixed_hosts && !b->mixed_hosts &&
                                    strcmp(pl_result_text(a->result, "host", "cpu"),
                                           pl_result_text(b->result, "host", "cpu")) == 0);
}

/* Whether the value is worse than `best` by more than noise. */
static bool is_worse(const pl_case *test_case, int metric, double value, double best)
{
    double level = fmax(best, floor_of(test_case, metric));
    return value - best > pl_metric_table[metric].noise &&
           value > (is_measured(metric) ? level * (1 + relative_noise) : level);
}

/* Returns the column of the other engine's ok run with the least value of the metric; -1: none. */
static int best_other(const pl_result_matrix *matrix, const pl_case *test_case, const pl_cell *ours,
                      int metric)
{
    int best = -1;
    for (int i = 0; i < matrix->column_count; ++i) {
        const pl_cell *cell = &test_case->cells[i];
        if (matrix->columns[i].ours || cell->result == NULL || !cell->ok ||
            (is_measured(metric) && matrix->columns[i].runtime != NULL) ||
            cell->metrics[metric].state != PL_METRIC_VALUE || !comparable(ours, cell, metric)) {
            continue;
        }
        if (best < 0 ||
            cell->metrics[metric].value < test_case->cells[best].metrics[metric].value) {
            best = i;
        }
    }
    return best;
}

static int first_good_other(const pl_result_matrix *matrix, const pl_case *test_case)
{
    for (int i = 0; i < matrix->column_count; ++i) {
        if (!matrix->columns[i].ours && test_case->cells[i].result != NULL &&
            test_case->cells[i].ok) {
            return i;
        }
    }
    return -1;
}

static void compare_metric(const pl_result_matrix *matrix, pl_loss loss, int metric,
                           pl_losses *losses)
{
    const pl_metric_summary *ours = &loss.our_cell->metrics[metric];
    /* reference_error is the same number. */
    if (ours->state == PL_METRIC_ABSENT || pl_case_primary_is(loss.test_case, metric)) {
        return;
    }
    int best = best_other(matrix, loss.test_case, loss.our_cell, metric);
    if (best < 0) {
        return;
    }
    ++losses->comparisons;
    loss.metric = metric;
    loss.best = &matrix->columns[best];
    loss.best_cell = &loss.test_case->cells[best];
    if (ours->state != PL_METRIC_VALUE) {
        loss.kind = PL_LOSS_NO_VALUE;
        losses->items[losses->count++] = loss;
        return;
    }
    double our_value = ours->value;
    double best_value = loss.best_cell->metrics[metric].value;
    if (!is_worse(loss.test_case, metric, our_value, best_value)) {
        return;
    }
    loss.kind = PL_LOSS_VALUE;
    loss.ratio = our_value / fmax(best_value, floor_of(loss.test_case, metric));
    loss.near_rounding = !is_measured(metric) && our_value < near_rounding_level;
    losses->items[losses->count++] = loss;
}

/* Compares a run of ours with the others. A failed run is one loss, not one for each metric. */
static void compare_run(const pl_result_matrix *matrix, pl_loss loss, pl_losses *losses)
{
    int other = first_good_other(matrix, loss.test_case);
    if (other < 0) {
        return;
    }
    if (loss.our_cell->ok) {
        for (int id = 0; id < PL_METRIC_COUNT; ++id) {
            if (pl_metric_is(id, PL_TRAIT_COMPARED)) {
                compare_metric(matrix, loss, id, losses);
            }
        }
        return;
    }
    int best = best_other(matrix, loss.test_case, loss.our_cell, PL_METRIC_REFERENCE_ERROR);
    if (best < 0) {
        best = other;
    }
    loss.kind = PL_LOSS_OUTCOME;
    loss.best = &matrix->columns[best];
    loss.best_cell = &loss.test_case->cells[best];
    ++losses->comparisons;
    losses->items[losses->count++] = loss;
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
    if (rank_of(a) != rank_of(b)) {
        return rank_of(a) < rank_of(b) ? -1 : 1;
    }
    if (a->ratio != b->ratio) {
        return a->ratio > b->ratio ? -1 : 1;
    }
    if (a->test_case != b->test_case) {
        return a->test_case < b->test_case ? -1 : 1;
    }
    if (a->metric != b->metric) {
        return a->metric < b->metric ? -1 : 1;
    }
    return (a->ours > b->ours) - (a->ours < b->ours);
}

static void write_statement(const pl_losses *losses, const pl_result_matrix *matrix,
                            pl_text_buffer *text)
{
    if (!losses->others_present) {
        pl_text_add(text, "Nothing was compared: these results hold no other engine.");
        return;
    }
    if (losses->comparisons == 0) {
        pl_text_add(text, "Nothing was compared: there is no case that plumb was run on and that "
                          "another engine ended with outcome ok.");
        return;
    }
    if (losses->count == 0) {
        pl_text_format(text,
                       "No losses: in none of %d comparisons is plumb worse than the best other "
                       "engine",
                       losses->comparisons);
    } else {
        pl_text_format(text, "plumb is worse than the best other engine in %d of %d comparisons",
                       losses->count, losses->comparisons);
    }
    pl_text_format(text, ", over %d %s: ", losses->cases, losses->cases == 1 ? "case" : "cases");
    pl_result_matrix_engines(matrix, true, text);
    pl_text_add(text, " against the best of ");
    pl_result_matrix_engines(matrix, false, text);
    pl_text_add(text, ".");
}

static void write_rule(pl_text_buffer *text)
{
    pl_text_add(text,
                "Compared, metric by metric and lower is better, with the best run of another "
                "engine whose outcome is ok: ");
    const char *separator = "";
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        if (!pl_metric_is(id, PL_TRAIT_COMPARED)) {
            continue;
        }
        pl_text_format(text, "%s%s", separator, pl_metric_table[id].name);
        separator = ", ";
    }
    pl_text_add(
        text,
        ". Iterations and residuals are left out: they mean different things to different solvers. "
        "Of the times, those of a step are compared. A difference below noise is no loss. A value "
        "below its floor counts as the "
        "floor, also in the ratio: 1e-9 for lengths (m), speeds (m/s), angles (rad) and relative "
        "numbers, since rounding in double precision over a run of thousands of steps reaches "
        "about 1e-10; one time step for settle_time, which is not known more closely; 256 KiB for "
        "memory_peak, since memory is counted in pages and taken ahead of need. Times and memory "
        "within 10 %, and memory within 256 KiB, are equal; both are compared only on one machine. "
        "A failed run of ours counts once. Failed runs come first, then the primary error and the "
        "time of a step, then other metrics, each by the ratio; last those of which both values "
        "are "
        "below 1e-7, near rounding and the tolerances of solvers.");
}

pl_status pl_losses_find(const pl_result_matrix *matrix, pl_losses *losses, pl_error *error)
{
    *losses = (pl_losses){0};
    size_t most = (size_t)matrix->case_count * (size_t)matrix->column_count * PL_METRIC_COUNT;
    losses->items = calloc(most + 1, sizeof *losses->items);
    if (losses->items == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu comparisons", most);
    }
    for (int i = 0; i < matrix->column_count; ++i) {
        losses->ours_present |= matrix->columns[i].ours;
        losses->others_present |= !matrix->columns[i].ours;
    }
    for (int b = 0; b < matrix->case_count; ++b) {
        const pl_case *test_case = &matrix->cases[b];
        int before = losses->comparisons;
        for (int i = 0; i < matrix->column_count; ++i) {
            pl_loss loss = {.test_case = test_case,
                            .ours = &matrix->columns[i],
                            .our_cell = &test_case->cells[i],
                            .ratio = (double)INFINITY};
            if (matrix->columns[i].ours && test_case->cells[i].result != NULL) {
                compare_run(matrix, loss, losses);
            }
        }
        losses->cases += losses->comparisons > before;
    }
    qsort(losses->items, (size_t)losses->count, sizeof *losses->items, compare_losses);
    write_statement(losses, matrix, &losses->statement);
    write_rule(&losses->rule);
    if (losses->statement.failed || losses->rule.failed) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for the statement of losses");
    }
    return PL_OK;
}

void pl_losses_free(pl_losses *losses)
{
    free(losses->items);
    pl_text_free(&losses->statement);
    pl_text_free(&losses->rule);
    *losses = (pl_losses){0};
}

void pl_loss_texts(const pl_loss *loss, char metric[PL_LOSS_TEXT_SIZE],
                   char ours[PL_LOSS_TEXT_SIZE], char best[PL_LOSS_TEXT_SIZE],
                   char ratio[PL_LOSS_TEXT_SIZE])
{
    if (loss->kind == PL_LOSS_OUTCOME) {
        snprintf(metric, PL_LOSS_TEXT_SIZE, "outcome");
        snprintf(ours, PL_LOSS_TEXT_SIZE, "%.150s", loss->our_cell->outcome);
        snprintf(best, PL_LOSS_TEXT_SIZE, "%.150s", loss->best_cell->outcome);
        snprintf(ratio, PL_LOSS_TEXT_SIZE, "%s", pl_no_number);
        return;
    }
    bool primary =
        loss->metric == PL_METRIC_REFERENCE_ERROR && loss->test_case->primary_error[0] != '\0';
    snprintf(metric, PL_LOSS_TEXT_SIZE, "%s%s%.100s%s", pl_metric_table[loss->metric].name,
             primary ? " (" : "", primary ? loss->test_case->primary_error : "",
             primary ? ")" : "");
    pl_metric_text(&loss->our_cell->metrics[loss->metric], ours);
    pl_metric_text(&loss->best_cell->metrics[loss->metric], best);
    if (loss->best_cell->verdict == PL_VERDICT_INACCURATE) {
        const size_t used = strlen(best);
        snprintf(best + used, PL_LOSS_TEXT_SIZE - used, " (inaccurate)");
    }
    if (loss->near_rounding) {
        snprintf(ratio, PL_LOSS_TEXT_SIZE, "both near rounding");
    } else if (loss->kind == PL_LOSS_VALUE) {
        pl_format_ratio(loss->ratio, ratio);
    } else {
        snprintf(ratio, PL_LOSS_TEXT_SIZE, "%s", pl_no_number);
    }
}
