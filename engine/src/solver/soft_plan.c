#include "soft_plan.h"

#include <string.h>

enum {
    COLOURS = 64,               /* bits of a mask; the last one is serial */
    KINDS = 4 * PE_SOFT_POINTS, /* points x hard x rough */
    BATCHES = COLOURS * KINDS
};

/* Position of the lowest bit that is 0, or of the last when there is none. In walls and piles it is
 * nearly always below 8. */
static int lowest_free(uint64_t mask)
{
    int colour = 0;
    while (colour < COLOURS - 1 && (mask >> colour & 1)) {
        ++colour;
    }
    return colour;
}

/* The batch of a contact: colour by colour, most points first. */
static int batch_of(int colour, const pe_soft_contact *contact, bool rough)
{
    bool hard = contact->a == 0 || contact->b == 0;
    return colour * KINDS + 4 * (PE_SOFT_POINTS - contact->count) + 2 * hard + rough;
}

/* In how many contacts a manifold is solved. */
static int parts_of(const pe_manifold *m)
{
    return (m->count + PE_SOFT_POINTS - 1) / PE_SOFT_POINTS;
}

/* The plan while it is made: contacts in the manifolds' order. */
typedef struct draft {
    const pe_solver_bodies *lines;
    uint64_t *mask; /* (lines): colours that each body has */
    pe_soft_contact *contacts;
    int *batch; /* where each goes */
} draft;

static void add_manifold(const pe_world *world, int index, const draft *d, pe_soft_plan *plan)
{
    const pe_manifold *m = &pe_manifolds(&world->contacts)[index];
    int a = d->lines->index_of[m->a], b = d->lines->index_of[m->b], parts = parts_of(m);
    for (int part = 0; part < parts; ++part) {
        pe_soft_contact *contact = &d->contacts[plan->count];
        *contact = (pe_soft_contact){.manifold = index, .a = a, .b = b};
        /* Points in turn, so that each part spans the whole. */
        for (int j = part; j < m->count; j += parts) {
            contact->point[contact->count++] = m->first + j;
        }
        int colour = lowest_free(d->mask[a] | d->mask[b]);
        d->mask[a] |= (uint64_t)(a != 0) << colour;
        d->mask[b] |= (uint64_t)(b != 0) << colour;
        d->batch[plan->count++] = batch_of(colour, contact, m->friction > 0);
        plan->colours = colour >= plan->colours ? colour + 1 : plan->colours;
        plan->points += contact->count;
    }
    plan->bounces = plan->bounces || m->restitution > 0;
}

/* A counting sort of the contacts by batch, which keeps their order within one. */
static void sort_into_batches(const draft *d, pe_soft_plan *plan)
{
    int size[BATCHES] = {0}, next[BATCHES];
    for (int i = 0; i < plan->count; ++i) {
        size[d->batch[i]] += 1;
    }
    int first = 0;
    for (int q = 0; q < plan->colours * KINDS; ++q) {
        next[q] = first;
        if (size[q] > 0) {
            plan->batches[plan->batch_count++] = (pe_soft_batch){
                .first = first,
                .count = size[q],
                .points = PE_SOFT_POINTS - q % KINDS / 4,
                .hard = q / 2 % 2 == 1,
                .rough = q % 2 == 1,
                .serial = q / KINDS == COLOURS - 1,
            };
            first += size[q];
        }
    }
    for (int i = 0; i < plan->count; ++i) {
        plan->contacts[next[d->batch[i]]++] = d->contacts[i];
    }
}

pe_status pe_soft_plan_make(pe_world *world, const pe_islands *islands, const bool *chosen,
                            const pe_solver_bodies *lines, pe_soft_plan *plan, pe_error *error)
{
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    size_t count = 0;
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->start[k]; chosen[k] && i < islands->start[k + 1]; ++i) {
            count += (size_t)parts_of(&manifolds[islands->manifolds[i]]);
        }
    }
    *plan = (pe_soft_plan){
        .contacts = pe_scratch(world, count + 1, sizeof *plan->contacts),
        .batches = pe_scratch(world, BATCHES, sizeof *plan->batches),
    };
    draft d = {
        .lines = lines,
        .mask = pe_scratch(world, (size_t)lines->count, sizeof *d.mask),
        .contacts = pe_scratch(world, count + 1, sizeof *d.contacts),
        .batch = pe_scratch(world, count + 1, sizeof *d.batch),
    };
    if (plan->contacts == NULL || plan->batches == NULL || d.mask == NULL || d.contacts == NULL ||
        d.batch == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the order of %zu contacts", count);
    }
    memset(d.mask, 0, (size_t)lines->count * sizeof *d.mask);
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->start[k]; chosen[k] && i < islands->start[k + 1]; ++i) {
            add_manifold(world, islands->manifolds[i], &d, plan);
        }
    }
    sort_into_batches(&d, plan);
    return PE_OK;
}
