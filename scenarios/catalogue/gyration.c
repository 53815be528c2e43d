/* Free and gyroscopic rotation: a box without torque, and a top. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* A box turns freely about nearly its middle axis, and flips again and again.
 *
 * In the body's axes Euler's equations have the integrals 2 E = sum I_i w_i^2 and
 * L^2 = sum I_i^2 w_i^2. With I_1 < I_2 < I_3 and L^2 > 2 E I_2 the middle component is
 * w_2 ~ sn(p t; m),
 *   p^2 = (I_3 - I_2)(L^2 - 2 E I_1) / (I_1 I_2 I_3),
 *   1 - m = (I_3 - I_1)(L^2 - 2 E I_2) / ((I_3 - I_2)(L^2 - 2 E I_1)),
 * of period 4 K(m) / p; with 1 and 3 changed for each other where L^2 < 2 E I_2. K is by the
 * arithmetic-geometric mean, K = pi / (2 M(1, sqrt(1 - m))). Where L^2 = 2 E I_2 there is no
 * period. The box keeps its place, to 1 m. The differences L^2 - 2 E I_k = sum I_i (I_i - I_k)
 * w_i^2 are taken without cancellation. */

enum { TORQUE_FREE_WOBBLE_X, TORQUE_FREE_WOBBLE_Z, TORQUE_FREE_SPIN };

static const pl_param torque_free_params[] = {
    {"wobble_x", 0.1, 0, 1, false, "rad/s", "spin at the start about the axis of largest inertia"},
    {"wobble_z", 0.1, 0, 1, false, "rad/s", "spin at the start about the axis of least inertia"},
    {"spin", 5, 0.5, 50, false, "rad/s", "at the start about the middle axis"},
    PL_PARAM_TIME(20),
};

static double mean_of(double a, double b)
{
    for (int i = 0; i < 64 && fabs(a - b) > 4e-16 * a; ++i) {
        double mean = (a + b) / 2;
        b = sqrt(a * b);
        a = mean;
    }
    return (a + b) / 2;
}

/* L^2 - 2 E I_k. */
static double excess(const double inertia[3], const double w[3], int k)
{
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        sum += inertia[i] * (inertia[i] - inertia[k]) * w[i] * w[i];
    }
    return sum;
}

/* Of the middle component; inertia falls or rises from one end to the other. */
static double period_of(const double inertia[3], const double w[3], int least, int middle, int most)
{
    const double over = excess(inertia, w, middle);
    const int a = over > 0 ? least : most, c = over > 0 ? most : least;
    const double side = (inertia[c] - inertia[middle]) * excess(inertia, w, a);
    const double p = sqrt(side / (inertia[0] * inertia[1] * inertia[2]));
    const double rest = sqrt((inertia[c] - inertia[a]) * over / side); /* sqrt(1 - m) */
    const double pi = 3.141592653589793;
    return 2 * pi / (mean_of(1, rest) * p);
}

static void torque_free_build(pl_builder *b, const double *values)
{
    b->scene->gravity[2] = 0;
    pl_body box = pl_body_at(pl_shape_box(0.05, 0.2, 0.45), 0, 0, 0);
    box.mass = 10;
    pl_shape_inertia(&box.shape, box.mass, box.inertia);
    box.angular_velocity[0] = values[TORQUE_FREE_WOBBLE_X];
    box.angular_velocity[1] = values[TORQUE_FREE_SPIN];
    box.angular_velocity[2] = values[TORQUE_FREE_WOBBLE_Z];
    const int index = pl_build_body(b, &box, "box");
    if (excess(box.inertia, box.angular_velocity, 1) == 0 && b->status == PL_OK) {
        pl_build_refuse(b, "expected a wobble that makes the box flip, found %g and %g",
                        values[TORQUE_FREE_WOBBLE_X], values[TORQUE_FREE_WOBBLE_Z]);
        return;
    }
    pl_expect_value period = pl_expect_value_default(b->scene);
    period.body = index;
    period.quantity = PL_QUANTITY_PERIOD;
    period.direction[1] = 1;
    period.direction[2] = 0;
    period.value = period_of(box.inertia, box.angular_velocity, 2, 1, 0);
    period.scale = period.value;
    pl_build_value(b, &period);
    pl_build_none(b, index, PL_QUANTITY_POSITION, PL_ALONG_ALL, 1);
}

const pl_scenario pl_scenario_torque_free = {
    .name = "torque-free",
    .title = "Flipping box in free space",
    .description = "A box of 1 x 4 x 9, without any force, turns about nearly its middle axis, "
                   "which is unstable: it flips at exact intervals. The metric momentum_error "
                   "shows whether its angular momentum stays.",
    .reference = "the middle component of the spin has the period 4 K(m) / p; at the default spins "
                 "6.056844 s; angular momentum and energy are constant",
    .expected = "ok: the box flips at equal intervals; energy and angular momentum stay",
    .source = "Landau and Lifshitz 1976, Mechanics, section 37, the asymmetrical top",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "the run must see two whole flips: a duration of two periods suffices",
    PL_PARAMS(torque_free_params),
    .build = torque_free_build};

