/* Pairs by dynamic trees of fat AABBs, kept from step to step.
 *
 * Every bounded body has two AABBs. The tight one holds the body with its margin and a little more.
 * It is kept while the body, at its speed, stays within it. The fat one, a leaf of the tree of
 * dynamic or of static bodies, holds the tight one and some of the path ahead. Pairs of fat AABBs
 * are kept: when a body leaves its fat AABB its pairs are found again. The pairs of these whose
 * tight AABBs overlap are the result, also kept while no tight AABB is new. A body at rest costs
 * one comparison a step.
 *
 * A body that was at x0 with orientation q0, and now is at x with q, has no point that moved by
 * more than |x - x0| + 2 r |q - q0| (see contact.c). With its margin it is within the AABB that was
 * computed with `margin` around it as long as
 *
 *     |x - x0| + 2 r |q - q0| + h |v| + h r |w| + slack <= margin. */
#include "broad_phase.h"

#include "model/rest.h"
#include "model/shape.h"
#include "model/view.h"

#include <string.h>

/* In bounding radii: how much wider a tight AABB is than its body and margin need, and a fat one
 * than the tight one. */
static const double TIGHT = 0.01, FAT = 0.1;
/* Steps at the body's velocity that a fat AABB holds. */
static const double AHEAD = 4;

double pe_spin_speed(const pe_world *world, int slot)
{
    return pe_length(pe_twists(world)[slot].angular_velocity) *
           pe_bodies(world)[slot].bounding_radius;
}

double pe_margin_slack(const pe_world *world, double dt)
{
    return world->def.contact_margin + dt * dt * pe_length(world->def.gravity);
}

double pe_pair_margin(const pe_world *world, int a, int b, double dt)
{
    const pe_twist *ma = &pe_twists(world)[a], *mb = &pe_twists(world)[b];
    double spin = pe_spin_speed(world, a) + pe_spin_speed(world, b);
    return dt * (pe_length(pe_sub(ma->velocity, mb->velocity)) + spin) + pe_margin_slack(world, dt);
}

void pe_broad_free(pe_broad *broad, const pe_allocator *allocator)
{
    pe_array *arrays[] = {&broad->proxy_array, &broad->moved_flag, &broad->moved_list,
                          &broad->plane_array, &broad->fat_array,  &broad->tight_array};
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i) {
        pe_array_free(arrays[i], allocator);
    }
    pe_tree_free(&broad->dynamics, allocator);
    pe_tree_free(&broad->statics, allocator);
}

static pe_proxy *proxies_of(const pe_broad *broad)
{
    return broad->proxy_array.items;
}

static pe_tree *tree_of(pe_broad *broad, const pe_proxy *proxy)
{
    return proxy->is_static ? &broad->statics : &broad->dynamics;
}

static bool is_plane(const pe_proxy *proxy)
{
    return proxy->alive && !proxy->bounded;
}

/* ---- AABBs ---- */

/* Bounds of the body, enlarged by `margin` on every side. */
static pe_aabb body_aabb(const pe_world *world, int slot, double margin)
{
    const pe_body *body = &pe_bodies(world)[slot];
    const pe_pose *pose = &pe_poses(world)[slot];
    pe_extent bounds = pe_shape_extent(&body->shape, body->geometry, &pose->rotation);
    pe_vec3 centre = pe_add(pose->position, bounds.centre);
    pe_vec3 half = pe_add(bounds.half, pe_v3(margin, margin, margin));
    pe_vec3 low = pe_sub(centre, half), high = pe_add(centre, half);
    return (pe_aabb){{low.x, low.y, low.z}, {high.x, high.y, high.z}};
}

/* The box enlarged by `margin` on every side, and to hold itself after the displacement. */
static pe_aabb enlarged(const pe_aabb *box, double margin, pe_vec3 displacement)
{
    pe_aabb wide = *box;
    for (int k = 0; k < 3; ++k) {
        wide.low[k] += pe_min(pe_component(displacement, k), 0) - margin;
        wide.high[k] += pe_max(pe_component(displacement, k), 0) + margin;
    }
    return wide;
}

/* Whether a part of the box is in the solid half-space. */
static bool is_below(const pe_aabb *box, const pe_shape *plane)
{
    double deepest = 0;
    for (int k = 0; k < 3; ++k) {
        double n = pe_component(plane->normal, k);
        deepest += n * (n > 0 ? box->low[k] : box->high[k]);
    }
    return deepest <= plane->offset;
}

