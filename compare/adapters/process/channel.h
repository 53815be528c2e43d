/* A program that answers requests by the protocol plumb.engine/1 (PROTOCOL.md): its start and end,
 * one JSON object a line each way, and the file through which it may hand over numbers.
 *
 * The first fault of a channel stays: every later request fails with it. */
#ifndef PLUMB_CHANNEL_H
#define PLUMB_CHANNEL_H

#include "base/diagnostic.h"
#include "base/text_buffer.h"
#include "plumb/engine_abi.h"

#include <jansson.h>
#include <sys/types.h>

/* A running program. Starts as pl_channel_open. */
typedef struct pl_channel {
    pid_t pid;              /* 0: none */
    int handle;             /* its pidfd */
    int input, output;      /* ends of its standard input and output; -1: closed */
    int numbers;            /* the file that is its descriptor 3 */
    long id;                /* of the last request */
    pl_text_buffer request; /* in work */
    char *text;             /* what it wrote since the last request */
    size_t length, capacity;
    double cpu_time; /* s: what the operating system had counted for it at its last answer */
    pl_error fault;  /* the first one; its status is PL_OK before */
} pl_channel;

/* Reads an answer. False with a diagnostic when it is not right. */
typedef bool (*pl_answer_reader)(const json_t *answer, void *user, pl_diagnostic *diagnostic);

/* Runs `/bin/sh -c "exec COMMAND"`, with `exec env` where the command begins with a variable. PL_IO:
 * no process or pipe can be made. */
pl_status pl_channel_open(pl_channel *channel, const char *command, pl_error *error);

/* Ends the program's standard input, waits up to a second for its end, and then kills it. Frees what
 * the channel holds. */
void pl_channel_close(pl_channel *channel);

/* How the program ended that has closed its output, as a part of a sentence. PL_BAD_INPUT: the command
 * names none; PL_FAILED otherwise. */
pl_status pl_channel_describe_end(const pl_channel *channel, char *text, size_t size);

/* The CPU time that a process has used so far, in all threads, s; 0: there is none. */
double pl_cpu_time_of(pid_t pid);

/* Begins the request of that name. Members are added to the result, each with a comma before it. */
pl_text_buffer *pl_channel_begin(pl_channel *channel, const char *name);

/* Adds the members of the request `create` (create_request.c): a scene with every number that an engine needs,
 * and the options of `engine` with the values of the setup. Out of memory: out->failed. */
void pl_create_request_add(pl_text_buffer *out, const pl_engine_setup *setup,
                           const pl_engine *engine);

/* Sends the request and waits for the answer, which `read` gets, if it is not NULL. `what` is what messages call the
 * request. PL_UNSUPPORTED: the program refuses, with its own reason. PL_BAD_INPUT: a member of the
 * answer is not right. PL_FAILED: the program reports an error, has ended, answers what is no
 * answer to this request, or holds more in the file of numbers than this process may have as memory.
 * PL_NO_MEMORY: this process has none. */
pl_status pl_channel_ask(pl_channel *channel, const char *what, pl_answer_reader read, void *user,
                         pl_error *error);

/* The number of numbers that the answer has at `key`: of an array, or of a part of the file of
 * numbers, which has as many; -1: there is no such key. */
bool pl_channel_count(const pl_channel *channel, const json_t *answer, const char *key, long *count,
                      pl_diagnostic *diagnostic);

/* Copies them to values[count], as many as pl_channel_count says. null becomes NAN. */
bool pl_channel_numbers(const pl_channel *channel, const json_t *answer, const char *key,
                        double *values, long count, pl_diagnostic *diagnostic);

#endif
