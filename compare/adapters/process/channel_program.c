/* The program at the other end of a channel: its start, its end and its CPU time. */
#include "channel.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* How long a program has to end by itself. */
enum { PATIENCE_MS = 1000 };

/* The descriptor of the file of numbers in the program. */
enum { NUMBERS = STDERR_FILENO + 1 };

/* The exit codes of a shell that cannot run a command. */
enum { EXIT_NOT_EXECUTABLE = 126, EXIT_NOT_FOUND = 127 };

static void close_end(int *descriptor)
{
    if (*descriptor >= 0) {
        close(*descriptor);
        *descriptor = -1;
    }
}

/* Whether the command begins with NAME=VALUE, which `exec` does not take. */
static bool sets_variable(const char *command)
{
    size_t length = 0;
    while (isalnum((unsigned char)command[length]) || command[length] == '_') {
        ++length;
    }
    return length > 0 && !isdigit((unsigned char)command[0]) && command[length] == '=';
}

static _Noreturn void run_program(const char *command, pid_t parent, int input, int output,
                                  int numbers)
{
    char *text = NULL;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGPIPE, SIG_DFL);
    command += strspn(command, " \t\n");
    if (getppid() != parent ||
        asprintf(&text, "exec %s%s", sets_variable(command) ? "env " : "", command) < 0 ||
        dup2(input, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 ||
        (numbers != NUMBERS ? dup2(numbers, NUMBERS) : fcntl(NUMBERS, F_SETFD, 0)) < 0) {
        _exit(EXIT_NOT_EXECUTABLE);
    }
    execl("/bin/sh", "sh", "-c", text, (char *)NULL);
    _exit(EXIT_NOT_EXECUTABLE);
}

pl_status pl_channel_open(pl_channel *channel, const char *command, pl_error *error)
{
    int input[2] = {-1, -1}, output[2] = {-1, -1};
    *channel = (pl_channel){.handle = -1, .input = -1, .output = -1};
    channel->numbers = memfd_create("numbers", MFD_CLOEXEC);
    const bool has_pipes = pipe2(input, O_CLOEXEC) == 0 && pipe2(output, O_CLOEXEC) == 0;
    if (channel->numbers >= 0 && has_pipes) {
        /* A program that has ended must not end this one. */
        signal(SIGPIPE, SIG_IGN);
        fflush(NULL);
        const pid_t parent = getpid();
        const pid_t pid = fork();
        if (pid == 0) {
            run_program(command, parent, input[0], output[1], channel->numbers);
        }
        channel->pid = pid > 0 ? pid : 0;
        channel->handle = pid > 0 ? pidfd_open(pid, 0) : -1;
    }
    const int cause = errno;
    channel->input = input[1];
    channel->output = output[0];
    close_end(&input[0]);
    close_end(&output[1]);
    if (channel->handle < 0) {
        pl_channel_close(channel);
        return pl_fail(error, PL_IO, "cannot start \"%s\": %s", command, strerror(cause));
    }
    fcntl(channel->input, F_SETFL, O_NONBLOCK);
    fcntl(channel->output, F_SETFL, O_NONBLOCK);
    return PL_OK;
}

/* Waits until the program has ended. False: it has not within that time. */
static bool has_ended(const pl_channel *channel, int milliseconds)
{
    struct pollfd end = {.fd = channel->handle, .events = POLLIN};
    return poll(&end, 1, milliseconds) > 0;
}

void pl_channel_close(pl_channel *channel)
{
    close_end(&channel->input);
    close_end(&channel->output);
    if (channel->pid > 0) {
        if (channel->handle < 0 || !has_ended(channel, PATIENCE_MS)) {
            kill(channel->pid, SIGKILL);
        }
        waitpid(channel->pid, NULL, 0);
    }
    close_end(&channel->handle);
    close_end(&channel->numbers);
    pl_text_free(&channel->request);
    free(channel->text);
    *channel = (pl_channel){.handle = -1, .input = -1, .output = -1, .numbers = -1};
}

pl_status pl_channel_describe_end(const pl_channel *channel, char *text, size_t size)
{
    siginfo_t info = {.si_pid = 0};
    pl_status status = PL_FAILED;
    if (!has_ended(channel, PATIENCE_MS) ||
        waitid(P_PID, (id_t)channel->pid, &info, WEXITED | WNOWAIT) != 0) {
        snprintf(text, size, "the program closed its standard output");
    } else if (info.si_code == CLD_EXITED && info.si_status == EXIT_NOT_FOUND) {
        snprintf(text, size, "the program was not found");
        status = PL_BAD_INPUT;
    } else if (info.si_code == CLD_EXITED && info.si_status == EXIT_NOT_EXECUTABLE) {
        snprintf(text, size, "the program cannot be run");
    } else if (info.si_code == CLD_EXITED) {
        snprintf(text, size, "the program called exit(%d)", info.si_status);
    } else {
        const char *name = sigabbrev_np(info.si_status);
        snprintf(text, size, "the program ended by SIG%s", name == NULL ? "?" : name);
    }
    return status;
}

double pl_cpu_time_of(pid_t pid)
{
    clockid_t clock;
    struct timespec used;
    if (pid <= 0 || clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &used) != 0) {
        return 0;
    }
    return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}
