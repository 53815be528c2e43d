/* Errors against the references of a scene.
 *
 * The scene has the discrete reference x_s of semi-implicit Euler. A second-order integrator has
 * the same velocities v_k at the frames, and moves by their means, so that after N steps
 *
 *   x_2 = x_s - h (v_N - v_0) / 2
 *
 * v_0 is given by the scene. v_N is expected too, or follows from the reference x of the continuous
 * problem if the whole motion is one of two kinds: for uniform acceleration it is 2 x / T - v_0
 * (then x_2 = x), for uniform braking to rest it is 0. Each kind gives x_s from x, which tells
 * which of the two it is. */
#include "reference_error.h"

#include "base/hash.h"

#include <string.h>

/* A frame within this part of a step of `until` is at `until`. */
static const double SAME_TIME = 1e-6;
/* Relative difference below which two displacements are equal. */
static const double SAME = 1e-9;

static double relative(double actual, double expected)
{
    return fabs(actual - expected) / fabs(expected);
}

/* Makes the metric the larger of its value and `error`. */
static void raise_to(pl_metric *metric, double error)
{
    *metric = pl_metric_value(fmax(metric->value, error));
}

/* ---- Discrete references ---- */

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

/* x_s, if uniform braking brings the body to rest after x; otherwise NAN. */
static double braked(const displacement *d, double h)
{
    double braking = d->start * d->start / (2 * d->continuous);
    if (!(d->start * d->continuous > 0) || fabs(d->start / braking) > d->time) {
        return (double)NAN;
    }
    double steps = floor(fabs(d->start / (braking * h)));
    return steps * h * d->start - braking * h * h * steps * (steps + 1) / 2;
}

/* x_2, or NAN if it is not known; `end` is v_N, or NAN if it is not expected. */
static double second_order(const displacement *d, double end, double h)
{
    if (isnan(d->discrete)) {
        return (double)NAN;
    }
    if (!isnan(end)) {
        return d->discrete - h * (end - d->start) / 2;
    }
    if (same(d, d->discrete, d->continuous + h * (d->continuous / d->time - d->start))) {
        return d->continuous;
    }
    return same(d, d->discrete, braked(d, h)) ? d->discrete + h * d->start / 2 : (double)NAN;
}

/* The discrete reference of a travel, m; NAN if it is not known. */
static double discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                              pl_position_rule integrator)
{
    if (integrator == PL_SEMI_IMPLICIT) {
        return travel->discrete;
    }
    pl_vec velocity = pl_vec_of(scene->bodies[travel->body].velocity);
    displacement d = {.start = pl_vec_dot(velocity, pl_vec_of(travel->direction)),
                      .time = (double)pl_scene_steps(scene) * scene->dt,
                      .continuous = travel->distance,
                      .discrete = travel->discrete};
    return second_order(&d, (double)NAN, scene->dt);
}

/* The velocity or spin that is expected of the same body, direction and time as `of`; NAN if none
 * is. */
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

/* The discrete reference of a value, in its unit; NAN if it is not known. */
static double discrete_value(const pl_scene *scene, const pl_expect_value *value,
                             pl_position_rule integrator)
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
        displacement d = {.start = pl_vec_dot(velocity, pl_vec_of(value->direction)),
                          .time = value->until,
                          .continuous = value->value,
                          .discrete = value->discrete};
        double end = end_velocity(scene, value, turns ? PL_QUANTITY_SPIN : PL_QUANTITY_VELOCITY);
        return second_order(&d, end, scene->dt);
    }
    case PL_QUANTITY_VELOCITY:
    case PL_QUANTITY_SPIN:
        return value->discrete;
    case PL_QUANTITY_APEX: /* that of the parabola through the frames, which lie on one */
        return value->value;
    case PL_QUANTITY_PERIOD:
        break;
    }
    return (double)NAN;
}

/* ---- Expected values ---- */

