#include "sweep_tables.h"

#include "base/number_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char level_headings[] = "|>1e-1|>1e-2|>1e-3|>1e-4|>1e-5|>1e-6|>1e-7|>1e-8";

/* ---- Texts ---- */

void pl_sweep_ratio_text(const pl_sweep_ratio *ratio, char text[PL_SWEEP_TEXT_SIZE])
{
    char value[PL_QUANTITY_SIZE], low[PL_QUANTITY_SIZE], high[PL_QUANTITY_SIZE];
    pl_format_ratio(ratio->value, value);
    pl_format_number(ratio->low, "1", low);
    pl_format_number(ratio->high, "1", high);
    if (isnan(ratio->value) || isnan(ratio->low)) {
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%s", value);
    } else {
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%.60s (%.60s to %.60s)", value, low, high);
    }
}

void pl_sweep_error_text(double error, const char *unit, char text[PL_SWEEP_TEXT_SIZE])
{
    char number[PL_QUANTITY_SIZE];
    const bool bare = unit[0] == '\0' || strcmp(unit, "1") == 0;
    if (error <= pl_sweep_error_floor) {
        pl_format_power(pl_sweep_error_floor, number);
        snprintf(text, PL_SWEEP_TEXT_SIZE, "≤ %.20s%s%.40s", number, bare ? "" : " ",
                 bare ? "" : unit);
    } else {
        pl_format_number(error, bare ? "1" : unit, number);
        snprintf(text, PL_SWEEP_TEXT_SIZE, "%s", number);
    }
}

/* How many pairs tables show. */
static int count_pairs(const pl_sweep_analysis *analysis)
{
    int count = 0;
    for (int i = 0; i < analysis->pair_count; ++i) {
        count += analysis->engines[analysis->pairs[i].first].kind == analysis->shown;
    }
    return count;
}

void pl_sweep_statement(const pl_sweep_analysis *analysis, pl_text_buffer *out)
{
    const char *home = analysis->results->home;
    bool others = false;
    int within = 0;
    for (int i = 0; i < analysis->engine_count; ++i) {
        others |= !analysis->engines[i].is_home;
    }
    for (int i = 0; i < analysis->loss_count; ++i) {
        within += analysis->losses[i].within_noise;
    }
    if (home == NULL) {
        pl_text_format(out, "%d %s of engines compared.", count_pairs(analysis),
                       count_pairs(analysis) == 1 ? "pair" : "pairs");
    } else if (!others) {
        pl_text_add(out, "Nothing was compared: these results hold no other engine.");
    } else if (analysis->compared == 0) {
        pl_text_format(out,
                       "Nothing was compared: on no scene did %s or another engine that was "
                       "run on it reach any of the errors.",
                       home);
    } else if (analysis->loss_count == 0) {
        pl_text_format(out,
                       "No losses: in none of %d comparisons (scene, engine, error) is another "
                       "engine's front ahead of that of %s.",
                       analysis->compared, home);
    } else {
        pl_text_format(out,
                       "Another engine's front is ahead of that of %s in %d of %d comparisons "
                       "(scene, engine, error): in %d at errors up to 1e-3, in %d at larger "
                       "ones; %d of all are within noise.",
                       home, analysis->loss_count, analysis->compared, analysis->fine_losses,
                       analysis->loss_count - analysis->fine_losses, within);
    }
    if (analysis->unjudged > 0) {
        pl_text_format(out, " %d of %d scenes have no primary error and are not judged.",
                       analysis->unjudged, analysis->scene_count);
    }
}

void pl_sweep_warning(const pl_sweep_analysis *analysis, pl_text_buffer *out)
{
    if (analysis->several_hosts) {
        pl_text_add(out, "These runs come from several processors: ratios of time between them "
                         "mean little. ");
    }
    if (analysis->several_builds) {
        pl_text_add(out, "These runs come from several builds of plumb or versions of an "
                         "engine, which share a front here. ");
    }
}

void pl_sweep_unverified(const pl_sweep_analysis *analysis, pl_text_buffer *out)
{
    pl_text_buffer specs = {0};
    for (int i = 0; i < analysis->engine_count; ++i) {
        const pl_sweep_engine *engine = &analysis->engines[i];
        if (engine->unverified != NULL) {
            pl_text_add(&specs, " ");
            pl_text_add(&specs, engine->unverified[0] != '\0' ? engine->unverified : engine->name);
        }
    }
    if (specs.length > 0) {
        pl_text_format(out,
                       "Not verified, so that a difference may be the adapter's: run plumb "
                       "check-engine%s.",
                       specs.data);
    }
    pl_text_free(&specs);
}

