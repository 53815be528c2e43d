/* Sizes of shapes and places of planes, by motion alone: a body that comes straight down on a plane
 * moves freely until its surface is there, and does not enter. */
#include "plumb/scene.h"
#include "probe.h"

#include <math.h>
#include <string.h>

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

const pl_check pl_shape_checks[] = {
    {"plane", "a plane is where the scene has it", PL_NEEDS_PLANE | PL_NEEDS_SPHERE, 0, check_plane,
     0},
    {"box-size", "a box has its half extents", TURNING | PL_NEEDS_BOX, 0, check_size, PL_SHAPE_BOX},
    {"capsule-size", "a capsule has its length and radius", TURNING | PL_NEEDS_CAPSULE, 0,
     check_size, PL_SHAPE_CAPSULE},
    {"cylinder-size", "a cylinder has its length and radius", TURNING | PL_NEEDS_CYLINDER, 0,
     check_size, PL_SHAPE_CYLINDER},
    {0}};
