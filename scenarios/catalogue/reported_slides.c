/* Slides that users of engines reported: fast, down a grid of ramps, until they stop, pushed along and
 * across the axes, and along an axis of the body alone. Friction acts against the path whatever the
 * distribution of the weight, so that a body that stays flat keeps its line and its heading. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* The distance after `time` from the speed v, which friction takes at the rate a. */
static double braking_path(double v, double a, double time)
{
    const double t = a > 0 ? fmin(time, v / a) : time;
    return v * t - a * t * t / 2;
}

/* A small cube slides fast over the floor. It stays flat as long as friction < 1. */

enum { FAST_SPEED };

static const pl_param fast_params[] = {
    {"speed", 6, 0.1, 100, false, "m/s", "at the start"},
    {"friction", 0.5, 0, 0.95, false, "1",
     "Coulomb coefficient; below 1, where the cube would tip"},
    PL_PARAM_STEP(0.005),
    PL_PARAM_DURATION(2),
};

static void fast_build(pl_builder *b, const double *values)
{
    const double half = 0.05, v = values[FAST_SPEED]; /* m, m/s */
    pl_build_floor(b);
    pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 0, half);
    cube.mass = 0.2;
    cube.velocity[0] = v;
    const double distance = braking_path(v, b->scene->materials[0].friction * b->gravity, b->end);
    const pl_straight path = {.along = pl_axis_x,
                              .up = pl_axis_z,
                              .distance = distance,
                              .until = b->end,
                              .size = 2 * half};
    pl_build_straight(b, pl_build_body(b, &cube, "cube"), &path);
}

const pl_scenario pl_scenario_fast_slide = {
    .name = "fast-slide",
    .title = "Fast slide without lift",
    .description = "A small cube slides fast over the floor until friction stops it: whether it "
                   "stays flat, on its line and on the floor.",
    .reference = "v^2 / (2 friction g) along the line, no lift, no turn",
    .expected = "ok: the cube slides flat and stops after 3.67 m",
    .source = "Coulomb's law; moments about the centre of mass",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "friction < 1, else the cube tips",
    .symptom = "the cube rises by 0.3 m and tumbles",
    .threads = "Genesis-Embodied-AI/Genesis#3115, Genesis-Embodied-AI/Genesis#3126",
    PL_PARAMS(fast_params),
    .build = fast_build};

/* Slabs on ramps: five angles by five coefficients.
 *
 * With tan(angle) below the coefficient a slab is held, else a = g (sin - friction cos). It is judged
 * at the end of the run or 4 m down the ramp, which is shorter than what is left of it. */

static const pl_param grid_params[] = {
    PL_PARAM_TIME(1),
};

static const double ramp_half_length = 2.5, ramp_half_height = 0.05; /* m */
static const double slab_half = 0.2, slab_half_height = 0.05;        /* m */
static const double slab_path = 4; /* m: the longest that is judged */

/* Adds a ramp that rises along y, at (x, y), and a slab of `material` on it. */
static void add_ramp(pl_builder *b, double x, double y, double degrees, int material)
{
    const double friction = b->scene->materials[material].friction;
    const double angle = PL_RADIANS_PER_DEGREE * degrees;
    const double s = pl_sine(angle), c = pl_cosine(angle), up_ramp = 2.2; /* m */
    const double over = ramp_half_height + slab_half_height;
    pl_body body = pl_body_at(pl_shape_box(0.5, ramp_half_length, ramp_half_height), x, y, 0);
    body.is_static = true;
    body.material = material;
    pl_turn_about_axis(&body, 0, angle);
    pl_build_body(b, &body, "ramp %g at %g deg", friction, degrees);
    body.is_static = false;
    body.mass = 16;
    body.shape = pl_shape_box(slab_half, slab_half, slab_half_height);
    body.position[1] = y + up_ramp * c - over * s;
    body.position[2] = up_ramp * s + over * c;
    const double a = fmax(0, b->gravity * (s - friction * c));
    const double until = a > 0 ? fmin(b->end, sqrt(2 * slab_path / a)) : b->end;
    const double down[3] = {0, -c, -s}, normal[3] = {0, -s, c};
    const pl_straight path = {.along = down,
                              .up = normal,
                              .distance = a * until * until / 2,
                              .until = until,
                              .size = 2 * slab_half};
    const int slab = pl_build_body(b, &body, "friction %g at %g deg", friction, degrees);
    pl_build_straight(b, slab, &path);
}

