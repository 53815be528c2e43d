/* The data of a scene: the bodies at t = 0, and the expected results. It is plain data, which
 * adapters and loadable engines read directly; plumb/scene.h has the functions that make it.
 *
 * SI units, right-handed, z up by custom (gravity says). Quaternions are (w, x, y, z), unit, body
 * to world. `velocity` is that of the centre of mass; `velocity` and `angular_velocity` are in the
 * world frame. `position` and `orientation` place the shape's own frame: for a hull or a mesh that
 * of its vertices, for the others also that of the centre of mass and of the principal axes.
 *
 * The scene owns its arrays. Objects refer to each other by index, except shapes, which point to the scene's
 * polyhedra. */
#ifndef PLUMB_SCENE_DATA_H
#define PLUMB_SCENE_DATA_H

#include "plumb/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Limits of a scene. */
enum {
    PL_MAX_MATERIALS = 256,          /* materials */
    PL_MAX_BODIES = 200000,          /* bodies */
    PL_MAX_STEPS = 10000000,         /* steps of a run */
    PL_MAX_SCENE_BYTES = 64 << 20,   /* bytes of a scene file, and of its .obj files together */
    PL_MAX_SCENE_TRIANGLES = 1 << 21 /* triangles of its hulls and meshes together */
};

/* The kinds of shapes. */
typedef enum pl_shape_kind {
    PL_SHAPE_PLANE,    /* a half-space: the solid on one side of a plane */
    PL_SHAPE_SPHERE,   /* about the origin */
    PL_SHAPE_BOX,      /* about the origin, along the axes */
    PL_SHAPE_CAPSULE,  /* around the segment from -half_height to half_height on its z axis */
    PL_SHAPE_CYLINDER, /* about its z axis, capped at -half_height and half_height */
    PL_SHAPE_HULL,     /* the convex hull of its points */
    PL_SHAPE_MESH      /* the solid within closed surfaces of triangles */
} pl_shape_kind;

/* The number of kinds of shapes. */
enum { PL_SHAPE_KIND_COUNT = 7 };

/* The solid of a hull or a mesh, in the shape's own frame. */
typedef struct pl_polyhedron {
    char name[PL_NAME_SIZE]; /* its key in the scene file's "shapes"; empty: it has none */
    bool convex;             /* a hull */
    int vertex_count;        /* number of vertices */
    int triangle_count;      /* number of triangles */
    double (*vertices)[3]; /* (vertex_count), m; of a hull, those of its points that are corners */
    int (*triangles)[3];   /* (triangle_count), counter-clockwise seen from outside */
    double volume;         /* m^3 */
    double centre[3];      /* of mass, m */
    double axes[4];        /* unit quaternion: principal axes to the shape's frame */
    double inertia[3];     /* principal, of 1 kg, about the centre, m^2 */
    double radius;         /* of the smallest sphere about the centre that holds all vertices, m */
} pl_polyhedron;

/* A shape in its own frame. Only the fields of its kind have a meaning. */
typedef struct pl_shape {
    pl_shape_kind kind; /* which fields have a meaning */
    double normal[3];   /* plane: unit, points out of the solid half-space {x : n.x <= offset} */
    double offset;      /* plane: m, along the normal */
    double radius;      /* sphere, capsule, cylinder: m */
    double half_height; /* capsule, cylinder: m */
    double half_extents[3];          /* box: m */
    const pl_polyhedron *polyhedron; /* hull, mesh: one of the scene's */
} pl_shape;

/* A material. Two different materials are mixed by pl_scene_pair. */
typedef struct pl_material {
    char name[PL_NAME_SIZE]; /* unique in the scene */
    double friction;         /* Coulomb coefficient against itself, >= 0 */
    double restitution;      /* Newton coefficient against itself, 0 .. 1 */
} pl_material;

/* Overrides the mixing rule for one unordered pair of materials. */
typedef struct pl_material_pair {
    int material_a;     /* index */
    int material_b;     /* index; may be the same */
    double friction;    /* Coulomb coefficient, >= 0 */
    double restitution; /* Newton coefficient, 0 .. 1 */
} pl_material_pair;

