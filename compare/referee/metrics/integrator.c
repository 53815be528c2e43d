/* A body whose centre of mass moves by d while its velocity goes from v to v' has made a step of
 *
 *   semi-implicit Euler         d = h v', with n sub-steps h v' - (1 - 1/n) h (v' - v) / 2
 *   a second-order integrator   d = h (v + v') / 2, with or without what forces add that turn with
 *                               the body, or d = h v' - h^2 g / 2, where impulses come before the
 *                               flight; under gravity alone these are equal
 *
 * The two integrators differ by h |v' - v| / (2n). A step votes where that is far above rounding
 * and the step fits exactly one of them, to a thousandth of h |v' - v| and to the rounding of the
 * precision that the engine declares. A step in which the engine pushes a body out of another fits
 * neither, and without gravity an impulse before the flight fits both. */
#include "mechanics.h"

#include "plumb/vec.h"
#include "referee/geometry/solid.h"

static const double RESOLUTION = 1e-10; /* of the distance from the origin */
static const double FIT = 1e-3;
static const double FREE = 1e-9; /* of the velocity that gravity gives in a step */
/* Of the steps that fit semi-implicit Euler: so many may fit second order by chance. */
static const double BY_CHANCE = 1e-3;

int pl_substeps_of(const pl_referee_engine *engine)
{
    return engine->substeps > 1 ? engine->substeps : 1;
}

double pl_step_rounding(const pl_referee_engine *engine)
{
    const double rounding = 1.0 / (1 << 24);
    return engine->precision == PL_PRECISION_FLOAT ? 2 * (pl_substeps_of(engine) + 1) * rounding
                                                   : 0;
}

double pl_later_share(const pl_referee_engine *engine)
{
    return 0.5 * (1 - 1.0 / pl_substeps_of(engine));
}

static void count_body(pl_integrator_votes *votes, const pl_body *body, pl_vec g, double h,
                       const pl_body_state *before, const pl_body_state *after, pl_vec turned)
{
    pl_vec x = pl_state_centre(body, before), v = pl_vec_of(before->velocity);
    pl_vec end = pl_vec_of(after->velocity);
    double apart = h * pl_vec_length(pl_vec_sub(end, v));
    if (!(apart > RESOLUTION * (pl_vec_length(x) + pl_bounding_radius(&body->shape)))) {
        return;
    }
    pl_vec late = pl_vec_mad(pl_vec_sub(pl_state_centre(body, after), x), -h, end); /* d - h v' */
    const double rounding = pl_step_rounding(&votes->engine), speed = pl_vec_length(v);
    const double blur = rounding * (pl_vec_length(x) + pl_bounding_radius(&body->shape) +
                                    h * (speed + pl_vec_length(end)));
    const double fit = FIT * apart + blur;
    double semi_implicit =
        pl_vec_length(pl_vec_mad(late, pl_later_share(&votes->engine) * h, pl_vec_sub(end, v)));
    double mean = pl_vec_length(pl_vec_mad(late, h / 2, pl_vec_sub(end, v)));
    double turning = pl_vec_length(pl_vec_sub(pl_vec_mad(late, h / 2, pl_vec_sub(end, v)), turned));
    double flight = pl_vec_length(pl_vec_mad(late, h * h / 2, g));
    double second_order = fmin(fmin(mean, turning), flight);
    bool is_first = semi_implicit <= fit, is_second = second_order <= fit;
    if (is_first && is_second) {
        return;
    }
    pl_vec falling = pl_vec_mad(pl_vec_sub(end, v), -h, g);
    const double fall = h * pl_vec_length(g);
    bool flies = pl_vec_length(falling) <= FREE * fall + rounding * (speed + fall);
    long *count = flies ? votes->flying : votes->pushed;
    count[is_first ? PL_SEMI_IMPLICIT : is_second ? PL_SECOND_ORDER : PL_POSITION_RULE_COUNT] += 1;
}

void pl_integrator_see(pl_integrator_votes *votes, const pl_scene *scene,
                       const pl_body_state *before, const pl_body_state *after,
                       const pl_vec *turned)
{
    pl_vec g = pl_vec_of(scene->gravity);
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            count_body(votes, &scene->bodies[i], g, scene->dt, &before[i], &after[i], turned[i]);
        }
    }
}

/* Whether any step in free flight fits an integrator. */
static bool flew(const pl_integrator_votes *votes)
{
    return votes->flying[PL_SECOND_ORDER] > 0 || votes->flying[PL_SEMI_IMPLICIT] > 0;
}

/* The votes that count: those in free flight, if there are any. */
static const long *deciding_votes(const pl_integrator_votes *votes)
{
    return flew(votes) ? votes->flying : votes->pushed;
}

pl_position_rule pl_integrator_of(const pl_integrator_votes *votes)
{
    const long *count = deciding_votes(votes);
    const double least = flew(votes) ? 1 : BY_CHANCE;
    return (double)count[PL_SECOND_ORDER] > least * (double)count[PL_SEMI_IMPLICIT]
               ? PL_SECOND_ORDER
               : PL_SEMI_IMPLICIT;
}

pl_integrator_certainty pl_integrator_certain(const pl_integrator_votes *votes)
{
    const long *count = deciding_votes(votes);
    long either = count[PL_SEMI_IMPLICIT] + count[PL_SECOND_ORDER];
    if (either == 0 || either < count[PL_POSITION_RULE_COUNT]) {
        return PL_INTEGRATOR_UNDETECTED;
    }
    long more = count[pl_integrator_of(votes)];
    return 10 * more >= 9 * either ? PL_INTEGRATOR_DETECTED : PL_INTEGRATOR_MIXED;
}
