/* A job in a process of its own, under limits. Its output and its answer are collected.
 *
 * The job leads its own session, so that no terminal reaches it. Standard output and error are one pipe, of
 * which the last PL_OUTPUT_TAIL bytes are kept. The answer goes through another. The parent never
 * blocks: it polls.
 *
 * Between the two is a supervisor, which outlives the job, to end whatever the job has left. Every descendant of a job
 * whose parent has ended becomes a child of the supervisor, also one in a session of its own. The supervisor kills them
 * when the job has ended, or when the harness has. Without /proc only the job's session is killed.
 *
 * Linux (pidfd_open, prctl: PR_SET_CHILD_SUBREAPER, PR_SET_PDEATHSIG). */
#ifndef PLUMB_PROCESS_H
#define PLUMB_PROCESS_H

#include "base/text_buffer.h"
#include "plumb/base.h"

#include <poll.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

enum { PL_OUTPUT_TAIL = 2000, PL_PROCESS_POLLS = 3 };

/* What an engine did whose answer did not arrive though it was sent. */
#define PL_FOREIGN_DESCRIPTOR "the engine closed or wrote into a descriptor that is not its own"

/* The limits of a run. */
typedef struct pl_limits {
    double timeout;  /* s of wall time, > 0 */
    double cpu_time; /* s of CPU time of an engine's own calls (run_once.h); 0: no limit */
    uint64_t memory; /* bytes that the process may take in its job; 0: no limit */
} pl_limits;

/* What a supervisor reports to the harness, in memory that both map and the job does not. */
typedef struct pl_supervision {
    _Atomic(int) job; /* its process; 0: it has not started */
    atomic_bool has_ended;
    int wait_status; /* of the job, as waitpid gives it; set before has_ended */
} pl_supervision;

/* A job's process, and its supervisor. */
typedef struct pl_process {
    pid_t supervisor;
    pl_supervision *report;     /* of the supervisor */
    int handle, output, answer; /* pidfd of the supervisor, and reading ends; -1: closed */
    double started, deadline;   /* s, of pl_monotonic_seconds */
    bool timed_out;
    int wait_status;           /* of the job, as waitpid gives it, once ended */
    char tail[PL_OUTPUT_TAIL]; /* the end of what it printed */
    size_t tail_length;
    pl_text_buffer text; /* the answer so far */
    /* Gets whole lines of the answer as they come, except for those from the first that begins with
     * '{' on, which alone are kept in `text`. NULL, as pl_process_start sets it: all are kept. */
    FILE *stream;
} pl_process;

/* Zeroed memory that processes which are forked later share with this one. The caller unmaps it. */
void *pl_shared_new(size_t size);

/* Seconds of a clock that is never set. */
double pl_monotonic_seconds(void);

/* Starts `job` in a process, which ends when the job returns. No descriptor of the caller is open in
 * it but its standard output and error and the answer. What the job writes to `answer` is the
 * answer. PL_IO when no process or pipe can be made. */
pl_status pl_process_start(pl_process *process, const pl_limits *limits,
                           void (*job)(void *user, FILE *answer), void *user, pl_error *error);

/* In the job: limits the memory that is taken from now on to so many bytes, whatever the process has
 * already; 0: no limit. A job may do so again. */
void pl_process_limit_memory(uint64_t memory);

/* Fills polls[PL_PROCESS_POLLS] with the events to wait for. */
void pl_process_polls(const pl_process *process, struct pollfd *polls);

/* Collects output and answer so far, and kills the job when its time is up. True when the job and its
 * offspring have ended and everything is collected and closed: pl_process_free is then due. */
bool pl_process_advance(pl_process *process, const struct pollfd *polls);

/* Waits until the job has ended, when pl_process_free is due. PL_IO: it could not be waited for;
 * it was killed and freed. */
pl_status pl_process_wait(pl_process *process, pl_error *error);

/* Has the job and its offspring killed. Does not wait: pl_process_advance says when they have ended. */
void pl_process_end(const pl_process *process);

/* The same, and waits for their end. */
void pl_process_kill(pl_process *process);

/* Frees what an ended process holds. */
void pl_process_free(pl_process *process);

/* ---- The supervisor (supervisor.c), and what it reads of /proc ---- */

/* The text after `key` and any of " \t:=\"" in the first line of `path` that begins with `key`, without a closing
 * quote: "VmRSS" of "VmRSS:  12 kB" is "12 kB". Empty when there is none. */
void pl_file_field(const char *path, const char *key, char *text, size_t size);

/* In a child of the harness, to be called first: makes it a supervisor, in a session of its own. It ends at once where
 * `parent`, the harness, has ended already. */
void pl_supervisor_begin(pid_t parent);

/* In the supervisor: waits until the job has ended, kills it at SIGTERM, which is also what the death of the harness
 * sends, and ends this process when no descendant is left. One that cannot be killed is waited for 5 s. */
_Noreturn void pl_supervise(pid_t job, pl_supervision *report);

/* ---- How it ended ---- */

/* The last line that a process printed, of at most 200 bytes; control characters become '?'. */
void pl_process_last_line(const pl_process *process, char text[201]);

/* How an ended process ended, for people: "SIGSEGV WHERE; last line: ...", "it called exit(1)
 * WHERE", "out of memory WHERE", or "no end within TIMEOUT s: killed WHERE". Control characters become '?'. */
void pl_process_describe_end(const pl_process *process, double timeout, const char *where,
                             char *text, size_t size);

#endif
