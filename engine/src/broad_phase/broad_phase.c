/* Pairs by dynamic trees of fat boxes, kept from step to step.
 *
 * Every bounded body has two boxes. The snug one holds the body with its margin and a little more,
 * and stays while the body, at its speed, stays within it. The fat one, a leaf of the tree of
 * dynamic or of static bodies, holds the snug one and some way ahead. Pairs of fat boxes are kept:
 * when a fat box is left its body's pairs are found anew. Of these the pairs of snug boxes are the
 * answer, kept likewise while no snug box is new. A body at rest costs one comparison a step.
 *
 * A body that was at x0 with orientation q0, and now is at x with q, has no point that moved by
 * more than |x - x0| + 2 r |q - q0| (see contact_reuse.c); with its margin it is within the box
 * that had `room` around it as long as
 *
 *     |x - x0| + 2 r |q - q0| + h |v| + h r |w| + slack <= room. */
#include "broad_phase.h"

#include "model/shape.h"

#include <string.h>

/* In bounding radii: by how much a snug box is wider than its body and margin need, and a fat one
 * than the snug one. */
static const double SNUG = 0.01, FAT = 0.1;
/* Steps at its velocity that a fat box holds. */
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
    pe_array *arrays[] = {&broad->proxy_array, &broad->stirred_flag, &broad->stirred_list,
                          &broad->plane_array, &broad->fat_array,    &broad->near_array};
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

/* ---- Boxes -------------------------------------------------------------------------------------
 */

/* Bounds of the body, wider by `room` on every side. */
static pe_box box_of(const pe_world *world, int slot, double room)
{
    const pe_body *body = &pe_bodies(world)[slot];
    const pe_pose *pose = &pe_poses(world)[slot];
    pe_extent bounds = pe_shape_extent(&body->shape, body->geometry, &pose->rotation);
    pe_vec3 centre = pe_add(pose->position, bounds.centre);
    pe_vec3 half = pe_add(bounds.half, pe_v3(room, room, room));
    pe_vec3 low = pe_sub(centre, half), high = pe_add(centre, half);
    return (pe_box){{low.x, low.y, low.z}, {high.x, high.y, high.z}};
}

/* The box wider by `room` on every side, and by `way` besides on that to which it leads. */
static pe_box wider(const pe_box *box, double room, pe_vec3 way)
{
    pe_box wide = *box;
    for (int k = 0; k < 3; ++k) {
        wide.low[k] += pe_min(pe_component(way, k), 0) - room;
        wide.high[k] += pe_max(pe_component(way, k), 0) + room;
    }
    return wide;
}

static bool is_below(const pe_box *box, const pe_shape *plane)
{
    double deepest = 0;
    for (int k = 0; k < 3; ++k) {
        double n = pe_component(plane->normal, k);
        deepest += n * (n > 0 ? box->low[k] : box->high[k]);
    }
    return deepest <= plane->offset;
}

static void stir(pe_broad *broad, int slot)
{
    bool *stirred = broad->stirred_flag.items;
    if (!stirred[slot]) {
        stirred[slot] = true;
        ((int *)broad->stirred_list.items)[broad->stirred_count++] = slot;
    }
}

/* ---- Following the bodies ----------------------------------------------------------------------
 */

/* Room for the slots that the world has, which are planes, have moved and so on at most. */
static pe_status reserve_slots(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    size_t used = (size_t)broad->proxy_count, slots = (size_t)world->slot_count;
    const struct {
        pe_array *array;
        size_t stride, used;
    } rows[] = {
        {&broad->proxy_array, sizeof(pe_proxy), used},
        {&broad->stirred_flag, sizeof(bool), used},
        {&broad->stirred_list, sizeof(int), (size_t)broad->stirred_count},
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
    memset((bool *)broad->stirred_flag.items + used, 0, (slots - used) * sizeof(bool));
    broad->proxy_count = world->slot_count;
    return PE_OK;
}

/* Forgets the body that had the slot. */
static void drop(pe_broad *broad, int slot)
{
    pe_proxy *proxy = &proxies_of(broad)[slot];
    if (proxy->bounded) {
        pe_tree_remove(tree_of(broad, proxy), slot);
    }
    broad->planes_changed |= is_plane(proxy);
    *proxy = (pe_proxy){0};
    stir(broad, slot);
}

static pe_status adopt(pe_world *world, int slot, pe_error *error)
{
    pe_broad *broad = world->broad;
    const pe_body *body = &pe_bodies(world)[slot];
    pe_proxy made = {
        .room = -1, /* of no use: to be made */
        .radius = body->bounding_radius,
        .generation = body->generation,
        .alive = true,
        .is_static = body->is_static,
        .bounded = body->shape.kind != PE_SHAPE_PLANE,
    };
    if (made.bounded) {
        pe_box none = {{0}, {0}};
        pe_status status =
            pe_tree_add(tree_of(broad, &made), &world->allocator, slot, &none, error);
        if (status != PE_OK) {
            return status;
        }
    }
    broad->planes_changed |= is_plane(&made);
    proxies_of(broad)[slot] = made;
    stir(broad, slot);
    return PE_OK;
}

/* Finds the bodies that came and went. */
static pe_status meet_bodies(pe_world *world, pe_error *error)
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
            drop(broad, slot);
        }
        if (bodies[slot].alive && !same) {
            status = adopt(world, slot, error);
        }
        if (is_plane(proxy)) {
            ((int *)broad->plane_array.items)[planes++] = slot;
        }
    }
    broad->plane_count = planes;
    world->bodies_changed = status != PE_OK;
    return status;
}

