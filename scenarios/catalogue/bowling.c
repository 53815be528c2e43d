/* A sphere thrown along a level floor skids until it rolls.
 *
 * With v along x, w the spin about y, s = v - r w the slip of the lowest point, and I = 2/5 m r^2,
 * Coulomb's friction changes v by -sign(s) mu g and r w by 5/2 sign(s) mu g, so that s loses
 * 7/2 mu g and 5 v + 2 r w stays what it is:
 *   t_s = 2 |s0| / (7 mu g),  v = r w = (5 v0 + 2 r w0) / 7 from then on,
 *   x = v0 t_s - sign(s0) mu g t_s^2 / 2 + v (t - t_s).
 * Without spin v = 5/7 v0, t_s = 2 v0 / (7 mu g), and 12 v0^2 / (49 mu g) is the way until it
 * rolls. Semi-implicit Euler skids for floor(t_s / h) whole steps and rolls from the next on. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPEED, SPIN, FRICTION, DT, DURATION, PARAM_COUNT };

static const double radius = 0.1; /* m */

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 5,
               .min = 0.1,
               .max = 100,
               .unit = "m/s",
               .help = "of the throw"},
    [SPIN] = {.name = "spin",
              .value = 0,
              .min = -1000,
              .max = 1000,
              .unit = "rad/s",
              .help = "at the start, positive as in rolling; the radius is 0.1 m"},
    [FRICTION] = {.name = "friction",
                  .value = 0.2,
                  .min = 1e-3,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

static void expect(pl_builder *builder, int ball, double v0, double rim0, double friction)
{
    const pl_scene *scene = builder->scene;
    const double steps = (double)pl_scene_steps(scene), h = scene->dt, t = steps * h;
    const double slip = v0 - rim0, braking = friction * -scene->gravity[2];
    const double a = slip > 0 ? -braking : braking;
    const double skid = fmin(t, 2 * fabs(slip) / (7 * braking));
    const double skid_steps = fmin(steps, floor(2 * fabs(slip) / (7 * braking * h)));
    const bool rolls = skid < t;
    const double v = rolls ? (5 * v0 + 2 * rim0) / 7 : v0 + a * t;
    const double rim = rolls ? v : rim0 - 2.5 * a * t;
    const pl_answer way = {v0 * skid + a * skid * skid / 2 + v * (t - skid),
                           pl_uniform_way(v0, a, h, skid_steps).discrete +
                               v * h * (steps - skid_steps)};
    /* What the answers are made of, so that one of them may vanish. */
    const double speed = fmax(fabs(v), 0.1 * (v0 + fabs(rim0)));
    pl_build_at_end(builder, ball, PL_QUANTITY_POSITION, pl_axis_x, way,
                    fmax(fabs(way.continuous), speed * t));
    pl_build_at_end(builder, ball, PL_QUANTITY_VELOCITY, pl_axis_x, pl_exactly(v), speed);
    pl_build_at_end(builder, ball, PL_QUANTITY_SPIN, pl_axis_y, pl_exactly(rim / radius),
                    speed / radius);
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_bowling.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(radius);
    ball.position[2] = radius;
    ball.velocity[0] = values[SPEED];
    ball.angular_velocity[1] = values[SPIN];
    const int index = pl_build_body(&builder, &ball, "ball");
    expect(&builder, index, values[SPEED], radius * values[SPIN], values[FRICTION]);
    pl_build_judge(&builder, pl_scenario_bowling.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_bowling = {
    .name = "bowling",
    .title = "From skidding to rolling",
    .description = "A sphere thrown along the floor, with any spin, skids until it rolls: whether "
                   "friction acts in full while it slips, and not at all when it rolls.",
    .reference =
        "t_s = 2 |v0 - r w0| / (7 friction g); then v = r w = (5 v0 + 2 r w0) / 7; without "
        "spin the skid is 12 v0^2 / (49 friction g) long",
    .expected = "ok: the ball skids until it rolls; way, speed and spin are those of the reference",
    .source = "Coulomb's law and I = 2/5 m r^2; Coriolis 1835, Theorie mathematique des effets du "
              "jeu de billard",
    .primary_error = "value_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
