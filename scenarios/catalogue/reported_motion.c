/* Free and rolling motion that users of engines reported: fast, slanted and long rolls, and the box of
 * the Gazebo benchmark, which tumbles about its middle axis. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>
#include <string.h>

/* ---- Rolling ---- */

/* A ball that rolls along `along` at the speed v over the floor keeps its velocity and its spin
 * v / r. */
static void add_roller(pl_builder *b, double radius, double mass, const double along[3], double v)
{
    const double axis[3] = {-along[1], along[0], 0}, spin = v / radius;
    pl_build_floor(b);
    pl_body ball = pl_body_at(pl_shape_sphere(radius), 0, 0, radius);
    ball.mass = mass;
    for (int k = 0; k < 2; ++k) {
        ball.velocity[k] = v * along[k];
        ball.angular_velocity[k] = spin * axis[k];
    }
    const int index = pl_build_body(b, &ball, "ball");
    const double visible = 0.02 * radius;
    pl_build_within(b, index, PL_QUANTITY_POSITION, along, v * b->end, 0.06 * v * b->end);
    pl_build_within(b, index, PL_QUANTITY_POSITION, axis, 0, visible);
    pl_build_within(b, index, PL_QUANTITY_POSITION, pl_axis_z, 0, visible);
    pl_build_within(b, index, PL_QUANTITY_VELOCITY, along, v, 0.06 * v);
    pl_build_within(b, index, PL_QUANTITY_SPIN, axis, spin, 0.06 * spin);
}

enum { ROLL_SPEED };

