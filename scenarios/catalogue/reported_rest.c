/* Bodies at rest that users of engines reported: heavy on light, round and small ones, a body wider than
 * its support, hulls, and bodies that touch or overlap a little at the start. All rest where they are
 * expected to, to 1 % of their size and 0.01 rad, unless the text says otherwise. */
#include "base/trigonometry.h"
#include "catalogue.h"
#include "solids.h"

#include <math.h>
#include <stdio.h>

#define ACCEPT_SIZE(size, text)                                                                    \
    .acceptance = 0.01 * (size), .acceptance_reason = "1 % of " text ": an offset that can be "    \
                                                      "seen; of a turn, 0.01 rad"

static const pl_param resting_params[] = {
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

/* Expects that the body does not move any more in the second half of the run: one that jitters or rocks
 * may be near its place at the end. */
static void expect_still(pl_builder *b, int body)
{
    pl_expect_value speed = pl_value_within(b, body, PL_QUANTITY_TOP_SPEED, pl_axis_z, 0, 0.01);
    speed.from = b->end / 2;
    speed.bound = PL_BOUND_AT_MOST;
    pl_build_value(b, &speed);
}

/* Five cubes, light and heavy in turn. Each rests on the one below. */

enum { ALTERNATING_RATIO, ALTERNATING_COUNT };

static const double alternating_side = 0.4, alternating_light = 0.1; /* m, kg */

static const pl_param alternating_params[] = {
    {"ratio", 100, 1, 1e6, false, "1", "mass of a heavy cube over that of a light one"},
    {"n", 5, 1, 50, true, "1", "number of cubes; the lowest is light"},
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.01),
    PL_PARAM_DURATION(10),
};

static void alternating_build(pl_builder *b, const double *values)
{
    const double half = alternating_side / 2;
    pl_build_floor(b);
    for (int i = 0; i < (int)values[ALTERNATING_COUNT]; ++i) {
        pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 0, (2 * i + 1) * half);
        cube.mass = alternating_light * (i % 2 == 0 ? 1 : values[ALTERNATING_RATIO]);
        pl_build_rest_within(b, pl_build_body(b, &cube, "cube %d", i + 1), alternating_side);
    }
    b->scene->collapse_distance = half;
}

const pl_scenario pl_scenario_alternating_stack = {
    .name = "alternating-stack",
    .title = "Stack of light and heavy cubes in turn",
    .description = "Cubes of 0.4 m, light and heavy in turn, the lightest at the bottom: whether "
                   "the stack stands.",
    .reference = "z = (i - 1/2) side",
    .expected = "ok: the stack stands where it was built",
    .source = "statics",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(0.4, "a side of 0.4 m"),
    .symptom = "the stack collapses at once with one solver, and stands with another",
    .threads = "NVIDIAGameWorks/PhysX#21",
    PL_PARAMS(alternating_params),
    .build = alternating_build};

/* A heavy cylinder stands on a light cube. */

enum { HEAVY_MASS };

