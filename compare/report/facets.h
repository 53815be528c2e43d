/* The surface of a body as flat facets, for pictures: no finer than the picture shows. */
#ifndef PLUMB_FACETS_H
#define PLUMB_FACETS_H

#include "plumb/scene.h"
#include "plumb/vec.h"

/* Counter-clockwise seen from outside, in the shape's own frame, m. Of a triangle the last corner
 * is there twice. */
typedef struct pl_facet {
    pl_vec corner[4];
    bool triangle;
} pl_facet;

typedef struct pl_facets {
    pl_facet *items; /* (count) */
    int count;
} pl_facets;

/* Of a box, capsule, cylinder, hull or mesh (of others none), with details smaller than about
 * `resolution` (m, > 0) left out: vertices of a hull or mesh that share a cell of that size become
 * one, and triangles between fewer than three such cells go. False when out of memory. The caller
 * frees by pl_facets_free. */
bool pl_facets_of(const pl_shape *shape, double resolution, pl_facets *facets);
void pl_facets_free(pl_facets *facets);

#endif