/* A rigid body at t = 0. */
typedef struct pl_body {
    char name[PL_NAME_SIZE]; /* unique in the scene */
    bool is_static;          /* never moves; mass and inertia have no meaning */
    int material;            /* index */
    pl_shape shape;          /* a plane is always static and ignores position and orientation */
    double mass;             /* kg, > 0 for a dynamic body */
    double inertia[3];     /* kg m^2, principal, about the centre of mass, in its principal axes */
    double position[3];    /* of the shape's frame, m */
    double orientation[4]; /* unit quaternion (w, x, y, z), shape's frame to world */
    double velocity[3];    /* of the centre of mass, world, m/s */
    double angular_velocity[3]; /* world, rad/s */
} pl_body;

/* The axes in which a force is given. */
typedef enum pl_force_frame {
    PL_FRAME_WORLD, /* the world's axes */
    PL_FRAME_BODY   /* the axes of the shape's frame, which turn with the body */
} pl_force_frame;

/* A constant force on a body at a point, over from <= t < until; t is the time at the start of a
 * step. In the world frame, `force` is in world axes and `at` is an offset from the centre of mass
 * in world axes; in the body frame both are in the axes of the shape's frame and turn with it. */
typedef struct pl_force {
    int body;             /* index */
    double force[3];      /* N */
    double at[3];         /* m, from the centre of mass */
    pl_force_frame frame; /* axes of `force` and `at` */
    double from;          /* s: the force acts from this time */
    double until;         /* s: up to this time, exclusive; may be INFINITY */
} pl_force;

/* The final pose that a right engine reaches. */
typedef struct pl_expect_rest {
    int body;                     /* index */
    double position[3];           /* of the shape's frame, m */
    double orientation[4];        /* unit quaternion (w, x, y, z) */
    bool has_orientation;         /* else the orientation is not judged */
    double tolerance;             /* m, of the distance; 0: the scene's acceptance */
    double orientation_tolerance; /* rad; 0: the scene's acceptance */
} pl_expect_rest;

/* The distance that a body moves along one line by the end of the run. */
typedef struct pl_expect_travel {
    int body;            /* index */
    double direction[3]; /* unit, world */
    double distance;     /* m, of the continuous problem */
    double discrete; /* m, the exact answer of semi-implicit Euler at the scene's dt; NAN if none */
    double tolerance; /* m; 0: the scene's acceptance, as a fraction of the distance */
} pl_expect_travel;

/* A number that is read from the path of one body. */
typedef enum pl_quantity {
    PL_QUANTITY_POSITION, /* m: displacement of its frame along the direction, at `until` */
    PL_QUANTITY_VELOCITY, /* m/s: of its centre of mass along the direction, at `until` */
    PL_QUANTITY_SPIN,     /* rad/s: of its angular velocity along the direction, at `until` */
    PL_QUANTITY_TURN,   /* rad: the sum over steps of the parts of their turns along the direction,
                          until `until`: also over whole turns */
    PL_QUANTITY_APEX,   /* m: the highest position along the direction, from its start, in
                          from .. until */
    PL_QUANTITY_PERIOD, /* s: of the angular velocity along the direction, which turns with the
                           body: the mean time between its changes from - to + in from .. until */
    PL_QUANTITY_TOP_SPEED, /* m/s: the largest speed of its centre of mass in from .. until */
    PL_QUANTITY_EXCURSION, /* m: the largest distance of its frame from its start in from .. until */
    PL_QUANTITY_ENERGY     /* J: kinetic, and potential against that of the start, at `until` */
} pl_quantity;

/* The number of quantities. */
enum { PL_QUANTITY_COUNT = 9 };

/* How a number that is found has to compare with the one that is expected. */
typedef enum pl_bound {
    PL_BOUND_EQUAL,   /* equal */
    PL_BOUND_AT_MOST, /* at most that */
    PL_BOUND_AT_LEAST /* at least that */
} pl_bound;

/* A number that a right engine reaches. Between frames it is interpolated linearly; an apex is that
 * of the parabola through the highest frame and its neighbours. */
typedef struct pl_expect_value {
    int body;             /* index */
    pl_quantity quantity; /* what is read */
    double direction[3];  /* unit, world; of a period in the axes of the shape's frame */
    double from;          /* s: the beginning of the interval of an apex or a period */
    double until;         /* s: when the quantity is read, or the end of that interval */
    double value;         /* of the continuous problem */
    double discrete;  /* the exact answer of semi-implicit Euler at the scene's dt; NAN if none */
    double scale;     /* > 0, in the quantity's unit: what the error is divided by */
    pl_bound bound;   /* how the number that is found has to compare with `value` */
    double number;    /* of an apex: which one in from .. until, counted from 1; 0: the highest */
    double tolerance; /* in the quantity's unit; 0: the scene's acceptance, times the scale */
    double answer; /* of a scene with several right answers, the number from 1 of the one that the
                        value belongs to; 0: it belongs to all */
} pl_expect_value;

