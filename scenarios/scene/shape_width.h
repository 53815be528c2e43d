/* How wide a shape is. */
#ifndef PLUMB_SHAPE_WIDTH_H
#define PLUMB_SHAPE_WIDTH_H

#include "plumb/scene.h"

/* Half of its smallest dimension, m: along its own axes, of a polyhedron along its principal axes;
 * INFINITY for a plane. */
double pl_shape_half_width(const pl_shape *shape);

#endif
