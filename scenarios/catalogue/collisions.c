/* Spheres in a row that run into each other: apart, and touching as in Newton's cradle. */
#include "catalogue.h"

#include <math.h>
#include <string.h>

/* Spheres in a row, apart; the first runs into the second, that into the third, and so on.
 *
 * Momentum and Newton's restitution give, for two that meet with v1 > v2,
 *   v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2),
 *   v2' = ((m2 - e m1) v2 + (1 + e) m1 v1) / (m1 + m2).
 * Which two meet next is found here from the motion between impacts, to the end of the run, so that
 * the masses, and how often a sphere is caught up with, may be any. The impacts are central: no
 * sphere gets a velocity across the row, or a spin. */

enum {
    COLLISION_TRAIN_COUNT,
    COLLISION_TRAIN_RATIO,
    COLLISION_TRAIN_RESTITUTION,
    COLLISION_TRAIN_SPEED
};
enum { MOST_APART = 10, MOST_TOUCHING = 50, MOST = 2 * MOST_TOUCHING, MOST_IMPACTS = 10000 };

static const double collision_train_radius = 0.1, collision_train_gap = 0.5; /* m */

static const pl_param collision_train_params[] = {
    {"n", 4, 2, MOST_APART, true, "1", "spheres"},
    {"ratio", 2, 1e-3, 1e3, false, "1",
     "of each sphere's mass to the one before; the first has 1 kg"},
    PL_PARAM_RESTITUTION(0.8),
    {"speed", 3, 0.1, 100, false, "m/s",
     "of the first sphere; the others are at rest, 0.5 m apart"},
    PL_PARAM_TIME(2),
};

typedef struct train {
    int count;
    double mass[MOST], place[MOST], speed[MOST]; /* place: without the radii, m */
} train;

static train train_of(const double *values)
{
    train t = {.count = (int)values[COLLISION_TRAIN_COUNT]};
    for (int i = 0; i < t.count; ++i) {
        t.mass[i] = i == 0 ? 1 : t.mass[i - 1] * values[COLLISION_TRAIN_RATIO];
        t.place[i] = collision_train_gap * i;
    }
    t.speed[0] = values[COLLISION_TRAIN_SPEED];
    return t;
}

/* The time until sphere i meets the next; INFINITY: never. */
static double time_to_meet(const train *t, int i)
{
    const double approach = t->speed[i] - t->speed[i + 1];
    return approach > 0 ? fmax(0, t->place[i + 1] - t->place[i]) / approach : (double)INFINITY;
}

static void collide(train *t, int i, double e)
{
    const double m1 = t->mass[i], m2 = t->mass[i + 1], v1 = t->speed[i], v2 = t->speed[i + 1];
    t->speed[i] = ((m1 - e * m2) * v1 + (1 + e) * m2 * v2) / (m1 + m2);
    t->speed[i + 1] = e == 0 ? t->speed[i] : ((m2 - e * m1) * v2 + (1 + e) * m1 * v1) / (m1 + m2);
}

/* False: the impacts crowd without end. */
static bool run_until(train *t, double time, double e)
{
    for (int impacts = 0; impacts < MOST_IMPACTS; ++impacts) {
        int next = 0;
        for (int i = 1; i < t->count - 1; ++i) {
            next = time_to_meet(t, i) < time_to_meet(t, next) ? i : next;
        }
        const double wait = fmin(time, time_to_meet(t, next));
        for (int i = 0; i < t->count; ++i) {
            t->place[i] += wait * t->speed[i];
        }
        time -= wait;
        if (time <= 0) {
            return true;
        }
        collide(t, next, e);
    }
    return false;
}

