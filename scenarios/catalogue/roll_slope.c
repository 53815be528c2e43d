/* A sphere, a cylinder and a prism of many sides roll down a slope from rest.
 *
 * Without slip, with a = g sin(angle) / (1 + I / (m r^2)), that is 5/7 and 2/3 of g sin(angle), and
 * t = n h after n steps of h: a t^2 / 2, and of semi-implicit Euler a h^2 n (n + 1) / 2. It does
 * not slip while friction >= tan(angle) / (1 + m r^2 / I): 2/7 and 1/3 of tan(angle). The prism
 * loses energy whenever it falls from one side to the next, so its way is shorter than the
 * cylinder's and has no such form. */
#include "catalogue.h"
#include "slope.h"
#include "solids.h"
#include "trigonometry.h"

#include <math.h>

enum { SHAPE, SIDES, FRICTION, ANGLE, DT, DURATION, PARAM_COUNT };
enum { SPHERE, CYLINDER, PRISM };

static const double radius = 0.5, half_height = 0.5; /* m */

static const pl_param params[PARAM_COUNT] = {
    [SHAPE] = {.name = "shape",
               .value = SPHERE,
               .min = SPHERE,
               .max = PRISM,
               .integer = true,
               .unit = "1",
               .help = "0 sphere, 1 cylinder, 2 prism: a convex hull"},
    [SIDES] = {.name = "sides",
               .value = 64,
               .min = 4,
               .max = 1000,
               .integer = true,
               .unit = "1",
               .help = "of the prism"},
    [FRICTION] = PL_PARAM_FRICTION,
    [ANGLE] = {.name = "angle",
               .value = 0.3,
               .min = 0,
               .max = 1.5,
               .unit = "rad",
               .help = "of the slope, at which it must not slip"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

static void shape_body(pl_builder *builder, int shape, int sides, pl_body *body)
{
    if (shape == SPHERE) {
        body->shape = pl_shape_sphere(radius);
    } else if (shape == CYLINDER) {
        body->shape = pl_shape_cylinder(radius, half_height);
    } else {
        pl_solid solid = pl_solid_prism(sides, radius, half_height);
        const pl_polyhedron *prism = pl_build_solid(builder, &solid, true, "prism");
        body->shape = prism != NULL ? pl_shape_of(prism) : body->shape;
    }
}

/* From the axis to the lowest line. */
static double height_of(int shape, int sides)
{
    double x = 1, y;
    if (shape == PRISM) {
        pl_circle_point(1, 2 * sides, &x, &y);
    }
    return radius * x;
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const int shape = (int)values[SHAPE];
    const pl_slope slope = pl_slope_of(values[ANGLE], values[FRICTION]);
    const double inertia = shape == SPHERE ? 0.4 : 0.5; /* over m r^2 */
    *scene = pl_scene_default();
    if (slope.angle == 0 && shape != PRISM) {
        return pl_fail(error, PL_BAD_INPUT,
                       "roll-slope: expected an angle above 0, where it begins to roll, found 0");
    }
    if (slope.friction * slope.cosine * (1 + 1 / inertia) < slope.sine) {
        return pl_fail(error, PL_BAD_INPUT,
                       "roll-slope: expected a friction of %g at least, where it does not slip, "
                       "found %g",
                       slope.sine / slope.cosine / (1 + 1 / inertia), slope.friction);
    }
    pl_builder builder = pl_build_begin(scene, pl_scenario_roll_slope.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, slope.sine, 0, slope.cosine, 0);
    pl_body body = pl_body_default();
    shape_body(&builder, shape, (int)values[SIDES], &body);
    const double height = height_of(shape, (int)values[SIDES]);
    body.position[0] = height * slope.sine;
    body.position[2] = height * slope.cosine;
    /* The axis, z of the shape, is turned to y by a right angle about x; then all by the slope. */
    const double c = pl_cosine(slope.angle / 2), s = pl_sine(slope.angle / 2), r = sqrt(0.5);
    const double orientation[4] = {r * c, -r * c, r * s, r * s};
    for (int k = 0; k < 4; k++) {
        body.orientation[k] = orientation[k];
    }
    int index = pl_build_body(&builder, &body, "roller");
    if (shape == PRISM) {
        pl_build_judge(&builder, "penetration_max", (double)INFINITY);
        return pl_build_end(&builder);
    }
    const double a = -scene->gravity[2] * slope.sine / (1 + inertia);
    const double steps = (double)pl_scene_steps(scene), t = steps * scene->dt;
    const pl_expect_travel travel = {.body = index,
                                     .direction = {slope.cosine, 0, -slope.sine},
                                     .distance = a * t * t / 2,
                                     .discrete =
                                         a * scene->dt * scene->dt * steps * (steps + 1) / 2};
    pl_build_travel(&builder, &travel);
    pl_build_judge(&builder, pl_scenario_roll_slope.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
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
    .validity = "angle > 0, friction >= 2/7 tan(angle) for the sphere, 1/3 for the cylinder",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
