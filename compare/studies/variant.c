/* The variants of scenarios, and how each changes the parameters. */
#include "variant.h"

#include "base/random.h"

#include <math.h>
#include <string.h>

const pl_variant pl_variant_none = {"as asked for", PL_VARIANT_NONE, 0};

/* The variants that fail most often come first, because the others are then not run. */
static const pl_variant tuned_on[] = {
    {"n one larger", PL_VARIANT_LARGER, 0},
    {"offset=0.01, seed + 1", PL_VARIANT_OFFSET, 1},
    {"parameters within 1 %, draw 1", PL_VARIANT_DRAWN, 1},
    {"offset=0.01, seed + 4", PL_VARIANT_OFFSET, 4},
    {"parameters within 1 %, draw 4", PL_VARIANT_DRAWN, 4},
    {"offset=0.01, seed + 5", PL_VARIANT_OFFSET, 5},
    {"offset=0.01, seed + 6", PL_VARIANT_OFFSET, 6},
    {"friction up by a last bit", PL_VARIANT_FRICTION_UP, 0},
};

static const pl_variant chosen_by[] = {
    {"offset=0.01, seed + 7", PL_VARIANT_OFFSET, 7},
    {"parameters within 1 %, draw 7", PL_VARIANT_DRAWN, 7},
    {"offset=0.01, seed + 8", PL_VARIANT_OFFSET, 8},
    {"parameters within 1 %, draw 8", PL_VARIANT_DRAWN, 8},
    {"offset=0.01, seed + 9", PL_VARIANT_OFFSET, 9},
    {"parameters within 1 %, draw 9", PL_VARIANT_DRAWN, 9},
    {"offset=0.01, seed + 10", PL_VARIANT_OFFSET, 10},
    {"parameters within 1 %, draw 10", PL_VARIANT_DRAWN, 10},
    {"offset=0.01, seed + 11", PL_VARIANT_OFFSET, 11},
    {"offset=0.01, seed + 12", PL_VARIANT_OFFSET, 12},
};

static const pl_variant held_out[] = {
    {"friction down by a last bit", PL_VARIANT_FRICTION_DOWN, 0},
    {"n one smaller", PL_VARIANT_SMALLER, 0},
    {"offset=0.01, seed + 2", PL_VARIANT_OFFSET, 2},
    {"offset=0.01, seed + 3", PL_VARIANT_OFFSET, 3},
    {"parameters within 1 %, draw 2", PL_VARIANT_DRAWN, 2},
    {"parameters within 1 %, draw 3", PL_VARIANT_DRAWN, 3},
};

static const pl_variant swept[] = {
    {"n one larger", PL_VARIANT_LARGER, 0},
    {"friction up by a last bit", PL_VARIANT_FRICTION_UP, 0},
    {"parameters within 1 %, draw 1", PL_VARIANT_DRAWN, 1},
    {"friction down by a last bit", PL_VARIANT_FRICTION_DOWN, 0},
    {"n one smaller", PL_VARIANT_SMALLER, 0},
    {"parameters within 1 %, draw 2", PL_VARIANT_DRAWN, 2},
    {"parameters within 1 %, draw 3", PL_VARIANT_DRAWN, 3},
};

#define LIST(items)                                                                                \
    {                                                                                              \
        (items), sizeof(items) / sizeof(items)[0]                                                  \
    }
const pl_variants pl_variants_tuned_on = LIST(tuned_on);
const pl_variants pl_variants_chosen_by = LIST(chosen_by);
const pl_variants pl_variants_held_out = LIST(held_out);
const pl_variants pl_variants_swept = LIST(swept);

/* Changes a parameter where the scenario has it and its range contains the new value. The names are
 * those of the catalogue; what a scene file means by them is not known. */
static bool set(const pl_scenario *scenario, const char *name, double (*change)(double value),
                double *values)
{
    const int index = scenario->file == NULL ? pl_scenario_param(scenario, name) : -1;
    if (index < 0) {
        return false;
    }
    const pl_param *param = &scenario->params[index];
    const double value = change(values[index]);
    const bool fits = value >= param->min && value <= param->max;
    values[index] = fits ? value : values[index];
    return fits;
}

static double bit_up(double value)
{
    return nextafter(value, (double)INFINITY);
}

static double bit_down(double value)
{
    return nextafter(value, -(double)INFINITY);
}

static double one_more(double value)
{
    return value + 1;
}

static double one_less(double value)
{
    return value - 1;
}

static double small_offset(double value)
{
    (void)value;
    return 0.01;
}

/* The time step and the duration are not drawn: they are not part of the scene. */
static bool is_drawn(const pl_param *param, double value)
{
    return !param->integer && value != 0 && strcmp(param->name, "dt") != 0 &&
           strcmp(param->name, "duration") != 0;
}

/* A scenario with a critical value is left alone: on the other side of it another answer is right. */
static bool draw(const pl_scenario *scenario, uint64_t seed, double *values)
{
    const double part = 0.01;
    pl_random random = {.state = seed};
    bool changed = false;
    for (int i = 0; i < scenario->param_count && scenario->threshold == NULL; ++i) {
        const pl_param *param = &scenario->params[i];
        if (is_drawn(param, values[i])) {
            const double moved = values[i] * (1 + part * (2 * pl_random_unit(&random) - 1));
            const double value = fmin(fmax(moved, param->min), param->max);
            changed = changed || value != values[i];
            values[i] = value;
        }
    }
    return changed;
}

bool pl_variant_apply(const pl_variant *variant, const pl_scenario *scenario, uint64_t seed,
                      double *values)
{
    switch (variant->kind) {
    case PL_VARIANT_FRICTION_UP:
        return set(scenario, "friction", bit_up, values);
    case PL_VARIANT_FRICTION_DOWN:
        return set(scenario, "friction", bit_down, values);
    case PL_VARIANT_LARGER:
        return set(scenario, "n", one_more, values);
    case PL_VARIANT_SMALLER:
        return set(scenario, "n", one_less, values);
    case PL_VARIANT_OFFSET:
        return set(scenario, "offset", small_offset, values);
    case PL_VARIANT_DRAWN:
        return draw(scenario, seed + (uint64_t)variant->seed, values);
    case PL_VARIANT_NONE:
        break;
    }
    return true;
}
