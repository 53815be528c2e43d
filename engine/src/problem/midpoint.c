/* Transport of manifolds to the midpoint of the step; the method is in midpoint.h. */
#include "midpoint.h"

/* Most bodies of an island. Larger ones have an impact in most steps, and the residual matters
 * more. */
enum { MOST_BODIES = 2 };

/* In a smooth island no point is off by more than this part of the largest impulse. */
static const double SMOOTH = 0.25;

/* rad: less rotation than this in a step is none; more than this in half a step is too much to
 * transport. */
static const double NO_ROTATION = 1e-9, MOST_ROTATION = 0.5;

/* Part of a small gap that is corrected in a step: with all of it, mean velocities overshoot. Small
 * is this part of the way that rotation moves the point in half a step. */
static const double DRIFT = 0.5, SMALL_GAP = 0.25;

/* m and m/s: a contact that touches, and one that does not approach. */
static const double TOUCHING = 1e-9, RESTING = 1e-6;

/* The bound on the normal velocity of a transported point and on its gap in a step, in units of the
 * change that rotation makes in half a step. A step without transport leaves two. */
static const double SMOOTH_CHANGES = 3;

/* Part of the speed gained in a step of free fall that does not count as normal velocity. */
static const double FALL = 2e-3;

/* Part of that which a normal velocity may be off at the midpoint. */
static const double NEGLIGIBLE = 0.01;

/* Friction below this part of its bound sticks. */
static const double LIMIT = 0.99;

/* Part of its mean by which a slip that goes on may slow down in half a step; m/s: the least such
 * slip. */
static const double SLOWING = 0.5, LEAST_SLIP = 1e-6;

/* rad: a slip that turns by less in a quarter of a step is straight, and its friction needs no
 * rotation. */
static const double STRAIGHT = 1e-7;

/* How often the midpoint is found from the velocities, which depend on it. */
enum { TRANSPORTS = 2 };

/* Rounds of finding b_t and the direction of the impulses, which depend on each other. */
enum { SLIP_ROUNDS = 3 };

/* m, and of a unit normal: a point or normal that moves by less than this in a body's axes is fixed
 * there. */
static const double FIXED = 1e-9;

/* In units of the radius: a point that is less than this, and its gap, from a rim is on it. */
static const double ON_RIM = 1e-6;

/* A motion of both bodies. */
typedef struct displacement {
    pe_vec3 rotation_a, rotation_b; /* rotation vectors, world, up to about a radian */
    pe_vec3 shift;                  /* of a's centre of mass relative to b's, world, m */
} displacement;

/* A manifold after such a motion, to second order of the rotations, in world axes. */
typedef struct transported {
    pe_vec3 axis[3]; /* n, t1, t2 */
    pe_vec3 rA, rB;  /* from the centres of mass to the manifold's centre */
} transported;

typedef struct midpoint {
    pe_world *world;
    pe_island_problem *built;
    const pe_problem *problem;
    const pe_free_motion *free;
    double dt;
    bool *fixed;         /* (manifolds): transported, or would be if its bodies rotated */
    bool *moved;         /* (manifolds): transported */
    transported *end;    /* (manifolds): at the end of the step, of those that are transported */
    pe_vec3 *end_offset; /* (points): from the manifold's centre there, world */
    pe_problem start;    /* its contacts at the start of the step */
} midpoint;

/* ---- Attachment to features ---- */

/* The bodies in which all points of a manifold are fixed, and in which its normal is. */
typedef struct attachment {
    bool in_a, in_b;
    bool normal_a, normal_b;
    /* The points are on the rims of a cylinder, which is the body that they would be fixed in, but
     * stay lowest, or in their direction, while it turns. */
    bool on_rim;
    pe_vec3 axis;  /* of the cylinder, world */
    double radius; /* m */
} attachment;

/* The first manifold of the list that is not before the pair of m. */
static int find_pair(const pe_contacts *list, const pe_manifold *m)
{
    int low = 0, high = list->manifold_count;
    while (low < high) {
        int at = low + (high - low) / 2;
        const pe_manifold *other = &pe_manifolds(list)[at];
        if (other->a < m->a || (other->a == m->a && other->b < m->b)) {
            low = at + 1;
        } else {
            high = at;
        }
    }
    return low;
}

