/* A Fibonacci lattice of directions, then a pattern search from the best ones. */
#include "direction_sweep.h"

double reach_along(const placed_shape *b, pe_vec3 d)
{
    pe_vec3 local = pe_unrotate(&b->pose.rotation, d), e = b->shape.half_extents;
    double across = sqrt(local.x * local.x + local.y * local.y);
    switch (b->shape.kind) {
    case PE_SHAPE_SPHERE:
        return b->shape.radius;
    case PE_SHAPE_BOX:
        return fabs(local.x) * e.x + fabs(local.y) * e.y + fabs(local.z) * e.z;
    case PE_SHAPE_CAPSULE:
        return fabs(local.z) * b->shape.half_height + b->shape.radius;
    default:
        return fabs(local.z) * b->shape.half_height + across * b->shape.radius;
    }
}

double separation_along(const placed_shape *a, const placed_shape *b, pe_vec3 d)
{
    return pe_dot(d, pe_sub(b->pose.position, a->pose.position)) - reach_along(a, d) -
           reach_along(b, d);
}

/* Pattern search from d, with shrinking steps. */
static double refined(const placed_shape *a, const placed_shape *b, pe_vec3 d, double value)
{
    for (double h = 0.05; h > 1e-10; h *= 0.5) {
        for (bool better = true; better;) {
            better = false;
            pe_vec3 t1, t2;
            pe_tangents(d, &t1, &t2);
            for (int k = 0; k < 16 && !better; ++k) {
                double angle = k * 0.39269908169872414;
                pe_vec3 e = pe_madd(pe_madd(d, h * cos(angle), t1), h * sin(angle), t2);
                e = pe_scale(1 / pe_length(e), e);
                double there = separation_along(a, b, e);
                better = there > value + 1e-15;
                d = better ? e : d;
                value = better ? there : value;
            }
        }
    }
    return value;
}

double swept_distance(const placed_shape *a, const placed_shape *b)
{
    enum { SWEEP = 4000, STARTS = 6 };
    pe_vec3 start[STARTS + 1];
    double value[STARTS + 1];
    int count = 0;
    for (int i = 0; i < SWEEP; ++i) {
        /* Fibonacci lattice on the sphere. */
        double z = 1 - (2 * i + 1.0) / SWEEP, angle = i * 2.399963229728653, r = sqrt(1 - z * z);
        pe_vec3 d = pe_v3(r * cos(angle), r * sin(angle), z);
        double there = separation_along(a, b, d);
        int j = count;
        for (; j > 0 && value[j - 1] < there; --j) {
            value[j] = value[j - 1];
            start[j] = start[j - 1];
        }
        value[j] = there;
        start[j] = d;
        count = count < STARTS ? count + 1 : STARTS;
    }
    double best = -HUGE_VAL;
    for (int i = 0; i < STARTS; ++i) {
        best = pe_max(best, refined(a, b, start[i], value[i]));
    }
    return best;
}
