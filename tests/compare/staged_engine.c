/* An engine of the loadable ABI that commits one fault at one stage, both named by its own file:
 * STAGE-FAULT.so is a copy of it. Its physics is free fall by semi-implicit Euler. */
#include "plumb/adapter_helpers.h"
#include "plumb/engine_abi.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

struct pl_engine_instance {
    const pl_scene *scene;
    int calls[2]; /* of step and read_frame */
    pl_body_state states[];
};

/* What functions return from now on. */
static pl_status returned_status;
static int contact_count;
static bool doubles_contacts;
static pl_step_stats wrong_stats; /* where a number is not 0, it takes the place of the right one */
static pl_contact contact = {.body_b = 1, .normal = {0, 0, 1}};

/* ---- Faults ---- */

static void fail_exit0(void)
{
    exit(0);
}

static void fail_exit7(void)
{
    exit(7);
}

static void fail_abort(void)
{
    fprintf(stderr, "\033[31mit cannot go on\n");
    abort();
}

static void fail_crash(void)
{
    raise(SIGSEGV);
}

static void fail_hang(void)
{
    for (;;) {
        pause();
    }
}

static void fail_print(void)
{
    printf("from the engine\n");
    fprintf(stderr, "and on its standard error\n");
}

static void fail_flood(void)
{
    for (int i = 0; i < 1 << 16; ++i) {
        printf("%031d\n", i);
    }
    fflush(stdout);
}

static void fail_escape(void)
{
    const char text[] = "\033[31mred\0\a\177 \302\23331m\377\n";
    fwrite(text, 1, sizeof text, stdout);
    fflush(stdout);
}

static void fail_chdir(void)
{
    (void)!chdir("/");
}

static void fail_standard(void)
{
    for (int i = 0; i < 3; ++i) {
        close(i);
    }
}

static void fail_close(void)
{
    for (int i = 3; i < 256; ++i) {
        close(i);
    }
}

static void fail_write(void)
{
    for (int i = 3; i < 256; ++i) {
        (void)!write(i, "{\"outcome\":\"ok\"}\n\033[31m", 22);
    }
}

static void fail_forge(void)
{
    static const char text[] = "{\"outcome\":\"ok\",\"metrics\":{}}";
    (void)!write(3, text, sizeof text - 1);
    _exit(0);
}

/* Says which descriptors are open but the standard ones. */
static void fail_list(void)
{
    for (int i = 0; i < 1024; ++i) {
        char link[64];
        char target[256];
        snprintf(link, sizeof link, "/proc/self/fd/%d", i);
        const ssize_t length = readlink(link, target, sizeof target);
        if (length > 0) {
            printf("%d:%.*s ", i, (int)length, target);
        }
    }
    printf("\n");
}

static void fail_limits(void)
{
    static const __rlimit_resource_t limits[] = {RLIMIT_NOFILE, RLIMIT_FSIZE, RLIMIT_DATA,
                                                 RLIMIT_STACK};
    const struct rlimit none = {0, 0};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; ++i) {
        setrlimit(limits[i], &none);
    }
}

static void fail_rounding(void)
{
    fesetround(FE_UPWARD);
#ifdef __SSE__
    _mm_setcsr(_mm_getcsr() | 0x8040u); /* subnormal numbers are 0 */
#endif
}

static void fail_traps(void)
{
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW);
}

static void ignore(int number)
{
    (void)number;
}

static void fail_signals(void)
{
    sigset_t all;
    for (int i = 1; i < 32; ++i) {
        signal(i, i == SIGTERM ? SIG_IGN : ignore);
    }
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, NULL);
}

static void fail_environment(void)
{
    setenv("TMPDIR", "/nowhere", 1);
    setenv("PLUMB_PROFILES", "/nowhere", 1);
    umask(0777);
}

/* Numbers are then written with a comma, where the machine has one of these. */
static void fail_locale(void)
{
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE.utf8"};
    for (size_t i = 0; i < sizeof names / sizeof *names && setlocale(LC_ALL, names[i]) == NULL;
         ++i) {}
}

static void fail_fork(void)
{
    if (fork() == 0) {
        sleep(30);
        _exit(0);
    }
}

static void fail_memory(void)
{
    const size_t block = (size_t)64 << 20;
    void *memory = NULL;
    for (int i = 0; i < 512 && (memory = malloc(block)) != NULL; ++i) {
        *(volatile char *)memory = 1;
    }
    fprintf(stderr, "no more memory\n");
    abort();
}

static void fail_silent(void)
{
    returned_status = PL_FAILED;
}

static void fail_many(void)
{
    contact_count = 2000000000;
}

static void fail_negative(void)
{
    contact_count = -3;
}

