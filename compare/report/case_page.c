/* One case of the HTML page. Its pictures are drawn only over the very scene that was run: the hash
 * of the rebuilt scene must be that of the results. */
#include "case_page.h"

#include "cell_verdict.h"
#include "losses.h"
#include "number_format.h"
#include "picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- Cells ---- */

void pl_case_columns(const pl_result_matrix *matrix, pl_table *table)
{
    for (int i = 0; i < matrix->column_count; ++i) {
        pl_table_column(table, PL_RIGHT, "%s", matrix->columns[i].name);
    }
}

/* ---- Metrics ---- */

static bool counts_for_best(const pl_cell *cell, int metric)
{
    return cell->result != NULL && cell->ok && cell->metrics[metric].state == PL_METRIC_VALUE;
}

/* Finds the least value over ok runs. False where no best value is marked: there are fewer than two
 * values, all are equal up to noise, or they mean different things to different engines. */
static bool find_best(const pl_case *test_case, int column_count, int metric, double *best)
{
    double most = -INFINITY;
    *best = pl_case_least(test_case, column_count, metric);
    if (!pl_loss_is_compared(metric)) {
        return false;
    }
    for (int i = 0; i < column_count; ++i) {
        if (counts_for_best(&test_case->cells[i], metric)) {
            most = fmax(most, test_case->cells[i].metrics[metric].value);
        }
    }
    return pl_loss_is_worse(test_case, metric, most, *best);
}

/* Adds a row with a metric on every engine; nothing where no engine has it. */
static void add_metric_row(const pl_result_matrix *matrix, const pl_case *test_case, int metric,
                           pl_table *table)
{
    const pl_metric_info *info = &pl_metric_table[metric];
    bool present = false;
    for (int i = 0; i < matrix->column_count; ++i) {
        present |= test_case->cells[i].result != NULL &&
                   test_case->cells[i].metrics[metric].state != PL_METRIC_ABSENT;
    }
    if (!present) {
        return;
    }
    double best = 0;
    const bool has_best = find_best(test_case, matrix->column_count, metric, &best);
    pl_table_add(table, info->name);
    pl_table_style(table, NULL, info->definition);
    for (int i = 0; i < matrix->column_count; ++i) {
        const pl_cell *cell = &test_case->cells[i];
        const pl_metric_summary *summary = &cell->metrics[metric];
        char text[PL_METRIC_TEXT_SIZE], note[PL_METRIC_NOTE_SIZE] = "not run";
        pl_text_buffer markup = {0};
        snprintf(text, sizeof text, "%s", pl_no_number);
        if (cell->result != NULL) {
            pl_metric_note(summary, note);
            pl_metric_text(summary, text);
        }
        const bool is_best = has_best && counts_for_best(cell, metric) &&
                             !pl_loss_is_worse(test_case, metric, summary->value, best);
        pl_text_add_element(&markup, is_best ? "<b class=\"best\">" : "", text,
                            is_best ? "</b>" : "");
        pl_text_add(&markup, summary->disagrees ? PL_CELL_DISAGREES : "");
        pl_page_add_markup(table, &markup);
        pl_table_style(table, NULL, note);
    }
}

/* Adds the verdict on every engine, and below it why. */
static void add_verdict_row(const pl_result_matrix *matrix, const pl_case *test_case,
                            pl_table *table)
{
    pl_table_add(table, "verdict");
    for (int i = 0; i < matrix->column_count; ++i) {
        const pl_cell *cell = &test_case->cells[i];
        pl_text_buffer markup = {0};
        const pl_page page = {.out = &markup, .html = true};
        if (cell->result == NULL) {
            pl_table_add(table, "not run");
        } else {
            pl_cell_badge(&page, cell);
            pl_text_add_element(&markup, "<span class=\"because\">", pl_cell_why(cell), "</span>");
            pl_page_add_markup(table, &markup);
        }
        pl_table_style(table, pl_cell_style(cell), NULL);
    }
}

