/* `plumb COMMAND ...`: the table of commands, and the way to them. */
#include "commands.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const pl_command commands[] = {
    {"compare", "run scenarios on engines side by side and report", pl_command_compare},
    {"run", "run one scenario on one engine", pl_command_run},
    {"threshold", "bisect a scenario's critical value on engines", pl_command_threshold},
    {"list", "list scenarios, engines, metrics or suites", pl_command_list},
    {"scene", "print a scenario as a scene file, to edit and run", pl_command_scene},
    {"solve", "solve one captured contact problem again", pl_command_solve},
    {"ensemble", "compare engines where motion is chaotic", pl_command_ensemble},
    {"sweep", "vary steps, options and parameters over many runs", pl_command_sweep},
    {"tune", "find the cheapest settings that meet a target", pl_command_tune},
    {"report", "report on results that are there", pl_command_report},
    {"metamorphic", "check engines without a reference", pl_command_metamorphic},
    {"gate", "fail where results are worse than a baseline", pl_command_gate},
    {"help", "explain a command", pl_command_help},
    {"version", "print the version", pl_command_version},
};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static const pl_command *find_command(const char *name)
{
    if (strcmp(name, "--help") == 0) {
        name = "help";
    } else if (strcmp(name, "--version") == 0) {
        name = "version";
    }
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        if (strcmp(commands[i].name, name) == 0) {
            return &commands[i];
        }
    }
    return NULL;
}

static void reject_command(const char *name)
{
    const char *names[COMMAND_COUNT];
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        names[i] = commands[i].name;
    }
    const char *nearest = pl_nearest_name(name, names, COMMAND_COUNT);
    if (nearest != NULL) {
        fprintf(stderr, "plumb: there is no command %s; did you mean %s?\n", name, nearest);
    } else {
        fprintf(stderr, "plumb: there is no command %s; see plumb help\n", name);
    }
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

static void print_version_for_argp(FILE *stream, struct argp_state *state)
{
    (void)state;
    fprintf(stream, "plumb %s (%s)\n", PLUMB_VERSION, PLUMB_GIT);
}

int pl_program(int argc, char **argv)
{
    fill_closed_streams();
    atexit(check_output);
    argp_err_exit_status = PL_EXIT_USAGE;
    argp_program_version_hook = print_version_for_argp;
    if (argc < 2) {
        fprintf(stderr, "plumb: no command was given; see plumb help\n");
        return PL_EXIT_USAGE;
    }
    const pl_command *command = find_command(argv[1]);
    if (command == NULL) {
        reject_command(argv[1]);
        return PL_EXIT_USAGE;
    }
    char name[64];
    snprintf(name, sizeof name, "plumb %s", command->name);
    char **command_argv = malloc((size_t)argc * sizeof *command_argv);
    if (command_argv == NULL) {
        fprintf(stderr, "plumb: out of memory\n");
        return PL_EXIT_FAILED;
    }
    memcpy(command_argv, argv + 1, (size_t)argc * sizeof *command_argv);
    command_argv[0] = name;
    const pl_call call = {.argc = argc - 1,
                          .argv = command_argv,
                          .program_argc = argc,
                          .program_argv = argv,
                          .commands = commands,
                          .command_count = COMMAND_COUNT};
    int code = command->run(&call);
    free(command_argv);
    return code;
}
