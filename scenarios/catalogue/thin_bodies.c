/* Very thin bodies and gaps: a slender rod, a thin wall, a needle in a gap. */
#include "catalogue.h"

#include <math.h>

/* A very slender rod that falls flat on the floor.
 *
 * A square rod 1 m long, 1 / slenderness m thick; its moments of inertia are in the ratio
 * (slenderness^2 + 1) / 2, half a million for the default. It is dropped level, so both ends
 * strike at once and it does not turn; without restitution it then lies still. */

enum { THIN_ROD_SLENDERNESS, THIN_ROD_DROP, THIN_ROD_FRICTION };

static const pl_param thin_rod_params[] = {
    {"slenderness", 1000, 1, 1e5, false, "1", "length over thickness"},
    {"drop", 0.1, 0, 10, false, "m", "height that it falls"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void thin_rod_build(pl_builder *b, const double *values)
{
    const double half_length = 0.5, half_thickness = half_length / values[THIN_ROD_SLENDERNESS];
    pl_build_floor(b);
    pl_body rod =
        pl_body_at(pl_shape_box(half_length, half_thickness, half_thickness), 0, 0, half_thickness);
    int index = pl_build_body(b, &rod, "rod");
    pl_build_rest(b, index);
    pl_build_start_off(b, index, 2, values[THIN_ROD_DROP]);
    b->scene->collapse_distance = 0.05;
}

const pl_scenario pl_scenario_thin_rod = {
    .name = "thin-rod",
    .title = "Slender rod that falls flat",
    .description = "A rod of 1 m and 1 mm thickness that falls level: moments of inertia that "
                   "differ by half a million, and a body thinner than it falls in a step.",
    .reference = "it lies where it fell: z = half its thickness, not turned",
    .expected = "ok: the rod lies flat where it fell",
    .source = "by symmetry",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "the run lasts until it lies: duration > sqrt(2 drop / g)",
    .provokes = "the rod passes through the floor, spins up about its long axis, where the least "
                "moment turns it, or never comes to rest; in a right engine it lies down and stays",
    PL_PARAMS(thin_rod_params),
    .build = thin_rod_build};

/* A body flies at a wall that is much thinner than its displacement in a step.
 *
 * There is no gravity, and nothing bounces: the body meets the wall's middle squarely, or with its
 * edge foremost, and stops where it touches. */

enum { THIN_WALL_SHAPE, THIN_WALL_SPEED, THIN_WALL_THICKNESS, THIN_WALL_FRICTION };
enum { SPHERE, PLATE, PLATE_ON_EDGE };

static const pl_param thin_wall_params[] = {
    {"shape", SPHERE, SPHERE, PLATE_ON_EDGE, true, "1",
     "0 sphere of 1 m, 1 plate of 1 m by 1 cm, 2 the same, its edge foremost"},
    {"speed", 200, 0.1, 1e4, false, "m/s", "of the body"},
    {"thickness", 0.01, 1e-6, 1, false, "m", "of the wall"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(1),
};

static const double half = 0.5, half_plate = 0.005; /* m */
static const double start_off = -7.3; /* m: so that the body is at the wall in mid-step */
static const double half_wall = 20;   /* m */

static void thin_wall_build(pl_builder *b, const double *values)
{
    b->scene->gravity[2] = 0;
    pl_body wall =
        pl_body_at(pl_shape_box(values[THIN_WALL_THICKNESS] / 2, half_wall, half_wall), 0, 0, 0);
    wall.is_static = true;
    pl_build_body(b, &wall, "wall");

    const int shape = (int)values[THIN_WALL_SHAPE];
    pl_body body = pl_body_at(shape == SPHERE  ? pl_shape_sphere(half)
                              : shape == PLATE ? pl_shape_box(half_plate, half, half)
                                               : pl_shape_box(half, half, half_plate),
                              0, 0, 0);
    const double front = shape == PLATE ? half_plate : half;
    body.position[0] = -values[THIN_WALL_THICKNESS] / 2 - front;
    body.velocity[0] = values[THIN_WALL_SPEED];
    const int flying = pl_build_body(b, &body, "body");
    pl_build_rest(b, flying);
    pl_build_start_off(b, flying, 0, start_off);
    b->scene->collapse_distance = 0.1;
}

const pl_scenario pl_scenario_thin_wall = {
    .name = "thin-wall",
    .title = "Bullet and thin wall",
    .description =
        "A fast body flies squarely at a thin wall, which it would pass within one step: "
        "whether the engine sees it coming.",
    .reference = "it stops where it touches the wall",
    .expected = "ok: the body stops where it touches the wall",
    .source = "impenetrability, and a restitution of 0",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "the run lasts until it is there: speed * duration > 7.3 m",
    PL_PARAMS(thin_wall_params),
    .build = thin_wall_build};

/* A needle that falls into a gap a little wider than itself.
 *
 * The needle is a box 0.5 m long and 10 mm wide, the gap between two fixed blocks `clearance` of
 * that wider and 1 m deep. The needle starts with its point just within the gap, at the fraction
 * `tilt` of the largest angle that the gap allows. It slides down without friction, and ends
 * upright on the floor: its base is level there, and its centre of mass over it. Its place across
 * the gap is free to within half the clearance, 0.05 mm by default. */

enum { NEEDLE_IN_GAP_CLEARANCE, NEEDLE_IN_GAP_TILT };

static const pl_param needle_in_gap_params[] = {
    {"clearance", 0.01, 1e-4, 1, false, "1",
     "of the gap next to the needle, over the needle's width"},
    {"tilt", 0.5, 0, 0.9, false, "1", "of the needle at the start, over the largest that fits"},
    PL_PARAM_TIME(5),
};

static void needle_in_gap_build(pl_builder *b, const double *values)
{
    const double half_length = 0.25, half_width = 0.005, half_depth = 0.005, gap_depth = 1;
    const double gap = half_width * (1 + values[NEEDLE_IN_GAP_CLEARANCE]), block = 0.5;
    pl_build_floor(b);
    pl_body side =
        pl_body_at(pl_shape_box(block, block, gap_depth / 2), -(gap + block), 0, gap_depth / 2);
    side.is_static = true;
    pl_build_body(b, &side, "left");
    side.position[0] = gap + block;
    pl_build_body(b, &side, "right");
    pl_body needle =
        pl_body_at(pl_shape_box(half_width, half_depth, half_length), 0, 0, half_length);
    needle.mass = 0.01;
    int index = pl_build_body(b, &needle, "needle");
    pl_build_rest(b, index);
    if (b->status == PL_OK) {
        /* A turn by q about y, small, widens the needle by its length times q. */
        const double turn = values[NEEDLE_IN_GAP_TILT] * (gap - half_width) / half_length;
        pl_body *start = &b->scene->bodies[index];
        start->position[2] = gap_depth;
        start->orientation[0] = sqrt(1 - turn * turn / 4);
        start->orientation[2] = turn / 2;
    }
    b->scene->collapse_distance = 0.01;
}

const pl_scenario pl_scenario_needle_in_gap = {
    .name = "needle-in-gap",
    .title = "Needle in a narrow gap",
    .description = "A slender box that falls down a gap 1 % wider than itself: contacts on both "
                   "sides at once, in a body thinner than it falls in a step.",
    .reference = "it stands on the floor, upright, to within the clearance",
    .expected = "ok: the needle stands upright on the floor",
    .source = "statics and impenetrability",
    .primary_error = "rest_position_error",
    .acceptance = 0.005,
    .acceptance_reason = "1 % of its length of 0.5 m: an offset that can be seen",
    .validity = "across the gap to within half of clearance times width; the run lasts until it "
                "stands: duration > 0.4 s",
    .provokes =
        "margins and contacts from both sides that will not agree: the needle jams, shakes, "
        "is squeezed out or passes through a side; a right engine lets it fall to the floor",
    PL_PARAMS(needle_in_gap_params),
    .build = needle_in_gap_build};
