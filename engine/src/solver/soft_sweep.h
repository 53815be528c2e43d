/* The kernels, for PE_WIDTH lanes; included by one file a width, which names the table PE_KERNEL.
 *
 * A block is up to PE_WIDTH manifolds of one batch, one a lane. With n from a to b and r from the
 * centre of mass to the point, a point's normal row is, in the scaled axes of line.h,
 *
 *   u_n = n.(v_b - v_a) + ja.w'_a + jb.w'_b,    ja = L_a (n x r_a),  jb = L_b (r_b x n),  L = turn
 *
 * and an impulse p along n does  v -+= n p/m,  w'_a += ja p,  w'_b += jb p.
 *
 * Friction: the points of a manifold lie in one plane, so that their tangential velocities follow
 * from three numbers, those at the centre and the spin about n:
 *
 *   u1 = c1 - y s,   u2 = c2 + x s,     (x, y) in the plane from the centre
 *
 * Each point has its own disc |p_t| <= mu p_n, and all points take one step of projected gradient
 * descent at once, p_t <- disc(p_t - u_t / lambda), with lambda the largest eigenvalue of what the
 * points' impulses do to their velocities. The step is the same in all directions, so that sliding
 * is opposed exactly; from the weight's four corners follows the torque of friction.
 *
 * Lanes without a manifold have rows of zeros, which act on line 0. */
#include "body_lanes.h"
#include "soft_kernel.h"

#include <string.h>

typedef struct block {
    wide normal[3];
    wide inverse_mass;            /* of both bodies together */
    int a[PE_WIDTH], b[PE_WIDTH]; /* lines */
    int contact;                  /* the first lane's, in the plan */
    int lanes;                    /* that have a contact */
    int count;                    /* points */
    int row;                      /* the first point's */
    int friction, friction_row;   /* -1 when smooth */
    bool hard;                    /* against a static body */
} block;

typedef struct row {
    wide ja[3], jb[3];
    wide mass;    /* 1/(J M^-1 J^T) */
    wide gap;     /* at the step's start */
    wide impulse; /* in this substep */
    wide sum;     /* over the substeps */
} row;

typedef struct friction_block {
    wide tangent[2][3];
    wide ja[3][3], jb[3][3]; /* along the two tangents at the centre, and about the normal */
    wide step;               /* 1/lambda */
    wide friction;
} friction_block;

typedef struct friction_row {
    wide x, y;
    wide impulse[2], sum[2];
} friction_row;

/* Speed at which a point must leave; 0: it does not bounce. */
typedef wide bounce;

/* to += s a */
static inline void add(wide to[3], wide s, const wide a[3])
{
    for (int k = 0; k < 3; ++k) {
        to[k] += s * a[k];
    }
}

/* m a, m row-major */
static inline void turned(const wide m[9], const wide a[3], wide out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] = m[3 * k] * a[0] + m[3 * k + 1] * a[1] + m[3 * k + 2] * a[2];
    }
}

/* Along `direction`, the velocity of b less that of a. */
static inline wide relative(const wide direction[3], const wide_body *a, const wide_body *b)
{
    wide d[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = b->linear[k] - a->linear[k];
    }
    return wide_dot(direction, d);
}

static inline void push(const wide impulse[3], wide_body *a, wide_body *b)
{
    for (int k = 0; k < 3; ++k) {
        a->linear[k] -= a->inverse_mass * impulse[k];
        b->linear[k] += b->inverse_mass * impulse[k];
    }
}

static inline void push_along(const wide direction[3], wide size, wide_body *a, wide_body *b)
{
    wide impulse[3];
    for (int k = 0; k < 3; ++k) {
        impulse[k] = size * direction[k];
    }
    push(impulse, a, b);
}

/* ---- Preparation */

/* A body a lane as its rows need it. */
typedef struct wide_frame {
    wide turn[9], position[3];
    wide unused[4];
} wide_frame;

