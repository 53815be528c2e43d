#include "benchmark.h"

#include "plumb/contact_problem.h"
#include "results/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const double pl_benchmark_levels[PL_BENCHMARK_LEVELS] = {1e-3, 1e-4, 1e-6, 1e-8};

/* What the others are measured against: the first of the engine's table. */
static const char *baseline(void)
{
    return pe_solver(0).name;
}

static const char *const STARTS[] = {"warm", "cold"};

static double number(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static bool reached(const json_t *level)
{
    return json_is_true(json_object_get(level, "reached"));
}

/* The cell's level of this tolerance; NULL where it was not tried, a larger one being missed. */
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

/* ---- Losses ------------------------------------------------------------------------------------
 */

static int put_unreached_of(FILE *out, const json_t *problem)
{
    const json_t *cells = json_object_get(problem, "cells");
    int count = 0;
    for (size_t i = 0; i < json_array_size(cells); ++i) {
        const json_t *cell = json_array_get(cells, i);
        const json_t *levels = json_object_get(cell, "levels");
        const json_t *last = json_array_get(levels, json_array_size(levels) - 1);
        if (!reached(last)) {
            fprintf(out, "| %s | %s | %s | %g | %s | %.3g |\n", pl_json_get_text(problem, "name"),
                    pl_json_get_text(cell, "start"), pl_json_get_text(cell, "solver"),
                    number(last, "tolerance"), pl_json_get_text(last, "stop"),
                    number(last, "residual_max"));
            ++count;
        }
    }
    return count;
}

static void put_unreached(FILE *out, const json_t *problems)
{
    int count = 0;
    fputs("## Not reached\n\nThe first level that a solver missed; smaller ones were not tried.\n\n"
          "| problem | start | solver | level, m/s | stopped by | residual, m/s |\n"
          "|---|---|---|---|---|---|\n",
          out);
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        const json_t *problem = json_array_get(problems, i);
        const char *failed = pl_json_get_text(problem, "error");
        if (failed[0] != '\0') {
            fprintf(out, "| %s | | | | not captured: %s | |\n", pl_json_get_text(problem, "name"),
                    failed);
            ++count;
        } else {
            count += put_unreached_of(out, problem);
        }
    }
    fprintf(out, "\n%d cells.\n", count);
}

typedef struct loss {
    const char *problem, *solver, *start;
    double tolerance, ratio; /* of CPU times */
} loss;

static int compare_losses(const void *a, const void *b)
{
    double x = ((const loss *)a)->ratio, y = ((const loss *)b)->ratio;
    return (x < y) - (x > y);
}

/* Calls `visit` for every level that the solver or the baseline was tried on, from one start. */
static void for_each_pair(const json_t *problems, const char *solver, const char *start,
                          double tolerance,
                          void (*visit)(void *user, const json_t *problem, const json_t *level,
                                        const json_t *base),
                          void *user)
{
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        const json_t *problem = json_array_get(problems, i);
        const json_t *level = find_level(find_cell(problem, solver, start), tolerance);
        const json_t *base = find_level(find_cell(problem, baseline(), start), tolerance);
        visit(user, problem, reached(level) ? level : NULL, reached(base) ? base : NULL);
    }
}

typedef struct losses {
    loss *items;
    int count;
    loss next; /* what all of this pass share */
} losses;

static void note_loss(void *user, const json_t *problem, const json_t *level, const json_t *base)
{
    losses *l = user;
    /* Nothing was to be done where the start was good enough. */
    if (level == NULL || base == NULL || !(number(base, "iterations") > 0)) {
        return;
    }
    l->next.ratio = number(level, "seconds") / number(base, "seconds");
    if (l->next.ratio > 1) {
        l->next.problem = pl_json_get_text(problem, "name");
        l->items[l->count++] = l->next;
    }
}

