/* The sweeps of soft contact for PE_WIDTH lanes; one file per width includes this. */
#include "soft_rows.h"

/* ---- Sweeps ---- */

/* Changes the linear velocities of each pair by an impulse (N s) on B and its opposite on A. */
PE_INLINE void apply_linear(const wide impulse[3], wide_pair *p)
{
    for (int k = 0; k < 3; ++k) {
        p->vA[k] -= p->mA * impulse[k];
        p->vB[k] += p->mB * impulse[k];
    }
}

/* Does the same for an impulse of this size (N s) along a unit direction. */
PE_INLINE void apply_along(const wide direction[3], wide size, wide_pair *p)
{
    wide impulse[3];
    for (int k = 0; k < 3; ++k) {
        impulse[k] = size * direction[k];
    }
    apply_linear(impulse, p);
}

/* Changes the scaled angular velocities by an impulse of this size along the row (jA, jB). */
PE_INLINE void apply_angular(const wide jA[3], const wide jB[3], wide size, wide_pair *p)
{
    wide_add(p->wA, size, jA);
    wide_add(p->wB, size, jB);
}

/* The normal impulses of a block while they are found: the linear part acts on the bodies when all
 * points are done. */
typedef struct normal_sum {
    wide vn;  /* n.(vB - vA) with the impulses so far */
    wide sum; /* of their changes */
} normal_sum;

/* The normal velocity of a row (m/s), with vn_linear its linear part n.(vB - vA). */
PE_INLINE wide normal_velocity(const soft_row *r, wide vn_linear, const wide_pair *p)
{
    return vn_linear + (wide_dot(r->jA, p->wA) + wide_dot(r->jB, p->wB));
}

/* Adds dp (N s) to the sum of normal impulses and applies its angular part. */
PE_INLINE void apply_normal(const soft_block *c, const soft_row *r, wide dp, normal_sum *n,
                            wide_pair *p)
{
    n->sum += dp;
    n->vn += dp * c->inverse_mass;
    apply_angular(r->jA, r->jB, dp, p);
}

/* Applies the impulses of the last sub-step to the velocities. */
static void soft_warm_start(const pe_soft_task *task, int begin, int end)
{
    pe_solver_body *bodies = task->bodies->velocity;
    for (int i = begin; i < end; ++i) {
        const soft_block *c = (const soft_block *)task->blocks + i;
        const soft_row *rows = (const soft_row *)task->rows + c->row;
        wide_pair p;
        wide_load_pair(bodies, c->a, c->b, &p);
        wide zero = wide_of(0), total = zero;
        for (int j = 0; j < c->count; ++j) {
            total += rows[j].impulse;
            apply_angular(rows[j].jA, rows[j].jB, rows[j].impulse, &p);
        }
        apply_along(c->normal, total, &p);
        if (c->friction >= 0) {
            const friction_block *f = (const friction_block *)task->friction_blocks + c->friction;
            const friction_row *g = (const friction_row *)task->friction_rows + c->friction_row;
            wide sum[3] = {zero, zero, zero};
            for (int j = 0; j < c->count; ++j) {
                sum[0] += g[j].impulse[0];
                sum[1] += g[j].impulse[1];
                sum[2] += g[j].x * g[j].impulse[1] - g[j].y * g[j].impulse[0];
            }
            for (int q = 0; q < 3; ++q) {
                apply_angular(f->jA[q], f->jB[q], sum[q], &p);
            }
            apply_along(f->tangent[0], sum[0], &p);
            apply_along(f->tangent[1], sum[1], &p);
        }
        wide_store_pair(bodies, c->a, c->b, 0, &p);
    }
}

/* One sweep over the normal impulses, with springs that correct penetration. */
static void soft_bias(const pe_soft_task *task, int begin, int end)
{
    pe_solver_body *bodies = task->bodies->velocity;
    wide zero = wide_of(0), one = wide_of(1);
    wide per_substep = wide_of(1 / task->substep), least = wide_of(-task->push_speed);
    for (int i = begin; i < end; ++i) {
        const soft_block *c = (const soft_block *)task->blocks + i;
        soft_row *rows = (soft_row *)task->rows + c->row;
        wide_pair p, d; /* velocities, displacements */
        wide_load_pair(bodies, c->a, c->b, &p);
        wide_load_pair(task->bodies->displacement, c->a, c->b, &d);
        normal_sum n = {relative_velocity(c->normal, &p), zero};
        wide dn = relative_velocity(c->normal, &d);
        const pe_soft_spring *spring = c->hard ? &task->hard_spring : &task->spring;
        wide rate = wide_of(spring->rate), mass_scale = wide_of(spring->mass_scale);
        wide impulse_scale = wide_of(spring->impulse_scale);
        for (int j = 0; j < c->count; ++j) {
            soft_row *r = &rows[j];
            wide vn = normal_velocity(r, n.vn, &p);
            wide s = r->gap + normal_velocity(r, dn, &d);
            /* A gap may close within the sub-step and no further; a penetration is a spring. */
            wide pushed = mass_scale * wide_max(rate * s, least);
            wide bias = wide_select(s, zero, s * per_substep, pushed);
            wide scale = wide_select(s, zero, one, mass_scale);
            wide leak = wide_select(s, zero, zero, impulse_scale);
            wide old = r->impulse;
            r->impulse = wide_max(old - (r->mass * (scale * vn + bias) + leak * old), zero);
            apply_normal(c, r, r->impulse - old, &n, &p);
        }
        apply_along(c->normal, n.sum, &p);
        wide_store_pair(bodies, c->a, c->b, 0, &p);
    }
}

