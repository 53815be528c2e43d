/* Mass properties and bounds of the shapes. */
#ifndef PE_SHAPE_H
#define PE_SHAPE_H

#include "geometry.h"

/* `geometry` is that of a hull or mesh, NULL for the others. */

/* Principal inertia of the solid of uniform density, kg m^2. Not for a plane. */
pe_vec3 pe_shape_inertia(const pe_shape *shape, const pe_geometry *geometry, double mass);

/* Radius of the sphere about the centre of mass that holds the shape; 0 for a plane. */
double pe_shape_bounding_radius(const pe_shape *shape, const pe_geometry *geometry);

/* Least half extent or radius; 0 for a plane. */
double pe_shape_size(const pe_shape *shape, const pe_geometry *geometry);

typedef struct pe_extent {
    pe_vec3 centre, half; /* m */
} pe_extent;

/* An axis-aligned box in the world, about the centre of mass, that holds the shape; exact but for
 * hulls and meshes. Not for a plane. */
pe_extent pe_shape_extent(const pe_shape *shape, const pe_geometry *geometry,
                          const pe_mat3 *rotation);

/* PE_BAD_ARGUMENT when a number is not finite, a length not positive, or the normal not unit to
 * 1e-9. */
pe_status pe_shape_check(const pe_shape *shape, pe_error *error);

#endif
