#include "staged_faults.h"

#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

/* ---- Ends ---- */

static void fail_exit0(void)
{
    exit(0);
}

static void fail_exit7(void)
{
    exit(7);
}

static void fail_quick_exit(void)
{
    quick_exit(8);
}

static void fail_abort(void)
{
    fprintf(stderr, "\033[31mit cannot go on\n");
    abort();
}

static void fail_killgroup(void)
{
    kill(0, SIGKILL);
}

static void fail_killparent(void)
{
    kill(getppid(), SIGKILL);
    pause();
}

static void fail_alarm(void)
{
    const struct itimerval soon = {.it_value = {.tv_usec = 1000}};
    setitimer(ITIMER_REAL, &soon, NULL);
    pause();
}

/* Reads a page that its file no longer has. */
static void fail_bus(void)
{
    const int file = memfd_create("page", 0);
    if (ftruncate(file, 4096) != 0) {
        return;
    }
    volatile char *page = mmap(NULL, 4096, PROT_READ, MAP_SHARED, file, 0);
    if (ftruncate(file, 0) == 0) {
        (void)*page;
    }
}

static void fail_constant(void)
{
    void *page = mmap(NULL, 4096, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    *(volatile char *)page = 1;
}

/* The compiler must not see that it never ends. */
static volatile int depth = 1;

static int recurse(int level)
{
    volatile char room[4096];
    room[0] = (char)level;
    return depth == 0 ? 0 : recurse(level + 1) + room[0];
}

static void fail_stack(void)
{
    recurse(0);
}

static void fail_free(void)
{
    void (*volatile give_back)(void *) = free; /* so that no compiler warns */
    void *twice = malloc(100);
    give_back(twice);
    give_back(twice);
}

static void *abort_in_thread(void *nothing)
{
    (void)nothing;
    abort();
}

static void fail_thread_abort(void)
{
    pthread_t thread;
    pthread_create(&thread, NULL, abort_in_thread, NULL);
    pthread_join(thread, NULL);
}

static void fail_exec(void)
{
    execl("/bin/true", "true", (char *)NULL);
}

static void fail_atexit_abort(void)
{
    atexit(abort);
    exit(0);
}

static jmp_buf place;

/* Back into a function that has returned. */
__attribute__((noinline)) static int set_place(void)
{
    return setjmp(place);
}

static void fail_longjmp(void)
{
    if (set_place() == 0) {
        longjmp(place, 1);
    }
    abort();
}

static void fail_hang(void)
{
    for (;;) {
        pause();
    }
}

static void fail_stopparent(void)
{
    kill(getppid(), SIGSTOP);
}

static void fail_deaf(void)
{
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, NULL);
    for (int i = 1; i < 32; ++i) {
        signal(i, SIG_IGN);
    }
    fail_hang();
}

static void fail_spin(void)
{
    volatile int turns = 0;
    for (;;) {
        turns = turns + 1;
    }
}

/* ---- What is the process's own ---- */

static void fail_chdir(void)
{
    (void)!chdir("/");
}

/* Its folder is gone. */
static void fail_folder(void)
{
    char name[] = "/tmp/staged-XXXXXX";
    if (mkdtemp(name) != NULL && chdir(name) == 0) {
        rmdir(name);
    }
}

static void fail_standard(void)
{
    for (int i = 0; i < 3; ++i) {
        close(i);
    }
}

static void fail_close(void)
{
    for (int i = 3; i < 256; ++i) {
        close(i);
    }
}

static void fail_write(void)
{
    for (int i = 3; i < 256; ++i) {
        (void)!write(i, "{\"outcome\":\"ok\"}\n\033[31m", 22);
    }
}

static void fail_replaced(void)
{
    dup2(open("/dev/null", O_WRONLY), 3);
}

static void fail_descriptors(void)
{
    while (open("/dev/null", O_RDONLY) >= 0) {}
}

static void fail_forge(void)
{
    static const char text[] = "{\"outcome\":\"ok\",\"metrics\":{}}";
    (void)!write(3, text, sizeof text - 1);
    _exit(0);
}

