/* Finds where our engine is worse than the best other one.
 *
 * Each of our runs is held against the other engines' runs of the same problem whose outcome is ok,
 * metric by metric; the best of them may be a different one for each metric, which is the hardest
 * test. */
#include "report/losses.h"

#include "report/quantity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All are better when lower. iterations_mean is left out: an iteration of one solver is not the
 * unit of work of another's. */
static const pl_metric_id compared[] = {PL_METRIC_REFERENCE_ERROR, PL_METRIC_REST_ROTATION_ERROR,
                                        PL_METRIC_PENETRATION_MAX, PL_METRIC_PENETRATION_REST,
                                        PL_METRIC_DRIFT,           PL_METRIC_CREEP,
                                        PL_METRIC_ENERGY_GAIN,     PL_METRIC_MOMENTUM_ERROR,
                                        PL_METRIC_SETTLE_TIME,     PL_METRIC_TIME_PER_STEP,
                                        PL_METRIC_MEMORY_PEAK};
enum { COMPARED_COUNT = sizeof compared / sizeof compared[0] };

static const double measurement_noise = 0.1; /* relative: of times and memory */

static bool is_measured(int metric)
{
    return !pl_metric_table[metric].deterministic;
}

/* Times and memory of different machines are not held against each other. */
static bool comparable(const pl_cell *a, const pl_cell *b, int metric)
{
    return !is_measured(metric) || (!a->mixed_hosts && !b->mixed_hosts &&
                                    strcmp(pl_row_text_in(a->row, "host", "cpu"),
                                           pl_row_text_in(b->row, "host", "cpu")) == 0);
}

static bool is_worse(double ours, double best, int metric)
{
    if (ours < PL_LOSS_ROUNDING && best < PL_LOSS_ROUNDING)
        return false;
    return ours > (is_measured(metric) ? best * (1 + measurement_noise) : best);
}

/* The other engine's ok run with the least value of the metric; -1 when there is none. */
static int best_other(const pl_cells *cells, const pl_block *block, const pl_cell *ours, int metric)
{
    int best = -1;
    for (int i = 0; i < cells->column_count; i++) {
        const pl_cell *cell = &block->cells[i];
        if (cells->columns[i].ours || cell->row == NULL || !cell->ok ||
            cell->measure[metric].state != PL_METRIC_VALUE || !comparable(ours, cell, metric))
            continue;
        if (best < 0 || cell->measure[metric].value < block->cells[best].measure[metric].value)
            best = i;
    }
    return best;
}

static int first_good_other(const pl_cells *cells, const pl_block *block)
{
    for (int i = 0; i < cells->column_count; i++)
        if (!cells->columns[i].ours && block->cells[i].row != NULL && block->cells[i].ok)
            return i;
    return -1;
}

static void compare_metric(const pl_cells *cells, pl_loss loss, int metric, pl_losses *losses)
{
    const pl_measure *ours = &loss.our_cell->measure[metric];
    /* reference_error says the same already. */
    if (ours->state == PL_METRIC_ABSENT || pl_block_primary_is(loss.block, metric))
        return;
    int best = best_other(cells, loss.block, loss.our_cell, metric);
    if (best < 0)
        return;
    losses->comparisons++;
    loss.metric = metric;
    loss.best = &cells->columns[best];
    loss.best_cell = &loss.block->cells[best];
    if (ours->state != PL_METRIC_VALUE) {
        loss.kind = PL_LOSS_NO_VALUE;
        losses->items[losses->count++] = loss;
        return;
    }
    double our_value = ours->value;
    double best_value = loss.best_cell->measure[metric].value;
    if (!is_worse(our_value, best_value, metric))
        return;
    loss.kind = PL_LOSS_VALUE;
    loss.ratio = best_value > 0 ? our_value / best_value : (double)INFINITY;
    losses->items[losses->count++] = loss;
}

/* A run of ours against the others: a failed run is one loss, not one a metric. */
static void compare_run(const pl_cells *cells, pl_loss loss, pl_losses *losses)
{
    int other = first_good_other(cells, loss.block);
    if (other < 0)
        return;
    if (loss.our_cell->ok) {
        for (int i = 0; i < COMPARED_COUNT; i++)
            compare_metric(cells, loss, (int)compared[i], losses);
        return;
    }
    int best = best_other(cells, loss.block, loss.our_cell, PL_METRIC_REFERENCE_ERROR);
    if (best < 0)
        best = other;
    loss.kind = PL_LOSS_OUTCOME;
    loss.best = &cells->columns[best];
    loss.best_cell = &loss.block->cells[best];
    losses->comparisons++;
    losses->items[losses->count++] = loss;
}

static int compare_losses(const void *left, const void *right)
{
    const pl_loss *a = left, *b = right;
    if (a->kind != b->kind)
        return a->kind < b->kind ? -1 : 1;
    if (a->ratio != b->ratio)
        return a->ratio > b->ratio ? -1 : 1;
    if (a->block != b->block)
        return a->block < b->block ? -1 : 1;
    if (a->metric != b->metric)
        return a->metric < b->metric ? -1 : 1;
    return (a->ours > b->ours) - (a->ours < b->ours);
}

