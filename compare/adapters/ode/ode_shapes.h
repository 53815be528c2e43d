/* Shapes as ODE's own geoms: a hull is a dConvex, a mesh a dTriMesh. */
#ifndef PLUMB_ODE_SHAPES_H
#define PLUMB_ODE_SHAPES_H

#include "hull_faces.h"
#include "plumb/scene.h"

#include <ode/ode.h>

/* A hull or a mesh as ODE's geoms share it. */
typedef struct ode_solid {
    double origin[3];         /* of the geoms' frame, in the shape's, whose axes it has; m */
    double (*points)[3];      /* hull: (vertex_count), from `origin` */
    pl_hull_faces faces;      /* hull */
    dTriMeshDataID triangles; /* mesh; borrows the scene's arrays */
} ode_solid;

/* Makes what the geoms of a hull or a mesh share into a zeroed *solid; `shape` must outlive it. On
 * failure too the caller frees it by pl_ode_free_solid. */
pl_status pl_ode_make_solid(const pl_polyhedron *shape, ode_solid *solid, pl_error *error);

/* Frees what *solid owns and zeroes it. */
void pl_ode_free_solid(ode_solid *solid);

/* A geom in `space` (NULL: in none), which owns it. `solid` is that of the shape's polyhedron, NULL
 * where it has none. NULL when ODE has no such shape. */
dGeomID pl_ode_make_geom(dSpaceID space, const pl_shape *shape, const ode_solid *solid);

/* Places a geom whose frame is the shape's, but for the origin of `solid`. */
void pl_ode_place_static(dGeomID geom, const pl_body *body, const ode_solid *solid);

/* Places the geom in the principal frame of its body. */
void pl_ode_place_in_body(dGeomID geom, const pl_shape *shape, const ode_solid *solid);

/* Whether this build of ODE has a collider for every pair of kinds of shapes of the scene that may
 * meet: UNSUPPORTED names the first that it has none for. ODE must be initialised. */
pl_status pl_ode_check_colliders(const pl_scene *scene, pl_error *error);

#endif