/* Makes one step of projected gradient descent on the friction of a block of `count` points. */
PE_INLINE void relax_friction(const friction_block *f, friction_row *g, const soft_row *rows,
                              int count, wide_pair *p)
{
    wide zero = wide_of(0), v[3], sum[3] = {zero, zero, zero};
    for (int q = 0; q < 3; ++q) {
        v[q] = wide_dot(f->jA[q], p->wA) + wide_dot(f->jB[q], p->wB);
    }
    v[0] += relative_velocity(f->tangent[0], p);
    v[1] += relative_velocity(f->tangent[1], p);
    for (int j = 0; j < count; ++j) {
        wide x = g[j].x, y = g[j].y;
        wide p1 = g[j].impulse[0] - f->step * (v[0] - y * v[2]);
        wide p2 = g[j].impulse[1] - f->step * (v[1] + x * v[2]);
        wide bound = f->friction * rows[j].impulse, square = p1 * p1 + p2 * p2;
        wide shrink = wide_select(square, bound * bound, bound / wide_sqrt(square), wide_of(1));
        p1 *= shrink;
        p2 *= shrink;
        wide dp1 = p1 - g[j].impulse[0], dp2 = p2 - g[j].impulse[1];
        g[j].impulse[0] = p1;
        g[j].impulse[1] = p2;
        g[j].sum[0] += p1;
        g[j].sum[1] += p2;
        sum[0] += dp1;
        sum[1] += dp2;
        sum[2] += x * dp2 - y * dp1;
    }
    for (int q = 0; q < 3; ++q) {
        apply_angular(f->jA[q], f->jB[q], sum[q], p);
    }
    wide impulse[3];
    for (int k = 0; k < 3; ++k) {
        impulse[k] = sum[0] * f->tangent[0][k] + sum[1] * f->tangent[1][k];
    }
    apply_linear(impulse, p);
}

static void soft_relax(const pe_soft_task *task, int begin, int end)
{
    pe_solver_body *bodies = task->bodies->velocity;
    wide zero = wide_of(0), per_step = wide_of(1 / (task->substep * task->substeps));
    for (int i = begin; i < end; ++i) {
        const soft_block *c = (const soft_block *)task->blocks + i;
        soft_row *rows = (soft_row *)task->rows + c->row;
        wide_pair p;
        wide_load_pair(bodies, c->a, c->b, &p);
        normal_sum n = {relative_velocity(c->normal, &p), zero};
        for (int j = 0; j < c->count; ++j) {
            soft_row *r = &rows[j];
            /* A gap of the step's start may close by the step's end. */
            wide vn = normal_velocity(r, n.vn, &p) + wide_max(r->gap, zero) * per_step;
            wide old = r->impulse;
            r->impulse = wide_max(old - r->mass * vn, zero);
            r->sum += r->impulse;
            apply_normal(c, r, r->impulse - old, &n, &p);
        }
        apply_along(c->normal, n.sum, &p);
        if (c->friction >= 0) {
            relax_friction((const friction_block *)task->friction_blocks + c->friction,
                           (friction_row *)task->friction_rows + c->friction_row, rows, c->count,
                           &p);
        }
        wide_store_pair(bodies, c->a, c->b, 0, &p);
    }
}

/* ---- Bodies and results ---- */

static void soft_store(const pe_soft_task *task, int begin, int end)
{
    for (int i = begin; i < end; ++i) {
        const soft_block *c = (const soft_block *)task->blocks + i;
        const friction_block *f =
            c->friction < 0 ? NULL : (const friction_block *)task->friction_blocks + c->friction;
        for (int j = 0; j < c->count; ++j) {
            const soft_row *r = (const soft_row *)task->rows + c->row + j;
            const friction_row *g = (const friction_row *)task->friction_rows + c->friction_row + j;
            double impulse[3][PE_WIDTH];
            for (int k = 0; k < 3; ++k) {
                wide p = r->sum * c->normal[k];
                if (f != NULL) {
                    p += g->sum[0] * f->tangent[0][k] + g->sum[1] * f->tangent[1][k];
                }
                wide_store(impulse[k], p);
            }
            for (int l = 0; l < c->lanes; ++l) {
                task->points[task->plan->contacts[c->contact + l].point[j]].impulse =
                    pe_v3(impulse[0][l], impulse[1][l], impulse[2][l]);
            }
        }
    }
}

/* Bodies are taken as rows of eight numbers here. The inverse mass among them does not change, and
 * what it adds to a displacement is never read. */
static void soft_integrate_velocities(const pe_soft_task *task, int begin, int end)
{
    double *v = task->bodies->velocity[0].linear, *previous = task->bodies->previous[0].linear;
    for (int i = 8 * begin; i < 8 * end; ++i) {
        double now = v[i];
        v[i] = now + (now - previous[i]);
        previous[i] = now;
    }
}

static void soft_integrate_positions(const pe_soft_task *task, int begin, int end)
{
    const double *v = task->bodies->velocity[0].linear;
    double *d = task->bodies->displacement[0].linear, h = task->substep;
    for (int i = 8 * begin; i < 8 * end; ++i) {
        d[i] += h * v[i];
    }
}

static const pe_soft_kernel SOFT_KERNEL = {
    .block_size = sizeof(soft_block),
    .row_size = sizeof(soft_row),
    .friction_block_size = sizeof(friction_block),
    .friction_row_size = sizeof(friction_row),
    .lay_out = soft_lay_out,
    .prepare = soft_prepare,
    .warm_start = soft_warm_start,
    .bias = soft_bias,
    .relax = soft_relax,
    .store = soft_store,
    .integrate_velocities = soft_integrate_velocities,
    .integrate_positions = soft_integrate_positions,
};
