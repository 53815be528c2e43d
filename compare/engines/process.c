#include "process.h"

#include "base/heap.h"
#include "base/sanitizer.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* More than any result: a longer answer is no answer, and the rest of it is dropped. */
enum { MAX_ANSWER = 1 << 28, CHUNK = 1 << 16 };

/* The descriptor of the answer in the child, and how the child ends when it cannot be written. */
enum { ANSWER = STDERR_FILENO + 1, EXIT_UNANSWERED = 113 };

double pl_monotonic_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void *pl_shared_new(size_t size)
{
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        pl_out_of_memory();
    }
    return memory;
}

/* ---- Limits ---- */

/* The limit is on writable memory: interpreters reserve far more addresses than they use. The shadow of
 * a sanitizer is larger than any limit. */
static const bool can_limit_memory = !PL_SANITIZER;

void pl_process_limit_memory(uint64_t memory)
{
    struct rlimit limit;
    char own[64];
    if (can_limit_memory && memory != 0 && getrlimit(RLIMIT_DATA, &limit) == 0) {
        pl_file_field("/proc/self/status", "VmData", own, sizeof own);
        const rlim_t most = 1024 * strtoull(own, NULL, 10) + memory;
        limit.rlim_cur = most < limit.rlim_max ? most : limit.rlim_max;
        setrlimit(RLIMIT_DATA, &limit);
    }
}

static void limit_resources(const pl_limits *limits)
{
    const struct rlimit none = {0, 0};
    struct rlimit files;
    setrlimit(RLIMIT_CORE, &none);
    /* Of a limit that the engine sets it dies; the user's is an error of who writes. */
    if (getrlimit(RLIMIT_FSIZE, &files) == 0 && files.rlim_cur == RLIM_INFINITY) {
        signal(SIGXFSZ, SIG_DFL);
    }
    pl_process_limit_memory(limits->memory);
}

/* ---- In the job ---- */

static void restore_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        signal(numbers[i], SIG_DFL);
    }
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

/* What a process starts with. */
typedef struct job_def {
    const pl_limits *limits;
    void (*run)(void *user, FILE *answer);
    void *user;
} job_def;

static _Noreturn void run_job(const job_def *job, pid_t supervisor)
{
    setsid();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    FILE *file = fdopen(ANSWER, "w");
    if (getppid() != supervisor || file == NULL) {
        _exit(1);
    }
    restore_signals();
    /* Numbers are written with a point, whatever locale an engine sets: this thread has its own. */
    uselocale(newlocale(LC_ALL_MASK, "C", NULL));
    /* So that a last line is not lost in a buffer when the engine crashes. */
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    limit_resources(job->limits);
    job->run(job->user, file);
    fflush(stdout);
    _exit(fclose(file) == 0 ? 0 : EXIT_UNANSWERED);
}

/* Leaves no descriptor open but the standard ones and the answer. */
static bool arrange_descriptors(int output, int answer)
{
    const int nothing = open("/dev/null", O_RDONLY);
    return nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
           dup2(output, STDERR_FILENO) >= 0 && (answer == ANSWER || dup2(answer, ANSWER) >= 0) &&
           close_range(ANSWER + 1, ~0U, 0) == 0 && fcntl(ANSWER, F_SETFD, FD_CLOEXEC) == 0;
}

static _Noreturn void run_supervisor(const job_def *job, pid_t parent, int output, int answer,
                                     pl_supervision *report)
{
    pl_supervisor_begin(parent);
    const pid_t self = getpid();
    const pid_t pid = arrange_descriptors(output, answer) ? fork() : -1;
    if (pid < 0) {
        _exit(1);
    }
    if (pid == 0) {
        munmap(report, sizeof *report);
        run_job(job, self);
    }
    atomic_store(&report->job, pid);
    close_range(STDIN_FILENO, ANSWER, 0);
    pl_supervise(pid, report);
}

/* ---- In the harness ---- */

static void close_end(int *descriptor)
{
    if (*descriptor >= 0) {
        close(*descriptor);
        *descriptor = -1;
    }
}

