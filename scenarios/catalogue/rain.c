/* Balls that fall on a floor and on each other, with restitution: followed from impact to impact.
 *
 * In flight all balls have the same acceleration, so that two of them meet as if there were none, and
 * one meets the floor as in `bounce`. In an impact, with n from b to a, u the velocity of a against b
 * where they touch and M = 1 / (1 / m_a + 1 / m_b), the normal impulse is -(1 + e) M u_n, and friction
 * stops the slip u_t, which takes 2/7 M |u_t| of solid spheres, or reaches its bound, friction times
 * the normal impulse; the floor is a body without 1 / m. All impulses of an impact have the same
 * direction of slip, so this is exact (Routh 1905), and so is what it takes of the energy.
 *
 * Errors grow. Over a flight, a place is off by the error of the velocity times the time. In an
 * impact of bodies whose places are off by d, its instant is off by d / |u_n|, which moves them by up
 * to (1 + e) d afterwards, and n turns by d over the distance of the centres R, which changes
 * velocities by up to (1 + e) |u| d / R. Each ball keeps such a bound for an error of 1 at the start,
 * and the motion is followed until one of them passes 1e12, when rounding, 1e-16 m, is below 1e-4 m
 * (two starts 1e-12 m apart are then 1e-9 m apart); or until a ball has two impacts within 1e-5 s,
 * since where three meet at once there is no law for what follows. There the place of each ball is
 * expected; and if the run has ended by then, so is the energy that was lost. */
#include "catalogue.h"

#include <math.h>
#include <string.h>

enum { RAIN_COUNT, RAIN_COLUMNS, RAIN_HEIGHT, RAIN_RESTITUTION, RAIN_FRICTION };
enum { MOST_BALLS = 500 };

static const double least_radius = 0.08, most_radius = 0.12, cell = 0.5; /* m */
static const double sideways = 0.5;                                      /* m/s, at most */
static const double apart = 1e-5; /* s, between two impacts of one ball */
static const double most_growth = 1e12;

static const pl_param rain_params[] = {
    {"n", 100, 1, MOST_BALLS, true, "1", "number of balls"},
    {"columns", 6, 1, 100, true, "1", "cells of a layer in x and in y, each of 0.5 m"},
    {"height", 1, 0.1, 100, false, "m", "of the lowest cells above the floor"},
    PL_PARAM_RESTITUTION(0.7),
    {"friction", 0.3, 0, 10, false, "1", "Coulomb coefficient of all contacts"},
    PL_PARAM_TIME(0.8),
};

/* ---- Flight ---- */

enum { NONE = -2, FLOOR = -1 };

/* A ball at the time `when` of its last impact, and the next one. */
typedef struct flier {
    double when, mass, radius;
    double x[3], v[3], w[3];
    double next;   /* s: the time of its next impact; INFINITY: none */
    int partner;   /* FLOOR, NONE or another ball */
    double off[2]; /* bounds of the errors of x, m, and of v, m/s, for 1 m at the start */
} flier;

typedef struct shower {
    flier ball[MOST_BALLS];
    int count;
    double g, restitution, friction;
    double lost; /* J */
} shower;

/* The place and the velocity of a ball in flight. */
static void place_of(const flier *f, double time, double g, double x[3], double v[3])
{
    const double t = time - f->when;
    for (int k = 0; k < 3; ++k) {
        x[k] = f->x[k] + f->v[k] * t;
        v[k] = f->v[k];
    }
    x[2] -= g * t * t / 2;
    v[2] -= g * t;
}

static void go_to(flier *f, double time, double g)
{
    double x[3], v[3];
    place_of(f, time, g, x, v);
    memcpy(f->x, x, sizeof x);
    memcpy(f->v, v, sizeof v);
    f->off[0] += f->off[1] * (time - f->when);
    f->when = time;
}

/* The time at which the ball, which is where it was at `when`, meets the floor. */
static double time_to_floor(const flier *f, double g)
{
    const double gap = fmax(0, f->x[2] - f->radius), v = f->v[2];
    return f->when + (v + sqrt(v * v + 2 * g * gap)) / g;
}

/* The time from `now` on at which two balls meet; INFINITY: never. */
static double time_to_ball(const flier *a, const flier *b, double now, double g)
{
    double x[2][3], v[2][3], gap = -(a->radius + b->radius) * (a->radius + b->radius);
    double along = 0, square = 0;
    place_of(a, now, g, x[0], v[0]);
    place_of(b, now, g, x[1], v[1]);
    for (int k = 0; k < 3; ++k) {
        const double d = x[0][k] - x[1][k], u = v[0][k] - v[1][k];
        gap += d * d;
        along += d * u;
        square += u * u;
    }
    const double root = along * along - square * gap;
    if (along >= 0 || root < 0) {
        return (double)INFINITY;
    }
    return now + fmax(0, gap) / (sqrt(root) - along);
}

