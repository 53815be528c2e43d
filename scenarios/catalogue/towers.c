/* Towers of unit cubes at rest, by statics: single ones, a field of them, with a heavy cube on top,
 * at long steps, far from the origin and with an initial overlap. */
#include "base/trigonometry.h"
#include "catalogue.h"

static const double half = 0.5; /* m, of a cube */

#define PL_PARAM_CUBES                                                                             \
    {                                                                                              \
        "n", 10, 1, 2000, true, "1", "number of cubes"                                             \
    }

/* A cube at (x, y, z). */
static pl_body cube_at(double x, double y, double z)
{
    return pl_body_at(pl_shape_box(half, half, half), x, y, z);
}

/* Begins a scene of cubes: the floor, and how far one may move before it has collapsed. */
static void begin(pl_builder *b)
{
    pl_build_floor(b);
    b->scene->collapse_distance = half;
}

/* A tower of n unit cubes, or of slabs.
 *
 * Cube k = 1 .. n of side 1 and height h stands with its centre at z = (k - 1/2) h, exactly on the
 * one below. Its mass is m_k = rising_mass^((k - 1) / (n - 1)) kg, times top_mass for k = n, so that
 * cube 1 of several weighs 1 kg. With `offset`, each is moved in x and y by a uniform random part of
 * up to offset * side. No cube is then more than 2 * 0.2 sides off any other, so the centre of mass
 * of all cubes above a joint, a mean of theirs whatever their masses, lies within half a side of the
 * centres of both cubes at the joint: it stands by statics, and nothing moves. With `yaw`, each is
 * turned about z by a uniform random angle up to that. The faces at a joint then still overlap in
 * the circles in them, of half a side about their centres, in which the centre of mass must lie: so
 * 2 sqrt(2) offset <= 1/2. */

enum {
    TOWER_COUNT,
    TOWER_FRICTION,
    TOWER_OFFSET,
    TOWER_TOP_MASS,
    TOWER_RISING_MASS,
    TOWER_YAW,
    TOWER_HEIGHT
};

static const double most_yawed_offset = 0.17;

static const pl_param tower_params[] = {
    PL_PARAM_CUBES,
    PL_PARAM_FRICTION,
    {"offset", 0, 0, 0.2, false, "1",
     "largest random displacement in x and in y, in sides of a cube"},
    {"top_mass", 1, 1, 1e6, false, "1", "how many times heavier the top cube is"},
    {"rising_mass", 1, 1, 1e6, false, "1",
     "mass of the top over the bottom, in equal ratios from cube to cube (before top_mass)"},
    {"yaw", 0, 0, 0.8, false, "rad", "largest random turn about the vertical"},
    {"height", 1, 0.05, 1, false, "m", "of a cube; below 1 it is a slab"},
    PL_PARAM_TIME(10),
};

/* Uniform from -most to most. */
static double displacement(pl_random *random, double most)
{
    /* Not 0 times something negative, which would be -0. */
    return most > 0 ? most * (2 * pl_random_unit(random) - 1) : 0;
}

static void turn_about_z(pl_body *body, double angle)
{
    body->orientation[0] = pl_cosine(angle / 2);
    body->orientation[3] = pl_sine(angle / 2);
}

/* The n-th root of ratio >= 1, from below, by bisection down to neighbouring numbers: the same bits
 * on every machine, which pow does not give. */
static double root(double ratio, int n)
{
    double low = 1, high = ratio;
    for (;;) {
        double middle = low + (high - low) / 2, power = 1;
        if (middle <= low || middle >= high) {
            return low;
        }
        for (int i = 0; i < n && power <= ratio; ++i) {
            power *= middle;
        }
        *(power <= ratio ? &low : &high) = middle;
    }
}

static void tower_build(pl_builder *b, const double *values)
{
    begin(b);
    const int count = (int)values[TOWER_COUNT];
    const double height = values[TOWER_HEIGHT];
    b->scene->collapse_distance = height / 2;
    if (values[TOWER_YAW] > 0 && values[TOWER_OFFSET] > most_yawed_offset) {
        pl_build_refuse(b, "expected an offset up to %g with yaw, found %g", most_yawed_offset,
                        values[TOWER_OFFSET]);
    }
    const double growth = count > 1 ? root(values[TOWER_RISING_MASS], count - 1) : 1;
    double mass = 1;
    for (int k = 1; k <= count; ++k, mass *= growth) {
        const double x = displacement(&b->random, values[TOWER_OFFSET]);
        const double y = displacement(&b->random, values[TOWER_OFFSET]);
        pl_body cube = pl_body_at(pl_shape_box(half, half, height / 2), x, y, (k - half) * height);
        cube.mass = k == count ? mass * values[TOWER_TOP_MASS] : mass;
        turn_about_z(&cube, displacement(&b->random, values[TOWER_YAW]));
        pl_build_rest(b, pl_build_body(b, &cube, "cube %d", k));
    }
}

