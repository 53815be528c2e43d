#include "modules.h"

#include <string.h>

struct pl_repeated_steps {
    const pl_scene *scene;
    pl_arena *arena;
    bool stood;             /* no state changed in the last step */
    pl_contact *contacts;   /* (count of capacity): of the last step */
    pl_contact_time *times; /* (count of time_capacity) */
    int count, capacity, time_capacity;
    bool has_times;
};

pl_repeated_steps *pl_repeated_steps_create(const pl_scene *scene, pl_arena *arena)
{
    pl_repeated_steps *r = pl_arena_take(arena, 1, sizeof *r);
    *r = (pl_repeated_steps){.scene = scene, .arena = arena};
    return r;
}

static bool same_contacts(const pl_repeated_steps *r, const pl_step *step)
{
    const size_t count = step->contact_count > 0 ? (size_t)step->contact_count : 0;
    return step->contact_count == r->count && (step->times != NULL) == r->has_times &&
           (count == 0 || memcmp(step->contacts, r->contacts, count * sizeof *r->contacts) == 0) &&
           (count == 0 || !r->has_times ||
            memcmp(step->times, r->times, count * sizeof *r->times) == 0);
}

static void keep(pl_repeated_steps *r, const pl_step *step)
{
    const int count = step->contact_count;
    r->count = count;
    r->has_times = step->times != NULL;
    if (count > 0) {
        pl_arena_reserve(r->arena, &r->contacts, &r->capacity, count, sizeof *r->contacts);
        memcpy(r->contacts, step->contacts, (size_t)count * sizeof *r->contacts);
    }
    if (count > 0 && r->has_times) {
        pl_arena_reserve(r->arena, &r->times, &r->time_capacity, count, sizeof *r->times);
        memcpy(r->times, step->times, (size_t)count * sizeof *r->times);
    }
}

bool pl_repeated_steps_see(pl_repeated_steps *r, const pl_step *step)
{
    const size_t size = (size_t)r->scene->body_count * sizeof *step->after;
    const bool stood = r->stood;
    r->stood = memcmp(step->before, step->after, size) == 0;
    if (stood && r->stood && same_contacts(r, step)) {
        return true;
    }
    if (r->stood) {
        keep(r, step);
    }
    return false;
}
