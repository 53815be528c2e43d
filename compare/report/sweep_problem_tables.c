/* The tables of one scene. */
#include "quantity.h"
#include "sweep_tables.h"
#include "sweep_words.h"

#include <math.h>
#include <stdio.h>

static const char *const level_heads[PL_SWEEP_LEVELS] = {"1e-1", "1e-2", "1e-3", "1e-4",
                                                         "1e-5", "1e-6", "1e-7", "1e-8"};

void pl_sweep_costs_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                          bool whole, pl_sweep_table *table)
{
    *table = (pl_sweep_table){.columns = PL_SWEEP_LEVELS + 3, .heads = {"Engine"}};
    for (int k = 0; k < PL_SWEEP_LEVELS; k++) {
        table->heads[k + 1] = level_heads[k];
        table->numeric[k + 1] = true;
    }
    table->heads[PL_SWEEP_LEVELS + 1] = "least error";
    table->heads[PL_SWEEP_LEVELS + 2] = "failed points";
    table->numeric[PL_SWEEP_LEVELS + 1] = table->numeric[PL_SWEEP_LEVELS + 2] = true;
    for (int e = 0; e < analysis->engine_count; e++) {
        const pl_sweep_curve *curve = &scene->curves[e];
        char text[PL_SWEEP_TEXT_SIZE];
        if (analysis->engines[e].whole != whole || !pl_sweep_curve_was_run(curve))
            continue;
        pl_sweep_table_add(table, "%s", analysis->engines[e].name);
        for (int k = 0; k < PL_SWEEP_LEVELS; k++) {
            if (curve->cheapest[k] >= 0)
                pl_sweep_cost_text(analysis->points[curve->cheapest[k]].cost, text);
            pl_sweep_table_add(table, "%s", curve->cheapest[k] >= 0 ? text : "not reached");
        }
        if (curve->front_count > 0)
            pl_sweep_error_text(analysis->points[curve->front[curve->front_count - 1]].error,
                                scene->unit, text);
        pl_sweep_table_add(table, "%s", curve->front_count > 0 ? text : pl_quantity_missing);
        pl_sweep_table_add(table, "%d of %d", curve->failed + curve->unmeasured,
                           curve->ok + curve->failed + curve->unmeasured);
    }
}

static void name_pair(const pl_sweep_analysis *analysis, const pl_sweep_pair *pair,
                      pl_sweep_table *table)
{
    pl_sweep_table_add(table, "%s", analysis->engines[pair->ours].name);
    pl_sweep_table_add(table, "%s", analysis->engines[pair->other].name);
}

/* Who is there alone, or what is said where both are but have no ratio. */
static const char *alone(pl_attained_by attained)
{
    return attained == PL_ATTAINED_BY_OURS_ONLY    ? "ours alone"
           : attained == PL_ATTAINED_BY_OTHER_ONLY ? "other alone"
                                                   : pl_quantity_missing;
}

static void add_ratio(const pl_sweep_ratio *ratio, const char *otherwise, pl_sweep_table *table)
{
    char text[PL_SWEEP_TEXT_SIZE];
    pl_sweep_ratio_text(ratio, text);
    pl_sweep_table_add(table, "%s", isnan(ratio->value) ? otherwise : text);
}

void pl_sweep_speeds_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                           bool whole, bool between, pl_sweep_table *table)
{
    *table = (pl_sweep_table){.columns = PL_SWEEP_LEVELS + 2, .heads = {"Ours", "Other"}};
    for (int k = 0; k < PL_SWEEP_LEVELS; k++) {
        table->heads[k + 2] = level_heads[k];
        table->numeric[k + 2] = true;
    }
    for (int i = 0; i < analysis->pair_count; i++) {
        const pl_sweep_pair *pair = &analysis->pairs[i];
        const pl_pairwise_comparison *comparison = &scene->comparisons[i];
        if (analysis->engines[pair->ours].whole != whole || !comparison->run)
            continue;
        name_pair(analysis, pair, table);
        for (int k = 0; k < PL_SWEEP_LEVELS; k++)
            add_ratio(between ? &comparison->speed_between[k] : &comparison->speed[k],
                      between ? pl_quantity_missing : alone(comparison->at_error[k]), table);
    }
}

void pl_sweep_errors_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                           bool whole, pl_sweep_table *table)
{
    *table = (pl_sweep_table){
        .columns = 5,
        .heads = {"Ours", "Other", "Cost", "Their error over ours", "Between points"},
        .numeric = {false, false, true, true, true}};
    for (int i = 0; i < analysis->pair_count; i++) {
        const pl_sweep_pair *pair = &analysis->pairs[i];
        const pl_pairwise_comparison *comparison = &scene->comparisons[i];
        if (analysis->engines[pair->ours].whole != whole || !comparison->run)
            continue;
        for (int k = 0; k < PL_SWEEP_TIMES; k++) {
            char cost[PL_SWEEP_TEXT_SIZE];
            /* Costs at which neither front has anything new are left out. */
            bool same = k > 0 &&
                        scene->curves[pair->ours].most_exact[k] ==
                            scene->curves[pair->ours].most_exact[k - 1] &&
                        scene->curves[pair->other].most_exact[k] ==
                            scene->curves[pair->other].most_exact[k - 1];
            if (comparison->at_cost[k] == PL_ATTAINED_BY_NEITHER ||
                (same && isnan(comparison->exactness_between[k].value)))
                continue;
            pl_sweep_cost_text(pl_sweep_times[k], cost);
            name_pair(analysis, pair, table);
            pl_sweep_table_add(table, "%s", cost);
            add_ratio(&comparison->exactness[k], alone(comparison->at_cost[k]), table);
            add_ratio(&comparison->exactness_between[k], pl_quantity_missing, table);
        }
    }
}

void pl_sweep_points_table(const pl_sweep_analysis *analysis, int scene, pl_sweep_table *table)
{
    *table = (pl_sweep_table){.columns = 8,
                              .heads = {"Engine", "Time step", "Cost", "MAD", "Repeats", "Error",
                                        "Instructions", "On the front"},
                              .numeric = {false, true, true, true, true, true, true, false}};
    for (int i = 0; i < analysis->point_count; i++) {
        const pl_sweep_point *point = &analysis->points[i];
        const pl_sweep_scene *of = &analysis->scenes[point->scene];
        char text[PL_SWEEP_TEXT_SIZE], count[PL_QUANTITY_SIZE];
        if (point->scene != scene || point->state != PL_SWEEP_OK)
            continue;
        const pl_sweep_curve *curve = &of->curves[point->engines[0]];
        bool on_front = false;
        for (int k = 0; k < curve->front_count; k++)
            on_front |= curve->front[k] == i;
        pl_sweep_table_add(table, "%s", point->label);
        pl_sweep_step_text(point->dt, text);
        pl_sweep_table_add(table, "%s", text);
        pl_sweep_cost_text(point->cost, text);
        pl_sweep_table_add(table, "%s", text);
        pl_sweep_cost_text(point->cost_mad, text);
        pl_sweep_table_add(table, "%s", text);
        pl_sweep_table_add(table, "%d", point->sample_count);
        pl_sweep_error_text(point->error, of->unit, text);
        pl_sweep_table_add(table, "%s", text);
        pl_quantity_text(point->instructions, "1", count);
        pl_sweep_table_add(table, "%s", count);
        pl_sweep_table_add(table, "%s", on_front ? "yes" : "");
    }
}
