/* A body flies at a wall that is much thinner than the way it makes in a step.
 *
 * There is no gravity, and nothing bounces: the body meets the wall's middle squarely, or with its
 * edge foremost, and stops where it touches. */
#include "catalogue.h"
#include "scene_builder.h"

#include <math.h>

enum { SHAPE, SPEED, THICKNESS, FRICTION, DT, DURATION, PARAM_COUNT };
enum { SPHERE, PLATE, PLATE_ON_EDGE };

static const pl_param params[PARAM_COUNT] = {
    [SHAPE] = {.name = "shape",
               .value = SPHERE,
               .min = SPHERE,
               .max = PLATE_ON_EDGE,
               .integer = true,
               .unit = "1",
               .help = "0 sphere of 1 m, 1 plate of 1 m by 1 cm, 2 the same, its edge foremost"},
    [SPEED] = {.name = "speed",
               .value = 200,
               .min = 0.1,
               .max = 1e4,
               .unit = "m/s",
               .help = "of the body"},
    [THICKNESS] = {.name = "thickness",
                   .value = 0.01,
                   .min = 1e-6,
                   .max = 1,
                   .unit = "m",
                   .help = "of the wall"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(1),
};

static const double half = 0.5, half_plate = 0.005; /* m */
static const double start = -7.3;                   /* m: in mid-step at the wall */
static const double half_wall = 20;                 /* m */

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_thin_wall.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    scene->gravity[2] = 0;
    pl_body wall = pl_body_default();
    wall.is_static = true;
    wall.shape = pl_shape_box(values[THICKNESS] / 2, half_wall, half_wall);
    pl_build_body(&builder, &wall, "wall");

    const int shape = (int)values[SHAPE];
    pl_body body = pl_body_default();
    body.shape = shape == SPHERE  ? pl_shape_sphere(half)
                 : shape == PLATE ? pl_shape_box(half_plate, half, half)
                                  : pl_shape_box(half, half, half_plate);
    const double front = shape == PLATE ? half_plate : half;
    body.position[0] = -values[THICKNESS] / 2 - front;
    body.velocity[0] = values[SPEED];
    const double resting = body.position[0];
    int flying = pl_build_body(&builder, &body, "body");
    pl_build_rest(&builder, flying);
    if (builder.status == PL_OK) {
        scene->bodies[flying].position[0] = resting + start;
    }
    pl_build_judge(&builder, pl_scenario_thin_wall.primary_error, 0.1);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_thin_wall = {
    .name = "thin-wall",
    .title = "Bullet and thin wall",
    .description =
        "A fast body flies squarely at a thin wall, which it would pass within one step: "
        "whether the engine sees it coming.",
    .reference = "it stops where it touches the wall",
    .expected = "ok: the body stops where it touches the wall",
    .source = "impenetrability, and a restitution of 0",
    .primary_error = "rest_position_error",
    .validity = "the run lasts until it is there: speed * duration > 7.3 m",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_BOX | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
