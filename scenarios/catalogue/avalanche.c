/* Stones that run down a slope to the floor at its foot.
 *
 * The slope is the plane through the y axis with normal n = (sin a, 0, cos a), so that downhill is
 * t = (cos a, 0, -sin a) and its foot the line x = z = 0, where the floor z = 0 begins. The stones
 * start at rest and apart, each in a cell of a lattice along -t, y and n that lies on the slope,
 * `distance` from the foot and about four times as long and as wide as it is high. The motion is
 * chaotic and has no closed form; it is judged by what all right answers have in common: see
 * converged.c. */
#include "base/trigonometry.h"
#include "catalogue.h"
#include "solids.h"

#include <stdio.h>

enum { AVALANCHE_COUNT, AVALANCHE_ANGLE, AVALANCHE_DISTANCE, AVALANCHE_FRICTION };

static const double least = 0.2, most = 0.4; /* m, half axes of a stone */
static const double gap = 0.05;              /* m, between two cells */
static const double density = 1;             /* kg/m^3 */

/* Hulls of a scene: no two stones are alike up to so many; a scene of more repeats them in turn. */
enum { KINDS = 300 };

static const pl_param avalanche_params[] = {
    {"n", KINDS, 1, 100000, true, "1", "number of stones"},
    {"angle", 40, 5, 80, false, "deg", "of the slope"},
    {"distance", 4, 0, 1000, false, "m", "of the lowest stones from the foot, along the slope"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(6),
};

/* The least number of cells along and across the slope for a lattice a quarter as high or less. */
static int columns_for(int count)
{
    int columns = 1;
    while (columns * columns * columns < 4 * count) {
        ++columns;
    }
    return columns;
}

static void avalanche_build(pl_builder *b, const double *values)
{
    const double angle = PL_RADIANS_PER_DEGREE * values[AVALANCHE_ANGLE];
    const double sine = pl_sine(angle), cosine = pl_cosine(angle);
    const double cell = 2 * most + gap;
    const int count = (int)values[AVALANCHE_COUNT], columns = columns_for(count);
    pl_shape kinds[KINDS];
    pl_build_floor(b);
    pl_build_plane(b, "slope", 0, sine, 0, cosine, 0);
    for (int i = 0; i < count && b->status == PL_OK; ++i) {
        pl_shape *shape = &kinds[i % KINDS];
        if (i < KINDS) {
            char name[PL_NAME_SIZE];
            snprintf(name, sizeof name, "kind %d", i + 1);
            *shape = pl_build_stone(b, name, least, most);
        }
        const double across = (i % columns + 0.5 - 0.5 * columns) * cell;
        const double uphill = values[AVALANCHE_DISTANCE] + (i / columns % columns + 0.5) * cell;
        const int layer = i / columns / columns;
        const double above = (layer + 0.5) * cell;
        pl_body stone = pl_body_at(*shape, above * sine - uphill * cosine, across,
                                   above * cosine + uphill * sine);
        pl_draw_orientation(&b->random, stone.orientation);
        stone.mass = b->status == PL_OK ? density * pl_shape_volume(shape) : 1;
        pl_build_body(b, &stone, "stone %d", i + 1);
    }
}

const pl_scenario pl_scenario_avalanche = {
    .name = "avalanche",
    .title = "Avalanche of stones",
    .description = "Convex stones of random shapes run down a slope and come to lie on the floor "
                   "at its foot: a mass in motion, in contacts of vertices, edges and faces that "
                   "last no longer than a few steps.",
    .reference = "no closed form for the motion; " PL_CHAOTIC_REFERENCE,
    .expected =
        "ok: the stones run down and come to lie at the foot of the slope; no two overlap at "
        "any time",
    .source = PL_CHAOTIC_SOURCE,
    PL_CHAOTIC_JUDGED,
    PL_PARAMS(avalanche_params),
    .build = avalanche_build};
