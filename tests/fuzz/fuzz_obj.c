/* Reads any bytes as an .obj file. They are accepted, or refused with the line of the fault.
 * Accepted data becomes a mesh or is refused with a reason, in every order of its vertices and
 * triangles alike, and so does the hull of its vertices. A mesh or hull made again from its own
 * vertices and triangles, or from a file or a scene that it was written to, is the same. The
 * engine takes it. */
#include "base/random.h"
#include "base/text_buffer.h"
#include "fuzz.h"
#include "plumb/engine.h"
#include "plumb/vec.h"
#include "solids/obj.h"
#include "solids/polyhedron.h"

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

static pl_polyhedron *make_mesh(const pl_obj *obj, pl_diagnostic *diagnostic)
{
    pl_polyhedron *mesh = NULL;
    pl_polyhedron_of_mesh((const double(*)[3])obj->vertices, obj->vertex_count,
                          (const int(*)[3])obj->triangles, obj->triangle_count, &mesh, diagnostic);
    return mesh;
}

/* Fills `order` with the numbers below `count` in any order. */
static void shuffle(int *order, int count, pl_random *random)
{
    for (int i = 0; i < count; ++i) {
        const int k = (int)(pl_random_unit(random) * (i + 1)) % (i + 1);
        order[i] = order[k];
        order[k] = i;
    }
}

/* The same surface with vertices, triangles and corners in another order. */
static void check_order(const pl_obj *obj, const pl_polyhedron *mesh)
{
    pl_random random = {.state = (uint64_t)obj->vertex_count};
    const size_t vertices = (size_t)obj->vertex_count, triangles = (size_t)obj->triangle_count;
    pl_obj other = {.vertices = malloc(vertices * sizeof *other.vertices),
                    .triangles = malloc(triangles * sizeof *other.triangles),
                    .vertex_count = obj->vertex_count,
                    .triangle_count = obj->triangle_count};
    int *place = malloc(vertices * sizeof *place), *order = malloc(triangles * sizeof *order);
    fuzz_check(other.vertices && other.triangles && place && order, "there is memory");
    shuffle(place, obj->vertex_count, &random);
    shuffle(order, obj->triangle_count, &random);
    for (int i = 0; i < obj->vertex_count; ++i) {
        memcpy(other.vertices[place[i]], obj->vertices[i], sizeof obj->vertices[i]);
    }
    for (int t = 0; t < obj->triangle_count; ++t) {
        const int first = order[t] % 3, step = 1 + order[t] / 3 % 2; /* turned, or turned round */
        for (int k = 0; k < 3; ++k) {
            other.triangles[order[t]][k] = place[obj->triangles[t][(first + step * k) % 3]];
        }
    }
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_polyhedron *made = make_mesh(&other, &diagnostic);
    fuzz_check((made != NULL) == (mesh != NULL), "it is accepted in every order or in none");
    fuzz_check(made == NULL || fabs(made->volume - mesh->volume) <= 1e-8 * mesh->volume,
               "it has the same volume in every order");
    pl_polyhedron_free(made);
    pl_obj_free(&other);
    free(place);
    free(order);
}

static void check_written_file(const pl_polyhedron *mesh)
{
    pl_text_buffer text = {0};
    for (int i = 0; i < mesh->vertex_count; ++i) {
        const double *v = mesh->vertices[i];
        pl_text_format(&text, "v %.17g %.17g %.17g\n", v[0], v[1], v[2]);
    }
    for (int t = 0; t < mesh->triangle_count; ++t) {
        const int *c = mesh->triangles[t];
        pl_text_format(&text, "f %d %d %d\n", c[0] + 1, c[1] + 1, c[2] + 1);
    }
    pl_obj obj;
    pl_diagnostic diagnostic = {.status = PL_OK};
    fuzz_check(pl_obj_read_text(text.data, text.length, "written", &obj, NULL) == PL_OK,
               "a written file can be read");
    pl_polyhedron *again = make_mesh(&obj, &diagnostic);
    fuzz_check(again != NULL, "a mesh can be made of a written file");
    check_same(mesh, again);
    pl_polyhedron_free(again);
    pl_obj_free(&obj);
    pl_text_free(&text);
}

