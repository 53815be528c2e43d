/* Bodies on others that end beside or under them: a slide over a row of tiles, and a cube that bounces
 * on a pedestal smaller than itself. */
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

enum { SEAMS_SPEED, SEAMS_YAW, SEAMS_GAP, SEAMS_FRICTION };

static const double half = 0.25; /* m, of the cube */

static const pl_param seams_params[] = {
    {"speed", 2, 0.1, 20, false, "m/s", "of the cube at the start"},
    {"yaw", 0, 0, 45, false, "deg", "of its sides against the path"},
    {"gap", 0, 0, 0.01, false, "m", "between tiles"},
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
    for (int i = 0; i < count; ++i) {
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
    .source = "Coulomb's law and uniform deceleration; the symptom: rapier#142, bullet3#676, "
              "godot#21341",
    .primary_error = "value_error",
    PL_ACCEPT_FRICTION,
    .validity = "the tops of the tiles are level, and the cube does not tip",
    .provokes = "the side of the next tile is the nearest face while the cube approaches it: the "
                "cube stops, hops or turns at a seam",
    PL_PARAMS(seams_params),
    .build = seams_build};

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
    .source = "Newton's law of impact; the resultant passes through the centre of mass. The "
              "symptom: box3d#83",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "the apex, at (1 + e) sqrt(2 H / g), is within the run",
    .provokes = "restitution that acts point after point: the first point throws the cube over",
    PL_PARAMS(pedestal_params),
    .build = pedestal_build};
