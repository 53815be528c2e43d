/* Scene files as scenarios, and the parameters of any scenario by name. */
#include "scene_family.h"

#include "plumb/scenario.h"
#include "scene/scene_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A scenario with what it borrows. */
typedef struct family {
    pl_scenario scenario; /* must be first */
    pl_param params[PL_MAX_PARAMS];
    pl_scene_file *file;
} family;

/* The parameters of the file, then the time step and the duration. */
static void list_params(family *f)
{
    static const pl_param times[] = {
        {"dt", (double)NAN, 1e-9, 1e3, false, "s", "time step"},
        {"duration", (double)NAN, 1e-9, 1e9, false, "s", "simulated time"}};
    const pl_scene_parameters *parameters = &f->file->parameters;
    int count = 0;
    for (; count < parameters->count; ++count) {
        const pl_scene_parameter *p = &parameters->items[count];
        f->params[count] = (pl_param){.name = p->name,
                                      .value = p->value,
                                      .min = p->low,
                                      .max = p->high,
                                      .unit = p->unit,
                                      .help = p->description};
    }
    for (int i = 0; i < 2; ++i) {
        f->params[count++] = times[i];
    }
    f->scenario.params = f->params;
    f->scenario.param_count = count;
}

pl_status pl_scenario_open_file(const char *path, pl_scenario **scenario, pl_error *error)
{
    family *made = calloc(1, sizeof *made);
    *scenario = NULL;
    pl_status status = made == NULL ? pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path)
                                    : pl_scene_file_open(path, &made->file, error);
    if (status != PL_OK) {
        free(made);
        return status;
    }
    made->scenario = (pl_scenario){.name = made->file->path,
                                   .title = "",
                                   .description = "",
                                   .reference = "",
                                   .expected = "",
                                   .source = "",
                                   .primary_error = "",
                                   .acceptance = (double)INFINITY,
                                   .acceptance_reason = "",
                                   .file = made->file};
    list_params(made);
    *scenario = &made->scenario;
    return PL_OK;
}

void pl_scenario_close_file(pl_scenario *scenario)
{
    family *f = (family *)scenario;
    if (f != NULL) {
        pl_scene_file_close(f->file);
        free(f);
    }
}

int pl_scenario_param(const pl_scenario *scenario, const char *name)
{
    for (int i = 0; i < scenario->param_count; ++i) {
        if (strcmp(scenario->params[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

static pl_status set_times(pl_scene *scene, const char *path, double dt, double duration,
                           pl_error *error)
{
    const bool has_step = !isnan(dt) && dt != scene->dt;
    const bool has_duration = !isnan(duration) && duration != scene->duration;
    if (has_duration &&
        (scene->travel_count > 0 || scene->value_count > 0 || scene->statistic_count > 0)) {
        return pl_fail(
            error, PL_BAD_INPUT,
            "%s: --duration cannot replace the duration of a scene that expects a travel, a "
            "value or a statistic: they hold for %g s",
            path, scene->duration);
    }
    if (!has_step && !has_duration) {
        return PL_OK;
    }
    scene->dt = has_step ? dt : scene->dt;
    scene->duration = has_duration ? duration : scene->duration;
    for (int i = 0; i < scene->travel_count && has_step; ++i) {
        scene->travels[i].discrete = (double)NAN;
    }
    for (int i = 0; i < scene->value_count && has_step; ++i) {
        scene->values[i].discrete = (double)NAN;
    }
    return pl_scene_validate(scene, error);
}

pl_status pl_scene_family_build(const pl_scenario *scenario, const double *values, pl_scene *scene,
                                pl_error *error)
{
    const int count = scenario->file->parameters.count;
    pl_status status = pl_scene_file_read(scenario->file, values, scene, error);
    if (status == PL_OK) {
        status = set_times(scene, scenario->name, values[count], values[count + 1], error);
        if (status != PL_OK) {
            pl_scene_free(scene);
        }
    }
    return status;
}
