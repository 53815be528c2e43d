/* Rows of dominoes along x or a spiral, the first of them tipped over. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* Half extents of a domino, over its height. */
static const double domino_half[3] = {0.075, 0.25, 0.5};

/* A domino of 1 kg and `size` m of height, upright on the floor. */
static pl_body domino_at(double size, double x, double y)
{
    const double *h = domino_half;
    return pl_body_at(pl_shape_box(h[0] * size, h[1] * size, h[2] * size), x, y, h[2] * size);
}

/* Lets a domino that faces along the level unit vector (dx, dy) turn about its leading lower edge
 * with `push` times the spin that just tips it. */
static void tip(const pl_builder *b, double size, double push, double dx, double dy,
                pl_body *domino)
{
    const double x = domino_half[0] * size, z = domino_half[2] * size, reach = sqrt(x * x + z * z);
    const double spin = push * sqrt(1.5 * b->gravity * (reach - z)) / reach;
    domino->angular_velocity[0] = spin * (0 - dy);
    domino->angular_velocity[1] = spin * dx;
    domino->velocity[0] = spin * z * dx;
    domino->velocity[1] = spin * z * dy;
    domino->velocity[2] = spin * x;
}

/* Adds `count` dominoes along x, the first at x = 0, which is tipped, and `spacing` times the size
 * from each to the next. */
static void build_row(pl_builder *b, int count, double size, double spacing, double push)
{
    for (int i = 0; i < count; ++i) {
        pl_body domino = domino_at(size, i * spacing * size, 0);
        if (i == 0) {
            tip(b, size, push, 1, 0, &domino);
        }
        pl_build_body(b, &domino, "domino %d", i + 1);
    }
}

/* A row of dominoes of which the first is tipped over.
 *
 * It starts upright, turning about its leading lower edge with `push` times the spin that just
 * carries it over: 1/2 I w^2 = m g (R - height / 2), I = 4/3 m R^2, R half the diagonal of its
 * side. All lengths are proportional to `size`, and all times to its square root: the wave runs
 * sqrt(s) times as fast in a row s times as large. */

enum { DOMINOES_COUNT, DOMINOES_SIZE, DOMINOES_SPACING, DOMINOES_PUSH, DOMINOES_FRICTION };

