/* Degenerate contacts of the literature (Erleben 2018): tips that pass over a surface, tips on tips, a
 * wedge in a crack and a spike in a hole, and a cube on a cliff of its own size.
 *
 * A tip points down from its frame's origin to 3 m over it: that of a spike is a point, and its base is
 * 1 m square; that of a wedge is an edge along y, and its base is 1 m by 2 m. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>

#define ERLEBEN                                                                                    \
    "scene after Erleben 2018, Methodology for assessing mesh-based contact point methods, ACM "   \
    "Transactions on Graphics 37(3)"

enum { SPIKE, WEDGE };

#define TIP_PARAM(name, text)                                                                      \
    {                                                                                              \
        name, SPIKE, SPIKE, WEDGE, true, "1", text ": 0 a spike, 1 a wedge"                        \
    }

static const double tip_height = 3, tip_half = 0.5; /* m */

/* Half the length of the tip along y: that of its base, at its end. */
static double half_along(int kind)
{
    return kind == WEDGE ? 1 : tip_half;
}

/* The hull of a tip, which points down where `up` is 1, and up where it is -1. */
static pl_shape tip_shape(pl_builder *b, int kind, double up, const char *name)
{
    double points[6][3];
    int count = 0;
    for (int i = 0; i < 4; ++i) {
        points[count][0] = i & 1 ? tip_half : -tip_half;
        points[count][1] = i & 2 ? half_along(kind) : -half_along(kind);
        points[count++][2] = up * tip_height;
    }
    for (int i = 0; i < (kind == WEDGE ? 2 : 1); ++i) {
        points[count][0] = points[count][2] = 0;
        points[count++][1] = kind == WEDGE ? 2 * i - 1 : 0;
    }
    return pl_build_hull(b, name, (const double(*)[3])points, count);
}

/* 1000 kg/m^3. */
static double tip_mass(int kind)
{
    const double base = 4 * tip_half * half_along(kind);
    return 1000 * base * tip_height / (kind == WEDGE ? 2 : 3);
}

/* ---- A tip over a surface ---- */

/* A tip moves along x, a gap over the ground, without gravity. Nothing touches it: it keeps its velocity
 * and does not turn. */

enum { PASS_TIP, PASS_GROUND, PASS_GAP, PASS_SPEED };
enum { ON_PLANE, ON_BOX, ON_MESH };

static const pl_param pass_params[] = {
    TIP_PARAM("tip", "the body"),
    {"ground", ON_PLANE, ON_PLANE, ON_MESH, true, "1",
     "0 a plane, 1 a box, 2 a mesh of 20 x 20 quads"},
    {"gap", 1e-4, 0, 0.1, false, "m", "between the tip and the ground"},
    {"speed", 10, 0.1, 100, false, "m/s", "of the tip"},
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.01),
    PL_PARAM_DURATION(2),
};

static void add_ground(pl_builder *b, int kind)
{
    const double half[3] = {15, 4, 0.5}; /* m */
    if (kind == ON_PLANE) {
        pl_build_floor(b);
        return;
    }
    pl_shape shape = pl_shape_box(half[0], half[1], half[2]);
    if (kind == ON_MESH) {
        pl_solid slab = pl_solid_slab(half[0], half[1], half[2], 20);
        shape = pl_build_solid(b, &slab, false, "slab");
    }
    pl_body ground = pl_body_at(shape, 10, 0, -half[2]);
    ground.is_static = true;
    pl_build_body(b, &ground, "ground");
}

static void pass_build(pl_builder *b, const double *values)
{
    const int kind = (int)values[PASS_TIP];
    const double v = values[PASS_SPEED], until = fmin(b->end, 20 / v);
    b->scene->gravity[2] = 0;
    add_ground(b, (int)values[PASS_GROUND]);
    pl_body tip = pl_body_at(tip_shape(b, kind, 1, "tip"), 0, 0.1, values[PASS_GAP]);
    tip.mass = tip_mass(kind);
    tip.velocity[0] = v;
    const int index = pl_build_body(b, &tip, "tip");
    const pl_straight path = {.along = pl_axis_x,
                              .up = pl_axis_z,
                              .distance = v * until,
                              .until = until,
                              .size = 2 * tip_half};
    pl_build_straight(b, index, &path);
    pl_expect_value velocity =
        pl_value_within(b, index, PL_QUANTITY_VELOCITY, pl_axis_x, v, 0.01 * v);
    velocity.until = until;
    pl_build_value(b, &velocity);
}

