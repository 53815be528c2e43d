/* Impacts of spheres on the floor: straight and with restitution, alone and side by side, and oblique
 * with spin. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>
#include <stdio.h>

/* A sphere falls on a level floor and bounces.
 *
 * From the height H (of its lowest point) it reaches e^(2 k) H after k bounces, by v' = -e v at
 * each. It first meets the floor at T = sqrt(2 H / g), and the apex after the k-th bounce comes at
 * T (1 + 2 e + ... + 2 e^(k - 1) + e^k); for e < 1 the bounces end at T (1 + e) / (1 - e). Each of
 * the first `bounces` apexes is looked for in the middle half of its own flight, so that an engine
 * that is late still shows it, and its error is relative to its own height. If the run shows no
 * apex, or without restitution there is none, the height at its end is expected, relative to H. It
 * bounces in its place and does not spin: its displacement to the sides is relative to H too. */

enum { BOUNCE_HEIGHT, BOUNCE_RESTITUTION, BOUNCE_BOUNCES };

static const double bounce_radius = 0.1; /* m */

static const pl_param bounce_params[] = {
    {"height", 1, 0.01, 100, false, "m", "of the lowest point above the floor"},
    PL_PARAM_RESTITUTION(0.8),
    {"bounces", 3, 1, 50, true, "1", "how many of them are judged"},
    PL_PARAM_TIME(3),
};

/* Expects the apexes of the flights of which the run has at least three quarters. */
static void expect_apexes(pl_builder *b, int ball, double height, double e, int bounces)
{
    const pl_scene *scene = b->scene;
    const double fall = sqrt(2 * height / b->gravity);
    double start = fall, part = e; /* of the flight after bounce k; e^k */
    pl_expect_value apex = pl_expect_value_default(scene);
    const double end = apex.until;
    apex.body = ball;
    apex.quantity = PL_QUANTITY_APEX;
    for (int k = 0; k < bounces; ++k) {
        const double flight = 2 * part * fall;
        apex.from = start + flight / 4;
        apex.until = start + flight * 3 / 4;
        apex.value = height * (part * part - 1);
        apex.scale = height * part * part;
        if (flight < 8 * scene->dt || apex.until > end) {
            return;
        }
        pl_build_value(b, &apex);
        start += flight;
        part *= e;
    }
}

/* Height of the lowest point, from flight to flight. A body that bounces by less than rounding lies
 * still. */
static double height_at(double time, double height, double e, double g)
{
    double start = sqrt(2 * height / g), speed = g * start * e;
    if (time <= start) {
        return height - g * time * time / 2;
    }
    while (speed > 1e-9 && start + 2 * speed / g < time) {
        start += 2 * speed / g;
        speed *= e;
    }
    const double passed = time - start;
    return speed > 1e-9 ? speed * passed - g * passed * passed / 2 : 0;
}

/* Drops a ball at x from a height, and expects its apexes, or else its height at the end. */
static void build_bouncing(pl_builder *b, const char *name, double radius, double x, double height,
                           double e, int bounces)
{
    pl_body ball = pl_body_at(pl_shape_sphere(radius), x, 0, radius + height);
    const int index = pl_build_body(b, &ball, "%s", name), values = b->scene->value_count;
    expect_apexes(b, index, height, e, bounces);
    if (b->scene->value_count == values) {
        const double end = b->end;
        const double left = height_at(end, height, e, b->gravity);
        pl_build_at_end(b, index, PL_QUANTITY_POSITION, pl_axis_z, pl_continuous(left - height),
                        height);
    }
    pl_build_none(b, index, PL_QUANTITY_POSITION, PL_ALONG_X | PL_ALONG_Y, height);
    pl_build_none(b, index, PL_QUANTITY_SPIN, PL_ALONG_ALL, 1);
}

static void bounce_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    build_bouncing(b, "ball", bounce_radius, 0, values[BOUNCE_HEIGHT], values[BOUNCE_RESTITUTION],
                   (int)values[BOUNCE_BOUNCES]);
}

const pl_scenario pl_scenario_bounce = {
    .name = "bounce",
    .title = "Bouncing ball",
    .description = "A sphere falls on the floor and bounces, with any restitution from 0 to 1: "
                   "whether it comes back as high as it should, time after time.",
    .reference = "apex e^(2 k) H after k bounces; at rest after sqrt(2 H / g) (1 + e) / (1 - e)",
    .expected = "ok: each apex at e^2 of the one before",
    .source = "Newton 1687, Principia, scholium to the laws: v' = -e v; conservation of energy in "
              "flight",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity =
        "apexes of flights of 8 steps or more within the run; without one, the height at the end",
    PL_PARAMS(bounce_params),
    .build = bounce_build};

