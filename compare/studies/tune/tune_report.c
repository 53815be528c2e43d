/* The outcome of tuning as text, as JSON and as a profile. */
#include "tune.h"

#include "base/folding.h"
#include "results/result.h"
#include "studies/tunable.h"

#include <math.h>
#include <string.h>

/* ---- plumb.tuning/1 and plumb.profile/1 ---- */

static json_t *options_json(const pl_engine_choice *choice)
{
    json_t *options = json_object();
    for (int i = 0; i < choice->engine->option_count; ++i) {
        json_object_set_new(options, choice->engine->options[i].name, json_real(choice->values[i]));
    }
    return options;
}

/* Of the step in seconds, of which the parameter has the reciprocal. */
static json_t *value_json(const pl_tune_parameter *parameter, double value)
{
    return json_real(parameter->option == PL_TUNE_RATE ? 1 / value : value);
}

static json_t *targets_json(const pl_tune_def *def)
{
    json_t *list = json_array();
    for (int i = 0; i < def->targets->count; ++i) {
        char text[96];
        pl_target_text(&def->targets->items[i], text);
        json_array_append_new(list, json_string(text));
    }
    return list;
}

static json_t *scenarios_json(const pl_tune_def *def)
{
    json_t *list = json_array();
    for (int p = 0; p < def->plan->case_count; ++p) {
        json_array_append_new(list, json_string(def->plan->cases[p].name));
    }
    return list;
}

/* The default step of a setting that keeps the scenarios' own is not one number: null. */
static json_t *setting_json(const pl_setting *setting)
{
    return json_pack("{s:s, s:o, s:o}", "spec", setting->choice.spec, "dt",
                     pl_json_number_or_null(setting->dt), "options",
                     options_json(&setting->choice));
}

static json_t *values_json(const pl_tune_def *def, const pl_target_reading *reading)
{
    json_t *values = json_object();
    for (int i = 0; i < def->targets->count; ++i) {
        json_object_set_new(values, pl_metric_table[def->targets->items[i].metric].name,
                            pl_json_number_or_null(reading->values[i]));
    }
    return values;
}

static json_t *scores_json(const pl_tune_def *def, const pl_tuning *tuning)
{
    json_t *list = json_array();
    for (int p = 0; p < def->plan->case_count; ++p) {
        const pl_tune_score *score = &tuning->scores[p];
        json_array_append_new(
            list, json_pack("{s:s, s:s, s:o, s:f, s:o, s:o, s:o, s:s, s:o}", "scenario",
                            def->plan->cases[p].name, "outcome", score->outcome, "metrics",
                            values_json(def, &score->target), "excess", score->target.excess,
                            "cost_ratio", pl_json_number_or_null(score->ratio), "seconds",
                            pl_json_number_or_null(score->seconds), "shipped_seconds",
                            pl_json_number_or_null(score->default_seconds), "shipped_outcome",
                            score->default_outcome, "shipped_metrics",
                            values_json(def, &score->default_target)));
    }
    return list;
}

static json_t *sensitivities_json(const pl_tune_def *def, const pl_tuning *tuning)
{
    json_t *list = json_array();
    for (int i = 0; i < tuning->sensitivity_count; ++i) {
        const pl_tune_sensitivity *sensitivity = &tuning->sensitivities[i];
        const pl_tune_parameter *parameter = &def->space->parameters[sensitivity->parameter];
        json_array_append_new(
            list,
            json_pack("{s:s, s:o, s:o, s:o, s:f}", "key", parameter->name, "from",
                      value_json(parameter, tuning->best.values[sensitivity->parameter]), "to",
                      value_json(parameter, sensitivity->value), "cost_ratio",
                      pl_json_number_or_null(sensitivity->cost), "excess", sensitivity->excess));
    }
    return list;
}

static json_t *checks_json(const pl_tune_def *def, const pl_tuning *tuning)
{
    json_t *list = json_array();
    for (int i = 0; i < tuning->check_count; ++i) {
        const pl_tune_check *check = &tuning->checks[i];
        json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:o, s:f}", "scenario",
                                              def->plan->cases[check->test_case].name, "variant",
                                              check->variant, "outcome", check->outcome, "metrics",
                                              values_json(def, &check->target), "excess",
                                              check->target.excess));
    }
    return list;
}

