/* The tables of all scenes together. */
#include "sweep_tables.h"

#include "quantity.h"
#include "sweep_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *engine_name(const pl_sweep_analysis *analysis, int engine)
{
    return analysis->engines[engine].name;
}

void pl_sweep_statement(const pl_sweep_analysis *analysis, pl_text_buffer *out)
{
    bool ours = false, others = false;
    int within = 0;
    for (int i = 0; i < analysis->engine_count; i++) {
        ours |= analysis->engines[i].ours;
        others |= !analysis->engines[i].ours;
    }
    for (int i = 0; i < analysis->loss_count; i++)
        within += analysis->losses[i].within_noise;
    if (!ours || !others) {
        pl_text_add(out, ours ? "Nothing was compared: these results hold no other engine."
                              : "Nothing was compared: plumb itself was not run.");
    } else if (analysis->compared == 0) {
        pl_text_add(out, "Nothing was compared: on no problem did plumb or another engine that "
                         "was run on it reach any error asked for.");
    } else if (analysis->loss_count == 0) {
        pl_text_format(out,
                       "No losses: in none of %d comparisons (problem, engine, error) is another "
                       "engine's front ahead of plumb's.",
                       analysis->compared);
    } else {
        pl_text_format(out,
                       "Another engine's front is ahead of plumb's in %d of %d comparisons "
                       "(problem, engine, error): in %d at errors up to 1e-3, in %d at larger "
                       "ones; %d of all are within noise.",
                       analysis->loss_count, analysis->compared, analysis->fine_losses,
                       analysis->loss_count - analysis->fine_losses, within);
    }
    if (analysis->unjudged > 0)
        pl_text_format(out, " %d of %d problems have no primary error and are not judged.",
                       analysis->unjudged, analysis->scene_count);
}

void pl_sweep_warning(const pl_sweep_analysis *analysis, pl_text_buffer *out)
{
    if (analysis->several_hosts)
        pl_text_add(out, "These runs come from several processors: ratios of time between them "
                         "mean little. ");
    if (analysis->several_builds)
        pl_text_add(out, "These runs come from several builds of plumb or versions of an "
                         "engine, which share a front here. ");
}

void pl_sweep_losses_table(const pl_sweep_analysis *analysis, pl_sweep_table *table)
{
    *table = (pl_sweep_table){
        .columns = 7,
        .heads = {"Problem", "Error", "Ahead", "its cost", "plumb's cost", "Speed", ""},
        .numeric = {false, true, false, true, true, true, false}};
    for (int i = 0; i < analysis->loss_count; i++) {
        const pl_sweep_loss *loss = &analysis->losses[i];
        const pl_sweep_pair *pair = &analysis->pairs[loss->pair];
        char cost[PL_SWEEP_TEXT_SIZE], speed[PL_SWEEP_TEXT_SIZE];
        pl_sweep_table_add(table, "%s", analysis->scenes[loss->scene].name);
        pl_sweep_power_text(pl_sweep_levels[loss->level], cost);
        pl_sweep_table_add(table, "%s", cost);
        pl_sweep_table_add(table, "%s", engine_name(analysis, pair->other));
        pl_sweep_cost_text(analysis->points[loss->other].cost, cost);
        pl_sweep_table_add(table, "%s", cost);
        if (loss->ours >= 0)
            pl_sweep_cost_text(analysis->points[loss->ours].cost, cost);
        pl_sweep_table_add(table, "%s", loss->ours >= 0 ? cost : "not reached");
        pl_sweep_ratio_text(&loss->speed, speed);
        pl_sweep_table_add(table, "%s", loss->ours >= 0 ? speed : pl_quantity_missing);
        pl_sweep_table_add(table, "%s", loss->within_noise ? "within noise" : "");
    }
}

static void add_count(pl_sweep_table *table, int count, int scenes)
{
    if (count == 0)
        pl_sweep_table_add(table, "none");
    else
        pl_sweep_table_add(table, "%d of %d problems: never reached", count, scenes);
}

void pl_sweep_means_table(const pl_sweep_analysis *analysis, bool whole, int level,
                          pl_sweep_table *table)
{
    *table = (pl_sweep_table){.columns = 6,
                              .heads = {"Ours", "Other", "Mean speed", "Problems both reach",
                                        "The other alone fails", "Ours alone fails"},
                              .numeric = {false, false, true, true, false, false}};
    for (int i = 0; i < analysis->pair_count; i++) {
        const pl_sweep_pair *pair = &analysis->pairs[i];
        char speed[PL_SWEEP_TEXT_SIZE];
        if (analysis->engines[pair->ours].whole != whole || pair->scenes == 0)
            continue;
        pl_sweep_ratio_text(&pair->mean[level], speed);
        pl_sweep_table_add(table, "%s", engine_name(analysis, pair->ours));
        pl_sweep_table_add(table, "%s", engine_name(analysis, pair->other));
        pl_sweep_table_add(table, "%s", speed);
        pl_sweep_table_add(table, "%d of %d", pair->both[level], pair->scenes);
        add_count(table, pair->ours_only[level], pair->scenes);
        add_count(table, pair->other_only[level], pair->scenes);
    }
}

