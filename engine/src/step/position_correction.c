#include "position_correction.h"

#include "solver/kernels.h"

#include <string.h>

pe_project_rules pe_project_rules_default(void)
{
    return (pe_project_rules){
        .begin = 3e-4,
        .aim = 1e-4,
        .enough = 5e-5,
        .max_sweeps = 200,
        .max_rounds = 8,
    };
}

/* Sweeps between two looks at the violation, after which the sweeping may also reach further. */
enum { LOOK_INTERVAL = 10 };

/* A body takes its other contacts into the sweeps when a point of it has moved by this part of
 * rules->enough. */
static const double REACHED = 0.3;

/* In units of the deepest penetration of its island: a gap that no push closes. */
static const double FAR = 4;

typedef struct projecting {
    pe_world *world;
    const pe_project_rules *rules;
    pe_islands islands;
    bool *moved;      /* (slots): in this round */
    bool *active;     /* (slots): bodies all of whose contacts are swept */
    double far;       /* m: gaps of more are not swept */
    double *push;     /* (points of the world): normal impulses so far, kg m */
    pe_islands swept; /* one island: the contacts that are swept */
    int iterations;
    pe_error *error;
} projecting;

/* ---- The problem -------------------------------------------------------------------------------
 */

pe_status pe_project_problem(pe_world *world, const pe_islands *islands, int k, double aim,
                             pe_island_problem *built, pe_error *error)
{
    pe_status status = pe_problem_build(world, islands, k, NULL, 1, built, error);
    if (status != PE_OK) {
        return status;
    }
    pe_problem *problem = &built->problem;
    size_t patches = (size_t)problem->manifold_count, points = (size_t)problem->point_count;
    pe_solver_manifold *patch = pe_scratch(world, patches, sizeof *patch);
    pe_solver_point *point = pe_scratch(world, points, sizeof *point);
    if (patch == NULL || point == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    memcpy(patch, problem->manifold, patches * sizeof *patch);
    memcpy(point, problem->point, points * sizeof *point);
    for (size_t i = 0; i < patches; ++i) {
        patch[i].friction = 0;
    }
    for (size_t i = 0; i < points; ++i) {
        point[i].bias = pe_manifold_points(&world->contacts)[built->point_of[i]].separation + aim;
    }
    problem->manifold = patch;
    problem->point = point;
    memset(problem->impulse, 0, points * sizeof *problem->impulse);
    memset(problem->velocity, 0, ((size_t)problem->body_count + 1) * sizeof *problem->velocity);
    return PE_OK;
}

/* Of J_n d + phi >= -aim, at the displacements as they stand. */
static pe_violation violation_of(const pe_problem *problem)
{
    pe_violation v = {0};
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *patch = &problem->manifold[i];
        double q[6], u[3];
        pe_solver_manifold_twist(patch, (const double(*)[6])problem->velocity, q);
        for (int j = patch->first; j < patch->first + patch->count; ++j) {
            pe_point_velocity(&problem->point[j], q, u);
            double depth = pe_max(-u[0], 0);
            v.deepest = pe_max(v.deepest, depth);
            v.squares += depth * depth;
        }
    }
    return v;
}

/* The same at rest. */
static pe_violation violation_before(const pe_problem *problem)
{
    pe_violation v = {0};
    for (int j = 0; j < problem->point_count; ++j) {
        double depth = pe_max(-problem->point[j].bias, 0);
        v.deepest = pe_max(v.deepest, depth);
        v.squares += depth * depth;
    }
    return v;
}

static double deepest_of(const pe_world *world, const int *manifolds, int count)
{
    double deepest = 0;
    for (int i = 0; i < count; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[manifolds[i]];
        deepest = pe_max(deepest, -m->least_separation);
    }
    return deepest;
}

static bool counts(const pe_project_rules *rules, const pe_manifold *m)
{
    return rules->among == NULL || rules->among[m->a] || rules->among[m->b];
}

/* Of the contacts of an island that count. */
static double deepest_that_counts(const projecting *p, int k)
{
    const pe_islands *islands = &p->islands;
    double deepest = 0;
    for (int i = islands->start[k]; i < islands->start[k + 1]; ++i) {
        const pe_manifold *m = &pe_manifolds(&p->world->contacts)[islands->manifolds[i]];
        deepest = counts(p->rules, m) ? pe_max(deepest, -m->least_separation) : deepest;
    }
    return deepest;
}

static double deepest_of_world(const pe_world *world, const pe_project_rules *rules)
{
    double deepest = 0;
    for (int i = 0; i < world->contacts.manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
        deepest = counts(rules, m) ? pe_max(deepest, -m->least_separation) : deepest;
    }
    return deepest;
}

