/* A wide box that carries k x k balls on its top is pushed along the floor.
 *
 * With M the box, m a ball, n = k^2 and f1 = mu (M + n m) g the friction of the floor: a ball that
 * rolls without slip on a top of acceleration a gets a force f2 with f2 / m + f2 r^2 / I = a, that
 * is f2 = m a / (1 + 5/2) = 2/7 m a, and pushes the top back by as much, so that
 *   a_box = (F - f1) / (M + 2/7 n m),  a_ball = 2/7 a_box,  r w = 5/7 a_box t backwards.
 * (In another form f2 = ((F - f1) / M) / (3.5 / m + n / M), a_box = (F - f1 - n f2) / M.)
 *
 * Valid while the balls stick, a_box <= 7/2 mu_ball g, while none has rolled to the edge,
 * 5/7 a_box t^2 / 2, and while the box stays flat: about its centre the push has no moment, the
 * floor's friction f1 H, the balls' n f2 H, with H half its height, and the balls that lag by d
 * n m g d; all together less than the weight (M + n m) g times half the width. */
#include "catalogue.h"
#include "trigonometry.h"
#include "uniform_motion.h"

#include <math.h>
#include <string.h>

enum { ROWS, PUSH, AZIMUTH, FRICTION, DT, DURATION, PARAM_COUNT };

static const double half_width = 2, half_height = 0.1, box_mass = 10;
static const double radius = 0.1, ball_mass = 1, spacing = 0.25;
static const double ball_friction = 0.8;

static const pl_param params[PARAM_COUNT] = {
    [ROWS] = {.name = "rows",
              .value = 3,
              .min = 1,
              .max = 5,
              .integer = true,
              .unit = "1",
              .help = "of balls, and balls in a row; each has 1 kg, the box 10 kg"},
    [PUSH] = {.name = "push",
              .value = 50,
              .min = 1,
              .max = 300,
              .unit = "N",
              .help = "on the box, from the start"},
    [AZIMUTH] =
        {.name = "azimuth", .value = 45, .min = 0, .max = 90, .unit = "deg", .help = "of the push"},
    [FRICTION] = {.name = "friction",
                  .value = 0.1,
                  .min = 0,
                  .max = 0.5,
                  .unit = "1",
                  .help = "Coulomb coefficient of the floor; that of the balls is 0.8"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(1),
};

/* Of the box, m/s^2; the time is over when it is wrong. */
typedef struct carriage {
    double acceleration, time;
} carriage;

static pl_status check(const carriage *c, double weight, double floor_friction, int rows, double g,
                       pl_error *error)
{
    const double lag = 5.0 / 14 * c->acceleration * c->time * c->time;
    const double balls = ball_mass * rows * rows;
    const double moment =
        half_height * (floor_friction + balls * 2 / 7 * c->acceleration) + balls * g * lag;
    if (!(c->acceleration > 0)) {
        return pl_fail(error, PL_BAD_INPUT,
                       "carried-balls: expected a push of more than the floor's friction of %g N",
                       floor_friction);
    }
    if (lag + spacing * (rows - 1) / 2 > 0.95 * half_width || moment > 0.9 * weight * half_width ||
        c->acceleration > 3.5 * ball_friction * g) {
        return pl_fail(error, PL_BAD_INPUT,
                       "carried-balls: expected a push and a duration in which the balls stay on "
                       "the box, found that they slip or lag by %g m at %g m/s^2",
                       lag, c->acceleration);
    }
    return PL_OK;
}

static void add_materials(pl_builder *builder)
{
    int ball = 0;
    const pl_material material = {.name = "ball", .friction = ball_friction};
    if (builder->status == PL_OK) {
        builder->status = pl_scene_add_material(builder->scene, &material, &ball, builder->error);
    }
    const pl_material_pair pair = {.material_a = 0, .material_b = ball, .friction = ball_friction};
    if (builder->status == PL_OK) {
        builder->status = pl_scene_add_pair(builder->scene, &pair, builder->error);
    }
}

static void expect(pl_builder *builder, int body, const double direction[3], double acceleration)
{
    const pl_scene *scene = builder->scene;
    const pl_answer way = pl_uniform_way(0, acceleration, scene->dt, (double)pl_scene_steps(scene));
    pl_build_at_end(builder, body, PL_QUANTITY_POSITION, direction, way, way.continuous);
}

static void build_balls(pl_builder *builder, int rows, const double direction[3], double a,
                        double time)
{
    const double axis[3] = {-direction[1], direction[0], 0};
    const double spin = -5.0 / 7 * a * time / radius;
    for (int i = 0; i < rows * rows; i++) {
        pl_body ball = pl_body_default();
        ball.shape = pl_shape_sphere(radius);
        ball.mass = ball_mass;
        ball.material = 1;
        ball.position[0] = spacing * (i % rows - (rows - 1) / 2.0);
        ball.position[1] = spacing * (i / rows - (rows - 1) / 2.0);
        ball.position[2] = 2 * half_height + radius;
        const int index = pl_build_body(builder, &ball, "ball %d", i + 1);
        expect(builder, index, direction, a * 2 / 7);
        pl_build_at_end(builder, index, PL_QUANTITY_SPIN, axis, pl_exactly(spin), -spin);
    }
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_carried_balls.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    const int rows = (int)values[ROWS];
    const double g = -scene->gravity[2], balls = ball_mass * rows * rows;
    const double weight = (box_mass + balls) * g, braking = values[FRICTION] * weight;
    const carriage c = {.acceleration = (values[PUSH] - braking) / (box_mass + balls * 2 / 7),
                        .time = (double)pl_scene_steps(scene) * scene->dt};
    if (builder.status == PL_OK) {
        builder.status = check(&c, weight, braking, rows, g, error);
    }
    double direction[3];
    pl_azimuth(values[AZIMUTH], direction);
    add_materials(&builder);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body box = pl_body_default();
    box.shape = pl_shape_box(half_width, half_width, half_height);
    box.mass = box_mass;
    box.position[2] = half_height;
    const int index = pl_build_body(&builder, &box, "box");
    if (builder.status == PL_OK) {
        pl_force push = {.body = index, .frame = PL_FRAME_WORLD, .until = (double)INFINITY};
        for (int k = 0; k < 3; k++) {
            push.force[k] = values[PUSH] * direction[k];
        }
        builder.status = pl_scene_add_force(scene, &push, error);
    }
    expect(&builder, index, direction, c.acceleration);
    build_balls(&builder, rows, direction, c.acceleration, c.time);
    pl_build_judge(&builder, pl_scenario_carried_balls.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_carried_balls = {
    .name = "carried-balls",
    .title = "Pushed box that carries balls",
    .description = "A box pushed over the floor, at any azimuth, carries balls that roll back on "
                   "its top: sliding and rolling friction in one island, in each its own.",
    .reference = "a_box = (F - friction (M + n m) g) / (M + 2/7 n m), a_ball = 2/7 a_box, while "
                 "the balls stick and stay on the box",
    .expected = "ok: box and balls go as far as the reference says; no ball slips or falls off",
    .source = "Newton's and Euler's laws with I = 2/5 m r^2; the scene after the rolling test of "
              "SimBenchmark (Kang and Hwangbo 2018)",
    .primary_error = "value_error",
    .validity = "the balls neither slip, 7/2 of their friction times g, nor reach the edge",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES | PL_NEEDS_PLANE |
             PL_NEEDS_SPHERE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
