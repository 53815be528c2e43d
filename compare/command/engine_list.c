/* Each configuration of an engine with all its settings: as shipped, as its authors recommend, and
 * as plumb tune found. */
#include "command.h"

#include "adapters/process/hello.h"
#include "base/json_field.h"
#include "base/program_name.h"
#include "engines/registry.h"
#include "report/page_data.h"

#include <string.h>

/* ---- JSON ---- */

/* The values of a profile that differ from those of the first one, by name. */
static json_t *changed_values(const pl_engine_info *engine, int profile)
{
    const double *shipped = pl_engine_profile_values(engine, 0);
    const double *values = pl_engine_profile_values(engine, profile);
    json_t *changed = json_object();
    for (int i = 0; i < engine->option_count; ++i) {
        if (values[i] != shipped[i]) {
            json_object_set_new(changed, engine->options[i].name, json_real(values[i]));
        }
    }
    return changed;
}

static json_t *sources_of(const pl_engine_info *engine, int profile)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->source_count; ++i) {
        const pl_engine_source *source = &engine->sources[i];
        if (source->profile == profile) {
            json_array_append_new(
                list, json_pack("{s:s?, s:s}", "option", source->option, "text", source->text));
        }
    }
    return list;
}

static json_t *list_profiles(const pl_engine_info *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->profile_count; ++i) {
        const pl_engine_profile *p = &engine->profiles[i];
        json_array_append_new(
            list, json_pack("{s:s, s:s, s:b, s:o, s:o}", "name", p->name, "help", p->help,
                            "in_default_comparison", (int)p->in_default_comparison, "changed",
                            changed_values(engine, i), "sources", sources_of(engine, i)));
    }
    return list;
}

static json_t *list_options(const pl_engine_info *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *o = &engine->options[i];
        json_array_append_new(list,
                              json_pack("{s:s, s:f, s:f, s:f, s:b, s:s, s:s, s:s*, s:o*}", "name",
                                        o->name, "default", pl_engine_profile_values(engine, 0)[i],
                                        "min", o->min, "max", o->max, "integer", (int)o->integer,
                                        "unit", o->unit, "help", o->help, "code", o->code, "tune",
                                        pl_hello_tune(o, engine->profiles, engine->profile_count)));
    }
    return list;
}

/* Adds what is known of an engine to its item. Of one that could not be asked, the fault. */
static void describe_engine(const pl_call *call, json_t *item, const pl_engine_info *e)
{
    json_t *tuned = NULL;
    if (e->fault.is_fault) {
        json_object_set_new(item, "fault", pl_json_text(e->fault.reason));
        return;
    }
    pl_call_need(call, pl_tuned_profiles(e, &tuned, call->error));
    json_t *words = e->built_in == NULL ? NULL : pl_engine_words();
    json_t *known = json_pack("{s:s, s:s, s:s, s:s, s:s, s:o, s:s, s:i, s:o, s:o, s:o, s:O*}",
                              "version", e->version, "description", e->description, "runtime",
                              pl_engine_runtime(e), "precision", pl_hello_precision(e->precision),
                              "integrator", pl_hello_integrator(e->integrator), "contacts",
                              pl_hello_contacts(e->contacts), "binary", e->binary, "substeps",
                              e->substeps, "profiles", list_profiles(e), "tuned", tuned, "options",
                              list_options(e), "words", json_object_get(words, e->name));
    json_object_update(item, known);
    json_decref(words);
    json_decref(known);
}

static void add_built_in(const pl_call *call, const pl_built_in *built_in, json_t *list)
{
    const bool is_present = pl_built_in_is_present(built_in);
    const pl_engine_info *engine = NULL;
    json_t *item = json_pack("{s:s, s:s, s:b}", "name", built_in->name, "package",
                             built_in->package, "present", is_present);
    json_array_append_new(list, item);
    if (is_present) {
        pl_call_need(call, pl_engine_of_build(built_in, &engine, call->error));
        describe_engine(call, item, engine);
    } else {
        char how[PL_HOW_TO_GET];
        pl_built_in_how_to_get(built_in, how, sizeof how);
        json_object_set_new(item, "get", json_string(how));
    }
}

json_t *pl_engine_list(const pl_call *call, const pl_texts *names)
{
    int count;
    const pl_built_in *engines = pl_built_in_engines(&count);
    json_t *list = json_array();
    for (int i = 0; names->count == 1 && i < count; ++i) {
        add_built_in(call, &engines[i], list);
    }
    for (int i = 1; i < names->count; ++i) {
        pl_engine_choice choice;
        pl_call_need(call, pl_engine_choose(names->items[i], &choice, call->error));
        json_t *item = json_pack("{s:s, s:b}", "name", choice.engine->name, "present", true);
        json_array_append_new(list, item);
        describe_engine(call, item, choice.engine);
    }
    return list;
}

/* ---- Text ---- */

/* Prints texts of an array, with commas between them. */
static void print_texts(const json_t *texts, FILE *out)
{
    size_t index;
    const json_t *item;
    json_array_foreach(texts, index, item)
    {
        fprintf(out, "%s%s", index == 0 ? "" : ", ", json_string_value(item));
    }
}

/* Precision, sub-steps, integrator and what contacts report, on a line. */
static void print_nature(const json_t *item, FILE *out)
{
    const int substeps = (int)pl_json_get_number(item, "substeps");
    const char *runtime = pl_json_get_text(item, "runtime");
    const json_t *contacts = json_object_get(item, "contacts");
    if (strcmp(runtime, "native") != 0) {
        fprintf(out, "  runs in %s: its times are not ranked with those of native engines\n",
                runtime);
    }
    fprintf(out, "  %s precision, %d %s a step, integrator %s, contacts %s",
            pl_json_get_text(item, "precision"), substeps, substeps == 1 ? "sub-step" : "sub-steps",
            pl_json_get_text(item, "integrator"),
            json_array_size(contacts) == 0 ? "not reported" : "with ");
    print_texts(contacts, out);
    fputc('\n', out);
}

