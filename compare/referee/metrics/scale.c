/* Scales of a scene, from what is there at the start.
 *
 * The bound of speed: a body that loses all the height there is falls to v = sqrt(v0^2 + 2 |g| (H +
 * D)), D the diameter of the scene; in free fall over the whole run it gains |g| T, by the scene's
 * forces F T / m; and an elastic collision with far heavier bodies at most doubles a speed each
 * time. A bound of 100 v + 100 m/s + |g| T + F T / m lies beyond all of that, and an engine that
 * blows up, which it does exponentially, passes it within steps. */
#include "scale.h"

#include "referee/geometry/solid.h"

static pl_vec centre_of(const pl_body *body)
{
    return pl_centre_of_mass(&body->shape, body->position, body->orientation);
}

/* The span of the dynamic bodies' bounding spheres along a unit vector. */
static double span(const pl_scene *scene, pl_vec along)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            double s = pl_vec_dot(along, centre_of(body));
            double r = pl_bounding_radius(&body->shape);
            low = fmin(low, s - r);
            high = fmax(high, s + r);
        }
    }
    return high > low ? high - low : 0;
}

/* `spin` in the principal axes. */
static double kinetic_energy(const pl_body *body, pl_vec spin)
{
    pl_vec v = pl_vec_of(body->velocity);
    return (body->mass * pl_vec_dot(v, v) + body->inertia[0] * spin.x * spin.x +
            body->inertia[1] * spin.y * spin.y + body->inertia[2] * spin.z * spin.z) /
           2;
}

/* Largest impulse of the scene's forces on any one kilogram, m/s; their sum into *total, N s. */
static double force_speed(const pl_scene *scene, double *total)
{
    double speed = 0;
    *total = 0;
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        double time = fmin(force->until, scene->duration) - fmax(force->from, 0);
        double impulse = pl_vec_length(pl_vec_of(force->force)) * fmax(time, 0);
        *total += impulse;
        /* Off the centre of mass it turns the body too: count its lever arm in radii. */
        const pl_body *body = &scene->bodies[force->body];
        double r = pl_bounding_radius(&body->shape);
        double arm = pl_vec_length(pl_vec_of(force->at));
        double least = fmin(body->inertia[0], fmin(body->inertia[1], body->inertia[2]));
        if (!body->is_static) {
            speed += impulse / body->mass + (least > 0 ? impulse * arm * r / least : 0);
        }
    }
    return speed;
}

pl_scale pl_scale_of(const pl_scene *scene)
{
    pl_vec g = pl_vec_of(scene->gravity);
    pl_scale scale = {.gravity = pl_vec_length(g)};
    double mass = 0, fastest = 0, farthest = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->is_static) {
            continue;
        }
        double r = pl_bounding_radius(&body->shape);
        double v = pl_vec_length(pl_vec_of(body->velocity));
        pl_axes axes = pl_principal_axes(&body->shape, body->orientation);
        pl_vec spin = pl_to_local(&axes, pl_vec_of(body->angular_velocity));
        pl_vec turning = {body->inertia[0] * spin.x, body->inertia[1] * spin.y,
                          body->inertia[2] * spin.z};
        scale.dynamic_count += 1;
        scale.energy += kinetic_energy(body, spin);
        scale.momentum += body->mass * v + pl_vec_length(turning) / r;
        mass += body->mass;
        fastest = fmax(fastest, v + r * pl_vec_length(spin));
        farthest = fmax(farthest, pl_vec_length(centre_of(body)) + r);
    }
    double height = scale.gravity > 0 ? span(scene, pl_vec_scale(g, 1 / scale.gravity)) : 0;
    pl_vec spans = {span(scene, (pl_vec){1, 0, 0}), span(scene, (pl_vec){0, 1, 0}),
                    span(scene, (pl_vec){0, 0, 1})};
    double fall = 2 * scale.gravity * (height + pl_vec_length(spans));
    double impulse = 0;
    double pushed = force_speed(scene, &impulse);
    double weight = mass * scale.gravity;

    scale.energy += weight * height;
    scale.energy = scale.energy > 0 ? scale.energy : 1;
    scale.momentum = fmax(scale.momentum + weight * scene->duration + impulse, 1e-300);
    scale.angular_momentum = fmax(scale.momentum * farthest, 1e-300);
    scale.speed_bound =
        100 * sqrt(fastest * fastest + fall) + 100 + scale.gravity * scene->duration + pushed;
    return scale;
}
