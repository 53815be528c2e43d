#include "model/rest.h"
#include "step.h"

/* Part of the terms that growth is the difference of, below which it is left alone. */
static const double ROUNDING = 1e-10;

/* Part of the kinetic energy that an island which was solved exactly may gain. */
static const double MOVING_ERROR = 1e-6;

/* Height, in m, by which a contact that was solved may lift the bodies on it in a step, to remove
 * rounding (problem_build.c). */
static const double ROUNDING_LIFT = 1e-10;

/* Part of the speed that position correction must leave. */
static const double LEFT = 0.5;

/* Speed, in m/s, that counts as rest: contacts at rest remove rounding with less
 * (problem_build.c). */
static const double REST_SPEED = 1e-6;

/* Bodies that are guarded together. */
typedef struct group {
    const pe_step *step;
    const double *lifts; /* (slots): see find_lifts; NULL: none */
    const int *slots;
    int count;
} group;

/* Of one group, J. */
typedef struct energy {
    double kinetic; /* at the end */
    double growth;
    double risen;   /* work against the forces, of the bodies that moved against them */
    double motion;  /* kinetic, before and after */
    double terms;   /* that growth is the difference of, in size */
    double mass;    /* kg */
    double force;   /* N, in size */
    bool exact;     /* all bodies were solved directly or have no contact to solve */
    bool corrected; /* position correction moved one */
} energy;

static pe_vec3 angular_momentum(const pe_mass *mass, const pe_mat3 *rotation, pe_vec3 w)
{
    return pe_rotate(rotation, pe_mul(mass->inertia, pe_unrotate(rotation, w)));
}

static double kinetic_energy(const pe_mass *mass, const pe_pose *pose, const pe_twist *twist)
{
    pe_vec3 l = angular_momentum(mass, &pose->rotation, twist->angular_velocity);
    return 0.5 * (mass->mass * pe_dot(twist->velocity, twist->velocity) +
                  pe_dot(l, twist->angular_velocity));
}

/* Work of the torque on a body: its impulse is what the free motion gains of angular momentum. */
static double torque_work(const pe_step *step, int slot)
{
    if (!pe_has_torque(pe_applied_force_of(step->world, slot))) {
        return 0;
    }
    const pe_mass *mass = &pe_masses(step->world)[slot];
    const pe_free_motion *free = &step->free[slot];
    pe_vec3 begin = step->twists[slot].angular_velocity;
    pe_vec3 end = pe_twists(step->world)[slot].angular_velocity;
    const pe_pose start = pe_pose_restore(&step->poses[slot]);
    pe_pose rotated = start;
    pe_pose_move(&rotated, pe_v3(0, 0, 0), pe_scale(step->dt, free->mean.angular_velocity));
    pe_vec3 impulse = pe_sub(angular_momentum(mass, &rotated.rotation, free->end.angular_velocity),
                             angular_momentum(mass, &start.rotation, begin));
    return 0.5 * pe_dot(impulse, pe_add(begin, end));
}

static bool is_corrected(const pe_step *step, int slot)
{
    return step->corrected != NULL && step->corrected[slot];
}

static void add_body(const pe_step *step, int slot, energy *e)
{
    const pe_mass *mass = &pe_masses(step->world)[slot];
    const pe_pose start = pe_pose_restore(&step->poses[slot]);
    const pe_pose *begin = &start, *end = &pe_poses(step->world)[slot];
    pe_vec3 velocity = step->twists[slot].velocity;
    double before = kinetic_energy(mass, begin, &step->twists[slot]);
    double after = kinetic_energy(mass, end, &pe_twists(step->world)[slot]);
    pe_vec3 force =
        pe_scale(mass->mass / step->dt, pe_sub(step->free[slot].end.velocity, velocity));
    pe_vec3 displacement = pe_sub(end->position, begin->position);
    double work = pe_dot(force, displacement), rotating = torque_work(step, slot);
    e->exact &= step->solved_directly[slot] || step->islands.place[slot] < 0;
    e->corrected |= is_corrected(step, slot);
    e->kinetic += after;
    e->motion += before + after;
    e->mass += mass->mass;
    e->force += pe_length(force);
    e->growth += (after - before) - work - rotating;
    e->risen += pe_max(-work, 0);
    /* Positions and velocities are rounded themselves. */
    double far = pe_length(force) * (pe_length(end->position) + pe_length(displacement));
    e->terms += before + after + fabs(rotating) + far +
                mass->mass / step->dt * pe_length(velocity) * pe_length(displacement);
}

