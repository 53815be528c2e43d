/* A rocket under constant thrust in its own axes, through its centre of mass or beside it.
 *
 * Beside it, at `offset`, in the plane y = 0, it turns at the constant angular acceleration
 * A = thrust offset / I, so that at time t it leans by A t^2 / 2, and
 *   x = (thrust / m) int_0^t (t - s) sin(A s^2 / 2) ds,
 *   z = (thrust / m) int_0^t (t - s) cos(A s^2 / 2) ds - g t^2 / 2,
 * which are Fresnel integrals; here by Simpson's rule in 20000 intervals, which for a lean of up
 * to 5000 rad is good to 1e-8 of the way. On the axis A = 0. */
#include "catalogue.h"
#include "scene_builder.h"
#include "trigonometry.h"

#include <math.h>
#include <string.h>

enum { THRUST, OFFSET, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [THRUST] = {.name = "thrust",
                .value = 30,
                .min = 0,
                .max = 1e4,
                .unit = "N",
                .help = "on a rocket of 1 kg, along its axis, at its bottom"},
    [OFFSET] = {.name = "offset",
                .value = 0,
                .min = -0.2,
                .max = 0.2,
                .unit = "m",
                .help = "of the thrust from the axis"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

static const double half[3] = {0.2, 0.2, 1}; /* m */

static const double most_lean = 5000; /* rad, in a run */

/* The way in x and z, without gravity, of unit thrust over mass. */
static void fly(double angular, double time, double *x, double *z)
{
    enum { INTERVALS = 20000 }; /* even */
    double h = time / INTERVALS;
    *x = *z = 0;
    for (int i = 0; i <= INTERVALS; i++) {
        double s = i * h, lean = fabs(angular) * s * s / 2;
        double weight = i == 0 || i == INTERVALS ? 1 : i % 2 == 1 ? 4 : 2;
        *x += weight * h / 3 * (time - s) * pl_sine_of_any(lean);
        *z += weight * h / 3 * (time - s) * pl_cosine_of_any(lean);
    }
    *x = angular < 0 ? -*x : *x;
}

/* An error in the way says nothing where there is none. */
static pl_status check(double angular, double time, double weight, double thrust, pl_error *error)
{
    if (fabs(angular) * time * time / 2 > most_lean) {
        return pl_fail(error, PL_BAD_INPUT,
                       "rocket: expected a thrust, an offset and a duration that turn it by %g rad "
                       "at most, found %g",
                       most_lean, fabs(angular) * time * time / 2);
    }
    if (angular == 0 && fabs(thrust - weight) < 1e-6 * weight) {
        return pl_fail(error, PL_BAD_INPUT,
                       "rocket: expected a thrust other than its weight of %g N, with which it "
                       "goes nowhere, found %g",
                       weight, thrust);
    }
    return PL_OK;
}

static void expect(pl_builder *builder, int rocket, double thrust, double angular)
{
    const pl_scene *scene = builder->scene;
    const double steps = (double)pl_scene_steps(scene), t = steps * scene->dt;
    double x, z;
    fly(angular, t, &x, &z);
    x *= thrust / scene->bodies[rocket].mass;
    z = z * thrust / scene->bodies[rocket].mass + scene->gravity[2] * t * t / 2;
    const double distance = sqrt(x * x + z * z);
    const pl_expect_travel travel = {.body = rocket,
                                     .direction = {x / distance, 0, z / distance},
                                     .distance = distance,
                                     .discrete =
                                         angular == 0 ? distance * (1 + 1 / steps) : (double)NAN};
    pl_build_travel(builder, &travel);
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_rocket.name, values[DT], values[DURATION], 0, error);
    pl_body rocket = pl_body_default();
    rocket.shape = pl_shape_box(half[0], half[1], half[2]);
    const int index = pl_build_body(&builder, &rocket, "rocket");
    if (builder.status == PL_OK) {
        const pl_force thrust = {.body = index,
                                 .force = {0, 0, values[THRUST]},
                                 .at = {-values[OFFSET], 0, -half[2]},
                                 .frame = PL_FRAME_BODY,
                                 .until = (double)INFINITY};
        builder.status = pl_scene_add_force(scene, &thrust, error);
    }
    if (builder.status == PL_OK) {
        const double angular = values[THRUST] * values[OFFSET] / scene->bodies[index].inertia[1];
        const double time = (double)pl_scene_steps(scene) * scene->dt;
        builder.status =
            check(angular, time, rocket.mass * -scene->gravity[2], values[THRUST], error);
        if (builder.status == PL_OK) {
            expect(&builder, index, values[THRUST], angular);
        }
    }
    pl_build_judge(&builder, pl_scenario_rocket.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_rocket = {
    .name = "rocket",
    .title = "Rocket under thrust",
    .description =
        "A rocket propelled by a constant thrust at its bottom, in its own axes; beside "
        "the axis it turns faster and faster. Figure 1 of the source paper, " PL_SOURCE_PAPER ".",
    .reference = "on the axis (thrust / m - g) t^2 / 2; beside it Fresnel integrals of A t^2 / 2 "
                 "with A = thrust offset / I",
    .expected = "ok: the rocket ends where the reference puts it",
    .source = "Newton's and Euler's laws, integrated by Simpson's rule",
    .primary_error = "travel_error",
    .validity = "a thrust other than the weight of 9.81 N, a turn of 5000 rad at most",
    .needs = PL_NEEDS_ROTATION | PL_NEEDS_FORCES | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
