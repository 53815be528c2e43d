/* Pyramids of cubes, of cylinders and of spheres, at rest by statics. */
#include "catalogue.h"

#include <math.h>

/* A tenth of the radius of a cylinder or sphere, m. */
static const double round_collapse = 0.05;

#define PL_PARAM_ROUND_FRICTION(default)                                                           \
    {                                                                                              \
        "friction", default, 0, 10, false, "1", "Coulomb coefficient between the bodies"           \
    }
#define PL_PARAM_FLOOR_FRICTION                                                                    \
    {                                                                                              \
        "floor_friction", 1, 0, 10, false, "1", "Coulomb coefficient of the floor"                 \
    }

/* A floor whose friction is not that between the bodies on it, which are of material 0. */
static void build_round_floor(pl_builder *b, double friction)
{
    const int material = pl_build_material(b, "floor", friction, 0);
    pl_build_plane(b, "floor", material, 0, 0, 1, 0);
    pl_build_pair(b, 0, material, friction);
    b->scene->collapse_distance = round_collapse;
}

/* A pyramid of unit cubes in a plane: n cubes in the lowest row, one less in each above, each over
 * the gap between two.
 *
 * Cube i of row r, both from 0, has its centre at x = (1 + gap) (i - (n - 1 - r) / 2), z = r + 1/2:
 * rows lie symmetric about x = 0, so that each cube rests on the two below it with the same weight.
 * It stands by statics without any friction. */

enum { PYRAMID_COUNT, PYRAMID_GAP, PYRAMID_FRICTION };

