/* Builds of ODE differ in the pairs that they can collide, so ODE itself is asked, and a scene with
 * a pair that has no collider is declined. Debian's libode8 0.16.2 (OPCODE with its new collider of
 * two meshes, libccd for cylinders, capsules and hulls) has one for every pair. Measured on it,
 * bodies of 1 m at a depth of 1 cm in random poses:
 *
 * - True depth and normal, but for a few poses at edges: spheres, boxes and capsules with one
 *   another; cylinders on a plane, a sphere or a box; meshes with all but a sphere and another
 *   mesh.
 * - One point, by libccd's MPR search: a hull with any other convex shape, a cylinder with a
 *   capsule or askew to another. Its depth is within 0.3 mm in half of the poses (once off by
 *   15 cm). With a curved shape its normal is more than 10 degrees off in a sixth to two fifths of
 *   them. Two hulls, or a hull and a box, have a true normal, but on one point neither comes to
 *   rest on the other: it rocks, about 1 cm deep.
 * - Meshes: vertices are rounded to single precision. The first contacts found are kept, not the
 *   deepest, so that a pair with a hull or a mesh may have 64, as in ODE's demos of moving ones. A
 *   sphere at a mesh's edge gets a normal more than 10 degrees off in half of the poses, and no
 *   contact where its centre is inside.
 * - Two meshes touch triangle by triangle, which has no depth for faces that lie in each other: of
 *   cubes of triangles dropped askew on a slab of triangles all came to lie on it within 1.4 mm in
 *   20 poses, but one that starts flush with the edges of another falls through it. */
#include "ode_shapes.h"

#include "plumb/engine_abi.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void pl_ode_free_solid(ode_solid *solid)
{
    if (solid->triangles != NULL) {
        dGeomTriMeshDataDestroy(solid->triangles);
    }
    pl_hull_faces_free(&solid->faces);
    free(solid->points);
    memset(solid, 0, sizeof *solid);
}

/* ODE's collider of convex shapes starts its search at the geom's origin, which must lie inside. A
 * mesh keeps its own frame, because ODE rounds its vertices to single precision: what was round
 * stays so. Both copies of vertices are the caller's to keep. */
pl_status pl_ode_make_solid(const pl_polyhedron *shape, ode_solid *solid, pl_error *error)
{
    if (!shape->convex) {
        solid->triangles = dGeomTriMeshDataCreate();
        dGeomTriMeshDataBuildDouble(solid->triangles, shape->vertices, sizeof *shape->vertices,
                                    shape->vertex_count, shape->triangles,
                                    3 * shape->triangle_count, sizeof *shape->triangles);
        /* The collider of convex shapes and meshes asks for the angles. */
        if (!dGeomTriMeshDataPreprocess2(solid->triangles,
                                         1u << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, NULL)) {
            return pl_fail(error, PL_NO_MEMORY, "ode could not prepare a mesh of %d triangles",
                           shape->triangle_count);
        }
        return PL_OK;
    }
    memcpy(solid->origin, shape->centre, sizeof solid->origin);
    solid->points = malloc((size_t)shape->vertex_count * sizeof *solid->points);
    if (solid->points == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for a hull of %d points",
                       shape->vertex_count);
    }
    for (int i = 0; i < shape->vertex_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            solid->points[i][k] = shape->vertices[i][k] - solid->origin[k];
        }
    }
    return pl_hull_faces_of(shape, solid->origin, &solid->faces, error);
}

dGeomID pl_ode_make_geom(dSpaceID space, const pl_shape *shape, const ode_solid *solid)
{
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        return dCreatePlane(space, shape->normal[0], shape->normal[1], shape->normal[2],
                            shape->offset);
    case PL_SHAPE_SPHERE:
        return dCreateSphere(space, shape->radius);
    case PL_SHAPE_BOX:
        return dCreateBox(space, 2 * shape->half_extents[0], 2 * shape->half_extents[1],
                          2 * shape->half_extents[2]);
    case PL_SHAPE_CAPSULE:
        return dCreateCapsule(space, shape->radius, 2 * shape->half_height);
    case PL_SHAPE_CYLINDER:
        return dCreateCylinder(space, shape->radius, 2 * shape->half_height);
    case PL_SHAPE_HULL:
        return dCreateConvex(space, solid->faces.planes[0], (unsigned int)solid->faces.count,
                             solid->points[0], (unsigned int)shape->polyhedron->vertex_count,
                             solid->faces.polygons);
    case PL_SHAPE_MESH:
        return dCreateTriMesh(space, solid->triangles, NULL, NULL, NULL);
    }
    return NULL;
}

void pl_ode_place_static(dGeomID geom, const pl_body *body, const ode_solid *solid)
{
    if (body->shape.kind == PL_SHAPE_PLANE) {
        return;
    }
    pl_vec p = pl_vec_of(body->position);
    if (solid != NULL) {
        const pl_axes axes = pl_axes_of(body->orientation);
        p = pl_vec_add(p, pl_to_world(&axes, pl_vec_of(solid->origin)));
    }
    dGeomSetPosition(geom, p.x, p.y, p.z);
    dGeomSetQuaternion(geom, body->orientation);
}

