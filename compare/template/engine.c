/* my_engine for Plumb: an adapter around a small engine of spheres and half-spaces, in C99 and C++20.
 *
 * It works as it is. To plug in an engine of your own, keep the adapter, and replace what is marked
 * "YOUR ENGINE" by calls to your library. plumb/engine_abi.h says what each function must do and
 * which conventions hold, and `plumb check-engine ./my_engine.so` tests it. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <math.h>
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
     "world.iterations = {};", 1u << 0, 1, 1000, true},
};

static const pl_engine_profile PROFILES[] = {
    {"default", "sequential impulses", true, "world_step(world, {});"},
};

/* ---- YOUR ENGINE: its world, bodies and contacts ---- */

/* A body. The inverses are 0 for a static one. */
typedef struct body {
    pl_body_state state;
    double velocity_before[3];  /* m/s, at the beginning of the step */
    double inverse_mass;        /* 1/kg */
    double inverse_inertia[3];  /* 1/(kg m^2), along the axes of the body */
    double max_inverse_inertia; /* the largest of the three */
} body;

/* A contact of the step. The impulse so far stands in `shared`, its normal part also apart. */
typedef struct contact {
    pl_contact shared;
    double arm_a[3], arm_b[3];        /* m, from the centres of mass to the point */
    double normal_impulse;            /* N s */
    double normal_mass, tangent_mass; /* kg: impulse for a change of velocity of 1 m/s */
    double friction;
    bool bounces;
    double target; /* m/s: the least normal velocity at the end of the step */
} contact;

struct pl_engine_instance {
    const pl_engine_setup *setup; /* outlives the instance */
    body *bodies;                 /* (body_count), in the scene's order */
    contact *contacts;            /* (contact_count) of the last step */
    int contact_count, contact_capacity;
    int iterations;
    double time; /* s */
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* sum += s v */
static void add(double sum[3], double s, const double v[3])
{
    for (int k = 0; k < 3; ++k) {
        sum[k] += s * v[k];
    }
}

/* Sets angular_velocity to I^-1 momentum, both in world axes. */
static void angular_velocity_of(const body *b, const double momentum[3], double angular_velocity[3])
{
    double local[3];
    pl_rotate_to_body(b->state.orientation, momentum, local);
    for (int k = 0; k < 3; ++k) {
        local[k] *= b->inverse_inertia[k];
    }
    pl_rotate_to_world(b->state.orientation, local, angular_velocity);
}

/* Applies s times an impulse (N s) at a point that is `arm` away from the centre of mass. */
static void push(body *b, double s, const double impulse[3], const double arm[3])
{
    double moment[3], turned[3];
    cross(arm, impulse, moment);
    angular_velocity_of(b, moment, turned);
    add(b->state.velocity, s * b->inverse_mass, impulse);
    add(b->state.angular_velocity, s, turned);
}

/* ---- Create and destroy: the scene becomes a world of your engine ---- */

static void destroy(pl_engine_instance *instance)
{
    if (instance != NULL) {
        free(instance->bodies);
        free(instance->contacts);
        free(instance);
    }
}

/* A pose in the scene is that of the shape's frame. Here that is the centre of mass, as for all
 * shapes but hulls and meshes, for which adapter_helpers.h has pl_to_principal_pose. */
static void make_body(const pl_body *from, body *to)
{
    memcpy(to->state.position, from->position, sizeof from->position);
    memcpy(to->state.orientation, from->orientation, sizeof from->orientation);
    if (!from->is_static) {
        memcpy(to->state.velocity, from->velocity, sizeof from->velocity);
        memcpy(to->state.angular_velocity, from->angular_velocity, sizeof from->angular_velocity);
        to->inverse_mass = 1 / from->mass;
        for (int k = 0; k < 3; ++k) {
            to->inverse_inertia[k] = 1 / from->inertia[k];
            to->max_inverse_inertia = fmax(to->max_inverse_inertia, to->inverse_inertia[k]);
        }
    }
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape_kind kind = scene->bodies[i].shape.kind;
        if (kind != PL_SHAPE_SPHERE && kind != PL_SHAPE_PLANE) {
            return pl_engine_error(error, PL_UNSUPPORTED, "it has only spheres and planes");
        }
    }
    pl_engine_instance *made = (pl_engine_instance *)calloc(1, sizeof *made);
    if (made != NULL) {
        made->bodies = (body *)calloc((size_t)scene->body_count + 1, sizeof *made->bodies);
    }
    if (made == NULL || made->bodies == NULL) {
        destroy(made);
        return pl_engine_error(error, PL_NO_MEMORY, "no memory for the scene");
    }
    made->setup = setup;
    made->iterations = (int)setup->values[OPTION_ITERATIONS];
    for (int i = 0; i < scene->body_count; ++i) {
        make_body(&scene->bodies[i], &made->bodies[i]);
    }
    *instance = made;
    return PL_OK;
}

