#include "broad_phase.h"

#include "shape.h"

#include <string.h>

typedef struct bounds {
    pe_vec3 low, high;
} bounds;

/* What a point of a body may travel in a step, gravity apart. */
static double reach(const pe_world *world, int slot, double dt)
{
    const pe_motion *motion = &pe_motions(world)[slot];
    double spin = pe_length(motion->angular_velocity) * pe_bodies(world)[slot].bounding_radius;
    return dt * (pe_length(motion->velocity) + spin);
}

static double slack(const pe_world *world, double dt)
{
    return world->def.contact_margin + dt * dt * pe_length(world->def.gravity);
}

double pe_pair_margin(const pe_world *world, int a, int b, double dt)
{
    const pe_motion *ma = &pe_motions(world)[a], *mb = &pe_motions(world)[b];
    const pe_body *bodies = pe_bodies(world);
    double spin = pe_length(ma->angular_velocity) * bodies[a].bounding_radius +
                  pe_length(mb->angular_velocity) * bodies[b].bounding_radius;
    return dt * (pe_length(pe_sub(ma->velocity, mb->velocity)) + spin) + slack(world, dt);
}

/* The axis, 0 to 2, along which the centres have the largest variance. */
static int widest_axis(const pe_world *world, const int *order, int count)
{
    pe_vec3 sum = {0}, squares = {0};
    for (int i = 0; i < count; ++i) {
        pe_vec3 x = pe_poses(world)[order[i]].position;
        sum = pe_add(sum, x);
        squares = pe_add(squares, pe_mul(x, x));
    }
    pe_vec3 spread = pe_sub(squares, pe_scale(1.0 / count, pe_mul(sum, sum)));
    return spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
}

/* Sorts slots by the low end of their bounds; ties by slot, so that the order is one. The order of
 * the last step is nearly right, which insertion likes. */
static void sort_by_low(int *order, int count, const bounds *boxes, int axis)
{
    for (int i = 1; i < count; ++i) {
        int slot = order[i];
        double key = pe_component(boxes[slot].low, axis);
        int j = i;
        for (; j > 0; --j) {
            double other = pe_component(boxes[order[j - 1]].low, axis);
            if (!(other > key) && !(other == key && order[j - 1] > slot)) {
                break;
            }
            order[j] = order[j - 1];
        }
        order[j] = slot;
    }
}

/* Pairs in a growing piece of the arena. */
typedef struct pair_list {
    pe_pair *items;
    int count, capacity;
} pair_list;

static pe_status push(pe_world *world, pair_list *list, int a, int b, pe_error *error)
{
    if (list->count == list->capacity) {
        int capacity = list->capacity * 2;
        pe_pair *items = pe_scratch(world, (size_t)capacity, sizeof *items);
        if (items == NULL) {
            return pe_fail(error, PE_NO_MEMORY, "no memory for %d pairs", capacity);
        }
        memcpy(items, list->items, (size_t)list->count * sizeof *items);
        list->items = items;
        list->capacity = capacity;
    }
    list->items[list->count++] = a < b ? (pe_pair){a, b} : (pe_pair){b, a};
    return PE_OK;
}

static bool overlap(const bounds *p, const bounds *q)
{
    return p->low.x <= q->high.x && q->low.x <= p->high.x && p->low.y <= q->high.y &&
           q->low.y <= p->high.y && p->low.z <= q->high.z && q->low.z <= p->high.z;
}

static pe_status sweep(pe_world *world, const int *order, int count, const bounds *boxes, int axis,
                       pair_list *list, pe_error *error)
{
    const pe_body *bodies = pe_bodies(world);
    for (int i = 0; i < count; ++i) {
        const bounds *box = &boxes[order[i]];
        double end = pe_component(box->high, axis);
        for (int j = i + 1; j < count && pe_component(boxes[order[j]].low, axis) <= end; ++j) {
            if ((bodies[order[i]].is_static && bodies[order[j]].is_static) ||
                !overlap(box, &boxes[order[j]])) {
                continue;
            }
            pe_status status = push(world, list, order[i], order[j], error);
            if (status != PE_OK) {
                return status;
            }
        }
    }
    return PE_OK;
}

