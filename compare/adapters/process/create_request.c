/* The request `create` of the protocol plumb.engine/1. */
#include "channel.h"

#include "adapters/native.h"
#include "plumb/scene.h"

#include <stdlib.h>
#include <string.h>

static const char *const shape_types[PL_SHAPE_KIND_COUNT] = {
    [PL_SHAPE_PLANE] = "plane",     [PL_SHAPE_SPHERE] = "sphere",     [PL_SHAPE_BOX] = "box",
    [PL_SHAPE_CAPSULE] = "capsule", [PL_SHAPE_CYLINDER] = "cylinder", [PL_SHAPE_HULL] = "hull",
    [PL_SHAPE_MESH] = "mesh"};

/* A member of an object, with a comma before it. */
static void add_key(pl_text_buffer *out, const char *key)
{
    pl_text_format(out, ",\"%s\":", key);
}

static void add_member(pl_text_buffer *out, const char *key, double value)
{
    add_key(out, key);
    pl_text_add_number(out, value);
}

static void add_vector(pl_text_buffer *out, const char *key, const double *values, int count)
{
    add_key(out, key);
    pl_text_add_numbers(out, values, count);
}

/* A comma, but before the first item of an array. */
static void separate(pl_text_buffer *out, int index)
{
    pl_text_add(out, index > 0 ? "," : "");
}

static void add_shape(pl_text_buffer *out, const pl_scene *scene, const pl_shape *shape)
{
    pl_text_format(out, "{\"type\":\"%s\"", shape_types[shape->kind]);
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        add_vector(out, "normal", shape->normal, 3);
        add_member(out, "offset", shape->offset);
        break;
    case PL_SHAPE_SPHERE:
        add_member(out, "radius", shape->radius);
        break;
    case PL_SHAPE_BOX:
        add_vector(out, "half_extents", shape->half_extents, 3);
        break;
    case PL_SHAPE_CAPSULE:
    case PL_SHAPE_CYLINDER:
        add_member(out, "radius", shape->radius);
        add_member(out, "half_height", shape->half_height);
        break;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        add_member(out, "solid", pl_polyhedron_index(scene, shape->polyhedron));
        break;
    }
    pl_text_add(out, "}");
}

static void add_solid(pl_text_buffer *out, const pl_polyhedron *solid)
{
    pl_text_format(out, "{\"type\":\"%s\",\"vertices\":[", solid->convex ? "hull" : "mesh");
    for (int i = 0; i < solid->vertex_count; ++i) {
        separate(out, i);
        pl_text_add_numbers(out, solid->vertices[i], 3);
    }
    pl_text_add(out, "],\"triangles\":[");
    for (int i = 0; i < solid->triangle_count; ++i) {
        const int *t = solid->triangles[i];
        separate(out, i);
        pl_text_format(out, "[%d,%d,%d]", t[0], t[1], t[2]);
    }
    pl_text_add(out, "]");
    add_vector(out, "centre", solid->centre, 3);
    add_vector(out, "axes", solid->axes, 4);
    pl_text_add(out, "}");
}

static void add_force(pl_text_buffer *out, const pl_force *force)
{
    pl_text_add(out, "{\"force\":");
    pl_text_add_numbers(out, force->force, 3);
    add_vector(out, "at", force->at, 3);
    add_key(out, "frame");
    pl_text_add(out, force->frame == PL_FRAME_BODY ? "\"body\"" : "\"world\"");
    add_member(out, "from", force->from);
    add_member(out, "until", force->until); /* infinity becomes null */
    pl_text_add(out, "}");
}

/* first[b] is the number of the first force of body b in `forces`, the next of each in `next`; -1:
 * none. In the scene's order. */
typedef struct force_lists {
    int *first, *next;
} force_lists;

static bool list_forces(const pl_scene *scene, force_lists *lists)
{
    lists->first = malloc(((size_t)scene->body_count + 1) * sizeof *lists->first);
    lists->next = malloc(((size_t)scene->force_count + 1) * sizeof *lists->next);
    if (lists->first == NULL || lists->next == NULL) {
        return false;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        lists->first[i] = -1;
    }
    for (int i = scene->force_count - 1; i >= 0; --i) {
        lists->next[i] = lists->first[scene->forces[i].body];
        lists->first[scene->forces[i].body] = i;
    }
    return true;
}

