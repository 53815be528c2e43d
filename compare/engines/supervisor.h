/* The process between the harness and a job: it outlives the job, to end whatever the job has left.
 *
 * Every descendant of a job whose parent has ended becomes a child of the supervisor, also one in a
 * session of its own. The supervisor kills them when the job has ended, or when the harness has.
 *
 * Linux (PR_SET_CHILD_SUBREAPER, PR_SET_PDEATHSIG, /proc). Without /proc only the job's session is
 * killed. */
#ifndef PLUMB_SUPERVISOR_H
#define PLUMB_SUPERVISOR_H

#include <stdatomic.h>
#include <stdbool.h>
#include <sys/types.h>

/* What a supervisor reports to the harness, in memory that both map and the job does not. */
typedef struct pl_supervision {
    _Atomic(int) job; /* its process; 0: it has not started */
    atomic_bool has_ended;
    int wait_status; /* of the job, as waitpid gives it; set before has_ended */
} pl_supervision;

/* In a child of the harness, to be called first: makes it a supervisor, in a session of its own. It
 * ends at once where `parent`, the harness, has ended already. */
void pl_supervisor_begin(pid_t parent);

/* In the supervisor: waits until the job has ended, kills it at SIGTERM, which is also what the death of
 * the harness sends, and ends this process when no descendant is left. One that cannot be killed is
 * waited for 5 s. */
_Noreturn void pl_supervise(pid_t job, pl_supervision *report);

#endif
