#include "far_copy.h"

#include "plumb/vec.h"
#include "referee/geometry/solid.h"

/* A normal that is square to the direction but for rounding. */
static const double SQUARE = 1e-12;

double pl_scene_size(const pl_scene *scene)
{
    pl_vec low = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            double r = pl_bounding_radius(&body->shape);
            pl_vec c = pl_centre_of_mass(&body->shape, body->position, body->orientation);
            low = (pl_vec){fmin(low.x, c.x - r), fmin(low.y, c.y - r), fmin(low.z, c.z - r)};
            high = (pl_vec){fmax(high.x, c.x + r), fmax(high.y, c.y + r), fmax(high.z, c.z + r)};
        }
    }
    return high.x > low.x ? pl_vec_length(pl_vec_sub(high, low)) : 1;
}

static bool fits(const pl_scene *scene, pl_vec direction)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        if (shape->kind == PL_SHAPE_PLANE &&
            fabs(pl_vec_dot(pl_vec_of(shape->normal), direction)) > SQUARE) {
            return false;
        }
    }
    return true;
}

/* The axes are tried first: along them the copy's places are rounded least. Planes that all map to
 * themselves along no axis leave one direction at most that is square to two of them, or, of one
 * plane alone, the level line in it. */
static bool find_direction(const pl_scene *scene, pl_vec *direction)
{
    static const pl_vec axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    pl_vec first = {0, 0, 0};
    for (int i = 0; i < 3; ++i) {
        *direction = axes[i];
        if (fits(scene, *direction)) {
            return true;
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        if (shape->kind == PL_SHAPE_PLANE) {
            pl_vec n = pl_vec_of(shape->normal);
            pl_vec other = pl_vec_length(first) > 0 ? first : axes[2];
            pl_vec across = pl_vec_cross(n, other);
            double length = pl_vec_length(across);
            *direction = pl_vec_scale(across, length > 0 ? 1 / length : 0);
            if (length > SQUARE && fits(scene, *direction)) {
                return true;
            }
            first = pl_vec_length(first) > 0 ? first : n;
        }
    }
    return false;
}

bool pl_far_offset(const pl_scene *scene, double sizes, double offset[3])
{
    pl_vec direction = {0, 0, 0};
    bool found = find_direction(scene, &direction);
    pl_vec_store(pl_vec_scale(direction, sizes * pl_scene_size(scene)), offset);
    return found;
}
