/* ODE 0.16 in double precision, through its C API.
 *
 * quick:   dWorldQuickStep, successive over-relaxation with a fixed number of sweeps.
 * dantzig: dWorldStep, Dantzig's pivoting on the dense matrix of each island.
 *
 * Contacts are made anew at every step, as ODE's manual has it (section "Collision Detection"): up
 * to max_contacts points a pair, with the friction pyramid whose limits follow the normal force
 * (dContactApprox1) and, where the pair's restitution e > 0, dContactBounce with threshold 0.
 * Everything else stays as ODE ships it: ERP, CFM, surface layer, unbounded correcting velocity,
 * over-relaxation, implicit gyroscopic torque. Automatic disabling is off.
 *
 * The contact forces are asked for as joint feedback, which ODE works out inside its step: 4 % more
 * instructions of `quick` on the wall of 10 x 10, and not a bit of difference in the motion.
 *
 * The space is dHashSpace, as in ODE's own demos. ODE has no islands, residual or iteration count
 * to report: `quick` runs exactly the sweeps it is told, and that number is reported; `dantzig`
 * reports none.
 *
 * Shapes are ODE's own: a hull is a dConvex, a mesh a dTriMesh. Rolling friction is none. Builds of
 * ODE differ in the pairs that they can collide, so `create` asks ODE itself and declines a scene
 * with a pair that has no collider. Debian's libode8 0.16.2 (OPCODE with its new collider of two
 * meshes, libccd for cylinders, capsules and hulls) has one for every pair. Measured on it, bodies
 * of 1 m at a depth of 1 cm in random poses:
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
 *   20 poses, but one that starts flush with the edges of another falls through it.
 *
 * ODE's conventions: quaternions (w, x, y, z) and world angular velocity are ours; a contact's
 * normal points into the first geom and its depth is positive; a joint's feedback is the force on
 * each of its bodies, where a joint with one body only has it as its first. */
#include "adapters/adapters.h"
#include "adapters/force.h"
#include "adapters/hull_faces.h"
#include "adapters/principal.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"

#include <math.h>
#include <ode/ode.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PROFILE_QUICK, PROFILE_DANTZIG, PROFILE_COUNT };
enum {
    OPTION_ITERATIONS,
    OPTION_ERP,
    OPTION_CFM,
    OPTION_MAX_CONTACTS,
    OPTION_SOLID_CONTACTS,
    OPTION_SURFACE_LAYER,
    OPTION_COUNT
};

enum { SHIPPED_ITERATIONS = 20, MOST_CONTACTS = 64, MOST_SOLID_CONTACTS = 4096 };

static const double gibibyte = 1024.0 * 1024.0 * 1024.0;
static const double dense_limit = 4 * 1024.0 * 1024.0 * 1024.0; /* bytes */

static const pl_engine_profile profiles[PROFILE_COUNT] = {
    [PROFILE_QUICK] = {.name = "quick",
                       .help = "dWorldQuickStep: successive over-relaxation",
                       .in_default_comparison = true},
    [PROFILE_DANTZIG] = {.name = "dantzig",
                         .help = "dWorldStep: Dantzig's pivoting on a dense matrix",
                         .in_default_comparison = true},
};

