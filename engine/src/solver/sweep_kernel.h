/* The kernels of sweep.h for PE_WIDTH lanes; one file per width includes this.
 *
 * Loops run over groups: PE_WIDTH manifolds of a block, from `lane` on. Sweeps take two groups of
 * one colour together: each is one long chain of operations that wait for each other, and two such
 * chains take little longer than one. */
#include "body_lanes.h"
#include "kernels.h"

#include <string.h>

/* ---- Lanes ---- */

/* Reads PE_WIDTH numbers from x, which is aligned to a whole vector. */
PE_INLINE wide load(const double *x)
{
    return *(const wide *)x;
}

/* Writes PE_WIDTH numbers to x, which is aligned to a whole vector. */
PE_INLINE void store(double *x, wide value)
{
    *(wide *)x = value;
}

/* `count` rows of pe_block_lanes, from x on. */
PE_INLINE void load_rows(const double *x, int lane, int count, wide *r)
{
    for (int k = 0; k < count; ++k) {
        r[k] = load(x + PE_BLOCK_LANES * k + lane);
    }
}

/* Writes `count` rows of pe_block_lanes, from x on. */
PE_INLINE void store_rows(double *x, int lane, int count, const wide *r)
{
    for (int k = 0; k < count; ++k) {
        store(x + PE_BLOCK_LANES * k + lane, r[k]);
    }
}

/* Symmetric (xx, xy, xz, yy, yz, zz) times a vector. */
PE_INLINE void symmetric_times(const wide m[6], const wide x[3], wide y[3])
{
    y[0] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2];
    y[1] = m[1] * x[0] + m[3] * x[1] + m[4] * x[2];
    y[2] = m[2] * x[0] + m[4] * x[1] + m[5] * x[2];
}

/* ---- A group of manifolds ---- */

/* The lanes of a block that are swept at once, from `lane` on. */
typedef struct group {
    pe_sweep_block *block;
    pe_sweep_point *points;       /* of the block */
    pe_sweep_friction *frictions; /* the same; NULL with `normals` */
    const pe_sweep_extra *extras; /* the same; NULL where no point has slip */
    int lane;
    wide_pair p;
    wide frame[3][3]; /* rows n, t1, t2 */
    wide rA[3], rB[3];
    wide beta;
    wide q[6];      /* relative twist, in the frame */
    wide wrench[6]; /* of the changes of impulse so far, in the frame */
    wide e[6];      /* normals only: their part of E */
} group;

/* Reads group number `index`: its lanes and the velocities of its bodies. */
PE_INLINE void load_group(const pe_sweep *sweep, int index, group *g)
{
    int lane = index * PE_WIDTH % PE_BLOCK_LANES;
    pe_sweep_block *block = &sweep->blocks[index * PE_WIDTH / PE_BLOCK_LANES];
    g->block = block;
    g->points = &sweep->points[block->first];
    g->frictions = sweep->normals ? NULL : &sweep->frictions[block->first];
    g->extras = sweep->has_slip ? &sweep->extras[block->first] : NULL;
    g->lane = lane;
    wide_load_pair(sweep->velocity, block->a + lane, block->b + lane, &g->p);
    load_rows(block->normal[0], lane, 3, g->frame[0]);
    load_rows(block->tangent[0], lane, 3, g->frame[1]);
    wide_cross(g->frame[0], g->frame[1], g->frame[2]);
    load_rows(block->arm_a[0], lane, 3, g->rA);
    load_rows(block->arm_b[0], lane, 3, g->rB);
    g->beta = sweep->one_beta ? wide_of(sweep->whole_beta) : load(block->beta + lane);
}

/* The relative twist q, and the part of E for normals. */
PE_INLINE void begin_group(group *g)
{
    const wide_pair *p = &g->p;
    wide wA_rA[3], wB_rB[3], v[3], w[3];
    wide_cross(p->wA, g->rA, wA_rA);
    wide_cross(p->wB, g->rB, wB_rB);
    for (int k = 0; k < 3; ++k) {
        v[k] = (p->vB[k] + wB_rB[k]) - (p->vA[k] + wA_rA[k]);
        w[k] = p->wB[k] - p->wA[k];
    }
    for (int k = 0; k < 3; ++k) {
        g->q[k] = wide_dot(g->frame[k], v);
        g->q[3 + k] = wide_dot(g->frame[k], w);
        g->wrench[k] = g->wrench[3 + k] = wide_of(0);
    }
}