static void add_outcome_row(const pl_result_matrix *matrix, const pl_case *test_case,
                            pl_table *table)
{
    pl_table_add(table, "outcome");
    for (int i = 0; i < matrix->column_count; ++i) {
        const pl_cell *cell = &test_case->cells[i];
        pl_table_add(table, cell->result == NULL ? "not run" : cell->outcome);
    }
}

/* Adds what makes a run of the case accurate. */
static void add_acceptance(const pl_result_matrix *matrix, const pl_case *test_case,
                           pl_text_buffer *out)
{
    char bound[PL_NUMBER_SIZE];
    const char *reason = NULL;
    if (!pl_case_acceptance(matrix, test_case, bound, &reason)) {
        return;
    }
    pl_text_add_element(out, "<p><b>Accurate:</b> <code>", test_case->primary_error, "</code>");
    pl_text_add_element(out, " of at most ", bound, "");
    pl_text_add_element(out, reason[0] != '\0' ? " <span class=\"small\">(" : "", reason,
                        reason[0] != '\0' ? ")</span></p>\n" : "</p>\n");
}

/* Adds the parameters, or for a scene file, which has none, its time step and duration. */
static void add_params(const pl_case *test_case, pl_text_buffer *out)
{
    static const pl_param times[] = {{.name = "dt", .unit = "s"},
                                     {.name = "duration", .unit = "s"}};
    const pl_scenario *scenario = test_case->catalogue;
    const pl_param *params = scenario == NULL ? times : scenario->params;
    const json_t *values =
        scenario == NULL ? json_object_get(test_case->result, "settings") : test_case->params;
    pl_text_add(out, "<p class=\"small\">");
    for (int i = 0; i < (scenario == NULL ? 2 : scenario->param_count); ++i) {
        const json_t *value = json_object_get(values, params[i].name);
        char number[PL_NUMBER_SIZE];
        pl_format_given(json_is_number(value) ? json_number_value(value) : (double)NAN,
                        params[i].unit, number);
        pl_text_add_element(out, i == 0 ? "" : " · ", params[i].name, " = ");
        pl_text_add_html(out, number);
    }
    pl_text_format(out, " · seed = %" JSON_INTEGER_FORMAT "</p>\n", test_case->seed);
}

/* ---- Pictures ---- */

static pl_status build_from_catalogue(const pl_case *test_case, pl_scene *scene, pl_error *error)
{
    const pl_scenario *scenario = test_case->catalogue;
    double values[PL_MAX_PARAMS];
    char texts[PL_MAX_PARAMS][128];
    const char *settings[PL_MAX_PARAMS];
    int count = 0;
    for (int i = 0; i < scenario->param_count; ++i) {
        const json_t *value = json_object_get(test_case->params, scenario->params[i].name);
        if (!json_is_number(value)) {
            continue; /* it has its default; the hash shows if that has changed */
        }
        snprintf(texts[count], sizeof texts[count], "%.80s=%.17g", scenario->params[i].name,
                 json_number_value(value));
        settings[count] = texts[count];
        ++count;
    }
    pl_status status = pl_scenario_values(scenario, settings, count, values, error);
    if (status != PL_OK) {
        return status;
    }
    return pl_scenario_build(scenario, values, (uint64_t)test_case->seed, scene, error);
}

static pl_status build_from_file(const pl_case *test_case, pl_scene *scene, pl_error *error)
{
    struct stat information;
    if (stat(test_case->scenario, &information) != 0 || !S_ISREG(information.st_mode)) {
        return pl_fail(error, PL_IO, "there is no scene file %.200s here", test_case->scenario);
    }
    pl_status status = pl_scene_read_file(test_case->scenario, scene, error);
    if (status != PL_OK) {
        return status;
    }
    const json_t *settings = json_object_get(test_case->result, "settings");
    const json_t *dt = json_object_get(settings, "dt");
    const json_t *duration = json_object_get(settings, "duration");
    if (json_is_number(dt)) {
        scene->dt = json_number_value(dt);
    }
    if (json_is_number(duration)) {
        scene->duration = json_number_value(duration);
    }
    return PL_OK;
}

