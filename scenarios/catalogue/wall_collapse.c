/* A brick wall hit by a heavy ball.
 *
 * The ball, of radius 1 m, starts 3 m before the wall at the middle of its length, 0.3 m above half
 * its height but never below the floor, and flies at it along +y. The motion is chaotic and has no
 * closed form; what every right answer shares is that no two bodies ever overlap. */
#include "brick_wall.h"
#include "catalogue.h"

#include <math.h>

enum { ROWS, COLUMNS, MASS, SPEED, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [ROWS] = PL_PARAM_BRICK_ROWS(25),
    [COLUMNS] = PL_PARAM_BRICK_COLUMNS(40),
    [MASS] = {.name = "mass",
              .value = 100,
              .min = 1e-3,
              .max = 1e6,
              .unit = "kg",
              .help = "of the ball"},
    [SPEED] = {.name = "speed",
               .value = 20,
               .min = 0,
               .max = 1000,
               .unit = "m/s",
               .help = "of the ball towards the wall"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(5),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double radius = 1;
    pl_builder builder = pl_build_begin(scene, pl_scenario_wall_collapse.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_brick_wall(&builder, (int)values[ROWS], (int)values[COLUMNS], false);
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(radius);
    ball.mass = values[MASS];
    ball.position[0] = values[COLUMNS] * PL_BRICK_LENGTH / 2;
    ball.position[1] = -3;
    ball.position[2] = fmax(values[ROWS] * PL_BRICK_HEIGHT / 2 + 0.3, radius);
    ball.velocity[1] = values[SPEED];
    pl_build_body(&builder, &ball, "ball");
    pl_build_judge(&builder, pl_scenario_wall_collapse.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_wall_collapse = {
    .name = "wall-collapse",
    .title = "Brick wall hit by a ball",
    .description =
        "A thousand bricks and a ball of 100 kg at 20 m/s: impact, collapse and a pile, with "
        "contacts that come and go at every step.",
    .reference = "no closed form for the motion; no overlap at any time: penetration 0",
    .expected = "ok: the ball breaks the wall; no two bodies overlap at any time",
    .source = "impenetrability",
    .primary_error = "penetration_max",
    .needs =
        PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
