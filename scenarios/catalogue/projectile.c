/* A small sphere thrown at an angle: range, height and apex of its parabola.
 *
 * With (u, w) = speed (cos, sin) of the angle and t = n h:
 *   continuous:           x = u t,  z = w t - g t^2 / 2,  apex w^2 / (2 g) at t = w / g
 *   semi-implicit Euler:  x_n = u t,  z_n = w t - g h^2 n (n + 1) / 2: the parabola of the speed
 *                         w - g h / 2, whose apex is (w - g h / 2)^2 / (2 g)
 * The apex is expected where it lies within the run. Errors are relative to each answer's own size:
 * u t, w t + g t^2 / 2, and the apex. */
#include "catalogue.h"
#include "trigonometry.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPEED, ANGLE, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [SPEED] =
        {.name = "speed", .value = 10, .min = 0.1, .max = 1000, .unit = "m/s", .help = "of launch"},
    [ANGLE] = {.name = "angle",
               .value = 0.8,
               .min = 0,
               .max = 1.5,
               .unit = "rad",
               .help = "of launch, above the horizon"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

/* The apex, where a step before and after it is still in the run. */
static void expect_apex(pl_builder *builder, int body, double rise, double g)
{
    const pl_scene *scene = builder->scene;
    pl_expect_value apex = pl_expect_value_default(scene);
    apex.body = body;
    apex.quantity = PL_QUANTITY_APEX;
    apex.value = rise * rise / (2 * g);
    apex.scale = apex.value;
    const double first = rise - g * scene->dt / 2;
    apex.discrete = first * first / (2 * g);
    if (rise > 2 * g * scene->dt && rise / g + 2 * scene->dt < apex.until) {
        pl_build_value(builder, &apex);
    }
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_projectile.name, values[DT], values[DURATION], 0, error);
    const double u = values[SPEED] * pl_cosine(values[ANGLE]);
    const double w = values[SPEED] * pl_sine(values[ANGLE]), g = -scene->gravity[2];
    const double steps = (double)pl_scene_steps(scene), t = steps * scene->dt;
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(0.1);
    ball.velocity[0] = u;
    ball.velocity[2] = w;
    const int index = pl_build_body(&builder, &ball, "ball");
    pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_x, pl_exactly(u * t), u * t);
    pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_z,
                    pl_uniform_way(w, -g, scene->dt, steps), w * t + g * t * t / 2);
    expect_apex(&builder, index, w, g);
    pl_build_judge(&builder, pl_scenario_projectile.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_projectile = {
    .name = "projectile",
    .title = "Thrown ball",
    .description = "A sphere thrown at an angle: how far and how high it flies. An engine that "
                   "damps velocities falls short.",
    .reference = "x = u t, z = w t - g t^2 / 2, apex w^2 / (2 g); of semi-implicit Euler "
                 "z_n = w n h - g h^2 n (n + 1) / 2, apex (w - g h / 2)^2 / (2 g)",
    .expected = "ok: place at the end and apex are those of the reference",
    .source = "Galilei 1638, Discorsi, fourth day; the discrete form: the sum of h v_k",
    .primary_error = "value_error",
    .validity = "the apex: where it comes within the run",
    .needs = PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
