/* plumb help [COMMAND], plumb version. */
#include "commands.h"

#include <string.h>

static const char introduction[] =
    "plumb tells whether a rigid-body engine is plumb: it runs canonical scenarios on engines side "
    "by\n"
    "side, and reports how far each is from the right answer and at what cost.\n"
    "\n"
    "Usage: plumb COMMAND [OPTION...]\n"
    "\n";

static const char closing[] =
    "\n"
    "  plumb help COMMAND     options and examples of a command\n"
    "  plumb --version        version\n"
    "\n"
    "Exit codes: 0 all well; 2 usage or bad input; 3 a run's outcome is not ok (run), no solver\n"
    "reached the tolerance (solve), a run could not be made, or I/O failed; 4 nothing was "
    "compared;\n"
    "128+N ended by signal N.\n";

int pl_command_help(const pl_call *call)
{
    const char *name = call->argc > 1 ? call->argv[1] : NULL;
    if (name == NULL || strncmp(name, "--", 2) == 0 || strcmp(name, "help") == 0) {
        fputs(introduction, stdout);
        for (int i = 0; i < call->command_count; ++i) {
            printf("  plumb %-16s %s\n", call->commands[i].name, call->commands[i].summary);
        }
        fputs(closing, stdout);
        return PL_EXIT_OK;
    }
    const char *names[32];
    for (int i = 0; i < call->command_count; ++i) {
        names[i] = call->commands[i].name;
        if (strcmp(names[i], name) == 0) {
            char full_name[64];
            snprintf(full_name, sizeof full_name, "plumb %s", name);
            char *argv[] = {full_name, "--help", NULL};
            pl_call asked = *call;
            asked.argc = 2;
            asked.argv = argv;
            return call->commands[i].run(&asked);
        }
    }
    const char *nearest = pl_nearest_name(name, names, call->command_count);
    fprintf(stderr, "plumb help: there is no command %s%s%s%s\n", name,
            nearest == NULL ? "" : "; did you mean ", nearest == NULL ? "" : nearest,
            nearest == NULL ? "" : "?");
    return PL_EXIT_USAGE;
}

int pl_command_version(const pl_call *call)
{
    (void)call;
    printf("plumb %s (%s)\n", PLUMB_VERSION, PLUMB_GIT);
    return PL_EXIT_OK;
}
