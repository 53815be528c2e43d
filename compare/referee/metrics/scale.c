/* Scales of a scene from its initial state, and the validity checks of a frame.
 *
 * The speed bound: a body that falls through the whole scene reaches v = sqrt(v0^2 + 2 |g| (H +
 * D)), where H is the height of the scene and D its diameter. In free fall over the whole run it
 * gains |g| T, by the scene's forces F T / m, and an elastic collision with far heavier bodies at
 * most doubles its speed. The bound 100 v + 100 m/s + |g| T + F T / m is beyond all of these. The
 * speed of an unstable engine grows exponentially and passes the bound within a few steps.
 *
 * No place is farther from where the body began than that speed and the duration take it. Bodies that
 * overlap are moved apart without a speed: that is what D and 100 m are added for. */
#include "mechanics.h"

#include "referee/geometry/solid.h"

static const double MAX_ENERGY_GAIN = 10;
static const double ROOM = 100; /* m */

static pl_vec centre_of(const pl_body *body)
{
    return pl_centre_of_mass(&body->shape, body->position, body->orientation);
}

/* The extent of the dynamic bodies' bounding spheres along a unit vector, m. */
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

/* An upper bound of the speed that the scene's forces give to any point, m/s. The sum of their
 * impulses goes into *total, N s. */
static double force_speed(const pl_scene *scene, double *total)
{
    double speed = 0;
    *total = 0;
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        double time = fmin(force->until, scene->duration) - fmax(force->from, 0);
        double impulse = pl_vec_length(pl_vec_of(force->force)) * fmax(time, 0);
        *total += impulse;
        /* A force off the centre of mass also turns the body, whose surface gains speed. */
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
    pl_scale scale = {0};
    const double gravity = pl_vec_length(g);
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
        scale.energy += pl_kinetic_energy(body, body->velocity, spin);
        scale.momentum += body->mass * v + pl_vec_length(turning) / r;
        mass += body->mass;
        fastest = fmax(fastest, v + r * pl_vec_length(spin));
        farthest = fmax(farthest, pl_vec_length(centre_of(body)) + r);
    }
    double height = gravity > 0 ? span(scene, pl_vec_scale(g, 1 / gravity)) : 0;
    pl_vec spans = {span(scene, (pl_vec){1, 0, 0}), span(scene, (pl_vec){0, 1, 0}),
                    span(scene, (pl_vec){0, 0, 1})};
    const double diameter = pl_vec_length(spans);
    double fall = 2 * gravity * (height + diameter);
    double impulse = 0;
    double pushed = force_speed(scene, &impulse);
    double weight = mass * gravity;

    scale.energy += weight * height;
    scale.energy = scale.energy > 0 ? scale.energy : 1;
    scale.momentum = fmax(scale.momentum + weight * scene->duration + impulse, 1e-300);
    scale.angular_momentum = fmax(scale.momentum * farthest, 1e-300);
    scale.speed_bound =
        100 * sqrt(fastest * fastest + fall) + 100 + gravity * scene->duration + pushed;
    scale.travel_bound = scale.speed_bound * scene->duration + diameter + ROOM;
    return scale;
}

/* ---- Validity checks ---- */

static bool is_finite(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* Whether what an engine says of a static body can be written: it is not judged otherwise. */
static bool is_pose_finite(const pl_body_state *s)
{
    return is_finite(s->position) && is_finite(s->orientation) && isfinite(s->orientation[3]);
}

/* The name of the first invalid part of a state, or NULL. */
static const char *invalid_part(const pl_body_state *s)
{
    double norm = 0;
    for (int i = 0; i < 4; ++i) {
        norm += s->orientation[i] * s->orientation[i];
    }
    if (!is_finite(s->position)) {
        return "position";
    }
    if (!(norm >= 0.5 && norm <= 2)) {
        return "orientation";
    }
    if (!is_finite(s->velocity)) {
        return "velocity";
    }
    return is_finite(s->angular_velocity) ? NULL : "angular velocity";
}

pl_ending pl_check_finite(const pl_scene *scene, const pl_body_state *bodies, long step,
                          pl_error *error)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const char *invalid = !scene->bodies[i].is_static  ? invalid_part(&bodies[i])
                              : is_pose_finite(&bodies[i]) ? NULL
                                                           : "pose";
        if (invalid != NULL) {
            (void)pl_fail(error, PL_FAILED, "the %s of body \"%s\" is %s at step %ld", invalid,
                          scene->bodies[i].name,
                          invalid[0] == 'o' ? "no rotation" : "not a finite number", step);
            return PL_ENDING_NONFINITE;
        }
    }
    return PL_ENDING_OK;
}

pl_ending pl_check_bounds(const pl_scene *scene, const pl_scale *scale, const pl_body_state *bodies,
                          double energy_gain, long step, pl_error *error)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        double speed =
            pl_vec_length(pl_vec_of(bodies[i].velocity)) +
            pl_bounding_radius(&body->shape) * pl_vec_length(pl_vec_of(bodies[i].angular_velocity));
        double travel =
            pl_vec_length(pl_vec_sub(pl_vec_of(bodies[i].position), pl_vec_of(body->position)));
        if (!body->is_static && !(speed <= scale->speed_bound)) {
            (void)pl_fail(error, PL_FAILED,
                          "body \"%s\" moves at %.3g m/s at step %ld, beyond the scene's %.3g m/s",
                          body->name, speed, step, scale->speed_bound);
            return PL_ENDING_DIVERGED;
        }
        if (!body->is_static && !(travel <= scale->travel_bound)) {
            (void)pl_fail(error, PL_FAILED,
                          "body \"%s\" is %.3g m from where it began at step %ld, beyond the "
                          "scene's %.3g m",
                          body->name, travel, step, scale->travel_bound);
            return PL_ENDING_DIVERGED;
        }
    }
    if (!(energy_gain <= MAX_ENERGY_GAIN)) {
        (void)pl_fail(error, PL_FAILED,
                      "energy has grown by %.3g times the scene's %.3g J at step %ld", energy_gain,
                      scale->energy, step);
        return PL_ENDING_DIVERGED;
    }
    return PL_ENDING_OK;
}