/* v += M^-1 J^T p for the bodies of the group; force (N s) and torque (N m s) act on B, in world
 * axes. Static bodies, which several threads read, are not written. */
PE_INLINE void apply_impulse(pe_sweep *sweep, group *g, const wide force[3], const wide torque[3])
{
    pe_sweep_block *block = g->block;
    wide_pair *p = &g->p;
    wide iA[6], iB[6], moment_a[3], moment_b[3], spin_a[3], spin_b[3];
    load_rows(block->inverse_inertia_a[0], g->lane, 6, iA);
    load_rows(block->inverse_inertia_b[0], g->lane, 6, iB);
    wide_cross(g->rA, force, moment_a);
    wide_cross(g->rB, force, moment_b);
    for (int k = 0; k < 3; ++k) {
        moment_a[k] = moment_a[k] + torque[k];
        moment_b[k] = moment_b[k] + torque[k];
        p->vA[k] = p->vA[k] - p->mA * force[k];
        p->vB[k] = p->vB[k] + p->mB * force[k];
    }
    symmetric_times(iA, moment_a, spin_a);
    symmetric_times(iB, moment_b, spin_b);
    for (int k = 0; k < 3; ++k) {
        p->wA[k] = p->wA[k] - spin_a[k];
        p->wB[k] = p->wB[k] + spin_b[k];
    }
    wide_store_pair(sweep->velocity, block->a + g->lane, block->b + g->lane,
                    sweep->problem->body_count, p);
}

/* The first group of a block. */
PE_INLINE int group_of(int block)
{
    return block * (PE_BLOCK_LANES / PE_WIDTH);
}

/* Whether groups `index` and `index + 1` share no body. */
PE_INLINE bool are_independent(const pe_sweep *sweep, int index)
{
    int block = index * PE_WIDTH / PE_BLOCK_LANES, next = (index + 1) * PE_WIDTH / PE_BLOCK_LANES;
    return sweep->blocks[next].colour == sweep->blocks[block].colour;
}

/* s of point j of the group. */
PE_INLINE void load_place(const group *g, int j, bool normals, wide s[3])
{
    s[0] = normals ? wide_of(0) : load(g->frictions[j].s + g->lane);
    load_rows(g->points[j].s[0], g->lane, 2, s + 1);
}

/* J v of a point at s, by the twist. */
PE_INLINE void velocity_at(const wide q[6], const wide s[3], wide u[3])
{
    wide_cross(q + 3, s, u);
    for (int k = 0; k < 3; ++k) {
        u[k] = q[k] + u[k];
    }
}

/* J v + b of point j, at s. */
PE_INLINE void contact_velocity(const group *g, int j, const wide s[3], wide u[3])
{
    velocity_at(g->q, s, u);
    u[0] = u[0] + load(g->points[j].bias + g->lane);
    if (g->extras != NULL) {
        u[1] = u[1] + load(g->extras[j].slip[0] + g->lane);
        u[2] = u[2] + load(g->extras[j].slip[1] + g->lane);
    }
}

/* The wrench of an impulse at s. */
PE_INLINE void wrench_of(const wide s[3], const wide impulse[3], wide wrench[6])
{
    for (int k = 0; k < 3; ++k) {
        wrench[k] = impulse[k];
    }
    wide_cross(s, impulse, wrench + 3);
}

/* E = T M^-1 T^T, which takes a wrench to the change of the twist. */
typedef struct coupling {
    wide linear[6], mixed[9], angular[6];
} coupling;

