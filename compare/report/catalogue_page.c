/* The catalogue as a page: each scenario with its scene, right answer, source and parameters. */
#include "case_scene.h"
#include "page.h"
#include "page_data.h"
#include "report.h"

#include <math.h>
#include <string.h>

static json_t *suites_of(const char *name)
{
    int count;
    const pl_suite *suites = pl_suites(&count);
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        bool within = false;
        for (int k = 0; k < suites[i].entry_count; ++k) {
            within = within || strcmp(suites[i].entries[k].scenario, name) == 0;
        }
        if (within) {
            json_array_append_new(array, json_string(suites[i].name));
        }
    }
    return array;
}

static json_t *needs_json(uint32_t needs)
{
    json_t *array = json_array();
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((needs & bit) != 0) {
            json_array_append_new(array, json_string(pl_needs_name(bit)));
        }
    }
    return array;
}

static json_t *params_json(const pl_scenario *scenario)
{
    json_t *array = json_array();
    for (int i = 0; i < scenario->param_count; ++i) {
        const pl_param *p = &scenario->params[i];
        json_array_append_new(array,
                              json_pack("{s:s, s:f, s:f, s:f, s:b, s:s, s:s}", "name", p->name,
                                        "value", p->value, "min", p->min, "max", p->max, "integer",
                                        (int)p->integer, "unit", p->unit, "help", p->help));
    }
    return array;
}

static pl_status add_scenario(json_t *array, const pl_scenario *s, pl_error *error)
{
    double values[PL_MAX_PARAMS];
    pl_scene scene = pl_scene_default();
    const int id = pl_metric_by_name(s->primary_error);
    json_t *object = json_object();
    pl_status status = pl_scenario_values(s, NULL, 0, values, error);
    if (status == PL_OK) {
        status = pl_scenario_build(s, values, 0, &scene, error);
    }
    pl_page_data_scenario(s, object);
    json_object_set_new(object, "name", json_string(s->name));
    json_object_set_new(object, "params", params_json(s));
    json_object_set_new(object, "suites", suites_of(s->name));
    json_object_set_new(object, "needs", needs_json(pl_scenario_needs(s)));
    if (id >= 0) {
        json_object_set_new(object, "judged_by",
                            json_pack("{s:s, s:s, s:s, s:f, s:s}", "metric",
                                      pl_metric_table[id].name, "unit", pl_metric_table[id].unit,
                                      "definition", pl_metric_table[id].definition, "bound",
                                      s->acceptance, "reason", s->acceptance_reason));
    }
    if (s->threshold != NULL) {
        const char *formula =
            s->threshold->formula != NULL ? s->threshold->formula : "no closed form";
        json_object_set_new(object, "threshold",
                            json_pack("{s:s, s:b, s:s}", "param", s->threshold->param,
                                      "holds_below", (int)s->threshold->holds_below, "formula",
                                      formula));
    }
    if (status == PL_OK) {
        json_object_set_new(object, "scene", pl_case_scene_json(&scene));
    }
    json_array_append_new(array, object);
    pl_scene_free(&scene);
    return status;
}

pl_status pl_catalogue_page(pl_text_buffer *out, pl_error *error)
{
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    json_t *array = json_array();
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = add_scenario(array, scenarios[i], error);
    }
    json_t *study = json_pack("{s:o}", "scenarios", array);
    pl_page_of_study(out, "catalogue", study);
    json_decref(study);
    return status;
}
