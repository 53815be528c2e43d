/* The page of a sweep, its tables on a terminal, and the files that hold both. */
#include "sweep_report.h"

#include "base/folding.h"
#include "number_format.h"
#include "page.h"
#include "results/store.h"
#include "sweep_tables.h"

#include <stdlib.h>

enum { PAGE_LOSSES = 30, PRINTED_ROWS = 20 };

/* Whether plumb took part; engines of ours come first. */
static bool has_ours(const pl_sweep_analysis *analysis)
{
    return analysis->engine_count > 0 && analysis->engines[0].ours;
}

/* ---- Page ---- */

static void add_losses(const pl_sweep_analysis *analysis, const pl_page *page)
{
    pl_text_buffer statement = {0};
    pl_sweep_statement(analysis, &statement);
    page->out->failed |= statement.failed;
    pl_page_heading(page, "sweep-losses", "Where plumb loses: speed against error");
    pl_page_paragraph(page, "verdict", statement.failed ? "" : statement.data);
    pl_page_table(page, pl_sweep_losses_table(analysis), PAGE_LOSSES);
    pl_page_paragraph(page, "note",
                      "Errors up to 1e-3 come first, then larger ones; in each, losses within "
                      "noise come last. Speed is the other engine's cost over plumb's, of the "
                      "cheapest point of each at or below the error, over all profiles and options "
                      "that were run.");
    pl_text_free(&statement);
}

static void add_warnings(const pl_sweep_analysis *analysis, const pl_page *page)
{
    pl_text_buffer warning = {0}, unverified = {0};
    pl_sweep_warning(analysis, &warning);
    pl_sweep_unverified(analysis, &unverified);
    page->out->failed |= warning.failed || unverified.failed;
    if (unverified.length > 0) {
        pl_page_paragraph(page, "note", unverified.data);
    }
    if (warning.length > 0) {
        pl_page_paragraph(page, "warn", warning.data);
    }
    pl_text_free(&unverified);
    pl_text_free(&warning);
}

static void add_means(const pl_sweep_analysis *analysis, const pl_page *page)
{
    pl_page_heading(page, "sweep-speed", "Speed at matched error");
    pl_page_paragraph(
        page, "",
        "How many times as fast plumb is at an error of at most 1e-3: the geometric "
        "mean over the scenes that both solve to it. Scenes that one of them does not "
        "solve with the settings that were tried are not in the mean, and are counted "
        "next to it. As shipped, both have their first profile with its default "
        "options, at any time step; at its best, each has the cheapest of all "
        "settings that were tried on the scene.");
    pl_page_table(page, pl_sweep_means_table(analysis, PL_SWEEP_WHOLE, PL_SWEEP_MATCHED_LEVEL), 0);
    pl_page_paragraph(page, "", "Scene by scene, with the settings that are each one's best:");
    pl_page_table(page, pl_sweep_factors_table(analysis, -1, PL_SWEEP_MATCHED_LEVEL), 0);
    pl_page_details(page, "Profile against profile, and at other errors");
    for (int k = 0; k < 2 * PL_SWEEP_LEVELS; ++k) {
        const int level = k % PL_SWEEP_LEVELS;
        const pl_sweep_kind kind = k < PL_SWEEP_LEVELS ? PL_SWEEP_WHOLE : PL_SWEEP_PROFILE;
        char error[PL_NUMBER_SIZE];
        if (kind == PL_SWEEP_WHOLE && level == PL_SWEEP_MATCHED_LEVEL) {
            continue;
        }
        pl_format_power(pl_sweep_levels[level], error);
        pl_text_format(page->out, "<h4>%s, at most %s</h4>\n",
                       kind == PL_SWEEP_WHOLE ? "Engines" : "Profiles", error);
        pl_page_table(page, pl_sweep_means_table(analysis, kind, level), 0);
    }
    pl_text_add(page->out, "</details>\n");
}

static void add_shares(const pl_sweep_analysis *analysis, int index, const pl_page *page)
{
    const pl_sweep_profile *profile = &analysis->profiles[index];
    char error[PL_NUMBER_SIZE];
    if (profile->scenes == 0) {
        return;
    }
    pl_format_power(pl_sweep_levels[profile->level], error);
    pl_text_format(page->out, "<h4>%s, at most %s: %d scenes</h4>\n",
                   profile->kind == PL_SWEEP_WHOLE ? "Engines" : "Profiles", error,
                   profile->scenes);
    pl_sweep_plot_profile(analysis, profile, page->out);
    pl_page_table(page, pl_sweep_shares_table(analysis, profile), 0);
}

static void add_profiles(const pl_sweep_analysis *analysis, const pl_page *page)
{
    pl_page_heading(page, "sweep-profiles", "Performance profiles");
    pl_page_paragraph(page, "",
                      "The share of scenes that an engine solves to an error within a factor of "
                      "the cost of the fastest engine that does (Dolan and Moré 2002), over the "
                      "scenes that all of these engines were run on.");
    add_shares(analysis, PL_SWEEP_MATCHED_LEVEL, page);
    pl_page_details(page, "At other errors, and of profiles");
    for (int i = 0; i < analysis->profile_count; ++i) {
        if (i != PL_SWEEP_MATCHED_LEVEL) {
            add_shares(analysis, i, page);
        }
    }
    pl_text_add(page->out, "</details>\n");
}

