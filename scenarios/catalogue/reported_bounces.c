/* Rebounds that users of engines reported: several coefficients at once, elastic for a long time,
 * slow, late, and where there must be none. */
#include "catalogue.h"

#include <math.h>

/* A fall from rest over a height: its time, and that of the later flights by the coefficient. */
static double fall_time(const pl_builder *b, double height)
{
    return sqrt(2 * height / b->gravity);
}

/* Expects the first `count` apexes after impacts that end within the run: apex k is e^(2 k) h over the
 * floor, at t (1 + 2 e + ... + 2 e^(k - 1) + e^k) with t = sqrt(2 h / g). Each is judged to 6 % of its
 * own height. */
static void expect_apexes(pl_builder *b, int ball, double height, double e, int count)
{
    const double fall = fall_time(b, height);
    double start = fall, part = e;
    for (int k = 1; k <= count && start + part * fall + 2 * b->scene->dt < b->end; ++k) {
        const double over_floor = height * part * part;
        pl_expect_value apex = pl_value_within(b, ball, PL_QUANTITY_APEX, pl_axis_z,
                                               over_floor - height, 0.06 * over_floor);
        apex.number = k;
        pl_build_value(b, &apex);
        start += 2 * part * fall;
        part *= e;
    }
}

/* Adds a ball whose lowest point is at `height`, and expects that it stays in its place and does not
 * spin. */
static int add_ball(pl_builder *b, const char *name, int material, double radius, double x,
                    double height)
{
    pl_body ball = pl_body_at(pl_shape_sphere(radius), x, 0, radius + height);
    ball.material = material;
    const int index = pl_build_body(b, &ball, "%s", name);
    pl_build_none_within(b, index, PL_QUANTITY_POSITION, PL_ALONG_X | PL_ALONG_Y, 0.02 * radius);
    pl_build_none_within(b, index, PL_QUANTITY_SPIN, PL_ALONG_ALL, 0.06);
    return index;
}

/* Four balls fall from one height, each with a coefficient of its own. The first apex of each is e^2
 * of the height, by v' = -e v. */

enum { DROP_HEIGHT };

static const pl_param drop_params[] = {
    {"height", 2, 0.01, 100, false, "m", "of the lowest points above the floor"},
    PL_PARAM_TIME(2),
};

static void drop_build(pl_builder *b, const double *values)
{
    static const struct {
        const char *name;
        double restitution;
    } balls[] = {{"e 0.3", 0.3}, {"e 0.5", 0.5}, {"e 0.8", 0.8}, {"e 0.95", 0.95}};
    pl_build_floor(b);
    for (int i = 0; i < 4; ++i) {
        const double e = balls[i].restitution;
        const int material = pl_build_material(b, balls[i].name, 0, e);
        const int ball = add_ball(b, balls[i].name, material, 0.1, i - 1.5, values[DROP_HEIGHT]);
        expect_apexes(b, ball, values[DROP_HEIGHT], e, 1);
    }
}

const pl_scenario pl_scenario_drop_coefficients = {
    .name = "drop-coefficients",
    .title = "Four coefficients of restitution",
    .description = "Four spheres fall from one height onto one floor, each with its own "
                   "coefficient of restitution: whether each returns to its own height.",
    .reference = "first apex e^2 H over the floor",
    .expected = "ok: the balls return to 9, 25, 64 and 90 % of the height",
    .source = "Newton 1687, Principia, scholium to the laws: v' = -e v; conservation of energy in "
              "flight",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "apexes within the run",
    .symptom = "balls return to about 1 % of the height whatever the coefficient, or fly away",
    .threads = "dimforge/rapier#974, newton-physics/newton#1289",
    PL_PARAMS(drop_params),
    .build = drop_build};

/* A ball bounces elastically for a long time.
 *
 * Its energy stays that of the start, and each flight lasts 2 sqrt(2 h / g) and returns to h. The first
 * flight and the last whole one are judged by their highest points, and the energy at the end: 6 % of
 * m g h, over as many bounces as the run has. */

enum { ELASTIC_HEIGHT };

static const double elastic_radius = 0.5; /* m */

static const pl_param elastic_params[] = {
    {"height", 5, 0.01, 100, false, "m", "of the lowest point above the floor"},
    PL_PARAM_TIME(20),
};

