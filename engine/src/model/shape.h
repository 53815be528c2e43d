/* Mass properties and bounds of the shapes. In all functions `geometry` is that of a hull or mesh,
 * and NULL for the other shapes. */
#ifndef PE_SHAPE_H
#define PE_SHAPE_H

#include "geometry.h"

/* The principal inertia of a solid of uniform density, kg m^2. Not for a plane. */
pe_vec3 pe_shape_inertia(const pe_shape *shape, const pe_geometry *geometry, double mass);

/* The radius (m) of the sphere about the centre of mass that holds the shape; 0 for a plane. */
double pe_shape_bounding_radius(const pe_shape *shape, const pe_geometry *geometry);

/* The least half extent or radius (m), the scale of geometric tolerances; 0 for a plane. */
double pe_shape_size(const pe_shape *shape, const pe_geometry *geometry);

/* An axis-aligned box: centre and half extents. */
typedef struct pe_extent {
    pe_vec3 centre, half; /* m */
} pe_extent;

/* The AABB in the world, relative to the centre of mass. Tight, except for hulls and meshes. Not
 * for a plane. */
pe_extent pe_shape_extent(const pe_shape *shape, const pe_geometry *geometry,
                          const pe_mat3 *rotation);

/* PE_BAD_ARGUMENT: a length or an offset is out of range, or the normal not a unit vector to
 * 1e-9. */
pe_status pe_shape_check(const pe_shape *shape, pe_error *error);

#endif
