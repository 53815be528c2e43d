#include "run_once.h"

#include "adapters/process/channel.h"
#include "base/json_field.h"
#include "results/result.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* The numbers of a final pose: x, y, z, qw, qx, qy, qz. */
enum { POSE_NUMBERS = 7 };

/* In the child: the result as JSON is the answer. The final poses follow as doubles, since of many bodies they are
 * nearly all of it. */
static pl_status answer_result(const pl_run_result *result, void *user, pl_error *error)
{
    (void)error;
    FILE *answer = user;
    json_t *object = pl_run_result_to_json(result);
    char *line = pl_result_to_line(object);
    json_decref(object);
    fputs(line, answer);
    free(line);
    for (int i = 0; i < result->body_count && result->bodies != NULL; ++i) {
        fwrite(result->bodies[i].position, sizeof result->bodies->position, 1, answer);
        fwrite(result->bodies[i].orientation, sizeof result->bodies->orientation, 1, answer);
    }
    return PL_OK;
}

/* The final poses, `count` of them. */
static json_t *read_poses(const char *bytes, size_t count)
{
    json_t *poses = json_array();
    for (size_t i = 0; i < count; ++i) {
        json_t *row = json_array();
        for (int k = 0; k < POSE_NUMBERS; ++k, bytes += sizeof(double)) {
            double number;
            memcpy(&number, bytes, sizeof number);
            json_array_append_new(row, json_real(number));
        }
        json_array_append_new(poses, row);
    }
    return poses;
}

/* In the parent: the outcome that the child answered; NULL where it is not whole, and where something
 * else is with it. */
static json_t *read_answer(const pl_process *process)
{
    json_error_t place;
    json_t *outcome =
        json_loadb(process->text.data, process->text.length, JSON_DISABLE_EOF_CHECK, &place);
    if (outcome == NULL) {
        return NULL;
    }
    const json_t *asked = json_object_get(outcome, "final_poses");
    const size_t end = (size_t)place.position, length = process->text.length - end;
    const size_t size = POSE_NUMBERS * sizeof(double), count = length / size;
    const bool is_whole = length % size == 0 && json_integer_value(asked) == (json_int_t)count;
    if (!is_whole) {
        json_decref(outcome);
        return NULL;
    }
    if (json_is_integer(asked)) {
        json_object_set_new(outcome, "final_poses", read_poses(process->text.data + end, count));
    }
    return outcome;
}

/* In the child: what kept the run from being made is the answer {"error": message}. */
static void run_and_answer(void *user, FILE *answer)
{
    pl_run_def def = *(const pl_run_def *)user;
    pl_error error = {.message = ""};
    def.trajectory = def.trajectory == NULL ? NULL : answer;
    const pl_status status = pl_run_once(&def, answer_result, answer, &error);
    if (status == PL_OK) {
        return;
    }
    atomic_store(&def.watch->stage, PL_STAGE_REPORT);
    json_t *object = json_pack("{s:o}", "error", pl_json_text(error.message));
    json_dumpf(object, answer, JSON_COMPACT);
    json_decref(object);
}

pl_status pl_isolated_run_start(pl_isolated_run *run, const pl_run_def *def, json_t *identity,
                                const pl_limits *limits, pl_error *error)
{
    *run = (pl_isolated_run){.limits = *limits, .def = *def};
    run->def.watch = pl_shared_new(sizeof *run->def.watch);
    run->def.cpu_limit = limits->cpu_time;
    run->def.memory_limit = limits->memory;
    pl_timestamp(run->started);
    pl_status status = pl_process_start(&run->process, limits, run_and_answer, &run->def, error);
    if (status != PL_OK) {
        munmap(run->def.watch, sizeof *run->def.watch);
        return status;
    }
    run->process.stream = def->trajectory;
    run->identity = json_incref(identity);
    return PL_OK;
}

static void free_run(pl_isolated_run *run)
{
    pl_process_free(&run->process);
    munmap(run->def.watch, sizeof *run->def.watch);
    json_decref(run->identity);
}

static void describe_place(const pl_isolated_run *run, char *text, size_t size)
{
    static const char *const places[] = {[PL_STAGE_PREPARE] = "before the engine was called",
                                         [PL_STAGE_LOAD] = "while it was loaded",
                                         [PL_STAGE_CREATE] = "in create",
                                         [PL_STAGE_SETTINGS] = "while its settings were read back",
                                         [PL_STAGE_CAPTURE] = "while the contact problems of step ",
                                         [PL_STAGE_STEP] = "in step ",
                                         [PL_STAGE_READ] = "while its state was read",
                                         [PL_STAGE_JUDGE] = "while its state was judged",
                                         [PL_STAGE_DESTROY] = "in destroy",
                                         [PL_STAGE_UNLOAD] = "while it was unloaded",
                                         [PL_STAGE_REPORT] = "after it was unloaded"};
    const int stage = atomic_load(&run->def.watch->stage);
    const long done = atomic_load(&run->def.watch->steps_done);
    const long asked = pl_scene_steps(run->def.scene);
    if (stage < 0 || stage > PL_STAGE_REPORT) {
        snprintf(text, size, "at an unknown place");
    } else if (stage == PL_STAGE_CAPTURE) {
        snprintf(text, size, "%s%ld were captured", places[stage], done + 1);
    } else if (stage == PL_STAGE_STEP) {
        snprintf(text, size, "%s%ld of %ld", places[stage], done + 1, asked);
    } else if (stage > PL_STAGE_STEP) {
        snprintf(text, size, "%s, %ld of %ld steps done", places[stage], done, asked);
    } else {
        snprintf(text, size, "%s", places[stage]);
    }
}