/* ---- YOUR ENGINE: collision detection ---- */

/* Finds the normal, point and separation of bodies A, a plane or a sphere, and B, a sphere. */
static void measure(const pl_engine_instance *instance, pl_contact *c)
{
    const pl_shape *a = &instance->setup->scene->bodies[c->body_a].shape;
    const double radius = instance->setup->scene->bodies[c->body_b].shape.radius;
    const double *centre_a = instance->bodies[c->body_a].state.position;
    const double *centre_b = instance->bodies[c->body_b].state.position;
    if (a->kind == PL_SHAPE_PLANE) {
        memcpy(c->normal, a->normal, sizeof c->normal);
        c->separation = dot(a->normal, centre_b) - a->offset - radius;
        memcpy(c->point, centre_b, sizeof c->point);
        add(c->point, -radius, c->normal);
        return;
    }
    double apart[3] = {centre_b[0], centre_b[1], centre_b[2]};
    add(apart, -1, centre_a);
    const double distance = sqrt(dot(apart, apart));
    for (int k = 0; k < 3; ++k) {
        c->normal[k] = distance > 0 ? apart[k] / distance : k == 2;
    }
    c->separation = distance - a->radius - radius;
    memcpy(c->point, centre_a, sizeof c->point);
    add(c->point, a->radius + c->separation / 2, c->normal);
}

/* Adds the contact of two bodies if they touch, or would by the end of the step. A bounce is taken at
 * the frame that is nearer to the impact. */
static bool collide(pl_engine_instance *instance, int body_a, int body_b, double dt)
{
    const pl_body *bodies = instance->setup->scene->bodies;
    const bool swap = bodies[body_b].shape.kind == PL_SHAPE_PLANE;
    contact c;
    memset(&c, 0, sizeof c);
    c.shared.body_a = swap ? body_b : body_a;
    c.shared.body_b = swap ? body_a : body_b;
    const body *a = &instance->bodies[c.shared.body_a], *b = &instance->bodies[c.shared.body_b];
    if (a->inverse_mass + b->inverse_mass <= 0) {
        return true;
    }
    measure(instance, &c.shared);
    const double *n = c.shared.normal;
    const double before = dot(n, b->velocity_before) - dot(n, a->velocity_before);
    const double path = dt * (dot(n, b->state.velocity) - dot(n, a->state.velocity));
    const pl_pair_coefficients pair = pl_setup_pair(instance->setup, body_a, body_b);
    const bool bounces = pair.restitution > 0 && before < 0;
    if (c.shared.separation > 0 && c.shared.separation + (bounces ? path / 2 : path) > 0) {
        return true;
    }
    c.friction = pair.friction;
    c.bounces = bounces;
    /* An impact returns the velocity of before the step, without what gravity adds in it: a body at
     * rest does not begin to bounce. Without an impact a gap may close, but no further. */
    c.target = bounces ? -pair.restitution * before : -fmax(c.shared.separation, 0) / dt;
    memcpy(c.arm_a, c.shared.point, sizeof c.arm_a);
    memcpy(c.arm_b, c.shared.point, sizeof c.arm_b);
    add(c.arm_a, -1, a->state.position);
    add(c.arm_b, -1, b->state.position);
    c.normal_mass = 1 / (a->inverse_mass + b->inverse_mass);
    c.tangent_mass =
        1 / (a->inverse_mass + b->inverse_mass + a->max_inverse_inertia * dot(c.arm_a, c.arm_a) +
             b->max_inverse_inertia * dot(c.arm_b, c.arm_b));
    if (instance->contact_count == instance->contact_capacity) {
        const int capacity = 2 * instance->contact_capacity + 16;
        contact *larger = (contact *)realloc(instance->contacts, (size_t)capacity * sizeof *larger);
        if (larger == NULL) {
            return false;
        }
        instance->contacts = larger;
        instance->contact_capacity = capacity;
    }
    instance->contacts[instance->contact_count++] = c;
    return true;
}

