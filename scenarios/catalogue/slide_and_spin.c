/* A triangular plate slides and spins on its three corners until both end, at one instant.
 *
 * Three points, unlike four, share the weight in one way only. With r_i from the axis to corner i,
 * d_i the unit slip velocity there (v + w z x r_i over its length), H half the thickness and N_i
 * the reaction, friction -mu N_i d_i and a plate that stays flat ask for
 *   sum N_i = m g,  sum N_i (r_i - mu H d_i) = 0,
 *   m v' = -mu sum N_i d_i,  I w' = -mu sum N_i (r_i x d_i),
 * solved here by the classical Runge-Kutta rule until 1e-8 of the energy is left, which is worth
 * 1e-8 of the way. It brakes less in either motion than if the other were not there: on a disc
 * that presses evenly v / (R w) tends to 0.653 as both end, from any start (Farkas and others
 * 2003). */
#include "catalogue.h"
#include "solids.h"
#include "trigonometry.h"
#include "uniform_motion.h"

#include <math.h>

enum { SPEED, SPIN, FRICTION, DT, DURATION, PARAM_COUNT };

static const double radius = 0.5, half_height = 0.05; /* m */

static const pl_param params[PARAM_COUNT] = {
    [SPEED] = {.name = "speed",
               .value = 2,
               .min = 0.1,
               .max = 100,
               .unit = "m/s",
               .help = "at the start"},
    [SPIN] = {.name = "spin",
              .value = 6,
              .min = 0.1,
              .max = 200,
              .unit = "rad/s",
              .help = "at the start, about the vertical; the corners are 0.5 m from the axis"},
    [FRICTION] = {.name = "friction",
                  .value = 0.3,
                  .min = 0.01,
                  .max = 1,
                  .unit = "1",
                  .help = "Coulomb coefficient"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

/* Of a plate of 1 kg. `corner` is the unit vector from the axis to the first corner. */
enum { X, Y, TURN, VX, VY, W, CORNER_X, CORNER_Y, UNKNOWNS };

static const double inertia_over_square = 0.25; /* of 1 kg, over R^2: (2 + cos(2 pi / 3)) / 6 */

/* Cross product's z. */
static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

static void rate_of(const double *y, double friction, double g, double *rate)
{
    const double half_root_3 = 0.8660254037844386;
    static const double turn[3][2] = {{1, 0}, {-0.5, 1}, {-0.5, -1}};
    double r[3][2], slip[3][2], p[3][2], force[2] = {0, 0}, torque = 0;
    for (int i = 0; i < 3; i++) {
        const double c = turn[i][0], s = turn[i][1] * half_root_3;
        r[i][0] = radius * (c * y[CORNER_X] - s * y[CORNER_Y]);
        r[i][1] = radius * (s * y[CORNER_X] + c * y[CORNER_Y]);
        const double u[2] = {y[VX] - y[W] * r[i][1], y[VY] + y[W] * r[i][0]};
        const double speed = sqrt(u[0] * u[0] + u[1] * u[1]);
        for (int k = 0; k < 2; k++) {
            slip[i][k] = speed > 0 ? u[k] / speed : 0;
            p[i][k] = r[i][k] - friction * half_height * slip[i][k];
        }
    }
    /* The weights of the origin in the triangle of the p. */
    const double share[3] = {cross(p[1], p[2]), cross(p[2], p[0]), cross(p[0], p[1])};
    const double whole = share[0] + share[1] + share[2];
    for (int i = 0; i < 3; i++) {
        const double most = friction * g * share[i] / whole;
        force[0] -= most * slip[i][0];
        force[1] -= most * slip[i][1];
        torque -= most * cross(r[i], slip[i]);
    }
    rate[X] = y[VX];
    rate[Y] = y[VY];
    rate[TURN] = y[W];
    rate[VX] = force[0];
    rate[VY] = force[1];
    rate[W] = torque / (inertia_over_square * radius * radius);
    rate[CORNER_X] = -y[W] * y[CORNER_Y];
    rate[CORNER_Y] = y[W] * y[CORNER_X];
}

static double energy_of(const double *y)
{
    const double rim = radius * y[W];
    return y[VX] * y[VX] + y[VY] * y[VY] + inertia_over_square * rim * rim;
}

/* From y on, for so long or until it stops; then the velocities are 0. */
static void solve(double *y, double time, double friction, double g)
{
    enum { STEPS = 100000 };
    static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    const double least = 1e-8 * energy_of(y);
    const double h = fmin(time, (sqrt(energy_of(y)) * 2) / (friction * g)) / STEPS;
    double left = time;
    for (int n = 0; n < 4 * STEPS && left > 0 && energy_of(y) > least; n++) {
        const double step = fmin(h, left);
        double rate[UNKNOWNS] = {0}, sum[UNKNOWNS] = {0};
        for (int stage = 0; stage < 4; stage++) {
            double at[UNKNOWNS];
            for (int i = 0; i < UNKNOWNS; i++) {
                at[i] = y[i] + node[stage] * step * rate[i];
            }
            rate_of(at, friction, g, rate);
            for (int i = 0; i < UNKNOWNS; i++) {
                sum[i] += weight[stage] * rate[i];
            }
        }
        for (int i = 0; i < UNKNOWNS; i++) {
            y[i] += step / 6 * sum[i];
        }
        left -= step;
    }
    if (left > 0) {
        y[VX] = y[VY] = y[W] = 0;
    }
}

static void expect(pl_builder *builder, int plate, const double *y, const double *values)
{
    const double way = sqrt(y[X] * y[X] + y[Y] * y[Y]);
    pl_build_at_end(builder, plate, PL_QUANTITY_POSITION, pl_axis_x, pl_continuous(y[X]), way);
    pl_build_at_end(builder, plate, PL_QUANTITY_POSITION, pl_axis_y, pl_continuous(y[Y]), way);
    pl_build_at_end(builder, plate, PL_QUANTITY_TURN, pl_axis_z, pl_continuous(y[TURN]),
                    fabs(y[TURN]));
    pl_build_at_end(builder, plate, PL_QUANTITY_VELOCITY, pl_axis_x, pl_continuous(y[VX]),
                    values[SPEED]);
    pl_build_at_end(builder, plate, PL_QUANTITY_SPIN, pl_axis_z, pl_continuous(y[W]), values[SPIN]);
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_slide_and_spin.name, values[DT],
                                        values[DURATION], values[FRICTION], error);
    pl_build_floor(&builder, 0, 0, 1, 0);
    pl_solid solid = pl_solid_prism(3, radius, half_height);
    const pl_polyhedron *triangle = pl_build_solid(&builder, &solid, true, "triangle");
    if (builder.status == PL_OK) {
        double y[UNKNOWNS] = {[VX] = values[SPEED], [W] = values[SPIN]};
        pl_circle_point(1, 6, &y[CORNER_X], &y[CORNER_Y]);
        solve(y, (double)pl_scene_steps(scene) * scene->dt, values[FRICTION], -scene->gravity[2]);
        pl_body plate = pl_body_default();
        plate.shape = pl_shape_of(triangle);
        plate.position[2] = half_height;
        plate.velocity[0] = values[SPEED];
        plate.angular_velocity[2] = values[SPIN];
        expect(&builder, pl_build_body(&builder, &plate, "plate"), y, values);
    }
    pl_build_judge(&builder, pl_scenario_slide_and_spin.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_slide_and_spin = {
    .name = "slide-and-spin",
    .title = "Plate that slides and spins",
    .description = "A triangular plate slides and spins on its corners: friction at each against "
                   "its own slip, so that the spin carries the plate farther, and both end at one "
                   "instant.",
    .reference = "the equations of motion with Coulomb's friction at the three corners, solved to "
                 "1e-8 of the way; no closed form",
    .expected =
        "ok: way and turn are those of the reference; sliding and spinning end at one instant",
    .source = "Coulomb's law and statics of three points; the coupling: Farkas, Bartels, Unger and "
              "Wolf 2003, Frictional coupling between sliding and spinning motion",
    .primary_error = "value_error",
    .validity = "the plate stays flat, which it does while friction * 0.05 m is far below the "
                "0.25 m from its axis to its sides",
    .needs = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE | PL_NEEDS_HULL,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