/* Whether the run came to its end. What is in the pipe otherwise is not its answer. */
static bool was_reported(const pl_isolated_run *run)
{
    return atomic_load(&run->def.watch->stage) == PL_STAGE_REPORT;
}

void pl_isolated_run_look(pl_isolated_run *run)
{
    const int stage = atomic_load(&run->def.watch->stage);
    const long step = atomic_load(&run->def.watch->steps_done);
    if (!(run->limits.cpu_time > 0)) {
        return;
    }
    const double cpu_time = pl_cpu_time_of(atomic_load(&run->process.report->job)) +
                            pl_cpu_time_of(atomic_load(&run->def.watch->program));
    const bool is_limited =
        stage == PL_STAGE_CREATE || stage == PL_STAGE_STEP || stage == PL_STAGE_READ;
    if (!is_limited || stage != run->call || step != run->call_step) {
        run->call = stage;
        run->call_step = step;
        run->call_cpu_time = cpu_time;
    } else if (cpu_time - run->call_cpu_time > run->limits.cpu_time) {
        run->is_over_limit = true;
        pl_process_end(&run->process);
    }
}

/* The outcome of a run whose process did not answer. */
static json_t *missing_outcome(const pl_isolated_run *run)
{
    pl_run_result outcome = {.outcome = PL_OUTCOME_CRASHED,
                             .steps_asked = pl_scene_steps(run->def.scene),
                             .steps_done = atomic_load(&run->def.watch->steps_done)};
    char where[96];
    describe_place(run, where, sizeof where);
    if (run->process.timed_out) {
        outcome.outcome = PL_OUTCOME_TIMEOUT;
    }
    pl_process_describe_end(&run->process, run->limits.timeout, where, outcome.reason,
                            sizeof outcome.reason);
    if (run->is_over_limit) {
        outcome.outcome = PL_OUTCOME_TIMEOUT;
        snprintf(outcome.reason, sizeof outcome.reason,
                 "the engine's calls took more than the --cpu-limit of %g s: killed %s",
                 run->limits.cpu_time, where);
    }
    if (!run->process.timed_out && run->process.wait_status == 0 && was_reported(run)) {
        snprintf(outcome.reason, sizeof outcome.reason, "its result is damaged: %s",
                 PL_FOREIGN_DESCRIPTOR);
    }
    return pl_run_result_to_json(&outcome);
}

/* A program's own last words explain why it failed. */
static void add_last_line(const pl_isolated_run *run, json_t *outcome)
{
    char line[201], reason[800];
    pl_process_last_line(&run->process, line);
    if (run->def.choice->engine->command != NULL && line[0] != '\0' &&
        strcmp(pl_json_get_text(outcome, "outcome"), "crashed") == 0) {
        snprintf(reason, sizeof reason, "%s; last line: %s", pl_json_get_text(outcome, "reason"),
                 line);
        json_object_set_new(outcome, "reason", pl_json_text(reason));
    }
}

pl_status pl_isolated_run_finish(pl_isolated_run *run, json_t *provenance, json_t **result,
                                 pl_error *error)
{
    const pl_process *process = &run->process;
    pl_status status = PL_OK;
    /* A whole answer is a whole run; one cut short does not parse. */
    json_t *outcome = read_answer(process);
    if (!json_is_object(outcome) || !was_reported(run)) {
        json_decref(outcome);
        outcome = missing_outcome(run);
    } else {
        add_last_line(run, outcome);
    }
    const char *failed = json_string_value(json_object_get(outcome, "error"));
    if (process->stream != NULL && (fflush(process->stream) != 0 || ferror(process->stream))) {
        status = pl_fail(error, PL_IO, "trajectory: %s", strerror(errno));
    } else if (failed != NULL) {
        status = pl_fail(error, PL_IO, "%s on %s: the run could not be made: %s",
                         json_string_value(json_object_get(run->identity, "label")),
                         json_string_value(json_object_get(run->identity, "scenario")), failed);
    } else {
        *result = pl_result_compose(run->identity, outcome, provenance, process->tail,
                                    process->tail_length, run->started);
    }
    json_decref(outcome);
    free_run(run);
    return status;
}

void pl_isolated_run_cancel(pl_isolated_run *run)
{
    pl_process_kill(&run->process);
    free_run(run);
}

double pl_isolated_run_progress(const pl_isolated_run *run)
{
    long asked = pl_scene_steps(run->def.scene);
    return asked <= 0 ? 0 : (double)atomic_load(&run->def.watch->steps_done) / (double)asked;
}
