/* Rows that count are sorted; scenes, cases and cells are then runs of neighbours. */
#include "result_table.h"

#include "base/folding.h"
#include "base/heap.h"
#include "engines/registry.h"

#include <stdlib.h>
#include <string.h>

/* ---- Configurations ---- */

static bool is_home(const pl_result_row *row, const char *home)
{
    char with_profile[2 * PL_LABEL_SIZE];
    const size_t plain = strcspn(row->label, ",");
    snprintf(with_profile, sizeof with_profile, "%s:%s", row->engine, row->profile);
    return home != NULL && (strcmp(home, row->label) == 0 || strcmp(home, row->engine) == 0 ||
                            strcmp(home, with_profile) == 0 ||
                            (strlen(home) == plain && strncmp(home, row->label, plain) == 0));
}

/* A row's place among configurations is noted as 0 for those of the home engine, else 1, before they are known. */
static int compare_configurations(const void *left, const void *right)
{
    const pl_result_row *a = left, *b = right;
    int order = a->configuration - b->configuration;
    order = order != 0 ? order : strcmp(a->label, b->label);
    order = order != 0 ? order : strcmp(a->engine, b->engine);
    return order != 0 ? order : pl_result_rows_compare_builds(a, b);
}

static pl_result_configuration configuration_of(const pl_result_row *row, bool home)
{
    return (pl_result_configuration){.label = row->label,
                                     .engine = row->engine,
                                     .profile = row->profile,
                                     .version = row->version,
                                     .git = row->git,
                                     .binary = row->binary,
                                     .runtime = pl_result_runtime(row->result),
                                     .threads = pl_result_threads(row->result),
                                     .is_home = home};
}

/* The label, and what tells the configuration from others of that label, which are its neighbours. */
static void name_configuration(const pl_result_table *table, pl_result_configuration *own)
{
    bool other_version = false, other_git = false, only_other_binary = false;
    for (int i = 0; i < table->configuration_count; ++i) {
        const pl_result_configuration *other = &table->configurations[i];
        if (other == own || strcmp(other->label, own->label) != 0) {
            continue;
        }
        const bool is_version = strcmp(other->version, own->version) != 0;
        const bool is_git = strcmp(other->git, own->git) != 0;
        other_version |= is_version;
        other_git |= is_git;
        only_other_binary |= !is_version && !is_git;
    }
    snprintf(own->name, sizeof own->name, "%.150s%s%.40s%s%.40s%s%.8s", own->label,
             other_version ? " " : "", other_version ? own->version : "", other_git ? " @" : "",
             other_git ? own->git : "", only_other_binary ? " build " : "",
             only_other_binary ? own->binary : "");
}

static void make_configurations(pl_result_table *table, const char *home)
{
    pl_result_row *rows = table->rows;
    for (int i = 0; i < table->row_count; ++i) {
        rows[i].configuration = is_home(&rows[i], home) ? 0 : 1;
    }
    if (table->row_count > 0) {
        qsort(rows, (size_t)table->row_count, sizeof *rows, compare_configurations);
    }
    for (int first = 0, next; first < table->row_count; first = next) {
        const pl_result_configuration made =
            configuration_of(&rows[first], rows[first].configuration == 0);
        for (next = first + 1;
             next < table->row_count && compare_configurations(&rows[first], &rows[next]) == 0;) {
            ++next;
        }
        for (int i = first; i < next; ++i) {
            rows[i].configuration = table->configuration_count;
        }
        pl_push(&table->configurations, &table->configuration_count, &made, sizeof made);
    }
    for (int i = 0; i < table->configuration_count; ++i) {
        name_configuration(table, &table->configurations[i]);
    }
}

static pl_status check_home(const pl_result_table *table, pl_error *error)
{
    if (table->home == NULL || table->row_count == 0 || table->configurations[0].is_home) {
        return PL_OK;
    }
    const char **labels = pl_heap_new((size_t)table->configuration_count, sizeof(const char *));
    char hint[PL_SUGGESTION_SIZE];
    for (int i = 0; i < table->configuration_count; ++i) {
        labels[i] = table->configurations[i].label;
    }
    pl_did_you_mean(table->home, labels, table->configuration_count, hint);
    free(labels);
    return pl_fail(error, PL_BAD_INPUT, "--home %.100s: the results have no run of that engine%s",
                   table->home, hint);
}

/* ---- Scenes, cases and cells ---- */

