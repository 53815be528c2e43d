/* plumb list scenarios|engines|metrics|suites. Each kind is built as one JSON array, which is
 * printed as it is or as text. */
#include "commands.h"

#include "adapters/registry.h"
#include "plumb/scenario.h"
#include "report/catalogue_page.h"
#include "results/result.h"

#include <errno.h>
#include <stdio.h>

#include <stdlib.h>
#include <string.h>

static json_t *list_params(const pl_scenario *scenario)
{
    json_t *list = json_array();
    for (int i = 0; i < scenario->param_count; ++i) {
        const pl_param *p = &scenario->params[i];
        json_array_append_new(list, json_pack("{s:s, s:f, s:f, s:f, s:b, s:s, s:s}", "name",
                                              p->name, "default", p->value, "min", p->min, "max",
                                              p->max, "integer", (int)p->integer, "unit", p->unit,
                                              "help", p->help));
    }
    return list;
}

/* NULL: none. */
static json_t *threshold_of(const pl_scenario *scenario)
{
    const pl_threshold *t = scenario->threshold;
    if (t == NULL) {
        return NULL;
    }
    return json_pack("{s:s, s:f, s:f, s:s, s:f, s:s*}", "param", t->param, "low", t->low, "high",
                     t->high, "holds", t->holds_below ? "below" : "above", "tolerance",
                     t->tolerance, "formula", t->formula);
}

static json_t *list_scenarios(void)
{
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    json_t *list = json_array();
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        json_t *needs = json_array();
        for (uint32_t bit = 1; bit != 0; bit <<= 1) {
            if ((s->needs & bit) != 0) {
                json_array_append_new(needs, json_string(pl_needs_name(bit)));
            }
        }
        json_array_append_new(
            list,
            json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s*, s:s*, s:o*, s:s, s:o, s:o}", "name",
                      s->name, "title", s->title, "description", s->description, "reference",
                      s->reference, "expected", s->expected, "source", s->source, "validity",
                      s->validity, "provokes", s->provokes, "threshold", threshold_of(s),
                      "primary_error", s->primary_error, "needs", needs, "params", list_params(s)));
    }
    return list;
}

static json_t *list_profiles(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->profile_count; ++i) {
        const pl_engine_profile *p = &engine->profiles[i];
        json_array_append_new(list,
                              json_pack("{s:s, s:s, s:b}", "name", p->name, "help", p->help,
                                        "in_default_comparison", (int)p->in_default_comparison));
    }
    return list;
}

static json_t *list_options(const pl_engine *engine)
{
    json_t *list = json_array();
    for (int i = 0; i < engine->option_count; ++i) {
        const pl_engine_option *o = &engine->options[i];
        json_array_append_new(list, json_pack("{s:s, s:f, s:f, s:f, s:b, s:s, s:s}", "name",
                                              o->name, "default", o->value, "min", o->min, "max",
                                              o->max, "integer", (int)o->integer, "unit", o->unit,
                                              "help", o->help));
    }
    return list;
}

static json_t *list_engines(void)
{
    int count;
    const pl_known_engine *engines = pl_known_engines(&count);
    json_t *list = json_array();
    for (int i = 0; i < count; ++i) {
        const pl_engine *e = engines[i].engine;
        json_t *item = json_pack("{s:s, s:s, s:b}", "name", engines[i].name, "package",
                                 engines[i].package, "present", e != NULL);
        if (e != NULL) {
            json_object_set_new(item, "version", json_string(e->version));
            json_object_set_new(item, "description", json_string(e->description));
            json_object_set_new(item, "profiles", list_profiles(e));
            json_object_set_new(item, "options", list_options(e));
        }
        json_array_append_new(list, item);
    }
    return list;
}

static json_t *list_metrics(void)
{
    static const char *const directions[] = {[PL_LOWER_IS_BETTER] = "lower",
                                             [PL_HIGHER_IS_BETTER] = "higher",
                                             [PL_NO_DIRECTION] = "none"};
    json_t *list = json_array();
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *m = &pl_metric_table[i];
        json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:b, s:s}", "name", m->name, "unit",
                                              m->unit, "direction", directions[m->direction],
                                              "deterministic", (int)m->deterministic, "definition",
                                              m->definition));
    }
    return list;
}

static json_t *list_suites(void)
{
    int count;
    const pl_suite *suites = pl_suites(&count);
    json_t *list = json_array();
    for (int i = 0; i < count; ++i) {
        json_t *names = json_array();
        for (int k = 0; k < suites[i].entry_count; ++k) {
            const pl_suite_entry *entry = &suites[i].entries[k];
            bool set = entry->setting != NULL;
            json_array_append_new(names, json_sprintf("%s%s%s", entry->scenario, set ? " " : "",
                                                      set ? entry->setting : ""));
        }
        json_array_append_new(list,
                              json_pack("{s:s, s:s, s:o}", "name", suites[i].name, "description",
                                        suites[i].description, "scenarios", names));
    }
    return list;
}

static void print_settings(const json_t *settings)
{
    size_t index;
    const json_t *s;
    json_array_foreach(settings, index, s)
    {
        printf("    %-24s %s (%s; default %g, %g to %g)\n", pl_json_get_text(s, "name"),
               pl_json_get_text(s, "help"), pl_json_get_text(s, "unit"),
               json_number_value(json_object_get(s, "default")),
               json_number_value(json_object_get(s, "min")),
               json_number_value(json_object_get(s, "max")));
    }
}

