/* A contact problem from the world: biases, inertia, frames, warm start. */
#include "problem_build.h"

#include "midpoint.h"

#include <string.h>

/* Gaps and penetrations up to this, in m, belong to contacts that touch: rounding and tolerances
 * leave them. A tenth of them is corrected in each step, by the velocities, so that a stack at rest
 * does not drift: a tower of 1000 leans by a micrometre when its contacts tilt by 1e-12. To correct
 * all of it at once would ask redundant contacts for velocities that no rigid motion has. What is
 * deeper than DEEP is left to position correction alone: bodies that are wedged cannot have these
 * velocities. */
static const double TOUCHING = 1e-9;
static const double CORRECTED = 0.1;
static const double DEEP = 2e-9;

/* The part of a gap that must not close within the step. */
static double closable(double gap)
{
    if (gap < -DEEP) {
        return 0;
    }
    double touching = pe_max(-TOUCHING, pe_min(TOUCHING, gap));
    return pe_max(0, gap - TOUCHING) + CORRECTED * touching;
}

/* Velocity at the end of the step without contacts. */
static const pe_twist *end_of(const pe_world *world, const pe_free_motion *free, int slot)
{
    return pe_bodies(world)[slot].is_static ? &pe_twists(world)[slot] : &free[slot].end;
}

/* Whether a bounce from this approach, in m/s, outlasts the step, at whose start it is. One that does
 * not would add energy, because its impulse also bears what pushes the bodies together. */
static bool outlasts(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point,
                     const pe_free_motion *free, double approach)
{
    if (free == NULL) {
        return true;
    }
    double end =
        pe_opening_speed(world, m, point, end_of(world, free, m->a), end_of(world, free, m->b));
    return (end - approach) - m->restitution * approach > 0;
}

/* b_n of problem.h. There is a bounce only if the gap closes within the step. */
static double bias_of(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point,
                      const pe_interval *interval)
{
    const pe_free_motion *free = interval->free;
    const double dt = interval->dt;
    const bool stays = (interval->stops || interval->substep) && point->separation <= TOUCHING;
    double gap = stays ? 0 : closable(point->separation);
    if (m->restitution > 0) {
        const pe_twist *twists = pe_twists(world);
        double approach = pe_opening_speed(world, m, point, &twists[m->a], &twists[m->b]);
        if (approach < -world->def.restitution_threshold && gap + dt * approach <= 0 &&
            outlasts(world, m, point, free, approach)) {
            return m->restitution * approach;
        }
    }
    return gap / dt;
}

/* R diag(d) R^T as (xx, xy, xz, yy, yz, zz). */
static void rotated_diagonal(const pe_mat3 *rotation, pe_vec3 d, double m[6])
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
        rotated_diagonal(rotation, i, inertia.tensor);
        rotated_diagonal(rotation, pe_v3(1 / i.x, 1 / i.y, 1 / i.z), inertia.inverse_tensor);
    }
    return inertia;
}

static pe_vec3 centre_of(const pe_manifold_point *points, int count)
{
    pe_vec3 sum = {0};
    for (int i = 0; i < count; ++i) {
        sum = pe_add(sum, points[i].position);
    }
    return pe_scale(1.0 / count, sum);
}

/* A problem while it is built. */
typedef struct building {
    const pe_world *world;
    const pe_interval *interval;
    pe_island_problem *built;
} building;

static void fill_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const building *b = context;
    const pe_world *world = b->world;
    const pe_problem *problem = &b->built->problem;
    const pe_free_motion *free = b->interval->free;
    for (int i = begin; i < end; ++i) {
        int slot = b->built->slot[i];
        pe_twist at_end = free != NULL ? free[slot].end : (pe_twist){0};
        problem->inertia[i] = inertia_of(&pe_masses(world)[slot], &pe_poses(world)[slot].rotation);
        pe_v3_store(problem->free_velocity[i], at_end.velocity);
        pe_v3_store(problem->free_velocity[i] + 3, at_end.angular_velocity);
    }
}

/* Fills a manifold whose bodies and first point are set, and its points, from the world's manifold
 * m. */
static void fill_manifold(const pe_world *world, const pe_manifold *m, const pe_interval *interval,
                          pe_island_problem *built, pe_solver_manifold *manifold)
{
    const pe_problem *problem = &built->problem;
    const pe_manifold_point *points = pe_manifold_points(&world->contacts) + m->first;
    pe_vec3 axis[3] = {m->normal}, centre = centre_of(points, m->count);
    pe_vec3 xa = pe_poses(world)[m->a].position, xb = pe_poses(world)[m->b].position;
    pe_tangents(m->normal, &axis[1], &axis[2]);
    manifold->count = m->count;
    manifold->friction = m->friction;
    pe_v3_store(manifold->arm_a, pe_sub(centre, xa));
    pe_v3_store(manifold->arm_b, pe_sub(centre, xb));
    for (int k = 0; k < 3; ++k) {
        pe_v3_store(manifold->frame[k], axis[k]);
    }
    const int first = manifold->first;
    const pe_inertia *a = &problem->inertia[manifold->a], *b = &problem->inertia[manifold->b];
    for (int j = 0; j < m->count; ++j) {
        pe_solver_point *point = &problem->point[first + j];
        double *impulse = problem->impulse[first + j], ra[3], rb[3];
        pe_vec3 s = pe_sub(points[j].position, centre);
        pe_v3_store(ra, pe_sub(points[j].position, xa));
        pe_v3_store(rb, pe_sub(points[j].position, xb));
        for (int k = 0; k < 3; ++k) {
            point->s[k] = pe_dot(axis[k], s);
            impulse[k] = interval->free != NULL ? pe_dot(axis[k], points[j].impulse) : 0;
        }
        point->bias = bias_of(world, m, &points[j], interval);
        point->slip[0] = point->slip[1] = 0;
        point->scale = pe_point_scale(a, b, ra, rb);
        built->point_of[first + j] = m->first + j;
        built->normal_change[first + j] = 0;
    }
}

