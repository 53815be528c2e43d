#include "rest.h"

/* Islands that are gone stay in the arrays until these are longer than this many times what rests. */
enum { MOST_GARBAGE = 2 };

static pe_resting_island *islands_of(const pe_rest *rest)
{
    return rest->island_array.items;
}

static int *bodies_of(const pe_rest *rest)
{
    return rest->body_array.items;
}

static int *of_body(const pe_rest *rest)
{
    return rest->of_body_array.items;
}

/* Appends a manifold with its points to a list that has room for them. */
static void append_manifold(const pe_contacts *from, const pe_manifold *manifold, pe_contacts *to)
{
    pe_manifold *m = &pe_manifolds(to)[to->manifold_count++];
    const pe_manifold_point *points = pe_manifold_points(from) + manifold->first;
    *m = *manifold;
    m->first = to->point_count;
    memmove(pe_manifold_points(to) + m->first, points, (size_t)m->count * sizeof *points);
    to->point_count += m->count;
}

static pe_status reserve_contacts(const pe_world *world, pe_contacts *list, int manifolds,
                                  int points, pe_error *error)
{
    const size_t used_manifolds = (size_t)list->manifold_count;
    const size_t used_points = (size_t)list->point_count;
    pe_status status =
        pe_array_reserve(&list->manifold_array, &world->allocator, sizeof(pe_manifold),
                         used_manifolds + (size_t)manifolds, used_manifolds, error);
    return status != PE_OK
               ? status
               : pe_array_reserve(&list->point_array, &world->allocator, sizeof(pe_manifold_point),
                                  used_points + (size_t)points, used_points, error);
}

/* ---- Totals ---- */

static void add_to_totals(const pe_world *world, const pe_resting_island *island, pe_rest_totals *t)
{
    const pe_rest *rest = world->rest;
    const pe_record *record = &pe_records(world)[bodies_of(rest)[island->first_body]];
    int points = 0;
    for (int i = 0; i < island->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(&rest->contacts)[island->first_manifold + i];
        points += m->count;
        t->penetration = pe_max(t->penetration, -m->least_separation);
    }
    t->islands += 1;
    t->bodies += island->body_count;
    t->sleeping += island->sleeps ? island->body_count : 0;
    t->manifolds += island->manifold_count;
    t->points += points;
    t->residual = pe_max(t->residual, record->residual);
    t->squares += points * record->rms * record->rms;
}

static void sum_totals(const pe_world *world)
{
    pe_rest *rest = world->rest;
    pe_rest_totals totals = {0};
    for (int k = 0; k < rest->island_count; ++k) {
        const pe_resting_island *island = &islands_of(rest)[k];
        if (island->body_count > 0 && !island->wakes) {
            add_to_totals(world, island, &totals);
        }
    }
    rest->totals = totals;
}

/* ---- Bodies that are not at rest ---- */

pe_status pe_rest_list_awake(pe_world *world, pe_error *error)
{
    pe_rest *rest = world->rest;
    if (!rest->awake_stale) {
        return PE_OK;
    }
    pe_status status = pe_array_reserve(&rest->awake_array, &world->allocator, sizeof(int),
                                        (size_t)world->slot_count, 0, error);
    if (status != PE_OK) {
        return status;
    }
    const int *resting = pe_resting_of(world);
    int *awake = rest->awake_array.items;
    rest->awake_count = rest->movable_count = 0;
    for (int slot = 0; slot < world->slot_count; ++slot) {
        const bool rests = slot < rest->slot_count && pe_rests(resting, slot);
        if (!rests && pe_bodies(world)[slot].alive) {
            awake[rest->awake_count++] = slot;
            rest->movable_count += !pe_bodies(world)[slot].is_static;
        }
    }
    rest->awake_stale = false;
    return PE_OK;
}

/* ---- Beginning of a step ---- */

