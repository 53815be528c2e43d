/* Scene to JSON, for people to edit: one object a line or two, in the order of the format, every
 * number in as few digits as read back to it. What a reader would fill in by itself is left out
 * where it is the same to the bit: zero velocities, the shape's own inertia, a force's defaults.
 *
 * Polyhedra that have a name, or that several bodies share, stand in "shapes"; of the others each
 * in its body. All have their vertices: the text needs no other file. */
#include "base/json_writer.h"
#include "plumb/scene.h"
#include "polyhedron_names.h"
#include "scene_keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Equal as bits: 0 and -0 differ. */
static bool same_numbers(const double *a, const double *b, int count)
{
    return memcmp(a, b, (size_t)count * sizeof *a) == 0;
}

static const double zeros[3] = {0, 0, 0};

static void put_materials(pl_json_writer *w, const pl_scene *scene)
{
    pl_put(w, ",\n  \"materials\": {");
    for (int i = 0; i < scene->material_count; i++) {
        const pl_material *material = &scene->materials[i];
        pl_put_key(w, i == 0 ? "\n    " : ",\n    ", material->name);
        pl_put_number_member(w, "{ ", "friction", material->friction);
        pl_put_number_member(w, ", ", "restitution", material->restitution);
        pl_put(w, " }");
    }
    pl_put(w, "\n  }");
}

static void put_pairs(pl_json_writer *w, const pl_scene *scene)
{
    pl_put(w, ",\n  \"pairs\": [");
    for (int i = 0; i < scene->pair_count; i++) {
        const pl_material_pair *pair = &scene->pairs[i];
        pl_put_string_member(w, i == 0 ? "\n    { " : ",\n    { ", "a",
                             scene->materials[pair->material_a].name);
        pl_put_string_member(w, ", ", "b", scene->materials[pair->material_b].name);
        pl_put_number_member(w, ", ", "friction", pair->friction);
        pl_put_number_member(w, ", ", "restitution", pair->restitution);
        pl_put(w, " }");
    }
    pl_put(w, "\n  ]");
}

/* Triples of numbers, some on a line. */
static void put_triples(pl_json_writer *w, const char *key, const double (*triples)[3], int count)
{
    enum { ON_A_LINE = 4 };
    pl_put_key(w, ", ", key);
    for (int i = 0; i < count; i++) {
        pl_put(w, i == 0 ? "[" : i % ON_A_LINE == 0 ? ",\n      " : ", ");
        pl_put_vector(w, triples[i], 3);
    }
    pl_put(w, "]");
}

static void put_triangles(pl_json_writer *w, const int (*triangles)[3], int count)
{
    enum { ON_A_LINE = 8 };
    pl_put(w, ", \"triangles\": ");
    for (int i = 0; i < count; i++) {
        char text[48];
        snprintf(text, sizeof text, "[%d, %d, %d]", triangles[i][0], triangles[i][1],
                 triangles[i][2]);
        pl_put(w, i == 0 ? "[" : i % ON_A_LINE == 0 ? ",\n      " : ", ");
        pl_put(w, text);
    }
    pl_put(w, "]");
}

static void put_polyhedron(pl_json_writer *w, const pl_polyhedron *p)
{
    const double(*vertices)[3] = (const double(*)[3])p->vertices;
    put_triples(w, p->convex ? "points" : "vertices", vertices, p->vertex_count);
    if (!p->convex) {
        put_triangles(w, (const int(*)[3])p->triangles, p->triangle_count);
    }
}

static void put_shape(pl_json_writer *w, const pl_shape *shape)
{
    pl_put_string_member(w, "{ ", "type", pl_shape_names[shape->kind]);
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        pl_put_vector_member(w, ", ", "normal", shape->normal, 3);
        pl_put_number_member(w, ", ", "offset", shape->offset);
        break;
    case PL_SHAPE_SPHERE:
        pl_put_number_member(w, ", ", "radius", shape->radius);
        break;
    case PL_SHAPE_BOX:
        pl_put_vector_member(w, ", ", "half_extents", shape->half_extents, 3);
        break;
    case PL_SHAPE_CAPSULE:
    case PL_SHAPE_CYLINDER:
        pl_put_number_member(w, ", ", "radius", shape->radius);
        pl_put_number_member(w, ", ", "half_height", shape->half_height);
        break;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        put_polyhedron(w, shape->polyhedron);
        break;
    }
    pl_put(w, " }");
}

static void put_shapes(pl_json_writer *w, const pl_scene *scene, const pl_polyhedron_names *names)
{
    const char *before = ",\n  \"shapes\": {\n    ";
    bool any = false;
    for (int i = 0; i < scene->polyhedron_count; i++) {
        if (names->names[i][0] != '\0') {
            const pl_shape shape = pl_shape_of(scene->polyhedra[i]);
            pl_put_key(w, any ? ",\n    " : before, names->names[i]);
            put_shape(w, &shape);
            any = true;
        }
    }
    pl_put(w, any ? "\n  }" : "");
}

