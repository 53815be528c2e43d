/* Bodies that roll: down a slope, from skidding to rolling, and balls on a box that is pushed. */
#include "base/trigonometry.h"
#include "catalogue.h"
#include "solids.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A sphere, a cylinder and a prism of many sides roll down a slope from rest.
 *
 * Without slip, with a = g sin(angle) / (1 + I / (m r^2)), that is 5/7 and 2/3 of g sin(angle), and
 * t = n h after n steps of h: a t^2 / 2, and of semi-implicit Euler a h^2 n (n + 1) / 2. It does
 * not slip while friction >= tan(angle) / (1 + m r^2 / I): 2/7 and 1/3 of tan(angle). The prism
 * loses energy whenever it falls from one side to the next, so its distance is shorter than the
 * cylinder's and has no such form. */

enum { ROLL_SLOPE_SHAPE, ROLL_SLOPE_SIDES, ROLL_SLOPE_FRICTION, ROLL_SLOPE_ANGLE };
enum { SPHERE, CYLINDER, PRISM };

static const double roll_slope_radius = 0.5, roll_slope_half_height = 0.5; /* m */

static const pl_param roll_slope_params[] = {
    {"shape", SPHERE, SPHERE, PRISM, true, "1", "0 sphere, 1 cylinder, 2 prism: a convex hull"},
    {"sides", 64, 4, 1000, true, "1", "of the prism"},
    PL_PARAM_FRICTION,
    {"angle", 0.3, 0, 1.5, false, "rad", "of the slope, at which it must not slip"},
    PL_PARAM_TIME(2),
};

static pl_shape shape_of(pl_builder *b, int shape, int sides)
{
    if (shape == SPHERE) {
        return pl_shape_sphere(roll_slope_radius);
    }
    if (shape == CYLINDER) {
        return pl_shape_cylinder(roll_slope_radius, roll_slope_half_height);
    }
    pl_solid solid = pl_solid_prism(sides, roll_slope_radius, roll_slope_half_height);
    return pl_build_solid(b, &solid, true, "prism");
}

/* The distance from the axis to the lowest line. */
static double height_of(int shape, int sides)
{
    double x = 1, y;
    if (shape == PRISM) {
        pl_circle_point(1, 2 * sides, &x, &y);
    }
    return roll_slope_radius * x;
}

static void roll_slope_build(pl_builder *b, const double *values)
{
    const int shape = (int)values[ROLL_SLOPE_SHAPE];
    const double angle = values[ROLL_SLOPE_ANGLE], friction = values[ROLL_SLOPE_FRICTION];
    const double sine = pl_sine(angle), cosine = pl_cosine(angle);
    const double inertia = shape == SPHERE ? 0.4 : 0.5; /* over m r^2 */
    if (angle == 0 && shape != PRISM) {
        pl_build_refuse(b, "expected an angle above 0, where it begins to roll, found 0");
        return;
    }
    if (friction * cosine * (1 + 1 / inertia) < sine) {
        pl_build_refuse(b,
                        "expected a friction of %g at least, where it does not slip, "
                        "found %g",
                        sine / cosine / (1 + 1 / inertia), friction);
        return;
    }
    pl_build_plane(b, "floor", 0, sine, 0, cosine, 0);
    const int sides = (int)values[ROLL_SLOPE_SIDES];
    const double height = height_of(shape, sides);
    pl_body body = pl_body_at(shape_of(b, shape, sides), height * sine, 0, height * cosine);
    /* The axis, z of the shape, is turned to y by a right angle about x; then all by the slope. */
    const double c = pl_cosine(angle / 2), s = pl_sine(angle / 2), r = sqrt(0.5);
    memcpy(body.orientation, (double[4]){r * c, -r * c, r * s, r * s}, sizeof body.orientation);
    int index = pl_build_body(b, &body, "roller");
    if (shape == PRISM) {
        snprintf(b->scene->primary_error, PL_NAME_SIZE, "chaotic_error");
        b->scene->acceptance = 0.1;
        return;
    }
    const double downhill[3] = {cosine, 0, -sine};
    pl_build_travel(
        b, index, downhill,
        pl_uniform_distance(0, b->gravity * sine / (1 + inertia), b->scene->dt, b->steps));
}

