#include "channel.h"

#include "base/json_field.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* The longest answer. */
enum { MOST_ANSWER = 256 << 20, CHUNK = 1 << 16 };

/* ---- Bytes ---- */

/* Reads what is there. *is_over: the program has closed its output. PL_NO_MEMORY. */
static pl_status take_output(pl_channel *channel, const char *what, bool *is_over, pl_error *error)
{
    if (channel->length + CHUNK > channel->capacity) {
        const size_t capacity = 2 * (channel->length + CHUNK);
        char *grown = realloc(channel->text, capacity);
        if (grown == NULL) {
            return pl_fail(error, PL_NO_MEMORY, "out of memory for the answer to %s", what);
        }
        channel->text = grown;
        channel->capacity = capacity;
    }
    const ssize_t length = read(channel->output, channel->text + channel->length, CHUNK);
    channel->length += length > 0 ? (size_t)length : 0;
    *is_over = length == 0 || (length < 0 && errno != EAGAIN && errno != EINTR);
    return PL_OK;
}

/* Writes the request while taking what the program writes, until a whole line is there. *size is
 * then the length of the line without its end. */
static pl_status exchange(pl_channel *channel, const char *what, size_t *size, pl_error *error)
{
    const pl_text_buffer *request = &channel->request;
    size_t sent = 0;
    size_t searched = 0;
    for (;;) {
        const char *end = channel->length > searched
                              ? memchr(channel->text + searched, '\n', channel->length - searched)
                              : NULL;
        if (end != NULL) {
            *size = (size_t)(end - channel->text);
            return PL_OK;
        }
        searched = channel->length;
        if (searched > MOST_ANSWER) {
            return pl_fail(error, PL_FAILED, "answer to %s: longer than %d MiB without an end",
                           what, MOST_ANSWER >> 20);
        }
        struct pollfd polls[] = {
            {.fd = channel->output, .events = POLLIN},
            {.fd = sent < request->length ? channel->input : -1, .events = POLLOUT},
            {.fd = channel->handle, .events = POLLIN},
        };
        if (poll(polls, 3, -1) < 0 && errno != EINTR) {
            return pl_fail(error, PL_IO, "poll: %s", strerror(errno));
        }
        if (polls[1].revents != 0) {
            const ssize_t done =
                write(channel->input, request->data + sent, request->length - sent);
            /* A program that reads no more has ended, or answers before it has read all. */
            sent = done > 0 ? sent + (size_t)done : errno == EPIPE ? request->length : sent;
        }
        /* A process that it has started may keep its output open. */
        bool is_over = polls[2].revents != 0;
        pl_status status =
            polls[0].revents != 0 ? take_output(channel, what, &is_over, error) : PL_OK;
        if (status != PL_OK) {
            return status;
        }
        if (is_over) {
            char how[96];
            status = pl_channel_describe_end(channel, how, sizeof how);
            return pl_fail(error, status, "%s instead of answering %s%s", how, what,
                           channel->length > 0 ? ", in the middle of a line" : "");
        }
    }
}

/* What the program keeps in the file of numbers is memory, which no limit of the system's counts as
 * its own. */
static pl_status check_memory(const pl_channel *channel, const char *what, pl_error *error)
{
    enum { BLOCK = 512, MIB = 1 << 20 };
    struct rlimit limit;
    struct stat file;
    if (getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
        fstat(channel->numbers, &file) != 0) {
        return PL_OK;
    }
    const double used = (double)BLOCK * (double)file.st_blocks;
    return used <= (double)limit.rlim_cur
               ? PL_OK
               : pl_fail(error, PL_FAILED,
                         "answer to %s: descriptor 3 holds %.0f MiB, more than --memory allows",
                         what, used / MIB);
}

/* ---- Requests ---- */

pl_text_buffer *pl_channel_begin(pl_channel *channel, const char *name)
{
    channel->id += 1;
    channel->request.length = 0;
    pl_text_format(&channel->request, "{\"id\":%ld,\"request\":\"%s\"", channel->id, name);
    return &channel->request;
}

