/* A ring that hangs in another, as links of a chain.
 *
 * Both are tori of straight pieces. The upper one stands still in the plane y = 0; the lower one,
 * in the plane x = 0, hangs from it: the middle of the innermost flat side of one lies on that of
 * the other, at a hole's radius below the upper and above the lower centre. Each side holds the
 * other like a saddle. */
#include "catalogue.h"
#include "solids.h"

#include <math.h>

enum { DROP, FRICTION, DT, DURATION, PARAM_COUNT };
enum { AROUND = 24, SIDES = 12 };

static const double ring_radius = 0.5, tube_radius = 0.15; /* m */

static const pl_param params[PARAM_COUNT] = {
    [DROP] = {.name = "drop",
              .value = 0,
              .min = 0,
              .max = 0.3,
              .unit = "m",
              .help = "height from which the lower ring falls into the upper one"},
    [FRICTION] = PL_PARAM_FRICTION,
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(10),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_linked_rings.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_solid solid = pl_solid_torus(ring_radius, tube_radius, AROUND, SIDES);
    const pl_polyhedron *torus = pl_build_solid(&builder, &solid, false, "ring");
    pl_body ring = pl_body_default();
    ring.shape = torus != NULL ? pl_shape_of(torus) : ring.shape;
    ring.is_static = true;
    ring.orientation[0] = ring.orientation[1] = sqrt(0.5); /* its axis along y */
    pl_build_body(&builder, &ring, "upper ring");

    ring.is_static = false;
    ring.orientation[1] = 0;
    ring.orientation[2] = sqrt(0.5); /* its axis along x */
    ring.position[2] = -2 * pl_torus_hole(ring_radius, tube_radius, AROUND, SIDES);
    const double resting = ring.position[2];
    int lower = pl_build_body(&builder, &ring, "lower ring");
    pl_build_rest(&builder, lower);
    if (builder.status == PL_OK) {
        scene->bodies[lower].position[2] = resting + values[DROP];
    }
    pl_build_judge(&builder, pl_scenario_linked_rings.primary_error, ring_radius);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_linked_rings = {
    .name = "linked-rings",
    .title = "Ring hanging in a ring",
    .description =
        "Two tori of triangles, linked: neither is convex, and where they touch both are "
        "hollow. Whether one hangs in the other without passing through.",
    .reference = "the lower centre hangs two inner radii below the upper one",
    .expected = "ok: the lower ring hangs in the upper one, at rest",
    .source = "by symmetry",
    .primary_error = "rest_position_error",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_MESH,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
