#include "session.h"

#include "base/hash.h"
#include "base/heap.h"

#include <stdlib.h>
#include <string.h>

/* ---- Hashes ---- */

static uint64_t hash_of(const pl_frame *frame)
{
    uint64_t hash = PL_HASH_START;
    for (int i = 0; i < frame->body_count; ++i) {
        const pl_body_state *s = &frame->bodies[i];
        hash = pl_hash_numbers(hash, s->position, 3);
        hash = pl_hash_numbers(hash, s->orientation, 4);
        hash = pl_hash_numbers(hash, s->velocity, 3);
        hash = pl_hash_numbers(hash, s->angular_velocity, 3);
    }
    return hash;
}

void pl_state_hashes_create(const pl_scene *scene, pl_state_hashes *hashes)
{
    const long states = pl_scene_steps(scene) + 1;
    *hashes = (pl_state_hashes){.count = 0};
    if (scene->same_bits) {
        hashes->step = pl_heap_new((size_t)states, sizeof *hashes->step);
    }
}

void pl_state_hashes_add(pl_state_hashes *hashes, const pl_frame *frame)
{
    if (hashes->step != NULL) {
        hashes->step[hashes->count++] = hash_of(frame);
    }
}

/* ---- The second run ---- */

static void compare_state(pl_session *session, const pl_state_hashes *first, long step,
                          pl_frame *frame, pl_difference *difference)
{
    pl_session_read_frame(session, frame);
    if (hash_of(frame) != first->step[step]) {
        difference->first = difference->steps == 0 ? step : difference->first;
        difference->steps += 1;
    }
}

pl_status pl_second_run(pl_session *session, const pl_scene *scene, const pl_state_hashes *first,
                        double cpu_limit, pl_frame *frame, pl_difference *difference,
                        pl_error *error)
{
    pl_call_cost cost[PL_CALL_GROUP_COUNT];
    *difference = (pl_difference){.steps = 0};
    memcpy(cost, session->cost, sizeof cost);
    memset(session->cost, 0, sizeof session->cost);
    pl_session_destroy(session);
    pl_status status = pl_session_create(session, scene, error);
    for (long step = 1;
         status == PL_OK && step < first->count && !pl_session_is_over_limit(session, cpu_limit);
         ++step) {
        pl_step_stats stats;
        status = pl_session_step(session, &stats, NULL, error);
        if (status == PL_OK) {
            compare_state(session, first, step, frame, difference);
        }
    }
    memcpy(session->cost, cost, sizeof cost);
    return status;
}