static void check_written_scene(const pl_polyhedron *mesh)
{
    pl_scene scene = pl_scene_default(), read;
    const pl_polyhedron *added = NULL;
    fuzz_check(pl_scene_add_mesh(&scene, "mesh", (const double(*)[3])mesh->vertices,
                                 mesh->vertex_count, (const int(*)[3])mesh->triangles,
                                 mesh->triangle_count, &added, NULL) == PL_OK,
               "a scene takes the mesh");
    pl_body body = pl_body_default();
    memcpy(body.name, "body", sizeof "body");
    body.shape = pl_shape_of(added);
    body.is_static = true;
    const pl_material material = {.name = "default", .friction = 0.5};
    fuzz_check(pl_scene_add_material(&scene, &material, NULL, NULL) == PL_OK &&
                   pl_scene_add_body(&scene, &body, NULL, NULL) == PL_OK &&
                   pl_scene_validate(&scene, NULL) == PL_OK,
               "a scene takes the body");
    char *text = pl_scene_to_text(&scene);
    fuzz_check(text != NULL &&
                   pl_scene_read_text(text, strlen(text), "scene", &read, NULL) == PL_OK,
               "a written scene can be read");
    check_same(mesh, read.polyhedra[0]);
    free(text);
    pl_scene_free(&scene);
    pl_scene_free(&read);
}

/* The engine takes lengths up to 1e12 m, no triangles that are all but a line, and no volume that is
 * lost in the rounding of what it is summed from. */
static bool is_for_engine(const pl_polyhedron *p)
{
    bool fits = p->inertia[0] > 1e-12 && p->inertia[1] > 1e-12 && p->inertia[2] > 1e-12;
    double products = 0;
    for (int i = 0; i < 3 * p->vertex_count; ++i) {
        fits = fits && fabs(p->vertices[i / 3][i % 3]) <= 1e12;
    }
    for (int t = 0; t < p->triangle_count && fits; ++t) {
        const pl_vec a = pl_vec_of(p->vertices[p->triangles[t][0]]);
        const pl_vec u = pl_vec_sub(pl_vec_of(p->vertices[p->triangles[t][1]]), a);
        const pl_vec v = pl_vec_sub(pl_vec_of(p->vertices[p->triangles[t][2]]), a);
        const pl_vec w = pl_vec_sub(v, u);
        const double longest = fmax(pl_vec_dot(u, u), fmax(pl_vec_dot(v, v), pl_vec_dot(w, w)));
        fits = pl_vec_length(pl_vec_cross(u, v)) > 1e-11 * longest;
        /* No corner is further from the middle of the bounds than twice the radius. */
        products += 8 * p->radius * p->radius * p->radius +
                    pl_vec_length(a) * pl_vec_length(pl_vec_cross(u, v));
    }
    return fits && p->volume > 1e-14 * products;
}

static void check_engine(const pl_polyhedron *p)
{
    pe_world *world = NULL;
    pe_world_def world_def = pe_world_def_default();
    fuzz_check(pe_world_create(&world_def, &world, NULL) == PE_OK, "there is a world");
    pe_vec3 *vertices = malloc((size_t)p->vertex_count * sizeof *vertices);
    fuzz_check(vertices != NULL, "there is memory");
    for (int i = 0; i < p->vertex_count; ++i) {
        vertices[i] = (pe_vec3){p->vertices[i][0], p->vertices[i][1], p->vertices[i][2]};
    }
    const pe_geometry_def def = {.vertices = vertices,
                                 .triangles = (const uint32_t(*)[3])(const void *)p->triangles,
                                 .vertex_count = p->vertex_count,
                                 .triangle_count = p->triangle_count,
                                 .convex = p->convex};
    pe_geometry_id id;
    pe_error error = {.message = ""};
    const pe_status status = pe_geometry_create(world, &def, &id, &error);
    if (status != PE_OK && is_for_engine(p)) {
        fprintf(stderr, "%s\n", error.message);
        fuzz_check(false, "the engine takes it");
    }
    free(vertices);
    pe_world_destroy(world);
}

static void try_mesh(const pl_obj *obj)
{
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_polyhedron *mesh = make_mesh(obj, &diagnostic);
    check_order(obj, mesh);
    if (mesh == NULL) {
        check_diagnostic(&diagnostic);
        return;
    }
    check_solid(mesh);
    check_written_file(mesh);
    check_written_scene(mesh);
    check_engine(mesh);
    pl_polyhedron_free(mesh);
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
