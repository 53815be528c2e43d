/* plumb list scenarios|engines|metrics|suites. Each kind is built as one JSON array, which is
 * printed as it is or as text. */
#include "base/folding.h"
#include "base/json_field.h"
#include "plumb/scenario.h"
#include "report/report.h"
#include "request.h"
#include "results/result.h"
#include "results/store.h"

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
    return t == NULL
               ? NULL
               : json_pack("{s:s, s:f, s:f, s:s, s:f, s:s*}", "param", t->param, "low", t->low,
                           "high", t->high, "holds", t->holds_below ? "below" : "above",
                           "tolerance", t->tolerance, "formula", t->formula);
}

/* The bits of the scenario's needs, as words. */
static json_t *needs_of(const pl_scenario *scenario)
{
    const uint32_t needed = pl_scenario_needs(scenario);
    json_t *needs = json_array();
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((needed & bit) != 0) {
            json_array_append_new(needs, json_string(pl_needs_name(bit)));
        }
    }
    return needs;
}

static json_t *acceptance_of(const pl_scenario *scenario)
{
    return json_pack("{s:f, s:s, s:s}", "bound", scenario->acceptance, "unit",
                     pl_metric_table[pl_metric_by_name(scenario->primary_error)].unit, "reason",
                     scenario->acceptance_reason);
}

static json_t *list_scenarios(void)
{
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    json_t *list = json_array();
    for (int i = 0; i < count; ++i) {
        const pl_scenario *s = scenarios[i];
        json_array_append_new(
            list,
            json_pack(
                "{s:s, s:s, s:s, s:s, s:s, s:s, s:s*, s:s*, s:s*, s:s*, s:o*, s:s, s:o, s:o, s:o}",
                "name", s->name, "title", s->title, "description", s->description, "reference",
                s->reference, "expected", s->expected, "source", s->source, "validity", s->validity,
                "provokes", s->provokes, "symptom", s->symptom, "threads", s->threads, "threshold",
                threshold_of(s), "primary_error", s->primary_error, "acceptance", acceptance_of(s),
                "needs", needs_of(s), "params", list_params(s)));
    }
    return list;
}

/* The properties of a metric, as words. */
static json_t *properties_of(int id)
{
    static const struct {
        pl_trait trait;
        const char *word;
    } words[] = {{PL_TRAIT_MEASURED, "measured"}, {PL_TRAIT_COMPARED, "compared"},
                 {PL_TRAIT_OVER_STEPS, "steps"},  {PL_TRAIT_VALUE_OF_END, "end"},
                 {PL_TRAIT_IMPULSES, "impulses"}, {PL_TRAIT_STATIC_IMPULSES, "static impulses"}};
    const pl_metric_info *info = &pl_metric_table[id];
    json_t *list = json_array();
    int primary_count;
    const char *const *primary = pl_primary_errors(&primary_count);
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i) {
        if (pl_metric_is(id, words[i].trait)) {
            json_array_append_new(list, json_string(words[i].word));
        }
    }
    for (int i = 0; i < primary_count; ++i) {
        if (strcmp(primary[i], info->name) == 0) {
            json_array_append_new(list, json_string("primary"));
        }
    }
    if (info->more[0] != NULL) {
        json_array_append_new(list, json_string("ensemble"));
    }
    if (info->ratio != NULL) {
        json_array_append_new(list, json_string(info->ratio));
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
        json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:b, s:s, s:o}", "name", m->name,
                                              "unit", m->unit, "direction",
                                              directions[m->direction], "deterministic",
                                              !pl_metric_is(i, PL_TRAIT_MEASURED), "definition",
                                              m->definition, "properties", properties_of(i)));
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

static void print_scenario(const json_t *item, FILE *out)
{
    size_t index;
    const json_t *param, *acceptance = json_object_get(item, "acceptance");
    const char *unit = pl_json_get_text(acceptance, "unit");
    const bool has_unit = strcmp(unit, "1") != 0;
    fprintf(out, "%-18s  %s\n    judged by %s\n    accurate up to %g%s%s (%s)\n",
            pl_json_get_text(item, "name"), pl_json_get_text(item, "title"),
            pl_json_get_text(item, "primary_error"), pl_json_get_number(acceptance, "bound"),
            has_unit ? " " : "", has_unit ? unit : "", pl_json_get_text(acceptance, "reason"));
    json_array_foreach(json_object_get(item, "params"), index, param)
    {
        pl_list_print_number(param, "", out);
    }
}

static void print_metric(const json_t *item, FILE *out)
{
    fprintf(out, "%-22s  %-6s %-6s  %s\n", pl_json_get_text(item, "name"),
            pl_json_get_text(item, "unit"), pl_json_get_text(item, "direction"),
            pl_json_get_text(item, "definition"));
}

