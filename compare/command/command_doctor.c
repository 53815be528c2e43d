/* plumb doctor: which engines and tools are here, and how to get the others. */
#include "adapters/built_in.h"
#include "base/folding.h"
#include "base/table.h"
#include "engines/registry.h"
#include "request.h"
#include "results/conformance_record.h"

#include <string.h>

typedef struct options {
    pl_request request;
} options;

/* What is known of the conformance of the profiles that an engine proposes: the worst of them. */
static void describe_conformance(const pl_engine_info *engine, char *text, size_t size)
{
    int known = 0, proposed = 0, failed = 0, checks = 0;
    for (int i = 0; i < engine->profile_count; ++i) {
        const pl_conformance found = pl_conformance_find(engine, engine->profiles[i].name);
        if (!engine->profiles[i].in_default_comparison) {
            continue;
        }
        ++proposed;
        known += found.is_known;
        failed += found.is_known ? found.failed : 0;
        checks += found.is_known ? found.checks : 0;
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

static pl_status add_engine(const pl_built_in *built_in, pl_table *table, bool *faulty,
                            pl_error *error)
{
    char text[PL_NAME_SIZE + 64];
    const pl_engine_info *engine = NULL;
    pl_table_add(table, built_in->name);
    if (!pl_built_in_is_present(built_in)) {
        char how[PL_HOW_TO_GET];
        pl_built_in_how_to_get(built_in, how, sizeof how);
        pl_table_add(table, "absent");
        pl_table_add(table, "");
        pl_table_add(table, how);
        return PL_OK;
    }
    const pl_status status = pl_engine_of_build(built_in, &engine, error);
    if (status != PL_OK) {
        return status;
    }
    const bool has_fault = engine->fault.is_fault;
    *faulty = *faulty || has_fault;
    pl_table_add(table, has_fault ? "fault" : engine->version);
    pl_table_add(table, pl_engine_runtime(engine));
    describe_conformance(engine, text, sizeof text);
    pl_table_add(table, has_fault ? engine->fault.reason : text);
    return PL_OK;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    pl_error error = {.message = ""};
    pl_table table = {0};
    pl_status status = PL_OK;
    int count;
    bool faulty = false;
    const pl_built_in *known = pl_built_in_engines(&count);
    pl_call_parse(call, &o);
    pl_table_columns(&table, "engine|version|runs as|conformance, or how to get it");
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = add_engine(&known[i], &table, &faulty, &error);
    }
    if (status == PL_OK) {
        pl_table_print(&table, stdout);
    }
    pl_table_free(&table);
    pl_request_free(&o.request);
    return pl_call_end(call, status, &error, 0, faulty ? PL_EXIT_FAILED : PL_EXIT_OK);
}

const pl_command pl_command_doctor = {
    .name = "doctor",
    .summary = "say which engines are here, and how to get the others",
    .arguments = "",
    .description = "Lists every engine that Plumb has an adapter for: its version, what runs its "
                   "code, whether "
                   "plumb check-engine has verified this binary of it, and how to get one that is "
                   "absent. Exits "
                   "with 3 when an engine that is here could not be asked.",
    .notes = "Examples:\n"
             "  plumb doctor\n"
             "  ./compare/run --with rapier,jolt",
    .run = run};