static const pl_engine_option options[OPTION_COUNT] = {
    [OPTION_ITERATIONS] = {.name = "iterations",
                           .value = SHIPPED_ITERATIONS,
                           .min = 1,
                           .max = 1e6,
                           .integer = true,
                           .unit = "1",
                           .help = "sweeps of quick; dantzig has none"},
    [OPTION_ERP] = {.name = "erp",
                    .value = 0.2,
                    .min = 0,
                    .max = 1,
                    .unit = "1",
                    .help = "share of the penetration undone in a step"},
    [OPTION_CFM] = {.name = "cfm",
                    .value = 1e-10,
                    .min = 0,
                    .max = 1,
                    .unit = "s^2/kg",
                    .help = "softness added to the diagonal"},
    [OPTION_MAX_CONTACTS] = {.name = "max_contacts",
                             .value = 8,
                             .min = 1,
                             .max = MOST_CONTACTS,
                             .integer = true,
                             .unit = "1",
                             .help = "contact points a pair; two boxes make at most 8"},
    [OPTION_SOLID_CONTACTS] = {.name = "solid_contacts",
                               .value = 64,
                               .min = 1,
                               .max = MOST_SOLID_CONTACTS,
                               .integer = true,
                               .unit = "1",
                               .help = "the same of a pair with a hull or a mesh; ODE takes the "
                                       "first, not the deepest"},
    [OPTION_SURFACE_LAYER] = {.name = "surface_layer",
                              .value = 0,
                              .min = 0,
                              .max = 1e3,
                              .unit = "m",
                              .help =
                                  "penetration that is not pushed out; ODE suggests about 0.001"},
};

/* A hull or a mesh as ODE's geoms share it. */
typedef struct ode_solid {
    double origin[3];         /* of the geoms' frame, in the shape's, whose axes it has; m */
    double (*points)[3];      /* hull: (vertex_count), from `origin` */
    pl_hull_faces faces;      /* hull */
    dTriMeshDataID triangles; /* mesh; borrows the scene's arrays */
} ode_solid;

/* A contact point of the current step. */
typedef struct ode_contact {
    dContactGeom geom;
    dJointID joint;
} ode_contact;

struct pl_engine_instance {
    const pl_scene *scene;
    int profile, max_contacts, solid_contacts;
    dWorldID world;
    dSpaceID space;
    dJointGroupID joints;
    dBodyID *bodies;   /* (body_count), NULL for a static body */
    dGeomID *geoms;    /* (body_count) */
    ode_solid *solids; /* (polyhedron_count) */
    double time, last_dt;

    ode_contact *contacts; /* (contact_capacity) */
    dJointFeedback *feedback;
    int contact_count, contact_capacity;
    bool out_of_memory;

    int *island;  /* (body_count): union-find parents, used only when memory is in question */
    double *rows; /* (body_count) */
};

/* ODE calls exit(1) after an error handler returns. A process that ends so would look like one that
 * chose to end; a signal cannot be mistaken. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 0)))
#endif
static void
fatal(int number, const char *format, va_list arguments)
{
    fprintf(stderr, "ODE error %d: ", number);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    fflush(stderr);
    abort();
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int geom_index(dGeomID geom)
{
    return (int)(intptr_t)dGeomGetData(geom);
}

static bool is_solid(dGeomID geom)
{
    int class = dGeomGetClass(geom);
    return class == dConvexClass || class == dTriMeshClass;
}

static bool reserve_contacts(pl_engine_instance *instance, int more)
{
    if (instance->contact_count + more <= instance->contact_capacity) {
        return true;
    }
    int capacity = 2 * instance->contact_capacity + more;
    ode_contact *contacts = realloc(instance->contacts, (size_t)capacity * sizeof *contacts);
    if (contacts != NULL) {
        instance->contacts = contacts;
    }
    dJointFeedback *feedback = realloc(instance->feedback, (size_t)capacity * sizeof *feedback);
    if (feedback != NULL) {
        instance->feedback = feedback;
    }
    if (contacts == NULL || feedback == NULL) {
        return false;
    }
    instance->contact_capacity = capacity;
    return true;
}

static void collide_pair(void *data, dGeomID a, dGeomID b)
{
    pl_engine_instance *instance = data;
    dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == NULL && body_b == NULL) {
        return;
    }
    int most = is_solid(a) || is_solid(b) ? instance->solid_contacts : instance->max_contacts;
    if (!reserve_contacts(instance, most)) {
        instance->out_of_memory = true;
        return;
    }
    ode_contact *found = &instance->contacts[instance->contact_count];
    int count = dCollide(a, b, most, &found->geom, sizeof *found);
    if (count == 0) {
        return;
    }
    dContact contact;
    memset(&contact, 0, sizeof contact);
    const pl_scene *scene = instance->scene;
    double friction, restitution;
    pl_scene_pair(scene, scene->bodies[geom_index(a)].material,
                  scene->bodies[geom_index(b)].material, &friction, &restitution);
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = friction;
    if (restitution > 0) {
        contact.surface.mode |= dContactBounce;
        contact.surface.bounce = restitution;
    }
    for (int i = 0; i < count; i++) {
        contact.geom = found[i].geom;
        found[i].joint = dJointCreateContact(instance->world, instance->joints, &contact);
        dJointAttach(found[i].joint, body_a, body_b);
    }
    instance->contact_count += count;
}

static void free_solid(ode_solid *solid)
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
static pl_status make_solid(const pl_polyhedron *shape, ode_solid *solid, pl_error *error)
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
    for (int i = 0; i < shape->vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            solid->points[i][k] = shape->vertices[i][k] - solid->origin[k];
        }
    }
    return pl_hull_faces_of(shape, solid->origin, &solid->faces, error);
}

/* `solid` is that of the shape's polyhedron. NULL when ODE has no such shape. */
static dGeomID make_geom(dSpaceID space, const pl_shape *shape, const ode_solid *solid)
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

