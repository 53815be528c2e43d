/* An engine of the loadable ABI that misbehaves on purpose, a profile a fault: what the harness
 * must live through. Its physics is free fall by semi-implicit Euler, without contacts. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef enum fault {
    FAULT_NONE,
    FAULT_ABORT,
    FAULT_SEGFAULT,
    FAULT_HANG,
    FAULT_STOP,
    FAULT_NAN,
    FAULT_MEMORY,
    FAULT_EXIT,
    FAULT_PRINT,
    FAULT_SLOW_PRINT,
    FAULT_MASS,
    FAULT_FRICTION,
    FAULT_REFUSE,
    FAULT_ORPHAN,
    FAULT_CREATE,
    FAULT_DESTROY,
    FAULT_WORK_IN_CREATE,
    FAULT_WORK_IN_READ,
    FAULT_WORK_IN_STEP
} fault;

static const pl_engine_profile profiles[] = {
    [FAULT_NONE] = {.name = "good", .help = "nothing is wrong"},
    [FAULT_ABORT] = {.name = "abort", .help = "says why and aborts in step 3"},
    [FAULT_SEGFAULT] = {.name = "segfault", .help = "SIGSEGV in step 3"},
    [FAULT_HANG] = {.name = "hang", .help = "never returns from step 3"},
    [FAULT_STOP] = {.name = "stop", .help = "stops its process in step 3"},
    [FAULT_NAN] = {.name = "nan", .help = "a position is NaN after step 3"},
    [FAULT_MEMORY] = {.name = "memory", .help = "takes memory until there is none, then aborts"},
    [FAULT_EXIT] = {.name = "exit", .help = "calls exit(0) in step 3"},
    [FAULT_PRINT] = {.name = "print", .help = "prints 8 MB in step 3 and goes on"},
    [FAULT_SLOW_PRINT] = {.name = "slow_print",
                          .help = "prints a line a step and takes 20 ms for it"},
    [FAULT_MASS] = {.name = "mass", .help = "simulates another mass than the scene's"},
    [FAULT_FRICTION] = {.name = "friction", .help = "uses another friction than the scene's"},
    [FAULT_REFUSE] = {.name = "refuse", .help = "says in step 3 that it cannot"},
    [FAULT_ORPHAN] = {.name = "orphan",
                      .help = "leaves a process behind that holds its output open"},
    [FAULT_CREATE] = {.name = "create", .help = "aborts in create"},
    [FAULT_DESTROY] = {.name = "destroy", .help = "aborts in destroy"},
    [FAULT_WORK_IN_CREATE] = {.name = "work_in_create",
                              .help = "takes 50 ms of CPU time in create"},
    [FAULT_WORK_IN_READ] = {.name = "work_in_read",
                            .help = "takes 2 ms of CPU time to hand out a frame"},
    [FAULT_WORK_IN_STEP] = {.name = "work_in_step", .help = "takes 2 ms of CPU time in a step"},
};

struct pl_engine_instance {
    const pl_engine_setup *setup;
    const pl_scene *scene;
    fault fault;
    long steps;
    pl_body_state states[];
};

static void work(double seconds)
{
    const clock_t end = clock() + (clock_t)(seconds * CLOCKS_PER_SEC);
    while (clock() < end) {}
}

static pl_status create(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error)
{
    const pl_scene *scene = setup->scene;
    (void)error;
    size_t count = (size_t)scene->body_count;
    pl_engine_instance *made = calloc(1, sizeof *made + count * sizeof made->states[0]);
    if (made == NULL || (fault)setup->profile == FAULT_CREATE) {
        abort();
    }
    made->setup = setup;
    made->scene = scene;
    made->fault = (fault)setup->profile;
    work(made->fault == FAULT_WORK_IN_CREATE ? 0.05 : 0);
    for (size_t i = 0; i < count; ++i) {
        pl_initial_state(&scene->bodies[i], &made->states[i]);
    }
    *instance = made;
    return PL_OK;
}

static void destroy(pl_engine_instance *instance)
{
    if (instance != NULL && instance->fault == FAULT_DESTROY) {
        abort();
    }
    free(instance);
}

static void take_all_memory(void)
{
    const size_t block = (size_t)64 << 20;
    int blocks = 0;
    for (void *memory = malloc(block); memory != NULL; memory = malloc(block)) {
        *(volatile char *)memory = 1;
        if (++blocks == 512) {
            fprintf(stderr, "32 GiB and there is no limit\n");
            abort();
        }
    }
    fprintf(stderr, "out of memory\n");
    abort();
}

static void leave_a_process(void)
{
    if (fork() == 0) {
        sleep(30);
        _exit(0);
    }
}

static pl_status misbehave(pl_engine_instance *instance, pl_error *error)
{
    pl_body_state *last = &instance->states[instance->scene->body_count - 1];
    switch (instance->fault) {
    case FAULT_ABORT:
        printf("first line\nassertion failed: depth < 1e-3\n");
        abort();
    case FAULT_SEGFAULT:
        raise(SIGSEGV);
        break;
    case FAULT_HANG:
        for (;;) {
            pause();
        }
    case FAULT_STOP:
        raise(SIGSTOP);
        break;
    case FAULT_NAN:
        last->position[1] = NAN;
        break;
    case FAULT_MEMORY:
        take_all_memory();
        break;
    case FAULT_EXIT:
        exit(0);
    case FAULT_PRINT:
        for (int i = 0; i < 1 << 18; ++i) {
            printf("%031d\n", i);
        }
        break;
    case FAULT_REFUSE:
        return pl_engine_error(error, PL_UNSUPPORTED, "this is too steep for it");
    case FAULT_ORPHAN:
        leave_a_process();
        break;
    default:
        break;
    }
    return PL_OK;
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    (void)stats;
    instance->steps += 1;
    work(instance->fault == FAULT_WORK_IN_STEP ? 0.002 : 0);
    for (int i = 0; i < instance->scene->body_count; ++i) {
        for (int k = 0; k < 3 && !instance->scene->bodies[i].is_static; ++k) {
            instance->states[i].velocity[k] += dt * instance->scene->gravity[k];
            instance->states[i].position[k] += dt * instance->states[i].velocity[k];
        }
    }
    if (instance->fault == FAULT_SLOW_PRINT) {
        printf("step %ld\n", instance->steps);
        usleep(20000);
    }
    return instance->steps == 3 ? misbehave(instance, error) : PL_OK;
}

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    work(instance->fault == FAULT_WORK_IN_READ ? 0.002 : 0);
    memcpy(frame->bodies, instance->states,
           (size_t)instance->scene->body_count * sizeof frame->bodies[0]);
}

static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    memcpy(settings->gravity, instance->scene->gravity, sizeof settings->gravity);
    settings->dt = instance->setup->dt;
    for (int i = 0; i < instance->scene->body_count; ++i) {
        const pl_body *body = &instance->scene->bodies[i];
        double wrong = instance->fault == FAULT_MASS ? 1 + 1e-9 : 1;
        settings->mass[i] = body->mass * wrong;
        /* Which axis is which is no part of the contract. */
        settings->inertia[i][0] = body->inertia[2];
        settings->inertia[i][1] = body->inertia[0];
        settings->inertia[i][2] = body->inertia[1];
    }
}

static void read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    *found = pl_setup_pair(instance->setup, body_a, body_b);
    if (instance->fault == FAULT_FRICTION) {
        found->friction += 0.25;
    }
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "faulty",
    .version = "1",
    .description = "free fall, and one fault a profile",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_PLANE |
                    PL_NEEDS_SPHERE,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = sizeof profiles / sizeof profiles[0],
    .create = create,
    .destroy = destroy,
    .step = step,
    .read_frame = read_frame,
    .read_settings = read_settings,
    .read_pair = read_pair,
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    return &engine;
}