static void elastic_build(pl_builder *b, const double *values)
{
    const double height = values[ELASTIC_HEIGHT], fall = fall_time(b, height);
    b->scene->materials[0].restitution = 1;
    pl_build_floor(b);
    const int ball = add_ball(b, "ball", 0, elastic_radius, 0, height);
    const double flights = floor((b->end / fall - 1) / 2);
    for (int i = 0; i < 2 && i < flights; ++i) {
        pl_expect_value apex =
            pl_value_within(b, ball, PL_QUANTITY_APEX, pl_axis_z, 0, 0.06 * height);
        apex.from = fall * (1 + 2 * (i == 0 ? 0 : flights - 1));
        apex.until = fmin(apex.from + 2 * fall, b->end);
        pl_build_value(b, &apex);
    }
    pl_build_within(b, ball, PL_QUANTITY_ENERGY, pl_axis_z, 0, 0.06 * b->gravity * height);
    if (b->end > fall) { /* so that a ball that hangs in the air is off */
        const double most = b->gravity * fall;
        pl_expect_value speed =
            pl_value_within(b, ball, PL_QUANTITY_TOP_SPEED, pl_axis_z, most, 0.06 * most);
        speed.bound = PL_BOUND_AT_LEAST;
        pl_build_value(b, &speed);
    }
}

const pl_scenario pl_scenario_elastic_bounces = {
    .name = "elastic-bounces",
    .title = "Elastic ball for a long time",
    .description = "A sphere bounces elastically on the floor for as long as the run lasts: "
                   "whether its bounces keep their height and their energy.",
    .reference = "energy constant; every apex at the start; period 2 sqrt(2 H / g)",
    .expected = "ok: the ball still returns to its start at the end",
    .source = "conservation of energy",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "whole flights within the run",
    .symptom = "an elastic ball rises higher with each bounce, or its bounces die down",
    .threads = "jrouwe/JoltPhysics#1286, dimforge/rapier#97, godotengine/godot#52550, "
               "erincatto/box2d#76, bulletphysics/bullet3#1530",
    PL_PARAMS(elastic_params),
    .build = elastic_build};

/* A ball strikes a wall slowly, without gravity.
 *
 * The gap of 0.8 m to the wall is crossed in 0.8 m / v; from then on it moves back at e v. The law has
 * no least speed. */

enum { SLOW_SPEED };

static const pl_param slow_params[] = {
    {"speed", 1, 1e-3, 100, false, "m/s", "of the ball, towards the wall"},
    PL_PARAM_RESTITUTION(1),
    PL_PARAM_STEP(1.0 / 240),
    PL_PARAM_DURATION(2),
};

static void slow_build(pl_builder *b, const double *values)
{
    const double gap = 0.8, speed = values[SLOW_SPEED]; /* m, m/s */
    const double e = b->scene->materials[0].restitution, path = speed * b->end;
    const bool strikes = path > gap;
    b->scene->gravity[2] = 0;
    pl_body wall = pl_body_at(pl_shape_box(0.1, 1, 1), 1.1, 0, 0);
    wall.is_static = true;
    pl_build_body(b, &wall, "wall");
    pl_body ball = pl_body_at(pl_shape_sphere(0.2), 0, 0, 0);
    ball.velocity[0] = speed;
    const int index = pl_build_body(b, &ball, "ball");
    pl_build_within(b, index, PL_QUANTITY_POSITION, pl_axis_x,
                    strikes ? gap - e * (path - gap) : path, 0.06 * gap);
    pl_build_within(b, index, PL_QUANTITY_VELOCITY, pl_axis_x, strikes ? -e * speed : speed,
                    0.06 * speed);
    pl_build_none_within(b, index, PL_QUANTITY_POSITION, PL_ALONG_Y | PL_ALONG_Z, 0.004);
}

const pl_scenario pl_scenario_slow_impact = {
    .name = "slow-impact",
    .title = "Slow impact on a wall",
    .description = "A ball strikes a wall slowly, without gravity: whether it leaves at its "
                   "coefficient, without a least speed and without sticking.",
    .reference = "touch at 0.8 m / v, then v' = -e v",
    .expected = "ok: the ball comes back at the speed of its coefficient",
    .source = "Newton 1687, Principia, scholium to the laws: v' = -e v",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .symptom = "the ball stays at the wall, or comes back too slowly",
    .threads = "bulletphysics/bullet3#3094, erincatto/box2d#89",
    PL_PARAMS(slow_params),
    .build = slow_build};

