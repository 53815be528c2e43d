#include "repeats.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

static void name_point(const pl_plan *plan, const pl_planned_run *run, char name[48])
{
    snprintf(name, 48, "%td.%td", run->test_case - plan->cases,
             run->configuration - plan->configurations);
}

pl_status pl_repeats_begin(pl_repeats *repeats, const pl_plan *plan, double limit, pl_error *error)
{
    *repeats = (pl_repeats){
        .limit = limit, .points = json_object(), .first = json_object(), .spared = json_object()};
    bool made = repeats->points != NULL && repeats->first != NULL && repeats->spared != NULL;
    for (long i = 0; made && i < pl_plan_size(plan); ++i) {
        char name[48];
        const pl_planned_run run = pl_plan_run(plan, i);
        json_t *identity = pl_planned_run_identity(plan, &run);
        const char *hash = identity != NULL ? pl_json_get_text(identity, "run") : "";
        name_point(plan, &run, name);
        made =
            identity != NULL && json_object_set_new(repeats->points, hash, json_string(name)) == 0;
        if (made && run.repeat == 0) {
            made = json_object_set_new(repeats->first, hash, json_true()) == 0;
        }
        json_decref(identity);
    }
    return made ? PL_OK : pl_fail(error, PL_NO_MEMORY, "out of memory for the plan");
}

void pl_repeats_free(pl_repeats *repeats)
{
    json_decref(repeats->points);
    json_decref(repeats->first);
    json_decref(repeats->spared);
    *repeats = (pl_repeats){0};
}

static const char *point_of(const pl_repeats *repeats, const char *run)
{
    return json_string_value(json_object_get(repeats->points, run));
}

/* Of the engine's steps, s. */
static double cost_of(const json_t *result)
{
    const json_t *metric = json_object_get(json_object_get(result, "metrics"), "time_per_step");
    const json_t *done = json_object_get(json_object_get(result, "steps"), "done");
    return json_number_value(json_object_get(metric, "value")) * json_number_value(done);
}

void pl_repeats_see(pl_repeats *repeats, const json_t *result)
{
    const char *point = point_of(repeats, pl_json_get_text(result, "run"));
    bool ended = strcmp(pl_json_get_text(result, "outcome"), "timeout") != 0;
    if (point != NULL && (!ended || cost_of(result) > repeats->limit)) {
        json_object_set_new(repeats->spared, point, json_true());
    }
}

bool pl_repeats_spare(const pl_repeats *repeats, const char *run)
{
    const char *point = point_of(repeats, run);
    return point != NULL && json_object_get(repeats->first, run) == NULL &&
           json_object_get(repeats->spared, point) != NULL;
}
