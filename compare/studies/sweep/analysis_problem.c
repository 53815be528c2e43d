#include "analysis_problem.h"

#include "results/result.h"

#include <stdio.h>
#include <string.h>

static void append(char *text, size_t size, const char *part)
{
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s", part);
}

static void name_scene(pl_sweep_scene *scene)
{
    char part[160];
    const json_t *params = json_object_get(scene->row, "params");
    snprintf(scene->name, sizeof scene->name, "%.120s", scene->scenario);
    for (int i = 0; scene->catalogue != NULL && i < scene->catalogue->param_count; ++i) {
        const pl_param *param = &scene->catalogue->params[i];
        const json_t *value = json_object_get(params, param->name);
        bool bare = strcmp(param->unit, "1") == 0 || param->unit[0] == '\0';
        if (strcmp(param->name, "dt") == 0 || !json_is_number(value) ||
            json_number_value(value) == param->value) {
            continue;
        }
        snprintf(part, sizeof part, " %s=%.6g%s%s", param->name, json_number_value(value),
                 bare ? "" : " ", bare ? "" : param->unit);
        append(scene->name, sizeof scene->name, part);
    }
    const json_t *seed = json_object_get(scene->row, "seed");
    const json_t *member = json_object_get(scene->row, "member");
    if (json_integer_value(seed) != 0) {
        snprintf(part, sizeof part, " seed=%" JSON_INTEGER_FORMAT, json_integer_value(seed));
        append(scene->name, sizeof scene->name, part);
    }
    if (json_is_integer(member)) {
        snprintf(part, sizeof part, " member=%" JSON_INTEGER_FORMAT, json_integer_value(member));
        append(scene->name, sizeof scene->name, part);
    }
}

pl_sweep_scene make_scene_of(const json_t *row, int first)
{
    pl_sweep_scene scene = {.row = row,
                            .scenario = pl_json_get_text(row, "scenario"),
                            .primary_error = pl_json_get_text(row, "primary_error"),
                            .unit = "",
                            .first = first};
    scene.catalogue = pl_scenario_find(scene.scenario, NULL);
    name_scene(&scene);
    return scene;
}

void pl_sweep_take_unit(pl_sweep_scene *scene, const json_t *row)
{
    const json_t *metric = json_object_get(json_object_get(row, "metrics"), scene->primary_error);
    if (scene->unit[0] == '\0') {
        scene->unit = pl_json_get_text(metric, "unit");
    }
}
