/* Surfaces of triangles that are one plane: a cube that rests and one that slides on a tessellated slab,
 * and a ball that rolls over it. An edge between two triangles of one plane is no edge of the solid: each
 * moves as over a box. Engines that collide with these edges have "ghost collisions". */
#include "base/trigonometry.h"
#include "catalogue.h"
#include "solids.h"

#include <math.h>

#define PARAM_N                                                                                    \
    {                                                                                              \
        "n", 5, 0, 40, true, "1", "quads along each side of the slab's mesh; 0: a box"             \
    }

/* Adds a slab with its top at z = 0. */
static void add_slab(pl_builder *b, double x, double half_x, double half_y, int n)
{
    pl_shape shape = pl_shape_box(half_x, half_y, 0.5);
    if (n > 0) {
        pl_solid solid = pl_solid_slab(half_x, half_y, 0.5, n);
        shape = pl_build_solid(b, &solid, false, "slab");
    }
    pl_body slab = pl_body_at(shape, x, 0, -0.5);
    slab.is_static = true;
    pl_build_body(b, &slab, "slab");
}

/* A cube rests on the slab, askew. */

enum { SLAB_N, SLAB_SPEED };

static const pl_param rest_params[] = {
    PARAM_N,
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void rest_build(pl_builder *b, const double *values)
{
    add_slab(b, 0, 5, 5, (int)values[SLAB_N]);
    pl_body cube = pl_body_at(pl_shape_box(0.5, 0.5, 0.5), 0.13, 0.27, 0.5);
    cube.mass = 1000;
    pl_turn_about_axis(&cube, 2, 0.3);
    pl_build_rest(b, pl_build_body(b, &cube, "cube"));
    b->scene->collapse_distance = 0.5;
}

const pl_scenario pl_scenario_tessellated_rest = {
    .name = "tessellated-rest",
    .title = "Cube at rest on a tessellated slab",
    .description = "A cube stands askew on a slab whose top is a plane of many triangles: whether "
                   "their edges move it.",
    .reference = "at rest where it starts",
    .expected = "ok: the cube stays where it is",
    .source = "statics; scene after Erleben 2018, Methodology for assessing mesh-based contact "
              "point methods, ACM Transactions on Graphics 37(3)",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(rest_params),
    .build = rest_build};

/* A cube slides over the slab until friction stops it, v^2 / (2 friction g), askew. */

static const double slide_half_length = 60,
                    slide_start = 5; /* m; the start is from the slab's end */

static const pl_param slide_params[] = {
    PARAM_N,
    {"speed", 10, 0.1, 10, false, "m/s", "of the cube at the start"},
    {"friction", 0.05, 0, 0.6, false, "1",
     "Coulomb coefficient; below that at which the cube tips"},
    PL_PARAM_STEP(0.01),
    PL_PARAM_DURATION(22),
};

static void slide_build(pl_builder *b, const double *values)
{
    const double v = values[SLAB_SPEED], a = b->scene->materials[0].friction * b->gravity;
    const double until = fmin(b->end, (2 * slide_half_length - 2 * slide_start) / v);
    const double moving = a > 0 ? fmin(b->end, v / a) : until;
    add_slab(b, slide_half_length - slide_start, slide_half_length, 3, (int)values[SLAB_N]);
    pl_body cube = pl_body_at(pl_shape_box(0.5, 0.5, 0.5), 0, 0.13, 0.5);
    cube.mass = 1000;
    cube.velocity[0] = v;
    pl_turn_about_axis(&cube, 2, 0.2);
    const pl_straight path = {.along = pl_axis_x,
                              .up = pl_axis_z,
                              .distance = v * moving - a * moving * moving / 2,
                              .until = a > 0 ? b->end : until,
                              .size = 1};
    pl_build_straight(b, pl_build_body(b, &cube, "cube"), &path);
}

const pl_scenario pl_scenario_tessellated_slide = {
    .name = "tessellated-slide",
    .title = "Cube that slides over a tessellated slab",
    .description = "A cube slides askew over a slab whose top is a plane of many triangles, until "
                   "friction stops it: whether it meets their edges.",
    .reference = "v^2 / (2 friction g) straight on, no rise, no turn: as over a box",
    .expected = "ok: the cube slides 102 m as if over a box",
    .source = "Coulomb's law; an edge between triangles of one plane is no edge of the solid",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "the slab of 120 m, which a speed of 10 m/s leaves if friction is below 0.045",
    PL_PARAMS(slide_params),
    .build = slide_build};

/* A ball rolls over the slab. */

static const pl_param roll_params[] = {
    PARAM_N,
    {"speed", 10, 0.1, 20, false, "m/s", "of the ball"},
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.01),
    PL_PARAM_DURATION(5),
};

static void roll_build(pl_builder *b, const double *values)
{
    const double r = 0.5, v = values[SLAB_SPEED];
    const double until = fmin(b->end, (2 * slide_half_length - 2 * slide_start) / v);
    add_slab(b, slide_half_length - slide_start, slide_half_length, 3, (int)values[SLAB_N]);
    pl_body ball = pl_body_at(pl_shape_sphere(r), 0, 0.13, r);
    ball.velocity[0] = v;
    ball.angular_velocity[1] = v / r;
    const int index = pl_build_body(b, &ball, "ball");
    pl_expect_value found[] = {
        pl_value_within(b, index, PL_QUANTITY_POSITION, pl_axis_x, v * until, 0.06 * v * until),
        pl_value_within(b, index, PL_QUANTITY_POSITION, pl_axis_y, 0, 0.02 * r),
        pl_value_within(b, index, PL_QUANTITY_APEX, pl_axis_z, 0, 0.02 * r),
        pl_value_within(b, index, PL_QUANTITY_SPIN, pl_axis_y, v / r, 0.06 * v / r),
    };
    found[2].bound = PL_BOUND_AT_MOST;
    for (int i = 0; i < 4; ++i) {
        found[i].until = until;
        pl_build_value(b, &found[i]);
    }
}

const pl_scenario pl_scenario_tessellated_roll = {
    .name = "tessellated-roll",
    .title = "Ball that rolls over a tessellated slab",
    .description = "A ball rolls over a slab whose top is a plane of many triangles: whether it "
                   "meets their edges.",
    .reference = "velocity and spin constant, straight on, no rise: as over a box",
    .expected = "ok: the ball rolls on at its speed as if over a box",
    .source =
        "rolling without slip; an edge between triangles of one plane is no edge of the solid",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "the slab, of 120 m",
    PL_PARAMS(roll_params),
    .build = roll_build};