static void fill_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    const building *b = context;
    for (int i = begin; i < end; ++i) {
        fill_manifold(b->world, &pe_manifolds(&b->world->contacts)[b->built->source[i]],
                      b->interval, b->built, &b->built->problem.manifold[i]);
    }
}

static int body_of(const pe_islands *islands, int slot, int statics)
{
    return islands->place[slot] < 0 ? statics : islands->place[slot];
}

/* The bodies and the first points of all manifolds. */
typedef struct heading {
    const pe_manifold *kept;
    const pe_islands *islands;
    pe_island_problem *built;
    int grain, first[PE_MOST_SUMS]; /* of each piece: how many points it has, then its first one */
} heading;

static void count_points(void *context, int worker, int begin, int end)
{
    (void)worker;
    heading *h = context;
    int points = 0;
    for (int i = begin; i < end; ++i) {
        points += h->kept[h->built->source[i]].count;
    }
    h->first[begin / h->grain] = points;
}

static void head_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    const heading *h = context;
    const pe_problem *problem = &h->built->problem;
    int first = h->first[begin / h->grain];
    for (int i = begin; i < end; ++i) {
        const pe_manifold *m = &h->kept[h->built->source[i]];
        problem->manifold[i] = (pe_solver_manifold){
            .a = body_of(h->islands, m->a, problem->body_count),
            .b = body_of(h->islands, m->b, problem->body_count),
            .first = first,
        };
        first += m->count;
    }
}

pe_status pe_problem_build(pe_world *world, const pe_interval *interval, pe_island_problem *built,
                           pe_error *error)
{
    const pe_islands *islands = interval->islands;
    const int k = interval->k;
    pe_problem *problem = &built->problem;
    *built = (pe_island_problem){
        .problem.body_count = islands->body_start[k + 1] - islands->body_start[k],
        .problem.manifold_count = islands->start[k + 1] - islands->start[k],
        .slot = islands->bodies + islands->body_start[k],
        .source = islands->manifolds + islands->start[k],
    };
    heading heads = {.kept = pe_manifolds(&world->contacts),
                     .islands = islands,
                     .built = built,
                     .grain = pe_sum_grain(problem->manifold_count)};
    pe_pool_run(world->pool, problem->manifold_count, heads.grain, count_points, &heads);
    for (int i = 0; i < pe_piece_count(problem->manifold_count, heads.grain); ++i) {
        const int count = heads.first[i];
        heads.first[i] = problem->point_count;
        problem->point_count += count;
    }
    pe_status status = pe_problem_take(problem, pe_step_memory(world), error);
    if (status != PE_OK) {
        return status;
    }
    size_t points = (size_t)problem->point_count;
    built->point_of = pe_scratch(world, points, sizeof *built->point_of);
    built->normal_change = pe_scratch(world, points, sizeof *built->normal_change);
    if (built->point_of == NULL || built->normal_change == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    pe_pool_run(problem->pool, problem->manifold_count, heads.grain, head_manifolds, &heads);
    status = pe_problem_list_sides(problem, pe_step_memory(world), error);
    if (status != PE_OK) {
        return status;
    }
    building b = {world, interval, built};
    pe_pool_run(problem->pool, problem->body_count, PE_PROBLEM_BODY_GRAIN, fill_bodies, &b);
    pe_pool_run(problem->pool, problem->manifold_count, PE_MANIFOLD_GRAIN, fill_manifolds, &b);
    if (interval->free == NULL) {
        const size_t bodies = (size_t)problem->body_count + 1;
        memset(problem->velocity, 0, bodies * sizeof *problem->velocity);
        return PE_OK;
    }
    pe_problem_rebuild_velocity(problem);
    if (!interval->instant) {
        return pe_problem_to_midpoint(world, built, interval->free, interval->dt, interval->solved,
                                      error);
    }
    return PE_OK;
}

/* Where impulses go. */
typedef struct storing {
    const pe_island_problem *built;
    pe_manifold_point *points; /* of the world */
} storing;

static void store_impulses(void *context, int worker, int begin, int end)
{
    (void)worker;
    const storing *s = context;
    const pe_problem *problem = &s->built->problem;
    for (int i = begin; i < end; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        const double(*d)[3] = manifold->frame;
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            const double *p = problem->impulse[j];
            s->points[s->built->point_of[j]].impulse =
                pe_v3(d[0][0] * p[0] + d[1][0] * p[1] + d[2][0] * p[2],
                      d[0][1] * p[0] + d[1][1] * p[1] + d[2][1] * p[2],
                      d[0][2] * p[0] + d[1][2] * p[1] + d[2][2] * p[2]);
        }
    }
}

void pe_problem_store_impulses(pe_world *world, const pe_island_problem *built)
{
    storing s = {built, pe_manifold_points(&world->contacts)};
    pe_pool_run(built->problem.pool, built->problem.manifold_count, PE_MANIFOLD_GRAIN,
                store_impulses, &s);
}
