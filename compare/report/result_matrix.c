#include "result_matrix.h"

#include "number_format.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *pl_result_text(const json_t *result, const char *object, const char *key)
{
    return pl_json_get_text(json_object_get(result, object), key);
}

static pl_status check_result(const json_t *result, size_t index, pl_error *error)
{
    static const char *const texts[] = {"scenario", "engine", "label", "outcome"};
    if (!json_is_object(result)) {
        return pl_fail(error, PL_BAD_INPUT, "results[%zu]: expected an object", index);
    }
    if (strcmp(pl_json_get_text(result, "schema"), "plumb.result/1") != 0) {
        return pl_fail(error, PL_BAD_INPUT,
                       "results[%zu].schema: expected \"plumb.result/1\", found \"%.40s\"", index,
                       pl_json_get_text(result, "schema"));
    }
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        if (!json_is_string(json_object_get(result, texts[i]))) {
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].%s: expected a string", index,
                           texts[i]);
        }
    }
    if (!json_is_object(json_object_get(result, "metrics"))) {
        return pl_fail(error, PL_BAD_INPUT, "results[%zu].metrics: expected an object", index);
    }
    return PL_OK;
}

/* ---- Columns ---- */

static pl_column column_of(const json_t *result)
{
    return (pl_column){.label = pl_json_get_text(result, "label"),
                       .engine = pl_json_get_text(result, "engine"),
                       .version = pl_json_get_text(result, "engine_version"),
                       .git = pl_result_text(result, "plumb", "git"),
                       .binary = pl_json_get_text(result, "engine_binary"),
                       .runtime = pl_result_runtime(result),
                       .threads = pl_result_threads(result),
                       .ours = strcmp(pl_json_get_text(result, "engine"), "plumb") == 0};
}

static int compare_columns(const void *left, const void *right)
{
    const pl_column *a = left, *b = right;
    int order = (int)b->ours - (int)a->ours;
    /* NOLINTNEXTLINE(clang-analyzer-core.*): column_of sets all texts */
    order = order != 0 ? order : strcmp(a->label, b->label);
    order = order != 0 ? order : strcmp(a->version, b->version);
    order = order != 0 ? order : strcmp(a->git, b->git);
    return order != 0 ? order : strcmp(a->binary, b->binary);
}

static int find_column(const pl_result_matrix *matrix, const json_t *result)
{
    pl_column wanted = column_of(result);
    for (int i = 0; i < matrix->column_count; ++i) {
        if (compare_columns(&matrix->columns[i], &wanted) == 0) {
            return i;
        }
    }
    return -1;
}

static void name_columns(pl_result_matrix *matrix)
{
    for (int i = 0; i < matrix->column_count; ++i) {
        pl_column *column = &matrix->columns[i];
        bool other_version = false, other_git = false, only_other_binary = false;
        for (int k = 0; k < matrix->column_count; ++k) {
            const pl_column *other = &matrix->columns[k];
            if (k == i || strcmp(other->label, column->label) != 0) {
                continue;
            }
            const bool is_version = strcmp(other->version, column->version) != 0;
            const bool is_git = strcmp(other->git, column->git) != 0;
            other_version |= is_version;
            other_git |= is_git;
            only_other_binary |= !is_version && !is_git;
        }
        snprintf(column->name, sizeof column->name, "%.150s%s%.40s%s%.40s%s%.8s", column->label,
                 other_version ? " " : "", other_version ? column->version : "",
                 other_git ? " @" : "", other_git ? column->git : "",
                 only_other_binary ? " build " : "", only_other_binary ? column->binary : "");
    }
}

/* ---- Cases ---- */

static pl_case case_of(const json_t *result)
{
    const char *scenario = pl_json_get_text(result, "scenario");
    return (pl_case){.result = result,
                     .catalogue = pl_scenario_find(scenario, NULL),
                     .scenario = scenario,
                     .scene_hash = pl_json_get_text(result, "scene_hash"),
                     .primary_error = pl_json_get_text(result, "primary_error"),
                     .params = json_object_get(result, "params"),
                     .seed = json_integer_value(json_object_get(result, "seed"))};
}