const pl_scenario pl_scenario_roll_slope = {
    .name = "roll-slope",
    .title = "Rolling down a slope",
    .description = "A sphere, a cylinder or a prism, released at rest on a slope with friction "
                   "enough: whether it rolls without slip, as fast as its inertia lets it.",
    .reference = "s = a t^2 / 2 along the slope, a = 5/7 g sin(angle) for the sphere, 2/3 for the "
                 "cylinder; of semi-implicit Euler a h^2 n (n + 1) / 2; none for the prism",
    .expected = "ok: sphere and cylinder roll by the distance of the reference; a prism stays out "
                "of the slope",
    .source = "a = g sin(angle) / (1 + I / (m r^2)), rolling without slip",
    .primary_error = "travel_error",
    .acceptance = 0.06,
    .acceptance_reason =
        "6 %: speeds that differ by less look the same (Snowden and Braddick 1991); "
        "a prism is judged as chaotic scenes are, by 0.1",
    .validity = "angle > 0, friction >= 2/7 tan(angle) for the sphere, 1/3 for the cylinder",
    PL_PARAMS(roll_slope_params),
    .build = roll_slope_build};

/* A sphere thrown along a level floor skids until it rolls.
 *
 * With v along x, w the spin about y, s = v - r w the slip of the lowest point, and I = 2/5 m r^2,
 * Coulomb's friction changes v by -sign(s) mu g and r w by 5/2 sign(s) mu g, so that s loses
 * 7/2 mu g and 5 v + 2 r w is constant:
 *   t_s = 2 |s0| / (7 mu g),  v = r w = (5 v0 + 2 r w0) / 7 from then on,
 *   x = v0 t_s - sign(s0) mu g t_s^2 / 2 + v (t - t_s).
 * Without spin v = 5/7 v0, t_s = 2 v0 / (7 mu g), and 12 v0^2 / (49 mu g) is the distance until it
 * rolls. Semi-implicit Euler skids for floor(t_s / h) whole steps and rolls from the next on. The
 * path is straight and level, and the ball spins about y alone. */

enum { BOWLING_SPEED, BOWLING_SPIN, BOWLING_FRICTION };

static const double bowling_radius = 0.1; /* m */

static const pl_param bowling_params[] = {
    {"speed", 5, 0.1, 100, false, "m/s", "of the throw"},
    {"spin", 0, -1000, 1000, false, "rad/s",
     "at the start, positive as in rolling; the radius is 0.1 m"},
    {"friction", 0.2, 1e-3, 10, false, "1", "Coulomb coefficient"},
    PL_PARAM_TIME(2),
};

static void bowling_expect(pl_builder *b, int ball, double v0, double rim0, double friction)
{
    const pl_scene *scene = b->scene;
    const double steps = b->steps, h = scene->dt, t = steps * h;
    const double slip = v0 - rim0, braking = friction * b->gravity;
    const double a = slip > 0 ? -braking : braking;
    const double skid = fmin(t, 2 * fabs(slip) / (7 * braking));
    const double skid_steps = fmin(steps, floor(2 * fabs(slip) / (7 * braking * h)));
    const bool rolls = skid < t;
    const double v = rolls ? (5 * v0 + 2 * rim0) / 7 : v0 + a * t;
    const double rim = rolls ? v : rim0 - 2.5 * a * t;
    const pl_answer distance = {v0 * skid + a * skid * skid / 2 + v * (t - skid),
                                pl_uniform_distance(v0, a, h, skid_steps).discrete +
                                    v * h * (steps - skid_steps)};
    /* The size of the terms of the answers, since an answer itself may vanish. */
    const double speed = fmax(fabs(v), 0.1 * (v0 + fabs(rim0)));
    pl_build_displaced(b, ball, pl_axis_x, distance, fmax(fabs(distance.continuous), speed * t));
    pl_build_at_end(b, ball, PL_QUANTITY_VELOCITY, pl_axis_x, pl_exactly(v), speed);
    pl_build_at_end(b, ball, PL_QUANTITY_SPIN, pl_axis_y, pl_exactly(rim / bowling_radius),
                    speed / bowling_radius);
    pl_build_none(b, ball, PL_QUANTITY_SPIN, PL_ALONG_X | PL_ALONG_Z, speed / bowling_radius);
}

