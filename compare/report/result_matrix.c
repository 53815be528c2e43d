/* Gathers results into blocks, columns and cells. */
#include "result_matrix.h"

#include "quantity.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pl_status check_row(const json_t *row, size_t index, pl_error *error)
{
    static const char *const texts[] = {"scenario", "engine", "label", "outcome"};
    if (!json_is_object(row))
        return pl_fail(error, PL_BAD_INPUT, "results[%zu]: expected an object", index);
    if (strcmp(pl_json_get_text(row, "schema"), "plumb.result/1") != 0)
        return pl_fail(error, PL_BAD_INPUT,
                       "results[%zu].schema: expected \"plumb.result/1\", found \"%.40s\"", index,
                       pl_json_get_text(row, "schema"));
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (!json_is_string(json_object_get(row, texts[i])))
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].%s: expected a string", index,
                           texts[i]);
    if (!json_is_object(json_object_get(row, "metrics")))
        return pl_fail(error, PL_BAD_INPUT, "results[%zu].metrics: expected an object", index);
    return PL_OK;
}

/* --- Columns --- */

static pl_column column_of(const json_t *row)
{
    return (pl_column){.label = pl_json_get_text(row, "label"),
                       .engine = pl_json_get_text(row, "engine"),
                       .version = pl_json_get_text(row, "engine_version"),
                       .git = pl_row_text_in(row, "plumb", "git"),
                       .ours = strcmp(pl_json_get_text(row, "engine"), "plumb") == 0};
}

static int compare_columns(const void *left, const void *right)
{
    const pl_column *a = left, *b = right;
    if (a->ours != b->ours)
        return a->ours ? -1 : 1;
    int order = strcmp(a->label, b->label);
    if (order == 0)
        order = strcmp(a->version, b->version);
    return order != 0 ? order : strcmp(a->git, b->git);
}

static int find_column(const pl_result_matrix *cells, const json_t *row)
{
    pl_column wanted = column_of(row);
    for (int i = 0; i < cells->column_count; i++)
        if (compare_columns(&cells->columns[i], &wanted) == 0)
            return i;
    return -1;
}

static void name_columns(pl_result_matrix *cells)
{
    for (int i = 0; i < cells->column_count; i++) {
        pl_column *column = &cells->columns[i];
        bool other_version = false, other_git = false;
        for (int k = 0; k < cells->column_count; k++) {
            const pl_column *other = &cells->columns[k];
            if (k == i || strcmp(other->label, column->label) != 0)
                continue;
            other_version |= strcmp(other->version, column->version) != 0;
            other_git |= strcmp(other->git, column->git) != 0;
        }
        snprintf(column->name, sizeof column->name, "%.150s%s%.40s%s%.40s", column->label,
                 other_version ? " " : "", other_version ? column->version : "",
                 other_git ? " @" : "", other_git ? column->git : "");
    }
}

/* --- Blocks --- */

static pl_block block_of(const json_t *row)
{
    const char *scenario = pl_json_get_text(row, "scenario");
    return (pl_block){.row = row,
                      .catalogue = pl_scenario_find(scenario, NULL),
                      .scenario = scenario,
                      .scene_hash = pl_json_get_text(row, "scene_hash"),
                      .primary_error = pl_json_get_text(row, "primary_error"),
                      .params = json_object_get(row, "params"),
                      .seed = json_integer_value(json_object_get(row, "seed"))};
}

static bool same_problem(const pl_block *a, const pl_block *b)
{
    bool same_params = a->params == NULL ? b->params == NULL : json_equal(a->params, b->params);
    return a->seed == b->seed && strcmp(a->scenario, b->scenario) == 0 &&
           strcmp(a->scene_hash, b->scene_hash) == 0 && same_params;
}

static int find_block(const pl_result_matrix *cells, const json_t *row)
{
    pl_block wanted = block_of(row);
    for (int i = 0; i < cells->block_count; i++)
        if (same_problem(&cells->blocks[i], &wanted))
            return i;
    return -1;
}

