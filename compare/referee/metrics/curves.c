/* Kinetic energy is m v^2 / 2 + w I w / 2, with the inertia in its principal axes. Potential energy is
 * -m g . (x - x0) of the centre of mass. */
#include "curves.h"

#include "expectations.h"
#include "referee/geometry/solid.h"

#include <math.h>

const char *pl_curve_name(pl_curve curve)
{
    static const char *const names[PL_CURVE_COUNT] = {
        "rest_error", "penetration", "kinetic_energy", "energy",
        "iterations", "residual",    "contact_force"};
    return names[curve];
}

static double kinetic_energy(const pl_body *body, const pl_body_state *state)
{
    const pl_axes axes = pl_principal_axes(&body->shape, state->orientation);
    const pl_vec spin = pl_to_local(&axes, pl_vec_of(state->angular_velocity));
    return pl_kinetic_energy(body, state->velocity, spin);
}

/* The potential energy in gravity, from that of the start on. */
static double potential_energy(const pl_scene *scene, const pl_body *body,
                               const pl_body_state *state)
{
    const pl_vec start = pl_centre_of_mass(&body->shape, body->position, body->orientation);
    const pl_vec moved = pl_vec_sub(pl_state_centre(body, state), start);
    return -body->mass * pl_vec_dot(pl_vec_of(scene->gravity), moved);
}

void pl_curves_of(const pl_scene *scene, const pl_body_state *bodies, const pl_contact *contacts,
                  int contact_count, double value[PL_CURVE_COUNT])
{
    double distance = 0, kinetic = 0, potential = 0, force = 0;
    const bool rests = pl_farthest_from_rest(scene, bodies, &distance) >= 0;
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            kinetic += kinetic_energy(&scene->bodies[i], &bodies[i]);
            potential += potential_energy(scene, &scene->bodies[i], &bodies[i]);
        }
    }
    for (int i = 0; i < contact_count; ++i) {
        force += pl_vec_length(pl_vec_of(contacts[i].impulse)) / scene->dt;
    }
    value[PL_CURVE_REST_ERROR] = rests ? distance : (double)NAN;
    value[PL_CURVE_KINETIC_ENERGY] = kinetic;
    value[PL_CURVE_ENERGY] = kinetic + potential;
    value[PL_CURVE_CONTACT_FORCE] = contact_count >= 0 ? force : (double)NAN;
}