static const pl_param pyramid_params[] = {
    {"n", 10, 1, 100, true, "1", "cubes in the lowest row"},
    {"gap", 0.125, 0, 0.75, false, "1", "between cubes of a row, over their side; 0: they touch"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void pyramid_build(pl_builder *b, const double *values)
{
    const double half = 0.5, spacing = 1 + values[PYRAMID_GAP];
    const int count = (int)values[PYRAMID_COUNT];
    pl_build_floor(b);
    for (int row = 0; row < count; ++row) {
        for (int i = 0; i < count - row; ++i) {
            pl_body cube = pl_body_at(pl_shape_box(half, half, half),
                                      spacing * (i - (count - 1 - row) / 2.0), 0, row + half);
            pl_build_rest(b, pl_build_body(b, &cube, "cube %d.%d", row + 1, i + 1));
        }
    }
    b->scene->collapse_distance = half;
}

const pl_scenario pl_scenario_pyramid = {
    .name = "pyramid",
    .title = "Pyramid of cubes",
    .description = "Cubes in rows, each on the two below it, at rest: the weight spreads over many "
                   "ways to the floor.",
    .reference = "every cube stays where it is: z = row - 1/2 m",
    .expected = "ok: every cube at rest where it began, even without friction",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(pyramid_params),
    .build = pyramid_build};

/* Three equal cylinders side by side: two on the floor, which touch, and one on top.
 *
 * Let N and T be the normal and the friction force between the upper and a lower one of weight W,
 * at 30 degrees from the vertical, and F and M those of the floor. Moments about a lower axis: F =
 * T. Along the floor: N sin 30 = T cos 30 + F, so T / N = sin 30 / (1 + cos 30) = tan 15. The upper
 * one: 2 (N cos 30 + T sin 30) = W, so N = W / 2, and with M = 3/2 W, F / M = tan(15) / 3. A push
 * between the lower two would only ask for more. They stand iff friction >= tan 15 = 2 - sqrt(3) =
 * 0.26795, floor_friction >= tan(15) / 3 = 0.08932.
 *
 * With d too little, the lower ones part by an acceleration near g d that grows as the upper one
 * sinks between them: at 1e-4 that is 0.05 m, where they have collapsed, within 10 s. */

enum { CYLINDER_PYRAMID_FRICTION, CYLINDER_PYRAMID_FLOOR_FRICTION };

static const pl_param cylinder_pyramid_params[] = {
    PL_PARAM_ROUND_FRICTION(0.28),
    PL_PARAM_FLOOR_FRICTION,
    PL_PARAM_TIME(10),
};

static double cylinder_pyramid_critical(const double *values)
{
    const double tangent = 2 - sqrt(3);
    return values[CYLINDER_PYRAMID_FLOOR_FRICTION] > tangent / 3 ? tangent : (double)NAN;
}

static const pl_threshold cylinder_pyramid_threshold = {.param = "friction",
                                                        .low = 0,
                                                        .high = 1,
                                                        .tolerance = 1e-5,
                                                        .critical = cylinder_pyramid_critical,
                                                        .formula = "tan 15 deg = 2 - sqrt(3)"};

static void cylinder_pyramid_build(pl_builder *b, const double *values)
{
    const double radius = 0.5, half_height = 0.5;
    build_round_floor(b, values[CYLINDER_PYRAMID_FLOOR_FRICTION]);
    pl_body cylinder = pl_body_at(pl_shape_cylinder(radius, half_height), 0, 0, 0);
    cylinder.orientation[0] = cylinder.orientation[1] = sqrt(0.5); /* its axis along y */
    for (int i = 0; i < 2; ++i) {
        cylinder.position[0] = i == 0 ? -radius : radius;
        cylinder.position[2] = radius;
        pl_build_rest(b, pl_build_body(b, &cylinder, "lower %d", i + 1));
    }
    cylinder.position[0] = 0;
    cylinder.position[2] = radius + sqrt(3) * radius;
    pl_build_rest(b, pl_build_body(b, &cylinder, "upper"));
}

const pl_scenario pl_scenario_cylinder_pyramid = {
    .name = "cylinder-pyramid",
    .title = "Three cylinders",
    .description = "A cylinder on two others that only friction keeps from rolling apart, with a "
                   "little more of it than that takes.",
    .reference = "they stand iff friction >= tan 15 deg = 0.26795 between them, and >= tan(15 deg) "
                 "/ 3 = 0.08932 on the floor",
    .expected = "ok: all at rest where they began, above both critical frictions; collapsed below: "
                "they roll apart",
    .source = "statics of each cylinder",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "friction > 0.26795, floor_friction > 0.08932",
    .provokes =
        "rolling bodies are held by friction alone, at every contact near its cone: creep, a "
        "cone of too few sides or a cap on the iterations lets it roll apart; a right "
        "engine holds it to the last digit of tan 15 deg",
    .threshold = &cylinder_pyramid_threshold,
    PL_PARAMS(cylinder_pyramid_params),
    .build = cylinder_pyramid_build};

/* Four equal spheres: three on the floor, which touch, and one on top.
 *
 * The upper centre is at the top of a regular tetrahedron: lines to the lower ones lean by a from
 * the vertical, cos a = sqrt(2/3), sin a = 1/sqrt(3). As for three cylinders (above),
 * T / N = sin a / (1 + cos a) = sqrt(3) - sqrt(2). The upper one: 3 (N cos a + T sin a) = W, so
 * N = W / 3; the floor carries 4/3 W under each lower one, and F / that = (sqrt(3) - sqrt(2)) / 4.
 * They stand iff friction >= sqrt(3) - sqrt(2) = 0.31784, floor_friction >= (sqrt(3) - sqrt(2)) / 4
 * = 0.07946.
 *
 * The growth beyond is that of the cylinders. */

enum { SPHERE_PYRAMID_FRICTION, SPHERE_PYRAMID_FLOOR_FRICTION };

static const pl_param sphere_pyramid_params[] = {
    PL_PARAM_ROUND_FRICTION(0.33),
    PL_PARAM_FLOOR_FRICTION,
    PL_PARAM_TIME(10),
};

static double sphere_pyramid_critical(const double *values)
{
    const double tangent = sqrt(3) - sqrt(2);
    return values[SPHERE_PYRAMID_FLOOR_FRICTION] > tangent / 4 ? tangent : (double)NAN;
}

static const pl_threshold sphere_pyramid_threshold = {.param = "friction",
                                                      .low = 0,
                                                      .high = 1,
                                                      .tolerance = 1e-5,
                                                      .critical = sphere_pyramid_critical,
                                                      .formula = "sqrt(3) - sqrt(2)"};

static void sphere_pyramid_build(pl_builder *b, const double *values)
{
    const double radius = 0.5, out = 2 * radius / sqrt(3);
    const double lower[3][2] = {{out, 0}, {-out / 2, radius}, {-out / 2, -radius}};
    build_round_floor(b, values[SPHERE_PYRAMID_FLOOR_FRICTION]);
    pl_body sphere = pl_body_at(pl_shape_sphere(radius), 0, 0, radius);
    for (int i = 0; i < 3; ++i) {
        sphere.position[0] = lower[i][0];
        sphere.position[1] = lower[i][1];
        pl_build_rest(b, pl_build_body(b, &sphere, "lower %d", i + 1));
    }
    sphere.position[0] = sphere.position[1] = 0;
    sphere.position[2] = radius + 2 * radius * sqrt(2.0 / 3);
    pl_build_rest(b, pl_build_body(b, &sphere, "upper"));
}

const pl_scenario pl_scenario_sphere_pyramid = {
    .name = "sphere-pyramid",
    .title = "Four spheres",
    .description = "A sphere on three others that only friction keeps from rolling apart, with a "
                   "little more of it than that takes.",
    .reference = "they stand iff friction >= sqrt(3) - sqrt(2) = 0.31784 between them, and >= a "
                 "quarter of that, 0.07946, on the floor",
    .expected = "ok: all at rest where they began, above both critical frictions; collapsed below: "
                "they roll apart",
    .source = "statics of each sphere",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "friction > 0.31784, floor_friction > 0.07946",
    .provokes =
        "friction in directions along no axis, at every contact near its cone: a pyramid in "
        "place of the cone holds too much or too little, and creep lets the spheres roll "
        "apart; a right engine holds them",
    .threshold = &sphere_pyramid_threshold,
    PL_PARAMS(sphere_pyramid_params),
    .build = sphere_pyramid_build};