/* The answer's own faults: another request's answer, or the program's error. */
static pl_status check_answer(const pl_channel *channel, const char *what, const json_t *answer,
                              pl_error *error)
{
    const json_t *id = json_object_get(answer, "id");
    const json_t *reason = json_object_get(answer, "error");
    const json_t *unsupported = json_object_get(answer, "unsupported");
    char found[PL_FOUND_SIZE];
    if (!json_is_number(id) || json_number_value(id) != (double)channel->id) {
        return pl_fail(error, PL_FAILED, "answer to %s: id: expected %ld, found %s", what,
                       channel->id, pl_json_found(id, found));
    }
    if (unsupported != NULL && !json_is_null(unsupported) && !json_is_boolean(unsupported)) {
        return pl_fail(error, PL_FAILED,
                       "answer to %s: unsupported: expected true or false, found %s", what,
                       pl_json_found(unsupported, found));
    }
    const bool refused = json_is_true(unsupported);
    if ((reason == NULL || json_is_null(reason)) && !refused) {
        return PL_OK;
    }
    if (!json_is_string(reason)) {
        return pl_fail(error, PL_FAILED, "answer to %s: error: expected a text, found %s", what,
                       pl_json_found(reason, found));
    }
    json_t *plain = pl_json_bytes(json_string_value(reason), json_string_length(reason));
    const pl_status status = pl_fail(error, refused ? PL_UNSUPPORTED : PL_FAILED, "%s",
                                     plain == NULL ? "" : json_string_value(plain));
    json_decref(plain);
    return status;
}

static pl_status read_answer(const pl_channel *channel, const char *what, size_t size,
                             pl_answer_reader read, void *user, pl_error *error)
{
    json_error_t syntax;
    json_t *answer =
        json_loadb(channel->text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &syntax);
    if (answer == NULL && pl_json_lacked_memory(&syntax)) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the answer to %s", what);
    }
    if (!json_is_object(answer)) {
        char begin[PL_QUOTED_SIZE - 20], quoted[PL_QUOTED_SIZE];
        snprintf(begin, sizeof begin, "%.*s", (int)(size < sizeof begin ? size : sizeof begin - 1),
                 channel->text);
        const bool is_broken = answer == NULL && begin[0] == '{';
        json_decref(answer);
        return pl_fail(
            error, PL_FAILED, "answer to %s: expected a JSON object on a line, found %s%s%s", what,
            pl_quoted(begin, quoted), is_broken ? ": " : "", is_broken ? syntax.text : "");
    }
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_status status = check_answer(channel, what, answer, error);
    if (status == PL_OK && read != NULL && !read(answer, user, &diagnostic)) {
        char path[256];
        pl_path_text(&diagnostic.path, "the answer", path, sizeof path);
        status =
            pl_fail(error, diagnostic.status, "answer to %s: %s: %s", what, path, diagnostic.text);
    }
    json_decref(answer);
    return status;
}

pl_status pl_channel_ask(pl_channel *channel, const char *what, pl_answer_reader read, void *user,
                         pl_error *error)
{
    size_t size = 0;
    pl_error fault = channel->fault;
    if (fault.status == PL_OK) {
        pl_text_add(&channel->request, "}\n");
        if (channel->request.failed) {
            pl_fail(&fault, PL_NO_MEMORY, "out of memory for a request");
        } else if (channel->length > 0) {
            pl_fail(&fault, PL_FAILED,
                    "before %s: it wrote more than one line as the answer to a request", what);
        } else if (exchange(channel, what, &size, &fault) == PL_OK) {
            channel->cpu_time = fmax(channel->cpu_time, pl_cpu_time_of(channel->pid));
            if (check_memory(channel, what, &fault) == PL_OK) {
                read_answer(channel, what, size, read, user, &fault);
            }
            channel->length -= size + 1;
        }
    }
    /* A refusal leaves the channel in order. */
    channel->fault = fault.status == PL_UNSUPPORTED ? channel->fault : fault;
    return fault.status == PL_OK ? PL_OK : pl_fail(error, fault.status, "%s", fault.message);
}

