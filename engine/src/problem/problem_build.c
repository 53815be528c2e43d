#include "problem_build.h"

#include "midpoint.h"

/* Gaps and penetrations up to this, in m, are those of contacts that touch: what rounding and
 * tolerances leave at a step. A tenth of them is taken back at each, by the velocities, so that a
 * stack that stands for an hour stands where it stood: a tower of 1000 leans by a micrometre when
 * its contacts tilt by 1e-12. All of it at once would ask redundant contacts for velocities that no
 * rigid motion has. Deeper penetrations are the projection's. */
static const double TOUCHING = 1e-9;
static const double TAKEN_BACK = 0.1;

/* The part of a gap that must not close within the step. */
static double closable(double gap)
{
    double touching = pe_max(-TOUCHING, pe_min(TOUCHING, gap));
    return pe_max(0, gap - TOUCHING) + TAKEN_BACK * touching;
}

static pe_vec3 point_velocity(const pe_twist *motion, pe_vec3 r)
{
    return pe_add(motion->velocity, pe_cross(motion->angular_velocity, r));
}

/* b_n: see the head of problem.h. A bounce needs that the gap closes within the step. */
static double bias_of(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point,
                      double dt)
{
    double gap = closable(point->separation);
    if (m->restitution > 0) {
        const pe_twist *motions = pe_twists(world);
        pe_vec3 ra = pe_sub(point->position, pe_poses(world)[m->a].position);
        pe_vec3 rb = pe_sub(point->position, pe_poses(world)[m->b].position);
        double approach = pe_dot(m->normal, pe_sub(point_velocity(&motions[m->b], rb),
                                                   point_velocity(&motions[m->a], ra)));
        if (approach < -world->def.restitution_threshold && gap + dt * approach <= 0) {
            return m->restitution * approach;
        }
    }
    return gap / dt;
}

/* R diag(d) R^T as (xx, xy, xz, yy, yz, zz). */
static void turned(const pe_mat3 *rotation, pe_vec3 d, double m[6])
{
    pe_vec3 x = pe_axis(rotation, 0), y = pe_axis(rotation, 1), z = pe_axis(rotation, 2);
    m[0] = d.x * x.x * x.x + d.y * y.x * y.x + d.z * z.x * z.x;
    m[1] = d.x * x.x * x.y + d.y * y.x * y.y + d.z * z.x * z.y;
    m[2] = d.x * x.x * x.z + d.y * y.x * y.z + d.z * z.x * z.z;
    m[3] = d.x * x.y * x.y + d.y * y.y * y.y + d.z * z.y * z.y;
    m[4] = d.x * x.y * x.z + d.y * y.y * y.z + d.z * z.y * z.z;
    m[5] = d.x * x.z * x.z + d.y * y.z * y.z + d.z * z.z * z.z;
}

static pe_inertia inertia_of(const pe_mass *mass, const pe_mat3 *rotation)
{
    pe_inertia inertia = {.mass = mass->mass, .inverse_mass = mass->inverse_mass};
    pe_vec3 i = mass->inertia;
    if (mass->spherical) { /* the same in every frame, without rounding */
        inertia.tensor[0] = inertia.tensor[3] = inertia.tensor[5] = i.x;
        inertia.inverse_tensor[0] = inertia.inverse_tensor[3] = inertia.inverse_tensor[5] = 1 / i.x;
    } else {
        turned(rotation, i, inertia.tensor);
        turned(rotation, pe_v3(1 / i.x, 1 / i.y, 1 / i.z), inertia.inverse_tensor);
    }
    return inertia;
}

