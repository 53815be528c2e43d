/* Answers a run's requests with any bytes, as a hostile program would: a line is an answer, and what
 * comes after the first zero byte is the file of numbers. The run ends with an outcome. Unless it is ok
 * it has a reason; if it is, all steps were made and all that was kept is finite. */
#define _GNU_SOURCE

#include "adapters/process/channel.h"
#include "fuzz.h"
#include "runner/run_once.h"

#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

static const char scene_text[] =
    "{\"plumb_scene\": 1, \"dt\": 0.01, \"duration\": 0.03,"
    " \"materials\": {\"m\": {\"friction\": 0.5, \"restitution\": 0}},"
    " \"bodies\": [{\"name\": \"ground\", \"static\": true, \"material\": \"m\","
    " \"shape\": {\"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": 0}},"
    " {\"name\": \"ball\", \"mass\": 1, \"material\": \"m\", \"position\": [0, 0, 3],"
    " \"shape\": {\"type\": \"sphere\", \"radius\": 0.5}}]}";

/* The input of the present run. */
static const char *text;
static size_t text_size, numbers_size;

/* ---- The program at the other end of a channel ---- */

/* Puts every line into the socket as a packet of its own, since there is one answer to a request. */
static void write_answers(int to)
{
    for (size_t begin = 0; begin < text_size;) {
        const char *end = memchr(text + begin, '\n', text_size - begin);
        const size_t length = end == NULL ? text_size - begin : (size_t)(end - text) + 1 - begin;
        if (send(to, text + begin, length, MSG_DONTWAIT) < 0) {
            return;
        }
        begin += length;
    }
}

pl_status pl_channel_open(pl_channel *channel, const char *command, pl_error *error)
{
    int ends[2];
    (void)command;
    (void)error;
    fuzz_check(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) == 0, "a socket");
    *channel = (pl_channel){.handle = -1, .output = ends[0]};
    channel->input = open("/dev/null", O_WRONLY | O_CLOEXEC);
    channel->numbers = memfd_create("numbers", MFD_CLOEXEC);
    fuzz_check(numbers_size == 0 || write(channel->numbers, text + text_size + 1, numbers_size) ==
                                        (ssize_t)numbers_size,
               "a file of numbers");
    channel->pid = 1; /* there is one; nothing here asks for it */
    write_answers(ends[1]);
    close(ends[1]);
    return PL_OK;
}

void pl_channel_close(pl_channel *channel)
{
    close(channel->input);
    close(channel->output);
    close(channel->numbers);
    pl_text_free(&channel->request);
    free(channel->text);
    *channel = (pl_channel){.handle = -1, .input = -1, .output = -1, .numbers = -1};
}

pl_status pl_channel_describe_end(const pl_channel *channel, char *how, size_t size)
{
    (void)channel;
    snprintf(how, size, "the input ended");
    return PL_FAILED;
}

double pl_cpu_time_of(pid_t pid)
{
    (void)pid;
    return 0;
}

/* ---- The laws ---- */

static void check_metrics(const pl_metrics *metrics)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric *m = &metrics->item[i];
        fuzz_check(m->state != PL_METRIC_VALUE || isfinite(m->value), "a metric's value is finite");
        fuzz_check(m->state != PL_METRIC_FAILED || m->reason[0] != '\0',
                   "a metric without a value has a reason");
    }
}

static pl_status check_result(const pl_run_result *result, void *user, pl_error *error)
{
    (void)user;
    (void)error;
    const bool is_ok = result->outcome == PL_OUTCOME_OK;
    fuzz_check(is_ok == (result->reason[0] == '\0'), "an outcome but ok has a reason");
    fuzz_check(memchr(result->reason, '\0', sizeof result->reason) != NULL, "a reason ends");
    fuzz_check(!is_ok || result->steps_done == result->steps_asked, "ok is all steps");
    fuzz_check(!is_ok || result->bodies != NULL, "ok has final poses");
    for (int i = 0; result->bodies != NULL && i < result->body_count; ++i) {
        const pl_body_state *body = &result->bodies[i];
        for (int k = 0; k < 4; ++k) {
            fuzz_check(isfinite(body->orientation[k]) && (k > 2 || isfinite(body->position[k])),
                       "what is kept of a body is finite");
        }
    }
    check_metrics(&result->metrics);
    json_t *json = pl_run_result_to_json(result);
    char *line = json_dumps(json, JSON_COMPACT);
    fuzz_check(line != NULL, "a result can be written");
    free(line);
    json_decref(json);
    return PL_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static pl_scene scene;
    static const double defaults[1];
    static const pl_engine_profile profiles[] = {{.name = "default", .help = ""}};
    static const pl_engine_info info = {.name = "fuzz",
                                        .capabilities = ~0u,
                                        .substeps = 1,
                                        .profiles = profiles,
                                        .profile_count = 1,
                                        .defaults = defaults,
                                        .command = "fuzz"};
    static const pl_engine_choice choice = {.engine = &info};
    pl_run_watch watch = {0};
    pl_error error = {.message = ""};
    if (scene.body_count == 0) {
        fuzz_check(pl_scene_read_text(scene_text, strlen(scene_text), "scene", &scene, &error) ==
                       PL_OK,
                   "the scene is right");
    }
    text = (const char *)data;
    text_size = strnlen(text, size);
    numbers_size = size > text_size ? size - text_size - 1 : 0;
    const pl_run_def def = {.scene = &scene, .choice = &choice, .watch = &watch};
    fuzz_check(pl_run_once(&def, check_result, NULL, &error) == PL_OK, "the run can be made");
    return 0;
}