static json_t *evaluations_json(const pl_tune_def *def, const pl_tuning *tuning)
{
    json_t *list = json_array();
    for (int i = 0; i < tuning->found.count; ++i) {
        const pl_evaluation *evaluation = &tuning->found.evaluations[i];
        json_t *values = json_object();
        for (int k = 0; k < def->space->parameter_count; ++k) {
            json_object_set_new(values, def->space->parameters[k].name,
                                value_json(&def->space->parameters[k], evaluation->values[k]));
        }
        json_array_append_new(list, json_pack("{s:o, s:o, s:f, s:b}", "values", values, "cost",
                                              pl_json_number_or_null(evaluation->cost), "excess",
                                              evaluation->excess, "holds", evaluation->holds));
    }
    return list;
}

static bool is_validated(const pl_tuning *tuning)
{
    return tuning->met && tuning->check_count > 0 && tuning->missed == 0;
}

json_t *pl_tune_json(const pl_tune_def *def, const pl_tuning *tuning)
{
    const pl_engine_choice *base = &def->space->base;
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:o, s:o, s:b, s:b, s:b, s:o, s:b, s:f, s:o, s:o, s:o, s:o, s:i, s:s, "
        "s:I, s:I, s:o}",
        "schema", "plumb.tuning/1", "engine", base->engine->name, "profile",
        base->engine->profiles[base->profile].name, "scenarios", scenarios_json(def), "targets",
        targets_json(def), "met", tuning->met, "has_margin", tuning->has_margin, "validated",
        is_validated(tuning), "cost", pl_json_number_or_null(tuning->cost), "cost_is_ratio",
        tuning->default_has_cost, "excess", tuning->worst, "setting",
        setting_json(&tuning->setting), "on", scores_json(def, tuning), "sensitivity",
        sensitivities_json(def, tuning), "validation", checks_json(def, tuning), "passed_over",
        tuning->passed_over, "search_cost", tuning->by_instructions ? "instructions" : "cpu_time",
        "seed", (json_int_t)def->plan->seed, "runs", (json_int_t)tuning->runs, "trials",
        evaluations_json(def, tuning));
    if (json != NULL && json_object_update(json, def->provenance) != 0) {
        json_decref(json);
        return NULL;
    }
    return json;
}

json_t *pl_tune_profile(const pl_tune_def *def, const pl_tuning *tuning)
{
    const pl_engine_choice *base = &def->space->base;
    char made[32];
    pl_timestamp(made);
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:b, s:i, s:s, s:O?, s:O?}", "schema",
        "plumb.profile/1", "name", "tuned", "engine", base->engine->name, "engine_version",
        base->engine->version, "profile", base->engine->profiles[base->profile].name, "dt",
        pl_json_number_or_null(tuning->setting.dt), "options",
        options_json(&tuning->setting.choice), "scenarios", scenarios_json(def), "targets",
        targets_json(def), "validated", is_validated(tuning), "budget", def->budget, "made", made,
        "command", json_object_get(def->provenance, "command"), "plumb",
        json_object_get(def->provenance, "plumb"));
}

static void print_margin(FILE *out, double excess)
{
    const double clear = 1e6, ratio = exp(fabs(excess));
    if (excess >= PL_SEARCH_WORST) {
        fprintf(out, "no value");
    } else if (ratio >= clear) {
        fprintf(out, excess <= 0 ? "clear of the target" : "far from the target");
    } else {
        fprintf(out, "%.3g x %s the target", ratio, excess <= 0 ? "below" : "above");
    }
}

static void print_values(FILE *out, const pl_targets *targets, const pl_target_reading *reading)
{
    for (int i = 0; i < targets->count; ++i) {
        fprintf(out, "%s%s %.3g", i == 0 ? "" : ", ",
                pl_metric_table[targets->items[i].metric].name, reading->values[i]);
    }
}

static void print_targets(FILE *out, const pl_tune_def *def)
{
    for (int i = 0; i < def->targets->count; ++i) {
        char text[96];
        pl_target_text(&def->targets->items[i], text);
        fprintf(out, "%s%s", i == 0 ? "" : " and ", text);
    }
}

static void print_settings(FILE *out, const pl_tune_def *def, const pl_tuning *tuning)
{
    const pl_setting *setting = &tuning->setting;
    const double rate = 1 / setting->dt;
    const bool is_whole = fabs(rate - nearbyint(rate)) < 1e-9 * rate;
    fprintf(out, "  --engine %s", setting->choice.spec);
    if (!isnan(setting->dt)) {
        fprintf(out, is_whole ? " --dt 1/%.0f" : " --dt %.9g", is_whole ? rate : setting->dt);
    }
    const double dt = isnan(setting->dt) ? def->plan->cases[0].scene.dt : setting->dt;
    fprintf(out, "\n");
    if (pl_tune_has_api(&setting->choice, dt)) {
        fprintf(out, "\nin its own API:\n\n");
        pl_tune_print_api(out, &setting->choice, dt);
    }
}