static void grid_build(pl_builder *b, const double *values)
{
    static const struct {
        const char *name;
        double friction;
    } materials[] = {{"0.1", 0.1}, {"0.3", 0.3}, {"0.5", 0.5}, {"0.7", 0.7}, {"1", 1}};
    static const double degrees[] = {3, 10, 20, 30, 40};
    (void)values;
    for (int k = 0; k < 5; ++k) {
        const int material = pl_build_material(b, materials[k].name, materials[k].friction, 0);
        for (int i = 0; i < 5 && b->status == PL_OK; ++i) {
            add_ramp(b, 1.5 * k, 8 * i, degrees[i], material);
        }
    }
}

const pl_scenario pl_scenario_ramp_grid = {
    .name = "ramp-grid",
    .title = "Grid of ramps",
    .description = "Slabs on ramps at 3 to 40 degrees, with friction 0.1 to 1: which of the 25 are "
                   "held, and how far the others slide.",
    .reference = "held iff tan(angle) < friction, else a = g (sin - friction cos)",
    .expected = "ok: 15 slabs are held, 10 slide as far as Coulomb's law says",
    .source = "Coulomb's law on an inclined plane",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "slabs that friction must hold slide, or slide as on ice",
    .threads = "newton-physics/newton#2881, newton-physics/newton#3492, "
               "newton-physics/newton#2549, Genesis-Embodied-AI/Genesis#3051",
    PL_PARAMS(grid_params),
    .build = grid_build};

/* Three cubes slide over one slab until they stop, each with its own friction against the slab:
 * v^2 / (2 friction g). */

enum { STOP_SPEED };

static const pl_param stop_params[] = {
    {"speed", 2, 0.1, 3, false, "m/s", "at the start"},
    PL_PARAM_TIME(2),
};

static void stop_build(pl_builder *b, const double *values)
{
    static const struct {
        const char *name;
        double friction;
    } cubes[] = {{"cube 0.2", 0.2}, {"cube 0.4", 0.4}, {"cube 0.7", 0.7}};
    const double half = 0.25, v = values[STOP_SPEED]; /* m, m/s */
    b->scene->materials[0].friction = 0.5;
    pl_body slab = pl_body_at(pl_shape_box(5, 5, 0.25), 0, 0, -0.25);
    slab.is_static = true;
    pl_build_body(b, &slab, "slab");
    for (int i = 0; i < 3; ++i) {
        pl_body cube = pl_body_at(pl_shape_box(half, half, half), 0, 2 * (i - 1), half);
        cube.material = pl_build_material(b, cubes[i].name, cubes[i].friction, 0);
        cube.mass = 125;
        cube.velocity[0] = v;
        pl_build_pair(b, 0, cube.material, cubes[i].friction);
        const pl_straight path = {.along = pl_axis_x,
                                  .up = pl_axis_z,
                                  .distance =
                                      braking_path(v, cubes[i].friction * b->gravity, b->end),
                                  .until = b->end,
                                  .size = 2 * half};
        pl_build_straight(b, pl_build_body(b, &cube, "%s", cubes[i].name), &path);
    }
}

const pl_scenario pl_scenario_stopping_distances = {
    .name = "stopping-distances",
    .title = "Stopping distances",
    .description = "Three cubes slide over one slab until friction stops them, each with its own "
                   "coefficient: how far they come.",
    .reference = "v^2 / (2 friction g)",
    .expected = "ok: the cubes stop after 1.02, 0.51 and 0.29 m",
    .source = "Coulomb's law",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "friction is weaker or stronger than its coefficient",
    .threads = "newton-physics/newton#2549, newton-physics/newton#2581",
    PL_PARAMS(stop_params),
    .build = stop_build};

/* A constant level force pushes three slabs, along x, at 22.5 and at 45 degrees.
 *
 * The limit of friction is the same in each direction: a slab of mass m moves iff F > mu m g, then with
 * a = F / m - mu g along the force, without turning. A friction pyramid along the axes has a limit up to
 * sqrt(2) times as large between them. The force acts at the centre, half the height over the floor:
 * the slab stays flat as long as F < m g times 5, its width over its height. */

enum { PUSH_FORCE };

