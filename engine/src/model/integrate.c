#include "integrate.h"

#include "rest.h"

/* Newton's steps, and then, for rotations of radians a step at which Newton's method diverges,
 * steps with the derivative at a small rotation, which converge slowly but surely. */
enum { MAX_NEWTON_STEPS = 12, MAX_SPIN_ITERATIONS = 300 };

/* In units of the angular velocity: a step of so little is the last. After Newton's, of which each
 * is about the square of the one before, that leaves rounding. */
static const double LAST_NEWTON_STEP = 1e-9, LAST_STEP = 1e-15;

/* rad: a body that rotates by less in a step keeps its inertia in the world's axes. */
static const double NO_ROTATION = 1e-9;

static pe_mat3 rotation_by(pe_vec3 v)
{
    return pe_matrix_of(pe_quat_rotated((pe_quat){.w = 1}, v));
}

/* Free rotation over a step. */
typedef struct spin {
    pe_vec3 end;      /* w' */
    pe_vec3 mean;     /* m */
    pe_mat3 rotation; /* exp(h m) */
} spin;

/* exp(v) and the coefficients of its derivative: d(exp(v) x)/dv = -exp(v) [x] J(v),
 * J = 1 - f [v] + g [v]^2, f = (1 - cos a)/a^2, g = (a - sin a)/a^3, a = |v|. */
typedef struct exponential_map {
    pe_vec3 v;
    pe_mat3 rotation;
    double f, g;
} exponential_map;

static exponential_map exponential(pe_vec3 v)
{
    double a2 = pe_dot(v, v), a = sqrt(a2), sine, cosine;
    pe_sincos(a, &sine, &cosine);
    /* Below 1e-3 the next term of each series is below 1e-15 of the first. */
    bool tiny = a < 1e-3;
    double e = tiny ? 1 - a2 / 6 : sine / a;
    double f = tiny ? 0.5 - a2 / 24 : (1 - cosine) / a2;
    double g = tiny ? 1.0 / 6 - a2 / 120 : (a - sine) / (a2 * a);
    double x = v.x, y = v.y, z = v.z, c = cosine;
    pe_mat3 rotation = {
        /* Rodrigues' formula */
        .r0 = {c + f * x * x, f * x * y - e * z, f * x * z + e * y},
        .r1 = {f * x * y + e * z, c + f * y * y, f * y * z - e * x},
        .r2 = {f * x * z - e * y, f * y * z + e * x, c + f * z * z},
    };
    return (exponential_map){v, rotation, f, g};
}

/* The derivative of the rotated vector x along d. */
static pe_vec3 rotated_change(const exponential_map *t, pe_vec3 x, pe_vec3 d)
{
    pe_vec3 vd = pe_cross(t->v, d), vvd = pe_cross(t->v, vd);
    pe_vec3 jd = pe_madd(pe_madd(d, -t->f, vd), t->g, vvd);
    return pe_rotate(&t->rotation, pe_cross(jd, x));
}

/* Free rotation over dt from angular velocity w, all in the body's axes: see pe_predict_motion.
 * The last line keeps the momentum, whatever the last digits of the iteration. */