const pl_scenario pl_scenario_tower = {
    .name = "tower",
    .title = "Tower of cubes",
    .description =
        "n unit cubes of 1 kg stacked exactly, at rest: whether a solver carries the weight "
        "of the whole tower through every contact, and for how long. The cubes may be displaced, "
        "turned, flat, or grow heavier upwards.",
    .reference = "every cube stays where it is: z_k = (k - 1/2) height, for any masses, offsets "
                 "and turns",
    .expected = "ok: every cube at rest where it began, for any number, masses, offsets and turns",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .provokes = "a weight that must pass through every contact: a solver of few iterations lets "
                "the tower sink, sway and fall; a right engine holds any number of cubes still",
    PL_PARAMS(tower_params),
    .build = tower_build};

/* Towers of unit cubes next to each other, k by k of them, 1 m apart: each is independent, and none
 * may disturb another. */

enum { MOST_CUBES = 100000 };

enum { MULTI_TOWER_SIDE, MULTI_TOWER_COUNT, MULTI_TOWER_FRICTION };

static const pl_param multi_tower_params[] = {
    {"k", 5, 1, 100, true, "1", "towers along either side of the square"},
    {"n", 25, 1, 100, true, "1", "cubes of a tower; all towers together have at most 100000"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void multi_tower_build(pl_builder *b, const double *values)
{
    const double spacing = 2;
    const int towers = (int)values[MULTI_TOWER_SIDE], count = (int)values[MULTI_TOWER_COUNT];
    if (towers * towers * count > MOST_CUBES) {
        pl_build_refuse(b, "expected at most %d cubes, found k * k * n = %d", MOST_CUBES,
                        towers * towers * count);
        return;
    }
    begin(b);
    for (int tower = 0; tower < towers * towers; ++tower) {
        const int column = tower % towers, row = tower / towers;
        for (int k = 0; k < count; ++k) {
            pl_body cube = cube_at(spacing * column, spacing * row, half + k);
            pl_build_rest(b, pl_build_body(b, &cube, "cube %d.%d", tower + 1, k + 1));
        }
    }
}

const pl_scenario pl_scenario_multi_tower = {
    .name = "multi-tower",
    .title = "Field of towers",
    .description =
        "A square of towers of cubes, at rest: many stacks at once, each of them as hard "
        "as a single one. Figure 4 of the source paper, " PL_SOURCE_PAPER ".",
    .reference = "every cube stays where it is: z_k = k - 1/2 m",
    .expected = "ok: every cube of every tower at rest where it began",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(multi_tower_params),
    .build = multi_tower_build};

/* A heavy cube on a light one.
 *
 * The light cube, of side 1 m and 1 kg, stands on the floor; the heavy one, of the same size and
 * 10^k kg, exactly on it. Statics: nothing moves, and with m = 1 kg and M = 10^k kg the contact
 * between them carries M g, that with the floor (M + m) g. An iteration that passes impulses from
 * contact to contact needs about M / m of them to do so. */

enum { MASS_RATIO_EXPONENT, MASS_RATIO_FRICTION };

static const pl_param mass_ratio_params[] = {
    {"k", 2, 0, 6, true, "1", "the upper cube is 10^k times as heavy as the lower"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void build_cube(pl_builder *b, const char *name, double mass, double height)
{
    pl_body cube = cube_at(0, 0, height);
    cube.mass = mass;
    pl_build_rest(b, pl_build_body(b, &cube, "%s", name));
}

static void mass_ratio_build(pl_builder *b, const double *values)
{
    double mass = 1;
    for (int i = 0; i < (int)values[MASS_RATIO_EXPONENT]; ++i) {
        mass *= 10;
    }
    begin(b);
    build_cube(b, "light", 1, half);
    build_cube(b, "heavy", mass, half + 1);
}

const pl_scenario pl_scenario_mass_ratio = {
    .name = "mass-ratio",
    .title = "Heavy cube on a light one",
    .description =
        "A cube of 10^k kg at rest on one of 1 kg: whether a solver carries a large weight "
        "through a small mass.",
    .reference = "both cubes stay where they are: z = 1/2 m and 3/2 m; the contacts carry M g and "
                 "(M + m) g",
    .expected = "ok: both cubes at rest where they began, at any ratio",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .provokes = "a large weight through a small mass: an iteration passes on a part of it at a "
                "time, so the light cube is squeezed and the heavy one falls; a right engine "
                "holds it still",
    PL_PARAMS(mass_ratio_params),
    .build = mass_ratio_build};

/* A tower of unit cubes, stepped ten times a second: a cube in free fall would drop by 0.1 m in one
 * step. The length of a step does not matter for a body at rest. */

enum { LARGE_STEP_COUNT, LARGE_STEP_FRICTION };

static const pl_param large_step_params[] = {
    PL_PARAM_CUBES,
    PL_PARAM_FRICTION,
    PL_PARAM_STEP(0.1),
    PL_PARAM_DURATION(20),
};

static void large_step_build(pl_builder *b, const double *values)
{
    begin(b);
    for (int k = 0; k < (int)values[LARGE_STEP_COUNT]; ++k) {
        pl_body cube = cube_at(0, 0, half + k);
        pl_build_rest(b, pl_build_body(b, &cube, "cube %d", k + 1));
    }
}

const pl_scenario pl_scenario_large_step = {
    .name = "large-step",
    .title = "Tower at ten steps a second",
    .description = "A tower of cubes at rest with a step of 1/10 s: whether a tower at rest "
                   "depends on the length of the step.",
    .reference = "every cube stays where it is, at any step",
    .expected = "ok: every cube at rest where it began, as at short steps",
    .source = "statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .provokes =
        "the error of a step grows with its square: cubes sink into each other, are "
        "pushed out too fast, and the tower jumps or falls; a right engine keeps it at rest",
    PL_PARAMS(large_step_params),
    .build = large_step_build};

/* A tower of unit cubes far from the origin, along a direction and turned by an angle of its own:
 * numbers near 10 km are 2e-12 m apart, so nothing about it is exact. */

enum { FAR_FROM_ORIGIN_COUNT, FAR_FROM_ORIGIN_DISTANCE, FAR_FROM_ORIGIN_FRICTION };

static const pl_param far_from_origin_params[] = {
    PL_PARAM_CUBES,
    {"distance", 1e4, 0, 1e7, false, "m", "of the tower from the origin, along the floor"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void far_from_origin_build(pl_builder *b, const double *values)
{
    const double azimuth = 30 * PL_RADIANS_PER_DEGREE;
    begin(b);
    for (int k = 0; k < (int)values[FAR_FROM_ORIGIN_COUNT]; ++k) {
        pl_body cube = cube_at(values[FAR_FROM_ORIGIN_DISTANCE] * pl_cosine(azimuth),
                               values[FAR_FROM_ORIGIN_DISTANCE] * pl_sine(azimuth), half + k);
        cube.orientation[0] = pl_cosine(azimuth / 2);
        cube.orientation[3] = pl_sine(azimuth / 2);
        pl_build_rest(b, pl_build_body(b, &cube, "cube %d", k + 1));
    }
}

const pl_scenario pl_scenario_far_from_origin = {
    .name = "far-from-origin",
    .title = "Tower 10 km away",
    .description =
        "A tower of cubes 10 km from the origin, turned by 30 degrees: whether an engine "
        "works with differences of positions or with positions.",
    .reference = "every cube stays where it is",
    .expected = "ok: every cube at rest where it began, as at the origin",
    .source = "statics, by the law's indifference to place",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .provokes = "digits are lost where moments or planes are taken about the origin, so that "
                "contacts flicker and the tower creeps; a right engine is as good as at the origin "
                "except for the rounding of the positions",
    PL_PARAMS(far_from_origin_params),
    .build = far_from_origin_build};

/* A tower of unit cubes that overlap at the start, each with the next and the lowest with the
 * floor.
 *
 * Cube k = 1 .. n starts at z = k - 1/2 - k overlap and belongs at k - 1/2: to part them lifts cube
 * k by k overlap, and takes m g overlap n (n + 1) / 2 of energy, no more. */

enum { INITIAL_OVERLAP_COUNT, INITIAL_OVERLAP_OVERLAP, INITIAL_OVERLAP_FRICTION };

static const pl_param initial_overlap_params[] = {
    {"n", 5, 1, 100, true, "1", "number of cubes"},
    {"overlap", 0.01, 0, 0.2, false, "1", "of two neighbours at the start, over their side"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static void initial_overlap_build(pl_builder *b, const double *values)
{
    begin(b);
    for (int k = 1; k <= (int)values[INITIAL_OVERLAP_COUNT]; ++k) {
        pl_body cube = cube_at(0, 0, k - half);
        int index = pl_build_body(b, &cube, "cube %d", k);
        pl_build_rest(b, index);
        pl_build_start_off(b, index, 2, -(k * values[INITIAL_OVERLAP_OVERLAP]));
    }
}

const pl_scenario pl_scenario_initial_overlap = {
    .name = "initial-overlap",
    .title = "Tower that starts overlapping",
    .description = "Cubes that overlap by 1 % at the start: an engine must part them without "
                   "throwing them, as after any mistake of its own or of a user.",
    .reference = "the cubes come to stand on each other, z_k = k - 1/2 m",
    .expected = "ok: the cubes part without a jump and rest on each other",
    .source = "impenetrability and statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .provokes = "overlap turned into speed: the tower jumps and gains energy, or stays overlapped; "
                "a right engine parts it gently and leaves no more than its slop",
    PL_PARAMS(initial_overlap_params),
    .build = initial_overlap_build};
