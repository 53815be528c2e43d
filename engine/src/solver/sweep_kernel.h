/* The kernels of sweep.h for PE_WIDTH wide an instruction, which they name PE_KERNEL; included by
 * one file a width. Each lane does the same operations at every width.
 *
 * What a loop runs over is a group: PE_WIDTH manifolds of a block, from `lane` on. Sweeps take two
 * groups of one colour together: what a manifold computes is one long chain of operations that wait
 * for each other, and two such chains take little longer than one. */
#include "sweep.h"

#include "body_lanes.h"

#include <string.h>

/* ---- Lanes -------------------------------------------------------------------------------------
 */

PE_INLINE wide load(const double *x)
{
    return *(const wide *)x;
}

PE_INLINE void store(double *x, wide value)
{
    *(wide *)x = value;
}

/* `count` wide of pe_block_lanes that follow each other from x on. */
PE_INLINE void load_some(const double *x, int lane, int count, wide *r)
{
    for (int k = 0; k < count; ++k) {
        r[k] = load(x + PE_BLOCK_LANES * k + lane);
    }
}

PE_INLINE void store_some(double *x, int lane, int count, const wide *r)
{
    for (int k = 0; k < count; ++k) {
        store(x + PE_BLOCK_LANES * k + lane, r[k]);
    }
}

