#include "island.h"

#include "rest.h"

/* Gaps up to this, in m, are closed. */
static const double TOUCHING = 1e-6;

/* Every visited link is cut in half (Tarjan and van Leeuwen 1984). */
int pe_root_of(int *parent, int item)
{
    while (parent[item] != item) {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    return item;
}

void pe_join_roots(int *parent, int a, int b)
{
    int p = pe_root_of(parent, a), q = pe_root_of(parent, b);
    parent[p > q ? p : q] = p < q ? p : q;
}

void pe_islands_take(pe_world *world, size_t manifolds, pe_islands *islands)
{
    size_t slots = (size_t)world->slot_count;
    *islands = (pe_islands){
        .start = pe_scratch(world, slots + 1, sizeof(int)),
        .manifolds = pe_scratch(world, manifolds + 1, sizeof(int)),
        .body_start = pe_scratch(world, slots + 1, sizeof(int)),
        .bodies = pe_scratch(world, slots, sizeof(int)),
        .place = pe_scratch(world, slots, sizeof(int)),
    };
}

/* Lists items by their group, in the given order in each, with group -1 left out. The items are those of
 * `listed` (count), or if that is NULL 0 .. count - 1. Fills start (groups + 1). */
static void sort_by_group(const int *group, const int *listed, int count, int groups, int *start,
                          int *sorted)
{
    memset(start, 0, ((size_t)groups + 1) * sizeof(int));
    for (int i = 0; i < count; ++i) {
        const int of = group[listed != NULL ? listed[i] : i];
        if (of >= 0) {
            start[of + 1] += 1;
        }
    }
    for (int k = 0; k < groups; ++k) {
        start[k + 1] += start[k];
    }
    for (int i = 0; i < count; ++i) {
        const int item = listed != NULL ? listed[i] : i;
        if (group[item] >= 0) {
            sorted[start[group[item]]++] = item;
        }
    }
    /* Each start has walked to its group's end: move them back. */
    for (int k = groups; k > 0; --k) {
        start[k] = start[k - 1];
    }
    start[0] = 0;
}

/* The bodies of a manifold that can move: if it is one, both are the same; -1: the manifold joins none. */
typedef struct link {
    int a, b;
} link;

/* Whether a manifold joins its bodies. */
typedef bool joining(const pe_contacts *contacts, const pe_manifold *m);

/* The links of a list of contacts. */
typedef struct linking {
    const pe_body *bodies;
    const pe_contacts *contacts;
    joining *joins; /* NULL: all do */
    link *links;    /* (manifolds) */
} linking;

enum { LINK_GRAIN = 512 };

static void find_links(void *context, int worker, int begin, int end)
{
    (void)worker;
    const linking *l = context;
    for (int i = begin; i < end; ++i) {
        const pe_manifold *m = &pe_manifolds(l->contacts)[i];
        const bool joins = l->joins == NULL || l->joins(l->contacts, m);
        l->links[i] = !joins                      ? (link){-1, -1}
                      : l->bodies[m->a].is_static ? (link){m->b, m->b}
                      : l->bodies[m->b].is_static ? (link){m->a, m->a}
                                                  : (link){m->a, m->b};
    }
}

/* The links of all manifolds; NULL: there is no memory. Joins the roots of their bodies. */
static link *join_all(pe_world *world, const pe_contacts *contacts, joining *joins, int *parent)
{
    linking l = {pe_bodies(world), contacts, joins,
                 pe_scratch(world, (size_t)contacts->manifold_count + 1, sizeof(link))};
    if (l.links != NULL) {
        pe_pool_run(world->pool, contacts->manifold_count, LINK_GRAIN, find_links, &l);
        for (int i = 0; i < contacts->manifold_count; ++i) {
            if (l.links[i].a != l.links[i].b) {
                pe_join_roots(parent, l.links[i].a, l.links[i].b);
            }
        }
    }
    return l.links;
}

/* Makes every body a root without a number. */
static void make_roots(const pe_world *world, int *parent, int *number)
{
    for (int i = 0; i < pe_awake_count(world); ++i) {
        const int slot = pe_awake(world)[i];
        parent[slot] = slot;
        number[slot] = -1;
    }
}

/* Fills the lists of bodies from the numbers of the roots. */
static void list_bodies(const pe_world *world, int *parent, const int *number, pe_islands *islands)
{
    /* Static bodies are roots of themselves without a contact: number -1. */
    int *island_of_body = islands->place;
    const int *awake = pe_awake(world);
    const int count = pe_awake_count(world);
    for (int i = 0; i < count; ++i) {
        island_of_body[awake[i]] = number[pe_root_of(parent, awake[i])];
    }
    sort_by_group(island_of_body, awake, count, islands->count, islands->body_start,
                  islands->bodies);
    memset(islands->place, -1, (size_t)world->slot_count * sizeof *islands->place);
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
            islands->place[islands->bodies[i]] = i - islands->body_start[k];
        }
    }
}

