#include "probe.h"

#include "referee/geometry/solid.h"

#include <string.h>

bool pl_check_claims(const pl_probe *probe, uint32_t needs)
{
    return (needs & ~probe->choice->engine->capabilities) == 0;
}

pl_body pl_check_any_body(pl_probe *probe)
{
    const pl_shape shapes[] = {
        pl_shape_sphere(0.5),
        pl_shape_box(0.3, 0.5, 0.8),
        pl_shape_capsule(0.3, 0.5),
        pl_shape_cylinder(0.5, 0.4),
    };
    size_t i = 0;
    while (i < sizeof shapes / sizeof *shapes &&
           !pl_check_claims(probe, (uint32_t)PL_NEEDS_PLANE << shapes[i].kind)) {
        ++i;
    }
    if (i == sizeof shapes / sizeof *shapes) {
        pl_probe_skip(probe, "the engine claims no sphere, box, capsule or cylinder");
        i = 0;
    }
    return (pl_body){.shape = shapes[i], .mass = 2, .orientation = {1, 0, 0, 0}};
}

pl_body pl_check_turned_body(pl_probe *probe)
{
    const pl_shape box = pl_shape_box(0.3, 0.5, 0.8);
    const bool has_boxes = pl_check_claims(probe, PL_NEEDS_BOX);
    return (pl_body){.shape = has_boxes ? box : pl_check_any_body(probe).shape,
                     .mass = 2,
                     .orientation = {0.2, 0.4, -0.4, 0.8}};
}

/* The shape of a solid that was made; of one that was not, which fails the check, some other. */
static pl_shape made_shape(pl_probe *probe, pl_status status, const pl_polyhedron *made,
                           const pl_error *error)
{
    return pl_probe_expect_made(probe, status, error) ? pl_shape_of(made) : pl_shape_sphere(1);
}

static pl_shape hull_of(pl_probe *probe, const double (*points)[3], int count)
{
    pl_error error = {.message = ""};
    const pl_polyhedron *made = NULL;
    const pl_status status = pl_scene_add_hull(&probe->scene, NULL, points, count, &made, &error);
    return made_shape(probe, status, made, &error);
}

static pl_shape box_hull(pl_probe *probe)
{
    double points[8][3];
    for (int i = 0; i < 8; ++i) {
        points[i][0] = (i & 1) != 0 ? 0.9 : 0.1;
        points[i][1] = (i & 2) != 0 ? 0.3 : -0.3;
        points[i][2] = (i & 4) != 0 ? 0.8 : 0.2;
    }
    return hull_of(probe, (const double(*)[3])points, 8);
}

/* A table whose outline is sheared along x by `shear` times the height. */
static pl_shape table_mesh(pl_probe *probe, double shear)
{
    /* The outline in x and z, extruded along y. */
    static const double outline[8][2] = {{-0.5, 0}, {-0.2, 0}, {-0.2, 0.5}, {0.2, 0.5},
                                         {0.2, 0},  {0.5, 0},  {0.5, 0.8},  {-0.5, 0.8}};
    static const int front[6][3] = {{0, 1, 2}, {0, 2, 7}, {2, 3, 7},
                                    {3, 6, 7}, {3, 5, 6}, {3, 4, 5}};
    double vertices[16][3];
    int triangles[28][3];
    int count = 0;
    for (int i = 0; i < 16; ++i) {
        vertices[i][0] = outline[i % 8][0] + shear * outline[i % 8][1];
        vertices[i][1] = i < 8 ? -0.3 : 0.3;
        vertices[i][2] = outline[i % 8][1];
    }
    for (int i = 0; i < 6; ++i) {
        memcpy(triangles[count++], front[i], sizeof front[i]);
        memcpy(triangles[count++], (int[]){front[i][0] + 8, front[i][2] + 8, front[i][1] + 8},
               sizeof front[i]);
    }
    for (int i = 0; i < 8; ++i) {
        const int next = (i + 1) % 8;
        memcpy(triangles[count++], (int[]){next, i, i + 8}, sizeof *triangles);
        memcpy(triangles[count++], (int[]){next, i + 8, next + 8}, sizeof *triangles);
    }
    pl_error error = {.message = ""};
    const pl_polyhedron *made = NULL;
    const pl_status status =
        pl_scene_add_mesh(&probe->scene, NULL, (const double(*)[3])vertices, 16,
                          (const int(*)[3])triangles, count, &made, &error);
    return made_shape(probe, status, made, &error);
}

pl_shape pl_check_standing_solid(pl_probe *probe, pl_shape_kind kind)
{
    return kind == PL_SHAPE_HULL ? box_hull(probe) : table_mesh(probe, 0);
}

pl_shape pl_check_skew_solid(pl_probe *probe, pl_shape_kind kind)
{
    static const double points[5][3] = {
        {0.1, 0.2, 0.1}, {1.3, 0.1, 0.2}, {0.2, 0.9, 0.3}, {0.3, 0.4, 0.8}, {1.1, 0.8, 0.4}};
    return kind == PL_SHAPE_HULL ? hull_of(probe, points, 5) : table_mesh(probe, 0.7);
}

void pl_check_add_floor(pl_probe *probe)
{
    const pl_body slab = {
        .is_static = true, .shape = pl_shape_box(10, 10, 5), .position = {0, 0, -5}};
    if (pl_check_claims(probe, PL_NEEDS_PLANE)) {
        pl_probe_add_floor(probe);
    } else if (pl_check_claims(probe, PL_NEEDS_BOX)) {
        pl_probe_add_body(probe, slab);
    } else {
        pl_probe_skip(probe, "the engine claims no plane and no box to stand on");
    }
}

int pl_check_create_floating(pl_probe *probe, double dt, pl_body body)
{
    pl_probe_floating(probe, dt);
    const int index = pl_probe_add_body(probe, body);
    pl_probe_create(probe);
    return index;
}

double pl_check_time(const pl_probe *probe, int body)
{
    const pl_body *moving = &probe->scene.bodies[body];
    const pl_vec velocity = pl_vec_of(moving->velocity);
    const pl_vec path = pl_vec_sub(pl_state_centre(moving, &probe->now[body]),
                                   pl_state_centre(moving, &probe->start[body]));
    const double asked = (double)probe->steps * probe->scene.dt;
    const double time = pl_vec_dot(path, velocity) / pl_vec_dot(velocity, velocity);
    return time > 0.1 * asked && time < 10 * asked ? time : asked;
}

pl_vec pl_check_rotate(const double orientation[4], pl_vec local)
{
    const pl_axes axes = pl_axes_of(orientation);
    return pl_to_world(&axes, local);
}

pl_vec pl_check_rotate_back(const double orientation[4], pl_vec world)
{
    const pl_axes axes = pl_axes_of(orientation);
    return pl_to_local(&axes, world);
}
