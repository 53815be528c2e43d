/* Scene to JSON, for people to edit: one object a line or two, in the order of the format, every
 * number in as few digits as read back to it. Where the table of fields says so, a value that a
 * reader would fill in by itself is left out when it is the same to the bit.
 *
 * Polyhedra that have a name, or that several bodies share, are written in "shapes", the others in
 * their body. All are written with their vertices: the text needs no other file. */
#include "base/hash.h"
#include "base/name_index.h"
#include "base/text_buffer.h"
#include "scene_fields.h"
#include "scene_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Names of polyhedra ---- */

typedef struct polyhedron_names {
    pl_pointer_map addresses;
    char (*names)[PL_NAME_SIZE]; /* (polyhedron_count); empty: it is written in its body, or, when
                                  * it has none, nowhere */
} polyhedron_names;

static void polyhedron_names_free(polyhedron_names *names)
{
    free(names->names);
    pl_pointer_map_free(&names->addresses);
    *names = (polyhedron_names){.names = NULL};
}

/* The number of bodies of each polyhedron, (polyhedron_count); NULL when out of memory. */
static int *count_uses(const pl_scene *scene, const pl_pointer_map *addresses)
{
    int *uses = calloc((size_t)scene->polyhedron_count + 1, sizeof *uses);
    for (int i = 0; i < scene->body_count && uses != NULL; ++i) {
        const int index = pl_pointer_map_find(addresses, scene->bodies[i].shape.polyhedron);
        if (index >= 0) {
            ++uses[index];
        }
    }
    return uses;
}

/* Names the shared polyhedra that have no name yet. `taken` has the names of the others. */
static void name_shared(const int *uses, int count, const pl_name_index *taken,
                        char (*names)[PL_NAME_SIZE])
{
    int number = 0;
    for (int i = 0; i < count; ++i) {
        if (names[i][0] != '\0' || uses[i] < 2) {
            continue;
        }
        char name[PL_NAME_SIZE];
        do {
            ++number;
            snprintf(name, sizeof name, "polyhedron %d", number);
        } while (pl_name_index_find(taken, name) >= 0);
        memcpy(names[i], name, sizeof name);
    }
}

/* Fills `names`, and `taken` in order, with the names that the polyhedra have themselves. */
static pl_status collect(const pl_scene *scene, char (*names)[PL_NAME_SIZE],
                         char (*own)[PL_NAME_SIZE], pl_name_index *taken)
{
    int count = 0;
    for (int i = 0; i < scene->polyhedron_count; ++i) {
        memcpy(names[i], scene->polyhedra[i]->name, PL_NAME_SIZE);
        if (names[i][0] != '\0') {
            memcpy(own[count++], names[i], PL_NAME_SIZE);
        }
    }
    return pl_name_index_create(own[0], sizeof *own, count, taken);
}

/* Each polyhedron's own name; or, where several bodies share one that has none, "polyhedron" and a
 * number that no other has. */
static pl_status polyhedron_names_create(const pl_scene *scene, polyhedron_names *names)
{
    const size_t count = (size_t)scene->polyhedron_count;
    pl_name_index taken = {.numbers = NULL};
    pl_status status = PL_NO_MEMORY;
    int *uses = NULL;
    char(*own)[PL_NAME_SIZE] = calloc(count + 1, sizeof *own);
    *names = (polyhedron_names){.names = calloc(count + 1, sizeof *names->names)};
    if (own == NULL || names->names == NULL ||
        pl_pointer_map_create(scene, &names->addresses) != PL_OK) {
        goto cleanup;
    }
    uses = count_uses(scene, &names->addresses);
    if (uses == NULL || collect(scene, names->names, own, &taken) != PL_OK) {
        goto cleanup;
    }
    name_shared(uses, scene->polyhedron_count, &taken, names->names);
    status = PL_OK;
cleanup:
    if (status != PL_OK) {
        polyhedron_names_free(names);
    }
    pl_name_index_free(&taken);
    free(uses);
    free(own);
    return status;
}

/* ---- Fields ---- */

typedef struct writer {
    pl_text_buffer json;
    bool is_hashed; /* then `hash` has taken the text up to the buffer's, which stays short */
    uint64_t hash;
    const pl_scene *scene;
    polyhedron_names names;
    int *order; /* (force_count): the numbers of the forces, by body and then as they come */
    int *first; /* (body_count + 1): order[first[b] .. first[b + 1]) are those of body b */
} writer;

