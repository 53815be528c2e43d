/* What of a manifold turns with which of its bodies. */
#ifndef PE_PATCH_FIXTURE_H
#define PE_PATCH_FIXTURE_H

#include "model/world.h"
#include "problem.h"

typedef struct pe_attachment {
    bool in_a, in_b;         /* all points */
    bool normal_a, normal_b; /* the normal */
} pe_attachment;

/* Of the manifold, which is one of world->contacts: by the same features in world->solved, where
 * what is fixed was at the same place of its body. Of a pair that is new, corners of polyhedra on a
 * plane are known. */
pe_attachment pe_attachment_of(const pe_world *world, const pe_manifold *manifold);

/* A motion of both bodies. */
typedef struct pe_displacement {
    pe_vec3 turn_a, turn_b; /* rotation vectors, world, up to about a radian */
    pe_vec3 shift;          /* of a's centre of mass relative to b's, world, m */
} pe_displacement;

typedef struct pe_transported {
    pe_vec3 axis[3];      /* n, t1, t2 */
    pe_vec3 arm_a, arm_b; /* from the centres of mass to the manifold's centre */
} pe_transported;

/* Where the manifold is after that motion, to second order of the turns, and the offset of one of
 * its points from its centre, all in world axes. Points are fixed in a or b, and so is the normal.
 */
pe_transported pe_solver_manifold_transported(const pe_solver_manifold *manifold,
                                              const pe_attachment *fixture,
                                              const pe_displacement *way);
pe_vec3 pe_offset_transported(const pe_solver_manifold *manifold, const pe_solver_point *point,
                              const pe_attachment *fixture, const pe_displacement *way);

#endif
