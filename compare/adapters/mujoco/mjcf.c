#include "mjcf.h"

#include "adapters/native.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The least coefficient of friction that MuJoCo does not raise (mjMINMU). */
static const double least_friction = 1e-5;

/* The most numbers of a keyframe's attribute that MuJoCo 2.2 reads. */
enum { MOST_KEYFRAME_NUMBERS = 1000 };

/* A scene that is being written. */
typedef struct mjcf_writer {
    const pl_scene *scene;
    pl_text_buffer *out;
    pl_error *error;
    double pairs; /* of bodies with a friction of their own */
} mjcf_writer;

/* Adds an attribute of numbers. */
static void add_attribute(pl_text_buffer *out, const char *name, const double *values, int count)
{
    pl_text_format(out, " %s=\"", name);
    for (int i = 0; i < count; ++i) {
        pl_text_add(out, i == 0 ? "" : " ");
        pl_text_add_number(out, values[i]);
    }
    pl_text_add(out, "\"");
}

static double friction_of(const pl_scene *scene, int material_a, int material_b)
{
    double friction = 0, restitution = 0;
    pl_scene_pair(scene, material_a, material_b, &friction, &restitution);
    return friction;
}

/* ---- What MJCF cannot express ---- */

static pl_status check_bodies(const mjcf_writer *w)
{
    if (w->scene->body_count > PL_MJCF_MAX_BODIES) {
        return pl_fail(w->error, PL_UNSUPPORTED, "%d bodies; MuJoCo takes at most %d",
                       w->scene->body_count, (int)PL_MJCF_MAX_BODIES);
    }
    for (int i = 0; i < w->scene->body_count; ++i) {
        const pl_body *body = &w->scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_MESH) {
            return pl_fail(w->error, PL_UNSUPPORTED,
                           "body \"%s\" is a mesh: MuJoCo replaces it by its convex hull",
                           body->name);
        }
    }
    return PL_OK;
}

/* Whether a body of one material can touch one of the other. `moving` and `fixed` count the bodies
 * of each material. */
static bool materials_meet(const double *moving, const double *fixed, int a, int b)
{
    if (a == b) {
        return moving[a] > 0 && moving[a] + fixed[a] > 1;
    }
    return moving[a] * (moving[b] + fixed[b]) + fixed[a] * moving[b] > 0;
}

/* The pairs of bodies of two different materials, at least one of them moving. */
static double pairs_between(const double *moving, const double *fixed, int a, int b)
{
    return (moving[a] + fixed[a]) * (moving[b] + fixed[b]) - fixed[a] * fixed[b];
}

static double larger_friction(const pl_scene *scene, int a, int b)
{
    return fmax(friction_of(scene, a, a), friction_of(scene, b, b));
}

static pl_status check_pair(const mjcf_writer *w, int a, int b)
{
    double friction = 0, restitution = 0;
    pl_scene_pair(w->scene, a, b, &friction, &restitution);
    const char *name_a = w->scene->materials[a].name, *name_b = w->scene->materials[b].name;
    if (restitution > 0) {
        return pl_fail(w->error, PL_UNSUPPORTED,
                       "materials \"%s\" and \"%s\" have restitution %g: MuJoCo has none", name_a,
                       name_b, restitution);
    }
    if (friction > 0 && friction < least_friction) {
        return pl_fail(w->error, PL_UNSUPPORTED,
                       "materials \"%s\" and \"%s\" have friction %g: MuJoCo's least is %g", name_a,
                       name_b, friction, least_friction);
    }
    return PL_OK;
}