/* Moves what rests to the front of the arrays. */
static void compact(pe_world *world)
{
    pe_rest *rest = world->rest;
    int kept = 0;
    rest->body_count = 0;
    const pe_contacts all = rest->contacts;
    rest->contacts.manifold_count = rest->contacts.point_count = 0;
    for (int k = 0; k < rest->island_count; ++k) {
        pe_resting_island island = islands_of(rest)[k];
        if (island.body_count == 0) {
            continue;
        }
        const int *slots = bodies_of(rest) + island.first_body;
        const pe_manifold *manifolds = pe_manifolds(&all) + island.first_manifold;
        island.first_body = rest->body_count;
        island.first_manifold = rest->contacts.manifold_count;
        island.first_point = rest->contacts.point_count;
        for (int i = 0; i < island.body_count; ++i) {
            of_body(rest)[slots[i]] = 1 + kept;
            bodies_of(rest)[rest->body_count++] = slots[i];
        }
        for (int i = 0; i < island.manifold_count; ++i) {
            append_manifold(&all, &manifolds[i], &rest->contacts);
        }
        islands_of(rest)[kept++] = island;
    }
    rest->island_count = kept;
}

pe_status pe_rest_begin(pe_world *world, double dt, pe_error *error)
{
    pe_rest *rest = world->rest;
    const size_t slots = (size_t)world->slot_count, used = (size_t)rest->slot_count;
    pe_status status =
        pe_array_reserve(&rest->of_body_array, &world->allocator, sizeof(int), slots, used, error);
    if (status == PE_OK) {
        status =
            pe_array_reserve(&rest->woken_array, &world->allocator, sizeof(int), slots, 0, error);
    }
    if (status != PE_OK) {
        return status;
    }
    memset(of_body(rest) + used, 0, (slots - used) * sizeof(int));
    rest->slot_count = world->slot_count;
    rest->woken_count = 0;
    rest->time += dt;
    for (int k = 0; k < rest->island_count && rest->changed; ++k) {
        pe_resting_island *island = &islands_of(rest)[k];
        island->is_new = false;
        if (island->wakes) {
            island->body_count = island->manifold_count = 0;
        }
    }
    rest->changed = false;
    pe_contacts_trim(&world->previous, world->contacts.manifold_count, &world->allocator);
    if (rest->contacts.manifold_count > MOST_GARBAGE * rest->totals.manifolds) {
        compact(world);
    }
    return pe_rest_list_awake(world, error);
}

/* ---- Coming to rest ---- */

/* The island at rest that a manifold of world->contacts belongs to; NULL: none. */
static pe_resting_island *island_of(const pe_rest *rest, const pe_manifold *m)
{
    const int index = of_body(rest)[m->a] != 0 ? of_body(rest)[m->a] : of_body(rest)[m->b];
    return index != 0 ? &islands_of(rest)[index - 1] : NULL;
}

/* Appends the chosen islands, without contacts. */
static pe_status add_bodies(pe_world *world, const pe_islands *islands,
                            const pe_rest_choice *choices, pe_error *error)
{
    pe_rest *rest = world->rest;
    const size_t old_islands = (size_t)rest->island_count, old_bodies = (size_t)rest->body_count;
    size_t count = 0, bodies = 0;
    for (int k = 0; k < islands->count; ++k) {
        count += choices[k].rests;
        bodies +=
            choices[k].rests ? (size_t)(islands->body_start[k + 1] - islands->body_start[k]) : 0;
    }
    pe_status status =
        pe_array_reserve(&rest->island_array, &world->allocator, sizeof(pe_resting_island),
                         old_islands + count, old_islands, error);
    if (status == PE_OK) {
        status = pe_array_reserve(&rest->body_array, &world->allocator, sizeof(int),
                                  old_bodies + bodies, old_bodies, error);
    }
    for (int k = 0; k < islands->count && status == PE_OK; ++k) {
        if (choices[k].rests) {
            pe_resting_island *island = &islands_of(rest)[rest->island_count++];
            *island = (pe_resting_island){.first_body = rest->body_count,
                                          .speed = choices[k].sleeps ? choices[k].speed : 0,
                                          .since = rest->time,
                                          .sleeps = choices[k].sleeps,
                                          .is_new = true};
            for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
                of_body(rest)[islands->bodies[i]] = rest->island_count;
                bodies_of(rest)[rest->body_count++] = islands->bodies[i];
                island->body_count += 1;
            }
        }
    }
    return status;
}