static void print_suite(const json_t *item, FILE *out)
{
    size_t index;
    const json_t *name;
    fprintf(out, "%-12s  %s\n   ", pl_json_get_text(item, "name"),
            pl_json_get_text(item, "description"));
    json_array_foreach(json_object_get(item, "scenarios"), index, name)
    {
        fprintf(out, " %s", json_string_value(name));
    }
    fprintf(out, "\n");
}

typedef struct kind {
    const char *name;
    json_t *(*list)(void); /* NULL: engines */
    void (*print)(const json_t *item, FILE *out);
} kind;

static const kind kinds[] = {{"scenarios", list_scenarios, print_scenario},
                             {"engines", NULL, pl_engine_list_print},
                             {"metrics", list_metrics, print_metric},
                             {"suites", list_suites, print_suite}};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

typedef struct options {
    pl_request request; /* names: the kind */
    const kind *kind;
    bool json;
    const char *page; /* NULL: none */
} options;

static pl_status check(void *user, pl_error *error)
{
    options *o = user;
    const pl_texts *asked = &o->request.names;
    if (asked->count == 0) {
        return pl_fail(error, PL_BAD_INPUT, "list what? scenarios, engines, metrics or suites");
    }
    const char *names[KIND_COUNT];
    for (int i = 0; i < KIND_COUNT; ++i) {
        names[i] = kinds[i].name;
        o->kind = strcmp(names[i], asked->items[0]) == 0 ? &kinds[i] : o->kind;
    }
    if (o->kind == NULL) {
        char hint[PL_SUGGESTION_SIZE];
        return pl_fail(error, PL_BAD_INPUT,
                       "expected scenarios, engines, metrics or suites, found \"%s\"%s",
                       asked->items[0], pl_did_you_mean(asked->items[0], names, KIND_COUNT, hint));
    }
    if (asked->count > 1 && o->kind->list != NULL) {
        return pl_fail(error, PL_BAD_INPUT, "one list at a time; found also \"%s\"",
                       asked->items[1]);
    }
    return o->page != NULL && o->kind->list != list_scenarios
               ? pl_fail(error, PL_BAD_INPUT, "--page is for scenarios")
               : PL_OK;
}

static void write_page(const pl_call *call, const options *o)
{
    pl_text_buffer out = {0};
    json_t *scenarios = list_scenarios(), *suites = list_suites();
    pl_call_need(call, pl_request_outputs(&o->request, o->page, call->error));
    pl_call_need(call, pl_catalogue_page(scenarios, suites, &out, call->error));
    pl_call_need(call, pl_write_buffer(o->page, &out, call->error));
    json_decref(scenarios);
    json_decref(suites);
}

/* Returns whether an engine of the list could not be asked. */
static bool print_list(const json_t *list, const options *o)
{
    bool has_fault = false;
    size_t index;
    const json_t *item;
    pl_folding folding;
    if (o->json) {
        pl_call_print_json(list);
    }
    FILE *out = pl_folding_begin(&folding, stdout);
    json_array_foreach(list, index, item)
    {
        has_fault |= json_object_get(item, "fault") != NULL;
        if (!o->json) {
            o->kind->print(item, out);
        }
    }
    pl_folding_end(&folding);
    return has_fault;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    bool has_fault = false;
    pl_call_parse(call, &o);
    if (o.page != NULL) {
        write_page(call, &o);
    } else {
        json_t *list =
            o.kind->list == NULL ? pl_engine_list(call, &o.request.names) : o.kind->list();
        has_fault = print_list(list, &o);
        json_decref(list);
    }
    pl_request_free(&o.request);
    return has_fault ? PL_EXIT_FAILED : PL_EXIT_OK;
}

static const pl_option OPTIONS[] = {
    {"json", NULL, "Print a JSON array with all that is known", PL_OPTION_FLAG,
     .field = offsetof(options, json), .letter = 'j'},
    {"page", "FILE",
     "For scenarios: write an HTML page with pictures, formulas and sources (- is standard "
     "output)",
     PL_OPTION_TEXT, .field = offsetof(options, page), .letter = 'p'},
    {0}};

const pl_command pl_command_list = {
    .name = "list",
    .summary = "list scenarios, engines, metrics or suites",
    .arguments = "scenarios|engines [SPEC...]|metrics|suites",
    .description =
        "Lists the scenarios, engines, metrics or suites of this build, or the engines of the "
        "given SPECs, such as the path of a shared object. Exits with 3 when an engine could not "
        "be asked.",
    .notes = "Examples:\n"
             "  plumb list engines\n"
             "  plumb list engines ./mine.so\n"
             "  plumb list scenarios --json\n"
             "  plumb list scenarios --page catalogue.html",
    .options = OPTIONS,
    .shared = {pl_force_options},
    .check = check,
    .run = run};