static void mark_moved(pe_broad *broad, int slot)
{
    bool *moved = broad->moved_flag.items;
    if (!moved[slot]) {
        moved[slot] = true;
        ((int *)broad->moved_list.items)[broad->moved_count++] = slot;
    }
}

/* ---- Proxies ---- */

/* Makes room for a proxy of every slot; all of them may move, or be planes. */
static pe_status reserve_slots(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    size_t used = (size_t)broad->proxy_count, slots = (size_t)world->slot_count;
    const struct {
        pe_array *array;
        size_t stride, used;
    } rows[] = {
        {&broad->proxy_array, sizeof(pe_proxy), used},
        {&broad->moved_flag, sizeof(bool), used},
        {&broad->moved_list, sizeof(int), (size_t)broad->moved_count},
        {&broad->plane_array, sizeof(int), (size_t)broad->plane_count},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        pe_status status = pe_array_reserve(rows[i].array, &world->allocator, rows[i].stride, slots,
                                            rows[i].used, error);
        if (status != PE_OK) {
            return status;
        }
    }
    memset(proxies_of(broad) + used, 0, (slots - used) * sizeof(pe_proxy));
    memset((bool *)broad->moved_flag.items + used, 0, (slots - used) * sizeof(bool));
    broad->proxy_count = world->slot_count;
    return PE_OK;
}

/* Forgets the body that had the slot. */
static void remove_proxy(pe_broad *broad, int slot)
{
    pe_proxy *proxy = &proxies_of(broad)[slot];
    if (proxy->bounded) {
        pe_tree_remove(tree_of(broad, proxy), slot);
    }
    broad->planes_changed |= is_plane(proxy);
    *proxy = (pe_proxy){0};
    mark_moved(broad, slot);
}

static pe_status add_proxy(pe_world *world, int slot, pe_error *error)
{
    pe_broad *broad = world->broad;
    const pe_body *body = &pe_bodies(world)[slot];
    pe_proxy made = {
        .margin = -1, /* the tight AABB is not computed yet */
        .radius = body->bounding_radius,
        .generation = body->generation,
        .alive = true,
        .is_static = body->is_static,
        .bounded = body->shape.kind != PE_SHAPE_PLANE,
    };
    if (made.bounded) {
        pe_aabb none = {{0}, {0}};
        pe_status status =
            pe_tree_add(tree_of(broad, &made), &world->allocator, slot, &none, error);
        if (status != PE_OK) {
            return status;
        }
    }
    broad->planes_changed |= is_plane(&made);
    proxies_of(broad)[slot] = made;
    mark_moved(broad, slot);
    return PE_OK;
}

/* Finds the bodies that were created or destroyed. */
static pe_status update_proxies(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    const pe_body *bodies = pe_bodies(world);
    pe_status status = PE_OK;
    int planes = 0;
    for (int slot = 1; slot < world->slot_count && status == PE_OK; ++slot) {
        pe_proxy *proxy = &proxies_of(broad)[slot];
        bool same =
            proxy->alive && bodies[slot].alive && proxy->generation == bodies[slot].generation;
        if (proxy->alive && !same) {
            remove_proxy(broad, slot);
        }
        if (bodies[slot].alive && !same) {
            status = add_proxy(world, slot, error);
        }
        if (is_plane(proxy)) {
            ((int *)broad->plane_array.items)[planes++] = slot;
        }
    }
    broad->plane_count = planes;
    world->bodies_changed = status != PE_OK;
    return status;
}

/* Whether the body is certainly within its tight AABB, by the bound at the head of this file;
 * (a + b + c + d)^2 <= 4 (a^2 + b^2 + c^2 + d^2) spares the roots. */
static bool is_within_tight(const pe_proxy *proxy, const pe_pose *pose, const pe_twist *twist,
                            double dt, double slack)
{
    pe_vec3 x = pe_sub(pose->position, proxy->position), v = twist->velocity;
    pe_quat q = pose->orientation, p = proxy->orientation;
    double dw = q.w - p.w, r = proxy->radius, margin = proxy->margin - slack;
    pe_vec3 dv = pe_v3(q.x - p.x, q.y - p.y, q.z - p.z), w = twist->angular_velocity;
    double turned = 4 * (dw * dw + pe_dot(dv, dv)) + dt * dt * pe_dot(w, w);
    double moved2 = pe_dot(x, x) + dt * dt * pe_dot(v, v) + r * r * turned;
    return margin > 0 && 4 * moved2 <= margin * margin;
}