static inline void load_frame(const pe_solver_body_frame *frames, const int index[PE_WIDTH],
                              wide_frame *frame)
{
    const double *from[PE_WIDTH], *second[PE_WIDTH];
    for (int l = 0; l < PE_WIDTH; ++l) {
        from[l] = frames[index[l]].turn;
        second[l] = from[l] + 8;
    }
    wide column[16];
    wide_columns(from, column);
    wide_columns(second, column + 8);
    memcpy(frame, column, sizeof column);
}

typedef struct pair {
    wide_frame a, b;
} pair;

/* The two halves of the row along `direction` at the world point x. */
static inline void make_row(const pair *p, const wide direction[3], const wide x[3], wide ja[3],
                            wide jb[3])
{
    wide ra[3], rb[3], arm[3];
    for (int k = 0; k < 3; ++k) {
        ra[k] = x[k] - p->a.position[k];
        rb[k] = x[k] - p->b.position[k];
    }
    wide_cross(direction, ra, arm);
    turned(p->a.turn, arm, ja);
    wide_cross(rb, direction, arm);
    turned(p->b.turn, arm, jb);
}

/* Two unit vectors that make a right-handed frame (t1, t2, n) with the unit vector n, without a
 * branch (Duff et al. 2017, "Building an orthonormal basis, revisited"). */
static inline void tangents(const wide n[3], wide t[2][3])
{
    wide zero = wide_of(0), one = wide_of(1);
    wide sign = wide_select(zero, n[2], zero - one, one);
    wide p = (zero - one) / (sign + n[2]), q = n[0] * n[1] * p;
    t[0][0] = one + sign * n[0] * n[0] * p;
    t[0][1] = sign * q;
    t[0][2] = zero - sign * n[0];
    t[1][0] = q;
    t[1][1] = sign + n[1] * n[1] * p;
    t[1][2] = zero - n[1];
}

/* Larger eigenvalue of the symmetric matrix [a c; c b]; `square` is c squared. */
static inline wide larger_eigenvalue(wide a, wide b, wide square)
{
    wide half = wide_of(0.5), d = half * (a - b);
    return half * (a + b) + wide_sqrt(d * d + square);
}

/* An upper bound of lambda, exact when tangents and spin do not couple: count points at the mean
 * square distance spread/count from the centre, and the 3 x 3 matrix of the friction_block's three
 * rows. */
static inline wide lambda_of(const friction_block *f, wide inverse_mass, wide count, wide spread)
{
    wide k[3][3];
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            k[i][j] = wide_dot(f->ja[i], f->ja[j]) + wide_dot(f->jb[i], f->jb[j]);
        }
    }
    wide tangential = count * larger_eigenvalue(inverse_mass + k[0][0], inverse_mass + k[1][1],
                                                k[0][1] * k[0][1]);
    wide coupling = count * spread * (k[0][2] * k[0][2] + k[1][2] * k[1][2]);
    return larger_eigenvalue(tangential, spread * k[2][2], coupling);
}

/* The contact points of a block, as they come. */
typedef struct point_lanes {
    wide position[PE_SOFT_POINTS][3];
    wide impulse[PE_SOFT_POINTS][3];
    wide gap[PE_SOFT_POINTS];
} point_lanes;

static inline void prepare_friction(const pe_soft_task *task, const block *c, const pair *p,
                                    const point_lanes *points, wide friction, friction_block *f,
                                    friction_row *rows)
{
    wide zero = wide_of(0), part = wide_of(1.0 / c->count), spread = zero;
    wide per_substep = wide_of(1.0 / task->substeps);
    wide centre[3] = {zero, zero, zero};
    for (int j = 0; j < c->count; ++j) {
        add(centre, part, points->position[j]);
    }
    tangents(c->normal, f->tangent);
    for (int j = 0; j < c->count; ++j) {
        wide e[3];
        for (int k = 0; k < 3; ++k) {
            e[k] = points->position[j][k] - centre[k];
        }
        rows[j].x = wide_dot(f->tangent[0], e);
        rows[j].y = wide_dot(f->tangent[1], e);
        spread += rows[j].x * rows[j].x + rows[j].y * rows[j].y;
        for (int q = 0; q < 2; ++q) {
            rows[j].impulse[q] = per_substep * wide_dot(f->tangent[q], points->impulse[j]);
            rows[j].sum[q] = zero;
        }
    }
    for (int q = 0; q < 2; ++q) {
        make_row(p, f->tangent[q], centre, f->ja[q], f->jb[q]);
    }
    wide opposite[3] = {zero - c->normal[0], zero - c->normal[1], zero - c->normal[2]};
    turned(p->a.turn, opposite, f->ja[2]);
    turned(p->b.turn, c->normal, f->jb[2]);
    f->step = wide_inverse(lambda_of(f, c->inverse_mass, wide_of(c->count), spread));
    f->friction = friction;
}