static int catalogue_index(const pl_scenario *scenario)
{
    int count = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    int i = 0;
    while (i < count && all[i] != scenario)
        i++;
    return i;
}

static double param_value(const pl_block *block, const char *name)
{
    return json_number_value(json_object_get(block->params, name));
}

static int compare_blocks(const void *left, const void *right)
{
    const pl_block *a = left, *b = right;
    int order = catalogue_index(a->catalogue) - catalogue_index(b->catalogue);
    if (order == 0)
        order = strcmp(a->scenario, b->scenario);
    for (int i = 0; order == 0 && a->catalogue != NULL && i < a->catalogue->param_count; i++) {
        double x = param_value(a, a->catalogue->params[i].name);
        double y = param_value(b, a->catalogue->params[i].name);
        order = (x > y) - (x < y);
    }
    if (order == 0)
        order = (a->seed > b->seed) - (a->seed < b->seed);
    return order != 0 ? order : strcmp(a->scene_hash, b->scene_hash);
}

static void append(char *text, size_t size, const char *part)
{
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s", part);
}

static void name_block(pl_block *block)
{
    char part[128];
    snprintf(block->name, sizeof block->name, "%.120s", block->scenario);
    for (int i = 0; block->catalogue != NULL && i < block->catalogue->param_count; i++) {
        const pl_param *param = &block->catalogue->params[i];
        const json_t *value = json_object_get(block->params, param->name);
        if (!json_is_number(value) || json_number_value(value) == param->value)
            continue;
        char number[PL_QUANTITY_SIZE];
        pl_quantity_given(json_number_value(value), param->unit, number);
        snprintf(part, sizeof part, " %s=%.60s", param->name, number);
        append(block->name, sizeof block->name, part);
    }
    if (block->seed != 0) {
        snprintf(part, sizeof part, " seed=%" JSON_INTEGER_FORMAT, block->seed);
        append(block->name, sizeof block->name, part);
    }
}

/* Two problems of one name are told apart by the scene's hash. */
static void name_blocks(pl_result_matrix *cells)
{
    for (int i = 0; i < cells->block_count; i++)
        name_block(&cells->blocks[i]);
    for (int i = 0; i < cells->block_count; i++) {
        int first = i, last = i;
        while (first > 0 && strcmp(cells->blocks[first - 1].name, cells->blocks[i].name) == 0)
            first--;
        while (last + 1 < cells->block_count &&
               strcmp(cells->blocks[last + 1].name, cells->blocks[i].name) == 0)
            last++;
        for (int k = first; k <= last && first < last; k++) {
            char part[32];
            snprintf(part, sizeof part, " #%.16s", cells->blocks[k].scene_hash);
            append(cells->blocks[k].name, sizeof cells->blocks[k].name, part);
        }
    }
}

/* --- Cells --- */

/* `rows` are the repeats of one run, at least one. */
static void fill_cell(pl_cell *cell, const json_t *const *rows, int count, const json_t **metrics,
                      double *scratch)
{
    const json_t *shown = NULL;
    const char *cpu = pl_row_text_in(rows[0], "host", "cpu");
    *cell = (pl_cell){.repeats = count};
    for (int i = 0; i < count; i++) {
        const char *outcome = pl_json_get_text(rows[i], "outcome");
        if (strcmp(outcome, "ok") == 0)
            cell->ok_repeats++;
        else if (shown == NULL)
            shown = rows[i];
        cell->outcomes_differ |= strcmp(outcome, pl_json_get_text(rows[0], "outcome")) != 0;
        cell->mixed_hosts |= strcmp(cpu, pl_row_text_in(rows[i], "host", "cpu")) != 0;
    }
    cell->row = shown == NULL ? rows[0] : shown;
    cell->ok = cell->ok_repeats == count;
    cell->outcome = pl_json_get_text(cell->row, "outcome");
    cell->reason = pl_json_get_text(cell->row, "reason");
    for (int id = 0; id < PL_METRIC_COUNT; id++) {
        for (int i = 0; i < count; i++)
            metrics[i] =
                json_object_get(json_object_get(rows[i], "metrics"), pl_metric_table[id].name);
        cell->measure[id] = pl_measure_of(metrics, count, id, scratch);
    }
}

