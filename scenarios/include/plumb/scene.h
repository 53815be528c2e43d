/* The functions that make, check, read and write scenes. plumb/scene_data.h has their data. */
#ifndef PLUMB_SCENE_H
#define PLUMB_SCENE_H

#include "plumb/base.h"
#include "plumb/scene_data.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An empty scene: gravity (0, 0, -9.81), dt 1/60, duration 5, nothing expected. It owns nothing. */
pl_scene pl_scene_default(void);

/* A dynamic body of 1 kg at the origin, at rest, without shape data. */
pl_body pl_body_default(void);

/* The position 0 along z at the end of the scene, without a discrete answer, scale 1. */
pl_expect_value pl_expect_value_default(const pl_scene *scene);

/* The half-space {x : n.x <= offset}, n a unit vector; offset in m. */
pl_shape pl_shape_plane(double nx, double ny, double nz, double offset);

/* A sphere; m. */
pl_shape pl_shape_sphere(double radius);

/* A box; m. */
pl_shape pl_shape_box(double half_x, double half_y, double half_z);

/* A capsule along z; half_height without the round ends, m. */
pl_shape pl_shape_capsule(double radius, double half_height);

/* A cylinder along z; m. */
pl_shape pl_shape_cylinder(double radius, double half_height);

/* A hull if the polyhedron is convex, else a mesh. The shape borrows it. */
pl_shape pl_shape_of(const pl_polyhedron *polyhedron);

/* Makes the convex hull of `count` points a polyhedron of the scene, which *polyhedron (NULL
 * allowed) then borrows. `name` as in pl_polyhedron, or NULL. PL_BAD_INPUT: points that are not
 * finite or lie in one plane. */
pl_status pl_scene_add_hull(pl_scene *scene, const char *name, const double (*points)[3], int count,
                            const pl_polyhedron **polyhedron, pl_error *);

/* The same for the solid within closed surfaces of triangles. PL_BAD_INPUT: an index out of range,
 * or a surface that is open, not orientable, encloses nothing or crosses itself, and where. A mesh
 * may be wound in any way: its surfaces are turned outward, those of cavities inward. Vertices that
 * no triangle uses are removed. */
pl_status pl_scene_add_mesh(pl_scene *scene, const char *name, const double (*vertices)[3],
                            int vertex_count, const int (*triangles)[3], int triangle_count,
                            const pl_polyhedron **polyhedron, pl_error *);

/* The volume in m^3; 0 for a plane. */
double pl_shape_volume(const pl_shape *shape);

/* The principal inertia of the solid of uniform density about its centre of mass, kg m^2, in its
 * principal axes; zeros for a plane. `mass` in kg. */
void pl_shape_inertia(const pl_shape *shape, double mass, double inertia[3]);

/* Appends a copy of a material; its index goes into *index (NULL allowed). PL_BAD_INPUT beyond
 * PL_MAX_MATERIALS; PL_NO_MEMORY. A failure of this and of the functions below leaves the scene
 * unchanged. */
pl_status pl_scene_add_material(pl_scene *scene, const pl_material *item, int *index, pl_error *);

/* Appends a copy of an exception from the mixing rule. PL_NO_MEMORY. */
pl_status pl_scene_add_pair(pl_scene *scene, const pl_material_pair *item, pl_error *);

/* Appends a copy of a body; its index goes into *index (NULL allowed). If the inertia of a dynamic
 * body is all zeros, that of its shape is filled in. Fields without meaning (mass and inertia of a
 * static body, pose of a plane) become zero, and the orientation the identity. PL_NO_MEMORY. */
pl_status pl_scene_add_body(pl_scene *scene, const pl_body *item, int *index, pl_error *);

/* Appends a copy of a force. PL_NO_MEMORY. */
pl_status pl_scene_add_force(pl_scene *scene, const pl_force *item, pl_error *);

/* Appends a copy of an expected final pose. PL_NO_MEMORY. */
pl_status pl_scene_add_rest(pl_scene *scene, const pl_expect_rest *item, pl_error *);

/* Appends a copy of an expected distance. PL_NO_MEMORY. */
pl_status pl_scene_add_travel(pl_scene *scene, const pl_expect_travel *item, pl_error *);

/* Appends a copy of an expected number. PL_NO_MEMORY. */
pl_status pl_scene_add_value(pl_scene *scene, const pl_expect_value *item, pl_error *);

/* Appends a copy of an expected statistic. PL_NO_MEMORY. */
pl_status pl_scene_add_statistic(pl_scene *scene, const pl_expect_statistic *item, pl_error *);

/* Frees everything that the scene owns and makes it an empty default scene. NULL is allowed. */
void pl_scene_free(pl_scene *scene);

/* Friction and restitution of a pair of materials: the override where the scene has one, otherwise
 * the geometric mean of the frictions and the larger restitution (which is each material's own
 * value for a material against itself). */
void pl_scene_pair(const pl_scene *scene, int material_a, int material_b, double *friction,
                   double *restitution);

/* Number of steps of a run: round(duration / dt). */
long pl_scene_steps(const pl_scene *scene);

/* The names of the metrics that a scene may have as its primary error. The strings are static. */
const char *const *pl_primary_errors(int *count);

/* Checks a scene made by code by the same rules as one read from a file (finite numbers, mass > 0,
 * unit normals and quaternions to 1e-9, indices in range, unique names, static planes).
 * PL_BAD_INPUT says which field of which object, and the number. */
pl_status pl_scene_validate(const pl_scene *scene, pl_error *);

/* Reads a scene file ("plumb_scene": 1). `path` "-" is standard input. The error's message is
 * FILE:LINE:COLUMN: path.to.field: what was expected, what was found. A relative path in the file
 * begins at the file's folder, or at the working directory for standard input. The caller frees
 * *scene. */
pl_status pl_scene_read_file(const char *path, pl_scene *scene, pl_error *);

/* The same for text in memory, which may name no files; `label` stands for the file's name in
 * messages. */
pl_status pl_scene_read_text(const char *text, size_t length, const char *label, pl_scene *scene,
                             pl_error *);

/* A valid scene as JSON text that pl_scene_read_text reads back to the same scene, number for
 * number. Forces come in the order of their bodies. A polyhedron that several bodies share gets a
 * name; one that has neither a name nor a body is not written. malloc'd; the caller frees. NULL
 * when out of memory. */
char *pl_scene_to_text(const pl_scene *scene);

/* 64-bit FNV-1a of that text as 16 hexadecimal digits and a zero: two scenes with the same hash are
 * the same. PL_NO_MEMORY leaves `hash` empty. */
pl_status pl_scene_hash(const pl_scene *scene, char hash[17], pl_error *);

#ifdef __cplusplus
}
#endif
#endif
