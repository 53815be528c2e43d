/* What of a patch turns with which of its bodies. */
#ifndef PE_PATCH_FIXTURE_H
#define PE_PATCH_FIXTURE_H

#include "problem.h"
#include "world.h"

typedef struct pe_fixture {
    bool in_a, in_b;         /* all points */
    bool normal_a, normal_b; /* the normal */
} pe_fixture;

/* Of the manifold, which is one of world->contacts: by the same features in world->solved, where
 * what is fixed was at the same place of its body. Of a pair that is new, corners of polyhedra on a
 * plane are known. */
pe_fixture pe_fixture_of(const pe_world *world, const pe_manifold *manifold);

/* A motion of both bodies. */
typedef struct pe_way {
    pe_vec3 turn_a, turn_b; /* rotation vectors, world, up to about a radian */
    pe_vec3 shift;          /* of a's centre of mass relative to b's, world, m */
} pe_way;

typedef struct pe_carried {
    pe_vec3 axis[3];      /* n, t1, t2 */
    pe_vec3 arm_a, arm_b; /* from the centres of mass to the patch's centre */
} pe_carried;

/* Where the patch is after that motion, to second order of the turns, and the offset of one of its
 * points from its centre, all in world axes. Points are fixed in a or b, and so is the normal. */
pe_carried pe_patch_carried(const pe_patch *patch, const pe_fixture *fixture, const pe_way *way);
pe_vec3 pe_offset_carried(const pe_patch *patch, const pe_patch_point *point,
                          const pe_fixture *fixture, const pe_way *way);

#endif