/* A ball bounces until its bounces are small. Apex k is e^(2 k) h over the floor. */

enum { LATE_HEIGHT, LATE_RESTITUTION, LATE_BOUNCES };

static const pl_param late_params[] = {
    {"height", 2, 0.01, 100, false, "m", "of the lowest point above the floor"},
    PL_PARAM_RESTITUTION(0.5),
    {"bounces", 3, 1, 20, true, "1", "how many of them are judged"},
    PL_PARAM_STEP(1.0 / 240),
    PL_PARAM_DURATION(3),
};

static void late_build(pl_builder *b, const double *values)
{
    const double height = values[LATE_HEIGHT], e = values[LATE_RESTITUTION];
    pl_build_floor(b);
    const int ball = add_ball(b, "ball", 0, 0.5, 0, height);
    if (e > 0) {
        expect_apexes(b, ball, height, e, (int)values[LATE_BOUNCES]);
    }
    if (e < 1 && b->end > fall_time(b, height) * (1 + e) / (1 - e)) {
        pl_build_within(b, ball, PL_QUANTITY_POSITION, pl_axis_z, -height, 0.01);
    }
}

const pl_scenario pl_scenario_late_bounces = {
    .name = "late-bounces",
    .title = "Late bounces",
    .description = "A sphere bounces until its bounces are small: whether the later ones still "
                   "have their coefficient.",
    .reference = "apex e^(2 k) H after bounce k; at rest after sqrt(2 H / g) (1 + e) / (1 - e)",
    .expected = "ok: each apex at e^2 of the one before, then rest",
    .source = "Newton 1687, Principia, scholium to the laws: v' = -e v; conservation of energy in "
              "flight",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "apexes within the run",
    .symptom = "the ball stops after its second impact, since impacts below a speed do not rebound",
    .threads = "NVIDIAGameWorks/PhysX#351, bepu/bepuphysics2#3",
    PL_PARAMS(late_params),
    .build = late_build};

/* A box falls flat onto a box, both without restitution. After the impact both rest, and the upper one
 * never rises over its place. */

static const pl_param no_rebound_params[] = {
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(2),
};

static void no_rebound_build(pl_builder *b, const double *values)
{
    const double drop = 0.1, half = 0.05, size = 0.1, density = 1000; /* m, kg/m^3 */
    (void)values;
    pl_build_floor(b);
    pl_body box = pl_body_at(pl_shape_box(2 * half, 2 * half, half), 0, 0, half);
    box.mass = density * 32 * half * half * half;
    pl_build_rest_within(b, pl_build_body(b, &box, "lower"), size);
    box.shape = pl_shape_box(half, half, half);
    box.mass = density * 8 * half * half * half;
    box.position[2] = 3 * half;
    const int upper = pl_build_body(b, &box, "upper");
    pl_build_rest_within(b, upper, size);
    pl_build_start_off(b, upper, 2, drop);
    pl_expect_value apex =
        pl_value_within(b, upper, PL_QUANTITY_APEX, pl_axis_z, -drop, 0.01 * size);
    apex.from = fmin(fall_time(b, drop) + 3 * b->scene->dt, b->end);
    apex.bound = PL_BOUND_AT_MOST;
    pl_build_value(b, &apex);
}

const pl_scenario pl_scenario_no_rebound = {
    .name = "no-rebound",
    .title = "Box on a box without rebound",
    .description = "A box falls 0.1 m flat onto a larger box, without restitution: whether it "
                   "stays down.",
    .reference = "at rest on the lower box from the impact at sqrt(2 H / g) on",
    .expected = "ok: the upper box stays on the lower one",
    .source = "Newton's restitution of 0",
    .primary_error = "value_error",
    PL_ACCEPT_REPORTED,
    .validity = "three steps after the impact",
    .symptom = "the upper box rises again by about the height of its fall",
    .threads = "newton-physics/newton#1137, newton-physics/newton#3957, avianphysics/avian#593",
    PL_PARAMS(no_rebound_params),
    .build = no_rebound_build};
