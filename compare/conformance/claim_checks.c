/* What an engine claims, it has: shapes that rest on a floor, friction that holds, restitution that
 * bounces, static bodies that stay. The bounds are wide, since contacts may be soft; other checks
 * measure. */
#include "probe.h"

#include <math.h>
#include <string.h>

/* ---- Shapes ---- */

/* A body of the shape is let go a little above the floor and comes to rest on it. */
static void check_rest(pl_probe *p)
{
    const double drop = 0.02, up = sqrt(0.5);
    const pl_shape_kind kind = (pl_shape_kind)p->check->variant;
    pl_probe_scene(p, 1.0 / 100);
    pl_check_add_floor(p);
    const struct {
        pl_shape shape;
        double bottom; /* the height of its lowest point in its own frame as it is turned, m */
        double size;   /* its height, m */
    } rests[PL_SHAPE_KIND_COUNT] = {
        [PL_SHAPE_SPHERE] = {pl_shape_sphere(0.5), -0.5, 1},
        [PL_SHAPE_BOX] = {pl_shape_box(0.5, 0.4, 0.3), -0.3, 0.6},
        [PL_SHAPE_CAPSULE] = {pl_shape_capsule(0.3, 0.5), -0.3, 0.6},
        [PL_SHAPE_CYLINDER] = {pl_shape_cylinder(0.5, 0.3), -0.3, 0.6},
        [PL_SHAPE_HULL] = {.bottom = 0.2, .size = 0.6},
        [PL_SHAPE_MESH] = {.bottom = 0, .size = 0.8},
    };
    const double bottom = rests[kind].bottom, size = rests[kind].size;
    pl_body body = {.shape = rests[kind].shape, .mass = 2, .position = {0, 0, drop - bottom}};
    if (kind == PL_SHAPE_HULL || kind == PL_SHAPE_MESH) {
        body.shape = pl_check_standing_solid(p, kind);
    } else if (kind == PL_SHAPE_CAPSULE) { /* on its side: its axis is the world's y axis */
        body.orientation[0] = body.orientation[1] = up;
    }
    const int index = pl_probe_add_body(p, body);
    pl_probe_run(p, 100);
    const double height = p->now[index].position[2] + bottom;
    const char *cause = "the size of the shape, its margin, or a contact that is too soft";
    if (height < -0.4 * size) {
        cause = "it falls into the floor: this shape is claimed, and its contacts are missing";
    } else if (height > 0.4 * size) {
        cause = "it flies off: gravity points up, or contacts push too far";
    }
    pl_probe_expect(p, "the lowest point of a body at rest on a floor at z = 0, after 1 s, m",
                    height, 0, 0.05 * size, cause);
}

/* ---- Contacts ---- */

/* Friction far above the slope's, whose floor is level and whose gravity is inclined: a box stays,
 * and a sphere rolls, 5/7 as fast as it would slide. */
static void check_friction(pl_probe *p)
{
    const double slope = 0.1745;
    pl_probe_scene(p, 1.0 / 100);
    p->scene.materials[0].friction = 0.9;
    p->scene.gravity[0] = 9.81 * sin(slope);
    p->scene.gravity[2] = -9.81 * cos(slope);
    pl_check_add_floor(p);
    const bool is_box = pl_check_claims(p, PL_NEEDS_BOX);
    pl_body body = is_box ? (pl_body){.shape = pl_shape_box(0.5, 0.5, 0.5)} : pl_check_any_body(p);
    body.position[2] = 0.5;
    const int index = pl_probe_add_body(p, body);
    pl_probe_run(p, 50);
    const double free = p->scene.gravity[0] * 0.5, most = (is_box ? 0.2 : 0.85) * free;
    const double speed = p->now[index].velocity[0];
    pl_probe_require(
        p, fabs(speed) < most,
        pl_probe_text(
            p, "friction 0.9 holds a %s on a slope of 10 degrees: below %.3g m/s after 0.5 s",
            is_box ? "box" : "body that may roll", most),
        pl_probe_text(p, "%.4g m/s; a free body has %.4g m/s", speed, free),
        "friction is claimed, and contacts have none or far too little");
}

