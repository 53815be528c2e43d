#include "agreement.h"

#include "plumb/vec.h"

static const double EXACT = 1e-9, CLOSE = 1e-3, PASSES = 1e-6;

const char *pl_grade_name(pl_grade grade)
{
    static const char *const names[] = {
        [PL_GRADE_BITWISE] = "bitwise", [PL_GRADE_EXACT] = "exact",
        [PL_GRADE_CLOSE] = "close",     [PL_GRADE_DIFFERS] = "differs",
        [PL_GRADE_FAILED] = "failed",   [PL_GRADE_INAPPLICABLE] = "inapplicable"};
    return names[grade];
}

pl_grade pl_difference_grade(const pl_difference *difference)
{
    const pl_difference *d = difference;
    if (d->same) {
        return PL_GRADE_BITWISE;
    }
    if (d->position <= EXACT && d->rotation <= EXACT) {
        return PL_GRADE_EXACT;
    }
    return d->position <= CLOSE && d->rotation <= CLOSE ? PL_GRADE_CLOSE : PL_GRADE_DIFFERS;
}

static bool same_numbers(const double *a, const double *b, int count, double sign)
{
    bool same = true;
    for (int i = 0; i < count; ++i) {
        same = same && a[i] == sign * b[i];
    }
    return same;
}

static void compare_body(const pl_body_state *a, const pl_body_state *b, pl_difference *d)
{
    double off = pl_vec_length(pl_vec_sub(pl_vec_of(a->position), pl_vec_of(b->position)));
    double turned = pl_angle_between(a->orientation, b->orientation);
    d->position = fmax(d->position, isnan(off) ? HUGE_VAL : off);
    d->rotation = fmax(d->rotation, isnan(turned) ? HUGE_VAL : turned);
    d->same = d->same && same_numbers(a->position, b->position, 3, 1) &&
              (same_numbers(a->orientation, b->orientation, 4, 1) ||
               same_numbers(a->orientation, b->orientation, 4, -1));
}

/* The frames that both stand at. */
static pl_difference compare_frames(const pl_trajectory_pair *c)
{
    pl_difference d = {.same = true};
    for (int i = 0; i < c->scene->body_count; ++i) {
        if (!c->scene->bodies[i].is_static) {
            pl_body_state back;
            int index = pl_transform_index(c->transform, i, c->scene->body_count);
            pl_transform_state_back(c->transform, &c->other->frame.bodies[index], &back);
            compare_body(&c->plain->frame.bodies[i], &back, &d);
        }
    }
    d.position /= c->size;
    return d;
}

pl_status pl_compare_trajectories(const pl_trajectory_pair *comparison, pl_agreement *agreement,
                                  pl_error *error)
{
    const pl_trajectory_pair *c = comparison;
    const long last = pl_scene_steps(c->scene) - c->first;
    const long early = last < 10 ? 1 : last / 10;
    bool same = true;
    *agreement = (pl_agreement){.passes_at = (double)NAN};
    pl_status status = pl_trajectory_rewind(c->plain, c->scene->body_count, error);
    if (status == PL_OK) {
        status = pl_trajectory_rewind(c->other, c->other_body_count, error);
    }
    if (status != PL_OK) {
        return status;
    }
    for (long i = 0; i < c->first; ++i) {
        pl_trajectory_next(c->plain);
    }
    for (long i = 0; i <= last; ++i) {
        if (!pl_trajectory_next(c->plain) || !pl_trajectory_next(c->other)) {
            return pl_fail(error, PL_FAILED, "%ld of %ld frames to compare", i, last + 1);
        }
        pl_difference now = compare_frames(c);
        same = same && now.same;
        now.same = same;
        if (isnan(agreement->passes_at) && !(now.position <= PASSES)) {
            agreement->passes_at = c->plain->frame.time;
        }
        if (i == early) {
            agreement->early = now;
        }
        if (i == last) {
            agreement->end = now;
        }
    }
    return PL_OK;
}
