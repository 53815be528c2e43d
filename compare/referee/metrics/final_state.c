/* Final poses against the reference, and their fingerprint: FNV-1a, 64 bits (Fowler, Noll and Vo
 * 1991). */
#include "final_state.h"

#include "discrete_answer.h"
#include "plumb/vec.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static pl_metric value_of(double value)
{
    return (pl_metric){.state = PL_METRIC_VALUE, .value = value};
}

int pl_farthest_from_rest(const pl_scene *scene, const pl_body_state *bodies, double *distance)
{
    int farthest = -1;
    *distance = -1;
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        double d = pl_vec_length(
            pl_vec_sub(pl_vec_of(bodies[rest->body].position), pl_vec_of(rest->position)));
        if (d > *distance) {
            *distance = d;
            farthest = i;
        }
    }
    return farthest;
}

pl_metric pl_rest_position_error(const pl_scene *scene, const pl_body_state *bodies)
{
    double distance = 0;
    int farthest = pl_farthest_from_rest(scene, bodies, &distance);
    return farthest < 0 ? (pl_metric){0} : value_of(distance);
}

pl_metric pl_rest_rotation_error(const pl_scene *scene, const pl_body_state *bodies)
{
    pl_metric metric = {0};
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        if (rest->has_orientation && scene->bodies[rest->body].shape.kind != PL_SHAPE_SPHERE) {
            double angle = pl_angle_between(rest->orientation, bodies[rest->body].orientation);
            metric = value_of(fmax(metric.value, angle));
        }
    }
    return metric;
}

/* Along the reference's line from where the scene puts the body. */
static double travelled(const pl_scene *scene, const pl_body_state *bodies,
                        const pl_expect_travel *travel)
{
    pl_vec from = pl_vec_of(scene->bodies[travel->body].position);
    pl_vec to = pl_vec_of(bodies[travel->body].position);
    return pl_vec_dot(pl_vec_sub(to, from), pl_vec_of(travel->direction));
}

static double relative(double actual, double expected)
{
    return fabs(actual - expected) / fabs(expected);
}

pl_metric pl_travel_error(const pl_scene *scene, const pl_body_state *bodies)
{
    pl_metric metric = {0};
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        double error = relative(travelled(scene, bodies, travel), travel->distance);
        metric = value_of(fmax(metric.value, error));
    }
    return metric;
}

pl_metric pl_discrete_error(const pl_scene *scene, const pl_body_state *bodies,
                            pl_integrator integrator)
{
    pl_metric metric = {0};
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        double answer = pl_discrete_travel(scene, travel, integrator);
        if (isnan(answer)) {
            return (pl_metric){0};
        }
        double error = relative(travelled(scene, bodies, travel), answer);
        metric = value_of(fmax(metric.value, error));
    }
    return metric;
}

/* Byte by byte from the least significant, so that it is the same on machines of either byte order.
 */
static uint64_t hash_numbers(uint64_t hash, const double *numbers, int count)
{
    for (int i = 0; i < count; ++i) {
        uint64_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        for (int shift = 0; shift < 64; shift += 8) {
            hash = (hash ^ ((bits >> shift) & 0xff)) * UINT64_C(0x100000001b3);
        }
    }
    return hash;
}

pl_metric pl_state_hash(const pl_scene *scene, const pl_body_state *bodies)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (int i = 0; i < scene->body_count; ++i) {
        hash = hash_numbers(hash, bodies[i].position, 3);
        hash = hash_numbers(hash, bodies[i].orientation, 4);
    }
    pl_metric metric = {.state = PL_METRIC_TEXT};
    (void)snprintf(metric.text, sizeof metric.text, "%016" PRIx64, hash);
    return metric;
}