static bool is_same_case(const pl_case *a, const pl_case *b)
{
    bool same_params = a->params == NULL ? b->params == NULL : json_equal(a->params, b->params);
    /* NOLINTNEXTLINE(clang-analyzer-core.*): case_of sets all texts */
    return a->seed == b->seed && strcmp(a->scenario, b->scenario) == 0 &&
           strcmp(a->scene_hash, b->scene_hash) == 0 && same_params;
}

static int find_case(const pl_result_matrix *matrix, const json_t *result)
{
    pl_case wanted = case_of(result);
    for (int i = 0; i < matrix->case_count; ++i) {
        if (is_same_case(&matrix->cases[i], &wanted)) {
            return i;
        }
    }
    return -1;
}

static int catalogue_index(const pl_scenario *scenario)
{
    int count = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    int i = 0;
    while (i < count && all[i] != scenario) {
        ++i;
    }
    return i;
}

static double param_value(const pl_case *test_case, const char *name)
{
    return json_number_value(json_object_get(test_case->params, name));
}

static int compare_params(const pl_case *a, const pl_case *b, const char *name)
{
    const double x = param_value(a, name), y = param_value(b, name);
    return (x > y) - (x < y);
}

static int compare_cases(const void *left, const void *right)
{
    const pl_case *a = left, *b = right;
    int order = catalogue_index(a->catalogue) - catalogue_index(b->catalogue);
    if (order == 0) {
        order = strcmp(a->scenario, b->scenario);
    }
    for (int i = 0; order == 0 && a->catalogue != NULL && i < a->catalogue->param_count; ++i) {
        order = compare_params(a, b, a->catalogue->params[i].name);
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)a->params, name, value)
    {
        order = order == 0 && a->catalogue == NULL ? compare_params(a, b, name) : order;
    }
    if (order == 0) {
        order = (a->seed > b->seed) - (a->seed < b->seed);
    }
    return order != 0 ? order : strcmp(a->scene_hash, b->scene_hash);
}

static void append(char *text, size_t size, const char *part)
{
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s", part);
}

static void add_param(pl_case *test_case, const char *name, const json_t *value, const char *unit)
{
    char number[PL_NUMBER_SIZE], part[128];
    pl_format_given(json_number_value(value), unit, number);
    snprintf(part, sizeof part, " %.50s=%.60s", name, number);
    append(test_case->name, sizeof test_case->name, part);
}

/* The name has the parameters that are not at their defaults; of a scene file, whose defaults are not
 * known, all. */
static void name_case(pl_case *test_case)
{
    const pl_scenario *catalogue = test_case->catalogue;
    const char *name;
    json_t *value;
    snprintf(test_case->name, sizeof test_case->name, "%.120s", test_case->scenario);
    for (int i = 0; catalogue != NULL && i < catalogue->param_count; ++i) {
        const pl_param *param = &catalogue->params[i];
        value = json_object_get(test_case->params, param->name);
        if (json_is_number(value) && json_number_value(value) != param->value) {
            add_param(test_case, param->name, value, param->unit);
        }
    }
    json_object_foreach((json_t *)test_case->params, name, value)
    {
        if (catalogue == NULL && json_is_number(value)) {
            add_param(test_case, name, value, strcmp(name, "dt") == 0 ? "s" : "1");
        }
    }
    if (test_case->seed != 0) {
        char part[128];
        snprintf(part, sizeof part, " seed=%" JSON_INTEGER_FORMAT, test_case->seed);
        append(test_case->name, sizeof test_case->name, part);
    }
}