pl_status pl_process_start(pl_process *process, const pl_limits *limits,
                           void (*job)(void *user, FILE *answer), void *user, pl_error *error)
{
    int output[2] = {-1, -1};
    int answer[2] = {-1, -1};
    pl_status status = PL_OK;
    *process = (pl_process){.supervisor = -1, .handle = -1, .output = -1, .answer = -1};
    process->report = pl_shared_new(sizeof *process->report);
    if (pipe2(output, O_CLOEXEC) != 0 || pipe2(answer, O_CLOEXEC) != 0) {
        status = pl_fail(error, PL_IO, "cannot make a pipe for a run: %s", strerror(errno));
        goto cleanup;
    }
    /* What is buffered would otherwise be written twice. */
    fflush(NULL);
    pid_t parent = getpid();
    process->started = pl_monotonic_seconds();
    process->deadline = process->started + limits->timeout;
    process->supervisor = fork();
    if (process->supervisor == 0) {
        run_supervisor(&(job_def){limits, job, user}, parent, output[1], answer[1],
                       process->report);
    }
    process->handle = process->supervisor < 0 ? -1 : pidfd_open(process->supervisor, 0);
    if (process->handle < 0) {
        status = pl_fail(error, PL_IO, "cannot start a process for a run: %s", strerror(errno));
        if (process->supervisor > 0) {
            pl_process_kill(process);
        }
        goto cleanup;
    }
    process->output = output[0];
    process->answer = answer[0];
    output[0] = -1;
    answer[0] = -1;
    fcntl(process->output, F_SETFL, O_NONBLOCK);
    fcntl(process->answer, F_SETFL, O_NONBLOCK);

cleanup:
    for (int i = 0; i < 2; ++i) {
        close_end(&output[i]);
        close_end(&answer[i]);
    }
    if (status != PL_OK) {
        pl_process_free(process);
    }
    return status;
}

void pl_process_polls(const pl_process *process, struct pollfd *polls)
{
    /* poll(2) passes over a negative descriptor. */
    polls[0] = (struct pollfd){.fd = process->handle, .events = POLLIN};
    polls[1] = (struct pollfd){.fd = process->output, .events = POLLIN};
    polls[2] = (struct pollfd){.fd = process->answer, .events = POLLIN};
}

static void keep_tail(pl_process *process, const char *bytes, size_t length)
{
    if (length > PL_OUTPUT_TAIL) {
        bytes += length - PL_OUTPUT_TAIL;
        length = PL_OUTPUT_TAIL;
    }
    size_t room = PL_OUTPUT_TAIL - length;
    size_t kept = process->tail_length < room ? process->tail_length : room;
    memmove(process->tail, process->tail + process->tail_length - kept, kept);
    memcpy(process->tail + kept, bytes, length);
    process->tail_length = kept + length;
}

/* Hands the whole lines at the head of the answer on, except for JSON. */
static void stream_lines(pl_text_buffer *text, FILE *stream)
{
    size_t done = 0;
    while (done < text->length && text->data[done] != '{') {
        const char *line = text->data + done;
        const char *newline = memchr(line, '\n', text->length - done);
        if (newline == NULL) {
            break;
        }
        fwrite(line, 1, (size_t)(newline - line) + 1, stream);
        done += (size_t)(newline - line) + 1;
    }
    text->length -= done;
    memmove(text->data, text->data + done, text->length);
}

static void keep_answer(pl_process *process, const char *bytes, size_t length)
{
    if (process->text.length + length > MAX_ANSWER) {
        return;
    }
    pl_text_add_bytes(&process->text, bytes, length);
    if (process->text.failed) {
        pl_out_of_memory();
    }
    if (process->stream != NULL) {
        stream_lines(&process->text, process->stream);
    }
}

/* Reads what is there, at most a chunk. */
static void take(pl_process *process, int *descriptor,
                 void (*keep)(pl_process *, const char *, size_t))
{
    char bytes[CHUNK];
    if (*descriptor < 0) {
        return;
    }
    ssize_t length = read(*descriptor, bytes, sizeof bytes);
    if (length > 0) {
        keep(process, bytes, (size_t)length);
    } else if (length == 0 || (errno != EAGAIN && errno != EINTR)) {
        close_end(descriptor);
    }
}

