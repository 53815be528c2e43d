/* Penetration removed by moving bodies, without a change of momentum.
 *
 *   min |d|_M  subject to  J_n d + phi >= -aim  at every contact, open ones too,
 *
 * is a contact problem without friction in which the displacement d, in m and rad, takes the place
 * of the velocity, phi + aim that of the bias, and nothing moves freely. Any solver of contact
 * problems solves it. An island is not swept whole: sweeping begins at the bodies of violated
 * contacts and extends to those that get pushed.
 *
 * Between two nearly opposite normals the least displacement of these linear rows may be hundreds of
 * metres, and no displacement at all may part a body from static ones on both sides. So no body
 * moves farther in a step than a part of its size: no contact asks for more than that, a solution
 * that exceeds it by far is dropped for sweeps, and what exceeds it still is scaled, all displacements
 * of the island by one factor. The violation is a convex function of them and 0 is no better, so that a
 * part mends as well, by less. Deep overlap is parted over several steps. Where that leads nowhere
 * the bodies are left as they are for a while. */
#include "model/rest.h"
#include "solver/kernels.h"
#include "step.h"

#include <string.h>

/* Sweeps between two looks at the violation, after which more bodies may be swept. */
enum { LOOK_INTERVAL = 10 };

/* An island of more than MOST_SOLVED / max_iterations points gets fewer iterations of the solver. */
enum { MOST_SOLVED = 1500, LEAST_ITERATIONS = 4 };

/* A body takes its other contacts into the sweeps when a point of it has moved by this part of
 * rules->enough. */
static const double REACHED = 0.3;

/* In units of the deepest penetration of its island: a gap that no push closes. */
static const double FAR = 4;

/* In units of the least half extent of a body: how far a point of it moves in a step at most. */
static const double LONGEST_WAY = 0.4;

/* A solution of which bodies may move by less than this part in a step leads far away. */
static const double LEAST_PART = 1.0 / 16;

/* In units of the least half extent: so little is none. */
static const double NO_WAY = 1e-3;

/* In the same unit: deeper contacts count as overlap, which may be impossible to part. */
static const double OVERLAP = 0.1;

/* Overlap that keeps more than this part of its depth is not being parted. */
static const double NO_HEADWAY = 0.99;

typedef struct correction {
    pe_step *step;
    pe_world *world;
    const pe_correction_rules *rules;
    pe_islands islands;
    bool *moved;      /* (slots): in this round */
    bool *active;     /* (slots): bodies all of whose contacts are swept */
    double far;       /* m: gaps of more are not swept */
    double *push;     /* (points of the world): normal impulses so far, kg m */
    pe_islands swept; /* one island: the contacts that are swept */
    int iterations;
    pe_error *error;
} correction;

/* Some of the world's manifolds. */
typedef struct selection {
    const int *manifolds; /* (count): indices; NULL: the first `count` */
    int count;
} selection;

pe_correction_rules pe_correction_rules_default(void)
{
    return (pe_correction_rules){
        .begin = 3e-4,
        .aim = 1e-4,
        .enough = 5e-5,
        .max_sweeps = 200,
        .max_rounds = 8,
    };
}

static selection island_manifolds(const pe_islands *islands, int k)
{
    return (selection){islands->manifolds + islands->start[k],
                       islands->start[k + 1] - islands->start[k]};
}

static int manifold_index(selection s, int i)
{
    return s.manifolds != NULL ? s.manifolds[i] : i;
}

static const pe_manifold *manifold_at(const pe_world *world, selection s, int i)
{
    return &pe_manifolds(&world->contacts)[manifold_index(s, i)];
}

/* The smallest least half extent of the two bodies, in m, of those that can move. */
static double size_of(const pe_world *world, const pe_manifold *m)
{
    const pe_body *a = &pe_bodies(world)[m->a], *b = &pe_bodies(world)[m->b];
    return a->is_static ? b->size : b->is_static ? a->size : pe_min(a->size, b->size);
}

static bool overlaps(const pe_world *world, const pe_manifold *m)
{
    return m->least_separation < 0 && -m->least_separation > OVERLAP * size_of(world, m);
}

static bool is_static_or_waits(const pe_world *world, int slot)
{
    return pe_bodies(world)[slot].is_static || pe_records(world)[slot].parting.wait > 0;
}

