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
#include "catalogue.h"
#include "solids.h"
#include "trigonometry.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPIN, TILT, DT, DURATION, PARAM_COUNT };
enum { SIDES = 16 };

static const double radius = 1, height = 1; /* m */

static const pl_param params[PARAM_COUNT] = {
    [SPIN] = {.name = "spin",
              .value = 25,
              .min = 12,
              .max = 1000,
              .unit = "rad/s",
              .help = "along its axis; below about 8 there is no steady precession"},
    [TILT] = {.name = "tilt",
              .value = 0.3,
              .min = 0.01,
              .max = 0.6,
              .unit = "rad",
              .help = "of its axis from the vertical; at 0.78 the rim would touch"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(3),
};

static const pl_polyhedron *build_cone(pl_builder *builder)
{
    double points[SIDES + 1][3] = {{0, 0, -0.75 * height}};
    for (int i = 0; i < SIDES; i++) {
        double x, y;
        pl_circle_point(i, SIDES, &x, &y);
        points[i + 1][0] = radius * x;
        points[i + 1][1] = radius * y;
        points[i + 1][2] = 0.25 * height;
    }
    const pl_polyhedron *cone = NULL;
    if (builder->status == PL_OK) {
        builder->status = pl_scene_add_hull(builder->scene, "cone", (const double(*)[3])points,
                                            SIDES + 1, &cone, builder->error);
    }
    return cone;
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

static void expect(pl_builder *builder, int top, double precession, const double spin[3])
{
    const pl_scene *scene = builder->scene;
    const double phase = precession * (double)pl_scene_steps(scene) * scene->dt;
    pl_build_at_end(builder, top, PL_QUANTITY_SPIN, pl_axis_x,
                    pl_continuous(spin[0] * pl_cosine_of_any(phase)), spin[0]);
    pl_build_at_end(builder, top, PL_QUANTITY_SPIN, pl_axis_y,
                    pl_continuous(spin[0] * pl_sine_of_any(phase)), spin[0]);
    pl_build_at_end(builder, top, PL_QUANTITY_SPIN, pl_axis_z, pl_exactly(spin[2]), spin[2]);
    pl_build_at_end(builder, top, PL_QUANTITY_POSITION, pl_axis_x, pl_exactly(0), height);
    pl_build_at_end(builder, top, PL_QUANTITY_POSITION, pl_axis_y, pl_exactly(0), height);
    pl_build_at_end(builder, top, PL_QUANTITY_POSITION, pl_axis_z, pl_exactly(0), height);
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_top.name, values[DT], values[DURATION], 0, error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    const double sine = pl_sine(values[TILT]), cosine = pl_cosine(values[TILT]);
    const double precession = precession_of(values[SPIN], cosine, -scene->gravity[2]);
    const double own = values[SPIN] - precession * cosine;
    const pl_polyhedron *cone = build_cone(&builder);
    if (builder.status == PL_OK) {
        pl_body top = pl_body_default();
        top.shape = pl_shape_of(cone);
        top.position[2] = 0.75 * height * cosine;
        top.orientation[0] = pl_cosine(values[TILT] / 2);
        top.orientation[2] = pl_sine(values[TILT] / 2);
        top.angular_velocity[0] = own * sine;
        top.angular_velocity[2] = own * cosine + precession;
        const int index = pl_build_body(&builder, &top, "top");
        expect(&builder, index, precession, top.angular_velocity);
    }
    pl_build_judge(&builder, pl_scenario_top.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
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
    .needs = PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_HULL,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
