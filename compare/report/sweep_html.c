#include "sweep_html.h"

#include "style.h"
#include "sweep_plot.h"
#include "sweep_tables.h"
#include "sweep_words.h"

enum { SHOWN_LOSSES = 30 };

/* Writes a table, frees it, and hands on that memory ran out. */
static void finish_table(pl_sweep_table *table, pl_text_buffer *text)
{
    text->failed |= table->texts.failed;
    pl_sweep_table_html(table, 0, pl_sweep_table_rows(table), text);
    pl_sweep_table_free(table);
}

static void open_details(const char *summary, pl_text_buffer *text)
{
    pl_text_add_element(text, "<details><summary>", summary, "</summary>\n");
}

static void add_losses(const pl_sweep_analysis *analysis, pl_text_buffer *text)
{
    pl_text_buffer statement = {0}, warning = {0};
    pl_sweep_table table;
    pl_sweep_statement(analysis, &statement);
    pl_sweep_warning(analysis, &warning);
    pl_sweep_losses_table(analysis, &table);
    text->failed |= statement.failed || warning.failed || table.texts.failed;
    pl_text_add(text, "<h2 id=\"sweep-losses\">Where plumb loses: speed against error</h2>\n");
    if (!text->failed)
        pl_text_add_element(text, "<p class=\"verdict\">", statement.data, "</p>\n");
    int rows = pl_sweep_table_rows(&table), shown = rows < SHOWN_LOSSES ? rows : SHOWN_LOSSES;
    pl_sweep_table_html(&table, 0, shown, text);
    if (rows > shown) {
        pl_text_format(text, "<details><summary>%d more</summary>\n", rows - shown);
        pl_sweep_table_html(&table, shown, rows, text);
        pl_text_add(text, "</details>\n");
    }
    pl_text_add(text, "<p class=\"note\">Errors up to 1e-3 come first, then larger ones; what is "
                      "within noise comes last in each. Speed is the other's cost over plumb's, "
                      "of the cheapest point of each at or below the error, with all profiles "
                      "and options that were run.</p>\n");
    if (warning.length > 0)
        pl_text_add_element(text, "<p class=\"warn\">", warning.data, "</p>\n");
    pl_text_free(&statement);
    pl_text_free(&warning);
    pl_sweep_table_free(&table);
}

static void add_means(const pl_sweep_analysis *analysis, pl_text_buffer *text)
{
    pl_sweep_table table;
    pl_text_add(text, "<h2 id=\"sweep-speed\">Speed at matched error</h2>\n"
                      "<p>How many times as fast plumb is at an error of at most 1e-3: the "
                      "geometric mean over the problems that both solve to it. Problems that one "
                      "of them never solves are not in the mean, but counted beside it.</p>\n");
    pl_sweep_means_table(analysis, true, PL_SWEEP_MATCHED_LEVEL, &table);
    finish_table(&table, text);
    open_details("Profile against profile, and at other errors", text);
    for (int k = 0; k < 2 * PL_SWEEP_LEVELS; k++) {
        int level = k % PL_SWEEP_LEVELS;
        if (k < PL_SWEEP_LEVELS && level == PL_SWEEP_MATCHED_LEVEL)
            continue;
        char error[PL_SWEEP_TEXT_SIZE];
        pl_sweep_power_text(pl_sweep_levels[level], error);
        pl_text_format(text, "<h4>%s, at most %s</h4>\n",
                       k < PL_SWEEP_LEVELS ? "Engines" : "Profiles", error);
        pl_sweep_means_table(analysis, k < PL_SWEEP_LEVELS, level, &table);
        finish_table(&table, text);
    }
    pl_text_add(text, "</details>\n");
}

static void add_shares(const pl_sweep_analysis *analysis, int index, pl_text_buffer *text)
{
    const pl_sweep_profile *profile = &analysis->profiles[index];
    pl_sweep_table table;
    if (profile->scenes == 0)
        return;
    char error[PL_SWEEP_TEXT_SIZE];
    pl_sweep_power_text(pl_sweep_levels[profile->level], error);
    pl_text_format(text, "<h4>%s, at most %s: %d problems</h4>\n",
                   profile->whole ? "Engines" : "Profiles", error, profile->scenes);
    pl_sweep_plot_profile(analysis, profile, text);
    pl_sweep_shares_table(analysis, profile, &table);
    finish_table(&table, text);
}

static void add_profiles(const pl_sweep_analysis *analysis, pl_text_buffer *text)
{
    pl_text_add(text, "<h2 id=\"sweep-profiles\">Performance profiles</h2>\n"
                      "<p>The share of problems that an engine solves to an error within a "
                      "factor of the cost of the fastest that does (Dolan and Moré 2002), over "
                      "the problems that all of these engines were run on.</p>\n");
    add_shares(analysis, PL_SWEEP_MATCHED_LEVEL, text);
    open_details("At other errors, and of profiles", text);
    for (int i = 0; i < analysis->profile_count; i++)
        if (i != PL_SWEEP_MATCHED_LEVEL)
            add_shares(analysis, i, text);
    pl_text_add(text, "</details>\n");
}

