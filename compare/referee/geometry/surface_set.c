#include "surface_set.h"

#include <stdint.h>
#include <stdlib.h>

struct pl_surface_set {
    pl_surface **of_body; /* (body_count), shared by equal shapes */
    pl_surface **owned;   /* (owned_count) */
    int owned_count;
};

/* A body's shape, to be sorted. */
typedef struct item {
    const pl_shape *shape;
    int body;
} item;

static int compare_numbers(double a, double b)
{
    return (a > b) - (a < b);
}

/* 0 for shapes of one surface. */
static int compare_shapes(const pl_shape *a, const pl_shape *b)
{
    if (a->kind != b->kind) {
        return a->kind < b->kind ? -1 : 1;
    }
    uintptr_t p = (uintptr_t)a->polyhedron, q = (uintptr_t)b->polyhedron;
    int order = p != q ? (p < q ? -1 : 1) : compare_numbers(a->half_height, b->half_height);
    for (int k = 0; k < 3 && order == 0; ++k) {
        order = compare_numbers(a->half_extents[k], b->half_extents[k]);
    }
    return order;
}

static int compare_items(const void *left, const void *right)
{
    const item *a = left, *b = right;
    int order = compare_shapes(a->shape, b->shape);
    return order != 0 ? order : a->body - b->body;
}

static bool has_surface(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_BOX || shape->kind == PL_SHAPE_CAPSULE ||
           shape->kind == PL_SHAPE_HULL || shape->kind == PL_SHAPE_MESH;
}

static bool fill(pl_surface_set *set, const item *items, int count)
{
    for (int i = 0; i < count; ++i) {
        if (i == 0 || compare_shapes(items[i].shape, items[i - 1].shape) != 0) {
            pl_surface **made = &set->owned[set->owned_count];
            if (pl_surface_create(items[i].shape, made) != PL_OK) {
                return false;
            }
            set->owned_count += 1;
        }
        set->of_body[items[i].body] = set->owned[set->owned_count - 1];
    }
    return true;
}

pl_surface_set *pl_surface_set_create(const pl_scene *scene)
{
    size_t most = (size_t)scene->body_count + 1;
    pl_surface_set *set = calloc(1, sizeof *set);
    item *items = calloc(most, sizeof *items);
    int count = 0;
    bool any_mesh = false, complete = false;
    if (set == NULL || items == NULL) {
        goto cleanup;
    }
    set->of_body = calloc(most, sizeof(pl_surface *));
    set->owned = calloc(most, sizeof(pl_surface *));
    if (set->of_body == NULL || set->owned == NULL) {
        goto cleanup;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_shape *shape = &scene->bodies[i].shape;
        any_mesh = any_mesh || shape->kind == PL_SHAPE_MESH;
        if (has_surface(shape)) {
            items[count++] = (item){shape, i};
        }
    }
    if (any_mesh) {
        qsort(items, (size_t)count, sizeof *items, compare_items);
    }
    complete = !any_mesh || fill(set, items, count);

cleanup:
    free(items);
    if (!complete) {
        pl_surface_set_destroy(set);
        return NULL;
    }
    return set;
}

void pl_surface_set_destroy(pl_surface_set *set)
{
    if (set != NULL) {
        for (int i = 0; i < set->owned_count; ++i) {
            pl_surface_destroy(set->owned[i]);
        }
        free(set->of_body);
        free(set->owned);
        free(set);
    }
}

const pl_surface *pl_surface_set_of(const pl_surface_set *set, int body)
{
    return set->of_body[body];
}