static bool is_fixed(pe_vec3 a, pe_vec3 b)
{
    pe_vec3 d = pe_sub(a, b);
    return pe_dot(d, d) < FIXED * FIXED;
}

static const pe_manifold_point *find_point(const pe_contacts *list, const pe_manifold *m,
                                           uint64_t feature)
{
    const pe_manifold_point *points = pe_manifold_points(list) + m->first;
    for (int i = 0; i < m->count; ++i) {
        if (points[i].feature == feature) {
            return &points[i];
        }
    }
    return NULL;
}

/* Whether a manifold and one of the last step have a point on the same features. */
static bool shares_point(const pe_world *world, const pe_manifold *m, const pe_manifold *last)
{
    const pe_manifold_point *points = pe_manifold_points(&world->contacts) + m->first;
    for (int i = 0; i < m->count; ++i) {
        if (find_point(&world->solved, last, points[i].feature) != NULL) {
            return true;
        }
    }
    return false;
}

/* Compares a manifold with that of the same features in the last step. */
static attachment compare(const pe_world *world, const pe_manifold *m, const pe_manifold *last)
{
    const pe_manifold_point *points = pe_manifold_points(&world->contacts) + m->first;
    bool on_b = m->built.normal_on_b;
    bool normal = last->built.normal_on_b == on_b && is_fixed(last->built.normal, m->built.normal);
    attachment f = {
        .in_a = true, .in_b = true, .normal_a = normal && !on_b, .normal_b = normal && on_b};
    for (int j = 0; j < m->count; ++j) {
        const pe_manifold_point *old = find_point(&world->solved, last, points[j].feature);
        /* A new point in front of a gap moves as the others do. */
        bool comes = old == NULL && points[j].separation > TOUCHING;
        f.in_a = f.in_a && (comes || (old != NULL && is_fixed(old->anchor_a, points[j].anchor_a)));
        f.in_b = f.in_b && (comes || (old != NULL && is_fixed(old->anchor_b, points[j].anchor_b)));
    }
    return f;
}

static bool is_polyhedron(const pe_world *world, int slot)
{
    pe_shape_kind kind = pe_bodies(world)[slot].shape.kind;
    return kind == PE_SHAPE_BOX || kind == PE_SHAPE_HULL || kind == PE_SHAPE_MESH;
}

static bool is_plane(const pe_world *world, int slot)
{
    return pe_bodies(world)[slot].shape.kind == PE_SHAPE_PLANE;
}

static bool is_cylinder(const pe_world *world, int slot)
{
    return pe_bodies(world)[slot].shape.kind == PE_SHAPE_CYLINDER;
}

/* Whether all points are on rims of the cylinder `slot`. */
static bool are_on_rim(const pe_world *world, const pe_manifold *m, int slot)
{
    const pe_shape *shape = &pe_bodies(world)[slot].shape;
    const pe_pose *pose = &pe_poses(world)[slot];
    const pe_manifold_point *points = pe_manifold_points(&world->contacts) + m->first;
    for (int j = 0; j < m->count; ++j) {
        pe_vec3 x = pe_unrotate(&pose->rotation, pe_sub(points[j].position, pose->position));
        double off = ON_RIM * shape->radius + fabs(points[j].separation);
        if (!(fabs(sqrt(x.x * x.x + x.y * x.y) - shape->radius) < off) ||
            !(fabs(fabs(x.z) - shape->half_height) < off)) {
            return false;
        }
    }
    return true;
}

/* Attaches points on the rims of a cylinder, whose normal is fixed in the other body. */
static void attach_to_rim(const pe_world *world, const pe_manifold *m, attachment *f)
{
    const int slot = f->normal_a ? m->b : m->a;
    if (!f->in_a && !f->in_b && f->normal_a != f->normal_b && is_cylinder(world, slot) &&
        are_on_rim(world, m, slot)) {
        f->on_rim = true;
        f->in_a = f->normal_b;
        f->in_b = f->normal_a;
        f->axis = pe_axis(&pe_poses(world)[slot].rotation, 2);
        f->radius = pe_bodies(world)[slot].shape.radius;
    }
}

