/* Penetration removed by moving bodies, without a change of momentum.
 *
 *   min |d|_M  subject to  J_n d + phi >= -aim  at every contact, open ones too,
 *
 * is a contact problem without friction in which the displacement d, in m and rad, takes the place
 * of the velocity, phi + aim that of the bias, and nothing moves freely. Any solver of contact
 * problems solves it. Sweeping begins at the bodies of violated contacts and extends to those that
 * get pushed; an island of which that is most is swept as a whole.
 *
 * Between two nearly opposite normals the least displacement of these linear rows may be hundreds of
 * metres, and no displacement at all may part a body from static ones on both sides. So no body
 * moves farther in a step than a part of its size: no contact asks for more than that, a solution
 * that exceeds it by far is dropped for sweeps, and what exceeds it still is scaled, all displacements
 * of the island by one factor. The violation is a convex function of them and 0 is no better, so that a
 * part mends as well, by less. Deep overlap is parted over several steps. Where that leads nowhere
 * the bodies are left as they are for a while. */
#include "correction.h"
#include "model/rest.h"

#include <string.h>

/* An island of more than MOST_SOLVED / max_iterations points gets fewer iterations of the solver. */
enum { MOST_SOLVED = 1500, LEAST_ITERATIONS = 4 };

/* Flops of the solver's factorisations, in all islands and rounds: a second or less. What is left then
 * is swept. */
static const double MOST_FLOPS = 5e9;

/* A solution of which bodies may move by less than this part in a step leads far away. */
static const double LEAST_PART = 1.0 / 16;

/* In units of the least half extent: so little is none. */
static const double NO_WAY = 1e-3;

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

/* ---- Islands ---- */

/* Bodies of a piece. */
enum { BODY_GRAIN = 256 };

static pe_status solve_whole(pe_correction *c, int k, pe_island_problem *built)
{
    pe_status status = pe_correction_build(c, c->islands, k, built);
    if (status == PE_OK) {
        pe_solve_report report = {.factor_flops = c->flops, .most_flops = MOST_FLOPS};
        pe_solve_limits limits = c->rules->solver_limits;
        const int bound = MOST_SOLVED / built->problem.point_count;
        limits.max_iterations = bound < LEAST_ITERATIONS        ? LEAST_ITERATIONS
                                : bound < limits.max_iterations ? bound
                                                                : limits.max_iterations;
        status =
            c->rules->solver(&built->problem, &limits, pe_step_memory(c->world), &report, c->error);
        c->iterations = report.iterations > c->iterations ? report.iterations : c->iterations;
        c->flops = report.factor_flops;
    }
    return status;
}

/* R diag(d) R^T x */
static pe_vec3 rotated_times(const pe_mat3 *rotation, pe_vec3 d, pe_vec3 x)
{
    return pe_rotate(rotation, pe_mul(d, pe_unrotate(rotation, x)));
}

/* How far the farthest point of body i moves by the displacement found, in m, at most. */
static double way_of(const pe_correction *c, const pe_island_problem *built, int i)
{
    const double *d = built->problem.velocity[i];
    double radius = pe_bodies(c->world)[built->slot[i]].bounding_radius;
    return sqrt(pe_dot3(d, d)) + radius * sqrt(pe_dot3(d + 3, d + 3));
}

/* How far the body may still be moved in this step, in m. */
static double way_left(const pe_correction *c, int slot)
{
    return pe_max(0, pe_correction_way(c, slot) - c->step->way[slot]);
}

/* What part_of finds, by pieces of the bodies. */
typedef struct parting {
    const pe_correction *c;
    const pe_island_problem *built;
    int grain;
    double part[PE_MOST_SUMS];
} parting;

static void find_parts(void *context, int worker, int begin, int end)
{
    (void)worker;
    parting *p = context;
    double part = 1;
    for (int i = begin; i < end; ++i) {
        double way = way_of(p->c, p->built, i), left = way_left(p->c, p->built->slot[i]);
        part = !isfinite(way) ? 0 : part * way > left ? left / way : part;
    }
    p->part[begin / p->grain] = part;
}

/* The part, at most 1, of the displacements found by which no body moves too far; 0: they are not
 * finite. */
static double part_of(const pe_correction *c, const pe_island_problem *built)
{
    const int bodies = built->problem.body_count;
    parting p = {.c = c, .built = built, .grain = pe_sum_grain(bodies)};
    double part = 1;
    pe_pool_run(built->problem.pool, bodies, p.grain, find_parts, &p);
    for (int i = 0; i < pe_piece_count(bodies, p.grain); ++i) {
        part = pe_min(part, p.part[i]);
    }
    return part;
}