/* Spheres side by side fall on a level floor and bounce, each as if it were alone.
 *
 * The centres lie in a row along x, two radii and `gap` apart; ball i = 0 .. n - 1 falls from
 * height + i stagger. All move vertically. Where two touch, they do so at one height, so that their
 * contact is level, and neither of them moves along its normal: it carries nothing, whatever its
 * restitution and friction, and each ball bounces as in `bounce`. Without stagger all meet the floor
 * at one instant. With it each has an impact of its own, next to others that fly. The radius is a
 * power of 2, so that spheres without a gap touch in floating point too. */

enum {
    BOUNCE_ROW_HEIGHT,
    BOUNCE_ROW_RESTITUTION,
    BOUNCE_ROW_BOUNCES,
    BOUNCE_ROW_COUNT,
    BOUNCE_ROW_GAP,
    BOUNCE_ROW_STAGGER,
    BOUNCE_ROW_FRICTION
};

static const double bounce_row_radius = 0.125; /* m */

static const pl_param bounce_row_params[] = {
    {"height", 1, 0.01, 100, false, "m", "of the first ball's lowest point above the floor"},
    PL_PARAM_RESTITUTION(0.8),
    {"bounces", 3, 1, 50, true, "1", "how many of them are judged"},
    {"n", 5, 1, 50, true, "1", "number of balls"},
    {"gap", 0, 0, 10, false, "m", "between two neighbours; 0: they touch"},
    {"stagger", 0, 0, 10, false, "m", "how much higher each ball starts than the one before"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(3),
};

static void bounce_row_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    for (int i = 0; i < (int)values[BOUNCE_ROW_COUNT]; ++i) {
        char name[PL_NAME_SIZE];
        snprintf(name, sizeof name, "ball %d", i + 1);
        build_bouncing(b, name, bounce_row_radius,
                       i * (2 * bounce_row_radius + values[BOUNCE_ROW_GAP]),
                       values[BOUNCE_ROW_HEIGHT] + i * values[BOUNCE_ROW_STAGGER],
                       values[BOUNCE_ROW_RESTITUTION], (int)values[BOUNCE_ROW_BOUNCES]);
    }
}

const pl_scenario pl_scenario_bounce_row = {
    .name = "bounce-row",
    .title = "Balls that bounce side by side",
    .description = "Spheres in a row, touching or apart, fall on the floor and bounce: whether "
                   "bodies that share no load leave each other's impacts alone.",
    .reference = "as for a single ball, for each: apex e^(2 k) H after k bounces",
    .expected = "ok: every ball bounces in its place, as high as a single one",
    .source = "Newton 1687, Principia, scholium to the laws: v' = -e v; the contact between two "
              "balls is level, and nothing moves along it",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity =
        "apexes of flights of 8 steps or more within the run; without one, the height at the end",
    .provokes = "independent impacts in one group of bodies: a solver that ends the group's step "
                "early, or drops restitution where many contacts act, takes from each ball's "
                "bounce; a right engine lets all bounce as one",
    PL_PARAMS(bounce_row_params),
    .build = bounce_row_build};

/* A spinning sphere strikes a floor obliquely, without gravity.
 *
 * With v along the floor (x), n the speed into it, w the spin about y, s = v - r w the slip of the
 * lowest point and I = 2/5 m r^2: the normal impulse is m (1 + e) n, and the friction J along x
 * changes v by J / m, r w by -5/2 J / m and so s by 7/2 J / m. It stops the slip, J = -2/7 m s, iff
 * that is within the cone, |s| <= 7/2 mu (1 + e) n:
 *   sticks:  v' = r w' = (5 v + 2 r w) / 7
 *   slides:  v' = v - sign(s) mu (1 + e) n,  r w' = r w + 5/2 sign(s) mu (1 + e) n
 * and e n is the speed away from the floor. Errors are relative to the speed of the impact. Nothing
 * acts across the plane of the path: no velocity along y, no spin about x and z. */

enum {
    OBLIQUE_IMPACT_SPEED,
    OBLIQUE_IMPACT_ANGLE,
    OBLIQUE_IMPACT_SPIN,
    OBLIQUE_IMPACT_FRICTION,
    OBLIQUE_IMPACT_RESTITUTION
};

