/* A ladder, a board of half length L, half thickness t and uniform density, against a smooth wall.
 *
 * The wall is x = 0, the floor z = 0; the board leans to the wall at `angle` from the floor. It
 * touches both with the two edges of its underside, so the points of contact are those of a line
 * of length 2 L, while the centre of mass lies t above the middle of that line. With the weight W,
 * the wall's push P and the floor's friction F = P, moments about the lower edge:
 *     W (L cos - t sin) = P 2 L sin
 * so friction >= P / W means tan(angle) >= 1 / (2 friction + t / L); for t = 0 that is
 * atan(1 / (2 friction)). At tan(angle) > L / t it would tip away from the wall.
 *
 * At d below the critical angle the board turns by an acceleration near g d / L that grows as it
 * sinks, at a rate near sqrt(g / L): d = 1e-4 is more than the 0.1 m of a fall within 5 s. From 10
 * degrees, the least, it falls by 0.17 m. */
#include "catalogue.h"
#include "degree.h"
#include "scene_builder.h"
#include "trigonometry.h"

#include <math.h>

enum { FRICTION, THICKNESS, ANGLE, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = {.name = "friction",
                  .value = 0.5,
                  .min = 0.05,
                  .max = 2,
                  .unit = "1",
                  .help = "Coulomb coefficient of the floor; the wall has none"},
    [THICKNESS] = {.name = "thickness",
                   .value = 0.02,
                   .min = 1e-3,
                   .max = 0.05,
                   .unit = "1",
                   .help = "of the board over its length"},
    [ANGLE] = {.name = "angle",
               .value = 45,
               .min = 10,
               .max = 89,
               .unit = "deg",
               .help = "from the floor"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static double critical(const double *values)
{
    return atan(1 / (2 * values[FRICTION] + values[THICKNESS])) / PL_RADIANS_PER_DEGREE;
}

static const pl_threshold threshold = {.param = "angle",
                                       .low = 10,
                                       .high = 86,
                                       .holds_below = false,
                                       .tolerance = 2e-4,
                                       .critical = critical,
                                       .formula = "atan(1 / (2 friction + thickness))"};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half_length = 1, half_width = 0.2, angle = PL_RADIANS_PER_DEGREE * values[ANGLE];
    const double half_thickness = half_length * values[THICKNESS];
    const double s = pl_sine(angle), c = pl_cosine(angle);
    pl_builder builder = pl_build_begin(scene, pl_scenario_ladder.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    const int smooth = pl_build_material(&builder, "smooth", 0);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body wall = pl_body_default();
    wall.is_static = true;
    wall.material = smooth;
    wall.shape = pl_shape_plane(1, 0, 0, 0);
    pl_build_body(&builder, &wall, "wall");
    /* Its x axis points down the board, its z axis up from the underside. */
    pl_body board = pl_body_default();
    board.shape = pl_shape_box(half_length, half_width, half_thickness);
    board.position[0] = half_length * c + half_thickness * s;
    board.position[2] = half_length * s + half_thickness * c;
    board.orientation[0] = pl_cosine(angle / 2);
    board.orientation[2] = pl_sine(angle / 2);
    pl_build_rest(&builder, pl_build_body(&builder, &board, "board"));
    pl_build_judge(&builder, pl_scenario_ladder.primary_error, 0.1);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_ladder = {
    .name = "ladder",
    .title = "Ladder against a smooth wall",
    .description =
        "A thin board that leans on a wall without friction, held by the floor's friction alone, a "
        "little steeper than it must be: two kinds of contact in one body.",
    .reference = "it holds iff tan(angle) >= 1 / (2 friction + thickness / length)",
    .expected = "ok: the board at rest where it began, above the critical angle; collapsed below: "
                "it slides down",
    .source =
        "statics: moments about the lower edge; textbooks have it for a line, 1 / (2 friction)",
    .primary_error = "rest_position_error",
    .validity = "angle > atan(1 / (2 friction + thickness / length))",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
