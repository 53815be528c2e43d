/* The rows of soft contact for PE_WIDTH lanes, and how they are made.
 *
 * A block is up to PE_WIDTH contacts of one batch, one per lane. With the normal n from body A to
 * body B and r from a body's centre of mass to the point, the normal velocity of a point is, in the
 * scaled axes of solver_body.h,
 *
 *   vn = n.(vB - vA) + jA.wA + jB.wB,    jA = S_A (n x rA),  jB = S_B (rB x n),  S = to_scaled
 *
 * and an impulse p along n does  vA -= mA p n,  wA += p jA,  vB += mB p n,  wB += p jB.
 *
 * Friction: the points of a manifold lie in one plane, so that their tangential velocities follow
 * from three numbers, the velocities (c1, c2) at the centre and the angular velocity w about n:
 *
 *   v1 = c1 - y w,   v2 = c2 + x w,     (x, y) the place in the plane from the centre
 *
 * Each point has its own disc |pt| <= mu pn. All points take one step of projected gradient descent
 * at once, pt <- disc(pt - vt / lambda), with lambda the largest eigenvalue of the matrix that
 * takes the points' impulses to their velocities. The step is the same in all directions, so that
 * friction is exactly opposed to sliding, and the points' different bounds give the friction
 * torque.
 *
 * Lanes without a contact have rows of zeros, which act on body 0. */
#ifndef PE_SOFT_ROWS_H
#define PE_SOFT_ROWS_H

#include "body_lanes.h"
#include "kernels.h"

#include <string.h>

/* A group of manifolds that are solved at once, one per lane. */
typedef struct soft_block {
    wide normal[3];
    wide inverse_mass;            /* mA + mB */
    int a[PE_WIDTH], b[PE_WIDTH]; /* solver bodies */
    int contact;                  /* the first lane's, in the plan */
    int lanes;                    /* that have a contact */
    int count;                    /* points */
    int row;                      /* the first point's */
    int friction, friction_row;   /* places in the friction arrays; friction is -1 when smooth */
    bool hard;                    /* against a static body */
} soft_block;

/* A normal row: one point of each manifold of a group, a manifold per lane. */
typedef struct soft_row {
    wide jA[3], jB[3];
    wide mass;    /* effective mass 1/(J M^-1 J^T) */
    wide gap;     /* at the step's start */
    wide impulse; /* in this sub-step */
    wide sum;     /* over the sub-steps */
} soft_row;

/* The friction of a group of manifolds, a manifold per lane. */
typedef struct friction_block {
    wide tangent[2][3];
    wide jA[3][3], jB[3][3]; /* along the two tangents at the centre, and about the normal */
    wide step;               /* 1/lambda */
    wide friction;
} friction_block;

/* The friction of one point of each manifold of a group. */
typedef struct friction_row {
    wide x, y;
    wide impulse[2], sum[2];
} friction_row;

/* n.(vB - vA) */
PE_INLINE wide relative_velocity(const wide direction[3], const wide_pair *p)
{
    wide d[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = p->vB[k] - p->vA[k];
    }
    return wide_dot(direction, d);
}

/* ---- Preparation ---- */

/* Frames of the bodies, one a lane. */
typedef struct wide_frame {
    wide to_scaled[9], position[3];
    wide unused[4];
} wide_frame;

/* The frames of the two bodies of each manifold of a group. */
typedef struct frame_pair {
    wide_frame a, b;
} frame_pair;

/* Reads the frames of the bodies `index`, one per lane. */
PE_INLINE void load_frame(const pe_solver_body_frame *frames, const int index[PE_WIDTH],
                          wide_frame *frame)
{
    const double *first[PE_WIDTH], *second[PE_WIDTH];
    for (int l = 0; l < PE_WIDTH; ++l) {
        first[l] = frames[index[l]].to_scaled;
        second[l] = first[l] + 8;
    }
    wide column[16];
    wide_columns(first, column);
    wide_columns(second, column + 8);
    memcpy(frame, column, sizeof column);
}