/* The bounds of dynamic bodies hold their margin already. */
static pe_status sweep_plane(pe_world *world, int plane, const int *order, int count,
                             const bounds *boxes, pair_list *list, pe_error *error)
{
    const pe_shape *shape = &pe_bodies(world)[plane].shape;
    pe_vec3 n = shape->normal;
    for (int i = 0; i < count; ++i) {
        const bounds *box = &boxes[order[i]];
        pe_vec3 deepest =
            pe_v3(n.x > 0 ? box->low.x : box->high.x, n.y > 0 ? box->low.y : box->high.y,
                  n.z > 0 ? box->low.z : box->high.z);
        if (pe_bodies(world)[order[i]].is_static || pe_dot(n, deepest) > shape->offset) {
            continue;
        }
        pe_status status = push(world, list, plane, order[i], error);
        if (status != PE_OK) {
            return status;
        }
    }
    return PE_OK;
}

/* Sorts by (a, b): a counting sort by a, then insertion by b in each short run. */
static pe_status sort_pairs(pe_world *world, pair_list *list, pe_error *error)
{
    int slots = world->slot_count;
    int *start = pe_scratch(world, (size_t)slots + 1, sizeof *start);
    pe_pair *sorted = pe_scratch(world, (size_t)list->count + 1, sizeof *sorted);
    if (start == NULL || sorted == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to sort %d pairs", list->count);
    }
    memset(start, 0, ((size_t)slots + 1) * sizeof *start);
    for (int i = 0; i < list->count; ++i) {
        start[list->items[i].a + 1] += 1;
    }
    for (int s = 0; s < slots; ++s) {
        start[s + 1] += start[s];
    }
    for (int i = 0; i < list->count; ++i) {
        sorted[start[list->items[i].a]++] = list->items[i];
    }
    for (int i = 1; i < list->count; ++i) {
        pe_pair pair = sorted[i];
        int j = i;
        for (; j > 0 && sorted[j - 1].a == pair.a && sorted[j - 1].b > pair.b; --j) {
            sorted[j] = sorted[j - 1];
        }
        sorted[j] = pair;
    }
    list->items = sorted;
    return PE_OK;
}

pe_status pe_broad_phase(pe_world *world, double dt, pe_pair **pairs, int *count, pe_error *error)
{
    int *order = world->order_array.items;
    int n = world->order_count;
    pair_list list = {.capacity = 64};
    list.items = pe_scratch(world, (size_t)list.capacity, sizeof *list.items);
    bounds *boxes = pe_scratch(world, (size_t)world->slot_count, sizeof *boxes);
    if (list.items == NULL || boxes == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the bounds of %d bodies", n);
    }
    for (int i = 0; i < n; ++i) {
        int slot = order[i];
        const pe_pose *pose = &pe_poses(world)[slot];
        /* The whole slack for each, because a plane has no bounds to hold a half of it. */
        double margin = reach(world, slot, dt) + slack(world, dt);
        pe_vec3 e = pe_shape_half_extents(&pe_bodies(world)[slot].shape, &pose->rotation);
        e = pe_add(e, pe_v3(margin, margin, margin));
        boxes[slot] = (bounds){pe_sub(pose->position, e), pe_add(pose->position, e)};
    }
    pe_status status = PE_OK;
    if (n > 0) {
        int axis = widest_axis(world, order, n);
        sort_by_low(order, n, boxes, axis);
        status = sweep(world, order, n, boxes, axis, &list, error);
    }
    for (int slot = 1; slot < world->slot_count && status == PE_OK; ++slot) {
        const pe_body *body = &pe_bodies(world)[slot];
        if (body->alive && body->shape.kind == PE_SHAPE_PLANE) {
            status = sweep_plane(world, slot, order, n, boxes, &list, error);
        }
    }
    if (status == PE_OK) {
        status = sort_pairs(world, &list, error);
    }
    *pairs = list.items;
    *count = list.count;
    return status;
}
