/* The scene has the answer x_s of semi-implicit Euler with one sub-step of h, and the answer x of
 * the continuous problem. Any other integrator follows from these.
 *
 * A motion that accelerates evenly from v_0 to v_N in the time t_s and then keeps v_N has
 *   x = (v_0 + v_N) t_s / 2 + v_N (T - t_s),
 * which gives t_s. With sub-steps of k = h / n, semi-implicit Euler accelerates in the m = floor(t_s
 * / k) of them that are whole, so that with a = (v_N - v_0) / t_s
 *   x_k = v_0 m k + a k^2 m (m + 1) / 2 + v_N (T - m k).
 * Under uniform acceleration, t_s = T, this is x_s - (1 - 1/n) h (v_N - v_0) / 2; braking to rest
 * has v_N = 0; a ball that skids, and then rolls, has both parts. v_N is expected of the same body,
 * or it is one of 2 x / T - v_0 (t_s = T) and 0. x_h must be x_s: that tells of which kind a motion
 * is, and no other kind has an answer for sub-steps.
 *
 * A second-order rule has the same velocities at the ends of its sub-steps, and moves by their
 * means: x_k - k (v_N - v_0) / 2; with one sub-step this is so for any motion whose v_N is known.
 */
#include "mechanics.h"

#include "plumb/vec.h"

#include <math.h>

/* Relative difference below which two displacements are equal. */
static const double SAME = 1e-9;

/* An expected displacement, m, or rotation, rad. */
typedef struct displacement {
    double start;                /* initial velocity, per s */
    double time;                 /* s */
    double continuous, discrete; /* x and x_s */
} displacement;

static bool same(const displacement *d, double a, double b)
{
    return fabs(a - b) <= SAME * (fabs(d->continuous) + fabs(d->start) * d->time);
}

/* x_k of a motion that comes to the velocity `end` and keeps it; NAN if that does not go as far as
 * the continuous answer. */
static double displacement_at(const displacement *d, double end, double k)
{
    const double kept = end * d->time;
    if (same(d, d->start * d->time, kept)) {
        return same(d, d->continuous, kept) ? d->continuous : (double)NAN;
    }
    const double time = 2 * (d->continuous - kept) / (d->start - end);
    if (!(time > 0 && time <= d->time * (1 + SAME))) {
        return (double)NAN;
    }
    const double steps = floor(time / k), acceleration = (end - d->start) / time;
    return d->start * steps * k + acceleration * k * k * steps * (steps + 1) / 2 +
           end * (d->time - steps * k);
}

/* The answer of a rule with `substeps` in h, or NAN; `end` is v_N, or NAN if it is not expected. */
static double answer(const displacement *d, double end, double h, pl_position_rule rule,
                     int substeps)
{
    if (isnan(d->discrete) || (rule == PL_SEMI_IMPLICIT && substeps == 1)) {
        return d->discrete;
    }
    if (!isnan(end) && substeps == 1) {
        return d->discrete - h * (end - d->start) / 2;
    }
    const double k = h / substeps;
    const double kinds[] = {end, 2 * d->continuous / d->time - d->start, 0};
    for (int i = isnan(end) ? 1 : 0; i < (isnan(end) ? 3 : 1); ++i) {
        const double change = kinds[i] - d->start;
        if (same(d, d->discrete, displacement_at(d, kinds[i], h))) {
            return displacement_at(d, kinds[i], k) - (rule == PL_SECOND_ORDER ? k * change / 2 : 0);
        }
    }
    return (double)NAN;
}

double pl_discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                          pl_position_rule rule, const pl_referee_engine *engine)
{
    const pl_vec velocity = pl_vec_of(scene->bodies[travel->body].velocity);
    const displacement d = {.start = pl_vec_dot(velocity, pl_vec_of(travel->direction)),
                            .time = (double)pl_scene_steps(scene) * scene->dt,
                            .continuous = travel->distance,
                            .discrete = travel->discrete};
    return answer(&d, (double)NAN, scene->dt, rule, pl_substeps_of(engine));
}

/* The velocity or spin that is expected of the same body, direction and time as `of`; NAN if none
 * is. */
static double end_velocity(const pl_scene *scene, const pl_expect_value *of, pl_quantity quantity)
{
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *v = &scene->values[i];
        const pl_vec apart = pl_vec_sub(pl_vec_of(v->direction), pl_vec_of(of->direction));
        if (v->body == of->body && v->quantity == quantity && v->until == of->until &&
            pl_vec_length(apart) == 0) {
            return v->discrete;
        }
    }
    return (double)NAN;
}

/* The apex of a throw, of height w^2 / (2 g): that of semi-implicit Euler is the apex of the speed
 * w - g k / 2, and a second-order rule is on the parabola itself. Without an answer for one
 * sub-step, or with one of another form, there is none for more. */
static double apex(const pl_scene *scene, const pl_expect_value *value, pl_position_rule rule,
                   int substeps)
{
    const double g = -pl_vec_dot(pl_vec_of(scene->gravity), pl_vec_of(value->direction));
    const double speed = sqrt(2 * g * value->value), late = g * scene->dt / 2;
    if (rule == PL_SECOND_ORDER || substeps == 1) {
        return rule == PL_SECOND_ORDER ? value->value : value->discrete;
    }
    const double first = speed - late, now = speed - late / substeps;
    const displacement d = {.continuous = value->value};
    return same(&d, value->discrete, first * first / (2 * g)) ? now * now / (2 * g) : (double)NAN;
}

double pl_discrete_value(const pl_scene *scene, const pl_expect_value *value, pl_position_rule rule,
                         const pl_referee_engine *engine)
{
    const pl_body *body = &scene->bodies[value->body];
    const bool turns = value->quantity == PL_QUANTITY_TURN;
    const int substeps = pl_substeps_of(engine);
    if (isnan(value->discrete)) {
        return value->discrete;
    }
    switch (value->quantity) {
    case PL_QUANTITY_POSITION:
    case PL_QUANTITY_TURN: {
        const pl_vec velocity = pl_vec_of(turns ? body->angular_velocity : body->velocity);
        const displacement d = {.start = pl_vec_dot(velocity, pl_vec_of(value->direction)),
                                .time = value->until,
                                .continuous = value->value,
                                .discrete = value->discrete};
        return answer(&d,
                      end_velocity(scene, value, turns ? PL_QUANTITY_SPIN : PL_QUANTITY_VELOCITY),
                      scene->dt, rule, substeps);
    }
    case PL_QUANTITY_VELOCITY:
    case PL_QUANTITY_SPIN: /* with sub-steps: only if the time-stepping does not change it */
        return substeps == 1 || value->discrete == value->value ? value->discrete : (double)NAN;
    case PL_QUANTITY_APEX:
        return apex(scene, value, rule, substeps);
    case PL_QUANTITY_PERIOD:
    case PL_QUANTITY_TOP_SPEED:
    case PL_QUANTITY_EXCURSION:
    case PL_QUANTITY_ENERGY:
        break;
    }
    return (double)NAN;
}
