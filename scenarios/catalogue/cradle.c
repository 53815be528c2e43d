/* Newton's cradle without strings: spheres that touch, in a row, and others that run into them.
 *
 * Without gravity the row is at rest, all of one mass; `moving` spheres come from the left at the
 * speed v. Momentum and, at restitution 1, energy must stay what they are; of the two laws in use
 * both keep them. In sequence, from contact to contact as with gaps of nothing, as many fly off on
 * the right as came. All contacts at once, each with Newton's restitution (Moreau's law), three
 * spheres of which one comes leave with v (-1/3, 2/3, 2/3). The end velocities tell which; neither
 * is an error. */
#include "catalogue.h"
#include "scene_builder.h"

#include <math.h>

enum { COUNT, MOVING, RESTITUTION, SPEED, DT, DURATION, PARAM_COUNT };

static const double radius = 0.1, gap = 0.25; /* m */

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 2,
               .min = 1,
               .max = 50,
               .integer = true,
               .unit = "1",
               .help = "spheres at rest"},
    [MOVING] = {.name = "moving",
                .value = 1,
                .min = 1,
                .max = 50,
                .integer = true,
                .unit = "1",
                .help = "spheres that run into them"},
    [RESTITUTION] = PL_PARAM_RESTITUTION(1),
    [SPEED] = {.name = "speed",
               .value = 1,
               .min = 0.1,
               .max = 100,
               .unit = "m/s",
               .help = "of the moving spheres"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(1),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder =
        pl_build_begin(scene, pl_scenario_cradle.name, values[DT], values[DURATION], 0, error);
    scene->gravity[2] = 0;
    if (builder.status == PL_OK) {
        scene->materials[0].restitution = values[RESTITUTION];
    }
    const int moving = (int)values[MOVING], count = moving + (int)values[COUNT];
    for (int i = 0; i < count; i++) {
        pl_body ball = pl_body_default();
        ball.shape = pl_shape_sphere(radius);
        ball.position[0] = 2 * radius * (i - moving) - (i < moving ? gap : 0);
        ball.velocity[0] = i < moving ? values[SPEED] : 0;
        pl_build_body(&builder, &ball, "ball %d", i + 1);
    }
    pl_build_judge(&builder, pl_scenario_cradle.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_cradle = {
    .name = "cradle",
    .title = "Newton's cradle by contacts alone",
    .description = "Spheres run into a row of spheres that touch each other: which of the laws of "
                   "simultaneous impact the engine has, and whether it keeps momentum and energy.",
    .reference = "momentum kept (momentum_error 0), at restitution 1 also energy (energy_lost 0 "
                 "J); 1 on 2 leave with v (0, 0, 1) in sequence, v (-1/3, 2/3, 2/3) all at once",
    .expected = "ok: momentum stays, at restitution 1 energy too; either law of simultaneous "
                "impact is right",
    .source = "conservation laws; simultaneous Newton impacts: Moreau 1988, Unilateral contact and "
              "dry friction in finite freedom dynamics",
    .primary_error = "momentum_error",
    .provokes = "an impact that passes through resting contacts: sequential solvers stop half way "
                "and lose energy, or gain it; a right engine keeps momentum and energy, by "
                "either law",
    .needs = PL_NEEDS_RESTITUTION | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