static spin spin_freely(pe_vec3 inertia, pe_vec3 w, double dt)
{
    pe_vec3 inverse = pe_v3(1 / inertia.x, 1 / inertia.y, 1 / inertia.z);
    pe_vec3 momentum = pe_mul(inertia, w);
    /* By the derivative at the start. */
    spin s = {.end = pe_madd(w, dt, pe_mul(inverse, pe_cross(momentum, w)))};
    double speed = pe_length(w);
    for (int i = 0; i < MAX_SPIN_ITERATIONS; ++i) {
        s.end = i == MAX_NEWTON_STEPS ? w : s.end;
        s.mean = pe_scale(0.5, pe_add(w, s.end));
        exponential_map back = exponential(pe_scale(-dt, s.mean));
        pe_vec3 rotated = pe_rotate(&back.rotation, momentum);
        /* Columns of I + (h/2) d(exp(-h m) L)/d(-h m) */
        pe_vec3 c[3];
        for (int k = 0; k < 3; ++k) {
            pe_vec3 d = pe_v3(k == 0, k == 1, k == 2);
            pe_vec3 change =
                i < MAX_NEWTON_STEPS ? rotated_change(&back, momentum, d) : pe_cross(d, rotated);
            c[k] = pe_madd(pe_mul(inertia, d), 0.5 * dt, change);
        }
        pe_vec3 change =
            pe_solve3(pe_v3(c[0].x, c[1].x, c[2].x), pe_v3(c[0].y, c[1].y, c[2].y),
                      pe_v3(c[0].z, c[1].z, c[2].z), pe_sub(pe_mul(inertia, s.end), rotated));
        s.end = pe_sub(s.end, change);
        if (pe_length(change) <= (i < MAX_NEWTON_STEPS ? LAST_NEWTON_STEP : LAST_STEP) * speed) {
            break;
        }
    }
    s.mean = pe_scale(0.5, pe_add(w, s.end));
    s.rotation = rotation_by(pe_scale(dt, s.mean));
    s.end = pe_mul(inverse, pe_unrotate(&s.rotation, momentum));
    return s;
}

/* The applied forces of a step, world. */
typedef struct step_forces {
    pe_vec3 mean;   /* N: h times it is their impulse */
    pe_vec3 early;  /* N, mean with the weight 2 (h - t)/h: h^2/2 times it is m times their
                       displacement */
    pe_vec3 torque; /* N m, mean */
} step_forces;

/* The rotation of the body in `time` from the step's start, by its angular velocity there and its
 * angular acceleration. Of a body that touches something, where contacts oppose the torque, that is
 * the one of the last step. */
static pe_mat3 rotation_after(const pe_world *world, int slot, bool flies, double time)
{
    const pe_applied_force *applied = pe_applied_force_of(world, slot);
    const pe_mat3 *rotation = &pe_poses(world)[slot].rotation;
    const pe_vec3 inertia = pe_masses(world)[slot].inertia;
    pe_vec3 velocity = pe_twists(world)[slot].angular_velocity, change = applied->acceleration;
    if (flies) {
        pe_vec3 w = pe_unrotate(rotation, velocity);
        pe_vec3 torque = pe_add(pe_cross(pe_mul(inertia, w), w), applied->body_torque);
        torque = pe_add(torque, pe_unrotate(rotation, applied->torque));
        change = pe_rotate(rotation,
                           pe_v3(torque.x / inertia.x, torque.y / inertia.y, torque.z / inertia.z));
    }
    return rotation_by(pe_scale(time, pe_madd(velocity, 0.5 * time, change)));
}

/* Forces in the body's axes by Simpson's rule: at the start, the middle and the end. */
static step_forces forces_of_step(const pe_world *world, int slot, bool flies, double dt)
{
    const pe_applied_force *applied = pe_applied_force_of(world, slot);
    step_forces f = {applied->force, applied->force, applied->torque};
    if (applied->rotates) {
        const pe_mat3 *rotation = &pe_poses(world)[slot].rotation;
        pe_vec3 force = pe_rotate(rotation, applied->body_force);
        pe_vec3 torque = pe_rotate(rotation, applied->body_torque);
        pe_mat3 half = rotation_after(world, slot, flies, 0.5 * dt);
        pe_mat3 whole = rotation_after(world, slot, flies, dt);
        pe_vec3 middle = pe_rotate(&half, force), end = pe_rotate(&whole, force);
        f.mean = pe_madd(f.mean, 1.0 / 6, pe_madd(pe_add(force, end), 4, middle));
        f.early = flies ? pe_madd(f.early, 1.0 / 3, pe_madd(force, 2, middle)) : f.mean;
        end = pe_add(torque, pe_rotate(&whole, torque));
        f.torque = pe_madd(f.torque, 1.0 / 6, pe_madd(end, 4, pe_rotate(&half, torque)));
    }
    return f;
}