static void put_object(writer *w, pl_object_kind kind, const void *object, int indent);

/* Moves the text so far into the hash, where that is all that is wanted. */
static void move_to_hash(writer *w)
{
    if (w->is_hashed && !w->json.failed && w->json.length > 0) {
        w->hash = pl_hash_text(w->hash, w->json.data);
        w->json.length = 0;
        w->json.data[0] = '\0';
    }
}

/* A comma and a line break with an indent. */
static void put_line(writer *w, const char *before, int indent)
{
    pl_text_add(&w->json, before);
    pl_text_add_bytes(&w->json, "\n", 1);
    pl_text_add_spaces(&w->json, indent);
}

/* Triples of numbers, some on a line. */
static void put_triples(pl_text_buffer *w, const double (*triples)[3], int count)
{
    enum { ON_A_LINE = 4 };
    for (int i = 0; i < count; ++i) {
        pl_text_add(w, i == 0 ? "[" : i % ON_A_LINE == 0 ? ",\n      " : ", ");
        pl_text_add_numbers(w, triples[i], 3);
    }
    pl_text_add(w, "]");
}

static void put_triangles(pl_text_buffer *w, const int (*triangles)[3], int count)
{
    enum { ON_A_LINE = 8 };
    for (int i = 0; i < count; ++i) {
        char text[48];
        snprintf(text, sizeof text, "[%d, %d, %d]", triangles[i][0], triangles[i][1],
                 triangles[i][2]);
        pl_text_add(w, i == 0 ? "[" : i % ON_A_LINE == 0 ? ",\n      " : ", ");
        pl_text_add(w, text);
    }
    pl_text_add(w, "]");
}

/* The name of one of the scene's shapes, or the shape itself. */
static void put_body_shape(writer *w, const pl_shape *shape, int indent)
{
    const int index = pl_pointer_map_find(&w->names.addresses, shape->polyhedron);
    if (index >= 0 && w->names.names[index][0] != '\0') {
        pl_text_add_json(&w->json, w->names.names[index]);
    } else {
        put_object(w, PL_OBJECT_PLANE + (pl_object_kind)shape->kind, shape, indent);
    }
}

static void put_shapes(writer *w, int indent)
{
    const char *before = "{";
    for (int i = 0; i < w->scene->polyhedron_count; ++i) {
        if (w->names.names[i][0] != '\0') {
            const pl_shape shape = pl_shape_of(w->scene->polyhedra[i]);
            put_line(w, before, indent + 2);
            pl_text_add_json_key(&w->json, w->names.names[i]);
            put_object(w, PL_OBJECT_PLANE + (pl_object_kind)shape.kind, &shape, indent + 2);
            before = ",";
        }
    }
    put_line(w, "", indent);
    pl_text_add(&w->json, "}");
}

static void put_items(writer *w, const pl_field *field, const void *object, int indent)
{
    const bool named = field->type == PL_FIELD_NAMED_ITEMS;
    int count;
    const char *items = pl_field_items(field, object, &count);
    pl_text_add(&w->json, named ? "{" : "[");
    for (int i = 0; i < count; ++i) {
        const char *item = items + (size_t)i * pl_objects[field->items].size;
        put_line(w, i == 0 ? "" : ",", indent + 2);
        if (named) {
            pl_text_add_json_key(&w->json, item); /* the struct begins with its name */
        }
        put_object(w, field->items, item, indent + 2);
        move_to_hash(w);
    }
    put_line(w, "", indent);
    pl_text_add(&w->json, named ? "}" : "]");
}

static void put_forces(writer *w, const pl_body *body, int indent)
{
    const int b = (int)(body - w->scene->bodies);
    pl_text_add(&w->json, "[");
    for (int i = w->first[b]; i < w->first[b + 1]; ++i) {
        put_line(w, i == w->first[b] ? "" : ",", indent + 2);
        put_object(w, PL_OBJECT_FORCE, &w->scene->forces[w->order[i]], indent + 2);
    }
    put_line(w, "", indent);
    pl_text_add(&w->json, "]");
}