static const ode_solid *solid_of(const pl_engine_instance *instance, const pl_shape *shape)
{
    for (int i = 0; shape->polyhedron != NULL && i < instance->scene->polyhedron_count; i++) {
        if (instance->scene->polyhedra[i] == shape->polyhedron) {
            return &instance->solids[i];
        }
    }
    return NULL;
}

/* Places a geom whose frame is the shape's, but for the origin of `solid`. */
static void place_static(dGeomID geom, const pl_body *body, const ode_solid *solid)
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

/* Places the geom in the principal frame of its body. */
static void place_in_body(dGeomID geom, const pl_shape *shape, const ode_solid *solid)
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

static pl_status add_body(pl_engine_instance *instance, int index, pl_error *error)
{
    const pl_body *body = &instance->scene->bodies[index];
    const pl_shape *shape = &body->shape;
    const ode_solid *solid = solid_of(instance, shape);
    if (shape->polyhedron != NULL && solid == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "body \"%s\": its solid is not one of the scene's",
                       body->name);
    }
    dGeomID geom = make_geom(instance->space, shape, solid);
    if (geom == NULL) {
        return pl_fail(error, PL_UNSUPPORTED, "body \"%s\": ode has no shape of kind %d",
                       body->name, (int)shape->kind);
    }
    instance->geoms[index] = geom;
    dGeomSetData(geom, (void *)(intptr_t)index);
    if (body->is_static) {
        place_static(geom, body, solid);
        return PL_OK;
    }
    const double *v = body->velocity, *w = body->angular_velocity;
    double p[3], q[4];
    memcpy(p, body->position, sizeof p);
    memcpy(q, body->orientation, sizeof q);
    pl_to_principal_pose(shape, p, q);
    dBodyID made = dBodyCreate(instance->world);
    instance->bodies[index] = made;
    dMass mass;
    dMassSetParameters(&mass, body->mass, 0, 0, 0, body->inertia[0], body->inertia[1],
                       body->inertia[2], 0, 0, 0);
    dBodySetMass(made, &mass);
    dBodySetPosition(made, p[0], p[1], p[2]);
    dBodySetQuaternion(made, q);
    dBodySetLinearVel(made, v[0], v[1], v[2]);
    dBodySetAngularVel(made, w[0], w[1], w[2]);
    dBodySetAutoDisableFlag(made, 0);
    dGeomSetBody(geom, made);
    place_in_body(geom, shape, solid);
    return PL_OK;
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
        make_solid(cube, solid, NULL) != PL_OK) {
        return NULL;
    }
    return make_geom(NULL, &shape, solid);
}