/* The name of a shape of "shapes", or the shape itself. */
static void put_body_shape(pl_json_writer *w, const pl_shape *shape,
                           const pl_polyhedron_names *names)
{
    const int index = pl_pointer_map_find(&names->addresses, shape->polyhedron);
    if (index >= 0 && names->names[index][0] != '\0') {
        pl_put_string_member(w, ", ", "shape", names->names[index]);
    } else {
        pl_put_key(w, ", ", "shape");
        put_shape(w, shape);
    }
}

static void put_force(pl_json_writer *w, const char *before, const pl_force *force)
{
    pl_put(w, before);
    pl_put_vector_member(w, "{ ", "force", force->force, 3);
    if (!same_numbers(force->at, zeros, 3)) {
        pl_put_vector_member(w, ", ", "at", force->at, 3);
    }
    if (force->frame == PL_FRAME_BODY) {
        pl_put_string_member(w, ", ", "frame", "body");
    }
    if (!same_numbers(&force->from, zeros, 1)) {
        pl_put_number_member(w, ", ", "from", force->from);
    }
    if (isfinite(force->until)) {
        pl_put_number_member(w, ", ", "until", force->until);
    }
    pl_put(w, " }");
}

/* The forces of one body; order[0 .. count) are their numbers. */
static void put_forces(pl_json_writer *w, const pl_scene *scene, const int *order, int count)
{
    pl_put(w, ",\n      \"forces\": [");
    for (int i = 0; i < count; i++) {
        put_force(w, i == 0 ? "\n        " : ",\n        ", &scene->forces[order[i]]);
    }
    pl_put(w, "\n      ]");
}

static void put_body(pl_json_writer *w, const pl_scene *scene, const pl_body *body,
                     const pl_polyhedron_names *names)
{
    const char *next_line = ",\n      ";
    pl_put_string_member(w, "{ ", "name", body->name);
    if (body->is_static) {
        pl_put(w, ", \"static\": true");
    } else {
        double inertia[3];
        pl_shape_inertia(&body->shape, body->mass, inertia);
        pl_put_number_member(w, ", ", "mass", body->mass);
        if (!same_numbers(body->inertia, inertia, 3)) {
            pl_put_vector_member(w, ", ", "inertia", body->inertia, 3);
        }
    }
    pl_put_string_member(w, ", ", "material", scene->materials[body->material].name);
    put_body_shape(w, &body->shape, names);
    if (body->shape.kind != PL_SHAPE_PLANE) {
        pl_put_vector_member(w, next_line, "position", body->position, 3);
        pl_put_vector_member(w, ", ", "orientation", body->orientation, 4);
    }
    if (!same_numbers(body->velocity, zeros, 3)) {
        pl_put_vector_member(w, next_line, "velocity", body->velocity, 3);
        next_line = ", ";
    }
    if (!same_numbers(body->angular_velocity, zeros, 3)) {
        pl_put_vector_member(w, next_line, "angular_velocity", body->angular_velocity, 3);
    }
}

/* The numbers of all forces, by body and then as they stand: order[first[b] .. first[b + 1]) are
 * those of body b. A counting sort; malloc'd, NULL when out of memory. */
static int *sort_forces(const pl_scene *scene, int **first)
{
    size_t bodies = (size_t)scene->body_count, forces = (size_t)scene->force_count;
    int *memory = calloc(bodies + 2 + forces, sizeof *memory);
    if (memory == NULL) {
        return NULL;
    }
    int *next = memory + 1; /* next[b] counts up from first[b] to first[b + 1] */
    int *order = memory + bodies + 2;
    for (int i = 0; i < scene->force_count; i++) {
        next[scene->forces[i].body + 1]++;
    }
    for (int b = 0; b < scene->body_count; b++) {
        next[b + 1] += next[b];
    }
    for (int i = 0; i < scene->force_count; i++) {
        order[next[scene->forces[i].body]++] = i;
    }
    *first = memory;
    return memory;
}

static void put_bodies(pl_json_writer *w, const pl_scene *scene, const pl_polyhedron_names *names)
{
    int *first = NULL;
    int *memory = sort_forces(scene, &first);
    if (memory == NULL) {
        w->out_of_memory = true;
        return;
    }
    const int *order = memory + scene->body_count + 2;
    pl_put(w, ",\n  \"bodies\": [");
    for (int b = 0; b < scene->body_count; b++) {
        pl_put(w, b == 0 ? "\n    " : ",\n    ");
        put_body(w, scene, &scene->bodies[b], names);
        if (first[b + 1] > first[b]) {
            put_forces(w, scene, order + first[b], first[b + 1] - first[b]);
        }
        pl_put(w, " }");
    }
    pl_put(w, "\n  ]");
    free(memory);
}