/* ---- Numbers ---- */

static bool wrong_numbers(const json_t *found, const char *key, pl_diagnostic *diagnostic)
{
    const json_t *count = json_object_get(found, "count"),
                 *offset = json_object_get(found, "offset");
    char text[PL_FOUND_SIZE], more[PL_FOUND_SIZE];
    if (count != NULL && offset != NULL) {
        return pl_diagnose_field(diagnostic, key,
                                 "expected whole numbers as offset and count, found %s and %s",
                                 pl_json_found(offset, text), pl_json_found(count, more));
    }
    return pl_diagnose_field(diagnostic, key,
                             "expected an array of numbers, or {\"offset\", \"count\"} of the file "
                             "that is descriptor 3, found %s",
                             pl_json_found(found, text));
}

/* Whether it is a whole number of 0 to `most`. */
static bool is_whole(const json_t *number, double most)
{
    const double value = json_number_value(number);
    return json_is_number(number) && value >= 0 && value <= most && value == floor(value);
}

/* Whether the file of numbers has so many at that place. */
static bool has_numbers(const pl_channel *channel, const char *key, double begin, double count,
                        pl_diagnostic *diagnostic)
{
    struct stat file;
    const double size = fstat(channel->numbers, &file) == 0 ? (double)file.st_size : 0;
    const double found = floor(fmax(0, size - begin) / sizeof(double));
    return found >= count ||
           pl_diagnose_field(diagnostic, key,
                             "expected %.0f numbers at byte %.0f of descriptor 3, found %.0f",
                             count, begin, found);
}

bool pl_channel_count(const pl_channel *channel, const json_t *answer, const char *key, long *count,
                      pl_diagnostic *diagnostic)
{
    const json_t *numbers = json_object_get(answer, key);
    const json_t *given = json_object_get(numbers, "count");
    const json_t *offset = json_object_get(numbers, "offset");
    *count = -1;
    if (numbers == NULL) {
        return true;
    }
    if (json_is_array(numbers)) {
        *count = (long)json_array_size(numbers);
        return true;
    }
    if (!is_whole(given, MOST_ANSWER) || !is_whole(offset, 1e15)) {
        return wrong_numbers(numbers, key, diagnostic);
    }
    *count = (long)json_number_value(given);
    return has_numbers(channel, key, json_number_value(offset), (double)*count, diagnostic);
}

static bool read_file(const pl_channel *channel, const json_t *part, const char *key,
                      double *values, long count, pl_diagnostic *diagnostic)
{
    const double begin = json_number_value(json_object_get(part, "offset"));
    const size_t size = (size_t)count * sizeof *values;
    size_t done = 0;
    while (done < size) {
        const ssize_t length =
            pread(channel->numbers, (char *)values + done, size - done, (off_t)begin + (off_t)done);
        if (length <= 0) { /* it has become shorter */
            return has_numbers(channel, key, begin, (double)count, diagnostic);
        }
        done += (size_t)length;
    }
    return true;
}

bool pl_channel_numbers(const pl_channel *channel, const json_t *answer, const char *key,
                        double *values, long count, pl_diagnostic *diagnostic)
{
    const json_t *numbers = json_object_get(answer, key);
    if (json_is_object(numbers)) {
        return read_file(channel, numbers, key, values, count, diagnostic);
    }
    for (long i = 0; i < count; ++i) {
        const json_t *number = json_array_get(numbers, (size_t)i);
        values[i] = json_is_null(number) ? (double)NAN : json_number_value(number);
        if (!json_is_null(number) && !json_is_number(number)) {
            char text[PL_FOUND_SIZE];
            pl_path_push_key(&diagnostic->path, key);
            pl_path_push_index(&diagnostic->path, (int)i);
            return pl_diagnose(diagnostic, "expected a number or null, found %s",
                               pl_json_found(number, text));
        }
    }
    return true;
}