/* The largest number of right answers of a scene. */
enum { PL_MAX_ANSWERS = 8 };

/* A number of the state at the end of a run, by the name of the metric. */
typedef enum pl_statistic {
    PL_STATISTIC_MASS_HEIGHT, /* m */
    PL_STATISTIC_RUN_OUT_P95, /* m */
    PL_STATISTIC_SPREAD_X,    /* m */
    PL_STATISTIC_SPREAD_Y,    /* m */
    PL_STATISTIC_ENERGY_LOST  /* J */
} pl_statistic;

/* The number of statistics. */
enum { PL_STATISTIC_COUNT = 5 };

/* The interval in which the statistic of a right engine lies in nine of ten runs from almost the same
 * start, or more. */
typedef struct pl_expect_statistic {
    pl_statistic metric; /* what is read at the end of the run */
    double low;          /* in the metric's unit */
    double high;         /* >= low */
    double scale;        /* > 0: what the distance from the interval is divided by */
    double tolerance;    /* in the metric's unit; 0: the scene's acceptance, times the scale */
} pl_expect_statistic;

/* A scene. Begins as pl_scene_default and is freed by pl_scene_free. */
typedef struct pl_scene {
    char name[PL_NAME_SIZE]; /* for reports; empty: none */
    double gravity[3];       /* m/s^2 */
    double dt;               /* s, > 0 */
    double duration;         /* s, >= dt; steps = round(duration / dt) */

    pl_material *materials;    /* (material_count) */
    int material_count;        /* number of materials */
    pl_material_pair *pairs;   /* (pair_count): exceptions from the mixing rule */
    int pair_count;            /* number of pairs */
    pl_polyhedron **polyhedra; /* (polyhedron_count); the address of each never changes */
    int polyhedron_count;      /* number of polyhedra */
    pl_body *bodies;           /* (body_count) */
    int body_count;            /* number of bodies */
    pl_force *forces;          /* (force_count) */
    int force_count;           /* number of forces */

    pl_expect_rest *rests;     /* (rest_count): expected final poses */
    int rest_count;            /* number of rests */
    pl_expect_travel *travels; /* (travel_count): expected distances */
    int travel_count;          /* number of travels */
    pl_expect_value *values;   /* (value_count): other expected numbers */
    int value_count;           /* number of values */
    /* The metric that is the scene's primary error (metrics' names: "rest_position_error", "drift",
     * "value_error", "chaotic_error"); empty when the scene has no reference. */
    char primary_error[PL_NAME_SIZE];
    /* A body of `rests` that ends farther than this from its reference has the outcome `collapsed`.
     * m; INFINITY when nothing is expected to stand. */
    double collapse_distance;
    /* The largest primary error of an accurate run, in the unit of the metric; INFINITY: none is
     * stated. */
    double acceptance;
    pl_expect_statistic *statistics; /* (statistic_count): of chaotic motion */
    int statistic_count;             /* number of statistics */
    bool
        same_bits; /* a second run in the same process has the same state at every step, bit for bit */
} pl_scene;

/* The features of an engine that a scenario needs, as bits. For an engine without one of them the
 * outcome is `unsupported`. */
enum {
    PL_NEEDS_FRICTION = 1u << 0,    /* friction in some contact */
    PL_NEEDS_RESTITUTION = 1u << 1, /* restitution in some contact */
    PL_NEEDS_ROTATION = 1u << 2,    /* a body that turns */
    PL_NEEDS_FORCES = 1u << 3,      /* applied forces */
    PL_NEEDS_PLANE = 1u << 8,       /* shapes: 1 << (8 + pl_shape_kind) */
    PL_NEEDS_SPHERE = 1u << 9,
    PL_NEEDS_BOX = 1u << 10,
    PL_NEEDS_CAPSULE = 1u << 11,
    PL_NEEDS_CYLINDER = 1u << 12,
    PL_NEEDS_HULL = 1u << 13,
    PL_NEEDS_MESH = 1u << 14
};

#endif
