/* Heavy loads on light cubes: dropped on a column, laid as a lid on a grid of columns, and on a raft
 * of cubes side by side.
 *
 * All bodies are boxes along the axes, stacked flush from the floor, and nothing restitutes. At rest
 * nothing moves: in each, the weight above a joint presses within the faces that meet there. A load
 * that falls flat stops at once, and so does everything below it: of all velocities after the impact
 * that contacts without restitution allow, the one of least kinetic energy is right (Moreau 1988),
 * and rest, which has none, is allowed, since contacts can pass the load's momentum, which acts
 * through its centre, on to the floor. So every body ends where the closed form of the stack has it,
 * at any ratio of masses. */
#include "catalogue.h"

static const double half = 0.5; /* m, of a cube; it weighs 1 kg */

#define PL_PARAM_LOAD(ratio, least)                                                                \
    {                                                                                              \
        "ratio", ratio, least, 1e6, false, "1", "mass of the load over that of a cube"             \
    }
#define PL_PARAM_DROP(height)                                                                      \
    {                                                                                              \
        "height", height, 0, 100, false, "m", "from which the load falls; 0: it lies there"        \
    }
#define PL_LOADED                                                                                  \
    .source = "statics; the plastic impact of least energy: Moreau 1988, Unilateral contact and "  \
              "dry friction in finite freedom dynamics",                                           \
    .primary_error = "rest_position_error", PL_ACCEPT_AT_REST

/* Adds a cube that rests at (x, y) in the layer, from 0. */
static void build_cube(pl_builder *b, double x, double y, int layer)
{
    pl_body cube = pl_body_at(pl_shape_box(half, half, half), x, y, layer + half);
    pl_build_rest(b, pl_build_body(b, &cube, "cube %d", b->scene->body_count));
}

/* Adds a load that comes to rest at x, its lower face at z, from `drop` above. */
static void build_load(pl_builder *b, pl_shape box, double mass, double x, double z, double drop)
{
    pl_body load = pl_body_at(box, x, 0, z + box.half_extents[2]);
    load.mass = mass;
    const int index = pl_build_body(b, &load, "load");
    pl_build_rest(b, index);
    pl_build_start_off(b, index, 2, drop);
}

/* ---- On a column ---- */

enum {
    DROPPED_LOAD_COUNT,
    DROPPED_LOAD_RATIO,
    DROPPED_LOAD_HEIGHT,
    DROPPED_LOAD_OFFSET,
    DROPPED_LOAD_FRICTION
};