void pe_rotate_freely(const pe_world *world, int slot, double dt, const pe_vec3 impulses[2],
                      pe_vec3 *end, pe_vec3 *mean)
{
    const pe_vec3 early = impulses[0], late = impulses[1];
    const pe_mass *mass = &pe_masses(world)[slot];
    const pe_mat3 *rotation = &pe_poses(world)[slot].rotation;
    pe_vec3 inverse = pe_v3(1 / mass->inertia.x, 1 / mass->inertia.y, 1 / mass->inertia.z);
    pe_vec3 w = pe_twists(world)[slot].angular_velocity;
    pe_vec3 begun = pe_add(w, pe_rotate(rotation, pe_mul(inverse, pe_unrotate(rotation, early))));
    if (mass->spherical || dt * dt * pe_dot(begun, begun) < NO_ROTATION * NO_ROTATION) {
        *mean = begun;
        *end = pe_add(begun, pe_rotate(rotation, pe_mul(inverse, pe_unrotate(rotation, late))));
        return;
    }
    spin s = spin_freely(mass->inertia, pe_unrotate(rotation, begun), dt);
    /* The late impulse in the axes that the body then has. */
    pe_vec3 kick = pe_mul(inverse, pe_unrotate(&s.rotation, pe_unrotate(rotation, late)));
    *end = pe_rotate(rotation, pe_rotate(&s.rotation, pe_add(s.end, kick)));
    *mean = pe_rotate(rotation, s.mean);
}

pe_free_motion pe_predict_body(const pe_world *world, int slot, bool flies, double dt)
{
    const pe_twist *twist = &pe_twists(world)[slot];
    const double inverse_mass = pe_masses(world)[slot].inverse_mass;
    const step_forces f = forces_of_step(world, slot, flies, dt);
    pe_free_motion free = {.end = *twist, .mean = *twist, .torque = f.torque};
    pe_vec3 mean = pe_madd(world->def.gravity, inverse_mass, f.mean);
    pe_vec3 early = pe_madd(world->def.gravity, inverse_mass, f.early);
    free.end.velocity = pe_madd(twist->velocity, dt, mean);
    free.mean.velocity = pe_madd(twist->velocity, 0.5 * dt, early);
    const pe_vec3 half = pe_scale(0.5 * dt, free.torque), halves[2] = {half, half};
    pe_rotate_freely(world, slot, dt, halves, &free.end.angular_velocity,
                     &free.mean.angular_velocity);
    return free;
}

/* What pe_predict_motion was given. */
typedef struct prediction {
    const pe_world *world;
    const int *place;
    double dt;
    pe_free_motion *motions;
} prediction;

static void predict_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const prediction *p = context;
    const pe_world *world = p->world;
    pe_free_motion *motions = p->motions;
    for (int i = begin; i < end; ++i) {
        const int slot = pe_awake(world)[i];
        const pe_twist *twist = &pe_twists(world)[slot];
        if (pe_masses(world)[slot].inverse_mass == 0) {
            motions[slot] = (pe_free_motion){.end = *twist, .mean = *twist};
        } else {
            motions[slot] = pe_predict_body(world, slot, p->place[slot] < 0, p->dt);
        }
    }
}

void pe_predict_motion(const pe_world *world, const int *place, double dt, pe_free_motion *motions)
{
    prediction p = {world, place, dt, motions};
    pe_pool_run(world->pool, pe_awake_count(world), PE_BODY_GRAIN, predict_bodies, &p);
}

void pe_pose_move(pe_pose *pose, pe_vec3 displacement, pe_vec3 rotation)
{
    pose->position = pe_add(pose->position, displacement);
    if (rotation.x != 0 || rotation.y != 0 || rotation.z != 0) {
        pose->orientation = pe_quat_rotated(pose->orientation, rotation);
        pose->rotation = pe_matrix_of(pose->orientation);
    }
}