static inline void prepare_normals(const pe_soft_task *task, const block *c, const pair *p,
                                   const point_lanes *points, row *rows)
{
    wide zero = wide_of(0), per_substep = wide_of(1.0 / task->substeps);
    for (int j = 0; j < c->count; ++j) {
        row *r = &rows[j];
        make_row(p, c->normal, points->position[j], r->ja, r->jb);
        r->mass = wide_inverse(c->inverse_mass + wide_dot(r->ja, r->ja) + wide_dot(r->jb, r->jb));
        r->gap = points->gap[j];
        r->impulse = wide_max(per_substep * wide_dot(c->normal, points->impulse[j]), zero);
        r->sum = zero;
    }
}

static inline void prepare_bounces(const pe_soft_task *task, const block *c, wide restitution,
                                   const row *rows, bounce *bounces)
{
    wide zero = wide_of(0), threshold = wide_of(task->threshold);
    wide_body a = wide_load(task->lines->velocity, c->a);
    wide_body b = wide_load(task->lines->velocity, c->b);
    wide q = relative(c->normal, &a, &b);
    for (int j = 0; j < c->count; ++j) {
        wide approach =
            zero - (q + (wide_dot(rows[j].ja, a.angular) + wide_dot(rows[j].jb, b.angular)));
        bounces[j] = wide_select(approach, threshold, restitution * approach, zero);
    }
}

/* Fills block c, whose contact, lanes, count and places in the arrays are set; `deepest` becomes
 * the penetration in each lane where it is more. */
static void prepare_block(const pe_soft_task *task, block *c, wide *deepest)
{
    static const pe_manifold no_manifold;
    static const pe_manifold_point no_point;
    const double *normal[PE_WIDTH], *friction[PE_WIDTH], *restitution[PE_WIDTH];
    const double *position[PE_SOFT_POINTS][PE_WIDTH], *impulse[PE_SOFT_POINTS][PE_WIDTH];
    const double *gap[PE_SOFT_POINTS][PE_WIDTH];
    for (int l = 0; l < PE_WIDTH; ++l) {
        const pe_soft_contact *contact =
            l < c->lanes ? &task->plan->contacts[c->contact + l] : NULL;
        const pe_manifold *m = contact != NULL ? &task->manifolds[contact->manifold] : &no_manifold;
        c->a[l] = contact != NULL ? contact->a : 0;
        c->b[l] = contact != NULL ? contact->b : 0;
        normal[l] = (const double *)&m->normal;
        friction[l] = &m->friction;
        restitution[l] = &m->restitution;
        for (int j = 0; j < c->count; ++j) {
            const pe_manifold_point *point =
                contact != NULL ? &task->points[contact->point[j]] : &no_point;
            position[j][l] = (const double *)&point->position;
            impulse[j][l] = (const double *)&point->impulse;
            gap[j][l] = &point->separation;
        }
    }
    pair p;
    load_frame(task->lines->frame, c->a, &p.a);
    load_frame(task->lines->frame, c->b, &p.b);
    point_lanes points;
    for (int k = 0; k < 3; ++k) {
        c->normal[k] = wide_gather(normal, k);
        for (int j = 0; j < c->count; ++j) {
            points.position[j][k] = wide_gather(position[j], k);
            points.impulse[j][k] = wide_gather(impulse[j], k);
        }
    }
    for (int j = 0; j < c->count; ++j) {
        points.gap[j] = wide_gather(gap[j], 0);
        *deepest = wide_max(*deepest, wide_of(0) - points.gap[j]);
    }
    wide_body a = wide_load(task->lines->velocity, c->a);
    wide_body b = wide_load(task->lines->velocity, c->b);
    c->inverse_mass = a.inverse_mass + b.inverse_mass;

    row *rows = (row *)task->rows + c->row;
    prepare_normals(task, c, &p, &points, rows);
    if (c->friction >= 0) {
        prepare_friction(task, c, &p, &points, wide_gather(friction, 0),
                         (friction_block *)task->friction_blocks + c->friction,
                         (friction_row *)task->friction_rows + c->friction_row);
    }
    if (task->bounces != NULL) {
        prepare_bounces(task, c, wide_gather(restitution, 0), rows,
                        (bounce *)task->bounces + c->row);
    }
}