static const pl_param dropped_load_params[] = {
    {"n", 3, 1, 100, true, "1", "cubes of the column"},
    PL_PARAM_LOAD(100, 1),
    PL_PARAM_DROP(1),
    {"offset", 0, 0, 0.4, false, "m", "of the load's centre from that of the column"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(3),
};

static void dropped_load_build(pl_builder *b, const double *values)
{
    const int count = (int)values[DROPPED_LOAD_COUNT];
    pl_build_floor(b);
    b->scene->collapse_distance = half;
    for (int layer = 0; layer < count; ++layer) {
        build_cube(b, 0, 0, layer);
    }
    build_load(b, pl_shape_box(half, half, half), values[DROPPED_LOAD_RATIO],
               values[DROPPED_LOAD_OFFSET], count, values[DROPPED_LOAD_HEIGHT]);
}

const pl_scenario pl_scenario_dropped_load = {
    .name = "dropped-load",
    .title = "Load dropped on a column",
    .description = "A heavy cube falls flat on a column of light ones: whether an impact passes "
                   "through them to the floor, without sinking in or throwing them about.",
    .reference = "cube k stays at z_k = k - 1/2 m, and the load comes to rest at z = n + 1/2 m, at "
                 "any ratio",
    .expected = "ok: the column stays where it is, and the load rests on it",
    PL_LOADED,
    .provokes =
        "the momentum of a large mass through small ones: cubes are pressed into each other "
        "and the floor and come back as springs, or the load sinks into them; a right "
        "engine stops it at once",
    PL_PARAMS(dropped_load_params),
    .build = dropped_load_build};

/* ---- A lid on columns ----
 *
 * k x k columns of cubes, `gap` apart, under a plate of 0.2 m that covers them all. How they share
 * its weight is not determined, where they all stand is. */

enum { LID_SIDE, LID_LAYERS, LID_RATIO, LID_HEIGHT, LID_GAP, LID_FRICTION };

static const pl_param lid_params[] = {
    {"k", 3, 1, 30, true, "1", "columns along either side of the square"},
    {"layers", 2, 1, 30, true, "1", "cubes of a column"},
    PL_PARAM_LOAD(1000, 1e-3),
    PL_PARAM_DROP(0),
    {"gap", 0.25, 0, 10, false, "m", "between two columns"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

/* Adds side * side columns about the z axis. */
static void build_columns(pl_builder *b, int side, int layers, double gap)
{
    pl_build_floor(b);
    for (int i = 0; i < side * side * layers; ++i) {
        const int column = i % side, row = i / side % side, layer = i / side / side;
        build_cube(b, (column - half * (side - 1)) * (1 + gap),
                   (row - half * (side - 1)) * (1 + gap), layer);
    }
}

static void lid_build(pl_builder *b, const double *values)
{
    const double gap = values[LID_GAP], edge = half * (values[LID_SIDE] * (1 + gap) - gap);
    b->scene->collapse_distance = 0.1;
    build_columns(b, (int)values[LID_SIDE], (int)values[LID_LAYERS], gap);
    build_load(b, pl_shape_box(edge, edge, 0.1), values[LID_RATIO], 0, values[LID_LAYERS],
               values[LID_HEIGHT]);
}

const pl_scenario pl_scenario_lid = {
    .name = "lid",
    .title = "Heavy lid on columns",
    .description = "A heavy plate lies on a square of columns of light cubes, or falls on them: "
                   "whether a weight that many share in no determined way lets any of them move.",
    .reference = "every cube stays where it is, and the plate comes to rest at z = layers + 0.1 m",
    .expected = "ok: every cube where it began, and the plate level on top of them",
    PL_LOADED,
    .provokes = "one large mass in many contacts at once: an iteration passes its weight to a few "
                "columns at a time, so that cubes are squeezed and the plate tilts; a right engine "
                "holds it level",
    PL_PARAMS(lid_params),
    .build = lid_build};

/* ---- A load on a raft ----
 *
 * k x k x layers cubes that touch their neighbours, and a cube of `size` in the middle of them. What
 * lies beside each other moves neither towards nor past each other, so that what they might press
 * sideways is 0, and each column stands for itself. */

enum { RAFT_SIDE, RAFT_LAYERS, RAFT_RATIO, RAFT_HEIGHT, RAFT_SIZE, RAFT_GAP, RAFT_FRICTION };

static const pl_param raft_params[] = {
    {"k", 5, 1, 30, true, "1", "cubes along either side of the raft"},
    {"layers", 2, 1, 30, true, "1", "of cubes"},
    PL_PARAM_LOAD(1000, 1),
    PL_PARAM_DROP(0),
    {"size", 2, 0.1, 30, false, "m", "side of the load"},
    {"gap", 0, 0, 1, false, "m", "between two neighbours; 0: they touch"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void raft_build(pl_builder *b, const double *values)
{
    const double edge = values[RAFT_SIZE] / 2;
    b->scene->collapse_distance = edge < half ? edge : half;
    build_columns(b, (int)values[RAFT_SIDE], (int)values[RAFT_LAYERS], values[RAFT_GAP]);
    build_load(b, pl_shape_box(edge, edge, edge), values[RAFT_RATIO], 0, values[RAFT_LAYERS],
               values[RAFT_HEIGHT]);
}

const pl_scenario pl_scenario_raft = {
    .name = "raft",
    .title = "Load on a raft of cubes",
    .description = "A heavy cube lies on the middle of a raft of light cubes side by side, or "
                   "falls on it: whether a weight that a few of many bodies carry sinks in.",
    .reference = "every cube stays where it is, and the load comes to rest at "
                 "z = layers + size / 2",
    .expected = "ok: every cube where it began, and the load level on top of them",
    PL_LOADED,
    .provokes = "one large mass in a large group of bodies: a solver whose work grows with the "
                "group gives it a few iterations, and the load sinks; a right engine holds it at "
                "any size of the raft",
    PL_PARAMS(raft_params),
    .build = raft_build};
