/* Flat polygons to triangles. */
#ifndef PLUMB_POLYGON_H
#define PLUMB_POLYGON_H

#include "plumb/base.h"

enum { PL_MAX_POLYGON_CORNERS = 4096 };

typedef enum pl_polygon_fault {
    PL_POLYGON_RIGHT,
    PL_POLYGON_NO_AREA,
    PL_POLYGON_NOT_FLAT, /* a corner is farther from the plane than a thousandth of its size */
    PL_POLYGON_CROSSES,  /* its outline does not enclose one piece */
    PL_POLYGON_NO_MEMORY
} pl_polygon_fault;

/* Cuts the polygon of corner[0 .. count), 3 to PL_MAX_POLYGON_CORNERS different vertices in order,
 * into count - 2 triangles of the same direction. O(n), or O(n^2) where it is not convex. */
pl_polygon_fault pl_polygon_cut(const double (*vertices)[3], const int *corner, int count,
                                int (*triangles)[3]);

#endif
