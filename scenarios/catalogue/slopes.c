/* A block on an inclined plane: held by friction, sliding, at the angle where it begins to slide,
 * and tipping.
 *
 * The plane goes through the origin with normal n = (sin a, 0, cos a), so downhill is
 * t = (cos a, 0, -sin a). The block of 1 kg lies on it, turned by a about y. Except in slope-tip
 * its half extents are (0.5, 0.5, 0.25) m. */
#include "base/trigonometry.h"
#include "catalogue.h"

#include <math.h>

/* Below 2, half width over half height, the flat block slides before it tips. */
#define PL_PARAM_SLOPE_FRICTION                                                                    \
    {                                                                                              \
        "friction", 0.5, 0, 1.9, false, "1",                                                       \
            "Coulomb coefficient; below 2, where the block would tip"                              \
    }

/* Adds the plane and a block of this shape; returns the block's index, -1 after a failure. */
static int build_slope(pl_builder *b, double angle, pl_shape shape)
{
    const double sine = pl_sine(angle), cosine = pl_cosine(angle);
    const double half_height = shape.half_extents[2];
    pl_build_plane(b, "floor", 0, sine, 0, cosine, 0);
    pl_body block = pl_body_at(shape, half_height * sine, 0, half_height * cosine);
    pl_turn_about_y(&block, angle);
    return pl_build_body(b, &block, "block");
}

static int build_flat_block(pl_builder *b, double angle)
{
    return build_slope(b, angle, pl_shape_box(0.5, 0.5, 0.25));
}

/* The acceleration along the slope over g: the block holds iff it is below 0. */
static double pull(double angle, double friction)
{
    return pl_sine(angle) - friction * pl_cosine(angle);
}

/* A block on a slope below the friction threshold: it stays.
 *
 * Coulomb: it holds iff tan(angle) < friction. The primary error is the whole displacement and not
 * the drift after settling, since the law is that it does not move at all. Beyond half a block's
 * height, 0.25 m, it counts as collapsed. */

enum { SLOPE_STICK_FRICTION, SLOPE_STICK_ANGLE };

static const pl_param slope_stick_params[] = {
    PL_PARAM_SLOPE_FRICTION,
    {"angle", 0.44, 0, 1.2, false, "rad", "of the slope, below atan(friction)"},
    PL_PARAM_TIME(60),
};

static void slope_stick_build(pl_builder *b, const double *values)
{
    if (!(pull(values[SLOPE_STICK_ANGLE], values[SLOPE_STICK_FRICTION]) < 0)) {
        pl_build_refuse(b,
                        "expected an angle below atan(friction) = %g rad, where the block "
                        "holds, found %g; use slope-slide for steeper ones",
                        atan(values[SLOPE_STICK_FRICTION]), values[SLOPE_STICK_ANGLE]);
        return;
    }
    pl_build_rest(b, build_flat_block(b, values[SLOPE_STICK_ANGLE]));
    b->scene->collapse_distance = 0.25;
}

const pl_scenario pl_scenario_slope_stick = {
    .name = "slope-stick",
    .title = "Block held by friction",
    .description =
        "A block on a slope a little below the angle at which it slides, for a minute: whether "
        "friction holds it, or lets it creep.",
    .reference = "no motion, since tan(angle) < friction",
    .expected = "ok: the block at rest where it began",
    .source = "Coulomb's law of friction (Coulomb 1785) and statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    PL_PARAMS(slope_stick_params),
    .build = slope_stick_build};

/* A block on a slope above the friction threshold: it slides without tipping.
 *
 * From rest, with a = g (sin(angle) - friction cos(angle)) and t = n h after n steps of h:
 *   continuous:           s = a t^2 / 2
 *   semi-implicit Euler:  v_k = k a h, s_n = sum of h v_k = a h^2 n (n + 1) / 2.
 * It stays flat while friction < half width / half height: the pressure then shifts
 * uphill-to-downhill by friction * half height, still inside the base. */

enum { SLOPE_SLIDE_FRICTION, SLOPE_SLIDE_ANGLE };

static const pl_param slope_slide_params[] = {
    PL_PARAM_SLOPE_FRICTION,
    {"angle", 0.6, 0, 1.5, false, "rad", "of the slope, above atan(friction)"},
    PL_PARAM_TIME(2),
};

static void slope_slide_build(pl_builder *b, const double *values)
{
    const double angle = values[SLOPE_SLIDE_ANGLE];
    const double acceleration = b->gravity * pull(angle, values[SLOPE_SLIDE_FRICTION]);
    if (!(acceleration > 0)) {
        pl_build_refuse(b,
                        "expected an angle above atan(friction) = %g rad, where the block "
                        "slides, found %g; use slope-stick for flatter ones",
                        atan(values[SLOPE_SLIDE_FRICTION]), values[SLOPE_SLIDE_ANGLE]);
        return;
    }
    const double downhill[3] = {pl_cosine(angle), 0, -pl_sine(angle)};
    pl_build_travel(b, build_flat_block(b, angle), downhill,
                    pl_uniform_distance(0, acceleration, b->scene->dt, b->steps));
}

const pl_scenario pl_scenario_slope_slide = {
    .name = "slope-slide",
    .title = "Block that slides down",
    .description =
        "A block on a slope above the angle at which it slides, released at rest: whether "
        "friction brakes it as Coulomb's law says.",
    .reference =
        "s = g (sin(angle) - friction cos(angle)) t^2 / 2 along the slope; of semi-implicit Euler "
        "a h^2 n (n + 1) / 2",
    .expected = "ok: the block slides straight down, flat, by the distance of the reference",
    .source = "Coulomb's law and uniform acceleration; the discrete sum is arithmetic",
    .primary_error = "travel_error",
    PL_ACCEPT_FRICTION,
    PL_PARAMS(slope_slide_params),
    .build = slope_slide_build};

