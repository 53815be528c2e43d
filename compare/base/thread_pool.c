#include "thread_pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

/* Small, since a limit on memory counts all of it. */
static const size_t STACK_SIZE = 1 << 20; /* bytes */

struct pl_thread_pool {
    pthread_mutex_t lock;
    pthread_cond_t has_work; /* or ends */
    pthread_cond_t is_done;
    pthread_t *threads; /* (count) */
    int count;
    /* Guarded by `lock`: */
    bool ends;
    unsigned long job; /* the number of the call */
    int busy;          /* threads that have not ended the present job */
    /* Written before a job begins: */
    int items, length, pieces;
    void (*work)(void *context, int begin, int end);
    void *context;
    atomic_int next; /* piece to begin */
};

static int end_of(int begin, int length, int count)
{
    return count - begin < length ? count : begin + length;
}

static void take_pieces(pl_thread_pool *pool)
{
    for (int i = atomic_fetch_add(&pool->next, 1); i < pool->pieces;
         i = atomic_fetch_add(&pool->next, 1)) {
        const int begin = i * pool->length;
        pool->work(pool->context, begin, end_of(begin, pool->length, pool->items));
    }
}

static void *work_until_end(void *argument)
{
    pl_thread_pool *pool = argument;
    unsigned long done = 0;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        while (!pool->ends && pool->job == done) {
            pthread_cond_wait(&pool->has_work, &pool->lock);
        }
        if (pool->ends) {
            break;
        }
        done = pool->job;
        pthread_mutex_unlock(&pool->lock);
        take_pieces(pool);
        pthread_mutex_lock(&pool->lock);
        pool->busy -= 1;
        if (pool->busy == 0) {
            pthread_cond_signal(&pool->is_done);
        }
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

pl_thread_pool *pl_thread_pool_create(int threads)
{
    pl_thread_pool *pool = threads < 2 ? NULL : calloc(1, sizeof *pool);
    if (pool == NULL) {
        return NULL;
    }
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, STACK_SIZE);
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->has_work, NULL);
    pthread_cond_init(&pool->is_done, NULL);
    atomic_init(&pool->next, 0);
    pool->threads = calloc((size_t)threads - 1, sizeof *pool->threads);
    while (pool->threads != NULL && pool->count < threads - 1 &&
           pthread_create(&pool->threads[pool->count], &attributes, work_until_end, pool) == 0) {
        pool->count += 1;
    }
    pthread_attr_destroy(&attributes);
    if (pool->count == 0) {
        pl_thread_pool_destroy(pool);
        return NULL;
    }
    return pool;
}

void pl_thread_pool_destroy(pl_thread_pool *pool)
{
    if (pool == NULL) {
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->ends = true;
    pthread_cond_broadcast(&pool->has_work);
    pthread_mutex_unlock(&pool->lock);
    for (int i = 0; i < pool->count; ++i) {
        pthread_join(pool->threads[i], NULL);
    }
    pthread_cond_destroy(&pool->is_done);
    pthread_cond_destroy(&pool->has_work);
    pthread_mutex_destroy(&pool->lock);
    free(pool->threads);
    free(pool);
}

void pl_thread_pool_run(pl_thread_pool *pool, int count, int length,
                        void (*work)(void *context, int begin, int end), void *context)
{
    if (pool == NULL || count <= length) {
        for (int begin = 0; begin < count; begin = end_of(begin, length, count)) {
            work(context, begin, end_of(begin, length, count));
        }
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->items = count;
    pool->length = length;
    pool->pieces = (count - 1) / length + 1;
    pool->work = work;
    pool->context = context;
    atomic_store(&pool->next, 0);
    pool->busy = pool->count;
    pool->job += 1;
    pthread_cond_broadcast(&pool->has_work);
    pthread_mutex_unlock(&pool->lock);
    take_pieces(pool);
    pthread_mutex_lock(&pool->lock);
    while (pool->busy > 0) {
        pthread_cond_wait(&pool->is_done, &pool->lock);
    }
    pthread_mutex_unlock(&pool->lock);
}

int pl_usable_cpus(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    const int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return count > 1 ? count : 1;
}