/* Whether earlier steps could not part the bodies, so that their overlap is left alone now. */
static bool is_left_alone(const pe_world *world, const pe_manifold *m)
{
    return overlaps(world, m) && is_static_or_waits(world, m->a) && is_static_or_waits(world, m->b);
}

static bool is_among(const bool *among, const pe_manifold *m)
{
    return among == NULL || among[m->a] || among[m->b];
}

static bool counts(const pe_world *world, const bool *among, const pe_manifold *m)
{
    return is_among(among, m) && !is_left_alone(world, m);
}

/* The deepest penetration of manifolds that count, in m. */
static double deepest_of(const pe_world *world, selection s, const bool *among)
{
    double deepest = 0;
    for (int i = 0; i < s.count; ++i) {
        const pe_manifold *m = manifold_at(world, s, i);
        deepest = counts(world, among, m) ? pe_max(deepest, -m->least_separation) : deepest;
    }
    return deepest;
}

/* The same over all manifolds, those that are left alone included. */
static double deepest_of_world(const correction *c)
{
    const pe_contacts *contacts = &c->world->contacts;
    double deepest = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        deepest = is_among(c->rules->among, m) ? pe_max(deepest, -m->least_separation) : deepest;
    }
    return deepest;
}

/* ---- The problem ---- */

/* How far a point of the body is moved in a step at most, in m: by a part of its size, and what its
 * speed has moved it may also be taken back. */
static double longest_way(const correction *c, int slot)
{
    const pe_twist *twist = &pe_twists(c->world)[slot];
    double speed = pe_length(twist->velocity);
    if (c->step->twists != NULL) {
        speed = pe_max(speed, pe_length(c->step->twists[slot].velocity));
    }
    return LONGEST_WAY * pe_bodies(c->world)[slot].size +
           c->step->dt * (speed + pe_spin_speed(c->world, slot));
}

/* The most depth that a contact of the manifold asks to be removed, in m. */
static double most_removed(const correction *c, const pe_manifold *m)
{
    const pe_body *bodies = pe_bodies(c->world);
    double a = bodies[m->a].is_static ? HUGE_VAL : longest_way(c, m->a);
    double b = bodies[m->b].is_static ? HUGE_VAL : longest_way(c, m->b);
    return is_left_alone(c->world, m) ? 0 : pe_min(a, b);
}

/* The problem at the head of this file for island k: impulses, velocities and free velocities 0. */
static pe_status build_problem(const correction *c, const pe_islands *islands, int k,
                               pe_island_problem *built)
{
    pe_world *world = c->world;
    pe_status status = pe_problem_build(world, &(pe_interval){.islands = islands, .k = k, .dt = 1},
                                        built, c->error);
    if (status != PE_OK) {
        return status;
    }
    pe_problem *problem = &built->problem;
    size_t manifolds = (size_t)problem->manifold_count, points = (size_t)problem->point_count;
    pe_solver_manifold *manifold = pe_scratch(world, manifolds, sizeof *manifold);
    pe_solver_point *point = pe_scratch(world, points, sizeof *point);
    if (pe_scratch_failed(world)) {
        return pe_fail(c->error, PE_NO_MEMORY, "no memory for %zu contact points", points);
    }
    memcpy(manifold, problem->manifold, manifolds * sizeof *manifold);
    memcpy(point, problem->point, points * sizeof *point);
    for (size_t i = 0; i < manifolds; ++i) {
        manifold[i].friction = 0;
    }
    for (size_t i = 0; i < manifolds; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[built->source[i]];
        const double least = -most_removed(c, m);
        for (int j = manifold[i].first; j < manifold[i].first + manifold[i].count; ++j) {
            double gap = pe_manifold_points(&world->contacts)[built->point_of[j]].separation;
            point[j].bias = pe_max(gap + c->rules->aim, least);
        }
    }
    problem->manifold = manifold;
    problem->point = point;
    memset(problem->impulse, 0, points * sizeof *problem->impulse);
    memset(problem->velocity, 0, ((size_t)problem->body_count + 1) * sizeof *problem->velocity);
    return PE_OK;
}

static void add_violation(double depth, double over, pe_violation *v)
{
    v->deepest = pe_max(v->deepest, depth);
    v->squares += over * over;
}

