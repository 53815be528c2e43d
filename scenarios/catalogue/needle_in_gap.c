/* A needle that falls into a gap a little wider than itself.
 *
 * The needle is a box 0.5 m long and 10 mm wide, the gap between two fixed blocks `clearance` of
 * that wider and 1 m deep. The needle starts with its point just within the gap, leaning by a part
 * `tilt` of what the gap will let it, slides down without friction, and comes to stand upright on
 * the floor: its base is level there, and its centre of mass over it. Where it stands across the
 * gap is free, to within half the clearance, 0.05 mm for the default. */
#include "catalogue.h"
#include "scene_builder.h"

#include <math.h>

enum { CLEARANCE, TILT, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [CLEARANCE] = {.name = "clearance",
                   .value = 0.01,
                   .min = 1e-4,
                   .max = 1,
                   .unit = "1",
                   .help = "of the gap beside the needle, over the needle's width"},
    [TILT] = {.name = "tilt",
              .value = 0.5,
              .min = 0,
              .max = 0.9,
              .unit = "1",
              .help = "of the needle at the start, over the largest that fits"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(5),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half_length = 0.25, half_width = 0.005, half_depth = 0.005, gap_depth = 1;
    const double gap = half_width * (1 + values[CLEARANCE]), block = 0.5;
    pl_builder builder = pl_build_begin(scene, pl_scenario_needle_in_gap.name, values[DT],
                                        values[DURATION], 0, error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body side = pl_body_default();
    side.is_static = true;
    side.shape = pl_shape_box(block, block, gap_depth / 2);
    side.position[2] = gap_depth / 2;
    side.position[0] = -(gap + block);
    pl_build_body(&builder, &side, "left");
    side.position[0] = gap + block;
    pl_build_body(&builder, &side, "right");
    pl_body needle = pl_body_default();
    needle.shape = pl_shape_box(half_width, half_depth, half_length);
    needle.mass = 0.01;
    needle.position[2] = half_length;
    int index = pl_build_body(&builder, &needle, "needle");
    pl_build_rest(&builder, index);
    if (builder.status == PL_OK) {
        /* A turn by q about y, small, widens the needle by its length times q. */
        const double turn = values[TILT] * (gap - half_width) / half_length;
        pl_body *start = &scene->bodies[index];
        start->position[2] = gap_depth;
        start->orientation[0] = sqrt(1 - turn * turn / 4);
        start->orientation[2] = turn / 2;
    }
    pl_build_judge(&builder, pl_scenario_needle_in_gap.primary_error, 0.01);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_needle_in_gap = {
    .name = "needle-in-gap",
    .title = "Needle in a narrow gap",
    .description = "A slender box that falls down a gap 1 % wider than itself: contacts on both "
                   "sides at once, in a body thinner than it falls in a step.",
    .reference = "it stands on the floor, upright, to within the clearance",
    .expected = "ok: the needle stands upright on the floor",
    .source = "statics and impenetrability",
    .primary_error = "rest_position_error",
    .validity = "across the gap to within half of clearance times width; the run lasts until it "
                "stands: duration > 0.4 s",
    .provokes =
        "margins and contacts from both sides that will not agree: the needle jams, shakes, "
        "is squeezed out or passes through a side; a right engine lets it fall to the floor",
    .needs = PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