static const pl_param heavy_params[] = {
    {"mass", 60, 1e-3, 1e6, false, "kg", "of the cylinder; the cube has 1 kg"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void heavy_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    pl_body body = pl_body_at(pl_shape_box(0.5, 0.5, 0.5), 0, 0, 0.5);
    pl_build_rest_within(b, pl_build_body(b, &body, "cube"), 1);
    body.shape = pl_shape_cylinder(0.5, 0.5);
    body.position[2] = 1.5;
    body.mass = values[HEAVY_MASS];
    pl_build_rest_within(b, pl_build_body(b, &body, "cylinder"), 1);
    b->scene->collapse_distance = 0.5;
}

const pl_scenario pl_scenario_heavy_cylinder = {
    .name = "heavy-cylinder",
    .title = "Heavy cylinder on a light cube",
    .description = "A cylinder stands on a cube that is up to a thousand times lighter: whether "
                   "both stay.",
    .reference = "at rest where they start",
    .expected = "ok: the cylinder stands on the cube",
    .source = "statics",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(1, "a side of 1 m"),
    .symptom = "the heavy body bounces about and falls, or pushes the light one into the floor",
    .threads = "godot-jolt/godot-jolt#1041, jrouwe/JoltPhysics#1390",
    PL_PARAMS(heavy_params),
    .build = heavy_build};

/* A cylinder stands on its rim, a little tilted.
 *
 * With the radius r, half the height H and the tilt f, its centre is over the point of the rim that it
 * stands on by H cos f + r sin f, and aside from it by r cos f - H sin f. It falls upright about that
 * point; then its centre is aside by r. It has moved by r (1 - cos f) + H sin f. Without restitution,
 * it may rock from rim to rim, about points that stay where they are. */

enum { UPRIGHT_TILT };

static const double upright_radius = 0.1, upright_half = 0.2; /* m */

static const pl_param upright_params[] = {
    {"tilt", 0.00776, 0, 0.1, false, "rad", "of its axis at the start"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static int add_table(pl_builder *b)
{
    pl_body box = pl_body_at(pl_shape_box(1, 1, 0.1), 0, 0, 0);
    box.is_static = true;
    return pl_build_body(b, &box, "box");
}

static void upright_build(pl_builder *b, const double *values)
{
    const double r = upright_radius, half = upright_half, top = 0.1;
    const double s = pl_sine(values[UPRIGHT_TILT]), c = pl_cosine(values[UPRIGHT_TILT]);
    add_table(b);
    pl_body body = pl_body_at(pl_shape_cylinder(r, half), -(half * s + r * (1 - c)), 0, top + half);
    body.mass = 12.5;
    const int cylinder = pl_build_body(b, &body, "cylinder");
    pl_build_rest_within(b, cylinder, r);
    expect_still(b, cylinder);
    if (b->status == PL_OK) {
        pl_body *start = &b->scene->bodies[cylinder];
        start->position[0] = 0;
        start->position[2] = top + half * c + r * s;
        pl_turn_about_y(start, values[UPRIGHT_TILT]);
    }
}

const pl_scenario pl_scenario_upright_cylinder = {
    .name = "upright-cylinder",
    .title = "Tilted cylinder that falls upright",
    .description = "A cylinder starts tilted on its rim and falls upright onto a box: whether it "
                   "comes to rest on its cap.",
    .reference = "upright, moved by r (1 - cos) + H sin of the tilt",
    .expected = "ok: the cylinder stands upright, at rest",
    .source = "by geometry; statics",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(0.1, "a radius of 0.1 m"),
    .validity = "the rim does not slip",
    .symptom = "the cylinder rocks for ever on one contact that changes ends, or sinks in",
    .threads = "google-deepmind/mujoco_warp#657, google-deepmind/mujoco_warp#1555, "
               "dartsim/dart#3428",
    PL_PARAMS(upright_params),
    .build = upright_build};

/* A battery, a small cylinder, lies on its side on a box. */

static const double battery_radius = 0.00725; /* m */

static void battery_build(pl_builder *b, const double *values)
{
    (void)values;
    add_table(b);
    pl_body body = pl_body_at(pl_shape_cylinder(battery_radius, 0.025), 0, 0, 0.1 + battery_radius);
    body.mass = 0.024;
    body.orientation[0] = body.orientation[2] = sqrt(0.5);
    const int battery = pl_build_body(b, &body, "battery");
    pl_build_rest_within(b, battery, 2 * battery_radius);
    expect_still(b, battery);
}

const pl_scenario pl_scenario_lying_battery = {
    .name = "lying-battery",
    .title = "Battery on its side",
    .description = "A cylinder of the size of a battery lies on a box: whether its contacts along "
                   "a line keep it there.",
    .reference = "at rest where it starts",
    .expected = "ok: the battery stays where it lies",
    .source = "statics",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(0.0145, "a diameter of 14.5 mm"),
    .symptom = "a small cylinder on its side rocks, sinks in or rolls away",
    .threads = "google-deepmind/mujoco_warp#657, google-deepmind/mujoco_warp#1555",
    PL_PARAMS(resting_params),
    .build = battery_build};

/* A peg lies across a smaller cube: its ends have no support. */

static const pl_param peg_params[] = {
    {"friction", 1, 0, 10, false, "1", "Coulomb coefficient of all contacts"},
    PL_PARAM_TIME(10),
};

static void peg_build(pl_builder *b, const double *values)
{
    (void)values;
    pl_body body = pl_body_at(pl_shape_box(0.025, 0.025, 0.025), 0, 0, 0.025);
    body.is_static = true;
    pl_build_body(b, &body, "cube");
    body.is_static = false;
    body.shape = pl_shape_box(0.048, 0.01, 0.01);
    body.mass = 0.0384;
    body.position[2] = 0.06;
    const int peg = pl_build_body(b, &body, "peg");
    pl_build_rest_within(b, peg, 0.02);
    expect_still(b, peg);
}

const pl_scenario pl_scenario_peg_on_cube = {
    .name = "peg-on-cube",
    .title = "Peg across a smaller cube",
    .description = "A small peg lies across a cube that is shorter than it: whether the contact "
                   "points inside of its face hold it still.",
    .reference = "at rest where it starts",
    .expected = "ok: the peg lies still",
    .source = "statics",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(0.02, "a height of 20 mm"),
    .symptom = "the peg jitters for ever",
    .threads = "google-deepmind/mujoco#2356, godotengine/godot#80603",
    PL_PARAMS(peg_params),
    .build = peg_build};

/* Two hulls with the corners of a cube stand on a box and on each other, where two boxes would. */

static void hulls_build(pl_builder *b, const double *values)
{
    (void)values;
    pl_body ground = pl_body_at(pl_shape_box(5, 5, 0.5), 0, 0, -0.5);
    ground.is_static = true;
    pl_build_body(b, &ground, "ground");
    pl_solid cube = pl_solid_box(0.5, 0.5, 0.5);
    const pl_shape shape = pl_build_solid(b, &cube, true, "cube");
    for (int i = 0; i < 2; ++i) {
        const pl_body body = pl_body_at(shape, 0, 0, 0.5 + i);
        pl_build_rest_within(b, pl_build_body(b, &body, "cube %d", i + 1), 1);
    }
    b->scene->collapse_distance = 0.5;
}

const pl_scenario pl_scenario_hulls_touch = {
    .name = "hulls-touch",
    .title = "Hulls without a gap",
    .description = "Two convex hulls of a cube's corners stand on each other: whether they touch, "
                   "as boxes do, or float by a margin.",
    .reference = "z = 1/2 and 3/2",
    .expected = "ok: the hulls stand where they were built",
    .source = "by geometry",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(1, "a side of 1 m"),
    .symptom = "bodies with hulls float over each other, boxes do not",
    .threads = "godotengine/godot#55503",
    PL_PARAMS(resting_params),
    .build = hulls_build};

/* Pairs of equal boxes on the floor, side by side, one of each pair turned by a small angle.
 *
 * Their faces touch, or overlap by up to 0.06 mm at a corner: a box turned by f reaches
 * a sin f + b cos f to the side. However they part, none has a reason to be fast, or to end farther away
 * than an offset that can be seen. */

enum { TOUCHING_PAIRS };

static const double box_half[3] = {0.05, 0.0355, 0.03}; /* m */

static const pl_param touching_params[] = {
    {"pairs", 20, 1, 500, true, "1", "of boxes"},
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.0005),
    PL_PARAM_DURATION(1),
};

static void add_pair(pl_builder *b, int pair, double yaw)
{
    const double most = 6e-5, speed = 0.1; /* m, m/s */
    const double reach = box_half[0] * pl_sine(yaw) + box_half[1] * pl_cosine(yaw);
    const double touch = 2 * box_half[1];
    const int column = pair % 10, row = pair / 10;
    for (int i = 0; i < 2; ++i) {
        pl_body body = pl_body_at(pl_shape_box(box_half[0], box_half[1], box_half[2]), 0.3 * column,
                                  0.4 * row, box_half[2]);
        body.mass = 0.852;
        if (i == 1) {
            body.position[1] += fmax(touch, box_half[1] + reach - most);
            pl_turn_about_axis(&body, 2, yaw);
        }
        const int index = pl_build_body(b, &body, "%s %d", i == 0 ? "straight" : "turned", pair);
        pl_build_rest_within(b, index, 0.06);
        pl_expect_value fast =
            pl_value_within(b, index, PL_QUANTITY_TOP_SPEED, pl_axis_z, 0, speed);
        fast.bound = PL_BOUND_AT_MOST;
        pl_build_value(b, &fast);
    }
}

static void touching_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    for (int i = 0; i < (int)values[TOUCHING_PAIRS] && b->status == PL_OK; ++i) {
        double yaw = pl_draw_uniform(&b->random, 0, 0.01);
        for (int k = 0; k < i % 3; ++k) {
            yaw *= 0.03; /* also very small angles */
        }
        add_pair(b, i, yaw);
    }
}

const pl_scenario pl_scenario_touching_boxes = {
    .name = "touching-boxes",
    .title = "Boxes that just touch",
    .description = "Boxes stand side by side in pairs, almost parallel, touching or overlapping "
                   "by up to 0.06 mm: whether they stay where they are.",
    .reference = "no body faster than 0.1 m/s, none moved by more than 0.6 mm",
    .expected = "ok: the boxes stay where they are",
    .source = "statics; an overlap of 0.06 mm is no reason to move farther",
    .primary_error = "rest_position_error",
    ACCEPT_SIZE(0.06, "a height of 60 mm"),
    .symptom = "a contact as deep as the box is wide throws two touching boxes apart at 18 m/s",
    .threads = "google-deepmind/mujoco#3476",
    PL_PARAMS(touching_params),
    .build = touching_build};

/* Two by two by two balls on a slab, out of line by up to 10 mm each, so that some overlap a little at
 * the start. They fall over; nothing gives them energy. An upper ball ends on the slab or between lower
 * ones: even between two it is 0.13 m lower than on top of one. */

static void balls_build(pl_builder *b, const double *values)
{
    (void)values;
    pl_body body = pl_body_at(pl_shape_box(100, 100, 0.1), 0, 0, -0.1);
    body.is_static = true;
    pl_build_body(b, &body, "slab");
    for (int i = 0; i < 8; ++i) {
        double place[3] = {i & 1, i >> 1 & 1, 0.5 + (i >> 2)};
        for (int k = 0; k < 3; ++k) {
            place[k] += pl_draw_uniform(&b->random, 0, 0.01);
        }
        body = pl_body_at(pl_shape_sphere(0.5), place[0], place[1], place[2]);
        const int ball = pl_build_body(b, &body, "ball %d", i);
        if (i >= 4 && b->end >= 5) {
            pl_expect_value fallen =
                pl_value_within(b, ball, PL_QUANTITY_POSITION, pl_axis_z, -0.1, 0.01);
            fallen.bound = PL_BOUND_AT_MOST;
            pl_build_value(b, &fallen);
        }
    }
    pl_build_same_bits(b);
}

const pl_scenario pl_scenario_eight_balls = {
    .name = "eight-balls",
    .title = "Eight balls that overlap a little",
    .description = "Eight balls in two layers, out of line by up to 10 mm and overlapping by up to "
                   "about 10 mm at the start, fall over: whether they gain energy, and whether "
                   "a second run in the same process has the same bits.",
    .reference = "no gain of energy; the same bits again",
    .expected = "ok: the balls part and roll away, and gain no energy",
    .source = "conservation of energy; a computation that depends on the scene alone",
    .primary_error = "energy_gain",
    .acceptance = 0.01,
    .acceptance_reason = "1 % of the energy: the bound of all scenes that are judged by it",
    .symptom = "runs from one start end in different places",
    .threads = "dimforge/rapier#868",
    PL_PARAMS(resting_params),
    .build = balls_build};
