#include "runner/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more item; NULL when out of memory. */
static void *grow(void *items, int count, size_t size)
{
    return realloc(items, ((size_t)count + 1) * size);
}

/* Hashes the problem and moves it into the plan, or frees it. */
static pl_status add_problem(pl_plan *plan, pl_problem *problem, const char *name, pl_error *error)
{
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
    if (status == PL_OK) {
        status = scenario->build(problem.params, plan->seed, &problem.scene, error);
    }
    return status == PL_OK ? add_problem(plan, &problem, scenario->name, error) : status;
}

static pl_status override_times(pl_scene *scene, const char *path, double dt, double duration,
                                pl_error *error)
{
    if (!isnan(duration) && scene->travel_count > 0) {
        return pl_fail(
            error, PL_BAD_INPUT,
            "%s: --duration cannot replace the duration of a scene that expects a travel: "
            "its distance holds for %g s",
            path, scene->duration);
    }
    scene->dt = isnan(dt) ? scene->dt : dt;
    scene->duration = isnan(duration) ? scene->duration : duration;
    for (int i = 0; i < scene->travel_count && !isnan(dt); ++i) {
        scene->travels[i].discrete = NAN;
    }
    return pl_scene_validate(scene, error);
}

pl_status pl_plan_add_scene_file(pl_plan *plan, const char *path, double dt, double duration,
                                 pl_error *error)
{
    pl_problem problem = {.scene = pl_scene_default()};
    pl_status status = pl_scene_read_file(path, &problem.scene, error);
    if (status == PL_OK) {
        status = override_times(&problem.scene, path, dt, duration, error);
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
    pl_contender *contenders = grow(plan->contenders, plan->contender_count, sizeof *contenders);
    if (contenders == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %s", spec);
    }
    plan->contenders = contenders;
    plan->contenders[plan->contender_count++] = added;
    return PL_OK;
}

long pl_plan_size(const pl_plan *plan)
{
    return (long)plan->repeats * plan->problem_count * plan->contender_count;
}

pl_planned_run pl_plan_run(const pl_plan *plan, long index)
{
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
    *plan = (pl_plan){.repeats = 0};
}
