#include "parallel.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>

/* Small, since a limit on memory counts all of it. */
static const size_t STACK_SIZE = 1 << 20; /* bytes */

enum { MOST_THREADS = 64 };

typedef struct shared_work {
    void (*work)(void *context, int item);
    void *context;
    int count;
    atomic_int next; /* item to begin */
} shared_work;

static void *take_items(void *argument)
{
    shared_work *w = argument;
    for (int i = atomic_fetch_add(&w->next, 1); i < w->count; i = atomic_fetch_add(&w->next, 1)) {
        w->work(w->context, i);
    }
    return NULL;
}

void pl_share_work(int threads, int count, void (*work)(void *context, int item), void *context)
{
    shared_work w = {.work = work, .context = context, .count = count};
    pthread_t others[MOST_THREADS];
    const int most = threads < MOST_THREADS ? threads : MOST_THREADS;
    int started = 0;
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, STACK_SIZE);
    while (started < most - 1 && started < count - 1 &&
           pthread_create(&others[started], &attributes, take_items, &w) == 0) {
        started += 1;
    }
    pthread_attr_destroy(&attributes);
    (void)take_items(&w);
    for (int i = 0; i < started; ++i) {
        pthread_join(others[i], NULL);
    }
}

int pl_usable_cpus(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    const int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return count > 1 ? count : 1;
}