/* Rebuilds the scene of a case: from the catalogue, or from the scene file by its path, with the
 * step and the duration of the run. PL_FAILED when its hash is not that of the results. The caller
 * frees. */
static pl_status rebuild_scene(const pl_case *test_case, pl_scene *scene, pl_error *error)
{
    *scene = pl_scene_default();
    pl_status status = test_case->catalogue != NULL ? build_from_catalogue(test_case, scene, error)
                                                    : build_from_file(test_case, scene, error);
    char hash[17] = "";
    if (status == PL_OK) {
        status = pl_scene_hash(scene, hash, error);
    }
    if (status == PL_OK && strcmp(hash, test_case->scene_hash) != 0) {
        status = pl_fail(error, PL_FAILED,
                         "the scene as it is built today (%s) is not the one that was run (%.40s)",
                         hash, test_case->scene_hash);
    }
    if (status != PL_OK) {
        pl_scene_free(scene);
    }
    return status;
}

/* Reads the final poses of a run; NULL with the reason in `why` where there are none. The caller
 * frees. */
static pl_pose *read_poses(const json_t *result, int body_count, char why[160])
{
    const json_t *listed = json_object_get(result, "final_poses");
    if (!json_is_array(listed) || body_count == 0) {
        snprintf(why, 160, "no final poses were recorded");
        return NULL;
    }
    if (json_array_size(listed) != (size_t)body_count) {
        snprintf(why, 160, "%zu poses for %d bodies", json_array_size(listed), body_count);
        return NULL;
    }
    pl_pose *poses = calloc((size_t)body_count, sizeof *poses);
    if (poses == NULL) {
        snprintf(why, 160, "no memory for the poses");
        return NULL;
    }
    for (int i = 0; i < body_count; ++i) {
        for (int k = 0; k < 7; ++k) {
            const json_t *item = json_array_get(json_array_get(listed, (size_t)i), (size_t)k);
            double value = json_is_number(item) ? json_number_value(item) : (double)NAN;
            *(k < 3 ? &poses[i].position[k] : &poses[i].orientation[k - 3]) = value;
        }
    }
    return poses;
}

static void add_caption(const pl_column *column, const pl_cell *cell, int outside,
                        pl_text_buffer *out)
{
    const pl_metric_summary *error = &cell->metrics[PL_METRIC_REFERENCE_ERROR];
    const pl_page page = {.out = out, .html = true};
    char text[PL_METRIC_TEXT_SIZE];
    pl_text_add(out, "<figcaption><b>");
    pl_text_add_html(out, column->name);
    pl_text_add(out, "</b> ");
    pl_cell_badge(&page, cell);
    if (cell->ok || error->state == PL_METRIC_VALUE) {
        pl_metric_text(error, text);
        pl_text_format(out, " error %s", text);
    }
    if (outside > 0) {
        pl_text_format(out, "<br>%d %s outside the picture", outside,
                       outside == 1 ? "body is" : "bodies are");
    }
    pl_text_add(out, "</figcaption></figure>\n");
}

/* The pictures of one case. */
typedef struct picture_row {
    pl_scene scene;
    pl_view view;
    char id[32]; /* of the expected outlines */
} picture_row;

/* Adds the picture of a run; where `poses` is NULL, an empty panel that says `why`. */
static void add_figure(const picture_row *row, const pl_column *column, const pl_cell *cell,
                       const pl_pose *poses, const char *why, pl_text_buffer *out)
{
    int outside = 0;
    pl_text_add(out, "<figure>");
    if (poses != NULL) {
        char title[400], verdict[PL_CELL_VERDICT_SIZE];
        pl_cell_verdict(cell, verdict);
        snprintf(title, sizeof title, "%.255s, %s: where the bodies are at the end", column->name,
                 verdict);
        outside = pl_svg_picture(&row->scene, &row->view, poses, row->id, title, out);
    } else {
        pl_text_format(out, "<div class=\"empty\" style=\"width:%.0fpx;height:%.0fpx\"><span>",
                       row->view.width, row->view.height);
        pl_text_add_html(out, why);
        pl_text_add(out, "</span></div>");
    }
    add_caption(column, cell, outside, out);
}

