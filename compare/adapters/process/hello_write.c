#include "base/json_field.h"
#include "hello.h"
#include "hello_words.h"
#include "plumb/scenario.h"

#include <string.h>

/* No text of an engine is longer in an answer. */
enum { MOST_TEXT = 4096 };

static json_t *text(const char *text_or_null)
{
    return text_or_null == NULL ? json_null()
                                : pl_json_bytes(text_or_null, strnlen(text_or_null, MOST_TEXT));
}

const char *pl_hello_precision(pl_precision precision)
{
    return precisions[precision];
}

const char *pl_hello_integrator(pl_integrator integrator)
{
    return integrators[integrator];
}

json_t *pl_hello_contacts(uint32_t reported)
{
    json_t *list = json_array();
    for (int i = 0; contacts[i] != NULL; ++i) {
        if ((reported >> i & 1u) != 0) {
            json_array_append_new(list, json_string(contacts[i]));
        }
    }
    return list;
}

static json_t *capability_words(uint32_t capabilities)
{
    json_t *list = json_array();
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((capabilities & bit) != 0 && pl_needs_name(bit) != NULL) {
            json_array_append_new(list, json_string(pl_needs_name(bit)));
        }
    }
    return list;
}

json_t *pl_hello_tune(const pl_engine_option *option, const pl_engine_profile *profiles, int count)
{
    json_t *names = json_array();
    for (int i = 0; i < count && i < 32; ++i) {
        if ((option->tune_profiles >> i & 1u) != 0) {
            json_array_append_new(names, text(profiles[i].name));
        }
    }
    if (json_array_size(names) == 0) {
        json_decref(names);
        return NULL;
    }
    return json_pack("{s:f, s:f, s:b, s:o}", "min", option->tune_min, "max", option->tune_max,
                     "logarithmic", (int)option->tune_logarithmic, "profiles", names);
}

static json_t *option_list(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *o = &engine->options[i];
        json_array_append_new(list,
                              json_pack("{s:o, s:f, s:f, s:f, s:b, s:o, s:o, s:o, s:o*}", "name",
                                        text(o->name), "value", o->value, "min", o->min, "max",
                                        o->max, "integer", (int)o->integer, "unit", text(o->unit),
                                        "help", text(o->help), "code", text(o->code), "tune",
                                        pl_hello_tune(o, engine->profiles, engine->profile_count)));
    }
    return list;
}

static json_t *profile_list(const pl_engine *engine, const double *defaults)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->profile_count; ++i) {
        const pl_engine_profile *p = &engine->profiles[i];
        json_t *values = json_object();
        for (int k = 0; k < engine->option_count; ++k) {
            const double value = defaults[i * engine->option_count + k];
            if (value != engine->options[k].value) {
                json_object_set_new(values, engine->options[k].name, json_real(value));
            }
        }
        json_array_append_new(list, json_pack("{s:o, s:o, s:b, s:o, s:o}", "name", text(p->name),
                                              "help", text(p->help), "in_default_comparison",
                                              (int)p->in_default_comparison, "step_code",
                                              text(p->step_code), "values", values));
    }
    return list;
}

static json_t *source_list(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->source_count; ++i) {
        const pl_engine_source *source = &engine->sources[i];
        json_array_append_new(list,
                              json_pack("{s:o, s:o, s:o}", "profile",
                                        text(engine->profiles[source->profile].name), "option",
                                        text(source->option), "text", text(source->text)));
    }
    return list;
}

json_t *pl_hello_write(const pl_engine *e, const double *defaults)
{
    json_t *reads = json_array();
    if (e->read_settings != NULL) {
        json_array_append_new(reads, json_string(readings[0]));
    }
    if (e->read_pair != NULL) {
        json_array_append_new(reads, json_string(readings[1]));
    }
    return json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:s, s:s, s:i, s:o, s:o, s:o, s:o}",
        "protocol", PROTOCOL, "name", text(e->name), "version", text(e->version), "description",
        text(e->description), "runtime", text(e->runtime == NULL ? "native" : e->runtime),
        "residual_unit", text(e->residual_unit), "capabilities", capability_words(e->capabilities),
        "contacts", pl_hello_contacts(e->contacts), "precision", precisions[e->precision],
        "integrator", integrators[e->integrator], "gyroscopic", gyroscopics[e->gyroscopic],
        "substeps", e->substeps, "profiles", profile_list(e, defaults), "options", option_list(e),
        "sources", source_list(e), "reads", reads);
}
