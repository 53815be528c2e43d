/* A small sphere in free fall: what is left of an engine when nothing touches anything.
 *
 * Up, with g = 9.81 m/s^2 and t = n h after n steps of h:
 *   continuous:           z = v0 t - g t^2 / 2,  v = v0 - g t
 *   semi-implicit Euler:  z_n = v0 n h - g h^2 n (n + 1) / 2, and the same v
 * so that the integrator's own error is told apart from any other. Errors are relative to
 * |v0| t + g t^2 / 2 and |v0| + g t, which do not vanish where the sphere comes back. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPEED, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 5,
               .min = -100,
               .max = 100,
               .unit = "m/s",
               .help = "upwards at the start"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_free_fall.name, values[DT], values[DURATION], 0, error);
    const double v = values[SPEED], g = -scene->gravity[2];
    const double steps = (double)pl_scene_steps(scene), t = steps * scene->dt;
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(0.1);
    ball.velocity[2] = v;
    const int index = pl_build_body(&builder, &ball, "ball");
    pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_z,
                    pl_uniform_way(v, -g, scene->dt, steps), fabs(v) * t + g * t * t / 2);
    pl_build_at_end(&builder, index, PL_QUANTITY_VELOCITY, pl_axis_z, pl_exactly(v - g * t),
                    fabs(v) + g * t);
    pl_build_judge(&builder, pl_scenario_free_fall.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_free_fall = {
    .name = "free-fall",
    .title = "Free fall",
    .description = "A sphere thrown straight up or down, with nothing to meet: the integrator "
                   "alone, and whether the engine damps what it should not.",
    .reference = "z = v0 t - g t^2 / 2, v = v0 - g t; of semi-implicit Euler "
                 "z_n = v0 n h - g h^2 n (n + 1) / 2",
    .expected = "ok: height and speed at the end are those of the reference",
    .source = "Galilei 1638, Discorsi, third day; the discrete form: the sum of h v_k",
    .primary_error = "value_error",
    .needs = PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