static void take_bodies_back(pe_rest *rest, int first)
{
    for (int i = islands_of(rest)[first].first_body; i < rest->body_count; ++i) {
        of_body(rest)[bodies_of(rest)[i]] = 0;
    }
    rest->body_count = islands_of(rest)[first].first_body;
    rest->island_count = first;
}

/* Makes room for the contacts of the islands from `first` on, each after the one before. Leaves their
 * counts at 0. */
static pe_status place_contacts(pe_world *world, int first, pe_error *error)
{
    pe_rest *rest = world->rest;
    const pe_contacts *contacts = &world->contacts;
    int manifolds = 0, points = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        pe_resting_island *island = island_of(rest, m);
        if (island != NULL) {
            island->manifold_count += 1;
            island->point_count += m->count;
            manifolds += 1;
            points += m->count;
        }
    }
    pe_status status = reserve_contacts(world, &rest->contacts, manifolds, points, error);
    if (status == PE_OK) {
        world->previous.manifold_count = world->previous.point_count = 0;
        status = reserve_contacts(world, &world->previous, contacts->manifold_count - manifolds,
                                  contacts->point_count - points, error);
    }
    for (int k = first; k < rest->island_count && status == PE_OK; ++k) {
        pe_resting_island *island = &islands_of(rest)[k];
        island->first_manifold = rest->contacts.manifold_count;
        island->first_point = rest->contacts.point_count;
        rest->contacts.manifold_count += island->manifold_count;
        rest->contacts.point_count += island->point_count;
        island->manifold_count = island->point_count = 0;
    }
    return status;
}

/* Moves the manifolds of bodies at rest from world->contacts to the places of their islands. Those of an
 * island come in order. */
static void move_contacts(pe_world *world)
{
    pe_rest *rest = world->rest;
    const pe_contacts *contacts = &world->contacts;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        pe_resting_island *island = island_of(rest, m);
        if (island == NULL) {
            append_manifold(contacts, m, &world->previous);
        } else {
            pe_contacts to = {rest->contacts.manifold_array, rest->contacts.point_array,
                              island->first_manifold + island->manifold_count,
                              island->first_point + island->point_count};
            append_manifold(contacts, m, &to);
            island->manifold_count += 1;
            island->point_count += m->count;
        }
    }
    pe_contacts_swap(&world->contacts, &world->previous);
}

pe_status pe_rest_add(pe_world *world, const pe_islands *islands, const pe_rest_choice *choices,
                      pe_error *error)
{
    pe_rest *rest = world->rest;
    const int first = rest->island_count;
    pe_status status = add_bodies(world, islands, choices, error);
    if (status != PE_OK) {
        return status;
    }
    status = place_contacts(world, first, error);
    if (status != PE_OK) {
        take_bodies_back(rest, first);
        return status;
    }
    rest->changed = rest->awake_stale = true;
    move_contacts(world);
    for (int k = first; k < rest->island_count; ++k) {
        add_to_totals(world, &islands_of(rest)[k], &rest->totals);
    }
    return PE_OK;
}

/* ---- Waking ---- */

void pe_rest_mark(pe_world *world, int slot)
{
    const int *resting = pe_resting_of(world);
    if (pe_rests(resting, slot)) {
        islands_of(world->rest)[resting[slot] - 1].wakes = world->rest->changed = true;
    }
}

void pe_rest_mark_all(pe_world *world)
{
    for (int k = 0; k < world->rest->island_count; ++k) {
        islands_of(world->rest)[k].wakes = world->rest->changed = true;
    }
}

