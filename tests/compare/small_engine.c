/* A plug-in that tests build in several ways: bodies without contacts, in free fall by semi-implicit
 * Euler. DRIFT is added to every height at every step, so that builds can be told apart; with
 * DEPENDENCY, the function small_engine_drift of another library is added too. With READ_BACK, a
 * type, it computes in that type, and reads back its settings in it. With CONTACTS, a number, it
 * reports that many points between the first two bodies, and says so after the step unless it is
 * SILENT. With LATER_DRIFT, each world but the first of a process drifts by that too, from step 5 on. With MEETS, a
 * run waits in its working directory, at the pipe `meeting`, until another run does. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <stdlib.h>
#include <string.h>
#ifdef MEETS
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#ifndef SIZE
#define SIZE sizeof(pl_engine)
#endif
#ifndef DRIFT
#define DRIFT 0
#endif

#ifdef LATER_DRIFT
static int worlds; /* that were created: what a right engine does not look at */
#define WORLDS_ADD (++worlds)
#else
#define WORLDS_ADD ((void)0)
#define LATER_DRIFT 0
enum { worlds = 0 };
#endif

struct pl_engine_instance {
    const pl_scene *scene;
    double iterations, dt;
    int steps;
    pl_body_state states[];
};

#ifdef READ_BACK
#define NUMBER READ_BACK
#else
#define NUMBER double
#endif

#ifdef DEPENDENCY
double small_engine_drift(void);
#else
static double small_engine_drift(void)
{
    return 0;
}
#endif

#ifdef MEETS
/* The first of two reads from the pipe, and the second writes: either waits until the other opens it too. */
static void meet(void)
{
    const int is_first = mkdir("waiting", 0700) == 0;
    if (!is_first) {
        rmdir("waiting");
    }
    close(open("meeting", is_first ? O_RDONLY : O_WRONLY));
}
#else
static void meet(void)
{
}
#endif

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const size_t count = (size_t)scene->body_count;
    pl_engine_instance *made = calloc(1, sizeof *made + count * sizeof made->states[0]);
    meet();
    if (made == NULL) {
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory");
    }
    made->scene = scene;
    made->iterations = setup->values[0];
    made->dt = setup->dt;
    for (size_t i = 0; i < count; ++i) {
        pl_initial_state(&scene->bodies[i], &made->states[i]);
    }
    *instance = made;
    WORLDS_ADD;
    return PL_OK;
}

static void destroy(pl_engine_instance *instance)
{
    free(instance);
}

/* Each iteration is a part of the step, so that more of them are more exact. */
static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    const NUMBER h = (NUMBER)dt / (NUMBER)instance->iterations;
    (void)error;
    for (int part = 0; part < (int)instance->iterations; ++part) {
        for (int i = 0; i < instance->scene->body_count; ++i) {
            for (int k = 0; k < 3 && !instance->scene->bodies[i].is_static; ++k) {
                double *x = &instance->states[i].position[k], *v = &instance->states[i].velocity[k];
                *v = (NUMBER)((NUMBER)*v + h * (NUMBER)instance->scene->gravity[k]);
                *x = (NUMBER)((NUMBER)*x + h * (NUMBER)*v);
            }
        }
    }
    instance->steps += 1;
    const double later = worlds > 1 && instance->steps >= 5 ? LATER_DRIFT : 0;
    for (int i = 0; i < instance->scene->body_count; ++i) {
        instance->states[i].position[2] += DRIFT + later + small_engine_drift();
    }
    stats->iterations = instance->iterations;
#if defined(CONTACTS) && !defined(SILENT)
    stats->contacts = CONTACTS;
#endif
    return PL_OK;
}

#ifdef CONTACTS
static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    (void)instance;
    for (int i = 0; i < CONTACTS && i < capacity; ++i) {
        contacts[i] = (pl_contact){.body_a = 0, .body_b = 1, .normal = {0, 0, 1}, .separation = 1};
    }
    return CONTACTS;
}
#endif

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    memcpy(frame->bodies, instance->states,
           (size_t)instance->scene->body_count * sizeof frame->bodies[0]);
}

#ifdef READ_BACK
/* Reads back in the precision of READ_BACK, off by ULPS units in the last place of a float. */
static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    for (int i = 0; i < instance->scene->body_count; ++i) {
        const double mass = instance->scene->bodies[i].mass;
        settings->mass[i] = (double)(READ_BACK)mass * (1 + (ULPS)*0x1p-23);
    }
    settings->dt = (double)(READ_BACK)instance->dt;
    settings->substeps = (int)instance->iterations;
}
#endif

static const pl_engine_profile profiles[] = {
    {.name = "one", .help = "a profile"},
    {.name = "two", .help = "another profile"},
};

static const pl_engine_option options[] = {{.name = "iterations",
                                            .value = 1,
                                            .min = 1,
                                            .max = 64,
                                            .integer = true,
                                            .unit = "1",
                                            .help = "parts of a step",
#ifdef CODE
                                            .code = "small_set_iterations({});",
#endif
                                            .tune_profiles = 3,
                                            .tune_min = 1,
                                            .tune_max = 32,
                                            .tune_logarithmic = true}};

static const pl_engine engine = {
    .struct_size = SIZE,
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "small",
    .version = "1",
    .description = "free fall",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE |
                    PL_NEEDS_SPHERE | PL_NEEDS_BOX,
#ifdef CONTACTS
    .contacts = PL_CONTACTS_POINTS,
    .read_contacts = read_contacts,
#endif
#ifdef READ_BACK
    .read_settings = read_settings,
    .precision = sizeof(READ_BACK) == 4 ? PL_PRECISION_FLOAT : PL_PRECISION_DOUBLE,
#endif
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = 2,
    .options = options,
    .option_count = 1,
    .create = create,
    .destroy = destroy,
    .step = step,
    .read_frame = read_frame,
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    return &engine;
}
