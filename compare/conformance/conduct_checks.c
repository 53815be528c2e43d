/* The conduct of an engine as a part of a program: it repeats, and leaves nothing behind. */
#include "probe.h"

#include "base/heap.h"
#include "base/sanitizer.h"

#include <dirent.h>
#include <fenv.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#if PL_SANITIZER
/* sanitizer/allocator_interface.h, which gcc does not install. */
size_t __sanitizer_get_current_allocated_bytes(void);
#endif

/* The least growth of memory that counts as a leak, bytes a scene or a step: malloc's smallest block.
 * The memory of a program is seen from outside, in pages, with what its runtime keeps for later. */
static const double LEAST_LEAK = 16, LEAST_LEAK_OF_PROGRAM = 32768;

/* ---- Scenes ---- */

/* Bodies that fall on each other and on a floor, of what the engine claims. */
static void begin_heap(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    pl_body body = pl_check_any_body(p);
    if (pl_check_claims(p, PL_NEEDS_PLANE) || pl_check_claims(p, PL_NEEDS_BOX)) {
        pl_check_add_floor(p);
    }
    if (!pl_check_claims(p, PL_NEEDS_ROTATION) && body.shape.kind != PL_SHAPE_SPHERE) {
        pl_probe_skip(p, "the engine claims neither spheres nor rotation");
        return;
    }
    for (int i = 0; i < 4; ++i) {
        memcpy(body.position, (double[]){0.1 * i, 0.07 * i * i, 0.9 + 1.7 * i},
               sizeof body.position);
        body.velocity[2] = -3;
        body.mass = 1 + i;
        memset(body.inertia, 0, sizeof body.inertia);
        pl_probe_add_body(p, body);
    }
}

/* A scene of another size, with other values. */
static void run_other_scene(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 240);
    p->scene.gravity[1] = 3;
    pl_body body = pl_check_any_body(p);
    body.velocity[0] = 2;
    pl_probe_add_body(p, body);
    pl_probe_run(p, 20);
}

/* ---- Repetition ---- */

enum { RECORDED_STEPS = 60 };

/* The frames of a run. */
typedef struct recording {
    pl_body_state bodies[RECORDED_STEPS][PL_PROBE_MOST_BODIES];
} recording;

/* Runs the heap and records it. */
static void record(pl_probe *p, recording *frames)
{
    begin_heap(p);
    pl_probe_create(p);
    for (int i = 0; i < RECORDED_STEPS && !p->over; ++i) {
        pl_probe_steps(p, 1);
        memcpy(frames->bodies[i], p->now, sizeof p->now);
    }
}