static void collision_train_build(pl_builder *b, const double *values)
{
    b->scene->gravity[2] = 0;
    train t = train_of(values);
    for (int i = 0; i < t.count; ++i) {
        pl_body ball = pl_body_at(pl_shape_sphere(collision_train_radius),
                                  t.place[i] + 2 * collision_train_radius * i, 0, 0);
        ball.mass = t.mass[i];
        ball.velocity[0] = t.speed[i];
        pl_build_body(b, &ball, "ball %d", i + 1);
    }
    if (!run_until(&t, b->end, values[COLLISION_TRAIN_RESTITUTION])) {
        pl_build_refuse(b,
                        "expected fewer than %d impacts within the run, found more "
                        "at restitution %g and ratio %g",
                        MOST_IMPACTS, values[COLLISION_TRAIN_RESTITUTION],
                        values[COLLISION_TRAIN_RATIO]);
        return;
    }
    for (int i = 0; i < t.count; ++i) {
        pl_build_at_end(b, i, PL_QUANTITY_VELOCITY, pl_axis_x, pl_exactly(t.speed[i]),
                        values[COLLISION_TRAIN_SPEED]);
    }
    for (int i = 0; i < t.count; ++i) {
        pl_build_none(b, i, PL_QUANTITY_VELOCITY, PL_ALONG_Y | PL_ALONG_Z,
                      values[COLLISION_TRAIN_SPEED]);
        pl_build_none(b, i, PL_QUANTITY_SPIN, PL_ALONG_ALL,
                      values[COLLISION_TRAIN_SPEED] / collision_train_radius);
    }
}

const pl_scenario pl_scenario_collision_train = {
    .name = "collision-train",
    .title = "Row of collisions",
    .description = "Spheres in a row, apart, of masses in any ratio, hand a push on from one to "
                   "the next: whether every impact keeps momentum and gives the restitution.",
    .reference = "at each impact v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2), and the same "
                 "with 1 and 2 changed",
    .expected =
        "ok: velocities at the end are those handed on from impact to impact; momentum stays",
    .source = "Newton 1687, Principia, scholium to the laws; from impact to impact",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "no impact falls within a step of the end, and no two of one sphere in one step",
    PL_PARAMS(collision_train_params),
    .build = collision_train_build};

/* Newton's cradle without strings: spheres that touch, in a row, and others that run into them.
 *
 * Without gravity the row is at rest, all of one mass; `moving` spheres come from the left at the
 * speed v. Momentum and, at restitution 1, energy are conserved; the two laws in use both keep
 * them. If the contacts act one after the other, as if the spheres had infinitely small gaps, as
 * many spheres leave on the right as arrived. If all contacts act at once, each with Newton's
 * restitution e (Moreau's law), the m that arrive and the n at rest act as two bodies, of which
 * each stays together: they leave with v (m - e n) / (m + n) and v (1 + e) m / (m + n), so that one
 * that meets two leaves them with v (-1/3, 2/3, 2/3). The velocities at the end are compared with
 * both laws, and the nearer one counts. Below restitution 1 the first law is that of equal gaps, as
 * they become small, where a finite number of impacts ends. With a gap between the spheres that are at
 * rest, and between those that arrive, no two contacts act at once: the first law alone is right, by
 * the impacts of the run. */

enum { CRADLE_COUNT, CRADLE_MOVING, CRADLE_RESTITUTION, CRADLE_SPEED, CRADLE_GAP };

static const double cradle_radius = 0.1, cradle_gap = 0.25; /* m */

static const pl_param cradle_params[] = {
    {"n", 2, 1, MOST_TOUCHING, true, "1", "spheres at rest"},
    {"moving", 1, 1, MOST_TOUCHING, true, "1", "spheres that run into them"},
    PL_PARAM_RESTITUTION(1),
    {"speed", 1, 0.1, 100, false, "m/s", "of the moving spheres"},
    {"gap", 0, 0, 1, false, "m",
     "between two neighbours at rest, and between two that move: above 0 only impacts in sequence "
     "are "
     "right; 0: they touch"},
    PL_PARAM_TIME(1),
};

static void expect_speed(pl_builder *b, int ball, double speed, double scale, int answer)
{
    pl_expect_value value = pl_expect_value_default(b->scene);
    value.body = ball;
    value.quantity = PL_QUANTITY_VELOCITY;
    memcpy(value.direction, pl_axis_x, sizeof value.direction);
    value.value = value.discrete = speed;
    value.scale = scale;
    value.answer = answer;
    pl_build_value(b, &value);
}

enum { IN_SEQUENCE = 1, AT_ONCE };

/* The velocities after impacts one after the other. Spheres that touch have a gap that does not
 * matter, and all impacts end at once; the others have those that fit into the run. */