/* ---- Cells ---- */

/* Adds that the settings that an engine was tried with do not reach an error. */
static void add_not_with(const pl_sweep_curve *curve, pl_table *table)
{
    const int settings = pl_sweep_curve_settings(curve);
    pl_table_format_cell(table, "not with %d %s", settings, settings == 1 ? "setting" : "settings");
}

static void add_ratio(const pl_sweep_ratio *ratio, const char *otherwise, pl_table *table)
{
    char text[PL_SWEEP_TEXT_SIZE];
    pl_sweep_ratio_text(ratio, text);
    pl_table_add(table, isnan(ratio->value) ? otherwise : text);
}

/* Adds the cost of a point, CPU time for a simulated second; for the index -1, with how many settings
 * of its curve it was not reached. */
static void add_cost_of(const pl_sweep_analysis *analysis, int point, const pl_sweep_curve *curve,
                        pl_table *table)
{
    char text[PL_QUANTITY_SIZE];
    if (point >= 0) {
        pl_format_number(analysis->points[point].cost, "s", text);
        pl_table_add(table, text);
    } else {
        add_not_with(curve, table);
    }
}

static void add_pair(const pl_sweep_analysis *analysis, const pl_sweep_pair *pair, pl_table *table)
{
    pl_table_add(table, analysis->engines[pair->first].name);
    pl_table_add(table, analysis->engines[pair->second].name);
}

/* ---- Tables of all scenes ---- */

pl_table pl_sweep_losses_table(const pl_sweep_analysis *analysis)
{
    pl_table table = {0};
    pl_table_columns(&table, "Scene|>Error|Home|>its cost|Ahead|>its cost|>Speed|");
    for (int i = 0; i < analysis->loss_count; ++i) {
        const pl_sweep_loss *loss = &analysis->losses[i];
        char error[PL_QUANTITY_SIZE];
        pl_format_power(pl_sweep_levels[loss->level], error);
        const pl_sweep_pair *pair = &analysis->pairs[loss->pair];
        const pl_sweep_curve *curves = analysis->scenes[loss->scene].curves;
        pl_table_add(&table, analysis->scenes[loss->scene].name);
        pl_table_add(&table, error);
        pl_table_add(&table, analysis->engines[pair->first].name);
        add_cost_of(analysis, loss->first, &curves[pair->first], &table);
        pl_table_add(&table, analysis->engines[pair->second].name);
        add_cost_of(analysis, loss->second, &curves[pair->second], &table);
        add_ratio(&loss->speed, pl_no_number, &table);
        pl_table_add(&table, loss->within_noise ? "within noise" : "");
    }
    return table;
}

/* Adds how many scenes one of a pair did not reach, and with how many settings at most. */
static void add_count(const pl_sweep_analysis *analysis, const pl_sweep_pair *pair, int engine,
                      int count, pl_table *table)
{
    int most = 0;
    for (int p = 0; p < analysis->scene_count; ++p) {
        const int settings = pl_sweep_curve_settings(&analysis->scenes[p].curves[engine]);
        most = settings > most ? settings : most;
    }
    if (count == 0) {
        pl_table_add(table, "none");
    } else {
        pl_table_format_cell(table, "%d of %d scenes: not with %d settings", count, pair->scenes,
                             most);
    }
}

static void add_mean(const pl_sweep_analysis *analysis, const pl_sweep_pair *pair, int level,
                     pl_table *table)
{
    add_ratio(&pair->mean[level], pl_no_number, table);
    pl_table_format_cell(table, "%d of %d", pair->both[level], pair->scenes);
    add_count(analysis, pair, pair->second, pair->first_only[level], table);
    add_count(analysis, pair, pair->first, pair->second_only[level], table);
}

pl_table pl_sweep_means_table(const pl_sweep_analysis *analysis, pl_sweep_kind kind, int level)
{
    pl_table table = {0};
    pl_table_columns(&table, kind == PL_SWEEP_WHOLE
                                 ? "First|Second|Settings|>Mean speed|>Scenes both reach|"
                                   "Second alone fails|First alone fails"
                                 : "First|Second|>Mean speed|>Scenes both reach|"
                                   "Second alone fails|First alone fails");
    for (int i = 0; i < analysis->pair_count; ++i) {
        const pl_sweep_pair *pair = &analysis->pairs[i];
        if (analysis->engines[pair->first].kind != kind || pair->scenes == 0) {
            continue;
        }
        if (kind == PL_SWEEP_WHOLE && pair->shipped >= 0) {
            add_pair(analysis, pair, &table);
            pl_table_add(&table, "as shipped");
            add_mean(analysis, &analysis->pairs[pair->shipped], level, &table);
        }
        add_pair(analysis, pair, &table);
        if (kind == PL_SWEEP_WHOLE) {
            pl_table_add(&table, "each at its best");
        }
        add_mean(analysis, pair, level, &table);
    }
    return table;
}