pl_status pl_losses_find(const pl_cells *cells, pl_losses *losses, pl_error *error)
{
    *losses = (pl_losses){0};
    size_t most = (size_t)cells->block_count * (size_t)cells->column_count * COMPARED_COUNT;
    losses->items = calloc(most + 1, sizeof *losses->items);
    if (losses->items == NULL)
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu comparisons", most);
    for (int i = 0; i < cells->column_count; i++) {
        losses->ours_present |= cells->columns[i].ours;
        losses->others_present |= !cells->columns[i].ours;
    }
    for (int b = 0; b < cells->block_count; b++) {
        const pl_block *block = &cells->blocks[b];
        int before = losses->comparisons;
        for (int i = 0; i < cells->column_count; i++) {
            pl_loss loss = {.block = block,
                            .ours = &cells->columns[i],
                            .our_cell = &block->cells[i],
                            .ratio = (double)INFINITY};
            if (cells->columns[i].ours && block->cells[i].row != NULL)
                compare_run(cells, loss, losses);
        }
        losses->problems += losses->comparisons > before;
    }
    qsort(losses->items, (size_t)losses->count, sizeof *losses->items, compare_losses);
    return PL_OK;
}

void pl_losses_free(pl_losses *losses)
{
    free(losses->items);
    *losses = (pl_losses){0};
}

static void list_columns(const pl_cells *cells, bool ours, pl_sheet *sheet)
{
    const char *separator = "";
    for (int i = 0; i < cells->column_count; i++) {
        if (cells->columns[i].ours != ours)
            continue;
        pl_sheet_format(sheet, "%s%s", separator, cells->columns[i].name);
        separator = ", ";
    }
}

void pl_losses_statement(const pl_losses *losses, const pl_cells *cells, pl_sheet *sheet)
{
    if (!losses->ours_present || !losses->others_present) {
        pl_sheet_add(sheet, losses->ours_present
                                ? "Nothing was compared: these results hold no other engine."
                                : "Nothing was compared: plumb itself was not run.");
        return;
    }
    if (losses->comparisons == 0) {
        pl_sheet_add(sheet,
                     "Nothing was compared: there is no problem that plumb was run on and that "
                     "another engine ended with outcome ok.");
        return;
    }
    if (losses->count == 0)
        pl_sheet_format(sheet, "No losses: in none of %d comparisons", losses->comparisons);
    else
        pl_sheet_format(sheet, "plumb is worse than the best other engine in %d of %d comparisons",
                        losses->count, losses->comparisons);
    if (losses->count == 0)
        pl_sheet_add(sheet, " is plumb worse than the best other engine");
    pl_sheet_format(sheet, ", over %d %s: ", losses->problems,
                    losses->problems == 1 ? "problem" : "problems");
    list_columns(cells, true, sheet);
    pl_sheet_add(sheet, " against the best of ");
    list_columns(cells, false, sheet);
    pl_sheet_add(sheet, ".");
}

void pl_losses_rule(pl_sheet *sheet)
{
    pl_sheet_add(sheet,
                 "Compared, metric by metric and lower is better, with the best run of another "
                 "engine whose outcome is ok: ");
    for (int i = 0; i < COMPARED_COUNT; i++)
        pl_sheet_format(sheet, "%s%s", i == 0 ? "" : ", ", pl_metric_table[compared[i]].name);
    pl_sheet_add(
        sheet,
        ". Iteration counts are left out: an iteration of one solver is not the unit of work of "
        "another's. No loss is a difference below noise: both numbers below 1e-12 (SI), or times "
        "and memory within 10 %; these are compared only on one machine. A failed run of ours "
        "counts once.");
}

void pl_loss_texts(const pl_loss *loss, char metric[PL_LOSS_TEXT_SIZE],
                   char ours[PL_LOSS_TEXT_SIZE], char best[PL_LOSS_TEXT_SIZE],
                   char ratio[PL_LOSS_TEXT_SIZE])
{
    if (loss->kind == PL_LOSS_OUTCOME) {
        snprintf(metric, PL_LOSS_TEXT_SIZE, "outcome");
        snprintf(ours, PL_LOSS_TEXT_SIZE, "%.150s", loss->our_cell->outcome);
        snprintf(best, PL_LOSS_TEXT_SIZE, "%.150s", loss->best_cell->outcome);
        snprintf(ratio, PL_LOSS_TEXT_SIZE, "%s", pl_quantity_missing);
        return;
    }
    bool primary =
        loss->metric == PL_METRIC_REFERENCE_ERROR && loss->block->primary_error[0] != '\0';
    snprintf(metric, PL_LOSS_TEXT_SIZE, "%s%s%.100s%s", pl_metric_table[loss->metric].name,
             primary ? " (" : "", primary ? loss->block->primary_error : "", primary ? ")" : "");
    pl_measure_text(&loss->our_cell->measure[loss->metric], ours, PL_LOSS_TEXT_SIZE);
    pl_measure_text(&loss->best_cell->measure[loss->metric], best, PL_LOSS_TEXT_SIZE);
    if (loss->kind == PL_LOSS_VALUE)
        pl_quantity_ratio(loss->ratio, ratio);
    else
        snprintf(ratio, PL_LOSS_TEXT_SIZE, "%s", pl_quantity_missing);
}