static void put_rests(pl_json_writer *w, const pl_scene *scene)
{
    pl_put(w, "\n    \"rest\": [");
    for (int i = 0; i < scene->rest_count; i++) {
        const pl_expect_rest *rest = &scene->rests[i];
        pl_put_string_member(w, i == 0 ? "\n      { " : ",\n      { ", "body",
                             scene->bodies[rest->body].name);
        pl_put_vector_member(w, ", ", "position", rest->position, 3);
        if (rest->has_orientation) {
            pl_put_vector_member(w, ", ", "orientation", rest->orientation, 4);
        }
        pl_put(w, " }");
    }
    pl_put(w, "\n    ],");
}

static void put_travels(pl_json_writer *w, const pl_scene *scene)
{
    pl_put(w, "\n    \"travel\": [");
    for (int i = 0; i < scene->travel_count; i++) {
        const pl_expect_travel *travel = &scene->travels[i];
        pl_put_string_member(w, i == 0 ? "\n      { " : ",\n      { ", "body",
                             scene->bodies[travel->body].name);
        pl_put_vector_member(w, ", ", "direction", travel->direction, 3);
        pl_put_number_member(w, ", ", "distance", travel->distance);
        if (!isnan(travel->discrete)) {
            pl_put_number_member(w, ", ", "discrete", travel->discrete);
        }
        pl_put(w, " }");
    }
    pl_put(w, "\n    ],");
}

static void put_values(pl_json_writer *w, const pl_scene *scene)
{
    pl_put(w, "\n    \"values\": [");
    for (int i = 0; i < scene->value_count; i++) {
        const pl_expect_value *value = &scene->values[i];
        pl_put_string_member(w, i == 0 ? "\n      { " : ",\n      { ", "body",
                             scene->bodies[value->body].name);
        pl_put_string_member(w, ", ", "quantity", pl_quantity_names[value->quantity]);
        pl_put_vector_member(w, ", ", "direction", value->direction, 3);
        pl_put_number_member(w, ", ", "from", value->from);
        pl_put_number_member(w, ", ", "until", value->until);
        pl_put_number_member(w, ", ", "value", value->value);
        if (!isnan(value->discrete)) {
            pl_put_number_member(w, ", ", "discrete", value->discrete);
        }
        pl_put_number_member(w, ", ", "scale", value->scale);
        pl_put(w, " }");
    }
    pl_put(w, "\n    ],");
}

static void put_expectations(pl_json_writer *w, const pl_scene *scene)
{
    bool nothing = scene->rest_count == 0 && scene->travel_count == 0 && scene->value_count == 0 &&
                   scene->primary_error[0] == '\0' && isinf(scene->collapse_distance);
    if (nothing) {
        return;
    }
    pl_put(w, ",\n  \"expect\": {");
    if (scene->rest_count > 0) {
        put_rests(w, scene);
    }
    if (scene->travel_count > 0) {
        put_travels(w, scene);
    }
    if (scene->value_count > 0) {
        put_values(w, scene);
    }
    pl_put_string_member(w, "\n    ", "primary", scene->primary_error);
    if (scene->rest_count > 0 || isfinite(scene->collapse_distance)) {
        pl_put_number_member(w, ",\n    ", "collapse_distance", scene->collapse_distance);
    }
    pl_put(w, "\n  }");
}

char *pl_scene_to_text(const pl_scene *scene)
{
    pl_json_writer w = {.text = NULL};
    pl_polyhedron_names names;
    if (pl_polyhedron_names_create(scene, &names) != PL_OK) {
        return NULL;
    }
    pl_put(&w, "{\n  \"plumb_scene\": 1");
    if (scene->name[0] != '\0') {
        pl_put_string_member(&w, ",\n  ", "name", scene->name);
    }
    pl_put_vector_member(&w, ",\n  ", "gravity", scene->gravity, 3);
    pl_put_number_member(&w, ",\n  ", "dt", scene->dt);
    pl_put_number_member(&w, ",\n  ", "duration", scene->duration);
    if (scene->material_count > 0) {
        put_materials(&w, scene);
    }
    if (scene->pair_count > 0) {
        put_pairs(&w, scene);
    }
    put_shapes(&w, scene, &names);
    put_bodies(&w, scene, &names);
    pl_polyhedron_names_free(&names);
    put_expectations(&w, scene);
    pl_put(&w, "\n}\n");
    if (w.out_of_memory) {
        free(w.text);
        return NULL;
    }
    return w.text;
}

/* Fowler, Noll and Vo: FNV-1a with its 64-bit offset and prime. */
pl_status pl_scene_hash(const pl_scene *scene, char hash[17], pl_error *error)
{
    hash[0] = '\0';
    char *text = pl_scene_to_text(scene);
    if (text == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the text of a scene of %d bodies",
                       scene->body_count);
    }
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    for (const char *c = text; *c != '\0'; c++) {
        sum = (sum ^ (unsigned char)*c) * UINT64_C(0x100000001b3);
    }
    free(text);
    snprintf(hash, 17, "%016llx", (unsigned long long)sum);
    return PL_OK;
}
