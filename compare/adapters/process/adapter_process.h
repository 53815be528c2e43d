/* An engine that is a program: the table of the engine ABI, whose functions ask it by the protocol
 * plumb.engine/1 (PROTOCOL.md).
 *
 * A process has at most one such engine at a time, as the functions of a table that take no instance
 * require. The harness runs an engine in a process of its own anyway. */
#ifndef PLUMB_ADAPTER_PROCESS_H
#define PLUMB_ADAPTER_PROCESS_H

#include "plumb/engine_abi.h"

#include <sys/types.h>

/* Runs `/bin/sh -c "exec COMMAND"`, asks the engine what it is, and fills the table, which is valid
 * until pl_process_engine_close. PL_FAILED: the program ended or did not answer by the protocol.
 * PL_BAD_INPUT: it was not found, or a member of its answer is not right. PL_IO, PL_NO_MEMORY. */
pl_status pl_process_engine_open(const char *command, pl_engine *table, pl_error *error);

/* Ends the program. Nothing happens where there is none. */
void pl_process_engine_close(void);

/* Its process; 0: there is none. */
pid_t pl_process_engine_pid(void);

/* CPU times of the program, s, since its start. */
typedef struct pl_process_engine_time {
    double all;   /* as the operating system had counted at its last answer, all threads */
    double steps; /* the sum of what it reported of its steps */
} pl_process_engine_time;

/* The times so far. */
pl_process_engine_time pl_process_engine_times(void);

/* Asks for the state of a scene `count` times, without a step. The channel's fault, if it has one. */
pl_status pl_process_engine_ask_state(pl_engine_instance *instance, int count, pl_error *error);

/* The path of file number `index` of those that the engine consists of: the program, files that its
 * command names, and those that it names itself; NULL: there are no more. Valid until the next
 * call. */
const char *pl_process_engine_file(int index);

#endif
