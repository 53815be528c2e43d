/* The table of metrics: what each one is, in a line. */
#include "metrics.h"

#include <string.h>

const pl_metric_info pl_metric_table[PL_METRIC_COUNT] = {
    [PL_METRIC_REFERENCE_ERROR] =
        {"reference_error", "as the scenario says", PL_LOWER_IS_BETTER, true,
         "the scenario's primary error: the metric that the scene names, copied with its unit"},
    [PL_METRIC_REST_POSITION_ERROR] =
        {"rest_position_error", "m", PL_LOWER_IS_BETTER, true,
         "max over bodies of the distance of the final position from the reference"},
    [PL_METRIC_REST_ROTATION_ERROR] =
        {"rest_rotation_error", "rad", PL_LOWER_IS_BETTER, true,
         "max over bodies of the angle from the reference orientation to the final one, 0 .. pi; "
         "spheres are left out"},
    [PL_METRIC_TRAVEL_ERROR] =
        {"travel_error", "1", PL_LOWER_IS_BETTER, true,
         "max over travelling bodies of |(x_end - x_0).d - s| / |s|, s the continuous answer"},
    [PL_METRIC_VALUE_ERROR] =
        {"value_error", "1", PL_LOWER_IS_BETTER, true,
         "max over the scene's expected values (velocities, spins, turns, apexes, periods, "
         "positions) "
         "of |found - value| / scale, against the continuous answer"},
    [PL_METRIC_DISCRETE_ERROR] =
        {"discrete_error", "1", PL_LOWER_IS_BETTER, true,
         "travel_error or value_error against the exact answer of the engine's own integrator at "
         "the scene's step: what contacts and friction err by, without the stepping; absent where "
         "the integrator is not told, or that answer is not known of all that is expected"},
    [PL_METRIC_PATH_DEVIATION] =
        {"path_deviation", "m", PL_LOWER_IS_BETTER, true,
         "max over steps and travelling bodies of the distance of the centre from the line of "
         "travel "
         "through its start, without the part normal to the plane that bears the body"},
    [PL_METRIC_LIFT] =
        {"lift", "m", PL_LOWER_IS_BETTER, true,
         "max over steps and bodies with an expected rest or travel of the height of the centre "
         "over "
         "its rest (travel: its start) along the normal of the plane that bears the body"},
    [PL_METRIC_PENETRATION_MAX] =
        {"penetration_max", "m", PL_LOWER_IS_BETTER, true,
         "max over steps and pairs of max(0, -gap); percentiles over steps x pairs with gap <= 0, "
         "to 0.8 %"},
    [PL_METRIC_PENETRATION_REST] =
        {"penetration_rest", "m", PL_LOWER_IS_BETTER, true,
         "mean over the last second of the per-frame maximum of max(0, -gap)"},
    [PL_METRIC_DRIFT] =
        {"drift", "m", PL_LOWER_IS_BETTER, true,
         "max over bodies and later frames of the displacement since settle_time (unsettled: since "
         "1 s or half the duration) in directions in which the reference does not move"},
    [PL_METRIC_CREEP] =
        {"creep", "m/s", PL_LOWER_IS_BETTER, true,
         "max over bodies of the least-squares slope of drift's displacement vector over time"},
    [PL_METRIC_ENERGY_GAIN] =
        {"energy_gain", "1", PL_LOWER_IS_BETTER, true,
         "max over frames of (E - E_0 - work of scene forces) / E_ref, the start's 0 included; E = "
         "kinetic + potential, + (h/2) m g.v where most steps fit x' = x + h v' (semi-implicit "
         "Euler); E_ref = initial kinetic + M |g| H"},
    [PL_METRIC_ENERGY_STEP_GAIN] =
        {"energy_step_gain", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and islands of (E' - E - work of scene forces) / E_ref of energy_gain, 0 "
         "at "
         "least; an island: bodies that touch, in the frame before or after, or could have"},
    [PL_METRIC_MOMENTUM_ERROR] =
        {"momentum_error", "1", PL_LOWER_IS_BETTER, true,
         "max over frames of |p - p_0 - impulses of gravity, forces and static contacts| / p_ref, "
         "linear and angular (about the origin), the larger"},
    [PL_METRIC_FORCE_BALANCE] =
        {"force_balance", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and bodies of |sum r + h m g + h F - m dv| / (h m |g|), r the reported "
         "contact impulses, F the scene's forces, dv from frames; absent without gravity"},
    [PL_METRIC_CONE_VIOLATION] =
        {"cone_violation", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and contacts of (|r_t| - mu r_n)+ / (mu r_n), of those that carry more "
         "than 1e-3 of the lighter body's weight"},
    [PL_METRIC_FRICTION_EFFECTIVE] =
        {"friction_effective", "1", PL_NO_DIRECTION, true,
         "mean over steps and such contacts that slide, |u_t| > h |g|, of |r_t| / r_n: the mu "
         "that was applied; u is the relative velocity after the step"},
    [PL_METRIC_SIGNORINI] =
        {"signorini", "W", PL_LOWER_IS_BETTER, true,
         "max over steps and contacts of |r_n u_n| / h, u_n + gap / h where a gap was open; pairs "
         "with restitution are left out"},
    [PL_METRIC_NATURAL_MAP] =
        {"natural_map", "m/s", PL_LOWER_IS_BETTER, true,
         "max over steps and the same contacts of |r - P_K(r - rho (u + mu |u_t| n))| / rho: the "
         "residual of the contact law, by reported impulses; K the cone, rho the contact's "
         "effective mass"},
    [PL_METRIC_SETTLE_TIME] =
        {"settle_time", "s", PL_LOWER_IS_BETTER, true,
         "first time from which every body is below 1 mm/s and 1 mrad/s for 0.5 s"},
    [PL_METRIC_SPREAD_X] = {"spread_x", "m", PL_NO_DIRECTION, true,
                            "standard deviation over the dynamic bodies of their centres' x at the "
                            "end; two bodies at least"},
    [PL_METRIC_SPREAD_Y] = {"spread_y", "m", PL_NO_DIRECTION, true, "the same of y"},
    [PL_METRIC_MASS_HEIGHT] =
        {"mass_height", "m", PL_NO_DIRECTION, true,
         "height above the origin, against gravity, of the centre of mass of all dynamic bodies at "
         "the end"},
    [PL_METRIC_RUN_OUT_P95] =
        {"run_out_p95", "m", PL_NO_DIRECTION, true,
         "95th percentile over the dynamic bodies of the way of the centre from start to end, "
         "across gravity"},
    [PL_METRIC_ENERGY_LOST] =
        {"energy_lost", "J", PL_NO_DIRECTION, true,
         "E_0 + work of scene forces - E at the end, E as for energy_gain: what was dissipated"},
    [PL_METRIC_ITERATIONS_MEAN] = {"iterations_mean", "1", PL_LOWER_IS_BETTER, true,
                                   "solver iterations a step as the engine reports them, mean"},
    [PL_METRIC_ITERATIONS_MAX] = {"iterations_max", "1", PL_LOWER_IS_BETTER, true,
                                  "solver iterations a step as the engine reports them, largest"},
    [PL_METRIC_ITERATIONS_TO_TOLERANCE] =
        {"iterations_to_tolerance", "1", PL_LOWER_IS_BETTER, true,
         "the least iteration budget whose reference_error is within 10 % of the converged one, by "
         "doubling and bisection: comparable between engines where raw counts are not; given by "
         "plumb compare --iterations-to-tolerance to engines with an option iterations"},
    [PL_METRIC_RESIDUAL_MAX] =
        {"residual_max", "engine's own", PL_LOWER_IS_BETTER, true,
         "max over steps of the residual after the last iteration as the engine reports it"},
    [PL_METRIC_RESIDUAL_RMS] =
        {"residual_rms", "engine's own", PL_LOWER_IS_BETTER, true,
         "root mean square over steps of the residual after the last iteration as the engine "
         "reports it"},
    [PL_METRIC_CONTACTS_MEAN] = {"contacts_mean", "1", PL_NO_DIRECTION, true,
                                 "contact points a step as the engine reports them, mean"},
    [PL_METRIC_TIME_PER_STEP] = {"time_per_step", "s", PL_LOWER_IS_BETTER, false,
                                 "CPU time of the engine's step alone, mean over steps"},
    [PL_METRIC_INSTRUCTIONS_PER_STEP] =
        {"instructions_per_step", "1", PL_LOWER_IS_BETTER, false,
         "instructions of the engine's step alone in user space, all threads, mean over steps; "
         "absent where the kernel or the machine does not count them"},
    [PL_METRIC_MEMORY_PEAK] = {"memory_peak", "bytes", PL_LOWER_IS_BETTER, false,
                               "growth of the resident set of the run's own process"},
    [PL_METRIC_INTEGRATOR] =
        {"integrator", "rule", PL_NO_DIRECTION, true,
         "the rule that takes velocities to positions, told from frames: 'semi-implicit Euler', x' "
         "= x + h v', or 'second order, exact for constant force', x' = x + h (v + v')/2: which "
         "nine in ten fit of the steps in free flight, or if nothing flies, of the others; 'mixed' "
         "where neither has so many, absent where nothing tells"},
    [PL_METRIC_STATE_HASH] =
        {"state_hash", "hex", PL_NO_DIRECTION, true,
         "64-bit FNV-1a of the bits of all final positions and orientations as they are (0 and -0 "
         "differ)"},
};

int pl_metric_by_name(const char *name)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        if (strcmp(pl_metric_table[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}
