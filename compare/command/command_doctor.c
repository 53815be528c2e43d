/* plumb doctor: which engines and tools are here and how to get the others, and how well times
 * repeat. All is found as one JSON object, which is printed as it is or as text. */
#include "adapters/built_in.h"
#include "base/folding.h"
#include "base/json_field.h"
#include "base/program_name.h"
#include "base/table.h"
#include "engines/registry.h"
#include "request.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_request request;
    bool json;
} options;

/* What is known of the conformance of the profiles that an engine proposes: the worst of them. */
static void describe_conformance(const pl_engine_info *engine, char *text, size_t size)
{
    int known = 0, proposed = 0, failed = 0, checks = 0;
    for (int i = 0; i < engine->profile_count; ++i) {
        if (!engine->profiles[i].in_default_comparison) {
            continue;
        }
        json_t *found = pl_conformance_find(engine, engine->profiles[i].name);
        ++proposed;
        known += json_is_object(found);
        failed += (int)json_integer_value(json_object_get(found, "failed"));
        checks += (int)json_integer_value(json_object_get(found, "checks"));
        json_decref(found);
    }
    if (known == 0) {
        snprintf(text, size, "not verified: plumb check-engine %s", engine->name);
    } else if (failed > 0) {
        snprintf(text, size, "%d of %d checks failed: plumb check-engine %s", failed, checks,
                 engine->name);
    } else {
        snprintf(text, size, "passed (%d of %d profiles)", known, proposed);
    }
}

/* Adds what is known of an engine to the array. */
static void add_engine(const pl_call *call, const pl_built_in *built_in, json_t *list, bool *faulty)
{
    char text[PL_NAME_SIZE + 64];
    const pl_engine_info *engine = NULL;
    if (!pl_built_in_is_present(built_in)) {
        char how[PL_HOW_TO_GET];
        pl_built_in_how_to_get(built_in, how, sizeof how);
        json_array_append_new(
            list, json_pack("{s:s, s:b, s:s}", "name", built_in->name, "present", 0, "get", how));
        return;
    }
    pl_call_need(call, pl_engine_of_build(built_in, &engine, call->error));
    json_t *item = json_pack("{s:s, s:b, s:s}", "name", built_in->name, "present", 1, "runtime",
                             pl_engine_runtime(engine));
    json_array_append_new(list, item);
    if (engine->fault.is_fault) {
        *faulty = true;
        json_object_set_new(item, "fault", pl_json_text(engine->fault.reason));
    } else {
        describe_conformance(engine, text, sizeof text);
        json_object_set_new(item, "version", json_string(engine->version));
        json_object_set_new(item, "conformance", json_string(text));
    }
}

/* Programs that some commands call. */
static json_t *list_tools(void)
{
    static const struct {
        const char *name, *variable, *use, *get;
    } tools[] = {{"chromium", "CHROMIUM", "plumb report --figure",
                  "Debian package chromium, or set CHROMIUM"},
                 {"xdg-open", "BROWSER", "plumb view", "Debian package xdg-utils, or set BROWSER"},
                 {"node", NULL, "engines from npm", "Debian package nodejs"},
                 {"npm", NULL, "gets these, and the page's replay", "Debian package npm"},
                 {"parallel", NULL, "shards of plumb sweep", "Debian package parallel"}};
    json_t *list = json_array();
    for (size_t i = 0; i < sizeof tools / sizeof tools[0]; ++i) {
        const char *set = tools[i].variable == NULL ? NULL : getenv(tools[i].variable);
        const char *program = set != NULL && set[0] != '\0' ? set : tools[i].name;
        json_array_append_new(list, json_pack("{s:s, s:o, s:b, s:s, s:s}", "name", tools[i].name,
                                              "program", pl_json_text(program), "present",
                                              (int)pl_has_program(program), "use", tools[i].use,
                                              "get", tools[i].get));
    }
    return list;
}

