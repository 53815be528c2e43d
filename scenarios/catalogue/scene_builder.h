/* The functions by which scenarios build their scenes. No call needs a check: the first failure is
 * kept, later calls do nothing, and pl_scenario_build reports it. */
#ifndef PLUMB_SCENE_BUILDER_H
#define PLUMB_SCENE_BUILDER_H

#include "base/random.h"
#include "plumb/scenario.h"

#define PL_RADIANS_PER_DEGREE 0.017453292519943295 /* pi / 180 */

/* A scene under construction. */
struct pl_builder {
    pl_scene *scene;  /* has its name, dt, duration, primary error and material 0 */
    double gravity;   /* m/s^2, downwards, > 0: that of a new scene */
    double steps;     /* number of steps of the run */
    double end;       /* s: the time of its last frame */
    pl_random random; /* of the scene's seed */
    pl_status status; /* of the first failure */
    pl_error *error;  /* NULL allowed */
};

/* ---- Materials and bodies ---- */

/* Adds a material and returns its index; 0 after a failure. */
int pl_build_material(pl_builder *builder, const char *name, double friction, double restitution);

/* Sets the friction between two materials, in place of the geometric mean of theirs. */
void pl_build_pair(pl_builder *builder, int material_a, int material_b, double friction);

/* Adds a static plane of this material, with the normal (nx, ny, nz). */
void pl_build_plane(pl_builder *builder, const char *name, int material, double nx, double ny,
                    double nz, double offset);

/* Adds the static plane "floor" z = 0 of material 0. */
void pl_build_floor(pl_builder *builder);

/* Returns a dynamic body of 1 kg at rest, its shape's frame at (x, y, z) along the world's axes. */
pl_body pl_body_at(pl_shape shape, double x, double y, double z);

/* Turns an unturned body by `angle`, 0 to 1.6 rad, about y: its x axis dips, its z axis leans to
 * x. */
void pl_turn_about_y(pl_body *body, double angle);

/* Turns an unturned body by `angle`, 0 to 1.6 rad, about the world's axis number `axis`. */
void pl_turn_about_axis(pl_body *body, int axis, double angle);

/* Adds `body`, named as printf does, and returns its index; -1 after a failure. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int pl_build_body(pl_builder *builder, const pl_body *body, const char *name, ...);

/* Makes a hull of `count` points the scene's and returns its shape; a shape without polyhedron
 * after a failure. */
pl_shape pl_build_hull(pl_builder *builder, const char *name, const double (*points)[3], int count);

/* Adds a constant force. */
void pl_build_force(pl_builder *builder, const pl_force *force);

/* ---- Random numbers ---- */

/* Returns a uniform number from `low` to `high`. */
double pl_draw_uniform(pl_random *random, double low, double high);

/* Fills a uniformly distributed unit quaternion, by rejection from the cube: the same bits on every
 * machine. */
void pl_draw_orientation(pl_random *random, double q[4]);

/* ---- Answers ----
 *
 * Motion under a constant acceleration, with t = n h after n steps of h:
 *   continuous:           x = v t + a t^2 / 2
 *   semi-implicit Euler:  x_n = n h v + a h^2 n (n + 1) / 2, the sum of h v_k, v_k = v + k h a */

/* A right answer. */
typedef struct pl_answer {
    double continuous; /* of the continuous problem */
    double discrete;   /* of semi-implicit Euler at the scene's dt; NAN where there is none */
} pl_answer;

/* The distance from speed v at acceleration a (both signed) over `steps` steps of h. */
pl_answer pl_uniform_distance(double v, double a, double h, double steps);

/* The same where friction takes `braking` > 0 from the speed v >= 0 until nothing is left. A
 * discrete answer of 0 is none. */
pl_answer pl_braking_distance(double v, double braking, double h, double steps);

/* An answer that is one number. */
pl_answer pl_exactly(double value);

/* An answer of the continuous problem alone. */
pl_answer pl_continuous(double value);

/* ---- Expectations ---- */

extern const double pl_axis_x[3], pl_axis_y[3], pl_axis_z[3];

/* Expects a body to end where it starts. A body that ends farther than the scene's
 * collapse_distance from there has collapsed; that is INFINITY unless the scenario sets it. */
void pl_build_rest(pl_builder *builder, int body);

/* Starts a body, whose rest is already expected, `distance` farther along an axis of the world. */
void pl_build_start_off(pl_builder *builder, int body, int axis, double distance);

/* Expects a body to travel along the unit vector `direction`. */
void pl_build_travel(pl_builder *builder, int body, const double direction[3], pl_answer distance);

/* Expects a value; `value` has its body's index. */
void pl_build_value(pl_builder *builder, const pl_expect_value *value);

/* Expects `quantity` of the body along `direction` at the end of the scene. The error is divided by
 * `scale`. */
void pl_build_at_end(pl_builder *builder, int body, pl_quantity quantity, const double direction[3],
                     pl_answer answer, double scale);

/* Expects the body to be displaced by `answer` along the unit vector `direction` at the end, and by
 * nothing across it: a body that drifts to the side is as wrong as one that goes too far. */
void pl_build_displaced(pl_builder *builder, int body, const double direction[3], pl_answer answer,
                        double scale);

/* Expects `quantity` to be 0 along the world's x, y and z at the end, where `axes` has that bit of
 * PL_ALONG_*. */
void pl_build_none(pl_builder *builder, int body, pl_quantity quantity, unsigned axes,
                   double scale);
enum { PL_ALONG_X = 1, PL_ALONG_Y = 2, PL_ALONG_Z = 4, PL_ALONG_ALL = 7 };

/* Returns an expected value at the end of the run, for pl_build_value: `quantity` of the body along
 * `direction` is `value` within `tolerance`, in the quantity's unit. Its scale is such that the
 * tolerance is an error of the scene's acceptance. */
pl_expect_value pl_value_within(const pl_builder *builder, int body, pl_quantity quantity,
                                const double direction[3], double value, double tolerance);

/* Adds that value. */
void pl_build_within(pl_builder *builder, int body, pl_quantity quantity, const double direction[3],
                     double value, double tolerance);

/* Expects `quantity` to be 0 within `tolerance` along each of the world's axes in `axes`, at the end. */
void pl_build_none_within(pl_builder *builder, int body, pl_quantity quantity, unsigned axes,
                          double tolerance);

/* Expects a body to rest where it starts, within 1 % of its `size`, m, and 0.01 rad. */
void pl_build_rest_within(pl_builder *builder, int body, double size);

/* A straight path over a flat surface, without lift and without turning. */
typedef struct pl_straight {
    const double *along; /* unit, world: the direction of the path */
    const double *up;    /* unit, world: the normal of the surface */
    double distance;     /* m, from the start to the place at `until` */
    double until;        /* s */
    double size;         /* m, of the body: what the distances aside and above are measured by */
} pl_straight;

/* Expects a body to follow the path: its distance within 6 % or 1 % of its size, its distance to the
 * side and its largest height over the start within 1 % of its size, its height at `until` within 6 %
 * of its size, its turn within 0.06 rad. */
void pl_build_straight(pl_builder *builder, int body, const pl_straight *path);

/* Expects that a second run in the same process has the same states, bit for bit. */
void pl_build_same_bits(pl_builder *builder);

/* Expects exactly this end value of a statistic. The error is divided by `scale`. */
void pl_build_statistic(pl_builder *builder, pl_statistic metric, double value, double scale);

/* Refuses the values of the parameters: PL_BAD_INPUT, with a message as printf makes it. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_build_refuse(pl_builder *builder, const char *format, ...);

#endif
