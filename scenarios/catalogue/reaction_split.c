/* A tall block slides on a level floor, its weight more on the leading edge than on the other.
 *
 * Friction mu m g acts at the floor, half the height hh below the centre of mass, so that with half
 * width hb along the path the reactions at the two edges are
 *   N_front, N_back = (m g / 2) (1 +- mu hh / hb).
 * The block stays flat iff the one behind is above 0, mu < hb / hh; then it slides as any other,
 *   s = v0 t - mu g t^2 / 2,  v = v0 - mu g t,
 * until it stops, and does not turn. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPEED, HEIGHT, FRICTION, DT, DURATION, PARAM_COUNT };

static const double half_width = 0.25; /* m */

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 5,
               .min = 0.1,
               .max = 100,
               .unit = "m/s",
               .help = "of the block at the start"},
    [HEIGHT] = {.name = "height",
                .value = 2,
                .min = 0.1,
                .max = 20,
                .unit = "1",
                .help = "of the block, over its width of 0.5 m"},
    [FRICTION] = {.name = "friction",
                  .value = 0.3,
                  .min = 1e-3,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient; below width / height, where the block would tip"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(1),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double speed = values[SPEED], friction = values[FRICTION];
    *scene = pl_scene_default();
    if (friction * values[HEIGHT] >= 1) {
        return pl_fail(error, PL_BAD_INPUT,
                       "reaction-split: expected a friction below width / height = %g, where the "
                       "block does not tip, found %g",
                       1 / values[HEIGHT], friction);
    }
    pl_builder builder = pl_build_begin(scene, pl_scenario_reaction_split.name, values[DT],
                                        values[DURATION], friction, error);
    const double braking = friction * -scene->gravity[2], h = scene->dt;
    const double steps = (double)pl_scene_steps(scene), half_height = half_width * values[HEIGHT];
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body block = pl_body_default();
    block.shape = pl_shape_box(half_width, half_width, half_height);
    block.position[2] = half_height;
    block.velocity[0] = speed;
    const int index = pl_build_body(&builder, &block, "block");
    const pl_answer way = pl_braked_way(speed, braking, h, steps);
    pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_x, way, way.continuous);
    pl_build_at_end(&builder, index, PL_QUANTITY_VELOCITY, pl_axis_x,
                    pl_exactly(fmax(0, speed - braking * steps * h)), speed);
    pl_build_at_end(&builder, index, PL_QUANTITY_TURN, pl_axis_y, pl_exactly(0), 1);
    pl_build_judge(&builder, pl_scenario_reaction_split.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_reaction_split = {
    .name = "reaction-split",
    .title = "Tall block that slides",
    .description = "A tall block slides with most of its weight on the leading edge: whether the "
                   "reactions shift as they must, so that it neither digs in nor tips, and brakes "
                   "as a flat one.",
    .reference = "a = friction g without turning; front and back reactions (m g / 2) "
                 "(1 +- friction height / width)",
    .expected = "ok: the block brakes as a flat one and does not turn",
    .source = "Coulomb's law; moments about the centre of mass",
    .primary_error = "value_error",
    .validity = "friction < width / height, else the block tips",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
