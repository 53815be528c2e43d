/* A spinning sphere strikes a floor obliquely, without gravity.
 *
 * With v along the floor (x), n the speed into it, w the spin about y, s = v - r w the slip of the
 * lowest point and I = 2/5 m r^2: the normal impulse is m (1 + e) n, and the friction J along x
 * changes v by J / m, r w by -5/2 J / m and so s by 7/2 J / m. It stops the slip, J = -2/7 m s, iff
 * that is within the cone, |s| <= 7/2 mu (1 + e) n:
 *   sticks:  v' = r w' = (5 v + 2 r w) / 7
 *   slides:  v' = v - sign(s) mu (1 + e) n,  r w' = r w + 5/2 sign(s) mu (1 + e) n
 * and e n is the speed away from the floor. Errors are relative to the speed of the impact. */
#include "catalogue.h"
#include "trigonometry.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPEED, ANGLE, SPIN, FRICTION, RESTITUTION, DT, DURATION, PARAM_COUNT };

static const double radius = 0.1; /* m */
static const double gap = 0.5;    /* m, to the floor at the start */

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 5,
               .min = 0.1,
               .max = 1000,
               .unit = "m/s",
               .help = "of the sphere"},
    [ANGLE] = {.name = "angle",
               .value = 0.8,
               .min = 0,
               .max = 1.4,
               .unit = "rad",
               .help = "of its path from the floor's normal"},
    [SPIN] = {.name = "spin",
              .value = 20,
              .min = -1000,
              .max = 1000,
              .unit = "rad/s",
              .help = "positive as in rolling on; the radius is 0.1 m"},
    [FRICTION] = {.name = "friction",
                  .value = 0.1,
                  .min = 0,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient"},
    [RESTITUTION] = PL_PARAM_RESTITUTION(0.8),
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(0.5),
};

typedef struct motion {
    double along, up, rim; /* m/s: v, speed from the floor, r w */
} motion;

static motion reflect(motion before, double friction, double e)
{
    const double slip = before.along - before.rim, into = -before.up;
    const double most = friction * (1 + e) * into;
    motion after = {.up = e * into};
    if (fabs(slip) <= 3.5 * most) {
        after.along = after.rim = (5 * before.along + 2 * before.rim) / 7;
    } else {
        const double change = slip > 0 ? most : -most;
        after.along = before.along - change;
        after.rim = before.rim + 2.5 * change;
    }
    return after;
}

static void expect(pl_builder *builder, int ball, motion m, double speed)
{
    pl_build_at_end(builder, ball, PL_QUANTITY_VELOCITY, pl_axis_x, pl_exactly(m.along), speed);
    pl_build_at_end(builder, ball, PL_QUANTITY_VELOCITY, pl_axis_z, pl_exactly(m.up), speed);
    pl_build_at_end(builder, ball, PL_QUANTITY_SPIN, pl_axis_y, pl_exactly(m.rim / radius),
                    speed / radius);
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_oblique_impact.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    scene->gravity[2] = 0;
    if (builder.status == PL_OK) {
        scene->materials[0].restitution = values[RESTITUTION];
    }
    pl_build_floor(&builder, 0, 0, 1, 0);
    motion m = {.along = values[SPEED] * pl_sine(values[ANGLE]),
                .up = -values[SPEED] * pl_cosine(values[ANGLE]),
                .rim = radius * values[SPIN]};
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(radius);
    ball.position[2] = radius + gap;
    ball.velocity[0] = m.along;
    ball.velocity[2] = m.up;
    ball.angular_velocity[1] = values[SPIN];
    const int index = pl_build_body(&builder, &ball, "ball");
    if (gap < -m.up * (double)pl_scene_steps(scene) * scene->dt) {
        m = reflect(m, values[FRICTION], values[RESTITUTION]);
    }
    expect(&builder, index, m, values[SPEED]);
    pl_build_judge(&builder, pl_scenario_oblique_impact.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_oblique_impact = {
    .name = "oblique-impact",
    .title = "Oblique impact of a spinning ball",
    .description = "A spinning sphere strikes the floor at an angle, without gravity: whether "
                   "friction stops its slip or reaches Coulomb's bound, and the spin that it "
                   "leaves with.",
    .reference = "with s = v - r w and c = friction (1 + e) v_n: sticks iff |s| <= 7/2 c, "
                 "v' = r w' = (5 v + 2 r w) / 7; else v' = v - sign(s) c, "
                 "r w' = r w + 5/2 sign(s) c; v_n' = e v_n",
    .expected = "ok: the ball leaves with the velocity and the spin of the reference",
    .source =
        "Coulomb's cone and Newton's restitution in the impulse on a solid sphere, as in "
        "Routh 1905, The Elementary Part of a Treatise on the Dynamics of a System of Rigid Bodies",
    .primary_error = "value_error",
    .validity = "the slip does not turn round in the impact, which it never does for a sphere",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE |
             PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