static void fail_double(void)
{
    doubles_contacts = true;
}

static void fail_iterations(void)
{
    wrong_stats.iterations = -3;
}

static void fail_residual(void)
{
    wrong_stats.residual = (double)INFINITY;
}

static void fail_contacts(void)
{
    wrong_stats.contacts = -1;
}

static void fail_time(void)
{
    wrong_stats.time_solve = -0.5;
}

static void fail_self(void)
{
    contact.body_a = 1;
    contact_count = 1;
}

static void fail_index(void)
{
    contact.body_b = 99;
    contact_count = 1;
}

static void fail_normal(void)
{
    contact.normal[2] = 3;
    contact_count = 1;
}

static void fail_point(void)
{
    contact.point[0] = (double)NAN;
    contact_count = 1;
}

/* Puts replacement.so in the place of its own file. */
static void fail_replace(void)
{
    Dl_info info;
    if (dladdr(&contact_count, &info) != 0) {
        rename("replacement.so", info.dli_fname);
    }
}

static void fail_none(void)
{
}

static const struct {
    const char *name;
    void (*commit)(void);
} faults[] = {
    {"none", fail_none},
    {"exit0", fail_exit0},
    {"exit7", fail_exit7},
    {"abort", fail_abort},
    {"crash", fail_crash},
    {"hang", fail_hang},
    {"print", fail_print},
    {"flood", fail_flood},
    {"escape", fail_escape},
    {"chdir", fail_chdir},
    {"standard", fail_standard},
    {"close", fail_close},
    {"write", fail_write},
    {"forge", fail_forge},
    {"list", fail_list},
    {"limits", fail_limits},
    {"rounding", fail_rounding},
    {"traps", fail_traps},
    {"signals", fail_signals},
    {"fork", fail_fork},
    {"environment", fail_environment},
    {"locale", fail_locale},
    {"memory", fail_memory},
    {"silent", fail_silent},
    {"many", fail_many},
    {"double", fail_double},
    {"negative", fail_negative},
    {"replace", fail_replace},
    {"iterations", fail_iterations},
    {"residual", fail_residual},
    {"contacts", fail_contacts},
    {"time", fail_time},
    {"self", fail_self},
    {"index", fail_index},
    {"normal", fail_normal},
    {"point", fail_point},
};

/* Commits the fault of this file when `stage` is its stage. */
static void reach(const char *stage)
{
    Dl_info info;
    if (dladdr(faults, &info) == 0) {
        return;
    }
    const char *slash = strrchr(info.dli_fname, '/');
    const char *name = slash == NULL ? info.dli_fname : slash + 1;
    const size_t length = strlen(stage);
    if (strncmp(name, stage, length) != 0 || name[length] != '-') {
        return;
    }
    for (size_t i = 0; i < sizeof faults / sizeof *faults; ++i) {
        const size_t size = strlen(faults[i].name);
        if (strncmp(name + length + 1, faults[i].name, size) == 0 &&
            name[length + 1 + size] == '.') {
            faults[i].commit();
        }
    }
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
    return returned_status;
}

static void destroy(pl_engine_instance *instance)
{
    free(instance);
    reach("destroy");
}

static pl_status step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    (void)error;
    for (int i = 0; i < instance->scene->body_count; ++i) {
        for (int k = 0; k < 3 && !instance->scene->bodies[i].is_static; ++k) {
            instance->states[i].velocity[k] += dt * instance->scene->gravity[k];
            instance->states[i].position[k] += dt * instance->states[i].velocity[k];
        }
    }
    stats->contacts = 0;
    if (++instance->calls[0] == 3) {
        reach("step");
        const double wrong[] = {wrong_stats.iterations, wrong_stats.residual, wrong_stats.contacts,
                                wrong_stats.time_solve};
        double *const right[] = {&stats->iterations, &stats->residual, &stats->contacts,
                                 &stats->time_solve};
        for (int i = 0; i < 4; ++i) {
            *right[i] = wrong[i] != 0 ? wrong[i] : *right[i];
        }
    }
    return returned_status;
}

static void read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    memcpy(frame->bodies, instance->states,
           (size_t)instance->scene->body_count * sizeof frame->bodies[0]);
    if (instance->calls[0] == 3) {
        reach("frame");
    }
}

static void read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    memcpy(settings->gravity, instance->scene->gravity, sizeof settings->gravity);
    reach("settings");
}

static void read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    (void)instance;
    (void)body_a;
    (void)body_b;
    (void)found;
    reach("pair");
}

static int read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    if (instance->calls[0] == 3) {
        reach("contacts");
    }
    if (contact_count == 1 && capacity >= 1) {
        contacts[0] = contact;
    }
    return doubles_contacts ? 2 * capacity : contact_count;
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
