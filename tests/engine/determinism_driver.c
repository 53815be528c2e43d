/* Runs short versions of the catalogue on our engine and prints a hash of the bits of all poses of
 * all frames, a line a scenario. */
#include "adapters/built_in.h"
#include "plumb/scenario.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* FNV-1a, 64 bits. */
static uint64_t hashed(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; ++i) {
        hash = (hash ^ b[i]) * UINT64_C(1099511628211);
    }
    return hash;
}

static int run(const char *name, int profile, const char *const *settings, int setting_count,
               int steps)
{
    const pl_engine *engine = pl_engine_plumb();
    double values[PL_MAX_PARAMS], options[PL_ENGINE_MAX_OPTIONS];
    pl_error error = {0};
    pl_scene scene;
    pl_engine_instance *instance = NULL;
    const pl_scenario *scenario = pl_scenario_find(name, &error);
    if (scenario == NULL ||
        pl_scenario_values(scenario, settings, setting_count, values, &error) != PL_OK ||
        pl_scenario_build(scenario, values, 7, &scene, &error) != PL_OK) {
        fprintf(stderr, "%s: %s\n", name, error.message);
        return 1;
    }
    for (int i = 0; i < engine->option_count; ++i) {
        /* A small bound on work keeps -O0 quick; hitting it is as good a test as converging. */
        bool bound = strcmp(engine->options[i].name, "updates") == 0;
        options[i] = bound ? 3e4 : engine->options[i].value;
    }
    pl_body_state *bodies = calloc((size_t)scene.body_count, sizeof *bodies);
    const pl_engine_setup setup = {.struct_size = sizeof setup,
                                   .scene = &scene,
                                   .dt = scene.dt,
                                   .profile = profile,
                                   .values = options};
    pl_status status = bodies != NULL ? engine->create(&setup, &instance, &error) : PL_NO_MEMORY;
    uint64_t hash = UINT64_C(14695981039346656037);
    for (int i = 0; i < steps && status == PL_OK; ++i) {
        pl_step_stats stats = {.struct_size = sizeof stats};
        pl_frame frame = {.body_count = scene.body_count, .bodies = bodies};
        status = engine->step(instance, scene.dt, &stats, &error);
        if (status == PL_OK) {
            engine->read_frame(instance, &frame);
            hash = hashed(hash, bodies, (size_t)scene.body_count * sizeof *bodies);
            hash = hashed(hash, &stats.iterations, sizeof stats.iterations);
            hash = hashed(hash, &stats.residual, sizeof stats.residual);
        }
    }
    engine->destroy(instance);
    pl_scene_free(&scene);
    free(bodies);
    if (status != PL_OK) {
        fprintf(stderr, "%s: %s\n", name, error.message);
        return 1;
    }
    printf("%s %s %016llx\n", engine->profiles[profile].name, name, (unsigned long long)hash);
    return 0;
}

int main(void)
{
    const char *const tower[] = {"n=5", "offset=0.05"};
    const char *const wall[] = {"rows=4", "columns=4"};
    const char *const collapse[] = {"rows=6", "columns=8"};
    const char *const pile[] = {"n=30", "shape=4"};
    const char *const prism[] = {"shape=2"};
    int failed = 0;
    for (int profile = 0; profile < pl_engine_plumb()->profile_count; ++profile) {
        failed |= run("tower", profile, tower, 2, 60);
        failed |= run("slope-stick", profile, NULL, 0, 60);
        failed |= run("slope-slide", profile, NULL, 0, 60);
        failed |= run("wall", profile, wall, 2, 20);
        failed |= run("wall-collapse", profile, collapse, 2, 40);
        failed |= run("pile", profile, pile, 2, 60);
        failed |= run("roll-slope", profile, prism, 1, 40);
        failed |= run("linked-rings", profile, NULL, 0, 20);
    }
    return failed;
}
