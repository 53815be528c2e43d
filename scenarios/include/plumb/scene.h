/* The engine-neutral scene: what is there at t = 0, and what is expected of it.
 *
 * SI units, right-handed, z up by custom (gravity says). Quaternions are (w, x, y, z), unit, body
 * to world. `velocity` is that of the centre of mass; `velocity` and `angular_velocity` are in the
 * world frame. `position` and `orientation` place the shape's own frame: for a hull or a mesh that
 * of its vertices, for the others also that of the centre of mass and of the principal axes.
 *
 * Plain data throughout: adapters and loadable engines read it as it stands. Arrays are owned by
 * the scene; indices refer from one array to another, but for shapes, which point to the scene's
 * polyhedra. */
#ifndef PLUMB_SCENE_H
#define PLUMB_SCENE_H

#include "plumb/base.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Limits of a scene. */
enum {
    PL_MAX_MATERIALS = 256,
    PL_MAX_BODIES = 100000,
    PL_MAX_STEPS = 10000000,
    PL_MAX_SCENE_BYTES = 64 << 20 /* of a scene file */
};

typedef enum pl_shape_kind {
    PL_SHAPE_PLANE,
    PL_SHAPE_SPHERE,
    PL_SHAPE_BOX,
    PL_SHAPE_CAPSULE,  /* around the segment from -half_height to half_height on its z axis */
    PL_SHAPE_CYLINDER, /* about its z axis, capped at -half_height and half_height */
    PL_SHAPE_HULL,     /* the convex hull of its points */
    PL_SHAPE_MESH      /* the solid within closed surfaces of triangles */
} pl_shape_kind;
enum { PL_SHAPE_KIND_COUNT = 7 };

/* The solid of a hull or a mesh, in the shape's own frame. */
typedef struct pl_polyhedron {
    char name[PL_NAME_SIZE]; /* in the scene file's "shapes"; empty: it has none */
    bool convex;             /* a hull */
    int vertex_count, triangle_count;
    double (*vertices)[3]; /* (vertex_count), m; of a hull, those of its points that are corners */
    int (*triangles)[3];   /* (triangle_count), counter-clockwise seen from outside */
    double volume;         /* m^3 */
    double centre[3];      /* of mass, m */
    double axes[4];        /* unit quaternion: principal axes to the shape's frame */
    double inertia[3];     /* principal, of 1 kg, about the centre, m^2 */
    double radius;         /* of the smallest sphere about the centre that holds all vertices, m */
} pl_polyhedron;

typedef struct pl_shape {
    pl_shape_kind kind;
    double normal[3];   /* plane: unit, points out of the solid half-space {x : n.x <= offset} */
    double offset;      /* plane: m, along the normal */
    double radius;      /* sphere, capsule, cylinder: m */
    double half_height; /* capsule, cylinder: m */
    double half_extents[3];          /* box: m */
    const pl_polyhedron *polyhedron; /* hull, mesh: of the scene */
} pl_shape;

typedef struct pl_material {
    char name[PL_NAME_SIZE];
    double friction;    /* Coulomb coefficient against itself, >= 0 */
    double restitution; /* Newton coefficient against itself, 0 .. 1 */
} pl_material;

/* Overrides the mixing rule for one unordered pair of materials. */
typedef struct pl_material_pair {
    int material_a, material_b;
    double friction, restitution;
} pl_material_pair;

typedef struct pl_body {
    char name[PL_NAME_SIZE]; /* unique in the scene */
    bool is_static;          /* never moves; mass and inertia have no meaning */
    int material;            /* index */
    pl_shape shape;          /* a plane is always static and ignores position and orientation */
    double mass;             /* kg, > 0 for a dynamic body */
    double inertia[3];  /* kg m^2, principal, about the centre of mass, in its principal axes */
    double position[3]; /* of the shape's frame, m */
    double orientation[4];
    double velocity[3];         /* m/s */
    double angular_velocity[3]; /* rad/s */
} pl_body;

typedef enum pl_force_frame { PL_FRAME_WORLD, PL_FRAME_BODY } pl_force_frame;

/* A constant force on a body at a point, over from <= t < until; t is the time at the start of a
 * step. In the world frame, `force` is in world axes and `at` is an offset from the centre of mass
 * in world axes; in the body frame both are in the axes of the shape's frame and turn with it. */