/* Cases that have the same name get the hash of their scene. */
static void name_cases(pl_result_matrix *matrix)
{
    for (int i = 0; i < matrix->case_count; ++i) {
        name_case(&matrix->cases[i]);
    }
    for (int i = 0; i < matrix->case_count; ++i) {
        int first = i, last = i;
        while (first > 0 && strcmp(matrix->cases[first - 1].name, matrix->cases[i].name) == 0) {
            --first;
        }
        while (last + 1 < matrix->case_count &&
               strcmp(matrix->cases[last + 1].name, matrix->cases[i].name) == 0) {
            ++last;
        }
        for (int k = first; k <= last && first < last; ++k) {
            char part[32];
            snprintf(part, sizeof part, " #%.16s", matrix->cases[k].scene_hash);
            append(matrix->cases[k].name, sizeof matrix->cases[k].name, part);
        }
    }
}

/* ---- Cells ---- */

/* Grows as a run is worse: of two repeats the worse one is shown. */
static int badness(const json_t *result)
{
    static const int of[PL_VERDICT_COUNT] = {0, 2, 3, 1};
    return strcmp(pl_json_get_text(result, "outcome"), "ok") != 0 ? 4 : of[pl_verdict_of(result)];
}

/* Summarises the repeats of one run, of which there is at least one. */
static void fill_cell(pl_cell *cell, const json_t *const *runs, int count, double *scratch)
{
    const json_t *shown = runs[0];
    const char *cpu = pl_result_text(runs[0], "host", "cpu");
    *cell = (pl_cell){.repeats = count};
    for (int i = 0; i < count; ++i) {
        const char *outcome = pl_json_get_text(runs[i], "outcome");
        cell->ok_repeats += strcmp(outcome, "ok") == 0;
        shown = badness(runs[i]) > badness(shown) ? runs[i] : shown;
        cell->outcomes_differ |= strcmp(outcome, pl_json_get_text(runs[0], "outcome")) != 0;
        cell->mixed_hosts |= strcmp(cpu, pl_result_text(runs[i], "host", "cpu")) != 0;
    }
    cell->result = shown;
    cell->verdict = pl_verdict_of(shown);
    cell->ok = cell->ok_repeats == count;
    cell->outcome = pl_json_get_text(cell->result, "outcome");
    cell->reason = pl_json_get_text(cell->result, "reason");
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        cell->metrics[id] = pl_metric_summarise(runs, count, id, scratch);
    }
}

bool pl_cell_disagrees(const pl_cell *cell)
{
    bool disagrees = cell->outcomes_differ;
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        disagrees |= cell->metrics[id].disagrees;
    }
    return disagrees;
}

/* A result with its place in the matrix: sorting by place brings the repeats of a run together. */
typedef struct placed_result {
    const json_t *result;
    int test_case, column;
    size_t index;
} placed_result;

