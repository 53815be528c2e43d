/* The solver benchmark's result as Markdown, as text and as CSV. */
#include "base/text_page.h"
#include "benchmark.h"
#include "results/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double pl_benchmark_levels[PL_BENCHMARK_LEVELS] = {1e-3, 1e-4, 1e-6, 1e-8};

static const char *const STARTS[] = {"warm", "cold"};

/* The solver that the others are compared with: the first of the engine's table. */
static const char *baseline(void)
{
    return pe_solver(0).name;
}

static double number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static bool reached(const json_t *level)
{
    return json_is_true(json_object_get(level, "reached"));
}

/* The cell's level of this tolerance; NULL: not tried, because a larger one was not reached. */
static const json_t *find_level(const json_t *cell, double tolerance)
{
    const json_t *levels = json_object_get(cell, "levels");
    for (size_t i = 0; i < json_array_size(levels); ++i) {
        const json_t *level = json_array_get(levels, i);
        if (number(level, "tolerance") == tolerance) {
            return level;
        }
    }
    return NULL;
}

static const json_t *find_cell(const json_t *problem, const char *solver, const char *start)
{
    const json_t *cells = json_object_get(problem, "cells");
    for (size_t i = 0; i < json_array_size(cells); ++i) {
        const json_t *cell = json_array_get(cells, i);
        if (strcmp(pl_json_get_text(cell, "solver"), solver) == 0 &&
            strcmp(pl_json_get_text(cell, "start"), start) == 0) {
            return cell;
        }
    }
    return NULL;
}

/* ---- Levels that were not reached ---- */

static void put_unreached(pl_text_page *page, const json_t *problems)
{
    pl_table table = {.keys = 3};
    pl_table_columns(&table, "problem|start|solver|level, m/s|stopped by|residual, m/s");
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        const json_t *problem = json_array_get(problems, i);
        const json_t *cells = json_object_get(problem, "cells");
        const char *name = pl_json_get_text(problem, "name");
        const char *failed = pl_json_get_text(problem, "error");
        if (failed[0] != '\0') {
            pl_table_add(&table, name);
            for (int k = 1; k <= 3; ++k) {
                pl_table_add(&table, "");
            }
            pl_table_format_cell(&table, "not captured: %s", failed);
            pl_table_add(&table, "");
        }
        for (size_t c = 0; c < json_array_size(cells) && failed[0] == '\0'; ++c) {
            const json_t *cell = json_array_get(cells, c);
            const json_t *levels = json_object_get(cell, "levels");
            const json_t *last = json_array_get(levels, json_array_size(levels) - 1);
            if (!reached(last)) {
                pl_table_add(&table, name);
                pl_table_add(&table, pl_json_get_text(cell, "start"));
                pl_table_add(&table, pl_json_get_text(cell, "solver"));
                pl_table_format_cell(&table, "%g", number(last, "tolerance"));
                pl_table_add(&table, pl_json_get_text(last, "stop"));
                pl_table_format_cell(&table, "%.3g", number(last, "residual_max"));
            }
        }
    }
    const int rows = pl_table_rows(&table);
    pl_text_page_heading(page, 2, "Not reached");
    pl_text_page_paragraph(page,
                           "The first level that a solver missed; smaller ones were not tried.");
    pl_text_page_table(page, &table);
    pl_text_page_paragraph(page, "%d cells.", rows);
}

/* ---- Each solver against the baseline ---- */

/* A solver from one start at one level. */
typedef struct setup {
    const char *solver, *start;
    double tolerance;
} setup;

/* The setup number `index` of all solvers except the baseline, starts and levels, in this order. */
static setup setup_of(int index)
{
    const int level = index % PL_BENCHMARK_LEVELS, start = index / PL_BENCHMARK_LEVELS;
    return (setup){pe_solver(1 + start / 2).name, STARTS[start % 2], pl_benchmark_levels[level]};
}

static int setup_count(void)
{
    return (pe_solver_count() - 1) * 2 * PL_BENCHMARK_LEVELS;
}

/* The level that `solver` reached on the problem in this setup; NULL: none. */
static const json_t *reached_level(const json_t *problem, const char *solver, const setup *at)
{
    const json_t *level = find_level(find_cell(problem, solver, at->start), at->tolerance);
    return reached(level) ? level : NULL;
}

typedef struct loss {
    double ratio; /* of CPU times */
    setup at;
    const char *problem;
} loss;

static int compare_losses(const void *left, const void *right)
{
    const loss *a = left, *b = right;
    return (a->ratio < b->ratio) - (a->ratio > b->ratio);
}

