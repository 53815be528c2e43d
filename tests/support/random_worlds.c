/* What random worlds are made of, and whether the laws of their steps hold. */
#include "random_worlds.h"

#include "model/world.h"
#include "random_pose.h"
#include "solid_forms.h"
#include "step_laws.h"
#include "world_for_tests.h"

#include <stdio.h>

enum { MOST_BODIES = 10, STEPS = 3, MOST_PRINTED = 10 };

/* Of its energy that a world may gain. */
static const double GAIN = 0.02;

/* A world and what is known of it. */
typedef struct trial {
    uint64_t seed;
    pe_profile profile;
    pe_world *world;
    double dt;
    pe_vec3 gravity;
    int count;
    pe_body_id ids[MOST_BODIES];
    pe_body_def defs[MOST_BODIES]; /* as created */
    pe_body_state before[MOST_BODIES], after[MOST_BODIES];
    bool printed;
} trial;

/* ---- Worlds ---- */

static bool happens(check_random *random, double probability)
{
    return check_uniform(random, 0, 1) < probability;
}

static double log_uniform(check_random *random, double low, double high)
{
    return low * exp(check_uniform(random, 0, log(high / low)));
}

static form random_form(check_random *random, bool convex)
{
    form f = convex && happens(random, 0.5) ? form_random_hull(random, 12)
             : convex                       ? form_frustum(6, check_uniform(random, 0.2, 1), 0)
             : happens(random, 0.5)         ? form_l_shape()
                                            : form_torus(1, 0.4, 7, 5);
    double size = log_uniform(random, 0.05, 0.7);
    form_scale(&f, pe_v3(size * check_uniform(random, 0.2, 1), size, size));
    return f;
}

static pe_geometry_id random_geometry(trial *t, check_random *random, bool convex)
{
    form f = random_form(random, convex);
    pe_geometry_id id;
    pe_error error;
    const pe_geometry_def def = {.vertices = f.vertices,
                                 .triangles = (const uint32_t(*)[3])f.triangles,
                                 .vertex_count = f.vertex_count,
                                 .triangle_count = f.triangle_count,
                                 .convex = convex};
    if (pe_geometry_create(t->world, &def, &id, &error) != PE_OK) {
        fail_msg("seed %llu: %s", (unsigned long long)t->seed, error.message);
    }
    return id;
}

static pe_shape random_shape(trial *t, check_random *random)
{
    double a = log_uniform(random, 0.05, 1), b = a * log_uniform(random, 0.05, 1),
           c = a * log_uniform(random, 0.2, 1);
    pe_shape s = {.kind = (pe_shape_kind)check_uniform(random, 1, PE_SHAPE_COUNT)};
    switch (s.kind) {
    case PE_SHAPE_SPHERE:
        s.radius = a;
        break;
    case PE_SHAPE_CAPSULE:
    case PE_SHAPE_CYLINDER:
        s.radius = happens(random, 0.5) ? a : b;
        s.half_height = s.radius == a ? b : a;
        break;
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        s.geometry = random_geometry(t, random, s.kind == PE_SHAPE_HULL);
        break;
    default:
        s.half_extents = pe_v3(a, c, b);
    }
    return s;
}

/* A plane of a box about the origin, or in any place. */
static pe_body_def random_plane(check_random *random, int i, double room)
{
    pe_vec3 normal = {0, 0, 0};
    double sign = i % 2 == 0 ? 1 : -1;
    normal.z = i / 2 == 0 ? sign : 0, normal.x = i / 2 == 1 ? sign : 0;
    normal.y = i / 2 == 2 ? sign : 0;
    if (happens(random, 0.2)) {
        double q[4];
        check_quaternion(random, q);
        pe_mat3 r = pe_matrix_of((pe_quat){q[0], q[1], q[2], q[3]});
        normal = pe_axis(&r, 2);
    }
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = normal, .offset = -0.5 * room};
    def.is_static = true;
    return def;
}

static pe_body_def random_body(trial *t, check_random *random, double reach, double fixed)
{
    pe_body_def def = pe_body_def_default();
    def.shape = random_shape(t, random);
    def.is_static = happens(random, fixed);
    def.mass = log_uniform(random, 1e-2, 1e2);
    def.position = random_vector(random, reach);
    if (happens(random, 0.6)) {
        def.orientation = random_turn(random);
    }
    if (happens(random, 0.5)) {
        def.velocity = random_vector(random, log_uniform(random, 0.1, 20));
        def.angular_velocity = random_vector(random, log_uniform(random, 0.1, 10));
    }
    return def;
}

static trial make_trial(uint64_t seed, pe_profile profile)
{
    check_random random = {seed * 0x9e3779b97f4a7c15u | 1};
    for (int i = 0; i < 8; ++i) {
        check_uniform(&random, 0, 1);
    }
    trial t = {.seed = seed, .profile = profile, .gravity = {0, 0, -9.81}};
    pe_world_def def = pe_world_def_default();
    def.profile = profile;
    if (happens(&random, 0.2)) {
        t.gravity.z = 0;
    }
    def.gravity = t.gravity;
    t.world = make_world(&def);
    t.dt = happens(&random, 0.7) ? 1.0 / 60 : log_uniform(&random, 1e-3, 0.1);
    double many = check_uniform(&random, 0, 1);
    t.count = 1 + (int)(MOST_BODIES * many * sqrt(many));
    int planes = (int)check_uniform(&random, 0, 3);
    planes = happens(&random, 0.2) ? (int)check_uniform(&random, 0, 7) : planes;
    planes = planes < t.count ? planes : t.count - 1;
    double room = check_uniform(&random, 0, 3), reach = log_uniform(&random, 0.01, 1.5);
    double fixed = happens(&random, 0.5) ? check_uniform(&random, 0, 0.7) : 0;
    double bouncing = happens(&random, 0.5);
    for (int i = 0; i < t.count; ++i) {
        double restitution = bouncing > 0 ? check_uniform(&random, 0, 1) : 0;
        pe_material_id material = add_material(t.world, check_uniform(&random, 0, 1), restitution);
        t.defs[i] =
            i < planes ? random_plane(&random, i, room) : random_body(&t, &random, reach, fixed);
        t.defs[i].material = material;
        t.ids[i] = add_body(t.world, &t.defs[i]);
    }
    return t;
}

