#include "runner/plan.h"

#include "plumb/jitter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more item; NULL when out of memory. */
static void *grow(void *items, int count, size_t size)
{
    return realloc(items, ((size_t)count + 1) * size);
}

/* Varies and hashes the problem and moves it into the plan, or frees it. */
static pl_status add_problem(pl_plan *plan, pl_problem *problem, const char *name, pl_error *error)
{
    problem->variation = plan->variation;
    if (plan->variation.is_member) {
        pl_scene_jitter(&problem->scene, plan->seed, plan->variation.member);
    }
    pl_status status = pl_scene_hash(&problem->scene, problem->scene_hash, error);
    bool known = false;
    for (int i = 0; i < plan->problem_count; ++i) {
        const pl_problem *other = &plan->problems[i];
        known = known || (strcmp(other->name, name) == 0 &&
                          strcmp(other->scene_hash, problem->scene_hash) == 0);
    }
    if (status != PL_OK || known) {
        pl_scene_free(&problem->scene);
        return status;
    }
    problem->name = strdup(name);
    pl_problem *problems = grow(plan->problems, plan->problem_count, sizeof *problems);
    if (problems != NULL) {
        plan->problems = problems;
    }
    if (problem->name == NULL || problems == NULL) {
        free(problem->name);
        pl_scene_free(&problem->scene);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %s", name);
    }
    plan->problems[plan->problem_count++] = *problem;
    return PL_OK;
}

pl_status pl_plan_add_scenario(pl_plan *plan, const pl_scenario *scenario,
                               const char *const *settings, int count, pl_error *error)
{
    pl_problem problem = {.descriptor = scenario, .scene = pl_scene_default()};
    pl_status status = pl_scenario_values(scenario, settings, count, problem.params, error);
    for (int i = 0; i < scenario->param_count && plan->variation.refinement > 1; ++i) {
        if (strcmp(scenario->params[i].name, "dt") == 0) {
            problem.params[i] /= plan->variation.refinement;
        }
    }
    if (status == PL_OK) {
        status = scenario->build(problem.params, plan->seed, &problem.scene, error);
    }
    return status == PL_OK ? add_problem(plan, &problem, scenario->name, error) : status;
}

static pl_status override_times(pl_scene *scene, const char *path, double dt, double duration,
                                pl_error *error)
{
    if (!isnan(duration) && (scene->travel_count > 0 || scene->value_count > 0)) {
        return pl_fail(
            error, PL_BAD_INPUT,
            "%s: --duration cannot replace the duration of a scene that expects a travel or a "
            "value: they hold for %g s",
            path, scene->duration);
    }
    scene->dt = isnan(dt) ? scene->dt : dt;
    scene->duration = isnan(duration) ? scene->duration : duration;
    for (int i = 0; i < scene->travel_count && !isnan(dt); ++i) {
        scene->travels[i].discrete = NAN;
    }
    for (int i = 0; i < scene->value_count && !isnan(dt); ++i) {
        scene->values[i].discrete = NAN;
    }
    return pl_scene_validate(scene, error);
}

pl_status pl_plan_add_scene_file(pl_plan *plan, const char *path, double dt, double duration,
                                 pl_error *error)
{
    pl_problem problem = {.scene = pl_scene_default()};
    pl_status status = pl_scene_read_file(path, &problem.scene, error);
    if (status == PL_OK) {
        const int refinement = plan->variation.refinement > 1 ? plan->variation.refinement : 1;
        const double step = isnan(dt) ? problem.scene.dt : dt;
        status = override_times(&problem.scene, path, refinement > 1 ? step / refinement : dt,
                                duration, error);
    }
    if (status != PL_OK) {
        pl_scene_free(&problem.scene);
        return status;
    }
    return add_problem(plan, &problem, path, error);
}

pl_status pl_plan_add_engine(pl_plan *plan, const char *spec, pl_error *error)
{
    pl_contender added = {.label = ""};
    pl_status status = pl_engine_choose(spec, &added.choice, error);
    if (status != PL_OK) {
        return status;
    }
    pl_engine_choice_label(&added.choice, added.label);
    for (int i = 0; i < plan->contender_count; ++i) {
        const pl_contender *other = &plan->contenders[i];
        if (strcmp(other->label, added.label) == 0) {
            return other->choice.engine == added.choice.engine
                       ? PL_OK
                       : pl_fail(error, PL_BAD_INPUT, "%s and %s are both called %s",
                                 other->choice.spec, spec, added.label);
        }
    }
    return pl_plan_add_choice(plan, &added.choice, added.label, NULL, error);
}

pl_status pl_plan_add_choice(pl_plan *plan, const pl_engine_choice *choice, const char *label,
                             int *index, pl_error *error)
{
    pl_contender added = {.choice = *choice};
    snprintf(added.label, sizeof added.label, "%s", label);
    pl_contender *contenders = grow(plan->contenders, plan->contender_count, sizeof *contenders);
    if (contenders == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %s", label);
    }
    plan->contenders = contenders;
    plan->contenders[plan->contender_count] = added;
    if (index != NULL) {
        *index = plan->contender_count;
    }
    plan->contender_count += 1;
    return PL_OK;
}

pl_status pl_plan_add_pairing(pl_plan *plan, int problem, int contender, pl_error *error)
{
    pl_pairing *pairings = grow(plan->pairings, plan->pairing_count, sizeof *pairings);
    if (pairings == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the plan");
    }
    plan->pairings = pairings;
    plan->pairings[plan->pairing_count++] = (pl_pairing){problem, contender};
    return PL_OK;
}

long pl_plan_size(const pl_plan *plan)
{
    if (plan->pairings != NULL) {
        return (long)plan->repeats * plan->pairing_count;
    }
    return (long)plan->repeats * plan->problem_count * plan->contender_count;
}

pl_planned_run pl_plan_run(const pl_plan *plan, long index)
{
    if (plan->pairings != NULL) {
        const pl_pairing *pairing = &plan->pairings[index % plan->pairing_count];
        return (pl_planned_run){.problem = &plan->problems[pairing->problem],
                                .contender = &plan->contenders[pairing->contender],
                                .repeat = (int)(index / plan->pairing_count)};
    }
    long engines = plan->contender_count;
    long position = index % engines;
    long problem = index / engines % plan->problem_count;
    long repeat = index / engines / plan->problem_count;
    return (pl_planned_run){.problem = &plan->problems[problem],
                            .contender = &plan->contenders[(position + repeat) % engines],
                            .repeat = (int)repeat};
}

json_t *pl_planned_run_identity(const pl_plan *plan, const pl_planned_run *run)
{
    const pl_problem *problem = run->problem;
    const pl_engine_choice *choice = &run->contender->choice;
    pl_run_view view = {.scenario = problem->name,
                        .descriptor = problem->descriptor,
                        .params = problem->params,
                        .scene_hash = problem->scene_hash,
                        .primary_error = problem->scene.primary_error,
                        .dt = problem->scene.dt,
                        .duration = problem->scene.duration,
                        .engine = choice->engine,
                        .profile = choice->profile,
                        .options = choice->values,
                        .label = run->contender->label,
                        .seed = plan->seed,
                        .is_member = problem->variation.is_member,
                        .member = problem->variation.member,
                        .repeat = run->repeat};
    return pl_run_identity(&view);
}

void pl_plan_free(pl_plan *plan)
{
    for (int i = 0; i < plan->problem_count; ++i) {
        free(plan->problems[i].name);
        pl_scene_free(&plan->problems[i].scene);
    }
    free(plan->problems);
    free(plan->contenders);
    free(plan->pairings);
    *plan = (pl_plan){.repeats = 0};
}
