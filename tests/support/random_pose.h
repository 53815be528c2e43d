/* Random vectors and orientations of the engine's types. */
#ifndef PLUMB_TEST_RANDOM_POSE_H
#define PLUMB_TEST_RANDOM_POSE_H

#include "base/vec3.h"
#include "check.h"

/* Components uniform in [low, high). */
static inline pe_vec3 random_vector_in(check_random *random, double low, double high)
{
    double x = check_uniform(random, low, high), y = check_uniform(random, low, high);
    return pe_v3(x, y, check_uniform(random, low, high));
}

/* Components uniform in [-reach, reach). */
static inline pe_vec3 random_vector(check_random *random, double reach)
{
    return random_vector_in(random, -reach, reach);
}

static inline pe_quat random_turn(check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    return (pe_quat){q[0], q[1], q[2], q[3]};
}

#endif