static pl_status check_materials(mjcf_writer *w)
{
    const pl_scene *scene = w->scene;
    size_t count = (size_t)scene->material_count + 1;
    double *moving = calloc(2 * count, sizeof *moving), *fixed = moving + count;
    if (moving == NULL) {
        return pl_fail(w->error, PL_NO_MEMORY, "out of memory");
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        (body->is_static ? fixed : moving)[body->material] += 1;
    }
    pl_status status = PL_OK;
    for (int a = 0; a < scene->material_count; ++a) {
        for (int b = a; b < scene->material_count && status == PL_OK; ++b) {
            if (materials_meet(moving, fixed, a, b)) {
                status = check_pair(w, a, b);
                w->pairs += a != b && friction_of(scene, a, b) != larger_friction(scene, a, b)
                                ? pairs_between(moving, fixed, a, b)
                                : 0;
            }
        }
    }
    free(moving);
    if (status == PL_OK && w->pairs > PL_MJCF_MAX_PAIRS) {
        return pl_fail(w->error, PL_UNSUPPORTED,
                       "%.0f pairs of bodies have a friction that is not the larger one of "
                       "their materials; the limit is %d",
                       w->pairs, (int)PL_MJCF_MAX_PAIRS);
    }
    return status;
}

/* ---- Writing ---- */

static void add_header(const mjcf_writer *w)
{
    const pl_scene *scene = w->scene;
    pl_mujoco_sizes sizes = pl_mujoco_sizes_for(scene, pl_mujoco_first_contacts(scene));
    pl_text_add(w->out, "<mujoco");
    if (scene->name[0] != '\0') {
        pl_text_add_element(w->out, " model=\"", scene->name, "\"");
    }
    pl_text_add(w->out, ">\n");
    if (scene->force_count > 0) {
        pl_text_format(w->out, "  <!-- without the scene's applied forces: %d -->\n",
                       scene->force_count);
    }
    pl_text_add(w->out, "  <compiler angle=\"radian\" boundmass=\"0\" boundinertia=\"0\" "
                        "balanceinertia=\"false\" inertiafromgeom=\"false\" fusestatic=\"false\" "
                        "discardvisual=\"false\"/>\n  <option");
    add_attribute(w->out, "timestep", &scene->dt, 1);
    add_attribute(w->out, "gravity", scene->gravity, 3);
    pl_text_format(w->out, "/>\n  <size njmax=\"%d\" nconmax=\"%d\" nstack=\"%d\"/>\n", sizes.njmax,
                   sizes.nconmax, sizes.nstack);
}

/* The vertices stand in the principal frame, so that a geom of the mesh needs no pose of its own. */
static void add_meshes(const mjcf_writer *w)
{
    const pl_scene *scene = w->scene;
    if (scene->polyhedron_count == 0) {
        return;
    }
    pl_text_add(w->out, "  <asset>\n");
    for (int i = 0; i < scene->polyhedron_count; ++i) {
        const pl_polyhedron *solid = scene->polyhedra[i];
        if (!solid->convex) {
            continue;
        }
        pl_text_format(w->out, "    <mesh name=\"mesh%d\" vertex=\"", i);
        for (int v = 0; v < solid->vertex_count; ++v) {
            double at[3];
            pl_vertex_in_principal(solid, v, at);
            for (int k = 0; k < 3; ++k) {
                pl_text_add(w->out, v + k == 0 ? "" : " ");
                pl_text_add_number(w->out, at[k]);
            }
        }
        pl_text_add(w->out, "\"/>\n");
    }
    pl_text_add(w->out, "  </asset>\n");
}

/* The pose of the frame whose z axis is the plane's normal. */
static void plane_pose(const pl_shape *plane, double position[3], double orientation[4])
{
    const double *n = plane->normal;
    /* Half of the angle from z to the normal, about an axis that is normal to both. */
    double across = hypot(n[0], n[1]), half = atan2(across, n[2]) / 2;
    double axis[2] = {across > 0 ? -n[1] / across : 1, across > 0 ? n[0] / across : 0};
    for (int k = 0; k < 3; ++k) {
        position[k] = plane->offset * n[k];
    }
    orientation[0] = cos(half);
    orientation[1] = sin(half) * axis[0];
    orientation[2] = sin(half) * axis[1];
    orientation[3] = 0;
}

