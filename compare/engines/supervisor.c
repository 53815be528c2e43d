/* The process between the harness and a job: it outlives the job, to end whatever the job has left. */
#include "process.h"

#include <ctype.h>
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

void pl_file_field(const char *path, const char *key, char *text, size_t size)
{
    char line[512];
    text[0] = '\0';
    FILE *file = fopen(path, "re");
    while (file != NULL && text[0] == '\0' && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, key, strlen(key)) == 0) {
            const char *value = line + strlen(key);
            value += strspn(value, " \t:=\"");
            snprintf(text, size, "%.*s", (int)strcspn(value, "\"\n"), value);
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

/* How long a process that SIGKILL does not end is waited for: one of another user, or in the kernel. */
static const time_t PATIENCE = 5; /* s */
static const struct timespec NAP = {.tv_nsec = 10 * 1000 * 1000};

static sigset_t handled_signals(void)
{
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGCHLD);
    sigaddset(&set, SIGTERM);
    return set;
}

void pl_supervisor_begin(pid_t parent)
{
    const sigset_t handled = handled_signals();
    setsid();
    /* A caller may have left both ignored, and an ignored signal does not arrive. */
    signal(SIGCHLD, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    sigprocmask(SIG_BLOCK, &handled, NULL);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) {
        _exit(1);
    }
}

/* Reaps the children that have ended. False: there are none left. */
static bool reap(pid_t job, pl_supervision *report)
{
    siginfo_t ended;
    for (;;) {
        ended.si_pid = 0;
        if (waitid(P_ALL, 0, &ended, WEXITED | WNOHANG | WNOWAIT) != 0) {
            return false;
        }
        if (ended.si_pid == 0) {
            return true;
        }
        if (ended.si_pid == job) {
            /* Its session, while no other process can have its number. */
            kill(-job, SIGKILL);
            waitpid(job, &report->wait_status, 0);
            atomic_store(&report->has_ended, true);
        } else {
            waitpid(ended.si_pid, NULL, 0);
        }
    }
}

/* The parent of a process; 0: it has none, or is gone. */
static pid_t parent_of(const char *process)
{
    char path[300], parent[16];
    snprintf(path, sizeof path, "/proc/%s/status", process);
    pl_file_field(path, "PPid", parent, sizeof parent);
    return (pid_t)strtol(parent, NULL, 10);
}

static void kill_children(void)
{
    DIR *processes = opendir("/proc");
    const struct dirent *entry;
    while (processes != NULL && (entry = readdir(processes)) != NULL) {
        if (isdigit((unsigned char)entry->d_name[0]) && parent_of(entry->d_name) == getpid()) {
            kill((pid_t)strtol(entry->d_name, NULL, 10), SIGKILL);
        }
    }
    if (processes != NULL) {
        closedir(processes);
    }
}

void pl_supervise(pid_t job, pl_supervision *report)
{
    const sigset_t handled = handled_signals();
    struct timespec now;
    bool has_children = reap(job, report);
    while (has_children && !atomic_load(&report->has_ended)) {
        if (sigwaitinfo(&handled, NULL) == SIGTERM) {
            kill(job, SIGKILL);
        }
        has_children = reap(job, report);
    }
    clock_gettime(CLOCK_MONOTONIC, &now);
    const time_t end = now.tv_sec + PATIENCE;
    /* The children of one that is killed come here, and are killed in their turn. */
    while (has_children && now.tv_sec <= end) {
        kill_children();
        sigtimedwait(&handled, NULL, &NAP);
        has_children = reap(job, report);
        clock_gettime(CLOCK_MONOTONIC, &now);
    }
    _exit(0);
}
