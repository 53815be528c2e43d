/* Commands of `plumb`. A command is a table entry: its name, its texts and its options, from which
 * the command line is parsed and --help is written, and a function that runs it. Data goes to
 * standard output; messages and progress go to standard error. */
#ifndef PLUMB_COMMAND_H
#define PLUMB_COMMAND_H

#include "plumb/base.h"
#include "results/store.h"
#include "studies/study.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct pl_report_def; /* report/report.h */

/* Exit codes: scripts rely on them. */
enum {
    PL_EXIT_OK = 0,
    PL_EXIT_GATE = 1,   /* gate: a result is worse than allowed; check-engine: a check failed */
    PL_EXIT_USAGE = 2,  /* usage or bad input */
    PL_EXIT_FAILED = 3, /* run: the outcome is not ok; any command: a run or I/O failed */
    PL_EXIT_NOTHING = 4 /* nothing was compared */
};

/* Texts in the order given, borrowed from the command line. Owner: free(items). */
typedef struct pl_texts {
    const char **items;
    int count;
} pl_texts;

/* Appends a text. */
void pl_texts_add(pl_texts *texts, const char *item);

/* What an option does with the field of the command's options that it stands for. */
typedef enum pl_option_kind {
    PL_OPTION_FLAG,    /* sets a bool to true; takes no argument */
    PL_OPTION_TEXT,    /* sets a const char * */
    PL_OPTION_TEXTS,   /* repeatable: appends to a pl_texts */
    PL_OPTION_NUMBER,  /* sets a double, also given as a fraction */
    PL_OPTION_INTEGER, /* sets an int */
    PL_OPTION_LARGE,   /* sets a uint64_t from an integer */
    PL_OPTION_CHOICE,  /* sets an int to the place of the word among `values`, from 0 */
    PL_OPTION_PARSED,  /* calls `parse` */
    PL_OPTION_HELP     /* no option: the command's own help of a shared option of this name */
} pl_option_kind;

/* An option "--name=argument". A table of options ends with {0}. */
typedef struct pl_option {
    const char *name;
    const char *argument; /* what stands for the argument in help; NULL: it takes none */
    const char *help;
    pl_option_kind kind;
    size_t field;      /* offset of the field in the command's options */
    const char *takes; /* NUMBER: the unit in messages, such as "seconds" */
    double min, max;   /* NUMBER, INTEGER, LARGE: the range allowed */
    double scale;      /* NUMBER: the field is the number times this; 0 means 1 */
    /* PARSED: takes the text. A failure ends the program as a usage error with its message. */
    pl_status (*parse)(void *options, const char *text, pl_error *error);
    char letter; /* short form "-letter"; 0: none */
    /* What a shell completes, in the form of pl_command.arguments, such as "json|mjcf"; NULL: what
     * `argument` names. */
    const char *values;
} pl_option;

enum { PL_COMMON_OPTIONS = 3 };

/* --help, --usage and --version, which every command has. Ends with {0}. */
extern const pl_option pl_common_options[PL_COMMON_OPTIONS + 1];

enum { PL_SHARED_OPTIONS = 7 };

/* How a command was called. */
typedef struct pl_call {
    const struct pl_command *command;
    int argc; /* of the command: argv[0] is its full name, such as "plumb compare" */
    char **argv;
    int program_argc; /* of the program */
    char **program_argv;
    pl_error *error; /* room for the error that is checked next */
} pl_call;

/* A command. The struct that its options are parsed into begins with a pl_request (request.h),
 * which the shared options and the arguments go to. */
typedef struct pl_command {
    const char *name;
    const char *summary;      /* for the list of commands */
    const char *arguments;    /* for the usage line; a line each way to call it */
    const char *description;  /* for --help, before the options */
    const char *notes;        /* for --help, after the options: exit codes, examples */
    const pl_option *options; /* its own; NULL: none */
    const pl_option *shared[PL_SHARED_OPTIONS]; /* tables of request.h, up to the first NULL */
    void (*list)(FILE *out);                    /* writes more help before `notes`; NULL: nothing */
    /* Checks options that were parsed; PL_OK, or a usage error with its message. NULL: no check. */
    pl_status (*check)(void *options, pl_error *error);
    int (*run)(const pl_call *call); /* returns the exit code */
} pl_command;

enum { PL_MOST_OPTIONS = 64 };

/* Lists the options of a command, its own first and the common ones last, with their help in this command. Returns
 * their number. */
int pl_command_options(const pl_command *command, pl_option options[PL_MOST_OPTIONS]);

/* The only one of `count` options that begins with the first `length` characters of `name`, or is `name`, as getopt
 * finds it. -1: there is none; -2: several. */
int pl_option_find(const pl_option *options, int count, const char *name, size_t length);

/* Parses the command line into the command's options, which hold their defaults before. Ends the
 * program on bad usage (exit 2, with a suggestion for an unknown option), --help and --version. */
