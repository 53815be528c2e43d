/* The runs of ensembles, with what their conclusion needs. */
#include "ensemble.h"

#include "plumb/jitter.h"
#include "sample.h"

void pl_ensemble_mark(const pl_ensembles *ensembles, const char *const *against, pl_plan *plan)
{
    for (int i = 0; i < ensembles->count; ++i) {
        const pl_ensemble *e = &ensembles->items[i];
        const char *text = e->setting == 0 ? NULL : against[e->setting - 1];
        /* The plan begins with the scenes as asked for. */
        json_t *study = json_pack(
            "{s:s, s:o, s:i, s:o, s:b}", "name", "ensemble", "case",
            pl_plan_case_params(&plan->cases[e->test_case]), "setting", e->setting, "against",
            text == NULL ? json_null() : pl_json_text(text), "converged", (int)e->reference);
        for (int k = 0; k < ensembles->members; ++k) {
            pl_case *test_case = &plan->cases[pl_member_case(ensembles, e, k)];
            json_decref(test_case->study);
            test_case->study = json_incref(study);
        }
        json_decref(study);
    }
}

typedef struct work {
    const pl_plan *plan;
    const pl_ensembles *ensembles;
    json_t *places; /* of each run, by its hash: the index of its ensemble, and that of its case */
} work;

/* Adds `ensemble`: how many members there are, the place of the ensemble among all, and of the scene the size of the
 * smallest body and whether a body ended beyond a plane. */
static void amend(void *user, json_t *result)
{
    const work *w = user;
    int place = 0, index = 0;
    json_unpack(json_object_get(w->places, pl_json_get_text(result, "run")), "[i, i]", &place,
                &index);
    const pl_scene *scene = &w->plan->cases[index].scene;
    json_object_set_new(result, "ensemble",
                        json_pack("{s:i, s:i, s:f, s:b}", "members", w->ensembles->members, "place",
                                  place, "least_size", pl_scene_least_size(scene), "fell_through",
                                  (int)pl_fell_through(scene, result)));
}

pl_status pl_ensemble_run(const pl_ensembles *ensembles, const pl_execution_def *how,
                          int *signal_number, pl_error *error)
{
    work w = {how->plan, ensembles, json_object()};
    pl_execution_def execution = *how;
    execution.user = &w;
    execution.amend = amend;
    /* Of equal runs under two labels the first counts. */
    for (int i = ensembles->count - 1; i >= 0; --i) {
        const pl_ensemble *e = &ensembles->items[i];
        json_t *runs = pl_member_runs(how->plan, ensembles, e), *run;
        size_t k;
        json_array_foreach(runs, k, run)
        {
            json_object_set_new(w.places, json_string_value(run),
                                json_pack("[i, i]", i, pl_member_case(ensembles, e, (int)k)));
        }
        json_decref(runs);
    }
    const pl_status status = pl_execute(&execution, signal_number, error);
    json_decref(w.places);
    return status;
}