const pl_scenario pl_scenario_tip_passes = {
    .name = "tip-passes",
    .title = "Spike or wedge that passes over a surface",
    .description = "A spike, or a wedge, moves 0.1 mm over a surface without gravity: whether it "
                   "meets anything.",
    .reference = "velocity constant, no turn",
    .expected = "ok: the tip passes at its speed",
    .source = "nothing touches it; " ERLEBEN,
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "the first 20 m",
    PL_PARAMS(pass_params),
    .build = pass_build};

/* ---- A tip on a tip ---- */

/* A tip falls by a gap onto a tip that points up, a little beside it. It cannot stay: it slips off its steep
 * side, without overlap, and never has more energy than at its start. Without the offset it could balance:
 * then the overlap and the energy alone are judged. */

enum { ON_ABOVE, ON_BELOW, ON_GAP, ON_OFFSET };

static const pl_param on_params[] = {
    TIP_PARAM("above", "the body"),
    TIP_PARAM("below", "its support"),
    {"gap", 1e-4, 0, 0.1, false, "m", "between the tips at the start"},
    {"offset", 0.01, 0, 0.4, false, "m", "of the upper tip to the side, along x"},
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.01),
    PL_PARAM_DURATION(2),
};

static void on_build(pl_builder *b, const double *values)
{
    const int above = (int)values[ON_ABOVE], below = (int)values[ON_BELOW];
    pl_build_plane(b, "floor", 0, 0, 0, 1, -tip_height);
    pl_body tip = pl_body_at(tip_shape(b, below, -1, "upwards"), 0, 0, 0);
    tip.is_static = true;
    pl_build_body(b, &tip, "below");
    tip = pl_body_at(tip_shape(b, above, 1, "downwards"), values[ON_OFFSET], 0, values[ON_GAP]);
    tip.mass = tip_mass(above);
    const int index = pl_build_body(b, &tip, "above");
    pl_expect_value energy = pl_value_within(b, index, PL_QUANTITY_ENERGY, pl_axis_z, 0,
                                             0.01 * tip.mass * b->gravity * tip_height);
    energy.bound = PL_BOUND_AT_MOST;
    pl_build_value(b, &energy);
    if (values[ON_OFFSET] >= 0.01 && b->end >= 2) {
        pl_expect_value fallen =
            pl_value_within(b, index, PL_QUANTITY_POSITION, pl_axis_z, -0.5, 0.01);
        fallen.bound = PL_BOUND_AT_MOST;
        pl_build_value(b, &fallen);
    }
}

const pl_scenario pl_scenario_tip_on_tip = {
    .name = "tip-on-tip",
    .title = "Spike or wedge on a spike or a wedge",
    .description = "A tip stands on a tip, from which it falls: whether the contact of a point or "
                   "an edge with another keeps them apart, and gives no energy.",
    .reference = "no overlap, no gain of energy",
    .expected = "ok: the body slips off without overlap and without a gain of energy",
    .source = "impenetrability, conservation of energy; " ERLEBEN,
    .primary_error = "penetration_max",
    .acceptance = 0.01,
    .acceptance_reason = "1 % of the width of 1 m: an overlap that can be seen; of the energy, 1 % "
                         "of the weight times the height",
    PL_PARAMS(on_params),
    .build = on_build};

/* ---- A tip in a gap ---- */

/* A wedge falls into a crack, or a spike into a square hole, of the width w.
 *
 * At the height h over its tip it is h / 3 wide. It rests where both edges of the crack, or all four of
 * the hole, touch its sides: with its tip 3 w below them, upright by symmetry. It sticks there, since
 * its sides are nearer to the vertical than the angle of friction to its contacts' normals. */

enum { GAP_TIP, GAP_MESH, GAP_WIDTH, GAP_DROP, GAP_SPEED };