static void add_body(pl_text_buffer *out, const pl_scene *scene, int index,
                     const force_lists *forces)
{
    const pl_body *body = &scene->bodies[index];
    static const double zero[3] = {0, 0, 0};
    pl_text_add(out, "{\"name\":");
    pl_text_add_json(out, body->name);
    add_key(out, "static");
    pl_text_add(out, body->is_static ? "true" : "false");
    add_key(out, "shape");
    add_shape(out, scene, &body->shape);
    add_member(out, "mass", body->is_static ? 0 : body->mass);
    add_vector(out, "inertia", body->is_static ? zero : body->inertia, 3);
    add_vector(out, "position", body->position, 3);
    add_vector(out, "orientation", body->orientation, 4);
    add_vector(out, "velocity", body->velocity, 3);
    add_vector(out, "angular_velocity", body->angular_velocity, 3);
    add_member(out, "material", body->material);
    add_key(out, "forces");
    pl_text_add(out, "[");
    for (int i = forces->first[index]; i >= 0; i = forces->next[i]) {
        separate(out, i != forces->first[index]);
        add_force(out, &scene->forces[i]);
    }
    pl_text_add(out, "]}");
}

/* One coefficient of all pairs of materials, a matrix. */
static void add_matrix(pl_text_buffer *out, const char *key, const pl_engine_setup *setup,
                       bool is_friction)
{
    const int count = setup->scene->material_count;
    add_key(out, key);
    pl_text_add(out, "[");
    for (int i = 0; i < count; ++i) {
        pl_text_add(out, i > 0 ? ",[" : "[");
        for (int k = 0; k < count; ++k) {
            const pl_pair_coefficients *pair = &setup->pairs[i * count + k];
            separate(out, k);
            pl_text_add_number(out, is_friction ? pair->friction : pair->restitution);
        }
        pl_text_add(out, "]");
    }
    pl_text_add(out, "]");
}

static void add_options(pl_text_buffer *out, const pl_engine_setup *setup, const pl_engine *engine)
{
    add_key(out, "profile");
    pl_text_add_json(out, engine->profiles[setup->profile].name);
    add_key(out, "options");
    pl_text_add(out, "{");
    for (int i = 0; i < engine->option_count; ++i) {
        separate(out, i);
        pl_text_add_json_key(out, engine->options[i].name);
        pl_text_add_number(out, setup->values[i]);
    }
    pl_text_add(out, "}");
}

static void add_bodies(pl_text_buffer *out, const pl_scene *scene)
{
    force_lists forces = {.first = NULL};
    if (!list_forces(scene, &forces)) {
        out->failed = true;
    } else {
        add_key(out, "bodies");
        pl_text_add(out, "[");
        for (int i = 0; i < scene->body_count; ++i) {
            separate(out, i);
            add_body(out, scene, i, &forces);
        }
        pl_text_add(out, "]");
    }
    free(forces.first);
    free(forces.next);
}

/* The text of the scene file on one line: its line breaks are between tokens. */
static void add_scene(pl_text_buffer *out, const pl_scene *scene)
{
    char *text = pl_scene_to_text(scene);
    if (text == NULL) {
        out->failed = true;
        return;
    }
    for (char *c = text; *c != '\0'; ++c) {
        *c = *c == '\n' ? ' ' : *c;
    }
    add_key(out, "scene");
    pl_text_add(out, text);
    free(text);
}

void pl_create_request_add(pl_text_buffer *out, const pl_engine_setup *setup,
                           const pl_engine *engine)
{
    const pl_scene *scene = setup->scene;
    add_options(out, setup, engine);
    add_member(out, "dt", setup->dt);
    add_vector(out, "gravity", scene->gravity, 3);
    add_bodies(out, scene);
    add_key(out, "solids");
    pl_text_add(out, "[");
    for (int i = 0; i < scene->polyhedron_count; ++i) {
        separate(out, i);
        add_solid(out, scene->polyhedra[i]);
    }
    pl_text_add(out, "]");
    add_matrix(out, "friction", setup, true);
    add_matrix(out, "restitution", setup, false);
    add_vector(out, "lower", setup->lower, 3);
    add_vector(out, "upper", setup->upper, 3);
    add_scene(out, scene);
}