static void print_scenario(const json_t *item)
{
    printf("%-18s %s\n", pl_json_get_text(item, "name"), pl_json_get_text(item, "title"));
    printf("    judged by %s\n", pl_json_get_text(item, "primary_error"));
    print_settings(json_object_get(item, "params"));
}

static void print_engine(const json_t *item)
{
    if (!json_is_true(json_object_get(item, "present"))) {
        printf("%-10s absent from this build; Debian: %s\n", pl_json_get_text(item, "name"),
               pl_json_get_text(item, "package"));
        return;
    }
    printf("%-10s %s  %s\n", pl_json_get_text(item, "name"), pl_json_get_text(item, "version"),
           pl_json_get_text(item, "description"));
    size_t index;
    const json_t *p;
    json_array_foreach(json_object_get(item, "profiles"), index, p)
    {
        printf("  %s:%-*s %s%s\n", pl_json_get_text(item, "name"),
               25 - (int)strlen(pl_json_get_text(item, "name")), pl_json_get_text(p, "name"),
               pl_json_get_text(p, "help"),
               json_is_true(json_object_get(p, "in_default_comparison"))
                   ? ""
                   : " (only when asked for)");
    }
    print_settings(json_object_get(item, "options"));
}

static void print_metric(const json_t *item)
{
    printf("%-22s %-6s %-7s %s\n", pl_json_get_text(item, "name"), pl_json_get_text(item, "unit"),
           pl_json_get_text(item, "direction"), pl_json_get_text(item, "definition"));
}

static void print_suite(const json_t *item)
{
    printf("%-12s %s\n   ", pl_json_get_text(item, "name"), pl_json_get_text(item, "description"));
    size_t index;
    const json_t *name;
    json_array_foreach(json_object_get(item, "scenarios"), index, name)
    {
        printf(" %s", json_string_value(name));
    }
    printf("\n");
}

typedef struct kind {
    const char *name;
    json_t *(*list)(void);
    void (*print)(const json_t *item);
} kind;

static const kind kinds[] = {{"scenarios", list_scenarios, print_scenario},
                             {"engines", list_engines, print_engine},
                             {"metrics", list_metrics, print_metric},
                             {"suites", list_suites, print_suite}};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

typedef struct options {
    const kind *kind;
    bool json;
    const char *page; /* NULL: none */
} options;

static const kind *find_kind(struct argp_state *state, const char *name)
{
    const char *names[KIND_COUNT];
    for (int i = 0; i < KIND_COUNT; ++i) {
        names[i] = kinds[i].name;
        if (strcmp(names[i], name) == 0) {
            return &kinds[i];
        }
    }
    const char *nearest = pl_nearest_name(name, names, KIND_COUNT);
    argp_error(state, "expected scenarios, engines, metrics or suites, found \"%s\"%s%s%s", name,
               nearest == NULL ? "" : "; did you mean ", nearest == NULL ? "" : nearest,
               nearest == NULL ? "" : "?");
    return NULL;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case 'j':
        o->json = true;
        return 0;
    case 'p':
        o->page = text;
        return 0;
    case ARGP_KEY_ARG:
        if (o->kind != NULL) {
            argp_error(state, "one list at a time; found also \"%s\"", text);
        }
        o->kind = find_kind(state, text);
        return 0;
    case ARGP_KEY_END:
        if (o->page != NULL && o->kind != NULL && o->kind->list != list_scenarios) {
            argp_error(state, "--page is of scenarios");
        }
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "list what? scenarios, engines, metrics or suites");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option argp_options[] = {
    {"json", 'j', NULL, 0, "Print a JSON array with everything there is to know", 0},
    {"page", 'p', "FILE", 0,
     "Of scenarios: write them as one HTML page with pictures, formulas and sources; - is stdout",
     0},
    {0}};
static const struct argp argp = {.options = argp_options,
                                 .parser = parse,
                                 .args_doc = "scenarios|engines|metrics|suites",
                                 .doc = "Lists what this build knows.\v"
                                        "Examples:\n"
                                        "  plumb list engines\n"
                                        "  plumb list scenarios --json\n"
                                        "  plumb list scenarios --page catalogue.html"};

static int write_page(const char *path)
{
    pl_text_buffer out = {0};
    pl_error error = {PL_OK, ""};
    bool written = false;
    if (pl_catalogue_page(&out, &error) == PL_OK) {
        bool to_stdout = strcmp(path, "-") == 0;
        FILE *file = to_stdout ? stdout : fopen(path, "we");
        written = file != NULL && fputs(out.data, file) >= 0 && fflush(file) == 0;
        written = (file == NULL || to_stdout || fclose(file) == 0) && written;
        if (!written) {
            pl_fail(&error, PL_IO, "%s: %s", path, strerror(errno));
        }
    }
    pl_text_free(&out);
    if (!written) {
        fprintf(stderr, "plumb list: %s\n", error.message);
    }
    return written ? PL_EXIT_OK : PL_EXIT_FAILED;
}

int pl_command_list(const pl_call *call)
{
    options o = {.json = false};
    pl_call_parse(call, &argp, &o);
    if (o.page != NULL) {
        return write_page(o.page);
    }
    json_t *list = o.kind->list();
    if (o.json) {
        json_dumpf(list, stdout, JSON_INDENT(1) | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
        putchar('\n');
    } else {
        size_t index;
        const json_t *item;
        json_array_foreach(list, index, item)
        {
            o.kind->print(item);
        }
    }
    json_decref(list);
    return PL_EXIT_OK;
}
