#include "midpoint.h"

#include "attachment.h"

/* Bodies of an island: in larger ones something strikes at most steps, and the residual matters
 * more. */
enum { FEW = 2 };

/* Part of the largest push by which no point of a smooth island is off. */
static const double SMOOTH = 0.25;

/* rad: what turns by less in a step does not, and by more in half of it is past being carried. */
static const double NO_TURN = 1e-9, MOST_TURN = 0.5;

/* Part of a gap that is taken back in a step. With all of it, mean velocities overshoot. */
static const double DRIFT = 0.5;

/* m and m/s: touches, and does not approach. */
static const double TOUCHING = 1e-9, STANDING = 1e-6;

/* In units of the change that its turn makes in half a step: by how much the normal velocity of a
 * carried point may be off, and its gap in a step. A step that is not of this kind leaves two. */
static const double GOES_ON = 3;

/* So much of the speed that is gained in a step of falling does not matter to it. */
static const double FALL = 2e-3;

/* Friction that is less, in parts of its limit, holds. */
static const double LIMIT = 0.99;
/* Part of its mean by which a slip that goes on may slow down in half a step, and its least. */
static const double SLOWING = 0.5, LEAST_SLIP = 1e-6;
/* rad: a slip that turns by less in a quarter of a step is straight, and has its friction already.
 */
static const double STRAIGHT = 1e-7;
/* The impulses' direction and b_t depend on each other. */
enum { SLIP_ROUNDS = 3 };

typedef struct middle {
    pe_world *world;
    const pe_island_problem *built;
    const pe_problem *problem;
    const int *source;
    const pe_free_motion *free;
    double dt;
    pe_solver_manifold *manifold;
    pe_solver_point *point;
    double *normal_change;
    bool *fixed; /* (manifolds): carried, or would be if its bodies turned */
} middle;

static pe_vec3 vector(const double v[3])
{
    return pe_v3(v[0], v[1], v[2]);
}

static void store(double to[3], pe_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

static const pe_manifold *kept_manifold(const middle *s, int i)
{
    return &pe_manifolds(&s->world->contacts)[s->source[i]];
}

/* Of a and b, at the step's start. */
static void began_velocities(const middle *s, const pe_solver_manifold *manifold,
                             double began[2][6])
{
    const int body[2] = {manifold->a, manifold->b};
    for (int i = 0; i < 2; ++i) {
        pe_twist motion = {0};
        if (body[i] != s->problem->body_count) {
            motion = pe_twists(s->world)[s->built->slot[body[i]]];
        }
        store(began[i], motion.velocity);
        store(began[i] + 3, motion.angular_velocity);
    }
}

/* The manifold's twist by the velocities of the step's start. */
static void began_twist(const middle *s, const pe_solver_manifold *manifold, double q[6])
{
    double began[2][6];
    pe_solver_manifold pair = *manifold;
    pair.a = 0, pair.b = 1;
    began_velocities(s, manifold, began);
    pe_solver_manifold_twist(&pair, (const double(*)[6])began, q);
}

/* ---- Smooth islands ----------------------------------------------------------------------------
 */

/* Whether the manifold touches, and nothing approaches: so scenes begin. */
static bool stands(const middle *s, int i)
{
    const pe_solver_manifold *manifold = &s->manifold[i];
    const pe_manifold_point *points =
        pe_manifold_points(&s->world->contacts) + kept_manifold(s, i)->first;
    double q[6], u[3];
    began_twist(s, manifold, q);
    for (int j = 0; j < manifold->count; ++j) {
        pe_point_motion(&s->point[manifold->first + j], q, u);
        if (!(fabs(points[j].separation) < TOUCHING && fabs(u[0]) < STANDING)) {
            return false;
        }
    }
    return true;
}

/* Whether the impulses of the last step nearly fit, or nothing moved yet. */
static bool is_smooth(const middle *s)
{
    double off = 0, push = 0, q[6], u[3];
    for (int i = 0; i < s->problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &s->manifold[i];
        pe_solver_manifold_twist(manifold, (const double(*)[6])s->problem->velocity, q);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            pe_point_velocity(&s->point[j], q, u);
            double p = s->point[j].scale * s->problem->impulse[j][0];
            off = pe_max(off, fabs(p - pe_max(0, p - u[0])));
            push = pe_max(push, p);
        }
    }
    bool began = push == 0;
    for (int i = 0; i < s->problem->manifold_count && began; ++i) {
        began = stands(s, i);
    }
    return began || off < SMOOTH * push;
}

/* ---- Carrying ----------------------------------------------------------------------------------
 */

