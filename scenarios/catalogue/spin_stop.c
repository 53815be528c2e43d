/* A box or a disc spins flat on a level floor until friction stops it.
 *
 * The box stands on its four corners, each at the distance d from the axis. However they share the
 * weight, the friction of all has the moment mu m g d; with I = m d^2 / 3
 *   w' = -3 mu g / d,
 * and by symmetry (or by pairs of opposite corners) nothing pushes it sideways. A disc of radius R
 * that presses evenly has the moment int mu p r dA = 2/3 mu m g R and I = m R^2 / 2:
 *   w' = -4/3 mu g / R.
 * An engine that holds the disc by a few points of its rim gives it 2 mu g / R. Either stops after
 * w0 / |w'| and has then turned by w0^2 / (2 |w'|); in semi-implicit Euler it turns by the sum of
 * h w_k. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { SHAPE, SPIN, FRICTION, DT, DURATION, PARAM_COUNT };
enum { BOX, DISC };

static const double half[3] = {0.5, 0.3, 0.1}; /* m, of the box */
static const double radius = 0.5, half_height = 0.1;

static const pl_param params[PARAM_COUNT] = {
    [SHAPE] = {.name = "shape",
               .value = BOX,
               .min = BOX,
               .max = DISC,
               .integer = true,
               .unit = "1",
               .help = "0 box, 1 disc: a cylinder on its cap, by its continuum of contact"},
    [SPIN] = {.name = "spin",
              .value = 10,
              .min = 0.1,
              .max = 1000,
              .unit = "rad/s",
              .help = "at the start, about the vertical"},
    [FRICTION] = {.name = "friction",
                  .value = 0.3,
                  .min = 1e-3,
                  .max = 10,
                  .unit = "1",
                  .help = "Coulomb coefficient"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(1),
};

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_spin_stop.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    const bool is_box = values[SHAPE] == BOX;
    const double reach = is_box ? sqrt(half[0] * half[0] + half[1] * half[1]) : radius;
    const double braking = (is_box ? 3 : 4.0 / 3) * values[FRICTION] * -scene->gravity[2] / reach;
    const double spin = values[SPIN], steps = (double)pl_scene_steps(scene);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_body body = pl_body_default();
    body.shape =
        is_box ? pl_shape_box(half[0], half[1], half[2]) : pl_shape_cylinder(radius, half_height);
    body.position[2] = is_box ? half[2] : half_height;
    body.angular_velocity[2] = spin;
    const int index = pl_build_body(&builder, &body, "block");
    const pl_answer turn = pl_braked_way(spin, braking, scene->dt, steps);
    const double left = fmax(0, spin - braking * steps * scene->dt);
    pl_build_at_end(&builder, index, PL_QUANTITY_TURN, pl_axis_z, turn, turn.continuous);
    pl_build_at_end(&builder, index, PL_QUANTITY_SPIN, pl_axis_z, pl_exactly(left), spin);
    pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_x, pl_exactly(0), reach);
    pl_build_at_end(&builder, index, PL_QUANTITY_POSITION, pl_axis_y, pl_exactly(0), reach);
    pl_build_judge(&builder, pl_scenario_spin_stop.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_spin_stop = {
    .name = "spin-stop",
    .title = "Spin that friction stops",
    .description = "A box, or a disc, spins flat on the floor until it stops: whether friction at "
                   "the corners brakes the spin as much as Coulomb's law lets it.",
    .reference = "box on its corners, d from the axis: w' = -3 friction g / d; disc that presses "
                 "evenly: w' = -4/3 friction g / R; it turns by w0^2 / (2 |w'|)",
    .expected = "ok: the body turns by the angle of the reference and stays in its place",
    .source = "Coulomb's law: the moment of friction over the contact points; for the disc over "
              "its face, as in Farkas, Bartels, Unger and Wolf 2003, Frictional coupling between "
              "sliding and spinning motion",
    .primary_error = "value_error",
    .validity = "the box on its four corners alone; the disc with a continuum of contact",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_BOX,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
