/* Kept patterns: a pool of equal parts, one per pattern, found by a hash of the pairs. */
#include "pattern_store.h"

#include <string.h>

/* All that a pattern depends on: three numbers per manifold. */
static void write_key(const pe_problem *problem, const bool *counted, int *key)
{
    for (int i = 0; i < problem->manifold_count; ++i) {
        key[3 * i] = problem->manifold[i].a;
        key[3 * i + 1] = problem->manifold[i].b;
        key[3 * i + 2] = counted[i];
    }
}

/* A part of the pool holds, one after the other: key (3 per manifold), order, place (bodies each),
 * start (bodies + 1), couple (manifolds), row (blocks). */
static pe_pattern pattern_in(const pe_kept_pattern *kept, const int *part, const bool *counted,
                             double mass_ratio)
{
    const int *order = part + 3 * kept->manifold_count;
    const int *place = order + kept->body_count, *start = place + kept->body_count;
    const int *couple = start + kept->body_count + 1, *row = couple + kept->manifold_count;
    return (pe_pattern){
        .count = kept->body_count,
        .order = order,
        .place = place,
        .start = start,
        .row = row,
        .couple = couple,
        .counted = counted,
        .depth = kept->depth,
        .mass_ratio = mass_ratio,
        .flops = kept->flops,
    };
}

static int *part_of(const pe_pattern_store *store, const pe_kept_pattern *kept)
{
    return (int *)store->pool.items + (size_t)(kept - store->kept) * store->room;
}

/* Makes room for patterns of `count` ints, and a half more. Growing forgets all patterns. */
static pe_status make_room(pe_pattern_store *store, size_t count, const pe_allocator *allocator,
                           pe_error *error)
{
    if (count <= store->room) {
        return PE_OK;
    }
    for (int i = 0; i < PE_KEPT_PATTERNS; ++i) {
        store->kept[i].used = 0;
    }
    size_t room = count + count / 2;
    pe_status status =
        pe_array_reserve(&store->pool, allocator, sizeof(int), PE_KEPT_PATTERNS * room, 0, error);
    store->room = status == PE_OK ? room : 0;
    return status;
}

static pe_status keep(pe_pattern_store *store, pe_kept_pattern *kept, const pe_allocator *allocator,
                      const int *key, const pe_problem *problem, const pe_pattern *pattern,
                      pe_error *error)
{
    size_t bodies = (size_t)problem->body_count, manifolds = (size_t)problem->manifold_count;
    size_t blocks = (size_t)pattern->start[bodies];
    pe_status status = make_room(store, 4 * manifolds + 3 * bodies + 1 + blocks, allocator, error);
    if (status != PE_OK) {
        return status;
    }
    int *to = part_of(store, kept);
    const struct {
        const int *from;
        size_t count;
    } parts[] = {
        {key, 3 * manifolds},         {pattern->order, bodies},     {pattern->place, bodies},
        {pattern->start, bodies + 1}, {pattern->couple, manifolds}, {pattern->row, blocks},
    };
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        memcpy(to, parts[i].from, parts[i].count * sizeof *to);
        to += parts[i].count;
    }
    kept->body_count = problem->body_count;
    kept->manifold_count = problem->manifold_count;
    kept->depth = pattern->depth;
    kept->flops = pattern->flops;
    return PE_OK;
}

pe_status pe_pattern_store_find(pe_pattern_store *store, const pe_problem *problem,
                                const bool *counted, pe_workspace work, pe_pattern *pattern,
                                pe_error *error)
{
    int numbers = 3 * problem->manifold_count;
    int *key = pe_take(work, (size_t)numbers + 1, sizeof *key);
    if (key == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d manifolds", problem->manifold_count);
    }
    write_key(problem, counted, key);
    uint64_t hash = pe_hash_ints(key, numbers);
    store->lookups += 1;
    pe_kept_pattern *oldest = &store->kept[0];
    for (int i = 0; i < PE_KEPT_PATTERNS; ++i) {
        pe_kept_pattern *kept = &store->kept[i];
        if (kept->used > 0 && kept->hash == hash && kept->body_count == problem->body_count &&
            kept->manifold_count == problem->manifold_count &&
            memcmp(part_of(store, kept), key, (size_t)numbers * sizeof *key) == 0) {
            kept->used = store->lookups;
            *pattern =
                pattern_in(kept, part_of(store, kept), counted, pe_pattern_mass_ratio(problem));
            return PE_OK;
        }
        oldest = kept->used < oldest->used ? kept : oldest;
    }
    pe_status status = pe_pattern_find(problem, counted, work, pattern, error);
    if (status == PE_OK) {
        status = keep(store, oldest, work.allocator, key, problem, pattern, error);
    }
    if (status == PE_OK) {
        oldest->hash = hash;
        oldest->used = store->lookups;
    }
    return status;
}

void pe_pattern_store_free(pe_pattern_store *store, const pe_allocator *allocator)
{
    pe_array_free(&store->pool, allocator);
}