static void put_slower(FILE *out, const json_t *problems)
{
    size_t most = json_array_size(problems) * 2 * (size_t)pe_solver_count() * PL_BENCHMARK_LEVELS;
    losses l = {.items = calloc(most + 1, sizeof *l.items)};
    if (l.items == NULL) {
        return;
    }
    for (int s = 1; s < pe_solver_count(); ++s) {
        for (int start = 0; start < 2; ++start) {
            for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
                l.next = (loss){.solver = pe_solver(s).name,
                                .start = STARTS[start],
                                .tolerance = pl_benchmark_levels[k]};
                for_each_pair(problems, l.next.solver, l.next.start, l.next.tolerance, note_loss,
                              &l);
            }
        }
    }
    qsort(l.items, (size_t)l.count, sizeof *l.items, compare_losses);
    fprintf(out,
            "\n## Slower than %s\n\nCPU time over that of %s, where both reached the level.\n\n"
            "| problem | start | solver | level, m/s | times as long |\n|---|---|---|---|---|\n",
            baseline(), baseline());
    for (int i = 0; i < l.count; ++i) {
        fprintf(out, "| %s | %s | %s | %g | %.2f |\n", l.items[i].problem, l.items[i].start,
                l.items[i].solver, l.items[i].tolerance, l.items[i].ratio);
    }
    fprintf(out, "\n%d cells.\n", l.count);
    free(l.items);
}

/* ---- Means -------------------------------------------------------------------------------------
 */

typedef struct mean {
    double log_iterations, log_seconds;
    int both, alone, missed; /* reached by both; by the solver alone; by the baseline alone */
} mean;

static void add_to_mean(void *user, const json_t *problem, const json_t *level, const json_t *base)
{
    (void)problem;
    mean *m = user;
    m->alone += level != NULL && base == NULL;
    m->missed += level == NULL && base != NULL;
    if (level != NULL && base != NULL && number(base, "iterations") > 0 &&
        number(level, "iterations") > 0) {
        m->log_iterations += log(number(level, "iterations") / number(base, "iterations"));
        m->log_seconds += log(number(level, "seconds") / number(base, "seconds"));
        m->both += 1;
    }
}

static void put_means(FILE *out, const json_t *problems)
{
    fprintf(out,
            "\n## Geometric means against %s\n\nOver the problems where both reached the level and "
            "had something to do; how many these are, and how many only one of the two reached. "
            "Below 1 is better than %s.\n\n"
            "| solver | start | level, m/s | iterations | CPU time | both | only it | only %s |\n"
            "|---|---|---|---|---|---|---|---|\n",
            baseline(), baseline(), baseline());
    for (int s = 1; s < pe_solver_count(); ++s) {
        for (int start = 0; start < 2; ++start) {
            for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
                mean m = {0};
                for_each_pair(problems, pe_solver(s).name, STARTS[start], pl_benchmark_levels[k],
                              add_to_mean, &m);
                fprintf(out, "| %s | %s | %g |", pe_solver(s).name, STARTS[start],
                        pl_benchmark_levels[k]);
                if (m.both > 0) {
                    fprintf(out, " %.3g | %.3g |", exp(m.log_iterations / m.both),
                            exp(m.log_seconds / m.both));
                } else {
                    fputs(" | |", out);
                }
                fprintf(out, " %d | %d | %d |\n", m.both, m.alone, m.missed);
            }
        }
    }
}

/* ---- All cells ---------------------------------------------------------------------------------
 */

static void put_cell(FILE *out, const json_t *cell)
{
    fprintf(out, "| %s | %s |", pl_json_get_text(cell, "solver"), pl_json_get_text(cell, "start"));
    for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
        const json_t *level = find_level(cell, pl_benchmark_levels[k]);
        if (reached(level)) {
            fprintf(out, " %.0f it, %.3g ms |", number(level, "iterations"),
                    1e3 * number(level, "seconds"));
        } else {
            fputs(" not reached |", out);
        }
    }
    fputc('\n', out);
}