void pl_ode_place_in_body(dGeomID geom, const pl_shape *shape, const ode_solid *solid)
{
    if (solid == NULL) {
        return;
    }
    const double *a = shape->polyhedron->axes, back[4] = {a[0], -a[1], -a[2], -a[3]};
    const pl_axes axes = pl_axes_of(a);
    pl_vec p = pl_vec_sub(pl_vec_of(solid->origin), pl_vec_of(shape->polyhedron->centre));
    p = pl_to_local(&axes, p);
    dGeomSetOffsetPosition(geom, p.x, p.y, p.z);
    dGeomSetOffsetQuaternion(geom, back);
}

/* A shape of about the size 1 of each kind, its own frame its principal one. */
static dGeomID make_sample(pl_shape_kind kind, const pl_polyhedron *cube, ode_solid *solid)
{
    pl_shape shape = {.kind = kind,
                      .normal = {0, 0, 1},
                      .offset = 1,
                      .radius = 1,
                      .half_height = 1,
                      .half_extents = {1, 1, 1},
                      .polyhedron = cube};
    if ((kind == PL_SHAPE_HULL || kind == PL_SHAPE_MESH) &&
        pl_ode_make_solid(cube, solid, NULL) != PL_OK) {
        return NULL;
    }
    return pl_ode_make_geom(NULL, &shape, solid);
}

/* Whether ODE finds any contact between two shapes of these kinds, of half size 1 each, one 1.7
 * above the other and a little aside: a pair without a collider makes none. A mesh answers a shape
 * only whose centre is outside it. */
static bool has_collider(pl_shape_kind kind_a, pl_shape_kind kind_b)
{
    double corners[8][3];
    int triangles[12][3];
    for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < 3; ++k) {
            corners[i][k] = i >> k & 1 ? 1 : -1;
        }
    }
    for (int i = 0; i < 6; ++i) {
        /* The face at +-1 of axis k: corner 0 of it, and the two steps along the other axes. */
        int k = i / 2, side = i % 2, u = 1 << (k + 1 + side) % 3, v = 1 << (k + 2 - side) % 3;
        int first = side << k;
        const int halves[2][3] = {{first, first + v, first + u},
                                  {first + u, first + v, first + u + v}};
        memcpy(triangles[2 * i], halves, sizeof halves);
    }
    pl_polyhedron cube = {.vertex_count = 8,
                          .triangle_count = 12,
                          .vertices = corners,
                          .triangles = triangles,
                          .axes = {1, 0, 0, 0},
                          .radius = sqrt(3)};
    ode_solid solids[2] = {{.triangles = NULL}, {.triangles = NULL}};
    dContactGeom found[8];
    cube.convex = kind_a == PL_SHAPE_HULL;
    dGeomID a = make_sample(kind_a, &cube, &solids[0]);
    cube.convex = kind_b == PL_SHAPE_HULL;
    dGeomID b = make_sample(kind_b, &cube, &solids[1]);
    int count = 0;
    if (a != NULL && b != NULL) {
        dGeomSetPosition(kind_a == PL_SHAPE_PLANE ? b : a, 0.3, 0.4, 1.7);
        count = dCollide(a, b, 8, found, sizeof *found);
    }
    dGeomID geoms[2] = {a, b};
    for (int i = 0; i < 2; ++i) {
        if (geoms[i] != NULL) {
            dGeomDestroy(geoms[i]);
        }
        pl_ode_free_solid(&solids[i]);
    }
    return count > 0;
}

static const char *kind_name(int kind)
{
    return pl_needs_name((uint32_t)PL_NEEDS_PLANE << kind);
}

pl_status pl_ode_check_colliders(const pl_scene *scene, pl_error *error)
{
    int bodies[PL_SHAPE_KIND_COUNT] = {0}, moving[PL_SHAPE_KIND_COUNT] = {0};
    for (int i = 0; i < scene->body_count; ++i) {
        ++bodies[scene->bodies[i].shape.kind];
        moving[scene->bodies[i].shape.kind] += !scene->bodies[i].is_static;
    }
    for (int a = 0; a < PL_SHAPE_KIND_COUNT; ++a) {
        for (int b = a; b < PL_SHAPE_KIND_COUNT; ++b) {
            bool meet = bodies[a] > 0 && bodies[b] > (a == b) && moving[a] + moving[b] > 0;
            if (meet && !has_collider((pl_shape_kind)a, (pl_shape_kind)b)) {
                return pl_fail(error, PL_UNSUPPORTED, "ODE: no collider for %s-%s in this build",
                               kind_name(a), kind_name(b));
            }
        }
    }
    return PL_OK;
}