/* Whether the displacements found violate J_n d + phi >= -aim by less than none do. */
static bool is_better(const pe_problem *problem)
{
    pe_violation after = {0}, before = {0};
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *m = &problem->manifold[i];
        double q[6], u[3];
        pe_solver_manifold_twist(m, (const double(*)[6])problem->velocity, q);
        for (int j = m->first; j < m->first + m->count; ++j) {
            pe_point_velocity(&problem->point[j], q, u);
            double depth = pe_max(-u[0], 0), depth_before = pe_max(-problem->point[j].bias, 0);
            add_violation(depth, depth, &after);
            add_violation(depth_before, depth_before, &before);
        }
    }
    return after.squares < before.squares;
}

/* Of phi >= -aim over all contacts that count. */
static pe_violation violation_of_world(const correction *c)
{
    pe_violation v = {0};
    for (pe_point_walk at = pe_walk_points(&c->world->contacts); pe_next_point(&at);) {
        if (counts(c->world, c->rules->among, at.manifold)) {
            double depth = -at.point->separation;
            add_violation(depth, pe_max(depth - c->rules->aim, 0), &v);
        }
    }
    return v;
}

/* ---- Sweeping the violated part of an island ---- */

static void activate(const correction *c, int slot)
{
    c->active[slot] = !pe_bodies(c->world)[slot].is_static;
}

/* Activates the bodies of violated contacts. */
static void activate_violated(const correction *c, selection island)
{
    double depth = c->rules->aim + 0.5 * c->rules->enough;
    for (int i = 0; i < island.count; ++i) {
        const pe_manifold *m = manifold_at(c->world, island, i);
        if (pe_max(0, -m->least_separation) > depth) {
            activate(c, m->a);
            activate(c, m->b);
        }
    }
}

/* Activates the bodies that have been pushed; returns whether there is a new one. */
static bool activate_reached(const correction *c, const pe_island_problem *built,
                             const pe_solver_body *displacement)
{
    bool any = false;
    double enough = REACHED * c->rules->enough;
    for (int i = 0; i < built->problem.body_count; ++i) {
        int slot = built->slot[i];
        const double *d = displacement[i].linear, *r = displacement[i].angular;
        double radius = pe_bodies(c->world)[slot].bounding_radius;
        double most = sqrt(pe_dot3(d, d)) + radius * sqrt(pe_dot3(r, r));
        if (!c->active[slot] && most > enough) {
            activate(c, slot);
            any = true;
        }
    }
    return any;
}

static void add_swept_body(correction *c, int slot)
{
    pe_islands *swept = &c->swept;
    if (!pe_bodies(c->world)[slot].is_static && swept->place[slot] < 0) {
        swept->place[slot] = swept->body_start[1];
        swept->bodies[swept->body_start[1]++] = slot;
    }
}

/* Lists the manifolds of active bodies and the bodies of these manifolds in c->swept. */
static void collect_swept(correction *c, selection island)
{
    pe_islands *swept = &c->swept;
    for (int i = 0; i < swept->body_start[1]; ++i) {
        swept->place[swept->bodies[i]] = -1;
    }
    swept->start[1] = swept->body_start[1] = 0;
    for (int i = 0; i < island.count; ++i) {
        const pe_manifold *m = manifold_at(c->world, island, i);
        if ((c->active[m->a] || c->active[m->b]) && m->least_separation < c->far) {
            swept->manifolds[swept->start[1]++] = manifold_index(island, i);
            add_swept_body(c, m->a);
            add_swept_body(c, m->b);
        }
    }
}

/* Builds the problem of the swept contacts, at the impulses so far, and its sweeps. */
static pe_status begin_sweeps(correction *c, pe_island_problem *built, pe_sweep *sweep)
{
    pe_status status = build_problem(c, &c->swept, 0, built);
    if (status != PE_OK) {
        return status;
    }
    for (int j = 0; j < built->problem.point_count; ++j) {
        built->problem.impulse[j][0] = c->push[built->point_of[j]];
    }
    pe_problem_rebuild_velocity(&built->problem);
    return pe_sweep_create(&built->problem, pe_kernels_for(0)->sweep, pe_step_memory(c->world),
                           sweep, c->error);
}

