#include "comparison.h"

#include <stdlib.h>

/* The entries of all suites asked for, then the names. The caller frees *asked. */
static pl_status list_problems(const pl_texts *suites, const pl_texts *names, pl_asked **asked,
                               int *count, pl_error *error)
{
    int room = names->count;
    *count = 0;
    for (int i = 0; i < suites->count; ++i) {
        const pl_suite *suite = pl_suite_find(suites->items[i], error);
        if (suite == NULL) {
            return PL_BAD_INPUT;
        }
        room += suite->entry_count;
    }
    *asked = calloc((size_t)room + 1, sizeof **asked);
    if (*asked == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    for (int i = 0; i < suites->count; ++i) {
        const pl_suite *suite = pl_suite_find(suites->items[i], NULL);
        for (int k = 0; k < suite->entry_count; ++k) {
            const pl_suite_entry *entry = &suite->entries[k];
            (*asked)[(*count)++] = (pl_asked){.name = entry->scenario, .setting = entry->setting};
        }
    }
    for (int i = 0; i < names->count; ++i) {
        (*asked)[(*count)++] = (pl_asked){.name = names->items[i]};
    }
    return PL_OK;
}

pl_status pl_comparison_add_problems(const pl_comparison *comparison, pl_plan *plan,
                                     pl_error *error)
{
    pl_asked *asked = NULL;
    int count = 0;
    pl_status status =
        list_problems(&comparison->suites, &comparison->names, &asked, &count, error);
    if (status == PL_OK) {
        status = pl_selection_add(&comparison->selection, asked, count, plan, error);
    }
    free(asked);
    return status;
}

static pl_status add_asked_engines(const char *command, const pl_texts *specs, pl_plan *plan,
                                   pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < specs->count && status == PL_OK; ++i) {
        status = pl_plan_add_engine(plan, specs->items[i], error);
        if (status == PL_UNSUPPORTED) {
            fprintf(stderr, "%s: %s\n", command, error->message);
            status = PL_OK;
        }
    }
    return status;
}

static pl_status add_found_engines(const char *command, pl_plan *plan, pl_error *error)
{
    int count;
    const pl_known_engine *known = pl_known_engines(&count);
    pl_status status = PL_OK;
    for (int i = 0; i < count; ++i) {
        const pl_engine *engine = known[i].engine;
        if (engine == NULL) {
            fprintf(stderr, "%s: engine %s is absent from this build; Debian: %s\n", command,
                    known[i].name, known[i].package);
        }
        for (int k = 0; engine != NULL && k < engine->profile_count && status == PL_OK; ++k) {
            char spec[2 * PL_NAME_SIZE];
            snprintf(spec, sizeof spec, "%s:%s", known[i].name, engine->profiles[k].name);
            if (engine->profiles[k].in_default_comparison) {
                status = pl_plan_add_engine(plan, spec, error);
            }
        }
    }
    return status;
}

pl_status pl_comparison_add_engines(const char *command, const pl_comparison *comparison,
                                    pl_plan *plan, pl_error *error)
{
    return comparison->engines.count > 0
               ? add_asked_engines(command, &comparison->engines, plan, error)
               : add_found_engines(command, plan, error);
}
