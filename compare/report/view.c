/* Chooses the view of a scene. The directions come from the scene alone: `up` is against gravity;
 * `right` follows a slope or the principal axis of the bodies' horizontal spread. */
#include "picture.h"

#include <stdlib.h>
#include <string.h>

static const double radian = 0.017453292519943295; /* of a degree */

static const pl_vec zero = {0, 0, 0};

/* Returns `v` at unit length; `fallback` when `v` has no length. */
static pl_vec unit(pl_vec v, pl_vec fallback)
{
    double length = pl_vec_length(v);
    return length > 1e-12 && isfinite(length) ? pl_vec_scale(v, 1 / length) : fallback;
}

/* Returns cos(angle) a + sin(angle) b. */
static pl_vec turned(pl_vec a, pl_vec b, double angle)
{
    return pl_vec_mad(pl_vec_scale(a, cos(angle)), sin(angle), b);
}

pl_pose pl_pose_of(const pl_body *body)
{
    pl_pose pose;
    memcpy(pose.position, body->position, sizeof pose.position);
    memcpy(pose.orientation, body->orientation, sizeof pose.orientation);
    return pose;
}

int pl_expected_poses(const pl_scene *scene, pl_pose *poses, int *bodies)
{
    int count = 0;
    for (int i = 0; i < scene->rest_count; ++i, ++count) {
        const pl_expect_rest *rest = &scene->rests[i];
        poses[count] = pl_pose_of(&scene->bodies[rest->body]);
        bodies[count] = rest->body;
        memcpy(poses[count].position, rest->position, sizeof rest->position);
        if (rest->has_orientation) {
            memcpy(poses[count].orientation, rest->orientation, sizeof rest->orientation);
        }
    }
    for (int i = 0; i < scene->travel_count; ++i, ++count) {
        const pl_expect_travel *travel = &scene->travels[i];
        poses[count] = pl_pose_of(&scene->bodies[travel->body]);
        bodies[count] = travel->body;
        for (int k = 0; k < 3; ++k) {
            poses[count].position[k] += travel->distance * travel->direction[k];
        }
    }
    return count;
}

/* ---- Directions ---- */

/* Returns the outward normal of a static plane or box that is tilted against `up` by 0.5 to 80
 * degrees; zero when there is none. */
static pl_vec find_slope(const pl_scene *scene, pl_vec up)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static || body->shape.kind == PL_SHAPE_SPHERE) {
            continue;
        }
        pl_vec normal = zero;
        if (body->shape.kind == PL_SHAPE_PLANE) {
            normal = pl_vec_of(body->shape.normal);
        }
        const pl_axes axes = pl_axes_of(body->orientation);
        for (int k = 0; k < 3 && body->shape.kind == PL_SHAPE_BOX; ++k) {
            double rise = pl_vec_dot(axes.axis[k], up);
            if (fabs(rise) > pl_vec_dot(normal, up)) {
                normal = pl_vec_scale(axes.axis[k], rise < 0 ? -1 : 1);
            }
        }
        double cosine = pl_vec_dot(normal, up);
        if (cosine > cos(80 * radian) && cosine < cos(0.5 * radian)) {
            return normal;
        }
    }
    return zero;
}

/* Computes the bounds of a shape along its own axes, m. */
static void shape_bounds(const pl_shape *shape, double low[3], double high[3])
{
    double half[3] = {shape->radius, shape->radius, shape->radius};
    if (shape->kind == PL_SHAPE_BOX) {
        memcpy(half, shape->half_extents, sizeof half);
    } else if (shape->kind == PL_SHAPE_CAPSULE) {
        half[2] += shape->half_height;
    } else if (shape->kind == PL_SHAPE_CYLINDER) {
        half[2] = shape->half_height;
    }
    for (int k = 0; k < 3; ++k) {
        low[k] = -half[k];
        high[k] = half[k];
    }
    if (shape->kind != PL_SHAPE_HULL && shape->kind != PL_SHAPE_MESH) {
        return;
    }
    for (int k = 0; k < 3; ++k) {
        low[k] = high[k] = shape->polyhedron->vertices[0][k];
        for (int i = 1; i < shape->polyhedron->vertex_count; ++i) {
            low[k] = fmin(low[k], shape->polyhedron->vertices[i][k]);
            high[k] = fmax(high[k], shape->polyhedron->vertices[i][k]);
        }
    }
}

/* Computes the corners, in the world, of the smallest box along a shape's own axes that holds it.
 * Bit k of the index says which side of axis k. */