/* Equal as bits: 0 and -0 differ. */
static bool same_bits(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

static size_t size_of(const pl_field *field)
{
    switch (field->type) {
    case PL_FIELD_NUMBER:
        return sizeof(double);
    case PL_FIELD_BOOL:
        return sizeof(bool);
    case PL_FIELD_WORD:
        return sizeof(int);
    case PL_FIELD_NAME:
        return 1; /* empty or not */
    default:
        return 3 * sizeof(double);
    }
}

static bool has_default(const pl_object *table, const pl_field *field, const void *value)
{
    const void *expected = pl_field_of(field, table->defaults);
    if (field->type == PL_FIELD_NUMBER && isnan(*(const double *)expected)) {
        return isnan(*(const double *)value);
    }
    return same_bits(value, expected, size_of(field));
}

/* Whether the field of `object` is written. */
static bool is_written(const writer *w, const pl_object *table, const pl_field *field,
                       const void *object)
{
    const void *value = pl_field_of(field, object);
    const pl_scene *scene = w->scene;
    int count = 0;
    if (field->applies != NULL && !field->applies(object)) {
        return false;
    }
    switch (field->type) {
    case PL_FIELD_DENSITY:
    case PL_FIELD_FILE:
    case PL_FIELD_PARAMETERS:
        return false;
    case PL_FIELD_INERTIA: {
        const pl_body *body = object;
        double inertia[3];
        pl_shape_inertia(&body->shape, body->mass, inertia);
        return !same_bits(value, inertia, sizeof inertia);
    }
    case PL_FIELD_ITEMS:
    case PL_FIELD_NAMED_ITEMS:
        pl_field_items(field, object, &count);
        return count > 0 || field->need == PL_NEED_ALWAYS;
    case PL_FIELD_FORCES:
        count = (int)((const pl_body *)object - scene->bodies);
        return w->first[count + 1] > w->first[count];
    case PL_FIELD_SHAPES:
        for (int i = 0; i < scene->polyhedron_count && count == 0; ++i) {
            count += w->names.names[i][0] != '\0' ? 1 : 0;
        }
        return count > 0;
    default:
        return !field->omit_default || !has_default(table, field, value);
    }
}

/* Whether an expectation has what version 1 does not know. */
static bool needs_version_2(const pl_scene *scene)
{
    bool any = scene->same_bits;
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        any = any || rest->tolerance > 0 || rest->orientation_tolerance > 0;
    }
    for (int i = 0; i < scene->travel_count; ++i) {
        any = any || scene->travels[i].tolerance > 0;
    }
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *value = &scene->values[i];
        any = any || value->tolerance > 0 || value->bound != PL_BOUND_EQUAL || value->number > 0 ||
              value->quantity >= PL_QUANTITY_TOP_SPEED;
    }
    for (int i = 0; i < scene->statistic_count; ++i) {
        any = any || scene->statistics[i].tolerance > 0;
    }
    return any;
}

static void put_value(writer *w, const pl_field *field, const void *object, int indent)
{
    pl_text_buffer *json = &w->json;
    const void *value = pl_field_of(field, object);
    switch (field->type) {
    case PL_FIELD_VERSION:
        pl_text_add(json, needs_version_2(object) ? "2" : "1");
        break;
    case PL_FIELD_NUMBER:
        pl_text_add_number(json, *(const double *)value);
        break;
    case PL_FIELD_VECTOR:
    case PL_FIELD_UNIT:
    case PL_FIELD_INERTIA:
        pl_text_add_numbers(json, value, 3);
        break;
    case PL_FIELD_QUATERNION:
        pl_text_add_numbers(json, value, 4);
        break;
    case PL_FIELD_BOOL:
        pl_text_add(json, *(const bool *)value ? "true" : "false");
        break;
    case PL_FIELD_NAME:
    case PL_FIELD_METRIC:
        pl_text_add_json(json, value);
        break;
    case PL_FIELD_WORD:
        pl_text_add_json(json, field->words[pl_field_index(field, object)]);
        break;
    case PL_FIELD_MATERIAL:
        pl_text_add_json(json, w->scene->materials[pl_field_index(field, object)].name);
        break;
    case PL_FIELD_BODY:
        pl_text_add_json(json, w->scene->bodies[pl_field_index(field, object)].name);
        break;
    case PL_FIELD_OBJECT:
        put_object(w, field->items, object, indent);
        break;
    case PL_FIELD_ITEMS:
    case PL_FIELD_NAMED_ITEMS:
        put_items(w, field, object, indent);
        break;
    case PL_FIELD_FORCES:
        put_forces(w, object, indent);
        break;
    case PL_FIELD_SHAPES:
        put_shapes(w, indent);
        break;
    case PL_FIELD_SHAPE:
        put_body_shape(w, value, indent);
        break;
    case PL_FIELD_TYPE:
        pl_text_add_json(json, pl_shape_names[((const pl_shape *)object)->kind]);
        break;
    case PL_FIELD_POINTS: {
        const pl_polyhedron *p = ((const pl_shape *)object)->polyhedron;
        put_triples(json, (const double(*)[3])p->vertices, p->vertex_count);
        break;
    }
    case PL_FIELD_TRIANGLES: {
        const pl_polyhedron *p = ((const pl_shape *)object)->polyhedron;
        put_triangles(json, (const int(*)[3])p->triangles, p->triangle_count);
        break;
    }
    default: /* nothing in C */
        break;
    }
}

