/* Free motion of the centre of mass: falling, thrown, under thrust. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* A small sphere in free fall: it shows the integrator alone, since nothing touches anything.
 *
 * Up, with g = 9.81 m/s^2 and t = n h after n steps of h:
 *   continuous:           z = v0 t - g t^2 / 2,  v = v0 - g t
 *   semi-implicit Euler:  z_n = v0 n h - g h^2 n (n + 1) / 2, and the same v
 * so that the integrator's own error can be separated from any other. Errors are relative to
 * |v0| t + g t^2 / 2 and |v0| + g t, which do not vanish where the sphere comes back. Nothing pushes
 * the sphere to a side or turns it, so that it is expected not to move across the vertical, and not
 * to spin: by 1 rad/s the error is 1. */

enum { FREE_FALL_SPEED };

static const pl_param free_fall_params[] = {
    {"speed", 5, -100, 100, false, "m/s", "upwards at the start"},
    PL_PARAM_TIME(2),
};

static void free_fall_build(pl_builder *b, const double *values)
{
    const double v = values[FREE_FALL_SPEED], g = b->gravity;
    const double steps = b->steps, t = b->end;
    pl_body ball = pl_body_at(pl_shape_sphere(0.1), 0, 0, 0);
    ball.velocity[2] = v;
    const int index = pl_build_body(b, &ball, "ball");
    pl_build_displaced(b, index, pl_axis_z, pl_uniform_distance(v, -g, b->scene->dt, steps),
                       fabs(v) * t + g * t * t / 2);
    pl_build_at_end(b, index, PL_QUANTITY_VELOCITY, pl_axis_z, pl_exactly(v - g * t),
                    fabs(v) + g * t);
    pl_build_none(b, index, PL_QUANTITY_SPIN, PL_ALONG_ALL, 1);
}

const pl_scenario pl_scenario_free_fall = {
    .name = "free-fall",
    .title = "Free fall",
    .description = "A sphere thrown straight up or down, with nothing to meet: the integrator "
                   "alone, and whether the engine damps motion without a cause.",
    .reference = "z = v0 t - g t^2 / 2, v = v0 - g t; of semi-implicit Euler "
                 "z_n = v0 n h - g h^2 n (n + 1) / 2",
    .expected = "ok: height and speed at the end are those of the reference",
    .source = "Galilei 1638, Discorsi, third day; the discrete form: the sum of h v_k",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    PL_PARAMS(free_fall_params),
    .build = free_fall_build};

/* A small sphere thrown at an angle: range, height and apex of its parabola.
 *
 * With (u, w) = speed (cos, sin) of the angle and t = n h:
 *   continuous:           x = u t,  z = w t - g t^2 / 2,  apex w^2 / (2 g) at t = w / g
 *   semi-implicit Euler:  x_n = u t,  z_n = w t - g h^2 n (n + 1) / 2: the parabola of the speed
 *                         w - g h / 2, whose apex is (w - g h / 2)^2 / (2 g)
 * The apex is expected where it lies within the run. Errors are relative to each answer's own size:
 * u t, w t + g t^2 / 2, and the apex. It stays in its plane, y = 0 relative to u t, and does not
 * spin. */

enum { PROJECTILE_SPEED, PROJECTILE_ANGLE };

static const pl_param projectile_params[] = {
    {"speed", 10, 0.1, 1000, false, "m/s", "of launch"},
    {"angle", 0.8, 0, 1.5, false, "rad", "of launch, above the horizon"},
    PL_PARAM_TIME(2),
};

/* The apex, where a step before and after it is still in the run. */
static void expect_apex(pl_builder *b, int body, double rise, double g)
{
    const pl_scene *scene = b->scene;
    pl_expect_value apex = pl_expect_value_default(scene);
    apex.body = body;
    apex.quantity = PL_QUANTITY_APEX;
    apex.value = rise * rise / (2 * g);
    apex.scale = apex.value;
    const double first = rise - g * scene->dt / 2;
    apex.discrete = first * first / (2 * g);
    if (rise > 2 * g * scene->dt && rise / g + 2 * scene->dt < apex.until) {
        pl_build_value(b, &apex);
    }
}

static void projectile_build(pl_builder *b, const double *values)
{
    const double u = values[PROJECTILE_SPEED] * pl_cosine(values[PROJECTILE_ANGLE]);
    const double w = values[PROJECTILE_SPEED] * pl_sine(values[PROJECTILE_ANGLE]), g = b->gravity;
    const double steps = b->steps, t = b->end;
    pl_body ball = pl_body_at(pl_shape_sphere(0.1), 0, 0, 0);
    ball.velocity[0] = u;
    ball.velocity[2] = w;
    const int index = pl_build_body(b, &ball, "ball");
    pl_build_at_end(b, index, PL_QUANTITY_POSITION, pl_axis_x, pl_exactly(u * t), u * t);
    pl_build_at_end(b, index, PL_QUANTITY_POSITION, pl_axis_z,
                    pl_uniform_distance(w, -g, b->scene->dt, steps), w * t + g * t * t / 2);
    pl_build_none(b, index, PL_QUANTITY_POSITION, PL_ALONG_Y, u * t);
    pl_build_none(b, index, PL_QUANTITY_SPIN, PL_ALONG_ALL, 1);
    expect_apex(b, index, w, g);
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
    PL_ACCEPT_MOTION,
    .validity = "the apex: where it comes within the run",
    PL_PARAMS(projectile_params),
    .build = projectile_build};

