/* Scene to JSON, for people to edit: one object a line or two, in the order of the format, every
 * number in as few digits as read back to it. What a reader would fill in by itself is left out
 * where it is the same to the bit: zero velocities, the shape's own inertia, a force's defaults. */
#include "number.h"
#include "plumb/scene.h"
#include "scene_keys.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct writer {
    char *text;
    size_t length, capacity;
    bool out_of_memory;
} writer;

static void put_bytes(writer *w, const char *bytes, size_t length)
{
    if (w->length + length + 1 > w->capacity && !w->out_of_memory) {
        size_t capacity = 2 * (w->length + length + 1);
        char *grown = realloc(w->text, capacity);
        if (grown == NULL) {
            w->out_of_memory = true;
        } else {
            w->text = grown;
            w->capacity = capacity;
        }
    }
    if (w->out_of_memory) {
        return;
    }
    memcpy(w->text + w->length, bytes, length);
    w->length += length;
    w->text[w->length] = '\0';
}

static void put(writer *w, const char *text)
{
    put_bytes(w, text, strlen(text));
}

static void put_string(writer *w, const char *string)
{
    put(w, "\"");
    for (const char *c = string; *c != '\0'; c++) {
        char escaped[8];
        if ((unsigned char)*c < 0x20) {
            snprintf(escaped, sizeof escaped, "\\u%04x", (unsigned)*c);
            put(w, escaped);
        } else {
            put(w, *c == '"' || *c == '\\' ? "\\" : "");
            put_bytes(w, c, 1);
        }
    }
    put(w, "\"");
}

/* JSON has no word for what is not finite: null, which the reader takes where it has a meaning. */
static void put_number(writer *w, double value)
{
    char text[PL_NUMBER_SIZE];
    put(w, isfinite(value) ? pl_number_text(value, text) : "null");
}

static void put_vector(writer *w, const double *values, int count)
{
    put(w, "[");
    for (int i = 0; i < count; i++) {
        put(w, i == 0 ? "" : ", ");
        put_number(w, values[i]);
    }
    put(w, "]");
}

/* Members of an object: `before` is what separates it from the member before, with its line breaks.
 */
static void put_key(writer *w, const char *before, const char *key)
{
    put(w, before);
    put_string(w, key);
    put(w, ": ");
}

static void put_string_member(writer *w, const char *before, const char *key, const char *value)
{
    put_key(w, before, key);
    put_string(w, value);
}

static void put_number_member(writer *w, const char *before, const char *key, double value)
{
    put_key(w, before, key);
    put_number(w, value);
}

static void put_vector_member(writer *w, const char *before, const char *key, const double *values,
                              int count)
{
    put_key(w, before, key);
    put_vector(w, values, count);
}

/* Equal as bits: 0 and -0 differ. */
static bool same_numbers(const double *a, const double *b, int count)
{
    return memcmp(a, b, (size_t)count * sizeof *a) == 0;
}

static const double zeros[3] = {0, 0, 0};

static void put_materials(writer *w, const pl_scene *scene)
{
    put(w, ",\n  \"materials\": {");
    for (int i = 0; i < scene->material_count; i++) {
        const pl_material *material = &scene->materials[i];
        put_key(w, i == 0 ? "\n    " : ",\n    ", material->name);
        put_number_member(w, "{ ", "friction", material->friction);
        put_number_member(w, ", ", "restitution", material->restitution);
        put(w, " }");
    }
    put(w, "\n  }");
}

static void put_pairs(writer *w, const pl_scene *scene)
{
    put(w, ",\n  \"pairs\": [");
    for (int i = 0; i < scene->pair_count; i++) {
        const pl_material_pair *pair = &scene->pairs[i];
        put_string_member(w, i == 0 ? "\n    { " : ",\n    { ", "a",
                          scene->materials[pair->material_a].name);
        put_string_member(w, ", ", "b", scene->materials[pair->material_b].name);
        put_number_member(w, ", ", "friction", pair->friction);
        put_number_member(w, ", ", "restitution", pair->restitution);
        put(w, " }");
    }
    put(w, "\n  ]");
}

static void put_shape(writer *w, const pl_shape *shape)
{
    put_key(w, ", ", "shape");
    put_string_member(w, "{ ", "type", pl_shape_names[shape->kind]);
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        put_vector_member(w, ", ", "normal", shape->normal, 3);
        put_number_member(w, ", ", "offset", shape->offset);
        break;
    case PL_SHAPE_SPHERE:
        put_number_member(w, ", ", "radius", shape->radius);
        break;
    case PL_SHAPE_BOX:
        put_vector_member(w, ", ", "half_extents", shape->half_extents, 3);
        break;
    }
    put(w, " }");
}

static void put_force(writer *w, const char *before, const pl_force *force)
{
    put(w, before);
    put_vector_member(w, "{ ", "force", force->force, 3);
    if (!same_numbers(force->at, zeros, 3)) {
        put_vector_member(w, ", ", "at", force->at, 3);
    }
    if (force->frame == PL_FRAME_BODY) {
        put_string_member(w, ", ", "frame", "body");
    }
    if (!same_numbers(&force->from, zeros, 1)) {
        put_number_member(w, ", ", "from", force->from);
    }
    if (isfinite(force->until)) {
        put_number_member(w, ", ", "until", force->until);
    }
    put(w, " }");
}

