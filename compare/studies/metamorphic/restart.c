#include "restart.h"

#include "transform.h"

#include <math.h>
#include <string.h>

/* A force counts as ended by the same millionth of a step that decides whether it acts. */
static void move_forces(pl_scene *scene, double time)
{
    int kept = 0;
    for (int i = 0; i < scene->force_count; ++i) {
        pl_force force = scene->forces[i];
        force.from = fmax(force.from - time, 0);
        force.until -= time;
        if (force.until > 1e-6 * scene->dt) {
            scene->forces[kept++] = force;
        }
    }
    scene->force_count = kept;
}

pl_status pl_restart_scene(const pl_scene *from, const pl_body_state *states, long step,
                           pl_scene *to, pl_error *error)
{
    pl_status status = pl_scene_copy_problem(from, to, error);
    if (status != PL_OK) {
        return status;
    }
    for (int i = 0; i < to->body_count; ++i) {
        pl_body *body = &to->bodies[i];
        if (!body->is_static) {
            memcpy(body->position, states[i].position, sizeof body->position);
            memcpy(body->orientation, states[i].orientation, sizeof body->orientation);
            memcpy(body->velocity, states[i].velocity, sizeof body->velocity);
            memcpy(body->angular_velocity, states[i].angular_velocity,
                   sizeof body->angular_velocity);
        }
    }
    move_forces(to, (double)step * to->dt);
    to->duration = (double)(pl_scene_steps(from) - step) * to->dt;
    return PL_OK;
}
