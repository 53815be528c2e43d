/* Blocks of manifolds in the order of their colours, and how threads share them. */
#ifndef PE_STAGES_H
#define PE_STAGES_H

#include "base/pool.h"

/* Blocks begin .. end - 1. Threads share them if they are of one colour and many. */
typedef struct pe_stage {
    int begin, end;
    bool shared;
} pe_stage;

enum { PE_COLOURS = 64, PE_MOST_STAGES = PE_COLOURS + 1 };

/* The stages of a sweep, in turn. All zero is none. */
typedef struct pe_stages {
    int count;
    pe_stage of[PE_MOST_STAGES];
} pe_stages;

/* Appends a stage. Stages that are not shared join, so that at most one of them follows each of up to
 * PE_COLOURS colours. */
static inline void pe_stages_add(pe_stages *stages, int begin, int end, bool shared)
{
    pe_stage *last = stages->count > 0 ? &stages->of[stages->count - 1] : NULL;
    if (last != NULL && !shared && !last->shared) {
        last->end = end;
    } else if (begin < end) {
        stages->of[stages->count++] = (pe_stage){begin, end, shared};
    }
}

/* Works on all blocks, stage by stage; the threads of the pool share a stage in pieces of `grain`. */
static inline void pe_stages_run(const pe_stages *stages, pe_pool *pool, int grain, pe_piece *piece,
                                 void *context)
{
    for (int i = 0; i < stages->count; ++i) {
        const pe_stage *s = &stages->of[i];
        const bool whole = pool == NULL || !s->shared;
        pe_pool_run_range(pool, s->begin, s->end, whole ? s->end - s->begin : grain, piece,
                          context);
    }
}

#endif