/* The text of the source of an option; NULL: none. */
static const char *source_text(const json_t *sources, const char *option)
{
    size_t index;
    const json_t *source;
    json_array_foreach(sources, index, source)
    {
        if (strcmp(pl_json_get_text(source, "option"), option) == 0) {
            return pl_json_get_text(source, "text");
        }
    }
    return NULL;
}

/* A setting on a line, and why. */
static void print_value(const char *name, double value, const char *why, FILE *out)
{
    char setting[PL_NAME_SIZE + 40];
    snprintf(setting, sizeof setting, "%s=%.6g", name, value);
    if (why == NULL) {
        fprintf(out, "      %s\n", setting);
    } else {
        fprintf(out, "      %-20s  %s\n", setting, why);
    }
}

static void print_profile(const json_t *engine, json_t *p, FILE *out)
{
    size_t index;
    const json_t *source;
    const char *key;
    json_t *value;
    const json_t *sources = json_object_get(p, "sources");
    const char *name = pl_json_get_text(engine, "name");
    fprintf(out, "  %s:%-*s  %s%s\n", name, 19 - (int)strlen(name), pl_json_get_text(p, "name"),
            pl_json_get_text(p, "help"),
            json_is_true(json_object_get(p, "in_default_comparison")) ? ""
                                                                      : " (only when asked for)");
    json_object_foreach(json_object_get(p, "changed"), key, value)
    {
        print_value(key, json_number_value(value), source_text(sources, key), out);
    }
    json_array_foreach(sources, index, source)
    {
        if (json_is_null(json_object_get(source, "option"))) {
            fprintf(out, "      %s\n", pl_json_get_text(source, "text"));
        }
    }
}

/* A tuned profile: what it is for, where it is from, and how its options differ from those of the
 * profile that it changes. */
static void print_tuned(const json_t *engine, const json_t *tuned, FILE *out)
{
    size_t index;
    const json_t *option;
    const char *name = pl_json_get_text(engine, "name"), *base = pl_json_get_text(tuned, "profile");
    const char *from = pl_json_get_text(tuned, "from");
    const double dt = pl_json_get_number(tuned, "dt");
    fprintf(out, "  %s:%-*s  ", name, 19 - (int)strlen(name), pl_json_get_text(tuned, "name"));
    print_texts(json_object_get(tuned, "targets"), out);
    fprintf(out, " on ");
    print_texts(json_object_get(tuned, "scenarios"), out);
    fprintf(out, "\n      %s; from %s, made %s\n",
            json_is_true(json_object_get(tuned, "validated")) ? "validated" : "not validated",
            strcmp(from, PL_PROGRAM) == 0 ? "Plumb" : from, pl_json_get_text(tuned, "made"));
    if (dt > 0) {
        fprintf(out, "      for --dt 1/%.6g\n", 1 / dt);
    }
    const json_t *profile = NULL;
    json_array_foreach(json_object_get(engine, "profiles"), index, option)
    {
        profile = strcmp(pl_json_get_text(option, "name"), base) == 0 ? option : profile;
    }
    fprintf(out, "      changes %s:%s:\n", name, base);
    json_array_foreach(json_object_get(engine, "options"), index, option)
    {
        const char *key = pl_json_get_text(option, "name");
        const json_t *value = json_object_get(json_object_get(tuned, "options"), key);
        const json_t *other = json_object_get(json_object_get(profile, "changed"), key);
        const double before =
            other != NULL ? json_number_value(other) : pl_json_get_number(option, "default");
        if (value != NULL && json_number_value(value) != before) {
            print_value(key, json_number_value(value), NULL, out);
        }
    }
}

void pl_list_print_number(const json_t *item, const char *more, FILE *out)
{
    char text[1024];
    snprintf(text, sizeof text, "%s (%s; default %g, %g to %g%s)", pl_json_get_text(item, "help"),
             pl_json_get_text(item, "unit"), pl_json_get_number(item, "default"),
             pl_json_get_number(item, "min"), pl_json_get_number(item, "max"), more);
    fprintf(out, "    %-20s  %s\n", pl_json_get_text(item, "name"), text);
}

static void print_option(const json_t *o, FILE *out)
{
    char range[128] = "";
    const json_t *tune = json_object_get(o, "tune");
    if (tune != NULL) {
        snprintf(range, sizeof range, "; tuned from %g to %g", pl_json_get_number(tune, "min"),
                 pl_json_get_number(tune, "max"));
    }
    pl_list_print_number(o, range, out);
}

void pl_engine_list_print(const json_t *item, FILE *out)
{
    const char *name = pl_json_get_text(item, "name");
    size_t index;
    json_t *part;
    if (!json_is_true(json_object_get(item, "present"))) {
        fprintf(out, "%-10s absent: %s gets it\n", name, pl_json_get_text(item, "get"));
        return;
    }
    if (json_object_get(item, "fault") != NULL) {
        fprintf(out, "%-10s %s\n", name, pl_json_get_text(item, "fault"));
        return;
    }
    fprintf(out, "%-10s %s  %s\n", name, pl_json_get_text(item, "version"),
            pl_json_get_text(item, "description"));
    print_nature(item, out);
    json_array_foreach(json_object_get(item, "profiles"), index, part)
    {
        print_profile(item, part, out);
    }
    json_array_foreach(json_object_get(item, "tuned"), index, part)
    {
        print_tuned(item, part, out);
    }
    json_array_foreach(json_object_get(item, "options"), index, part)
    {
        print_option(part, out);
    }
}
