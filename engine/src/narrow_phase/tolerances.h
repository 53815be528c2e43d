/* Tolerances of the narrow phase.
 *
 * Lengths are in units of the pair's size: the least half extent or radius of the smaller shape, so
 * that a result does not depend on the unit of length. Sines, cosines and ratios have no unit. Most
 * lengths lie above the rounding of positions, 1e-15, and above the motion of a body at rest, about
 * 1e-10 a step. Below that motion a manifold would change from step to step. */
#ifndef PE_TOLERANCES_H
#define PE_TOLERANCES_H

/* ---- Choice of the contact normal ---- */

/* Length: directions whose separations differ by less tie. A face of the first shape is preferred,
 * then a face of the second, then a pair of edges. */
#define PE_AXIS_TIE 1e-10
/* Length: the second box's face is the reference only if it separates more by this. A resting stack
 * must choose the same reference at every step. */
#define PE_REFERENCE_BIAS 1e-5
/* Cosine between a face and the normal from which the face is clipped as the reference. */
#define PE_REFERENCE_COSINE 0.995
/* Difference of cosines from which the second polytope's face is the reference: 1e-3 rad. */
#define PE_REFERENCE_COSINE_TIE 1e-6
/* Difference of cosines below which two faces look along a direction equally. */
#define PE_FACING_TIE 1e-9
/* Sine of the angle between an edge and the plane across a direction, below which both ends of the
 * edge are support points. */
#define PE_LEVEL_EDGE 1e-6

/* Box edges. Squared sine of the angle of two edges: below the first the quick test of their common
 * normal loses digits, below the second that normal is only rounding. */
#define PE_BOX_EDGES_NEAR_PARALLEL2 1e-6
#define PE_BOX_EDGES_PARALLEL2 1e-24
/* Rounding of the quick test, relative to the lengths in it. */
#define PE_BOX_AXIS_ROUNDING 1e-15
/* Polytope edges. Sine of their angle below which their cross product is so uncertain that the
 * edges need not be the support edges along it, and below which it is rounding. */
#define PE_EDGES_NEAR_PARALLEL 1e-4
#define PE_EDGES_PARALLEL 1e-12
/* Squared sine of the angle between the axes of two capsules below which they are parallel. */
#define PE_SEGMENTS_PARALLEL2 1e-24
/* Squared sine of the angle of two edges of meshes below which their nearest points lose digits. */
#define PE_SEGMENTS_NEAR_PARALLEL2 1e-6

/* Relative: the distance and its lower bound agree in the GJK descent. */
#define PE_GJK_AGREE 1e-15
/* Relative: rounding of coordinates. */
#define PE_COORDINATE_ROUNDING 1e-15

/* ---- Points of polytopes ---- */

/* Length: points this far outside a face still lie on it. */
#define PE_CLIP_SLACK 1e-8
/* Length: corners of a clipped polygon that are this near to each other are one corner. */
#define PE_SAME_CORNER 1e-6
/* Length: a point this near to the least separation realises it. */
#define PE_SAME_DISTANCE 5e-10
/* Sine of the angle below which two edges touch along a line, not at a point. */
#define PE_LINE_CONTACT 0.01
/* Cosine between an edge and the normal below which the edge lies across the normal. */
#define PE_EDGE_ACROSS 1e-4

/* Length: parallel edges whose gap or overlap is less have the normal of edges that meet. */
#define PE_EDGES_MEET 1e-4
/* Sine of the angle of two faces up to which they lie on each other and one gives the normal, though
 * edges meet. From twice that on the normal is that of the edges. */
#define PE_MEETING_FLAT 0.1
/* Sines of angles: by which a face's normal may lie outside the range of an edge, for rounding, and
 * by which that of edges that meet lies within it at least, or it is that of the face. */