/* Whether ODE finds any contact between two shapes of these kinds, of half size 1 each, one 1.7
 * above the other and a little aside: a pair without a collider makes none. A mesh answers a shape
 * only whose centre is outside it. */
static bool has_collider(pl_shape_kind kind_a, pl_shape_kind kind_b)
{
    double corners[8][3];
    int triangles[12][3];
    for (int i = 0; i < 8; i++) {
        for (int k = 0; k < 3; k++) {
            corners[i][k] = i >> k & 1 ? 1 : -1;
        }
    }
    for (int i = 0; i < 6; i++) {
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
    for (int i = 0; i < 2; i++) {
        if (geoms[i] != NULL) {
            dGeomDestroy(geoms[i]);
        }
        free_solid(&solids[i]);
    }
    return count > 0;
}

static const char *kind_name(int kind)
{
    return pl_needs_name((uint32_t)PL_NEEDS_PLANE << kind);
}

/* Builds of ODE differ in what they can collide, so ODE itself is asked. */
static pl_status check_colliders(const pl_scene *scene, pl_error *error)
{
    int bodies[PL_SHAPE_KIND_COUNT] = {0}, moving[PL_SHAPE_KIND_COUNT] = {0};
    for (int i = 0; i < scene->body_count; i++) {
        bodies[scene->bodies[i].shape.kind]++;
        moving[scene->bodies[i].shape.kind] += !scene->bodies[i].is_static;
    }
    for (int a = 0; a < PL_SHAPE_KIND_COUNT; a++) {
        for (int b = a; b < PL_SHAPE_KIND_COUNT; b++) {
            bool meet = bodies[a] > 0 && bodies[b] > (a == b) && moving[a] + moving[b] > 0;
            if (meet && !has_collider((pl_shape_kind)a, (pl_shape_kind)b)) {
                return pl_fail(error, PL_UNSUPPORTED, "ODE: no collider for %s-%s in this build",
                               kind_name(a), kind_name(b));
            }
        }
    }
    return PL_OK;
}

static void ode_destroy(pl_engine_instance *instance)
{
    if (instance == NULL) {
        return;
    }
    if (instance->world != NULL) {
        dJointGroupDestroy(instance->joints);
        dSpaceDestroy(instance->space);
        dWorldDestroy(instance->world);
        for (int i = 0; instance->solids != NULL && i < instance->scene->polyhedron_count; i++) {
            free_solid(&instance->solids[i]);
        }
        dCloseODE();
    }
    free(instance->solids);
    free(instance->bodies);
    free(instance->geoms);
    free(instance->contacts);
    free(instance->feedback);
    free(instance->island);
    free(instance->rows);
    free(instance);
}

static pl_status make_world(pl_engine_instance *instance, const double *values, pl_error *error)
{
    if (sizeof(dReal) != sizeof(double) || !dCheckConfiguration("ODE_double_precision")) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "this ODE library is built in single precision; plumb needs double");
    }
    if (!dInitODE2(0)) {
        return pl_fail(error, PL_FAILED, "dInitODE2 failed");
    }
    dSetErrorHandler(fatal);
    dSetDebugHandler(fatal);
    /* quick visits constraints in an order drawn from this generator, which the process shares. */
    dRandSetSeed(0);
    const double *g = instance->scene->gravity;
    instance->world = dWorldCreate();
    instance->space = dHashSpaceCreate(NULL);
    instance->joints = dJointGroupCreate(0);
    dWorldSetGravity(instance->world, g[0], g[1], g[2]);
    dWorldSetERP(instance->world, values[OPTION_ERP]);
    dWorldSetCFM(instance->world, values[OPTION_CFM]);
    dWorldSetContactSurfaceLayer(instance->world, values[OPTION_SURFACE_LAYER]);
    dWorldSetAutoDisableFlag(instance->world, 0);
    dWorldSetQuickStepNumIterations(instance->world, (int)values[OPTION_ITERATIONS]);
    instance->max_contacts = (int)values[OPTION_MAX_CONTACTS];
    instance->solid_contacts = (int)values[OPTION_SOLID_CONTACTS];
    return check_colliders(instance->scene, error);
}