/* A spinning cone on its tip, on a smooth floor, in steady precession.
 *
 * Without friction the floor only pushes up, so that the centre of mass stays over one point; in
 * steady precession also at one height, so that N = m g. With l from the tip to the centre,
 * inertias I1 across the axis and I3 about it, both about the centre of mass, spin w3 along the
 * axis, tilt t and precession P about the vertical, Euler's law about the centre gives
 *   I1 P^2 cos t - I3 w3 P + m g l = 0,
 * of which the slower root is taken. With a the unit vector along the axis, the spin is
 * P z + (w3 - P cos t) a, and goes round with P. (On a rough floor, or held at its tip, I1 would be
 * about the tip.)
 *
 * The cone is the hull of a tip and a regular polygon, of n sides with corners at R: over its area
 * the mean of r^2 is q = R^2 (2 + cos(2 pi / n)) / 6, and with height h
 *   I3 = 3/5 m q,  I1 = I3 / 2 + 3/80 m h^2,  l = 3/4 h. */

enum { TOP_SPIN, TOP_TILT };
enum { SIDES = 16 };

static const double radius = 1, height = 1; /* m */

static const pl_param top_params[] = {
    {"spin", 25, 12, 1000, false, "rad/s",
     "along its axis; below about 8 there is no steady precession"},
    {"tilt", 0.3, 0.01, 0.6, false, "rad",
     "of its axis from the vertical; at 0.78 the rim would touch"},
    PL_PARAM_TIME(3),
};

static pl_shape build_cone(pl_builder *b)
{
    double points[SIDES + 1][3] = {{0, 0, -0.75 * height}};
    for (int i = 0; i < SIDES; ++i) {
        double x, y;
        pl_circle_point(i, SIDES, &x, &y);
        points[i + 1][0] = radius * x;
        points[i + 1][1] = radius * y;
        points[i + 1][2] = 0.25 * height;
    }
    return pl_build_hull(b, "cone", (const double(*)[3])points, SIDES + 1);
}

/* P, of 1 kg. */
static double precession_of(double spin, double cosine, double g)
{
    double x, y;
    pl_circle_point(1, SIDES, &x, &y);
    const double q = radius * radius * (2 + x) / 6, along = 0.6 * q;
    const double across = along / 2 + 3.0 / 80 * height * height;
    const double torque = g * 0.75 * height, momentum = along * spin;
    return 2 * torque / (momentum + sqrt(momentum * momentum - 4 * across * cosine * torque));
}

static void expect(pl_builder *b, int top, double precession, const double spin[3])
{
    const double phase = precession * b->steps * b->scene->dt;
    pl_build_at_end(b, top, PL_QUANTITY_SPIN, pl_axis_x,
                    pl_continuous(spin[0] * pl_cosine_of_any(phase)), spin[0]);
    pl_build_at_end(b, top, PL_QUANTITY_SPIN, pl_axis_y,
                    pl_continuous(spin[0] * pl_sine_of_any(phase)), spin[0]);
    pl_build_at_end(b, top, PL_QUANTITY_SPIN, pl_axis_z, pl_exactly(spin[2]), spin[2]);
    pl_build_none(b, top, PL_QUANTITY_POSITION, PL_ALONG_ALL, height);
}

static void top_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    const double sine = pl_sine(values[TOP_TILT]), cosine = pl_cosine(values[TOP_TILT]);
    const double precession = precession_of(values[TOP_SPIN], cosine, b->gravity);
    const double own = values[TOP_SPIN] - precession * cosine;
    const pl_shape cone = build_cone(b);
    if (b->status == PL_OK) {
        pl_body top = pl_body_at(cone, 0, 0, 0.75 * height * cosine);
        pl_turn_about_y(&top, values[TOP_TILT]);
        top.angular_velocity[0] = own * sine;
        top.angular_velocity[2] = own * cosine + precession;
        const int index = pl_build_body(b, &top, "top");
        expect(b, index, precession, top.angular_velocity);
    }
}

const pl_scenario pl_scenario_top = {
    .name = "top",
    .title = "Spinning top",
    .description = "A cone spins on its tip on a smooth floor and precesses steadily: gyroscopic "
                   "torque against one contact, round and round.",
    .reference = "I1 P^2 cos(tilt) - I3 w3 P + m g l = 0, the slower root; inertias about the "
                 "centre of mass, which stays where it is",
    .expected = "ok: the top precesses steadily and its centre of mass stays where it is",
    .source =
        "Landau and Lifshitz 1976, Mechanics, section 35, with the tip free to glide: Euler's "
        "law about the centre of mass",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    PL_PARAMS(top_params),
    .build = top_build};