/* Of phi >= -aim over all contacts that count. */
static pe_violation violation_of_world(const pe_world *world, const pe_project_rules *rules)
{
    pe_violation v = {0};
    for (int i = 0; i < world->contacts.manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
        for (int j = m->first; j < m->first + m->count && counts(rules, m); ++j) {
            double depth = -pe_manifold_points(&world->contacts)[j].separation;
            double over = pe_max(depth - rules->aim, 0);
            v.deepest = pe_max(v.deepest, depth);
            v.squares += over * over;
        }
    }
    return v;
}

/* ---- What is swept -----------------------------------------------------------------------------
 */

static void activate(const projecting *p, int slot)
{
    p->active[slot] = !pe_bodies(p->world)[slot].is_static;
}

/* The bodies of violated contacts. */
static void activate_violated(const projecting *p, const int *manifolds, int count)
{
    double depth = p->rules->aim + 0.5 * p->rules->enough;
    for (int i = 0; i < count; ++i) {
        const pe_manifold *m = &pe_manifolds(&p->world->contacts)[manifolds[i]];
        if (deepest_of(p->world, &manifolds[i], 1) > depth) {
            activate(p, m->a);
            activate(p, m->b);
        }
    }
}

/* The bodies that have been pushed; whether there is a new one. */
static bool activate_reached(const projecting *p, const pe_island_problem *built,
                             const pe_solver_body *displacement)
{
    bool any = false;
    double enough = REACHED * p->rules->enough;
    for (int i = 0; i < built->problem.body_count; ++i) {
        int slot = built->slot[i];
        const double *d = displacement[i].linear, *r = displacement[i].angular;
        double reach = pe_bodies(p->world)[slot].bounding_radius;
        double most = sqrt(pe_dot3(d, d)) + reach * sqrt(pe_dot3(r, r));
        if (!p->active[slot] && most > enough) {
            activate(p, slot);
            any = true;
        }
    }
    return any;
}

static void take_body(pe_islands *swept, int slot)
{
    if (swept->place[slot] < 0) {
        swept->place[slot] = swept->body_start[1];
        swept->bodies[swept->body_start[1]++] = slot;
    }
}

/* Lists the manifolds of active bodies and the bodies of these manifolds in p->swept. */
static void collect(projecting *p, const int *manifolds, int count)
{
    pe_islands *swept = &p->swept;
    for (int i = 0; i < swept->body_start[1]; ++i) {
        swept->place[swept->bodies[i]] = -1;
    }
    swept->start[1] = swept->body_start[1] = 0;
    for (int i = 0; i < count; ++i) {
        const pe_manifold *m = &pe_manifolds(&p->world->contacts)[manifolds[i]];
        if ((p->active[m->a] || p->active[m->b]) && m->least_separation < p->far) {
            swept->manifolds[swept->start[1]++] = manifolds[i];
            if (!pe_bodies(p->world)[m->a].is_static) {
                take_body(swept, m->a);
            }
            if (!pe_bodies(p->world)[m->b].is_static) {
                take_body(swept, m->b);
            }
        }
    }
}

/* The problem of what is swept, at the impulses so far. */
static pe_status build_swept(projecting *p, pe_island_problem *built)
{
    pe_status status = pe_project_problem(p->world, &p->swept, 0, p->rules->aim, built, p->error);
    if (status == PE_OK) {
        for (int j = 0; j < built->problem.point_count; ++j) {
            built->problem.impulse[j][0] = p->push[built->point_of[j]];
        }
        pe_problem_rebuild_velocity(&built->problem);
    }
    return status;
}

/* Leaves the best displacements found in built->problem. */
static pe_status sweep_island(projecting *p, const int *manifolds, int count,
                              pe_island_problem *built)
{
    activate_violated(p, manifolds, count);
    p->far = FAR * deepest_of(p->world, manifolds, count);
    pe_momentum momentum;
    int sweeps = 0;
    pe_arena_mark before = pe_arena_fill(&p->world->arena);
    for (bool grown = true; grown;) {
        pe_sweep sweep;
        pe_arena_rewind(&p->world->arena, &p->world->allocator, before);
        collect(p, manifolds, count);
        pe_status status = build_swept(p, built);
        if (status == PE_OK) {
            status = pe_sweep_create(&built->problem, pe_kernels_for(0)->sweep,
                                     pe_step_memory(p->world), &sweep, p->error);
        }
        if (status != PE_OK) {
            return status;
        }
        pe_violation best = pe_sweep_violation(&sweep);
        if (sweeps == 0) {
            momentum = pe_momentum_begin(best.deepest);
        }
        grown = false;
        while (!grown && sweeps < p->rules->max_sweeps && best.deepest > p->rules->enough) {
            for (int i = 0; i < LOOK_INTERVAL; ++i) {
                pe_sweep_normals(&sweep, pe_momentum_next(&momentum));
            }
            sweeps += LOOK_INTERVAL;
            pe_violation now = pe_sweep_violation(&sweep);
            pe_momentum_look(&momentum, LOOK_INTERVAL, now.deepest);
            grown = activate_reached(p, built, sweep.velocity);
            if (now.squares < best.squares || grown) {
                best = now;
                pe_sweep_store(&sweep);
            }
        }
        for (int j = 0; j < built->problem.point_count && grown; ++j) {
            p->push[built->point_of[j]] = built->problem.impulse[j][0];
        }
    }
    pe_problem_rebuild_velocity(&built->problem);
    p->iterations = sweeps > p->iterations ? sweeps : p->iterations;
    return PE_OK;
}

