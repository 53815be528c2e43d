/* Motion that nothing explains: how much farther a body moved in a step than the speeds of its
 * island, gravity, the scene's forces and the overlaps of its island allow; and by how much the
 * velocity of a body in free flight changed otherwise than by gravity.
 *
 * In a step of h the centre of a body in an island moves by at most
 *
 *   h V + h^2 (|g| + F/m) + D
 *
 * V is the largest speed of a point of the island's bodies before or after the step: within the step
 * bodies hand velocities on. Where bodies rebound, several can hand theirs to one, which may then have
 * the whole kinetic energy E of the island: there V is sqrt(2 E / m), if that is more. F is the sum of
 * the scene's forces on the body. D is the sum of the depths of the island's overlaps before and after the step,
 * by which an engine may push bodies out. What goes beyond is a jump.
 *
 * A body that meets no other in a step has v' = v + h g, with any integrator and any number of
 * sub-steps. Engines that damp all motion, or that let nothing move, show here. */
#include "modules.h"
#include "plumb/vec.h"
#include "referee/geometry/solid.h"

#include <string.h>

/* What an island allows its bodies. */
typedef struct island {
    double speed;  /* m/s, the largest */
    double depth;  /* m, of all overlaps */
    double energy; /* J, kinetic, at most */
} island;

typedef struct unexplained {
    const pl_scene *scene;
    double *radius;       /* (body_count): bounding radii, m */
    double *acceleration; /* (body_count): |g| + F/m, m/s^2 */
    island *islands;      /* (body_count): by the root of each */
    bool rebounds;        /* a pair of materials has restitution */
} unexplained;

static void *create(const pl_run_view *view, pl_arena *arena)
{
    const pl_scene *scene = view->scene;
    const size_t count = (size_t)scene->body_count;
    unexplained *m = pl_arena_take(arena, 1, sizeof *m);
    *m = (unexplained){.scene = scene,
                       .radius = pl_arena_take(arena, count, sizeof *m->radius),
                       .acceleration = pl_arena_take(arena, count, sizeof *m->acceleration),
                       .islands = pl_arena_take(arena, count, sizeof *m->islands)};
    view->series[PL_METRIC_UNEXPLAINED_MOTION]->applies = true;
    for (int i = 0; i < scene->material_count; ++i) {
        m->rebounds = m->rebounds || scene->materials[i].restitution > 0;
    }
    for (int i = 0; i < scene->pair_count; ++i) {
        m->rebounds = m->rebounds || scene->pairs[i].restitution > 0;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        m->radius[i] = pl_bounding_radius(&scene->bodies[i].shape);
        m->acceleration[i] = pl_vec_length(pl_vec_of(scene->gravity));
    }
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        if (!scene->bodies[force->body].is_static) {
            m->acceleration[force->body] +=
                pl_vec_length(pl_vec_of(force->force)) / scene->bodies[force->body].mass;
        }
    }
    return m;
}

/* The largest speed of a point of the body, m/s. */
static double speed_of(const unexplained *m, int body, const pl_body_state *state)
{
    return pl_vec_length(pl_vec_of(state->velocity)) +
           m->radius[body] * pl_vec_length(pl_vec_of(state->angular_velocity));
}

/* The largest speed that a body of the island can have had in the step. */
static double explained_speed(const unexplained *m, const pl_body *body, const island *of)
{
    return m->rebounds ? fmax(of->speed, sqrt(2 * of->energy / body->mass)) : of->speed;
}

/* The largest unexplained motion of a dynamic body over its bounding radius; at least 0. */
static double unexplained_motion(unexplained *m, pl_touching *touching, const pl_body_state *before,
                                 const pl_body_state *after)
{
    const pl_scene *scene = m->scene;
    const double h = scene->dt;
    double most = 0;
    memset(m->islands, 0, (size_t)scene->body_count * sizeof *m->islands);
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            island *of = &m->islands[pl_touching_island(touching, i)];
            const double speed = fmax(speed_of(m, i, &before[i]), speed_of(m, i, &after[i]));
            of->speed = fmax(of->speed, speed);
            of->depth += touching->bodies[i].depth + touching->bodies[i].depth_before;
            of->energy += 0.5 * scene->bodies[i].mass * speed * speed;
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            const island *of = &m->islands[pl_touching_island(touching, i)];
            const double moved = pl_vec_length(
                pl_vec_sub(pl_state_centre(body, &after[i]), pl_state_centre(body, &before[i])));
            const double explained =
                h * explained_speed(m, body, of) + h * h * m->acceleration[i] + of->depth;
            most = fmax(most, (moved - explained) / m->radius[i]);
        }
    }
    return most;
}

/* The largest |v' - v - h g| / (h |g|) of a dynamic body that flew through the step and on which the
 * scene has no force. NAN where there is none, or no gravity. */
static double free_flight_error(const unexplained *m, const pl_touching *touching,
                                const pl_body_state *before, const pl_body_state *after)
{
    const pl_scene *scene = m->scene;
    const pl_vec gravity = pl_vec_of(scene->gravity);
    const double h = scene->dt, g = pl_vec_length(gravity);
    double most = (double)NAN;
    for (int i = 0; i < scene->body_count && g > 0; ++i) {
        const bool is_free = !scene->bodies[i].is_static && m->acceleration[i] == g;
        const bool flew = !touching->bodies[i].met && !touching->bodies[i].met_before;
        if (is_free && flew) {
            const pl_vec change =
                pl_vec_sub(pl_vec_of(after[i].velocity), pl_vec_of(before[i].velocity));
            most = fmax(most, pl_vec_length(pl_vec_mad(change, -h, gravity)) / (h * g));
        }
    }
    return most;
}

static void see(void *state, const pl_run_view *view)
{
    unexplained *m = state;
    const pl_body_state *before = view->step.before, *after = view->step.after;
    pl_see_value(view, PL_METRIC_UNEXPLAINED_MOTION,
                 unexplained_motion(m, view->touching, before, after));
    pl_see_value(view, PL_METRIC_FREE_FLIGHT_ERROR,
                 free_flight_error(m, view->touching, before, after));
}

const pl_module pl_unexplained_motion_module = {.create = create, .see = see};
