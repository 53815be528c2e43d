/* A body whose centre of mass moves by d while its velocity goes from v to v' has made the step of
 *
 *   semi-implicit Euler   d = h v'
 *   a second-order rule   d = h (v + v') / 2, or d = h v' - h^2 g / 2, where impulses come before
 * the flight; under gravity alone the two are one
 *
 * The rules differ by h |v' - v| / 2. A step votes where that is far above rounding, and where one
 * rule fits to a thousandth of it: one that pushes a body out of another fits none. */
#include "referee/integrator.h"

#include "referee/solid.h"

static const double RESOLUTION = 1e-10; /* of the distance from the origin */
static const double FIT = 1e-3;
static const double FREE = 1e-9; /* of the velocity that gravity gives in a step */

static pl_vec centre_of(const pl_body *body, const pl_body_state *state)
{
    return pl_centre_of_mass(&body->shape, state->position, state->orientation);
}

static void see_body(pl_integrator_votes *votes, const pl_body *body, pl_vec g, double h,
                     const pl_body_state *before, const pl_body_state *after)
{
    pl_vec x = centre_of(body, before), v = pl_vec_of(before->velocity);
    pl_vec end = pl_vec_of(after->velocity);
    double apart = h * pl_vec_length(pl_vec_sub(end, v));
    if (!(apart > RESOLUTION * (pl_vec_length(x) + pl_bounding_radius(&body->shape)))) {
        return;
    }
    pl_vec late = pl_vec_mad(pl_vec_sub(centre_of(body, after), x), -h, end); /* d - h v' */
    double semi_implicit = pl_vec_length(late);
    double mean = pl_vec_length(pl_vec_mad(late, h / 2, pl_vec_sub(end, v)));
    double flight = pl_vec_length(pl_vec_mad(late, h * h / 2, g));
    double second_order = fmin(mean, flight);
    if (fmin(semi_implicit, second_order) <= FIT * apart) {
        pl_vec falling = pl_vec_mad(pl_vec_sub(end, v), -h, g);
        bool flies = pl_vec_length(falling) <= FREE * h * pl_vec_length(g);
        long *count = flies ? votes->flying : votes->pushed;
        count[semi_implicit <= second_order ? PL_SEMI_IMPLICIT : PL_SECOND_ORDER] += 1;
    }
}

void pl_integrator_see(pl_integrator_votes *votes, const pl_scene *scene,
                       const pl_body_state *before, const pl_body_state *after)
{
    pl_vec g = pl_vec_of(scene->gravity);
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            see_body(votes, &scene->bodies[i], g, scene->dt, &before[i], &after[i]);
        }
    }
}

pl_integrator pl_integrator_of(const pl_integrator_votes *votes)
{
    bool flew = votes->flying[PL_SECOND_ORDER] > 0 || votes->flying[PL_SEMI_IMPLICIT] > 0;
    const long *count = flew ? votes->flying : votes->pushed;
    return count[PL_SECOND_ORDER] > count[PL_SEMI_IMPLICIT] ? PL_SECOND_ORDER : PL_SEMI_IMPLICIT;
}