/* Calls for what the contacts from `first` on will need: the points lie in the order of the pairs,
 * which no processor can guess from that of the colours. */
static inline void fetch_ahead(const pe_soft_task *task, int first)
{
    for (int i = first; i < first + PE_WIDTH && i < task->plan->count; ++i) {
        const pe_soft_contact *contact = &task->plan->contacts[i];
        wide_fetch(&task->manifolds[contact->manifold]);
        for (int j = 0; j < contact->count; ++j) {
            wide_fetch(&task->points[contact->point[j]]);
            wide_fetch(&task->points[contact->point[j]].impulse);
        }
    }
}

static void prepare(pe_soft_task *task)
{
    wide deepest = wide_of(0);
    block *blocks = task->blocks;
    int row_count = 0, friction_count = 0, friction_row_count = 0;
    task->block_count = 0;
    for (int q = 0; q < task->plan->batch_count; ++q) {
        const pe_soft_batch *batch = &task->plan->batches[q];
        int most = batch->serial ? 1 : PE_WIDTH;
        for (int i = 0; i < batch->count; i += most) {
            block *c = &blocks[task->block_count++];
            c->contact = batch->first + i;
            c->lanes = batch->count - i < most ? batch->count - i : most;
            c->count = batch->points;
            c->hard = batch->hard;
            c->row = row_count;
            c->friction = batch->rough ? friction_count++ : -1;
            c->friction_row = friction_row_count;
            row_count += c->count;
            friction_row_count += batch->rough ? c->count : 0;
            fetch_ahead(task, c->contact + c->lanes);
            prepare_block(task, c, &deepest);
        }
    }
    double depth[PE_WIDTH];
    wide_store(depth, deepest);
    task->penetration = 0;
    for (int l = 0; l < PE_WIDTH; ++l) {
        task->penetration = pe_max(task->penetration, depth[l]);
    }
}

/* ---- Sweeps */

static void warm(const pe_soft_task *task)
{
    pe_solver_body *lines = task->lines->velocity;
    for (int i = 0; i < task->block_count; ++i) {
        const block *c = (const block *)task->blocks + i;
        const row *rows = (const row *)task->rows + c->row;
        wide_body a = wide_load(lines, c->a), b = wide_load(lines, c->b);
        wide zero = wide_of(0), total = zero;
        for (int j = 0; j < c->count; ++j) {
            total += rows[j].impulse;
            add(a.angular, rows[j].impulse, rows[j].ja);
            add(b.angular, rows[j].impulse, rows[j].jb);
        }
        push_along(c->normal, total, &a, &b);
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
                add(a.angular, sum[q], f->ja[q]);
                add(b.angular, sum[q], f->jb[q]);
            }
            push_along(f->tangent[0], sum[0], &a, &b);
            push_along(f->tangent[1], sum[1], &a, &b);
        }
        wide_save(lines, c->a, &a);
        wide_save(lines, c->b, &b);
    }
}