static pl_status ode_create(const pl_scene *scene, int profile, const double *values,
                            pl_engine_instance **out, pl_error *error)
{
    *out = NULL;
    if (profile == PROFILE_DANTZIG && (int)values[OPTION_ITERATIONS] != SHIPPED_ITERATIONS) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "ode:dantzig pivots until it is done: it has no iterations to set");
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for an ode world");
    }
    pl_status status = PL_OK;
    size_t count = (size_t)scene->body_count + 1;
    instance->scene = scene;
    instance->profile = profile;
    instance->bodies = calloc(count, sizeof *instance->bodies);
    instance->geoms = calloc(count, sizeof *instance->geoms);
    instance->solids = calloc((size_t)scene->polyhedron_count + 1, sizeof *instance->solids);
    instance->island = calloc(count, sizeof *instance->island);
    instance->rows = calloc(count, sizeof *instance->rows);
    if (instance->bodies == NULL || instance->geoms == NULL || instance->solids == NULL ||
        instance->island == NULL || instance->rows == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %d ode bodies", scene->body_count);
        goto cleanup;
    }
    status = make_world(instance, values, error);
    for (int i = 0; status == PL_OK && i < scene->polyhedron_count; i++) {
        status = make_solid(scene->polyhedra[i], &instance->solids[i], error);
    }
    for (int i = 0; status == PL_OK && i < scene->body_count; i++) {
        status = add_body(instance, i, error);
    }
    if (status == PL_OK) {
        *out = instance;
        instance = NULL;
    }
cleanup:
    ode_destroy(instance);
    return status;
}

/* The pose of the frame of a moving body's shape. */
static void read_pose(const pl_engine_instance *instance, int body, double position[3],
                      double orientation[4])
{
    dBodyID moving = instance->bodies[body];
    memcpy(position, dBodyGetPosition(moving), 3 * sizeof *position);
    memcpy(orientation, dBodyGetQuaternion(moving), 4 * sizeof *orientation);
    pl_to_shape_pose(&instance->scene->bodies[body].shape, position, orientation);
}

static void add_forces(const pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    for (int i = 0; i < scene->force_count; i++) {
        const pl_force *force = &scene->forces[i];
        dBodyID body = instance->bodies[force->body];
        double p[3], q[4], f[3], r[3];
        if (body == NULL) {
            continue;
        }
        read_pose(instance, force->body, p, q);
        if (pl_force_at(force, instance->time, dt, q, f, r)) {
            dBodyAddForce(body, f[0], f[1], f[2]);
            pl_vec torque = pl_vec_cross(pl_vec_of(r), pl_vec_of(f));
            dBodyAddTorque(body, torque.x, torque.y, torque.z);
        }
    }
}

static int island_root(int *parent, int body)
{
    while (parent[body] != body) {
        parent[body] = parent[parent[body]];
        body = parent[body];
    }
    return body;
}

/* Constraint rows of the largest island: dWorldStep solves the islands one after another. A static
 * body joins none, so a contact counts at its moving body. */