/* Which of the AABBs of a body are new. Static bodies have a tree of their own. */
typedef enum left_boxes { NEITHER, TIGHT_ONLY, BOTH, BOTH_OF_STATIC } left_boxes;

/* Computes the tight AABB again of a body that has left it. */
static left_boxes update_tight(const pe_world *world, int slot, double dt, double slack)
{
    pe_broad *broad = world->broad;
    pe_proxy *proxy = &proxies_of(broad)[slot];
    const pe_pose *pose = &pe_poses(world)[slot];
    const pe_twist *twist = &pe_twists(world)[slot];
    double spin = pe_length(twist->angular_velocity) * proxy->radius;
    /* Each body has the whole slack, because a plane has no AABB to hold a half of it. */
    double margin = dt * (pe_length(twist->velocity) + spin) + slack;
    double more = TIGHT * proxy->radius;
    pe_aabb needed = body_aabb(world, slot, margin);
    if (proxy->margin >= 0 && pe_aabb_contains(&proxy->tight, &needed)) {
        return NEITHER;
    }
    proxy->margin = margin + more;
    proxy->tight = enlarged(&needed, more, pe_v3(0, 0, 0));
    proxy->position = pose->position;
    proxy->orientation = pose->orientation;
    return pe_aabb_contains(pe_tree_box(tree_of(broad, proxy), slot), &proxy->tight) ? TIGHT_ONLY
           : proxy->is_static ? BOTH_OF_STATIC
                              : BOTH;
}

/* Gives the body a fat AABB that holds its tight one. Returns whether its leaf was not marked yet. */
static bool move_leaf(const pe_world *world, int slot, double dt)
{
    pe_broad *broad = world->broad;
    const pe_proxy *proxy = &proxies_of(broad)[slot];
    pe_vec3 ahead = pe_scale(AHEAD * dt, pe_twists(world)[slot].velocity);
    pe_aabb fat = enlarged(&proxy->tight, FAT * proxy->radius, ahead);
    bool has_nan = !pe_aabb_contains(&fat, &fat); /* such a box overlaps none */
    return pe_tree_set_box(tree_of(broad, proxy), slot, has_nan ? &(pe_aabb){{0}, {0}} : &fat);
}

/* Bodies whose nodes are fetched before they are looked at: these lie anywhere in memory. */
enum { AHEAD_OF_USE = 8 };

/* The AABBs of all bodies. */
typedef struct boxes {
    const pe_world *world;
    double dt, slack;
    uint8_t *left; /* (awake bodies) left_boxes */
} boxes;

static void update_tight_boxes(void *context, int worker, int begin, int end)
{
    (void)worker;
    const boxes *b = context;
    const pe_world *world = b->world;
    const pe_proxy *proxies = proxies_of(world->broad);
    const int *awake = pe_awake(world);
    for (int i = begin; i < end; ++i) {
        const int slot = awake[i], later = i + AHEAD_OF_USE < end ? awake[i + AHEAD_OF_USE] : 0;
        b->left[i] = NEITHER;
        if (proxies[later].bounded) {
            __builtin_prefetch(pe_tree_box(tree_of(world->broad, &proxies[later]), later));
        }
        if (proxies[slot].bounded && !is_within_tight(&proxies[slot], &pe_poses(world)[slot],
                                                      &pe_twists(world)[slot], b->dt, b->slack)) {
            left_boxes left = update_tight(world, slot, b->dt, b->slack);
            if (left >= BOTH && !move_leaf(world, slot, b->dt)) {
                left = TIGHT_ONLY; /* a new body, or one of a step that failed */
            }
            b->left[i] = (uint8_t)left;
        }
    }
}