/* Of a pair that is new, only the corners of polyhedra on a plane are known to be fixed. */
static attachment find_fixed(const pe_world *world, const pe_manifold *m)
{
    const pe_contacts *list = &world->solved;
    bool known = false;
    for (int i = find_pair(list, m); i < list->manifold_count; ++i) {
        const pe_manifold *last = &pe_manifolds(list)[i];
        if (last->a != m->a || last->b != m->b) {
            break;
        }
        known = true;
        if (shares_point(world, m, last)) {
            return compare(world, m, last);
        }
    }
    bool a = !known && is_plane(world, m->b), b = !known && is_plane(world, m->a);
    return (attachment){.in_a = a && is_polyhedron(world, m->a),
                        .in_b = b && is_polyhedron(world, m->b),
                        .normal_a = b,
                        .normal_b = a};
}

static attachment find_attachment(const pe_world *world, const pe_manifold *m)
{
    attachment f = find_fixed(world, m);
    attach_to_rim(world, m, &f);
    return f;
}

/* ---- Transport of the geometry ---- */

/* x rotated about v by 2 atan |v|/2, which is |v| to second order (Rodrigues). */
static pe_vec3 rotated(pe_vec3 v, pe_vec3 x)
{
    pe_vec3 t = pe_scale(0.5, v), c = pe_cross(t, x);
    return pe_madd(x, 2 / (1 + pe_dot(t, t)), pe_add(c, pe_cross(t, c)));
}

/* The unit vector across the axis that is nearest to v, or 0. */
static pe_vec3 outward(pe_vec3 axis, pe_vec3 v)
{
    pe_vec3 across = pe_madd(v, -pe_dot(axis, v), axis);
    double length = pe_length(across);
    return pe_scale(length > 0 ? 1 / length : 0, across);
}

/* The arm of a point on a rim after the motion, world. `down` and `down_now` are the direction to the
 * other body before and after. */
static pe_vec3 rim_arm(const attachment *f, const displacement *d, pe_vec3 down, pe_vec3 down_now,
                       pe_vec3 arm)
{
    pe_vec3 axis = rotated(f->in_a ? d->rotation_a : d->rotation_b, f->axis);
    pe_vec3 radial = outward(f->axis, arm), lowest = outward(f->axis, down), now;
    if (pe_length(pe_sub(radial, lowest)) < ON_RIM) {
        radial = lowest;
        now = outward(axis, down_now);
    } else {
        now = outward(axis, radial);
    }
    pe_vec3 moved = pe_scale(pe_dot(arm, f->axis), pe_sub(axis, f->axis));
    return pe_add(arm, pe_madd(moved, f->radius, pe_sub(now, radial)));
}

static transported transport_manifold(const pe_solver_manifold *manifold, const attachment *f,
                                      const displacement *d)
{
    transported to;
    for (int k = 0; k < 3; ++k) {
        to.axis[k] =
            rotated(f->normal_a ? d->rotation_a : d->rotation_b, pe_v3_load(manifold->frame[k]));
    }
    pe_vec3 rA = pe_v3_load(manifold->arm_a), rB = pe_v3_load(manifold->arm_b);
    if (f->in_a) {
        to.rA = rotated(d->rotation_a, rA);
        to.rB = pe_add(pe_add(rB, d->shift), pe_sub(to.rA, rA));
    } else {
        to.rB = rotated(d->rotation_b, rB);
        to.rA = pe_add(pe_sub(rA, d->shift), pe_sub(to.rB, rB));
    }
    return to;
}

/* The offset of a point from the manifold's centre after the motion, in world axes. */
static pe_vec3 transport_point(const pe_solver_manifold *manifold, const pe_solver_point *point,
                               const attachment *f, const displacement *d)
{
    pe_vec3 offset = {0};
    for (int k = 0; k < 3; ++k) {
        offset = pe_madd(offset, point->s[k], pe_v3_load(manifold->frame[k]));
    }
    if (f->on_rim) {
        pe_vec3 centre = pe_v3_load(f->in_a ? manifold->arm_a : manifold->arm_b);
        pe_vec3 normal = pe_scale(f->in_a ? 1 : -1, pe_v3_load(manifold->frame[0]));
        pe_vec3 now = rotated(f->in_a ? d->rotation_b : d->rotation_a, normal);
        return pe_sub(rim_arm(f, d, normal, now, pe_add(centre, offset)),
                      rotated(f->in_a ? d->rotation_a : d->rotation_b, centre));
    }
    return rotated(f->in_a ? d->rotation_a : d->rotation_b, offset);
}