/* Mean velocity over the step of body i of the problem. */
static void mean_of(const middle *s, int i, pe_vec3 *linear, pe_vec3 *angular)
{
    *linear = *angular = pe_v3(0, 0, 0);
    if (i != s->problem->body_count) {
        int slot = s->built->slot[i];
        const double *v = s->problem->velocity[i];
        const pe_free_motion *free = &s->free[slot];
        *linear = pe_madd(free->mean.velocity, 0.5, pe_sub(vector(v), free->end.velocity));
        *angular = pe_scale(0.5, pe_add(pe_twists(s->world)[slot].angular_velocity, vector(v + 3)));
    }
}

/* Of b relative to a, of these velocities, at a point of the carried manifold, along its axes. */
static void velocity_at(const double a[6], const double b[6], const pe_transported *at, pe_vec3 off,
                        double u[3])
{
    pe_vec3 ua = pe_add(vector(a), pe_cross(vector(a + 3), pe_add(at->arm_a, off)));
    pe_vec3 ub = pe_add(vector(b), pe_cross(vector(b + 3), pe_add(at->arm_b, off)));
    for (int k = 0; k < 3; ++k) {
        u[k] = pe_dot(at->axis[k], pe_sub(ub, ua));
    }
}

static void carry_point(const middle *s, const pe_solver_manifold *manifold, const pe_attachment *f,
                        const pe_displacement *to_half, const pe_displacement *to_end, double gap,
                        int j)
{
    pe_solver_point *point = &s->point[j];
    pe_transported half = pe_solver_manifold_transported(manifold, f, to_half),
                   end = pe_solver_manifold_transported(manifold, f, to_end);
    pe_vec3 off = pe_offset_transported(manifold, point, f, to_half), force = {0};
    double at_half[3], at_end[3], ra[3], rb[3], *p = s->problem->impulse[j];
    const double *a = s->problem->velocity[manifold->a], *b = s->problem->velocity[manifold->b];
    velocity_at(a, b, &half, off, at_half);
    velocity_at(a, b, &end, pe_offset_transported(manifold, point, f, to_end), at_end);
    double normal_change = fabs(at_end[0] - at_half[0]);
    bool bounces = point->bias < -STANDING;
    if (!bounces && fabs(gap) < s->dt * normal_change + TOUCHING) {
        point->bias = DRIFT * gap / s->dt;
    }
    point->bias += at_end[0] - at_half[0];
    for (int k = 0; k < 2; ++k) {
        point->slip[k] = at_end[1 + k] - at_half[1 + k];
    }
    s->normal_change[j] = normal_change;
    store(ra, pe_add(half.arm_a, off));
    store(rb, pe_add(half.arm_b, off));
    point->scale = pe_point_scale(&s->problem->inertia[manifold->a],
                                  &s->problem->inertia[manifold->b], ra, rb);
    for (int k = 0; k < 3; ++k) {
        force = pe_madd(force, p[k], vector(manifold->frame[k]));
    }
    for (int k = 0; k < 3; ++k) {
        point->s[k] = pe_dot(half.axis[k], off);
        p[k] = pe_dot(half.axis[k], force);
    }
}

static bool slides(const middle *s, const pe_solver_manifold *manifold)
{
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        const double *p = s->problem->impulse[j];
        double held = LIMIT * manifold->friction * p[0];
        if (held > 0 && p[1] * p[1] + p[2] * p[2] >= held * held) {
            return true;
        }
    }
    return false;
}

/* Whether what the manifold pushes touches, and had, at the step's start, just the velocity that
 * its turn accounts for, or a step without this leaves. What has been struck has another. */
static bool goes_on(const middle *s, const pe_solver_manifold *manifold,
                    const pe_manifold_point *points, const pe_attachment *f,
                    const pe_displacement *half)
{
    pe_displacement none = {0};
    pe_transported now = pe_solver_manifold_transported(manifold, f, &none),
                   then = pe_solver_manifold_transported(manifold, f, half);
    double began[2][6], u[3], v[3];
    double least = 10 * TOUCHING / s->dt + FALL * s->dt * pe_length(s->world->def.gravity);
    began_velocities(s, manifold, began);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        const pe_solver_point *point = &s->point[j];
        pe_vec3 off = pe_offset_transported(manifold, point, f, &none);
        velocity_at(began[0], began[1], &now, off, u);
        velocity_at(began[0], began[1], &then, pe_offset_transported(manifold, point, f, half), v);
        double most = GOES_ON * fabs(v[0] - u[0]) + least;
        double gap = points[j - manifold->first].separation;
        bool parts = !(fabs(u[0]) < most) || !(fabs(gap) < s->dt * most);
        if (s->problem->impulse[j][0] > 0 && parts) {
            return false;
        }
    }
    return true;
}