/* ---- Islands and rounds ------------------------------------------------------------------------
 */

static pe_status solve_whole(projecting *p, int k, pe_island_problem *built)
{
    pe_status status = pe_project_problem(p->world, &p->islands, k, p->rules->aim, built, p->error);
    if (status == PE_OK) {
        pe_solve_report report = {0};
        status = p->rules->solver(&built->problem, &p->rules->solver_limits,
                                  pe_step_memory(p->world), &report, p->error);
        p->iterations = report.iterations > p->iterations ? report.iterations : p->iterations;
    }
    return status;
}

static bool is_better(const pe_problem *problem)
{
    return violation_of(problem).squares < violation_before(problem).squares;
}

/* R diag(d) R^T x */
static pe_vec3 turned_times(const pe_mat3 *rotation, pe_vec3 d, pe_vec3 x)
{
    return pe_rotate(rotation, pe_mul(d, pe_unrotate(rotation, x)));
}

/* Moves the bodies; their momenta stay. */
static void displace(projecting *p, const pe_island_problem *built)
{
    for (int i = 0; i < built->problem.body_count; ++i) {
        const double *d = built->problem.velocity[i];
        int slot = built->slot[i];
        pe_pose *pose = &pe_poses(p->world)[slot];
        pe_vec3 linear = pe_v3(d[0], d[1], d[2]), turn = pe_v3(d[3], d[4], d[5]);
        if (pe_dot(linear, linear) > 0 || pe_dot(turn, turn) > 0) {
            const pe_mass *mass = &pe_masses(p->world)[slot];
            pe_vec3 inertia = mass->inertia;
            pe_vec3 inverse = pe_v3(1 / inertia.x, 1 / inertia.y, 1 / inertia.z);
            pe_vec3 *spin = &pe_twists(p->world)[slot].angular_velocity;
            pe_vec3 momentum = turned_times(&pose->rotation, inertia, *spin);
            pe_pose_move(pose, linear, turn);
            if (!mass->spherical) {
                *spin = turned_times(&pose->rotation, inverse, momentum);
            }
            p->moved[slot] = true;
        }
    }
}

static pe_status project_island(projecting *p, int k)
{
    const pe_islands *islands = &p->islands;
    const int *manifolds = islands->manifolds + islands->start[k];
    int count = islands->start[k + 1] - islands->start[k];
    pe_island_problem built;
    bool whole = p->rules->solver != NULL;
    pe_status status = PE_OK;
    if (whole) {
        status = solve_whole(p, k, &built);
        whole = status == PE_OK && is_better(&built.problem);
    }
    if (status == PE_OK && !whole) {
        status = sweep_island(p, manifolds, count, &built);
    }
    if (status == PE_OK && is_better(&built.problem)) {
        displace(p, &built);
    }
    return status;
}

static pe_status take_round(projecting *p)
{
    pe_world *world = p->world;
    size_t slots = (size_t)world->slot_count;
    size_t points = (size_t)world->contacts.point_count;
    size_t manifolds = (size_t)world->contacts.manifold_count;
    p->active = pe_scratch(world, slots, sizeof *p->active);
    p->push = pe_scratch(world, points + 1, sizeof *p->push);
    p->swept = (pe_islands){
        .count = 1,
        .start = pe_scratch(world, 2, sizeof(int)),
        .manifolds = pe_scratch(world, manifolds + 1, sizeof(int)),
        .body_start = pe_scratch(world, 2, sizeof(int)),
        .bodies = pe_scratch(world, slots, sizeof(int)),
        .place = pe_scratch(world, slots, sizeof(int)),
    };
    if (p->active == NULL || p->push == NULL || p->swept.start == NULL ||
        p->swept.manifolds == NULL || p->swept.body_start == NULL || p->swept.bodies == NULL ||
        p->swept.place == NULL) {
        return pe_fail(p->error, PE_NO_MEMORY, "no memory to project %zu contact points", points);
    }
    memset(p->active, 0, slots * sizeof *p->active);
    memset(p->push, 0, points * sizeof *p->push);
    memset(p->swept.start, 0, 2 * sizeof(int));
    memset(p->swept.body_start, 0, 2 * sizeof(int));
    for (size_t i = 0; i < slots; ++i) {
        p->swept.place[i] = -1;
    }
    return PE_OK;
}