pl_table pl_sweep_orders_table(const pl_sweep_analysis *analysis, int scene)
{
    static const char *const kinds[] = {"", "too few time steps", "exact at every step",
                                        "does not converge"};
    pl_table table = {0};
    pl_table_columns(&table, "Scene|Engine|>Order|Time steps used|>Off fit");
    for (int i = 0; i < analysis->order_count; ++i) {
        const pl_sweep_order *order = &analysis->orders[i];
        char low[PL_QUANTITY_SIZE], high[PL_QUANTITY_SIZE];
        if (scene >= 0 && order->scene != scene) {
            continue;
        }
        pl_table_add(&table, analysis->scenes[order->scene].name);
        pl_table_add(&table, analysis->points[order->first].label);
        if (order->kind != PL_SWEEP_ORDER_FOUND) {
            pl_table_add(&table, pl_no_number);
            pl_table_format_cell(&table, "%s (%d were run)", kinds[order->kind], order->total);
            pl_table_add(&table, pl_no_number);
            continue;
        }
        pl_format_step(order->dt_low, low);
        pl_format_step(order->dt_high, high);
        pl_table_format_cell(&table, "%.2f", order->order);
        pl_table_format_cell(&table, "%s to %s: %d of %d", high, low, order->used, order->total);
        pl_table_format_cell(&table, "%.2f decades", order->deviation);
    }
    return table;
}

pl_table pl_sweep_shares_table(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile)
{
    static const double factors[] = {1, 1.5, 2, 3, 5, 10, 100, (double)INFINITY};
    pl_table table = {0};
    pl_table_columns(&table,
                     "Engine|>the fastest|>within 1.5 of it|>2|>3|>5|>10|>100|>at any cost");
    for (int e = 0; e < analysis->engine_count && profile->scenes > 0; ++e) {
        if (analysis->engines[e].kind != profile->kind) {
            continue;
        }
        pl_table_add(&table, analysis->engines[e].name);
        for (size_t k = 0; k < sizeof factors / sizeof factors[0]; ++k) {
            pl_table_format_cell(&table, "%.0f %%",
                                 100 * pl_sweep_share(analysis, profile, e, factors[k]));
        }
    }
    return table;
}

/* Counts the points from the first on that are of one engine and scene and have one outcome. */
static int count_alike(const pl_sweep_analysis *analysis, int first)
{
    const pl_sweep_point *points = analysis->points, *point = &points[first];
    int count = 1;
    while (first + count < analysis->point_count && points[first + count].scene == point->scene &&
           points[first + count].state == point->state &&
           strcmp(points[first + count].label, point->label) == 0 &&
           strcmp(points[first + count].outcome, point->outcome) == 0) {
        ++count;
    }
    return count;
}

pl_table pl_sweep_failed_table(const pl_sweep_analysis *analysis, int scene)
{
    pl_table table = {0};
    pl_table_columns(&table, "Scene|Engine|Time step|Outcome|Reason");
    for (int i = 0, count; i < analysis->point_count; i += count) {
        const pl_sweep_point *point = &analysis->points[i];
        char first[PL_QUANTITY_SIZE], last[PL_QUANTITY_SIZE];
        count = count_alike(analysis, i);
        if (point->state == PL_SWEEP_OK || (scene >= 0 && point->scene != scene)) {
            continue;
        }
        pl_format_step(point->dt, first);
        pl_format_step(point[count - 1].dt, last);
        pl_table_add(&table, analysis->scenes[point->scene].name);
        pl_table_add(&table, point->label);
        if (count > 1) {
            pl_table_format_cell(&table, "%s to %s: %d", first, last, count);
        } else {
            pl_table_add(&table, first);
        }
        pl_table_add(&table, point->state == PL_SWEEP_UNMEASURED ? "not measured" : point->outcome);
        if (point->change[0] != '\0') {
            pl_table_format_cell(&table, "on a changed scene (%s): %s", point->change,
                                 point->reason);
        } else {
            pl_table_add(&table, point->reason);
        }
    }
    return table;
}