static void add_orders(const pl_sweep_analysis *analysis, const pl_page *page)
{
    if (analysis->order_count == 0) {
        return;
    }
    pl_page_heading(page, "sweep-orders", "Order of convergence");
    pl_page_paragraph(page, "",
                      "The slope of the logarithm of error over that of the time step, by least "
                      "squares over the part of each series of runs in which the error falls. The "
                      "runs of a series differ in the time step alone.");
    pl_page_table(page, pl_sweep_orders_table(analysis, -1), 0);
}

static void add_titled(const pl_page *page, const char *title, pl_table table)
{
    pl_text_format(page->out, "<h4>%s</h4>\n", title);
    pl_page_table(page, table, 0);
}

static void add_scene(const pl_sweep_analysis *analysis, int index, const pl_page *page)
{
    const pl_sweep_scene *scene = &analysis->scenes[index];
    pl_text_format(page->out, "<h3 id=\"sweep-scene-%d\">", index + 1);
    pl_text_add_element(page->out, "", scene->name, "</h3>\n");
    pl_sweep_plot_scene(analysis, scene, page->out);
    add_titled(page, "Least CPU time for a simulated second, by error",
               pl_sweep_costs_table(analysis, scene, PL_SWEEP_WHOLE));
    add_titled(page, "Speed of plumb, by error", pl_sweep_factors_table(analysis, index, -1));
    pl_page_details(page, "Between points of the fronts, error at matched time, profiles");
    add_titled(page, "Speed between points of the fronts",
               pl_sweep_speeds_table(analysis, scene, PL_SWEEP_WHOLE, true));
    add_titled(page, "Error at matched CPU time for a simulated second",
               pl_sweep_errors_table(analysis, scene, PL_SWEEP_WHOLE));
    add_titled(page, "Profiles: least CPU time, and speed",
               pl_sweep_costs_table(analysis, scene, PL_SWEEP_PROFILE));
    pl_page_table(page, pl_sweep_speeds_table(analysis, scene, PL_SWEEP_PROFILE, false), 0);
    pl_text_add(page->out, "</details>\n");
    pl_page_details(page, "All points, and those that failed");
    pl_page_table(page, pl_sweep_points_table(analysis, index), 0);
    pl_page_table(page, pl_sweep_failed_table(analysis, index), 0);
    pl_text_add(page->out, "</details>\n");
}

static void add_method(pl_text_buffer *out)
{
    char floor[PL_NUMBER_SIZE];
    pl_format_power(pl_sweep_error_floor, floor);
    pl_text_format(
        out,
        "<h2 id=\"sweep-method\">How speed and error are weighed</h2>\n"
        "<p>A point is an engine with its options at a time step on a scene. Its cost is the CPU "
        "time of the engine's steps alone for a second of simulated time, the median over its "
        "repeats; its error is the scenario's primary error, and an error below %s counts as "
        "%s. Where a point was also run on small changes of the scene, its error is the largest of "
        "all, and its cost remains that of the scene itself. A point of which any repeat or change "
        "was not ok has failed and has no numbers; so has one that ran into a limit of time, or "
        "would have at a shorter step. Settings that an engine does "
        "not support make no point.</p>\n"
        "<p>A front has the points of an engine for which no other of its points is both cheaper "
        "and as exact. Nothing is extrapolated: between points of a front the line is straight in "
        "the logarithms, and beyond its ends there is none.</p>\n"
        "<p>The ranges in brackets hold 95 %% of %d bootstrap replicates, in which the repeats of "
        "each point are drawn with replacement, by a fixed seed. A few repeats say little about "
        "their own scatter: where a point has fewer than ten, each repeat drawn is also disturbed "
        "by the noise of the scene, estimated from the repeats of all its points. There are no "
        "ranges where nothing was repeated.</p>\n",
        floor, floor, PL_BOOTSTRAP_REPLICATES);
}

void pl_sweep_page(const pl_sweep_analysis *analysis, pl_text_buffer *out)
{
    const pl_page page = {.out = out, .html = true};
    pl_page_open(out, "Plumb: speed against error", pl_sweep_css);
    pl_text_format(
        out, "<h1>Speed against error</h1>\n<p class=\"lead\">%d runs, %d points on %d %s.</p>\n",
        analysis->run_count, analysis->point_count, analysis->scene_count,
        analysis->scene_count == 1 ? "scene" : "scenes");
    if (has_ours(analysis)) {
        add_losses(analysis, &page);
    }
    add_warnings(analysis, &page);
    if (analysis->point_count == 0) {
        pl_page_paragraph(&page, "", "There are no results.");
    } else {
        add_means(analysis, &page);
        add_profiles(analysis, &page);
        add_orders(analysis, &page);
        pl_page_heading(&page, "sweep-scenes", "Error against cost, scene by scene");
        for (int i = 0; i < analysis->scene_count; ++i) {
            add_scene(analysis, i, &page);
        }
        add_method(out);
    }
    pl_page_close(out);
}

