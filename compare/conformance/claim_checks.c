/* What an engine claims, it has: shapes that rest on a floor, friction that holds, restitution that
 * bounces, static bodies that stay. The bounds are wide, since contacts may be soft; other checks
 * measure. */
#include "check_bodies.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Shapes ---- */

/* A body of this shape is let go a little above the floor and comes to rest on it. `bottom` is the
 * height of its lowest point in its own frame as it is turned, m; `size` its height. */
static void expect_rest(pl_probe *p, pl_body body, double bottom, double size)
{
    const double drop = 0.02;
    body.position[2] = drop - bottom;
    const int index = pl_probe_add_body(p, body);
    if (!pl_probe_run(p, 100)) {
        return;
    }
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

/* Begins a scene with a floor, and a body to stand on it. */
static pl_body begin_on_floor(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    pl_check_add_floor(p);
    pl_body body = pl_body_default();
    body.mass = 2;
    return body;
}

static void check_sphere(pl_probe *p)
{
    pl_body body = begin_on_floor(p);
    body.shape = pl_shape_sphere(0.5);
    expect_rest(p, body, -0.5, 1);
}

static void check_box(pl_probe *p)
{
    pl_body body = begin_on_floor(p);
    body.shape = pl_shape_box(0.5, 0.4, 0.3);
    expect_rest(p, body, -0.3, 0.6);
}

/* It lies on its side: its axis is the world's y axis. */
static void check_capsule(pl_probe *p)
{
    pl_body body = begin_on_floor(p);
    body.shape = pl_shape_capsule(0.3, 0.5);
    memcpy(body.orientation, (double[]){sqrt(0.5), sqrt(0.5), 0, 0}, sizeof body.orientation);
    expect_rest(p, body, -0.3, 0.6);
}

static void check_cylinder(pl_probe *p)
{
    pl_body body = begin_on_floor(p);
    body.shape = pl_shape_cylinder(0.5, 0.3);
    expect_rest(p, body, -0.3, 0.6);
}

static void check_hull(pl_probe *p)
{
    pl_body body = begin_on_floor(p);
    body.shape = pl_check_box_hull(p);
    expect_rest(p, body, 0.2, 0.6);
}

static void check_mesh(pl_probe *p)
{
    pl_body body = begin_on_floor(p);
    body.shape = pl_check_table_mesh(p);
    expect_rest(p, body, 0, 0.8);
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
    if (pl_check_add_floor(p) < 0) {
        return;
    }
    const bool is_box = pl_check_claims(p, PL_NEEDS_BOX);
    pl_body body = is_box ? pl_body_default() : pl_check_any_body(p);
    body.shape = is_box ? pl_shape_box(0.5, 0.5, 0.5) : body.shape;
    body.position[2] = 0.5;
    const int index = pl_probe_add_body(p, body);
    pl_probe_create(p);
    pl_probe_steps(p, 50);
    const double free = p->scene.gravity[0] * 0.5;
    const double speed = p->now[index].velocity[0];
    char expected[PL_CHECK_TEXT_SIZE], found[PL_CHECK_TEXT_SIZE];
    snprintf(expected, sizeof expected,
             "friction 0.9 holds a %s on a slope of 10 degrees: below %.3g m/s after 0.5 s",
             is_box ? "box" : "body that may roll", (is_box ? 0.2 : 0.85) * free);
    snprintf(found, sizeof found, "%.4g m/s; a free body has %.4g m/s", speed, free);
    pl_probe_require(p, fabs(speed) < (is_box ? 0.2 : 0.85) * free, expected, found,
                     "friction is claimed, and contacts have none or far too little");
}

static void check_restitution(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    p->scene.materials[0].restitution = 0.8;
    if (pl_check_add_floor(p) < 0) {
        return;
    }
    pl_body body = pl_check_any_body(p);
    body.position[2] = 0.9;
    body.velocity[2] = -3;
    const int index = pl_probe_add_body(p, body);
    pl_probe_create(p);
    double impact = 0, rebound = 0;
    for (int i = 0; i < 40 && !p->over; ++i) {
        pl_probe_steps(p, 1);
        impact = fmin(impact, p->now[index].velocity[2]);
        rebound = fmax(rebound, p->now[index].velocity[2]);
    }
    char found[PL_CHECK_TEXT_SIZE];
    snprintf(found, sizeof found, "it arrives at %.4g m/s and leaves at %.4g m/s", -impact,
             rebound);
    pl_probe_require(p,
                     rebound > 0.4 * -impact &&
                             rebound<1.2 * -impact,
                                     "restitution 0.8 throws a body back at about 0.8 of its speed",
                                     found, rebound> 0
                         ? "the coefficient of restitution"
                         : "restitution is claimed, and bodies do not bounce");
}

/* A heavy sphere falls on a static one. */
static void check_static_hit(pl_probe *p)
{
    static const double zero[3] = {0, 0, 0};
    pl_probe_scene(p, 1.0 / 100);
    pl_body rock = pl_body_default();
    rock.is_static = true;
    rock.shape = pl_shape_sphere(0.5);
    const int rock_index = pl_probe_add_body(p, rock);
    const int heavy = pl_probe_add_sphere(p, 0.5, 1000, (double[]){0, 0, 1.2});
    pl_probe_create(p);
    for (int i = 0; i < 60 && !p->over; ++i) {
        pl_probe_steps(p, 1);
        pl_probe_expect_vector(p, "the position of a static body that is hit, m",
                               p->now[rock_index].position, p->start[rock_index].position, 0,
                               "the engine has given it a mass: is_static bodies never move");
        pl_probe_expect_vector(p, "the velocity of a static body that is hit, m/s",
                               p->now[rock_index].velocity, zero, 0,
                               "the engine has given it a mass: is_static bodies never move");
    }
    pl_probe_expect(p, "the height of a sphere at rest on a static sphere, m",
                    p->now[heavy].position[2], 1, 0.05,
                    "dynamic bodies do not touch static ones, or contacts are too soft");
}

const pl_check pl_claim_checks[] = {
    {"sphere-rests", "a sphere rests on a floor", PL_NEEDS_SPHERE, 0, check_sphere},
    {"box-rests", "a box rests on a floor", PL_NEEDS_BOX | PL_NEEDS_ROTATION, 0, check_box},
    {"capsule-rests", "a capsule rests on a floor", PL_NEEDS_CAPSULE | PL_NEEDS_ROTATION, 0,
     check_capsule},
    {"cylinder-rests", "a cylinder rests on a floor", PL_NEEDS_CYLINDER | PL_NEEDS_ROTATION, 0,
     check_cylinder},
    {"hull-rests", "a hull rests on a floor", PL_NEEDS_HULL | PL_NEEDS_ROTATION, 0, check_hull},
    {"mesh-rests", "a mesh rests on a floor", PL_NEEDS_MESH | PL_NEEDS_ROTATION, 0, check_mesh},
    {"friction-holds", "friction is there", PL_NEEDS_FRICTION | PL_NEEDS_ROTATION, 0,
     check_friction},
    {"restitution-bounces", "restitution is there", PL_NEEDS_RESTITUTION, 0, check_restitution},
    {"static-bodies-stay", "static bodies do not move when they are hit", PL_NEEDS_SPHERE, 0,
     check_static_hit},
    {0}};