static void check_restitution(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    p->scene.materials[0].restitution = 0.8;
    pl_check_add_floor(p);
    pl_body body = pl_check_any_body(p);
    body.position[2] = 0.9;
    body.velocity[2] = -3;
    const int index = pl_probe_add_body(p, body);
    pl_probe_create(p);
    double impact = 0, rebound = 0;
    for (int i = 0; i < 40 && !p->over; ++i) {
        pl_probe_steps(p, 1);
        impact = fmax(impact, -p->now[index].velocity[2]);
        rebound = fmax(rebound, p->now[index].velocity[2]);
    }
    pl_probe_require(
        p, rebound > 0.4 * impact &&
                   rebound<1.2 * impact,
                           "restitution 0.8 throws a body back at about 0.8 of its speed",
                           pl_probe_text(p, "it arrives at %.4g m/s and leaves at %.4g m/s", impact,
                                         rebound),
                           rebound> 0
               ? "the coefficient of restitution"
               : "restitution is claimed, and bodies do not bounce");
}

/* A heavy sphere falls on a static one. */
static void check_static_hit(pl_probe *p)
{
    const pl_vec zero = {0, 0, 0};
    pl_probe_scene(p, 1.0 / 100);
    const pl_body rock_body = {.is_static = true, .shape = pl_shape_sphere(PL_BALL_RADIUS)};
    const int rock = pl_probe_add_body(p, rock_body);
    const int heavy = pl_probe_add_ball(p, 1000, (pl_vec){0, 0, 1.2}, zero);
    pl_probe_create(p);
    for (int i = 0; i < 60 && !p->over; ++i) {
        pl_probe_steps(p, 1);
        pl_probe_expect_vector(p, "the position of a static body that is hit, m",
                               pl_vec_of(p->now[rock].position), pl_vec_of(p->start[rock].position),
                               0, "the engine has given it a mass: is_static bodies never move");
        pl_probe_expect_vector(p, "the velocity of a static body that is hit, m/s",
                               pl_vec_of(p->now[rock].velocity), zero, 0,
                               "the engine has given it a mass: is_static bodies never move");
    }
    pl_probe_expect(p, "the height of a sphere at rest on a static sphere, m",
                    p->now[heavy].position[2], 1, 0.05,
                    "dynamic bodies do not touch static ones, or contacts are too soft");
}

/* ---- Sizes of shapes and places of planes ----
 *
 * By motion alone: a body that comes straight down on a plane moves freely until its surface is there, and
 * does not enter. */

static const double DT = 1.0 / 100;  /* s */
static const double SPEED = 2;       /* m/s */
static const double GAP = 0.1;       /* m, at the start */
enum { FREE_STEPS = 4, STEPS = 30 }; /* the gap lasts for five steps */

/* A body comes down on a plane, face on; `reach` is the distance from its centre to the surface that touches,
 * m. */
static void expect_approach(pl_probe *p, const char *what, pl_body body, double reach,
                            const pl_shape *plane, const char *cause)
{
    const pl_vec normal = pl_vec_of(plane->normal);
    pl_probe_floating(p, DT)->materials[0].friction = 0;
    pl_vec_store(pl_vec_scale(normal, plane->offset + reach + GAP), body.position);
    pl_vec_store(pl_vec_scale(normal, -SPEED), body.velocity);
    pl_probe_add_body(p, (pl_body){.is_static = true, .shape = *plane});
    pl_probe_add_body(p, body);
    pl_probe_create(p);
    for (int n = 1; n <= STEPS && !p->over; ++n) {
        pl_probe_steps(p, 1);
        const double gap =
            pl_vec_dot(normal, pl_vec_of(p->now[1].position)) - plane->offset - reach;
        const double speed = -pl_vec_dot(normal, pl_vec_of(p->now[1].velocity));
        const double way = SPEED * DT * n;
        const bool is_free = fabs(speed - SPEED) < 0.01 && fabs(gap - GAP + way) < 0.01;
        pl_probe_require(
            p, (n > FREE_STEPS || is_free) && gap > -0.02 - 0.05 * reach,
            pl_probe_text(p,
                          "%s, %g m above a plane and coming at %g m/s, moves freely for %g s and "
                          "does not enter the plane by more than a part of its size",
                          what, GAP, SPEED, FREE_STEPS * DT),
            pl_probe_text(p, "after %g s it is %.3g m above the plane and comes at %.3g m/s",
                          n * DT, gap, speed),
            cause);
    }
}