void pl_case_pictures(const pl_result_matrix *matrix, int index, pl_text_buffer *out)
{
    const pl_case *test_case = &matrix->cases[index];
    int count = matrix->column_count;
    picture_row row = {.scene = pl_scene_default()};
    pl_error error = {PL_OK, ""};
    pl_pose **poses = calloc((size_t)count + 1, sizeof(pl_pose *));
    const pl_pose **framed = calloc((size_t)count + 1, sizeof(const pl_pose *));
    char(*why)[160] = calloc((size_t)count + 1, sizeof *why);
    if (poses == NULL || framed == NULL || why == NULL) {
        out->failed = true;
        goto cleanup;
    }
    if (rebuild_scene(test_case, &row.scene, &error) != PL_OK) {
        pl_text_add(out, "<p class=\"note\">No pictures: ");
        pl_text_add_html(out, error.message);
        pl_text_add(out, ".</p>\n");
        goto cleanup;
    }
    for (int i = 0; i < count; ++i) {
        const pl_cell *cell = &test_case->cells[i];
        if (cell->result == NULL) {
            continue;
        }
        poses[i] = read_poses(cell->result, row.scene.body_count, why[i]);
        /* A run that diverged must not make the pictures of the others smaller. */
        if (cell->ok || strcmp(cell->outcome, "collapsed") == 0) {
            framed[i] = poses[i];
        }
    }
    row.view = pl_view_choose(&row.scene, framed, count);
    snprintf(row.id, sizeof row.id, "expected-%d", index);
    pl_svg_expected(&row.scene, &row.view, row.id, out);
    pl_text_add(out, "<div class=\"pictures\">\n");
    for (int i = 0; i < count; ++i) {
        if (test_case->cells[i].result != NULL) {
            add_figure(&row, &matrix->columns[i], &test_case->cells[i], poses[i], why[i], out);
        }
    }
    pl_text_add(out, "</div>\n");

cleanup:
    for (int i = 0; poses != NULL && i < count; ++i) {
        free(poses[i]);
    }
    free(poses);
    free(framed);
    free(why);
    pl_scene_free(&row.scene);
}

void pl_case_page(const pl_result_matrix *matrix, int index, pl_text_buffer *out)
{
    const pl_case *test_case = &matrix->cases[index];
    const pl_scenario *scenario = test_case->catalogue;
    const pl_page page = {.out = out, .html = true};
    pl_table table = {0};
    pl_text_format(out, "<section>\n<h3 id=\"case-%d\">", index);
    pl_text_add_html(out, test_case->name);
    if (scenario != NULL) {
        pl_text_add_element(out, ": ", scenario->title, "</h3>\n");
        pl_text_add_element(out, "<p>", scenario->description, "</p>\n");
        pl_text_add_element(out, "<p><b>Right answer:</b> <span class=\"formula\">",
                            scenario->reference, "</span> ");
        pl_text_add_element(out, "<span class=\"small\">(", scenario->source, ")</span></p>\n");
    } else {
        pl_text_add(out, "</h3>\n<p>A scene that is not in the catalogue.</p>\n");
    }
    add_acceptance(matrix, test_case, out);
    add_params(test_case, out);
    pl_table_columns(&table, "Metric");
    pl_case_columns(matrix, &table);
    add_verdict_row(matrix, test_case, &table);
    add_outcome_row(matrix, test_case, &table);
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        add_metric_row(matrix, test_case, id, &table);
    }
    pl_page_table(&page, table, 0);
    pl_case_pictures(matrix, index, out);
    pl_text_add(out, "</section>\n");
}
