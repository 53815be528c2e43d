/* Which problems the benchmark solves, and how they are captured: by running the scenario on our
 * own engine, in this process. */
#include "benchmark.h"

#include "adapters/registry.h"
#include "capture_file.h"
#include "plumb/scenario.h"

#include <math.h>

/* Stands at rest are taken after they have settled, with the warm start of the step before; piles
 * and collapses while they move. Seeds above 100 are held out. */
static const pl_benchmark_problem PROBLEMS[] = {
    {"tower-10", "tower", {"n=10"}, .step = 2},
    {"tower-100", "tower", {"n=100"}, .step = 2},
    {"tower-1000", "tower", {"n=1000"}, .step = 2},
    {"tower-100-offset", "tower", {"n=100", "offset=0.05"}, .seed = 1, .step = 30},
    {"tower-100-offset-held-out", "tower", {"n=100", "offset=0.05"}, 101, 30, true},
    {"mass-ratio-1e3", "mass-ratio", {"k=3"}, .step = 2},
    {"mass-ratio-1e6", "mass-ratio", {"k=6"}, .step = 2},
    {"tower-100-top-1000", "tower", {"n=100", "top_mass=1000"}, .step = 2},
    {"tower-100-rising-1000", "tower", {"n=100", "rising_mass=1000"}, .step = 2},
    {"slope-stick-threshold", "slope-stick", {"angle=0.4636"}, .step = 30},
    {"slope-slide-threshold", "slope-slide", {"angle=0.4637"}, .step = 30},
    {"wall-10x10", "wall", {"rows=10", "columns=10"}, .step = 2},
    {"wall-25x40", "wall", {"rows=25", "columns=40"}, .step = 2},
    {"collapse-10x10-impact", "wall-collapse", {"rows=10", "columns=10"}, .step = 8},
    {"collapse-10x10", "wall-collapse", {"rows=10", "columns=10"}, .step = 40},
    {"collapse-25x40-impact", "wall-collapse", {"rows=25", "columns=40"}, .step = 8},
    {"collapse-25x40", "wall-collapse", {"rows=25", "columns=40"}, .step = 40},
    {"pile-100-spheres", "pile", {"n=100", "shape=0"}, .seed = 1, .step = 90},
    {"pile-100-boxes", "pile", {"n=100", "shape=1"}, .seed = 1, .step = 90},
    {"pile-100-both", "pile", {"n=100", "shape=2"}, .seed = 1, .step = 90},
    {"pile-500-spheres", "pile", {"n=500", "shape=0"}, .seed = 1, .step = 110},
    {"pile-500-boxes", "pile", {"n=500", "shape=1"}, .seed = 1, .step = 110},
    {"pile-500-both", "pile", {"n=500", "shape=2"}, .seed = 1, .step = 110},
    {"pile-1000-spheres", "pile", {"n=1000", "shape=0"}, .seed = 1, .step = 130},
    {"pile-1000-boxes", "pile", {"n=1000", "shape=1"}, .seed = 1, .step = 130},
    {"pile-100-both-held-out", "pile", {"n=100", "shape=2"}, 101, 80, true},
    {"pile-500-both-held-out", "pile", {"n=500", "shape=2"}, 102, 100, true},
    {"pile-1000-both-held-out", "pile", {"n=1000", "shape=2"}, 103, 120, true},
};
enum { PROBLEM_COUNT = sizeof PROBLEMS / sizeof PROBLEMS[0] };

const pl_benchmark_problem *pl_benchmark_problems(int *count)
{
    *count = PROBLEM_COUNT;
    return PROBLEMS;
}

static pl_status build_scene(const pl_benchmark_problem *row, pl_scene *scene, pl_error *error)
{
    const pl_scenario *scenario = pl_scenario_find(row->scenario, error);
    if (scenario == NULL) {
        return PL_BAD_INPUT;
    }
    double values[PL_MAX_PARAMS];
    int count = 0;
    while (count < PL_BENCHMARK_SETTINGS && row->settings[count] != NULL) {
        ++count;
    }
    pl_status status = pl_scenario_values(scenario, row->settings, count, values, error);
    return status == PL_OK ? scenario->build(values, row->seed, scene, error) : status;
}

/* Makes the steps before, then captures. */
static pl_status step_and_capture(const pl_benchmark_problem *row, const pl_scene *scene,
                                  const pl_engine *engine, pl_engine_instance *instance,
                                  pe_contact_problem **problem, pl_error *error)
{
    for (int step = 1; step < row->step; ++step) {
        pl_step_stats stats = {.struct_size = sizeof stats};
        pl_status status = engine->step(instance, scene->dt, &stats, error);
        if (status != PL_OK) {
            return status;
        }
    }
    pe_contact_problem **problems = NULL;
    int count = 0;
    pl_status status = engine->capture(instance, scene->dt, &problems, &count, error);
    if (status != PL_OK) {
        return status;
    }
    int largest = pl_capture_largest(problems, count);
    if (largest < 0) {
        return pl_fail(error, PL_FAILED, "%s: step %d has no contact", row->name, row->step);
    }
    *problem = pe_contact_problems_keep(problems, count, largest);
    return PL_OK;
}

pl_status pl_benchmark_capture(const pl_benchmark_problem *row, pe_contact_problem **problem,
                               pl_error *error)
{
    pl_scene scene = pl_scene_default();
    pl_engine_choice choice;
    pl_engine_instance *instance = NULL;
    pl_status status = build_scene(row, &scene, error);
    if (status == PL_OK) {
        status = pl_engine_choose("plumb:accurate", &choice, error);
    }
    if (status == PL_OK) {
        status = choice.engine->create(&scene, choice.profile, choice.values, &instance, error);
    }
    if (status == PL_OK) {
        status = step_and_capture(row, &scene, choice.engine, instance, problem, error);
        choice.engine->destroy(instance);
    }
    pl_scene_free(&scene);
    return status;
}