/* Reads E of the manifolds of a group. */
PE_INLINE void load_coupling(const pe_sweep_block *block, int lane, coupling *e)
{
    load_rows(block->e_normal[0], lane, 1, e->linear);
    load_rows(block->e_normal[1], lane, 2, e->mixed + 1);
    load_rows(block->e_normal[3], lane, 3, e->angular + 3);
    load_rows(block->e_other[0], lane, 5, e->linear + 1);
    load_rows(block->e_other[5], lane, 1, e->mixed);
    load_rows(block->e_other[6], lane, 6, e->mixed + 3);
    load_rows(block->e_other[12], lane, 3, e->angular);
}

/* The inverse of load_coupling. */
PE_INLINE void store_coupling(pe_sweep_block *block, int lane, bool normals, const coupling *e)
{
    store_rows(block->e_normal[0], lane, 1, e->linear);
    store_rows(block->e_normal[1], lane, 2, e->mixed + 1);
    store_rows(block->e_normal[3], lane, 3, e->angular + 3);
    if (!normals) {
        store_rows(block->e_other[0], lane, 5, e->linear + 1);
        store_rows(block->e_other[5], lane, 1, e->mixed);
        store_rows(block->e_other[6], lane, 6, e->mixed + 3);
        store_rows(block->e_other[12], lane, 3, e->angular);
    }
}

/* The change of the twist by a wrench: E times the wrench. */
PE_INLINE void twist_change(const coupling *e, const wide wrench[6], wide change[6])
{
    const wide *m = e->mixed, *f = wrench, *t = wrench + 3;
    wide linear[3], angular[3];
    symmetric_times(e->linear, f, linear);
    symmetric_times(e->angular, t, angular);
    for (int k = 0; k < 3; ++k) {
        change[k] = linear[k] + (m[3 * k] * t[0] + m[3 * k + 1] * t[1] + m[3 * k + 2] * t[2]);
        change[3 + k] = angular[k] + (m[k] * f[0] + m[3 + k] * f[1] + m[6 + k] * f[2]);
    }
}

/* ---- Preparation ---- */

/* Adds one body's part of E: with m its inverse mass, I its inverse inertia and r its arm, both in
 * the manifold's frame, (m + [r] I [r]^T, -[r] I; I [r], I). */