bool pl_cell_disagrees(const pl_cell *cell)
{
    bool disagrees = cell->outcomes_differ;
    for (int id = 0; id < PL_METRIC_COUNT; id++)
        disagrees |= cell->measure[id].disagrees;
    return disagrees;
}

/* A row with its place, so that sorting brings the repeats of a run together. */
typedef struct placed_row {
    const json_t *row;
    int block, column;
    size_t index;
} placed_row;

static int compare_places(const void *left, const void *right)
{
    const placed_row *a = left, *b = right;
    if (a->block != b->block)
        return a->block < b->block ? -1 : 1;
    if (a->column != b->column)
        return a->column < b->column ? -1 : 1;
    json_int_t a_repeat = json_integer_value(json_object_get(a->row, "repeat"));
    json_int_t b_repeat = json_integer_value(json_object_get(b->row, "repeat"));
    if (a_repeat != b_repeat)
        return a_repeat < b_repeat ? -1 : 1;
    int order = strcmp(pl_json_get_text(a->row, "started"), pl_json_get_text(b->row, "started"));
    if (order != 0)
        return order;
    return a->index < b->index ? -1 : 1;
}

/* Fills every cell from rows sorted by place. */
static pl_status fill_cells(pl_result_matrix *cells, const placed_row *placed, size_t count,
                            pl_error *error)
{
    pl_status status = PL_OK;
    const json_t **rows = calloc(count + 1, sizeof(const json_t *));
    const json_t **metrics = calloc(count + 1, sizeof(const json_t *));
    double *scratch = calloc(count + 1, sizeof *scratch);
    if (rows == NULL || metrics == NULL || scratch == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
        goto cleanup;
    }
    for (size_t first = 0, next; first < count; first = next) {
        int repeats = 0;
        for (next = first; next < count && placed[next].block == placed[first].block &&
                           placed[next].column == placed[first].column;
             next++) {
            bool again = false;
            for (int i = 0; i < repeats && !again; i++)
                again = json_equal(rows[i], placed[next].row);
            if (!again)
                rows[repeats++] = placed[next].row;
        }
        pl_cell *cell = &cells->blocks[placed[first].block].cells[placed[first].column];
        fill_cell(cell, rows, repeats, metrics, scratch);
        cells->run_count += repeats;
        cells->disagrees |= pl_cell_disagrees(cell);
        if (first == 0 || placed[first].block != placed[first - 1].block)
            cells->blocks[placed[first].block].row = cell->row;
        if (first > 0)
            cells->several_hosts |= strcmp(pl_row_text_in(cell->row, "host", "cpu"),
                                           pl_row_text_in(placed[0].row, "host", "cpu")) != 0;
        cells->several_hosts |= cell->mixed_hosts;
    }

cleanup:
    free(rows);
    free(metrics);
    free(scratch);
    return status;
}

/* Makes the columns and the empty blocks, sorted and named. */
static pl_status lay_out(const json_t *results, pl_result_matrix *cells, pl_error *error)
{
    size_t count = json_array_size(results);
    cells->blocks = calloc(count + 1, sizeof *cells->blocks);
    cells->columns = calloc(count + 1, sizeof *cells->columns);
    if (cells->blocks == NULL || cells->columns == NULL)
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
    for (size_t i = 0; i < count; i++) {
        const json_t *row = json_array_get(results, i);
        pl_status status = check_row(row, i, error);
        if (status != PL_OK)
            return status;
        if (find_column(cells, row) < 0)
            cells->columns[cells->column_count++] = column_of(row);
        if (find_block(cells, row) < 0)
            cells->blocks[cells->block_count++] = block_of(row);
    }
    qsort(cells->columns, (size_t)cells->column_count, sizeof *cells->columns, compare_columns);
    qsort(cells->blocks, (size_t)cells->block_count, sizeof *cells->blocks, compare_blocks);
    name_columns(cells);
    name_blocks(cells);
    for (int i = 0; i < cells->block_count; i++) {
        cells->blocks[i].cells = calloc((size_t)cells->column_count, sizeof(pl_cell));
        if (cells->blocks[i].cells == NULL)
            return pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
        for (int k = 0; k < cells->column_count; k++)
            cells->blocks[i].cells[k] = (pl_cell){.outcome = "", .reason = ""};
    }
    return PL_OK;
}