/* Leaves the best displacements found in built->problem. */
static pe_status sweep_island(correction *c, selection island, pe_island_problem *built)
{
    activate_violated(c, island);
    c->far = FAR * deepest_of(c->world, island, NULL);
    pe_momentum momentum;
    int sweeps = 0;
    pe_arena_mark before = pe_arena_fill(&c->world->arena);
    for (bool grown = true; grown;) {
        pe_sweep sweep;
        pe_arena_rewind(&c->world->arena, &c->world->allocator, before);
        collect_swept(c, island);
        pe_status status = begin_sweeps(c, built, &sweep);
        if (status != PE_OK) {
            return status;
        }
        const pe_sweep_part whole = pe_sweep_whole(&sweep);
        pe_violation best = pe_sweep_violation(&sweep);
        if (sweeps == 0) {
            momentum = pe_momentum_begin(best.deepest);
        }
        grown = false;
        while (!grown && sweeps < c->rules->max_sweeps && best.deepest > c->rules->enough) {
            for (int i = 0; i < LOOK_INTERVAL; ++i) {
                pe_sweep_set_beta(&sweep, &whole, pe_momentum_next(&momentum));
                pe_sweep_normals(&sweep);
            }
            sweeps += LOOK_INTERVAL;
            pe_violation now = pe_sweep_violation(&sweep);
            pe_momentum_look(&momentum, LOOK_INTERVAL, now.deepest);
            grown = activate_reached(c, built, sweep.velocity);
            if (now.squares < best.squares || grown) {
                best = now;
                pe_sweep_store(&sweep, &whole);
            }
        }
        for (int j = 0; j < built->problem.point_count && grown; ++j) {
            c->push[built->point_of[j]] = built->problem.impulse[j][0];
        }
    }
    pe_problem_rebuild_velocity(&built->problem);
    c->iterations = sweeps > c->iterations ? sweeps : c->iterations;
    return PE_OK;
}

/* ---- Islands ---- */

static pe_status solve_whole(correction *c, int k, pe_island_problem *built)
{
    pe_status status = build_problem(c, &c->islands, k, built);
    if (status == PE_OK) {
        pe_solve_report report = {0};
        pe_solve_limits limits = c->rules->solver_limits;
        const int bound = MOST_SOLVED / built->problem.point_count;
        limits.max_iterations = bound < LEAST_ITERATIONS        ? LEAST_ITERATIONS
                                : bound < limits.max_iterations ? bound
                                                                : limits.max_iterations;
        status =
            c->rules->solver(&built->problem, &limits, pe_step_memory(c->world), &report, c->error);
        c->iterations = report.iterations > c->iterations ? report.iterations : c->iterations;
    }
    return status;
}

/* R diag(d) R^T x */
static pe_vec3 rotated_times(const pe_mat3 *rotation, pe_vec3 d, pe_vec3 x)
{
    return pe_rotate(rotation, pe_mul(d, pe_unrotate(rotation, x)));
}

/* How far the farthest point of body i moves by the displacement found, in m, at most. */
static double way_of(const correction *c, const pe_island_problem *built, int i)
{
    const double *d = built->problem.velocity[i];
    double radius = pe_bodies(c->world)[built->slot[i]].bounding_radius;
    return sqrt(pe_dot3(d, d)) + radius * sqrt(pe_dot3(d + 3, d + 3));
}

/* How far the body may still be moved in this step, in m. */
static double way_left(const correction *c, int slot)
{
    return pe_max(0, longest_way(c, slot) - c->step->way[slot]);
}

/* The part, at most 1, of the displacements found by which no body moves too far; 0: they are not
 * finite. */
static double part_of(const correction *c, const pe_island_problem *built)
{
    double part = 1;
    for (int i = 0; i < built->problem.body_count; ++i) {
        double way = way_of(c, built, i), left = way_left(c, built->slot[i]);
        if (!isfinite(way)) {
            return 0;
        }
        part = part * way > left ? left / way : part;
    }
    return part;
}

/* Moves the bodies by that part; their momenta stay. */
static void displace(correction *c, const pe_island_problem *built, double part)
{
    for (int i = 0; i < built->problem.body_count; ++i) {
        const double *d = built->problem.velocity[i];
        int slot = built->slot[i];
        pe_pose *pose = &pe_poses(c->world)[slot];
        pe_vec3 linear = pe_scale(part, pe_v3_load(d));
        pe_vec3 rotation = pe_scale(part, pe_v3_load(d + 3));
        c->step->way[slot] += part * way_of(c, built, i);
        if (pe_dot(linear, linear) > 0 || pe_dot(rotation, rotation) > 0) {
            const pe_mass *mass = &pe_masses(c->world)[slot];
            pe_vec3 inertia = mass->inertia;
            pe_vec3 inverse = pe_v3(1 / inertia.x, 1 / inertia.y, 1 / inertia.z);
            pe_vec3 *spin = &pe_twists(c->world)[slot].angular_velocity;
            pe_vec3 momentum = rotated_times(&pose->rotation, inertia, *spin);
            pe_pose_move(pose, linear, rotation);
            if (!mass->spherical) {
                *spin = rotated_times(&pose->rotation, inverse, momentum);
            }
            c->moved[slot] = true;
        }
    }
}

