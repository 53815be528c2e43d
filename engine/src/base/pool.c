/* A loop is published by its caller, who takes pieces of it together with all threads that come.
 * Threads without work spin, then yield, for some tenths of a millisecond before they sleep: loops follow
 * each other closely, and to wake a thread takes as long as a small loop. The caller never waits for a thread that
 * has not begun, so that a task system may run its tasks late, one after the other, or within the call
 * that submits them. */
#define _POSIX_C_SOURCE 200809L

#include "pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

/* Looks at a number that another thread is about to change: before a thread without work begins to yield,
 * then until it sleeps, and before one that waits for others yields. */
enum { SPINS = 4000, YIELDS = 1000, PATIENCE = 200 };

enum { CACHE_LINE = 64 };

/* A thread of the pool. Neighbours lie on cache lines of their own. */
typedef struct seat {
    pe_pool *pool;
    int worker;
    pthread_t thread; /* not of a task system */
    void *handle;     /* of a task system */
    atomic_int next;  /* of its share of the pieces: the one to be taken next */
    char space[CACHE_LINE];
} seat;

struct pe_pool {
    int threads;
    int started; /* threads that must be joined, from seat 1 */
    seat *seats; /* (threads); the first one is the caller's */
    pe_task_system tasks;

    /* The loop. It stays as it is while a thread is inside it. */
    pe_piece *piece;
    void *context;
    int begin, end, grain, pieces;

    pthread_cond_t wake;

    _Alignas(CACHE_LINE) atomic_uint loop;  /* odd while a loop is open, and other than before */
    _Alignas(CACHE_LINE) atomic_int inside; /* threads that may look at the loop */
    atomic_int sleepers;
    atomic_bool stop;
    pthread_mutex_t mutex;
};

static void relax(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

static int end_of(int begin, int end, int grain)
{
    return end - begin < grain ? end : begin + grain;
}

/* The first piece of a thread's share; that of the next thread begins where it ends. */
static int share_of(const pe_pool *pool, int worker)
{
    return (int)((long long)pool->pieces * worker / pool->threads);
}

/* Takes the pieces of a thread's own share, which lie next to each other, as they did in the loops before,
 * and then what is left of the others'. */
static void take_pieces(pe_pool *pool, int worker)
{
    for (int k = 0; k < pool->threads; ++k) {
        const int owner = (worker + k) % pool->threads, end = share_of(pool, owner + 1);
        for (int i; (i = atomic_fetch_add_explicit(&pool->seats[owner].next, 1,
                                                   memory_order_relaxed)) < end;) {
            const int begin = pool->begin + i * pool->grain;
            pool->piece(pool->context, worker, begin, end_of(begin, pool->end, pool->grain));
        }
    }
}

/* Takes pieces of the loop with this number, unless it is closed. The caller of the loop closes it
 * before it looks for threads inside, and a thread enters before it looks whether the loop is open. */
static void join_loop(pe_pool *pool, unsigned number, int worker)
{
    atomic_fetch_add(&pool->inside, 1);
    if (atomic_load(&pool->loop) == number) {
        take_pieces(pool, worker);
    }
    atomic_fetch_sub(&pool->inside, 1);
}

static bool is_open(unsigned number)
{
    return number % 2 == 1;
}

/* Waits for an open loop other than number `last`, and returns its number, or `last` at the end. */
static unsigned await_loop(pe_pool *pool, unsigned last)
{
    unsigned number = last;
    for (int i = 0; i < SPINS + YIELDS; ++i) {
        number = atomic_load(&pool->loop);
        if (is_open(number) && number != last) {
            return number;
        }
        if (i < SPINS) {
            relax();
        } else {
            sched_yield();
        }
    }
    pthread_mutex_lock(&pool->mutex);
    atomic_fetch_add(&pool->sleepers, 1);
    for (number = atomic_load(&pool->loop);
         !(is_open(number) && number != last) && !atomic_load(&pool->stop);
         number = atomic_load(&pool->loop)) {
        pthread_cond_wait(&pool->wake, &pool->mutex);
    }
    atomic_fetch_sub(&pool->sleepers, 1);
    pthread_mutex_unlock(&pool->mutex);
    return is_open(number) ? number : last;
}

static void *serve(void *argument)
{
    const seat *s = argument;
    for (unsigned last = 0; !atomic_load(&s->pool->stop);) {
        const unsigned number = await_loop(s->pool, last);
        if (number != last) {
            join_loop(s->pool, number, s->worker);
            last = number;
        }
    }
    return NULL;
}

/* The work of a task: it begins when the loop is open, and may be late. */
static void help(void *argument)
{
    const seat *s = argument;
    const unsigned number = atomic_load(&s->pool->loop);
    if (is_open(number)) {
        join_loop(s->pool, number, s->worker);
    }
}

static void wake_sleepers(pe_pool *pool)
{
    if (atomic_load(&pool->sleepers) > 0) {
        pthread_mutex_lock(&pool->mutex);
        pthread_cond_broadcast(&pool->wake);
        pthread_mutex_unlock(&pool->mutex);
    }
}

pe_status pe_pool_create(const pe_world_def *def, const pe_allocator *allocator, pe_pool **pool,
                         pe_error *error)
{
    *pool = NULL;
    if (def->threads == 1) {
        return PE_OK;
    }
    const size_t threads = (size_t)def->threads;
    pe_pool *made = allocator->allocate(allocator->context, sizeof *made);
    seat *seats = allocator->allocate(allocator->context, threads * sizeof *seats);
    if (made == NULL || seats == NULL) {
        pe_release(allocator, made);
        pe_release(allocator, seats);
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu threads", threads);
    }
    *made = (pe_pool){.threads = def->threads, .started = 1, .seats = seats, .tasks = def->tasks};
    pthread_mutex_init(&made->mutex, NULL);
    pthread_cond_init(&made->wake, NULL);
    for (int i = 0; i < def->threads; ++i) {
        seats[i] = (seat){.pool = made, .worker = i, .next = 0};
    }
    while (def->tasks.run == NULL && made->started < def->threads) {
        seat *s = &seats[made->started];
        if (pthread_create(&s->thread, NULL, serve, s) != 0) {
            pe_pool_destroy(made, allocator);
            return pe_fail(error, PE_NO_MEMORY, "the system does not start %zu threads", threads);
        }
        made->started += 1;
    }
    *pool = made;
    return PE_OK;
}

void pe_pool_destroy(pe_pool *pool, const pe_allocator *allocator)
{
    if (pool == NULL) {
        return;
    }
    atomic_store(&pool->stop, true);
    wake_sleepers(pool);
    for (int i = 1; i < pool->started; ++i) {
        pthread_join(pool->seats[i].thread, NULL);
    }
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->mutex);
    pe_release(allocator, pool->seats);
    pe_release(allocator, pool);
}

