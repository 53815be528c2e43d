#include "execute.h"

#include "base/heap.h"
#include "base/parallel.h"
#include "progress.h"
#include "recording.h"
#include "results/result.h"
#include "run_once.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <unistd.h>

/* ---- The schedule ---- */

static int least(int a, int b)
{
    return a < b ? a : b;
}

bool pl_schedule_has_room(const pl_schedule *s, int threads)
{
    return s->runs < s->jobs && least(threads, s->cpus) <= s->cpus - s->busy_cpus;
}

int pl_schedule_begin(pl_schedule *s, int threads)
{
    const int needed = least(threads, s->cpus);
    const int share = least(s->cpus / s->jobs, s->cpus - s->busy_cpus);
    const int taken = share > needed ? share : needed;
    s->runs += 1;
    s->busy_cpus += taken;
    return taken;
}

void pl_schedule_end(pl_schedule *s, int cpus)
{
    s->runs -= 1;
    s->busy_cpus -= cpus;
}

/* ---- Runs ---- */

/* A running job. */
typedef struct slot {
    bool busy;
    int cpus; /* of the run */
    pl_isolated_run run;
    struct pollfd *polls; /* (PL_PROCESS_POLLS), of the last poll */
    char *positions;      /* path, or NULL */
    char *recording;      /* path of the raw file, or NULL */
    const pl_scene *scene;
    pl_scene built; /* of a deferred case */
} slot;

typedef struct execution {
    const pl_execution_def *def;
    slot *slots;          /* (def->jobs) */
    struct pollfd *polls; /* one for signals, then PL_PROCESS_POLLS of each busy slot */
    long next;            /* run to start */
    bool *due;            /* (size of the plan): counted by the bar, and not begun */
    pl_schedule schedule;
    pl_progress *bar; /* NULL: none */
    int signals;      /* signalfd */
} execution;

/* Blocks the signals that end a command and are not ignored, and makes them readable. */
static int catch_signals(sigset_t *before)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    sigset_t caught;
    sigemptyset(&caught);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        struct sigaction action;
        if (sigaction(numbers[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN) {
            sigaddset(&caught, numbers[i]);
        }
    }
    sigprocmask(SIG_BLOCK, &caught, before);
    return signalfd(-1, &caught, SFD_CLOEXEC | SFD_NONBLOCK);
}

static bool is_skipped(const pl_execution_def *def, const char *run)
{
    return def->skip != NULL && def->skip(def->user, run);
}

/* The result of the run that the store has, with the positions that belong to it; NULL: the run is to be made. */
static json_t *recall(const pl_execution_def *def, const char *run)
{
    json_t *result = def->store == NULL ? NULL : pl_store_find(def->store, run);
    if (result == NULL || !def->needs_positions) {
        return result;
    }
    char *path = pl_run_file(def->positions, run, "positions");
    const bool is_whole = access(path, R_OK) == 0;
    free(path);
    return is_whole ? result : NULL;
}

long pl_execution_due(const pl_execution_def *def, bool *due)
{
    long count = 0;
    for (long i = 0; i < pl_plan_size(def->plan); ++i) {
        pl_planned_run planned = pl_plan_run(def->plan, i);
        json_t *identity = pl_planned_run_identity(def->plan, &planned);
        const char *run = pl_json_get_text(identity, "run");
        const bool is_due = !is_skipped(def, run) && recall(def, run) == NULL;
        count += is_due;
        if (due != NULL) {
            due[i] = is_due;
        }
        json_decref(identity);
    }
    return count;
}

/* Chooses the paths where the slot's run writes its positions and its recording, if it does. */
static void place_files(const execution *e, slot *s, const char *run)
{
    const char *recordings = e->def->recordings, *positions = e->def->positions;
    free(s->positions);
    free(s->recording);
    s->recording = recordings == NULL ? NULL : pl_run_file(recordings, run, "raw");
    s->positions = positions == NULL ? NULL : pl_run_file(positions, run, "positions");
}

