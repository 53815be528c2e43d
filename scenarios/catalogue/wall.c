/* A brick wall at rest. It stands by statics: every brick lies on its row below over its whole
 * length. */
#include "brick_wall.h"
#include "catalogue.h"

enum { ROWS, COLUMNS, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [ROWS] = PL_PARAM_BRICK_ROWS(10),   [COLUMNS] = PL_PARAM_BRICK_COLUMNS(10),
    [FRICTION] = PL_PARAM_FRICTION,     [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_wall.name, values[DT], values[DURATION],
                                        values[FRICTION], error);
    pl_build_brick_wall(&builder, (int)values[ROWS], (int)values[COLUMNS], true);
    pl_build_judge(&builder, pl_scenario_wall.primary_error, PL_BRICK_HEIGHT / 2);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_wall = {
    .name = "wall",
    .title = "Brick wall at rest",
    .description =
        "A wall of bricks in running bond that touch exactly: many bodies and closed loops of "
        "contacts, where a stack has a chain.",
    .reference = "every brick stays where it is",
    .expected = "ok: every brick at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
