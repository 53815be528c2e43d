/* A box turns freely about nearly its middle axis, and flips again and again.
 *
 * In the body's axes Euler's equations have the integrals 2 E = sum I_i w_i^2 and
 * L^2 = sum I_i^2 w_i^2. With I_1 < I_2 < I_3 and L^2 > 2 E I_2 the middle component is
 * w_2 ~ sn(p t; m),
 *   p^2 = (I_3 - I_2)(L^2 - 2 E I_1) / (I_1 I_2 I_3),
 *   1 - m = (I_3 - I_1)(L^2 - 2 E I_2) / ((I_3 - I_2)(L^2 - 2 E I_1)),
 * of period 4 K(m) / p; with 1 and 3 changed for each other where L^2 < 2 E I_2. K is by the
 * arithmetic-geometric mean, K = pi / (2 M(1, sqrt(1 - m))). Where L^2 = 2 E I_2 there is no
 * period. The differences L^2 - 2 E I_k = sum I_i (I_i - I_k) w_i^2 are taken without
 * cancellation. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { WOBBLE_X, WOBBLE_Z, SPIN, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [WOBBLE_X] = {.name = "wobble_x",
                  .value = 0.1,
                  .min = 0,
                  .max = 1,
                  .unit = "rad/s",
                  .help = "spin at the start about the axis of largest inertia"},
    [WOBBLE_Z] = {.name = "wobble_z",
                  .value = 0.1,
                  .min = 0,
                  .max = 1,
                  .unit = "rad/s",
                  .help = "spin at the start about the axis of least inertia"},
    [SPIN] = {.name = "spin",
              .value = 5,
              .min = 0.5,
              .max = 50,
              .unit = "rad/s",
              .help = "at the start about the middle axis"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(20),
};

static double mean_of(double a, double b)
{
    for (int i = 0; i < 64 && fabs(a - b) > 4e-16 * a; i++) {
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
    for (int i = 0; i < 3; i++) {
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

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_torque_free.name, values[DT], values[DURATION], 0, error);
    scene->gravity[2] = 0;
    pl_body box = pl_body_default();
    box.mass = 10;
    box.shape = pl_shape_box(0.05, 0.2, 0.45);
    pl_shape_inertia(&box.shape, box.mass, box.inertia);
    box.angular_velocity[0] = values[WOBBLE_X];
    box.angular_velocity[1] = values[SPIN];
    box.angular_velocity[2] = values[WOBBLE_Z];
    const int index = pl_build_body(&builder, &box, "box");
    if (excess(box.inertia, box.angular_velocity, 1) == 0 && builder.status == PL_OK) {
        pl_scene_free(scene);
        return pl_fail(error, PL_BAD_INPUT,
                       "torque-free: expected a wobble that makes the box flip, found %g and %g",
                       values[WOBBLE_X], values[WOBBLE_Z]);
    }
    pl_expect_value period = pl_expect_value_default(scene);
    period.body = index;
    period.quantity = PL_QUANTITY_PERIOD;
    period.direction[1] = 1;
    period.direction[2] = 0;
    period.value = period_of(box.inertia, box.angular_velocity, 2, 1, 0);
    period.scale = period.value;
    pl_build_value(&builder, &period);
    pl_build_judge(&builder, pl_scenario_torque_free.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_torque_free = {
    .name = "torque-free",
    .title = "Flipping box in free space",
    .description = "A box of 1 x 4 x 9, without any force, turns about nearly its middle axis, "
                   "which is unstable: it flips at exact intervals. The metric momentum_error "
                   "tells whether its angular momentum stays.",
    .reference = "the middle component of the spin has the period 4 K(m) / p; at the default spins "
                 "6.056844 s; angular momentum and energy are constant",
    .expected = "ok: the box flips at equal intervals; energy and angular momentum stay",
    .source = "Landau and Lifshitz 1976, Mechanics, section 37, the asymmetrical top",
    .primary_error = "value_error",
    .validity = "the run must see two whole flips: a duration of two periods suffices",
    .needs = PL_NEEDS_ROTATION | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