/* The scene of a case, built in the slot where the plan does not keep it. */
static pl_status place_scene(const execution *e, slot *s, const pl_case *test_case,
                             const pl_scene **scene, pl_error *error)
{
    *scene = &test_case->scene;
    if (!test_case->deferred) {
        return PL_OK;
    }
    *scene = &s->built;
    pl_scene_free(&s->built);
    return pl_plan_build_scene(e->def->plan, test_case, &s->built, error);
}

static pl_status take(const execution *e, json_t *result, pl_error *error)
{
    return e->def->take == NULL ? PL_OK : e->def->take(e->def->user, result, error);
}

/* What the display calls a run: its scenario, and what was changed of it. The caller frees. */
static char *name_of(const json_t *run)
{
    const char *change = pl_json_get_text(run, "change");
    return pl_heap_format("%s%s%s", pl_json_get_text(run, "scenario"),
                          change[0] == '\0' ? "" : ", ", change);
}

/* Stores the result of a run that ended, and hands it on. A run that was made again for its positions alone has a
 * result there. */
static pl_status hand_on(execution *e, json_t *result, double seconds, pl_error *error)
{
    pl_store *store = e->def->store;
    pl_status status = PL_OK;
    if (e->def->amend != NULL) {
        e->def->amend(e->def->user, result);
    }
    if (store != NULL && pl_store_find(store, pl_json_get_text(result, "run")) == NULL) {
        status = pl_store_append(store, result, error);
    }
    if (status == PL_OK) {
        status = take(e, result, error);
    }
    if (status == PL_OK && e->bar != NULL) {
        char *name = name_of(result);
        pl_progress_run_ended(e->bar, name, result, seconds);
        free(name);
    }
    return status;
}

/* Hands on the result of a run that an engine's fault makes pointless. */
static pl_status report_fault(execution *e, const pl_engine_fault *fault, const pl_scene *scene,
                              json_t *identity, pl_error *error)
{
    json_t *result =
        pl_result_unmade(identity, fault->timed_out ? PL_OUTCOME_TIMEOUT : PL_OUTCOME_CRASHED,
                         pl_scene_steps(scene), fault->reason, e->def->provenance);
    const pl_status status = hand_on(e, result, 0, error);
    json_decref(result);
    return status;
}

/* Whether a run may begin beside those in progress: its pipes, and the files that are opened for a moment,
 * must not take the last descriptors. */
static bool has_descriptors(const execution *e)
{
    enum { NEEDED = 12 };
    struct rlimit limit;
    if (e->schedule.runs == 0 || getrlimit(RLIMIT_NOFILE, &limit) != 0) {
        return true;
    }
    const int lowest = fcntl(e->signals, F_DUPFD_CLOEXEC, 0);
    if (lowest >= 0) {
        close(lowest);
    }
    return lowest >= 0 && (rlim_t)lowest + NEEDED <= limit.rlim_cur;
}

/* Makes the run in the slot, or hands on what its engine's fault says. */
static pl_status start(execution *e, slot *s, const pl_planned_run *planned, json_t *identity,
                       int threads, pl_error *error)
{
    const pl_engine_choice *choice = &planned->configuration->choice;
    const pl_scene *scene = NULL;
    place_files(e, s, pl_json_get_text(identity, "run"));
    pl_status status = place_scene(e, s, planned->test_case, &scene, error);
    if (status != PL_OK) {
        return status;
    }
    if (choice->engine->fault.is_fault) {
        return report_fault(e, &choice->engine->fault, scene, identity, error);
    }
    FILE *frames = NULL;
    if (e->def->frames != NULL) {
        status = e->def->frames(e->def->user, pl_json_get_text(identity, "run"), &frames, error);
        if (status != PL_OK) {
            return status;
        }
    }
    s->cpus = pl_schedule_begin(&e->schedule, threads);
    s->scene = scene;
    const pl_run_def run = {.scene = scene,
                            .choice = choice,
                            .trajectory = frames,
                            .positions = s->positions,
                            .recording = s->recording,
                            .positions_stride = e->def->positions_stride,
                            .capture = e->def->capture,
                            .referee_threads = s->cpus};
    status = pl_isolated_run_start(&s->run, &run, identity, &e->def->limits, error);
    s->busy = status == PL_OK;
    return status;
}