/* Writes an object. Its lines after the first begin at `indent` + 2. */
static void put_object(writer *w, pl_object_kind kind, const void *object, int indent)
{
    const pl_object *table = &pl_objects[kind];
    const bool tall = table->fields[0].line > 0; /* each field on a line of its own */
    const char *before = "{";
    int line = 0;
    for (int i = 0; i < table->field_count; ++i) {
        const pl_field *field = &table->fields[i];
        if (!is_written(w, table, field, object)) {
            continue;
        }
        if (field->line != line) {
            put_line(w, before, indent + 2);
        } else {
            pl_text_add(&w->json, before);
            pl_text_add(&w->json, " ");
        }
        line = field->line;
        before = ",";
        pl_text_add_json_key(&w->json, field->key);
        put_value(w, field, object, indent + 2);
    }
    if (tall) {
        put_line(w, "", indent);
    }
    pl_text_add(&w->json, tall ? "}" : " }");
}

/* ---- Scenes ---- */

/* Sorts the forces by body: a counting sort. False when out of memory. */
static bool sort_forces(writer *w)
{
    const pl_scene *scene = w->scene;
    w->first = calloc((size_t)scene->body_count + 2, sizeof *w->first);
    w->order = calloc((size_t)scene->force_count + 1, sizeof *w->order);
    if (w->first == NULL || w->order == NULL) {
        return false;
    }
    int *next = w->first + 1; /* next[b] counts up from first[b] to first[b + 1] */
    for (int i = 0; i < scene->force_count; ++i) {
        next[scene->forces[i].body + 1]++;
    }
    for (int b = 0; b < scene->body_count; ++b) {
        next[b + 1] += next[b];
    }
    for (int i = 0; i < scene->force_count; ++i) {
        w->order[next[scene->forces[i].body]++] = i;
    }
    return true;
}

/* Writes the scene. False when out of memory; the text is the caller's in any case. */
static bool put_scene(writer *w)
{
    if (polyhedron_names_create(w->scene, &w->names) != PL_OK) {
        return false;
    }
    const bool sorted = sort_forces(w);
    if (sorted) {
        put_object(w, PL_OBJECT_SCENE, w->scene, 0);
        pl_text_add(&w->json, "\n");
        move_to_hash(w);
    }
    polyhedron_names_free(&w->names);
    free(w->order);
    free(w->first);
    return sorted && !w->json.failed;
}

char *pl_scene_to_text(const pl_scene *scene)
{
    writer w = {.scene = scene};
    if (!put_scene(&w)) {
        pl_text_free(&w.json);
    }
    return w.json.data;
}

pl_status pl_scene_hash(const pl_scene *scene, char hash[17], pl_error *error)
{
    writer w = {.scene = scene, .is_hashed = true, .hash = PL_HASH_START};
    const bool written = put_scene(&w);
    pl_text_free(&w.json);
    hash[0] = '\0';
    if (!written) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the text of a scene of %d bodies",
                       scene->body_count);
    }
    pl_hash_hex(w.hash, hash);
    return PL_OK;
}
