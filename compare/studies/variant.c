/* The variants of scenarios, and how each changes the parameters. */
#include "variant.h"

#include "base/random.h"

#include <math.h>
#include <string.h>

const pl_variant pl_variant_none = {"as asked for", PL_VARIANT_NONE, 0};

#define OFFSET(k) "offset=0.01, seed + " #k, PL_VARIANT_OFFSET, k
#define DRAWN(k) "parameters within 1 %, draw " #k, PL_VARIANT_DRAWN, k
#define LARGER "n one larger", PL_VARIANT_LARGER, 0
#define SMALLER "n one smaller", PL_VARIANT_SMALLER, 0
#define FRICTION_UP "friction up by a last bit", PL_VARIANT_FRICTION_UP, 0
#define FRICTION_DOWN "friction down by a last bit", PL_VARIANT_FRICTION_DOWN, 0

/* The variants that fail most often come first, because the others are then not run. */
static const pl_variant tuned_on[] = {{LARGER},   {OFFSET(1)}, {DRAWN(1)},  {OFFSET(4)},
                                      {DRAWN(4)}, {OFFSET(5)}, {OFFSET(6)}, {FRICTION_UP}};
static const pl_variant chosen_by[] = {{OFFSET(7)},  {DRAWN(7)},  {OFFSET(8)},  {DRAWN(8)},
                                       {OFFSET(9)},  {DRAWN(9)},  {OFFSET(10)}, {DRAWN(10)},
                                       {OFFSET(11)}, {OFFSET(12)}};
static const pl_variant held_out[] = {{FRICTION_DOWN}, {SMALLER},  {OFFSET(2)},
                                      {OFFSET(3)},     {DRAWN(2)}, {DRAWN(3)}};
static const pl_variant swept[] = {{LARGER},  {FRICTION_UP}, {DRAWN(1)}, {FRICTION_DOWN},
                                   {SMALLER}, {DRAWN(2)},    {DRAWN(3)}};

#define LIST(items) (items), sizeof(items) / sizeof(items)[0]
const pl_variants pl_variants_tuned_on = {LIST(tuned_on)};
const pl_variants pl_variants_chosen_by = {LIST(chosen_by)};
const pl_variants pl_variants_held_out = {LIST(held_out)};
const pl_variants pl_variants_swept = {LIST(swept)};

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
    static const char *const names[] = {[PL_VARIANT_FRICTION_UP] = "friction",
                                        [PL_VARIANT_FRICTION_DOWN] = "friction",
                                        [PL_VARIANT_LARGER] = "n",
                                        [PL_VARIANT_SMALLER] = "n",
                                        [PL_VARIANT_OFFSET] = "offset"};
    if (variant->kind == PL_VARIANT_NONE) {
        return true;
    }
    if (variant->kind == PL_VARIANT_DRAWN) {
        return draw(scenario, seed + (uint64_t)variant->seed, values);
    }
    /* The names are those of the catalogue; what a scene file means by them is not known. */
    const int index =
        scenario->file == NULL ? pl_scenario_param(scenario, names[variant->kind]) : -1;
    if (index < 0) {
        return false;
    }
    const double was = values[index];
    const double changed[] = {[PL_VARIANT_FRICTION_UP] = nextafter(was, (double)INFINITY),
                              [PL_VARIANT_FRICTION_DOWN] = nextafter(was, -(double)INFINITY),
                              [PL_VARIANT_LARGER] = was + 1,
                              [PL_VARIANT_SMALLER] = was - 1,
                              [PL_VARIANT_OFFSET] = 0.01};
    const double value = changed[variant->kind];
    const bool fits = value >= scenario->params[index].min && value <= scenario->params[index].max;
    values[index] = fits ? value : was;
    return fits;
}
