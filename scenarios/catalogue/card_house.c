/* A house of cards: rows of pairs that lean on each other, a level card over each row.
 *
 * Cards are boards of half length L and half thickness t, leaning by `lean` from the vertical. A
 * leaning card touches what is below it, and its partner, with the edges of its underside, and
 * bears the level card with the upper edge of its outer side. The lowest row has `storeys` pairs,
 * each row above one less, and one level card spans a row.
 *
 * Without a row above, a pair of cards stands on the floor iff, by moments about a lower edge,
 *     friction >= (tan(lean) - t / L) / 2,
 * where its partner's push is level, as symmetry asks. But the two edges that meet there have no
 * normal of their own: where an engine takes that of a card's face, which leans, the level push
 * needs friction >= tan(lean) too. More storeys have no closed form. */
#include "catalogue.h"
#include "degree.h"
#include "scene_builder.h"
#include "trigonometry.h"

enum { STOREYS, LEAN, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [STOREYS] = {.name = "storeys",
                 .value = 3,
                 .min = 1,
                 .max = 20,
                 .integer = true,
                 .unit = "1",
                 .help = "rows of leaning pairs"},
    [LEAN] = {.name = "lean",
              .value = 20,
              .min = 5,
              .max = 45,
              .unit = "deg",
              .help = "of the cards, from the vertical"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static const pl_threshold threshold = {
    .param = "friction", .low = 0, .high = 2, .holds_below = false, .tolerance = 1e-4};

/* m */
static const double half_length = 0.5, half_width = 0.3, half_thickness = 0.01;

typedef struct card {
    double sine, cosine;           /* of the lean */
    double half_sine, half_cosine; /* of half of it */
} card;

/* A leaning card whose upper edge touches x, on ground at z; side -1 is on the left. */
static void add_leaning(pl_builder *builder, const card *c, double x, double z, int side,
                        const char *name, int row, int place)
{
    pl_body body = pl_body_default();
    body.shape = pl_shape_box(half_thickness, half_width, half_length);
    body.position[0] = x + side * (half_length * c->sine + half_thickness * c->cosine);
    body.position[2] = z + half_length * c->cosine + half_thickness * c->sine;
    body.orientation[0] = c->half_cosine;
    body.orientation[2] = -side * c->half_sine;
    pl_build_rest(builder, pl_build_body(builder, &body, "%s %d.%d", name, row, place));
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const int storeys = (int)values[STOREYS];
    const double lean = PL_RADIANS_PER_DEGREE * values[LEAN];
    const card c = {.sine = pl_sine(lean),
                    .cosine = pl_cosine(lean),
                    .half_sine = pl_sine(lean / 2),
                    .half_cosine = pl_cosine(lean / 2)};
    /* A pair's height, and its width with a little room beside it. */
    const double height = 2 * (half_length * c.cosine + half_thickness * c.sine);
    const double spacing = 4 * (half_length * c.sine + half_thickness * c.cosine) + 0.02;
    pl_builder builder = pl_build_begin(scene, pl_scenario_card_house.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    double z = 0;
    for (int row = 1; row <= storeys; row++) {
        const int pairs = storeys - row + 1;
        for (int i = 0; i < pairs; i++) {
            const double x = spacing * (i - (pairs - 1) / 2.0);
            add_leaning(&builder, &c, x, z, -1, "left", row, i + 1);
            add_leaning(&builder, &c, x, z, 1, "right", row, i + 1);
        }
        z += height;
        if (pairs > 1) {
            pl_body level = pl_body_default();
            level.shape = pl_shape_box(spacing * (pairs - 1) / 2 + 0.1, half_width, half_thickness);
            level.position[2] = z + half_thickness;
            pl_build_rest(&builder, pl_build_body(&builder, &level, "level %d", row));
            z += 2 * half_thickness;
        }
    }
    pl_build_judge(&builder, pl_scenario_card_house.primary_error, 0.05);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_card_house = {
    .name = "card-house",
    .title = "House of cards",
    .description = "Three rows of leaning cards with level ones between them: every card stands on "
                   "an edge, by friction alone.",
    .reference =
        "every card stays where it is; one pair needs friction >= (tan(lean) - thickness / "
        "length) / 2, or tan(lean) where the edges that meet take the normal of a face; more "
        "storeys "
        "have no closed form",
    .expected = "ok: every card at rest where it began; collapsed with too little friction: the "
                "cards slide apart",
    .source = "statics of a pair: moments about its lower edge",
    .primary_error = "rest_position_error",
    .validity = "friction well above that of one pair",
    .provokes = "thin bodies on edges, where a contact has no area and its normal jumps, and "
                "friction holds all: cards creep apart or are thrown; a right engine keeps the "
                "house standing",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