/* The velocity of B relative to A at a point of the transported manifold, along its axes. */
static void velocity_at(const double a[6], const double b[6], const transported *at, pe_vec3 offset,
                        double u[3])
{
    pe_vec3 vA = pe_v3_load(a), wA = pe_v3_load(a + 3), vB = pe_v3_load(b), wB = pe_v3_load(b + 3);
    pe_vec3 uA = pe_add(vA, pe_cross(wA, pe_add(at->rA, offset)));
    pe_vec3 uB = pe_add(vB, pe_cross(wB, pe_add(at->rB, offset)));
    for (int k = 0; k < 3; ++k) {
        u[k] = pe_dot(at->axis[k], pe_sub(uB, uA));
    }
}

/* ---- Smooth islands ---- */

static const pe_manifold *kept_manifold(const midpoint *s, int i)
{
    return &pe_manifolds(&s->world->contacts)[s->built->source[i]];
}

static const pe_manifold_point *kept_points(const midpoint *s, int i)
{
    return pe_manifold_points(&s->world->contacts) + kept_manifold(s, i)->first;
}

/* Velocities of bodies a and b at the step's start. */
static void start_velocities(const midpoint *s, const pe_solver_manifold *manifold,
                             double start[2][6])
{
    const int body[2] = {manifold->a, manifold->b};
    for (int i = 0; i < 2; ++i) {
        pe_twist twist = {0};
        if (body[i] != s->problem->body_count) {
            twist = pe_twists(s->world)[s->built->slot[body[i]]];
        }
        pe_v3_store(start[i], twist.velocity);
        pe_v3_store(start[i] + 3, twist.angular_velocity);
    }
}

/* The manifold's relative twist at the velocities of the step's start. */
static void start_twist(const midpoint *s, const pe_solver_manifold *manifold, double q[6])
{
    double start[2][6];
    pe_solver_manifold pair = *manifold;
    pair.a = 0, pair.b = 1;
    start_velocities(s, manifold, start);
    pe_solver_manifold_twist(&pair, (const double(*)[6])start, q);
}

/* Whether the impulses of the last step nearly fit. */
static bool is_smooth(const midpoint *s)
{
    double off = 0, largest = 0, q[6], u[3];
    for (int i = 0; i < s->problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &s->problem->manifold[i];
        pe_solver_manifold_twist(manifold, (const double(*)[6])s->problem->velocity, q);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            pe_point_velocity(&s->problem->point[j], q, u);
            double p = s->problem->point[j].scale * s->problem->impulse[j][0];
            off = pe_max(off, fabs(p - pe_max(0, p - u[0])));
            largest = pe_max(largest, p);
        }
    }
    return off < SMOOTH * largest;
}

/* ---- Transport ---- */

/* Mean velocity over the step of body i of the problem. */
static void mean_velocity(const midpoint *s, int i, pe_vec3 *linear, pe_vec3 *angular)
{
    *linear = *angular = pe_v3(0, 0, 0);
    if (i != s->problem->body_count) {
        int slot = s->built->slot[i];
        const double *v = s->problem->velocity[i];
        const pe_free_motion *free = &s->free[slot];
        *linear = pe_madd(free->mean.velocity, 0.5, pe_sub(pe_v3_load(v), free->end.velocity));
        *angular =
            pe_scale(0.5, pe_add(pe_twists(s->world)[slot].angular_velocity, pe_v3_load(v + 3)));
    }
}

/* Whether friction is at its bound. */
static bool slides(double friction, const double p[3])
{
    double bound = LIMIT * friction * p[0];
    return bound > 0 && p[1] * p[1] + p[2] * p[2] >= bound * bound;
}

static bool any_slides(const midpoint *s, const pe_solver_manifold *manifold)
{
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        if (slides(manifold->friction, s->problem->impulse[j])) {
            return true;
        }
    }
    return false;
}

/* Whether every loaded point touches, and had at the step's start the velocity that its rotation
 * accounts for, or that a step without transport leaves. After an impact it has another one. */
