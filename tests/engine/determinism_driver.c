/* Runs short versions of the catalogue on our engine in each profile and prints a hash of the bits of all
 * poses of all frames, a line a scene. The scenes have so many bodies and contacts that the loops of a step
 * are divided among threads.
 *
 *   determinism_driver [THREADS]      golden_hashes.txt holds what it prints, for any number of threads */
#include "adapters/plumb/adapter_plumb.h"
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

/* A scene, and how long it runs. */
typedef struct sample {
    const char *name;
    const char *settings; /* NULL: the defaults */
    int steps;
} sample;

static const sample samples[] = {
    {"blocks", "n=700,mesh=0", 6},
    {"multi-tower", "k=6,n=5", 12},
    {"pile", "n=600,gap=0.01", 25},
    {"pile", "n=200,shape=4", 25},
    {"wall", "rows=12,columns=16", 4},
    {"wall-collapse", "rows=20,columns=30", 14},
    {"container", NULL, 30},
    {"rubble", "n=60", 20},
    {"medley", NULL, 20},
    {"domino-spiral", NULL, 30},
    {"bounce-row", NULL, 40},
    {"cradle", NULL, 40},
    {"falling-cubes", NULL, 40},
    {"dropped-load", NULL, 20},
    {"rain", NULL, 30},
    {"pyramid", NULL, 10},
    {"sphere-pyramid", NULL, 10},
    {"domino-into-pile", NULL, 30},
    {"raft", NULL, 20},
    {"overlapping-start", NULL, 15},
};

static int run(const sample *s, int profile, int threads)
{
    const char *name = s->name;
    const char *const settings[] = {s->settings};
    const pl_engine *engine = pl_engine_plumb();
    double values[PL_MAX_PARAMS], options[PL_ENGINE_MAX_OPTIONS];
    pl_error error = {0};
    pl_scene scene;
    pl_engine_instance *instance = NULL;
    const pl_scenario *scenario = pl_scenario_find(name, &error);
    if (scenario == NULL ||
        pl_scenario_values(scenario, settings, s->settings != NULL, values, &error) != PL_OK ||
        pl_scenario_build(scenario, values, 7, &scene, &error) != PL_OK) {
        fprintf(stderr, "%s: %s\n", name, error.message);
        return 1;
    }
    for (int i = 0; i < engine->option_count; ++i) {
        /* A small bound on work keeps -O0 quick; hitting it is as good a test as converging. */
        bool bound = strcmp(engine->options[i].name, "updates") == 0;
        options[i] = bound ? 3e4 : engine->options[i].value;
        if (strcmp(engine->options[i].name, "threads") == 0) {
            options[i] = threads;
        }
    }
    pl_body_state *bodies = calloc((size_t)scene.body_count, sizeof *bodies);
    const pl_engine_setup setup = {.struct_size = sizeof setup,
                                   .scene = &scene,
                                   .dt = scene.dt,
                                   .profile = profile,
                                   .values = options};
    pl_status status = bodies != NULL ? engine->create(&setup, &instance, &error) : PL_NO_MEMORY;
    uint64_t hash = UINT64_C(14695981039346656037);
    for (int i = 0; i < s->steps && status == PL_OK; ++i) {
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
    printf("%s %s %s %016llx\n", engine->profiles[profile].name, name,
           s->settings != NULL ? s->settings : "", (unsigned long long)hash);
    return 0;
}

int main(int argc, char **argv)
{
    const int threads = argc > 1 ? atoi(argv[1]) : 1;
    int failed = 0;
    for (int profile = 0; profile < pl_engine_plumb()->profile_count; ++profile) {
        for (size_t i = 0; i < sizeof samples / sizeof *samples; ++i) {
            failed |= run(&samples[i], profile, threads);
        }
    }
    return failed;
}