/* A counting sort of manifolds by one of their bodies, which keeps the order of equal ones. `start`
 * (slots + 1) is scratch. */
static void sort_by_body(const pe_manifold *manifolds, bool by_b, const int *from, int count,
                         int slots, int *start, int *to)
{
    memset(start, 0, ((size_t)slots + 1) * sizeof *start);
    for (int i = 0; i < count; ++i) {
        const pe_manifold *m = &manifolds[from[i]];
        start[1 + (by_b ? m->b : m->a)] += 1;
    }
    for (int slot = 0; slot < slots; ++slot) {
        start[slot + 1] += start[slot];
    }
    for (int i = 0; i < count; ++i) {
        const pe_manifold *m = &manifolds[from[i]];
        to[start[by_b ? m->b : m->a]++] = from[i];
    }
}

/* What waking needs: the manifolds of the islands that wake. */
typedef struct waking {
    int islands, manifolds, points;
    int *listed; /* (manifolds): indices into the contacts at rest, sorted by (a, b) */
    int *first;  /* (manifolds): their first points in world->contacts */
    int *start, *sorted;
} waking;

/* Whether the island is to be woken, and has not been. */
static bool is_waking(const pe_rest *rest, int k)
{
    const pe_resting_island *island = &islands_of(rest)[k];
    return island->wakes && island->body_count > 0 &&
           of_body(rest)[bodies_of(rest)[island->first_body]] == k + 1;
}

static waking count_waking(const pe_rest *rest)
{
    waking w = {0};
    for (int k = 0; k < rest->island_count; ++k) {
        if (is_waking(rest, k)) {
            const pe_resting_island *island = &islands_of(rest)[k];
            w.islands += 1;
            w.manifolds += island->manifold_count;
            for (int i = 0; i < island->manifold_count; ++i) {
                w.points += pe_manifolds(&rest->contacts)[island->first_manifold + i].count;
            }
        }
    }
    return w;
}

static void list_manifolds(const pe_world *world, waking *w)
{
    const pe_rest *rest = world->rest;
    const pe_manifold *manifolds = pe_manifolds(&rest->contacts);
    int count = 0;
    for (int k = 0; k < rest->island_count; ++k) {
        const pe_resting_island *island = &islands_of(rest)[k];
        for (int i = 0; is_waking(rest, k) && i < island->manifold_count; ++i) {
            w->listed[count++] = island->first_manifold + i;
        }
    }
    if (w->islands > 1) {
        sort_by_body(manifolds, true, w->listed, count, world->slot_count, w->start, w->sorted);
        sort_by_body(manifolds, false, w->sorted, count, world->slot_count, w->start, w->listed);
    }
}

/* Appends the points of the listed manifolds to world->contacts, which has room for them. */
static void copy_points(pe_world *world, const waking *w)
{
    const pe_contacts *from = &world->rest->contacts;
    pe_contacts *to = &world->contacts;
    for (int j = 0; j < w->manifolds; ++j) {
        const pe_manifold *m = &pe_manifolds(from)[w->listed[j]];
        w->first[j] = to->point_count;
        memcpy(pe_manifold_points(to) + to->point_count, pe_manifold_points(from) + m->first,
               (size_t)m->count * sizeof(pe_manifold_point));
        to->point_count += m->count;
    }
}

/* Merges the listed manifolds into world->contacts, from behind. */
static void merge_manifolds(pe_world *world, const waking *w)
{
    const pe_manifold *from = pe_manifolds(&world->rest->contacts);
    pe_manifold *to = pe_manifolds(&world->contacts);
    int i = world->contacts.manifold_count - 1, j = w->manifolds - 1;
    world->contacts.manifold_count += w->manifolds;
    for (int at = world->contacts.manifold_count - 1; j >= 0; --at) {
        const pe_manifold *woken = &from[w->listed[j]];
        if (i >= 0 && (to[i].a > woken->a || (to[i].a == woken->a && to[i].b > woken->b))) {
            to[at] = to[i--];
        } else {
            to[at] = *woken;
            to[at].first = w->first[j--];
        }
    }
}