static bool is_continued(const midpoint *s, const pe_solver_manifold *manifold,
                         const pe_manifold_point *points, const attachment *f,
                         const displacement *half)
{
    displacement none = {0};
    transported now = transport_manifold(manifold, f, &none);
    transported then = transport_manifold(manifold, f, half);
    double start[2][6], u[3], v[3];
    double least = 10 * TOUCHING / s->dt + FALL * s->dt * pe_length(s->world->def.gravity);
    start_velocities(s, manifold, start);
    for (int j = 0; j < manifold->count; ++j) {
        const pe_solver_point *point = &s->problem->point[manifold->first + j];
        velocity_at(start[0], start[1], &now, transport_point(manifold, point, f, &none), u);
        velocity_at(start[0], start[1], &then, transport_point(manifold, point, f, half), v);
        double most = SMOOTH_CHANGES * fabs(v[0] - u[0]) + least;
        bool parts = !(fabs(u[0]) < most) || !(fabs(points[j].separation) < s->dt * most);
        if (s->problem->impulse[manifold->first + j][0] > 0 && parts) {
            return false;
        }
    }
    return true;
}

/* Sets scales, offsets and impulses of the points to those at the midpoint. */
static void transport_points(const midpoint *s, const pe_solver_manifold *manifold,
                             const attachment *f, const displacement *to_half,
                             const displacement *to_end)
{
    transported half = transport_manifold(manifold, f, to_half);
    const pe_inertia *inertia = s->problem->inertia;
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        pe_solver_point *point = &s->problem->point[j];
        double ra[3], rb[3], *p = s->problem->impulse[j];
        pe_vec3 offset = transport_point(manifold, point, f, to_half), force = {0};
        s->end_offset[j] = transport_point(manifold, point, f, to_end);
        pe_v3_store(ra, pe_add(half.rA, offset));
        pe_v3_store(rb, pe_add(half.rB, offset));
        point->scale = pe_point_scale(&inertia[manifold->a], &inertia[manifold->b], ra, rb);
        for (int k = 0; k < 3; ++k) {
            force = pe_madd(force, p[k], pe_v3_load(manifold->frame[k]));
        }
        for (int k = 0; k < 3; ++k) {
            point->s[k] = pe_dot(half.axis[k], offset);
            p[k] = pe_dot(half.axis[k], force);
        }
    }
}

/* Sets the biases of the points of manifold i, which is at the midpoint. */
static void set_biases(const midpoint *s, int i)
{
    const pe_solver_manifold *manifold = &s->problem->manifold[i];
    const pe_manifold_point *points = kept_points(s, i);
    const double(*velocity)[6] = (const double(*)[6])s->problem->velocity;
    double q[6], at_half[3], at_end[3], most = 0;
    pe_solver_manifold_twist(manifold, velocity, q);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        pe_solver_point *point = &s->problem->point[j];
        double gap = points[j - manifold->first].separation;
        pe_point_motion(point, q, at_half);
        velocity_at(velocity[manifold->a], velocity[manifold->b], &s->end[i], s->end_offset[j],
                    at_end);
        double change = fabs(at_end[0] - at_half[0]);
        most = pe_max(most, change);
        bool bounces = point->bias < -RESTING;
        if (!bounces && fabs(gap) < SMALL_GAP * s->dt * change + TOUCHING) {
            point->bias = DRIFT * gap / s->dt;
        }
        point->bias += at_end[0] - at_half[0];
        point->slip[0] = at_end[1] - at_half[1];
        point->slip[1] = at_end[2] - at_half[2];
        s->built->end[j] =
            (pe_contact_place){pe_add(s->end[i].rA, s->end_offset[j]),
                               pe_add(s->end[i].rB, s->end_offset[j]), s->end[i].axis[0]};
    }
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        s->built->normal_change[j] =
            most + NEGLIGIBLE * FALL * s->dt * pe_length(s->world->def.gravity);
    }
}

/* The motions of manifold i up to the midpoint and the end; false where it does not rotate, or too
 * much. */