int pe_pool_threads(const pe_pool *pool)
{
    return pool != NULL ? pool->threads : 1;
}

static void open_loop(pe_pool *pool)
{
    for (int i = 0; i < pool->threads; ++i) {
        atomic_store_explicit(&pool->seats[i].next, share_of(pool, i), memory_order_relaxed);
    }
    atomic_fetch_add(&pool->loop, 1);
    wake_sleepers(pool);
    for (int i = 1; i < pool->threads && pool->tasks.run != NULL; ++i) {
        pool->seats[i].handle = pool->tasks.run(help, &pool->seats[i], pool->tasks.context);
    }
}

static void close_loop(pe_pool *pool)
{
    atomic_fetch_add(&pool->loop, 1);
    for (int i = 0; atomic_load(&pool->inside) > 0; ++i) {
        if (i < PATIENCE) {
            relax();
        } else {
            sched_yield();
        }
    }
    for (int i = 1; i < pool->threads && pool->tasks.run != NULL; ++i) {
        if (pool->seats[i].handle != NULL) {
            pool->tasks.wait(pool->seats[i].handle, pool->tasks.context);
        }
    }
}

void pe_pool_run_range(pe_pool *pool, int begin, int end, int grain, pe_piece *piece, void *context)
{
    if (pool == NULL || end - begin <= grain) {
        for (int i = begin; i < end; i = end_of(i, end, grain)) {
            piece(context, 0, i, end_of(i, end, grain));
        }
        return;
    }
    pool->piece = piece;
    pool->context = context;
    pool->begin = begin;
    pool->end = end;
    pool->grain = grain;
    pool->pieces = pe_piece_count(end - begin, grain);
    open_loop(pool);
    take_pieces(pool, 0);
    close_loop(pool);
}
