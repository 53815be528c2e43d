/* An engine of the loadable ABI in which bodies move on without forces and contacts, a profile a fault that
 * depends on the form of what they pass, or on the time of the first step. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum fault { FAULT_NONE, FAULT_SEAM, FAULT_EDGE, FAULT_GRID } fault;

static const pl_engine_profile profiles[] = {
    [FAULT_NONE] = {.name = "good", .help = "nothing is wrong"},
    [FAULT_SEAM] = {.name = "seam", .help = "halves the speed over an end of a static box"},
    [FAULT_EDGE] = {.name = "edge", .help = "halves the speed over a vertex of a static mesh"},
    [FAULT_GRID] = {.name = "grid", .help = "starts bodies at multiples of 1 cm"},
};

struct pl_engine_instance {
    const pl_engine_setup *setup;
    fault fault;
    pl_body_state states[];
};

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const size_t count = (size_t)scene->body_count;
    pl_engine_instance *made = calloc(1, sizeof *made + count * sizeof made->states[0]);
    if (made == NULL) {
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory");
    }
    made->setup = setup;
    made->fault = (fault)setup->profile;
    for (size_t i = 0; i < count; ++i) {
        pl_initial_state(&scene->bodies[i], &made->states[i]);
        if (made->fault == FAULT_GRID && !scene->bodies[i].is_static) {
            made->states[i].position[0] = round(100 * made->states[i].position[0]) / 100;
        }
    }
    *instance = made;
    return PL_OK;
}

static void destroy(pl_engine_instance *instance)
{
    free(instance);
}

static bool is_between(double x, double a, double b)
{
    return x > a && x <= b;
}

/* Whether a static body has an end of a box, or a vertex of a mesh, strictly between its own ends or at
 * them, from x = a to b. */
static bool has_fault_between(const pl_engine_instance *e, const pl_body *body, double a, double b)
{
    const pl_shape *shape = &body->shape;
    bool found = false;
    if (e->fault == FAULT_SEAM && shape->kind == PL_SHAPE_BOX) {
        found = is_between(body->position[0] - shape->half_extents[0], a, b) ||
                is_between(body->position[0] + shape->half_extents[0], a, b);
    }
    for (int i = 0; e->fault == FAULT_EDGE && shape->kind == PL_SHAPE_MESH &&
                    i < shape->polyhedron->vertex_count;
         ++i) {
        found = found || is_between(body->position[0] + shape->polyhedron->vertices[i][0], a, b);
    }
    return body->is_static && found;
}

static pl_status step(pl_engine_instance *e, double dt, pl_step_stats *stats, pl_error *error)
{
    const pl_scene *scene = e->setup->scene;
    (void)stats;
    (void)error;
    for (int i = 0; i < scene->body_count; ++i) {
        pl_body_state *state = &e->states[i];
        const double before = state->position[0];
        bool trips = false;
        for (int k = 0; k < 3 && !scene->bodies[i].is_static; ++k) {
            state->position[k] += dt * state->velocity[k];
        }
        for (int k = 0; k < scene->body_count; ++k) {
            trips = trips || has_fault_between(e, &scene->bodies[k], before, state->position[0]);
        }
        state->velocity[0] *= trips ? 0.5 : 1;
    }
    return PL_OK;
}

static void read_frame(const pl_engine_instance *e, pl_frame *frame)
{
    memcpy(frame->bodies, e->states, (size_t)e->setup->scene->body_count * sizeof frame->bodies[0]);
}

static void read_settings(const pl_engine_instance *e, pl_engine_settings *settings)
{
    const pl_scene *scene = e->setup->scene;
    memcpy(settings->gravity, scene->gravity, sizeof settings->gravity);
    settings->dt = e->setup->dt;
    for (int i = 0; i < scene->body_count; ++i) {
        settings->mass[i] = scene->bodies[i].mass;
        memcpy(settings->inertia[i], scene->bodies[i].inertia, sizeof settings->inertia[i]);
    }
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "seam",
    .version = "1",
    .description = "uniform motion, and one fault a profile",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_SPHERE |
                    PL_NEEDS_BOX | PL_NEEDS_MESH,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = sizeof profiles / sizeof profiles[0],
    .create = create,
    .destroy = destroy,
    .step = step,
    .read_frame = read_frame,
    .read_settings = read_settings,
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    return &engine;
}