/* ---- YOUR ENGINE: the solver ---- */

/* Corrects the impulse of one contact. Returns by how much it changed the velocity, m/s. */
static double solve(pl_engine_instance *instance, contact *c)
{
    body *a = &instance->bodies[c->shared.body_a], *b = &instance->bodies[c->shared.body_b];
    const double *n = c->shared.normal;
    double velocity[3], turning[3], tangential[3], change[3];
    cross(b->state.angular_velocity, c->arm_b, velocity);
    add(velocity, 1, b->state.velocity);
    cross(a->state.angular_velocity, c->arm_a, turning);
    add(velocity, -1, a->state.velocity);
    add(velocity, -1, turning);

    const double normal_velocity = dot(n, velocity), old = c->normal_impulse;
    c->normal_impulse = fmax(0, old + c->normal_mass * (c->target - normal_velocity));
    /* Coulomb's law: the friction that would stop the sliding, but at most mu times the normal. */
    memcpy(tangential, c->shared.impulse, sizeof tangential);
    add(tangential, -old, n);
    add(tangential, -c->tangent_mass, velocity);
    add(tangential, c->tangent_mass * normal_velocity, n);
    const double size = sqrt(dot(tangential, tangential));
    const double most = c->friction * c->normal_impulse;
    const double scale = size > most ? most / size : 1;
    for (int k = 0; k < 3; ++k) {
        const double impulse = c->normal_impulse * n[k] + scale * tangential[k];
        change[k] = impulse - c->shared.impulse[k];
        c->shared.impulse[k] = impulse;
    }
    push(a, -1, change, c->arm_a);
    push(b, 1, change, c->arm_b);
    return sqrt(dot(change, change)) / c->normal_mass;
}

/* ---- YOUR ENGINE: motion ---- */

/* Turns an orientation by the rotation vector angular_velocity dt, which is in world axes. */
static void turn(double orientation[4], const double angular_velocity[3], double dt)
{
    const double angle = dt * sqrt(dot(angular_velocity, angular_velocity));
    if (angle > 0) {
        const double s = sin(angle / 2) * dt / angle;
        const double by[4] = {cos(angle / 2), s * angular_velocity[0], s * angular_velocity[1],
                              s * angular_velocity[2]};
        pl_quaternion_product(by, orientation, orientation);
        double norm = 0;
        for (int k = 0; k < 4; ++k) {
            norm += orientation[k] * orientation[k];
        }
        for (int k = 0; k < 4; ++k) {
            orientation[k] /= sqrt(norm);
        }
    }
}

/* Moves a body by its velocities, and turns it by the midpoint rule, which keeps its angular
 * momentum: that is the gyroscopic torque of a body whose moments of inertia differ. */
static void move(body *b, double dt)
{
    double momentum[3], start[4], middle[3], *w = b->state.angular_velocity;
    add(b->state.position, dt, b->state.velocity);
    memcpy(start, b->state.orientation, sizeof start);
    pl_rotate_to_body(start, w, momentum);
    for (int k = 0; k < 3; ++k) {
        momentum[k] /= b->inverse_inertia[k];
    }
    pl_rotate_to_world(start, momentum, momentum);
    turn(b->state.orientation, w, dt / 2);
    angular_velocity_of(b, momentum, middle);
    memcpy(b->state.orientation, start, sizeof start);
    turn(b->state.orientation, middle, dt);
    angular_velocity_of(b, momentum, w);
}

