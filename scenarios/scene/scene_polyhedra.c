/* Polyhedra of a scene: adding those made by code, and finding one by its address. */
#include "scene_internal.h"
#include "solids/polyhedron.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The diagnostic as an error, with the path of the fault. */
static pl_status fail_by(const pl_diagnostic *diagnostic, const char *kind, pl_error *error)
{
    if (diagnostic->status != PL_BAD_INPUT) {
        return pl_fail(error, diagnostic->status, "%s", diagnostic->text);
    }
    char path[128];
    pl_path_text(&diagnostic->path, kind, path, sizeof path);
    return pl_fail(error, diagnostic->status, "%s: %s: %s", kind, path, diagnostic->text);
}

/* The scene takes the polyhedron, or it is freed. */
static pl_status take(pl_scene *scene, const char *name, pl_polyhedron *made,
                      const pl_polyhedron **polyhedron, pl_error *error)
{
    if (name != NULL && strlen(name) >= sizeof made->name) {
        pl_polyhedron_free(made);
        return pl_fail(error, PL_BAD_INPUT, "name: expected at most %d bytes, found %zu",
                       PL_NAME_SIZE - 1, strlen(name));
    }
    snprintf(made->name, sizeof made->name, "%s", name != NULL ? name : "");
    pl_status status = pl_scene_add_polyhedron(scene, made, error);
    if (status != PL_OK) {
        pl_polyhedron_free(made);
    } else if (polyhedron != NULL) {
        *polyhedron = made;
    }
    return status;
}

pl_status pl_scene_add_hull(pl_scene *scene, const char *name, const double (*points)[3], int count,
                            const pl_polyhedron **polyhedron, pl_error *error)
{
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_polyhedron *made = NULL;
    if (!pl_polyhedron_of_hull(points, count, &made, &diagnostic)) {
        return fail_by(&diagnostic, "hull", error);
    }
    return take(scene, name, made, polyhedron, error);
}

pl_status pl_scene_add_mesh(pl_scene *scene, const char *name, const double (*vertices)[3],
                            int vertex_count, const int (*triangles)[3], int triangle_count,
                            const pl_polyhedron **polyhedron, pl_error *error)
{
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_polyhedron *made = NULL;
    if (!pl_polyhedron_of_mesh(vertices, vertex_count, triangles, triangle_count, &made,
                               &diagnostic)) {
        return fail_by(&diagnostic, "mesh", error);
    }
    return take(scene, name, made, polyhedron, error);
}

static int by_address(const void *left, const void *right)
{
    const pl_addressed *a = left, *b = right;
    return (a->address > b->address) - (a->address < b->address);
}

pl_status pl_pointer_map_create(const pl_scene *scene, pl_pointer_map *map)
{
    *map = (pl_pointer_map){.items = NULL};
    if (scene->polyhedron_count == 0) {
        return PL_OK;
    }
    const size_t count = (size_t)scene->polyhedron_count;
    map->items = malloc(count * sizeof *map->items);
    if (map->items == NULL) {
        return PL_NO_MEMORY;
    }
    map->count = scene->polyhedron_count;
    for (int i = 0; i < map->count; ++i) {
        map->items[i] = (pl_addressed){(uintptr_t)scene->polyhedra[i], i};
    }
    qsort(map->items, count, sizeof *map->items, by_address);
    return PL_OK;
}

void pl_pointer_map_free(pl_pointer_map *map)
{
    free(map->items);
    *map = (pl_pointer_map){.items = NULL};
}

int pl_pointer_map_find(const pl_pointer_map *map, const pl_polyhedron *polyhedron)
{
    if (map->count == 0) {
        return -1;
    }
    const pl_addressed key = {.address = (uintptr_t)polyhedron};
    const pl_addressed *found =
        bsearch(&key, map->items, (size_t)map->count, sizeof key, by_address);
    return found != NULL ? found->index : -1;
}