static bool predict_motion(const midpoint *s, int i, displacement *half, displacement *end)
{
    const pe_solver_manifold *manifold = &s->problem->manifold[i];
    pe_vec3 vA, wA, vB, wB;
    mean_velocity(s, manifold->a, &vA, &wA);
    mean_velocity(s, manifold->b, &vB, &wB);
    double angle = s->dt * sqrt(pe_max(pe_dot(wA, wA), pe_dot(wB, wB)));
    pe_vec3 shift = pe_sub(vA, vB);
    const double h = s->dt;
    *half = (displacement){pe_scale(0.5 * h, wA), pe_scale(0.5 * h, wB), pe_scale(0.5 * h, shift)};
    *end = (displacement){pe_scale(h, wA), pe_scale(h, wB), pe_scale(h, shift)};
    return angle > NO_ROTATION && 0.5 * angle < MOST_ROTATION;
}

/* Transports manifold i to the midpoint, if it can be; false where nothing changed. */
static bool transport(const midpoint *s, int i)
{
    pe_solver_manifold *manifold = &s->problem->manifold[i];
    displacement half, end;
    bool rotates = predict_motion(s, i, &half, &end);
    s->fixed[i] = false;
    if (!rotates && !any_slides(s, manifold)) {
        return false;
    }
    attachment f = find_attachment(s->world, kept_manifold(s, i));
    s->fixed[i] = (f.in_a || f.in_b) && (f.normal_a || f.normal_b);
    if (!s->fixed[i] || !rotates) {
        return false;
    }
    s->fixed[i] = is_continued(s, manifold, kept_points(s, i), &f, &half);
    if (!s->fixed[i]) {
        return false;
    }
    transported to = transport_manifold(manifold, &f, &half);
    s->end[i] = transport_manifold(manifold, &f, &end);
    transport_points(s, manifold, &f, &half, &end);
    for (int k = 0; k < 3; ++k) {
        pe_v3_store(manifold->frame[k], to.axis[k]);
    }
    pe_v3_store(manifold->arm_a, to.rA);
    pe_v3_store(manifold->arm_b, to.rB);
    return true;
}

/* ---- Slip ---- */

/* Gives the sliding points of the manifold their b_t, and their friction the direction that opposes
 * the mean slip; false where no point slides on. */
static bool oppose_mean_slip(const midpoint *s, const pe_solver_manifold *manifold)
{
    double then[6], now[6], u[3], v[3];
    bool any = false;
    start_twist(s, manifold, then);
    pe_solver_manifold_twist(manifold, (const double(*)[6])s->problem->velocity, now);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        pe_solver_point *point = &s->problem->point[j];
        double *p = s->problem->impulse[j];
        if (!slides(manifold->friction, p)) {
            continue;
        }
        pe_point_motion(point, then, u);
        pe_point_motion(point, now, v);
        double sum[2] = {u[1] + v[1], u[2] + v[2]}, loss[2] = {u[1] - v[1], u[2] - v[2]};
        double cross = u[1] * v[2] - u[2] * v[1];
        double turned = 2 * point->scale * manifold->friction * p[0];
        double square = sum[0] * sum[0] + sum[1] * sum[1];
        const bool slides_on = square > LEAST_SLIP * LEAST_SLIP && turned * turned < square &&
                               fabs(loss[0] * sum[0] + loss[1] * sum[1]) < SLOWING * square &&
                               loss[0] * loss[0] + loss[1] * loss[1] < square;
        if (slides_on) {
            /* At the midpoint the manifold has rotated by half, and so has the slip. */
            point->slip[0] = point->slip[1] = 0;
        }
        if (slides_on && fabs(cross) > STRAIGHT * square) {
            double most = manifold->friction * p[0] / sqrt(square);
            for (int k = 0; k < 2; ++k) {
                point->slip[k] = 0.5 * loss[k];
                p[1 + k] = -most * sum[k];
            }
            any = true;
        }
    }
    return any;
}

/* Whether the points of a manifold wander on a rim. */
static bool any_on_rim(const midpoint *s)
{
    for (int i = 0; i < s->problem->manifold_count; ++i) {
        const pe_manifold *m = kept_manifold(s, i);
        if ((is_cylinder(s->world, m->a) || is_cylinder(s->world, m->b)) &&
            find_attachment(s->world, m).on_rim) {
            return true;
        }
    }
    return false;
}

