/* Reads rows of results, and drops those that newer ones replace. */
#include "result_table.h"

#include "base/heap.h"
#include "base/program_name.h"
#include "plumb/scenario.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Reading ---- */

static int rank_in_catalogue(const pl_scenario *scenario)
{
    int count = 0, i = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    while (i < count && all[i] != scenario) {
        ++i;
    }
    return i;
}

/* A row without its key; an outcome that is unknown is PL_OUTCOME_COUNT. */
static pl_result_row row_of(const json_t *result)
{
    const json_t *settings = json_object_get(result, "settings");
    const json_t *member = json_object_get(result, "member");
    const char *scenario = pl_json_get_text(result, "scenario");
    const pl_scenario *catalogue = pl_scenario_find(scenario, NULL);
    return (pl_result_row){
        .result = result,
        .run = pl_json_get_text(result, "run"),
        .scenario = scenario,
        .scene_hash = pl_json_get_text(result, "scene_hash"),
        .edition = pl_json_get_text(result, "scene_edition"),
        .change = pl_json_get_text(result, "change"),
        .primary_error = pl_json_get_text(result, "primary_error"),
        .engine = pl_json_get_text(result, "engine"),
        .profile = pl_json_get_text(result, "profile"),
        .label = pl_json_get_text(result, "label"),
        .spec = pl_json_get_text(result, "engine_spec"),
        .version = pl_json_get_text(result, "engine_version"),
        .binary = pl_json_get_text(result, "engine_binary"),
        .git = pl_result_text(result, PL_PROGRAM, "git"),
        .cpu = pl_result_text(result, "host", "cpu"),
        .started = pl_json_get_text(result, "started"),
        .reason = pl_json_get_text(result, "reason"),
        .params = json_object_get(result, "params"),
        .metrics = json_object_get(result, "metrics"),
        .catalogue = catalogue,
        .catalogue_rank = rank_in_catalogue(catalogue),
        .outcome = pl_outcome_named(pl_json_get_text(result, "outcome")),
        .verdict = pl_verdict_of(result),
        .dt = json_number_value(json_object_get(settings, "dt")),
        .duration = json_number_value(json_object_get(settings, "duration")),
        .seed = json_integer_value(json_object_get(result, "seed")),
        .repeat = json_integer_value(json_object_get(result, "repeat")),
        .member = json_is_integer(member) ? (int)json_integer_value(member) : -1,
    };
}

static pl_status check_row(const pl_result_row *row, const char *path, pl_error *error)
{
    const struct {
        const char *key, *expected;
        bool is_right;
    } checks[] = {
        {"schema", "\"plumb.result/1\"",
         strcmp(pl_json_get_text(row->result, "schema"), "plumb.result/1") == 0},
        {"scenario", "a text", json_is_string(json_object_get(row->result, "scenario"))},
        {"engine", "a text", json_is_string(json_object_get(row->result, "engine"))},
        {"label", "a text", json_is_string(json_object_get(row->result, "label"))},
        {"outcome", "an outcome, such as \"ok\"", (int)row->outcome != PL_OUTCOME_COUNT},
        {"settings.dt", "a time step above 0", row->dt > 0},
        {"metrics", "an object", json_is_object(row->metrics)},
        {"params", "an object", row->params == NULL || json_is_object(row->params)},
    };
    const char *name;
    json_t *value;
    for (size_t i = 0; i < sizeof checks / sizeof checks[0]; ++i) {
        if (!checks[i].is_right) {
            return pl_fail(error, PL_BAD_INPUT, "%s:%d:1: %s: expected %s", path, row->line,
                           checks[i].key, checks[i].expected);
        }
    }
    json_object_foreach((json_t *)row->params, name, value)
    {
        if (!json_is_number(value)) {
            return pl_fail(error, PL_BAD_INPUT, "%s:%d:1: params.%s: expected a number", path,
                           row->line, name);
        }
    }
    return PL_OK;
}

pl_case_identity pl_result_row_identity(const pl_result_row *row)
{
    return (pl_case_identity){.scenario = row->scenario,
                              .catalogue = row->catalogue,
                              .params = row->params,
                              .dt = row->dt,
                              .duration = row->duration,
                              .seed = row->seed,
                              .member = row->member};
}

/* The same at any time step. The duration of a scene file is no parameter unless it was given; that of other scenes
 * may follow from the time step. */