static void bowling_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    pl_body ball = pl_body_at(pl_shape_sphere(bowling_radius), 0, 0, bowling_radius);
    ball.velocity[0] = values[BOWLING_SPEED];
    ball.angular_velocity[1] = values[BOWLING_SPIN];
    const int index = pl_build_body(b, &ball, "ball");
    bowling_expect(b, index, values[BOWLING_SPEED], bowling_radius * values[BOWLING_SPIN],
                   values[BOWLING_FRICTION]);
}

const pl_scenario pl_scenario_bowling = {
    .name = "bowling",
    .title = "From skidding to rolling",
    .description = "A sphere thrown along the floor, with any spin, skids until it rolls: whether "
                   "friction acts in full while it slips, and not at all when it rolls.",
    .reference =
        "t_s = 2 |v0 - r w0| / (7 friction g); then v = r w = (5 v0 + 2 r w0) / 7; without "
        "spin the skid is 12 v0^2 / (49 friction g) long",
    .expected =
        "ok: the ball skids until it rolls; distance, speed and spin are those of the reference",
    .source = "Coulomb's law and I = 2/5 m r^2; Coriolis 1835, Theorie mathematique des effets du "
              "jeu de billard",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    PL_PARAMS(bowling_params),
    .build = bowling_build};

/* A wide box that carries k x k balls on its top is pushed along the floor.
 *
 * With M the box, m a ball, n = k^2 and f1 = mu (M + n m) g the friction of the floor: a ball that
 * rolls without slip on a top of acceleration a gets a force f2 with f2 / m + f2 r^2 / I = a, that
 * is f2 = m a / (1 + 5/2) = 2/7 m a, and pushes the top back by as much, so that
 *   a_box = (F - f1) / (M + 2/7 n m),  a_ball = 2/7 a_box,  r w = 5/7 a_box t backwards.
 * (In another form f2 = ((F - f1) / M) / (3.5 / m + n / M), a_box = (F - f1 - n f2) / M.)
 *
 * Valid while the balls stick, a_box <= 7/2 mu_ball g, while none has rolled to the edge,
 * 5/7 a_box t^2 / 2, and while the box stays flat: about its centre the push has no moment, the
 * floor's friction f1 H, the balls' n f2 H, with H half its height, and the balls that lag by d
 * n m g d; all together less than the weight (M + n m) g times half the width. Box and balls go
 * straight on and stay at their heights, and the box does not turn. */

enum { CARRIED_BALLS_ROWS, CARRIED_BALLS_PUSH, CARRIED_BALLS_AZIMUTH, CARRIED_BALLS_FRICTION };

static const double half_width = 2, carried_balls_half_height = 0.1, box_mass = 10;
static const double carried_balls_radius = 0.1, ball_mass = 1, spacing = 0.25;
static const double ball_friction = 0.8;

static const pl_param carried_balls_params[] = {
    {"rows", 3, 1, 5, true, "1", "of balls, and balls in a row; each has 1 kg, the box 10 kg"},
    {"push", 50, 1, 300, false, "N", "on the box, from the start"},
    {"azimuth", 45, 0, 90, false, "deg", "of the push"},
    {"friction", 0.1, 0, 0.5, false, "1",
     "Coulomb coefficient of the floor; that of the balls is 0.8"},
    PL_PARAM_TIME(1),
};

/* Of the box, m/s^2; the time is over when it is wrong. */
typedef struct carriage {
    double acceleration, time;
} carriage;

