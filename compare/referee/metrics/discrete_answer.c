/* The scene has the answer x_s of semi-implicit Euler. A second-order rule has the same velocities
 * v_k at the frames, and moves by their means, so that after N steps
 *
 *   x_2 = x_s - h (v_N - v_0) / 2
 *
 * v_0 is the scene's. v_N is expected too, or follows from the answer x of the continuous problem
 * where all is one motion: 2 x / T - v_0 of uniform acceleration (then x_2 = x), 0 of uniform
 * braking to rest. Which of the two it is shows, since each gives x_s from x. */
#include "discrete_answer.h"

#include "plumb/vec.h"

#include <math.h>

static const double SAME = 1e-9; /* of the way */

/* An expected way, in m, or turn, in rad. */
typedef struct way {
    double start;                /* velocity, per s */
    double time;                 /* s */
    double continuous, discrete; /* x and x_s */
} way;

static bool same(const way *w, double a, double b)
{
    return fabs(a - b) <= SAME * (fabs(w->continuous) + fabs(w->start) * w->time);
}

/* x_s, if uniform braking brings the body to rest after x. NAN where it does not. */
static double braked(const way *w, double h)
{
    double braking = w->start * w->start / (2 * w->continuous);
    if (!(w->start * w->continuous > 0) || fabs(w->start / braking) > w->time) {
        return (double)NAN;
    }
    double steps = floor(fabs(w->start / (braking * h)));
    return steps * h * w->start - braking * h * h * steps * (steps + 1) / 2;
}

/* x_2; `end` is v_N, NAN where it is not expected. */
static double second_order(const way *w, double end, double h)
{
    if (isnan(w->discrete)) {
        return (double)NAN;
    }
    if (!isnan(end)) {
        return w->discrete - h * (end - w->start) / 2;
    }
    if (same(w, w->discrete, w->continuous + h * (w->continuous / w->time - w->start))) {
        return w->continuous;
    }
    return same(w, w->discrete, braked(w, h)) ? w->discrete + h * w->start / 2 : (double)NAN;
}

double pl_discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                          pl_integrator integrator)
{
    if (integrator == PL_SEMI_IMPLICIT) {
        return travel->discrete;
    }
    pl_vec velocity = pl_vec_of(scene->bodies[travel->body].velocity);
    way w = {.start = pl_vec_dot(velocity, pl_vec_of(travel->direction)),
             .time = (double)pl_scene_steps(scene) * scene->dt,
             .continuous = travel->distance,
             .discrete = travel->discrete};
    return second_order(&w, (double)NAN, scene->dt);
}

/* The velocity that is expected where the way is; NAN where none is. */
static double end_velocity(const pl_scene *scene, const pl_expect_value *of, pl_quantity quantity)
{
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *v = &scene->values[i];
        pl_vec apart = pl_vec_sub(pl_vec_of(v->direction), pl_vec_of(of->direction));
        if (v->body == of->body && v->quantity == quantity && v->until == of->until &&
            pl_vec_length(apart) == 0) {
            return v->discrete;
        }
    }
    return (double)NAN;
}

double pl_discrete_value(const pl_scene *scene, const pl_expect_value *value,
                         pl_integrator integrator)
{
    const pl_body *body = &scene->bodies[value->body];
    bool turns = value->quantity == PL_QUANTITY_TURN;
    if (integrator == PL_SEMI_IMPLICIT || isnan(value->discrete)) {
        return value->discrete;
    }
    switch (value->quantity) {
    case PL_QUANTITY_POSITION:
    case PL_QUANTITY_TURN: {
        pl_vec velocity = pl_vec_of(turns ? body->angular_velocity : body->velocity);
        way w = {.start = pl_vec_dot(velocity, pl_vec_of(value->direction)),
                 .time = value->until,
                 .continuous = value->value,
                 .discrete = value->discrete};
        double end = end_velocity(scene, value, turns ? PL_QUANTITY_SPIN : PL_QUANTITY_VELOCITY);
        return second_order(&w, end, scene->dt);
    }
    case PL_QUANTITY_VELOCITY:
    case PL_QUANTITY_SPIN:
        return value->discrete;
    case PL_QUANTITY_APEX: /* a parabola through frames that lie on one */
        return value->value;
    case PL_QUANTITY_PERIOD:
        break;
    }
    return (double)NAN;
}