static const pl_param dominoes_params[] = {
    {"n", 20, 1, 2000, true, "1", "dominoes"},
    {"size", 1, 0.01, 100, false, "m", "height of a domino; it is half as wide and 0.15 as thick"},
    {"spacing", 0.5, 0.2, 0.9, false, "1", "from one to the next, over the height"},
    {"push", 1.2, 0, 10, false, "1", "spin of the first, over that which just tips it"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void dominoes_build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    build_row(b, (int)values[DOMINOES_COUNT], values[DOMINOES_SIZE], values[DOMINOES_SPACING],
              values[DOMINOES_PUSH]);
}

const pl_scenario pl_scenario_dominoes = {
    .name = "dominoes",
    .title = "Row of dominoes",
    .description = "A row of dominoes, the first of them tipped over: a wave of impacts that every "
                   "engine must hand on without overlap.",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE "; in a row s "
                 "times as large all speeds are sqrt(s) times as high",
    .expected = "ok: the wave runs to the last domino, with push above 1; no two bodies overlap at "
                "any time",
    .source = PL_CHAOTIC_SOURCE "; dimensional analysis",
    PL_CHAOTIC_JUDGED,
    PL_PARAMS(dominoes_params),
    .build = dominoes_build};

/* A row of dominoes falls into a pile of cubes.
 *
 * The pile stands before the last domino, within its reach: 3 x 3 stacks of cubes, each cube set
 * off at random by up to 0.05 of its side, which leaves every stack standing by itself. Chaotic:
 * judged by what all right answers have in common (converged.c), and as an ensemble. */

enum { DOMINO_INTO_PILE_COUNT, DOMINO_INTO_PILE_LAYERS, DOMINO_INTO_PILE_FRICTION };
enum { ROWS = 3 };

static const double size = 1, spacing = 0.5, push = 1.2; /* of the dominoes */
static const double side = 0.3, apart = 0.02;            /* m, of the cubes */
static const double density = 10;                        /* kg/m^3 */

static const pl_param domino_into_pile_params[] = {
    {"n", 10, 1, 1000, true, "1", "dominoes, of 1 kg and 1 m"},
    {"layers", 3, 1, 5, true, "1", "of 3 x 3 cubes of 0.3 m"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(5),
};

static void build_pile(pl_builder *b, pl_random *random, double near, int layers)
{
    const double offset = 0.05 * side, pitch = side + 2 * offset + apart;
    for (int i = 0; i < ROWS * ROWS * layers; ++i) {
        const int layer = i / (ROWS * ROWS);
        const double dx = pl_draw_uniform(random, -offset, offset);
        const double dy = pl_draw_uniform(random, -offset, offset);
        pl_body cube = pl_body_at(
            pl_shape_box(side / 2, side / 2, side / 2), near + (i % ROWS + 0.5) * pitch + dx,
            (i / ROWS % ROWS - (ROWS - 1) / 2.0) * pitch + dy, (layer + 0.5) * side);
        cube.mass = density * side * side * side;
        pl_build_body(b, &cube, "cube %d", i + 1);
    }
}

static void domino_into_pile_build(pl_builder *b, const double *values)
{
    const int count = (int)values[DOMINO_INTO_PILE_COUNT];
    pl_build_floor(b);
    build_row(b, count, size, spacing, push);
    const double last = (count - 1) * spacing * size;
    build_pile(b, &b->random, last + spacing * size, (int)values[DOMINO_INTO_PILE_LAYERS]);
}

const pl_scenario pl_scenario_domino_into_pile = {
    .name = "domino-into-pile",
    .title = "Dominoes fall into a pile",
    .description = "A row of dominoes, of which the last falls into stacks of cubes set off at "
                   "random: an orderly wave that ends in a chaotic one.",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,
    .expected = "ok: the wave runs into the pile; no two bodies overlap at any time",
    .source = PL_CHAOTIC_SOURCE,
    PL_CHAOTIC_JUDGED,
    PL_PARAMS(domino_into_pile_params),
    .build = domino_into_pile_build};

/* Dominoes along a spiral, of which the innermost is tipped over.
 *
 * On the spiral r = inner + turn_width angle / (2 pi), each domino faces along the tangent, half its
 * height from the next. Those of neighbouring turns do not reach each other. */

enum { DOMINO_SPIRAL_COUNT, DOMINO_SPIRAL_FRICTION };

static const double inner = 2, turn_width = 1; /* m */

static const pl_param domino_spiral_params[] = {
    {"n", 150, 1, 1000, true, "1", "dominoes, of 1 kg and 1 m"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(12),
};

/* Turns an unturned body about z until its x axis is the level unit vector (dx, dy). */
static void face(pl_body *body, double dx, double dy)
{
    body->orientation[0] = sqrt(fmax(1 + dx, 0) / 2);
    body->orientation[3] = copysign(sqrt(fmax(1 - dx, 0) / 2), dy);
}

static void domino_spiral_build(pl_builder *b, const double *values)
{
    const double widening = turn_width / (2 * 3.141592653589793); /* m per rad */
    double angle = 0;
    pl_build_floor(b);
    for (int i = 0; i < (int)values[DOMINO_SPIRAL_COUNT]; ++i) {
        const double radius = inner + widening * angle;
        const double c = pl_cosine_of_any(angle), s = pl_sine_of_any(angle);
        /* The point (radius c, radius s) moves by this per rad. */
        const double x = widening * c - radius * s, y = widening * s + radius * c;
        const double along = sqrt(x * x + y * y);
        pl_body domino = domino_at(size, radius * c, radius * s);
        face(&domino, x / along, y / along);
        if (i == 0) {
            tip(b, size, push, x / along, y / along, &domino);
        }
        pl_build_body(b, &domino, "domino %d", i + 1);
        angle += spacing * size / along;
    }
}

const pl_scenario pl_scenario_domino_spiral = {
    .name = "domino-spiral",
    .title = "Spiral of dominoes",
    .description = "Dominoes along a spiral, the innermost tipped over: the wave turns all the way "
                   "and leaves one long chain of bodies that lean on each other.",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,
    .expected = "ok: the wave runs to the last domino; no two bodies overlap at any time",
    .source = PL_CHAOTIC_SOURCE,
    PL_CHAOTIC_JUDGED,
    PL_PARAMS(domino_spiral_params),
    .build = domino_spiral_build};