/* Takes a world vector a to a scaled row: out = m a, with m row-major. */
PE_INLINE void to_scaled(const wide m[9], const wide a[3], wide out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] = m[3 * k] * a[0] + m[3 * k + 1] * a[1] + m[3 * k + 2] * a[2];
    }
}

/* jA and jB of the row along `direction` at the world point x. */
PE_INLINE void make_row(const frame_pair *f, const wide direction[3], const wide x[3], wide jA[3],
                        wide jB[3])
{
    wide rA[3], rB[3], moment[3];
    for (int k = 0; k < 3; ++k) {
        rA[k] = x[k] - f->a.position[k];
        rB[k] = x[k] - f->b.position[k];
    }
    wide_cross(direction, rA, moment);
    to_scaled(f->a.to_scaled, moment, jA);
    wide_cross(rB, direction, moment);
    to_scaled(f->b.to_scaled, moment, jB);
}

/* Two unit vectors that make a right-handed frame (t1, t2, n) with the unit vector n, without a
 * branch (Duff et al. 2017, "Building an orthonormal basis, revisited"). */
PE_INLINE void make_tangents(const wide n[3], wide t[2][3])
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
PE_INLINE wide larger_eigenvalue(wide a, wide b, wide square)
{
    wide half = wide_of(0.5), d = half * (a - b);
    return half * (a + b) + wide_sqrt(d * d + square);
}

/* An upper bound of lambda for `count` points at the mean square distance spread/count from the
 * centre. It is exact where tangents and spin do not couple. */
PE_INLINE wide find_lambda(const friction_block *f, wide inverse_mass, wide count, wide spread)
{
    wide k[3][3];
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) {
            k[i][j] = wide_dot(f->jA[i], f->jA[j]) + wide_dot(f->jB[i], f->jB[j]);
        }
    }
    wide tangential = count * larger_eigenvalue(inverse_mass + k[0][0], inverse_mass + k[1][1],
                                                k[0][1] * k[0][1]);
    wide coupling = count * spread * (k[0][2] * k[0][2] + k[1][2] * k[1][2]);
    return larger_eigenvalue(tangential, spread * k[2][2], coupling);
}

/* The manifold points of a block. */
typedef struct point_lanes {
    wide position[PE_SOFT_POINTS][3];
    wide impulse[PE_SOFT_POINTS][3];
    wide gap[PE_SOFT_POINTS];
    wide friction;
} point_lanes;

/* Fills the friction of a block: its tangents, its step, and a row for each point. */
PE_INLINE void prepare_friction(const pe_soft_task *task, const soft_block *c,
                                const frame_pair *frames, const point_lanes *points)
{
    friction_block *f = (friction_block *)task->friction_blocks + c->friction;
    friction_row *rows = (friction_row *)task->friction_rows + c->friction_row;
    wide zero = wide_of(0), part = wide_of(1.0 / c->count), spread = zero;
    wide per_substep = wide_of(1.0 / task->substeps);
    wide centre[3] = {zero, zero, zero};
    for (int j = 0; j < c->count; ++j) {
        wide_add(centre, part, points->position[j]);
    }
    make_tangents(c->normal, f->tangent);
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
        make_row(frames, f->tangent[q], centre, f->jA[q], f->jB[q]);
    }
    wide opposite[3] = {zero - c->normal[0], zero - c->normal[1], zero - c->normal[2]};
    to_scaled(frames->a.to_scaled, opposite, f->jA[2]);
    to_scaled(frames->b.to_scaled, c->normal, f->jB[2]);
    f->step = wide_inverse(find_lambda(f, c->inverse_mass, wide_of(c->count), spread));
    f->friction = points->friction;
}

/* Fills the normal rows of a block. */
PE_INLINE void prepare_normals(const pe_soft_task *task, const soft_block *c,
                               const frame_pair *frames, const point_lanes *points)
{
    soft_row *rows = (soft_row *)task->rows + c->row;
    wide zero = wide_of(0), per_substep = wide_of(1.0 / task->substeps);
    for (int j = 0; j < c->count; ++j) {
        soft_row *r = &rows[j];
        make_row(frames, c->normal, points->position[j], r->jA, r->jB);
        r->mass = wide_inverse(c->inverse_mass + wide_dot(r->jA, r->jA) + wide_dot(r->jB, r->jB));
        r->gap = points->gap[j];
        r->impulse = wide_max(per_substep * wide_dot(c->normal, points->impulse[j]), zero);
        r->sum = zero;
    }
}