static bool sequence_of(const pl_builder *b, const double *values, train *t)
{
    const double arriving = values[CRADLE_MOVING], gap = values[CRADLE_GAP];
    *t = (train){.count = (int)(arriving + values[CRADLE_COUNT])};
    for (int i = 0; i < t->count; ++i) {
        t->mass[i] = 1;
        t->place[i] = (gap > 0 ? gap : 1) * i - (i < arriving && gap > 0 ? cradle_gap : 0);
        t->speed[i] = i < arriving ? values[CRADLE_SPEED] : 0;
    }
    return run_until(t, gap > 0 ? b->end : 1e9, values[CRADLE_RESTITUTION]);
}

static void expect_in_sequence(pl_builder *b, const double *values, int answer)
{
    train t;
    const bool ends = sequence_of(b, values, &t);
    if (!ends && answer == 0) {
        pl_build_refuse(b, "expected fewer than %d impacts within the run, found more",
                        MOST_IMPACTS);
    }
    for (int i = 0; i < t.count && ends; ++i) {
        expect_speed(b, i, t.speed[i], values[CRADLE_SPEED], answer);
    }
}

static void expect_at_once(pl_builder *b, const double *values)
{
    const double speed = values[CRADLE_SPEED], e = values[CRADLE_RESTITUTION];
    const double arriving = values[CRADLE_MOVING], resting = values[CRADLE_COUNT];
    for (int i = 0; i < (int)(arriving + resting); ++i) {
        const double part = i < arriving ? arriving - e * resting : (1 + e) * arriving;
        expect_speed(b, i, speed * part / (arriving + resting), speed, AT_ONCE);
    }
}

static void cradle_expect(pl_builder *b, const double *values)
{
    const double speed = values[CRADLE_SPEED];
    const int count = (int)(values[CRADLE_MOVING] + values[CRADLE_COUNT]);
    if (values[CRADLE_GAP] > 0) {
        expect_in_sequence(b, values, 0);
    } else if (speed * b->end > cradle_gap) {
        expect_in_sequence(b, values, IN_SEQUENCE);
        expect_at_once(b, values);
    } else {
        for (int i = 0; i < count; ++i) {
            expect_speed(b, i, b->scene->bodies[i].velocity[0], speed, 0);
        }
    }
    for (int i = 0; i < count; ++i) {
        pl_build_none(b, i, PL_QUANTITY_VELOCITY, PL_ALONG_Y | PL_ALONG_Z, speed);
        pl_build_none(b, i, PL_QUANTITY_SPIN, PL_ALONG_ALL, speed / cradle_radius);
    }
}

static void cradle_build(pl_builder *b, const double *values)
{
    b->scene->gravity[2] = 0;
    const int moving = (int)values[CRADLE_MOVING], count = moving + (int)values[CRADLE_COUNT];
    for (int i = 0; i < count; ++i) {
        pl_body ball = pl_body_at(pl_shape_sphere(cradle_radius),
                                  (2 * cradle_radius + values[CRADLE_GAP]) * (i - moving) -
                                      (i < moving ? cradle_gap : 0),
                                  0, 0);
        ball.velocity[0] = i < moving ? values[CRADLE_SPEED] : 0;
        pl_build_body(b, &ball, "ball %d", i + 1);
    }
    cradle_expect(b, values);
}

const pl_scenario pl_scenario_cradle = {
    .name = "cradle",
    .title = "Newton's cradle by contacts alone",
    .description = "Spheres run into a row of spheres that touch each other: which of the laws of "
                   "simultaneous impact the engine has, and whether it keeps momentum and energy.",
    .reference = "1 on 2 leave with v (0, 0, 1) in sequence, v (-1/3, 2/3, 2/3) all at once "
                 "(answers 1 and 2); both "
                 "keep momentum (momentum_error 0), at restitution 1 also energy (energy_lost 0 J)",
    .expected = "ok: the velocities at the end are those of one of the two laws of simultaneous "
                "impact",
    .source = "conservation laws; simultaneous Newton impacts: Moreau 1988, Unilateral contact and "
              "dry friction in finite freedom dynamics",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "no impact falls within a step of the end",
    .provokes = "an impact that passes through resting contacts: sequential solvers stop half way "
                "and lose energy, or gain it; a right engine keeps momentum and energy, by "
                "either law",
    PL_PARAMS(cradle_params),
    .build = cradle_build};