/* A block on a slope, at the angle where it begins to slide.
 *
 * Coulomb: it holds iff tan(angle) < friction. At d beyond the critical angle it slides with a =
 * g (sin - friction cos) = g d / cos(critical) to first order, so in 30 s by 4415 m d / cos. It has
 * collapsed at 0.1 m: beyond 2.3e-5 rad times the cosine, 5e-5 of the critical angle for friction
 * 0.5. An engine in which the block creeps by less than 3 mm/s is still measured. */

enum { SLOPE_THRESHOLD_FRICTION, SLOPE_THRESHOLD_ANGLE };

static const pl_param slope_threshold_params[] = {
    PL_PARAM_SLOPE_FRICTION,
    {"angle", 26.5, 0, 85, false, "deg", "of the slope"},
    PL_PARAM_TIME(30),
};

static double slope_threshold_critical(const double *values)
{
    return atan(values[SLOPE_THRESHOLD_FRICTION]) / PL_RADIANS_PER_DEGREE;
}

static const pl_threshold slope_threshold_threshold = {.param = "angle",
                                                       .low = 0,
                                                       .high = 80,
                                                       .holds_below = true,
                                                       .tolerance = 2e-4,
                                                       .critical = slope_threshold_critical,
                                                       .formula = "atan(friction)"};

static void slope_threshold_build(pl_builder *b, const double *values)
{
    pl_build_rest(b, build_flat_block(b, PL_RADIANS_PER_DEGREE * values[SLOPE_THRESHOLD_ANGLE]));
    b->scene->collapse_distance = 0.1;
}

const pl_scenario pl_scenario_slope_threshold = {
    .name = "slope-threshold",
    .title = "Slope at which a block slides",
    .description = "A block on a slope a little below the angle at which it slides; bisected, it "
                   "gives the friction that an engine really has.",
    .reference = "it holds iff angle < atan(friction)",
    .expected = "ok: at rest where it began, below atan(friction); collapsed above: it slides off",
    .source = "Coulomb's law of friction (Coulomb 1785) and statics",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "angle < atan(friction); friction < 2, where the block would tip",
    .threshold = &slope_threshold_threshold,
    PL_PARAMS(slope_threshold_params),
    .build = slope_threshold_build};

/* A tall block on a slope: it tips, or slides, whichever comes first.
 *
 * The block, half width hb across the slope's fall line and half height hh, has its centre hh above
 * the slope. Its weight passes the lower edge when tan(angle) = hb / hh, and it slides when
 * tan(angle) = friction: so it tips first iff friction > hb / hh, and holds iff tan(angle) is below
 * both.
 *
 * Beyond the critical angle by d it slides as in slope-threshold, g d / cos(critical), 0.1 m in 30
 * s at 5e-5 of the angle; or it turns about its lower edge by d (cosh(k t) - 1) with k^2 = 3 g / (4
 * R), R = sqrt(hb^2 + hh^2), 3.6 / s for the default block: any d above 1e-15 rad is a fall within
 * 10 s. */

enum { SLOPE_TIP_FRICTION, SLOPE_TIP_WIDTH, SLOPE_TIP_ANGLE };

static const pl_param slope_tip_params[] = {
    {"friction", 1, 0, 10, false, "1",
     "Coulomb coefficient; above `slenderness` the block tips first"},
    {"slenderness", 0.5, 0.1, 2, false, "1", "half width over half height"},
    {"angle", 26.5, 0, 85, false, "deg", "of the slope"},
    PL_PARAM_TIME(30),
};

static double slope_tip_critical(const double *values)
{
    return atan(fmin(values[SLOPE_TIP_FRICTION], values[SLOPE_TIP_WIDTH])) / PL_RADIANS_PER_DEGREE;
}

static const pl_threshold slope_tip_threshold = {
    .param = "angle",
    .low = 0,
    .high = 85,
    .holds_below = true,
    .tolerance = 2e-4,
    .critical = slope_tip_critical,
    .formula = "atan(min(friction, half width / half height))"};

static void slope_tip_build(pl_builder *b, const double *values)
{
    const double half_height = 0.5;
    const pl_shape shape =
        pl_shape_box(half_height * values[SLOPE_TIP_WIDTH], half_height, half_height);
    pl_build_rest(b, build_slope(b, PL_RADIANS_PER_DEGREE * values[SLOPE_TIP_ANGLE], shape));
    b->scene->collapse_distance = 0.1;
}

const pl_scenario pl_scenario_slope_tip = {
    .name = "slope-tip",
    .title = "Tall block on a slope",
    .description = "A block twice as tall as wide on a slope a little below the angle at which it "
                   "tips over; with less friction than that takes, it slides instead. Figure 3 of "
                   "the source paper, " PL_SOURCE_PAPER ".",
    .reference = "it holds iff tan(angle) < min(friction, half width / half height); it tips first "
                 "iff friction > half width / half height",
    .expected = "ok: at rest where it began, below the critical angle; collapsed above: it tips or "
                "slides off",
    .source = "statics: moments about the lower edge, and Coulomb's law",
    .primary_error = "rest_position_error",
    PL_ACCEPT_AT_REST,
    .validity = "tan(angle) < min(friction, half width / half height)",
    .threshold = &slope_tip_threshold,
    PL_PARAMS(slope_tip_params),
    .build = slope_tip_build};