/* An expected value and what the frames so far show of it. */
typedef struct reading {
    const pl_expect_value *expected;
    pl_vec direction, origin;
    bool done;                            /* the frame at `until` has been seen */
    double found;                         /* the value so far */
    double sample[3];                     /* of an apex: positions in the last three frames */
    int samples;                          /* of an apex or a period: frames seen in the window */
    double orientation[4];                /* of a turn: in the last frame */
    double last_spin;                     /* of a period */
    long crossings;                       /* of a period: changes of the spin from - to + */
    double first_crossing, last_crossing; /* s */
} reading;

struct pl_values {
    const pl_scene *scene;
    reading *items; /* (scene->value_count) */
};

pl_values *pl_values_create(const pl_scene *scene, pl_arena *arena)
{
    pl_values *v = pl_arena_take(arena, 1, sizeof *v);
    reading *items = pl_arena_take(arena, (size_t)scene->value_count, sizeof *items);
    if (arena->failed) {
        return NULL;
    }
    *v = (pl_values){scene, items};
    for (int i = 0; i < scene->value_count; ++i) {
        items[i].expected = &scene->values[i];
        items[i].direction = pl_vec_of(scene->values[i].direction);
        items[i].found = scene->values[i].quantity == PL_QUANTITY_APEX ? -HUGE_VAL : 0;
    }
    return v;
}

/* The component along d of the rotation vector from orientation a to b, rad. */
static double turn_along(const double a[4], const double b[4], pl_vec d)
{
    pl_vec va = pl_vec_of(a + 1), vb = pl_vec_of(b + 1);
    double w = a[0] * b[0] + pl_vec_dot(va, vb);
    pl_vec v = pl_vec_sub(pl_vec_scale(vb, a[0]), pl_vec_scale(va, b[0]));
    v = pl_vec_sub(v, pl_vec_cross(vb, va));
    double sine = pl_vec_length(v), sign = w < 0 ? -1 : 1;
    return sine > 0 ? 2 * atan2(sine, fabs(w)) / sine * sign * pl_vec_dot(v, d) : 0;
}

/* The maximum of the parabola through three samples a step apart, of which the second is the
 * highest. */
static double crest(const double y[3])
{
    double bend = y[0] - 2 * y[1] + y[2], slope = 0.5 * (y[2] - y[0]);
    return bend < 0 ? y[1] - 0.5 * slope * slope / bend : y[1];
}

static void see_apex(reading *r, double height)
{
    r->sample[0] = r->sample[1];
    r->sample[1] = r->sample[2];
    r->sample[2] = height;
    r->samples += 1;
    r->found = fmax(r->found, height);
    if (r->samples >= 3 && r->sample[1] >= r->sample[0] && r->sample[1] >= r->sample[2]) {
        r->found = fmax(r->found, crest(r->sample));
    }
}

/* Of a period: the spin in the body's own axes. */
static void see_spin(reading *r, double time, double dt, const pl_body_state *body)
{
    pl_axes axes = pl_axes_of(body->orientation);
    pl_vec own = pl_to_local(&axes, pl_vec_of(body->angular_velocity));
    double spin = pl_vec_dot(own, r->direction);
    if (r->samples > 0 && r->last_spin < 0 && spin >= 0) {
        double at = time - dt * spin / (spin - r->last_spin);
        r->first_crossing = r->crossings == 0 ? at : r->first_crossing;
        r->last_crossing = at;
        r->crossings += 1;
    }
    r->last_spin = spin;
    r->samples += 1;
}

/* The value in this frame alone, for the quantities that are read at one time. */
static double value_in(const reading *r, const pl_body_state *body)
{
    switch (r->expected->quantity) {
    case PL_QUANTITY_VELOCITY:
        return pl_vec_dot(pl_vec_of(body->velocity), r->direction);
    case PL_QUANTITY_SPIN:
        return pl_vec_dot(pl_vec_of(body->angular_velocity), r->direction);
    case PL_QUANTITY_TURN:
        return r->found + turn_along(r->orientation, body->orientation, r->direction);
    default:
        return pl_vec_dot(pl_vec_sub(pl_vec_of(body->position), r->origin), r->direction);
    }
}

