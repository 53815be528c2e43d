#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* A slender block, tilted by less than its balance, is let go and rocks from corner to corner.
 *
 * With half width b and half height a, R^2 = a^2 + b^2, tan(alpha) = b / a and p^2 = 3 g / (4 R),
 * its tilt t on one corner keeps to t'' = -p^2 sin(alpha - t). With f = alpha - t, from rest at f0,
 *   f'^2 = 2 p^2 (cos f0 - cos f),
 * and the base strikes the floor at f = alpha. By the angular momentum about the corner that
 * strikes, while the other is free to lift,
 *   w+ / w- = r = 1 - 3/2 sin^2(alpha),
 * so that the centre, R cos f above the floor, comes back by r^2 of what it fell: after the first
 * impact its apex is (1 - r^2) D below the start, D = R (cos f0 - cos alpha).
 *
 * The fall takes a quarter of the period, int df / f' from f0 to alpha; f = f0 + (alpha - f0) s^2
 * takes the singular end out of it, and Simpson's rule does the rest. For slender blocks it tends
 * to acosh(1 / (1 - t0 / alpha)) / p. The spin is expected where f is half displacement. The block
 * rocks in one plane: it neither turns out of it nor leaves it sideways. */

enum { ROCKING_BLOCK_SLENDERNESS, ROCKING_BLOCK_TILT, ROCKING_BLOCK_FRICTION };

static const double half_width = 0.25; /* m */

static const pl_param params[] = {
    {"slenderness", 4, 2, 20, false, "1", "height over width; the width is 0.5 m"},
    {"tilt", 0.6, 0.05, 0.95, false, "1",
     "at the start, over that at which it would balance on its corner"},
    {"friction", 1, 0.8, 10, false, "1", "Coulomb coefficient; enough not to slip"},
    PL_PARAM_TIME(2),
};

typedef struct rocking {
    double alpha, start; /* alpha, f0: rad */
    double radius, rate; /* R, m; p, 1/s */
    double ratio;        /* r */
} rocking;

/* atan(x), 0 <= x <= 1/2: 31 terms of its series leave less than 1e-20. */
static double small_angle_of(double x)
{
    double sum = 0;
    for (int power = 61; power > 0; power -= 2) {
        sum = 1.0 / power - x * x * sum;
    }
    return x * sum;
}

static rocking rocking_of(double slenderness, double tilt, double g)
{
    rocking k = {.alpha = small_angle_of(1 / slenderness)};
    k.start = k.alpha * (1 - tilt);
    k.radius = half_width * sqrt(1 + slenderness * slenderness);
    k.rate = sqrt(3 * g / (4 * k.radius));
    const double sine = half_width / k.radius;
    k.ratio = 1 - 1.5 * sine * sine;
    return k;
}

/* cos f0 - cos f, without cancellation. */
static double height_lost(const rocking *k, double f)
{
    return 2 * pl_sine((f + k->start) / 2) * pl_sine((f - k->start) / 2);
}

/* From f0 to f, s. */
static double time_to(const rocking *k, double f)
{
    enum { INTERVALS = 2000 }; /* even */
    const double displacement = f - k->start;
    double sum =
        sqrt(2 * displacement / pl_sine(k->start)); /* the limit of the integrand at s = 0 */
    for (int i = 1; i <= INTERVALS; ++i) {
        const double s = (double)i / INTERVALS;
        const double weight = i == INTERVALS ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * 2 * displacement * s /
               sqrt(2 * height_lost(k, k->start + displacement * s * s));
    }
    return sum / (3 * INTERVALS * k->rate);
}

static void place(const rocking *k, double slenderness, pl_body *block)
{
    const double tilt = k->alpha - k->start, half_height = half_width * slenderness;
    block->shape = pl_shape_box(half_width, half_width, half_height);
    block->position[0] = half_height * pl_sine(tilt) - half_width * pl_cosine(tilt);
    block->position[2] = half_height * pl_cosine(tilt) + half_width * pl_sine(tilt);
    block->orientation[0] = pl_cosine(tilt / 2);
    block->orientation[2] = pl_sine(tilt / 2);
}

static void expect(pl_builder *b, int block, const rocking *k)
{
    const double quarter = time_to(k, k->alpha), middle = (k->start + k->alpha) / 2;
    const double depth = k->radius * height_lost(k, k->alpha);
    pl_expect_value value = pl_expect_value_default(b->scene);
    const double end = value.until;
    value.body = block;
    value.quantity = PL_QUANTITY_APEX;
    value.from = quarter;
    value.until = 2.5 * quarter; /* the second quarter is shorter, and what comes later is lower */
    value.value = -(1 - k->ratio * k->ratio) * depth;
    value.scale = depth;
    if (value.until <= end) {
        pl_build_value(b, &value);
    }
    value.quantity = PL_QUANTITY_SPIN;
    value.direction[1] = 1;
    value.direction[2] = 0;
    value.from = 0;
    value.until = time_to(k, middle);
    value.value = -k->rate * sqrt(2 * height_lost(k, middle));
    value.scale = -value.value;
    if (value.until <= end) {
        pl_build_value(b, &value);
    }
    pl_build_none(b, block, PL_QUANTITY_TURN, PL_ALONG_X | PL_ALONG_Z, k->alpha);
    pl_build_none(b, block, PL_QUANTITY_POSITION, PL_ALONG_Y, half_width);
}

static void build(pl_builder *b, const double *values)
{
    pl_build_floor(b);
    const rocking k =
        rocking_of(values[ROCKING_BLOCK_SLENDERNESS], values[ROCKING_BLOCK_TILT], b->gravity);
    pl_body block = pl_body_default();
    place(&k, values[ROCKING_BLOCK_SLENDERNESS], &block);
    expect(b, pl_build_body(b, &block, "block"), &k);
}

const pl_scenario pl_scenario_rocking_block = {
    .name = "rocking-block",
    .title = "Rocking block",
    .description = "A slender block let go at a tilt falls back and rocks on to its other corner: "
                   "how fast it falls, and how much of the spin the impact leaves.",
    .reference = "w+ / w- = 1 - 3/2 sin^2(alpha), alpha = atan(width / height); the fall: "
                 "t'' = -p^2 sin(alpha - t), p = sqrt(3 g / (4 R)), for slender blocks in "
                 "acosh(1 / (1 - t0 / alpha)) / p",
    .expected =
        "ok: the block rocks on in its plane, its next swing lower by the loss at the impact",
    .source = "Housner 1963, The behavior of inverted pendulum structures during earthquakes: the "
              "equation of motion, the period of free rocking and the loss at impact",
    .primary_error = "value_error",
    PL_ACCEPT_MOTION,
    .validity = "restitution 0 at the corner that strikes, no slip; the fall and the apex where "
                "they come within the run",
    .provokes =
        "an impact on one corner in the instant in which the other lets go: solvers that hold "
        "both, or push the floor's penetration out as speed, stop the block or make it "
        "bounce; a right engine leaves it 1 - 3/2 sin^2(alpha) of its spin",
    PL_PARAMS(params),
    .build = build};
