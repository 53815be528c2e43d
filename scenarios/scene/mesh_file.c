#include "mesh_file.h"

#include "obj.h"
#include "polyhedron.h"

#include <string.h>

/* The diagnostic of a mesh as an error at the line of the triangle that it is about. */
static pl_status fail_by(const pl_diagnostic *diagnostic, const pl_obj *obj, const char *path,
                         pl_error *error)
{
    const pl_path *place = &diagnostic->path;
    if (diagnostic->status != PL_BAD_INPUT) {
        return pl_fail(error, diagnostic->status, "%s: %s", path, diagnostic->text);
    }
    if (place->depth >= 2 && strcmp(place->steps[0].key, "triangles") == 0) {
        return pl_fail(error, PL_BAD_INPUT, "%s:%d: %s (numbers from 0)", path,
                       obj->lines[place->steps[1].index], diagnostic->text);
    }
    return pl_fail(error, PL_BAD_INPUT, "%s: %s", path, diagnostic->text);
}

pl_status pl_polyhedron_of_file(const char *path, pl_polyhedron **polyhedron, pl_error *error)
{
    pl_obj obj;
    pl_status status = pl_obj_read_file(path, &obj, error);
    if (status != PL_OK) {
        return status;
    }
    pl_diagnostic diagnostic = {.status = PL_OK};
    if (!pl_polyhedron_of_mesh((const double(*)[3])obj.vertices, obj.vertex_count,
                               (const int(*)[3])obj.triangles, obj.triangle_count, polyhedron,
                               &diagnostic)) {
        status = fail_by(&diagnostic, &obj, path, error);
    }
    pl_obj_free(&obj);
    return status;
}