static void check_plane(pl_probe *p)
{
    const pl_shape plane = pl_shape_plane(0.6, 0, 0.8, 0.75);
    expect_approach(p, "a sphere", (pl_body){.shape = pl_shape_sphere(0.5)}, 0.5, &plane,
                    "the plane's normal or its offset: the solid is {x : n.x <= offset}; or the "
                    "sphere's radius");
}

/* Each axis of the shape stands upright in turn; of a capsule and a cylinder the first is as the second. */
static void check_size(pl_probe *p)
{
    const pl_shape_kind kind = (pl_shape_kind)p->check->variant;
    const pl_shape plane = pl_shape_plane(0, 0, 1, 0);
    const double half = sqrt(0.5);
    const struct {
        const char *what;
        double orientation[4]; /* which brings the axis upright */
    } axes[] = {{"the body with its x axis upright", {half, 0, -half, 0}},
                {"the body with its y axis upright", {half, half, 0, 0}},
                {"the body with its z axis upright", {1, 0, 0, 0}}};
    const struct {
        pl_shape shape;
        double reach[3]; /* along each axis, m */
        const char *cause;
    } sizes[PL_SHAPE_KIND_COUNT] = {
        [PL_SHAPE_BOX] = {pl_shape_box(0.3, 0.5, 0.8),
                          {0.3, 0.5, 0.8},
                          "pl_shape.half_extents are half the edges, along x, y and z"},
        [PL_SHAPE_CAPSULE] = {pl_shape_capsule(0.3, 0.5),
                              {0.3, 0.3, 0.8},
                              "a capsule's axis is z, and its half_height is without its round "
                              "ends"},
        [PL_SHAPE_CYLINDER] = {pl_shape_cylinder(0.3, 0.5),
                               {0.3, 0.3, 0.5},
                               "a cylinder's axis is z, and its half_height is half its length"}};
    for (int axis = kind == PL_SHAPE_BOX ? 0 : 1; axis < 3 && !p->over; ++axis) {
        pl_body body = {.shape = sizes[kind].shape};
        memcpy(body.orientation, axes[axis].orientation, sizeof body.orientation);
        expect_approach(p, axes[axis].what, body, sizes[kind].reach[axis], &plane,
                        sizes[kind].cause);
    }
}

enum { TURNING = PL_NEEDS_PLANE | PL_NEEDS_ROTATION };

const pl_check pl_claim_checks[] = {
    {"sphere-rests", "a sphere rests on a floor", PL_NEEDS_SPHERE, 0, check_rest, PL_SHAPE_SPHERE},
    {"box-rests", "a box rests on a floor", PL_NEEDS_BOX | PL_NEEDS_ROTATION, 0, check_rest,
     PL_SHAPE_BOX},
    {"capsule-rests", "a capsule rests on a floor", PL_NEEDS_CAPSULE | PL_NEEDS_ROTATION, 0,
     check_rest, PL_SHAPE_CAPSULE},
    {"cylinder-rests", "a cylinder rests on a floor", PL_NEEDS_CYLINDER | PL_NEEDS_ROTATION, 0,
     check_rest, PL_SHAPE_CYLINDER},
    {"hull-rests", "a hull rests on a floor", PL_NEEDS_HULL | PL_NEEDS_ROTATION, 0, check_rest,
     PL_SHAPE_HULL},
    {"mesh-rests", "a mesh rests on a floor", PL_NEEDS_MESH | PL_NEEDS_ROTATION, 0, check_rest,
     PL_SHAPE_MESH},
    {"friction-holds", "friction is there", PL_NEEDS_FRICTION | PL_NEEDS_ROTATION, 0,
     check_friction, 0},
    {"restitution-bounces", "restitution is there", PL_NEEDS_RESTITUTION, 0, check_restitution, 0},
    {"static-bodies-stay", "static bodies do not move when they are hit", PL_NEEDS_SPHERE, 0,
     check_static_hit, 0},
    {"plane", "a plane is where the scene has it", PL_NEEDS_PLANE | PL_NEEDS_SPHERE, 0, check_plane,
     0},
    {"box-size", "a box has its half extents", TURNING | PL_NEEDS_BOX, 0, check_size, PL_SHAPE_BOX},
    {"capsule-size", "a capsule has its length and radius", TURNING | PL_NEEDS_CAPSULE, 0,
     check_size, PL_SHAPE_CAPSULE},
    {"cylinder-size", "a cylinder has its length and radius", TURNING | PL_NEEDS_CYLINDER, 0,
     check_size, PL_SHAPE_CYLINDER},
    {0}};
