/* A sphere falls on a level floor and bounces.
 *
 * From the height H (of its lowest point) it reaches e^(2 k) H after k bounces, by v' = -e v at
 * each. It first meets the floor at T = sqrt(2 H / g), and the apex after the k-th bounce comes at
 * T (1 + 2 e + ... + 2 e^(k - 1) + e^k); for e < 1 the bounces end at T (1 + e) / (1 - e). Each of
 * the first `bounces` apexes is looked for in the middle half of its own flight, so that an engine
 * that is late still shows it, and its error is relative to its own height. Where the run shows
 * none of them, or there is none for lack of restitution, the height at its end is expected,
 * relative to H. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { HEIGHT, RESTITUTION, BOUNCES, DT, DURATION, PARAM_COUNT };

static const double radius = 0.1; /* m */

static const pl_param params[PARAM_COUNT] = {
    [HEIGHT] = {.name = "height",
                .value = 1,
                .min = 0.01,
                .max = 100,
                .unit = "m",
                .help = "of the lowest point above the floor"},
    [RESTITUTION] = PL_PARAM_RESTITUTION(0.8),
    [BOUNCES] = {.name = "bounces",
                 .value = 3,
                 .min = 1,
                 .max = 50,
                 .integer = true,
                 .unit = "1",
                 .help = "how many of them are judged"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(3),
};

/* Of the flights that the run sees to three quarters at least. */
static void expect_apexes(pl_builder *builder, int ball, double height, double e, int bounces)
{
    const pl_scene *scene = builder->scene;
    const double fall = sqrt(2 * height / -scene->gravity[2]);
    double start = fall, part = e; /* of the flight after bounce k; e^k */
    pl_expect_value apex = pl_expect_value_default(scene);
    const double end = apex.until;
    apex.body = ball;
    apex.quantity = PL_QUANTITY_APEX;
    for (int k = 0; k < bounces; k++) {
        const double flight = 2 * part * fall;
        apex.from = start + flight / 4;
        apex.until = start + flight * 3 / 4;
        apex.value = height * (part * part - 1);
        apex.scale = height * part * part;
        if (flight < 8 * scene->dt || apex.until > end) {
            return;
        }
        pl_build_value(builder, &apex);
        start += flight;
        part *= e;
    }
}

/* Of the lowest point, from flight to flight; what bounces by less than rounding lies. */
static double height_at(double time, double height, double e, double g)
{
    double start = sqrt(2 * height / g), speed = g * start * e;
    if (time <= start) {
        return height - g * time * time / 2;
    }
    while (speed > 1e-9 && start + 2 * speed / g < time) {
        start += 2 * speed / g;
        speed *= e;
    }
    const double passed = time - start;
    return speed > 1e-9 ? speed * passed - g * passed * passed / 2 : 0;
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double height = values[HEIGHT], e = values[RESTITUTION];
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_bounce.name, values[DT], values[DURATION], 0, error);
    if (builder.status == PL_OK) {
        scene->materials[0].restitution = e;
    }
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(radius);
    ball.position[2] = radius + height;
    const int index = pl_build_body(&builder, &ball, "ball");
    expect_apexes(&builder, index, height, e, (int)values[BOUNCES]);
    if (scene->value_count == 0) {
        const double end = (double)pl_scene_steps(scene) * scene->dt;
        const double left = height_at(end, height, e, -scene->gravity[2]);
        pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_z,
                        pl_continuous(left - height), height);
    }
    pl_build_judge(&builder, pl_scenario_bounce.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_bounce = {
    .name = "bounce",
    .title = "Bouncing ball",
    .description = "A sphere falls on the floor and bounces, with any restitution from 0 to 1: "
                   "whether it comes back as high as it should, time after time.",
    .reference = "apex e^(2 k) H after k bounces; at rest after sqrt(2 H / g) (1 + e) / (1 - e)",
    .expected = "ok: each apex at e^2 of the one before",
    .source = "Newton 1687, Principia, scholium to the laws: v' = -e v; conservation of energy in "
              "flight",
    .primary_error = "value_error",
    .validity =
        "apexes of flights of 8 steps or more within the run; without one, the height at the end",
    .needs = PL_NEEDS_RESTITUTION | PL_NEEDS_PLANE | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