static energy energy_of(const group *g)
{
    energy e = {.exact = true};
    double lift = 0;
    for (int i = 0; i < g->count; ++i) {
        add_body(g->step, g->slots[i], &e);
        lift += g->lifts != NULL ? g->lifts[g->slots[i]] : 0;
    }
    e.growth -= pe_min(lift, e.risen);
    return e;
}

/* ---- The motion of a group as a whole ---- */

/* The rigid motion that has the group's momenta. */
typedef struct whole {
    pe_vec3 centre; /* m */
    pe_twist twist; /* of the centre */
    double kinetic; /* J, of the group */
    double inside;  /* J, of what its bodies move besides */
} whole;

/* Adds m (r.r 1 - r r^T) + R I R^T to rows of a symmetric matrix. */
static void add_inertia(const pe_mass *mass, const pe_mat3 *rotation, pe_vec3 r, pe_vec3 rows[3])
{
    for (int k = 0; k < 3; ++k) {
        pe_vec3 e = pe_v3(k == 0, k == 1, k == 2);
        pe_vec3 of_arm = pe_sub(pe_scale(pe_dot(r, r), e), pe_scale(pe_component(r, k), r));
        rows[k] = pe_madd(pe_add(rows[k], angular_momentum(mass, rotation, e)), mass->mass, of_arm);
    }
}

/* The velocities of a body that moves with the group as a whole. */
static pe_twist twist_in(const whole *w, pe_vec3 position)
{
    pe_vec3 r = pe_sub(position, w->centre);
    return (pe_twist){pe_add(w->twist.velocity, pe_cross(w->twist.angular_velocity, r)),
                      w->twist.angular_velocity};
}

static pe_twist twist_besides(const pe_twist *twist, const pe_twist *mean)
{
    return (pe_twist){pe_sub(twist->velocity, mean->velocity),
                      pe_sub(twist->angular_velocity, mean->angular_velocity)};
}

static whole whole_of(const group *g)
{
    const pe_world *world = g->step->world;
    const pe_pose *poses = pe_poses(world);
    const pe_twist *twists = pe_twists(world);
    const pe_mass *masses = pe_masses(world);
    pe_vec3 first = {0, 0, 0}, momentum = {0, 0, 0}, angular = {0, 0, 0}, rows[3] = {{0, 0, 0}};
    double mass = 0;
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        mass += masses[slot].mass;
        first = pe_madd(first, masses[slot].mass, poses[slot].position);
        momentum = pe_madd(momentum, masses[slot].mass, twists[slot].velocity);
    }
    whole w = {.centre = pe_scale(1 / mass, first), .twist.velocity = pe_scale(1 / mass, momentum)};
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        const pe_mat3 *rotation = &poses[slot].rotation;
        pe_vec3 r = pe_sub(poses[slot].position, w.centre);
        angular = pe_madd(angular, masses[slot].mass, pe_cross(r, twists[slot].velocity));
        angular = pe_add(angular,
                         angular_momentum(&masses[slot], rotation, twists[slot].angular_velocity));
        add_inertia(&masses[slot], rotation, r, rows);
    }
    w.twist.angular_velocity = pe_solve3(rows[0], rows[1], rows[2], angular);
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        pe_twist mean = twist_in(&w, poses[slot].position);
        pe_twist besides = twist_besides(&twists[slot], &mean);
        w.kinetic += kinetic_energy(&masses[slot], &poses[slot], &twists[slot]);
        w.inside += kinetic_energy(&masses[slot], &poses[slot], &besides);
    }
    return w;
}

/* Takes the energy that scaling all velocities would from what the group moves besides its motion
 * as a whole, so that it keeps its momenta; false where there is not so much. */
static bool take_from_inside(const group *g, double scale)
{
    const whole w = whole_of(g);
    const double taken = (1 - scale * scale) * w.kinetic;
    if (!(taken < w.inside)) {
        return false;
    }
    const double factor = sqrt(1 - taken / w.inside);
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        pe_twist *twist = &pe_twists(g->step->world)[slot];
        pe_twist mean = twist_in(&w, pe_poses(g->step->world)[slot].position);
        pe_twist besides = twist_besides(twist, &mean);
        twist->velocity = pe_madd(mean.velocity, factor, besides.velocity);
        twist->angular_velocity = pe_madd(mean.angular_velocity, factor, besides.angular_velocity);
    }
    return true;
}

/* ---- Loads on soft contacts ---- */