static void store3(double to[3], pe_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

static pe_vec3 centre_of(const pe_manifold_point *points, int count)
{
    pe_vec3 sum = {0};
    for (int i = 0; i < count; ++i) {
        sum = pe_add(sum, points[i].position);
    }
    return pe_scale(1.0 / count, sum);
}

/* The arrays of a problem, writable while it is being built. */
typedef struct filling {
    pe_inertia *inertia;
    double (*free_velocity)[6], (*velocity)[6];
    pe_solver_manifold *manifold;
    pe_solver_point *point;
    double (*impulse)[3];
    int *slot, *point_of;
    double *normal_change;
} filling;

static void fill_bodies(const pe_world *world, const int *slots, int count,
                        const pe_free_motion *free, const filling *f)
{
    for (int i = 0; i < count; ++i) {
        int slot = slots[i];
        f->slot[i] = slot;
        f->inertia[i] = inertia_of(&pe_masses(world)[slot], &pe_poses(world)[slot].rotation);
        pe_twist end = free != NULL ? free[slot].end : (pe_twist){0};
        store3(f->free_velocity[i], end.velocity);
        store3(f->free_velocity[i] + 3, end.angular_velocity);
    }
    f->inertia[count] = (pe_inertia){0};
    for (int k = 0; k < 6; ++k) {
        f->free_velocity[count][k] = 0;
    }
}

static void fill_manifold(const pe_world *world, const pe_islands *islands, const pe_manifold *m,
                          int statics, double dt, int first, pe_solver_manifold *manifold,
                          const filling *f)
{
    const pe_manifold_point *points = pe_manifold_points(&world->contacts) + m->first;
    pe_vec3 direction[3] = {m->normal}, centre = centre_of(points, m->count);
    pe_tangents(m->normal, &direction[1], &direction[2]);
    *manifold = (pe_solver_manifold){
        .a = islands->place[m->a] < 0 ? statics : islands->place[m->a],
        .b = islands->place[m->b] < 0 ? statics : islands->place[m->b],
        .first = first,
        .count = m->count,
        .friction = m->friction,
    };
    pe_vec3 xa = pe_poses(world)[m->a].position, xb = pe_poses(world)[m->b].position;
    store3(manifold->arm_a, pe_sub(centre, xa));
    store3(manifold->arm_b, pe_sub(centre, xb));
    for (int k = 0; k < 3; ++k) {
        store3(manifold->frame[k], direction[k]);
    }
    for (int j = 0; j < m->count; ++j) {
        pe_solver_point *point = &f->point[first + j];
        double ra[3], rb[3];
        pe_vec3 off = pe_sub(points[j].position, centre);
        store3(ra, pe_sub(points[j].position, xa));
        store3(rb, pe_sub(points[j].position, xb));
        for (int k = 0; k < 3; ++k) {
            point->s[k] = pe_dot(direction[k], off);
            f->impulse[first + j][k] = pe_dot(direction[k], points[j].impulse);
        }
        point->bias = bias_of(world, m, &points[j], dt);
        point->slip[0] = point->slip[1] = 0;
        point->scale = pe_point_scale(&f->inertia[manifold->a], &f->inertia[manifold->b], ra, rb);
        f->point_of[first + j] = m->first + j;
        f->normal_change[first + j] = 0;
    }
}

static bool take_arrays(pe_workspace work, size_t bodies, size_t manifolds, size_t points,
                        filling *f)
{
    *f = (filling){
        .inertia = pe_take(work, bodies + 1, sizeof *f->inertia),
        .free_velocity = pe_take(work, bodies + 1, sizeof *f->free_velocity),
        .velocity = pe_take(work, bodies + 1, sizeof *f->velocity),
        .manifold = pe_take(work, manifolds, sizeof *f->manifold),
        .point = pe_take(work, points, sizeof *f->point),
        .impulse = pe_take(work, points, sizeof *f->impulse),
        .slot = pe_take(work, bodies, sizeof *f->slot),
        .point_of = pe_take(work, points, sizeof *f->point_of),
        .normal_change = pe_take(work, points, sizeof *f->normal_change),
    };
    return f->inertia != NULL && f->free_velocity != NULL && f->velocity != NULL &&
           f->manifold != NULL && f->point != NULL && f->impulse != NULL && f->slot != NULL &&
           f->point_of != NULL && f->normal_change != NULL;
}

pe_status pe_problem_build(pe_world *world, const pe_islands *islands, int k,
                           const pe_free_motion *free, double dt, pe_island_problem *built,
                           pe_error *error)
{
    const pe_manifold *kept = pe_manifolds(&world->contacts);
    const int *listed = islands->manifolds + islands->start[k];
    int bodies = islands->body_start[k + 1] - islands->body_start[k];
    int count = islands->start[k + 1] - islands->start[k], points = 0;
    for (int i = 0; i < count; ++i) {
        points += kept[listed[i]].count;
    }
    filling f;
    if (!take_arrays(pe_step_memory(world), (size_t)bodies, (size_t)count, (size_t)points, &f)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d contact points", points);
    }
    fill_bodies(world, islands->bodies + islands->body_start[k], bodies, free, &f);
    for (int i = 0, first = 0; i < count; ++i) {
        const pe_manifold *m = &kept[listed[i]];
        fill_manifold(world, islands, m, bodies, dt, first, &f.manifold[i], &f);
        first += m->count;
    }
    *built = (pe_island_problem){
        .problem = {.body_count = bodies,
                    .manifold_count = count,
                    .point_count = points,
                    .inertia = f.inertia,
                    .free_velocity = (const double(*)[6])f.free_velocity,
                    .velocity = f.velocity,
                    .manifold = f.manifold,
                    .point = f.point,
                    .impulse = f.impulse},
        .slot = f.slot,
        .point_of = f.point_of,
        .normal_change = f.normal_change,
    };
    pe_problem_rebuild_velocity(&built->problem);
    if (free != NULL && world->def.profile != PE_PROFILE_FAST) {
        return pe_problem_to_midpoint(world, built, listed, free, dt, f.manifold, f.point,
                                      f.normal_change, error);
    }
    return PE_OK;
}

void pe_problem_store_impulses(pe_world *world, const pe_island_problem *built)
{
    const pe_problem *problem = &built->problem;
    pe_manifold_point *points = pe_manifold_points(&world->contacts);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        const double(*d)[3] = manifold->frame;
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            const double *p = problem->impulse[j];
            points[built->point_of[j]].impulse =
                pe_v3(d[0][0] * p[0] + d[1][0] * p[1] + d[2][0] * p[2],
                      d[0][1] * p[0] + d[1][1] * p[1] + d[2][1] * p[2],
                      d[0][2] * p[0] + d[1][2] * p[1] + d[2][2] * p[2]);
        }
    }
}