pe_status pe_islands_find(pe_world *world, pe_islands *islands, pe_error *error)
{
    size_t slots = (size_t)world->slot_count;
    int count = world->contacts.manifold_count;
    int *parent = pe_scratch(world, slots, sizeof *parent);
    int *number = pe_scratch(world, slots, sizeof *number);
    int *island_of = pe_scratch(world, (size_t)count + 1, sizeof *island_of);
    pe_islands_take(world, (size_t)count, islands);
    if (pe_rest_list_awake(world, error) != PE_OK || pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the islands of %zu bodies", slots);
    }
    make_roots(world, parent, number);
    const link *links = join_all(world, &world->contacts, NULL, parent);
    if (links == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the islands of %zu bodies", slots);
    }
    /* Mark the roots that have contacts and number them in order. */
    for (int i = 0; i < count; ++i) {
        island_of[i] = pe_root_of(parent, links[i].a);
        number[island_of[i]] = 0;
    }
    for (int i = 0; i < pe_awake_count(world); ++i) {
        const int slot = pe_awake(world)[i];
        number[slot] = number[slot] == 0 ? islands->count++ : -1;
    }
    for (int i = 0; i < count; ++i) {
        island_of[i] = number[island_of[i]];
    }
    sort_by_group(island_of, NULL, count, islands->count, islands->start, islands->manifolds);
    list_bodies(world, parent, number, islands);
    return PE_OK;
}

/* The part of each body and of each manifold, by place in the island; -1: in none. The number of
 * parts. */
static int number_parts(const pe_world *world, const pe_islands *whole, int k, int *parent,
                        int *of_body, int *of_manifold)
{
    int bodies = whole->body_start[k + 1] - whole->body_start[k], count = 0;
    for (int i = 0; i < bodies; ++i) { /* a root comes before the rest of its tree */
        int root = pe_root_of(parent, i);
        of_body[i] = root == i ? count++ : of_body[root];
    }
    for (int j = whole->start[k]; j < whole->start[k + 1]; ++j) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[whole->manifolds[j]];
        int a = whole->place[m->a], b = whole->place[m->b];
        int part = of_body[a < 0 ? b : a];
        of_manifold[j - whole->start[k]] = b < 0 || of_body[b] == part ? part : -1;
    }
    return count;
}

/* Sorts the items by their part; what is sorted are their numbers in the world. */
static void list_parts(const int *part, int count, const int *number, int parts, int *start,
                       int *listed)
{
    sort_by_group(part, NULL, count, parts, start, listed);
    for (int i = 0; i < start[parts]; ++i) {
        listed[i] = number[listed[i]];
    }
}

pe_status pe_islands_divide(pe_world *world, const pe_islands *whole, int k, int *parent,
                            pe_islands *parts, pe_error *error)
{
    const int *bodies = whole->bodies + whole->body_start[k];
    const int *manifolds = whole->manifolds + whole->start[k];
    int body_count = whole->body_start[k + 1] - whole->body_start[k];
    int manifold_count = whole->start[k + 1] - whole->start[k];
    int *of_body = pe_scratch(world, (size_t)body_count, sizeof *of_body);
    int *of_manifold = pe_scratch(world, (size_t)manifold_count + 1, sizeof *of_manifold);
    pe_islands_take(world, (size_t)manifold_count, parts);
    if (pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the parts of %d bodies", body_count);
    }
    parts->count = number_parts(world, whole, k, parent, of_body, of_manifold);
    list_parts(of_manifold, manifold_count, manifolds, parts->count, parts->start,
               parts->manifolds);
    list_parts(of_body, body_count, bodies, parts->count, parts->body_start, parts->bodies);
    for (int j = 0; j < manifold_count; ++j) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[manifolds[j]];
        parts->place[m->a] = parts->place[m->b] = -1; /* static bodies stay so */
    }
    for (int p = 0; p < parts->count; ++p) {
        for (int i = parts->body_start[p]; i < parts->body_start[p + 1]; ++i) {
            parts->place[parts->bodies[i]] = i - parts->body_start[p];
        }
    }
    return PE_OK;
}

static bool touches(const pe_contacts *contacts, const pe_manifold *m)
{
    (void)contacts;
    return m->least_separation <= TOUCHING;
}

static bool pushed(const pe_contacts *contacts, const pe_manifold *m)
{
    for (int j = m->first; j < m->first + m->count; ++j) {
        pe_vec3 p = pe_manifold_points(contacts)[j].impulse;
        if (pe_dot(p, m->normal) > 0) {
            return true;
        }
    }
    return false;
}

pe_status pe_islands_find_touching(pe_world *world, const int *parted, pe_islands *groups,
                                   pe_error *error)
{
    size_t slots = (size_t)world->slot_count;
    int *parent = pe_scratch(world, slots, sizeof *parent);
    int *number = pe_scratch(world, slots, sizeof *number);
    bool *joined = pe_scratch_zero(world, slots, sizeof *joined);
    pe_islands_take(world, 0, groups);
    if (pe_rest_list_awake(world, error) != PE_OK || pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the groups of %zu bodies", slots);
    }
    make_roots(world, parent, number);
    const pe_contacts *lists[] = {&world->solved, &world->contacts};
    joining *const joins[] = {pushed, touches};
    for (int list = 0; list < 2; ++list) {
        const link *links = join_all(world, lists[list], joins[list], parent);
        if (links == NULL) {
            return pe_fail(error, PE_NO_MEMORY, "no memory for the groups of %zu bodies", slots);
        }
        for (int i = 0; i < lists[list]->manifold_count; ++i) {
            if (links[i].a >= 0) {
                joined[links[i].a] = joined[links[i].b] = true;
            }
        }
    }
    for (int i = 0; i < pe_awake_count(world) && parted != NULL; ++i) {
        const int slot = pe_awake(world)[i];
        if (parted[slot] != slot) {
            pe_join_roots(parent, slot, parted[slot]);
            joined[slot] = joined[parted[slot]] = true;
        }
    }
    for (int i = 0; i < pe_awake_count(world); ++i) {
        const int slot = pe_awake(world)[i];
        if (joined[slot]) {
            int root = pe_root_of(parent, slot);
            number[root] = number[root] < 0 ? groups->count++ : number[root];
        }
    }
    list_bodies(world, parent, number, groups);
    return PE_OK;
}