static void put_problem(FILE *out, const json_t *problem)
{
    fprintf(out, "\n### %s%s\n\n", pl_json_get_text(problem, "name"),
            json_is_true(json_object_get(problem, "held_out")) ? " (held out)" : "");
    if (pl_json_get_text(problem, "error")[0] != '\0') {
        fprintf(out, "Not captured: %s\n", pl_json_get_text(problem, "error"));
        return;
    }
    fprintf(out, "%s", pl_json_get_text(problem, "scenario"));
    const json_t *settings = json_object_get(problem, "settings");
    for (size_t i = 0; i < json_array_size(settings); ++i) {
        fprintf(out, " %s", json_string_value(json_array_get(settings, i)));
    }
    fprintf(out,
            ", seed %.0f, step %.0f: %.0f bodies, %.0f manifolds, %.0f points; residual %.3g m/s "
            "warm, %.3g cold\n\n| solver | start |",
            number(problem, "seed"), number(problem, "step"), number(problem, "bodies"),
            number(problem, "manifolds"), number(problem, "points"),
            number(problem, "warm_residual"), number(problem, "cold_residual"));
    for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
        fprintf(out, " to %g m/s |", pl_benchmark_levels[k]);
    }
    fputs("\n|---|---|", out);
    for (int k = 0; k < PL_BENCHMARK_LEVELS; ++k) {
        fputs("---|", out);
    }
    fputc('\n', out);
    const json_t *cells = json_object_get(problem, "cells");
    for (size_t i = 0; i < json_array_size(cells); ++i) {
        put_cell(out, json_array_get(cells, i));
    }
}

/* The text that `put` writes, malloc'd. */
static char *text_of(void (*put)(FILE *out, const json_t *result), const json_t *result)
{
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);
    if (out == NULL) {
        return NULL;
    }
    put(out, result);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

static void put_markdown(FILE *out, const json_t *result)
{
    const json_t *problems = json_object_get(result, "problems");
    const json_t *host = json_object_get(result, "host");
    fprintf(out,
            "# Solver benchmark\n\n%zu contact problems captured from plumb:accurate, solved again "
            "by every solver, each level a solve of its own. The residual is the largest natural "
            "map over all contact points, in m/s. CPU times are medians of up to 9 repeats, one "
            "thread, on %s.\n\n",
            json_array_size(problems), pl_json_get_text(host, "cpu"));
    put_unreached(out, problems);
    put_slower(out, problems);
    put_means(out, problems);
    fputs("\n## All problems\n", out);
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        put_problem(out, json_array_get(problems, i));
    }
}

char *pl_benchmark_markdown(const json_t *result)
{
    return text_of(put_markdown, result);
}

static void put_csv_number(FILE *out, const json_t *object, const char *key)
{
    double value = number(object, key);
    fputc(',', out);
    if (isfinite(value)) {
        fprintf(out, "%.17g", value);
    }
}

static void put_csv(FILE *out, const json_t *result)
{
    const json_t *problems = json_object_get(result, "problems");
    fputs("problem,held_out,seed,step,bodies,manifolds,points,start,solver,tolerance,reached,stop,"
          "iterations,seconds,residual_max,residual_rms\n",
          out);
    for (size_t i = 0; i < json_array_size(problems); ++i) {
        const json_t *problem = json_array_get(problems, i);
        const json_t *cells = json_object_get(problem, "cells");
        for (size_t c = 0; c < json_array_size(cells); ++c) {
            const json_t *cell = json_array_get(cells, c);
            const json_t *levels = json_object_get(cell, "levels");
            for (size_t k = 0; k < json_array_size(levels); ++k) {
                const json_t *level = json_array_get(levels, k);
                fprintf(out, "%s,%d", pl_json_get_text(problem, "name"),
                        json_is_true(json_object_get(problem, "held_out")));
                put_csv_number(out, problem, "seed");
                put_csv_number(out, problem, "step");
                put_csv_number(out, problem, "bodies");
                put_csv_number(out, problem, "manifolds");
                put_csv_number(out, problem, "points");
                fprintf(out, ",%s,%s", pl_json_get_text(cell, "start"),
                        pl_json_get_text(cell, "solver"));
                put_csv_number(out, level, "tolerance");
                fprintf(out, ",%d,%s", reached(level), pl_json_get_text(level, "stop"));
                put_csv_number(out, level, "iterations");
                put_csv_number(out, level, "seconds");
                put_csv_number(out, level, "residual_max");
                put_csv_number(out, level, "residual_rms");
                fputc('\n', out);
            }
        }
    }
}

char *pl_benchmark_csv(const json_t *result)
{
    return text_of(put_csv, result);
}