static void put_slower(pl_text_page *page, const json_t *problems)
{
    loss *losses = calloc(json_array_size(problems) * (size_t)setup_count() + 1, sizeof *losses);
    int count = 0;
    for (int s = 0; s < setup_count() && losses != NULL; ++s) {
        const setup at = setup_of(s);
        for (size_t i = 0; i < json_array_size(problems); ++i) {
            const json_t *problem = json_array_get(problems, i);
            const json_t *level = reached_level(problem, at.solver, &at);
            const json_t *base = reached_level(problem, baseline(), &at);
            const double ratio = number(level, "seconds") / number(base, "seconds");
            /* Without iterations the start was good enough, and there is nothing to compare. */
            if (level != NULL && base != NULL && number(base, "iterations") > 0 && ratio > 1) {
                losses[count++] = (loss){ratio, at, pl_json_get_text(problem, "name")};
            }
        }
    }
    if (losses == NULL) {
        page->out->failed = true;
        return;
    }
    qsort(losses, (size_t)count, sizeof *losses, compare_losses);
    pl_text_page_heading(page, 2, "Slower than %s", baseline());
    pl_text_page_paragraph(page, "CPU time over that of %s, where both reached the level.",
                           baseline());
    pl_table table = {.keys = 3};
    pl_table_columns(&table, "problem|start|solver|level, m/s|times as long");
    for (int i = 0; i < count; ++i) {
        pl_table_add(&table, losses[i].problem);
        pl_table_add(&table, losses[i].at.start);
        pl_table_add(&table, losses[i].at.solver);
        pl_table_format_cell(&table, "%g", losses[i].at.tolerance);
        pl_table_format_cell(&table, "%.2f", losses[i].ratio);
    }
    pl_text_page_table(page, &table);
    pl_text_page_paragraph(page, "%d cells.", count);
    free(losses);
}

static void put_means(pl_text_page *page, const json_t *problems)
{
    pl_table table = {.missing = "", .keys = 3};
    pl_table_columns(&table, "solver|start|level, m/s|iterations|CPU time|both|only it");
    pl_table_column(&table, PL_LEFT, "only %s", baseline());
    for (int s = 0; s < setup_count(); ++s) {
        const setup at = setup_of(s);
        double log_iterations = 0, log_seconds = 0;
        int both = 0, only = 0, missed = 0;
        for (size_t i = 0; i < json_array_size(problems); ++i) {
            const json_t *problem = json_array_get(problems, i);
            const json_t *level = reached_level(problem, at.solver, &at);
            const json_t *base = reached_level(problem, baseline(), &at);
            const double iterations = number(level, "iterations");
            const double base_iterations = number(base, "iterations");
            only += level != NULL && base == NULL;
            missed += level == NULL && base != NULL;
            if (iterations > 0 && base_iterations > 0) {
                log_iterations += log(iterations / base_iterations);
                log_seconds += log(number(level, "seconds") / number(base, "seconds"));
                both += 1;
            }
        }
        pl_table_add(&table, at.solver);
        pl_table_add(&table, at.start);
        pl_table_format_cell(&table, "%g", at.tolerance);
        pl_table_number(&table, both > 0 ? exp(log_iterations / both) : (double)NAN, 3);
        pl_table_number(&table, both > 0 ? exp(log_seconds / both) : (double)NAN, 3);
        pl_table_format_cell(&table, "%d", both);
        pl_table_format_cell(&table, "%d", only);
        pl_table_format_cell(&table, "%d", missed);
    }
    pl_text_page_heading(page, 2, "Geometric means against %s", baseline());
    pl_text_page_paragraph(
        page,
        "Over the problems where both reached the level and had something to do; how many these "
        "are, and how many only one of the two reached. Below 1 is better than %s.",
        baseline());
    pl_text_page_table(page, &table);
}

/* ---- All cells ---- */

