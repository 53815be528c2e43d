/* A slender rod that slides on its end over rough ground, that end ahead, as chalk that is pushed.
 *
 * The rod, of length 2 L and uniform density, leans back by an angle a from the ground, so that
 * friction, against the slip, turns its end into the ground. The normal acceleration of the end for
 * a normal force N is
 *     N / m (1 + 3 cos a (cos a - friction sin a)):
 * with friction > (1 + 3 cos^2 a) / (3 sin a cos a), least 4/3 at tan a = 2, a larger force presses
 * the end further in. No finite force keeps it out, and the answer is an impulse that stops the
 * slip at once. Impulses of friction, and of a contact that does not rebound, take energy and never
 * give any. */
#include "catalogue.h"
#include "degree.h"
#include "scene_builder.h"
#include "trigonometry.h"

#include <math.h>

enum { FRICTION, ANGLE, SPEED, DT, DURATION, PARAM_COUNT };

static const pl_param params[PARAM_COUNT] = {
    [FRICTION] = {.name = "friction",
                  .value = 2,
                  .min = 0,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient; above 4/3 there are angles without an answer"},
    [ANGLE] = {.name = "angle",
               .value = 63.43494882292201,
               .min = 5,
               .max = 85,
               .unit = "deg",
               .help = "of the rod from the ground; tan = 2 is the worst"},
    [SPEED] = {.name = "speed",
               .value = 2,
               .min = 0,
               .max = 20,
               .unit = "m/s",
               .help = "of the rod along the ground at the start"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(3),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    const double half_length = 0.5, half_thickness = 0.005;
    const double angle = PL_RADIANS_PER_DEGREE * values[ANGLE];
    const double s = pl_sine(angle), c = pl_cosine(angle);
    pl_builder builder = pl_build_begin(scene, pl_scenario_painleve.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    /* Its long axis is its x axis, which the turn about y points down. */
    pl_body rod = pl_body_default();
    rod.shape = pl_shape_box(half_length, 5 * half_thickness, half_thickness);
    rod.position[2] = half_length * s + half_thickness * c;
    rod.orientation[0] = pl_cosine(angle / 2);
    rod.orientation[2] = pl_sine(angle / 2);
    rod.velocity[0] = values[SPEED];
    pl_build_body(&builder, &rod, "rod");
    pl_build_judge(&builder, pl_scenario_painleve.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_painleve = {
    .name = "painleve",
    .title = "Rod without a finite force",
    .description = "A rod that slides on its end, that end ahead, with so much "
                   "friction that no finite force keeps it out of the ground.",
    .reference =
        "an impulse stops the end at once; energy never grows; inconsistent iff friction > "
        "(1 + 3 cos^2) / (3 sin cos) of the angle, at least 4/3",
    .expected = "ok: the sliding end stops at once and the rod falls over; energy never grows",
    .source = "Newton's and Euler's laws with Coulomb's friction: Painleve 1895; Genot and "
              "Brogliato 1999, New results on Painleve paradoxes",
    .primary_error = "energy_gain",
    .provokes =
        "the equations of forces have no solution: a solver of accelerations fails or finds "
        "endless forces, another throws the rod; a right engine solves for impulses, which "
        "are finite, and energy falls",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
