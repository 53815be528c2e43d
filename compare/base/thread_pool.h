/* Threads for work that is cut into pieces. The results have the same bits for any number of threads
 * where three rules are kept: the number of pieces follows from counts of the data, a piece writes
 * memory of its own, and what the pieces have found is put together in their order.
 *
 * Between two calls the threads sleep, and take no CPU time. */
#ifndef PLUMB_THREAD_POOL_H
#define PLUMB_THREAD_POOL_H

/* Threads that wait for work. */
typedef struct pl_thread_pool pl_thread_pool;

/* Starts `threads` - 1 threads: the caller's is one of them. NULL for fewer than 2, and where the
 * system has no more threads to give. */
pl_thread_pool *pl_thread_pool_create(int threads);

/* Ends the threads. `pool` may be NULL. */
void pl_thread_pool_destroy(pl_thread_pool *pool);

/* Cuts `count` items into pieces of `length`, the last of which may be shorter, and calls
 * work(context, begin, end) once for each piece, in any order, with its first item and the one after
 * its last. Returns when all calls have. Without a pool (NULL) this thread makes all calls, in
 * order. */
void pl_thread_pool_run(pl_thread_pool *pool, int count, int length,
                        void (*work)(void *context, int begin, int end), void *context);

/* The CPUs that this process may use (sched_getaffinity(2)), at least 1. */
int pl_usable_cpus(void);

#endif