static pe_status correct_island(correction *c, int k)
{
    pe_island_problem built;
    pe_status status = PE_OK;
    bool better = false;
    if (c->rules->solver != NULL) {
        status = solve_whole(c, k, &built);
        better = status == PE_OK && is_better(&built.problem) && part_of(c, &built) >= LEAST_PART;
    }
    if (status == PE_OK && !better) {
        status = sweep_island(c, island_manifolds(&c->islands, k), &built);
        better = status == PE_OK && is_better(&built.problem);
    }
    const double part = better ? part_of(c, &built) : 0;
    if (part > 0) {
        displace(c, &built, part);
    }
    return status;
}

static pe_status take_sweep_memory(correction *c)
{
    pe_world *world = c->world;
    size_t slots = (size_t)world->slot_count;
    size_t points = (size_t)world->contacts.point_count;
    size_t manifolds = (size_t)world->contacts.manifold_count;
    c->active = pe_scratch_zero(world, slots, sizeof *c->active);
    c->push = pe_scratch_zero(world, points + 1, sizeof *c->push);
    pe_islands_take(world, manifolds, &c->swept);
    c->swept.count = 1;
    if (pe_scratch_failed(world)) {
        return pe_fail(c->error, PE_NO_MEMORY, "no memory to move %zu contact points apart",
                       points);
    }
    c->swept.start[0] = c->swept.start[1] = c->swept.body_start[0] = c->swept.body_start[1] = 0;
    for (size_t i = 0; i < slots; ++i) {
        c->swept.place[i] = -1;
    }
    return PE_OK;
}

/* ---- Rounds ---- */

/* Whether a body of the island has moved as far as it may in this step: the others wait for it. */
static bool has_moved_enough(const correction *c, int k)
{
    bool enough = false;
    for (int i = c->islands.body_start[k]; i < c->islands.body_start[k + 1] && !enough; ++i) {
        int slot = c->islands.bodies[i];
        enough = !(way_left(c, slot) > NO_WAY * pe_bodies(c->world)[slot].size);
    }
    return enough;
}

/* Moves the bodies of contacts that are too deep, once. */
static pe_status correct_once(correction *c)
{
    const bool *among = c->rules->among;
    memset(c->moved, 0, (size_t)c->world->slot_count * sizeof *c->moved);
    pe_status status = pe_islands_find(c->world, &c->islands, c->error);
    if (status == PE_OK) {
        status = take_sweep_memory(c);
    }
    for (int k = 0; status == PE_OK && k < c->islands.count; ++k) {
        int first = c->islands.bodies[c->islands.body_start[k]];
        if ((among == NULL || among[first]) && !has_moved_enough(c, k) &&
            deepest_of(c->world, island_manifolds(&c->islands, k), among) > c->rules->begin) {
            pe_arena_mark before = pe_arena_fill(&c->world->arena);
            status = correct_island(c, k);
            pe_arena_rewind(&c->world->arena, &c->world->allocator, before);
        }
    }
    return status;
}

static pe_status find_moved_contacts(correction *c)
{
    return pe_update_contacts(c->step, c->moved);
}

/* The state of all bodies at some time. */
typedef struct snapshot {
    pe_violation violation;
    pe_pose *poses;   /* (slots) */
    pe_twist *twists; /* (slots) */
} snapshot;

static snapshot take_snapshot_memory(pe_world *world)
{
    size_t slots = (size_t)world->slot_count;
    return (snapshot){.poses = pe_scratch(world, slots, sizeof(pe_pose)),
                      .twists = pe_scratch(world, slots, sizeof(pe_twist))};
}

static void save(const pe_world *world, pe_violation violation, snapshot *s)
{
    size_t slots = (size_t)world->slot_count;
    s->violation = violation;
    memcpy(s->poses, pe_poses(world), slots * sizeof *s->poses);
    memcpy(s->twists, pe_twists(world), slots * sizeof *s->twists);
}

