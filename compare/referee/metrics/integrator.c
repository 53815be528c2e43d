/* A body whose centre of mass moves by d while its velocity goes from v to v' has made the step of
 *
 *   semi-implicit Euler   d = h v'
 *   a second-order rule   d = h (v + v') / 2, or d = h v' - h^2 g / 2, where impulses come before
 * the flight; under gravity alone the two are one
 *
 * The rules differ by h |v' - v| / 2. A step votes where that is far above rounding and one rule
 * alone fits, to a thousandth of it: one that pushes a body out of another fits none, and without
 * gravity an impulse before the flight fits both. */
#include "integrator.h"

#include "referee/geometry/solid.h"

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
    bool is_first = semi_implicit <= FIT * apart, is_second = second_order <= FIT * apart;
    if (is_first && is_second) {
        return;
    }
    pl_vec falling = pl_vec_mad(pl_vec_sub(end, v), -h, g);
    bool flies = pl_vec_length(falling) <= FREE * h * pl_vec_length(g);
    long *count = flies ? votes->flying : votes->pushed;
    count[is_first ? PL_SEMI_IMPLICIT : is_second ? PL_SECOND_ORDER : PL_INTEGRATOR_COUNT] += 1;
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

/* The votes that count. */
static const long *votes_of(const pl_integrator_votes *votes)
{
    bool flew = votes->flying[PL_SECOND_ORDER] > 0 || votes->flying[PL_SEMI_IMPLICIT] > 0;
    return flew ? votes->flying : votes->pushed;
}

pl_integrator pl_integrator_of(const pl_integrator_votes *votes)
{
    const long *count = votes_of(votes);
    return count[PL_SECOND_ORDER] > count[PL_SEMI_IMPLICIT] ? PL_SECOND_ORDER : PL_SEMI_IMPLICIT;
}

pl_integrator_certainty pl_integrator_certain(const pl_integrator_votes *votes)
{
    const long *count = votes_of(votes);
    long either = count[PL_SEMI_IMPLICIT] + count[PL_SECOND_ORDER];
    if (either == 0 || either < count[PL_INTEGRATOR_COUNT]) {
        return PL_INTEGRATOR_UNTOLD;
    }
    long more = count[pl_integrator_of(votes)];
    return 10 * more >= 9 * either ? PL_INTEGRATOR_TOLD : PL_INTEGRATOR_MIXED;
}

const char *pl_integrator_name(const pl_integrator_votes *votes)
{
    switch (pl_integrator_certain(votes)) {
    case PL_INTEGRATOR_TOLD:
        return pl_integrator_of(votes) == PL_SECOND_ORDER ? "second order, exact for constant force"
                                                          : "semi-implicit Euler";
    case PL_INTEGRATOR_MIXED:
        return "mixed";
    case PL_INTEGRATOR_UNTOLD:
        break;
    }
    return NULL;
}