/* ---- Tables of one scene ---- */

pl_table pl_sweep_costs_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                              pl_sweep_kind kind)
{
    pl_table table = {0};
    char headings[PL_SWEEP_TEXT_SIZE], text[PL_SWEEP_TEXT_SIZE];
    snprintf(headings, sizeof headings, "Engine%s|>least error|>failed points", level_headings);
    pl_table_columns(&table, headings);
    for (int e = 0; e < analysis->engine_count; ++e) {
        const pl_sweep_curve *curve = &scene->curves[e];
        if (analysis->engines[e].kind != kind || !pl_sweep_curve_was_run(curve)) {
            continue;
        }
        pl_table_add(&table, analysis->engines[e].name);
        for (int k = 0; k < PL_SWEEP_LEVELS; ++k) {
            add_cost_of(analysis, curve->cheapest[k], curve, &table);
        }
        snprintf(text, sizeof text, "%s", pl_no_number);
        if (curve->front_count > 0) {
            pl_sweep_error_text(analysis->points[curve->front[curve->front_count - 1]].error,
                                scene->unit, text);
        }
        pl_table_add(&table, text);
        pl_table_format_cell(&table, "%d of %d", curve->failed + curve->unmeasured,
                             curve->ok + curve->failed + curve->unmeasured);
    }
    return table;
}

/* The text where there is no ratio: which of the two reached the error or cost alone. */
static const char *attained_text(pl_attained_by attained)
{
    return attained == PL_ATTAINED_BY_FIRST_ONLY    ? "first alone"
           : attained == PL_ATTAINED_BY_SECOND_ONLY ? "second alone"
                                                    : pl_no_number;
}

/* ---- Both factors of a scene ---- */

/* Adds the ratio of a pair at a level, or which of the two reached it alone. */
static void add_factor(const pl_sweep_scene *scene, int pair, int level, pl_table *table)
{
    const pl_pairwise_comparison *comparison = pair < 0 ? NULL : &scene->comparisons[pair];
    if (comparison == NULL || !comparison->run) {
        pl_table_add(table, pl_no_number);
    } else {
        add_ratio(&comparison->speed[level], attained_text(comparison->at_error[level]), table);
    }
}

/* Adds the setting of an engine that is the cheapest at a level: its label and time step. */
static void add_setting(const pl_sweep_analysis *analysis, const pl_sweep_curve *curve, int level,
                        pl_table *table)
{
    const int point = curve->cheapest[level];
    char step[PL_QUANTITY_SIZE];
    if (point < 0) {
        add_not_with(curve, table);
    } else {
        pl_format_step(analysis->points[point].dt, step);
        pl_table_format_cell(table, "%s at %s", analysis->points[point].label, step);
    }
}

static void add_factors(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int index,
                        int level, pl_table *table)
{
    const pl_sweep_pair *pair = &analysis->pairs[index];
    char error[PL_QUANTITY_SIZE];
    pl_format_power(pl_sweep_levels[level], error);
    pl_table_add(table, scene->name);
    pl_table_add(table, error);
    add_pair(analysis, pair, table);
    add_factor(scene, pair->shipped, level, table);
    add_factor(scene, index, level, table);
    add_setting(analysis, &scene->curves[pair->first], level, table);
    add_setting(analysis, &scene->curves[pair->second], level, table);
}

pl_table pl_sweep_factors_table(const pl_sweep_analysis *analysis, int scene, int level)
{
    pl_table table = {0};
    pl_table_columns(&table, "Scene|>Error|First|Second|>Speed as shipped|>Speed, each at its best|"
                             "First at its best|Second at its best");
    for (int p = 0; p < analysis->scene_count; ++p) {
        for (int i = 0; i < analysis->pair_count && (scene < 0 || scene == p); ++i) {
            const pl_pairwise_comparison *comparison = &analysis->scenes[p].comparisons[i];
            const bool is_shown =
                analysis->engines[analysis->pairs[i].first].kind == analysis->shown;
            for (int k = 0; k < PL_SWEEP_LEVELS && is_shown && comparison->run; ++k) {
                if (comparison->at_error[k] != PL_ATTAINED_BY_NEITHER &&
                    (level < 0 || level == k)) {
                    add_factors(analysis, &analysis->scenes[p], i, k, &table);
                }
            }
        }
    }
    return table;
}
