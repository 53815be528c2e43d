/* A list of touches in the step's memory, and the manifolds made of it: touches with one normal
 * together, each manifold with at most PE_MAX_POINTS points. */
#include "touches.h"

#include "narrow_phase/tolerances.h"

#include <string.h>

/* ---- The list ---- */

pe_touch pe_touch_on_face(pe_touch_kind kind, int vertex, pe_vec3 x, const pe_facet *face,
                          double height)
{
    bool of_a = kind == PE_VERTEX_FACE;
    return pe_touch_make(kind, pe_touch_feature(kind, vertex, face->face),
                         of_a ? x : pe_madd(x, -height, face->normal),
                         of_a ? pe_scale(-1, face->normal) : face->normal, height);
}

void pe_touches_add(pe_touches *list, const pe_touch *touch)
{
    if (list->count == list->capacity && !list->failed) {
        enum { FIRST_CAPACITY = 64 };
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

/* Restores the heap below `root`. Heapsort (Williams 1964) sorts in place, in O(n log n). */
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

/* Halfway between the core of a and b. */
static pe_vec3 middle_of(const pe_touch *t, double radius)
{
    return pe_madd(t->on_a, 0.5 * (t->separation + radius), t->normal);
}

/* Whether another touch contradicts the overlap t. */
static bool is_contradicted(const pe_touches *list, const pe_touch *t, double radius, double size)
{
    double height = t->separation + radius, tie = PE_DEPTH_TIE * size;
    double near = PE_SAME_PLACE * height, most = pe_min(-height, PE_MESH_DEPTH * size);
    pe_vec3 x = middle_of(t, radius);
    for (int i = 0; i < list->count; ++i) {
        const pe_touch *other = &list->items[i];
        double h = other->separation + radius;
        if (!other->strict || other->dent || h <= height + tie || h > most) {
            continue;
        }
        pe_vec3 d = pe_sub(middle_of(other, radius), x);
        pe_vec3 across = pe_cross(other->normal, t->normal);
        if (pe_dot(d, d) <= near * near &&
            pe_dot(across, across) > PE_OTHER_DIRECTION * PE_OTHER_DIRECTION) {
            return true;
        }
    }
    return false;
}

void pe_touches_drop_merged(pe_touches *list)
{
    int kept = 0;
    for (int i = 0; i < list->count; ++i) {
        if (!list->items[i].merged) {
            list->items[kept++] = list->items[i];
        }
    }
    list->count = kept;
}

void pe_touches_drop_contradicted(pe_touches *list, double radius, double size)
{
    for (int i = 0; i < list->count; ++i) {
        pe_touch *t = &list->items[i];
        bool deep = t->separation + radius < -PE_DEPTH_TIE * size;
        t->merged = deep && !t->dent && is_contradicted(list, t, radius, size);
    }
    pe_touches_drop_merged(list);
}

double pe_touches_least(const pe_touches *list)
{
    double least = HUGE_VAL;
    for (int i = 0; i < list->count; ++i) {
        least = pe_min(least, list->items[i].separation);
    }
    return least;
}

/* ---- Manifolds ---- */

typedef struct gatherer {
    const pe_manifold_rules *rules;
    pe_vec3 normal;
    pe_pair_point *points; /* of one manifold, in the touches' axes */
    int count;
} gatherer;

/* Whether the touch may give a manifold its normal: its features face each other. Nearest points
 * and lines do, and so do the overlaps that are left. */
static bool leads(const pe_touch *t, const pe_manifold_rules *rules)
{
    return t->strict || t->kind > PE_EDGE_EDGE ||
           t->separation + rules->radius < -PE_MESH_POINT_TIE * rules->size;
}

static double bias(const pe_touch *t, double size)
{
    return t->kind == PE_FACE_VERTEX   ? 0
           : t->kind == PE_VERTEX_FACE ? PE_SECOND_FACE_BIAS * size
                                       : PE_EDGE_BIAS * size;
}

/* The touch that gives the next manifold its normal; -1: none is left. It is the one with the least
 * separation, preferably on a face of the first solid, then of the second: a body at rest then has
 * the same normal at every step. `must_lead`: only touches that may lead. */
static int find_leader(const pe_touches *list, const pe_manifold_rules *rules, bool must_lead)
{
    int leader = -1;
    double least = HUGE_VAL;
    for (int i = 0; i < list->count; ++i) {
        const pe_touch *t = &list->items[i];
        double value = t->separation + bias(t, rules->size);
        if (!t->merged && (leads(t, rules) || !must_lead) && value < least) {
            least = value;
            leader = i;
        }
    }
    return leader;
}

static bool same_normal(const pe_touch *t, pe_vec3 n, const pe_manifold_rules *rules)
{
    pe_vec3 c = pe_cross(t->normal, n);
    double length = rules->radius + fabs(t->separation), most = PE_ONE_NORMAL;
    if (t->kind > PE_EDGE_EDGE && length > 0) {
        most = pe_min(most, PE_ONE_LINE * rules->size / length);
    } else if (t->kind == PE_EDGE_EDGE && rules->radius > 0) {
        /* A turn about the core's edge moves the point along both edges, and may move it past an
         * end: the farther, the more parallel they are. */
        double sine = pe_length(pe_cross(t->along_a, t->along_b)) /
                      (pe_length(t->along_a) * pe_length(t->along_b));
        most = pe_min(most, PE_ONE_LINE * rules->size / length * sine);
    }
    return pe_dot(t->normal, n) > 0 && pe_dot(c, c) <= most * most;
}

/* The manifold point of a touch, seen along the manifold's normal: the same vertex and another
 * point of the face, or other points of the two edges. */
static pe_pair_point point_of(const gatherer *g, const pe_touch *t)
{
    double radius = g->rules->radius, height = t->separation + radius;
    double along = height / pe_dot(t->normal, g->normal);
    pe_vec3 shift = pe_sub(pe_scale(height, t->normal), pe_scale(along, g->normal));
    pe_vec3 on_a = t->on_a;
    if (t->kind == PE_FACE_VERTEX) {
        on_a = pe_add(on_a, shift);
    } else if (t->kind == PE_EDGE_EDGE) {
        pe_vec3 c = pe_cross(t->along_a, t->along_b);
        double s = pe_dot(pe_cross(shift, t->along_b), c) / pe_dot(c, c);
        on_a = pe_madd(on_a, s, t->along_a);
    }
    double separation = pe_max(along - radius, g->rules->least);
    return (pe_pair_point){
        .position = pe_madd(on_a, radius + 0.5 * separation, g->normal),
        .separation = separation,
        .feature = t->feature,
    };
}

/* Points at one place become one: the deeper one, or of equal ones the first. */
static void add_point(gatherer *g, pe_pair_point point)
{
    double merge = PE_MESH_MERGE * g->rules->size, tie = PE_MESH_POINT_TIE * g->rules->size;
    for (int i = 0; i < g->count; ++i) {
        pe_pair_point *other = &g->points[i];
        pe_vec3 d = pe_sub(point.position, other->position);
        if (pe_dot(d, d) > merge * merge) {
            continue;
        }
        if (point.separation < other->separation - tie) {
            *other = point;
        } else {
            other->separation = pe_min(other->separation, point.separation);
        }
        return;
    }
    g->points[g->count++] = point;
}

/* The polygon of the points kept so far, in order around the normal. */
typedef struct polygon {
    int corner[PE_MAX_POINTS], count;
} polygon;

/* The distance of point i outside the edge of the polygon between two points. */
static double outside(const gatherer *g, int from, int to, int i)
{
    pe_vec3 u = pe_sub(g->points[to].position, g->points[from].position);
    pe_vec3 out = pe_cross(u, g->normal);
    double length2 = pe_dot(out, out);
    pe_vec3 d = pe_sub(g->points[i].position, g->points[from].position);
    return length2 > 0 ? pe_dot(out, d) / sqrt(length2) : pe_length(d);
}

/* Adds the point that widens the polygon most (Eddy 1977). False: none does. */
static bool widen(const gatherer *g, double least, polygon *p)
{
    double most = PE_LEAST_WIDTH * g->rules->size, tie = most;
    int best = -1, place = 0;
    for (int i = 0; i < g->count; ++i) {
        double discount = PE_HEIGHT_WEIGHT * (g->points[i].separation - least);
        for (int k = 0; k < p->count; ++k) {
            int next = k + 1 < p->count ? k + 1 : 0;
            double width = outside(g, p->corner[k], p->corner[next], i) - discount;
            if (width > most + (best >= 0 ? tie : 0)) {
                most = width;
                best = i;
                place = k + 1;
            }
        }
    }
    if (best < 0) {
        return false;
    }
    for (int k = p->count; k > place; --k) {
        p->corner[k] = p->corner[k - 1];
    }
    p->corner[place] = best;
    p->count += 1;
    return true;
}

/* Keeps a deepest point and those that span the widest polygon, in their order. */
static void reduce(gatherer *g)
{
    double least = HUGE_VAL;
    for (int i = 0; i < g->count; ++i) {
        least = pe_min(least, g->points[i].separation);
    }
    polygon p = {.count = 1};
    while (g->points[p.corner[0]].separation > least + PE_MESH_POINT_TIE * g->rules->size) {
        p.corner[0] += 1;
    }
    g->points[p.corner[0]].separation = least;
    while (p.count < PE_MAX_POINTS && widen(g, least, &p)) {}
    int kept = 0;
    for (int i = 0; i < g->count; ++i) {
        for (int k = 0; k < p.count; ++k) {
            if (p.corner[k] == i) {
                g->points[kept++] = g->points[i];
                break;
            }
        }
    }
    g->count = kept;
}

/* Gathers the points of all touches that have the normal of the leader. */
static void gather(gatherer *g, pe_touches *list, int leader)
{
    g->normal = list->items[leader].normal;
    g->count = 0;
    for (int i = 0; i < list->count; ++i) {
        pe_touch *t = &list->items[i];
        if (!t->merged && same_normal(t, g->normal, g->rules)) {
            t->merged = true;
            add_point(g, point_of(g, t));
        }
    }
    if (g->count > PE_MAX_POINTS) {
        reduce(g);
    }
}

/* Drops the touches beyond the margin. Fills the range of margins of the manifold, which has the
 * same points in that range. */
static void drop_far(pe_touches *list, const pe_manifold_rules *rules, pe_pair_manifold *range)
{
    pe_pair_manifold_clear(range);
    range->end_margin = rules->end_margin;
    for (int i = 0; i < list->count; ++i) {
        double s = pe_max(list->items[i].separation, rules->least);
        list->items[i].merged =
            s > rules->limit || !pe_pair_manifold_within(range, s, rules->margin);
    }
    pe_touches_drop_merged(list);
}

/* Sorts by the first feature of each, so that the order does not depend on rounding. */
static void sort_manifolds(pe_pair_manifold *manifolds, int count)
{
    for (int i = 1; i < count; ++i) {
        for (int j = i; j > 0 && manifolds[j].item[0].feature < manifolds[j - 1].item[0].feature;
             --j) {
            pe_pair_manifold swap = manifolds[j];
            manifolds[j] = manifolds[j - 1];
            manifolds[j - 1] = swap;
        }
    }
}

int pe_touches_make_manifolds(pe_touches *list, const pe_manifold_rules *rules, const pe_pose *pose,
                              pe_pair_manifold *manifolds)
{
    pe_pair_manifold range;
    drop_far(list, rules, &range);
    if (list->count == 0 || list->failed) {
        return list->failed ? -1 : 0;
    }
    gatherer g = {.rules = rules};
    g.points = pe_take(list->work, (size_t)list->count, sizeof *g.points);
    if (g.points == NULL) {
        return -1;
    }
    int count = 0;
    bool must_lead = find_leader(list, rules, true) >= 0;
    for (; count < PE_MAX_MANIFOLDS; ++count) {
        int leader = find_leader(list, rules, must_lead);
        if (leader < 0) {
            break;
        }
        gather(&g, list, leader);
        pe_pair_manifold *manifold = &manifolds[count];
        manifold->normal = pe_rotate(&pose->rotation, g.normal);
        manifold->normal_on_b = list->items[leader].kind == PE_VERTEX_FACE;
        manifold->least_margin = range.least_margin;
        manifold->end_margin = range.end_margin;
        manifold->count = g.count;
        for (int i = 0; i < g.count; ++i) {
            manifold->item[i] = g.points[i];
            manifold->item[i].position = pe_pose_to_world(pose, g.points[i].position);
        }
    }
    sort_manifolds(manifolds, count);
    return count;
}