static void body_pose(const pl_body *body, double position[3], double orientation[4])
{
    if (body->shape.kind == PL_SHAPE_PLANE) {
        plane_pose(&body->shape, position, orientation);
        return;
    }
    memcpy(position, body->position, sizeof body->position);
    memcpy(orientation, body->orientation, sizeof body->orientation);
    pl_to_principal_pose(&body->shape, position, orientation);
}

static void add_pose(const mjcf_writer *w, const pl_body *body)
{
    double position[3], orientation[4];
    body_pose(body, position, orientation);
    add_attribute(w->out, "pos", position, 3);
    add_attribute(w->out, "quat", orientation, 4);
}

/* MuJoCo's body 0 has the name "world": a body of the scene of that name gets as many '_' as make
 * it unique. */
static void add_body_name(const mjcf_writer *w, const pl_body *body)
{
    char name[2 * PL_NAME_SIZE];
    snprintf(name, sizeof name, "%s", body->name);
    bool taken = strcmp(name, "world") == 0;
    for (size_t end = strlen(name); taken && end + 1 < sizeof name; ++end) {
        name[end] = '_';
        name[end + 1] = '\0';
        taken = false;
        for (int i = 0; i < w->scene->body_count; ++i) {
            taken = taken || strcmp(w->scene->bodies[i].name, name) == 0;
        }
    }
    pl_text_add_element(w->out, " name=\"", name, "\"");
}

static void add_shape(const mjcf_writer *w, const pl_shape *shape)
{
    const double length[2] = {shape->radius, shape->half_height};
    switch (shape->kind) {
    case PL_SHAPE_PLANE: /* the size is that of the picture: the plane is unbounded */
        pl_text_add(w->out, " type=\"plane\" size=\"0 0 1\"");
        return;
    case PL_SHAPE_SPHERE:
        pl_text_add(w->out, " type=\"sphere\"");
        add_attribute(w->out, "size", length, 1);
        return;
    case PL_SHAPE_BOX:
        pl_text_add(w->out, " type=\"box\"");
        add_attribute(w->out, "size", shape->half_extents, 3);
        return;
    case PL_SHAPE_CAPSULE:
    case PL_SHAPE_CYLINDER:
        pl_text_format(w->out, " type=\"%s\"",
                       shape->kind == PL_SHAPE_CAPSULE ? "capsule" : "cylinder");
        add_attribute(w->out, "size", length, 2);
        return;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        pl_text_format(w->out, " type=\"mesh\" mesh=\"mesh%d\"",
                       pl_polyhedron_index(w->scene, shape->polyhedron));
        return;
    }
}

static void add_geom(const mjcf_writer *w, const pl_body *body)
{
    double friction = friction_of(w->scene, body->material, body->material);
    pl_text_add_element(w->out, "<geom name=\"", body->name, "\"");
    add_shape(w, &body->shape);
    if (body->shape.kind == PL_SHAPE_PLANE) {
        add_pose(w, body);
    }
    pl_text_format(w->out, " condim=\"%d\"", friction > 0 ? 3 : 1);
    add_attribute(w->out, "friction", (double[]){friction, 0, 0}, 3);
    pl_text_add(w->out, "/>\n");
}

/* Planes are geoms of the world: MuJoCo 2.2 collides a plane of another body twice with a body that
 * its origin is in. */
static void add_bodies(const mjcf_writer *w)
{
    pl_text_add(w->out, "  <worldbody>\n");
    for (int i = 0; i < w->scene->body_count; ++i) {
        const pl_body *body = &w->scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            pl_text_add(w->out, "    ");
            add_geom(w, body);
            continue;
        }
        pl_text_add(w->out, "    <body");
        add_body_name(w, body);
        add_pose(w, body);
        pl_text_add(w->out, ">\n");
        if (!body->is_static) {
            pl_text_add(w->out, "      <freejoint/>\n      <inertial pos=\"0 0 0\"");
            add_attribute(w->out, "mass", &body->mass, 1);
            add_attribute(w->out, "diaginertia", body->inertia, 3);
            pl_text_add(w->out, "/>\n");
        }
        pl_text_add(w->out, "      ");
        add_geom(w, body);
        pl_text_add(w->out, "    </body>\n");
    }
    pl_text_add(w->out, "  </worldbody>\n");
}

