/* A list of touches in the step's memory. */
#include "collide_mesh.h"

#include <string.h>

enum { FIRST_CAPACITY = 64 };

/* In units of the smaller solid: depths that differ by less are one. */
static const double TIE = 1e-9;
/* In units of its depth: how near other touches are at the same place. */
static const double PLACE = 8;
/* Sine of the angle from which a direction is another one. */
static const double ANOTHER = 1e-3;

uint64_t pe_touch_feature(pe_touch_kind kind, int first, int second)
{
    return (uint64_t)kind << 60 | (uint64_t)(uint32_t)first << 30 | (uint64_t)(uint32_t)second;
}

int pe_touch_first(uint64_t feature)
{
    return (int)(feature >> 30 & ((1u << 30) - 1));
}

int pe_touch_second(uint64_t feature)
{
    return (int)(feature & ((1u << 30) - 1));
}

void pe_touches_add(pe_touches *list, const pe_touch *touch)
{
    if (list->count == list->capacity && !list->failed) {
        int capacity = list->capacity > 0 ? 2 * list->capacity : FIRST_CAPACITY;
        pe_touch *items = pe_take(list->work, (size_t)capacity, sizeof *items);
        list->failed = items == NULL;
        if (!list->failed) {
            if (list->count > 0) {
                memcpy(items, list->items, (size_t)list->count * sizeof *items);
            }
            list->items = items;
            list->capacity = capacity;
        }
    }
    if (!list->failed) {
        list->items[list->count++] = *touch;
    }
}

/* Heapsort (Williams 1964): in place, and no worse for many. */
static void sift(pe_touch *items, int root, int count)
{
    pe_touch touch = items[root];
    int child = 2 * root + 1;
    for (; child < count; child = 2 * root + 1) {
        if (child + 1 < count && items[child + 1].feature > items[child].feature) {
            ++child;
        }
        if (items[child].feature <= touch.feature) {
            break;
        }
        items[root] = items[child];
        root = child;
    }
    items[root] = touch;
}

void pe_touches_sort(pe_touches *list)
{
    for (int i = list->count / 2 - 1; i >= 0; --i) {
        sift(list->items, i, list->count);
    }
    for (int end = list->count - 1; end > 0; --end) {
        pe_touch last = list->items[end];
        list->items[end] = list->items[0];
        list->items[0] = last;
        sift(list->items, 0, end);
    }
}

static pe_vec3 middle_of(const pe_touch *t, double radius)
{
    return pe_madd(t->on_a, 0.5 * (t->separation + radius), t->normal);
}

static bool has_better(const pe_touches *list, const pe_touch *t, double radius, double size)
{
    double height = t->separation + radius, tie = TIE * size;
    double near = PLACE * height, most = pe_min(-height, PE_DEPTH * size);
    pe_vec3 x = middle_of(t, radius);
    for (int i = 0; i < list->count; ++i) {
        const pe_touch *other = &list->items[i];
        double h = other->separation + radius;
        if (!other->strict || other->dent || h <= height + tie || h > most) {
            continue;
        }
        pe_vec3 d = pe_sub(middle_of(other, radius), x);
        pe_vec3 across = pe_cross(other->normal, t->normal);
        if (pe_dot(d, d) <= near * near && pe_dot(across, across) > ANOTHER * ANOTHER) {
            return true;
        }
    }
    return false;
}

void pe_touches_settle(pe_touches *list, double radius, double size)
{
    for (int i = 0; i < list->count; ++i) {
        pe_touch *t = &list->items[i];
        bool deep = t->separation + radius < -TIE * size;
        t->merged = deep && !t->dent && has_better(list, t, radius, size);
    }
    int kept = 0;
    for (int i = 0; i < list->count; ++i) {
        if (!list->items[i].merged) {
            list->items[kept++] = list->items[i];
        }
    }
    list->count = kept;
}

double pe_touches_least(const pe_touches *list)
{
    double least = HUGE_VAL;
    for (int i = 0; i < list->count; ++i) {
        least = pe_min(least, list->items[i].separation);
    }
    return least;
}