static void wake_bodies(pe_rest *rest)
{
    for (int k = 0; k < rest->island_count; ++k) {
        const pe_resting_island *island = &islands_of(rest)[k];
        if (is_waking(rest, k)) {
            rest->sleep_drift =
                pe_max(rest->sleep_drift, island->speed * (rest->time - island->since));
            for (int i = island->body_count - 1; i >= 0; --i) {
                const int slot = bodies_of(rest)[island->first_body + i];
                of_body(rest)[slot] = 0;
                ((int *)rest->woken_array.items)[rest->woken_count++] = slot;
            }
        }
    }
}

pe_status pe_rest_wake(pe_world *world, pe_error *error)
{
    waking w = count_waking(world->rest);
    if (w.islands == 0) {
        return PE_OK;
    }
    const size_t count = (size_t)w.manifolds + 1;
    w.listed = pe_scratch(world, count, sizeof(int));
    w.first = pe_scratch(world, count, sizeof(int));
    w.sorted = pe_scratch(world, count, sizeof(int));
    w.start = pe_scratch(world, (size_t)world->slot_count + 1, sizeof(int));
    if (pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to wake %d islands", w.islands);
    }
    pe_status status = reserve_contacts(world, &world->contacts, w.manifolds, w.points, error);
    if (status == PE_OK) {
        list_manifolds(world, &w);
        copy_points(world, &w);
        merge_manifolds(world, &w);
        wake_bodies(world->rest);
        sum_totals(world);
        world->rest->awake_stale = true;
        status = pe_rest_list_awake(world, error);
    }
    return status;
}

pe_status pe_rest_wake_touched(pe_world *world, pe_error *error)
{
    const int *resting = pe_resting_of(world);
    bool any = false;
    for (int i = 0; resting != NULL && i < world->contacts.manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
        if (resting[m->a] != 0 || resting[m->b] != 0) {
            pe_rest_mark(world, m->a);
            pe_rest_mark(world, m->b);
            any = true;
        }
    }
    return any ? pe_rest_wake(world, error) : PE_OK;
}

void pe_rest_forget(pe_world *world, int slot)
{
    const int *resting = pe_resting_of(world);
    pe_rest *rest = world->rest;
    /* A body of a later slot is new: pe_rest_begin has not made room for it yet. */
    if (slot >= rest->slot_count || !pe_rests(resting, slot)) {
        return;
    }
    pe_resting_island *island = &islands_of(rest)[resting[slot] - 1];
    /* Null where no body at rest has a contact. */
    pe_manifold *manifolds = pe_manifolds(&rest->contacts);
    const int first = island->first_manifold;
    int *bodies = bodies_of(rest) + island->first_body;
    int kept = 0, left = 0;
    for (int i = 0; i < island->manifold_count; ++i) {
        const pe_manifold *manifold = &manifolds[first + i];
        if (manifold->a != slot && manifold->b != slot) {
            manifolds[first + kept++] = *manifold;
        }
    }
    for (int i = 0; i < island->body_count; ++i) {
        if (bodies[i] != slot) {
            bodies[left++] = bodies[i];
        }
    }
    island->manifold_count = kept;
    island->body_count = left;
    of_body(rest)[slot] = 0;
    rest->awake_stale = true;
    rest->totals.islands -= left == 0;
}

void pe_rest_free(pe_rest *rest, const pe_allocator *allocator)
{
    pe_array *arrays[] = {&rest->island_array, &rest->body_array, &rest->of_body_array,
                          &rest->woken_array, &rest->awake_array};
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i) {
        pe_array_free(arrays[i], allocator);
    }
    pe_contacts_free(&rest->contacts, allocator);
}
