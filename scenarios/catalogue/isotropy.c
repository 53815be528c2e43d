/* Nineteen blocks side by side, each pushed off at its own azimuth, 0 to 90 degrees by 5.
 *
 * Coulomb's friction takes friction g along each path, so that all go equally far and straight on;
 * see slide_to_stop.c for one of them, and for its discrete answer. Friction by a pyramid whose
 * edges lie along the world's axes would hold one at 45 degrees sqrt(2) times as well as one at 0.
 * The blocks' sides stay along x and y. They start on a line across 45 degrees and fan out. */
#include "catalogue.h"
#include "trigonometry.h"
#include "uniform_motion.h"

#include <math.h>
#include <string.h>

enum { SPEED, FRICTION, DT, DURATION, PARAM_COUNT };
enum { BLOCKS = 19 };

static const double half[3] = {0.5, 0.5, 0.25}; /* m */
static const double spacing = 5;                /* m */

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 5,
               .min = 0.1,
               .max = 100,
               .unit = "m/s",
               .help = "of the blocks at the start"},
    [FRICTION] = {.name = "friction",
                  .value = 0.5,
                  .min = 0.01,
                  .max = 1.9,
                  .unit = "1",
                  .help = "Coulomb coefficient; below 2, where the blocks would tip"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(3),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_isotropy.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    const double steps = (double)pl_scene_steps(scene);
    const pl_answer way =
        pl_braked_way(values[SPEED], values[FRICTION] * -scene->gravity[2], scene->dt, steps);
    pl_build_floor(&builder, 0, 0, 1, 0);
    for (int i = 0; i < BLOCKS; i++) {
        pl_expect_travel travel = {.distance = way.continuous, .discrete = way.discrete};
        pl_azimuth(5 * i, travel.direction);
        pl_body block = pl_body_default();
        block.shape = pl_shape_box(half[0], half[1], half[2]);
        const double across = spacing * sqrt(0.5) * (i - (BLOCKS - 1) / 2);
        block.position[0] = -across;
        block.position[1] = across;
        block.position[2] = half[2];
        for (int k = 0; k < 3; k++) {
            block.velocity[k] = values[SPEED] * travel.direction[k];
        }
        travel.body = pl_build_body(&builder, &block, "block %d", 5 * i);
        pl_build_travel(&builder, &travel);
    }
    pl_build_judge(&builder, pl_scenario_isotropy.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_isotropy = {
    .name = "isotropy",
    .title = "Friction in all directions",
    .description =
        "Blocks pushed off over a level floor at azimuths of 0 to 90 degrees, all of one "
        "size and speed: friction by a pyramid in place of a cone stops them at "
        "different distances, and off their paths.",
    .reference = "s = v0^2 / (2 friction g) along every azimuth, while friction < half width / "
                 "half height = 2, so that no block tips",
    .expected = "ok: all blocks go equally far, each straight along its azimuth",
    .source = "Coulomb's law and uniform deceleration",
    .primary_error = "travel_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
