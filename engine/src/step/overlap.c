/* Overlap: contacts so deep that it may be impossible to part their bodies. */
#include "correction.h"
#include "model/rest.h"

/* In units of the least half extent: deeper contacts count as overlap. */
static const double OVERLAP = 0.1;

/* Overlap that keeps more than this part of its depth is not being parted. */
static const double NO_HEADWAY = 0.99;

/* The smallest least half extent of the two bodies, in m, of those that can move. */
static double size_of(const pe_world *world, const pe_manifold *m)
{
    const pe_body *a = &pe_bodies(world)[m->a], *b = &pe_bodies(world)[m->b];
    return a->is_static ? b->size : b->is_static ? a->size : pe_min(a->size, b->size);
}

bool pe_overlaps(const pe_world *world, const pe_manifold *m)
{
    return m->least_separation < 0 && -m->least_separation > OVERLAP * size_of(world, m);
}

static bool is_static_or_waits(const pe_world *world, int slot)
{
    return pe_bodies(world)[slot].is_static || pe_records(world)[slot].parting.wait > 0;
}

bool pe_is_left_alone(const pe_world *world, const pe_manifold *m)
{
    return pe_overlaps(world, m) && is_static_or_waits(world, m->a) &&
           is_static_or_waits(world, m->b);
}

/* Which contacts of the world overlap. */
typedef struct look {
    const pe_world *world;
    bool *overlaps; /* (manifolds) */
} look;

enum { LOOK_GRAIN = 512 };

static void look_at_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    const look *l = context;
    for (int i = begin; i < end; ++i) {
        l->overlaps[i] = pe_overlaps(l->world, &pe_manifolds(&l->world->contacts)[i]);
    }
}

/* The overlap of each body (slots), in m; 0 where it has none, or is static. NULL: there is no memory. */
static double *find_overlap(pe_world *world)
{
    const pe_body *bodies = pe_bodies(world);
    const int count = world->contacts.manifold_count;
    double *depth = pe_scratch_zero(world, (size_t)world->slot_count, sizeof *depth);
    look l = {world, pe_scratch(world, (size_t)count + 1, sizeof *l.overlaps)};
    if (depth == NULL || l.overlaps == NULL) {
        return NULL;
    }
    pe_pool_run(world->pool, count, LOOK_GRAIN, look_at_manifolds, &l);
    for (int i = 0; i < count; ++i) {
        if (l.overlaps[i]) {
            const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
            const int slots[2] = {m->a, m->b};
            for (int k = 0; k < 2; ++k) {
                double most = pe_max(depth[slots[k]], -m->least_separation);
                depth[slots[k]] = bodies[slots[k]].is_static ? 0 : most;
            }
        }
    }
    return depth;
}

pe_status pe_overlap_begin(pe_step *step)
{
    size_t slots = (size_t)step->world->slot_count;
    step->overlap = find_overlap(step->world);
    return step->overlap != NULL ? PE_OK
                                 : pe_fail(step->error, PE_NO_MEMORY,
                                           "no memory for the overlap of %zu bodies", slots);
}

pe_status pe_overlap_end(pe_step *step)
{
    size_t slots = (size_t)step->world->slot_count;
    const double *now = find_overlap(step->world);
    if (now == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for the overlap of %zu bodies", slots);
    }
    for (int i = 0; i < pe_awake_count(step->world); ++i) {
        const int slot = pe_awake(step->world)[i];
        pe_backoff *b = &pe_records(step->world)[slot].parting;
        if (b->wait > 0) {
            *b = pe_backoff_less(*b);
        } else {
            bool in_vain = now[slot] > 0 && now[slot] > NO_HEADWAY * step->overlap[slot];
            *b = pe_backoff_after(in_vain, b->pause);
        }
        step->stats.overlapping += now[slot] > 0;
        step->stats.unparted += now[slot] > 0 && b->pause > 0;
    }
    return PE_OK;
}