pl_case_identity pl_result_row_scene(const pl_result_row *row)
{
    pl_case_identity identity = pl_result_row_identity(row);
    const json_t *given = json_object_get(row->params, "duration");
    identity.duration = given != NULL ? json_number_value(given) : row->duration;
    identity.dt = (double)NAN;
    return identity;
}

static bool is_wanted(const pl_result_table_def *def, const pl_result_row *row)
{
    const json_t *study = json_object_get(row->result, "study");
    const char *name = pl_json_get_text(study, "name");
    return (def->has_changes || row->change[0] == '\0') &&
           (def->study == NULL ? study == NULL : strcmp(name, def->study) == 0);
}

/* What tells scenes apart. Runs of a study that say of themselves what they are, are of scenes of their own: a scene
 * that begins in the middle of another run depends on the engine. */
static char *scene_key(const pl_case_identity *identity, const json_t *study)
{
    char *key = pl_case_key(identity);
    if (study == NULL) {
        return key;
    }
    char *text = pl_result_to_line(study);
    char *both = pl_heap_format("%s%s", key, text);
    free(key);
    free(text);
    return both;
}

static pl_status read_file(const pl_result_table_def *def, int index, pl_result_table *table,
                           pl_error *error)
{
    const pl_result_file *file = &def->files[index];
    pl_status status = PL_OK;
    if (!json_is_array(file->results)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected results", file->path);
    }
    for (size_t i = 0; i < json_array_size(file->results) && status == PL_OK; ++i) {
        pl_result_row row = row_of(json_array_get(file->results, i));
        row.file = index;
        row.line = file->lines != NULL ? file->lines[i] : (int)i + 1;
        row.snapshot = file->snapshot;
        status = check_row(&row, file->path, error);
        if (status == PL_OK && is_wanted(def, &row)) {
            const pl_case_identity identity = pl_result_row_scene(&row);
            row.key = scene_key(&identity, json_object_get(row.result, "study"));
            pl_push(&table->rows, &table->row_count, &row, sizeof row);
        }
    }
    return status;
}

/* ---- Orders ---- */

static int compare_numbers(double a, double b)
{
    return (a > b) - (a < b);
}

static double param_of(const pl_result_row *row, const char *name, double otherwise)
{
    const json_t *value = json_object_get(row->params, name);
    return value != NULL ? json_number_value(value) : otherwise;
}

static int compare_params(const pl_result_row *a, const pl_result_row *b)
{
    int order = 0;
    const char *name;
    json_t *value;
    for (int i = 0; a->catalogue != NULL && i < a->catalogue->param_count && order == 0; ++i) {
        const pl_param *param = &a->catalogue->params[i];
        order = strcmp(param->name, "dt") == 0
                    ? 0
                    : compare_numbers(param_of(a, param->name, param->value),
                                      param_of(b, param->name, param->value));
    }
    json_object_foreach((json_t *)a->params, name, value)
    {
        if (order == 0 && a->catalogue == NULL && strcmp(name, "dt") != 0) {
            order = compare_numbers(json_number_value(value), param_of(b, name, 0));
        }
    }
    return order;
}

int pl_result_rows_compare_scenes(const pl_result_row *a, const pl_result_row *b)
{
    int order = 0;
    if (strcmp(a->key, b->key) != 0) {
        order = a->catalogue_rank - b->catalogue_rank;
        order = order != 0 ? order : strcmp(a->scenario, b->scenario);
        order = order != 0 ? order : compare_params(a, b);
        order = order != 0 ? order : compare_numbers((double)a->seed, (double)b->seed);
        order = order != 0 ? order : a->member - b->member;
        order = order != 0 ? order : strcmp(a->key, b->key);
    }
    order = order != 0 ? order : strcmp(a->primary_error, b->primary_error);
    return order != 0 ? order : strcmp(a->edition, b->edition);
}

/* Of one scene. */
static int compare_steps(const pl_result_row *a, const pl_result_row *b)
{
    const int order = compare_numbers(b->dt, a->dt);
    return order != 0 ? order : strcmp(a->change, b->change);
}

int pl_result_rows_compare_cases(const pl_result_row *a, const pl_result_row *b)
{
    int order = pl_result_rows_compare_scenes(a, b);
    order = order != 0 ? order : compare_steps(a, b);
    return order != 0 ? order : strcmp(a->scene_hash, b->scene_hash);
}