/* Says which descriptors are open. */
static void fail_list(void)
{
    for (int i = 0; i < 1024; ++i) {
        char link[64];
        char target[256];
        snprintf(link, sizeof link, "/proc/self/fd/%d", i);
        const ssize_t length = readlink(link, target, sizeof target);
        if (length > 0) {
            printf("%d:%.*s ", i, (int)length, target);
        }
    }
    printf("\n");
}

static void fail_limits(void)
{
    static const __rlimit_resource_t limits[] = {RLIMIT_NOFILE, RLIMIT_FSIZE, RLIMIT_DATA,
                                                 RLIMIT_STACK};
    const struct rlimit none = {0, 0};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; ++i) {
        setrlimit(limits[i], &none);
    }
}

static void fail_rounding(void)
{
    fesetround(FE_UPWARD);
#ifdef __SSE__
    _mm_setcsr(_mm_getcsr() | 0x8040u); /* subnormal numbers are 0 */
#endif
}

static void fail_x87(void)
{
#if defined(__x86_64__) || defined(__i386__)
    const unsigned short single = 0x007f;
    __asm__ volatile("fldcw %0" : : "m"(single));
#endif
}

static void fail_traps(void)
{
    feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW);
}

static void ignore(int number)
{
    (void)number;
}

static void fail_signals(void)
{
    sigset_t all;
    for (int i = 1; i < 32; ++i) {
        signal(i, i == SIGTERM ? SIG_IGN : ignore);
    }
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, NULL);
}

static void fail_environment(void)
{
    setenv("TMPDIR", "/nowhere", 1);
    setenv("PLUMB_PROFILES", "/nowhere", 1);
    umask(0777);
}

static void fail_cleared(void)
{
    clearenv();
}

/* Numbers are then written with a comma, where the machine has one of these. */
static void fail_locale(void)
{
    static const char *const names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE.utf8"};
    for (size_t i = 0; i < sizeof names / sizeof *names && setlocale(LC_ALL, names[i]) == NULL;
         ++i) {}
}

static void fail_atexit(void)
{
    atexit(abort);
}

static void fail_nice(void)
{
    setpriority(PRIO_PROCESS, 0, 19);
}

static void fail_undumpable(void)
{
    prctl(PR_SET_DUMPABLE, 0);
    prctl(PR_SET_PDEATHSIG, 0);
}

static void *sleep_in_thread(void *nothing)
{
    (void)nothing;
    sleep(30);
    return NULL;
}

static void fail_thread(void)
{
    pthread_t thread;
    pthread_create(&thread, NULL, sleep_in_thread, NULL);
    usleep(5000); /* it must be asleep before its code is unloaded */
}

/* ---- Offspring ---- */

/* What a descendant does that is to be found by its name if it is left. */
static _Noreturn void linger(void)
{
    execl("/bin/sleep", "sleep", "3217", (char *)NULL);
    _exit(1);
}

static void fail_fork(void)
{
    if (fork() == 0) {
        linger();
    }
}

/* Each generation in a session of its own, of which the parents end at once. */
static void fail_setsid(void)
{
    for (int generation = 0; generation < 3; ++generation) {
        if (fork() != 0) {
            if (generation > 0) {
                _exit(0);
            }
            usleep(20000);
            return;
        }
        setsid();
    }
    linger();
}

/* Hangs besides. */
static void fail_lost(void)
{
    fail_setsid();
    fail_hang();
}

/* Ends together with those that it leaves. */
static void fail_orphans(void)
{
    fail_setsid();
    exit(7);
}

/* It cannot be told from one of another parent by a careless reader of /proc, and ends by no signal but
 * one. */
static void fail_disguise(void)
{
    if (fork() == 0) {
        setsid();
        prctl(PR_SET_NAME, "a) S 1 (b\n) R 0");
        fail_deaf();
    }
}

static void fail_stopped_child(void)
{
    if (fork() == 0) {
        setsid();
        raise(SIGSTOP);
        linger();
    }
}