/* ---- Files ---- */

static pl_status write_in(const char *directory, const char *name, const char *text, size_t length,
                          pl_error *error)
{
    pl_text_buffer path = {0};
    pl_text_format(&path, "%s/%s", directory, name);
    pl_status status = path.failed ? pl_fail(error, PL_NO_MEMORY, "out of memory to write %s", name)
                                   : pl_write_text(path.data, text, length, error);
    pl_text_free(&path);
    return status;
}

pl_status pl_sweep_report_write(const char *directory, const pl_sweep_analysis *analysis,
                                pl_error *error)
{
    pl_text_buffer page = {0}, lines = {0};
    json_t *json = pl_sweep_to_json(analysis);
    char *text = json_dumps(json, JSON_SORT_KEYS | JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    pl_sweep_page(analysis, &page);
    pl_text_format(&lines, "%s\n", text == NULL ? "" : text);
    pl_status status = PL_OK;
    if (text == NULL || page.failed || lines.failed) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory to report %d points",
                         analysis->point_count);
    }
    if (status == PL_OK) {
        status = write_in(directory, "sweep.json", lines.data, lines.length, error);
    }
    if (status == PL_OK) {
        status = write_in(directory, "sweep.html", page.data, page.length, error);
    }
    free(text);
    json_decref(json);
    pl_text_free(&lines);
    pl_text_free(&page);
    return status;
}

/* ---- Terminal ---- */

/* Prints the first `most` rows of a table (0: all) under a heading, and frees the table. */
static void print_table(const char *heading, pl_table table, int most, int width,
                        pl_text_buffer *out)
{
    const int rows = pl_table_rows(&table);
    table.last = most == 0 || rows < most ? rows : most;
    table.line_width = width;
    if (rows > 0) {
        pl_text_add(out, "\n");
        pl_text_add_folded(out, heading, width);
        pl_text_add(out, "\n\n");
    }
    pl_table_write(&table, PL_TABLE_TEXT, out);
    if (rows > table.last) {
        pl_text_format(out, "and %d more\n", rows - table.last);
    }
    pl_table_free(&table);
}

static void print_scene(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, int width,
                        pl_text_buffer *out)
{
    pl_text_buffer heading = {0};
    pl_text_format(&heading, "%s: least CPU time for a simulated second, by %s%s%s", scene->name,
                   scene->primary_error, scene->unit[0] == '\0' ? "" : ", ", scene->unit);
    out->failed |= heading.failed;
    if (scene->primary_error[0] != '\0' && !heading.failed) {
        print_table(heading.data, pl_sweep_costs_table(analysis, scene, PL_SWEEP_WHOLE), 0, width,
                    out);
    }
    pl_text_free(&heading);
}

void pl_sweep_report_print(FILE *stream, const pl_sweep_analysis *analysis)
{
    pl_text_buffer words = {0}, out = {0};
    const int width = pl_window_width(stream);
    if (has_ours(analysis)) {
        pl_sweep_statement(analysis, &words);
        pl_text_add(&words, "\n");
    }
    pl_sweep_unverified(analysis, &words);
    pl_text_add(&words, "\n");
    pl_sweep_warning(analysis, &words);
    pl_text_add_folded(&out, words.failed ? "" : words.data, width);
    out.failed |= words.failed;
    pl_text_free(&words);
    if (has_ours(analysis)) {
        print_table("Where plumb loses", pl_sweep_losses_table(analysis), PRINTED_ROWS, width,
                    &out);
    }
    print_table("Speed of plumb at errors of at most 1e-3, over all scenes",
                pl_sweep_means_table(analysis, PL_SWEEP_WHOLE, PL_SWEEP_MATCHED_LEVEL), 0, width,
                &out);
    print_table("Speed of plumb at errors of at most 1e-3, scene by scene",
                pl_sweep_factors_table(analysis, -1, PL_SWEEP_MATCHED_LEVEL), 0, width, &out);
    for (int i = 0; i < analysis->scene_count; ++i) {
        print_scene(analysis, &analysis->scenes[i], width, &out);
    }
    if (analysis->profile_count > PL_SWEEP_MATCHED_LEVEL) {
        print_table("Scenes solved to 1e-3, within a factor of the fastest",
                    pl_sweep_shares_table(analysis, &analysis->profiles[PL_SWEEP_MATCHED_LEVEL]), 0,
                    width, &out);
    }
    print_table("Order of convergence", pl_sweep_orders_table(analysis, -1), 0, width, &out);
    print_table("Points without numbers", pl_sweep_failed_table(analysis, -1), PRINTED_ROWS, width,
                &out);
    fputs(out.failed ? "out of memory to print the sweep\n" : out.data, stream);
    pl_text_free(&out);
}