static void find_corners(const pl_shape *shape, const pl_pose *pose, pl_vec corners[8])
{
    const pl_axes axes = pl_axes_of(pose->orientation);
    double low[3], high[3];
    shape_bounds(shape, low, high);
    for (int i = 0; i < 8; ++i) {
        corners[i] = pl_vec_of(pose->position);
        for (int k = 0; k < 3; ++k) {
            corners[i] = pl_vec_mad(corners[i], (i >> k & 1) != 0 ? high[k] : low[k], axes.axis[k]);
        }
    }
}

/* Returns the principal axis of the spread of the moving bodies' corners in the plane of a and b;
 * `a` where the spread is nearly round. */
static pl_vec longest_axis(const pl_scene *scene, pl_vec a, pl_vec b)
{
    double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0, sum_yy = 0, count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        pl_pose pose = pl_pose_of(body);
        pl_vec corners[8];
        find_corners(&body->shape, &pose, corners);
        for (int k = 0; k < 8 && !body->is_static; ++k) {
            double x = pl_vec_dot(corners[k], a), y = pl_vec_dot(corners[k], b);
            sum_x += x;
            sum_y += y;
            sum_xx += x * x;
            sum_xy += x * y;
            sum_yy += y * y;
            ++count;
        }
    }
    if (count == 0) {
        return a;
    }
    double xx = sum_xx / count - sum_x / count * (sum_x / count);
    double xy = sum_xy / count - sum_x / count * (sum_y / count);
    double yy = sum_yy / count - sum_y / count * (sum_y / count);
    bool round = hypot(xx - yy, 2 * xy) < 0.1 * (xx + yy);
    return round ? a : turned(a, b, 0.5 * atan2(2 * xy, xx - yy));
}

static void choose_directions(const pl_scene *scene, pl_vec up, pl_view *view)
{
    const pl_vec x = {1, 0, 0}, y = {0, 1, 0};
    pl_vec slope = find_slope(scene, up);
    if (pl_vec_length(slope) > 0) {
        view->right = unit(pl_vec_reject(slope, up), x);
        view->up = up;
        view->toward = pl_vec_cross(view->right, up);
        return;
    }
    pl_vec level = unit(pl_vec_reject(fabs(up.x) < 0.9 ? x : y, up), x);
    pl_vec right = longest_axis(scene, level, pl_vec_cross(up, level));
    pl_vec front = pl_vec_cross(right, up);
    view->right = turned(right, front, -25 * radian);
    pl_vec turned_front = turned(front, right, 25 * radian);
    view->toward = turned(turned_front, up, 12 * radian);
    view->up = turned(up, turned_front, -12 * radian);
}

/* ---- Frame ---- */

/* Bounds of right and up coordinates, m. */
typedef struct bounds {
    double low[2], high[2];
} bounds;

static void include_body(const pl_view *view, const pl_shape *shape, const pl_pose *pose,
                         const bounds *limit, bounds *box)
{
    pl_vec corners[8];
    if (shape->kind == PL_SHAPE_PLANE) {
        return;
    }
    find_corners(shape, pose, corners);
    for (int i = 0; i < 8; ++i) {
        double at[2] = {pl_vec_dot(corners[i], view->right), pl_vec_dot(corners[i], view->up)};
        if (!isfinite(at[0]) || !isfinite(at[1])) {
            return;
        }
        for (int k = 0; k < 2; ++k) {
            double value = limit == NULL ? at[k] : fmin(fmax(at[k], limit->low[k]), limit->high[k]);
            box->low[k] = fmin(box->low[k], value);
            box->high[k] = fmax(box->high[k], value);
        }
    }
}

/* Returns the pose of a body in `poses`; where that is NULL, at the start. */
static pl_pose pose_in(const pl_scene *scene, const pl_pose *poses, int body)
{
    return poses == NULL ? pl_pose_of(&scene->bodies[body]) : poses[body];
}

static void include_moving(const pl_view *view, const pl_scene *scene, const pl_pose *poses,
                           const bounds *limit, bounds *box)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_pose pose = pose_in(scene, poses, i);
        if (!scene->bodies[i].is_static) {
            include_body(view, &scene->bodies[i].shape, &pose, limit, box);
        }
    }
}

static void include_expected(const pl_view *view, const pl_scene *scene, bounds *box)
{
    int count = scene->rest_count + scene->travel_count;
    pl_pose *poses = calloc((size_t)count + 1, sizeof *poses);
    int *bodies = calloc((size_t)count + 1, sizeof *bodies);
    if (poses != NULL && bodies != NULL) {
        pl_expected_poses(scene, poses, bodies);
        for (int i = 0; i < count; ++i) {
            include_body(view, &scene->bodies[bodies[i]].shape, &poses[i], NULL, box);
        }
    }
    free(poses);
    free(bodies);
}

