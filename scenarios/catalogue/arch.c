/* A semicircular arch of equal voussoirs between two fixed springers.
 *
 * Its mean radius is 1 m, its joints are radial, the lowest of them level, upon the springers. The
 * voussoirs have flat faces. Without sliding it stands iff a line of thrust fits within all joints:
 * for voussoirs without number thickness / radius >= 0.107478, for few of them less, because hinges
 * open at joints alone: arch_limit.c.
 *
 * A little too thin, by d of the thickness, it opens at five joints (at the crown above, at the
 * haunches below, at the springers outside) by an angle that grows as g d / radius t^2 / 2 at
 * first, then at a rate near sqrt(g / radius): d = 1e-4 is more than the 0.05 m of a fall within 10
 * s. */
#include "arch_limit.h"
#include "catalogue.h"
#include "scene_builder.h"
#include "trigonometry.h"

#include <math.h>

enum { COUNT, THICKNESS, FRICTION, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 20,
               .min = 5,
               .max = 200,
               .integer = true,
               .unit = "1",
               .help = "number of voussoirs"},
    [THICKNESS] = {.name = "thickness",
                   .value = 0.115,
                   .min = 0.01,
                   .max = 0.5,
                   .unit = "1",
                   .help = "of the arch over its mean radius"},
    [FRICTION] = {.name = "friction",
                  .value = 2,
                  .min = 0,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient of all contacts; the limit holds without sliding"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(5),
};

static double critical(const double *values)
{
    return values[FRICTION] >= 1 ? pl_arch_limit((int)values[COUNT]) : (double)NAN;
}

static const pl_threshold threshold = {
    .param = "thickness",
    .low = 0.06,
    .high = 0.2,
    .holds_below = false,
    .tolerance = 1e-5,
    .critical = critical,
    .formula = "the least thickness with a line of thrust within all joints"};

/* A voussoir about the point of radius 1 at its middle; its z axis points outward. */
static const pl_polyhedron *add_voussoir(pl_builder *builder, int count, double thickness)
{
    const double half_width = 0.2;
    const pl_polyhedron *hull = NULL;
    double corners[8][3], cosine, sine;
    pl_circle_point(1, 4 * count, &cosine, &sine);
    for (int i = 0; i < 8; i++) {
        const double radius = 1 + (i & 4 ? thickness / 2 : -thickness / 2);
        corners[i][0] = i & 1 ? radius * sine : -radius * sine;
        corners[i][1] = i & 2 ? half_width : -half_width;
        corners[i][2] = radius * cosine - 1;
    }
    if (builder->status == PL_OK) {
        builder->status = pl_scene_add_hull(builder->scene, "voussoir", (const double(*)[3])corners,
                                            8, &hull, builder->error);
    }
    return hull;
}

static void add_springers(pl_builder *builder)
{
    pl_body springer = pl_body_default();
    springer.is_static = true;
    springer.shape = pl_shape_box(0.3, 0.3, 0.25);
    springer.position[2] = -0.25;
    springer.position[0] = -1;
    pl_build_body(builder, &springer, "left springer");
    springer.position[0] = 1;
    pl_build_body(builder, &springer, "right springer");
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const int count = (int)values[COUNT];
    pl_builder builder = pl_build_begin(scene, pl_scenario_arch.name, values[DT], values[DURATION],
                                        values[FRICTION], error);
    add_springers(&builder);
    const pl_polyhedron *hull = add_voussoir(&builder, count, values[THICKNESS]);
    for (int i = 0; i < count && hull != NULL; i++) {
        /* The middle is at the part (2 i + 1) / (4 count) of a turn, from the right; its z axis is
         * turned from the vertical by a quarter less that. */
        const int lean = count - (2 * i + 1); /* of 4 count: positive to the right */
        double x, z, cosine, sine;
        pl_circle_point(2 * i + 1, 4 * count, &x, &z);
        pl_circle_point(lean < 0 ? -lean : lean, 8 * count, &cosine, &sine);
        pl_body voussoir = pl_body_default();
        voussoir.shape = pl_shape_of(hull);
        voussoir.position[0] = x;
        voussoir.position[2] = z;
        voussoir.orientation[0] = cosine;
        voussoir.orientation[2] = lean < 0 ? -sine : sine;
        pl_build_rest(&builder, pl_build_body(&builder, &voussoir, "voussoir %d", i + 1));
    }
    pl_build_judge(&builder, pl_scenario_arch.primary_error, 0.05);
    return pl_build_end(&builder);
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
    .validity =
        "thickness above the threshold, which is below 0.10748 for any n; friction of 1 or more",
    .provokes =
        "one loop of contacts through all bodies: a little give at each joint adds up, the "
        "line of thrust leaves the arch, and it opens in five hinges; a right engine stands "
        "at 0.1075 and falls at 0.1072",
    .threshold = &threshold,
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_BOX | PL_NEEDS_HULL,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
