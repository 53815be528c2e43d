/* Scenes of other comparisons of engines: 216 balls (SimBenchmark's 666), falling and elastic, and a tower
 * of planks. */
#include "catalogue.h"

#include <math.h>

/* ---- 666 ---- */

/* 6 x 6 x 6 balls without friction, almost in a grid, fall and flow apart. No single motion is right. Balls
 * that do not bounce are judged by their overlap, elastic ones by their energy. */

enum { BALLS_SIDE };

static const double ball_radius = 0.1, ball_mass = 10, ball_spacing = 0.21; /* m, kg, m */

static const pl_param balls_params[] = {
    {"n", 6, 1, 20, true, "1", "balls along each edge of the grid"},
    PL_PARAM_STEP(0.001),
    PL_PARAM_DURATION(1),
};

/* Expects that the ball has fallen from rest by this height: one that hangs in the air is off. */
static void expect_fall(pl_builder *b, int ball, double height)
{
    const double speed = sqrt(2 * b->gravity * height);
    if (b->end > speed / b->gravity) {
        pl_expect_value value =
            pl_value_within(b, ball, PL_QUANTITY_TOP_SPEED, pl_axis_z, speed, 0.06 * speed);
        value.bound = PL_BOUND_AT_LEAST;
        pl_build_value(b, &value);
    }
}

/* `lowest` is the height of the lowest centres. Returns the index of the first ball. */
static int add_balls(pl_builder *b, int n, double lowest)
{
    const double off = 1e-3; /* m: out of the grid */
    pl_build_floor(b);
    for (int i = 0; i < n * n * n; ++i) {
        const double x = pl_draw_uniform(&b->random, -off, off);
        const double y = pl_draw_uniform(&b->random, -off, off);
        const int column = i % n, row = i / n % n, layer = i / (n * n);
        pl_body ball = pl_body_at(pl_shape_sphere(ball_radius), ball_spacing * column + x,
                                  ball_spacing * row + y, lowest + ball_spacing * layer);
        ball.mass = ball_mass;
        pl_build_body(b, &ball, "ball %d", i);
    }
    return b->scene->body_count - n * n * n;
}

static void balls_build(pl_builder *b, const double *values)
{
    const int n = (int)values[BALLS_SIDE];
    const double gap = ball_spacing - 2 * ball_radius, fall = 0.001; /* m */
    const int first = add_balls(b, n, ball_radius + fall);
    /* All fall together, and those below stop first: a gap for each layer below the highest ball. */
    expect_fall(b, first + n * n * n - 1, fall + (n - 1) * gap);
}

const pl_scenario pl_scenario_balls_666 = {
    .name = "balls-666",
    .title = "666: a grid of balls that flows apart",
    .description = "216 balls without friction, almost in a grid, fall by 1 mm and flow apart: how "
                   "deep they overlap.",
    .reference = "no overlap at any time",
    .expected = "ok: the balls flow apart and do not overlap",
    .source = "impenetrability; scene after Kang and Hwangbo 2018, SimBenchmark, \"666\"",
    .primary_error = "penetration_max",
    .acceptance = 0.002,
    .acceptance_reason = "1 % of the diameter of 0.2 m: an overlap that can be seen",
    PL_PARAMS(balls_params),
    .build = balls_build};

static void elastic_build(pl_builder *b, const double *values)
{
    b->scene->materials[0].restitution = 1;
    const double fall = 1.001; /* m */
    expect_fall(b, add_balls(b, (int)values[BALLS_SIDE], ball_radius + fall), fall);
}

const pl_scenario pl_scenario_elastic_666 = {
    .name = "elastic-666",
    .title = "666, elastic",
    .description = "216 elastic balls, almost in a grid, fall by 1 m: whether their impacts add "
                   "energy.",
    .reference = "no gain of energy",
    .expected = "ok: the balls bounce apart and gain no energy",
    .source = "conservation of energy; scene after Kang and Hwangbo 2018, SimBenchmark, "
              "\"elastic 666\"",
    .primary_error = "energy_gain",
    .acceptance = 0.01,
    .acceptance_reason = "1 % of the energy: the bound of all scenes that are judged by it",
    PL_PARAMS(balls_params),
    .build = elastic_build};

/* ---- Planks ---- */

/* A tower of planks in layers of 8, by turns along y and along x, each layer without gaps: every plank
 * rests on planks whose tops are level. Everything stays. */

enum { KAPLA_FLOORS };

static const double plank[3] = {0.1, 0.025,
                                0.05}; /* m: half the length, the width and the height */

static const pl_param kapla_params[] = {
    {"floors", 6, 1, 50, true, "1", "of two layers of 8 planks"},
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.01),
    PL_PARAM_DURATION(5),
};

/* Eight planks at the height z. Along y they lie in one row, along x in four rows of two. */
static void add_layer(pl_builder *b, int layer, bool along_x)
{
    const double z = plank[2] * (2 * layer + 1);
    for (int i = 0; i < 8; ++i) {
        const int column = i % 2, row = i / 2; /* of a layer along x */
        pl_body body = along_x
                           ? pl_body_at(pl_shape_box(plank[0], plank[1], plank[2]),
                                        plank[0] * (2 * column - 1), plank[1] * (2 * row - 3), z)
                           : pl_body_at(pl_shape_box(plank[1], plank[0], plank[2]),
                                        plank[1] * (2 * i - 7), 0, z);
        body.mass = 10;
        const int index = pl_build_body(b, &body, "plank %d.%d", layer + 1, i + 1);
        pl_build_rest_within(b, index, 0.2);
    }
}

static void kapla_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    for (int layer = 0; layer < 2 * (int)values[KAPLA_FLOORS]; ++layer) {
        add_layer(b, layer, layer % 2 == 1);
    }
    b->scene->collapse_distance = plank[2];
}

const pl_scenario pl_scenario_kapla = {
    .name = "kapla",
    .title = "Tower of planks",
    .description = "96 planks in twelve layers, by turns along and across, without gaps: whether "
                   "the tower stands, and how much it creeps.",
    .reference = "every plank stays where it is",
    .expected = "ok: the tower stands where it was built",
    .source = "statics; after Kang and Hwangbo 2018, SimBenchmark, \"Kapla\", here without gaps",
    .primary_error = "rest_position_error",
    .acceptance = 0.002,
    .acceptance_reason = "1 % of a plank of 0.2 m: an offset that can be seen; of a turn, 0.01 rad",
    PL_PARAMS(kapla_params),
    .build = kapla_build};
