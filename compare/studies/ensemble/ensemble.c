/* The runs of ensembles, with what their conclusion needs. */
#include "ensemble.h"

#include "plumb/jitter.h"
#include "sample.h"

#include <string.h>

/* ---- Before the runs ---- */

/* The parameters of a case. */
static json_t *params_of(const pl_plan *plan, const pl_case *test_case)
{
    const pl_planned_run planned = {.test_case = test_case,
                                    .configuration = &plan->configurations[0]};
    json_t *identity = pl_planned_run_identity(plan, &planned);
    json_t *params = json_incref(json_object_get(identity, "params"));
    json_decref(identity);
    return params;
}

/* The ensemble of the scene as asked for. */
static const pl_ensemble *as_asked(const pl_ensembles *ensembles, int test_case)
{
    const pl_ensemble *e = ensembles->items;
    while (e->test_case != test_case || e->setting != 0 || e->reference) {
        ++e;
    }
    return e;
}

void pl_ensemble_mark(const pl_ensembles *ensembles, const char *const *against, pl_plan *plan)
{
    for (int i = 0; i < ensembles->count; ++i) {
        const pl_ensemble *e = &ensembles->items[i];
        const pl_ensemble *asked = as_asked(ensembles, e->test_case);
        const char *text = e->setting == 0 ? NULL : against[e->setting - 1];
        json_t *study = json_pack(
            "{s:s, s:o, s:i, s:o, s:b}", "name", "ensemble", "case",
            params_of(plan, &plan->cases[asked->cases[0]]), "setting", e->setting, "against",
            text == NULL ? json_null() : pl_json_text(text), "converged", (int)e->reference);
        for (int k = 0; k < ensembles->members; ++k) {
            pl_case *test_case = &plan->cases[e->cases[k]];
            json_decref(test_case->study);
            test_case->study = json_incref(study);
        }
        json_decref(study);
    }
}

/* ---- After a run ---- */

typedef struct work {
    const pl_plan *plan;
    const pl_ensembles *ensembles;
} work;

/* Whether the result is of this case. */
static bool is_of_case(const json_t *result, const pl_case *test_case)
{
    return strcmp(pl_json_get_text(result, "scene_hash"), test_case->scene_hash) == 0 &&
           strcmp(pl_json_get_text(result, "scenario"), test_case->name) == 0 &&
           json_equal(json_object_get(result, "study"), test_case->study);
}

/* Adds `ensemble`: how many members there are, the place of the ensemble among all, and of the scene the size of the
 * smallest body and whether a body ended beyond a plane. */
static void amend(void *user, json_t *result)
{
    const work *w = user;
    const int members = w->ensembles->members;
    for (int i = 0; i < w->ensembles->count; ++i) {
        const pl_ensemble *e = &w->ensembles->items[i];
        const pl_configuration *configuration = &w->plan->configurations[e->configuration];
        for (int k = 0;
             strcmp(pl_json_get_text(result, "label"), configuration->label) == 0 && k < members;
             ++k) {
            const pl_case *test_case = &w->plan->cases[e->cases[k]];
            if (is_of_case(result, test_case)) {
                json_object_set_new(
                    result, "ensemble",
                    json_pack("{s:i, s:i, s:f, s:b}", "members", members, "place", i, "least_size",
                              pl_scene_least_size(&test_case->scene), "fell_through",
                              (int)pl_fell_through(&test_case->scene, result)));
                return;
            }
        }
    }
}

pl_status pl_ensemble_run(const pl_plan *plan, const pl_ensembles *ensembles,
                          const pl_execution_def *how, int *signal_number, pl_error *error)
{
    work w = {plan, ensembles};
    pl_execution_def execution = *how;
    execution.plan = plan;
    execution.user = &w;
    execution.amend = amend;
    return pl_execute(&execution, signal_number, error);
}