/* Displacements of an island, and the part of them by which its bodies are moved. */
typedef struct displacing {
    const pe_correction *c;
    const pe_island_problem *built;
    double part;
} displacing;

/* Saves the body before it moves, in this round and in the step. */
static void keep_as_it_was(const pe_correction *c, int slot)
{
    pe_step *step = c->step;
    c->poses[slot] = pe_pose_save(&pe_poses(c->world)[slot]);
    c->twists[slot] = pe_twists(c->world)[slot];
    c->moved[slot] = true;
    if (!step->corrected[slot]) {
        step->uncorrected_poses[slot] = c->poses[slot];
        step->uncorrected_twists[slot] = c->twists[slot];
        step->corrected[slot] = true;
    }
}

static void displace_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const displacing *moving = context;
    const pe_correction *c = moving->c;
    const double part = moving->part;
    for (int i = begin; i < end; ++i) {
        const double *d = moving->built->problem.velocity[i];
        int slot = moving->built->slot[i];
        pe_pose *pose = &pe_poses(c->world)[slot];
        pe_vec3 linear = pe_scale(part, pe_v3_load(d));
        pe_vec3 rotation = pe_scale(part, pe_v3_load(d + 3));
        c->step->way[slot] += part * way_of(c, moving->built, i);
        if (pe_dot(linear, linear) > 0 || pe_dot(rotation, rotation) > 0) {
            keep_as_it_was(c, slot);
            const pe_mass *mass = &pe_masses(c->world)[slot];
            pe_vec3 inertia = mass->inertia;
            pe_vec3 inverse = pe_v3(1 / inertia.x, 1 / inertia.y, 1 / inertia.z);
            pe_vec3 *spin = &pe_twists(c->world)[slot].angular_velocity;
            pe_vec3 momentum = rotated_times(&pose->rotation, inertia, *spin);
            pe_pose_move(pose, linear, rotation);
            if (!mass->spherical) {
                *spin = rotated_times(&pose->rotation, inverse, momentum);
            }
        }
    }
}

/* Joins the bodies that a contact pushed apart: one may have been raised by what lowered the other, and
 * the two need not touch any more. */
static void join_parted(const pe_correction *c, const pe_island_problem *built)
{
    const pe_problem *problem = &built->problem;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *m = &problem->manifold[i];
        bool pushed = false;
        for (int j = m->first; j < m->first + m->count; ++j) {
            pushed = pushed || problem->impulse[j][0] > 0;
        }
        if (pushed && m->a < problem->body_count && m->b < problem->body_count) {
            pe_join_roots(c->step->parted, built->slot[m->a], built->slot[m->b]);
        }
    }
}

/* Moves the bodies by that part; their momenta stay. */
static void displace(const pe_correction *c, const pe_island_problem *built, double part)
{
    displacing moving = {c, built, part};
    pe_pool_run(built->problem.pool, built->problem.body_count, BODY_GRAIN, displace_bodies,
                &moving);
    join_parted(c, built);
}

static pe_status correct_island(pe_correction *c, int k)
{
    pe_island_problem built;
    pe_status status = PE_OK;
    bool better = false;
    if (c->rules->solver != NULL) {
        status = solve_whole(c, k, &built);
        better = status == PE_OK && pe_correction_is_better(&built.problem, NULL) &&
                 part_of(c, &built) >= LEAST_PART;
    }
    if (status == PE_OK && !better) {
        status = pe_correction_sweep(c, k, &built, &better);
    }
    const double part = better ? part_of(c, &built) : 0;
    if (part > 0) {
        displace(c, &built, part);
    }
    return status;
}

/* ---- Rounds ---- */

/* Whether a body of the island has moved as far as it may in this step: the others wait for it. */
static bool has_moved_enough(const pe_correction *c, int k)
{
    bool enough = false;
    for (int i = c->islands->body_start[k]; i < c->islands->body_start[k + 1] && !enough; ++i) {
        int slot = c->islands->bodies[i];
        /* One that has not been moved has its whole way left. */
        enough = c->step->way[slot] > 0 &&
                 !(way_left(c, slot) > NO_WAY * pe_bodies(c->world)[slot].size);
    }
    return enough;
}