static void bias(const pe_soft_task *task)
{
    pe_solver_body *lines = task->lines->velocity;
    const pe_solver_body *moved = task->lines->displacement;
    wide zero = wide_of(0), one = wide_of(1);
    wide per_substep = wide_of(1 / task->substep), least = wide_of(-task->push_speed);
    for (int i = 0; i < task->block_count; ++i) {
        const block *c = (const block *)task->blocks + i;
        row *rows = (row *)task->rows + c->row;
        wide_body a = wide_load(lines, c->a), b = wide_load(lines, c->b);
        wide_body da = wide_load(moved, c->a), db = wide_load(moved, c->b);
        wide along = relative(c->normal, &a, &b), apart = relative(c->normal, &da, &db);
        const pe_soft_spring *spring = c->hard ? &task->hard_spring : &task->spring;
        wide rate = wide_of(spring->rate), mass_scale = wide_of(spring->mass_scale);
        wide impulse_scale = wide_of(spring->impulse_scale), total = zero;
        for (int j = 0; j < c->count; ++j) {
            row *r = &rows[j];
            wide u = along + (wide_dot(r->ja, a.angular) + wide_dot(r->jb, b.angular));
            wide s = r->gap + (apart + (wide_dot(r->ja, da.angular) + wide_dot(r->jb, db.angular)));
            /* A gap may close within the substep and no further; a penetration is a spring. */
            wide pushed = mass_scale * wide_max(rate * s, least);
            wide speed = wide_select(s, zero, s * per_substep, pushed);
            wide scale = wide_select(s, zero, one, mass_scale);
            wide leak = wide_select(s, zero, zero, impulse_scale);
            wide old = r->impulse;
            wide now = wide_max(old - (r->mass * (scale * u + speed) + leak * old), zero);
            wide delta = now - old;
            r->impulse = now;
            total += delta;
            along += delta * c->inverse_mass;
            add(a.angular, delta, r->ja);
            add(b.angular, delta, r->jb);
        }
        push_along(c->normal, total, &a, &b);
        wide_save(lines, c->a, &a);
        wide_save(lines, c->b, &b);
    }
}

static inline void relax_friction(const friction_block *f, friction_row *g, const row *rows,
                                  int count, wide_body *a, wide_body *b)
{
    wide zero = wide_of(0), u[3], sum[3] = {zero, zero, zero};
    for (int q = 0; q < 3; ++q) {
        u[q] = wide_dot(f->ja[q], a->angular) + wide_dot(f->jb[q], b->angular);
    }
    u[0] += relative(f->tangent[0], a, b);
    u[1] += relative(f->tangent[1], a, b);
    for (int j = 0; j < count; ++j) {
        wide x = g[j].x, y = g[j].y;
        wide p = g[j].impulse[0] - f->step * (u[0] - y * u[2]);
        wide q = g[j].impulse[1] - f->step * (u[1] + x * u[2]);
        wide bound = f->friction * rows[j].impulse, square = p * p + q * q;
        wide shrink = wide_select(square, bound * bound, bound / wide_sqrt(square), wide_of(1));
        p *= shrink;
        q *= shrink;
        wide dp = p - g[j].impulse[0], dq = q - g[j].impulse[1];
        g[j].impulse[0] = p;
        g[j].impulse[1] = q;
        g[j].sum[0] += p;
        g[j].sum[1] += q;
        sum[0] += dp;
        sum[1] += dq;
        sum[2] += x * dq - y * dp;
    }
    for (int q = 0; q < 3; ++q) {
        add(a->angular, sum[q], f->ja[q]);
        add(b->angular, sum[q], f->jb[q]);
    }
    wide impulse[3];
    for (int k = 0; k < 3; ++k) {
        impulse[k] = sum[0] * f->tangent[0][k] + sum[1] * f->tangent[1][k];
    }
    push(impulse, a, b);
}

