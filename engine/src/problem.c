#include "problem.h"

#include <string.h>

/* The scaled row of direction d at offset r from the centre of mass. */
static void fill(double j[6], const pe_mass *mass, const pe_mat3 *rotation, pe_vec3 r, pe_vec3 d,
                 double sign)
{
    pe_vec3 linear = pe_scale(sign * mass->inverse_root_mass, d);
    pe_vec3 angular =
        pe_mul(mass->inverse_root_inertia, pe_unrotate(rotation, pe_scale(sign, pe_cross(r, d))));
    j[0] = linear.x, j[1] = linear.y, j[2] = linear.z;
    j[3] = angular.x, j[4] = angular.y, j[5] = angular.z;
}

static double product(const pe_row *row, int k, int l)
{
    return pe_row_dot(row->ja[k], row->ja[l]) + pe_row_dot(row->jb[k], row->jb[l]);
}

static pe_vec3 point_velocity(const pe_motion *motion, pe_vec3 r)
{
    return pe_add(motion->velocity, pe_cross(motion->angular_velocity, r));
}

/* Gaps below this part of the contact margin count as closed. Without it the rounding of gaps
 * between faces that touch at four points asks for velocities that no rigid motion has, and a
 * sweeping solver shifts the load from corner to corner for ever to meet them. */
static const double TOUCHING = 1e-3;

/* b_n: see the head of problem.h. A bounce needs that the gap closes within the step. */
static double bias_of(const pe_world *world, const pe_manifold *m, const pe_point *point,
                      pe_vec3 ra, pe_vec3 rb, double dt)
{
    bool touching = point->separation <= TOUCHING * world->def.contact_margin;
    double gap = touching ? 0 : point->separation;
    if (m->restitution > 0) {
        const pe_motion *motions = pe_motions(world);
        double approach = pe_dot(m->normal, pe_sub(point_velocity(&motions[m->b], rb),
                                                   point_velocity(&motions[m->a], ra)));
        if (approach < -world->def.restitution_threshold && gap + dt * approach <= 0) {
            return m->restitution * approach;
        }
    }
    return gap / dt;
}

static void build_row(const pe_world *world, const pe_manifold *m, const pe_point *point,
                      const pe_vec3 direction[3], double dt, pe_row *row)
{
    const pe_pose *pa = &pe_poses(world)[m->a], *pb = &pe_poses(world)[m->b];
    pe_vec3 ra = pe_sub(point->position, pa->position);
    pe_vec3 rb = pe_sub(point->position, pb->position);
    row->a = m->a;
    row->b = m->b;
    for (int k = 0; k < 3; ++k) {
        fill(row->ja[k], &pe_masses(world)[m->a], &pa->rotation, ra, direction[k], -1);
        fill(row->jb[k], &pe_masses(world)[m->b], &pb->rotation, rb, direction[k], 1);
    }
    double wnn = product(row, 0, 0), w11 = product(row, 1, 1), w22 = product(row, 2, 2);
    double w12 = product(row, 1, 2), half = 0.5 * (w11 - w22);
    row->bias = bias_of(world, m, point, ra, rb, dt);
    row->friction = m->friction;
    row->inverse_wnn = 1 / wnn;
    row->inverse_wtt = 1 / (0.5 * (w11 + w22) + sqrt(half * half + w12 * w12));
    row->wn1 = product(row, 0, 1);
    row->wn2 = product(row, 0, 2);
    row->scale = (wnn + w11 + w22) / 3;
}

/* y* of every slot; static ones stay 0. */
static void scale_velocities(const pe_world *world, const pe_motion *predicted,
                             double (*y)[PE_LANES])
{
    memset(y, 0, (size_t)world->slot_count * sizeof *y);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        const pe_mass *mass = &pe_masses(world)[slot];
        pe_vec3 v = pe_scale(mass->mass * mass->inverse_root_mass, predicted[slot].velocity);
        pe_vec3 w =
            pe_mul(pe_mul(mass->inertia, mass->inverse_root_inertia),
                   pe_unrotate(&pe_poses(world)[slot].rotation, predicted[slot].angular_velocity));
        y[slot][0] = v.x, y[slot][1] = v.y, y[slot][2] = v.z;
        y[slot][3] = w.x, y[slot][4] = w.y, y[slot][5] = w.z;
    }
}

