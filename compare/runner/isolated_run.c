#include "isolated_run.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>

/* In the child: the result as JSON is the answer. */
static pl_status answer_result(const pl_run_result *result, void *user, pl_error *error)
{
    FILE *answer = user;
    json_t *object = pl_run_result_to_json(result);
    char *line = object == NULL ? NULL : pl_result_to_line(object);
    json_decref(object);
    if (line == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the result");
    }
    fputs(line, answer);
    free(line);
    return PL_OK;
}

/* In the child: what kept the run from being made is the answer {"error": message}. */
static void run_and_answer(void *user, FILE *answer)
{
    const pl_run_def *def = user;
    pl_error error = {.message = ""};
    if (pl_run_once(def, answer_result, answer, &error) != PL_OK) {
        json_t *object =
            json_pack("{s:o}", "error", pl_json_text(error.message, strlen(error.message)));
        json_dumpf(object, answer, JSON_COMPACT);
        json_decref(object);
    }
}

pl_status pl_isolated_run_start(pl_isolated_run *run, const pl_run_def *def, json_t *identity,
                                const pl_limits *limits, pl_error *error)
{
    *run = (pl_isolated_run){.limits = *limits, .def = *def};
    void *shared =
        mmap(NULL, sizeof *def->watch, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) {
        return pl_fail(error, PL_IO, "cannot map memory for a run: %s", strerror(errno));
    }
    run->def.watch = shared;
    pl_timestamp(run->started);
    pl_status status = pl_process_start(&run->process, limits, run_and_answer, &run->def, error);
    if (status != PL_OK) {
        munmap(run->def.watch, sizeof *run->def.watch);
        return status;
    }
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
    long done = atomic_load(&run->def.watch->steps_done);
    long asked = pl_scene_steps(run->def.scene);
    switch ((pl_stage)atomic_load(&run->def.watch->stage)) {
    case PL_STAGE_PREPARE:
        snprintf(text, size, "before the engine was called");
        break;
    case PL_STAGE_CREATE:
        snprintf(text, size, "in create");
        break;
    case PL_STAGE_CHECK:
        snprintf(text, size, "while its settings were read back");
        break;
    case PL_STAGE_CAPTURE:
        snprintf(text, size, "while the contact problems of step %ld were captured", done + 1);
        break;
    case PL_STAGE_STEP:
        snprintf(text, size, "in step %ld of %ld", done + 1, asked);
        break;
    case PL_STAGE_JUDGE:
        snprintf(text, size, "while its state was read and judged, %ld of %ld steps done", done,
                 asked);
        break;
    case PL_STAGE_DESTROY:
        snprintf(text, size, "in destroy, %ld of %ld steps done", done, asked);
        break;
    }
}

/* The last line with something in it, of at most 200 bytes. */
static void copy_last_line(const pl_process *process, char text[201])
{
    size_t end = process->tail_length;
    while (end > 0 && strchr(" \t\r\n", process->tail[end - 1]) != NULL) {
        --end;
    }
    size_t begin = end;
    while (begin > 0 && end - begin < 200 && process->tail[begin - 1] != '\n') {
        --begin;
    }
    memcpy(text, process->tail + begin, end - begin);
    text[end - begin] = '\0';
}

static void describe_crash(const pl_isolated_run *run, char *text, size_t size)
{
    int status = run->process.wait_status;
    char how[64];
    char where[96];
    char line[201];
    describe_place(run, where, sizeof where);
    copy_last_line(&run->process, line);
    if (WIFSIGNALED(status)) {
        const char *name = sigabbrev_np(WTERMSIG(status));
        snprintf(how, sizeof how, "SIG%s%s", name == NULL ? "?" : name,
                 WTERMSIG(status) == SIGKILL ? " (out of memory?)" : "");
    } else {
        snprintf(how, sizeof how, "it called exit(%d)", WEXITSTATUS(status));
    }
    snprintf(text, size, "%s %s%s%s", how, where, line[0] == '\0' ? "" : "; last line: ", line);
}

/* The outcome of a run whose process did not answer. */
static json_t *missing_outcome(const pl_isolated_run *run)
{
    pl_run_result outcome = {.outcome = PL_OUTCOME_CRASHED,
                             .steps_asked = pl_scene_steps(run->def.scene),
                             .steps_done = atomic_load(&run->def.watch->steps_done)};
    if (run->process.timed_out) {
        char where[96];
        describe_place(run, where, sizeof where);
        outcome.outcome = PL_OUTCOME_TIMEOUT;
        snprintf(outcome.reason, sizeof outcome.reason, "no end within %g s: killed %s",
                 run->limits.timeout, where);
    } else {
        describe_crash(run, outcome.reason, sizeof outcome.reason);
    }
    return pl_run_result_to_json(&outcome);
}

pl_status pl_isolated_run_finish(pl_isolated_run *run, json_t *provenance, json_t **result,
                                 pl_error *error)
{
    const pl_process *process = &run->process;
    pl_status status = PL_OK;
    /* A whole answer is a whole run; one cut short does not parse. */
    json_t *outcome = json_loadb(process->text, process->text_length, 0, NULL);
    if (outcome == NULL) {
        outcome = missing_outcome(run);
    }
    const char *failed = json_string_value(json_object_get(outcome, "error"));
    if (failed != NULL) {
        status = pl_fail(error, PL_IO, "%s on %s: the run could not be made: %s",
                         json_string_value(json_object_get(run->identity, "label")),
                         json_string_value(json_object_get(run->identity, "scenario")), failed);
        goto cleanup;
    }
    *result = pl_result_compose(run->identity, outcome, provenance, process->tail,
                                process->tail_length, run->started);
    if (*result == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for a result");
    }

cleanup:
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