/* Whether two pieces of memory have the same bits, also those of zeros and NANs. */
static bool same_bits(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

static void expect_same(pl_probe *p, const recording *first, const recording *second,
                        const char *expected, const char *cause)
{
    for (int i = 0; i < RECORDED_STEPS && !p->over; ++i) {
        for (int k = 0; k < p->scene.body_count && !p->over; ++k) {
            const pl_body_state *a = &first->bodies[i][k], *b = &second->bodies[i][k];
            const char *found = pl_probe_text(
                p,
                "body %d after step %d at (%.17g, %.17g, %.17g), and then at (%.17g, %.17g, "
                "%.17g)",
                k, i + 1, a->position[0], a->position[1], a->position[2], b->position[0],
                b->position[1], b->position[2]);
            pl_probe_require(p, same_bits(a, b, sizeof *a), expected, found, cause);
        }
    }
}

/* Expects the heap to be the same after `between`. Skips the check where it is not the same even
 * without that. */
static void expect_repeats(pl_probe *p, void (*between)(pl_probe *), const char *expected,
                           const char *cause)
{
    recording *frames = pl_heap_new(3, sizeof *frames);
    record(p, &frames[0]);
    record(p, &frames[1]);
    if (between != NULL) {
        if (!same_bits(&frames[0], &frames[1], sizeof *frames)) {
            pl_probe_skip(p, "the same scene does not give the same bits again: see `repeats`");
        }
        if (!p->over) {
            between(p);
        }
        record(p, &frames[2]);
    }
    expect_same(p, &frames[0], &frames[between != NULL ? 2 : 1], expected, cause);
    free(frames);
}

static void check_repeats(pl_probe *p)
{
    expect_repeats(p, NULL, "the same scene gives the same bits when it is created again",
                   "memory that is not initialised, an order by addresses, threads, the time, or "
                   "a random number whose seed is not set in create");
}

static void check_independence(pl_probe *p)
{
    expect_repeats(p, run_other_scene, "another scene before it does not change a scene",
                   "global state of the engine that create does not set, or destroy does not "
                   "reset");
}

static void load_again(pl_probe *p)
{
    pl_error error = {.message = ""};
    const pl_engine_info *info = p->choice->engine;
    pl_session_destroy(&p->session);
    pl_unload_engine(&p->session.loaded);
    if (pl_load_engine(info, &p->session.loaded, &error) != PL_OK) {
        pl_probe_fail(p, "the engine loads a second time", error.message, "");
    }
}

static void check_reload(pl_probe *p)
{
    expect_repeats(p, load_again, "a scene gives the same bits after the engine is loaded again",
                   "global state of the engine");
}

/* ---- The floating-point environment ---- */

static void raise_flags(void *user, pl_stage stage)
{
    (void)user;
    (void)stage;
    feraiseexcept(FE_ALL_EXCEPT);
}

/* Skips the check for an engine that is a program. */
static void skip_program(pl_probe *p)
{
    if (p->choice->engine->command != NULL) {
        pl_probe_skip(
            p, "the engine is another process, with a floating-point environment of its own");
    }
}

static void begin_raising_flags(pl_probe *p)
{
    p->session.enter = raise_flags;
}

/* The flags of exceptions are what earlier work left: no result may come from them. Nothing is
 * asked of other rounding modes, which the harness never sets. */
static void check_flags(pl_probe *p)
{
    skip_program(p);
    expect_repeats(p, begin_raising_flags,
                   "flags of floating-point exceptions raised before a call do not change results",
                   "the engine reads fetestexcept without feclearexcept before");
}

static void check_modes(pl_probe *p)
{
    skip_program(p);
    begin_heap(p);
    pl_probe_run(p, 20);
    pl_session_destroy(&p->session);
    const pl_mode_change *change = &p->session.mode_change;
    const char *found = pl_probe_text(
        p, "%s changed%s%s%s", pl_stage_name(change->stage),
        (change->modes & PL_MODE_ROUNDING) != 0 ? " the rounding mode" : "",
        (change->modes & PL_MODE_TRAPS) != 0 ? " which exceptions trap" : "",
        (change->modes & PL_MODE_FLUSH) != 0 ? " the flushing of subnormal numbers" : "");
    pl_probe_require(p, change->modes == 0,
                     "every call leaves the floating-point modes as it found them", found,
                     change->stage == PL_STAGE_LOAD
                         ? "the shared object was linked with -ffast-math, which changes the modes "
                           "of every program that loads it"
                         : "_MM_SET_FLUSH_ZERO_MODE, fesetround or feenableexcept without a "
                           "restore; the harness restores the modes, other programs do not");
}

/* ---- Leaks ---- */

/* Bytes that are allocated now, by the sanitizer's own allocator where there is one. */
static double heap_in_use(void)
{
#if PL_SANITIZER
    return (double)__sanitizer_get_current_allocated_bytes();
#else
    const struct mallinfo2 info = mallinfo2();
    return (double)(info.uordblks + info.hblkhd);
#endif
}

/* Bytes that a process has of its own; NAN: the system does not say. */
static double private_memory(pid_t pid)
{
    char path[64], line[128];
    double kib = (double)NAN;
    snprintf(path, sizeof path, "/proc/%d/smaps_rollup", (int)pid);
    FILE *file = fopen(path, "re");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (sscanf(line, "Private_Dirty: %lf", &kib) == 1) {
            break;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return 1024 * kib;
}

/* Entries of a folder of a process in /proc. */
static double count_entries(pid_t pid, const char *name)
{
    double count = 0;
    char folder[64];
    snprintf(folder, sizeof folder, "/proc/%d/%s", (int)pid, name);
    DIR *open = opendir(folder);
    while (open != NULL && readdir(open) != NULL) {
        ++count;
    }
    if (open != NULL) {
        closedir(open);
    }
    return count;
}

/* The resources that a leak uses up: bytes of memory, open files, threads. */
enum { HOLDING_COUNT = 3 };

/* glibc counts freed blocks in its caches as in use, and fills these over the first rounds. A runtime
 * that collects garbage grows in some rounds, but not in all. */
enum { ROUNDS = 20, CYCLES = 10, SETTLED_STEPS = 100 };

static void read_holdings(double now[HOLDING_COUNT])
{
    const pid_t program = pl_process_engine_pid();
    const pid_t pid = program > 0 ? program : getpid();
    now[0] = program > 0 ? private_memory(pid) : heap_in_use();
    now[1] = count_entries(pid, "fd");
    now[2] = count_entries(pid, "task");
}

/* Expects that no holding grows in every round after the first, which warms up, for each of `count` equal
 * pieces of work in a round. */
static void expect_no_growth(pl_probe *p, double rounds[ROUNDS][HOLDING_COUNT], int count,
                             const char *work)
{
    const bool is_program = p->choice->engine->command != NULL;
    const struct {
        const char *what;
        double least; /* growth that counts as a leak */
    } kinds[HOLDING_COUNT] = {{"bytes of memory", is_program ? LEAST_LEAK_OF_PROGRAM : LEAST_LEAK},
                              {"open files", 0.5},
                              {"threads", 0.5}};
    const bool is_seen = !isnan(rounds[0][0]);
    for (int k = is_seen ? 0 : 1; k < HOLDING_COUNT; ++k) {
        double growth = INFINITY;
        for (int i = 1; i < ROUNDS; ++i) {
            growth = fmin(growth, (rounds[i][k] - rounds[i - 1][k]) / count);
        }
        pl_probe_require(
            p, growth < kinds[k].least,
            pl_probe_text(p, "%s holds no more %s than the one before", work, kinds[k].what),
            pl_probe_text(p, "%.4g more each time", growth),
            is_program ? "a leak, or garbage that the runtime has not collected so far"
                       : "a leak: destroy frees what create and step made");
    }
    if (!is_seen) {
        pl_probe_skip(p, "the system does not say how much memory the program has");
    }
}

static void check_leaks(pl_probe *p)
{
    double rounds[ROUNDS][HOLDING_COUNT];
    for (int i = 0; i < ROUNDS; ++i) {
        for (int k = 0; k < CYCLES && !p->over; ++k) {
            begin_heap(p);
            pl_probe_run(p, 20);
            pl_session_destroy(&p->session);
        }
        read_holdings(rounds[i]);
    }
    expect_no_growth(p, rounds, CYCLES, "each scene that was created, stepped and destroyed");
}

static void check_step_leaks(pl_probe *p)
{
    double rounds[ROUNDS][HOLDING_COUNT];
    begin_heap(p);
    pl_probe_create(p);
    for (int i = 0; i < ROUNDS; ++i) {
        pl_probe_steps(p, SETTLED_STEPS);
        read_holdings(rounds[i]);
    }
    expect_no_growth(p, rounds, SETTLED_STEPS, "each step of a scene");
}

/* ---- The time of a program ---- */

/* Steps of a program are timed by itself. What it reports of some steps is compared with what the
 * operating system counted for them, less the same number of requests for the state alone. In most
 * batches a runtime may compile or collect garbage in other threads; a report that is far too low is
 * so in all of them. Single batches may also seem long because other programs had the processor: unless
 * half of them are, there is nothing to compare. */
static void check_reported_time(pl_probe *p)
{
    enum { BATCH = 50, BATCHES = 20 };
    const double clear = 1e-3; /* s: less is not told from the requests for the state */
    double best = 0;
    int clear_batches = 0;
    pl_error error = {.message = ""};
    if (p->choice->engine->command == NULL) {
        pl_probe_skip(p, "the harness itself measures engines in its own process");
        return;
    }
    begin_heap(p);
    pl_probe_create(p);
    for (int i = 0; i < BATCHES && !p->over; ++i) {
        const pl_process_engine_time before = pl_process_engine_times();
        pl_probe_steps(p, BATCH);
        const pl_process_engine_time between = pl_process_engine_times();
        if (p->over || pl_process_engine_ask_state(p->session.instance, BATCH, &error) != PL_OK) {
            break;
        }
        const double steps = between.all - before.all;
        const double states = pl_process_engine_times().all - between.all;
        if (steps - states > clear) {
            best = fmax(best, (between.steps - before.steps) / (steps - states));
            clear_batches += 1;
        }
    }
    pl_probe_require(
        p, 2 * clear_batches < BATCHES || best >= 0.5,
        "the reported CPU time is at least half of what steps take beyond requests for "
        "the state",
        pl_probe_text(p, "%.2g of it", best),
        "the CPU time around the engine's own step, in all threads and in seconds");
}

/* ---- Small duties ---- */

static void check_destroy_null(pl_probe *p)
{
    p->session.loaded.table.destroy(NULL);
}

/* The first kind of shape that the engine does not claim, in a scene that the harness would never
 * give it. */
static void check_refusal(pl_probe *p)
{
    pl_engine_instance *instance = NULL;
    pl_error error = {.message = ""};
    static const uint32_t kinds[] = {PL_NEEDS_MESH, PL_NEEDS_HULL, PL_NEEDS_CYLINDER,
                                     PL_NEEDS_CAPSULE};
    int kind = 0;
    while (kind < 4 && pl_check_claims(p, kinds[kind])) {
        ++kind;
    }
    if (kind == 4) {
        pl_probe_skip(p, "the engine claims every shape, so that no scene is sure to be refused");
        return;
    }
    pl_probe_scene(p, 1.0 / 100);
    const pl_shape shape = kind == 0   ? pl_check_standing_solid(p, PL_SHAPE_MESH)
                           : kind == 1 ? pl_check_standing_solid(p, PL_SHAPE_HULL)
                           : kind == 2 ? pl_shape_cylinder(0.5, 0.5)
                                       : pl_shape_capsule(0.5, 0.5);
    pl_probe_add_body(p, (pl_body){.shape = shape});
    const pl_engine_setup setup = {
        .struct_size = sizeof setup,
        .scene = &p->scene,
        .dt = p->scene.dt,
        .profile = p->choice->profile,
        .values = p->choice->values,
        .pairs = (pl_pair_coefficients[]){{0.5, 0}},
        .lower = {-100, -100, -100},
        .upper = {100, 100, 100},
    };
    const pl_engine *engine = &p->session.loaded.table;
    if (engine->create(&setup, &instance, &error) == PL_OK) {
        engine->destroy(instance);
        pl_probe_skip(p, "the engine also makes a shape that it does not claim");
        return;
    }
    pl_probe_require(p, instance == NULL, "create leaves *instance NULL when it fails", "a pointer",
                     "create stores the instance before it is complete, and then frees it");
    pl_probe_require(p, error.message[0] != '\0', "create says why it refuses a scene",
                     "no message", "pl_engine_error fills the caller's error");
}

static void check_statistics(pl_probe *p)
{
    begin_heap(p);
    pl_probe_create(p);
    for (int i = 0; i < 60 && !p->over; ++i) {
        pl_probe_steps(p, 1);
        const struct {
            const char *name;
            double value;
        } numbers[] = {{"iterations", p->stats.iterations},     {"residual", p->stats.residual},
                       {"contacts", p->stats.contacts},         {"islands", p->stats.islands},
                       {"time_collide", p->stats.time_collide}, {"time_solve", p->stats.time_solve},
                       {"time_other", p->stats.time_other}};
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; ++k) {
            pl_probe_require(
                p, isnan(numbers[k].value) || (numbers[k].value >= 0 && isfinite(numbers[k].value)),
                pl_probe_text(p, "pl_step_stats.%s: 0 or more, or NAN", numbers[k].name),
                pl_probe_text(p, "%.6g in step %d", numbers[k].value, i + 1),
                "a number that the engine does not have is left NAN");
        }
    }
}

const pl_check pl_conduct_checks[] = {
    {"repeats", "a scene gives the same bits again", 0, 0, check_repeats, 0},
    {"independent-scenes", "a scene does not depend on the one before", 0, 0, check_independence,
     0},
    {"reload", "a scene does not depend on when the engine was loaded", 0, 0, check_reload, 0},
    {"exception-flags", "results do not depend on raised exception flags", 0, 0, check_flags, 0},
    {"floating-point-modes", "calls leave the floating-point modes alone", 0, 0, check_modes, 0},
    {"reported-time", "the CPU time that a program reports is that of its steps", 0, 0,
     check_reported_time, 0},
    {"scene-leaks", "destroy frees what create and step made", 0, 0, check_leaks, 0},
    {"step-leaks", "steps of a settled scene take no memory", 0, 0, check_step_leaks, 0},
    {"destroy-null", "destroy takes NULL", 0, 0, check_destroy_null, 0},
    {"refusal", "a create that fails makes no instance and says why", 0, 0, check_refusal, 0},
    {"statistics", "statistics are not negative", 0, 0, check_statistics, 0},
    {0}};