typedef struct pl_force {
    int body;
    double force[3]; /* N */
    double at[3];    /* m, from the centre of mass */
    pl_force_frame frame;
    double from, until; /* s; until may be INFINITY */
} pl_force;

/* The final pose that a right engine reaches. */
typedef struct pl_expect_rest {
    int body;
    double position[3];
    double orientation[4];
    bool has_orientation;
} pl_expect_rest;

/* A body that moves along one line: how far a right engine carries it by the end of the run. */
typedef struct pl_expect_travel {
    int body;
    double direction[3]; /* unit, world */
    double distance;     /* m, of the continuous problem */
    double discrete; /* m, the exact answer of semi-implicit Euler at the scene's dt; NAN if none */
} pl_expect_travel;

/* What is read from the path of one body. */
typedef enum pl_quantity {
    PL_QUANTITY_POSITION, /* m: of its frame along the direction, from where it starts, at `until`
                           */
    PL_QUANTITY_VELOCITY, /* m/s: of its centre of mass along the direction, at `until` */
    PL_QUANTITY_SPIN,     /* rad/s: of its angular velocity along the direction, at `until` */
    PL_QUANTITY_TURN,  /* rad: the sum over steps of the parts of their turns along the direction,
                          until `until`: also over whole turns */
    PL_QUANTITY_APEX,  /* m: the highest position along the direction, from its start, in
                          from .. until */
    PL_QUANTITY_PERIOD /* s: of the angular velocity along the direction, which turns with the
                          body: the mean time between its changes from - to + in from .. until */
} pl_quantity;
enum { PL_QUANTITY_COUNT = 6 };

/* A number that a right engine reaches. Between frames it is interpolated linearly; an apex is that
 * of the parabola through the highest frame and its neighbours. */
typedef struct pl_expect_value {
    int body;
    pl_quantity quantity;
    double direction[3]; /* unit, world; of a period in the axes of the shape's frame */
    double from, until;  /* s; from matters to apex and period alone */
    double value;        /* of the continuous problem */
    double discrete; /* the exact answer of semi-implicit Euler at the scene's dt; NAN if none */
    double scale;    /* > 0, in the quantity's unit: what the error is divided by */
} pl_expect_value;

typedef struct pl_scene {
    char name[PL_NAME_SIZE];
    double gravity[3]; /* m/s^2 */
    double dt;         /* s, > 0 */
    double duration;   /* s, >= dt; steps = round(duration / dt) */

    pl_material *materials;
    int material_count;
    pl_material_pair *pairs;
    int pair_count;
    pl_polyhedron **polyhedra; /* (polyhedron_count); each stays where it is */
    int polyhedron_count;
    pl_body *bodies;
    int body_count;
    pl_force *forces;
    int force_count;

    /* What is expected. */
    pl_expect_rest *rests;
    int rest_count;
    pl_expect_travel *travels;
    int travel_count;
    pl_expect_value *values;
    int value_count;
    /* The metric that is the scene's primary error (metrics' names: "rest_position_error", "drift",
     * "value_error", "penetration_max"); empty when the scene has no reference. */
    char primary_error[PL_NAME_SIZE];
    /* A body of `rests` farther than this from its reference at the end has fallen: outcome
     * `collapsed`. m; INFINITY when nothing is expected to stand. */
    double collapse_distance;
} pl_scene;

/* An empty scene: gravity (0, 0, -9.81), dt 1/60, duration 5, nothing expected. Owns nothing yet.
 */
pl_scene pl_scene_default(void);

/* A dynamic unit-mass body at the origin, at rest, without shape data. Owns nothing. */
pl_body pl_body_default(void);

/* At rest at the end of the scene: direction (0, 0, 1), no discrete answer, scale 1. */
pl_expect_value pl_expect_value_default(const pl_scene *scene);

pl_shape pl_shape_plane(double nx, double ny, double nz, double offset);
pl_shape pl_shape_sphere(double radius);
pl_shape pl_shape_box(double half_x, double half_y, double half_z);
pl_shape pl_shape_capsule(double radius, double half_height);
pl_shape pl_shape_cylinder(double radius, double half_height);
pl_shape pl_shape_of(const pl_polyhedron *polyhedron); /* a hull if it is convex, else a mesh */