/* Whether no loaded manifold has an impact. */
static bool all_continue(const midpoint *s)
{
    for (int i = 0; i < s->problem->manifold_count; ++i) {
        const attachment f = find_attachment(s->world, kept_manifold(s, i));
        displacement half, end;
        predict_motion(s, i, &half, &end);
        if (!is_continued(s, &s->problem->manifold[i], kept_points(s, i), &f, &half)) {
            return false;
        }
    }
    return true;
}

static void copy_contacts(const pe_problem *from, const pe_problem *to)
{
    const size_t points = (size_t)from->point_count;
    memcpy(to->manifold, from->manifold, (size_t)from->manifold_count * sizeof *to->manifold);
    memcpy(to->point, from->point, points * sizeof *to->point);
    memcpy(to->impulse, from->impulse, points * sizeof *to->impulse);
}

/* Whether the impulses show where the midpoint is: those of the last step, or, with `solved`, of
 * this one. */
static bool is_predictable(const midpoint *s, bool solved)
{
    return solved || s->built->wanders ? pe_problem_has_impulse(s->problem) && all_continue(s)
                                       : is_smooth(s);
}

/* Takes memory, and keeps the problem as it is at the step's start. */
static pe_status begin(midpoint *s, pe_error *error)
{
    const size_t manifolds = (size_t)s->problem->manifold_count + 1;
    const size_t points = (size_t)s->problem->point_count + 1;
    s->fixed = pe_scratch(s->world, manifolds, sizeof *s->fixed);
    s->moved = pe_scratch(s->world, manifolds, sizeof *s->moved);
    s->end = pe_scratch(s->world, manifolds, sizeof *s->end);
    s->end_offset = pe_scratch(s->world, points, sizeof *s->end_offset);
    s->start.manifold = pe_scratch(s->world, manifolds, sizeof *s->start.manifold);
    s->start.point = pe_scratch(s->world, points, sizeof *s->start.point);
    s->start.impulse = pe_scratch(s->world, points, sizeof *s->start.impulse);
    s->built->end = pe_scratch_zero(s->world, points, sizeof *s->built->end);
    if (pe_scratch_failed(s->world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    s->start.manifold_count = s->problem->manifold_count;
    s->start.point_count = s->problem->point_count;
    copy_contacts(s->problem, &s->start);
    return PE_OK;
}

/* Transports manifolds from the step's start by the velocities, and brings these in step. Returns
 * whether it did any. */
static bool transport_all(const midpoint *s)
{
    bool changed = false;
    copy_contacts(&s->start, s->problem);
    for (int i = 0; i < s->problem->manifold_count; ++i) {
        s->moved[i] = transport(s, i);
        changed |= s->moved[i];
    }
    if (changed) {
        pe_problem_rebuild_velocity(s->problem);
    }
    return changed;
}

pe_status pe_problem_to_midpoint(pe_world *world, pe_island_problem *built,
                                 const pe_free_motion *free, double dt, bool solved,
                                 pe_error *error)
{
    midpoint s = {
        .world = world, .built = built, .problem = &built->problem, .free = free, .dt = dt};
    const int count = built->problem.manifold_count;
    built->unsettled = built->wanders = false;
    if (built->problem.body_count > MOST_BODIES) {
        return PE_OK;
    }
    built->wanders = !solved && any_on_rim(&s);
    if (!is_predictable(&s, solved)) {
        built->unsettled = !solved;
        return PE_OK;
    }
    pe_status status = begin(&s, error);
    for (int n = 0; n < TRANSPORTS && status == PE_OK; ++n) {
        if (!transport_all(&s)) {
            built->end = NULL;
            break;
        }
    }
    for (int i = 0; i < count && status == PE_OK; ++i) {
        if (s.moved[i] && built->end != NULL) {
            set_biases(&s, i);
        }
    }
    bool changed = status == PE_OK;
    for (int round = 0; round < SLIP_ROUNDS && changed; ++round) {
        changed = false;
        for (int i = 0; i < count; ++i) {
            changed |= s.fixed[i] && oppose_mean_slip(&s, &s.problem->manifold[i]);
        }
        if (changed) {
            pe_problem_rebuild_velocity(s.problem);
        }
    }
    return status;
}