/* Carries manifold i, if it can be, to the middle; false where nothing changed. */
static bool carry(const middle *s, int i)
{
    pe_solver_manifold *manifold = &s->manifold[i];
    pe_vec3 va, wa, vb, wb;
    mean_of(s, manifold->a, &va, &wa);
    mean_of(s, manifold->b, &vb, &wb);
    double fastest = s->dt * sqrt(pe_max(pe_dot(wa, wa), pe_dot(wb, wb)));
    bool turns = fastest > NO_TURN && 0.5 * fastest < MOST_TURN;
    s->fixed[i] = false;
    if (!turns && !slides(s, manifold)) {
        return false;
    }
    const pe_manifold *m = kept_manifold(s, i);
    pe_attachment f = pe_attachment_of(s->world, m);
    s->fixed[i] = (f.in_a || f.in_b) && (f.normal_a || f.normal_b);
    if (!s->fixed[i] || !turns) {
        return false;
    }
    pe_displacement half = {pe_scale(0.5 * s->dt, wa), pe_scale(0.5 * s->dt, wb),
                            pe_scale(0.5 * s->dt, pe_sub(va, vb))};
    s->fixed[i] =
        goes_on(s, manifold, pe_manifold_points(&s->world->contacts) + m->first, &f, &half);
    if (!s->fixed[i]) {
        return false;
    }
    pe_displacement end = {pe_scale(2, half.turn_a), pe_scale(2, half.turn_b),
                           pe_scale(2, half.shift)};
    pe_transported carried = pe_solver_manifold_transported(manifold, &f, &half);
    for (int j = 0; j < manifold->count; ++j) {
        double gap = pe_manifold_points(&s->world->contacts)[m->first + j].separation;
        carry_point(s, manifold, &f, &half, &end, gap, manifold->first + j);
    }
    for (int k = 0; k < 3; ++k) {
        store(manifold->frame[k], carried.axis[k]);
    }
    store(manifold->arm_a, carried.arm_a);
    store(manifold->arm_b, carried.arm_b);
    return true;
}

/* ---- Slip --------------------------------------------------------------------------------------
 */

/* Gives the points of the manifold whose slip goes on their b_t, and their friction the direction
 * that it then has; false where there is none. */
static bool oppose_mean_slip(const middle *s, const pe_solver_manifold *manifold)
{
    double then[6], now[6], u[3], v[3];
    bool any = false;
    began_twist(s, manifold, then);
    pe_solver_manifold_twist(manifold, (const double(*)[6])s->problem->velocity, now);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        pe_point_motion(&s->point[j], then, u);
        pe_point_motion(&s->point[j], now, v);
        double *p = s->problem->impulse[j], held = LIMIT * manifold->friction * p[0];
        if (!(held > 0 && p[1] * p[1] + p[2] * p[2] >= held * held)) {
            continue;
        }
        double sum[2] = {u[1] + v[1], u[2] + v[2]}, loss[2] = {u[1] - v[1], u[2] - v[2]};
        double aside = u[1] * v[2] - u[2] * v[1];
        double turned = 2 * s->point[j].scale * manifold->friction * p[0];
        double square = sum[0] * sum[0] + sum[1] * sum[1];
        /* Where it slips the manifold has turned by half, and so has the direction. */
        s->point[j].slip[0] = s->point[j].slip[1] = 0;
        if (square > LEAST_SLIP * LEAST_SLIP && turned * turned < square &&
            fabs(aside) > STRAIGHT * square &&
            fabs(loss[0] * sum[0] + loss[1] * sum[1]) < SLOWING * square &&
            loss[0] * loss[0] + loss[1] * loss[1] < square) {
            double most = manifold->friction * p[0] / sqrt(square);
            for (int k = 0; k < 2; ++k) {
                s->point[j].slip[k] = 0.5 * loss[k];
                p[1 + k] = -most * sum[k];
            }
            any = true;
        }
    }
    return any;
}

pe_status pe_problem_to_midpoint(pe_world *world, const pe_island_problem *built, const int *source,
                                 const pe_free_motion *free, double dt,
                                 pe_solver_manifold *manifold, pe_solver_point *point,
                                 double *normal_change, pe_error *error)
{
    middle s = {.world = world,
                .built = built,
                .problem = &built->problem,
                .source = source,
                .free = free,
                .dt = dt,
                .manifold = manifold,
                .point = point,
                .normal_change = normal_change};
    int count = built->problem.manifold_count;
    if (built->problem.body_count > FEW || !is_smooth(&s)) {
        return PE_OK;
    }
    s.fixed = pe_scratch(world, (size_t)count + 1, sizeof *s.fixed);
    if (s.fixed == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d manifolds", count);
    }
    bool changed = false;
    for (int i = 0; i < count; ++i) {
        changed |= carry(&s, i);
    }
    if (changed) {
        pe_problem_rebuild_velocity(s.problem);
    }
    changed = true;
    for (int round = 0; round < SLIP_ROUNDS && changed; ++round) {
        changed = false;
        for (int i = 0; i < count; ++i) {
            changed |= s.fixed[i] && oppose_mean_slip(&s, &manifold[i]);
        }
        if (changed) {
            pe_problem_rebuild_velocity(s.problem);
        }
    }
    return PE_OK;
}
