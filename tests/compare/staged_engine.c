/* An engine of the loadable ABI that commits one fault at one stage, both named by its own file:
 * STAGE-FAULT.so is a copy of it. Its physics is free fall by semi-implicit Euler. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include "staged_faults.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

struct pl_engine_instance {
    const pl_scene *scene;
    int steps;
    pl_body_state states[];
};

/* Commits the fault of this file when `stage` is its stage. */
static void reach(const char *stage)
{
    Dl_info info;
    char fault[64];
    if (dladdr(&staged, &info) == 0) {
        return;
    }
    const char *slash = strrchr(info.dli_fname, '/');
    const char *name = slash == NULL ? info.dli_fname : slash + 1;
    const size_t length = strlen(stage);
    if (strncmp(name, stage, length) != 0 || name[length] != '-') {
        return;
    }
    name += length + 1;
    const size_t size = strcspn(name, ".");
    if (size < sizeof fault) {
        memcpy(fault, name, size);
        fault[size] = '\0';
        staged_commit(fault);
    }
}

/* What create and step return. */
static pl_status result(pl_error *error)
{
    if (staged.message != NULL) {
        memcpy(error->message, staged.message, sizeof error->message);
    }
    return staged.returned;
}

/* ---- Stages ---- */

__attribute__((constructor)) static void load(void)
{
    reach("load");
}

__attribute__((destructor)) static void unload(void)
{
    reach("unload");
}

static void profile_defaults(int profile, double *values)
{
    values[0] = profile;
    reach("defaults");
}

static const void *extension(const char *name)
{
    (void)name;
    reach("extension");
    return NULL;
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const size_t count = (size_t)scene->body_count;
    pl_engine_instance *made = calloc(1, sizeof *made + count * sizeof made->states[0]);
    if (made == NULL) {
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory");
    }
    made->scene = scene;
    for (size_t i = 0; i < count; ++i) {
        pl_initial_state(&scene->bodies[i], &made->states[i]);
    }
    *instance = made;
    reach("create");
    if (staged.makes_nothing) {
        *instance = NULL;
        free(made);
    }
    return result(error);
}

static void destroy(pl_engine_instance *instance)
{
    free(instance);
    reach("destroy");
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    for (int i = 0; i < instance->scene->body_count; ++i) {
        for (int k = 0; k < 3 && !instance->scene->bodies[i].is_static; ++k) {
            instance->states[i].velocity[k] += dt * instance->scene->gravity[k];
            instance->states[i].position[k] += dt * instance->states[i].velocity[k];
        }
    }
    stats->contacts = 0;
    if (++instance->steps == 3) {
        reach("step");
        staged_spoil(FIELD_STATS, stats);
        staged_spoil(FIELD_BODY, &instance->states[1]);
    }
    return result(error);
}

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    memcpy(frame->bodies, instance->states,
           (size_t)instance->scene->body_count * sizeof frame->bodies[0]);
    if (instance->steps == 3) {
        reach("frame");
    }
    if (staged.changes_frame) {
        frame->body_count = 1 << 30;
        frame->bodies = NULL;
    }
}

static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    memcpy(settings->gravity, instance->scene->gravity, sizeof settings->gravity);
    reach("settings");
    staged_spoil(FIELD_SETTINGS, settings);
    if (staged.changes_settings) {
        settings->body_count = 1 << 30;
        settings->mass = NULL;
        settings->inertia = NULL;
    }
}

static void read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    (void)instance;
    (void)body_a;
    (void)body_b;
    reach("pair");
    staged_spoil(FIELD_PAIR, found);
}

static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    if (instance->steps == 3) {
        reach("contacts");
    }
    if (staged.contact_count == 1 && capacity >= 1) {
        contacts[0] = (pl_contact){.body_b = 1, .normal = {0, 0, 1}};
        staged_spoil(FIELD_CONTACT, &contacts[0]);
    }
    return staged.doubles_contacts ? 2 * capacity : staged.contact_count;
}

static const pl_engine_profile profiles[] = {{.name = "default", .help = "", .step_code = NULL}};
static const pl_engine_option options[] = {{.name = "iterations", .value = 1, .min = 0, .max = 9}};

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "staged",
    .version = "1",
    .description = "free fall, and a fault",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE |
                    PL_NEEDS_SPHERE,
    .contacts = PL_CONTACTS_POINTS,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = 1,
    .options = options,
    .option_count = 1,
    .profile_defaults = profile_defaults,
    .create = create,
    .destroy = destroy,
    .step = step,
    .read_frame = read_frame,
    .read_settings = read_settings,
    .read_pair = read_pair,
    .read_contacts = read_contacts,
    .extension = extension,
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    reach("ask");
    return &engine;
}
