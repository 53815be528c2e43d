#include "value.h"

#include "discrete_answer.h"
#include "plumb/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Of a step: how much past `until` a frame is still at it. */
static const double SAME_TIME = 1e-6;

/* One expected value, and what has been seen of it. */
typedef struct follower {
    const pl_expect_value *expected;
    pl_vec direction, origin;
    bool done;        /* the frame at `until` has been seen */
    double found;     /* where it stands */
    double sample[3]; /* of an apex: the last three frames' positions */
    int samples;
    double orientation[4]; /* of a turn: at the last frame */
    double last_spin;      /* of a period */
    long crossings;
    double first_crossing, last_crossing; /* s */
} follower;

struct pl_values {
    const pl_scene *scene;
    int count;
    follower *items;
};

pl_values *pl_values_create(const pl_scene *scene)
{
    pl_values *v = calloc(1, sizeof *v);
    follower *items = calloc((size_t)scene->value_count + 1, sizeof *items);
    if (v == NULL || items == NULL) {
        free(v);
        free(items);
        return NULL;
    }
    *v = (pl_values){scene, scene->value_count, items};
    for (int i = 0; i < v->count; ++i) {
        items[i].expected = &scene->values[i];
        items[i].direction = pl_vec_of(scene->values[i].direction);
        items[i].found = scene->values[i].quantity == PL_QUANTITY_APEX ? -HUGE_VAL : 0;
    }
    return v;
}

void pl_values_destroy(pl_values *values)
{
    if (values != NULL) {
        free(values->items);
        free(values);
    }
}

/* The rotation vector from a to b along d. */
static double turn_along(const double a[4], const double b[4], pl_vec d)
{
    pl_vec va = pl_vec_of(a + 1), vb = pl_vec_of(b + 1);
    double w = a[0] * b[0] + pl_vec_dot(va, vb);
    pl_vec v = pl_vec_sub(pl_vec_scale(vb, a[0]), pl_vec_scale(va, b[0]));
    v = pl_vec_sub(v, pl_vec_cross(vb, va));
    double sine = pl_vec_length(v), sign = w < 0 ? -1 : 1;
    return sine > 0 ? 2 * atan2(sine, fabs(w)) / sine * sign * pl_vec_dot(v, d) : 0;
}

/* The highest of the parabola through three samples a step apart, of which the middle one is the
 * highest. */
static double crest(const double y[3])
{
    double bend = y[0] - 2 * y[1] + y[2], slope = 0.5 * (y[2] - y[0]);
    return bend < 0 ? y[1] - 0.5 * slope * slope / bend : y[1];
}

static void see_apex(follower *f, double height)
{
    f->sample[0] = f->sample[1];
    f->sample[1] = f->sample[2];
    f->sample[2] = height;
    f->samples += 1;
    f->found = fmax(f->found, height);
    if (f->samples >= 3 && f->sample[1] >= f->sample[0] && f->sample[1] >= f->sample[2]) {
        f->found = fmax(f->found, crest(f->sample));
    }
}

static void see_spin(follower *f, double time, double dt, double spin)
{
    if (f->samples > 0 && f->last_spin < 0 && spin >= 0) {
        double at = time - dt * spin / (spin - f->last_spin);
        f->first_crossing = f->crossings == 0 ? at : f->first_crossing;
        f->last_crossing = at;
        f->crossings += 1;
    }
    f->last_spin = spin;
    f->samples += 1;
}

/* What the frame shows of what is read at one time. */
static double reading(const follower *f, const pl_body_state *body)
{
    switch (f->expected->quantity) {
    case PL_QUANTITY_VELOCITY:
        return pl_vec_dot(pl_vec_of(body->velocity), f->direction);
    case PL_QUANTITY_SPIN:
        return pl_vec_dot(pl_vec_of(body->angular_velocity), f->direction);
    case PL_QUANTITY_TURN:
        return f->found + turn_along(f->orientation, body->orientation, f->direction);
    default:
        return pl_vec_dot(pl_vec_sub(pl_vec_of(body->position), f->origin), f->direction);
    }
}

static void see(follower *f, long step, double dt, const pl_body_state *body)
{
    double time = (double)step * dt, until = f->expected->until;
    if (step == 0) {
        f->origin = pl_vec_of(body->position);
        for (int k = 0; k < 4; ++k) {
            f->orientation[k] = body->orientation[k];
        }
    }
    bool within = time >= f->expected->from - SAME_TIME * dt && time <= until + SAME_TIME * dt;
    if (f->expected->quantity == PL_QUANTITY_APEX) {
        if (within) {
            see_apex(f, reading(f, body));
        }
        return;
    }
    if (f->expected->quantity == PL_QUANTITY_PERIOD) {
        if (within) {
            pl_axes axes = pl_axes_of(body->orientation);
            pl_vec own = pl_to_local(&axes, pl_vec_of(body->angular_velocity));
            see_spin(f, time, dt, pl_vec_dot(own, f->direction));
        }
        return;
    }
    if (f->done) {
        return;
    }
    double now = reading(f, body);
    f->done = time >= until - SAME_TIME * dt;
    /* A time between frames: the part of the step until then. */
    double part = f->done && step > 0 ? 1 - fmax(0, time - until) / dt : 1;
    f->found += part * (now - f->found);
    for (int k = 0; k < 4; ++k) {
        f->orientation[k] = body->orientation[k];
    }
}

void pl_values_see(pl_values *values, long step, const pl_body_state *bodies)
{
    for (int i = 0; i < values->count; ++i) {
        follower *f = &values->items[i];
        see(f, step, values->scene->dt, &bodies[f->expected->body]);
    }
}

/* Adds the error of one value to the largest so far. */
static void add_error(pl_metric *metric, const follower *f, double expected)
{
    metric->state = PL_METRIC_VALUE;
    metric->value = fmax(metric->value, fabs(f->found - expected) / f->expected->scale);
}

pl_metric pl_values_error(const pl_values *values)
{
    pl_metric metric = {0};
    for (int i = 0; i < values->count; ++i) {
        follower f = values->items[i];
        const pl_expect_value *e = f.expected;
        if (e->quantity == PL_QUANTITY_PERIOD) {
            if (f.crossings < 2) {
                metric = (pl_metric){.state = PL_METRIC_FAILED};
                (void)snprintf(metric.reason, sizeof metric.reason,
                               "no whole period was seen from %g to %g s", e->from, e->until);
                return metric;
            }
            f.found = (f.last_crossing - f.first_crossing) / (double)(f.crossings - 1);
        }
        add_error(&metric, &f, e->value);
    }
    return metric;
}

pl_metric pl_values_discrete_error(const pl_values *values, pl_integrator integrator)
{
    pl_metric metric = {0};
    for (int i = 0; i < values->count; ++i) {
        const follower *f = &values->items[i];
        double answer = pl_discrete_value(values->scene, f->expected, integrator);
        if (isnan(answer) || f->expected->quantity == PL_QUANTITY_PERIOD) {
            return (pl_metric){0};
        }
        add_error(&metric, f, answer);
    }
    return metric;
}
