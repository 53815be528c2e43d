/* What a command of `plumb` is, and what commands share. Data goes to standard output, messages and
 * progress to standard error. */
#ifndef PLUMB_COMMAND_H
#define PLUMB_COMMAND_H

#include "plumb/base.h"

#include <argp.h>
#include <stdio.h>

/* Exit codes: scripts rely on them. */
enum {
    PL_EXIT_OK = 0,
    PL_EXIT_USAGE = 2, /* usage or bad input */
    PL_EXIT_FAILED =
        3, /* run: the outcome is not ok; any: a run could not be made, or I/O failed */
    PL_EXIT_NOTHING = 4 /* nothing was compared */
};

/* How a command was called. */
typedef struct pl_call {
    int argc; /* of the command: argv[0] is its full name, such as "plumb compare" */
    char **argv;
    int program_argc; /* of the program */
    char **program_argv;
    const struct pl_command *commands; /* (command_count): all that there are */
    int command_count;
} pl_call;

typedef struct pl_command {
    const char *name;
    const char *summary;
    int (*run)(const pl_call *call); /* returns the exit code */
} pl_command;

/* Parses the call's options as argp does, but suggests the nearest one for an option that there is
 * not. Ends the program on bad usage (exit 2), --help and --version. */
void pl_call_parse(const pl_call *call, const struct argp *argp, void *input);

/* A number with min <= value <= max, also as a ratio (pl_parse_number). Anything else is an
 * argp_error, in which `what` names the option and what it takes. */
double pl_option_number(struct argp_state *state, const char *what, const char *text, double min,
                        double max);

/* The same for a whole number. */
long pl_option_integer(struct argp_state *state, const char *what, const char *text, long min,
                       long max);

/* Says what went wrong, and returns the exit code of it. */
int pl_call_fail(const pl_call *call, const pl_error *error);

#endif
