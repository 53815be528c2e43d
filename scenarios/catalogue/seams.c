/* Bodies on others that end beside or under them: slides and falls along rows of flush bodies, two bodies
 * that pass each other, and a cube that bounces on a pedestal smaller than itself. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* A cube that slides over a row of flush tiles.
 *
 * The tops of the tiles lie in one plane, so that the cube moves as over one body: friction brakes it
 * by a = friction g along its path, and after the time t, the smaller of the duration and v0 / a, it is
 * at v0 t - a t^2 / 2. It neither rises nor turns: friction is along the path at every point, and the
 * weight acts friction * half height ahead of the centre, within the base for friction < 1 where the
 * sides are along the path, and for less than 1 / sqrt(2) at 45 degrees. A tile is twice as long as the
 * cube, which moves from seam to seam at another phase of the step each time. */

enum { SEAMS_SPEED, SEAMS_YAW, SEAMS_GAP, SEAMS_JOINED, SEAMS_FRICTION };

static const double half = 0.25; /* m, of the cube */

static const pl_param seams_params[] = {
    {"speed", 2, 0.1, 20, false, "m/s", "of the cube at the start"},
    {"yaw", 0, 0, 45, false, "deg", "of its sides against the path"},
    {"gap", 0, 0, 0.01, false, "m", "between tiles"},
    {"joined", 0, 0, 1, true, "1", "1: one body as long as the row in place of the tiles"},
    {"friction", 0, 0, 0.7, false, "1", "Coulomb coefficient; below that at which the cube tips"},
    PL_PARAM_TIME(4),
};

static void seams_build(pl_builder *b, const double *values)
{
    const double speed = values[SEAMS_SPEED], pitch = 4 * half + values[SEAMS_GAP];
    const double braking = b->scene->materials[0].friction * b->gravity;
    const pl_answer distance = braking > 0
                                   ? pl_braking_distance(speed, braking, b->scene->dt, b->steps)
                                   : pl_uniform_distance(speed, 0, b->scene->dt, b->steps);
    const double reach = speed * b->end + 4 * half;
    const int count = (int)ceil((reach + 2 * half) / pitch) + 1;
    if (values[SEAMS_JOINED] != 0) {
        pl_body row = pl_body_at(pl_shape_box(2 * half + (count - 1) * pitch / 2, 4 * half, half),
                                 (count - 1) * pitch / 2, 0, -half);
        row.is_static = true;
        pl_build_body(b, &row, "row");
    }
    for (int i = 0; i < count && values[SEAMS_JOINED] == 0; ++i) {
        pl_body tile = pl_body_at(pl_shape_box(2 * half, 4 * half, half), i * pitch, 0, -half);
        tile.is_static = true;
        pl_build_body(b, &tile, "tile %d", i + 1);
    }
    pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 0, half);
    const double half_yaw = 0.5 * values[SEAMS_YAW] * 3.141592653589793 / 180;
    cube.orientation[0] = pl_cosine(half_yaw);
    cube.orientation[3] = pl_sine(half_yaw);
    cube.velocity[0] = speed;
    const int index = pl_build_body(b, &cube, "cube");
    pl_build_displaced(b, index, pl_axis_x, distance, distance.continuous);
    pl_build_none(b, index, PL_QUANTITY_TURN, PL_ALONG_ALL, 1);
    pl_expect_value apex = pl_expect_value_default(b->scene);
    apex.body = index;
    apex.quantity = PL_QUANTITY_APEX;
    apex.scale = 2 * half;
    apex.discrete = 0;
    pl_build_value(b, &apex);
}

const pl_scenario pl_scenario_seams = {
    .name = "seams",
    .title = "Cube that slides over flush tiles",
    .description = "A cube slides over a row of tiles whose tops lie in one plane: whether it "
                   "collides with the edges between them.",
    .reference = "s = v0 t - friction g t^2 / 2, as over one body; no rise and no turn",
    .expected = "ok: the cube slides straight on as if there were no seams",
    .source = "Coulomb's law and uniform deceleration",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    .validity = "the tops of the tiles are level, and the cube does not tip",
    .provokes = "the side of the next tile is the nearest face while the cube approaches it: the "
                "cube stops, hops or turns at a seam",
    .symptom = "a sliding body stops or jumps at the seam of two boxes",
    .threads = "dimforge/rapier#95, dimforge/rapier#142, dimforge/rapier#404, "
               "bulletphysics/bullet3#92, bulletphysics/bullet3#676, godotengine/godot#21341",
    PL_PARAMS(seams_params),
    .build = seams_build};