/* Takes the next run of the plan: it is skipped, or its result is there, or it starts in the free slot. Runs start
 * in the order of the plan: *waits is set where there is no room for this one yet. */
static pl_status take_next(execution *e, slot *free_slot, bool *waits, pl_error *error)
{
    const pl_planned_run planned = pl_plan_run(e->def->plan, e->next);
    json_t *identity = pl_planned_run_identity(e->def->plan, &planned);
    const char *run = pl_json_get_text(identity, "run");
    const pl_engine_choice *choice = &planned.configuration->choice;
    const int threads = pl_engine_threads(choice->engine, choice->values);
    const bool skipped = is_skipped(e->def, run);
    json_t *recalled = skipped ? NULL : recall(e->def, run);
    pl_status status = PL_OK;
    if (skipped || recalled != NULL) {
        /* A result that came meanwhile made it unnecessary. */
        if (e->due[e->next] && e->bar != NULL) {
            e->bar->total -= 1;
        }
        e->next += 1;
        status = recalled != NULL ? take(e, recalled, error) : PL_OK;
    } else if (pl_schedule_has_room(&e->schedule, threads) && has_descriptors(e)) {
        e->next += 1;
        status = start(e, free_slot, &planned, identity, threads, error);
    } else {
        *waits = true;
    }
    json_decref(identity);
    return status;
}

/* Starts the next run that is due in a free slot. */
static pl_status start_next(execution *e, slot *free_slot, pl_error *error)
{
    pl_status status = PL_OK;
    bool waits = false;
    while (status == PL_OK && !waits && !free_slot->busy && e->next < pl_plan_size(e->def->plan)) {
        status = take_next(e, free_slot, &waits, error);
    }
    return status;
}

static pl_status finish(execution *e, slot *ended, pl_error *error)
{
    json_t *result = NULL;
    double seconds = pl_monotonic_seconds() - ended->run.process.started;
    pl_status status = pl_isolated_run_finish(&ended->run, e->def->provenance, &result, error);
    ended->busy = false;
    pl_schedule_end(&e->schedule, ended->cpus);
    if (status != PL_OK) {
        return status;
    }
    status = hand_on(e, result, seconds, error);
    if (status == PL_OK && ended->recording != NULL) {
        status = pl_recording_finish(e->def->recordings, pl_json_get_text(result, "run"),
                                     ended->scene, error);
    }
    json_decref(result);
    return status;
}

static void draw(const execution *e)
{
    char running[256] = "";
    double part = 0;
    if (e->bar == NULL) {
        return;
    }
    for (int i = 0; i < e->def->jobs; ++i) {
        const slot *s = &e->slots[i];
        if (s->busy) {
            size_t used = strlen(running);
            char *name = name_of(s->run.identity);
            snprintf(running + used, sizeof running - used, "%s%s %s", used == 0 ? "" : ", ", name,
                     pl_json_get_text(s->run.identity, "label"));
            free(name);
            part += pl_isolated_run_progress(&s->run);
        }
    }
    pl_progress_draw(e->bar, running, part, pl_monotonic_seconds());
}

/* Milliseconds until a deadline, until the bar is drawn again, or until runs are looked at. */
static int patience(const execution *e)
{
    double now = pl_monotonic_seconds();
    double wait = e->bar != NULL && e->bar->terminal ? 0.2 : 3600;
    if (e->def->limits.cpu_time > 0) {
        wait = fmin(wait, fmin(fmax(e->def->limits.cpu_time / 4, 0.005), 0.25));
    }
    for (int i = 0; i < e->def->jobs; ++i) {
        double left = e->slots[i].run.process.deadline - now;
        if (e->slots[i].busy && !e->slots[i].run.process.timed_out && left < wait) {
            wait = left;
        }
    }
    return wait <= 0 ? 0 : (int)(1000 * wait) + 1;
}