static void see_value(reading *r, long step, double dt, const pl_body_state *body)
{
    double time = (double)step * dt, until = r->expected->until;
    if (step == 0) {
        r->origin = pl_vec_of(body->position);
        memcpy(r->orientation, body->orientation, sizeof r->orientation);
    }
    pl_quantity quantity = r->expected->quantity;
    if (quantity == PL_QUANTITY_APEX || quantity == PL_QUANTITY_PERIOD) {
        if (time < r->expected->from - SAME_TIME * dt || time > until + SAME_TIME * dt) {
            return;
        }
        if (quantity == PL_QUANTITY_APEX) {
            see_apex(r, value_in(r, body));
        } else {
            see_spin(r, time, dt, body);
        }
    } else if (!r->done) {
        double now = value_in(r, body);
        r->done = time >= until - SAME_TIME * dt;
        /* If `until` is between two frames, only the part of the step before it counts. */
        double part = r->done && step > 0 ? 1 - fmax(0, time - until) / dt : 1;
        r->found += part * (now - r->found);
        memcpy(r->orientation, body->orientation, sizeof r->orientation);
    }
}

void pl_values_see(pl_values *values, long step, const pl_body_state *bodies)
{
    for (int i = 0; i < values->scene->value_count; ++i) {
        reading *r = &values->items[i];
        see_value(r, step, values->scene->dt, &bodies[r->expected->body]);
    }
}

/* Adds the error of one value to the largest so far. */
static void add_error(pl_metric *metric, const reading *r, double found, double expected)
{
    raise_to(metric, fabs(found - expected) / r->expected->scale);
}

static pl_metric value_error(const pl_values *values)
{
    pl_metric metric = {0};
    for (int i = 0; i < values->scene->value_count; ++i) {
        const reading *r = &values->items[i];
        const pl_expect_value *e = r->expected;
        double found = r->found;
        if (e->quantity == PL_QUANTITY_PERIOD) {
            if (r->crossings < 2) {
                return pl_metric_failed("no whole period was seen from %g to %g s", e->from,
                                        e->until);
            }
            found = (r->last_crossing - r->first_crossing) / (double)(r->crossings - 1);
        }
        add_error(&metric, r, found, e->value);
    }
    return metric;
}

/* ---- Final states ---- */

int pl_farthest_from_rest(const pl_scene *scene, const pl_body_state *bodies, double *distance)
{
    int farthest = -1;
    *distance = -1;
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        double d = pl_vec_length(
            pl_vec_sub(pl_vec_of(bodies[rest->body].position), pl_vec_of(rest->position)));
        if (d > *distance) {
            *distance = d;
            farthest = i;
        }
    }
    return farthest;
}

static pl_metric rest_position_error(const pl_scene *scene, const pl_body_state *bodies)
{
    double distance = 0;
    int farthest = pl_farthest_from_rest(scene, bodies, &distance);
    return farthest < 0 ? (pl_metric){0} : pl_metric_value(distance);
}

/* Spheres are left out, because their orientation is not visible. */
static pl_metric rest_rotation_error(const pl_scene *scene, const pl_body_state *bodies)
{
    pl_metric metric = {0};
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        if (rest->has_orientation && scene->bodies[rest->body].shape.kind != PL_SHAPE_SPHERE) {
            raise_to(&metric, pl_angle_between(rest->orientation, bodies[rest->body].orientation));
        }
    }
    return metric;
}

/* The displacement along the travel's direction from the scene's position of the body, m. */
static double travelled(const pl_scene *scene, const pl_body_state *bodies,
                        const pl_expect_travel *travel)
{
    pl_vec from = pl_vec_of(scene->bodies[travel->body].position);
    pl_vec to = pl_vec_of(bodies[travel->body].position);
    return pl_vec_dot(pl_vec_sub(to, from), pl_vec_of(travel->direction));
}