/* Finds the next impact of ball i, at `now` or later, and tells those that are earlier with it. */
static void look_ahead(shower *s, int i, double now)
{
    flier *f = &s->ball[i];
    const double floor = time_to_floor(f, s->g);
    if (floor < f->next) {
        f->next = floor;
        f->partner = FLOOR;
    }
    for (int j = 0; j < s->count; ++j) {
        const double time = j != i ? time_to_ball(f, &s->ball[j], now, s->g) : (double)INFINITY;
        if (time < f->next) {
            f->next = time;
            f->partner = j;
        }
        if (time < s->ball[j].next) {
            s->ball[j].next = time;
            s->ball[j].partner = i;
        }
    }
}

/* ---- Impact ---- */

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; ++k) {
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double kinetic(const flier *f)
{
    const double inertia = 0.4 * f->mass * f->radius * f->radius;
    return (f->mass * dot(f->v, f->v) + inertia * dot(f->w, f->w)) / 2;
}

/* Adds the velocity of the ball's point that faces along -side * n, times side, to u. */
static void add_rim(const flier *f, const double n[3], double side, double u[3])
{
    double turn[3];
    cross(f->w, n, turn);
    for (int k = 0; k < 3; ++k) {
        u[k] += side * f->v[k] - f->radius * turn[k];
    }
}

/* The impulse p on the ball, or its opposite for side -1, at that point. */
static void push(flier *f, const double n[3], double side, const double p[3])
{
    double turn[3];
    cross(n, p, turn);
    for (int k = 0; k < 3; ++k) {
        f->v[k] += side * p[k] / f->mass;
        f->w[k] -= turn[k] / (0.4 * f->mass * f->radius);
    }
}

/* What an impact makes of errors: `speed` is the change of velocity, at most, and `shift` by how much
 * an error of the places, over that of the instant, moves them afterwards. */
static void grow(flier *a, flier *b, double speed, double shift)
{
    double off[2] = {a->off[0], a->off[1]};
    if (b != NULL) {
        off[0] += b->off[0];
        off[1] += b->off[1] + speed * off[0] / (a->radius + b->radius);
        b->off[0] = (1 + shift) * off[0];
        b->off[1] = off[1];
    }
    a->off[0] = (1 + shift) * off[0];
    a->off[1] = off[1];
}

/* The impact of ball a on ball b, or on the floor where b is NULL; n from b to a. */
static void strike(shower *s, flier *a, flier *b, const double n[3])
{
    const double before = kinetic(a) + (b != NULL ? kinetic(b) : 0);
    const double mass = 1 / (1 / a->mass + (b != NULL ? 1 / b->mass : 0));
    double u[3] = {0, 0, 0}, p[3];
    add_rim(a, n, 1, u);
    if (b != NULL) {
        add_rim(b, n, -1, u);
    }
    const double into = -dot(u, n), normal = (1 + s->restitution) * mass * into;
    grow(a, b, (1 + s->restitution) * sqrt(dot(u, u)), 1 + s->restitution);
    double slip = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] += into * n[k];
        slip += u[k] * u[k];
    }
    slip = sqrt(slip);
    const double stop = 2.0 / 7 * mass, most = s->friction * normal;
    const double rub = stop * slip <= most ? stop : most / slip;
    for (int k = 0; k < 3; ++k) {
        p[k] = normal * n[k] - rub * u[k];
    }
    push(a, n, 1, p);
    if (b != NULL) {
        push(b, n, -1, p);
    }
    s->lost += before - kinetic(a) - (b != NULL ? kinetic(b) : 0);
}

/* The next impact, of ball i. False: it is not followed. */
static bool impact(shower *s, int i)
{
    flier *a = &s->ball[i], *b = a->partner == FLOOR ? NULL : &s->ball[a->partner];
    const double now = a->next;
    double n[3] = {0, 0, 1};
    if (now < a->when + apart || (b != NULL && now < b->when + apart)) {
        return false;
    }
    go_to(a, now, s->g);
    if (b != NULL) {
        go_to(b, now, s->g);
        for (int k = 0; k < 3; ++k) {
            n[k] = (a->x[k] - b->x[k]) / (a->radius + b->radius);
        }
    } else {
        a->x[2] = a->radius;
    }
    if (a->off[0] > most_growth || (b != NULL && b->off[0] > most_growth)) {
        return false;
    }
    strike(s, a, b, n);
    return true;
}

/* After the impact of ball i with `partner` at `now`: what they, and all that would have met them,
 * meet next. */
static void look_again(shower *s, int i, int partner, double now)
{
    bool open[MOST_BALLS] = {false};
    for (int j = 0; j < s->count; ++j) {
        flier *f = &s->ball[j];
        open[j] = j == i || j == partner || f->partner == NONE || f->partner == i ||
                  (partner >= 0 && f->partner == partner);
        f->next = open[j] ? (double)INFINITY : f->next;
    }
    for (int j = 0; j < s->count; ++j) {
        if (open[j]) {
            look_ahead(s, j, now);
        }
    }
}