/* Puts the bodies that moved in this round back. */
static void restore(const correction *c, const snapshot *s)
{
    for (int slot = 0; slot < c->world->slot_count; ++slot) {
        if (c->moved[slot]) {
            pe_poses(c->world)[slot] = s->poses[slot];
            pe_twists(c->world)[slot] = s->twists[slot];
        }
    }
}

/* Whether any body moved in this round. */
static bool any_moved(const correction *c, bool *ever)
{
    bool any = false;
    for (int slot = 0; slot < c->world->slot_count; ++slot) {
        any = any || c->moved[slot];
        ever[slot] = ever[slot] || c->moved[slot];
    }
    return any;
}

pe_status pe_correct_positions(pe_step *step, const pe_correction_rules *rules,
                               pe_correction_report *report)
{
    pe_world *world = step->world;
    size_t slots = (size_t)world->slot_count;
    correction c = {.step = step, .world = world, .rules = rules, .error = step->error};
    double deepest = deepest_of_world(&c);
    *report = (pe_correction_report){.penetration = deepest, .penetration_left = deepest};
    if (!(deepest > rules->begin) || rules->max_rounds < 1) {
        return PE_OK;
    }
    c.moved = pe_scratch(world, slots, sizeof *c.moved);
    bool *ever = pe_scratch_zero(world, slots, sizeof *ever);
    snapshot begun = take_snapshot_memory(world), later = take_snapshot_memory(world);
    if (step->way == NULL) {
        step->way = pe_scratch_zero(world, slots, sizeof *step->way);
    }
    if (pe_scratch_failed(world)) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to correct %zu positions", slots);
    }
    save(world, violation_of_world(&c), &begun);
    snapshot best = begun;
    pe_status status = PE_OK;
    bool better = true;
    while (better && best.violation.deepest > rules->begin && report->rounds < rules->max_rounds) {
        status = correct_once(&c);
        if (status != PE_OK || !any_moved(&c, ever)) {
            break;
        }
        status = find_moved_contacts(&c);
        if (status != PE_OK) {
            break;
        }
        report->rounds += 1;
        pe_violation now = violation_of_world(&c);
        better = now.squares < best.violation.squares;
        if (better) {
            best = later;
            save(world, now, &best);
        } else {
            restore(&c, &best);
            status = find_moved_contacts(&c);
        }
    }
    report->iterations = c.iterations;
    report->penetration_left = deepest_of_world(&c);
    report->moved = ever;
    report->poses = begun.poses;
    report->twists = begun.twists;
    return status;
}

/* ---- Overlap ---- */

/* Of each body (slots), in m; 0 where it has none, or is static. */
static void find_overlap(const pe_world *world, double *depth)
{
    const pe_body *bodies = pe_bodies(world);
    memset(depth, 0, (size_t)world->slot_count * sizeof *depth);
    for (int i = 0; i < world->contacts.manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
        if (overlaps(world, m)) {
            const int slots[2] = {m->a, m->b};
            for (int k = 0; k < 2; ++k) {
                double most = pe_max(depth[slots[k]], -m->least_separation);
                depth[slots[k]] = bodies[slots[k]].is_static ? 0 : most;
            }
        }
    }
}

pe_status pe_overlap_begin(pe_step *step)
{
    size_t slots = (size_t)step->world->slot_count;
    step->overlap = pe_scratch(step->world, slots, sizeof *step->overlap);
    if (step->overlap == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for the overlap of %zu bodies", slots);
    }
    find_overlap(step->world, step->overlap);
    return PE_OK;
}

pe_status pe_overlap_end(pe_step *step)
{
    size_t slots = (size_t)step->world->slot_count;
    double *now = pe_scratch(step->world, slots, sizeof *now);
    if (now == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for the overlap of %zu bodies", slots);
    }
    find_overlap(step->world, now);
    const int *resting = pe_resting_of(step->world);
    for (size_t slot = 1; slot < slots; ++slot) {
        if (pe_rests(resting, (int)slot)) {
            continue;
        }
        pe_backoff *b = &pe_records(step->world)[slot].parting;
        if (b->wait > 0) {
            b->wait -= 1;
        } else {
            bool in_vain = now[slot] > 0 && now[slot] > NO_HEADWAY * step->overlap[slot];
            *b = pe_backoff_after(in_vain, b->pause);
        }
        step->stats.overlapping += now[slot] > 0;
        step->stats.unparted += now[slot] > 0 && b->pause > 0;
    }
    return PE_OK;
}
