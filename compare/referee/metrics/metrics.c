/* The table of metrics, with the definition of each.
 *
 * Notation: a prime marks the value after a step, h is the step, g gravity, m the mass of a body, M
 * the mass of all dynamic bodies, E energy, p momentum, r the impulse of a contact on its second
 * body, n its normal, u the relative velocity of the bodies there. All vectors are in the world
 * frame. The formulas and their sources are at the heads of mechanics.c, contact_force.c,
 * reference_error.c, motion.c, touching.c and chaotic.c. */
#include "metrics.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const pl_metric_info pl_metric_table[PL_METRIC_COUNT] = {
    [PL_METRIC_REFERENCE_ERROR] =
        {"reference_error", "as the scenario says", PL_LOWER_IS_BETTER, true,
         "the scenario's primary error: a copy of the metric that the scene names, with its unit"},
    [PL_METRIC_REST_POSITION_ERROR] =
        {"rest_position_error", "m", PL_LOWER_IS_BETTER, true,
         "max over bodies of the distance of the final position from the reference"},
    [PL_METRIC_REST_ROTATION_ERROR] =
        {"rest_rotation_error", "rad", PL_LOWER_IS_BETTER, true,
         "max over bodies, without spheres, of the angle between the final orientation and the "
         "reference, 0 .. pi"},
    [PL_METRIC_TRAVEL_ERROR] =
        {"travel_error", "1", PL_LOWER_IS_BETTER, true,
         "max over travelling bodies of |x_end - x_0 - s d| / |s|, where s is the travel along d "
         "in "
         "the continuous problem: a drift to the side counts as much as a wrong distance"},
    [PL_METRIC_VALUE_ERROR] =
        {"value_error", "1", PL_LOWER_IS_BETTER, true,
         "max over the scene's expected values (velocities, spins, turns, apexes, periods, "
         "positions) of |found - value| / scale, where value is that of the continuous problem; of "
         "several right answers the nearest counts; a period that is not seen is found to be 0"},
    [PL_METRIC_DISCRETE_ERROR] =
        {"discrete_error", "1", PL_LOWER_IS_BETTER, true,
         "travel_error or value_error against the discrete reference: the exact result of the "
         "engine's own integrator at the scene's step and with the engine's sub-steps, so that the "
         "time-stepping error is left out, and for an engine in floats without what their rounding "
         "explains; absent where the scene has no discrete reference, null, with the reason, where "
         "the integrator was not detected or that of the engine is not known"},
    [PL_METRIC_STATISTICS_ERROR] =
        {"statistics_error", "1", PL_LOWER_IS_BETTER, true,
         "max over the scene's expected statistics of the distance of the run's value from the "
         "interval low .. high, / scale; 0 inside; the interval holds the 5 % to 95 % quantiles of "
         "converged runs of all engines, where two of them at least agree"},
    [PL_METRIC_CHAOTIC_ERROR] =
        {"chaotic_error", "1", PL_LOWER_IS_BETTER, true,
         "max of penetration_max p99 / L, penetration_max / (10 L), energy_gain, momentum_error "
         "and statistics_error, each where it has a value, and of 1e-3, its resolution; L is the "
         "least dimension of the smallest dynamic body; computed where it is the primary error"},
    [PL_METRIC_EXPECTATION_ERROR] =
        {"expectation_error", "1", PL_LOWER_IS_BETTER, true,
         "max over all that the scene expects (rests, orientations, travels, values, statistics) "
         "of "
         "the distance from it over its tolerance; at most 1 is right; the tolerance is the "
         "expectation's own, or else follows from the scene's acceptance; absent where nothing has "
         "a tolerance"},
    [PL_METRIC_PATH_DEVIATION] =
        {"path_deviation", "m", PL_LOWER_IS_BETTER, true,
         "max over steps and travelling bodies of the distance of the centre from the line of "
         "travel through its start, without the part along the normal of the supporting plane"},
    [PL_METRIC_LIFT] =
        {"lift", "m", PL_LOWER_IS_BETTER, true,
         "lift-off height: max over steps and bodies with an expected rest or travel of the height "
         "of the centre above its rest (travel: its start) along the normal of the supporting "
         "plane"},
    [PL_METRIC_PENETRATION_MAX] =
        {"penetration_max", "m", PL_LOWER_IS_BETTER, true,
         "max over steps and pairs of max(0, -gap); percentiles are over steps and pairs with "
         "gap <= 0, to 0.8 %"},
    [PL_METRIC_PENETRATION_REST] =
        {"penetration_rest", "m", PL_LOWER_IS_BETTER, true,
         "mean over the frames of the last second of the frame's maximum of max(0, -gap)"},
    [PL_METRIC_DRIFT] =
        {"drift", "m", PL_LOWER_IS_BETTER, true,
         "max over bodies and frames of the displacement since settle_time (of a scene that does "
         "not settle: since 1 s or half the duration) in directions in which the reference does "
         "not move; where the scene expects nothing of any body, of all bodies once it has "
         "settled"},
    [PL_METRIC_CREEP] =
        {"creep", "m/s", PL_LOWER_IS_BETTER, true,
         "max over bodies of the least-squares slope of drift's displacement vector over time"},
    [PL_METRIC_UNEXPLAINED_MOTION] =
        {"unexplained_motion", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and bodies of the part of the displacement of the centre that goes beyond "
         "h V + h^2 (|g| + F/m) + D, over the body's radius, at least 0; V is the largest speed, "
         "and D the sum of the overlaps, in the body's island before and after the step; beyond "
         "0.1 the run has failed"},
    [PL_METRIC_FREE_FLIGHT_ERROR] =
        {"free_flight_error", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and bodies that meet no other, and have no force of the scene, of "
         "|v' - v - h g| / (h |g|); absent where no body flies, and without gravity"},
    [PL_METRIC_ENERGY_GAIN] =
        {"energy_gain", "1", PL_LOWER_IS_BETTER, true,
         "max over frames of (E - E_0 - work of scene forces) / E_ref, at least 0; E = kinetic + "
         "potential energy, + (h/2) m g.v where most steps fit x' = x + h v' (semi-implicit "
         "Euler; h of a sub-step); E_ref = initial kinetic energy + M |g| H, where H is the "
         "initial "
         "height of the scene; of an engine in floats without what rounding explains: in each step "
         "2 (n + 1) 2^-24 of m (|v| + h |g|)^2 + m sum |g_k x_k| + 3 |w| |I w|, n sub-steps"},
    [PL_METRIC_ENERGY_STEP_GAIN] =
        {"energy_step_gain", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and islands of (E' - E - work of scene forces) / E_ref as for "
         "energy_gain, rounding of floats included, at least 0; an island consists of bodies that "
         "touch, or may have touched, "
         "in the frame before or after the step"},
    [PL_METRIC_MOMENTUM_ERROR] =
        {"momentum_error", "1", PL_LOWER_IS_BETTER, true,
         "max over frames of |p - p_0 - impulses of gravity, scene forces and static bodies| / "
         "p_ref, for linear and for angular momentum about the origin, whichever is larger; for "
         "an engine that divides the step, for linear momentum alone after a contact with a static "
         "body; of an engine in floats without what rounding of momenta and impulses explains"},
    [PL_METRIC_FORCE_BALANCE] =
        {"force_balance", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and bodies of |sum r + h m g + h F - m (v' - v)| / (h m |g|), where r are "
         "the reported contact impulses, F the scene's forces and v the velocities of the frames; "
         "absent without gravity"},
    [PL_METRIC_CONE_VIOLATION] =
        {"cone_violation", "1", PL_LOWER_IS_BETTER, true,
         "max over steps and loaded contacts of max(0, |r_t| - mu r_n) / (mu r_n); a contact is "
         "loaded if it bears more than 1e-3 of the lighter body's weight"},
    [PL_METRIC_FRICTION_EFFECTIVE] =
        {"friction_effective", "1", PL_NO_DIRECTION, true,
         "mean over steps and loaded contacts that slide, |u_t| > h |g|, of |r_t| / r_n: the "
         "friction coefficient that was applied; u is the relative velocity after the step"},
    [PL_METRIC_SIGNORINI] =
        {"signorini", "W", PL_LOWER_IS_BETTER, true,
         "max over steps and contacts of |r_n u_n| / h, with u_n + gap / h in place of u_n where "
         "a gap was open; pairs with restitution are left out"},
    [PL_METRIC_NATURAL_MAP] =
        {"natural_map", "m/s", PL_LOWER_IS_BETTER, true,
         "max over steps and contacts without restitution of "
         "|r - P_K(r - rho (u + mu |u_t| n))| / rho: the residual of the contact law for the "
         "reported impulses; K is the friction cone, P_K the projection onto it, rho the effective "
         "mass at the contact"},
    [PL_METRIC_SETTLE_TIME] =
        {"settle_time", "s", PL_LOWER_IS_BETTER, true,
         "first time from which every body stays below 1 mm/s and 1 mrad/s for 0.5 s"},
    [PL_METRIC_SPREAD_X] = {"spread_x", "m", PL_NO_DIRECTION, true,
                            "standard deviation over the dynamic bodies of the final x of their "
                            "centres; needs two bodies"},
    [PL_METRIC_SPREAD_Y] = {"spread_y", "m", PL_NO_DIRECTION, true, "as spread_x, of y"},
    [PL_METRIC_MASS_HEIGHT] =
        {"mass_height", "m", PL_NO_DIRECTION, true,
         "final height above the origin, against gravity, of the centre of mass of all dynamic "
         "bodies"},
    [PL_METRIC_RUN_OUT_P95] =
        {"run_out_p95", "m", PL_NO_DIRECTION, true,
         "95th percentile over the dynamic bodies of the displacement of the centre from start to "
         "end, normal to gravity"},
    [PL_METRIC_ENERGY_LOST] =
        {"energy_lost", "J", PL_NO_DIRECTION, true,
         "E_0 + work of scene forces - E at the end, with E as for energy_gain: the dissipated "
         "energy"},
    [PL_METRIC_ITERATIONS_MEAN] = {"iterations_mean", "1", PL_LOWER_IS_BETTER, true,
                                   "mean over steps of the solver iterations that the engine "
                                   "reports"},
    [PL_METRIC_ITERATIONS_MAX] = {"iterations_max", "1", PL_LOWER_IS_BETTER, true,
                                  "max over steps of the solver iterations that the engine "
                                  "reports"},
    [PL_METRIC_ITERATIONS_TO_TOLERANCE] =
        {"iterations_to_tolerance", "1", PL_LOWER_IS_BETTER, true,
         "the least iteration budget whose reference_error is within 10 % of the converged one, by "
         "doubling and bisection: comparable between engines, which raw counts are not; measured "
         "by plumb compare --iterations-to-tolerance for engines with an option iterations"},
    [PL_METRIC_RESIDUAL_MAX] =
        {"residual_max", "engine's own", PL_LOWER_IS_BETTER, true,
         "max over steps of the residual after the last iteration that the engine reports"},
    [PL_METRIC_RESIDUAL_RMS] =
        {"residual_rms", "engine's own", PL_LOWER_IS_BETTER, true,
         "root mean square over steps of the residual after the last iteration that the engine "
         "reports"},
    [PL_METRIC_CONTACTS_MEAN] = {"contacts_mean", "1", PL_NO_DIRECTION, true,
                                 "mean over steps of the contact points that the engine reports"},
    [PL_METRIC_TIME_PER_STEP] = {"time_per_step", "s", PL_LOWER_IS_BETTER, false,
                                 "mean over steps of the CPU time of the engine's step alone"},
    [PL_METRIC_WALL_TIME_PER_STEP] =
        {"wall_time_per_step", "s", PL_LOWER_IS_BETTER, false,
         "mean over steps of the elapsed time of the engine's step alone: above time_per_step the "
         "engine waited, below it several threads worked"},
    [PL_METRIC_TIME_CREATE] = {"time_create", "s", PL_LOWER_IS_BETTER, false,
                               "CPU time in which the engine built the scene"},
    [PL_METRIC_WALL_TIME_CREATE] = {"wall_time_create", "s", PL_LOWER_IS_BETTER, false,
                                    "elapsed time in which the engine built the scene"},
    [PL_METRIC_TIME_READ] = {"time_read", "s", PL_LOWER_IS_BETTER, false,
                             "mean over steps of the CPU time in which the engine handed out the "
                             "frame and the contacts"},
    [PL_METRIC_WALL_TIME_READ] = {"wall_time_read", "s", PL_LOWER_IS_BETTER, false,
                                  "mean over steps of the elapsed time of the same"},
    [PL_METRIC_INSTRUCTIONS_PER_STEP] =
        {"instructions_per_step", "1", PL_LOWER_IS_BETTER, false,
         "mean over steps of the user-space instructions of the engine's step alone, of all "
         "threads; absent where the kernel or the machine does not count them"},
    [PL_METRIC_MEMORY_PEAK] = {"memory_peak", "bytes", PL_LOWER_IS_BETTER, false,
                               "growth of the resident set of the run's own process"},
    [PL_METRIC_INTEGRATOR] =
        {"integrator", "rule", PL_NO_DIRECTION, true,
         "the rule that moves positions by velocities, detected from frames: 'semi-implicit "
         "Euler', x' = x + h v', or 'second order, exact for constant force', x' = x + h (v + "
         "v')/2, if nine in ten of the steps in free flight fit it (without free flight: of the "
         "other steps); 'mixed' if neither rule has so many; absent if no step distinguishes them"},
    [PL_METRIC_STATE_HASH] =
        {"state_hash", "hex", PL_NO_DIRECTION, true,
         "64-bit FNV-1a hash of the bits of all final positions and orientations (0 and -0 "
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

pl_metric pl_metric_value(double value)
{
    return (pl_metric){.state = PL_METRIC_VALUE, .value = value};
}

pl_metric pl_metric_failed(const char *format, ...)
{
    pl_metric metric = {.state = PL_METRIC_FAILED};
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(metric.reason, sizeof metric.reason, format, arguments);
    va_end(arguments);
    return metric;
}