void pl_process_end(const pl_process *process)
{
    kill(process->supervisor, SIGTERM);
    kill(process->supervisor, SIGCONT); /* should the job have stopped it */
}

/* Waits for the supervisor. One that did not live to tell the job's end took the job with it. */
static void reap(pl_process *process)
{
    while (waitpid(process->supervisor, &process->wait_status, 0) < 0 && errno == EINTR) {}
    if (atomic_load(&process->report->has_ended)) {
        process->wait_status = process->report->wait_status;
    }
}

bool pl_process_advance(pl_process *process, const struct pollfd *polls)
{
    if (polls[1].revents != 0) {
        take(process, &process->output, keep_tail);
    }
    if (polls[2].revents != 0) {
        take(process, &process->answer, keep_answer);
    }
    if (polls[0].revents == 0) {
        if (!process->timed_out && pl_monotonic_seconds() >= process->deadline) {
            process->timed_out = true;
            pl_process_end(process);
        }
        return false;
    }
    /* It has ended with its offspring, and the pipes hold no more than their buffers. The bound is for
     * one that could not be killed and prints on. */
    reap(process);
    for (int i = 0; i < 64; ++i) {
        take(process, &process->output, keep_tail);
        take(process, &process->answer, keep_answer);
    }
    close_end(&process->handle);
    close_end(&process->output);
    close_end(&process->answer);
    return true;
}

pl_status pl_process_wait(pl_process *process, pl_error *error)
{
    struct pollfd polls[PL_PROCESS_POLLS];
    do {
        pl_process_polls(process, polls);
        if (poll(polls, PL_PROCESS_POLLS, 100) < 0 && errno != EINTR) {
            pl_process_kill(process);
            pl_process_free(process);
            return pl_fail(error, PL_IO, "poll: %s", strerror(errno));
        }
    } while (!pl_process_advance(process, polls));
    return PL_OK;
}

void pl_process_kill(pl_process *process)
{
    pl_process_end(process);
    reap(process);
}

void pl_process_free(pl_process *process)
{
    close_end(&process->handle);
    close_end(&process->output);
    close_end(&process->answer);
    pl_text_free(&process->text);
    if (process->report != NULL) {
        munmap(process->report, sizeof *process->report);
        process->report = NULL;
    }
}

void pl_process_last_line(const pl_process *process, char text[201])
{
    size_t end = process->tail_length;
    while (end > 0 && strchr(" \t\r\n", process->tail[end - 1]) != NULL) {
        --end;
    }
    size_t begin = end;
    while (begin > 0 && end - begin < 200 && process->tail[begin - 1] != '\n') {
        --begin;
    }
    memcpy(text, process->tail + begin, end - begin);
    text[end - begin] = '\0';
    for (char *c = text; *c != '\0'; ++c) {
        const bool is_c1 = (unsigned char)*c == 0xc2 && (c[1] & 0xe0) == 0x80;
        if (is_c1) {
            *c++ = '?';
        }
        *c = is_c1 || (unsigned char)*c < ' ' || *c == 0x7f ? '?' : *c;
    }
}

void pl_process_describe_end(const pl_process *process, double timeout, const char *where,
                             char *text, size_t size)
{
    const int status = process->wait_status;
    char how[64];
    char line[201];
    if (process->timed_out) {
        snprintf(text, size, "no end within %g s: killed %s", timeout, where);
        return;
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_UNANSWERED) {
        snprintf(text, size, "it cannot answer: %s", PL_FOREIGN_DESCRIPTOR);
        return;
    }
    pl_process_last_line(process, line);
    if (strncmp(line, pl_out_of_memory_message, strlen(pl_out_of_memory_message) - 1) == 0) {
        snprintf(text, size, "out of memory %s", where);
        return;
    }
    if (WIFSIGNALED(status)) {
        const char *name = sigabbrev_np(WTERMSIG(status));
        snprintf(how, sizeof how, "SIG%s%s", name == NULL ? "?" : name,
                 WTERMSIG(status) == SIGKILL ? " (out of memory?)" : "");
    } else {
        snprintf(how, sizeof how, "it called exit(%d)", WEXITSTATUS(status));
    }
    snprintf(text, size, "%s %s%s%s", how, where, line[0] == '\0' ? "" : "; last line: ", line);
}
