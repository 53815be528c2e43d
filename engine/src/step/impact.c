#include "impact.h"

#include "integrate_positions.h"
#include "toi_substep.h"

enum {
    MOST_PARTS = 8, /* of a step */
    MOST_TRIES = 8  /* to hit the time of an impact */
};

/* In units of the first impact's speed: what follows it at less is none. */
static const double MINOR = 1e-3;

bool pe_impact_is_due(const pe_world *world, const pe_islands *islands, int k, double dt)
{
    if (islands->body_start[k + 1] - islands->body_start[k] > world->def.impact_bodies) {
        return false;
    }
    double slow = pe_slow_closing(world, dt);
    bool due = false;
    for (int i = islands->start[k]; i < islands->start[k + 1] && !due; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[islands->manifolds[i]];
        for (int j = m->first; j < m->first + m->count && !due; ++j) {
            const pe_manifold_point *point = &pe_manifold_points(&world->contacts)[j];
            double speed = pe_opening_now(world, m, point);
            due = speed < -slow && point->separation + dt * (speed - slow) < 0;
        }
    }
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1] && due; ++i) {
        const pe_applied_force *load = &pe_applied_forces(world)[islands->bodies[i]];
        due = pe_dot(load->torque, load->torque) == 0 &&
              pe_dot(load->body_torque, load->body_torque) == 0;
    }
    return due;
}

/* ---- Flights -----------------------------------------------------------------------------------
 */

static void predict(pe_substep *part, double dt)
{
    for (int i = 0; i < pe_substep_bodies(part); ++i) {
        int slot = part->island.bodies[i];
        part->free[slot] = pe_predict_body(part->world, slot, dt);
    }
}

static pe_twist solved_motion(const pe_island_problem *built, int i)
{
    const double *v = built->problem.velocity[i];
    return (pe_twist){pe_v3(v[0], v[1], v[2]), pe_v3(v[3], v[4], v[5])};
}

/* Where the bodies would be heading at the end of what is left, but for the impacts. */
static pe_status look_ahead(pe_substep *part)
{
    pe_island_problem built;
    predict(part, part->left);
    bool touching = pe_substep_choose(part, PE_SEPARATING) > 0;
    pe_status status = !touching
                           ? PE_OK
                           : pe_island_solve(part->world, &part->island, 0, part->free, part->left,
                                             part->tally, &built, &part->path, part->error);
    for (int i = 0; i < pe_substep_bodies(part) && status == PE_OK; ++i) {
        part->ends[i] = part->free[part->island.bodies[i]].end;
        if (touching) {
            part->ends[i] = solved_motion(&built, i);
        }
    }
    pe_substep_choose(part, PE_ALL);
    return status;
}

/* When a gap that opens by u0 now and by u1 at the end closes, s: a root of
 * gap + u0 t + (u1 - u0) t^2 / (2 left). HUGE_VAL: never. */
static double closing_time(double gap, double u0, double u1, double left)
{
    if (gap <= PE_CLOSED) {
        return 0;
    }
    double square = u0 * u0 - 2 * gap * (u1 - u0) / left;
    return square >= 0 ? 2 * gap / (sqrt(square) - u0) : HUGE_VAL;
}

static const pe_twist *end_of(const pe_substep *part, int slot)
{
    int place = part->island.place[slot];
    return place < 0 ? &pe_twists(part->world)[slot] : &part->ends[place];
}

/* When the first impact of what is left will be, s from now; `left` when there is none. *fast:
 * whether any contact closes fast enough to be one some time. */
static pe_status first_impact(pe_substep *part, double *time, bool *fast)
{
    pe_status status = look_ahead(part);
    const pe_contacts *contacts = &part->world->contacts;
    *time = part->left;
    *fast = false;
    for (int i = 0; i < contacts->manifold_count && status == PE_OK; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_manifold_point *point = &pe_manifold_points(contacts)[j];
            double u0 = pe_opening_now(part->world, m, point);
            if (u0 < -part->slow) {
                double u1 =
                    pe_opening(part->world, m, point, end_of(part, m->a), end_of(part, m->b));
                *time = pe_min(*time, closing_time(point->separation, u0, u1, part->left));
                *fast = true;
            }
        }
    }
    return status;
}

/* How far it is, at the speeds now, from the nearest impact, s; below 0 when that is past. */
static double time_to_go(const pe_substep *part)
{
    const pe_contacts *contacts = &part->world->contacts;
    double least = HUGE_VAL;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_manifold_point *point = &pe_manifold_points(contacts)[j];
            double speed = pe_opening_now(part->world, m, point);
            if (speed < -part->slow) {
                bool closed = fabs(point->separation) <= PE_CLOSED;
                least = pe_min(least, closed ? 0 : point->separation / -speed);
            }
        }
    }
    return least;
}

static void remember(pe_substep *part)
{
    for (int i = 0; i < pe_substep_bodies(part); ++i) {
        part->poses[i] = pe_poses(part->world)[part->island.bodies[i]];
        part->motions[i] = pe_twists(part->world)[part->island.bodies[i]];
    }
}