/* Make a polyhedron of the scene's own, which *polyhedron (NULL allowed) then borrows; `name` as in
 * pl_polyhedron, or NULL. PL_BAD_INPUT: of a hull, points that are not finite or lie in one plane;
 * of a mesh, an index out of range, or a surface that is open, not orientable, encloses nothing or
 * crosses itself, and where. A mesh may be wound in any way: its surfaces are turned outward, those
 * of cavities inward; vertices that no triangle has are left out. */
pl_status pl_scene_add_hull(pl_scene *scene, const char *name, const double (*points)[3], int count,
                            const pl_polyhedron **polyhedron, pl_error *);
pl_status pl_scene_add_mesh(pl_scene *scene, const char *name, const double (*vertices)[3],
                            int vertex_count, const int (*triangles)[3], int triangle_count,
                            const pl_polyhedron **polyhedron, pl_error *);

/* Volume in m^3 (0 for a plane) and the principal inertia of the solid of uniform density, kg m^2,
 * in its principal axes. */
double pl_shape_volume(const pl_shape *shape);
void pl_shape_inertia(const pl_shape *shape, double mass, double inertia[3]);

/* Each appends a copy and returns its index in *index (NULL allowed). A failure leaves the scene as
 * it was: PL_NO_MEMORY, or PL_BAD_INPUT for a material beyond PL_MAX_MATERIALS. pl_scene_add_body
 * fills an inertia of all zeros of a dynamic body from its shape, and gives what has no meaning
 * (mass and inertia of a static body, pose of a plane) its one value: zero, and the identity for
 * the orientation. */
pl_status pl_scene_add_material(pl_scene *scene, const pl_material *item, int *index, pl_error *);
pl_status pl_scene_add_pair(pl_scene *scene, const pl_material_pair *item, pl_error *);
pl_status pl_scene_add_body(pl_scene *scene, const pl_body *item, int *index, pl_error *);
pl_status pl_scene_add_force(pl_scene *scene, const pl_force *item, pl_error *);
pl_status pl_scene_add_rest(pl_scene *scene, const pl_expect_rest *item, pl_error *);
pl_status pl_scene_add_travel(pl_scene *scene, const pl_expect_travel *item, pl_error *);
pl_status pl_scene_add_value(pl_scene *scene, const pl_expect_value *item, pl_error *);

/* Frees what the scene owns and makes it an empty default scene. */
void pl_scene_free(pl_scene *scene);

/* Friction and restitution of a pair of materials: the override where the scene has one, otherwise
 * the geometric mean of the frictions and the larger restitution (which is each material's own
 * value for a material against itself). */
void pl_scene_pair(const pl_scene *scene, int material_a, int material_b, double *friction,
                   double *restitution);

/* Number of steps of a run: round(duration / dt). */
long pl_scene_steps(const pl_scene *scene);

/* Checks a scene made by code by the same rules as one read from a file (finite numbers, mass > 0,
 * unit normals and quaternions to 1e-9, indices in range, unique names, static planes).
 * PL_BAD_INPUT says which field of which object, and the number. */
pl_status pl_scene_validate(const pl_scene *scene, pl_error *);

/* Reads a scene file ("plumb_scene": 1). `path` "-" is standard input. The error's message is
 * FILE:LINE:COLUMN: path.to.field: what was expected, what was found. Files that it names are
 * looked for beside it, or in the working directory. The caller frees *scene. */
pl_status pl_scene_read_file(const char *path, pl_scene *scene, pl_error *);

/* The same for text in memory, which may name no files; `label` stands for the file's name in
 * messages. */
pl_status pl_scene_read_text(const char *text, size_t length, const char *label, pl_scene *scene,
                             pl_error *);

/* A valid scene as JSON text that pl_scene_read_text reads back to the same scene, number for
 * number; forces come in the order of their bodies, a polyhedron that several share gets a name,
 * and one that has neither a name nor a body is left out. malloc'd; the caller frees. NULL when out
 * of memory. */
char *pl_scene_to_text(const pl_scene *scene);

/* 64-bit FNV-1a of that text as 16 hexadecimal digits and a zero: two scenes with the same hash are
 * the same problem. PL_NO_MEMORY leaves `hash` empty. */
pl_status pl_scene_hash(const pl_scene *scene, char hash[17], pl_error *);

#ifdef __cplusplus
}
#endif
#endif