/* Recomputes the AABBs that bodies have left. */
static pe_status update_all_boxes(pe_world *world, double dt, pe_error *error)
{
    pe_broad *broad = world->broad;
    boxes b = {.world = world,
               .dt = dt,
               .slack = pe_margin_slack(world, dt),
               .left = pe_scratch(world, (size_t)pe_awake_count(world) + 1, sizeof *b.left)};
    if (b.left == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the boxes of %d bodies",
                       world->slot_count);
    }
    pe_pool_run(world->pool, pe_awake_count(world), PE_BODY_GRAIN, update_tight_boxes, &b);
    int count[2] = {0}; /* of dynamic and of static bodies */
    for (int i = 0; i < pe_awake_count(world); ++i) {
        broad->tight_changed |= b.left[i] != NEITHER;
        if (b.left[i] >= BOTH) {
            count[b.left[i] == BOTH_OF_STATIC] += 1;
            mark_moved(broad, pe_awake(world)[i]);
        }
    }
    pe_tree_count_marked(&broad->dynamics, count[0]);
    pe_tree_count_marked(&broad->statics, count[1]);
    return PE_OK;
}

/* ---- Pairs ---- */

static void mark_all_dynamics(pe_broad *broad)
{
    for (int slot = 1; slot < broad->proxy_count; ++slot) {
        const pe_proxy *proxy = &proxies_of(broad)[slot];
        if (proxy->bounded && !proxy->is_static) {
            mark_moved(broad, slot);
        }
    }
    pe_tree_invalidate(&broad->dynamics);
}

/* The pairs of fat AABBs with a moved one. Each thread lists those that it finds. */
typedef struct pair_search {
    pe_world *world;
    const pe_tree *with; /* of a query: where the partners of dynamic bodies are */
    pe_node_pair starts[PE_MOST_STARTS];
    pe_pair_list *found; /* (threads) */
    pe_status *statuses; /* (threads) */
} pair_search;

static void pair_with_planes(void *context, int worker, int begin, int end)
{
    const pair_search *s = context;
    const pe_broad *broad = s->world->broad;
    const int *planes = broad->plane_array.items, *moved = broad->moved_list.items;
    pe_status *status = &s->statuses[worker];
    for (int i = begin; i < end; ++i) {
        const pe_proxy *proxy = &proxies_of(broad)[moved[i]];
        if (!proxy->bounded || proxy->is_static) {
            continue;
        }
        const pe_aabb *box = pe_tree_box(&broad->dynamics, moved[i]);
        for (int k = 0; k < broad->plane_count && *status == PE_OK; ++k) {
            if (is_below(box, &pe_bodies(s->world)[planes[k]].shape)) {
                *status = pe_pair_list_add(&s->found[worker], planes[k], moved[i], NULL);
            }
        }
    }
}

static void query_from(void *context, int worker, int begin, int end)
{
    const pair_search *s = context;
    for (int i = begin; i < end && s->statuses[worker] == PE_OK; ++i) {
        s->statuses[worker] = pe_tree_query_from(&s->world->broad->dynamics, s->with, s->starts[i],
                                                 &s->found[worker], NULL);
    }
}

/* Looks for the pairs of dynamic bodies with those of a tree. */
static void query(pair_search *s, const pe_tree *with)
{
    const int most = s->world->pool != NULL ? PE_MOST_STARTS : 1;
    const int starts = pe_tree_query_starts(&s->world->broad->dynamics, with, most, s->starts);
    s->with = with;
    pe_pool_run(s->world->pool, starts, 1, query_from, s);
}

/* Lists what all threads have found, in any order. */
static pe_status gather_pairs(const pair_search *s, int threads, pe_pair_list *pairs)
{
    pe_status status = PE_OK;
    int count = 0;
    for (int i = 0; i < threads; ++i) {
        status = status == PE_OK ? s->statuses[i] : status;
        count += s->found[i].count;
    }
    if (status != PE_OK || threads == 1) {
        *pairs = s->found[0];
        return status;
    }
    pairs->items = pe_take(pairs->work, (size_t)count + 1, sizeof *pairs->items);
    if (pairs->items == NULL) {
        return PE_NO_MEMORY;
    }
    pairs->capacity = count + 1;
    for (int i = 0; i < threads; ++i) {
        if (s->found[i].count > 0) {
            memcpy(pairs->items + pairs->count, s->found[i].items,
                   (size_t)s->found[i].count * sizeof *pairs->items);
            pairs->count += s->found[i].count;
        }
    }
    return PE_OK;
}