pe_status pe_problems_build(pe_world *world, const pe_islands *islands, const pe_motion *predicted,
                            double dt, pe_problems *problems, pe_error *error)
{
    size_t count = (size_t)world->contacts.point_count, slots = (size_t)world->slot_count;
    pe_row *rows = pe_scratch(world, count + 1, sizeof *rows);
    double(*impulse)[3] = pe_scratch(world, count + 1, sizeof *impulse);
    double(*velocity)[PE_LANES] = pe_scratch(world, slots, sizeof *velocity);
    double(*free_velocity)[PE_LANES] = pe_scratch(world, slots, sizeof *free_velocity);
    double(*spare)[PE_LANES] = pe_scratch(world, slots, sizeof *spare);
    int *row_start = pe_scratch(world, (size_t)islands->count + 1, sizeof *row_start);
    int *point_of = pe_scratch(world, count + 1, sizeof *point_of);
    int *manifold_of = pe_scratch(world, count + 1, sizeof *manifold_of);
    if (rows == NULL || impulse == NULL || velocity == NULL || free_velocity == NULL ||
        spare == NULL || row_start == NULL || point_of == NULL || manifold_of == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", count);
    }
    scale_velocities(world, predicted, free_velocity);
    memcpy(velocity, free_velocity, slots * sizeof *velocity);

    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    const pe_point *points = pe_points(&world->contacts);
    int filled = 0;
    for (int k = 0; k < islands->count; ++k) {
        row_start[k] = filled;
        for (int i = islands->start[k]; i < islands->start[k + 1]; ++i) {
            const pe_manifold *m = &manifolds[islands->manifolds[i]];
            pe_vec3 direction[3] = {m->normal};
            pe_tangents(m->normal, &direction[1], &direction[2]);
            for (int j = m->first; j < m->first + m->count; ++j, ++filled) {
                build_row(world, m, &points[j], direction, dt, &rows[filled]);
                for (int q = 0; q < 3; ++q) {
                    impulse[filled][q] = pe_dot(direction[q], points[j].impulse);
                }
                point_of[filled] = j;
                manifold_of[filled] = islands->manifolds[i];
            }
        }
    }
    row_start[islands->count] = filled;
    *problems = (pe_problems){
        .all = {.count = filled,
                .rows = rows,
                .impulse = impulse,
                .velocity = velocity,
                .free_velocity = (const double(*)[PE_LANES])free_velocity},
        .row_start = row_start,
        .point_of = point_of,
        .manifold_of = manifold_of,
        .spare = spare,
    };
    return PE_OK;
}

pe_problem pe_problems_island(const pe_problems *problems, int k)
{
    pe_problem island = problems->all;
    island.rows += problems->row_start[k];
    island.impulse += problems->row_start[k];
    island.count = problems->row_start[k + 1] - problems->row_start[k];
    return island;
}

void pe_problems_store_impulses(pe_world *world, const pe_problems *problems)
{
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    pe_point *points = pe_points(&world->contacts);
    for (int i = 0; i < problems->all.count; ++i) {
        pe_vec3 n = manifolds[problems->manifold_of[i]].normal, t1, t2;
        const double *p = problems->all.impulse[i];
        pe_tangents(n, &t1, &t2);
        points[problems->point_of[i]].impulse =
            pe_madd(pe_madd(pe_scale(p[0], n), p[1], t1), p[2], t2);
    }
}

void pe_problem_rebuild_velocity(const pe_problem *problem)
{
    for (int i = 0; i < problem->count; ++i) {
        const pe_row *row = &problem->rows[i];
        memcpy(problem->velocity[row->a], problem->free_velocity[row->a],
               sizeof problem->velocity[0]);
        memcpy(problem->velocity[row->b], problem->free_velocity[row->b],
               sizeof problem->velocity[0]);
    }
    for (int i = 0; i < problem->count; ++i) {
        const pe_row *row = &problem->rows[i];
        for (int k = 0; k < 3; ++k) {
            double p = problem->impulse[i][k];
            if (p != 0) {
                pe_row_add(problem->velocity[row->a], p, row->ja[k]);
                pe_row_add(problem->velocity[row->b], p, row->jb[k]);
            }
        }
    }
}

/* The natural map of one point with friction; see problem.h. */
static double cone_residual(const pe_row *row, const double p[3], const double u[3])
{
    double mu = row->friction, w = row->scale;
    double slip = sqrt(u[1] * u[1] + u[2] * u[2]);
    double z[3] = {p[0] - (u[0] + mu * slip) / w, p[1] - u[1] / w, p[2] - u[2] / w};
    /* The projection of z on the cone K. */
    double along = sqrt(z[1] * z[1] + z[2] * z[2]);
    if (mu * along <= -z[0]) {
        z[0] = z[1] = z[2] = 0;
    } else if (along > mu * z[0]) {
        double n = (z[0] + mu * along) / (1 + mu * mu);
        z[1] *= mu * n / along;
        z[2] *= mu * n / along;
        z[0] = n;
    }
    double d[3] = {p[0] - z[0], p[1] - z[1], p[2] - z[2]};
    return w * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

double pe_problem_residual(const pe_problem *problem)
{
    double worst = 0;
    for (int i = 0; i < problem->count; ++i) {
        const pe_row *row = &problem->rows[i];
        const double *p = problem->impulse[i];
        const double *ya = problem->velocity[row->a], *yb = problem->velocity[row->b];
        double u[3] = {pe_row_velocity(row, 0, ya, yb) + row->bias, 0, 0};
        if (p[0] == 0 && u[0] >= 0) {
            continue; /* open: no impulse, no approach */
        }
        double e;
        if (row->friction > 0) {
            u[1] = pe_row_velocity(row, 1, ya, yb);
            u[2] = pe_row_velocity(row, 2, ya, yb);
            e = cone_residual(row, p, u);
        } else {
            e = row->scale * fabs(p[0] - pe_max(0, p[0] - u[0] / row->scale));
        }
        worst = e > worst || e != e ? e : worst;
    }
    return worst;
}