void pl_call_parse(const pl_call *call, void *options);

/* Ends the program as pl_call_end_store does, unless the status is PL_OK and no signal came. If results of
 * pl_request_open_store are open, it closes them. */
void pl_call_check_end(const pl_call *call, pl_status status, int signal_number);

/* The same where no signal is waited for. */
void pl_call_need(const pl_call *call, pl_status status);

/* Reports that there is nothing to do, and why. Returns PL_EXIT_NOTHING. */
int pl_call_nothing(const pl_call *call, const char *why);

/* Closes the store of `folder` (NULL: there is none), and returns the command's exit code: that of a failed status, whose
 * error, that of the call, is reported; 128 plus the number of the signal that ended it; or else `code`. A command that
 * did not come to its end says how to go on. */
int pl_call_end_store(const pl_call *call, pl_store *store, const char *folder, pl_status status,
                      int signal_number, int code);

/* Prints a value on standard output. */
void pl_call_print_json(const json_t *value);

/* The provenance of results of this call (pl_provenance), a new reference. */
json_t *pl_call_provenance(const pl_call *call);

/* The commands, one file each: command_<name>.c. */
#define COMMAND(name) extern const pl_command pl_command_##name;
#define STUDY(name) COMMAND(name)
#include "commands.def"

/* All commands in the order of `plumb help`, which has no description. Static storage. */
const pl_command *const *pl_commands(int *count);

/* An exit code, such as "0", and when the program ends with it. */
typedef struct pl_exit_meaning {
    const char *code, *meaning;
} pl_exit_meaning;

/* All of them. Static storage. */
const pl_exit_meaning *pl_exit_meanings(int *count);

/* Prints what can stand in the place of the last of `words`, the command line after `plumb`, for the scripts of
 * compare/completion: plumb __complete WORD..., which `plumb help` does not list. Each candidate is a line
 * "CANDIDATE\tDESCRIPTION", where CANDIDATE is the whole word. After one that ends in '=', ',' or ':' the word goes
 * on. A line ":files SUFFIX" stands for all files whose names end in SUFFIX, and for all folders; for folders alone
 * where SUFFIX is "/", and for all files where it is empty. Such a line comes only where no candidate fits. No engine
 * is started. Never fails, and returns PL_EXIT_OK. */
int pl_complete(const pl_command *const *commands, int command_count, int word_count,
                char *const *words);

/* All studies, in the order of reports. Static storage. */
const pl_study *const *pl_studies(int *count);

/* The study with conclusions plumb.KIND/1; NULL: none. */
const pl_study *pl_study_find(const char *kind);

/* ---- Parts of single commands ---- */

/* An array of the engines of this build, or of those of the SPECs after the first of `names`: a new reference. An
 * engine that could not be asked has the key "fault". Ends the program where a SPEC or a file of profiles is wrong. */
json_t *pl_engine_list(const pl_call *call, const pl_texts *names);

/* Prints an item of that array: what the engine is, its profiles with the values that differ from
 * the first one's and where they come from, its tuned profiles, and its options. */
void pl_engine_list_print(const json_t *item, FILE *out);

/* Prints a parameter of a scenario or an option of an engine: its help, unit, default and range, and `more`. */
void pl_list_print_number(const json_t *item, const char *more, FILE *out);

/* The machine as a JSON object: the processor's features and settings, the clock that times steps, load and
 * memory. What cannot be read is left out. A new reference. It takes about 0.2 s. */
json_t *pl_machine(void);

/* Prints the machine as a table, with the host of a provenance (pl_provenance). */
void pl_machine_print(const json_t *host, const json_t *machine, FILE *out);

/* Runs a program, looked up in PATH, to its end. `argv` ends with a NULL. Its standard output goes to the file
 * `output`; it has no input, and its messages go nowhere. Returns its exit code, or 128 plus the number of the signal
 * that ended it; -1: it could not be started, and errno says why. */
int pl_run_program(const char *const *argv, const char *output);

/* Opens a file with the program of the environment variable BROWSER, else with xdg-open. PL_IO when
 * neither can be started: the message names the file. */
pl_status pl_open_page(const char *path, pl_error *error);

/* Writes DIRECTORY/NAME.svg, .png or .pdf, as `format` says, of the scenario that `what` names: "NAME", a case's name
 * in the report, or "NAME:t=SECONDS". All engines stand side by side, at the end or at that time. *path is the file that
 * was written, malloc'd. The program is that of the environment variable CHROMIUM, else chromium. PL_BAD_INPUT: there is
 * no such case, it cannot be drawn, or without `force` the file exists; PL_IO: Chromium is not there or failed. */
pl_status pl_figure_write(const struct pl_report_def *def, const char *what, const char *format,
                          bool force, char **path, pl_error *error);

/* The program: finds the command, runs it, and returns the exit code. */
int pl_program(int argc, char **argv);

#endif