/* Whether the body is for certain within its snug box, as at the head of this file;
 * (a + b + c + d)^2 <= 4 (a^2 + b^2 + c^2 + d^2) spares the roots. */
static bool stays(const pe_proxy *proxy, const pe_pose *pose, const pe_twist *motion, double dt,
                  double slack)
{
    pe_vec3 x = pe_sub(pose->position, proxy->position), v = motion->velocity;
    pe_quat q = pose->orientation, p = proxy->orientation;
    double dw = q.w - p.w, r = proxy->radius, room = proxy->room - slack;
    pe_vec3 dv = pe_v3(q.x - p.x, q.y - p.y, q.z - p.z), w = motion->angular_velocity;
    double turned = 4 * (dw * dw + pe_dot(dv, dv)) + dt * dt * pe_dot(w, w);
    double way2 = pe_dot(x, x) + dt * dt * pe_dot(v, v) + r * r * turned;
    return room > 0 && 4 * way2 <= room * room;
}

/* Renews the boxes that the body has left. */
static void follow_body(pe_world *world, int slot, double dt, double slack)
{
    pe_broad *broad = world->broad;
    pe_proxy *proxy = &proxies_of(broad)[slot];
    const pe_pose *pose = &pe_poses(world)[slot];
    const pe_twist *motion = &pe_twists(world)[slot];
    double spin = pe_length(motion->angular_velocity) * proxy->radius;
    /* The whole slack for each, because a plane has no bounds to hold a half of it. */
    double margin = dt * (pe_length(motion->velocity) + spin) + slack;
    double more = SNUG * proxy->radius;
    pe_box needed = box_of(world, slot, margin);
    if (proxy->room >= 0 && pe_aabb_contains(&proxy->snug, &needed)) {
        return;
    }
    proxy->room = margin + more;
    proxy->snug = wider(&needed, more, pe_v3(0, 0, 0));
    proxy->position = pose->position;
    proxy->orientation = pose->orientation;
    broad->shifted = true;
    pe_tree *tree = tree_of(broad, proxy);
    if (!pe_aabb_contains(pe_tree_box(tree, slot), &proxy->snug)) {
        pe_vec3 way = pe_scale(AHEAD * dt, motion->velocity);
        pe_box fat = wider(&proxy->snug, FAT * proxy->radius, way);
        bool is_box =
            pe_aabb_contains(&fat, &fat); /* no NaN: that meets nothing, and has no place */
        pe_tree_move(tree, slot, is_box ? &fat : &(pe_box){{0}, {0}});
        stir(broad, slot);
    }
}

static void follow(pe_world *world, double dt)
{
    const pe_proxy *proxies = proxies_of(world->broad);
    double slack = pe_margin_slack(world, dt);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (proxies[slot].bounded &&
            !stays(&proxies[slot], &pe_poses(world)[slot], &pe_twists(world)[slot], dt, slack)) {
            follow_body(world, slot, dt, slack);
        }
    }
}

/* ---- Pairs -------------------------------------------------------------------------------------
 */

static void stir_all_dynamics(pe_broad *broad)
{
    for (int slot = 1; slot < broad->proxy_count; ++slot) {
        const pe_proxy *proxy = &proxies_of(broad)[slot];
        if (proxy->bounded && !proxy->is_static) {
            stir(broad, slot);
        }
    }
    pe_tree_invalidate(&broad->dynamics);
}

static pe_status meet_planes(const pe_world *world, pe_pair_list *pairs, pe_error *error)
{
    const pe_broad *broad = world->broad;
    const int *planes = broad->plane_array.items, *stirred = broad->stirred_list.items;
    pe_status status = PE_OK;
    for (int i = 0; i < broad->stirred_count; ++i) {
        const pe_proxy *proxy = &proxies_of(broad)[stirred[i]];
        if (!proxy->bounded || proxy->is_static) {
            continue;
        }
        const pe_box *box = pe_tree_box(&broad->dynamics, stirred[i]);
        for (int k = 0; k < broad->plane_count && status == PE_OK; ++k) {
            if (is_below(box, &pe_bodies(world)[planes[k]].shape)) {
                status = pe_pair_list_add(pairs, planes[k], stirred[i], error);
            }
        }
    }
    return status;
}

