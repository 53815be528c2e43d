/* An engine of the loadable ABI that never moves a body, whatever acts on it. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <stdlib.h>
#include <string.h>

enum { STILL, KEPT }; /* as the option's values */

static const pl_engine_profile profiles[] = {
    [STILL] = {.name = "still", .help = "every velocity is read as 0"},
    [KEPT] = {.name = "kept", .help = "every velocity is read as it was at the start"},
};

static const pl_engine_option options[] = {
    {.name = "kept", .min = 0, .max = 1, .integer = true, .unit = "1", .help = "1: as kept"}};

struct pl_engine_instance {
    int body_count;
    pl_body_state states[];
};

static void profile_defaults(int profile, double *values)
{
    values[0] = profile;
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const size_t count = (size_t)scene->body_count;
    pl_engine_instance *made = calloc(1, sizeof *made + count * sizeof made->states[0]);
    if (made == NULL) {
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory");
    }
    made->body_count = scene->body_count;
    for (size_t i = 0; i < count; ++i) {
        pl_initial_state(&scene->bodies[i], &made->states[i]);
        if (setup->values[0] == STILL) {
            memset(made->states[i].velocity, 0, sizeof made->states[i].velocity);
            memset(made->states[i].angular_velocity, 0, sizeof made->states[i].angular_velocity);
        }
    }
    *instance = made;
    return PL_OK;
}

static void destroy(pl_engine_instance *instance)
{
    free(instance);
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    (void)instance;
    (void)dt;
    (void)stats;
    (void)error;
    return PL_OK;
}

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    memcpy(frame->bodies, instance->states, (size_t)instance->body_count * sizeof frame->bodies[0]);
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "frozen",
    .version = "1",
    .description = "nothing moves",
    .capabilities = UINT32_MAX,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = 2,
    .options = options,
    .option_count = 1,
    .profile_defaults = profile_defaults,
    .create = create,
    .destroy = destroy,
    .step = step,
    .read_frame = read_frame,
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    return &engine;
}