static pl_metric travel_error(const pl_scene *scene, const pl_body_state *bodies)
{
    pl_metric metric = {0};
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        raise_to(&metric, relative(travelled(scene, bodies, travel), travel->distance));
    }
    return metric;
}

/* The largest error of travels and values against the discrete references of an integrator; absent
 * if one of these is not known. */
static pl_metric discrete_error_of(const pl_values *values, const pl_body_state *bodies,
                                   pl_position_rule integrator)
{
    const pl_scene *scene = values->scene;
    pl_metric metric = {0};
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        double reference = discrete_travel(scene, travel, integrator);
        if (isnan(reference)) {
            return (pl_metric){0};
        }
        raise_to(&metric, relative(travelled(scene, bodies, travel), reference));
    }
    for (int i = 0; i < scene->value_count; ++i) {
        const reading *r = &values->items[i];
        double reference = discrete_value(scene, r->expected, integrator);
        if (isnan(reference) || r->expected->quantity == PL_QUANTITY_PERIOD) {
            return (pl_metric){0};
        }
        add_error(&metric, r, r->found, reference);
    }
    return metric;
}

/* Where the integrator was not detected, an error counts if it is the same by every integrator. The
 * references are those of whole steps. */
static pl_metric discrete_error(const pl_values *values, const pl_body_state *bodies,
                                const pl_integrator_votes *votes)
{
    if (votes->substeps > 1) {
        return (pl_metric){0};
    }
    pl_metric error = discrete_error_of(values, bodies, pl_integrator_of(votes));
    if (pl_integrator_certain(votes) == PL_INTEGRATOR_DETECTED) {
        return error;
    }
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        pl_metric other = discrete_error_of(values, bodies, (pl_position_rule)k);
        if (other.state != error.state || other.value != error.value) {
            return (pl_metric){0};
        }
    }
    return error;
}

static pl_metric text_metric(const char *text)
{
    pl_metric metric = {.state = PL_METRIC_TEXT};
    (void)snprintf(metric.text, sizeof metric.text, "%s", text);
    return metric;
}

static pl_metric integrator_metric(const pl_integrator_votes *votes)
{
    switch (pl_integrator_certain(votes)) {
    case PL_INTEGRATOR_DETECTED:
        return text_metric(pl_integrator_of(votes) == PL_SECOND_ORDER
                               ? "second order, exact for constant force"
                               : "semi-implicit Euler");
    case PL_INTEGRATOR_MIXED:
        return text_metric("mixed");
    case PL_INTEGRATOR_UNDETECTED:
        break;
    }
    return (pl_metric){0};
}

static pl_metric state_hash(const pl_scene *scene, const pl_body_state *bodies)
{
    char text[PL_HASH_TEXT_SIZE];
    uint64_t hash = PL_HASH_START;
    for (int i = 0; i < scene->body_count; ++i) {
        hash = pl_hash_numbers(hash, bodies[i].position, 3);
        hash = pl_hash_numbers(hash, bodies[i].orientation, 4);
    }
    return text_metric(pl_hash_hex(hash, text));
}

void pl_reference_metrics(const pl_values *values, const pl_body_state *last,
                          const pl_integrator_votes *votes, pl_metric *item)
{
    const pl_scene *scene = values->scene;
    item[PL_METRIC_REST_POSITION_ERROR] = rest_position_error(scene, last);
    item[PL_METRIC_REST_ROTATION_ERROR] = rest_rotation_error(scene, last);
    item[PL_METRIC_TRAVEL_ERROR] = travel_error(scene, last);
    item[PL_METRIC_VALUE_ERROR] = value_error(values);
    item[PL_METRIC_DISCRETE_ERROR] = discrete_error(values, last, votes);
    item[PL_METRIC_INTEGRATOR] = integrator_metric(votes);
    item[PL_METRIC_STATE_HASH] = state_hash(scene, last);
}
