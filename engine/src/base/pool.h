/* Threads that share the pieces of a loop.
 *
 * What a loop computes does not depend on the number of threads: it is cut by counts of items alone,
 * each piece writes what no other piece reads or writes, except for atomic flags that any of them may
 * set, and sums are gathered in the order of the pieces. */
#ifndef PE_POOL_H
#define PE_POOL_H

#include "memory.h"

/* Does items begin .. end - 1. Pieces with the same `worker`, which is below the number of threads,
 * never run at the same time. */
typedef void pe_piece(void *context, int worker, int begin, int end);

/* Starts threads - 1 threads, or none if the def has a task system. The pool is the caller's to
 * destroy; NULL if the def asks for one thread. The settings must have been checked. PE_NO_MEMORY
 * where there is no memory or no thread for it. */
pe_status pe_pool_create(const pe_world_def *def, const pe_allocator *allocator, pe_pool **pool,
                         pe_error *error);

/* Ends the threads. NULL is allowed. */
void pe_pool_destroy(pe_pool *pool, const pe_allocator *allocator);

/* The number of threads, the calling one included. */
int pe_pool_threads(const pe_pool *pool);

/* The number of pieces of `grain` items, the last one of fewer, that `count` items make. */
static inline int pe_piece_count(int count, int grain)
{
    return (count + grain - 1) / grain;
}

/* Calls piece for all of begin .. end - 1 in pieces of `grain` items, in any order and by any of the
 * threads, and returns when all are done. The caller is worker 0. It is called by the thread that
 * steps the world, and not from within a piece. */
void pe_pool_run_range(pe_pool *pool, int begin, int end, int grain, pe_piece *piece,
                       void *context);

/* The same for 0 .. count - 1. */
static inline void pe_pool_run(pe_pool *pool, int count, int grain, pe_piece *piece, void *context)
{
    pe_pool_run_range(pool, 0, count, grain, piece, context);
}

/* Of loops that leave a sum for each piece: the most pieces, and the least items of one. */
enum { PE_MOST_SUMS = 64, PE_LEAST_SUMMED = 512 };

/* The items of a piece of such a loop. */
static inline int pe_sum_grain(int count)
{
    const int least = pe_piece_count(count, PE_MOST_SUMS);
    return least < PE_LEAST_SUMMED ? PE_LEAST_SUMMED : least;
}

#endif