/* The pairs of bodies for which the larger friction of their materials is not the scene's. */
static void add_pairs(const mjcf_writer *w)
{
    const pl_scene *scene = w->scene;
    if (w->pairs == 0) {
        return;
    }
    pl_text_add(w->out, "  <contact>\n");
    for (int i = 0; i < scene->body_count; ++i) {
        for (int j = i + 1; j < scene->body_count; ++j) {
            const pl_body *a = &scene->bodies[i], *b = &scene->bodies[j];
            if ((a->is_static && b->is_static) || a->material == b->material) {
                continue;
            }
            double friction = friction_of(scene, a->material, b->material);
            if (friction == larger_friction(scene, a->material, b->material)) {
                continue;
            }
            const double all[5] = {friction, friction, 0, 0, 0};
            pl_text_add_element(w->out, "    <pair geom1=\"", a->name, "\"");
            pl_text_add_element(w->out, " geom2=\"", b->name, "\"");
            pl_text_format(w->out, " condim=\"%d\"", friction > 0 ? 3 : 1);
            add_attribute(w->out, "friction", all, 5);
            pl_text_add(w->out, "/>\n");
        }
    }
    pl_text_add(w->out, "  </contact>\n");
}

static bool any_velocity(const pl_scene *scene)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        for (int k = 0; k < 3 && !body->is_static; ++k) {
            if (body->velocity[k] != 0 || body->angular_velocity[k] != 0) {
                return true;
            }
        }
    }
    return false;
}

/* The poses of the keyframe are those of the bodies. */
static void add_keyframe(const mjcf_writer *w)
{
    const pl_scene *scene = w->scene;
    int numbers = 0;
    if (!any_velocity(scene)) {
        return;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        numbers += scene->bodies[i].is_static ? 0 : 6;
    }
    if (numbers > MOST_KEYFRAME_NUMBERS) {
        pl_text_format(w->out, "  <!-- without the velocities: MuJoCo 2.2 reads at most %d -->\n",
                       (int)MOST_KEYFRAME_NUMBERS);
        return;
    }
    const char *separator = "  <keyframe>\n    <key name=\"start\" qvel=\"";
    for (int i = 0; i < scene->body_count; ++i) {
        double velocity[6];
        pl_mjcf_velocity(&scene->bodies[i], velocity);
        for (int k = 0; k < 6 && !scene->bodies[i].is_static; ++k) {
            pl_text_add(w->out, separator);
            pl_text_add_number(w->out, velocity[k]);
            separator = " ";
        }
    }
    pl_text_add(w->out, "\"/>\n  </keyframe>\n");
}

void pl_mjcf_velocity(const pl_body *body, double velocity[6])
{
    double position[3], orientation[4];
    body_pose(body, position, orientation);
    memcpy(velocity, body->velocity, sizeof body->velocity);
    pl_rotate_to_body(orientation, body->angular_velocity, velocity + 3);
}

pl_status pl_mjcf_write(const pl_scene *scene, pl_text_buffer *out, pl_error *error)
{
    mjcf_writer w = {.scene = scene, .out = out, .error = error};
    pl_status status = check_bodies(&w);
    if (status == PL_OK) {
        status = check_materials(&w);
    }
    if (status != PL_OK) {
        return status;
    }
    add_header(&w);
    add_meshes(&w);
    add_bodies(&w);
    add_pairs(&w);
    add_keyframe(&w);
    pl_text_add(out, "</mujoco>\n");
    return out->failed ? pl_fail(error, PL_NO_MEMORY, "out of memory") : PL_OK;
}