static void put_problem(pl_text_page *page, const json_t *problem)
{
    pl_text_page_heading(page, 3, "%s%s", pl_json_get_text(problem, "name"),
                         json_is_true(json_object_get(problem, "held_out")) ? " (held out)" : "");
    if (pl_json_get_text(problem, "error")[0] != '\0') {
        pl_text_page_paragraph(page, "Not captured: %s", pl_json_get_text(problem, "error"));
        return;
    }
    pl_text_buffer what = {0};
    pl_text_add(&what, pl_json_get_text(problem, "scenario"));
    const json_t *settings = json_object_get(problem, "settings");
    for (size_t i = 0; i < json_array_size(settings); ++i) {
        pl_text_format(&what, " %s", json_string_value(json_array_get(settings, i)));
    }
    pl_text_page_paragraph(
        page,
        "%s, seed %.0f, step %.0f: %.0f bodies, %.0f manifolds, %.0f points; residual %.3g m/s "
        "warm, %.3g cold",
        what.failed ? "" : what.data, number(problem, "seed"), number(problem, "step"),
        number(problem, "bodies"), number(problem, "manifolds"), number(problem, "points"),
        number(problem, "warm_residual"), number(problem, "cold_residual"));
    page->out->failed |= what.failed;
    pl_text_free(&what);
    pl_table table = {.keys = 2};
    pl_table_columns(&table, "solver|start");
    for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
        pl_table_column(&table, PL_LEFT, "to %g m/s", pl_benchmark_levels[k]);
    }
    const json_t *cells = json_object_get(problem, "cells");
    for (size_t i = 0; i < json_array_size(cells); ++i) {
        const json_t *cell = json_array_get(cells, i);
        pl_table_add(&table, pl_json_get_text(cell, "solver"));
        pl_table_add(&table, pl_json_get_text(cell, "start"));
        for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
            const json_t *level = find_level(cell, pl_benchmark_levels[k]);
            if (reached(level)) {
                pl_table_format_cell(&table, "%.0f it, %.3g ms", number(level, "iterations"),
                                     1e3 * number(level, "seconds"));
            } else {
                pl_table_add(&table, "not reached");
            }
        }
    }
    pl_text_page_table(page, &table);
}

/* The text of a buffer, malloc'd; NULL when out of memory. */
static char *text_of(pl_text_buffer *buffer)
{
    if (buffer->failed) {
        pl_text_free(buffer);
    }
    return buffer->data;
}

char *pl_benchmark_text(const json_t *result, int width)
{
    pl_text_buffer out = {0};
    pl_text_page page = {.out = &out, .width = width};
    const json_t *problems = json_object_get(result, "problems");
    pl_text_page_heading(&page, 1, "Solver benchmark");
    pl_text_page_paragraph(
        &page,
        "%zu contact problems captured from plumb:accurate, solved again by every solver, each "
        "level a solve of its own. The residual is the largest natural map over all contact "
        "points, in m/s. CPU times are medians of up to 9 repeats, one thread, on %s.",
        json_array_size(problems), pl_json_get_text(json_object_get(result, "host"), "cpu"));
    put_unreached(&page, problems);
    put_slower(&page, problems);
    put_means(&page, problems);
    pl_text_page_heading(&page, 2, "All problems");
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        put_problem(&page, json_array_get(problems, i));
    }
    return text_of(&out);
}

/* The next cells: numbers of an object, exact. */
static void add_numbers(pl_table *table, const json_t *object, const char *const *keys, int count)
{
    for (int i = 0; i < count; ++i) {
        pl_table_number(table, number(object, keys[i]), 17);
    }
}

char *pl_benchmark_csv(const json_t *result)
{
    static const char *const of_problem[] = {"seed", "step", "bodies", "manifolds", "points"};
    static const char *const of_level[] = {"iterations", "seconds", "residual_max", "residual_rms"};
    pl_table table = {.line_end = "\n", .missing = ""};
    pl_text_buffer out = {0};
    const json_t *problems = json_object_get(result, "problems");
    pl_table_columns(&table, "problem|held_out|seed|step|bodies|manifolds|points|start|solver|"
                             "tolerance|reached|stop|iterations|seconds|residual_max|residual_rms");
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        const json_t *problem = json_array_get(problems, i);
        const json_t *cells = json_object_get(problem, "cells");
        for (size_t c = 0; c < json_array_size(cells); ++c) {
            const json_t *cell = json_array_get(cells, c);
            const json_t *levels = json_object_get(cell, "levels");
            for (size_t k = 0; k < json_array_size(levels); ++k) {
                const json_t *level = json_array_get(levels, k);
                pl_table_add(&table, pl_json_get_text(problem, "name"));
                pl_table_format_cell(&table, "%d",
                                     json_is_true(json_object_get(problem, "held_out")));
                add_numbers(&table, problem, of_problem, 5);
                pl_table_add(&table, pl_json_get_text(cell, "start"));
                pl_table_add(&table, pl_json_get_text(cell, "solver"));
                pl_table_number(&table, number(level, "tolerance"), 17);
                pl_table_format_cell(&table, "%d", reached(level));
                pl_table_add(&table, pl_json_get_text(level, "stop"));
                add_numbers(&table, level, of_level, 4);
            }
        }
    }
    pl_table_write(&table, PL_TABLE_CSV, &out);
    pl_table_free(&table);
    return text_of(&out);
}