/* ---- The step: forces of the scene, then one step of your engine ---- */

static void add_forces(pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->setup->scene;
    for (int i = 0; i < scene->body_count; ++i) {
        body *b = &instance->bodies[i];
        memcpy(b->velocity_before, b->state.velocity, sizeof b->velocity_before);
        add(b->state.velocity, b->inverse_mass > 0 ? dt : 0, scene->gravity);
    }
    for (int i = 0; i < scene->force_count; ++i) {
        body *b = &instance->bodies[scene->forces[i].body];
        double force[3], arm[3];
        if (pl_force_at(&scene->forces[i], instance->time, dt, b->state.orientation, force, arm)) {
            push(b, dt, force, arm);
        }
    }
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    const int count = instance->setup->scene->body_count;
    add_forces(instance, dt);
    instance->contact_count = 0;
    for (int a = 0; a < count; ++a) {
        for (int b = a + 1; b < count; ++b) {
            if (!collide(instance, a, b, dt)) {
                return pl_engine_error(error, PL_NO_MEMORY, "no memory for the contacts");
            }
        }
    }
    double residual = instance->contact_count > 0 ? INFINITY : 0;
    int iterations = 0;
    for (; iterations < instance->iterations && residual > 1e-13; ++iterations) {
        residual = 0;
        for (int i = 0; i < instance->contact_count; ++i) {
            residual = fmax(residual, solve(instance, &instance->contacts[i]));
        }
    }
    for (int i = 0; i < count; ++i) {
        if (instance->bodies[i].inverse_mass > 0) {
            move(&instance->bodies[i], dt);
        }
    }
    /* Bodies that overlapped are pushed apart a little, without a change of velocity. A bounce parts
     * them by itself. */
    for (int i = 0; i < instance->contact_count; ++i) {
        const contact *c = &instance->contacts[i];
        body *a = &instance->bodies[c->shared.body_a], *b = &instance->bodies[c->shared.body_b];
        const double depth =
            (c->bounces ? 0 : 0.2) * fmax(0, -c->shared.separation) * c->normal_mass;
        add(a->state.position, -depth * a->inverse_mass, c->shared.normal);
        add(b->state.position, depth * b->inverse_mass, c->shared.normal);
    }
    instance->time += dt;
    /* Leave NAN what your engine does not know. */
    stats->contacts = instance->contact_count;
    stats->iterations = iterations;
    stats->residual = residual;
    return PL_OK;
}

/* ---- Reading: what your engine says, in the scene's order and conventions ---- */

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        frame->bodies[i] = instance->bodies[i].state;
    }
}

/* Ask your engine's own objects, not the scene: that is what this check is for. */
static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    memcpy(settings->gravity, instance->setup->scene->gravity, sizeof settings->gravity);
    settings->dt = instance->setup->dt;
    settings->linear_damping = 0;
    settings->angular_damping = 0;
    for (int i = 0; i < settings->body_count; ++i) {
        const body *b = &instance->bodies[i];
        settings->mass[i] = b->inverse_mass > 0 ? 1 / b->inverse_mass : 0;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = b->inverse_mass > 0 ? 1 / b->inverse_inertia[k] : 0;
        }
    }
}

static void read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    *found = pl_setup_pair(instance->setup, body_a, body_b);
}

static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    for (int i = 0; i < instance->contact_count && i < capacity; ++i) {
        contacts[i] = instance->contacts[i].shared;
    }
    return instance->contact_count;
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
    .gyroscopic = PL_GYROSCOPIC_IMPLICIT,
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
    .read_pair = read_pair,
    .read_contacts = read_contacts,
    .extension = NULL,
};

/* The one symbol that the harness looks up. */
#ifdef __cplusplus
extern "C" const pl_engine *plumb_engine(void);
#else
const pl_engine *plumb_engine(void);
#endif

const pl_engine *plumb_engine(void)
{
    return &ENGINE;
}