static int compare_places(const void *left, const void *right)
{
    const placed_result *a = left, *b = right;
    json_int_t a_repeat = json_integer_value(json_object_get(a->result, "repeat"));
    json_int_t b_repeat = json_integer_value(json_object_get(b->result, "repeat"));
    int order = a->test_case - b->test_case;
    order = order != 0 ? order : a->column - b->column;
    order = order != 0 ? order : (a_repeat > b_repeat) - (a_repeat < b_repeat);
    order = order != 0 ? order
                       : strcmp(pl_json_get_text(a->result, "started"),
                                pl_json_get_text(b->result, "started"));
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

/* Fills every cell from runs sorted by place. */
static pl_status fill_cells(pl_result_matrix *matrix, const placed_result *placed, size_t count,
                            pl_error *error)
{
    pl_status status = PL_OK;
    const json_t **runs = calloc(count + 1, sizeof(const json_t *));
    double *scratch = calloc(count + 1, sizeof *scratch);
    if (runs == NULL || scratch == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
        goto cleanup;
    }
    for (size_t first = 0, next; first < count; first = next) {
        int repeats = 0;
        for (next = first; next < count && placed[next].test_case == placed[first].test_case &&
                           placed[next].column == placed[first].column;
             ++next) {
            bool again = false;
            for (int i = 0; i < repeats && !again; ++i) {
                again = json_equal(runs[i], placed[next].result);
            }
            if (!again) {
                runs[repeats++] = placed[next].result;
            }
        }
        pl_cell *cell = &matrix->cases[placed[first].test_case].cells[placed[first].column];
        fill_cell(cell, runs, repeats, scratch);
        matrix->run_count += repeats;
        matrix->disagrees |= pl_cell_disagrees(cell);
        if (first == 0 || placed[first].test_case != placed[first - 1].test_case) {
            matrix->cases[placed[first].test_case].result = cell->result;
        }
        if (first > 0) {
            matrix->several_hosts |= strcmp(pl_result_text(cell->result, "host", "cpu"),
                                            pl_result_text(placed[0].result, "host", "cpu")) != 0;
        }
        matrix->several_hosts |= cell->mixed_hosts;
    }

cleanup:
    free(runs);
    free(scratch);
    return status;
}

/* Makes the columns and the empty cases, sorted and named. */
static pl_status lay_out(const json_t *results, pl_result_matrix *matrix, pl_error *error)
{
    size_t count = json_array_size(results);
    matrix->cases = calloc(count + 1, sizeof *matrix->cases);
    matrix->columns = calloc(count + 1, sizeof *matrix->columns);
    if (matrix->cases == NULL || matrix->columns == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
    }
    for (size_t i = 0; i < count; ++i) {
        const json_t *result = json_array_get(results, i);
        pl_status status = check_result(result, i, error);
        if (status != PL_OK) {
            return status;
        }
        if (find_column(matrix, result) < 0) {
            matrix->columns[matrix->column_count++] = column_of(result);
        }
        if (find_case(matrix, result) < 0) {
            matrix->cases[matrix->case_count++] = case_of(result);
        }
    }
    qsort(matrix->columns, (size_t)matrix->column_count, sizeof *matrix->columns, compare_columns);
    qsort(matrix->cases, (size_t)matrix->case_count, sizeof *matrix->cases, compare_cases);
    name_columns(matrix);
    name_cases(matrix);
    for (int i = 0; i < matrix->case_count; ++i) {
        matrix->cases[i].cells = calloc((size_t)matrix->column_count, sizeof(pl_cell));
        if (matrix->cases[i].cells == NULL) {
            return pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
        }
        for (int k = 0; k < matrix->column_count; ++k) {
            matrix->cases[i].cells[k] =
                (pl_cell){.outcome = "", .reason = "", .verdict = PL_VERDICT_UNJUDGED};
        }
    }
    return PL_OK;
}

pl_status pl_result_matrix_build(const json_t *results, pl_result_matrix *matrix, pl_error *error)
{
    *matrix = (pl_result_matrix){.results = results};
    if (!json_is_array(results)) {
        return pl_fail(error, PL_BAD_INPUT, "results: expected an array");
    }
    pl_status status = lay_out(results, matrix, error);
    if (status != PL_OK) {
        return status;
    }
    size_t count = json_array_size(results);
    placed_result *placed = calloc(count + 1, sizeof *placed);
    if (placed == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
    }
    for (size_t i = 0; i < count; ++i) {
        const json_t *result = json_array_get(results, i);
        placed[i] = (placed_result){.result = result,
                                    .test_case = find_case(matrix, result),
                                    .column = find_column(matrix, result),
                                    .index = i};
    }
    qsort(placed, count, sizeof *placed, compare_places);
    status = fill_cells(matrix, placed, count, error);
    free(placed);
    return status;
}

void pl_result_matrix_free(pl_result_matrix *matrix)
{
    for (int i = 0; matrix->cases != NULL && i < matrix->case_count; ++i) {
        free(matrix->cases[i].cells);
    }
    free(matrix->cases);
    free(matrix->columns);
    *matrix = (pl_result_matrix){0};
}

/* ---- Queries ---- */

bool pl_case_primary_is(const pl_case *test_case, int metric)
{
    return strcmp(test_case->primary_error, pl_metric_table[metric].name) == 0;
}

bool pl_case_is_entry(const pl_case *test_case, const pl_suite_entry *entry)
{
    const pl_scenario *scenario = test_case->catalogue;
    double values[PL_MAX_PARAMS];
    if (scenario == NULL || strcmp(test_case->scenario, entry->scenario) != 0 ||
        pl_scenario_values(scenario, &entry->setting, entry->setting == NULL ? 0 : 1, values,
                           NULL) != PL_OK) {
        return false;
    }
    for (int i = 0; i < scenario->param_count; ++i) {
        const char *name = scenario->params[i].name;
        const json_t *value = json_object_get(test_case->params, name);
        if (strcmp(name, "dt") != 0 && strcmp(name, "duration") != 0 &&
            (!json_is_number(value) || json_number_value(value) != values[i])) {
            return false;
        }
    }
    return true;
}

void pl_cell_time_text(const pl_column *column, const pl_cell *cell,
                       void (*write)(const pl_metric_summary *summary,
                                     char text[PL_METRIC_TEXT_SIZE]),
                       char text[PL_CELL_TIME_SIZE])
{
    const pl_metric_summary *wall = &cell->metrics[PL_METRIC_WALL_TIME_PER_STEP];
    char cpu[PL_METRIC_TEXT_SIZE], elapsed[PL_METRIC_TEXT_SIZE] = "";
    const bool is_shown = column->threads > 1 && wall->state == PL_METRIC_VALUE;
    write(&cell->metrics[PL_METRIC_TIME_PER_STEP], cpu);
    if (is_shown) {
        write(wall, elapsed);
    }
    snprintf(text, PL_CELL_TIME_SIZE, "%s%s%s", cpu, is_shown ? ", wall " : "", elapsed);
}

double pl_case_least_time(const pl_result_matrix *matrix, const pl_case *test_case)
{
    double least = INFINITY;
    for (int i = 0; i < matrix->column_count; ++i) {
        const pl_cell *cell = &test_case->cells[i];
        const pl_metric_summary *time = &cell->metrics[PL_METRIC_TIME_PER_STEP];
        if (matrix->columns[i].runtime == NULL && cell->result != NULL && cell->ok &&
            time->state == PL_METRIC_VALUE) {
            least = fmin(least, time->value);
        }
    }
    return least;
}

bool pl_result_matrix_next(const pl_result_matrix *matrix,
                           bool (*holds)(const pl_case *test_case, const pl_cell *cell), int *row,
                           int *column)
{
    for (; *row < matrix->case_count; ++*row, *column = 0) {
        for (; *column < matrix->column_count; ++*column) {
            const pl_case *test_case = &matrix->cases[*row];
            const pl_cell *cell = &test_case->cells[*column];
            if (cell->result != NULL && holds(test_case, cell)) {
                return true;
            }
        }
    }
    return false;
}

void pl_result_matrix_engines(const pl_result_matrix *matrix, bool ours, pl_text_buffer *out)
{
    const char *separator = "";
    for (int i = 0; i < matrix->column_count; ++i) {
        if (matrix->columns[i].ours == ours) {
            pl_text_format(out, "%s%s", separator, matrix->columns[i].name);
            separator = ", ";
        }
    }
}

void pl_result_matrix_settings(const pl_result_matrix *matrix, int column, pl_text_buffer *out)
{
    int b = 0;
    while (b < matrix->case_count && matrix->cases[b].cells[column].result == NULL) {
        ++b;
    }
    if (b == matrix->case_count) {
        return;
    }
    json_t *settings = json_object_get(matrix->cases[b].cells[column].result, "settings");
    const char *name, *separator = "";
    json_t *value;
    json_object_foreach(settings, name, value)
    {
        if (strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0) {
            continue;
        }
        pl_text_format(out, "%s%s = ", separator, name);
        if (json_is_integer(value)) {
            pl_text_format(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        } else if (json_is_real(value)) {
            pl_text_format(out, "%.6g", json_real_value(value));
        } else {
            pl_text_add(out, json_is_string(value) ? json_string_value(value) : pl_no_number);
        }
        separator = ", ";
    }
    if (separator[0] == '\0') {
        pl_text_add(out, "none are recorded");
    }
}
