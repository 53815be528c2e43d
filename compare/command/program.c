/* `plumb COMMAND ...`: the table of commands, help and version. */
#include "command.h"

#include "base/folding.h"
#include "base/heap.h"
#include "base/program_name.h"
#include "study_command.h"

#include <argp.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int help(const pl_call *call);
static int version(const pl_call *call);

static const pl_command HELP = {
    .name = "help", .summary = "explain a command", .arguments = "[COMMAND]", .run = help};
static const pl_command VERSION = {
    .name = "version", .summary = "print the version", .arguments = "", .run = version};

static const pl_command *const COMMANDS[] = {
#define COMMAND(name) &pl_command_##name,
#define STUDY(name) COMMAND(name)
#include "commands.def"
    &HELP, &VERSION};
enum { COMMAND_COUNT = sizeof COMMANDS / sizeof COMMANDS[0] };

static const char INTRODUCTION[] = "plumb runs canonical scenarios on rigid-body physics engines, "
                                   "and reports how far each engine "
                                   "is from the right answer and at what cost.\n"
                                   "\n"
                                   "Usage: plumb COMMAND [OPTION...]\n"
                                   "\n";

static const char CLOSING[] = "\n"
                              "  plumb help COMMAND     options and examples of a command\n"
                              "  plumb --version        version\n"
                              "\n";

static const pl_exit_meaning EXIT_MEANINGS[] = {
    {"0", "success"},
    {"1", "the gate failed (gate) or a check failed (check-engine)"},
    {"2", "usage or bad input"},
    {"3", "the outcome of a run is not ok (run), no solver reached the tolerance (solve), a run "
          "could not be made, or I/O failed"},
    {"4", "nothing was compared"},
    {"128+N", "ended by signal N"}};
enum { EXIT_COUNT = sizeof EXIT_MEANINGS / sizeof EXIT_MEANINGS[0] };

const pl_command *const *pl_commands(int *count)
{
    *count = COMMAND_COUNT;
    return COMMANDS;
}

const pl_exit_meaning *pl_exit_meanings(int *count)
{
    *count = EXIT_COUNT;
    return EXIT_MEANINGS;
}

/* The command of that name; NULL, after a message on behalf of `asker`, when there is none. */
static const pl_command *find_command(const char *name, const char *asker, const char *otherwise)
{
    const char *names[COMMAND_COUNT];
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        names[i] = COMMANDS[i]->name;
        if (strcmp(names[i], name) == 0) {
            return COMMANDS[i];
        }
    }
    char hint[PL_SUGGESTION_SIZE];
    pl_did_you_mean(name, names, COMMAND_COUNT, hint);
    pl_print_line(stderr, "%s: there is no command %s%s", asker, name,
                  hint[0] == '\0' ? otherwise : hint);
    return NULL;
}

static int run_command(const pl_command *command, pl_call call)
{
    char name[64];
    snprintf(name, sizeof name, "plumb %s", command->name);
    pl_error error = {.message = ""};
    call.command = command;
    call.argv[0] = name;
    call.error = &error;
    return command->run(&call);
}

static int help(const pl_call *call)
{
    const char *name = call->argc > 1 ? call->argv[1] : "help";
    if (strncmp(name, "--", 2) == 0 || strcmp(name, "help") == 0) {
        pl_folding folding;
        FILE *out = pl_folding_begin(&folding, stdout);
        fputs(INTRODUCTION, out);
        for (int i = 0; i < COMMAND_COUNT; ++i) {
            fprintf(out, "  plumb %-12s  %s\n", COMMANDS[i]->name, COMMANDS[i]->summary);
        }
        fputs(CLOSING, out);
        for (int i = 0; i < EXIT_COUNT; ++i) {
            fprintf(out, "%s%s %s", i == 0 ? "Exit codes: " : "; ", EXIT_MEANINGS[i].code,
                    EXIT_MEANINGS[i].meaning);
        }
        fputs(".\n", out);
        pl_folding_end(&folding);
        return PL_EXIT_OK;
    }
    const pl_command *command = find_command(name, "plumb help", "");
    char option[] = "--help";
    char *argv[] = {NULL, option, NULL};
    return command == NULL ? PL_EXIT_USAGE
                           : run_command(command, (pl_call){.argc = 2, .argv = argv});
}

static void print_version(FILE *stream, struct argp_state *state)
{
    (void)state;
    fprintf(stream, "plumb %s (%s)\n", PLUMB_VERSION, PLUMB_GIT);
}

static int version(const pl_call *call)
{
    (void)call;
    print_version(stdout, NULL);
    return PL_EXIT_OK;
}

/* A standard stream that the caller closed would be the number of the first file opened, and what
 * is printed would end in that file: it becomes a stream that cannot be used. */
static void fill_closed_streams(void)
{
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
        if (fcntl(stream, F_GETFD) < 0) {
            (void)!open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
        }
    }
}

/* What was printed must have arrived: a full disk or a closed pipe is a failure, not a success. At
 * exit, because argp exits by itself after --help. */
static void check_output(void)
{
    bool failed = ferror(stdout) != 0;
    failed = fflush(stdout) != 0 || failed;
    if (failed) {
        fprintf(stderr, "plumb: standard output could not be written\n");
        _exit(PL_EXIT_FAILED);
    }
}

/* argp's own help fits the window too, unless the user has set its format. */
static void fit_help(void)
{
    char format[32];
    if (!pl_window_is_known(stdout)) {
        return;
    }
    snprintf(format, sizeof format, "rmargin=%d", pl_window_width(stdout) - 1);
    (void)setenv("ARGP_HELP_FMT", format, 0);
}

int pl_program(int argc, char **argv)
{
    fill_closed_streams();
    /* Messages are not buffered. So both keep their order, also where they go to one file, and each line
     * of data is written whole. */
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    signal(SIGXFSZ, SIG_IGN); /* a file that may grow no more is an error of write(2) */
    atexit(check_output);
    argp_err_exit_status = PL_EXIT_USAGE;
    argp_program_version_hook = print_version;
    fit_help();
    if (argc < 2) {
        fprintf(stderr, "plumb: no command was given; see plumb help\n");
        return PL_EXIT_USAGE;
    }
    if (strcmp(argv[1], "__complete") == 0) {
        return pl_complete(COMMANDS, COMMAND_COUNT, argc - 2, argv + 2);
    }
    const bool is_option = strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "--version") == 0;
    const pl_command *command =
        find_command(is_option ? argv[1] + 2 : argv[1], PL_PROGRAM, "; see plumb help");
    if (command == NULL) {
        return PL_EXIT_USAGE;
    }
    char **command_argv = pl_heap_new((size_t)argc, sizeof *command_argv);
    memcpy(command_argv, argv + 1, (size_t)argc * sizeof *command_argv);
    int code = run_command(command, (pl_call){.argc = argc - 1,
                                              .argv = command_argv,
                                              .program_argc = argc,
                                              .program_argv = argv});
    free(command_argv);
    return code;
}