/* ---- Laws ---- */

static void print_vector(const char *name, pe_vec3 v)
{
    printf(" %s (%.9g, %.9g, %.9g)", name, v.x, v.y, v.z);
}

static void print_world(const trial *t)
{
    for (int i = 0; i < t->count; ++i) {
        const pe_body_def *d = &t->defs[i];
        const pe_body_state *s = &t->before[i];
        printf("    body %d: kind %d%s, %g kg, least extent %g,", i, (int)d->shape.kind,
               d->is_static ? ", static" : "", d->mass,
               2 * pe_bodies(t->world)[t->ids[i].index].size);
        print_vector("normal", d->shape.normal);
        printf(" offset %g radius %g half height %g", d->shape.offset, d->shape.radius,
               d->shape.half_height);
        print_vector("half extents", d->shape.half_extents);
        print_vector("\n       at", s->position);
        printf(" orientation (%.9g, %.9g, %.9g, %.9g)", s->orientation.w, s->orientation.x,
               s->orientation.y, s->orientation.z);
        print_vector("velocity", s->velocity);
        print_vector("spin", s->angular_velocity);
        printf("\n");
    }
}

/* Prints what was found, and the world the first time. */
static void report(trial *t, int step, int body, const char *what, double found)
{
    static int printed;
    if (!t->printed && printed++ < MOST_PRINTED) {
        printf("  seed %llu, profile %d, dt %.9g s, gravity %g, step %d, body %d: %s %.4g\n",
               (unsigned long long)t->seed, (int)t->profile, t->dt, t->gravity.z, step, body, what,
               found);
        print_world(t);
        t->printed = true;
    }
}

/* The law of a body's motion. */
static void check_motion(trial *t, int step, int i, random_worlds_found *w, bool *far)
{
    unexplained_motion found = unexplained_motion_of(t->world, t->ids[i], &t->before[i],
                                                     &t->after[i], t->dt, pe_length(t->gravity));
    w->moved = pe_max(w->moved, found.moved);
    w->rotated = pe_max(w->rotated, found.rotated);
    if (found.moved > MOST_UNEXPLAINED || found.rotated > MOST_UNEXPLAINED) {
        report(t, step, i, found.moved > MOST_UNEXPLAINED ? "moved by" : "rotated by",
               pe_max(found.moved, found.rotated));
        *far = true;
    }
}

/* Kinetic energy gained beyond the work of gravity on the bodies that fall, in units of both. */
static double gain_of(const trial *t)
{
    double before = 0, after = 0, work = 0;
    for (int i = 0; i < t->count; ++i) {
        if (!t->defs[i].is_static) {
            before += kinetic_energy_of(t->world, t->ids[i], &t->before[i]);
            after += kinetic_energy_of(t->world, t->ids[i], &t->after[i]);
            pe_vec3 d = pe_sub(centre_of(t->world, t->ids[i], &t->after[i]),
                               centre_of(t->world, t->ids[i], &t->before[i]));
            work += pe_max(0, t->defs[i].mass * pe_dot(t->gravity, d));
        }
    }
    return after > 0 ? (after - before - work) / (before + work + 1e-9) : 0;
}

static void read_states(const trial *t, pe_body_state *states)
{
    for (int i = 0; i < t->count; ++i) {
        states[i] = state_of(t->world, t->ids[i]);
    }
}

static void run_trial(trial *t, random_worlds_found *w)
{
    bool far = false, finite = true, gained = false, failed = false, unparted = false;
    for (int step = 0; step < STEPS && finite && !failed; ++step) {
        pe_error error;
        pe_step_stats stats = {0};
        read_states(t, t->before);
        failed = pe_world_step(t->world, t->dt, &stats, &error) != PE_OK;
        unparted |= stats.unparted > 0;
        if (failed) {
            report(t, step, -1, error.message, 0);
        }
        read_states(t, t->after);
        for (int i = 0; i < t->count && finite; ++i) {
            finite = is_finite_state(&t->after[i]);
            if (!finite) {
                report(t, step, i, "not finite", 0);
            } else if (!t->defs[i].is_static) {
                check_motion(t, step, i, w, &far);
            }
        }
        double gain = finite ? gain_of(t) : 0;
        w->gained = pe_max(w->gained, gain);
        if (gain > GAIN) {
            report(t, step, -1, "gained energy", gain);
            gained = true;
        }
    }
    w->too_far += far;
    w->not_finite += !finite;
    w->too_fast += gained;
    w->failed += failed;
    w->unparted += unparted;
    w->runs += 1;
}

random_worlds_found random_worlds_run(uint64_t first, int count)
{
    random_worlds_found found = {0};
    for (uint64_t seed = first; seed < first + (uint64_t)count; ++seed) {
        for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
            trial t = make_trial(seed, (pe_profile)profile);
            run_trial(&t, &found);
            pe_world_destroy(t.world);
        }
    }
    return found;
}
