/* my_engine for Plumb: the adapter between Plumb and an engine, in C99 and C++20. This file is yours
 * to change.
 *
 * The engine is sphere_world, a toy. To plug in your own, replace everything that begins with sw_ by
 * calls to your library, from the top to the bottom, and delete sphere_world.h and sphere_world.c.
 * plumb/engine_abi.h says what each function must do and which conventions hold, and
 * `plumb check-engine ./my_engine.so` tests it. */
#include "sphere_world.h"

#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <stdlib.h>
#include <string.h>

/* ---- Options and profiles ----
 *
 * `--engine ./my_engine.so:PROFILE,OPTION=VALUE` chooses them. List the settings that your users
 * tune. `iterations` is varied by name in studies. The fields from `code` on are for `plumb tune`:
 * how a program sets the option, the profiles in which it is tuned, and the range that is searched. */

enum { OPTION_ITERATIONS, OPTION_COUNT };

static const pl_engine_option OPTIONS[OPTION_COUNT] = {
    {"iterations", 200, 1, 1e6, true, "1", "sweeps of the solver in one step, at most",
     "world->max_iterations = {};", 1u << 0, 1, 1000, true},
};

static const pl_engine_profile PROFILES[] = {
    {"default", "sequential impulses", true, "sw_step(world, {});"},
};

/* ---- Conversions: from the types and conventions of Plumb to yours, and back ---- */

static sw_vec to_vec(const double v[3])
{
    const sw_vec made = {v[0], v[1], v[2]};
    return made;
}

static void from_vec(sw_vec v, double out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

/* Plumb's quaternions are (w, x, y, z), from the body to the world. */
static sw_quat to_quat(const double q[4])
{
    const sw_quat made = {q[1], q[2], q[3], q[0]};
    return made;
}

static void from_quat(sw_quat q, double out[4])
{
    out[0] = q.w;
    out[1] = q.x;
    out[2] = q.y;
    out[3] = q.z;
}

/* ---- Create and destroy: a scene becomes a world of your engine ---- */

/* All that belongs to one scene. sw_world numbers bodies as the scene does. If yours has handles
 * or pointers instead, keep them here, in an array by the index in the scene. */
struct pl_engine_instance {
    const pl_engine_setup *setup; /* outlives the instance */
    sw_world *world;
    double time; /* s */
};

/* Friction and restitution are given for each pair of bodies. No rule that mixes two materials gives
 * all pairs that scenes use. */
static sw_pair pair_of(const void *setup, int body_a, int body_b)
{
    const pl_pair_coefficients given =
        pl_setup_pair((const pl_engine_setup *)setup, body_a, body_b);
    const sw_pair pair = {given.friction, given.restitution};
    return pair;
}

/* Returns false for what the engine cannot simulate. The pose in the scene is that of the shape's
 * frame. Here that is the centre of mass, as for all shapes but hulls and meshes, for which
 * adapter_helpers.h has pl_to_principal_pose. */
static bool add_body(sw_world *world, const pl_body *from)
{
    const double *inertia = from->inertia;
    const bool is_round = inertia[0] == inertia[1] && inertia[0] == inertia[2];
    if (from->shape.kind == PL_SHAPE_PLANE) {
        sw_add_plane(world, to_vec(from->shape.normal), from->shape.offset);
        return true;
    }
    if (from->shape.kind != PL_SHAPE_SPHERE || !(from->is_static || is_round)) {
        return false;
    }
    sw_body sphere;
    memset(&sphere, 0, sizeof sphere);
    sphere.radius = from->shape.radius;
    sphere.position = to_vec(from->position);
    sphere.orientation = to_quat(from->orientation);
    if (!from->is_static) {
        sphere.mass = from->mass;
        sphere.inertia = inertia[0];
        sphere.velocity = to_vec(from->velocity);
        sphere.angular_velocity = to_vec(from->angular_velocity);
    }
    sw_add_sphere(world, &sphere);
    return true;
}

static void destroy(pl_engine_instance *instance)
{
    if (instance != NULL) {
        sw_destroy(instance->world);
        free(instance);
    }
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    pl_engine_instance *made = (pl_engine_instance *)calloc(1, sizeof *made);
    if (made != NULL) {
        made->setup = setup;
        made->world = sw_create(scene->body_count, to_vec(scene->gravity),
                                (int)setup->values[OPTION_ITERATIONS], pair_of, setup);
    }
    if (made == NULL || made->world == NULL) {
        destroy(made);
        return pl_engine_error(error, PL_NO_MEMORY, "no memory for the scene");
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (!add_body(made->world, &scene->bodies[i])) {
            destroy(made);
            return pl_engine_error(error, PL_UNSUPPORTED,
                                   "it has only planes, and spheres with equal moments of inertia");
        }
    }
    *instance = made;
    return PL_OK;
}

/* ---- The step: forces of the scene, then one step of your engine of exactly dt ---- */

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    const pl_scene *scene = instance->setup->scene;
    sw_world *world = instance->world;
    for (int i = 0; i < scene->force_count; ++i) {
        const int body = scene->forces[i].body;
        double orientation[4], force[3], arm[3];
        from_quat(world->bodies[body].orientation, orientation);
        if (pl_force_at(&scene->forces[i], instance->time, dt, orientation, force, arm)) {
            sw_apply_force(world, body, to_vec(force), to_vec(arm));
        }
    }
    if (!sw_step(world, dt)) {
        return pl_engine_error(error, PL_NO_MEMORY, "no memory for the contacts");
    }
    instance->time += dt;
    /* Leave NAN what your engine does not know. */
    stats->contacts = world->contact_count;
    stats->iterations = world->iterations;
    stats->residual = world->residual;
    return PL_OK;
}