/* Waits for output, the end of a run, a signal or a timeout, and handles it. */
static pl_status wait_and_collect(execution *e, int *signal_number, pl_error *error)
{
    const int jobs = e->def->jobs;
    pl_status status = PL_OK;
    /* No more than are open: poll(2) takes no more than the limit on descriptors. */
    struct pollfd *signals = e->polls;
    nfds_t count = 1;
    *signals = (struct pollfd){.fd = e->signals, .events = POLLIN};
    for (int i = 0; i < jobs; ++i) {
        if (e->slots[i].busy) {
            e->slots[i].polls = &e->polls[count];
            pl_process_polls(&e->slots[i].run.process, &e->polls[count]);
            count += PL_PROCESS_POLLS;
        }
    }
    if (poll(e->polls, count, patience(e)) < 0) {
        return errno == EINTR ? PL_OK : pl_fail(error, PL_IO, "poll: %s", strerror(errno));
    }
    struct signalfd_siginfo info;
    if (signals->revents != 0 && read(e->signals, &info, sizeof info) == sizeof info) {
        *signal_number = (int)info.ssi_signo;
        return PL_OK;
    }
    for (int i = 0; i < jobs && status == PL_OK; ++i) {
        if (e->slots[i].busy) {
            pl_isolated_run_look(&e->slots[i].run);
        }
        if (e->slots[i].busy && pl_process_advance(&e->slots[i].run.process, e->slots[i].polls)) {
            status = finish(e, &e->slots[i], error);
        }
    }
    return status;
}

static pl_status carry_out(execution *e, int *signal_number, pl_error *error)
{
    pl_status status = PL_OK;
    do {
        for (int i = 0; i < e->def->jobs && status == PL_OK; ++i) {
            status = start_next(e, &e->slots[i], error);
        }
        if (status == PL_OK && e->schedule.runs > 0) {
            draw(e);
            status = wait_and_collect(e, signal_number, error);
        }
    } while (status == PL_OK && *signal_number == 0 &&
             (e->schedule.runs > 0 || e->next < pl_plan_size(e->def->plan)));
    return status;
}

pl_status pl_execute(const pl_execution_def *def, int *signal_number, pl_error *error)
{
    size_t jobs = (size_t)def->jobs;
    execution e = {.def = def,
                   .bar = def->bar,
                   .signals = -1,
                   .schedule = {.jobs = def->jobs, .cpus = pl_usable_cpus()}};
    pl_progress own;
    sigset_t before;
    *signal_number = 0;
    e.slots = pl_heap_new(jobs, sizeof *e.slots);
    e.polls = pl_heap_new(jobs * PL_PROCESS_POLLS + 1, sizeof *e.polls);
    e.due = pl_heap_new((size_t)pl_plan_size(def->plan), sizeof *e.due);
    for (size_t i = 0; i < jobs; ++i) {
        e.slots[i].built = pl_scene_default();
    }
    e.signals = catch_signals(&before);
    const long due = pl_execution_due(def, e.due);
    if (def->bar == NULL && def->progress != NULL) {
        own = pl_progress_begin(def->progress, due, pl_monotonic_seconds());
        e.bar = &own;
    }
    const pl_status status = carry_out(&e, signal_number, error);
    for (int i = 0; i < def->jobs; ++i) {
        if (e.slots[i].busy) {
            pl_isolated_run_cancel(&e.slots[i].run);
            if (e.slots[i].recording != NULL) {
                unlink(e.slots[i].recording);
            }
        }
        free(e.slots[i].positions);
        free(e.slots[i].recording);
        pl_scene_free(&e.slots[i].built);
    }
    if (def->bar == NULL && e.bar != NULL) {
        pl_progress_end(e.bar);
    }
    close(e.signals);
    sigprocmask(SIG_SETMASK, &before, NULL);
    free(e.slots);
    free(e.polls);
    free(e.due);
    return status;
}