#define PE_MEETING_ROUNDING 1e-9
#define PE_MEETING_FACE 1e-6
/* Length: an overlap by less is none of two bodies that pass each other, and a motion by less closes
 * no gap. It is above the rounding of positions and the depth of 1e-8 m at which bodies of 0.1 m and
 * more are left. */
#define PE_PASSING 1e-7
/* Length: the widest gap at which two bodies are taken to pass each other. Without this bound medleys
 * and piles of the fast profile had overlaps of 10 cm in a frame, with it of 1 cm. */
#define PE_PASSING_GAP 0.1

/* ---- Reduction to PE_MAX_POINTS ---- */

/* Length: depths that tie for the first point of a reduced polytope manifold. */
#define PE_START_TIE 1e-5
/* Relative: squared distances that tie for the next point. */
#define PE_SPREAD_TIE 1e-5
/* The same for the points of cylinders. */
#define PE_LIST_SPREAD_TIE 1e-6
/* Length: points of a cylinder that are nearer to each other than this are one. */
#define PE_LIST_MERGE 1e-3
/* Length: points of a mesh manifold that are nearer to each other than this are one. */
#define PE_MESH_MERGE 1e-4
/* Length: separations of mesh points that differ by less are the same. */
#define PE_MESH_POINT_TIE 1e-8
/* Length: a mesh point that widens its manifold by less is dropped. */
#define PE_LEAST_WIDTH 1e-5
/* A mesh point that is farther from touching than the deepest one, by h, counts as this many times
 * h less far out. It would come into play when the bodies tilt by the inverse, in rad. */
#define PE_HEIGHT_WEIGHT 10

/* ---- Cylinders ---- */

/* Length: the place of a point of a cylinder, and separations that differ by less are the same. */
#define PE_CYLINDER_TIE 4e-10
/* Length: an iteration for such a place ends there. */
#define PE_CYLINDER_EXACT 1e-12
/* Length: a face or a cap keeps the normal unless another direction separates more by this. */
#define PE_FLAT_BIAS 4e-10
/* Length: points of a cap, or of a side, this far outside a bound are moved onto the bound. */
#define PE_CAP_SLACK 1e-6
#define PE_SIDE_SLACK 1e-7
/* Length: a cap whose tilt, from end to end, is less has no lowest point; the same over a plane. */
#define PE_LEVEL_CAP 6e-9
#define PE_LEVEL_CAP_ON_PLANE 3e-9
/* Cosine between the normal and the axis from which a cap, not the side, faces the other shape. */
#define PE_CAP_FACING 0.7
/* Cosine between the normal and that of a face from which a cap, or a side, lies along the face. */
#define PE_FACE_ALONG_CAP 0.98
#define PE_FACE_ALONG_SIDE 0.9999955
/* Cosine between a direction and an edge below which the edge lies across the direction. */
#define PE_EDGE_CROSSWISE 0.2
/* Length: two maxima of the separation differ by more than rounding. */
#define PE_MAXIMUM_ROUNDING 1e-14
/* Length: vertices whose support differs by less are equally far out. */
#define PE_SUPPORT_TIE 1e-10
/* Length: gap from which the direction is taken from the nearest points, which is more exact. */
#define PE_NEAREST_POINT_GAP 1e-4

/* ---- Meshes ---- */

/* Length: a point this far beyond the rim of a face still lies on the face. */
#define PE_MESH_SLACK 6e-9
/* Length: the same for a point beyond the border of two triangles of one face, which rounding may
 * put outside both. */
#define PE_MESH_SEAM 1e-12
/* Length: an overlap deeper than this is found from the vertices that lie inside, not from features
 * within reach. A vertex that far behind a dent at the rim of a face is still over that face. */
#define PE_MESH_DEPTH 0.05
/* In units of the margin: how much farther features are searched, to know from which margin on
 * there would be more points. */
#define PE_LOOK_AHEAD 0.1
/* In units of the smaller bounding radius: features are not searched whose gap exceeds the least
 * one by more than this, whatever the margin. */