static void add_engine_row(pl_table *table, const json_t *engine)
{
    const bool is_present = json_is_true(json_object_get(engine, "present"));
    const bool has_fault = json_object_get(engine, "fault") != NULL;
    pl_table_add(table, pl_json_get_text(engine, "name"));
    pl_table_add(table, !is_present ? "absent"
                        : has_fault ? "fault"
                                    : pl_json_get_text(engine, "version"));
    pl_table_add(table, pl_json_get_text(engine, "runtime"));
    pl_table_add(table, pl_json_get_text(engine, !is_present ? "get"
                                                 : has_fault ? "fault"
                                                             : "conformance"));
}

static void add_tool_row(pl_table *table, const json_t *tool)
{
    const bool is_present = json_is_true(json_object_get(tool, "present"));
    pl_table_add(table, pl_json_get_text(tool, "name"));
    pl_table_add(table, pl_json_get_text(tool, "use"));
    pl_table_format_cell(table, "%s%s", is_present ? "" : "absent: ",
                         pl_json_get_text(tool, is_present ? "program" : "get"));
}

static void print_list(const json_t *list, const char *columns,
                       void (*add_row)(pl_table *table, const json_t *item))
{
    pl_table table = {0};
    size_t index;
    const json_t *item;
    pl_table_columns(&table, columns);
    json_array_foreach(list, index, item)
    {
        add_row(&table, item);
    }
    pl_table_print(&table, stdout);
    pl_table_free(&table);
}

static void print_findings(const json_t *found)
{
    const json_t *plumb = json_object_get(found, PL_PROGRAM);
    pl_print_line(stdout, "Plumb %s (%s)", pl_json_get_text(plumb, "version"),
                  pl_json_get_text(plumb, "git"));
    putchar('\n');
    print_list(json_object_get(found, "engines"),
               "engine|version|runs as|conformance, or how to get it", add_engine_row);
    putchar('\n');
    pl_machine_print(json_object_get(found, "host"), json_object_get(found, "machine"), stdout);
    putchar('\n');
    print_list(json_object_get(found, "tools"), "tool|needed for|found, or how to get it",
               add_tool_row);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    int count;
    bool faulty = false;
    const pl_built_in *known = pl_built_in_engines(&count);
    pl_call_parse(call, &o);
    pl_request_free(&o.request);
    json_t *engines = json_array(), *found = pl_call_provenance(call);
    for (int i = 0; i < count; ++i) {
        add_engine(call, &known[i], engines, &faulty);
    }
    json_object_set_new(found, "engines", engines);
    json_object_set_new(found, "machine", pl_machine());
    json_object_set_new(found, "tools", list_tools());
    if (o.json) {
        pl_call_print_json(found);
    } else {
        print_findings(found);
    }
    json_decref(found);
    return faulty ? PL_EXIT_FAILED : PL_EXIT_OK;
}

static const pl_option OPTIONS[] = {{"json", NULL, "Print a JSON object with all that was found",
                                     PL_OPTION_FLAG, .field = offsetof(options, json),
                                     .letter = 'j'},
                                    {0}};

const pl_command pl_command_doctor = {
    .name = "doctor",
    .summary = "say what is here: engines, tools, and how well times repeat",
    .arguments = "",
    .description =
        "Lists every engine that Plumb has an adapter for: its version, what runs its code, "
        "whether plumb check-engine has verified this binary of it, and how to get one that is "
        "absent. Then what times depend on: the processor and which of its instructions Plumb's "
        "engine uses, the CPUs that this process may use, their frequency, the resolution and the "
        "noise of the clock that times steps, which is measured for 0.2 s, the load and the "
        "memory. Then the programs that some commands need. Exits with 3 when an engine that is "
        "here could not be asked.",
    .notes = "Examples:\n"
             "  plumb doctor\n"
             "  plumb doctor --json\n"
             "  ./compare/run --with rapier,jolt",
    .options = OPTIONS,
    .run = run};