/* The forces of one body; order[0 .. count) are their numbers. */
static void put_forces(writer *w, const pl_scene *scene, const int *order, int count)
{
    put(w, ",\n      \"forces\": [");
    for (int i = 0; i < count; i++) {
        put_force(w, i == 0 ? "\n        " : ",\n        ", &scene->forces[order[i]]);
    }
    put(w, "\n      ]");
}

static void put_body(writer *w, const pl_scene *scene, const pl_body *body)
{
    const char *next_line = ",\n      ";
    put_string_member(w, "{ ", "name", body->name);
    if (body->is_static) {
        put(w, ", \"static\": true");
    } else {
        double inertia[3];
        pl_shape_inertia(&body->shape, body->mass, inertia);
        put_number_member(w, ", ", "mass", body->mass);
        if (!same_numbers(body->inertia, inertia, 3)) {
            put_vector_member(w, ", ", "inertia", body->inertia, 3);
        }
    }
    put_string_member(w, ", ", "material", scene->materials[body->material].name);
    put_shape(w, &body->shape);
    if (body->shape.kind != PL_SHAPE_PLANE) {
        put_vector_member(w, next_line, "position", body->position, 3);
        put_vector_member(w, ", ", "orientation", body->orientation, 4);
    }
    if (!same_numbers(body->velocity, zeros, 3)) {
        put_vector_member(w, next_line, "velocity", body->velocity, 3);
        next_line = ", ";
    }
    if (!same_numbers(body->angular_velocity, zeros, 3)) {
        put_vector_member(w, next_line, "angular_velocity", body->angular_velocity, 3);
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

static void put_bodies(writer *w, const pl_scene *scene)
{
    int *first = NULL;
    int *memory = sort_forces(scene, &first);
    if (memory == NULL) {
        w->out_of_memory = true;
        return;
    }
    const int *order = memory + scene->body_count + 2;
    put(w, ",\n  \"bodies\": [");
    for (int b = 0; b < scene->body_count; b++) {
        put(w, b == 0 ? "\n    " : ",\n    ");
        put_body(w, scene, &scene->bodies[b]);
        if (first[b + 1] > first[b]) {
            put_forces(w, scene, order + first[b], first[b + 1] - first[b]);
        }
        put(w, " }");
    }
    put(w, "\n  ]");
    free(memory);
}

static void put_rests(writer *w, const pl_scene *scene)
{
    put(w, "\n    \"rest\": [");
    for (int i = 0; i < scene->rest_count; i++) {
        const pl_expect_rest *rest = &scene->rests[i];
        put_string_member(w, i == 0 ? "\n      { " : ",\n      { ", "body",
                          scene->bodies[rest->body].name);
        put_vector_member(w, ", ", "position", rest->position, 3);
        if (rest->has_orientation) {
            put_vector_member(w, ", ", "orientation", rest->orientation, 4);
        }
        put(w, " }");
    }
    put(w, "\n    ],");
}

static void put_travels(writer *w, const pl_scene *scene)
{
    put(w, "\n    \"travel\": [");
    for (int i = 0; i < scene->travel_count; i++) {
        const pl_expect_travel *travel = &scene->travels[i];
        put_string_member(w, i == 0 ? "\n      { " : ",\n      { ", "body",
                          scene->bodies[travel->body].name);
        put_vector_member(w, ", ", "direction", travel->direction, 3);
        put_number_member(w, ", ", "distance", travel->distance);
        if (!isnan(travel->discrete)) {
            put_number_member(w, ", ", "discrete", travel->discrete);
        }
        put(w, " }");
    }
    put(w, "\n    ],");
}

static void put_expectations(writer *w, const pl_scene *scene)
{
    bool nothing = scene->rest_count == 0 && scene->travel_count == 0 &&
                   scene->primary_error[0] == '\0' && isinf(scene->collapse_distance);
    if (nothing) {
        return;
    }
    put(w, ",\n  \"expect\": {");
    if (scene->rest_count > 0) {
        put_rests(w, scene);
    }
    if (scene->travel_count > 0) {
        put_travels(w, scene);
    }
    put_string_member(w, "\n    ", "primary", scene->primary_error);
    if (scene->rest_count > 0 || isfinite(scene->collapse_distance)) {
        put_number_member(w, ",\n    ", "collapse_distance", scene->collapse_distance);
    }
    put(w, "\n  }");
}

char *pl_scene_to_text(const pl_scene *scene)
{
    writer w = {.text = NULL};
    put(&w, "{\n  \"plumb_scene\": 1");
    if (scene->name[0] != '\0') {
        put_string_member(&w, ",\n  ", "name", scene->name);
    }
    put_vector_member(&w, ",\n  ", "gravity", scene->gravity, 3);
    put_number_member(&w, ",\n  ", "dt", scene->dt);
    put_number_member(&w, ",\n  ", "duration", scene->duration);
    if (scene->material_count > 0) {
        put_materials(&w, scene);
    }
    if (scene->pair_count > 0) {
        put_pairs(&w, scene);
    }
    put_bodies(&w, scene);
    put_expectations(&w, scene);
    put(&w, "\n}\n");
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
