/* A row of dominoes falls into a pile of cubes.
 *
 * The pile stands before the last domino, within its reach: 3 x 3 stacks of cubes, each cube set
 * off at random by up to 0.05 of its side, which leaves every stack standing by itself. Chaotic:
 * judged by overlap, and as an ensemble over seeds. */
#include "catalogue.h"
#include "domino.h"
#include "draw.h"

#include <math.h>

enum { COUNT, LAYERS, FRICTION, DT, DURATION, PARAM_COUNT };
enum { ROWS = 3 };

static const double size = 1, spacing = 0.5, push = 1.2; /* of the dominoes */
static const double side = 0.3, apart = 0.02;            /* m, of the cubes */
static const double density = 10;                        /* kg/m^3 */

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 10,
               .min = 1,
               .max = 1000,
               .integer = true,
               .unit = "1",
               .help = "dominoes, of 1 kg and 1 m"},
    [LAYERS] = {.name = "layers",
                .value = 3,
                .min = 1,
                .max = 5,
                .integer = true,
                .unit = "1",
                .help = "of 3 x 3 cubes of 0.3 m"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(5),
};

static void build_pile(pl_builder *builder, pl_random *random, double near, int layers)
{
    const double offset = 0.05 * side, pitch = side + 2 * offset + apart;
    for (int i = 0; i < ROWS * ROWS * layers; i++) {
        pl_body cube = pl_body_default();
        cube.shape = pl_shape_box(side / 2, side / 2, side / 2);
        cube.mass = density * side * side * side;
        cube.position[0] =
            near + (i % ROWS + 0.5) * pitch + pl_draw_uniform(random, -offset, offset);
        cube.position[1] =
            (i / ROWS % ROWS - (ROWS - 1) / 2.0) * pitch + pl_draw_uniform(random, -offset, offset);
        cube.position[2] = (i / (ROWS * ROWS) + 0.5) * side;
        pl_build_body(builder, &cube, "cube %d", i + 1);
    }
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    pl_random random = {.state = seed};
    pl_builder builder = pl_build_begin(scene, pl_scenario_domino_into_pile.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    const int count = (int)values[COUNT];
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_build_dominoes(&builder, count, size, spacing, push);
    const double last = (count - 1) * spacing * size;
    build_pile(&builder, &random, last + spacing * size, (int)values[LAYERS]);
    pl_build_judge(&builder, pl_scenario_domino_into_pile.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_domino_into_pile = {
    .name = "domino-into-pile",
    .title = "Dominoes fall into a pile",
    .description = "A row of dominoes, of which the last falls into stacks of cubes set off at "
                   "random: an orderly wave that ends in a chaotic one.",
    .reference = "no closed form for the motion; no overlap at any time: penetration 0",
    .expected = "ok: the wave runs into the pile; no two bodies overlap at any time",
    .source = "impenetrability",
    .primary_error = "penetration_max",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
