#include "point_list.h"

/* In units of the smaller shape: points nearer to each other than this are one. */
static const double MERGE_DISTANCE = 1e-3;
/* In units of the smaller shape: separations that differ by less are the same. */
static const double TIE = 4e-10;

pe_point_list pe_point_list_begin(pe_vec3 normal, double least, double margin, double size)
{
    pe_point_list list;
    list.normal = normal;
    list.least = least;
    list.margin = margin;
    list.size = size;
    list.least_margin = least;
    list.end_margin = HUGE_VAL;
    list.count = 0;
    return list;
}

/* Index of the point with the least separation. */
static int nearest_of(const pe_point_list *list)
{
    int nearest = 0;
    for (int i = 1; i < list->count; ++i) {
        nearest = list->item[i].separation < list->item[nearest].separation ? i : nearest;
    }
    return nearest;
}

static double square(pe_vec3 v)
{
    return pe_dot(v, v);
}

/* Keeps `most` points: the first, then whichever is farthest from all kept ones, and in any case
 * one with the least separation but for a tie. Where two are as far, the earlier one. */
static void reduce(pe_point_list *list, int most)
{
    int nearest = nearest_of(list), count = list->count;
    double enough = list->item[nearest].separation + TIE * list->size, apart[PE_POINT_LIST_ROOM];
    for (int i = 0; i < count; ++i) {
        apart[i] = HUGE_VAL;
    }
    unsigned kept = 0;
    bool has_nearest = false;
    int next = 0;
    for (int n = 0; n < most; ++n) {
        kept |= 1u << next;
        has_nearest = has_nearest || list->item[next].separation <= enough;
        int farthest = -1;
        for (int i = 0; i < count; ++i) {
            apart[i] =
                pe_min(apart[i], square(pe_sub(list->item[i].position, list->item[next].position)));
            bool is_free = (kept >> i & 1) == 0;
            if (is_free && (farthest < 0 || apart[i] > (1 + 1e-6) * apart[farthest])) {
                farthest = i;
            }
        }
        next = n + 2 == most && !has_nearest ? nearest : farthest;
    }
    list->count = 0;
    for (int i = 0; i < count; ++i) {
        if (kept >> i & 1) {
            list->item[list->count++] = list->item[i];
        }
    }
}

void pe_point_list_add(pe_point_list *list, pe_vec3 on_second, double separation, uint64_t feature)
{
    /* Points within the slack of the features' bounds may come out nearer than can be. */
    double s = pe_max(separation, list->least);
    if (s > list->margin) {
        list->end_margin = pe_min(list->end_margin, s);
        return;
    }
    list->least_margin = pe_max(list->least_margin, s);
    pe_vec3 x = pe_madd(on_second, -0.5 * s, list->normal);
    double merge = MERGE_DISTANCE * list->size;
    for (int i = 0; i < list->count; ++i) {
        pe_pair_point *other = &list->item[i];
        if (other->feature == feature) {
            if (s < other->separation) {
                *other = (pe_pair_point){x, s, feature};
            }
            return;
        }
        if (other->separation <= s + TIE * list->size &&
            square(pe_sub(other->position, x)) <= merge * merge) {
            return;
        }
    }
    if (list->count == PE_POINT_LIST_ROOM) {
        reduce(list, PE_MAX_POINTS);
    }
    list->item[list->count++] = (pe_pair_point){x, s, feature};
}

bool pe_point_list_has_nearest(const pe_point_list *list)
{
    return list->count > 0 &&
           list->item[nearest_of(list)].separation <= list->least + TIE * list->size;
}

void pe_point_list_finish(pe_point_list *list, const pe_pose *pose, bool flip,
                          pe_pair_manifold *hits)
{
    if (list->count > PE_MAX_POINTS) {
        reduce(list, PE_MAX_POINTS);
    }
    hits->normal = pe_rotate(&pose->rotation, pe_scale(flip ? -1 : 1, list->normal));
    hits->least_margin = list->least_margin;
    hits->end_margin = list->end_margin;
    hits->count = list->count;
    for (int i = 0; i < list->count; ++i) {
        hits->item[i] = list->item[i];
        hits->item[i].position =
            pe_add(pose->position, pe_rotate(&pose->rotation, list->item[i].position));
    }
}