static const double oblique_impact_radius = 0.1; /* m */
static const double gap = 0.5;                   /* m, to the floor at the start */

static const pl_param oblique_impact_params[] = {
    {"speed", 5, 0.1, 1000, false, "m/s", "of the sphere"},
    {"angle", 0.8, 0, 1.4, false, "rad", "of its path from the floor's normal"},
    {"spin", 20, -1000, 1000, false, "rad/s", "positive as in rolling on; the radius is 0.1 m"},
    {"friction", 0.1, 0, 10, false, "1", "Coulomb coefficient"},
    PL_PARAM_RESTITUTION(0.8),
    PL_PARAM_TIME(0.5),
};

typedef struct motion {
    double along, up, rim; /* m/s: v, speed from the floor, r w */
} motion;

static motion reflect(motion before, double friction, double e)
{
    const double slip = before.along - before.rim, into = -before.up;
    const double most = friction * (1 + e) * into;
    motion after = {.up = e * into};
    if (fabs(slip) <= 3.5 * most) {
        after.along = after.rim = (5 * before.along + 2 * before.rim) / 7;
    } else {
        const double change = slip > 0 ? most : -most;
        after.along = before.along - change;
        after.rim = before.rim + 2.5 * change;
    }
    return after;
}

static void expect(pl_builder *b, int ball, motion m, double speed)
{
    pl_build_at_end(b, ball, PL_QUANTITY_VELOCITY, pl_axis_x, pl_exactly(m.along), speed);
    pl_build_at_end(b, ball, PL_QUANTITY_VELOCITY, pl_axis_z, pl_exactly(m.up), speed);
    pl_build_at_end(b, ball, PL_QUANTITY_SPIN, pl_axis_y, pl_exactly(m.rim / oblique_impact_radius),
                    speed / oblique_impact_radius);
    pl_build_none(b, ball, PL_QUANTITY_VELOCITY, PL_ALONG_Y, speed);
    pl_build_none(b, ball, PL_QUANTITY_SPIN, PL_ALONG_X | PL_ALONG_Z,
                  speed / oblique_impact_radius);
}

static void oblique_impact_build(pl_builder *b, const double *values)
{
    b->scene->gravity[2] = 0;
    pl_build_floor(b);
    motion m = {.along = values[OBLIQUE_IMPACT_SPEED] * pl_sine(values[OBLIQUE_IMPACT_ANGLE]),
                .up = -values[OBLIQUE_IMPACT_SPEED] * pl_cosine(values[OBLIQUE_IMPACT_ANGLE]),
                .rim = oblique_impact_radius * values[OBLIQUE_IMPACT_SPIN]};
    pl_body ball =
        pl_body_at(pl_shape_sphere(oblique_impact_radius), 0, 0, oblique_impact_radius + gap);
    ball.velocity[0] = m.along;
    ball.velocity[2] = m.up;
    ball.angular_velocity[1] = values[OBLIQUE_IMPACT_SPIN];
    const int index = pl_build_body(b, &ball, "ball");
    if (gap < -m.up * b->steps * b->scene->dt) {
        m = reflect(m, values[OBLIQUE_IMPACT_FRICTION], values[OBLIQUE_IMPACT_RESTITUTION]);
    }
    expect(b, index, m, values[OBLIQUE_IMPACT_SPEED]);
}

const pl_scenario pl_scenario_oblique_impact = {
    .name = "oblique-impact",
    .title = "Oblique impact of a spinning ball",
    .description = "A spinning sphere strikes the floor at an angle, without gravity: whether "
                   "friction stops its slip or reaches Coulomb's bound, and the spin that it "
                   "leaves with.",
    .reference = "with s = v - r w and c = friction (1 + e) v_n: sticks iff |s| <= 7/2 c, "
                 "v' = r w' = (5 v + 2 r w) / 7; else v' = v - sign(s) c, "
                 "r w' = r w + 5/2 sign(s) c; v_n' = e v_n",
    .expected = "ok: the ball leaves with the velocity and the spin of the reference",
    .source =
        "Coulomb's cone and Newton's restitution in the impulse on a solid sphere, as in "
        "Routh 1905, The Elementary Part of a Treatise on the Dynamics of a System of Rigid Bodies",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "the slip does not turn round in the impact, which it never does for a sphere",
    PL_PARAMS(oblique_impact_params),
    .build = oblique_impact_build};
