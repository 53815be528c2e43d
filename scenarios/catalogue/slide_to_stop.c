/* A block that slides over a level floor until friction stops it.
 *
 * The block of slope.h starts at rest but for v0, level, at `azimuth` from x towards y; its sides
 * stay along x and y, so that its corners lead it differently at every azimuth. Coulomb's friction
 * brakes it by a = friction g along its path, whatever the azimuth and however the weight is spread
 * over its base, since all points slide the same way. With t the smaller of the duration and v0 /
 * a: continuous:           s = v0 t - a t^2 / 2, which is v0^2 / (2 friction g) once it has stopped
 *   semi-implicit Euler:  v_k = v0 - k a h while that is above 0, s_n = n v0 h - a h^2 n (n + 1) /
 * 2
 *
 * Valid while the block stays flat. The weight acts on the floor friction * half height ahead of
 * the centre, along the path, for the moment of the friction about the centre of mass asks that. It
 * is inside of the base, half width hb, at every azimuth iff friction * half height < hb: the range
 * of the parameter friction sees to it. Then the moment about the vertical is zero too: the path is
 * straight, and the block does not turn. */
#include "catalogue.h"
#include "slope.h"
#include "trigonometry.h"

#include <math.h>

enum { SPEED, AZIMUTH, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 5,
               .min = 1e-3,
               .max = 100,
               .unit = "m/s",
               .help = "of the block at the start"},
    [AZIMUTH] = {.name = "azimuth",
                 .value = 30,
                 .min = 0,
                 .max = 90,
                 .unit = "deg",
                 .help = "of its path, from x towards y"},
    [FRICTION] = PL_PARAM_SLOPE_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(3),
};

/* The sum of h v_k over the steps that end in motion; NAN where there is none. */
static double discrete_distance(double speed, double braking, double dt, double steps)
{
    double moving = fmin(steps, floor(speed / (braking * dt)));
    double distance = moving * speed * dt - braking * dt * dt * moving * (moving + 1) / 2;
    return distance > 0 ? distance : (double)NAN;
}

static pl_expect_travel expected_travel(const pl_scene *scene, double speed, int block)
{
    double braking = scene->materials[0].friction * -scene->gravity[2];
    double steps = (double)pl_scene_steps(scene);
    double time = fmin(steps * scene->dt, speed / braking);
    return (pl_expect_travel){.body = block,
                              .distance = speed * time - braking * time * time / 2,
                              .discrete = discrete_distance(speed, braking, scene->dt, steps)};
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const pl_slope level = pl_slope_of(0, values[FRICTION]);
    const double speed = values[SPEED];
    pl_builder builder = pl_build_begin(scene, pl_scenario_slide_to_stop.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    double direction[3], velocity[3];
    pl_azimuth(values[AZIMUTH], direction);
    for (int i = 0; i < 3; i++) {
        velocity[i] = speed * direction[i];
    }
    int block = pl_build_slope(&builder, &level, velocity);
    if (builder.status == PL_OK) {
        pl_expect_travel travel = expected_travel(scene, speed, block);
        for (int i = 0; i < 3; i++) {
            travel.direction[i] = direction[i];
        }
        pl_build_travel(&builder, &travel);
    }
    pl_build_judge(&builder, pl_scenario_slide_to_stop.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_slide_to_stop = {
    .name = "slide-to-stop",
    .title = "Block that friction stops",
    .description =
        "A block pushed off over a level floor, at any azimuth: whether friction takes the right "
        "distance to stop it, the same in all directions, along a straight path.",
    .reference = "s = v0^2 / (2 friction g) along the azimuth, while friction < half width / half "
                 "height = 2, so that it does not tip",
    .expected =
        "ok: the block stops at the distance of the reference, straight ahead and not turned",
    .source = "Coulomb's law and uniform deceleration; the condition: moments about the centre of "
              "mass",
    .primary_error = "travel_error",
    .validity = "speed well above friction g dt, which a step takes from it",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