/* Gathers the manifolds and points of the block's contacts, and its bodies. */
PE_INLINE void load_block(const pe_soft_task *task, soft_block *c, point_lanes *points)
{
    static const pe_manifold no_manifold;
    static const pe_manifold_point no_point;
    const double *normal[PE_WIDTH], *friction[PE_WIDTH];
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
        for (int j = 0; j < c->count; ++j) {
            const pe_manifold_point *point =
                contact != NULL ? &task->points[contact->point[j]] : &no_point;
            position[j][l] = (const double *)&point->position;
            impulse[j][l] = (const double *)&point->impulse;
            gap[j][l] = &point->separation;
        }
    }
    for (int k = 0; k < 3; ++k) {
        c->normal[k] = wide_gather(normal, k);
        for (int j = 0; j < c->count; ++j) {
            points->position[j][k] = wide_gather(position[j], k);
            points->impulse[j][k] = wide_gather(impulse[j], k);
        }
    }
    for (int j = 0; j < c->count; ++j) {
        points->gap[j] = wide_gather(gap[j], 0);
    }
    points->friction = wide_gather(friction, 0);
}

/* Fills a block whose contact, lanes, count and places in the arrays are set. Where a point is
 * deeper than `deepest`, that becomes its depth. */
static void prepare_block(const pe_soft_task *task, soft_block *c, wide *deepest)
{
    point_lanes points;
    frame_pair frames;
    wide_pair p;
    load_block(task, c, &points);
    load_frame(task->bodies->frame, c->a, &frames.a);
    load_frame(task->bodies->frame, c->b, &frames.b);
    for (int j = 0; j < c->count; ++j) {
        *deepest = wide_max(*deepest, wide_of(0) - points.gap[j]);
    }
    wide_load_pair(task->bodies->velocity, c->a, c->b, &p);
    c->inverse_mass = p.mA + p.mB;
    prepare_normals(task, c, &frames, &points);
    if (c->friction >= 0) {
        prepare_friction(task, c, &frames, &points);
    }
}

/* Prefetches the contacts from `first` on. The points lie in the order of the pairs, which the
 * processor cannot guess from the order of the colours. */
PE_INLINE void fetch_ahead(const pe_soft_task *task, int first)
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

static void soft_lay_out(pe_soft_task *task)
{
    soft_block *blocks = task->blocks;
    int row_count = 0, friction_count = 0, friction_row_count = 0;
    task->block_count = 0;
    for (int q = 0; q < task->plan->batch_count; ++q) {
        const pe_soft_batch *batch = &task->plan->batches[q];
        int most = batch->serial ? 1 : PE_WIDTH;
        for (int i = 0; i < batch->count; i += most) {
            soft_block *c = &blocks[task->block_count++];
            c->contact = batch->first + i;
            c->lanes = batch->count - i < most ? batch->count - i : most;
            c->count = batch->points;
            c->hard = batch->hard;
            c->row = row_count;
            c->friction = batch->rough ? friction_count++ : -1;
            c->friction_row = friction_row_count;
            row_count += c->count;
            friction_row_count += batch->rough ? c->count : 0;
        }
    }
}

static void soft_prepare(const pe_soft_task *task, int begin, int end)
{
    wide deepest = wide_of(0);
    for (int i = begin; i < end; ++i) {
        soft_block *c = (soft_block *)task->blocks + i;
        fetch_ahead(task, c->contact + c->lanes);
        prepare_block(task, c, &deepest);
    }
    double depth[PE_WIDTH], *most = &task->depth[begin / PE_SOFT_GRAIN];
    wide_store(depth, deepest);
    *most = 0;
    for (int l = 0; l < PE_WIDTH; ++l) {
        *most = pe_max(*most, depth[l]);
    }
}

#endif
