#include "published.h"

#include <string.h>

bool pl_published_is(const pl_block *block, const pl_suite_entry *entry)
{
    const pl_scenario *scenario = block->catalogue;
    double values[PL_MAX_PARAMS];
    if (scenario == NULL || strcmp(block->scenario, entry->scenario) != 0 ||
        pl_scenario_values(scenario, &entry->setting, entry->setting == NULL ? 0 : 1, values,
                           NULL) != PL_OK)
        return false;
    for (int i = 0; i < scenario->param_count; i++) {
        const char *name = scenario->params[i].name;
        const json_t *value = json_object_get(block->params, name);
        if (strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0)
            continue;
        if (!json_is_number(value) || json_number_value(value) != values[i])
            return false;
    }
    return true;
}

bool pl_published_applies(const pl_suite *suite, const pl_result_matrix *cells)
{
    bool applies = suite->published_metric != NULL;
    for (int i = 0; i < suite->entry_count && applies; i++) {
        applies = false;
        for (int b = 0; b < cells->block_count && !applies; b++)
            applies = pl_published_is(&cells->blocks[b], &suite->entries[i]);
    }
    return applies;
}
