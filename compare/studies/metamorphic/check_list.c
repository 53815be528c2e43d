/* The table of checks, and their transforms. */
#include "check_list.h"

#include "divide.h"
#include "late_start.h"
#include "transform.h"

#include <string.h>

static const pl_check checks[] = {
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
enum { CHECK_COUNT = sizeof checks / sizeof checks[0] };

const pl_check *pl_checks(int *count)
{
    *count = CHECK_COUNT;
    return checks;
}

pl_status pl_check_choose(const char *name, bool *chosen, pl_error *error)
{
    const char *names[2 * CHECK_COUNT];
    bool found = false;
    for (int i = 0; i < CHECK_COUNT; ++i) {
        names[2 * i] = checks[i].name;
        names[2 * i + 1] = checks[i].family;
        if (strcmp(name, checks[i].name) == 0 || strcmp(name, checks[i].family) == 0) {
            chosen[i] = true;
            found = true;
        }
    }
    if (found) {
        return PL_OK;
    }
    const char *nearest = pl_nearest_name(name, names, 2 * CHECK_COUNT);
    return pl_fail(error, PL_BAD_INPUT,
                   "unknown check \"%s\"%s%s%s; there are again, rotate, mirror, order, far, "
                   "scale, shift, restart, split, tessellate and late",
                   name, nearest == NULL ? "" : "; did you mean \"", nearest == NULL ? "" : nearest,
                   nearest == NULL ? "" : "\"?");
}

/* Whether there are static boxes, no more than can be divided. */
static bool has_boxes(const pl_check *check, const pl_scene *scene, const char **reason)
{
    const double boxes = pl_static_box_count(scene);
    const bool fits = check->kind == PL_CHECK_SPLIT
                          ? scene->body_count + boxes <= PL_MAX_BODIES
                          : 12 * check->amount * check->amount * boxes <= PL_MAX_SCENE_TRIANGLES;
    *reason = boxes == 0 ? "there is no static box" : "there are too many static boxes";
    return boxes > 0 && fits;
}

bool pl_check_transform(const pl_check *check, const pl_scene *scene, pl_transform *transform,
                        const char **reason)
{
    double offset[3];
    *transform = pl_transform_identity();
    switch (check->kind) {
    case PL_CHECK_ROTATE:
        *transform = pl_transform_rotation(check->axis, (int)check->amount);
        break;
    case PL_CHECK_SHIFT:
        *transform = pl_transform_shift(check->amount, 0, 0);
        break;
    case PL_CHECK_SCALE:
        *transform = pl_transform_scaling(check->amount);
        break;
    case PL_CHECK_ORDER:
        *transform = pl_transform_order((pl_body_order)check->amount);
        break;
    case PL_CHECK_FAR:
        if (!pl_far_offset(scene, check->amount, offset)) {
            *reason = "planes stand in all directions: a far copy would meet them";
            return false;
        }
        *transform = pl_transform_copy(offset);
        break;
    case PL_CHECK_MIRROR:
        *transform = pl_transform_mirror();
        break;
    case PL_CHECK_AGAIN:
        break;
    case PL_CHECK_RESTART:
        if (pl_scene_steps(scene) < 2) {
            *reason = "a run of one step has no half time";
            return false;
        }
        break;
    case PL_CHECK_SPLIT:
    case PL_CHECK_TESSELLATE:
        return has_boxes(check, scene, reason);
    case PL_CHECK_LATE:
        return pl_late_start_is_known(scene, check->amount, reason);
    }
    return true;
}