/* The bodies and the contacts as they were before the flight. */
static void go_back(pe_substep *part)
{
    for (int i = 0; i < pe_substep_bodies(part); ++i) {
        pe_poses(part->world)[part->island.bodies[i]] = part->poses[i];
        pe_twists(part->world)[part->island.bodies[i]] = part->motions[i];
    }
    pe_substep_unfind(part);
}

/* Moves the island over dt with all contacts but those about to strike. */
static pe_status fly(pe_substep *part, double dt)
{
    predict(part, dt);
    if (pe_substep_choose(part, PE_SEPARATING) > 0) {
        return pe_island_step(part->world, &part->island, 0, part->free, dt, part->tally,
                              &part->path, part->error);
    }
    for (int i = 0; i < pe_substep_bodies(part); ++i) {
        pe_integrate_free(part->world, part->island.bodies[i], part->free, dt);
    }
    return PE_OK;
}

/* Flies for about `time`, to where the impact is, or to the end of what is left. */
static pe_status fly_to_impact(pe_substep *part, double time)
{
    remember(part);
    for (int n = 0; n < MOST_TRIES; ++n) {
        pe_status status = fly(part, time);
        if (status == PE_OK) {
            status = pe_substep_find(part);
        }
        if (status != PE_OK) {
            return status;
        }
        double more = time_to_go(part);
        double next = more < HUGE_VAL ? pe_max(0.1 * time, pe_min(time + more, part->left)) : time;
        if (more == 0 || next == time || n + 1 == MOST_TRIES) {
            break;
        }
        go_back(part);
        time = next;
    }
    pe_substep_add_impulses(part, &part->world->previous);
    part->left -= time;
    return PE_OK;
}

/* ---- Impacts -----------------------------------------------------------------------------------
 */

/* Of the fastest that strikes now, m/s; 0: nothing does. */
static double striking_speed(const pe_substep *part)
{
    const pe_contacts *contacts = &part->world->contacts;
    double most = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_manifold_point *point = &pe_manifold_points(contacts)[j];
            double speed = pe_opening_now(part->world, m, point);
            most = pe_strikes_now(part, point, speed) ? pe_max(most, -speed) : most;
        }
    }
    return most;
}

/* What strikes now gets its new velocities. */
static pe_status strike(pe_substep *part)
{
    double speed = striking_speed(part);
    if (speed == 0) {
        return PE_OK;
    }
    for (int i = 0; i < pe_substep_bodies(part); ++i) {
        int slot = part->island.bodies[i];
        part->free[slot] = (pe_free_motion){.end = pe_twists(part->world)[slot]};
    }
    pe_substep_choose(part, PE_IMPACTING);
    pe_island_problem built;
    /* Gaps do not matter in an instant: over a second they close by nothing. */
    pe_status status = pe_island_solve(part->world, &part->island, 0, part->free, 1, part->tally,
                                       &built, &part->path, part->error);
    if (status == PE_OK) {
        for (int i = 0; i < pe_substep_bodies(part); ++i) {
            pe_twists(part->world)[part->island.bodies[i]] = solved_motion(&built, i);
        }
        pe_problem_store_impulses(part->world, &built);
        pe_substep_add_impulses(part, &part->world->contacts);
    }
    pe_substep_choose(part, PE_ALL);
    part->slow = pe_max(part->slow, MINOR * speed);
    return status;
}

/* From impact to impact, and on to the end of the step. */
static pe_status go(pe_substep *part)
{
    pe_status status = pe_substep_find(part);
    bool fast = true;
    for (int n = 0; n < MOST_PARTS && fast && part->left > 0 && status == PE_OK; ++n) {
        double time;
        status = first_impact(part, &time, &fast);
        if (status == PE_OK && fast && time > 0) {
            status = fly_to_impact(part, time);
        }
        if (status == PE_OK && fast && part->left > 0) {
            status = strike(part);
        }
    }
    if (status == PE_OK && part->left > 0) {
        predict(part, part->left);
        status = pe_island_step(part->world, &part->island, 0, part->free, part->left, part->tally,
                                &part->path, part->error);
        pe_substep_add_impulses(part, &part->world->contacts);
    }
    return status;
}

pe_status pe_impact_step(pe_world *world, const pe_islands *islands, int k,
                         const pe_contact_rules *rules, double dt, pe_solve_tally *tally,
                         pe_path *path, pe_error *error)
{
    pe_substep part = {.world = world,
                       .rules = rules,
                       .whole = islands,
                       .k = k,
                       .dt = dt,
                       .left = dt,
                       .slow = pe_slow_closing(world, dt),
                       .tally = tally,
                       .path = PE_PATH_NONE,
                       .error = error};
    pe_status status = pe_substep_begin(&part);
    if (status != PE_OK) {
        return status;
    }
    pe_substep_clear_impulses(&part);
    world->part.manifold_count = world->part.point_count = 0;
    pe_substep_exchange(world);
    status = go(&part);
    pe_substep_exchange(world);
    *path = part.path;
    return status;
}
