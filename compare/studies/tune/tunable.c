/* The table of tunable options, and settings written in an engine's own API. */
#include "tunable.h"

#include <math.h>
#include <string.h>

/* Bits in the order of the engines' tables of profiles. */
enum {
    ODE_QUICK = 1u << 0,
    ODE_DANTZIG = 1u << 1,
    ODE_ALL = ODE_QUICK | ODE_DANTZIG,
    BULLET_SI = 1u << 0,
    BULLET_NNCG = 1u << 1,
    BULLET_ALL = 15u,
    PLUMB_ALL = 7u
};

static const pl_tunable tunables[] = {
    {"ode", "iterations", ODE_QUICK, 1, 300, true, "dWorldSetQuickStepNumIterations(world, ", ");"},
    {"ode", "erp", ODE_ALL, 0.05, 1, false, "dWorldSetERP(world, ", ");"},
    {"ode", "cfm", ODE_ALL, 1e-10, 1e-3, true, "dWorldSetCFM(world, ", ");"},
    {"ode", "max_contacts", ODE_ALL, 3, 8, false, "dCollide(a, b, ",
     ", contacts, sizeof *contacts); /* of other shapes than hulls and meshes */"},
    {"ode", "solid_contacts", 0, 0, 0, false, "dCollide(a, b, ",
     ", contacts, sizeof *contacts); /* of hulls and meshes */"},
    {"ode", "surface_layer", ODE_ALL, 0, 0.002, false, "dWorldSetContactSurfaceLayer(world, ",
     ");"},
    {"bullet", "iterations", BULLET_SI | BULLET_NNCG, 1, 300, true,
     "world->getSolverInfo().m_numIterations = ", ";"},
    {"bullet", "split_impulse", BULLET_ALL, 0, 1, false,
     "world->getSolverInfo().m_splitImpulse = ", ";"},
    {"bullet", "erp", 0, 0, 0, false, "world->getSolverInfo().m_erp = ", ";"},
    {"bullet", "erp2", BULLET_ALL, 0.05, 1, false, "world->getSolverInfo().m_erp2 = ", ";"},
    {"bullet", "restitution_threshold", 0, 0, 0, false,
     "world->getSolverInfo().m_restitutionVelocityThreshold = ", ";"},
    {"bullet", "margin", BULLET_ALL, 0.001, 0.1, true, "shape->setMargin(",
     "); /* of boxes and cylinders; at most a tenth of the least half extent */"},
    {"bullet", "solid_margin", 0, 0, 0, false, "shape->setMargin(", "); /* of hulls and meshes */"},
    {"bullet", "plane_multipoint", BULLET_ALL, 0, 4, false,
     "const int points = ", "; configuration.setPlaneConvexMultipointIterations(points, points);"},
    {"plumb", "tolerance", PLUMB_ALL, 1e-10, 1e-2, true, "def.tolerance = ", ";"},
    {"plumb", "updates", PLUMB_ALL, 1e3, 1e7, true, "def.max_contact_updates = ", ";"},
    {"plumb", "iterations", 0, 0, 0, false, "def.max_iterations = ", ";"},
    {"plumb", "slop", PLUMB_ALL, 1e-6, 1e-2, true, "def.penetration_slop = ", ";"},
    {"plumb", "impact_bodies", PLUMB_ALL, 0, 16, false, "def.impact_bodies = ", ";"},
};
enum { TUNABLE_COUNT = sizeof tunables / sizeof tunables[0] };

typedef struct step_text {
    const char *engine;
    unsigned profiles;
    const char *before, *after;
} step_text;

static const step_text steps[] = {
    {"ode", ODE_QUICK, "dWorldQuickStep(world, ", ");"},
    {"ode", ODE_DANTZIG, "dWorldStep(world, ", ");"},
    {"bullet", BULLET_ALL, "world->stepSimulation(", ", 0);"},
    {"plumb", PLUMB_ALL, "pe_world_step(world, ", ", &stats, &error);"},
};

static const pl_tunable *find(const char *engine, const char *option)
{
    for (int i = 0; i < TUNABLE_COUNT; ++i) {
        if (strcmp(tunables[i].engine, engine) == 0 && strcmp(tunables[i].option, option) == 0) {
            return &tunables[i];
        }
    }
    return NULL;
}

static bool is_in_table(const char *engine)
{
    for (int i = 0; i < TUNABLE_COUNT; ++i) {
        if (strcmp(tunables[i].engine, engine) == 0) {
            return true;
        }
    }
    return false;
}

const pl_tunable *pl_tunable_find(const pl_engine *engine, int profile, const char *option)
{
    static const pl_tunable of_others = {.low = 1, .high = 300, .logarithmic = true};
    const pl_tunable *found = find(engine->name, option);
    if (!is_in_table(engine->name) && strcmp(option, "iterations") == 0) {
        return &of_others;
    }
    return found != NULL && (found->profiles >> profile & 1u) != 0 ? found : NULL;
}

pl_status pl_tune_defaults(const pl_engine_choice *choice, pl_engine_choice *defaults,
                           pl_error *error)
{
    /* A loaded engine is found by its path alone. */
    const char *profile = choice->engine->profiles[choice->profile].name;
    char name[sizeof choice->spec];
    char spec[sizeof name + PL_NAME_SIZE];
    snprintf(name, sizeof name, "%s", choice->spec);
    char *end = strstr(name, ".so");
    if (end != NULL) {
        end[3] = '\0';
    } else {
        snprintf(name, sizeof name, "%s", choice->engine->name);
    }
    snprintf(spec, sizeof spec, "%s:%s", name, profile);
    return pl_engine_choose(spec, defaults, error);
}

void pl_tune_spec(const pl_engine_choice *choice, char spec[256])
{
    pl_engine_choice defaults;
    if (pl_tune_defaults(choice, &defaults, NULL) != PL_OK) {
        spec[0] = '\0';
        return;
    }
    const pl_engine *engine = choice->engine;
    char text[256];
    int used = snprintf(text, sizeof text, "%s", defaults.spec);
    for (int i = 0; i < engine->option_count && used < (int)sizeof text; ++i) {
        if (choice->values[i] != defaults.values[i]) {
            used += snprintf(text + used, sizeof text - (size_t)used, ",%s=%.15g",
                             engine->options[i].name, choice->values[i]);
        }
    }
    memcpy(spec, text, sizeof text);
}

static void print_step(FILE *out, const pl_engine_choice *choice, double dt)
{
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; ++i) {
        if (strcmp(steps[i].engine, choice->engine->name) == 0 &&
            (steps[i].profiles >> choice->profile & 1u) != 0) {
            const double rate = 1 / dt;
            const bool whole = fabs(rate - nearbyint(rate)) < 1e-9 * rate;
            fprintf(out, whole ? "    %s1.0 / %.0f%s\n" : "    %s%.9g%s\n", steps[i].before,
                    whole ? nearbyint(rate) : dt, steps[i].after);
        }
    }
}

void pl_tune_print_api(FILE *out, const pl_engine_choice *choice, double dt)
{
    pl_engine_choice defaults;
    if (pl_tune_defaults(choice, &defaults, NULL) != PL_OK) {
        return;
    }
    for (int i = 0; i < choice->engine->option_count; ++i) {
        const pl_tunable *text = find(choice->engine->name, choice->engine->options[i].name);
        if (text != NULL && choice->values[i] != defaults.values[i]) {
            fprintf(out, "    %s%.15g%s\n", text->before, choice->values[i], text->after);
        }
    }
    if (!isnan(dt)) {
        print_step(out, choice, dt);
    }
}