/* All pairs of fat AABBs with a moved one, sorted. */
static pe_status find_moved_pairs(pe_world *world, pe_pair_list *pairs, pe_error *error)
{
    pe_broad *broad = world->broad;
    *pairs = (pe_pair_list){.work = pe_step_memory(world)};
    pe_status status = pe_tree_update(&broad->dynamics, pairs->work, error);
    status = status ? status : pe_tree_update(&broad->statics, pairs->work, error);
    if (status != PE_OK) {
        return status;
    }
    pe_views_open(world);
    const int threads = pe_pool_threads(world->pool);
    pair_search s = {.world = world,
                     .found = pe_scratch(world, (size_t)threads, sizeof *s.found),
                     .statuses = pe_scratch_zero(world, (size_t)threads, sizeof *s.statuses)};
    if (s.found == NULL || s.statuses == NULL) {
        status = PE_NO_MEMORY;
    } else {
        for (int i = 0; i < threads; ++i) {
            s.found[i] = (pe_pair_list){.work = pe_step_memory(pe_view_of(world, i))};
        }
        query(&s, &broad->dynamics);
        query(&s, &broad->statics);
        if (broad->plane_count > 0) {
            pe_pool_run(world->pool, broad->moved_count, PE_BODY_GRAIN, pair_with_planes, &s);
        }
        status = gather_pairs(&s, threads, pairs);
    }
    return status == PE_OK
               ? pe_pair_list_sort(pairs, world->slot_count, error)
               : pe_fail(error, status, "no memory for pairs of %d bodies", world->slot_count);
}

static bool precedes(pe_pair p, pe_pair q)
{
    return p.a < q.a || (p.a == q.a && p.b < q.b);
}

/* Replaces the pairs of moved proxies by those found. */
static pe_status replace_moved_pairs(pe_world *world, const pe_pair_list *found, pe_error *error)
{
    pe_broad *broad = world->broad;
    const bool *moved = broad->moved_flag.items;
    pe_pair *fat = broad->fat_array.items;
    int kept = 0;
    for (int i = 0; i < broad->fat_count; ++i) {
        if (!moved[fat[i].a] && !moved[fat[i].b]) {
            fat[kept++] = fat[i];
        }
    }
    broad->fat_count = kept;
    int count = kept + found->count;
    pe_status status = pe_array_reserve(&broad->fat_array, &world->allocator, sizeof *fat,
                                        (size_t)count, (size_t)kept, error);
    if (status != PE_OK) {
        return status;
    }
    fat = broad->fat_array.items; /* merged from behind */
    for (int i = kept - 1, j = found->count - 1, to = count - 1; j >= 0; --to) {
        fat[to] = i >= 0 && precedes(found->items[j], fat[i]) ? fat[i--] : found->items[j--];
    }
    broad->fat_count = count;
    return PE_OK;
}

static pe_status update_fat_pairs(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    if (broad->planes_changed) {
        mark_all_dynamics(broad);
    }
    pe_pair_list found;
    pe_status status = find_moved_pairs(world, &found, error);
    if (status == PE_OK) {
        status = replace_moved_pairs(world, &found, error);
    }
    if (status == PE_OK) {
        pe_tree_unmark(&broad->dynamics, world->pool);
        pe_tree_unmark(&broad->statics, world->pool);
        bool *moved = broad->moved_flag.items;
        const int *list = broad->moved_list.items;
        for (int i = 0; i < broad->moved_count; ++i) {
            moved[list[i]] = false;
        }
        broad->moved_count = 0;
        broad->planes_changed = false;
        broad->tight_changed = true;
    }
    return status;
}

enum { PAIR_GRAIN = 1024 };

/* A choice among pairs. */
typedef struct pair_filter {
    const pe_world *world;
    bool (*keeps)(const struct pair_filter *s, pe_pair pair);
    const bool *moved;  /* (slots): see pe_broad_phase */
    const int *resting; /* pe_resting_of the world */
    const pe_pair *from;
    pe_pair *to;
    int *counts; /* kept of each piece, which lists them where it begins */
} pair_filter;

static void filter_piece(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pair_filter *s = context;
    pe_pair *to = s->to + begin;
    int count = 0;
    for (int i = begin; i < end; ++i) {
        if (s->keeps(s, s->from[i])) {
            to[count++] = s->from[i];
        }
    }
    s->counts[begin / PAIR_GRAIN] = count;
}

