/* Work on several threads. The results have the same bits for any number of threads where three rules
 * are kept: the number of items follows from counts of the data, an item writes memory of its own, and
 * what the items have found is put together in their order. */
#ifndef PLUMB_PARALLEL_H
#define PLUMB_PARALLEL_H

/* Calls work(context, item) once for each item from 0 to before `count`, in any order, on up to
 * `threads` threads, the caller's included. Returns when all calls have. Where the system has no more
 * threads to give, fewer share the work. Other threads exist only during the call. */
void pl_share_work(int threads, int count, void (*work)(void *context, int item), void *context);

/* The CPUs that this process may use (sched_getaffinity(2)), at least 1. */
int pl_usable_cpus(void);

#endif