/* Moves what is too deep, once. */
static pe_status project_once(projecting *p)
{
    pe_status status = pe_islands_find(p->world, &p->islands, p->error);
    if (status == PE_OK) {
        status = take_round(p);
    }
    for (int k = 0; status == PE_OK && k < p->islands.count; ++k) {
        int first = p->islands.bodies[p->islands.body_start[k]];
        bool among = p->rules->among == NULL || p->rules->among[first];
        if (among && deepest_that_counts(p, k) > p->rules->begin) {
            pe_arena_mark before = pe_arena_fill(&p->world->arena);
            status = project_island(p, k);
            pe_arena_rewind(&p->world->arena, &p->world->allocator, before);
        }
    }
    return status;
}

static pe_status refind(projecting *p, const pe_contact_rules *rules, double dt)
{
    pe_pair *pairs;
    int count;
    pe_status status = pe_broad_phase_moved(p->world, dt, p->moved, &pairs, &count, p->error);
    if (status == PE_OK) {
        status = pe_contacts_refind(p->world, rules, pairs, count, p->moved, dt, p->error);
    }
    return status;
}

/* The bodies as they stood at some time. */
typedef struct snapshot {
    pe_violation violation;
    pe_pose *poses;    /* (slots) */
    pe_twist *motions; /* (slots) */
} snapshot;

static bool take_snapshot(pe_world *world, snapshot *s)
{
    size_t slots = (size_t)world->slot_count;
    s->poses = pe_scratch(world, slots, sizeof *s->poses);
    s->motions = pe_scratch(world, slots, sizeof *s->motions);
    return s->poses != NULL && s->motions != NULL;
}

static void keep(const pe_world *world, pe_violation violation, snapshot *s)
{
    size_t slots = (size_t)world->slot_count;
    s->violation = violation;
    memcpy(s->poses, pe_poses(world), slots * sizeof *s->poses);
    memcpy(s->motions, pe_twists(world), slots * sizeof *s->motions);
}

/* Brings the bodies that moved in this round back. */
static void bring_back(const projecting *p, const snapshot *s)
{
    for (int slot = 0; slot < p->world->slot_count; ++slot) {
        if (p->moved[slot]) {
            pe_poses(p->world)[slot] = s->poses[slot];
            pe_twists(p->world)[slot] = s->motions[slot];
        }
    }
}

static bool any_moved(const projecting *p, bool *ever)
{
    bool any = false;
    for (int slot = 0; slot < p->world->slot_count; ++slot) {
        any = any || p->moved[slot];
        ever[slot] = ever[slot] || p->moved[slot];
    }
    return any;
}

pe_status pe_project_positions(pe_world *world, const pe_project_rules *rules,
                               const pe_contact_rules *contact_rules, double dt,
                               pe_project_report *report, pe_error *error)
{
    size_t slots = (size_t)world->slot_count;
    double deepest = deepest_of_world(world, rules);
    *report = (pe_project_report){.penetration = deepest, .penetration_left = deepest};
    if (!(deepest > rules->begin) || rules->max_rounds < 1) {
        return PE_OK;
    }
    projecting p = {.world = world, .rules = rules, .error = error};
    p.moved = pe_scratch(world, slots, sizeof *p.moved);
    bool *ever = pe_scratch(world, slots, sizeof *ever);
    snapshot begun, later;
    if (!take_snapshot(world, &begun) || !take_snapshot(world, &later) || p.moved == NULL ||
        ever == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to project %zu bodies", slots);
    }
    memset(ever, 0, slots * sizeof *ever);
    keep(world, violation_of_world(world, rules), &begun);
    snapshot best = begun;
    pe_status status = PE_OK;
    bool better = true;
    while (better && best.violation.deepest > rules->begin && report->rounds < rules->max_rounds) {
        memset(p.moved, 0, slots * sizeof *p.moved);
        status = project_once(&p);
        if (status != PE_OK || !any_moved(&p, ever)) {
            break;
        }
        status = refind(&p, contact_rules, dt);
        if (status != PE_OK) {
            break;
        }
        report->rounds += 1;
        pe_violation now = violation_of_world(world, rules);
        better = now.squares < best.violation.squares;
        if (better) {
            best = later;
            keep(world, now, &best);
        } else {
            bring_back(&p, &best);
            status = refind(&p, contact_rules, dt);
        }
    }
    report->iterations = p.iterations;
    report->penetration_left = best.violation.deepest;
    report->moved = ever;
    report->poses = begun.poses;
    report->motions = begun.motions;
    return status;
}