static void check(pl_builder *b, const carriage *c, double weight, double floor_friction, int rows)
{
    const double lag = 5.0 / 14 * c->acceleration * c->time * c->time;
    const double balls = ball_mass * rows * rows;
    const double moment =
        carried_balls_half_height * (floor_friction + balls * 2 / 7 * c->acceleration) +
        balls * b->gravity * lag;
    if (!(c->acceleration > 0)) {
        pl_build_refuse(b, "expected a push of more than the floor's friction of %g N",
                        floor_friction);
    } else if (lag + spacing * (rows - 1) / 2 > 0.95 * half_width ||
               moment > 0.9 * weight * half_width ||
               c->acceleration > 3.5 * ball_friction * b->gravity) {
        pl_build_refuse(b,
                        "expected a push and a duration in which the balls stay on "
                        "the box, found that they slip or lag by %g m at %g m/s^2",
                        lag, c->acceleration);
    }
}

static void carried_balls_expect(pl_builder *b, int body, const double direction[3],
                                 double acceleration)
{
    const pl_answer distance = pl_uniform_distance(0, acceleration, b->scene->dt, b->steps);
    pl_build_displaced(b, body, direction, distance, distance.continuous);
}

static void build_balls(pl_builder *b, int rows, const double direction[3], double a, double time)
{
    const double axis[3] = {-direction[1], direction[0], 0};
    const double spin = -5.0 / 7 * a * time / carried_balls_radius;
    for (int i = 0; i < rows * rows; ++i) {
        const int row = i / rows;
        pl_body ball =
            pl_body_at(pl_shape_sphere(carried_balls_radius),
                       spacing * (i % rows - (rows - 1) / 2.0), spacing * (row - (rows - 1) / 2.0),
                       2 * carried_balls_half_height + carried_balls_radius);
        ball.mass = ball_mass;
        ball.material = 1;
        const int index = pl_build_body(b, &ball, "ball %d", i + 1);
        carried_balls_expect(b, index, direction, a * 2 / 7);
        pl_build_at_end(b, index, PL_QUANTITY_SPIN, axis, pl_exactly(spin), -spin);
    }
}

static void carried_balls_build(pl_builder *b, const double *values)
{
    const int rows = (int)values[CARRIED_BALLS_ROWS];
    const double balls = ball_mass * rows * rows;
    const double weight = (box_mass + balls) * b->gravity,
                 braking = values[CARRIED_BALLS_FRICTION] * weight;
    const carriage c = {.acceleration =
                            (values[CARRIED_BALLS_PUSH] - braking) / (box_mass + balls * 2 / 7),
                        .time = b->end};
    check(b, &c, weight, braking, rows);
    double direction[3];
    pl_azimuth(values[CARRIED_BALLS_AZIMUTH], direction);
    pl_build_pair(b, 0, pl_build_material(b, "ball", ball_friction, 0), ball_friction);
    pl_build_floor(b);
    pl_body box = pl_body_at(pl_shape_box(half_width, half_width, carried_balls_half_height), 0, 0,
                             carried_balls_half_height);
    box.mass = box_mass;
    const int index = pl_build_body(b, &box, "box");
    pl_force push = {.body = index, .frame = PL_FRAME_WORLD, .until = (double)INFINITY};
    for (int k = 0; k < 3; ++k) {
        push.force[k] = values[CARRIED_BALLS_PUSH] * direction[k];
    }
    pl_build_force(b, &push);
    carried_balls_expect(b, index, direction, c.acceleration);
    pl_build_none(b, index, PL_QUANTITY_TURN, PL_ALONG_ALL, 1);
    build_balls(b, rows, direction, c.acceleration, c.time);
}

const pl_scenario pl_scenario_carried_balls = {
    .name = "carried-balls",
    .title = "Pushed box that carries balls",
    .description = "A box pushed over the floor, at any azimuth, carries balls that roll back on "
                   "its top: sliding and rolling friction in one island, in each its own.",
    .reference = "a_box = (F - friction (M + n m) g) / (M + 2/7 n m), a_ball = 2/7 a_box, while "
                 "the balls stick and stay on the box",
    .expected = "ok: box and balls go as far as the reference says; no ball slips or falls off",
    .source = "Newton's and Euler's laws with I = 2/5 m r^2; the scene after the rolling test of "
              "SimBenchmark (Kang and Hwangbo 2018)",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    .validity = "the balls neither slip, 7/2 of their friction times g, nor reach the edge",
    PL_PARAMS(carried_balls_params),
    .build = carried_balls_build};