/* The build of an engine; of results of earlier versions, which have no binary, that of the harness. */
int pl_result_rows_compare_builds(const pl_result_row *a, const pl_result_row *b)
{
    int order = strcmp(a->version, b->version);
    order = order != 0 ? order : strcmp(a->binary, b->binary);
    return order != 0 || a->binary[0] != '\0' ? order : strcmp(a->git, b->git);
}

/* ---- What counts ---- */

/* Writes two texts of a row: the group to which it belongs, and its version in that group. The caller frees them. */
typedef void versions(const pl_result_row *row, char **group, char **version);

/* By file of scenes; rows that state no edition are by themselves. */
static void note_edition(const pl_result_row *row, char **group, char **version)
{
    *group = pl_heap_format("%d %d %s", row->snapshot, row->edition[0] == '\0', row->scenario);
    *version = pl_heap_copy(row->edition);
}

/* By all that should give one scene. */
static void note_hash(const pl_result_row *row, char **group, char **version)
{
    *group = pl_heap_format("%d %.17g %s\x01%s", row->snapshot, row->dt, row->change, row->key);
    *version = pl_heap_copy(row->scene_hash);
}

/* By label without the options: "ode:quick", or what label= gave. */
static void note_build(const pl_result_row *row, char **group, char **version)
{
    *group = pl_heap_format("%d %.*s", row->snapshot, (int)strcspn(row->label, ","), row->label);
    *version = pl_heap_format("%s\x01%s\x01%s", row->version, row->binary,
                              row->binary[0] == '\0' ? row->git : "");
}

/* Returns whether the row is of the version of its group that started last, as far as that is noted in `newest`:
 * group -> [start, version]. Notes it where the row is newer. */
static bool is_newest(json_t *newest, const pl_result_row *row, versions *note)
{
    char *group, *version;
    note(row, &group, &version);
    const json_t *known = json_object_get(newest, group);
    const char *last = json_string_value(json_array_get(known, 1));
    int order =
        known == NULL ? 1 : strcmp(row->started, json_string_value(json_array_get(known, 0)));
    order = order != 0 ? order : strcmp(version, last);
    const bool is_same = known != NULL && strcmp(version, last) == 0;
    if (order > 0) {
        json_object_set_new(newest, group, json_pack("[s, s]", row->started, version));
    }
    free(group);
    free(version);
    return is_same || order > 0;
}

/* Drops the rows of a group that are of another version than the one that started last. Returns how many. */
static int drop_old(pl_result_table *table, versions *note)
{
    json_t *newest = json_object();
    const int count = table->row_count;
    for (int i = 0; i < count; ++i) {
        (void)is_newest(newest, &table->rows[i], note);
    }
    table->row_count = 0;
    for (int i = 0; i < count; ++i) {
        if (is_newest(newest, &table->rows[i], note)) {
            table->rows[table->row_count++] = table->rows[i];
        } else {
            free(table->rows[i].key);
        }
    }
    json_decref(newest);
    return count - table->row_count;
}

static int compare_same_scene(const void *left, const void *right)
{
    const pl_result_row *a = left, *b = right;
    int order = strcmp(a->key, b->key);
    order = order != 0 ? order : compare_steps(a, b);
    order = order != 0 ? order : strcmp(a->scene_hash, b->scene_hash);
    return order != 0 ? order : strcmp(b->edition, a->edition);
}

/* A row that states no edition is of that of another row with the same scene. */
static void find_editions(pl_result_table *table)
{
    pl_result_row *rows = table->rows;
    if (table->row_count > 0) {
        qsort(rows, (size_t)table->row_count, sizeof *rows, compare_same_scene);
    }
    for (int i = 1; i < table->row_count; ++i) {
        if (rows[i].edition[0] == '\0' && strcmp(rows[i].key, rows[i - 1].key) == 0 &&
            compare_steps(&rows[i], &rows[i - 1]) == 0 &&
            strcmp(rows[i].scene_hash, rows[i - 1].scene_hash) == 0) {
            rows[i].edition = rows[i - 1].edition;
        }
    }
}

pl_status pl_result_rows_read(const pl_result_table_def *def, pl_result_table *table,
                              pl_error *error)
{
    for (int i = 0; i < def->file_count; ++i) {
        const pl_status status = read_file(def, i, table, error);
        if (status != PL_OK) {
            return status;
        }
    }
    find_editions(table);
    table->old_scenes = drop_old(table, note_edition) + drop_old(table, note_hash);
    table->old_builds = drop_old(table, note_build);
    return PL_OK;
}
