#include "open_page.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

pl_status pl_open_page(const char *path, pl_error *error)
{
    const char *browser = getenv("BROWSER");
    const char *program = browser != NULL && browser[0] != '\0' ? browser : "xdg-open";
    int ended = 0;
    const pid_t child = fork();
    if (child == 0) {
        const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
        dup2(null, STDIN_FILENO);
        dup2(null, STDOUT_FILENO);
        dup2(null, STDERR_FILENO);
        execlp(program, program, path, (char *)NULL);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &ended, 0) < 0 || !WIFEXITED(ended) ||
        WEXITSTATUS(ended) != 0) {
        return pl_fail(error, PL_IO,
                       "%.300s was not opened: \"%.100s\" failed. Open it yourself, or set BROWSER",
                       path, program);
    }
    return PL_OK;
}