#define PE_BAND 0.25
/* In units of the band: a parting direction is accepted when its gap is within this of the distance
 * of the hulls. */
#define PE_PARTING_TOLERANCE 0.03

/* Sine of the angle by which a normal may lie outside the directions that a feature faces, so that
 * all corners are found of a face that lies nearly flat on another. */
#define PE_FACING 0.1
/* The same for features that face each other strictly. It covers rounding and the small motion of
 * bodies at rest. */
#define PE_FACING_STRICT 1e-6
/* The same for the nearest features of a rounded shape: rounding. */
#define PE_FACING_ROUNDED 1e-9
/* Angle (rad) of two edges below which their end points replace them. */
#define PE_MESH_EDGES_PARALLEL 1e-4
/* Angle (rad) of two edges below which their common normal is rounding. */
#define PE_NEAREST_EDGES_PARALLEL 1e-6
/* Length: features as near as this tie, and the one with the lowest id is taken. */
#define PE_NEAREST_TIE 1e-13
/* Length: depths that differ by less are the same. */
#define PE_DEPTH_TIE 1e-9
/* Length: a line of least distance that is shorter has no direction. */
#define PE_LEAST_LINE 1e-9
/* Sine of the angle to a face from which a ray crosses the face. */
#define PE_LEAST_RISE 1e-9
/* Relative: distances of a point from triangles that differ by less are the same. */
#define PE_SURFACE_TIE 1e-9

/* Overlaps. In units of the depth: how near another feature pair is at the same place. */
#define PE_SAME_PLACE 8
/* Sine of the angle from which another direction contradicts an overlap. */
#define PE_OTHER_DIRECTION 1e-3
/* Cosine of two face normals below which the faces look opposite ways. */
#define PE_OPPOSITE (-0.3)
/* Length: ends of two segments of an intersection curve that are nearer are joined. */
#define PE_JOINED 1e-4
/* In units of the squared length of an intersection curve, of which a circle has 1 / (4 pi): the
 * least vector area that has a direction. */
#define PE_LEAST_CURVE_AREA 0.005
/* In units of the sum of the curves' areas: vector areas of this size do not cancel. */
#define PE_NOT_CANCELLED 0.25

/* Manifolds. Sine of the angle below which two normals are one: points of the second are seen along
 * the first, and move along their faces by up to this times their separation. */
#define PE_ONE_NORMAL 1e-3
/* Length: normals that no plane has, but a line between two points, are one if a turn of the line
 * about the core moves the points by less. */
#define PE_ONE_LINE 5e-9
/* Length: a touching face of the first solid gives the normal. A face of the second gives it if its
 * separation is less by PE_SECOND_FACE_BIAS, edges if theirs is less by PE_EDGE_BIAS. */
#define PE_SECOND_FACE_BIAS 1e-6
#define PE_EDGE_BIAS 1e-5

/* ---- Cylinders on meshes ---- */

/* Length: separations that differ by less are the same. */
#define PE_CYLINDER_MESH_TIE 5e-10
/* Length: an edge that overlaps by more keeps its own direction, however near a face's it is. */
#define PE_DEEP_EDGE 5e-7
/* Cosine between a face's normal and the axis below which the side lies along the face. */
#define PE_SIDE_ON_FACE 3e-3
/* Length: an edge that is less far inside the rim does not cross the rim. */
#define PE_TANGENT_EDGE 1e-6
/* Sine of the angle below which a direction is a face's normal. */
#define PE_ALONG_NORMAL 1e-6
/* Sine of the angle below which a direction at an edge is that of a face next to it. */
#define PE_NEXT_TO_FACE 1e-3
/* Sine of the angle by which a direction may lie outside those that an edge faces. */
#define PE_OUTSIDE_EDGE 1e-6
/* Length: corners of a triangle that are equally far along a direction. */
#define PE_LEVEL_CORNERS 1e-8

#endif
