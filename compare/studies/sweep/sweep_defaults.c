#include "sweep_defaults.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A budget that is larger is none. */
static const double MOST_ITERATIONS = 1000;

/* The iterations that the configuration begins with; 0 when it has no such option, or no budget. */
static double iterations_of(const pl_configuration *configuration)
{
    const pl_engine *engine = configuration->choice.engine;
    for (int i = 0; i < engine->option_count; ++i) {
        if (strcmp(engine->options[i].name, "iterations") == 0) {
            const double value = configuration->choice.values[i];
            return value <= MOST_ITERATIONS ? value : 0;
        }
    }
    return 0;
}

static bool is_varied(const pl_vary *varied, int count, const char *owner)
{
    for (int i = 0; i < count; ++i) {
        if (strcmp(varied[i].owner, owner) == 0) {
            return true;
        }
    }
    return false;
}

pl_status pl_default_vary(const pl_plan *plan, pl_vary **varied, int *count, pl_error *error)
{
    *count = 0;
    *varied = calloc((size_t)plan->configuration_count + 1, sizeof **varied);
    if (*varied == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    /* Coarse ones first: what takes too long there need not be tried at the others. */
    pl_status status = pl_vary_parse("dt=1/60,1/120,1/240,1/480,1/960", &(*varied)[0], error);
    *count = status == PL_OK;
    for (int i = 0; i < plan->configuration_count && status == PL_OK; ++i) {
        const char *name = plan->configurations[i].choice.engine->name;
        const double shipped = iterations_of(&plan->configurations[i]);
        if (shipped > 0 && !is_varied(*varied, *count, name)) {
            char text[128];
            snprintf(text, sizeof text, "%s.iterations=%.0f,%.0f", name, shipped, 5 * shipped);
            status = pl_vary_parse(text, &(*varied)[*count], error);
            *count += status == PL_OK;
        }
    }
    return status;
}
