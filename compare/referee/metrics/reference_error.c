/* Errors against the references of a scene. Those against the discrete answers are of the engine's
 * own integrator (discrete_answer.c), less what rounding of the declared precision explains.
 *
 * Rounding: with c of pl_step_rounding, a step changes a velocity v by up to c (|v| + h |g|), a spin
 * w by c (|w| + h |g| / R), a position x by c |x| and an orientation by c. The changes of all steps
 * add up, and those of velocities also move the body, by h each step. */
#include "expectations.h"

#include "base/hash.h"
#include "referee/geometry/solid.h"

#include <string.h>

/* A frame within this part of a step of `until` is at `until`. */
static const double SAME_TIME = 1e-6;

/* Makes the metric the larger of its value and `error`. */
static void raise_to(pl_metric *metric, double error)
{
    *metric = pl_metric_value(fmax(metric->value, error));
}

/* ---- Rounding ---- */

/* What rounding so far explains of a body's velocity and displacement, or spin and turn. */
typedef struct blur {
    double rate, value;
} blur;

/* ---- Expected values ---- */

/* An expected value and what the frames so far show of it. */
typedef struct reading {
    const pl_expect_value *expected;
    pl_vec direction, origin, centre;     /* at the start: of its frame, and of mass */
    bool done;                            /* the frame at `until` has been seen */
    double found;                         /* the value so far */
    double sample[3];                     /* of an apex: positions in the last three frames */
    int samples;                          /* of an apex or a period: frames seen in the window */
    double orientation[4];                /* of a turn: in the last frame */
    double last_spin;                     /* of a period */
    long crossings;                       /* of a period: changes of the spin from - to + */
    long crests;                          /* of an apex: local maxima so far */
    double first_crossing, last_crossing; /* s */
    blur blur;
} reading;

struct pl_values {
    const pl_scene *scene;
    reading *items; /* (scene->value_count) */
    blur *travels;  /* (scene->travel_count) */
    const pl_integrator_votes *votes;
};

pl_values *pl_values_create(const pl_scene *scene, const pl_integrator_votes *votes,
                            pl_arena *arena)
{
    pl_values *v = pl_arena_take(arena, 1, sizeof *v);
    reading *items = pl_arena_take(arena, (size_t)scene->value_count, sizeof *items);
    blur *travels = pl_arena_take(arena, (size_t)scene->travel_count, sizeof *travels);
    *v = (pl_values){.scene = scene, .items = items, .travels = travels, .votes = votes};
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
    const bool at_crest =
        r->samples >= 3 && r->sample[1] >= r->sample[0] && r->sample[1] > r->sample[2];
    r->crests += at_crest;
    if (r->expected->number == 0) {
        const bool on_top =
            r->samples >= 3 && r->sample[1] >= r->sample[0] && r->sample[1] >= r->sample[2];
        r->found = fmax(fmax(r->found, height), on_top ? crest(r->sample) : height);
    } else if (at_crest && (double)r->crests == r->expected->number) {
        r->found = crest(r->sample);
    }
}

/* The kinetic energy of the body, and its potential energy against that at the start, J. The start is
 * that of the centre of mass. */
