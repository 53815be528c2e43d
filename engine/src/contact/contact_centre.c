#include "contact_centre.h"

static const double FAR = 0.5; /* margin, in units of the smaller body's bounding radius */
static const uint64_t CENTRE_FEATURE = UINT64_MAX;

static const pe_pair_point *deepest(const pe_pair_manifold *hits)
{
    const pe_pair_point *least = &hits->item[0];
    for (int i = 1; i < hits->count; ++i) {
        least = hits->item[i].separation < least->separation ? &hits->item[i] : least;
    }
    return least;
}

/* The least separated points stay. */
static void drop_farthest(pe_pair_manifold *hits)
{
    int farthest = 0;
    for (int i = 1; i < hits->count; ++i) {
        farthest = hits->item[i].separation > hits->item[farthest].separation ? i : farthest;
    }
    hits->count -= 1;
    for (int i = farthest; i < hits->count; ++i) {
        hits->item[i] = hits->item[i + 1];
    }
}

void pe_pair_manifold_hold_centre(pe_pair_manifold *hits, const pe_body *a, const pe_pose *pose_a,
                                  const pe_body *b, const pe_pose *pose_b, double margin)
{
    double ra = a->bounding_radius, rb = b->bounding_radius;
    bool b_is_smaller = ra == 0 || (rb > 0 && rb <= ra);
    double from = FAR * (b_is_smaller ? rb : ra);
    if (margin < from) {
        hits->end_margin = pe_min(hits->end_margin, from);
        return;
    }
    /* The plane through the other body's nearest point, and the centre's height over it. */
    const pe_pair_point *hit = deepest(hits);
    pe_vec3 out = b_is_smaller ? hits->normal : pe_scale(-1, hits->normal);
    pe_vec3 centre = b_is_smaller ? pose_b->position : pose_a->position;
    pe_vec3 on_other = pe_madd(hit->position, -0.5 * hit->separation, out);
    double height = pe_dot(out, pe_sub(centre, on_other));
    if (height <= 0) {
        hits->least_margin = pe_max(hits->least_margin, from);
    } else if (height > margin) {
        hits->end_margin = pe_min(hits->end_margin, height);
    } else {
        hits->least_margin = pe_max(hits->least_margin, pe_max(from, height));
        if (hits->count == PE_MAX_POINTS) {
            drop_farthest(hits);
        }
        hits->item[hits->count++] = (pe_pair_point){
            .position = pe_madd(centre, -0.5 * height, out),
            .separation = height,
            .feature = CENTRE_FEATURE,
        };
    }
}