static int compare_rows(const void *left, const void *right)
{
    const pl_result_row *a = left, *b = right;
    int order = pl_result_rows_compare_cases(a, b);
    order = order != 0 ? order : a->configuration - b->configuration;
    order = order != 0 ? order : (a->repeat > b->repeat) - (a->repeat < b->repeat);
    order = order != 0 ? order : strcmp(a->started, b->started);
    order = order != 0 ? order : a->file - b->file;
    return order != 0 ? order : a->line - b->line;
}

static void drop_doubles(pl_result_table *table)
{
    int kept = 0;
    pl_result_row *rows = table->rows;
    for (int i = 0; i < table->row_count; ++i) {
        bool is_double = false;
        for (int k = kept - 1;
             k >= 0 && !is_double && pl_result_rows_compare_cases(&rows[k], &rows[i]) == 0 &&
             rows[k].configuration == rows[i].configuration && rows[k].repeat == rows[i].repeat;
             --k) {
            is_double = json_equal(rows[k].result, rows[i].result);
        }
        if (is_double) {
            free(rows[i].key);
        } else {
            rows[kept++] = rows[i];
        }
    }
    table->row_count = kept;
}

static void add_row(pl_result_cell *cell, const pl_result_row *row)
{
    ++cell->count;
    cell->worst = pl_result_row_is_worse(row, cell->worst) ? row : cell->worst;
    cell->ok_count += row->outcome == PL_OUTCOME_OK;
    cell->outcomes_differ |= row->outcome != cell->rows->outcome;
    cell->hosts_differ |= strcmp(row->cpu, cell->rows->cpu) != 0;
}

static bool disagree(const pl_result_cell *cell)
{
    bool found = cell->outcomes_differ;
    for (int id = 0; id < PL_METRIC_COUNT && cell->count > 1 && !found; ++id) {
        found = pl_result_cell_metric(cell, id).disagrees;
    }
    return found;
}

/* Makes scenes, cases and cells of the sorted rows. */
static void lay_out(pl_result_table *table)
{
    const size_t count = (size_t)table->row_count;
    table->cells = pl_heap_new(count, sizeof *table->cells);
    table->cases = pl_heap_new(count, sizeof *table->cases);
    table->scenes = pl_heap_new(count, sizeof *table->scenes);
    for (int i = 0; i < table->row_count; ++i) {
        const pl_result_row *row = &table->rows[i], *last = row - 1;
        const bool is_scene = i == 0 || pl_result_rows_compare_scenes(last, row) != 0;
        const bool is_case = is_scene || pl_result_rows_compare_cases(last, row) != 0;
        if (is_scene) {
            table->scenes[table->scene_count++] =
                (pl_result_scene){.row = row, .cases = &table->cases[table->case_count]};
        }
        if (is_case) {
            table->cases[table->case_count++] =
                (pl_result_case){.row = row,
                                 .cells = &table->cells[table->cell_count],
                                 .scene = table->scene_count - 1};
            ++table->scenes[table->scene_count - 1].count;
        }
        if (is_case || last->configuration != row->configuration) {
            table->cells[table->cell_count++] =
                (pl_result_cell){.test_case = table->case_count - 1,
                                 .configuration = row->configuration,
                                 .rows = row,
                                 .worst = row};
            ++table->cases[table->case_count - 1].count;
        }
        add_row(&table->cells[table->cell_count - 1], row);
        table->several_hosts |= strcmp(row->cpu, table->rows[0].cpu) != 0;
    }
    for (int i = 0; i < table->cell_count; ++i) {
        table->cells[i].disagrees = disagree(&table->cells[i]);
        table->disagrees |= table->cells[i].disagrees;
    }
}

/* ---- Names ---- */

/* Counts how many have each name. */
static void count_name(json_t *counts, const char *name)
{
    const json_int_t before = json_integer_value(json_object_get(counts, name));
    json_object_set_new_nocheck(counts, name, json_integer(before + 1));
}

/* Adds the hash of the scene to a name that several have. */
static void mark_name(const json_t *counts, char name[PL_CASE_NAME_SIZE], const pl_result_row *row)
{
    if (json_integer_value(json_object_get(counts, name)) > 1) {
        pl_case_name_add(name, " #%.16s", row->scene_hash);
    }
}

static void name_all(pl_result_table *table)
{
    json_t *cases = json_object(), *scenes = json_object();
    for (int i = 0; i < table->case_count; ++i) {
        pl_result_case *own = &table->cases[i];
        const pl_case_identity identity = pl_result_row_identity(own->row);
        pl_case_name(&identity, own->name);
        if (own->row->change[0] != '\0') {
            pl_case_name_add(own->name, ", %s", own->row->change);
        }
        count_name(cases, own->name);
    }
    for (int i = 0; i < table->scene_count; ++i) {
        pl_result_scene *own = &table->scenes[i];
        const pl_case_identity identity = pl_result_row_scene(own->row);
        pl_case_name(&identity, own->name);
        count_name(scenes, own->name);
    }
    for (int i = 0; i < table->case_count; ++i) {
        mark_name(cases, table->cases[i].name, table->cases[i].row);
    }
    for (int i = 0; i < table->scene_count; ++i) {
        mark_name(scenes, table->scenes[i].name, table->scenes[i].row);
    }
    json_decref(cases);
    json_decref(scenes);
}