/* ---- Reading: what your engine says, in the scene's order and conventions ---- */

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        const sw_body *from = &instance->world->bodies[i];
        pl_body_state *to = &frame->bodies[i];
        from_vec(from->position, to->position);
        from_quat(from->orientation, to->orientation);
        from_vec(from->velocity, to->velocity);
        from_vec(from->angular_velocity, to->angular_velocity);
    }
}

/* Ask your engine's own objects, not the scene: what they say is compared with the scene. */
static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    const sw_world *world = instance->world;
    from_vec(world->gravity, settings->gravity);
    settings->dt = instance->setup->dt; /* sw_step takes any */
    settings->linear_damping = 0;       /* it has none */
    settings->angular_damping = 0;
    for (int i = 0; i < settings->body_count; ++i) {
        settings->mass[i] = world->bodies[i].mass;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = world->bodies[i].inertia;
        }
    }
}

static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    const sw_world *world = instance->world;
    for (int i = 0; i < world->contact_count && i < capacity; ++i) {
        const sw_contact *from = &world->contacts[i];
        contacts[i].body_a = from->body_a;
        contacts[i].body_b = from->body_b;
        from_vec(from->point, contacts[i].point);
        from_vec(from->normal, contacts[i].normal);
        contacts[i].separation = from->separation;
        from_vec(from->impulse, contacts[i].impulse);
    }
    return world->contact_count;
}

/* ---- The engine: claim only what works ---- */

static const pl_engine ENGINE = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "my_engine",
    .version = "0.1",
    .description = "spheres and half-spaces, by sequential impulses",
    .residual_unit = "m/s",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES |
                    PL_NEEDS_PLANE | PL_NEEDS_SPHERE,
    .contacts = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES,
    .precision = PL_PRECISION_DOUBLE,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .gyroscopic = PL_GYROSCOPIC_NONE, /* the only bodies that it has need none */
    .substeps = 1,
    .profiles = PROFILES,
    .profile_count = sizeof PROFILES / sizeof PROFILES[0],
    .options = OPTIONS,
    .option_count = OPTION_COUNT,
    .profile_defaults = NULL, /* no profile has defaults of its own */
    .create = create,
    .destroy = destroy,
    .step = step,
    .read_frame = read_frame,
    .read_settings = read_settings,
    .read_pair = NULL, /* it stores no coefficients, but asks pair_of */
    .read_contacts = read_contacts,
    .extension = NULL,
    .sources = NULL, /* why a profile has its values: documents of the engine's authors */
    .source_count = 0,
    .runtime = NULL, /* native */
};

/* The one symbol that the harness looks up. */
#ifdef __cplusplus
extern "C"
#endif
    const pl_engine *
    plumb_engine(void)
{
    return &ENGINE;
}