/* Expects a body without friction to keep its velocity v along x, its line and its height. */
static void expect_unhindered(pl_builder *b, int body, double v, double until)
{
    const pl_straight path = {.along = pl_axis_x,
                              .up = pl_axis_z,
                              .distance = v * until,
                              .until = until,
                              .size = 2 * half};
    pl_build_straight(b, body, &path);
    pl_expect_value velocity =
        pl_value_within(b, body, PL_QUANTITY_VELOCITY, pl_axis_x, v, 0.06 * fabs(v));
    velocity.until = until;
    pl_build_value(b, &velocity);
}

/* 24 cubes without friction, in lanes that meet a seam at 24 phases of the time step: an engine that trips at one phase
 * in 24 is found. */

enum { LANES_SPEED };

static const pl_param lanes_params[] = {
    {"speed", 2, 0.1, 8, false, "m/s", "of the cubes along their lanes"},
    PL_PARAM_TIME(0.75),
};

static void lanes_build(pl_builder *b, const double *values)
{
    enum { LANES = 24, TILES = 3 };
    const double v = values[LANES_SPEED];
    for (int lane = 0; lane < LANES; ++lane) {
        for (int i = 0; i < TILES; ++i) {
            pl_body tile = pl_body_at(pl_shape_box(0.5, 0.4, 0.5), i, lane, -0.5);
            tile.is_static = true;
            pl_build_body(b, &tile, "tile %d of lane %d", i, lane);
        }
        const double phase = fmin(v * b->scene->dt, 0.05) * lane / LANES;
        pl_body cube = pl_body_at(pl_shape_box(half, half, half), -0.2 - phase, lane, half);
        cube.velocity[0] = v;
        const int index = pl_build_body(b, &cube, "cube of lane %d", lane);
        expect_unhindered(b, index, v, fmin(b->end, 2.3 / v));
    }
}

const pl_scenario pl_scenario_seam_lanes = {
    .name = "seam-lanes",
    .title = "Seams at 24 phases of a step",
    .description = "24 cubes slide without friction over seams of flush boxes, each a 24th of a "
                   "step later than the one before: whether all pass.",
    .reference = "v constant, no lift, no turn, in every lane",
    .expected = "ok: all 24 cubes pass at their speed",
    .source = "flush faces are one surface: no force acts along it",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "some of many sliding bodies stop or jump at a seam",
    .threads = "dimforge/rapier#142, godotengine/godot#21341",
    PL_PARAMS(lanes_params),
    .build = lanes_build};

/* A cube falls freely along a wall of boxes whose faces are flush, touching it. */

enum { WALL_GAP };

static const pl_param seam_wall_params[] = {
    {"gap", 0, 0, 0.1, false, "m", "between the cube and the wall; 0: they touch"},
    PL_PARAM_TIME(1),
};

static void seam_wall_build(pl_builder *b, const double *values)
{
    enum { BOXES = 12 };
    const double until = fmin(b->end, 1.4); /* s, along the wall */
    for (int i = 0; i < BOXES; ++i) {
        pl_body box = pl_body_at(pl_shape_box(0.5, 0.5, 0.5), 0, 0, -i);
        box.is_static = true;
        pl_build_body(b, &box, "box %d", i);
    }
    pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0.5 + half + values[WALL_GAP], 0, 0);
    const double down[3] = {0, 0, -1};
    const pl_straight path = {.along = down,
                              .up = pl_axis_x,
                              .distance = b->gravity * until * until / 2,
                              .until = until,
                              .size = 2 * half};
    pl_build_straight(b, pl_build_body(b, &cube, "cube"), &path);
}

const pl_scenario pl_scenario_seam_wall = {
    .name = "seam-wall",
    .title = "Cube that falls along a wall of boxes",
    .description = "A cube falls along a wall of boxes whose faces are flush, touching it without "
                   "friction: whether it falls freely past their seams.",
    .reference = "g t^2 / 2 straight down, no turn",
    .expected = "ok: the cube falls as if the wall were not there",
    .source = "flush faces are one surface: no force acts along it; free fall",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "up to 1.4 s, along the wall",
    .symptom = "a body that moves along a wall of blocks catches at their seams",
    .threads = "dimforge/rapier#142, dimforge/rapier#404",
    PL_PARAMS(seam_wall_params),
    .build = seam_wall_build};

/* Two free cubes pass each other without gravity, their sides flush or a little apart. Neither moves
 * along the normal of the faces that meet, and their other faces are parallel to the path's normal. */

