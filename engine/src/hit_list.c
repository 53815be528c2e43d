#include "hit_list.h"

/* In units of the smaller shape: points nearer to each other than this are one. */
static const double MERGE_DISTANCE = 1e-3;
/* In units of the smaller shape: separations that differ by less are the same. */
static const double TIE = 4e-10;

pe_hit_list pe_hit_list_begin(pe_vec3 normal, double least, double margin, double size)
{
    pe_hit_list patch;
    patch.normal = normal;
    patch.least = least;
    patch.margin = margin;
    patch.size = size;
    patch.least_margin = least;
    patch.end_margin = HUGE_VAL;
    patch.count = 0;
    return patch;
}

/* Index of the point with the least separation. */
static int nearest_of(const pe_hit_list *patch)
{
    int nearest = 0;
    for (int i = 1; i < patch->count; ++i) {
        nearest = patch->item[i].separation < patch->item[nearest].separation ? i : nearest;
    }
    return nearest;
}

static double square(pe_vec3 v)
{
    return pe_dot(v, v);
}

/* Keeps `most` points: the first, then whichever is farthest from all kept ones, the nearest to
 * touching in any case. Where two are as far but for a tie, the earlier one. */
static void reduce(pe_hit_list *patch, int most)
{
    int nearest = nearest_of(patch), count = patch->count;
    double apart[PE_HIT_LIST_ROOM];
    for (int i = 0; i < count; ++i) {
        apart[i] = HUGE_VAL;
    }
    unsigned kept = 0;
    int next = 0;
    for (int n = 0; n < most; ++n) {
        kept |= 1u << next;
        int farthest = -1;
        for (int i = 0; i < count; ++i) {
            pe_vec3 d = pe_sub(patch->item[i].position, patch->item[next].position);
            apart[i] = pe_min(apart[i], square(d));
            bool free = (kept >> i & 1) == 0;
            if (free && (farthest < 0 || apart[i] > (1 + 1e-6) * apart[farthest])) {
                farthest = i;
            }
        }
        next = n + 2 == most && (kept >> nearest & 1) == 0 ? nearest : farthest;
    }
    patch->count = 0;
    for (int i = 0; i < count; ++i) {
        if (kept >> i & 1) {
            patch->item[patch->count++] = patch->item[i];
        }
    }
}

void pe_hit_list_add(pe_hit_list *patch, pe_vec3 on_second, double separation, uint64_t feature)
{
    /* Points within the slack of the features' bounds may come out nearer than can be. */
    double s = pe_max(separation, patch->least);
    if (s > patch->margin) {
        patch->end_margin = pe_min(patch->end_margin, s);
        return;
    }
    patch->least_margin = pe_max(patch->least_margin, s);
    pe_vec3 x = pe_madd(on_second, -0.5 * s, patch->normal);
    double merge = MERGE_DISTANCE * patch->size;
    for (int i = 0; i < patch->count; ++i) {
        const pe_hit *other = &patch->item[i];
        if (other->separation <= s + TIE * patch->size &&
            square(pe_sub(other->position, x)) <= merge * merge) {
            return;
        }
    }
    if (patch->count == PE_HIT_LIST_ROOM) {
        reduce(patch, PE_MAX_POINTS);
    }
    patch->item[patch->count++] = (pe_hit){x, s, feature};
}

void pe_hit_list_add_nearest(pe_hit_list *patch, pe_vec3 on_second, uint64_t feature)
{
    double tie = TIE * patch->size;
    if (patch->count == 0 || patch->item[nearest_of(patch)].separation > patch->least + tie) {
        pe_hit_list_add(patch, on_second, patch->least, feature);
    }
}

void pe_hit_list_finish(pe_hit_list *patch, const pe_pose *pose, bool flip, pe_hits *hits)
{
    if (patch->count > PE_MAX_POINTS) {
        reduce(patch, PE_MAX_POINTS);
    }
    hits->normal = pe_rotate(&pose->rotation, pe_scale(flip ? -1 : 1, patch->normal));
    hits->least_margin = patch->least_margin;
    hits->end_margin = patch->end_margin;
    hits->count = patch->count;
    for (int i = 0; i < patch->count; ++i) {
        hits->item[i] = patch->item[i];
        hits->item[i].position =
            pe_add(pose->position, pe_rotate(&pose->rotation, patch->item[i].position));
    }
}