/* Symmetric (xx, xy, xz, yy, yz, zz) times a vector. */
PE_INLINE void times(const wide m[6], const wide x[3], wide y[3])
{
    y[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    y[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    y[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

/* ---- A group of manifolds
 * -------------------------------------------------------------------------
 */

typedef struct group {
    pe_sweep_block *block;
    int lane;
    wide_body a, b; /* of the bodies */
    wide frame[3][3];
    wide arm_a[3], arm_b[3];
} group;

PE_INLINE group load_group(const pe_sweep *sweep, int index)
{
    int first = index * PE_WIDTH, lane = first % PE_BLOCK_LANES;
    pe_sweep_block *block = &sweep->blocks[first / PE_BLOCK_LANES];
    group g = {.block = block, .lane = lane};
    g.a = wide_load(sweep->velocity, block->a + lane);
    g.b = wide_load(sweep->velocity, block->b + lane);
    load_some(block->normal[0], lane, 3, g.frame[0]);
    load_some(block->tangent[0], lane, 3, g.frame[1]);
    wide_cross(g.frame[0], g.frame[1], g.frame[2]);
    load_some(block->arm_a[0], lane, 3, g.arm_a);
    load_some(block->arm_b[0], lane, 3, g.arm_b);
    return g;
}

PE_INLINE int group_count(const pe_sweep *sweep)
{
    return sweep->block_count * (PE_BLOCK_LANES / PE_WIDTH);
}

/* How many groups from the index on, up to two, share no body. */
PE_INLINE int together(const pe_sweep *sweep, int index)
{
    int next = (index + 1) * PE_WIDTH / PE_BLOCK_LANES;
    return next < sweep->block_count && sweep->blocks[next].colour ==
                                            sweep->blocks[index * PE_WIDTH / PE_BLOCK_LANES].colour
               ? 2
               : 1;
}

PE_INLINE pe_sweep_point *point_of(const pe_sweep *sweep, const group *g, int j)
{
    return &sweep->points[g->block->first + j];
}

PE_INLINE int larger(int a, int b)
{
    return a > b ? a : b;
}

/* The relative twist in the manifold's frame. */
PE_INLINE void twist_of(const group *g, wide q[6])
{
    wide turn_a[3], turn_b[3], d[3], w[3];
    wide_cross(g->a.angular, g->arm_a, turn_a);
    wide_cross(g->b.angular, g->arm_b, turn_b);
    for (int k = 0; k < 3; ++k) {
        d[k] = (g->b.linear[k] + turn_b[k]) - (g->a.linear[k] + turn_a[k]);
        w[k] = g->b.angular[k] - g->a.angular[k];
    }
    for (int k = 0; k < 3; ++k) {
        q[k] = wide_dot(g->frame[k], d);
        q[3 + k] = wide_dot(g->frame[k], w);
    }
}

PE_INLINE void push_line(wide_body *line, const wide inverse_inertia[6], const wide arm[3],
                         const wide force[3], const wide torque[3], double sign)
{
    wide moment[3], turn[3];
    wide_cross(arm, force, moment);
    for (int k = 0; k < 3; ++k) {
        moment[k] = moment[k] + torque[k];
        line->linear[k] = line->linear[k] + wide_of(sign) * (line->inverse_mass * force[k]);
    }
    times(inverse_inertia, moment, turn);
    for (int k = 0; k < 3; ++k) {
        line->angular[k] = line->angular[k] + wide_of(sign) * turn[k];
    }
}

/* v += M^-1 J^T p for the bodies of the group, of force and torque (N s, N m s) on b, world. */
PE_INLINE void push(pe_sweep *sweep, group *g, const wide force[3], const wide torque[3])
{
    wide inverse[6];
    load_some(g->block->inverse_inertia_a[0], g->lane, 6, inverse);
    push_line(&g->a, inverse, g->arm_a, force, torque, -1);
    load_some(g->block->inverse_inertia_b[0], g->lane, 6, inverse);
    push_line(&g->b, inverse, g->arm_b, force, torque, 1);
    wide_save(sweep->velocity, g->block->a + g->lane, &g->a);
    wide_save(sweep->velocity, g->block->b + g->lane, &g->b);
}

/* E, or its part of one body. */
typedef struct coupling {
    wide linear[6], mixed[9], angular[6];
} coupling;

PE_INLINE void load_coupling(const pe_sweep_block *block, int lane, coupling *e)
{
    load_some(block->linear[0], lane, 6, e->linear);
    load_some(block->mixed[0], lane, 9, e->mixed);
    load_some(block->angular[0], lane, 6, e->angular);
}

/* The change E x of a twist by a wrench. */
PE_INLINE void couple(const coupling *e, const wide x[6], wide change[6])
{
    const wide *m = e->mixed, *f = x, *t = x + 3;
    wide linear[3], angular[3];
    times(e->linear, f, linear);
    times(e->angular, t, angular);
    for (int k = 0; k < 3; ++k) {
        change[k] = linear[k] + (m[3 * k] * t[0] + m[3 * k + 1] * t[1] + m[3 * k + 2] * t[2]);
        change[3 + k] = angular[k] + (m[k] * f[0] + m[3 + k] * f[1] + m[6 + k] * f[2]);
    }
}

/* The velocity at a point of the manifold, by its twist. */
PE_INLINE void velocity_at(const wide q[6], const wide s[3], wide u[3])
{
    wide_cross(q + 3, s, u);
    for (int k = 0; k < 3; ++k) {
        u[k] = q[k] + u[k];
    }
}

PE_INLINE void add_bias(const pe_sweep_point *point, int lane, wide u[3])
{
    u[0] = u[0] + load(point->bias + lane);
    u[1] = u[1] + load(point->slip[0] + lane);
    u[2] = u[2] + load(point->slip[1] + lane);
}

/* The wrench of an impulse at a point. */
PE_INLINE void wrench_of(const wide s[3], const wide p[3], wide x[6])
{
    for (int k = 0; k < 3; ++k) {
        x[k] = p[k];
    }
    wide_cross(s, p, x + 3);
}

/* ---- Preparation -------------------------------------------------------------------------------
 */

/* Adds one body's part of E: with A its inverse inertia and r its arm, in the manifold's frame,
 * (1/m + [r] A [r]^T, -[r] A; A [r], A). */
PE_INLINE void add_coupling(const wide frame[3][3], const wide inverse_inertia[6],
                            const wide arm[3], wide inverse_mass, coupling *e)
{
    wide a[3][3], ra[3][3], r[3];
    for (int i = 0; i < 3; ++i) {
        wide turned[3];
        times(inverse_inertia, frame[i], turned);
        for (int j = 0; j < 3; ++j) {
            a[i][j] = wide_dot(frame[j], turned);
        }
        r[i] = wide_dot(frame[i], arm);
    }
    for (int j = 0; j < 3; ++j) {
        wide_cross(r, a[j], ra[j]); /* column j of [r] A, for A is symmetric */
    }
    for (int i = 0, at = 0; i < 3; ++i) {
        /* Row i of [r] A, and of [r] A [r]^T: the cross product of r with that row. */
        wide row[3] = {ra[0][i], ra[1][i], ra[2][i]}, both[3];
        wide_cross(r, row, both);
        e->linear[at] = e->linear[at] + inverse_mass;
        for (int j = i; j < 3; ++j, ++at) {
            e->linear[at] = e->linear[at] + both[j];
            e->angular[at] = e->angular[at] + a[i][j];
        }
        for (int j = 0; j < 3; ++j) {
            e->mixed[3 * i + j] = e->mixed[3 * i + j] - row[j];
        }
    }
}

/* A row of W, which is symmetric: what a unit impulse along k does at the point. */
PE_INLINE void unit_response(const coupling *e, const wide s[3], int k, wide w[3])
{
    wide p[3] = {wide_of(k == 0), wide_of(k == 1), wide_of(k == 2)}, x[6], change[6];
    wrench_of(s, p, x);
    couple(e, x, change);
    velocity_at(change, s, w);
}

PE_INLINE void prepare_point(pe_sweep_point *point, int lane, const coupling *e)
{
    wide s[3], w0[3], w1[3], w2[3];
    load_some(point->s[0], lane, 3, s);
    unit_response(e, s, 0, w0);
    unit_response(e, s, 1, w1);
    unit_response(e, s, 2, w2);
    wide half = wide_of(0.5) * (w1[1] - w2[2]);
    wide most = wide_of(0.5) * (w1[1] + w2[2]) + wide_sqrt(half * half + w1[2] * w1[2]);
    wide present = load(point->inverse_wnn + lane); /* 1 or 0, as it was filled */
    store(point->inverse_wnn + lane, present * wide_inverse(w0[0]));
    store(point->inverse_wtt + lane, present * wide_inverse(most));
    store(point->wn1 + lane, w0[1]);
    store(point->wn2 + lane, w0[2]);
}

static void prepare(pe_sweep *sweep)
{
    for (int i = 0; i < group_count(sweep); ++i) {
        group g = load_group(sweep, i);
        pe_sweep_block *block = g.block;
        coupling e;
        wide inverse[6];
        load_coupling(block, g.lane, &e); /* zero, as it was filled */
        load_some(block->inverse_inertia_a[0], g.lane, 6, inverse);
        add_coupling((const wide(*)[3])g.frame, inverse, g.arm_a, g.a.inverse_mass, &e);
        load_some(block->inverse_inertia_b[0], g.lane, 6, inverse);
        add_coupling((const wide(*)[3])g.frame, inverse, g.arm_b, g.b.inverse_mass, &e);
        store_some(block->linear[0], g.lane, 6, e.linear);
        store_some(block->mixed[0], g.lane, 9, e.mixed);
        store_some(block->angular[0], g.lane, 6, e.angular);
        for (int j = 0; j < block->count; ++j) {
            prepare_point(point_of(sweep, &g, j), g.lane, &e);
        }
    }
}

/* ---- Sweeps ------------------------------------------------------------------------------------
 */

/* Squares below this are of impulses that are none. */
static const double TINY_SQUARE = 1e-300;

/* y of component k of a point's impulse, whose z then is the one before. */
PE_INLINE wide take_start(pe_sweep_point *point, int k, int lane, wide beta)
{
    wide z = load(point->impulse[k] + lane);
    wide y = z + beta * (z - load(point->before[k] + lane));
    store(point->before[k] + lane, z);
    return y;
}

/* Makes a point's impulse z from y, and gives its change. */
PE_INLINE void sweep_point(pe_sweep_point *point, int lane, wide friction, wide beta,
                           const wide q[6], wide s[3], wide d[3])
{
    load_some(point->s[0], lane, 3, s);
    wide y[3], u[3];
    for (int k = 0; k < 3; ++k) {
        y[k] = take_start(point, k, lane, beta);
    }
    velocity_at(q, s, u);
    add_bias(point, lane, u);
    wide n = wide_max(y[0] - u[0] * load(point->inverse_wnn + lane), wide_of(0));
    d[0] = n - y[0];
    /* The slip as the new normal impulse leaves it. */
    wide u1 = u[1] + load(point->wn1 + lane) * d[0];
    wide u2 = u[2] + load(point->wn2 + lane) * d[0];
    wide gain = load(point->inverse_wtt + lane);
    wide t1 = y[1] - u1 * gain, t2 = y[2] - u2 * gain;
    wide square = wide_max(t1 * t1 + t2 * t2, wide_of(TINY_SQUARE));
    wide shrink = friction * n / wide_sqrt(square);
    shrink = wide_select(shrink, wide_of(1), wide_of(1), shrink);
    t1 = t1 * shrink;
    t2 = t2 * shrink;
    d[1] = t1 - y[1];
    d[2] = t2 - y[2];
    store(point->impulse[0] + lane, n);
    store(point->impulse[1] + lane, t1);
    store(point->impulse[2] + lane, t2);
}

/* A group on its way through its points: twist, and the wrench so far. */
typedef struct cone_sweep {
    group g;
    wide q[6], sum[6];
} cone_sweep;

PE_INLINE void cones_begin(const pe_sweep *sweep, int index, cone_sweep *c)
{
    c->g = load_group(sweep, index);
    twist_of(&c->g, c->q);
    for (int k = 0; k < 6; ++k) {
        c->sum[k] = wide_of(0);
    }
}

PE_INLINE void cones_visit(const pe_sweep *sweep, int j, wide beta, cone_sweep *c)
{
    const pe_sweep_block *block = c->g.block;
    int lane = c->g.lane;
    if (j >= block->count) {
        return;
    }
    wide s[3], d[3], x[6], friction = load(block->friction + lane);
    sweep_point(point_of(sweep, &c->g, j), lane, friction, beta, c->q, s, d);
    wrench_of(s, d, x);
    for (int k = 0; k < 6; ++k) {
        c->sum[k] = c->sum[k] + x[k];
    }
    if (j + 1 < block->count) { /* a point is left that sees the twist */
        coupling e;
        wide change[6];
        load_coupling(block, lane, &e);
        couple(&e, x, change);
        for (int k = 0; k < 6; ++k) {
            c->q[k] = c->q[k] + change[k];
        }
    }
}

PE_INLINE void cones_end(pe_sweep *sweep, cone_sweep *c)
{
    wide force[3], torque[3];
    const wide *sum = c->sum;
    for (int k = 0; k < 3; ++k) {
        wide n = c->g.frame[0][k], t1 = c->g.frame[1][k], t2 = c->g.frame[2][k];
        force[k] = n * sum[0] + t1 * sum[1] + t2 * sum[2];
        torque[k] = n * sum[3] + t1 * sum[4] + t2 * sum[5];
    }
    push(sweep, &c->g, force, torque);
}

/* y = z + beta (z - z_before) of the velocities; those of the impulses are made in the sweep. */
static void extrapolate(pe_sweep *sweep, double beta)
{
    double *now = sweep->velocity->linear, *before = sweep->before->linear;
    for (int i = 0; i < 8 * (sweep->problem->body_count + 1); i += PE_WIDTH) {
        wide z = load(now + i);
        store(now + i, z + wide_of(beta) * (z - load(before + i)));
        store(before + i, z);
    }
}

static void sweep_cones(pe_sweep *sweep, double beta)
{
    extrapolate(sweep, beta);
    for (int i = 0; i < group_count(sweep);) {
        cone_sweep c, d;
        cones_begin(sweep, i, &c);
        if (together(sweep, i) == 2) {
            cones_begin(sweep, i + 1, &d);
            for (int j = 0; j < larger(c.g.block->count, d.g.block->count); ++j) {
                cones_visit(sweep, j, wide_of(beta), &c);
                cones_visit(sweep, j, wide_of(beta), &d);
            }
            cones_end(sweep, &c);
            cones_end(sweep, &d);
            i += 2;
        } else {
            for (int j = 0; j < c.g.block->count; ++j) {
                cones_visit(sweep, j, wide_of(beta), &c);
            }
            cones_end(sweep, &c);
            i += 1;
        }
    }
}

/* ---- Normals alone -----------------------------------------------------------------------------
 */

/* All that normal velocities see of a twist: velocity along n, spin about t1 and t2. */
PE_INLINE void normal_twist(const group *g, wide q[3])
{
    wide full[6];
    twist_of(g, full);
    q[0] = full[0];
    q[1] = full[4];
    q[2] = full[5];
}

PE_INLINE wide normal_velocity(const pe_sweep_point *point, int lane, const wide q[3])
{
    wide s1 = load(point->s[1] + lane), s2 = load(point->s[2] + lane);
    return (q[0] + (q[1] * s2 - q[2] * s1)) + load(point->bias + lane);
}

/* The part of E for them. */
PE_INLINE void normal_coupling(const pe_sweep_block *block, int lane, wide e[6])
{
    e[0] = load(block->linear[0] + lane);
    e[1] = load(block->mixed[1] + lane);
    e[2] = load(block->mixed[2] + lane);
    load_some(block->angular[3], lane, 3, e + 3);
}

typedef struct normal_sweep {
    group g;
    wide q[3], e[6], sum[3];
} normal_sweep;

PE_INLINE void normals_begin(const pe_sweep *sweep, int index, normal_sweep *c)
{
    c->g = load_group(sweep, index);
    normal_coupling(c->g.block, c->g.lane, c->e);
    normal_twist(&c->g, c->q);
    for (int k = 0; k < 3; ++k) {
        c->sum[k] = wide_of(0);
    }
}

PE_INLINE void normals_visit(const pe_sweep *sweep, int j, wide beta, normal_sweep *c)
{
    int lane = c->g.lane;
    if (j >= c->g.block->count) {
        return;
    }
    pe_sweep_point *point = point_of(sweep, &c->g, j);
    wide y = take_start(point, 0, lane, beta), u = normal_velocity(point, lane, c->q);
    wide n = wide_max(y - u * load(point->inverse_wnn + lane), wide_of(0));
    wide d = n - y, change[3];
    store(point->impulse[0] + lane, n);
    wide x[3] = {d, load(point->s[2] + lane) * d, wide_of(0) - load(point->s[1] + lane) * d};
    times(c->e, x, change);
    for (int k = 0; k < 3; ++k) {
        c->sum[k] = c->sum[k] + x[k];
        c->q[k] = c->q[k] + change[k];
    }
}

PE_INLINE void normals_end(pe_sweep *sweep, normal_sweep *c)
{
    wide force[3], torque[3];
    for (int k = 0; k < 3; ++k) {
        force[k] = c->g.frame[0][k] * c->sum[0];
        torque[k] = c->g.frame[1][k] * c->sum[1] + c->g.frame[2][k] * c->sum[2];
    }
    push(sweep, &c->g, force, torque);
}

static void sweep_normals(pe_sweep *sweep, double beta)
{
    extrapolate(sweep, beta);
    for (int i = 0; i < group_count(sweep);) {
        normal_sweep c, d;
        normals_begin(sweep, i, &c);
        if (together(sweep, i) == 2) {
            normals_begin(sweep, i + 1, &d);
            for (int j = 0; j < larger(c.g.block->count, d.g.block->count); ++j) {
                normals_visit(sweep, j, wide_of(beta), &c);
                normals_visit(sweep, j, wide_of(beta), &d);
            }
            normals_end(sweep, &c);
            normals_end(sweep, &d);
            i += 2;
        } else {
            for (int j = 0; j < c.g.block->count; ++j) {
                normals_visit(sweep, j, wide_of(beta), &c);
            }
            normals_end(sweep, &c);
            i += 1;
        }
    }
}

/* Sums go by lane of the block and only then over the lanes, so that they too are the same bits at
 * every width. */
static pe_violation violation(const pe_sweep *sweep)
{
    pe_block_lanes deepest = {0}, squares = {0};
    for (int i = 0; i < group_count(sweep); ++i) {
        group g = load_group(sweep, i);
        wide q[3], most, sum;
        memcpy(&most, deepest + g.lane, sizeof most);
        memcpy(&sum, squares + g.lane, sizeof sum);
        normal_twist(&g, q);
        for (int j = 0; j < g.block->count; ++j) {
            wide depth = wide_of(0) - normal_velocity(point_of(sweep, &g, j), g.lane, q);
            depth = wide_max(depth, wide_of(0));
            most = wide_max(depth, most);
            sum = sum + depth * depth;
        }
        memcpy(deepest + g.lane, &most, sizeof most);
        memcpy(squares + g.lane, &sum, sizeof sum);
    }
    pe_violation v = {0};
    for (int i = 0; i < PE_BLOCK_LANES; ++i) {
        v.deepest = deepest[i] > v.deepest ? deepest[i] : v.deepest;
        v.squares += squares[i];
    }
    return v;
}

/* ---- The residual ------------------------------------------------------------------------------
 */

/* |P - P_K(P - u - mu |u_t| n)| with P = w p: the cone has no size, so that w goes into P. */
PE_INLINE wide residual_at(const pe_sweep_point *point, int lane, wide friction, const wide q[6])
{
    wide s[3], u[3], p[3], z[3];
    load_some(point->s[0], lane, 3, s);
    wide scale = load(point->scale + lane);
    for (int k = 0; k < 3; ++k) {
        p[k] = scale * load(point->impulse[k] + lane);
    }
    velocity_at(q, s, u);
    add_bias(point, lane, u);
    z[0] = p[0] - (u[0] + friction * wide_sqrt(u[1] * u[1] + u[2] * u[2]));
    z[1] = p[1] - u[1];
    z[2] = p[2] - u[2];
    wide along = wide_sqrt(z[1] * z[1] + z[2] * z[2]);
    wide n = (z[0] + friction * along) / (wide_of(1) + friction * friction);
    wide shrink = friction * n / wide_max(along, wide_of(TINY_SQUARE));
    wide inside = friction * z[0];
    shrink = wide_select(along, inside, shrink, wide_of(1));
    n = wide_select(along, inside, n, z[0]);
    wide polar = friction * along + z[0];
    shrink = wide_select(polar, wide_of(0), shrink, wide_of(0));
    n = wide_select(polar, wide_of(0), n, wide_of(0));
    wide d0 = p[0] - n, d1 = p[1] - shrink * z[1], d2 = p[2] - shrink * z[2];
    return wide_sqrt(d0 * d0 + d1 * d1 + d2 * d2);
}

static double residual(const pe_sweep *sweep)
{
    wide most = wide_of(0);
    for (int i = 0; i < group_count(sweep); ++i) {
        group g = load_group(sweep, i);
        wide q[6], friction = load(g.block->friction + g.lane);
        twist_of(&g, q);
        for (int j = 0; j < g.block->count; ++j) {
            most = wide_max(residual_at(point_of(sweep, &g, j), g.lane, friction, q), most);
        }
    }
    double lane[PE_WIDTH], worst = 0;
    memcpy(lane, &most, sizeof most);
    for (int i = 0; i < PE_WIDTH; ++i) {
        worst = lane[i] > worst ? lane[i] : worst;
    }
    return worst;
}

const pe_sweep_kernel PE_KERNEL = {
    .lanes = PE_WIDTH,
    .prepare = prepare,
    .sweep_cones = sweep_cones,
    .residual = residual,
    .sweep_normals = sweep_normals,
    .violation = violation,
};
