#include "polyhedron_names.h"

#include "base/name_index.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How many bodies have each polyhedron, (polyhedron_count); NULL when out of memory. */
static int *count_uses(const pl_scene *scene, const pl_pointer_map *addresses)
{
    int *uses = calloc((size_t)scene->polyhedron_count + 1, sizeof *uses);
    for (int i = 0; i < scene->body_count && uses != NULL; i++) {
        const int index = pl_pointer_map_find(addresses, scene->bodies[i].shape.polyhedron);
        if (index >= 0) {
            uses[index]++;
        }
    }
    return uses;
}

/* Names the shared that have none yet; `taken` has the names of the others. */
static void name_shared(const int *uses, int count, const pl_name_index *taken,
                        char (*names)[PL_NAME_SIZE])
{
    int number = 0;
    for (int i = 0; i < count; i++) {
        if (names[i][0] != '\0' || uses[i] < 2) {
            continue;
        }
        char name[PL_NAME_SIZE];
        do {
            number++;
            snprintf(name, sizeof name, "polyhedron %d", number);
        } while (pl_name_index_find(taken, name) >= 0);
        memcpy(names[i], name, sizeof name);
    }
}

/* `names` and, in order, `taken` with the names that the polyhedra have themselves. */
static pl_status collect(const pl_scene *scene, char (*names)[PL_NAME_SIZE],
                         char (*own)[PL_NAME_SIZE], pl_name_index *taken)
{
    int count = 0;
    for (int i = 0; i < scene->polyhedron_count; i++) {
        memcpy(names[i], scene->polyhedra[i]->name, PL_NAME_SIZE);
        if (names[i][0] != '\0') {
            memcpy(own[count++], names[i], PL_NAME_SIZE);
        }
    }
    return pl_name_index_create(own[0], sizeof *own, count, taken);
}

pl_status pl_polyhedron_names_create(const pl_scene *scene, pl_polyhedron_names *names)
{
    const size_t count = (size_t)scene->polyhedron_count;
    pl_name_index taken = {.items = NULL};
    pl_status status = PL_NO_MEMORY;
    int *uses = NULL;
    char(*own)[PL_NAME_SIZE] = calloc(count + 1, sizeof *own);
    *names = (pl_polyhedron_names){.names = calloc(count + 1, sizeof *names->names)};
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
        pl_polyhedron_names_free(names);
    }
    pl_name_index_free(&taken);
    free(uses);
    free(own);
    return status;
}

void pl_polyhedron_names_free(pl_polyhedron_names *names)
{
    free(names->names);
    pl_pointer_map_free(&names->addresses);
    *names = (pl_polyhedron_names){.names = NULL};
}