/* Lists the pairs that s->keeps, in the same order, in s->to (count), and counts them. */
static pe_status filter_pairs(pe_world *world, pair_filter *s, int count, int *kept,
                              pe_error *error)
{
    const int pieces = pe_piece_count(count, PAIR_GRAIN);
    s->counts = pe_scratch(world, (size_t)pieces + 1, sizeof *s->counts);
    if (s->counts == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d pairs", count);
    }
    pe_pool_run(world->pool, count, PAIR_GRAIN, filter_piece, s);
    *kept = 0;
    for (int i = 0; i < pieces; ++i) {
        memmove(s->to + *kept, s->to + i * PAIR_GRAIN, (size_t)s->counts[i] * sizeof *s->to);
        *kept += s->counts[i];
    }
    return PE_OK;
}

static bool overlap_tightly(const pair_filter *s, pe_pair pair)
{
    const pe_world *world = s->world;
    const pe_proxy *a = &proxies_of(world->broad)[pair.a], *b = &proxies_of(world->broad)[pair.b];
    const pe_body *bodies = pe_bodies(world);
    return is_plane(a)   ? is_below(&b->tight, &bodies[pair.a].shape)
           : is_plane(b) ? is_below(&a->tight, &bodies[pair.b].shape)
                         : pe_aabb_overlaps(&a->tight, &b->tight);
}

/* Lists the pairs of tight AABBs among those of fat ones. */
static pe_status update_tight_pairs(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    pe_status status = pe_array_reserve(&broad->tight_array, &world->allocator, sizeof(pe_pair),
                                        (size_t)broad->fat_count, 0, error);
    if (status == PE_OK) {
        pair_filter s = {.world = world,
                         .keeps = overlap_tightly,
                         .from = broad->fat_array.items,
                         .to = broad->tight_array.items};
        status = filter_pairs(world, &s, broad->fat_count, &broad->tight_count, error);
        broad->tight_changed = status != PE_OK;
    }
    return status;
}

static pe_status update_pairs(pe_world *world, double dt, pe_error *error)
{
    pe_broad *broad = world->broad;
    pe_status status = reserve_slots(world, error);
    if (status == PE_OK && world->bodies_changed) {
        status = update_proxies(world, error);
    }
    if (status != PE_OK) {
        return status;
    }
    status = pe_rest_list_awake(world, error);
    status = status ? status : update_all_boxes(world, dt, error);
    if (status == PE_OK && broad->moved_count > 0) {
        status = update_fat_pairs(world, error);
    }
    return status == PE_OK && broad->tight_changed ? update_tight_pairs(world, error) : status;
}

/* Whether a body has moved, if that is asked, and one is neither static nor at rest. */
static bool is_active(const pair_filter *s, pe_pair pair)
{
    if (s->moved != NULL && !s->moved[pair.a] && !s->moved[pair.b]) {
        return false;
    }
    const pe_proxy *proxies = proxies_of(s->world->broad);
    return s->resting == NULL || (!pe_rests(s->resting, pair.a) && !proxies[pair.a].is_static) ||
           (!pe_rests(s->resting, pair.b) && !proxies[pair.b].is_static);
}

pe_status pe_broad_phase(pe_world *world, double dt, const bool *moved, pe_pair_list *pairs,
                         pe_error *error)
{
    *pairs = (pe_pair_list){.work = pe_step_memory(world)};
    pe_status status = update_pairs(world, dt, error);
    if (status != PE_OK) {
        return status;
    }
    const int count = world->rest->movable_count > 0 ? world->broad->tight_count : 0;
    pairs->items = world->broad->tight_array.items;
    pairs->count = pairs->capacity = count;
    pair_filter s = {.world = world,
                     .keeps = is_active,
                     .moved = moved,
                     .resting = pe_resting_of(world),
                     .from = pairs->items};
    if (moved != NULL || s.resting != NULL) {
        s.to = pairs->items = pe_scratch(world, (size_t)count + 1, sizeof *pairs->items);
        status = s.to != NULL ? filter_pairs(world, &s, count, &pairs->count, error)
                              : pe_fail(error, PE_NO_MEMORY, "no memory for %d pairs", count);
    }
    return status;
}
