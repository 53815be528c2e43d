/* Feature ids: which features of the two shapes a manifold point lies on.
 *
 * An id is the same from step to step while the same features touch, so that the solver starts from
 * the impulse of the step before. The ids of one manifold differ. The ids of different pairs of
 * shape kinds may coincide. Bit 0 is the lowest.
 *
 *   pair                        bits    content
 *   ball, one point only        0-63    0
 *   plane, box or hull          0-31    vertex of the box or hull
 *   plane, capsule              0       end of the capsule's segment
 *   plane, cylinder             0-2     0, 1: ends of the lowest line; 2-5: points of the rim; 6:
 * lowest two boxes, face             0-2     side of the polygon that leaves the corner: 0-3 of the
 * clipped face, 4-7 of the reference face 3-5     side that arrives at the corner 6-8     clipped
 * face, 2 axis + (1 for its positive side) 9-11    reference face, likewise 12      the reference
 * is the second box two boxes, edges            0-7     edge of the second box: axis << 2 | sign <<
 * 1 | sign 8-15    edge of the first box, likewise 31      1 polytopes, corner           0-15
 * higher of the two edges that cross at the corner; bit 15 of an edge is set if the edge is of the
 * second shape 16-31   lower of the two edges 32-46   face of the second shape 47-61   face of the
 * first shape polytopes, nearest points   0-29    first and last vertex of the second shape's
 * feature, 15 bits each or ends of a line           30-59   first and last vertex of the first
 * shape's feature 60-61   1: nearest points; 2, 3: end of the first, second edge two cylinders 0-27
 * number of the point 56-63   kind of point, see cylinder_cylinder.c cylinder, polytope 0-27 number
 * of the point 28-55   face, or face count + edge 56-63   kind of point, see cylinder_polytope.c
 *   mesh                        0-29    feature of the second shape; if kind is PE_FACE_VERTEX the
 * face 30-59   feature of the first shape; if kind is PE_FACE_VERTEX the vertex 60-62
 * pe_touch_kind, see touches.h cylinder, mesh              as for a mesh; the place of the
 * cylinder's feature has a pe_rim_point, see mesh_cylinder_facet.h */
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
