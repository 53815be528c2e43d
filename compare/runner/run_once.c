/* Time and instructions are those of the engine's step alone (resource_usage.h). Memory is the
 * growth of the resident peak from just before `create`, when everything of the harness is already
 * there, to just before `destroy`. */
#include "run_once.h"

#include "adapters/contact_problems.h"
#include "base/array.h"
#include "parameter_check.h"
#include "positions.h"
#include "referee/referee.h"
#include "resource_usage.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two frames: the new one, and the last good one. */
typedef struct run {
    const pl_run_def *def;
    pl_engine_instance *instance;
    pl_referee *referee;
    pl_frame frame, good;
    bool has_good;
    pl_contact *contacts;
    int contact_capacity;
    pl_positions_writer positions;
    pl_step_timer timer;
    double instructions; /* of all steps; NAN: not counted */
} run;

pl_step_stats pl_step_stats_unknown(void)
{
    return (pl_step_stats){.struct_size = sizeof(pl_step_stats),
                           .iterations = NAN,
                           .residual = NAN,
                           .contacts = NAN,
                           .islands = NAN,
                           .time_collide = NAN,
                           .time_solve = NAN,
                           .time_other = NAN};
}

static void enter(const run *r, pl_stage stage)
{
    atomic_store_explicit(&r->def->watch->stage, (int)stage, memory_order_relaxed);
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

/* An engine's own failure. */
static void set_failure(pl_run_result *result, const pl_error *error)
{
    bool refused = error->status == PL_UNSUPPORTED || error->status == PL_BAD_INPUT;
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

/* Touches what it allocates: pages that become resident later would count as the engine's. */
static void *allocate_touched(size_t count, size_t size)
{
    void *memory = malloc(count * size + 1);
    if (memory != NULL) {
        memset(memory, 0xff, count * size + 1);
    }
    return memory;
}

static pl_status prepare(run *r, pl_error *error)
{
    const pl_scene *scene = r->def->scene;
    size_t count = (size_t)scene->body_count;
    r->contact_capacity = 64 + 32 * scene->body_count;
    r->frame = (pl_frame){.body_count = scene->body_count};
    r->good = r->frame;
    r->frame.bodies = allocate_touched(count, sizeof *r->frame.bodies);
    r->good.bodies = allocate_touched(count, sizeof *r->good.bodies);
    r->contacts = allocate_touched((size_t)r->contact_capacity, sizeof *r->contacts);
    if (r->frame.bodies == NULL || r->good.bodies == NULL || r->contacts == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    pl_status status = pl_referee_create(scene, &r->referee, error);
    if (status == PL_OK && r->def->trajectory != NULL) {
        status = write_header(r->def->trajectory, error);
    }
    if (status == PL_OK && r->def->positions != NULL) {
        status = pl_positions_create(r->def->positions, scene, &r->positions, error);
    }
    return status;
}

/* The number of contacts of the last step in r->contacts; -1: the engine does not report them. */
static pl_status read_contacts(run *r, int *count, pl_error *error)
{
    const pl_engine *engine = r->def->engine;
    *count = -1;
    if (engine->read_contacts == NULL) {
        return PL_OK;
    }
    *count = engine->read_contacts(r->instance, r->contacts, r->contact_capacity);
    if (*count <= r->contact_capacity) {
        return PL_OK;
    }
    pl_status status = pl_array_reserve(&r->contacts, &r->contact_capacity, 2 * *count,
                                        sizeof *r->contacts, error);
    if (status != PL_OK) {
        return status;
    }
    *count = engine->read_contacts(r->instance, r->contacts, r->contact_capacity);
    return PL_OK;
}

/* Hands the new frame to those who keep it. */
static pl_status record_frame(run *r, long step, pl_error *error)
{
    pl_status status = PL_OK;
    if (r->def->trajectory != NULL) {
        status = write_frame(r->def->trajectory, r->def->scene, &r->frame, error);
    }
    if (status == PL_OK) {
        status = pl_positions_write(&r->positions, step, &r->frame, error);
    }
    return status;
}

static void read_frame(run *r, double time)
{
    r->def->engine->read_frame(r->instance, &r->frame);
    r->frame.time = time;
}

/* Creates the engine and looks at the state before the first step. *going is false when that ended
 * it. */
static pl_status begin(run *r, pl_run_result *result, bool *going, pl_error *error)
{
    const pl_run_def *def = r->def;
    pl_error fault = {.message = ""};
    *going = false;
    if (pl_needs_check(def->scene, def->engine, &fault) != PL_OK) {
        set_outcome(result, PL_OUTCOME_UNSUPPORTED, &fault);
        return PL_OK;
    }
    enter(r, PL_STAGE_CREATE);
    fault.status =
        def->engine->create(def->scene, def->profile, def->options, &r->instance, &fault);
    if (fault.status != PL_OK) {
        set_failure(result, &fault);
        return PL_OK;
    }
    enter(r, PL_STAGE_CHECK);
    pl_status status = pl_parameter_check(def->scene, def->engine, r->instance, &fault);
    if (status == PL_UNSUPPORTED) {
        set_outcome(result, PL_OUTCOME_UNSUPPORTED, &fault);
        return PL_OK;
    }
    if (status != PL_OK) {
        return pl_fail(error, status, "%s", fault.message);
    }
    read_frame(r, 0);
    if (pl_referee_start(r->referee, &r->frame) == PL_VERDICT_NONFINITE) {
        pl_fail(&fault, PL_FAILED, "not finite before the first step");
        set_outcome(result, PL_OUTCOME_NONFINITE, &fault);
        return PL_OK;
    }
    *going = true;
    status = record_frame(r, 0, error);
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
    enter(r, PL_STAGE_CAPTURE);
    pl_status status = pl_contact_problems_of(r->def->engine)
                           ->capture(r->instance, r->def->scene->dt, &problems, &count, error);
    return status == PL_OK ? asked->take(asked->user, problems, count, error) : status;
}

/* One step. *going is false when it ended the run. */
static pl_status make_step(run *r, pl_run_result *result, bool *going, pl_error *error)
{
    const pl_run_def *def = r->def;
    pl_error fault = {.message = ""};
    pl_step_stats stats = pl_step_stats_unknown();
    pl_status status = capture(r, result->steps_done + 1, error);
    if (status != PL_OK) {
        return status;
    }
    enter(r, PL_STAGE_STEP);
    pl_step_timer_begin(&r->timer);
    fault.status = def->engine->step(r->instance, def->scene->dt, &stats, &fault);
    pl_step_cost cost = pl_step_timer_end(&r->timer);
    enter(r, PL_STAGE_JUDGE);
    if (fault.status != PL_OK) {
        *going = false;
        set_failure(result, &fault);
        return PL_OK;
    }
    result->steps_done += 1;
    r->instructions += cost.instructions;
    read_frame(r, (double)result->steps_done * def->scene->dt);
    int count = -1;
    status = read_contacts(r, &count, error);
    if (status != PL_OK) {
        return status;
    }
    const pl_step_observation seen = {&r->frame, &stats, count < 0 ? NULL : r->contacts, count,
                                      cost.cpu_time};
    pl_verdict verdict = pl_referee_step(r->referee, &seen, &fault);
    status = record_frame(r, result->steps_done, error);
    if (verdict == PL_VERDICT_NONFINITE || verdict == PL_VERDICT_DIVERGED) {
        *going = false;
        set_outcome(result,
                    verdict == PL_VERDICT_NONFINITE ? PL_OUTCOME_NONFINITE : PL_OUTCOME_DIVERGED,
                    &fault);
    }
    if (verdict != PL_VERDICT_NONFINITE) {
        swap_frames(r);
    }
    atomic_store_explicit(&def->watch->steps_done, result->steps_done, memory_order_relaxed);
    return status;
}

static void judge(run *r, double memory, pl_run_result *result)
{
    pl_error fault = {.message = ""};
    pl_verdict verdict =
        pl_referee_finish(r->referee, r->def->engine->residual_unit, &result->metrics, &fault);
    if (verdict == PL_VERDICT_COLLAPSED && result->outcome == PL_OUTCOME_OK) {
        set_outcome(result, PL_OUTCOME_COLLAPSED, &fault);
    }
    pl_metric *peak = &result->metrics.item[PL_METRIC_MEMORY_PEAK];
    *peak = (pl_metric){.state = PL_METRIC_VALUE, .value = memory};
    if (!isfinite(memory)) {
        *peak = (pl_metric){.state = PL_METRIC_FAILED, .reason = "/proc/self does not report it"};
    }
    if (isfinite(r->instructions) && result->steps_done > 0) {
        result->metrics.item[PL_METRIC_INSTRUCTIONS_PER_STEP] = (pl_metric){
            .state = PL_METRIC_VALUE, .value = r->instructions / (double)result->steps_done};
    }
}

pl_status pl_run_once(const pl_run_def *def,
                      pl_status (*report)(const pl_run_result *result, void *user, pl_error *error),
                      void *user, pl_error *error)
{
    run r = {.def = def, .timer = {.counter = -1}};
    pl_run_result result = {.outcome = PL_OUTCOME_OK,
                            .steps_asked = pl_scene_steps(def->scene),
                            .body_count = def->scene->body_count};
    enter(&r, PL_STAGE_PREPARE);
    pl_status status = prepare(&r, error);
    if (status != PL_OK) {
        goto cleanup;
    }
    r.timer = pl_step_timer_open();
    double baseline = pl_resident_set_baseline();
    bool going = false;
    status = begin(&r, &result, &going, error);
    bool started = going;
    while (status == PL_OK && going && result.steps_done < result.steps_asked) {
        status = make_step(&r, &result, &going, error);
    }
    if (status == PL_OK && started) {
        judge(&r, pl_resident_set_growth(baseline), &result);
    }
    enter(&r, PL_STAGE_DESTROY);
    def->engine->destroy(r.instance);
    if (status == PL_OK) {
        result.bodies = r.has_good ? r.good.bodies : NULL;
        enter(&r, PL_STAGE_JUDGE);
        status = report(&result, user, error);
    }

cleanup:
    pl_step_timer_close(&r.timer);
    pl_positions_end(&r.positions);
    pl_referee_destroy(r.referee);
    free(r.frame.bodies);
    free(r.good.bodies);
    free(r.contacts);
    return status;
}
