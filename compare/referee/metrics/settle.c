/* Comes to rest: all velocities below a threshold, without interruption, for long enough that the
 * top of a bounce or the turn of a swing does not count. */
#include "settle.h"

#include "plumb/vec.h"

static const double QUIET_SPEED = 1e-3; /* m/s */
static const double QUIET_SPIN = 1e-3;  /* rad/s */
static const double HOLD = 0.5;         /* s */

pl_settle pl_settle_start(const pl_scene *scene)
{
    /* The small part keeps a hold that is a whole number of steps from being rounded up. */
    long hold = (long)ceil(HOLD / scene->dt - 1e-6);
    return (pl_settle){.scene = scene, .hold = hold, .quiet_since = -1};
}

static bool all_quiet(const pl_scene *scene, const pl_body_state *bodies)
{
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static &&
            !(pl_vec_length(pl_vec_of(bodies[i].velocity)) < QUIET_SPEED &&
              pl_vec_length(pl_vec_of(bodies[i].angular_velocity)) < QUIET_SPIN)) {
            return false;
        }
    }
    return true;
}

bool pl_settle_see(pl_settle *settle, long step, const pl_body_state *bodies)
{
    if (settle->settled) {
        return false;
    }
    if (!all_quiet(settle->scene, bodies)) {
        settle->quiet_since = -1;
        return false;
    }
    bool begins = settle->quiet_since < 0;
    if (begins) {
        settle->quiet_since = step;
    }
    settle->settled = step - settle->quiet_since >= settle->hold;
    return begins;
}
