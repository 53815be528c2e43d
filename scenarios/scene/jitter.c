#include "plumb/jitter.h"

#include "base/random.h"
#include "plumb/vec.h"
#include "scene_internal.h"

#include <math.h>

static double draw(pl_random *random)
{
    return 2 * pl_random_unit(random) - 1;
}

/* Uniform in the unit ball, by rejection. */
static pl_vec draw_in_ball(pl_random *random)
{
    pl_vec v;
    do {
        v.x = draw(random);
        v.y = draw(random);
        v.z = draw(random);
    } while (pl_vec_dot(v, v) > 1);
    return v;
}

/* Where the centre of mass lies from the shape's frame, in the world. */
static pl_vec centre_arm(const pl_body *body)
{
    if (body->shape.polyhedron == NULL) {
        return (pl_vec){0, 0, 0};
    }
    const pl_axes axes = pl_axes_of(body->orientation);
    return pl_to_world(&axes, pl_vec_of(body->shape.polyhedron->centre));
}

/* Turns by 2 atan(|v| / 2) <= |v| about v in the world: Cayley's formula, which needs no function
 * but the square root. */
static void turn(double q[4], pl_vec v)
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const pl_vec h = pl_vec_scale(v, 0.5);
    q[0] = w - h.x * x - h.y * y - h.z * z;
    q[1] = x + h.x * w + h.y * z - h.z * y;
    q[2] = y + h.y * w + h.z * x - h.x * z;
    q[3] = z + h.z * w + h.x * y - h.y * x;
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int k = 0; k < 4; ++k) {
        q[k] /= length;
    }
}

static void jitter_body(pl_body *body, pl_random *random)
{
    const double reach = pl_jitter_amplitude * 2 * pl_shape_half_width(&body->shape);
    pl_vec centre = pl_vec_add(pl_vec_of(body->position), centre_arm(body));
    centre.x += reach * draw(random);
    centre.y += reach * draw(random);
    centre.z += reach * draw(random);
    turn(body->orientation, pl_vec_scale(draw_in_ball(random), pl_jitter_amplitude));
    pl_vec_store(pl_vec_sub(centre, centre_arm(body)), body->position);
}

void pl_scene_jitter(pl_scene *scene, uint64_t seed, int member)
{
    /* A member's own seed is its number in the stream of the ensemble's. */
    pl_random seeds = {.state = seed};
    pl_random random = {.state = pl_random_bits(&seeds)};
    for (int k = 0; k < member; ++k) {
        random.state = pl_random_bits(&seeds);
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            jitter_body(&scene->bodies[i], &random);
        }
    }
}

double pl_scene_least_size(const pl_scene *scene)
{
    double least = (double)INFINITY;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            least = fmin(least, 2 * pl_shape_half_width(&body->shape));
        }
    }
    return least;
}
