/* Time and instructions are those of the engine's step alone (resource_usage.h). Memory is the
 * growth of the resident peak from just before `create`, when everything of the harness is already
 * there, to just before `destroy`. Room for contacts comes later, and is subtracted. */
#include "run_once.h"

#include "adapters/contact_problems.h"
#include "base/arena.h"
#include "base/array.h"
#include "base/heap.h"
#include "engines/process.h"
#include "positions.h"
#include "recording.h"
#include "referee/referee.h"
#include "resource_usage.h"
#include "session.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Room for contacts; more make the array grow. */
enum { CONTACTS_PER_BODY = 16 };

/* Bodies from which on the referee's work is worth several threads. */
enum { MANY_BODIES = 2000 };

/* Two frames: the new one, and the last good one. */
typedef struct run {
    const pl_run_def *def;
    pl_session session;
    pl_referee *referee;
    pl_frame frame, good;
    bool has_good;
    pl_contact *contacts;
    pl_contact_time *times; /* of `contacts` */
    int time_capacity;
    int contact_capacity;
    int resident_contacts; /* the first of `contacts`, whose memory was touched */
    pid_t measured;        /* whose memory is the engine's; 0: this process */
    double baseline;       /* resident set without the engine's part, bytes */
    double memory;         /* the largest growth from it that was seen, bytes */
    pl_positions_writer positions;
    pl_recorder recorder;
    pl_state_hashes hashes; /* of a scene that expects the same bits again */
} run;

/* `user` is the run's watch. */
static void enter(void *user, pl_stage stage)
{
    pl_run_watch *watch = user;
    atomic_store_explicit(&watch->stage, (int)stage, memory_order_relaxed);
}

static void swap_frames(run *r)
{
    pl_frame spare = r->good;
    r->good = r->frame;
    r->frame = spare;
    r->has_good = true;
}

static void set_outcome(pl_run_result *result, pl_outcome outcome, const pl_error *error)
{
    result->outcome = outcome;
    memcpy(result->reason, error->message, sizeof result->reason);
}

/* An engine's own failure: `status` and the reason that it gave. */
static void set_failure(pl_run_result *result, pl_status status, pl_error *error)
{
    const bool refused = status == PL_UNSUPPORTED || status == PL_BAD_INPUT;
    if (error->message[0] == '\0') {
        pl_fail(error, status, "%s, and gave no reason",
                status == PL_UNSUPPORTED ? "the engine refused" : "the engine reported a failure");
    }
    set_outcome(result, refused ? PL_OUTCOME_UNSUPPORTED : PL_OUTCOME_CRASHED, error);
}

static pl_status write_header(FILE *file, pl_error *error)
{
    int written = fputs("time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n", file);
    return written >= 0 ? PL_OK : pl_fail(error, PL_IO, "trajectory: %s", strerror(errno));
}