static double energy_of(const pl_scene *scene, const reading *r, const pl_body_state *state)
{
    const pl_body *body = &scene->bodies[r->expected->body];
    const pl_axes axes = pl_principal_axes(&body->shape, state->orientation);
    const pl_vec v = pl_vec_of(state->velocity);
    const pl_vec w = pl_to_local(&axes, pl_vec_of(state->angular_velocity));
    const pl_vec risen = pl_vec_sub(pl_state_centre(body, state), r->centre);
    return body->mass * (0.5 * pl_vec_dot(v, v) - pl_vec_dot(pl_vec_of(scene->gravity), risen)) +
           0.5 * (body->inertia[0] * w.x * w.x + body->inertia[1] * w.y * w.y +
                  body->inertia[2] * w.z * w.z);
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
static double value_in(const pl_scene *scene, const reading *r, const pl_body_state *body)
{
    switch (r->expected->quantity) {
    case PL_QUANTITY_TOP_SPEED:
        return fmax(r->found, pl_vec_length(pl_vec_of(body->velocity)));
    case PL_QUANTITY_EXCURSION:
        return fmax(r->found, pl_vec_length(pl_vec_sub(pl_vec_of(body->position), r->origin)));
    case PL_QUANTITY_ENERGY:
        return energy_of(scene, r, body);
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

/* Whether the quantity is read over from .. until, not at `until`. */
static bool is_over_time(pl_quantity quantity)
{
    return quantity == PL_QUANTITY_APEX || quantity == PL_QUANTITY_PERIOD ||
           quantity == PL_QUANTITY_TOP_SPEED || quantity == PL_QUANTITY_EXCURSION;
}

static void see_value(const pl_scene *scene, reading *r, long step, const pl_body_state *body)
{
    const double dt = scene->dt;
    double time = (double)step * dt, until = r->expected->until;
    if (step == 0) {
        r->origin = pl_vec_of(body->position);
        r->centre = pl_state_centre(&scene->bodies[r->expected->body], body);
        memcpy(r->orientation, body->orientation, sizeof r->orientation);
    }
    pl_quantity quantity = r->expected->quantity;
    if (is_over_time(quantity)) {
        if (time < r->expected->from - SAME_TIME * dt || time > until + SAME_TIME * dt) {
            return;
        }
        if (quantity == PL_QUANTITY_APEX) {
            see_apex(r, value_in(scene, r, body));
        } else if (quantity == PL_QUANTITY_PERIOD) {
            see_spin(r, time, dt, body);
        } else {
            r->found = value_in(scene, r, body);
        }
    } else if (!r->done) {
        double now = value_in(scene, r, body);
        r->done = time >= until - SAME_TIME * dt;
        /* If `until` is between two frames, only the part of the step before it counts. */
        double part = r->done && step > 0 ? 1 - fmax(0, time - until) / dt : 1;
        r->found += part * (now - r->found);
        memcpy(r->orientation, body->orientation, sizeof r->orientation);
    }
}

/* Adds what rounding explains of a body's place and velocity in a step, or of its turn and spin. */
static void see_blur(const pl_values *values, blur *b, int body, bool turns,
                     const pl_body_state *state)
{
    const pl_scene *scene = values->scene;
    const double c = pl_step_rounding(&values->votes->engine);
    double fall = scene->dt * pl_vec_length(pl_vec_of(scene->gravity));
    double rate = pl_vec_length(pl_vec_of(state->velocity)), size = 1;
    if (turns) {
        rate = pl_vec_length(pl_vec_of(state->angular_velocity));
        fall /= pl_bounding_radius(&scene->bodies[body].shape);
    } else {
        size = pl_vec_length(pl_vec_of(state->position));
    }
    b->rate += c * (rate + fall);
    b->value += c * size + scene->dt * b->rate;
}

void pl_values_see(pl_values *values, long step, const pl_body_state *bodies)
{
    const pl_scene *scene = values->scene;
    for (int i = 0; i < scene->value_count; ++i) {
        reading *r = &values->items[i];
        const pl_quantity quantity = r->expected->quantity;
        if ((double)step * scene->dt < r->expected->until + scene->dt) {
            see_blur(values, &r->blur, r->expected->body,
                     quantity == PL_QUANTITY_SPIN || quantity == PL_QUANTITY_TURN,
                     &bodies[r->expected->body]);
        }
        see_value(scene, r, step, &bodies[r->expected->body]);
    }
    for (int i = 0; i < scene->travel_count; ++i) {
        const int body = scene->travels[i].body;
        see_blur(values, &values->travels[i], body, false, &bodies[body]);
    }
}

/* The largest error of the values of each right answer; [0]: of the values that all have. Below 0:
 * there are none. */
typedef struct answer_errors {
    double largest[PL_MAX_ANSWERS + 1];
} answer_errors;

static answer_errors no_errors(void)
{
    answer_errors errors;
    for (int i = 0; i <= PL_MAX_ANSWERS; ++i) {
        errors.largest[i] = -1;
    }
    return errors;
}

/* Adds the error of one value, in its unit, to those so far. */
static void add_error(answer_errors *errors, const reading *r, double error)
{
    double *largest = &errors->largest[(int)r->expected->answer];
    *largest = fmax(*largest, error / r->expected->scale);
}

/* Raises the metric to the error from the nearest right answer, and names it. */
static void raise_to_nearest(pl_metric *metric, const answer_errors *errors)
{
    int nearest = 0;
    for (int i = 1; i <= PL_MAX_ANSWERS; ++i) {
        const double error = errors->largest[i];
        nearest = error >= 0 && (nearest == 0 || error < errors->largest[nearest]) ? i : nearest;
    }
    const double error = fmax(errors->largest[0], errors->largest[nearest]);
    if (error >= 0) {
        raise_to(metric, error);
        metric->answer = nearest;
    }
}

/* How far a number is from what is expected, or beyond it if that is a bound; in its unit. */
static double error_of(const pl_expect_value *expected, double found)
{
    const double above = found - expected->value;
    return expected->bound == PL_BOUND_AT_MOST    ? fmax(above, 0)
           : expected->bound == PL_BOUND_AT_LEAST ? fmax(-above, 0)
                                                  : fabs(above);
}

bool pl_values_lack(const pl_values *values, int index)
{
    const reading *r = &values->items[index];
    const pl_expect_value *e = r->expected;
    return e->quantity == PL_QUANTITY_PERIOD
               ? r->crossings < 2 && !(e->until - e->from < 2 * e->value)
               : e->number > 0 && !isfinite(r->found);
}

double pl_values_found(const pl_values *values, int index)
{
    const reading *r = &values->items[index];
    if (pl_values_lack(values, index)) {
        return 0; /* the error is the whole height, or the whole period */
    }
    if (r->expected->quantity != PL_QUANTITY_PERIOD) {
        return r->found;
    }
    return r->crossings < 2 ? (double)NAN
                            : (r->last_crossing - r->first_crossing) / (double)(r->crossings - 1);
}

static pl_metric value_error(const pl_values *values)
{
    pl_metric metric = {0};
    answer_errors errors = no_errors();
    for (int i = 0; i < values->scene->value_count; ++i) {
        const pl_expect_value *e = values->items[i].expected;
        const double found = pl_values_found(values, i);
        if (isnan(found) && e->quantity == PL_QUANTITY_PERIOD) {
            return pl_metric_failed("no whole period was seen from %g to %g s", e->from, e->until);
        }
        add_error(&errors, &values->items[i], error_of(e, found));
    }
    raise_to_nearest(&metric, &errors);
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

double pl_off_travel(const pl_scene *scene, const pl_body_state *bodies,
                     const pl_expect_travel *travel, double distance)
{
    const pl_vec from = pl_vec_of(scene->bodies[travel->body].position);
    const pl_vec to = pl_vec_mad(from, distance, pl_vec_of(travel->direction));
    return pl_vec_length(pl_vec_sub(pl_vec_of(bodies[travel->body].position), to));
}

static pl_metric travel_error(const pl_scene *scene, const pl_body_state *bodies)
{
    pl_metric metric = {0};
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        raise_to(&metric,
                 pl_off_travel(scene, bodies, travel, travel->distance) / fabs(travel->distance));
    }
    return metric;
}

/* Whether the scene has the discrete answers to all that it expects, of semi-implicit Euler. */
static bool has_discrete_answers(const pl_scene *scene)
{
    bool has_all = scene->travel_count + scene->value_count > 0;
    for (int i = 0; i < scene->travel_count; ++i) {
        has_all = has_all && !isnan(scene->travels[i].discrete);
    }
    for (int i = 0; i < scene->value_count; ++i) {
        has_all = has_all && !isnan(scene->values[i].discrete);
    }
    return has_all;
}

static pl_metric no_discrete_answer(const pl_values *values, int body)
{
    const int substeps = pl_substeps_of(&values->votes->engine);
    return pl_metric_failed("no exact answer of the integrator with %d sub-step%s is known for "
                            "body \"%.40s\"",
                            substeps, substeps == 1 ? "" : "s", values->scene->bodies[body].name);
}

/* What is left of an error without rounding. */
static double beyond(double error, double rounding)
{
    return isnan(error) ? error : fmax(error - rounding, 0);
}

/* The largest error of travels and values against the discrete answers of an integrator; failed if
 * one of these is not known. */
static pl_metric discrete_error_of(const pl_values *values, const pl_body_state *bodies,
                                   pl_position_rule rule)
{
    const pl_scene *scene = values->scene;
    pl_metric metric = {0};
    answer_errors errors = no_errors();
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        const double answer = pl_discrete_travel(scene, travel, rule, &values->votes->engine);
        if (isnan(answer)) {
            return no_discrete_answer(values, travel->body);
        }
        const double error = pl_off_travel(scene, bodies, travel, answer);
        raise_to(&metric, beyond(error, values->travels[i].value) / fabs(answer));
    }
    for (int i = 0; i < scene->value_count; ++i) {
        const reading *r = &values->items[i];
        const pl_expect_value *e = r->expected;
        const double answer = pl_discrete_value(scene, e, rule, &values->votes->engine);
        if (isnan(answer)) {
            return no_discrete_answer(values, e->body);
        }
        const bool is_rate = e->quantity == PL_QUANTITY_VELOCITY || e->quantity == PL_QUANTITY_SPIN;
        const double error =
            beyond(fabs(r->found - answer), is_rate ? r->blur.rate : r->blur.value);
        add_error(&errors, r, error);
    }
    raise_to_nearest(&metric, &errors);
    return metric;
}

/* Absent where the scene has no discrete answers. Where the integrator was not detected, an error
 * counts if it is the same by every integrator. */
static pl_metric discrete_error(const pl_values *values, const pl_body_state *bodies)
{
    const pl_integrator_votes *votes = values->votes;
    if (!has_discrete_answers(values->scene)) {
        return (pl_metric){0};
    }
    pl_metric error = discrete_error_of(values, bodies, pl_integrator_of(votes));
    if (error.state != PL_METRIC_VALUE || pl_integrator_certain(votes) == PL_INTEGRATOR_DETECTED) {
        return error;
    }
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        pl_metric other = discrete_error_of(values, bodies, (pl_position_rule)k);
        if (other.state != error.state || other.value != error.value) {
            return pl_metric_failed("the engine's integrator was not detected");
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

void pl_reference_metrics(const pl_values *values, const pl_body_state *last, pl_metric *item)
{
    const pl_scene *scene = values->scene;
    item[PL_METRIC_REST_POSITION_ERROR] = rest_position_error(scene, last);
    item[PL_METRIC_REST_ROTATION_ERROR] = rest_rotation_error(scene, last);
    item[PL_METRIC_TRAVEL_ERROR] = travel_error(scene, last);
    item[PL_METRIC_VALUE_ERROR] = value_error(values);
    item[PL_METRIC_DISCRETE_ERROR] = discrete_error(values, last);
    item[PL_METRIC_INTEGRATOR] = integrator_metric(values->votes);
    item[PL_METRIC_STATE_HASH] = state_hash(scene, last);
}
