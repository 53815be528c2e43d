#include "mesh_file.h"

#include "obj.h"
#include "polyhedron.h"

#include <string.h>

/* The complaint of a mesh as an error at the line of the triangle that it is about. */
static pl_status fail_by(const pl_complaint *complaint, const pl_obj *obj, const char *path,
                         pl_error *error)
{
    const pl_path *place = &complaint->path;
    if (complaint->status != PL_BAD_INPUT) {
        return pl_fail(error, complaint->status, "%s: %s", path, complaint->text);
    }
    if (place->depth >= 2 && strcmp(place->steps[0].key, "triangles") == 0) {
        return pl_fail(error, PL_BAD_INPUT, "%s:%d: %s (numbers from 0)", path,
                       obj->lines[place->steps[1].index], complaint->text);
    }
    return pl_fail(error, PL_BAD_INPUT, "%s: %s", path, complaint->text);
}

pl_status pl_polyhedron_of_file(const char *path, pl_polyhedron **polyhedron, pl_error *error)
{
    pl_obj obj;
    pl_status status = pl_obj_read_file(path, &obj, error);
    if (status != PL_OK) {
        return status;
    }
    pl_complaint complaint = {.status = PL_OK};
    if (!pl_polyhedron_of_mesh((const double(*)[3])obj.vertices, obj.vertex_count,
                               (const int(*)[3])obj.triangles, obj.triangle_count, polyhedron,
                               &complaint)) {
        status = fail_by(&complaint, &obj, path, error);
    }
    pl_obj_free(&obj);
    return status;
}
