/* Sizes of shapes and places of planes, by motion alone: a body that comes straight down on a plane
 * moves freely until its surface is there, and does not enter. */
#include "plumb/scene.h"
#include "probe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double DT = 1.0 / 100;  /* s */
static const double SPEED = 2;       /* m/s */
static const double GAP = 0.1;       /* m, at the start */
enum { FREE_STEPS = 4, STEPS = 30 }; /* the gap lasts for five steps */

/* A body that comes down on a plane, face on. */
typedef struct approach {
    const char *what;
    pl_shape shape;
    double orientation[4];
    double reach;     /* m, from the centre to the surface that touches */
    double normal[3]; /* of the plane */
    double offset;    /* m, of the plane along its normal */
} approach;

static void expect_approach(pl_probe *p, const approach *a, const char *cause)
{
    pl_body plane = pl_body_default(), body = pl_body_default();
    pl_scene *scene = pl_probe_scene(p, DT);
    scene->materials[0].friction = 0;
    memset(scene->gravity, 0, sizeof scene->gravity);
    plane.is_static = true;
    plane.shape = pl_shape_plane(a->normal[0], a->normal[1], a->normal[2], a->offset);
    body.shape = a->shape;
    memcpy(body.orientation, a->orientation, sizeof body.orientation);
    for (int k = 0; k < 3; ++k) {
        body.position[k] = (a->offset + a->reach + GAP) * a->normal[k];
        body.velocity[k] = -SPEED * a->normal[k];
    }
    pl_probe_add_body(p, plane);
    pl_probe_add_body(p, body);
    pl_probe_create(p);
    for (int n = 1; n <= STEPS && !p->over; ++n) {
        pl_probe_steps(p, 1);
        double gap = -a->offset - a->reach, speed = 0;
        for (int k = 0; k < 3; ++k) {
            gap += a->normal[k] * p->now[1].position[k];
            speed -= a->normal[k] * p->now[1].velocity[k];
        }
        char expected[PL_CHECK_TEXT_SIZE], found[PL_CHECK_TEXT_SIZE];
        snprintf(expected, sizeof expected,
                 "%s, %g m above a plane and coming at %g m/s, moves freely for %g s and does not "
                 "enter the plane by more than a part of its size",
                 a->what, GAP, SPEED, FREE_STEPS * DT);
        snprintf(found, sizeof found,
                 "after %g s it is %.3g m above the plane and comes at %.3g m/s", n * DT, gap,
                 speed);
        const double way = SPEED * DT * n;
        const bool is_free = fabs(speed - SPEED) < 0.01 && fabs(gap - GAP + way) < 0.01;
        pl_probe_require(p, (n > FREE_STEPS || is_free) && gap > -0.02 - 0.05 * a->reach, expected,
                         found, cause);
    }
}

static void check_plane(pl_probe *p)
{
    expect_approach(p,
                    &(approach){.what = "a sphere",
                                .shape = pl_shape_sphere(0.5),
                                .orientation = {1, 0, 0, 0},
                                .reach = 0.5,
                                .normal = {0.6, 0, 0.8},
                                .offset = 0.75},
                    "the plane's normal or its offset: the solid is {x : n.x <= offset}; or the "
                    "sphere's radius");
}

/* Turns that bring the x, the y and the z axis of a shape upright. */
static const double TURNS[3][4] = {{0.70710678118654752, 0, -0.70710678118654752, 0},
                                   {0.70710678118654752, 0.70710678118654752, 0, 0},
                                   {1, 0, 0, 0}};

/* The axes from `first` on, with how far the shape reaches along each of them. */
static void check_size(pl_probe *p, pl_shape shape, int first, const double reach[3],
                       const char *cause)
{
    static const char *const what[] = {"the body with its x axis upright",
                                       "the body with its y axis upright",
                                       "the body with its z axis upright"};
    for (int axis = first; axis < 3 && !p->over; ++axis) {
        approach a = {
            .what = what[axis], .shape = shape, .reach = reach[axis], .normal = {0, 0, 1}};
        memcpy(a.orientation, TURNS[axis], sizeof a.orientation);
        expect_approach(p, &a, cause);
    }
}

static void check_box(pl_probe *p)
{
    check_size(p, pl_shape_box(0.3, 0.5, 0.8), 0, (double[]){0.3, 0.5, 0.8},
               "pl_shape.half_extents are half the edges, along x, y and z");
}

static void check_capsule(pl_probe *p)
{
    check_size(p, pl_shape_capsule(0.3, 0.5), 1, (double[]){0.3, 0.3, 0.8},
               "a capsule's axis is z, and its half_height is without its round ends");
}

static void check_cylinder(pl_probe *p)
{
    check_size(p, pl_shape_cylinder(0.3, 0.5), 1, (double[]){0.3, 0.3, 0.5},
               "a cylinder's axis is z, and its half_height is half its length");
}

enum { TURNING = PL_NEEDS_PLANE | PL_NEEDS_ROTATION };

const pl_check pl_shape_checks[] = {
    {"plane", "a plane is where the scene has it", PL_NEEDS_PLANE | PL_NEEDS_SPHERE, 0,
     check_plane},
    {"box-size", "a box has its half extents", TURNING | PL_NEEDS_BOX, 0, check_box},
    {"capsule-size", "a capsule has its length and radius", TURNING | PL_NEEDS_CAPSULE, 0,
     check_capsule},
    {"cylinder-size", "a cylinder has its length and radius", TURNING | PL_NEEDS_CYLINDER, 0,
     check_cylinder},
    {0}};
