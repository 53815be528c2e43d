#include "plan.h"

#include "plumb/jitter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more item; NULL when out of memory. */
static void *grow(void *items, int count, size_t size)
{
    return realloc(items, ((size_t)count + 1) * size);
}

/* Notes what tells the problem from others. *known: it is there already. */
static pl_status note_problem(pl_plan *plan, const pl_problem *problem, const char *name,
                              bool *known, pl_error *error)
{
    char *key = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&key, &length);
    bool failed = stream == NULL;
    if (!failed) {
        fprintf(stream, "%s\n%s", problem->scene_hash, name);
        for (int i = 0; problem->descriptor != NULL && i < problem->descriptor->param_count; ++i) {
            fprintf(stream, "\n%a", problem->params[i]);
        }
        failed = fclose(stream) != 0;
    }
    if (plan->known == NULL) {
        plan->known = json_object();
    }
    *known = !failed && json_object_get(plan->known, key) != NULL;
    failed = failed || (!*known && json_object_set_new_nocheck(plan->known, key, json_true()) != 0);
    free(key);
    return failed ? pl_fail(error, PL_NO_MEMORY, "out of memory for %s", name) : PL_OK;
}

static void vary_scene(const pl_plan *plan, const pl_problem *problem, pl_scene *scene)
{
    if (problem->variation.is_member) {
        pl_scene_jitter(scene, plan->seed, problem->variation.member);
    }
}

/* Leaves of a scene what tells which run it is. */
static void defer(pl_problem *problem)
{
    pl_scene kept = pl_scene_default();
    kept.dt = problem->scene.dt;
    kept.duration = problem->scene.duration;
    memcpy(kept.primary_error, problem->scene.primary_error, sizeof kept.primary_error);
    pl_scene_free(&problem->scene);
    problem->scene = kept;
    problem->deferred = true;
}

/* Varies and hashes the problem and moves it into the plan, or frees it. */
static pl_status add_problem(pl_plan *plan, pl_problem *problem, const char *name, pl_error *error)
{
    bool known = false;
    problem->variation = plan->variation;
    vary_scene(plan, problem, &problem->scene);
    pl_status status = pl_scene_hash(&problem->scene, problem->scene_hash, error);
    if (status == PL_OK) {
        status = note_problem(plan, problem, name, &known, error);
    }
    if (status != PL_OK || known) {
        pl_scene_free(&problem->scene);
        return status;
    }
    if (plan->defers && problem->descriptor != NULL) {
        defer(problem);
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

pl_status pl_plan_build_scene(const pl_plan *plan, const pl_problem *problem, pl_scene *scene,
                              pl_error *error)
{
    *scene = pl_scene_default();
    pl_status status = problem->descriptor->build(problem->params, plan->seed, scene, error);
    if (status == PL_OK) {
        vary_scene(plan, problem, scene);
    }
    return status;
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

/* Who stands at `place` in a repeat: the neighbours with its problem take turns. */
static const pl_pairing *turn(const pl_plan *plan, long place, long repeat)
{
    const int problem = plan->pairings[place].problem;
    long first = place, end = place + 1;
    while (first > 0 && plan->pairings[first - 1].problem == problem) {
        --first;
    }
    while (end < plan->pairing_count && plan->pairings[end].problem == problem) {
        ++end;
    }
    return &plan->pairings[first + (place - first + repeat) % (end - first)];
}

pl_planned_run pl_plan_run(const pl_plan *plan, long index)
{
    if (plan->pairings != NULL) {
        const long repeat = index / plan->pairing_count;
        const pl_pairing *pairing = turn(plan, index % plan->pairing_count, repeat);
        return (pl_planned_run){.problem = &plan->problems[pairing->problem],
                                .contender = &plan->contenders[pairing->contender],
                                .repeat = (int)repeat};
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
    json_decref(plan->known);
    *plan = (pl_plan){.repeats = 0};
}