/* A point of the body's axes in the world. */
static pe_vec3 at_pose(const pe_pose *pose, pe_vec3 anchor)
{
    return pe_add(pose->position, pe_rotate(&pose->rotation, anchor));
}

/* The change of a contact point's separation in the step, in m. `start`: of the manifold's bodies. */
static double parted(const pe_step *step, const pe_pose start[2], const pe_manifold *m,
                     const pe_manifold_point *point)
{
    const pe_pose *now = pe_poses(step->world);
    pe_vec3 a = pe_sub(at_pose(&now[m->a], point->anchor_a), at_pose(&start[0], point->anchor_a));
    pe_vec3 b = pe_sub(at_pose(&now[m->b], point->anchor_b), at_pose(&start[1], point->anchor_b));
    return pe_dot(m->normal, pe_sub(b, a));
}

/* What it costs to lift loads out of the depth of soft contacts. */
typedef struct lifting {
    const pe_step *step;
    double *of_point; /* J, of each point that was solved */
} lifting;

static void find_lifts_of_points(void *context, int worker, int begin, int end)
{
    (void)worker;
    const lifting *l = context;
    const pe_contacts *solved = &l->step->world->solved;
    for (int i = begin; i < end; ++i) {
        const pe_manifold *m = &pe_manifolds(solved)[i];
        const pe_pose start[2] = {pe_pose_restore(&l->step->poses[m->a]),
                                  pe_pose_restore(&l->step->poses[m->b])};
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_manifold_point *point = &pe_manifold_points(solved)[j];
            const double force = pe_dot(m->normal, point->impulse) / l->step->dt;
            l->of_point[j] = 0;
            if (point->separation < 0 && force > 0) {
                const double way = pe_min(parted(l->step, start, m, point), -point->separation);
                l->of_point[j] = force * pe_max(way, 0);
            }
        }
    }
}

enum { LIFT_GRAIN = 256 };

/* What it costs to lift the load of each soft contact out of its depth, in J: the force of the
 * contact along the depth that was removed. It counts for one of the two bodies, which are in the
 * same group. NULL where there is no memory. */
static double *find_lifts(const pe_step *step)
{
    pe_world *world = step->world;
    const pe_body *bodies = pe_bodies(world);
    const pe_contacts *solved = &world->solved;
    double *lifts = pe_scratch_zero(world, (size_t)world->slot_count, sizeof *lifts);
    lifting l = {step, pe_scratch(world, (size_t)solved->point_count + 1, sizeof *l.of_point)};
    if (lifts == NULL || l.of_point == NULL) {
        return NULL;
    }
    pe_pool_run(world->pool, solved->manifold_count, LIFT_GRAIN, find_lifts_of_points, &l);
    for (int k = 0; k < step->islands.count; ++k) {
        pe_point_walk at = pe_walk_island(solved, &step->islands, k);
        while (step->soft[k] && pe_next_point(&at)) {
            const pe_manifold *m = at.manifold;
            lifts[bodies[m->a].is_static ? m->b : m->a] +=
                l.of_point[at.point - pe_manifold_points(solved)];
        }
    }
    return lifts;
}

/* ---- The guard ---- */

/* The factor of the velocities that leaves no growth; 0: there is none. */
static double factor_of(const energy *e, bool exact)
{
    double allowed = ROUNDING * e->terms + REST_SPEED * REST_SPEED * e->mass;
    if (!(e->growth > allowed + (exact ? MOVING_ERROR * e->motion : 0))) {
        return 1;
    }
    return e->growth < e->kinetic ? sqrt(1 - e->growth / e->kinetic) : 0;
}

/* Whether no body, or with `corrected` no corrected body, is over step->shallow from `poses`. */
static bool is_shallow(const group *g, const pe_saved_pose *poses, bool corrected)
{
    const pe_step *step = g->step;
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        if (!corrected || is_corrected(step, slot)) {
            pe_vec3 d = pe_sub(pe_poses(step->world)[slot].position, poses[slot].position);
            if (pe_dot(d, d) > step->shallow * step->shallow) {
                return false;
            }
        }
    }
    return true;
}

/* A heap at rest would otherwise be corrected in vain at every step. */
static void note_correction(const group *g, bool taken_back)
{
    pe_record *records = pe_records(g->step->world);
    for (int i = 0; i < g->count; ++i) {
        pe_backoff *b = &records[g->slots[i]].correction;
        *b = pe_backoff_after(taken_back, b->pause);
    }
}