pl_status pl_result_matrix_build(const json_t *results, pl_result_matrix *cells, pl_error *error)
{
    *cells = (pl_result_matrix){.results = results};
    if (!json_is_array(results))
        return pl_fail(error, PL_BAD_INPUT, "results: expected an array");
    pl_status status = lay_out(results, cells, error);
    if (status != PL_OK)
        return status;
    size_t count = json_array_size(results);
    placed_row *placed = calloc(count + 1, sizeof *placed);
    if (placed == NULL)
        return pl_fail(error, PL_NO_MEMORY, "no memory for %zu results", count);
    for (size_t i = 0; i < count; i++) {
        const json_t *row = json_array_get(results, i);
        placed[i] = (placed_row){.row = row,
                                 .block = find_block(cells, row),
                                 .column = find_column(cells, row),
                                 .index = i};
    }
    qsort(placed, count, sizeof *placed, compare_places);
    status = fill_cells(cells, placed, count, error);
    free(placed);
    return status;
}

void pl_result_matrix_free(pl_result_matrix *cells)
{
    for (int i = 0; cells->blocks != NULL && i < cells->block_count; i++)
        free(cells->blocks[i].cells);
    free(cells->blocks);
    free(cells->columns);
    *cells = (pl_result_matrix){0};
}

/* --- Questions --- */

bool pl_block_primary_is(const pl_block *block, int metric)
{
    return strcmp(block->primary_error, pl_metric_table[metric].name) == 0;
}

double pl_block_least(const pl_block *block, int column_count, int metric)
{
    double least = INFINITY;
    for (int i = 0; i < column_count; i++) {
        const pl_cell *cell = &block->cells[i];
        const pl_measure *measure = &cell->measure[metric];
        if (cell->row != NULL && cell->ok && measure->state == PL_METRIC_VALUE)
            least = fmin(least, measure->value);
    }
    return least;
}

bool pl_result_matrix_next_failure(const pl_result_matrix *cells, int *block, int *column)
{
    for (; *block < cells->block_count; ++*block, *column = 0) {
        for (; *column < cells->column_count; ++*column) {
            const pl_cell *cell = &cells->blocks[*block].cells[*column];
            if (cell->row != NULL && !cell->ok)
                return true;
        }
    }
    return false;
}

int pl_result_matrix_warnings(const pl_result_matrix *cells, pl_warning warnings[PL_WARNINGS_MOST])
{
    int count = 0;
    if (cells->several_hosts)
        warnings[count++] = (pl_warning){"These runs come from several machines:",
                                         "their times cannot be compared with each other."};
    if (cells->disagrees)
        warnings[count++] = (pl_warning){"Not deterministic:",
                                         "some repeats of the same run differ where they should "
                                         "agree. The cells are marked."};
    return count;
}

void pl_result_matrix_settings(const pl_result_matrix *cells, int column, pl_text_buffer *out)
{
    int b = 0;
    while (b < cells->block_count && cells->blocks[b].cells[column].row == NULL)
        b++;
    if (b == cells->block_count)
        return;
    json_t *settings = json_object_get(cells->blocks[b].cells[column].row, "settings");
    const char *name, *separator = "";
    json_t *value;
    json_object_foreach(settings, name, value)
    {
        if (strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0)
            continue;
        pl_text_format(out, "%s%s = ", separator, name);
        if (json_is_integer(value))
            pl_text_format(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        else if (json_is_real(value))
            pl_text_format(out, "%.6g", json_real_value(value));
        else
            pl_text_add(out,
                        json_is_string(value) ? json_string_value(value) : pl_quantity_missing);
        separator = ", ";
    }
    if (separator[0] == '\0')
        pl_text_add(out, "none are recorded");
}