static void print_scores(FILE *out, const pl_tune_def *def, const pl_tuning *tuning)
{
    if (tuning->default_has_cost) {
        fprintf(out, "\ncost: %.3g x that of the default settings at the scenarios' own step\n",
                tuning->cost);
    } else {
        fprintf(out,
                "\ncost: %.3g s of CPU time a simulated second; the default settings have none\n",
                tuning->cost);
    }
    for (int p = 0; p < def->plan->case_count; ++p) {
        const pl_tune_score *score = &tuning->scores[p];
        fprintf(out, "  %s: ", def->plan->cases[p].name);
        if (isfinite(score->ratio)) {
            fprintf(out, "x %.3g, ", score->ratio);
        }
        fprintf(out, "%.3g s a simulated second; %s, ", score->seconds, score->outcome);
        print_values(out, def->targets, &score->target);
        fprintf(out, ", ");
        print_margin(out, score->target.excess);
        fprintf(out, "; default settings: %s, ", score->default_outcome);
        print_values(out, def->targets, &score->default_target);
        fprintf(out, "\n");
    }
}

static void print_sensitivities(FILE *out, const pl_tune_def *def, const pl_tuning *tuning)
{
    if (tuning->sensitivity_count > 0) {
        fprintf(out, "\nsensitivity, each moved by 10 %% or one step, on the scenarios as asked "
                     "for:\n");
    }
    for (int i = 0; i < tuning->sensitivity_count; ++i) {
        const pl_tune_sensitivity *sensitivity = &tuning->sensitivities[i];
        const pl_tune_parameter *parameter = &def->space->parameters[sensitivity->parameter];
        char from[32], to[32];
        pl_tune_value_text(parameter, tuning->best.values[sensitivity->parameter], from);
        pl_tune_value_text(parameter, sensitivity->value, to);
        fprintf(out, "  %-16s %10s -> %-10s cost x %.3g, ", parameter->name, from, to,
                sensitivity->cost);
        print_margin(out, sensitivity->excess);
        fprintf(out, "\n");
    }
}

static void print_checks(FILE *out, const pl_tune_def *def, const pl_tuning *tuning)
{
    if (tuning->check_count == 0) {
        fprintf(out, "\nnot validated: the scenarios have no parameters to change\n");
        return;
    }
    fprintf(out, "\nvalidation on %d runs that were not tuned on: ", tuning->check_count);
    if (tuning->missed == 0) {
        fprintf(out, "all meet the target\n");
    } else {
        fprintf(out,
                "%d miss the target: these settings are fitted to the scenarios as asked for\n",
                tuning->missed);
    }
    if (tuning->passed_over > 0) {
        fprintf(out, "  (%d cheaper, or nearer to a margin, missed it there)\n",
                tuning->passed_over);
    }
    for (int i = 0; i < tuning->check_count; ++i) {
        const pl_tune_check *check = &tuning->checks[i];
        fprintf(out, "  %s, %s: %s, ", def->plan->cases[check->test_case].name, check->variant,
                check->outcome);
        print_values(out, def->targets, &check->target);
        fprintf(out, ", ");
        print_margin(out, check->target.excess);
        fprintf(out, "\n");
    }
}

void pl_tune_print(FILE *stream, const pl_tune_def *def, const pl_tuning *tuning)
{
    pl_folding folding;
    FILE *out = pl_folding_begin(&folding, stream);
    const pl_engine_choice *base = &def->space->base;
    fprintf(out, tuning->met ? "%s:%s, the cheapest found for " : "%s:%s: no settings found meet ",
            base->engine->name, base->engine->profiles[base->profile].name);
    print_targets(out, def);
    fprintf(out, tuning->met ? ":\n\n" : "; the nearest:\n\n");
    print_settings(out, def, tuning);
    print_scores(out, def, tuning);
    print_sensitivities(out, def, tuning);
    if (tuning->met && !tuning->has_margin) {
        fprintf(out, "\nthe errors of the runs tuned on scatter so much that another may miss the "
                     "target: no settings found have two standard deviations to spare\n");
    }
    if (tuning->met) {
        print_checks(out, def, tuning);
    }
    fprintf(out,
            "\n%d settings tried (%d of a sweep, %d by NLopt, %d around the best) in %ld runs; the "
            "search took %s as cost\n",
            tuning->found.count, tuning->found.sampled, tuning->found.optimised,
            tuning->found.refined, tuning->runs,
            tuning->by_instructions
                ? "instructions a step"
                : "CPU time next to the default settings', in turns (instructions "
                  "are not counted here)");
    pl_folding_end(&folding);
}