/* Takes back the position correction. Returns the factor of the velocities. */
static double take_back_correction(const group *g, bool *put_back)
{
    const pe_step *step = g->step;
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        if (is_corrected(step, slot)) {
            pe_poses(step->world)[slot] = pe_pose_restore(&step->uncorrected_poses[slot]);
            pe_twists(step->world)[slot] = step->uncorrected_twists[slot];
            put_back[slot] = true;
        }
    }
    energy e = energy_of(g);
    return e.growth < ROUNDING_LIFT * g->count * e.force ? 1 : factor_of(&e, true);
}

/* Whether all bodies were at rest at the step's start. */
static bool was_still(const group *g)
{
    for (int i = 0; i < g->count; ++i) {
        if (!pe_is_still(&g->step->twists[g->slots[i]])) {
            return false;
        }
    }
    return true;
}

/* Returns whether bodies were put back. */
static bool take_energy(const group *g, const energy *e, double factor, bool *put_back)
{
    const pe_step *step = g->step;
    const bool near = is_shallow(g, step->poses, false);
    bool waits = e->corrected && (e->exact ? factor < LEFT : factor == 0 && !near) &&
                 is_shallow(g, step->uncorrected_poses, true);
    if (waits) {
        factor = take_back_correction(g, put_back);
    }
    bool returns = factor == 0 && near;
    const bool in_vain = returns && !step->world->has_applied_forces && was_still(g);
    if (factor > 0 && factor < 1 && take_from_inside(g, factor)) {
        factor = 1;
    }
    for (int i = 0; i < g->count; ++i) {
        int slot = g->slots[i];
        pe_twist *twist = &pe_twists(step->world)[slot];
        pe_records(step->world)[slot].put_back = in_vain;
        twist->velocity = pe_scale(factor, twist->velocity);
        twist->angular_velocity = pe_scale(factor, twist->angular_velocity);
        if (returns) {
            pe_poses(step->world)[slot] = pe_pose_restore(&step->poses[slot]);
            put_back[slot] = true;
        }
    }
    return waits || returns;
}

static void guard_group(const group *g, bool *put_back, pe_energy_report *report)
{
    energy e = energy_of(g);
    double factor = factor_of(&e, e.exact && !e.corrected);
    bool back = false;
    if (factor < 1) {
        report->islands += 1;
        report->removed += e.growth;
        back = take_energy(g, &e, factor, put_back);
        report->put_back += back;
    }
    if (e.corrected) {
        note_correction(g, back);
    }
}

/* All groups, on the threads of the world. */
typedef struct guarding {
    const pe_step *step;
    const pe_islands *groups;
    const double *lifts;
    bool *put_back;
    pe_energy_report *reports; /* of the pieces */
} guarding;

static void guard_groups(void *context, int worker, int begin, int end)
{
    (void)worker;
    const guarding *g = context;
    pe_energy_report *report = &g->reports[begin / PE_ISLAND_GRAIN];
    *report = (pe_energy_report){0};
    for (int k = begin; k < end; ++k) {
        const int *slots = g->groups->bodies + g->groups->body_start[k];
        const int count = g->groups->body_start[k + 1] - g->groups->body_start[k];
        guard_group(&(group){g->step, g->lifts, slots, count}, g->put_back, report);
    }
}

void pe_energy_guard(const pe_step *step, const pe_islands *groups, bool *put_back,
                     pe_energy_report *report)
{
    *report = (pe_energy_report){0};
    const double *lifts = step->stats.islands_by_path[PE_PATH_SOFT] > 0 ? find_lifts(step) : NULL;
    const int pieces = pe_piece_count(groups->count, PE_ISLAND_GRAIN);
    pe_energy_report *reports = pe_scratch(step->world, (size_t)pieces + 1, sizeof *reports);
    if (reports == NULL) {
        return; /* the caller looks whether there was no memory */
    }
    guarding g = {step, groups, lifts, put_back, reports};
    pe_pool_run(step->world->pool, groups->count, PE_ISLAND_GRAIN, guard_groups, &g);
    for (int i = 0; i < pieces; ++i) {
        report->islands += reports[i].islands;
        report->removed += reports[i].removed;
        report->put_back += reports[i].put_back;
    }
    for (int i = 0; i < pe_awake_count(step->world); ++i) {
        const int slot = pe_awake(step->world)[i];
        if (is_corrected(step, slot) && groups->place[slot] < 0) {
            guard_group(&(group){step, lifts, &slot, 1}, put_back, report);
        }
    }
}