static void relax(const pe_soft_task *task)
{
    pe_solver_body *lines = task->lines->velocity;
    wide zero = wide_of(0), per_step = wide_of(1 / (task->substep * task->substeps));
    for (int i = 0; i < task->block_count; ++i) {
        const block *c = (const block *)task->blocks + i;
        row *rows = (row *)task->rows + c->row;
        wide_body a = wide_load(lines, c->a), b = wide_load(lines, c->b);
        wide along = relative(c->normal, &a, &b), total = zero;
        for (int j = 0; j < c->count; ++j) {
            row *r = &rows[j];
            wide u = along + (wide_dot(r->ja, a.angular) + wide_dot(r->jb, b.angular));
            /* What was apart at the step's start may come near, as far as the step's end. */
            wide least = u + wide_max(r->gap, zero) * per_step;
            wide now = wide_max(r->impulse - r->mass * least, zero);
            wide delta = now - r->impulse;
            r->impulse = now;
            r->sum += now;
            total += delta;
            along += delta * c->inverse_mass;
            add(a.angular, delta, r->ja);
            add(b.angular, delta, r->jb);
        }
        push_along(c->normal, total, &a, &b);
        if (c->friction >= 0) {
            relax_friction((const friction_block *)task->friction_blocks + c->friction,
                           (friction_row *)task->friction_rows + c->friction_row, rows, c->count,
                           &a, &b);
        }
        wide_save(lines, c->a, &a);
        wide_save(lines, c->b, &b);
    }
}

static void bounce_off(const pe_soft_task *task)
{
    pe_solver_body *lines = task->lines->velocity;
    wide zero = wide_of(0);
    for (int i = 0; i < task->block_count; ++i) {
        const block *c = (const block *)task->blocks + i;
        row *rows = (row *)task->rows + c->row;
        const bounce *speeds = (const bounce *)task->bounces + c->row;
        wide_body a = wide_load(lines, c->a), b = wide_load(lines, c->b);
        wide along = relative(c->normal, &a, &b), total = zero;
        for (int j = 0; j < c->count; ++j) {
            row *r = &rows[j];
            wide u = along + (wide_dot(r->ja, a.angular) + wide_dot(r->jb, b.angular));
            wide now = wide_max(r->sum + r->mass * (speeds[j] - u), zero);
            /* Only what was to bounce, and was hit. */
            wide delta = wide_select(speeds[j], zero, now - r->sum, zero);
            delta = wide_select(r->sum, zero, delta, zero);
            r->sum += delta;
            total += delta;
            along += delta * c->inverse_mass;
            add(a.angular, delta, r->ja);
            add(b.angular, delta, r->jb);
        }
        push_along(c->normal, total, &a, &b);
        wide_save(lines, c->a, &a);
        wide_save(lines, c->b, &b);
    }
}

/* ---- Bodies and results */

static void store(const pe_soft_task *task)
{
    for (int i = 0; i < task->block_count; ++i) {
        const block *c = (const block *)task->blocks + i;
        const friction_block *f =
            c->friction < 0 ? NULL : (const friction_block *)task->friction_blocks + c->friction;
        for (int j = 0; j < c->count; ++j) {
            const row *r = (const row *)task->rows + c->row + j;
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

/* Lines as rows of eight numbers; a mass does not change, and what it adds to a displacement is
 * never read. */
static void advance(const pe_soft_task *task)
{
    double *v = task->lines->velocity[0].linear, *previous = task->lines->previous[0].linear;
    for (int i = 0; i < 8 * task->lines->count; ++i) {
        double now = v[i];
        v[i] = now + (now - previous[i]);
        previous[i] = now;
    }
}

static void drift(const pe_soft_task *task)
{
    const double *v = task->lines->velocity[0].linear;
    double *d = task->lines->displacement[0].linear, h = task->substep;
    for (int i = 0; i < 8 * task->lines->count; ++i) {
        d[i] += h * v[i];
    }
}

const pe_soft_kernel PE_KERNEL = {
    .lanes = PE_WIDTH,
    .block_size = sizeof(block),
    .row_size = sizeof(row),
    .friction_block_size = sizeof(friction_block),
    .friction_row_size = sizeof(friction_row),
    .bounce_size = sizeof(bounce),
    .prepare = prepare,
    .warm = warm,
    .bias = bias,
    .relax = relax,
    .bounce = bounce_off,
    .store = store,
    .advance = advance,
    .drift = drift,
};