/* Flushed a frame at a time, so that a crash leaves whole frames. */
static pl_status write_frame(FILE *file, const pl_scene *scene, const pl_frame *frame,
                             pl_error *error)
{
    for (int i = 0; i < frame->body_count; ++i) {
        const pl_body_state *s = &frame->bodies[i];
        const double *x = s->position;
        const double *q = s->orientation;
        const double *v = s->velocity;
        const double *w = s->angular_velocity;
        fprintf(file, "%.17g,\"", frame->time);
        for (const char *c = scene->bodies[i].name; *c != '\0'; ++c) {
            fputs(*c == '"' ? "\"\"" : (char[]){*c, '\0'}, file);
        }
        fprintf(file, "\",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", x[0], x[1], x[2], q[0], q[1],
                q[2], q[3]);
        fprintf(file, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", v[0], v[1], v[2], w[0], w[1], w[2]);
    }
    return fflush(file) == 0 && !ferror(file)
               ? PL_OK
               : pl_fail(error, PL_IO, "trajectory: %s", strerror(errno));
}

/* Touches memory: pages that become resident later would count as the engine's. */
static void touch(void *memory, size_t size)
{
    pl_make_resident(memory, size);
    memset(memory, 0xff, size);
}

static void *allocate_touched(size_t count, size_t size)
{
    void *memory = pl_heap_new(count, size);
    touch(memory, count * size);
    return memory;
}

/* The engine's memory so far. */
static void see_memory(run *r)
{
    r->memory = fmax(r->memory, pl_resident_set_growth(r->measured, r->baseline));
}

/* Touches room for as many contacts as the engine says it has; for all of it when it does not say. Few
 * scenes need all, and an engine that reports no contacts needs none. */
static void touch_contacts(run *r, double said)
{
    const int all = r->contact_capacity, had = r->resident_contacts;
    const int wanted = said >= 0 && said < all ? (int)said : all;
    if (r->session.loaded.table.contacts != 0 && wanted > had) {
        const int now = wanted < all / 2 ? 2 * wanted : all;
        see_memory(r);
        const double before = pl_resident_set(r->measured);
        touch(r->contacts + had, (size_t)(now - had) * sizeof *r->contacts);
        r->baseline += pl_resident_set(r->measured) - before;
        r->resident_contacts = now;
    }
}

static pl_status prepare(run *r, pl_error *error)
{
    const pl_scene *scene = r->def->scene;
    size_t count = (size_t)scene->body_count;
    r->contact_capacity = 64 + CONTACTS_PER_BODY * scene->body_count;
    r->frame = (pl_frame){.body_count = scene->body_count};
    r->good = r->frame;
    r->frame.bodies = allocate_touched(count, sizeof *r->frame.bodies);
    r->good.bodies = allocate_touched(count, sizeof *r->good.bodies);
    r->contacts = malloc((size_t)r->contact_capacity * sizeof *r->contacts);
    if (r->contacts == NULL) {
        pl_out_of_memory();
    }
    r->referee =
        pl_referee_create(scene, scene->body_count >= MANY_BODIES ? r->def->referee_threads : 1);
    pl_state_hashes_create(scene, &r->hashes);
    pl_status status = r->def->trajectory != NULL ? write_header(r->def->trajectory, error) : PL_OK;
    if (status == PL_OK && r->def->positions != NULL) {
        status = pl_positions_create(r->def->positions, scene, r->def->positions_stride,
                                     &r->positions, error);
    }
    if (status == PL_OK && r->def->recording != NULL) {
        status = pl_recorder_create(r->def->recording, scene, &r->recorder, error);
    }
    return status;
}

/* Hands the new frame to those who keep it. */
static pl_status record_frame(run *r, long step, const pl_step_stats *stats, int contact_count,
                              pl_error *error)
{
    const bool has_impulses =
        contact_count >= 0 && (r->session.loaded.table.contacts & PL_CONTACTS_IMPULSES) != 0;
    const pl_recorded_step seen = {.step = step,
                                   .frame = &r->frame,
                                   .contacts = r->contacts,
                                   .contact_count = contact_count,
                                   .has_impulses = has_impulses,
                                   .penetration = pl_referee_penetration(r->referee),
                                   .iterations = stats == NULL ? (double)NAN : stats->iterations,
                                   .residual = stats == NULL ? (double)NAN : stats->residual};
    pl_status status = PL_OK;
    if (r->def->trajectory != NULL) {
        status = write_frame(r->def->trajectory, r->def->scene, &r->frame, error);
    }
    if (status == PL_OK) {
        status = pl_positions_write(&r->positions, step, &r->frame, error);
    }
    pl_recorder_step(&r->recorder, &seen);
    pl_state_hashes_add(&r->hashes, &r->frame);
    return status;
}

static void read_frame(run *r, double time)
{
    pl_session_read_frame(&r->session, &r->frame);
    r->frame.time = time;
}

/* Loads the engine. False when that ended the run. */
static bool load(run *r, pl_run_result *result)
{
    pl_error fault = {.message = ""};
    const pl_status status = pl_session_load(&r->session, &fault);
    if (status != PL_OK) {
        set_failure(result, status, &fault);
    }
    atomic_store(&r->def->watch->program, pl_process_engine_pid());
    return status == PL_OK;
}

/* Creates the scene, and looks at the state before the first step. *going is false when that ended
 * the run. */
static pl_status begin(run *r, pl_run_result *result, bool *going, pl_error *error)
{
    const pl_run_def *def = r->def;
    pl_error fault = {.message = ""};
    *going = false;
    pl_status status = pl_session_create(&r->session, def->scene, &fault);
    if (status == PL_OK) {
        status = pl_parameter_check(&r->session, def->scene, &result->read_back, &result->substeps,
                                    &fault);
    }
    if (status != PL_OK) {
        set_failure(result, status, &fault);
        return PL_OK;
    }
    const pl_referee_engine engine = {result->substeps, def->choice->engine->precision};
    read_frame(r, 0);
    enter(def->watch, PL_STAGE_JUDGE);
    if (pl_referee_start(r->referee, &engine, &r->frame) == PL_ENDING_NONFINITE) {
        pl_fail(&fault, PL_FAILED, "not finite before the first step");
        set_outcome(result, PL_OUTCOME_NONFINITE, &fault);
        return PL_OK;
    }
    /* The first frame belongs to no step, and time_read is a step's. */
    r->session.cost[PL_CALLS_READ] = (pl_call_cost){.cpu_time = 0};
    *going = true;
    status = record_frame(r, 0, NULL, -1, error);
    swap_frames(r);
    return status;
}

/* Hands on the contact problems of the coming step where they are asked for. */
static pl_status capture(const run *r, long step, pl_error *error)
{
    const pl_capture *asked = r->def->capture;
    if (asked == NULL || asked->step != step) {
        return PL_OK;
    }
    struct pe_contact_problem **problems = NULL;
    int count = 0;
    enter(r->def->watch, PL_STAGE_CAPTURE);
    pl_status status =
        pl_contact_problems_of(&r->session.loaded.table)
            ->capture(r->session.instance, r->def->scene->dt, &problems, &count, error);
    return status == PL_OK ? asked->take(asked->user, problems, count, error) : status;
}

/* One step. *going is false when it ended the run. */
static pl_status make_step(run *r, pl_run_result *result, bool *going, pl_error *error)
{
    const pl_run_def *def = r->def;
    pl_error fault = {.message = ""};
    pl_step_stats stats;
    pl_call_cost cost;
    pl_status status = capture(r, result->steps_done + 1, error);
    if (status != PL_OK) {
        return status;
    }
    int count = -1;
    status = pl_session_step(&r->session, &stats, &cost, &fault);
    if (status == PL_OK) {
        result->steps_done += 1;
        atomic_store_explicit(&def->watch->steps_done, result->steps_done, memory_order_relaxed);
        status = pl_check_stats(&stats, result->steps_done, &fault);
    }
    if (status == PL_OK) {
        read_frame(r, (double)result->steps_done * def->scene->dt);
        touch_contacts(r, stats.contacts);
        status = pl_session_read_contacts(&r->session, &r->contacts, &r->contact_capacity, &count,
                                          &fault);
    }
    if (status == PL_OK) {
        status = pl_check_contacts(r->contacts, count, r->session.loaded.table.contacts,
                                   def->scene->body_count, result->steps_done, &fault);
    }
    const bool has_times = status == PL_OK && pl_session_read_contact_times(
                                                  &r->session, count, &r->times, &r->time_capacity);
    if (has_times) {
        status =
            pl_check_contact_times(r->times, count, def->scene->dt, result->steps_done, &fault);
    }
    if (status != PL_OK) {
        *going = false;
        set_failure(result, status, &fault);
        return PL_OK;
    }
    enter(def->watch, PL_STAGE_JUDGE);
    const bool has_impulses =
        count >= 0 && (r->session.loaded.table.contacts & PL_CONTACTS_IMPULSES) != 0;
    const pl_step seen = {.after = r->frame.bodies,
                          .stats = &stats,
                          .contacts = has_impulses ? r->contacts : NULL,
                          .contact_count = has_impulses ? count : -1,
                          .times = has_impulses && has_times ? r->times : NULL,
                          .has_points_alone = !has_impulses && count > 0,
                          .cpu_time = cost.cpu_time};
    pl_ending ending = pl_referee_step(r->referee, &seen, &fault);
    status = record_frame(r, result->steps_done, &stats, count, error);
    if (ending == PL_ENDING_NONFINITE || ending == PL_ENDING_DIVERGED) {
        *going = false;
        set_outcome(result,
                    ending == PL_ENDING_NONFINITE ? PL_OUTCOME_NONFINITE : PL_OUTCOME_DIVERGED,
                    &fault);
    }
    if (ending != PL_ENDING_NONFINITE) {
        swap_frames(r);
    }
    return status;
}

/* Whether the engine has used up its CPU time, which ends a run that has steps left. The referee's
 * time does not count. */
static bool is_over_limit(const run *r, pl_run_result *result)
{
    const double limit = r->def->cpu_limit;
    pl_error reason = {.message = ""};
    if (!pl_session_is_over_limit(&r->session, limit) ||
        result->steps_done == result->steps_asked) {
        return false;
    }
    pl_fail(
        &reason, PL_FAILED,
        "the engine's calls took more than the --cpu-limit of %g s: ended after step %ld of %ld",
        limit, result->steps_done, result->steps_asked);
    set_outcome(result, PL_OUTCOME_TIMEOUT, &reason);
    return true;
}

static void set_value(pl_run_result *result, pl_metric_id id, double value)
{
    result->metrics.item[id] = pl_metric_value(value);
}

/* The costs of the engine's calls, but for the CPU time of its steps, which is the referee's. */
static void set_costs(const pl_call_cost *cost, pl_run_result *result)
{
    const double steps = (double)result->steps_done;
    set_value(result, PL_METRIC_TIME_CREATE, cost[PL_CALLS_CREATE].cpu_time);
    set_value(result, PL_METRIC_WALL_TIME_CREATE, cost[PL_CALLS_CREATE].wall_time);
    if (steps == 0) {
        return;
    }
    set_value(result, PL_METRIC_WALL_TIME_PER_STEP, cost[PL_CALLS_STEP].wall_time / steps);
    set_value(result, PL_METRIC_TIME_READ, cost[PL_CALLS_READ].cpu_time / steps);
    set_value(result, PL_METRIC_WALL_TIME_READ, cost[PL_CALLS_READ].wall_time / steps);
    if (isfinite(cost[PL_CALLS_STEP].instructions)) {
        set_value(result, PL_METRIC_INSTRUCTIONS_PER_STEP,
                  cost[PL_CALLS_STEP].instructions / steps);
    }
}

static void judge(run *r, pl_run_result *result)
{
    pl_error fault = {.message = ""};
    pl_ending ending = pl_referee_finish(r->referee, r->def->choice->engine->residual_unit,
                                         &result->metrics, &result->note, &fault);
    if (ending == PL_ENDING_COLLAPSED && result->outcome == PL_OUTCOME_OK) {
        set_outcome(result, PL_OUTCOME_COLLAPSED, &fault);
    }
    pl_metric *peak = &result->metrics.item[PL_METRIC_MEMORY_PEAK];
    *peak = (pl_metric){.state = PL_METRIC_VALUE, .value = r->memory};
    if (!isfinite(r->memory)) {
        *peak = (pl_metric){.state = PL_METRIC_FAILED, .reason = "/proc/self does not report it"};
    }
    set_costs(r->session.cost, result);
}

/* Makes the run again where the scene expects the same bits. */
static void judge_bits(run *r, pl_run_result *result)
{
    pl_error fault = {.message = ""};
    pl_difference difference;
    if (r->hashes.step == NULL || result->outcome != PL_OUTCOME_OK) {
        return;
    }
    const pl_status status = pl_second_run(&r->session, r->def->scene, &r->hashes,
                                           r->def->cpu_limit, &r->frame, &difference, &fault);
    if (status == PL_OK) {
        pl_expectations_judge_bits(&difference, &result->metrics);
    } else {
        set_failure(result, status, &fault);
    }
}

pl_status pl_run_once(const pl_run_def *def,
                      pl_status (*report)(const pl_run_result *result, void *user, pl_error *error),
                      void *user, pl_error *error)
{
    run r = {.def = def, .session = pl_session_begin(def->choice), .memory = -HUGE_VAL};
    pl_run_result result = {.outcome = PL_OUTCOME_OK,
                            .steps_asked = pl_scene_steps(def->scene),
                            .body_count = def->scene->body_count};
    r.session.enter = enter;
    r.session.user = def->watch;
    enter(def->watch, PL_STAGE_PREPARE);
    pl_status status = prepare(&r, error);
    if (status != PL_OK) {
        goto cleanup;
    }
    pl_process_limit_memory(def->memory_limit);
    r.session.timer = pl_call_timer_open();
    bool going = load(&r, &result);
    r.measured = pl_process_engine_pid();
    r.baseline = pl_resident_set_baseline(r.measured);
    if (going) {
        status = begin(&r, &result, &going, error);
    }
    bool started = going;
    while (status == PL_OK && going && result.steps_done < result.steps_asked &&
           !is_over_limit(&r, &result)) {
        status = make_step(&r, &result, &going, error);
    }
    if (status == PL_OK && started) {
        see_memory(&r);
        judge(&r, &result);
        judge_bits(&r, &result);
    }
    pl_session_end(&r.session);
    if (status == PL_OK) {
        result.bodies = r.has_good ? r.good.bodies : NULL;
        enter(def->watch, PL_STAGE_REPORT);
        status = report(&result, user, error);
    }

cleanup:
    pl_call_timer_close(&r.session.timer);
    pl_positions_end(&r.positions);
    pl_recorder_end(&r.recorder);
    pl_referee_destroy(r.referee);
    free(r.frame.bodies);
    free(r.good.bodies);
    free(r.contacts);
    free(r.times);
    free(r.hashes.step);
    return status;
}
