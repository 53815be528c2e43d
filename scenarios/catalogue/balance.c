/* Bodies at rest at the limit of balance or friction: an overhanging stack, a ladder, a house of
 * cards. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* A harmonic stack: n equal blocks, each as far out over the one below as balance allows, times a
 * factor.
 *
 * Block k, from the top, is out over the next, and the lowest over the table, by factor L / (2 k).
 * The centre of mass of the top k blocks is then factor L / 2 out from the centre of the next: let
 * it be so for k - 1, and take moments,
 *     (k - 1) / k factor L / 2 + factor L / (2 k) = factor L / 2.
 * So all joints are at balance together at factor 1: the stack stands below and every joint opens
 * above. There the whole weight rests on the edge of each block.
 *
 * The top block alone, beyond by d in factor, turns about the edge by an angle that grows as
 * d cosh(k t), k^2 = g h / (2 I), with its height h = 1/4 m and its moment of inertia about the
 * edge for 1 kg, I = 0.104 m^2: k = 3.4 / s, so d = 1e-6 is a fall within 5 s. */

enum { OVERHANG_COUNT, OVERHANG_FACTOR, OVERHANG_FRICTION };

static const pl_param overhang_params[] = {
    {"n", 5, 1, 50, true, "1", "number of blocks"},
    {"factor", 0.98, 0, 1.5, false, "1", "overhang of every block over the largest that balances"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static double overhang_critical(const double *values)
{
    (void)values;
    return 1;
}

static const pl_threshold overhang_threshold = {.param = "factor",
                                                .low = 0.5,
                                                .high = 1.3,
                                                .holds_below = true,
                                                .tolerance = 1e-5,
                                                .critical = overhang_critical,
                                                .formula = "1"};

static void overhang_build(pl_builder *b, const double *values)
{
    const double half_length = 0.5, half_width = 0.25, half_height = 0.125;
    const int count = (int)values[OVERHANG_COUNT];
    /* The table's edge is x = 0, its top z = 0. */
    pl_body block = pl_body_at(pl_shape_box(half_length, half_width, half_height), 0, 0, 0);
    pl_body table = block;
    table.is_static = true;
    table.position[0] = -half_length;
    table.position[2] = -half_height;
    pl_build_body(b, &table, "table");
    double x = -half_length;
    for (int k = count; k >= 1; --k) {
        x += values[OVERHANG_FACTOR] * half_length / k;
        block.position[0] = x;
        block.position[2] = (2 * (count - k) + 1) * half_height;
        pl_build_rest(b, pl_build_body(b, &block, "block %d", count - k + 1));
    }
    b->scene->collapse_distance = half_height;
}

const pl_scenario pl_scenario_overhang = {
    .name = "overhang",
    .title = "Blocks over the table's edge",
    .description =
        "A stack of blocks that leans out as far as balance allows, times a factor: at 1 "
        "every joint is at its limit at once.",
    .reference = "it stands iff factor <= 1: the top is out by L/2 (1 + 1/2 + ... + 1/n)",
    .expected = "ok: every block at rest where it began, at factors below 1; collapsed above: the "
                "stack tips",
    .source = "statics, as in Hall 2005, Fun with stacking blocks; more than one block to a level "
              "would reach farther: Paterson and Zwick 2009, Overhang",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "factor < 1",
    .provokes =
        "each block rests on an edge, so that a contact that gives way a little tips all above it; "
        "a right engine stands at 0.999 and falls at 1.001",
    .threshold = &overhang_threshold,
    PL_PARAMS(overhang_params),
    .build = overhang_build};

/* A ladder, a board of half length L, half thickness t and uniform density, against a smooth wall.
 *
 * The wall is x = 0, the floor z = 0; the board leans to the wall at `angle` from the floor. It
 * touches both with the two edges of its underside, so the points of contact are those of a line
 * of length 2 L, while the centre of mass lies t above the middle of that line. With the weight W,
 * the wall's push P and the floor's friction F = P, moments about the lower edge:
 *     W (L cos - t sin) = P 2 L sin
 * so friction >= P / W means tan(angle) >= 1 / (2 friction + t / L); for t = 0 that is
 * atan(1 / (2 friction)). At tan(angle) > L / t it would tip away from the wall.
 *
 * At d below the critical angle the board turns by an acceleration near g d / L that grows as it
 * sinks, at a rate near sqrt(g / L): d = 1e-4 is more than the 0.1 m of a fall within 5 s. From 10
 * degrees, the least, it falls by 0.17 m. */

enum { LADDER_FRICTION, LADDER_THICKNESS, LADDER_ANGLE };

static const pl_param ladder_params[] = {
    {"friction", 0.5, 0.05, 2, false, "1", "Coulomb coefficient of the floor; the wall has none"},
    {"thickness", 0.02, 1e-3, 0.05, false, "1", "of the board over its length"},
    {"angle", 45, 10, 89, false, "deg", "from the floor"},
    PL_PARAM_TIME(10),
};

static double ladder_critical(const double *values)
{
    return atan(1 / (2 * values[LADDER_FRICTION] + values[LADDER_THICKNESS])) /
           PL_RADIANS_PER_DEGREE;
}

static const pl_threshold ladder_threshold = {.param = "angle",
                                              .low = 10,
                                              .high = 86,
                                              .tolerance = 2e-4,
                                              .critical = ladder_critical,
                                              .formula = "atan(1 / (2 friction + thickness))"};

static void ladder_build(pl_builder *b, const double *values)
{
    const double half_length = 1, half_width = 0.2,
                 angle = PL_RADIANS_PER_DEGREE * values[LADDER_ANGLE];
    const double half_thickness = half_length * values[LADDER_THICKNESS];
    const double s = pl_sine(angle), c = pl_cosine(angle);
    const int smooth = pl_build_material(b, "smooth", 0, 0);
    pl_build_floor(b);
    pl_build_plane(b, "wall", smooth, 1, 0, 0, 0);
    /* Its x axis points down the board, its z axis up from the underside. */
    pl_body board =
        pl_body_at(pl_shape_box(half_length, half_width, half_thickness),
                   half_length * c + half_thickness * s, 0, half_length * s + half_thickness * c);
    pl_turn_about_y(&board, angle);
    pl_build_rest(b, pl_build_body(b, &board, "board"));
    b->scene->collapse_distance = 0.1;
}

const pl_scenario pl_scenario_ladder = {
    .name = "ladder",
    .title = "Ladder against a smooth wall",
    .description =
        "A thin board that leans on a wall without friction, held by the floor's friction alone, a "
        "little steeper than it must be: two kinds of contact in one body.",
    .reference = "it holds iff tan(angle) >= 1 / (2 friction + thickness / length)",
    .expected = "ok: the board at rest where it began, above the critical angle; collapsed below: "
                "it slides down",
    .source =
        "statics: moments about the lower edge; textbooks have it for a line, 1 / (2 friction)",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "angle > atan(1 / (2 friction + thickness / length))",
    .threshold = &ladder_threshold,
    PL_PARAMS(ladder_params),
    .build = ladder_build};

/* A house of cards: rows of pairs that lean on each other, a level card over each row.
 *
 * Cards are boards of half length L and half thickness t, leaning by `lean` from the vertical. A
 * leaning card touches the floor or card below it, and its partner, with the edges of its
 * underside, and bears the level card with the upper edge of its outer side. The lowest row has
 * `storeys` pairs, each row above one less, and one level card spans a row.
 *
 * Without a row above, a pair of cards stands on the floor iff, by moments about a lower edge,
 *     friction >= (tan(lean) - t / L) / 2,
 * where its partner's push is level, as symmetry asks. But the two edges that meet there have no
 * normal of their own: where an engine takes that of a card's face, which leans, the level push
 * needs friction >= tan(lean) too. More storeys have no closed form. By linear programming, two
 * need 0.244929 and three 0.269143 at a lean of 20 degrees. */

enum { CARD_HOUSE_STOREYS, CARD_HOUSE_LEAN, CARD_HOUSE_FRICTION };

static const pl_param card_house_params[] = {
    {"storeys", 3, 1, 20, true, "1", "rows of leaning pairs"},
    {"lean", 20, 5, 45, false, "deg", "of the cards, from the vertical"},
    PL_PARAM_FRICTION,
    PL_PARAM_TIME(10),
};

static const pl_threshold card_house_threshold = {
    .param = "friction", .low = 0, .high = 2, .holds_below = false, .tolerance = 1e-4};

/* m */
static const double half_length = 0.5, half_width = 0.3, half_thickness = 0.01;

typedef struct card {
    double sine, cosine;           /* of the lean */
    double half_sine, half_cosine; /* of half of it */
} card;

/* A leaning card whose upper edge touches x, on ground at z; side -1 is on the left. */
static void add_leaning(pl_builder *b, const card *c, double x, double z, int side,
                        const char *name, int row, int place)
{
    pl_body body = pl_body_at(pl_shape_box(half_thickness, half_width, half_length),
                              x + side * (half_length * c->sine + half_thickness * c->cosine), 0,
                              z + half_length * c->cosine + half_thickness * c->sine);
    body.orientation[0] = c->half_cosine;
    body.orientation[2] = -side * c->half_sine;
    pl_build_rest(b, pl_build_body(b, &body, "%s %d.%d", name, row, place));
}

static void card_house_build(pl_builder *b, const double *values)
{
    const int storeys = (int)values[CARD_HOUSE_STOREYS];
    const double lean = PL_RADIANS_PER_DEGREE * values[CARD_HOUSE_LEAN];
    const card c = {.sine = pl_sine(lean),
                    .cosine = pl_cosine(lean),
                    .half_sine = pl_sine(lean / 2),
                    .half_cosine = pl_cosine(lean / 2)};
    /* A pair's height, and its width with a little space next to it. */
    const double height = 2 * (half_length * c.cosine + half_thickness * c.sine);
    const double spacing = 4 * (half_length * c.sine + half_thickness * c.cosine) + 0.02;
    pl_build_floor(b);
    double z = 0;
    for (int row = 1; row <= storeys; ++row) {
        const int pairs = storeys - row + 1;
        for (int i = 0; i < pairs; ++i) {
            const double x = spacing * (i - (pairs - 1) / 2.0);
            add_leaning(b, &c, x, z, -1, "left", row, i + 1);
            add_leaning(b, &c, x, z, 1, "right", row, i + 1);
        }
        z += height;
        if (pairs > 1) {
            pl_body level = pl_body_at(
                pl_shape_box(spacing * (pairs - 1) / 2 + 0.1, half_width, half_thickness), 0, 0,
                z + half_thickness);
            pl_build_rest(b, pl_build_body(b, &level, "level %d", row));
            z += 2 * half_thickness;
        }
    }
    b->scene->collapse_distance = 0.05;
}

const pl_scenario pl_scenario_card_house = {
    .name = "card-house",
    .title = "House of cards",
    .description = "Three rows of leaning cards with level ones between them: every card stands on "
                   "an edge, by friction alone.",
    .reference =
        "every card stays where it is; one pair needs friction >= (tan(lean) - thickness / "
        "length) / 2, or tan(lean) where the edges that meet take the normal of a face; at a lean "
        "of 20 degrees two storeys need 0.2449 and three 0.2691",
    .expected = "ok: every card at rest where it began; collapsed with too little friction: the "
                "cards slide apart",
    .source =
        "statics of a pair: moments about its lower edge; of more storeys: linear programming",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "friction well above that of one pair",
    .provokes = "thin bodies on edges, where a contact has no area and its normal jumps, and "
                "friction holds all: cards creep apart or are thrown; a right engine keeps the "
                "house standing",
    .threshold = &card_house_threshold,
    PL_PARAMS(card_house_params),
    .build = card_house_build};