static const pl_param gap_params[] = {
    TIP_PARAM("tip", "the body; the spike's gap is a hole, the wedge's a crack"),
    {"mesh", 0, 0, 1, true, "1", "the ground: 0 boxes, 1 one mesh"},
    {"width", 0.5, 0.1, 0.6, false, "m", "of the gap"},
    {"drop", 0.1, 0, 0.3, false, "m", "height over its rest from which the tip starts"},
    {"speed", 1, 0, 5, false, "m/s", "of the tip at the start, downwards"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(3),
};

static const double ground_half = 1.5, ground_depth = 2.5; /* m */

/* Adds boxes on two opposite sides of the gap, and for a hole on the other two between them. */
static void add_boxes(pl_builder *b, int kind, double half)
{
    const double wide = (ground_half - half) / 2, centre = half + wide, deep = ground_depth / 2;
    for (int i = 0; i < (kind == SPIKE ? 4 : 2); ++i) {
        const double sign = i % 2 == 0 ? 1 : -1;
        pl_body box =
            i < 2 ? pl_body_at(pl_shape_box(wide, ground_half, deep), sign * centre, 0, -deep)
                  : pl_body_at(pl_shape_box(half, wide, deep), 0, sign * centre, -deep);
        box.is_static = true;
        pl_build_body(b, &box, "ground %d", i + 1);
    }
}

static void gap_build(pl_builder *b, const double *values)
{
    const int kind = (int)values[GAP_TIP];
    const double half = values[GAP_WIDTH] / 2;
    if (values[GAP_MESH] != 0) {
        pl_solid solid = kind == SPIKE ? pl_solid_hole(ground_half, half, ground_depth)
                                       : pl_solid_crack(ground_half, half, ground_depth);
        pl_body ground = pl_body_at(pl_build_solid(b, &solid, false, "ground"), 0, 0, 0);
        ground.is_static = true;
        pl_build_body(b, &ground, "ground");
    } else {
        add_boxes(b, kind, half);
    }
    pl_body tip = pl_body_at(tip_shape(b, kind, 1, "tip"), 0, 0, -half * tip_height / tip_half);
    tip.mass = tip_mass(kind);
    tip.velocity[2] = -values[GAP_SPEED];
    const int index = pl_build_body(b, &tip, "tip");
    pl_build_rest(b, index);
    pl_build_start_off(b, index, 2, values[GAP_DROP]);
}

const pl_scenario pl_scenario_tip_in_gap = {
    .name = "tip-in-gap",
    .title = "Spike in a hole, wedge in a crack",
    .description = "A spike falls into a square hole, or a wedge into a crack: whether all edges "
                   "of the gap hold it where it fits.",
    .reference = "at rest upright, the tip 3 widths below the edges",
    .expected = "ok: the tip sits in the gap, upright",
    .source = "by geometry; " ERLEBEN,
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(gap_params),
    .build = gap_build};

/* ---- A cube on a cliff ---- */

/* A cube on a static cube of its own size, moved aside by less than half: it rests. */

enum { CLIFF_OVERHANG, CLIFF_MESH };

static const pl_param cliff_params[] = {
    {"overhang", 0, 0, 0.499, false, "m", "of the cube over the edge of the cliff; it has 1 m"},
    {"mesh", 0, 0, 1, true, "1", "the cliff: 0 a box, 1 a mesh"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void cliff_build(pl_builder *b, const double *values)
{
    pl_shape shape = pl_shape_box(0.5, 0.5, 0.5);
    if (values[CLIFF_MESH] != 0) {
        pl_solid solid = pl_solid_box(0.5, 0.5, 0.5);
        shape = pl_build_solid(b, &solid, false, "cliff");
    }
    pl_body body = pl_body_at(shape, 0, 0, -0.5);
    body.is_static = true;
    pl_build_body(b, &body, "cliff");
    body = pl_body_at(pl_shape_box(0.5, 0.5, 0.5), values[CLIFF_OVERHANG], 0, 0.5);
    body.mass = 1000;
    pl_build_rest(b, pl_build_body(b, &body, "cube"));
    b->scene->collapse_distance = 0.5;
}

const pl_scenario pl_scenario_cliff = {
    .name = "cliff",
    .title = "Cube on a cliff of its own size",
    .description = "A cube rests on a cube of its own size, flush or with an overhang of less than "
                   "half: whether faces whose edges coincide hold it.",
    .reference = "at rest where it starts",
    .expected = "ok: the cube stays on the cliff",
    .source = "statics: its centre is over the cliff; " ERLEBEN,
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(cliff_params),
    .build = cliff_build};