static const pl_param marble_params[] = {
    {"speed", 1, 0.01, 100, false, "m/s", "of the marble, of 16 mm"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void marble_build(pl_builder *b, const double *values)
{
    add_roller(b, 0.008, 0.00536, pl_axis_x, values[ROLL_SPEED]);
}

const pl_scenario pl_scenario_fast_marble = {
    .name = "fast-marble",
    .title = "Fast marble",
    .description = "A marble of 16 mm rolls at 1 m/s, 2.1 rad a step of 1/60 s: whether it keeps "
                   "its speed, its spin and its height.",
    .reference = "velocity, spin v / r and height constant",
    .expected = "ok: the marble rolls on straight at its speed",
    .source = "rolling without slip on a level floor: no force acts along it",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "the marble rides half its radius deep, since the contact point turns with it",
    .threads = "dartsim/dart#1433, gazebosim/gz-physics#7",
    PL_PARAMS(marble_params),
    .build = marble_build};

enum { POOL_SPEED, POOL_AZIMUTH };

static const pl_param pool_params[] = {
    {"speed", 2, 0.01, 100, false, "m/s", "of the ball, of 57 mm"},
    {"azimuth", 30, 0, 90, false, "deg", "of its path, from x towards y"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void pool_build(pl_builder *b, const double *values)
{
    double along[3];
    pl_azimuth(values[POOL_AZIMUTH], along);
    add_roller(b, 0.028575, 0.17, along, values[POOL_SPEED]);
}

const pl_scenario pl_scenario_pool_ball = {
    .name = "pool-ball",
    .title = "Pool ball that rolls at an angle to the axes",
    .description = "A pool ball rolls at 30 degrees to the axes: whether its path stays straight.",
    .reference = "velocity, spin v / r and height constant",
    .expected = "ok: the ball rolls on straight at its speed",
    .source = "rolling without slip on a level floor: no force acts along it",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "the path curves until it is along an axis",
    .threads = "bulletphysics/bullet3#2117, avianphysics/avian#1023",
    PL_PARAMS(pool_params),
    .build = pool_build};

/* A ball rolls down a long slope from rest: a = 5/7 g sin(angle), and its spin is v / r, as long as
 * tan(angle) <= 7/2 friction. */

enum { LONG_ANGLE };

static const double long_radius = 0.5; /* m */

static const pl_param long_params[] = {
    {"angle", 30, 1, 60, false, "deg",
     "of the slope; tan <= 3.5 friction, where the ball does not slip"},
    {"friction", 0.5, 0.5, 10, false, "1", "Coulomb coefficient"},
    PL_PARAM_TIME(10),
};

static void long_build(pl_builder *b, const double *values)
{
    const double angle = PL_RADIANS_PER_DEGREE * values[LONG_ANGLE];
    const double s = pl_sine(angle), c = pl_cosine(angle), r = long_radius, t = b->end;
    const double a = 5.0 / 7 * b->gravity * s;
    const double down[3] = {c, 0, -s}, normal[3] = {s, 0, c};
    pl_build_plane(b, "slope", 0, s, 0, c, 0);
    const pl_body ball = pl_body_at(pl_shape_sphere(r), r * s, 0, r * c);
    const int index = pl_build_body(b, &ball, "ball");
    pl_build_within(b, index, PL_QUANTITY_POSITION, down, a * t * t / 2, 0.06 * a * t * t / 2);
    pl_build_within(b, index, PL_QUANTITY_POSITION, pl_axis_y, 0, 0.02 * r);
    pl_build_within(b, index, PL_QUANTITY_POSITION, normal, 0, 0.02 * r);
    pl_build_within(b, index, PL_QUANTITY_SPIN, pl_axis_y, a * t / r, 0.06 * a * t / r);
}

const pl_scenario pl_scenario_long_roll = {
    .name = "long-roll",
    .title = "Long roll down a slope",
    .description = "A ball rolls down a slope from rest for ten seconds, to 35 m/s: whether its "
                   "acceleration stays that of rolling.",
    .reference = "a = 5/7 g sin(angle); spin a t / r",
    .expected = "ok: the ball rolls 175 m and does not slip",
    .source = "Newton's and Euler's laws for a solid sphere that rolls",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "tan(angle) <= 7/2 friction",
    .symptom = "after some seconds the ball accelerates without bound",
    .threads = "godotengine/godot#101149",
    PL_PARAMS(long_params),
    .build = long_build};

/* ---- The box of the Gazebo benchmark ----
 *
 * 0.1 x 0.4 x 0.9 m, 10 kg. Free of contact, its centre moves by p = v t + g t^2 / 2, and it turns by
 * Euler's equations, which are solved here by the classical Runge-Kutta rule. */

static const double box_half[3] = {0.05, 0.2, 0.45}, box_mass = 10; /* m, kg */

/* Principal moments. */
static void box_moments(double inertia[3])
{
    for (int k = 0; k < 3; ++k) {
        const double u = box_half[(k + 1) % 3], v = box_half[(k + 2) % 3];
        inertia[k] = box_mass / 3 * (u * u + v * v);
    }
}

static double rotational_energy(const double spin[3])
{
    double inertia[3], sum = 0;
    box_moments(inertia);
    for (int k = 0; k < 3; ++k) {
        sum += inertia[k] * spin[k] * spin[k] / 2;
    }
    return sum;
}

/* Orientation (4) and spin in the body's axes (3). */
enum { ATTITUDE = 7 };

static void attitude_rate(const double *y, double *rate)
{
    const double *w = y + 4;
    double inertia[3];
    box_moments(inertia);
    rate[0] = -0.5 * (y[1] * w[0] + y[2] * w[1] + y[3] * w[2]);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        rate[1 + k] = 0.5 * (y[0] * w[k] + y[1 + i] * w[j] - y[1 + j] * w[i]);
        rate[4 + k] = (inertia[i] - inertia[j]) * w[i] * w[j] / inertia[k];
    }
}

static void turn_freely(double *y, double time)
{
    const int steps = (int)ceil(fmin(time * 1000, 1e5));
    const double h = time / steps;
    for (int i = 0; i < steps; ++i) {
        double rate[4][ATTITUDE], at[ATTITUDE];
        static const double along[4] = {0, 0.5, 0.5, 1};
        for (int stage = 0; stage < 4; ++stage) {
            for (int k = 0; k < ATTITUDE; ++k) {
                at[k] = y[k] + (stage == 0 ? 0 : h * along[stage] * rate[stage - 1][k]);
            }
            attitude_rate(at, rate[stage]);
        }
        for (int k = 0; k < ATTITUDE; ++k) {
            y[k] += h / 6 * (rate[0][k] + 2 * rate[1][k] + 2 * rate[2][k] + rate[3][k]);
        }
    }
}

/* The spin in the world's axes. */
static void world_spin(const double *y, double spin[3])
{
    const double *q = y, *w = y + 4;
    double t[3];
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        t[k] = 2 * (q[1 + i] * w[j] - q[1 + j] * w[i]);
    }
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        spin[k] = w[k] + q[0] * t[k] + q[1 + i] * t[j] - q[1 + j] * t[i];
    }
}

static int add_box(pl_builder *b, const double velocity[3], const double spin[3])
{
    pl_body box = pl_body_at(pl_shape_box(box_half[0], box_half[1], box_half[2]), 0, 0, 0);
    box.mass = box_mass;
    memcpy(box.velocity, velocity, sizeof box.velocity);
    memcpy(box.angular_velocity, spin, sizeof box.angular_velocity);
    return pl_build_body(b, &box, "box");
}

static const pl_param tumbling_params[] = {
    PL_PARAM_STEP(0.001),
    PL_PARAM_DURATION(10),
};

static void tumbling_build(pl_builder *b, const double *values)
{
    const double velocity[3] = {-2, 2, 8}, spin[3] = {0.1, 5, 0.1}, g = 9.8;
    const double *const axes[] = {pl_axis_x, pl_axis_y, pl_axis_z};
    const double t = fmin(b->end, 20);
    double y[ATTITUDE] = {1, 0, 0, 0, spin[0], spin[1], spin[2]}, end[3];
    (void)values;
    b->scene->gravity[2] = -g;
    const int box = add_box(b, velocity, spin);
    turn_freely(y, t);
    world_spin(y, end);
    for (int k = 0; k < 3; ++k) {
        const double fall = k == 2 ? g * t * t / 2 : 0;
        pl_expect_value value =
            pl_value_within(b, box, PL_QUANTITY_POSITION, axes[k], velocity[k] * t - fall,
                            0.06 * (fabs(velocity[k]) * t + fall));
        value.until = t;
        pl_build_value(b, &value);
        value = pl_value_within(b, box, PL_QUANTITY_SPIN, axes[k], end[k], 0.06 * spin[1]);
        value.until = t;
        pl_build_value(b, &value);
    }
}

const pl_scenario pl_scenario_tumbling_box = {
    .name = "tumbling-box",
    .title = "Tumbling box of the Gazebo benchmark",
    .description = "A flat box, thrown up, tumbles about its middle axis: its path and its spin "
                   "after ten seconds.",
    .reference = "p = v t + g t^2 / 2; the spin by Euler's equations",
    .expected = "ok: the box falls on a parabola and flips every 3.03 s",
    .source = "Newton's and Euler's laws, solved by the classical Runge-Kutta rule; scene by "
              "Peters and Hsu 2014, Comparison of rigid body dynamic simulators for robotic "
              "simulation in Gazebo",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "up to 20 s",
    .symptom = "the box drifts to the side, or its spin gains or loses energy",
    .threads = "bulletphysics/bullet3#4636, bulletphysics/bullet3#346, jrouwe/JoltPhysics#803, "
               "bepu/bepuphysics2#79",
    PL_PARAMS(tumbling_params),
    .build = tumbling_build};

/* The same box without gravity: the period of its spin about the middle axis.
 *
 * With I1 < I2 < I3, M the angular momentum and E the energy, and M^2 > 2 E I2,
 *   T = 4 K(k) sqrt(I1 I2 I3 / ((I3 - I2) (M^2 - 2 E I1))),
 *   k^2 = (I2 - I1) (2 E I3 - M^2) / ((I3 - I2) (M^2 - 2 E I1)),
 * with K by the arithmetic-geometric mean. */

enum { FLIP_DISTURBANCE };

static const pl_param flip_params[] = {
    {"disturbance", 0.1, 1e-3, 0.5, false, "rad/s", "spin about the two other axes"},
    PL_PARAM_STEP(0.001),
    PL_PARAM_DURATION(20),
};

static double flip_period(const double spin[3])
{
    double moments[3], momentum = 0;
    box_moments(moments);
    for (int k = 0; k < 3; ++k) {
        momentum += moments[k] * moments[k] * spin[k] * spin[k];
    }
    const double least = moments[2], middle = moments[1], most = moments[0];
    const double energy = 2 * rotational_energy(spin);
    const double share = (most - middle) * (momentum - energy * least);
    double a = 1, mean = sqrt(1 - (middle - least) * (energy * most - momentum) / share);
    for (int i = 0; i < 40; ++i) {
        const double next = (a + mean) / 2;
        mean = sqrt(a * mean);
        a = next;
    }
    const double quarter = 1.5707963267948966 / a;
    return 4 * quarter * sqrt(least * middle * most / share);
}

static void flip_build(pl_builder *b, const double *values)
{
    const double still[3] = {0, 0, 0}, d = values[FLIP_DISTURBANCE], spin[3] = {d, 5, d};
    const double energy = rotational_energy(spin);
    b->scene->gravity[2] = 0;
    const int box = add_box(b, still, spin);
    const double period = flip_period(spin);
    if (b->end > 2 * period) {
        pl_build_within(b, box, PL_QUANTITY_PERIOD, pl_axis_y, period, 0.06 * period);
    }
    pl_build_within(b, box, PL_QUANTITY_ENERGY, pl_axis_z, energy, 0.06 * energy);
    pl_build_none_within(b, box, PL_QUANTITY_POSITION, PL_ALONG_ALL, 0.01);
}

const pl_scenario pl_scenario_flipping_box = {
    .name = "flipping-box",
    .title = "Period of the middle axis",
    .description = "The box of the Gazebo benchmark spins about its middle axis without gravity: "
                   "how often it flips, and whether it keeps its energy.",
    .reference = "T = 4 K(k) sqrt(I1 I2 I3 / ((I3 - I2) (M^2 - 2 E I1))); energy constant",
    .expected = "ok: the box flips every 3.03 s and keeps its energy",
    .source = "Landau and Lifshitz, Mechanics, section 37",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "M^2 > 2 E I2, which holds for every disturbance in the range; two periods "
                "within the run, else the energy alone",
    .symptom = "a tumbling body gains energy, or comes to rest",
    .threads = "bulletphysics/bullet3#4636, jrouwe/JoltPhysics#803, bepu/bepuphysics2#79",
    PL_PARAMS(flip_params),
    .build = flip_build};

/* Its simple variant: without gravity, and spinning about the axis of its largest moment, which is
 * steady. It goes straight and turns by w t. */

static void steady_build(pl_builder *b, const double *values)
{
    const double velocity[3] = {-0.9, 0.4, 0.1}, spin[3] = {0.5, 0, 0};
    const double *const axes[] = {pl_axis_x, pl_axis_y, pl_axis_z};
    const double t = b->end;
    (void)values;
    b->scene->gravity[2] = 0;
    const int box = add_box(b, velocity, spin);
    for (int k = 0; k < 3; ++k) {
        pl_build_within(b, box, PL_QUANTITY_POSITION, axes[k], velocity[k] * t,
                        0.06 * fabs(velocity[k]) * t);
        pl_build_within(b, box, PL_QUANTITY_TURN, axes[k], spin[k] * t, 0.06 * spin[0] * t);
    }
}

const pl_scenario pl_scenario_steady_box = {
    .name = "steady-box",
    .title = "Steady box of the Gazebo benchmark",
    .description = "A flat box drifts without gravity and spins about the axis of its largest "
                   "moment: its path and its turn after ten seconds.",
    .reference = "p = v t, turn w t",
    .expected = "ok: the box goes straight and turns by 5 rad",
    .source = "Newton's and Euler's laws; scene by Peters and Hsu 2014, Comparison of rigid body "
              "dynamic simulators for robotic simulation in Gazebo",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "a free body loses speed or spin to damping, or drifts to the side",
    .threads = "bulletphysics/bullet3#4636",
    PL_PARAMS(tumbling_params),
    .build = steady_build};