enum { PASS_GAP, PASS_SPEED };

static const pl_param passing_params[] = {
    {"gap", 0, 0, 0.1, false, "m", "between their sides; 0: they are flush"},
    {"speed", 1, 0.1, 20, false, "m/s", "of each cube, towards the other"},
    PL_PARAM_TIME(1),
};

static void passing_build(pl_builder *b, const double *values)
{
    const double side = half + values[PASS_GAP] / 2, v = values[PASS_SPEED];
    b->scene->gravity[2] = 0;
    for (int i = 0; i < 2; ++i) {
        const double sign = i == 0 ? 1 : -1;
        pl_body cube = pl_body_at(pl_shape_box(half, half, half), -0.6 * sign, side * sign, 0);
        cube.velocity[0] = v * sign;
        const int index = pl_build_body(b, &cube, i == 0 ? "left" : "right");
        expect_unhindered(b, index, v * sign, b->end);
        pl_build_none_within(b, index, PL_QUANTITY_VELOCITY, PL_ALONG_Y, 0.06 * v);
    }
}

const pl_scenario pl_scenario_passing_flush = {
    .name = "passing-flush",
    .title = "Two cubes that pass flush",
    .description = "Two free cubes pass each other without gravity, their sides flush or a "
                   "micrometre apart: whether they leave each other alone.",
    .reference = "both velocities constant",
    .expected = "ok: the cubes pass without a change",
    .source = "nothing moves along the normal of the faces that meet",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "bodies that pass without touching throw each other aside",
    .threads = "dimforge/rapier#142, bulletphysics/bullet3#676",
    PL_PARAMS(passing_params),
    .build = passing_build};

/* A cube falls flat on a pedestal that is smaller than it and off its centre, and bounces.
 *
 * The impulses of the points of contact add up to m (1 + e) v through the centre of mass, since the
 * centre is over the pedestal and the cube stays flat: it rises to e^2 of its fall, and neither turns
 * nor moves aside. With t1 = sqrt(2 H / g) the impact is at t1 and the apex at t1 (1 + e). */

enum { PEDESTAL_DROP, PEDESTAL_RESTITUTION };

static const pl_param pedestal_params[] = {
    {"drop", 1, 0.1, 10, false, "m", "height that the cube falls"},
    PL_PARAM_RESTITUTION(0.5),
    PL_PARAM_TIME(1.5),
};

static void pedestal_build(pl_builder *b, const double *values)
{
    const double drop = values[PEDESTAL_DROP], e = values[PEDESTAL_RESTITUTION];
    const double impact = sqrt(2 * drop / b->gravity);
    pl_body pedestal = pl_body_at(pl_shape_box(0.15, 0.2, 0.5), 0.05, 0.02, -0.5);
    pedestal.is_static = true;
    pl_build_body(b, &pedestal, "pedestal");
    const pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 0, half + drop);
    const int index = pl_build_body(b, &cube, "cube");
    pl_expect_value apex = pl_expect_value_default(b->scene);
    apex.body = index;
    apex.quantity = PL_QUANTITY_APEX;
    apex.from = fmin(impact + b->scene->dt, b->end);
    apex.until = fmin(impact * (1 + 2 * e) + b->scene->dt, b->end);
    apex.value = e * e * drop - drop;
    apex.scale = drop;
    apex.discrete = (double)NAN;
    pl_build_value(b, &apex);
    pl_build_none(b, index, PL_QUANTITY_TURN, PL_ALONG_ALL, 1);
    pl_build_none(b, index, PL_QUANTITY_POSITION, PL_ALONG_X | PL_ALONG_Y, 2 * half);
}

const pl_scenario pl_scenario_pedestal = {
    .name = "pedestal",
    .title = "Cube that bounces on a pedestal",
    .description = "A cube falls flat on a pedestal smaller than itself, which is not under its "
                   "middle: whether its points of contact rebound together.",
    .reference = "apex e^2 H, no turn, nothing aside",
    .expected = "ok: the cube rises straight up to e^2 of its fall",
    .source = "Newton's law of impact; the resultant passes through the centre of mass",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "the apex, at (1 + e) sqrt(2 H / g), is within the run",
    .provokes = "restitution that acts point after point: the first point throws the cube over",
    .symptom = "the cube leaves spinning, to the side, or higher than it fell",
    .threads = "erincatto/box3d#83",
    PL_PARAMS(pedestal_params),
    .build = pedestal_build};