PE_INLINE void add_coupling(const wide frame[3][3], const wide inverse_inertia[6],
                            const wide arm[3], wide inverse_mass, coupling *e)
{
    wide a[3][3], ra[3][3], r[3];
    for (int i = 0; i < 3; ++i) {
        wide column[3];
        symmetric_times(inverse_inertia, frame[i], column);
        for (int j = 0; j < 3; ++j) {
            a[i][j] = wide_dot(frame[j], column);
        }
        r[i] = wide_dot(frame[i], arm);
    }
    for (int j = 0; j < 3; ++j) {
        wide_cross(r, a[j], ra[j]); /* column j of [r] I, for I is symmetric */
    }
    for (int i = 0, at = 0; i < 3; ++i) {
        /* Row i of [r] I, and of [r] I [r]^T: the cross product of r with that row. */
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

/* W = J M^-1 J^T of a point. Its columns are the velocities by unit impulses along n, t1 and t2; with
 * `normals` the first one is enough. */
PE_INLINE void prepare_point(const group *g, int j, bool normals, const coupling *e)
{
    pe_sweep_point *point = &g->points[j];
    const int lane = g->lane;
    wide s[3], w[3][3];
    load_place(g, j, normals, s);
    for (int k = 0; k < (normals ? 1 : 3); ++k) {
        wide unit[3] = {wide_of(k == 0), wide_of(k == 1), wide_of(k == 2)}, wrench[6], change[6];
        wrench_of(s, unit, wrench);
        twist_change(e, wrench, change);
        velocity_at(change, s, w[k]);
    }
    wide present = load(point->inverse_wnn + lane); /* 1 or 0, as it was filled */
    store(point->inverse_wnn + lane, present * wide_inverse(w[0][0]));
    if (normals) {
        return;
    }
    wide half = wide_of(0.5) * (w[1][1] - w[2][2]);
    wide largest = wide_of(0.5) * (w[1][1] + w[2][2]) + wide_sqrt(half * half + w[1][2] * w[1][2]);
    store(point->inverse_wtt + lane, present * wide_inverse(largest));
    store(g->frictions[j].wn[0] + lane, w[0][1]);
    store(g->frictions[j].wn[1] + lane, w[0][2]);
}

static void sweep_prepare(pe_sweep *sweep, int begin, int end)
{
    for (int i = group_of(begin); i < group_of(end); ++i) {
        group g;
        coupling e;
        wide iA[6], iB[6];
        load_group(sweep, i, &g);
        for (int k = 0; k < 9; ++k) {
            e.linear[k < 6 ? k : 0] = e.angular[k < 6 ? k : 0] = e.mixed[k] = wide_of(0);
        }
        load_rows(g.block->inverse_inertia_a[0], g.lane, 6, iA);
        load_rows(g.block->inverse_inertia_b[0], g.lane, 6, iB);
        add_coupling((const wide(*)[3])g.frame, iA, g.rA, g.p.mA, &e);
        add_coupling((const wide(*)[3])g.frame, iB, g.rB, g.p.mB, &e);
        store_coupling(g.block, g.lane, sweep->normals, &e);
        for (int j = 0; j < g.block->count; ++j) {
            prepare_point(&g, j, sweep->normals, &e);
        }
    }
}

/* ---- Sweeps ---- */

/* Squares below this are taken to be this, so that no impulse is divided by zero. */
static const double TINY_SQUARE = 1e-300;

/* y = z + beta (z - z_before) of a component of the impulse. */
PE_INLINE wide extrapolated(const double *impulse, double *before, wide beta)
{
    wide z = load(impulse);
    wide y = z + beta * (z - load(before));
    store(before, z);
    return y;
}

/* Point j: the normal impulse that stops approach, then the tangential one that stops slip, held to
 * the disc of radius mu pn. */
PE_INLINE void solve_cone(int j, group *g)
{
    const pe_sweep_block *block = g->block;
    const int lane = g->lane;
    if (j >= block->count) {
        return;
    }
    pe_sweep_point *point = &g->points[j];
    pe_sweep_friction *friction = &g->frictions[j];
    wide s[3], y[3], u[3];
    load_place(g, j, false, s);
    y[0] = extrapolated(point->impulse + lane, point->before + lane, g->beta);
    for (int k = 0; k < 2; ++k) {
        y[1 + k] = extrapolated(friction->impulse[k] + lane, friction->before[k] + lane, g->beta);
    }
    contact_velocity(g, j, s, u);
    wide pn = wide_max(y[0] - u[0] * load(point->inverse_wnn + lane), wide_of(0));
    wide dn = pn - y[0];
    /* The slip with the new normal impulse. */
    wide u1 = u[1] + load(friction->wn[0] + lane) * dn;
    wide u2 = u[2] + load(friction->wn[1] + lane) * dn;
    wide mass = load(point->inverse_wtt + lane);
    wide p1 = y[1] - u1 * mass, p2 = y[2] - u2 * mass;
    wide square = wide_max(p1 * p1 + p2 * p2, wide_of(TINY_SQUARE));
    wide shrink = load(block->friction + lane) * pn / wide_sqrt(square);
    shrink = wide_select(shrink, wide_of(1), wide_of(1), shrink);
    p1 = p1 * shrink;
    p2 = p2 * shrink;
    store(point->impulse + lane, pn);
    store(friction->impulse[0] + lane, p1);
    store(friction->impulse[1] + lane, p2);

    wide change[3] = {dn, p1 - y[1], p2 - y[2]}, wrench[6];
    wrench_of(s, change, wrench);
    for (int k = 0; k < 6; ++k) {
        g->wrench[k] = g->wrench[k] + wrench[k];
    }
    if (j + 1 < block->count) { /* the next point sees the new twist */
        coupling e;
        wide dq[6];
        load_coupling(block, lane, &e);
        twist_change(&e, wrench, dq);
        for (int k = 0; k < 6; ++k) {
            g->q[k] = g->q[k] + dq[k];
        }
    }
}

/* Applies the wrench of the group's impulse changes to its bodies. */
PE_INLINE void apply_cones(pe_sweep *sweep, group *g)
{
    wide force[3], torque[3];
    const wide *x = g->wrench;
    for (int k = 0; k < 3; ++k) {
        wide n = g->frame[0][k], t1 = g->frame[1][k], t2 = g->frame[2][k];
        force[k] = n * x[0] + t1 * x[1] + t2 * x[2];
        torque[k] = n * x[3] + t1 * x[4] + t2 * x[5];
    }
    apply_impulse(sweep, g, force, torque);
}

/* Of the twist, normal velocities see only the velocity along n and the spins about t1 and t2. E
 * for these three: */
PE_INLINE void load_normal_coupling(group *g)
{
    load_rows(g->block->e_normal[0], g->lane, 6, g->e);
}

/* Normal component of J v + b of a point (m/s), by the twist. */
PE_INLINE wide normal_velocity_at(const pe_sweep_point *point, int lane, const wide q[6])
{
    wide s1 = load(point->s[0] + lane), s2 = load(point->s[1] + lane);
    return (q[0] + (q[4] * s2 - q[5] * s1)) + load(point->bias + lane);
}

/* Point j: the normal impulse that stops approach. Updates the parts of the twist that it needs. */
PE_INLINE void solve_normal(int j, group *g)
{
    const int lane = g->lane;
    if (j >= g->block->count) {
        return;
    }
    pe_sweep_point *point = &g->points[j];
    wide y = extrapolated(point->impulse + lane, point->before + lane, g->beta);
    wide un = normal_velocity_at(point, lane, g->q);
    wide pn = wide_max(y - un * load(point->inverse_wnn + lane), wide_of(0));
    wide dn = pn - y;
    store(point->impulse + lane, pn);
    wide wrench[3] = {dn, load(point->s[1] + lane) * dn,
                      wide_of(0) - load(point->s[0] + lane) * dn};
    wide change[3];
    symmetric_times(g->e, wrench, change);
    for (int k = 0; k < 3; ++k) {
        g->wrench[k] = g->wrench[k] + wrench[k];
    }
    g->q[0] = g->q[0] + change[0];
    g->q[4] = g->q[4] + change[1];
    g->q[5] = g->q[5] + change[2];
}

/* Applies the normal parts of the wrench, a force along n and torques about t1 and t2. */
PE_INLINE void apply_normals(pe_sweep *sweep, group *g)
{
    wide force[3], torque[3];
    for (int k = 0; k < 3; ++k) {
        force[k] = g->frame[0][k] * g->wrench[0];
        torque[k] = g->frame[1][k] * g->wrench[1] + g->frame[2][k] * g->wrench[2];
    }
    apply_impulse(sweep, g, force, torque);
}

static void sweep_extrapolate(pe_sweep *sweep, int begin, int end)
{
    double *now = sweep->velocity->linear, *before = sweep->before->linear;
    for (int i = 8 * begin; i < 8 * end; i += PE_WIDTH) {
        wide z = load(now + i);
        double beta = sweep->one_beta ? sweep->whole_beta : sweep->beta[i / 8];
        store(now + i, z + wide_of(beta) * (z - load(before + i)));
        store(before + i, z);
    }
}

/* `cones`: the whole contact law; otherwise only normal impulses. */
PE_INLINE void solve_point(int j, bool cones, group *g)
{
    if (cones) {
        solve_cone(j, g);
    } else {
        solve_normal(j, g);
    }
}

/* Reads a group and all that its sweep needs. */
PE_INLINE void start_group(const pe_sweep *sweep, int index, bool cones, group *g)
{
    load_group(sweep, index, g);
    begin_group(g);
    if (!cones) {
        load_normal_coupling(g);
    }
}

/* Applies the group's impulse changes to its bodies. */
PE_INLINE void end_group(pe_sweep *sweep, bool cones, group *g)
{
    if (cones) {
        apply_cones(sweep, g);
    } else {
        apply_normals(sweep, g);
    }
}

/* One sweep over blocks, with momentum; `cones` as in solve_point. */
PE_INLINE void sweep_groups(pe_sweep *sweep, bool cones, int begin, int end)
{
    for (int i = group_of(begin); i < group_of(end);) {
        group g, h;
        start_group(sweep, i, cones, &g);
        if (i + 1 < group_of(end) && are_independent(sweep, i)) {
            start_group(sweep, i + 1, cones, &h);
            for (int j = 0; j < g.block->count || j < h.block->count; ++j) {
                solve_point(j, cones, &g);
                solve_point(j, cones, &h);
            }
            end_group(sweep, cones, &g);
            end_group(sweep, cones, &h);
            i += 2;
        } else {
            for (int j = 0; j < g.block->count; ++j) {
                solve_point(j, cones, &g);
            }
            end_group(sweep, cones, &g);
            i += 1;
        }
    }
}

/* One sweep over the friction cones of the manifolds. */
static void sweep_cones(pe_sweep *sweep, int begin, int end)
{
    sweep_groups(sweep, true, begin, end);
}

/* One sweep over the normal impulses only. */
static void sweep_normals(pe_sweep *sweep, int begin, int end)
{
    sweep_groups(sweep, false, begin, end);
}

/* ---- Residuals ---- */

/* Sums go by lane of the block first and then over the lanes, so that all widths give the same
 * bits. */
static pe_violation sweep_violation(const pe_sweep *sweep, int begin, int end)
{
    pe_block_lanes deepest = {0}, squares = {0};
    for (int i = group_of(begin); i < group_of(end); ++i) {
        group g;
        wide most, sum;
        load_group(sweep, i, &g);
        begin_group(&g);
        memcpy(&most, deepest + g.lane, sizeof most);
        memcpy(&sum, squares + g.lane, sizeof sum);
        for (int j = 0; j < g.block->count; ++j) {
            wide depth = wide_of(0) - normal_velocity_at(&g.points[j], g.lane, g.q);
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

/* |P - P_K(P - u - mu |ut| n)| with P = w p: the scale w may go into P because K is a cone. */
PE_INLINE wide point_residual(const group *g, int j, wide friction, wide scale)
{
    wide s[3], u[3], p[3], z[3];
    load_place(g, j, false, s);
    p[0] = scale * load(g->points[j].impulse + g->lane);
    p[1] = scale * load(g->frictions[j].impulse[0] + g->lane);
    p[2] = scale * load(g->frictions[j].impulse[1] + g->lane);
    contact_velocity(g, j, s, u);
    z[0] = p[0] - (u[0] + friction * wide_sqrt(u[1] * u[1] + u[2] * u[2]));
    z[1] = p[1] - u[1];
    z[2] = p[2] - u[2];
    wide zt = wide_sqrt(z[1] * z[1] + z[2] * z[2]);
    wide n = (z[0] + friction * zt) / (wide_of(1) + friction * friction);
    wide shrink = friction * n / wide_max(zt, wide_of(TINY_SQUARE));
    wide inside = friction * z[0];
    shrink = wide_select(zt, inside, shrink, wide_of(1));
    n = wide_select(zt, inside, n, z[0]);
    wide polar = friction * zt + z[0];
    shrink = wide_select(polar, wide_of(0), shrink, wide_of(0));
    n = wide_select(polar, wide_of(0), n, wide_of(0));
    wide d0 = p[0] - n, d1 = p[1] - shrink * z[1], d2 = p[2] - shrink * z[2];
    return wide_sqrt(d0 * d0 + d1 * d1 + d2 * d2);
}

static void sweep_residuals(const pe_sweep *sweep, int begin, int end)
{
    for (int i = group_of(begin); i < group_of(end); ++i) {
        group g;
        wide most = wide_of(0);
        load_group(sweep, i, &g);
        begin_group(&g);
        wide friction = load(g.block->friction + g.lane);
        for (int j = 0; j < g.block->count; ++j) {
            wide scale = load(sweep->extras[g.block->first + j].scale + g.lane);
            most = wide_max(point_residual(&g, j, friction, scale), most);
        }
        store(sweep->worst[g.block - sweep->blocks] + g.lane, most);
    }
}

static const pe_sweep_kernel SWEEP_KERNEL = {
    .prepare = sweep_prepare,
    .extrapolate = sweep_extrapolate,
    .sweep_cones = sweep_cones,
    .sweep_normals = sweep_normals,
    .residuals = sweep_residuals,
    .violation = sweep_violation,
};