static double largest_island_rows(const pl_engine_instance *instance)
{
    int count = instance->scene->body_count;
    int *parent = instance->island;
    for (int i = 0; i < count; i++) {
        parent[i] = i;
        instance->rows[i] = 0;
    }
    for (int i = 0; i < instance->contact_count; i++) {
        int a = geom_index(instance->contacts[i].geom.g1);
        int b = geom_index(instance->contacts[i].geom.g2);
        if (instance->bodies[a] != NULL && instance->bodies[b] != NULL) {
            parent[island_root(parent, a)] = island_root(parent, b);
        }
    }
    double largest = 0;
    for (int i = 0; i < instance->contact_count; i++) {
        int a = geom_index(instance->contacts[i].geom.g1);
        int b = geom_index(instance->contacts[i].geom.g2);
        int root = island_root(parent, instance->bodies[a] != NULL ? a : b);
        instance->rows[root] += 3;
        largest = fmax(largest, instance->rows[root]);
    }
    return largest;
}

/* dWorldStep holds the island's matrix and its factor, both dense (ODE, lcp.cpp and step.cpp: A and
 * L). */
static double dense_bytes(double rows)
{
    return 2 * rows * rows * (double)sizeof(dReal);
}

static pl_status check_dense_memory(const pl_engine_instance *instance, pl_error *error)
{
    if (dense_bytes(3.0 * instance->contact_count) <= dense_limit) {
        return PL_OK;
    }
    double rows = largest_island_rows(instance);
    if (dense_bytes(rows) <= dense_limit) {
        return PL_OK;
    }
    return pl_fail(
        error, PL_UNSUPPORTED,
        "ode:dantzig needs %.1f GiB for the dense matrices of %.0f contact rows; the limit "
        "is %.0f GiB",
        dense_bytes(rows) / gibibyte, rows, dense_limit / gibibyte);
}

static pl_status ode_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                          pl_error *error)
{
    double start = now();
    dJointGroupEmpty(instance->joints);
    instance->contact_count = 0;
    dSpaceCollide(instance->space, instance, collide_pair);
    if (instance->out_of_memory) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for more than %d ode contacts",
                       instance->contact_count);
    }
    for (int i = 0; i < instance->contact_count; i++) {
        dJointSetFeedback(instance->contacts[i].joint, &instance->feedback[i]);
    }
    add_forces(instance, dt);
    if (instance->profile == PROFILE_DANTZIG) {
        pl_status status = check_dense_memory(instance, error);
        if (status != PL_OK) {
            return status;
        }
    }
    double collided = now();
    int stepped = instance->profile == PROFILE_QUICK ? dWorldQuickStep(instance->world, dt)
                                                     : dWorldStep(instance->world, dt);
    double solved = now();
    if (!stepped) {
        return pl_fail(error, PL_NO_MEMORY, "ode found no memory to step %d contacts",
                       instance->contact_count);
    }
    instance->time += dt;
    instance->last_dt = dt;
    if (instance->profile == PROFILE_QUICK) {
        stats->iterations = dWorldGetQuickStepNumIterations(instance->world);
    }
    stats->contacts = instance->contact_count;
    stats->time_collide = collided - start;
    stats->time_solve = solved - collided;
    return PL_OK;
}

static void read_static(const pl_engine_instance *instance, int body, pl_body_state *state)
{
    dGeomID geom = instance->geoms[body];
    const ode_solid *solid = solid_of(instance, &instance->scene->bodies[body].shape);
    memcpy(state->position, dGeomGetPosition(geom), sizeof state->position);
    dGeomGetQuaternion(geom, state->orientation);
    if (solid != NULL) {
        const pl_axes axes = pl_axes_of(state->orientation);
        pl_vec origin = pl_to_world(&axes, pl_vec_of(solid->origin));
        pl_vec_store(pl_vec_sub(pl_vec_of(state->position), origin), state->position);
    }
}

static void ode_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const pl_scene *scene = instance->scene;
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; i++) {
        pl_body_state *state = &frame->bodies[i];
        dBodyID body = instance->bodies[i];
        memset(state, 0, sizeof *state);
        if (body != NULL) {
            read_pose(instance, i, state->position, state->orientation);
            memcpy(state->velocity, dBodyGetLinearVel(body), sizeof state->velocity);
            memcpy(state->angular_velocity, dBodyGetAngularVel(body),
                   sizeof state->angular_velocity);
        } else if (scene->bodies[i].shape.kind == PL_SHAPE_PLANE) {
            /* ODE's planes have no pose. */
            memcpy(state->position, scene->bodies[i].position, sizeof state->position);
            memcpy(state->orientation, scene->bodies[i].orientation, sizeof state->orientation);
        } else {
            read_static(instance, i, state);
        }
    }
}

