/* Rebuilds scenes and lays out their pictures. A picture is drawn only over the very scene that was
 * run: its hash must be the results'. */
#include "picture.h"

#include "quantity.h"
#include "svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static pl_status build_from_catalogue(const pl_block *block, pl_scene *scene, pl_error *error)
{
    const pl_scenario *scenario = block->catalogue;
    double values[PL_MAX_PARAMS];
    char texts[PL_MAX_PARAMS][128];
    const char *settings[PL_MAX_PARAMS];
    int count = 0;
    for (int i = 0; i < scenario->param_count; i++) {
        const json_t *value = json_object_get(block->params, scenario->params[i].name);
        if (!json_is_number(value))
            continue; /* its default: the hash will tell */
        snprintf(texts[count], sizeof texts[count], "%.80s=%.17g", scenario->params[i].name,
                 json_number_value(value));
        settings[count] = texts[count];
        count++;
    }
    pl_status status = pl_scenario_values(scenario, settings, count, values, error);
    if (status != PL_OK)
        return status;
    return scenario->build(values, (uint64_t)block->seed, scene, error);
}

static pl_status build_from_file(const pl_block *block, pl_scene *scene, pl_error *error)
{
    struct stat information;
    if (stat(block->scenario, &information) != 0 || !S_ISREG(information.st_mode))
        return pl_fail(error, PL_IO, "there is no scene file %.200s here", block->scenario);
    pl_status status = pl_scene_read_file(block->scenario, scene, error);
    if (status != PL_OK)
        return status;
    const json_t *settings = json_object_get(block->row, "settings");
    const json_t *dt = json_object_get(settings, "dt");
    const json_t *duration = json_object_get(settings, "duration");
    if (json_is_number(dt))
        scene->dt = json_number_value(dt);
    if (json_is_number(duration))
        scene->duration = json_number_value(duration);
    return PL_OK;
}

pl_status pl_picture_scene(const pl_block *block, pl_scene *scene, pl_error *error)
{
    *scene = pl_scene_default();
    pl_status status = block->catalogue != NULL ? build_from_catalogue(block, scene, error)
                                                : build_from_file(block, scene, error);
    char hash[17] = "";
    if (status == PL_OK)
        status = pl_scene_hash(scene, hash, error);
    if (status == PL_OK && strcmp(hash, block->scene_hash) != 0)
        status = pl_fail(error, PL_FAILED,
                         "the scene as it is built today (%s) is not the one that was run (%.40s)",
                         hash, block->scene_hash);
    if (status != PL_OK)
        pl_scene_free(scene);
    return status;
}

/* The final poses of a run, or NULL with the reason in `why`. The caller frees. */
static pl_pose *read_poses(const json_t *row, int body_count, char why[160])
{
    const json_t *rows = json_object_get(row, "final_poses");
    if (!json_is_array(rows) || body_count == 0) {
        snprintf(why, 160, "no final poses were recorded");
        return NULL;
    }
    if (json_array_size(rows) != (size_t)body_count) {
        snprintf(why, 160, "%zu poses for %d bodies", json_array_size(rows), body_count);
        return NULL;
    }
    pl_pose *poses = calloc((size_t)body_count, sizeof *poses);
    if (poses == NULL) {
        snprintf(why, 160, "no memory for the poses");
        return NULL;
    }
    for (int i = 0; i < body_count; i++) {
        for (int k = 0; k < 7; k++) {
            const json_t *item = json_array_get(json_array_get(rows, (size_t)i), (size_t)k);
            double value = json_is_number(item) ? json_number_value(item) : (double)NAN;
            *(k < 3 ? &poses[i].position[k] : &poses[i].orientation[k - 3]) = value;
        }
    }
    return poses;
}

static void add_caption(const pl_column *column, const pl_cell *cell, int outside,
                        pl_text_buffer *buffer)
{
    char text[160];
    pl_text_add(buffer, "<figcaption><b>");
    pl_text_add_html(buffer, column->name);
    pl_text_add(buffer, "</b> ");
    if (cell->ok) {
        pl_measure_text(&cell->measure[PL_METRIC_REFERENCE_ERROR], text, sizeof text);
        pl_text_format(buffer, "error %s", text);
    } else {
        pl_text_add(buffer, "<span class=\"badge bad\">");
        pl_text_add_html(buffer, cell->outcome);
        pl_text_add(buffer, "</span>");
    }
    if (outside > 0)
        pl_text_format(buffer, "<br>%d %s outside the picture", outside,
                       outside == 1 ? "body is" : "bodies are");
    pl_text_add(buffer, "</figcaption></figure>\n");
}

static void add_figure(const pl_scene *scene, const pl_view *view, const pl_column *column,
                       const pl_cell *cell, const pl_pose *poses, const char *why,
                       const char *expected_id, pl_text_buffer *buffer)
{
    int outside = 0;
    pl_text_add(buffer, "<figure>");
    if (poses != NULL) {
        char title[400];
        snprintf(title, sizeof title, "%.255s: where the bodies are at the end", column->name);
        outside = pl_svg_picture(scene, view, poses, expected_id, title, buffer);
    } else {
        pl_text_format(buffer, "<div class=\"empty\" style=\"width:%.0fpx;height:%.0fpx\"><span>",
                       view->width, view->height);
        pl_text_add_html(buffer, why);
        pl_text_add(buffer, "</span></div>");
    }
    add_caption(column, cell, outside, buffer);
}

void pl_picture_row(const pl_result_matrix *cells, int index, pl_text_buffer *buffer)
{
    const pl_block *block = &cells->blocks[index];
    int count = cells->column_count;
    pl_scene scene = pl_scene_default();
    pl_error error = {PL_OK, ""};
    pl_pose **poses = calloc((size_t)count + 1, sizeof *poses);
    const pl_pose **framed = calloc((size_t)count + 1, sizeof *framed);
    char(*why)[160] = calloc((size_t)count + 1, sizeof *why);
    if (poses == NULL || framed == NULL || why == NULL) {
        buffer->failed = true;
        goto cleanup;
    }
    if (pl_picture_scene(block, &scene, &error) != PL_OK) {
        pl_text_add(buffer, "<p class=\"note\">No pictures: ");
        pl_text_add_html(buffer, error.message);
        pl_text_add(buffer, ".</p>\n");
        goto cleanup;
    }
    for (int i = 0; i < count; i++) {
        const pl_cell *cell = &block->cells[i];
        if (cell->row == NULL)
            continue;
        poses[i] = read_poses(cell->row, scene.body_count, why[i]);
        /* A run that flew apart must not shrink the others. */
        if (cell->ok || strcmp(cell->outcome, "collapsed") == 0)
            framed[i] = poses[i];
    }
    pl_view view = pl_view_choose(&scene, framed, count);
    char id[32];
    snprintf(id, sizeof id, "expected-%d", index);
    pl_svg_expected(&scene, &view, id, buffer);
    pl_text_add(buffer, "<div class=\"pictures\">\n");
    for (int i = 0; i < count; i++)
        if (block->cells[i].row != NULL)
            add_figure(&scene, &view, &cells->columns[i], &block->cells[i], poses[i], why[i], id,
                       buffer);
    pl_text_add(buffer, "</div>\n");

cleanup:
    for (int i = 0; poses != NULL && i < count; i++)
        free(poses[i]);
    free(poses);
    free(framed);
    free(why);
    pl_scene_free(&scene);
}