void pl_sweep_orders_table(const pl_sweep_analysis *analysis, int scene, pl_sweep_table *table)
{
    static const char *const findings[] = {"", "too few time steps", "exact at every step",
                                           "does not converge"};
    *table = (pl_sweep_table){.columns = 5,
                              .heads = {"Problem", "Engine", "Order", "Time steps used", "Off fit"},
                              .numeric = {false, false, true, false, true}};
    for (int i = 0; i < analysis->order_count; i++) {
        const pl_sweep_order *order = &analysis->orders[i];
        char low[PL_SWEEP_TEXT_SIZE], high[PL_SWEEP_TEXT_SIZE];
        if (scene >= 0 && order->scene != scene)
            continue;
        pl_sweep_table_add(table, "%s", analysis->scenes[order->scene].name);
        pl_sweep_table_add(table, "%s", analysis->points[order->first].label);
        if (order->kind != PL_SWEEP_ORDER_FOUND) {
            pl_sweep_table_add(table, "%s", pl_quantity_missing);
            pl_sweep_table_add(table, "%s (%d were run)", findings[order->kind], order->total);
            pl_sweep_table_add(table, "%s", pl_quantity_missing);
            continue;
        }
        pl_sweep_step_text(order->dt_low, low);
        pl_sweep_step_text(order->dt_high, high);
        pl_sweep_table_add(table, "%.2f", order->order);
        pl_sweep_table_add(table, "%s to %s: %d of %d", high, low, order->used, order->total);
        pl_sweep_table_add(table, "%.2f decades", order->deviation);
    }
}

void pl_sweep_shares_table(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile,
                           pl_sweep_table *table)
{
    static const double taus[] = {1, 1.5, 2, 3, 5, 10, 100};
    static const char *const heads[] = {"Engine", "the fastest", "within 1.5 of it", "2", "3", "5",
                                        "10",     "100",         "at any cost"};
    enum { TAUS = sizeof taus / sizeof taus[0] };
    *table = (pl_sweep_table){.columns = TAUS + 2};
    for (int k = 0; k < table->columns; k++) {
        table->heads[k] = heads[k];
        table->numeric[k] = k > 0;
    }
    for (int e = 0; e < analysis->engine_count && profile->scenes > 0; e++) {
        if (analysis->engines[e].whole != profile->whole)
            continue;
        pl_sweep_table_add(table, "%s", engine_name(analysis, e));
        for (int k = 0; k <= TAUS; k++) {
            double tau = k < TAUS ? taus[k] : (double)INFINITY;
            pl_sweep_table_add(table, "%.0f %%", 100 * pl_sweep_share(analysis, profile, e, tau));
        }
    }
}

static const char *state_of(const pl_sweep_point *point)
{
    return point->state == PL_SWEEP_UNMEASURED ? "not measured" : point->outcome;
}

/* How many points from the first on are of one engine and scene and came to the same end. */
static int alike(const pl_sweep_analysis *analysis, int first)
{
    const pl_sweep_point *points = analysis->points, *point = &points[first];
    int count = 1;
    while (first + count < analysis->point_count && points[first + count].scene == point->scene &&
           points[first + count].state == point->state &&
           strcmp(points[first + count].label, point->label) == 0 &&
           strcmp(points[first + count].outcome, point->outcome) == 0)
        count++;
    return count;
}

void pl_sweep_failed_table(const pl_sweep_analysis *analysis, int scene, pl_sweep_table *table)
{
    *table = (pl_sweep_table){.columns = 5,
                              .heads = {"Problem", "Engine", "Time step", "Outcome", "Reason"}};
    for (int i = 0, count; i < analysis->point_count; i += count) {
        const pl_sweep_point *point = &analysis->points[i];
        char first[PL_SWEEP_TEXT_SIZE], last[PL_SWEEP_TEXT_SIZE];
        count = alike(analysis, i);
        if (point->state == PL_SWEEP_OK || (scene >= 0 && point->scene != scene))
            continue;
        pl_sweep_step_text(point->dt, first);
        pl_sweep_step_text(point[count - 1].dt, last);
        pl_sweep_table_add(table, "%s", analysis->scenes[point->scene].name);
        pl_sweep_table_add(table, "%s", point->label);
        if (count > 1)
            pl_sweep_table_add(table, "%s to %s: %d", first, last, count);
        else
            pl_sweep_table_add(table, "%s", first);
        pl_sweep_table_add(table, "%s", state_of(point));
        pl_sweep_table_add(table, "%s", point->reason);
    }
}