static void choose_frame(const bounds *box, pl_view *view)
{
    const double most_width = 368, most_height = 300, least = 150, margin = 12;
    double wide = fmax(box->high[0] - box->low[0], 1e-9);
    double tall = fmax(box->high[1] - box->low[1], 1e-9);
    view->scale = fmin((most_width - 2 * margin) / wide, (most_height - 2 * margin) / tall);
    view->width = ceil(fmax(least, wide * view->scale + 2 * margin));
    view->height = ceil(fmax(least, tall * view->scale + 2 * margin));
    view->left = 0.5 * (box->low[0] + box->high[0]) - 0.5 * view->width / view->scale;
    view->top = 0.5 * (box->low[1] + box->high[1]) + 0.5 * view->height / view->scale;
}

static bounds widened(const bounds *box, double by)
{
    return (bounds){{box->low[0] - by, box->low[1] - by}, {box->high[0] + by, box->high[1] + by}};
}

/* Returns the largest half extent of a moving body, m. */
static double largest_body(const pl_scene *scene)
{
    double largest = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        if (scene->bodies[i].is_static) {
            continue;
        }
        double low[3], high[3];
        shape_bounds(shape, low, high);
        for (int k = 0; k < 3; ++k) {
            largest = fmax(largest, (high[k] - low[k]) / 2);
        }
    }
    return largest;
}

/* Returns the mean, at the start, of the centres of the moving bodies' boxes. */
static pl_vec start_centre(const pl_scene *scene)
{
    pl_vec sum = zero;
    int count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_pose pose = pl_pose_of(&scene->bodies[i]);
        pl_vec corners[8];
        if (!scene->bodies[i].is_static) {
            find_corners(&scene->bodies[i].shape, &pose, corners);
            sum = pl_vec_add(sum, pl_vec_scale(pl_vec_add(corners[0], corners[7]), 0.5));
            ++count;
        }
    }
    return pl_vec_scale(sum, 1.0 / (count > 0 ? count : 1));
}

/* Extends the reach to the corners of moving bodies that lie in the frame. */
static void include_reach(const pl_scene *scene, const pl_pose *poses, pl_vec up, pl_view *view)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_pose pose = pose_in(scene, poses, i);
        pl_vec corners[8];
        find_corners(&scene->bodies[i].shape, &pose, corners);
        for (int k = 0; k < 8 && !scene->bodies[i].is_static; ++k) {
            pl_pixel at = pl_view_project(view, corners[k]);
            pl_vec from = pl_vec_mad(corners[k], -1, view->centre);
            if (at.x >= 0 && at.y >= 0 && at.x <= view->width && at.y <= view->height) {
                view->reach = fmax(view->reach, pl_vec_length(pl_vec_reject(from, up)));
            }
        }
    }
}

pl_view pl_view_choose(const pl_scene *scene, const pl_pose *const *runs, int run_count)
{
    const pl_vec z = {0, 0, 1}; /* up where there is no gravity */
    const pl_vec up = unit(pl_vec_scale(pl_vec_of(scene->gravity), -1), z);
    pl_view view = {0};
    choose_directions(scene, up, &view);
    bounds box = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    include_moving(&view, scene, NULL, NULL, &box);
    include_expected(&view, scene, &box);
    if (!isfinite(box.low[0])) {
        box = (bounds){{-1, -1}, {1, 1}};
    }
    /* A margin, so that a single body has surroundings. */
    bounds limit = widened(&box, fmax(box.high[0] - box.low[0], box.high[1] - box.low[1]));
    box = widened(&box, 0.5 * largest_body(scene));
    for (int r = 0; r < run_count; ++r) {
        if (runs[r] != NULL) {
            include_moving(&view, scene, runs[r], &limit, &box);
        }
    }
    choose_frame(&box, &view);
    view.centre = start_centre(scene);
    include_reach(scene, NULL, up, &view);
    for (int r = 0; r < run_count; ++r) {
        if (runs[r] != NULL) {
            include_reach(scene, runs[r], up, &view);
        }
    }
    return view;
}

pl_pixel pl_view_project(const pl_view *view, pl_vec point)
{
    return (pl_pixel){(pl_vec_dot(point, view->right) - view->left) * view->scale,
                      (view->top - pl_vec_dot(point, view->up)) * view->scale};
}

double pl_pixel_turn(pl_pixel o, pl_pixel a, pl_pixel b)
{
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}