/* ---- The table ---- */

pl_status pl_result_table_build(const pl_result_table_def *def, pl_result_table *table,
                                pl_error *error)
{
    *table = (pl_result_table){.home = def->home};
    const pl_status status = pl_result_rows_read(def, table, error);
    if (status != PL_OK) {
        return status;
    }
    make_configurations(table, def->home);
    if (table->row_count > 0) {
        qsort(table->rows, (size_t)table->row_count, sizeof *table->rows, compare_rows);
    }
    drop_doubles(table);
    lay_out(table);
    name_all(table);
    return check_home(table, error);
}

void pl_result_table_free(pl_result_table *table)
{
    for (int i = 0; i < table->row_count; ++i) {
        free(table->rows[i].key);
    }
    free(table->rows);
    free(table->cells);
    free(table->cases);
    free(table->scenes);
    free(table->configurations);
    *table = (pl_result_table){0};
}

/* ---- Queries ---- */

void pl_result_table_print_left_out(const pl_result_table *table, FILE *out)
{
    static const char *const reasons[] = {"scene was edited", "engine was rebuilt"};
    const int counts[] = {table->old_scenes, table->old_builds};
    for (int i = 0; i < 2; ++i) {
        if (counts[i] > 0) {
            pl_print_line(out, "%d %s left out: the %s since", counts[i],
                          counts[i] == 1 ? "result is" : "results are", reasons[i]);
        }
    }
}

static int compare_places(const void *left, const void *right)
{
    const pl_result_row *a = *(const pl_result_row *const *)left;
    const pl_result_row *b = *(const pl_result_row *const *)right;
    return a->file != b->file ? a->file - b->file : a->line - b->line;
}

const pl_result_row **pl_result_table_by_place(const pl_result_table *table)
{
    const pl_result_row **rows =
        pl_heap_new((size_t)table->row_count, sizeof(const pl_result_row *));
    for (int i = 0; i < table->row_count; ++i) {
        rows[i] = &table->rows[i];
    }
    qsort(rows, (size_t)table->row_count, sizeof(const pl_result_row *), compare_places);
    return rows;
}

pl_status pl_results_that_count(const pl_result_table_def *def, json_t **results, pl_error *error)
{
    pl_result_table table;
    pl_status status = pl_result_table_build(def, &table, error);
    *results = NULL;
    if (status == PL_OK) {
        const pl_result_row **rows = pl_result_table_by_place(&table);
        pl_result_table_print_left_out(&table, stderr);
        *results = json_array();
        for (int i = 0; i < table.row_count; ++i) {
            json_array_append(*results, (json_t *)rows[i]->result);
        }
        free(rows);
    }
    pl_result_table_free(&table);
    return status;
}

const pl_result_cell *pl_result_case_cell(const pl_result_case *test_case, int configuration)
{
    int low = 0, high = test_case->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (test_case->cells[middle].configuration < configuration) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    const bool found =
        low < test_case->count && test_case->cells[low].configuration == configuration;
    return found ? &test_case->cells[low] : NULL;
}

/* Grows as a run is worse. */
static int badness(const pl_result_row *row)
{
    static const int of[PL_VERDICT_COUNT] = {[PL_VERDICT_ACCURATE] = 0,
                                             [PL_VERDICT_UNJUDGED] = 1,
                                             [PL_VERDICT_INACCURATE] = 2,
                                             [PL_VERDICT_FAILED] = 3};
    return row->outcome != PL_OUTCOME_OK ? 4 : of[row->verdict];
}

bool pl_result_row_is_worse(const pl_result_row *row, const pl_result_row *other)
{
    return badness(row) > badness(other);
}

double pl_result_row_metric(const pl_result_row *row, int id)
{
    return pl_result_metric(row->result, pl_metric_table[id].name);
}

pl_metric_summary pl_result_cell_metric(const pl_result_cell *cell, int id)
{
    return pl_metric_summarise(cell->rows, cell->count, pl_metric_table[id].name);
}

bool pl_result_cell_is_ok(const pl_result_cell *cell)
{
    return cell->ok_count == cell->count;
}
