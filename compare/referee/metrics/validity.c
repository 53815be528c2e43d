/* The bounds beyond which a run is not worth going on with. */
#include "validity.h"

#include "referee/geometry/solid.h"

static const double MOST_ENERGY_GAIN = 10;

static bool all_finite(const double *numbers, int count)
{
    bool finite = true;
    for (int i = 0; i < count; ++i) {
        finite = finite && isfinite(numbers[i]);
    }
    return finite;
}

/* The name of the first quantity that is wrong, or NULL. */
static const char *wrong_quantity(const pl_body_state *s)
{
    double norm = 0;
    for (int i = 0; i < 4; ++i) {
        norm += s->orientation[i] * s->orientation[i];
    }
    if (!all_finite(s->position, 3)) {
        return "position";
    }
    if (!(norm >= 0.5 && norm <= 2)) {
        return "orientation";
    }
    if (!all_finite(s->velocity, 3)) {
        return "velocity";
    }
    return all_finite(s->angular_velocity, 3) ? NULL : "angular velocity";
}

pl_verdict pl_check_finite(const pl_scene *scene, const pl_body_state *bodies, long step,
                           pl_error *error)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const char *wrong = scene->bodies[i].is_static ? NULL : wrong_quantity(&bodies[i]);
        if (wrong != NULL) {
            (void)pl_fail(error, PL_FAILED, "the %s of body \"%s\" is %s at step %ld", wrong,
                          scene->bodies[i].name,
                          wrong[0] == 'o' ? "no rotation" : "not a finite number", step);
            return PL_VERDICT_NONFINITE;
        }
    }
    return PL_VERDICT_OK;
}

pl_verdict pl_check_bounds(const pl_scene *scene, const pl_scale *scale,
                           const pl_body_state *bodies, double energy_gain, long step,
                           pl_error *error)
{
    for (int i = 0; i < scene->body_count; ++i) {
        double speed = pl_vec_length(pl_vec_of(bodies[i].velocity)) +
                       pl_bounding_radius(&scene->bodies[i].shape) *
                           pl_vec_length(pl_vec_of(bodies[i].angular_velocity));
        if (!scene->bodies[i].is_static && !(speed <= scale->speed_bound)) {
            (void)pl_fail(error, PL_FAILED,
                          "body \"%s\" moves at %.3g m/s at step %ld, beyond the scene's %.3g m/s",
                          scene->bodies[i].name, speed, step, scale->speed_bound);
            return PL_VERDICT_DIVERGED;
        }
    }
    if (!(energy_gain <= MOST_ENERGY_GAIN)) {
        (void)pl_fail(error, PL_FAILED,
                      "energy has grown by %.3g times the scene's %.3g J at step %ld", energy_gain,
                      scale->energy, step);
        return PL_VERDICT_DIVERGED;
    }
    return PL_VERDICT_OK;
}
