/* The commands of `plumb`, one file each: command_<name>.c. */
#ifndef PLUMB_COMMANDS_H
#define PLUMB_COMMANDS_H

#include "command.h"

int pl_command_compare(const pl_call *call);
int pl_command_run(const pl_call *call);
int pl_command_threshold(const pl_call *call);
int pl_command_list(const pl_call *call);
int pl_command_scene(const pl_call *call);
int pl_command_solve(const pl_call *call);
int pl_command_metamorphic(const pl_call *call);
int pl_command_ensemble(const pl_call *call);
int pl_command_gate(const pl_call *call);
int pl_command_sweep(const pl_call *call);
int pl_command_tune(const pl_call *call);
int pl_command_report(const pl_call *call);
int pl_command_help(const pl_call *call);
int pl_command_version(const pl_call *call);

/* The program: finds the command, runs it, and returns the exit code. */
int pl_program(int argc, char **argv);

#endif