/* Finds the islands of the contacts as they are, unless an earlier round or correction has. */
static pe_status find_islands(pe_correction *c)
{
    pe_step *step = c->step;
    pe_status status = PE_OK;
    if (!step->has_end_islands) {
        status = pe_islands_find(c->world, &step->end_islands, c->error);
        step->has_end_islands = status == PE_OK;
    }
    c->islands = &step->end_islands;
    return status;
}

/* Moves the bodies of contacts that are too deep, once. */
static pe_status correct_once(pe_correction *c)
{
    const bool *among = c->rules->among;
    memset(c->moved, 0, (size_t)c->world->slot_count * sizeof *c->moved);
    pe_status status = find_islands(c);
    if (status == PE_OK) {
        status = pe_correction_begin_sweeps(c);
    }
    for (int k = 0; status == PE_OK && k < c->islands->count; ++k) {
        int first = c->islands->bodies[c->islands->body_start[k]];
        if ((among == NULL || among[first]) &&
            pe_correction_depth(c, c->islands, k, true) > c->rules->begin &&
            !has_moved_enough(c, k)) {
            pe_arena_mark before = pe_arena_fill(&c->world->arena);
            status = correct_island(c, k);
            pe_arena_rewind(&c->world->arena, &c->world->allocator, before);
        }
    }
    return status;
}

static pe_status find_moved_contacts(pe_correction *c)
{
    pe_status status = pe_update_contacts(c->step, c->moved);
    return status == PE_OK ? pe_correction_look(c) : status;
}

/* Puts the bodies that moved in this round back. */
static void restore(const pe_correction *c)
{
    for (int slot = 0; slot < c->world->slot_count; ++slot) {
        if (c->moved[slot]) {
            pe_poses(c->world)[slot] = pe_pose_restore(&c->poses[slot]);
            pe_twists(c->world)[slot] = c->twists[slot];
        }
    }
}

/* Takes the memory of a correction, and that which all of a step share. */
static pe_status take_memory(pe_correction *c)
{
    pe_step *step = c->step;
    pe_world *world = c->world;
    const size_t slots = (size_t)world->slot_count;
    c->moved = pe_scratch(world, slots, sizeof *c->moved);
    c->poses = pe_scratch(world, slots, sizeof *c->poses);
    c->twists = pe_scratch(world, slots, sizeof *c->twists);
    if (step->way == NULL) {
        step->way = pe_scratch_zero(world, slots, sizeof *step->way);
        step->uncorrected_poses = pe_scratch(world, slots, sizeof *step->uncorrected_poses);
        step->uncorrected_twists = pe_scratch(world, slots, sizeof *step->uncorrected_twists);
        step->parted = pe_scratch(world, slots, sizeof *step->parted);
        for (int i = 0; i < world->slot_count && step->parted != NULL; ++i) {
            step->parted[i] = i;
        }
    }
    return pe_scratch_failed(world)
               ? pe_fail(step->error, PE_NO_MEMORY, "no memory to correct %zu positions", slots)
               : PE_OK;
}

pe_status pe_correct_positions(pe_step *step, const pe_correction_rules *rules,
                               pe_correction_report *report)
{
    pe_world *world = step->world;
    pe_correction c = {.step = step, .world = world, .rules = rules, .error = step->error};
    pe_status status = pe_correction_look(&c);
    if (status != PE_OK) {
        return status;
    }
    double deepest = pe_correction_deepest(&c);
    *report = (pe_correction_report){.penetration = deepest, .penetration_left = deepest};
    if (!(deepest > rules->begin) || rules->max_rounds < 1) {
        return PE_OK;
    }
    status = take_memory(&c);
    if (status != PE_OK) {
        return status;
    }
    pe_violation best = pe_correction_violation(&c);
    bool better = true;
    while (better && best.deepest > rules->begin && report->rounds < rules->max_rounds) {
        status = correct_once(&c);
        if (status != PE_OK || memchr(c.moved, true, (size_t)world->slot_count) == NULL) {
            break;
        }
        status = find_moved_contacts(&c);
        if (status != PE_OK) {
            break;
        }
        report->rounds += 1;
        pe_violation now = pe_correction_violation(&c);
        better = now.squares < best.squares;
        if (better) {
            best = now;
        } else {
            restore(&c);
            status = find_moved_contacts(&c);
        }
    }
    report->iterations = c.iterations;
    report->penetration_left = pe_correction_deepest(&c);
    return status;
}
