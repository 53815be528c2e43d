/* Shapes at a pose, as input of the narrow phase. */
#ifndef PLUMB_TEST_PLACED_SHAPE_H
#define PLUMB_TEST_PLACED_SHAPE_H

#include "model/shape.h"
#include "narrow_phase/collide.h"
#include "random_pose.h"

typedef struct placed_shape {
    pe_shape shape;
    pe_geometry *geometry; /* of a hull or a mesh; else NULL */
    pe_pose pose;
} placed_shape;

static const pe_quat unturned = {1, 0, 0, 0};

/* The orientation need not be unit. */
static inline void place(placed_shape *b, pe_vec3 position, pe_quat q)
{
    q = pe_quat_unit(q);
    b->pose = (pe_pose){position, q, pe_matrix_of(q)};
}

static inline pe_placed of(const placed_shape *b)
{
    return (pe_placed){&b->shape, b->geometry, &b->pose, pe_shape_size(&b->shape, b->geometry)};
}

/* A sphere, box, capsule or cylinder at the origin. Lengths (m) that the kind does not have are
 * ignored. */
static inline placed_shape shape_of(pe_shape_kind kind, double radius, double half_height,
                                    pe_vec3 half_extents)
{
    placed_shape b = {.shape = {.kind = kind,
                                .radius = radius,
                                .half_height = half_height,
                                .half_extents = half_extents}};
    place(&b, pe_v3(0, 0, 0), (pe_quat){.w = 1});
    return b;
}

static inline placed_shape cylinder(double radius, double half_height)
{
    return shape_of(PE_SHAPE_CYLINDER, radius, half_height, pe_v3(0, 0, 0));
}

/* The radius is uniform from `least_radius` to 1 m, the half height from 0.1 m to `most_height`. */
static inline placed_shape random_cylinder(check_random *random, double least_radius,
                                           double most_height)
{
    double half_height = check_uniform(random, 0.1, most_height);
    return cylinder(check_uniform(random, least_radius, 1), half_height);
}

static inline placed_shape random_box(check_random *random, double spread)
{
    placed_shape box = {.shape = {.kind = PE_SHAPE_BOX}};
    box.shape.half_extents = random_vector_in(random, 0.2, 1.5);
    pe_quat turn = random_turn(random);
    place(&box, random_vector_in(random, -spread, spread), turn);
    return box;
}

/* The rotation by an angle about a unit axis. */
static inline pe_quat about(pe_vec3 axis, double angle)
{
    double s = sin(0.5 * angle);
    return (pe_quat){cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

static inline double least_separation(const pe_pair_manifold *manifold)
{
    double least = HUGE_VAL;
    for (int i = 0; i < manifold->count; ++i) {
        least = pe_min(least, manifold->item[i].separation);
    }
    return least;
}

static inline bool has_point_at(const pe_pair_manifold *manifold, const pe_pair_point *at,
                                double within)
{
    for (int i = 0; i < manifold->count; ++i) {
        if (pe_length(pe_sub(manifold->item[i].position, at->position)) <= within &&
            fabs(manifold->item[i].separation - at->separation) <= within) {
            return true;
        }
    }
    return false;
}

#endif