static void ode_read_settings(const pl_engine_instance *instance, double dt,
                              pl_engine_settings *settings)
{
    dVector3 gravity;
    dWorldGetGravity(instance->world, gravity);
    memcpy(settings->gravity, gravity, sizeof settings->gravity);
    settings->dt = dt;
    for (int i = 0; i < settings->body_count; i++) {
        dMass mass;
        memset(&mass, 0, sizeof mass);
        if (instance->bodies[i] != NULL) {
            dBodyGetMass(instance->bodies[i], &mass);
        }
        settings->mass[i] = mass.mass;
        for (int k = 0; k < 3; k++) {
            settings->inertia[i][k] = mass.I[5 * k]; /* the diagonal of a 3 x 4 matrix */
        }
    }
}

static void ode_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                          double *friction, double *restitution)
{
    const pl_scene *scene = instance->scene;
    pl_scene_pair(scene, scene->bodies[body_a].material, scene->bodies[body_b].material, friction,
                  restitution);
}

static int ode_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    int count = instance->contact_count < capacity ? instance->contact_count : capacity;
    for (int i = 0; i < count; i++) {
        const dContactGeom *geom = &instance->contacts[i].geom;
        int first = geom_index(geom->g1), second = geom_index(geom->g2);
        bool in_order = first < second;
        pl_contact *contact = &contacts[i];
        contact->body_a = in_order ? first : second;
        contact->body_b = in_order ? second : first;
        contact->separation = -geom->depth;
        /* f1 is the force on the first geom's body, or on the only moving one. */
        bool on_b = instance->bodies[first] != NULL ? !in_order : in_order;
        for (int k = 0; k < 3; k++) {
            contact->point[k] = geom->pos[k];
            contact->normal[k] = in_order ? -geom->normal[k] : geom->normal[k];
            contact->impulse[k] = (on_b ? 1 : -1) * instance->feedback[i].f1[k] * instance->last_dt;
        }
    }
    return instance->contact_count;
}

/* Asks ODE itself, so that a library built with other defaults is compared as it ships. */
static void ode_profile_defaults(int profile, double *values)
{
    (void)profile;
    if (!dInitODE2(0)) {
        return;
    }
    dWorldID world = dWorldCreate();
    values[OPTION_ITERATIONS] = dWorldGetQuickStepNumIterations(world);
    values[OPTION_ERP] = dWorldGetERP(world);
    values[OPTION_CFM] = dWorldGetCFM(world);
    values[OPTION_SURFACE_LAYER] = dWorldGetContactSurfaceLayer(world);
    dWorldDestroy(world);
    dCloseODE();
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "ode",
    .version = PLUMB_ODE_VERSION,
    .description = "Open Dynamics Engine, double precision",
    .residual_unit = NULL,
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES |
                    PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX | PL_NEEDS_CAPSULE |
                    PL_NEEDS_CYLINDER | PL_NEEDS_HULL | PL_NEEDS_MESH,
    .profiles = profiles,
    .profile_count = PROFILE_COUNT,
    .options = options,
    .option_count = OPTION_COUNT,
    .profile_defaults = ode_profile_defaults,
    .create = ode_create,
    .destroy = ode_destroy,
    .step = ode_step,
    .read_frame = ode_read_frame,
    .read_settings = ode_read_settings,
    .read_pair = ode_read_pair,
    .read_contacts = ode_read_contacts,
};

const pl_engine *pl_engine_ode(void)
{
    return &engine;
}