/* Follows the balls until `end`, or as far as they can be, and returns until when. */
static double follow(shower *s, double end)
{
    for (int i = 0; i < s->count; ++i) {
        s->ball[i].partner = NONE;
    }
    look_again(s, NONE, NONE, 0);
    for (;;) {
        int first = 0;
        for (int i = 1; i < s->count; ++i) {
            first = s->ball[i].next < s->ball[first].next ? i : first;
        }
        const double now = s->ball[first].next;
        const int partner = s->ball[first].partner;
        if (now >= end) {
            return end;
        }
        if (!impact(s, first)) {
            return now;
        }
        look_again(s, first, partner, now);
    }
}

/* ---- Scene ---- */

static double energy_of(const shower *s)
{
    double sum = 0;
    for (int i = 0; i < s->count; ++i) {
        const flier *f = &s->ball[i];
        sum += kinetic(f) + f->mass * s->g * (f->x[2] - f->radius);
    }
    return sum;
}

/* Draws ball i, anywhere in its cell. */
static flier draw_ball(pl_builder *b, const double *values, int i)
{
    const int columns = (int)values[RAIN_COLUMNS];
    const int at[3] = {i % columns, i / columns % columns, i / columns / columns};
    flier f = {.radius = pl_draw_uniform(&b->random, least_radius, most_radius), .off = {1, 0}};
    f.mass = f.radius * f.radius * f.radius / (most_radius * most_radius * most_radius);
    for (int k = 0; k < 3; ++k) {
        const double room = cell / 2 - f.radius;
        f.x[k] = (at[k] + 0.5) * cell + pl_draw_uniform(&b->random, -room, room);
    }
    f.x[2] += values[RAIN_HEIGHT];
    f.v[0] = pl_draw_uniform(&b->random, -sideways, sideways);
    f.v[1] = pl_draw_uniform(&b->random, -sideways, sideways);
    return f;
}

static void expect_places(pl_builder *b, const shower *s, double time, double height)
{
    pl_expect_value value = pl_expect_value_default(b->scene);
    value.until = time;
    value.scale = height;
    value.discrete = (double)NAN;
    for (int i = 0; i < s->count; ++i) {
        double x[3], v[3];
        place_of(&s->ball[i], time, s->g, x, v);
        value.body = i + 1;
        for (int k = 0; k < 3 && b->status == PL_OK; ++k) {
            const double *const axis[] = {pl_axis_x, pl_axis_y, pl_axis_z};
            memcpy(value.direction, axis[k], sizeof value.direction);
            value.value = x[k] - b->scene->bodies[i + 1].position[k];
            pl_build_value(b, &value);
        }
    }
}

static void rain_build(pl_builder *b, const double *values)
{
    shower start = {.count = (int)values[RAIN_COUNT],
                    .g = b->gravity,
                    .restitution = values[RAIN_RESTITUTION],
                    .friction = values[RAIN_FRICTION]};
    pl_build_floor(b);
    for (int i = 0; i < start.count; ++i) {
        flier *f = &start.ball[i];
        *f = draw_ball(b, values, i);
        pl_body ball = pl_body_at(pl_shape_sphere(f->radius), f->x[0], f->x[1], f->x[2]);
        ball.mass = f->mass;
        memcpy(ball.velocity, f->v, sizeof ball.velocity);
        pl_build_body(b, &ball, "ball %d", i + 1);
    }
    shower end = start;
    const double until = follow(&end, b->end);
    const double frame = until < b->end ? floor(until / b->scene->dt) * b->scene->dt : b->end;
    if (until == b->end && start.count > 1) { /* of one body, energy_lost has no value */
        pl_build_statistic(b, PL_STATISTIC_ENERGY_LOST, end.lost, energy_of(&start));
    }
    if (until < b->end) {
        end = start;
        (void)follow(&end, frame);
    }
    if (frame > 0) {
        expect_places(b, &end, frame, values[RAIN_HEIGHT]);
    }
}

const pl_scenario pl_scenario_rain = {
    .name = "rain",
    .title = "Rain of balls",
    .description = "Balls of random sizes fall on the floor and on each other, and bounce: many "
                   "impacts at their own times, each of which takes the energy that restitution "
                   "and friction take, and no more.",
    .reference =
        "from impact to impact: normal impulse (1 + e) M u_n, friction 2/7 M u_t or at its "
        "bound; places (value_error) and energy lost (statistics_error) up to where three "
        "balls meet or errors have grown too far",
    .expected = "ok: the balls bounce up again by e^2 of their height, or aside off each other",
    .source =
        "Newton's restitution and Coulomb's cone in the impulse on solid spheres, as in Routh "
        "1905, The Elementary Part of a Treatise on the Dynamics of a System of Rigid Bodies",
    PL_CHAOTIC_JUDGED,
    .validity =
        "up to the first ball that meets two others within 1e-5 s, or that is the eighth in "
        "a chain of impacts between balls; after that overlap, energy and momentum alone are "
        "judged",
    PL_PARAMS(rain_params),
    .build = rain_build};