/* All pairs of fat boxes with a stirred one, sorted. */
static pe_status find_stirred(pe_world *world, pe_pair_list *pairs, pe_error *error)
{
    pe_broad *broad = world->broad;
    *pairs = (pe_pair_list){.work = pe_step_memory(world)};
    pe_status status = pe_tree_update(&broad->dynamics, pairs->work, error);
    if (status == PE_OK) {
        status = pe_tree_update(&broad->statics, pairs->work, error);
    }
    if (status == PE_OK) {
        status = pe_tree_query_pairs(&broad->dynamics, &broad->dynamics, pairs, error);
    }
    if (status == PE_OK) {
        status = pe_tree_query_pairs(&broad->dynamics, &broad->statics, pairs, error);
    }
    if (status == PE_OK) {
        status = meet_planes(world, pairs, error);
    }
    return status == PE_OK ? pe_pair_list_sort(pairs, world->slot_count, error) : status;
}

static bool precedes(pe_pair p, pe_pair q)
{
    return p.a < q.a || (p.a == q.a && p.b < q.b);
}

/* Puts the pairs found in the place of those that the stirred bodies had. */
static pe_status replace_stirred(pe_world *world, const pe_pair_list *found, pe_error *error)
{
    pe_broad *broad = world->broad;
    const bool *stirred = broad->stirred_flag.items;
    pe_pair *fat = broad->fat_array.items;
    int kept = 0;
    for (int i = 0; i < broad->fat_count; ++i) {
        if (!stirred[fat[i].a] && !stirred[fat[i].b]) {
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

static pe_status renew_fat(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    if (broad->planes_changed) {
        stir_all_dynamics(broad);
    }
    pe_pair_list found;
    pe_status status = find_stirred(world, &found, error);
    if (status == PE_OK) {
        status = replace_stirred(world, &found, error);
    }
    if (status == PE_OK) {
        pe_tree_unmark(&broad->dynamics);
        pe_tree_unmark(&broad->statics);
        bool *stirred = broad->stirred_flag.items;
        const int *list = broad->stirred_list.items;
        for (int i = 0; i < broad->stirred_count; ++i) {
            stirred[list[i]] = false;
        }
        broad->stirred_count = 0;
        broad->planes_changed = false;
        broad->shifted = true;
    }
    return status;
}

static bool are_near(const pe_world *world, pe_pair pair)
{
    const pe_proxy *a = &proxies_of(world->broad)[pair.a], *b = &proxies_of(world->broad)[pair.b];
    const pe_body *bodies = pe_bodies(world);
    return is_plane(a)   ? is_below(&b->snug, &bodies[pair.a].shape)
           : is_plane(b) ? is_below(&a->snug, &bodies[pair.b].shape)
                         : pe_box_overlaps(&a->snug, &b->snug);
}

static pe_status renew_near(pe_world *world, pe_error *error)
{
    pe_broad *broad = world->broad;
    pe_status status = pe_array_reserve(&broad->near_array, &world->allocator, sizeof(pe_pair),
                                        (size_t)broad->fat_count, 0, error);
    if (status != PE_OK) {
        return status;
    }
    const pe_pair *fat = broad->fat_array.items;
    pe_pair *near = broad->near_array.items;
    int count = 0;
    for (int i = 0; i < broad->fat_count; ++i) {
        if (are_near(world, fat[i])) {
            near[count++] = fat[i];
        }
    }
    broad->near_count = count;
    broad->shifted = false;
    return PE_OK;
}

static pe_status renew(pe_world *world, double dt, pe_error *error)
{
    pe_broad *broad = world->broad;
    pe_status status = reserve_slots(world, error);
    if (status == PE_OK && world->bodies_changed) {
        status = meet_bodies(world, error);
    }
    if (status != PE_OK) {
        return status;
    }
    follow(world, dt);
    if (broad->stirred_count > 0) {
        status = renew_fat(world, error);
    }
    return status == PE_OK && broad->shifted ? renew_near(world, error) : status;
}

pe_status pe_broad_phase(pe_world *world, double dt, pe_pair **pairs, int *count, pe_error *error)
{
    return pe_broad_phase_moved(world, dt, NULL, pairs, count, error);
}

pe_status pe_broad_phase_moved(pe_world *world, double dt, const bool *moved, pe_pair **pairs,
                               int *count, pe_error *error)
{
    *count = 0;
    pe_status status = renew(world, dt, error);
    if (status != PE_OK) {
        return status;
    }
    int most = world->broad->near_count;
    const pe_pair *near = world->broad->near_array.items;
    *pairs = pe_scratch(world, (size_t)most + 1, sizeof **pairs);
    if (*pairs == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d pairs", most);
    }
    for (int i = 0; i < most; ++i) {
        if (moved == NULL || moved[near[i].a] || moved[near[i].b]) {
            (*pairs)[(*count)++] = near[i];
        }
    }
    return PE_OK;
}
