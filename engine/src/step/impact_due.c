/* Which islands have impacts, and which of these take them at their own time. */
#include "impact.h"

/* Times impact_bodies may be in an island in which only impacts push. */
enum { IN_FLIGHT = 8 };

static double opening(const pe_world *world, const pe_point_walk *at)
{
    const pe_twist *twists = pe_twists(world);
    return pe_opening_speed(world, at->manifold, at->point, &twists[at->manifold->a],
                            &twists[at->manifold->b]);
}

bool pe_impact_is_due(const pe_step *step, const pe_islands *islands, int k)
{
    const pe_world *world = step->world;
    bool due = false;
    pe_point_walk at = pe_walk_island(&world->contacts, islands, k);
    while (!due && pe_next_point(&at)) {
        double speed = opening(world, &at), slow = pe_slow_closing(world, at.manifold, step->dt);
        due =
            speed < -slow &&
            at.point->separation + step->dt * (speed - pe_max(slow, pe_fall(world, step->dt))) < 0;
    }
    return due;
}

static const pe_twist *free_end(const pe_step *step, int slot)
{
    return pe_bodies(step->world)[slot].is_static ? &pe_twists(step->world)[slot]
                                                  : &step->free[slot].end;
}

bool pe_may_bounce(const pe_world *world, const pe_islands *islands, int k)
{
    bool any = false;
    for (int j = islands->start[k]; j < islands->start[k + 1] && !any; ++j) {
        any = pe_manifolds(&world->contacts)[islands->manifolds[j]].restitution > 0;
    }
    return any;
}

/* Whether no contact of the island pushes in the step, except in impacts. */
static bool is_in_flight(const pe_step *step, const pe_islands *islands, int k)
{
    const pe_world *world = step->world;
    pe_point_walk at = pe_walk_island(&world->contacts, islands, k);
    while (pe_next_point(&at)) {
        double slow = pe_slow_closing(world, at.manifold, step->dt);
        double end = pe_opening_speed(world, at.manifold, at.point, free_end(step, at.manifold->a),
                                      free_end(step, at.manifold->b));
        if (pe_max(at.point->separation, 0) + step->dt * end < -pe_closed_gap(at.manifold) &&
            opening(world, &at) >= -slow) {
            return false;
        }
    }
    return true;
}

bool pe_impact_has_own_time(const pe_step *step, const pe_islands *islands, int k)
{
    const pe_world *world = step->world;
    const int begin = islands->body_start[k], end = islands->body_start[k + 1];
    const int excess = end - begin - world->def.impact_bodies;
    if (excess > (IN_FLIGHT - 1) * world->def.impact_bodies ||
        !pe_impact_is_due(step, islands, k)) {
        return false;
    }
    for (int i = begin; i < end; ++i) {
        if (pe_has_torque(pe_applied_force_of(world, islands->bodies[i]))) {
            return false;
        }
    }
    return excess <= 0 || (pe_may_bounce(world, islands, k) && is_in_flight(step, islands, k));
}
