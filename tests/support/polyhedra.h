/* Hulls and meshes for tests, made by the scene that owns them. m. */
#ifndef PLUMB_TEST_POLYHEDRA_H
#define PLUMB_TEST_POLYHEDRA_H

#include "check.h"

#include "plumb/scene.h"

/* Of `points` random ones on an ellipsoid with half axes of 0.2 to 1 about a random middle. */
const pl_polyhedron *random_hull(pl_scene *scene, check_random *random, int points);

/* The surface of a hull, or of any polyhedron, as a mesh. */
const pl_polyhedron *mesh_of(pl_scene *scene, const pl_polyhedron *polyhedron);

/* A box about `middle`, each face in cells x cells squares of two triangles. */
const pl_polyhedron *box_mesh(pl_scene *scene, const double half[3], const double middle[3],
                              int cells);

/* A ring of radius `ring` about z, of `around` straight pieces of a tube with `sides` flat sides,
 * its corners at `tube` from the ring's circle. A corner is at the angle 0 of either. */
const pl_polyhedron *torus_mesh(pl_scene *scene, double ring, double tube, int around, int sides);

#endif
