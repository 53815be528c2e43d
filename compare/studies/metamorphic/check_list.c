/* The table of checks, and their transforms. */
#include "metamorphic.h"

#include "base/heap.h"

#include <string.h>

const pl_check pl_checks[PL_CHECK_COUNT] = {
    {"again", "again", PL_CHECK_AGAIN, 0, 0},
    {"rotate-z90", "rotate", PL_CHECK_ROTATE, 2, 2},
    {"rotate-z45", "rotate", PL_CHECK_ROTATE, 1, 2},
    {"rotate-x90", "rotate", PL_CHECK_ROTATE, 2, 0},
    {"mirror", "mirror", PL_CHECK_MIRROR, 0, 0},
    {"order-reverse", "order", PL_CHECK_ORDER, PL_ORDER_REVERSED, 0},
    {"order-shuffle", "order", PL_CHECK_ORDER, PL_ORDER_SHUFFLED, 0},
    {"far", "far", PL_CHECK_FAR, 1e4, 0},
    {"scale-10", "scale", PL_CHECK_SCALE, 10, 0},
    {"scale-0.1", "scale", PL_CHECK_SCALE, 0.1, 0},
    {"shift-1e3", "shift", PL_CHECK_SHIFT, 1e3, 0},
    {"shift-1e4", "shift", PL_CHECK_SHIFT, 1e4, 0},
    {"shift-1e5", "shift", PL_CHECK_SHIFT, 1e5, 0},
    {"shift-1e6", "shift", PL_CHECK_SHIFT, 1e6, 0},
    {"shift-1e7", "shift", PL_CHECK_SHIFT, 1e7, 0},
    {"restart", "restart", PL_CHECK_RESTART, 0, 0},
    {"split-x", "split", PL_CHECK_SPLIT, 0, 0},
    {"split-y", "split", PL_CHECK_SPLIT, 0, 1},
    {"split-z", "split", PL_CHECK_SPLIT, 0, 2},
    {"tessellate-1", "tessellate", PL_CHECK_TESSELLATE, 1, 0},
    {"tessellate-8", "tessellate", PL_CHECK_TESSELLATE, 8, 0},
    {"late-0.25", "late", PL_CHECK_LATE, 0.25, 0},
    {"late-0.5", "late", PL_CHECK_LATE, 0.5, 0},
    {"late-0.75", "late", PL_CHECK_LATE, 0.75, 0},
};

static pl_status choose(const char *name, bool *chosen, pl_error *error)
{
    const char *names[2 * PL_CHECK_COUNT];
    bool found = false;
    for (int i = 0; i < PL_CHECK_COUNT; ++i) {
        names[2 * i] = pl_checks[i].name;
        names[2 * i + 1] = pl_checks[i].family;
        if (strcmp(name, pl_checks[i].name) == 0 || strcmp(name, pl_checks[i].family) == 0) {
            chosen[i] = true;
            found = true;
        }
    }
    if (found) {
        return PL_OK;
    }
    const char *nearest = pl_nearest_name(name, names, 2 * PL_CHECK_COUNT);
    return pl_fail(error, PL_BAD_INPUT,
                   "unknown check \"%s\"%s%s%s; there are again, rotate, mirror, order, far, "
                   "scale, shift, restart, split, tessellate and late",
                   name, nearest == NULL ? "" : "; did you mean \"", nearest == NULL ? "" : nearest,
                   nearest == NULL ? "" : "\"?");
}

pl_status pl_checks_choose(const char *const *names, int count, bool **chosen, pl_error *error)
{
    pl_status status = PL_OK;
    *chosen = pl_heap_new(PL_CHECK_COUNT, sizeof **chosen);
    memset(*chosen, count == 0, PL_CHECK_COUNT * sizeof **chosen);
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = choose(names[i], *chosen, error);
    }
    return status;
}

const char *pl_check_transform(const pl_check *check, const pl_scene *scene,
                               pl_transform *transform)
{
    *transform = pl_transform_identity();
    switch (check->kind) {
    case PL_CHECK_ROTATE:
        *transform = pl_transform_rotation(check->axis, (int)check->amount);
        break;
    case PL_CHECK_SHIFT:
        transform->shift[0] = check->amount;
        break;
    case PL_CHECK_SCALE:
        transform->scale = check->amount;
        break;
    case PL_CHECK_ORDER:
        transform->order = (pl_body_order)check->amount;
        break;
    case PL_CHECK_FAR:
        transform->has_copy = pl_far_offset(scene, check->amount, transform->copy_offset);
        return transform->has_copy ? NULL
                                   : "planes stand in all directions: a far copy would meet them";
    case PL_CHECK_MIRROR:
        *transform = pl_transform_mirror();
        break;
    default:
        break;
    }
    return NULL;
}

/* The scene with its static boxes divided, if there are any, and no more than can be. */
static pl_status divide(const pl_check *check, const pl_scene *plain, pl_scene *scene,
                        const char **reason, pl_error *error)
{
    const double boxes = pl_static_box_count(plain);
    const bool splits = check->kind == PL_CHECK_SPLIT;
    const bool fits = splits ? plain->body_count + boxes <= PL_MAX_BODIES
                             : 12 * check->amount * check->amount * boxes <= PL_MAX_SCENE_TRIANGLES;
    if (boxes == 0 || !fits) {
        *reason = boxes == 0 ? "there is no static box" : "there are too many static boxes";
        return PL_OK;
    }
    return splits ? pl_split_boxes(plain, check->axis, scene, error)
                  : pl_tessellate_boxes(plain, (int)check->amount, scene, error);
}

pl_status pl_check_scene(const pl_check *check, const pl_scene *plain, pl_transform *transform,
                         pl_scene *scene, const char **reason, pl_error *error)
{
    *reason = pl_check_transform(check, plain, transform);
    if (*reason != NULL) {
        return PL_OK;
    }
    switch (check->kind) {
    case PL_CHECK_RESTART:
        *reason = pl_scene_steps(plain) < 2 ? "a run of one step has no half time" : NULL;
        return PL_OK;
    case PL_CHECK_SPLIT:
    case PL_CHECK_TESSELLATE:
        return divide(check, plain, scene, reason, error);
    case PL_CHECK_LATE:
        return pl_late_start(plain, check->amount, scene, reason, error);
    default:
        return pl_transform_scene(transform, plain, scene, error);
    }
}
