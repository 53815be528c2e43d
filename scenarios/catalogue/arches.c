/* A semicircular arch of equal voussoirs between two fixed springers.
 *
 * Its mean radius is 1 m, its joints are radial, the lowest of them level, on the springers. The
 * voussoirs have flat faces. Without sliding it stands iff a line of thrust fits within all joints:
 * for voussoirs without number thickness / radius >= 0.107478, for few of them less, because hinges
 * open at joints alone. The limit follows below.
 *
 * A little too thin, by d of the thickness, it opens at five joints (at the crown above, at the
 * haunches below, at the springers outside) by an angle that grows as g d / radius t^2 / 2 at
 * first, then at a rate near sqrt(g / radius): d = 1e-4 is more than the 0.05 m of a fall within 10
 * s.
 *
 * The limit: let the crown push with H at height y, and M = H y. At the joint at an angle f from
 * the vertical, with the weight V of all between it and the crown and its moment S about the
 * centre, the thrust passes the joint at the radius r where, by moments about the centre, r (H cos
 * f + V sin f) = M + S. It lies within the joint for inner <= r <= outer: for every joint a lower
 * and an upper bound on M, linear in H. The arch stands iff for some H the bounds do not cross;
 * their distance is concave in H. The forces may be taken as symmetric, because they could be
 * averaged with their mirror image. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* ---- Limit ---- */

static const double half_turn = 3.1415926535897931;

/* From the centre of the arch of mean radius 1 to the centre of mass of a voussoir. */
static double voussoir_centre(int count, double thickness)
{
    const double inner = 1 - thickness / 2, outer = 1 + thickness / 2;
    /* Of a trapezium, its sides as the radii. */
    return cos(half_turn / (2 * count)) *
           (inner + thickness / 3 * (inner + 2 * outer) / (inner + outer));
}

/* The distance of the bounds on M at this H, where a voussoir weighs 1. The uppermost joint is at
 * the crown, or, of an odd count, half a voussoir from it. */
static double slack(int count, double thickness, double thrust)
{
    const double inner = 1 - thickness / 2, outer = 1 + thickness / 2;
    const double centre = voussoir_centre(count, thickness), half = half_turn / (2 * count);
    const bool odd = count % 2 != 0;
    double joint = odd ? half : 0, weight = odd ? 0.5 : 0;
    double moment = weight * sin(half) / 3 * (inner + outer * outer / (inner + outer));
    double least = -HUGE_VAL, most = HUGE_VAL;
    for (int i = 0; i <= count / 2; ++i) {
        const double across = thrust * cos(joint) + weight * sin(joint);
        least = fmax(least, inner * across - moment);
        most = fmin(most, outer * across - moment);
        moment += centre * sin(joint + half);
        weight += 1;
        joint += 2 * half;
    }
    return most - least;
}

static bool stands(int count, double thickness)
{
    double low = 0, high = count;
    for (int i = 0; i < 100; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        if (slack(count, thickness, a) < slack(count, thickness, b)) {
            low = a;
        } else {
            high = b;
        }
    }
    return slack(count, thickness, low) >= 0;
}

/* The critical thickness over the mean radius, for `count` >= 3 voussoirs. */
static double arch_limit(int count)
{
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        const double middle = low + (high - low) / 2;
        *(stands(count, middle) ? &high : &low) = middle;
    }
    return low + (high - low) / 2;
}

/* ---- Scenario ---- */

enum { ARCH_COUNT, ARCH_THICKNESS, ARCH_FRICTION };

static const pl_param params[] = {
    {"n", 20, 5, 200, true, "1", "number of voussoirs"},
    {"thickness", 0.115, 0.01, 0.5, false, "1", "of the arch over its mean radius"},
    {"friction", 2, 0, 10, false, "1",
     "Coulomb coefficient of all contacts; the limit holds without sliding"},
    PL_PARAM_TIME(5),
};

static double critical(const double *values)
{
    return values[ARCH_FRICTION] >= 1 ? arch_limit((int)values[ARCH_COUNT]) : (double)NAN;
}

static const pl_threshold threshold = {.param = "thickness",
                                       .low = 0.06,
                                       .high = 0.2,
                                       .tolerance = 1e-5,
                                       .critical = critical,
                                       .formula = "the least thickness with a line of thrust "
                                                  "within all joints"};

/* A voussoir about the point of radius 1 at its middle; its z axis points outward. */
static pl_shape add_voussoir(pl_builder *b, int count, double thickness)
{
    const double half_width = 0.2;
    double corners[8][3], cosine, sine;
    pl_circle_point(1, 4 * count, &cosine, &sine);
    for (int i = 0; i < 8; ++i) {
        const double radius = 1 + (i & 4 ? thickness / 2 : -thickness / 2);
        corners[i][0] = i & 1 ? radius * sine : -radius * sine;
        corners[i][1] = i & 2 ? half_width : -half_width;
        corners[i][2] = radius * cosine - 1;
    }
    return pl_build_hull(b, "voussoir", (const double(*)[3])corners, 8);
}

static void add_springers(pl_builder *b)
{
    pl_body springer = pl_body_at(pl_shape_box(0.3, 0.3, 0.25), -1, 0, -0.25);
    springer.is_static = true;
    pl_build_body(b, &springer, "left springer");
    springer.position[0] = 1;
    pl_build_body(b, &springer, "right springer");
}

static void build(pl_builder *b, const double *values)
{
    const int count = (int)values[ARCH_COUNT];
    add_springers(b);
    const pl_shape shape = add_voussoir(b, count, values[ARCH_THICKNESS]);
    for (int i = 0; i < count; ++i) {
        /* The middle is at the part (2 i + 1) / (4 count) of a turn, from the right; its z axis is
         * turned from the vertical by a quarter less that. */
        const int lean = count - (2 * i + 1); /* of 4 count: positive to the right */
        double x, z, cosine, sine;
        pl_circle_point(2 * i + 1, 4 * count, &x, &z);
        pl_circle_point(lean < 0 ? -lean : lean, 8 * count, &cosine, &sine);
        pl_body voussoir = pl_body_at(shape, x, 0, z);
        voussoir.orientation[0] = cosine;
        voussoir.orientation[2] = lean < 0 ? -sine : sine;
        pl_build_rest(b, pl_build_body(b, &voussoir, "voussoir %d", i + 1));
    }
    b->scene->collapse_distance = 0.05;
}

const pl_scenario pl_scenario_arch = {
    .name = "arch",
    .title = "Semicircular arch",
    .description =
        "An arch of wedges without mortar, a little thicker than it must be: twenty bodies "
        "that hold each other up in one loop, each at the edge of its joints.",
    .reference =
        "it stands iff a line of thrust lies within all joints: thickness >= 0.107478 mean "
        "radii in the limit of many voussoirs, 0.107348 for 20",
    .expected = "ok: every voussoir at rest where it began, above the critical thickness; "
                "collapsed below: the arch opens",
    .source = "radial joints, many voussoirs: Milankovitch 1907, 0.1075; the further digits, and "
              "few voussoirs, by limit analysis worked out here",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity =
        "thickness above the threshold, which is below 0.10748 for any n; friction of 1 or more",
    .provokes =
        "one loop of contacts through all bodies: a little give at each joint adds up, the "
        "line of thrust leaves the arch, and it opens in five hinges; a right engine stands "
        "at 0.1075 and falls at 0.1072",
    .threshold = &threshold,
    PL_PARAMS(params),
    .build = build};
