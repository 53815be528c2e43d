/* A job in a process of its own, under limits, with what it prints and what it answers collected.
 *
 * The child leads its own session, so that it can be killed with all its offspring and no terminal
 * reaches it; it dies with its parent. Standard output and error are one pipe, of which the last
 * PL_OUTPUT_TAIL bytes are kept. The answer goes through another. The parent never blocks: it
 * polls.
 *
 * Linux (pidfd_open, prctl). */
#ifndef PLUMB_PROCESS_H
#define PLUMB_PROCESS_H

#include "plumb/base.h"

#include <poll.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

enum { PL_OUTPUT_TAIL = 2000, PL_PROCESS_POLLS = 3 };

typedef struct pl_limits {
    double timeout;  /* s of wall time, > 0 */
    uint64_t memory; /* bytes of address space; 0: no limit */
} pl_limits;

typedef struct pl_process {
    pid_t pid;
    int handle, output, answer; /* pidfd and reading ends; -1: closed */
    double started, deadline;   /* s, of pl_monotonic_seconds */
    bool timed_out;
    int wait_status;           /* as waitpid gives it, once ended */
    char tail[PL_OUTPUT_TAIL]; /* the end of what it printed */
    size_t tail_length;
    char *text; /* the answer so far */
    size_t text_length, text_capacity;
} pl_process;

double pl_monotonic_seconds(void);

/* Starts `job` in a child. The child ends when it returns; what it wrote to `answer` is the answer.
 * `signals` is the mask that the child takes back. PL_IO when there is no process or pipe to be
 * had. */
pl_status pl_process_start(pl_process *process, const pl_limits *limits,
                           void (*job)(void *user, FILE *answer), void *user, pl_error *error);

/* What to poll for: fills polls[PL_PROCESS_POLLS]. */
void pl_process_polls(const pl_process *process, struct pollfd *polls);

/* Takes in what is there, and kills the child when its time is up. True when it has ended:
 * everything is collected and closed, and pl_process_free is due. */
bool pl_process_advance(pl_process *process, const struct pollfd *polls);

/* Waits until the child has ended, when pl_process_free is due. PL_IO: it could not be waited for;
 * it was killed and freed. */
pl_status pl_process_wait(pl_process *process, pl_error *error);

/* Kills the child with its offspring and waits for its end. */
void pl_process_kill(pl_process *process);

/* Frees what an ended process holds. */
void pl_process_free(pl_process *process);

#endif
