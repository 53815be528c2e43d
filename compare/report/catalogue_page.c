/* The catalogue as a page: each scenario with its scene, right answer, source and parameters. */
#include "page.h"
#include "page_data.h"
#include "report.h"

static pl_status add_scene(json_t *scenes, const char *name, pl_error *error)
{
    double values[PL_MAX_PARAMS];
    pl_scene scene = pl_scene_default();
    const pl_scenario *scenario = pl_scenario_find(name, NULL);
    pl_status status = pl_scenario_values(scenario, NULL, 0, values, error);
    if (status == PL_OK) {
        status = pl_scenario_build(scenario, values, 0, &scene, error);
    }
    if (status == PL_OK) {
        json_array_append_new(scenes, pl_case_scene_json(&scene));
    }
    pl_scene_free(&scene);
    return status;
}

pl_status pl_catalogue_page(json_t *scenarios, json_t *suites, pl_text_buffer *out, pl_error *error)
{
    json_t *scenes = json_array();
    pl_status status = PL_OK;
    for (size_t i = 0; i < json_array_size(scenarios) && status == PL_OK; ++i) {
        status = add_scene(scenes, pl_json_get_text(json_array_get(scenarios, i), "name"), error);
    }
    json_t *study = json_pack("{s:O, s:O, s:o, s:o}", "scenarios", scenarios, "suites", suites,
                              "scenes", scenes, "metrics", pl_page_data_metrics());
    pl_page_of_study(out, "catalogue", study);
    json_decref(study);
    return status;
}
