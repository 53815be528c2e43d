/* The list of scenarios, and their parameters from the command line. */
#include "catalogue.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The one place where a scenario is registered: pl_scenario_NAME, in the order of reports. */
/* clang-format off */
#define EACH_SCENARIO(DO) \
    DO(tower) DO(mass_ratio) DO(slope_stick) DO(slope_slide) DO(slide_to_stop) DO(wall) \
    DO(wall_collapse) DO(pile) DO(rest_shape) DO(linked_rings) DO(roll_slope) DO(blocks) \
    DO(thin_wall) DO(rocket) DO(slope_threshold) DO(slope_tip) DO(ladder) DO(multi_tower) \
    DO(pyramid) DO(overhang) DO(cylinder_pyramid) DO(sphere_pyramid) DO(large_step) \
    DO(far_from_origin) DO(initial_overlap) DO(thin_rod) DO(arch) DO(card_house) DO(painleve) \
    DO(needle_in_gap) DO(free_fall) DO(projectile) DO(bowling) DO(torque_free) DO(bounce) \
    DO(oblique_impact) DO(collision_train) DO(rocking_block) DO(isotropy) DO(carried_balls) \
    DO(reaction_split) DO(spin_stop) DO(cradle) DO(dominoes) DO(falling_cubes) \
    DO(domino_into_pile) DO(domino_spiral) DO(container) DO(rubble) DO(medley) DO(top) \
    DO(slide_and_spin) DO(bounce_row) DO(dropped_load) DO(lid) DO(raft) DO(rain) \
    DO(spinning_coin) DO(overlapping_start) DO(city) DO(avalanche) DO(seams) DO(pedestal) \
    DO(drop_coefficients) DO(elastic_bounces) DO(slow_impact) DO(late_bounces) \
    DO(no_rebound) DO(fast_slide) DO(ramp_grid) DO(stopping_distances) DO(push_directions) \
    DO(sliding_heading) DO(seam_lanes) DO(seam_wall) DO(passing_flush) \
    DO(alternating_stack) DO(heavy_cylinder) DO(upright_cylinder) DO(lying_battery) \
    DO(peg_on_cube) DO(hulls_touch) DO(touching_boxes) DO(eight_balls) DO(fast_marble) \
    DO(pool_ball) DO(long_roll) DO(tumbling_box) DO(flipping_box) DO(steady_box) \
    DO(balls_666) DO(elastic_666) DO(kapla) DO(tip_passes) DO(tip_on_tip) DO(tip_in_gap) DO(cliff) \
    DO(tessellated_rest) DO(tessellated_slide) DO(tessellated_roll)
/* clang-format on */

#define DECLARE(name) extern const pl_scenario pl_scenario_##name;
EACH_SCENARIO(DECLARE)

#define ADDRESS(name) &pl_scenario_##name,
static const pl_scenario *const scenarios[] = {EACH_SCENARIO(ADDRESS)};
enum { SCENARIO_COUNT = sizeof scenarios / sizeof scenarios[0] };

const pl_scenario *const *pl_scenarios(int *count)
{
    *count = SCENARIO_COUNT;
    return scenarios;
}

const pl_scenario *pl_scenario_find(const char *name, pl_error *error)
{
    const char *names[SCENARIO_COUNT];
    for (int i = 0; i < SCENARIO_COUNT; ++i) {
        names[i] = scenarios[i]->name;
        if (strcmp(name, names[i]) == 0) {
            return scenarios[i];
        }
    }
    const char *nearest = error == NULL ? NULL : pl_nearest_name(name, names, SCENARIO_COUNT);
    if (nearest != NULL) {
        pl_fail(error, PL_BAD_INPUT, "unknown scenario \"%s\"; did you mean \"%s\"?", name,
                nearest);
    } else {
        pl_fail(error, PL_BAD_INPUT, "unknown scenario \"%s\"", name);
    }
    return NULL;
}

static pl_status fail_by_name(const pl_scenario *scenario, const char *setting, int length,
                              pl_error *error)
{
    const char *names[PL_MAX_PARAMS];
    char word[PL_NAME_SIZE], list[256] = "";
    for (int i = 0; i < scenario->param_count; ++i) {
        size_t used = strlen(list);
        names[i] = scenario->params[i].name;
        snprintf(list + used, sizeof list - used, "%s%s", i == 0 ? "" : ", ", names[i]);
    }
    snprintf(word, sizeof word, "%.*s", length, setting);
    const char *nearest = pl_nearest_name(word, names, scenario->param_count);
    if (nearest != NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s has no parameter \"%s\"; did you mean \"%s\"?",
                       scenario->name, word, nearest);
    }
    return pl_fail(error, PL_BAD_INPUT, "%s has no parameter \"%s\"; it has %s", scenario->name,
                   word, list);
}

static pl_status parse_value(const pl_scenario *scenario, const pl_param *param, const char *text,
                             double *value, pl_error *error)
{
    double number;
    if (!pl_parse_number(text, &number)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: %s: expected a number, found \"%s\"",
                       scenario->name, param->name, text);
    }
    if (param->integer && number != floor(number)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: %s: expected a whole number, found %s",
                       scenario->name, param->name, text);
    }
    if (number < param->min || number > param->max) {
        return pl_fail(error, PL_BAD_INPUT, "%s: %s: expected %g to %g (%s), found %s",
                       scenario->name, param->name, param->min, param->max, param->unit, text);
    }
    *value = number;
    return PL_OK;
}

/* One "NAME=VALUE". */
static pl_status apply_setting(const pl_scenario *scenario, const char *setting, double *values,
                               pl_error *error)
{
    const char *equals = strchr(setting, '=');
    if (equals == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected NAME=VALUE, found \"%s\"", scenario->name,
                       setting);
    }
    size_t length = (size_t)(equals - setting);
    int index = -1;
    for (int i = 0; i < scenario->param_count && index < 0; ++i) {
        const char *name = scenario->params[i].name;
        index = strlen(name) == length && memcmp(setting, name, length) == 0 ? i : -1;
    }
    if (index < 0) {
        return fail_by_name(scenario, setting, (int)length, error);
    }
    return parse_value(scenario, &scenario->params[index], equals + 1, &values[index], error);
}

pl_status pl_scenario_values(const pl_scenario *scenario, const char *const *settings, int count,
                             double *values, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < scenario->param_count; ++i) {
        values[i] = scenario->params[i].value;
    }
    for (int s = 0; s < count && status == PL_OK; ++s) {
        const char *next = settings[s];
        do {
            char setting[256];
            const int length = (int)strcspn(next, ",");
            snprintf(setting, sizeof setting, "%.*s", length, next);
            status = apply_setting(scenario, setting, values, error);
            next += length;
        } while (status == PL_OK && *next++ == ',');
    }
    return status;
}