static const pl_param push_params[] = {
    {"force", 12, 0, 40, false, "N", "on each slab of 1 kg"},
    {"friction", 1, 0, 4, false, "1", "Coulomb coefficient"},
    PL_PARAM_STEP(1.0 / 240),
    PL_PARAM_DURATION(1),
};

static void push_build(pl_builder *b, const double *values)
{
    static const double degrees[] = {0, 22.5, 45};
    const double force = values[PUSH_FORCE];
    const double a = fmax(0, force - b->scene->materials[0].friction * b->gravity);
    pl_build_floor(b);
    for (int i = 0; i < 3; ++i) {
        const pl_body slab = pl_body_at(pl_shape_box(0.5, 0.5, 0.1), 0, 4 * i, 0.1);
        double along[3];
        pl_azimuth(degrees[i], along);
        const int index = pl_build_body(b, &slab, "at %g deg", degrees[i]);
        pl_build_force(b, &(pl_force){.body = index,
                                      .force = {force * along[0], force * along[1], 0},
                                      .until = (double)INFINITY});
        const pl_straight path = {.along = along,
                                  .up = pl_axis_z,
                                  .distance = a * b->end * b->end / 2,
                                  .until = b->end,
                                  .size = 1};
        pl_build_straight(b, index, &path);
    }
}

const pl_scenario pl_scenario_push_directions = {
    .name = "push-directions",
    .title = "Push along and across the axes",
    .description = "The same level force pushes three slabs in three directions: whether friction "
                   "has the same limit in each.",
    .reference = "a = F / m - friction g along the force where that is above 0, else held",
    .expected = "ok: the three slabs move alike, each along its force",
    .source = "Coulomb's cone",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "a force that moves a body along an axis does not move it at 45 degrees",
    .threads = "dartsim/dart#841, jrouwe/JoltPhysics#572, gazebosim/gazebo-classic#1153",
    PL_PARAMS(push_params),
    .build = push_build};

/* Three long boxes slide along their long sides, turned by 15, 30 and 45 degrees about the vertical.
 *
 * All friction is against the velocity. The balance of pitch puts the centre of pressure on the line of
 * the path, friction times half the height ahead of the centre, whatever the distribution: there is no
 * moment about the vertical. The box goes straight for v^2 / (2 friction g), and keeps its heading. */

enum { HEADING_SPEED };

static const pl_param heading_params[] = {
    {"speed", 4, 0.1, 100, false, "m/s", "at the start"},
    {"friction", 0.5, 1e-3, 3, false, "1", "Coulomb coefficient; below 6, where a box would tip"},
    PL_PARAM_TIME(2),
};

static void heading_build(pl_builder *b, const double *values)
{
    static const double degrees[] = {15, 30, 45};
    const double v = values[HEADING_SPEED];
    const double distance = braking_path(v, b->scene->materials[0].friction * b->gravity, b->end);
    pl_build_floor(b);
    for (int i = 0; i < 3; ++i) {
        double along[3];
        pl_azimuth(degrees[i], along);
        pl_body box = pl_body_at(pl_shape_box(0.6, 0.2, 0.1), 0, 3 * i, 0.1);
        box.mass = 10;
        pl_turn_about_axis(&box, 2, PL_RADIANS_PER_DEGREE * degrees[i]);
        box.velocity[0] = v * along[0];
        box.velocity[1] = v * along[1];
        const pl_straight path = {
            .along = along, .up = pl_axis_z, .distance = distance, .until = b->end, .size = 0.2};
        pl_build_straight(b, pl_build_body(b, &box, "at %g deg", degrees[i]), &path);
    }
}

const pl_scenario pl_scenario_sliding_heading = {
    .name = "sliding-heading",
    .title = "Line and heading of sliding boxes",
    .description = "Long boxes slide along their long sides at three angles to the axes: whether "
                   "each keeps its line and its heading.",
    .reference = "v^2 / (2 friction g) straight on, heading unchanged",
    .expected = "ok: the boxes go straight and stop without turning",
    .source = "Coulomb's law; moments about the centre of mass",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "a sliding box is pulled towards an axis of the world, or turns",
    .threads = "dimforge/rapier#137, DanielChappuis/reactphysics3d#85, jrouwe/JoltPhysics#983, "
               "bulletphysics/bullet3#2402",
    PL_PARAMS(heading_params),
    .build = heading_build};
