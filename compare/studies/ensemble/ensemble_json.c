#include "ensemble_json.h"

#include "permutation.h"
#include "plumb/jitter.h"

#include <math.h>
#include <string.h>

static json_t *runs_json(const pl_plan *plan, const pl_ensemble *ensemble, int members)
{
    json_t *runs = json_array();
    for (int k = 0; k < members; ++k) {
        char run[17];
        pl_member_run(plan, ensemble, k, run);
        json_array_append_new(runs, json_string(run));
    }
    return runs;
}

static json_t *horizon_json(const pl_horizon *horizon)
{
    if (!horizon->known) {
        return json_pack("{s:n, s:s}", "time", "reason", horizon->reason);
    }
    json_t *object =
        json_pack("{s:o, s:f, s:o, s:f}", "time", pl_json_number_or_null(horizon->time),
                  "threshold", horizon->threshold, "last_spread",
                  pl_json_number_or_null(horizon->last_spread), "last_time", horizon->last_time);
    if (isinf(horizon->time)) {
        json_object_set_new(object, "reason",
                            json_sprintf("not passed within %.6g s", horizon->last_time));
    }
    return object;
}

bool pl_horizon_recall(const json_t *before, const pl_plan *plan, const pl_ensemble *ensemble,
                       int members, pl_horizon *horizon)
{
    bool found = false;
    size_t index;
    const json_t *item;
    json_t *runs = runs_json(plan, ensemble, members);
    json_array_foreach(json_object_get(before, "ensembles"), index, item)
    {
        const json_t *old = json_object_get(item, "horizon");
        const json_t *time = json_object_get(old, "time");
        const json_t *threshold = json_object_get(old, "threshold");
        if (!found && threshold != NULL && json_equal(json_object_get(item, "runs"), runs)) {
            found = true;
            *horizon = (pl_horizon){
                .known = true,
                .time = json_is_number(time) ? json_number_value(time) : (double)INFINITY,
                .threshold = json_number_value(threshold),
                .last_spread = json_number_value(json_object_get(old, "last_spread")),
                .last_time = json_number_value(json_object_get(old, "last_time"))};
        }
    }
    json_decref(runs);
    return found;
}

static json_t *sample_json(const pl_sample *sample, const pl_metric_info *info)
{
    json_t *values = json_array();
    for (int i = 0; i < sample->count; ++i) {
        json_array_append_new(values, json_real(sample->values[i]));
    }
    return json_pack("{s:o, s:s, s:o, s:o, s:i}", "values", values, "unit", info->unit, "mean",
                     pl_json_number_or_null(sample->mean), "standard_deviation",
                     pl_json_number_or_null(sample->deviation), "unsettled", sample->unsettled);
}

static json_t *outcomes_json(const pl_observations *observed)
{
    json_t *outcomes = json_object();
    for (int i = 0; i < PL_OUTCOME_COUNT; ++i) {
        if (observed->outcomes[i] > 0) {
            json_object_set_new(outcomes, pl_outcome_name((pl_outcome)i),
                                json_integer(observed->outcomes[i]));
        }
    }
    return outcomes;
}

static json_t *view_json(const pl_plan *plan, const pl_ensemble_view *view, int members)
{
    const pl_ensemble *ensemble = view->ensemble;
    const pl_problem *problem = &plan->problems[ensemble->problems[0]];
    const pl_invariants *kept = &view->observed.invariants;
    json_t *observables = json_object();
    for (int i = 0; i < PL_OBSERVABLE_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[pl_observables[i]];
        json_object_set_new(observables, info->name, sample_json(&view->observed.samples[i], info));
    }
    json_t *invariants =
        json_pack("{s:i, s:o, s:i, s:i}", "energy_grew", kept->energy_grew, "energy_growth",
                  pl_json_number_or_null(kept->energy_growth), "fell_through", kept->fell_through,
                  "not_finite", kept->not_finite);
    return json_pack(
        "{s:i, s:o, s:s, s:s, s:i, s:b, s:f, s:o, s:i, s:o, s:o, s:o, s:o}", "problem",
        ensemble->problem, "scenario", pl_json_text(problem->name, strlen(problem->name)), "name",
        ensemble->name, "label", plan->configurations[ensemble->configuration].label, "setting",
        ensemble->setting, "converged", (int)ensemble->reference, "dt", problem->scene.dt, "runs",
        runs_json(plan, ensemble, members), "results", view->observed.results, "outcomes",
        outcomes_json(&view->observed), "invariants", invariants, "horizon",
        horizon_json(&view->horizon), "observables", observables);
}

static json_t *ratio_json(double value, double floor)
{
    return pl_json_number_or_null(floor > 0 ? value / floor : (double)NAN);
}

static json_t *comparison_json(const pl_ensemble_view *views, const pl_sample_test *c)
{
    char sentence[512] = "";
    if (c->apart) {
        pl_sample_test_sentence(views, c, sentence, sizeof sentence);
    }
    return json_pack(
        "{s:i, s:i, s:s, s:f, s:o, s:o, s:f, s:o, s:o, s:f, s:f, s:s, s:o}", "a", c->a, "b", c->b,
        "observable", pl_metric_table[pl_observables[c->observable]].name, "energy_distance",
        c->energy, "energy_distance_floor", pl_json_number_or_null(c->energy_floor),
        "energy_distance_ratio", ratio_json(c->energy, c->energy_floor), "ks", c->ks, "ks_floor",
        pl_json_number_or_null(c->ks_floor), "ks_ratio", ratio_json(c->ks, c->ks_floor), "p", c->p,
        "p_corrected", c->corrected, "verdict", c->apart ? "told apart" : "not told apart",
        "finding", c->apart ? json_string(sentence) : json_null());
}

json_t *pl_ensemble_to_json(const pl_plan *plan, const pl_ensembles *ensembles,
                            const pl_ensemble_view *views, const pl_verdicts *verdicts)
{
    json_t *all = json_array(), *comparisons = json_array();
    for (int i = 0; i < ensembles->count; ++i) {
        json_array_append_new(all, view_json(plan, &views[i], ensembles->members));
    }
    for (int i = 0; i < verdicts->count; ++i) {
        json_array_append_new(comparisons, comparison_json(views, &verdicts->items[i]));
    }
    return json_pack("{s:s, s:i, s:I, s:f, s:f, s:i, s:f, s:o, s:o}", "schema", "plumb.ensemble/1",
                     "members", ensembles->members, "seed", (json_int_t)plan->seed, "jitter",
                     pl_jitter_amplitude, "significance", pl_significance, "permutations",
                     PL_PERMUTATION_DRAWS, "energy_growth_allowed", pl_energy_growth, "ensembles",
                     all, "comparisons", comparisons);
}