/* A rocket under constant thrust in its own axes, through its centre of mass or off the axis.
 *
 * Off the axis, at `offset`, in the plane y = 0, it turns at the constant angular acceleration
 * A = thrust offset / I, so that at time t it leans by A t^2 / 2, and
 *   x = (thrust / m) int_0^t (t - s) sin(A s^2 / 2) ds,
 *   z = (thrust / m) int_0^t (t - s) cos(A s^2 / 2) ds - g t^2 / 2,
 * which are Fresnel integrals; here by Simpson's rule in 20000 intervals, which for a lean of up
 * to 5000 rad is good to 1e-8 of the distance. On the axis A = 0. */

enum { ROCKET_THRUST, ROCKET_OFFSET };

static const pl_param rocket_params[] = {
    {"thrust", 30, 0, 1e4, false, "N", "on a rocket of 1 kg, along its axis, at its bottom"},
    {"offset", 0, -0.2, 0.2, false, "m", "of the thrust from the axis"},
    PL_PARAM_TIME(2),
};

static const double half[3] = {0.2, 0.2, 1}; /* m */

static const double most_lean = 5000; /* rad, in a run */

/* The displacement in x and z, without gravity, of unit thrust over mass. */
static void fly(double angular, double time, double *x, double *z)
{
    enum { INTERVALS = 20000 }; /* even */
    double h = time / INTERVALS;
    *x = *z = 0;
    for (int i = 0; i <= INTERVALS; ++i) {
        double s = i * h, lean = fabs(angular) * s * s / 2;
        double weight = i == 0 || i == INTERVALS ? 1 : i % 2 == 1 ? 4 : 2;
        *x += weight * h / 3 * (time - s) * pl_sine_of_any(lean);
        *z += weight * h / 3 * (time - s) * pl_cosine_of_any(lean);
    }
    *x = angular < 0 ? -*x : *x;
}

/* Refuses values with which a relative error has no meaning. */
static void check(pl_builder *b, double angular, double weight, double thrust)
{
    if (fabs(angular) * b->end * b->end / 2 > most_lean) {
        pl_build_refuse(b,
                        "expected a thrust, an offset and a duration that turn it by %g rad "
                        "at most, found %g",
                        most_lean, fabs(angular) * b->end * b->end / 2);
    } else if (angular == 0 && fabs(thrust - weight) < 1e-6 * weight) {
        pl_build_refuse(b,
                        "expected a thrust other than its weight of %g N, with which it "
                        "goes nowhere, found %g",
                        weight, thrust);
    }
}

static void expect(pl_builder *b, int rocket, double thrust, double angular)
{
    const pl_scene *scene = b->scene;
    const double t = b->end;
    double x, z;
    fly(angular, t, &x, &z);
    x *= thrust / scene->bodies[rocket].mass;
    z = z * thrust / scene->bodies[rocket].mass + scene->gravity[2] * t * t / 2;
    const double distance = sqrt(x * x + z * z);
    const double direction[3] = {x / distance, 0, z / distance};
    pl_build_travel(
        b, rocket, direction,
        (pl_answer){distance, angular == 0 ? distance * (1 + 1 / b->steps) : (double)NAN});
}

static void rocket_build(pl_builder *b, const double *values)
{
    pl_body rocket = pl_body_at(pl_shape_box(half[0], half[1], half[2]), 0, 0, 0);
    const int index = pl_build_body(b, &rocket, "rocket");
    const pl_force thrust = {.body = index,
                             .force = {0, 0, values[ROCKET_THRUST]},
                             .at = {-values[ROCKET_OFFSET], 0, -half[2]},
                             .frame = PL_FRAME_BODY,
                             .until = (double)INFINITY};
    pl_build_force(b, &thrust);
    if (b->status == PL_OK) {
        const double angular =
            values[ROCKET_THRUST] * values[ROCKET_OFFSET] / b->scene->bodies[index].inertia[1];
        check(b, angular, rocket.mass * b->gravity, values[ROCKET_THRUST]);
        expect(b, index, values[ROCKET_THRUST], angular);
    }
}

const pl_scenario pl_scenario_rocket = {
    .name = "rocket",
    .title = "Rocket under thrust",
    .description =
        "A rocket propelled by a constant thrust at its bottom, in its own axes; off "
        "the axis it turns faster and faster. Figure 1 of the source paper, " PL_SOURCE_PAPER ".",
    .reference = "on the axis (thrust / m - g) t^2 / 2; off it Fresnel integrals of A t^2 / 2 "
                 "with A = thrust offset / I",
    .expected = "ok: the rocket ends where the reference puts it",
    .source = "Newton's and Euler's laws, integrated by Simpson's rule",
    .primary_error = "travel_error",
    PL_ACCEPT_MOTION,
    .validity = "a thrust other than the weight of 9.81 N, a turn of 5000 rad at most",
    PL_PARAMS(rocket_params),
    .build = rocket_build};