/* 2^6 processes, each of the later ones in a session of its own. */
static void fail_bomb(void)
{
    const pid_t first = getpid();
    for (int i = 0; i < 6; ++i) {
        if (fork() == 0) {
            setsid();
        }
    }
    if (getpid() != first) {
        linger();
    }
}

/* ---- Memory ---- */

enum { BLOCK = 64 << 20, MOST_BLOCKS = 512 };

static void fail_memory(void)
{
    void *memory = NULL;
    for (int i = 0; i < MOST_BLOCKS && (memory = malloc(BLOCK)) != NULL; ++i) {
        *(volatile char *)memory = 1;
    }
    fprintf(stderr, "no more memory\n");
    abort();
}

/* It does not look at what malloc returns. */
static void fail_unchecked(void)
{
    for (int i = 0; i < MOST_BLOCKS; ++i) {
        *(volatile char *)malloc(BLOCK) = 1;
    }
}

/* Keeps all there is, and goes on. */
static void fail_hoard(void)
{
    for (size_t block = BLOCK; block >= 64; block /= 2) {
        for (int i = 0; i < MOST_BLOCKS && malloc(block) != NULL; ++i) {}
    }
}

const staged_fault staged_process_faults[] = {
    {"exit0", fail_exit0, 0},
    {"exit7", fail_exit7, 0},
    {"quick", fail_quick_exit, 0},
    {"abort", fail_abort, 0},
    {"crash", NULL, SIGSEGV},
    {"ill", NULL, SIGILL},
    {"fpe", NULL, SIGFPE},
    {"trap", NULL, SIGTRAP},
    {"sys", NULL, SIGSYS},
    {"pipe", NULL, SIGPIPE},
    {"term", NULL, SIGTERM},
    {"int", NULL, SIGINT},
    {"xcpu", NULL, SIGXCPU},
    {"realtime", NULL, 40},
    {"kill", NULL, SIGKILL},
    {"killgroup", fail_killgroup, 0},
    {"killparent", fail_killparent, 0},
    {"alarm", fail_alarm, 0},
    {"bus", fail_bus, 0},
    {"constant", fail_constant, 0},
    {"stack", fail_stack, 0},
    {"free", fail_free, 0},
    {"threadabort", fail_thread_abort, 0},
    {"exec", fail_exec, 0},
    {"atexitabort", fail_atexit_abort, 0},
    {"longjmp", fail_longjmp, 0},
    {"hang", fail_hang, 0},
    {"stop", NULL, SIGSTOP},
    {"stopparent", fail_stopparent, 0},
    {"deaf", fail_deaf, 0},
    {"spin", fail_spin, 0},
    {"chdir", fail_chdir, 0},
    {"folder", fail_folder, 0},
    {"standard", fail_standard, 0},
    {"close", fail_close, 0},
    {"write", fail_write, 0},
    {"replaced", fail_replaced, 0},
    {"descriptors", fail_descriptors, 0},
    {"forge", fail_forge, 0},
    {"list", fail_list, 0},
    {"limits", fail_limits, 0},
    {"rounding", fail_rounding, 0},
    {"x87", fail_x87, 0},
    {"traps", fail_traps, 0},
    {"signals", fail_signals, 0},
    {"environment", fail_environment, 0},
    {"cleared", fail_cleared, 0},
    {"locale", fail_locale, 0},
    {"atexit", fail_atexit, 0},
    {"nice", fail_nice, 0},
    {"undumpable", fail_undumpable, 0},
    {"thread", fail_thread, 0},
    {"fork", fail_fork, 0},
    {"setsid", fail_setsid, 0},
    {"lost", fail_lost, 0},
    {"orphans", fail_orphans, 0},
    {"disguise", fail_disguise, 0},
    {"stopped", fail_stopped_child, 0},
    {"bomb", fail_bomb, 0},
    {"memory", fail_memory, 0},
    {"unchecked", fail_unchecked, 0},
    {"hoard", fail_hoard, 0},
    {NULL, NULL, 0},
};
