/* Reads any bytes as an .obj file. They are accepted, or refused with the line of the fault.
 * Accepted data becomes a mesh or is refused with a reason, and so does the hull of its vertices. A
 * mesh or hull made again from its own vertices and triangles is the same. */
#include "fuzz.h"
#include "plumb/vec.h"
#include "scene/obj.h"
#include "scene/polyhedron.h"

#include <math.h>
#include <string.h>

static void check_same(const pl_polyhedron *a, const pl_polyhedron *b)
{
    fuzz_check(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count,
               "made again, it has the same counts");
    fuzz_check(memcmp(a->vertices, b->vertices, (size_t)a->vertex_count * sizeof *a->vertices) == 0,
               "made again, it has the same vertices");
    fuzz_check(
        memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * sizeof *a->triangles) == 0,
        "made again, it has the same triangles");
    fuzz_check(a->volume == b->volume && memcmp(a->inertia, b->inertia, sizeof a->inertia) == 0 &&
                   memcmp(a->axes, b->axes, sizeof a->axes) == 0,
               "made again, it has the same mass properties");
}

static void check_solid(const pl_polyhedron *p)
{
    double sum = 0, norm = 0;
    for (int k = 0; k < 3; ++k) {
        fuzz_check(p->inertia[k] > 0 && isfinite(p->inertia[k]), "inertia is positive");
        fuzz_check(isfinite(p->centre[k]), "the centre is finite");
        sum += p->inertia[k];
    }
    for (int k = 0; k < 3; ++k) {
        fuzz_check(p->inertia[k] <= (sum - p->inertia[k]) * (1 + 1e-9),
                   "no inertia is larger than the sum of the others");
    }
    for (int k = 0; k < 4; ++k) {
        norm += p->axes[k] * p->axes[k];
    }
    fuzz_check(fabs(norm - 1) < 1e-12, "the axes are a unit quaternion");
    fuzz_check(p->volume > 0 && p->radius > 0 && isfinite(p->radius), "it has a volume");
}

static void check_diagnostic(const pl_diagnostic *diagnostic)
{
    fuzz_check(diagnostic->status == PL_BAD_INPUT && strstr(diagnostic->text, "expected") != NULL &&
                   strstr(diagnostic->text, "found") != NULL,
               "a refusal names what was expected and what was found");
}

static void try_mesh(const pl_obj *obj)
{
    pl_polyhedron *mesh = NULL, *again = NULL;
    pl_diagnostic diagnostic = {.status = PL_OK};
    if (!pl_polyhedron_of_mesh((const double(*)[3])obj->vertices, obj->vertex_count,
                               (const int(*)[3])obj->triangles, obj->triangle_count, &mesh,
                               &diagnostic)) {
        check_diagnostic(&diagnostic);
        return;
    }
    check_solid(mesh);
    fuzz_check(pl_polyhedron_of_mesh((const double(*)[3])mesh->vertices, mesh->vertex_count,
                                     (const int(*)[3])mesh->triangles, mesh->triangle_count, &again,
                                     &diagnostic),
               "a mesh can be made again");
    check_same(mesh, again);
    pl_polyhedron_free(mesh);
    pl_polyhedron_free(again);
}

static void try_hull(const pl_obj *obj)
{
    pl_polyhedron *hull = NULL, *again = NULL;
    pl_diagnostic diagnostic = {.status = PL_OK};
    if (!pl_polyhedron_of_hull((const double(*)[3])obj->vertices, obj->vertex_count, &hull,
                               &diagnostic)) {
        check_diagnostic(&diagnostic);
        return;
    }
    check_solid(hull);
    fuzz_check(hull->triangle_count == 2 * hull->vertex_count - 4,
               "the triangles of a hull obey Euler's formula");
    fuzz_check(pl_polyhedron_of_hull((const double(*)[3])hull->vertices, hull->vertex_count, &again,
                                     &diagnostic),
               "a hull can be made again");
    check_same(hull, again);
    pl_polyhedron_free(hull);
    pl_polyhedron_free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pl_obj obj;
    pl_error error = {.message = ""};
    if (pl_obj_read_text((const char *)data, size, "input", &obj, &error) != PL_OK) {
        int line = 0;
        fuzz_check(sscanf(error.message, "input:%d: expected", &line) == 1 && line >= 1,
                   "a refusal has a line");
        fuzz_check(strstr(error.message, "found") != NULL, "a refusal names what was found");
        return 0;
    }
    try_mesh(&obj);
    try_hull(&obj);
    pl_obj_free(&obj);
    return 0;
}
