/* Other programs that commands call. */
#include "command.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

int pl_run_program(const char *const *argv, const char *output)
{
    int ended = 0;
    pid_t child = 0;
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    errno = posix_spawnp(&child, argv[0], &files, NULL, (char *const *)argv, environ);
    posix_spawn_file_actions_destroy(&files);
    if (errno != 0 || waitpid(child, &ended, 0) < 0) {
        return -1;
    }
    return WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
}

pl_status pl_open_page(const char *path, pl_error *error)
{
    const char *browser = getenv("BROWSER");
    const char *program = browser != NULL && browser[0] != '\0' ? browser : "xdg-open";
    const char *const argv[] = {program, path, NULL};
    return pl_run_program(argv, "/dev/null") == 0
               ? PL_OK
               : pl_fail(
                     error, PL_IO,
                     "%.300s was not opened: \"%.100s\" failed. Open it yourself, or set BROWSER",
                     path, program);
}