static void add_orders(const pl_sweep_analysis *analysis, pl_text_buffer *text)
{
    pl_sweep_table table;
    if (analysis->order_count == 0)
        return;
    pl_text_add(text, "<h2 id=\"sweep-orders\">Order of convergence</h2>\n"
                      "<p>The slope of the logarithm of error over that of the time step, by "
                      "least squares over the part of each series of runs, that differ in the "
                      "time step alone, in which the error falls.</p>\n");
    pl_sweep_orders_table(analysis, -1, &table);
    finish_table(&table, text);
}

static void add_problem(const pl_sweep_analysis *analysis, int index, pl_text_buffer *text)
{
    const pl_sweep_scene *scene = &analysis->scenes[index];
    pl_sweep_table table;
    pl_text_format(text, "<h3 id=\"sweep-problem-%d\">", index + 1);
    pl_text_add_element(text, "", scene->name, "</h3>\n");
    pl_sweep_plot_problem(analysis, scene, text);
    pl_text_add(text, "<h4>Least CPU time for a simulated second, by error</h4>\n");
    pl_sweep_costs_table(analysis, scene, true, &table);
    finish_table(&table, text);
    pl_text_add(text, "<h4>Speed of plumb, by error</h4>\n");
    pl_sweep_speeds_table(analysis, scene, true, false, &table);
    finish_table(&table, text);
    open_details("Between points of the fronts, error at matched time, profiles", text);
    pl_text_add(text, "<h4>Speed between points of the fronts</h4>\n");
    pl_sweep_speeds_table(analysis, scene, true, true, &table);
    finish_table(&table, text);
    pl_text_add(text, "<h4>Error at matched CPU time for a simulated second</h4>\n");
    pl_sweep_errors_table(analysis, scene, true, &table);
    finish_table(&table, text);
    pl_text_add(text, "<h4>Profiles: least CPU time, and speed</h4>\n");
    pl_sweep_costs_table(analysis, scene, false, &table);
    finish_table(&table, text);
    pl_sweep_speeds_table(analysis, scene, false, false, &table);
    finish_table(&table, text);
    pl_text_add(text, "</details>\n");
    open_details("All points, and those that failed", text);
    pl_sweep_points_table(analysis, index, &table);
    finish_table(&table, text);
    pl_sweep_failed_table(analysis, index, &table);
    finish_table(&table, text);
    pl_text_add(text, "</details>\n");
}

static void add_method(pl_text_buffer *text)
{
    char floor[PL_SWEEP_TEXT_SIZE];
    pl_sweep_power_text(pl_sweep_error_floor, floor);
    pl_text_format(
        text,
        "<h2 id=\"sweep-method\">How speed and error are weighed</h2>\n"
        "<p>A point is an engine with its options at a time step on a problem. Its cost is the CPU "
        "time of the engine's steps alone for a second of simulated time, the median over its "
        "repeats; its error is the scenario's primary error, and an error below %s counts as "
        "%s. A point of which any repeat was not ok is a failed one and has no numbers; so is one "
        "that ran into the time limit, or would have at a shorter step. What an engine does not "
        "support, or not with these options, is no point of its own.</p>\n"
        "<p>A front is what no other point of the same engine is both cheaper than and as exact. "
        "Nothing is extrapolated: between points of a front the line is straight in the "
        "logarithms, "
        "and beyond its ends there is none.</p>\n"
        "<p>The ranges in brackets hold 95 %% of %d draws in which each point's repeats are drawn "
        "anew from its own, by a fixed seed. Two or three repeats do not tell their own scatter, "
        "and one none: of fewer than ten each that is drawn is moved by the noise of the problem, "
        "which the repeats of all its points tell. There are no ranges where nothing was "
        "repeated.</p>\n",
        floor, floor, PL_BOOTSTRAP_REPLICATES);
}

void pl_sweep_html(const pl_sweep_analysis *analysis, pl_text_buffer *text)
{
    add_losses(analysis, text);
    if (analysis->point_count == 0) {
        pl_text_add(text, "<p>There are no results.</p>\n");
        return;
    }
    add_means(analysis, text);
    add_profiles(analysis, text);
    add_orders(analysis, text);
    pl_text_add(text, "<h2 id=\"sweep-problems\">Error against cost, problem by problem</h2>\n");
    for (int i = 0; i < analysis->scene_count; i++)
        add_problem(analysis, i, text);
    add_method(text);
}

void pl_sweep_page(const pl_sweep_analysis *analysis, pl_text_buffer *text)
{
    pl_text_add(text, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
                      "<title>Plumb: speed against error</title>\n<style>\n");
    for (int i = 0; pl_style[i] != NULL; i++)
        pl_text_format(text, "%s\n", pl_style[i]);
    for (int i = 0; pl_sweep_style[i] != NULL; i++)
        pl_text_format(text, "%s\n", pl_sweep_style[i]);
    pl_text_format(text,
                   "</style>\n</head>\n<body>\n<main>\n<h1>Speed against error</h1>\n"
                   "<p class=\"lead\">%d runs, %d points on %d %s.</p>\n",
                   analysis->run_count, analysis->point_count, analysis->scene_count,
                   analysis->scene_count == 1 ? "problem" : "problems");
    pl_sweep_html(analysis, text);
    pl_text_add(text, "</main>\n</body>\n</html>\n");
}
