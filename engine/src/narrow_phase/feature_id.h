/* Feature ids: which features of the two shapes a manifold point lies on.
 *
 * An id is the same from step to step while the same features touch, so that the solver starts from
 * the impulse of the step before. The ids of one manifold differ. The ids of different pairs of
 * shape kinds may coincide. Bit 0 is the lowest. By the kinds of the shapes:
 *
 *   a sphere and a convex shape      0-63   0: there is one point only
 *   plane and box or hull            0-31   vertex of the box or hull
 *   plane and capsule                0      end of the capsule's segment
 *   plane and cylinder               0-2    0, 1: ends of the lowest line; 2-5: four points of the
 *                                           rim; 6: lowest point of the rim
 *   two boxes, corner of a           0-2    side of the polygon that leaves the corner: 0-3 of the
 *   clipped face                            clipped face, 4-7 of the reference face
 *                                    3-5    side that arrives at the corner
 *                                    6-8    clipped face: 2 axis + (1 if on its positive side)
 *                                    9-11   reference face, likewise
 *                                    12     the reference is the second box
 *   two boxes, edges                 0-7    edge of the second box: axis << 2 | sign << 1 | sign
 *                                    8-15   edge of the first box, likewise
 *                                    31     1
 *   polytopes, corner of a           0-15   higher of the two edges that cross there; bit 15 of an
 *   clipped face                            edge is set if it is of the second shape
 *                                    16-31  lower of the two edges
 *                                    32-46  face of the second shape
 *                                    47-61  face of the first shape
 *   polytopes, nearest points        0-29   first and last vertex of the second shape's feature
 *   or ends of a line                30-59  first and last vertex of the first shape's feature
 *                                    60-61  1: nearest points; 2, 3: end of the first, second edge
 *   two cylinders                    0-27   number of the point
 *                                    56-63  kind of the point, see cylinder_cylinder.c
 *   cylinder and polytope            0-27   number of the point
 *                                    28-55  face, or number of faces + edge
 *                                    56-63  kind of the point, see cylinder_polytope.c
 *   mesh                             0-29   feature of the second shape, see pe_touch_feature
 *                                    30-59  feature of the first shape
 *                                    60-62  pe_touch_kind
 *   cylinder and mesh                       as for a mesh; 30-59 holds a pe_rim_point on a face, at
 *                                           an edge or vertex the point's kind << 2 | number */
#ifndef PE_FEATURE_ID_H
#define PE_FEATURE_ID_H

#include <stdint.h>

/* Of a cylinder: the kind of a point (above 0), the other shape's feature, and a number. */
static inline uint64_t pe_cylinder_feature(uint64_t kind, int feature, int point)
{
    return kind << 56 | (uint64_t)(uint32_t)feature << 28 | (uint64_t)(uint32_t)point;
}

/* Two vertices in rising order, 15 bits each. */
static inline uint64_t pe_vertex_pair_feature(int p, int q)
{
    return ((uint64_t)(p < q ? p : q) & 0x7fff) << 15 | ((uint64_t)(p < q ? q : p) & 0x7fff);
}

#endif
