/* Polyhedra of a scene made by code. */
#include "polyhedron.h"
#include "scene_array.h"

#include <stdio.h>
#include <string.h>

/* The diagnostic as an error, with the path of what is wrong. */
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
