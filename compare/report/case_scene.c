#include "page_data.h"

#include "base/heap.h"
#include "plumb/vec.h"
#include "results/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Builds the scene with the parameters of the case, for a file also with the run's step and
 * duration. One without a number has its default, and the hash shows whether that has changed. */
static pl_status build(const pl_result_case *test_case, const pl_scenario *scenario,
                       pl_scene *scene, pl_error *error)
{
    double values[PL_MAX_PARAMS];
    pl_text_buffer text = {0};
    const json_t *params = test_case->row->params;
    for (int i = 0; i < scenario->param_count; ++i) {
        const char *name = scenario->params[i].name;
        const bool is_time = strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0;
        const bool is_run = scenario->file != NULL && is_time;
        const json_t *from = is_run ? json_object_get(test_case->row->result, "settings") : params;
        const json_t *value = json_object_get(from, name);
        if (json_is_number(value)) {
            pl_text_format(&text, "%s%s=%.17g", text.length > 0 ? "," : "", name,
                           json_number_value(value));
        }
    }
    char *settings = pl_text_take(&text);
    const char *const items[] = {settings};
    pl_status status =
        pl_scenario_values(scenario, items, settings[0] == '\0' ? 0 : 1, values, error);
    free(settings);
    return status != PL_OK
               ? status
               : pl_scenario_build(scenario, values, (uint64_t)test_case->row->seed, scene, error);
}

static pl_status build_from_file(const pl_result_case *test_case, pl_scene *scene, pl_error *error)
{
    struct stat information;
    pl_scenario *scenario = NULL;
    if (stat(test_case->row->scenario, &information) != 0 || !S_ISREG(information.st_mode)) {
        return pl_fail(error, PL_IO, "there is no scene file %.200s here",
                       test_case->row->scenario);
    }
    pl_status status = pl_scenario_open_file(test_case->row->scenario, &scenario, error);
    if (status == PL_OK) {
        status = build(test_case, scenario, scene, error);
    }
    pl_scenario_close_file(scenario);
    return status;
}

pl_status pl_case_scene_build(const pl_result_case *test_case, pl_scene *scene, pl_error *error)
{
    *scene = pl_scene_default();
    char hash[17] = "";
    pl_status status = test_case->row->catalogue != NULL
                           ? build(test_case, test_case->row->catalogue, scene, error)
                           : build_from_file(test_case, scene, error);
    if (status == PL_OK) {
        status = pl_scene_hash(scene, hash, error);
    }
    if (status == PL_OK && strcmp(hash, test_case->row->scene_hash) != 0) {
        status = pl_fail(error, PL_FAILED,
                         "the scene as it is built today (%s) is not the one that was run (%.40s)",
                         hash, test_case->row->scene_hash);
    }
    return status;
}

/* ---- JSON ---- */

json_t *pl_rounded_json(double value)
{
    char text[32];
    snprintf(text, sizeof text, "%.6g", value);
    return pl_json_number_or_null(strtod(text, NULL));
}

static json_t *numbers(const double *values, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(array, pl_rounded_json(values[i]));
    }
    return array;
}

/* A box has its half extents, round shapes their radius and half height, a plane its normal and
 * offset, a hull or mesh its place in "polyhedra". */
static json_t *shape_json(const pl_scene *scene, const pl_shape *shape)
{
    static const char *const names[PL_SHAPE_KIND_COUNT] = {"plane",    "sphere", "box", "capsule",
                                                           "cylinder", "hull",   "mesh"};
    const double round[2] = {shape->radius, shape->half_height};
    const double plane[4] = {shape->normal[0], shape->normal[1], shape->normal[2], shape->offset};
    json_t *size = NULL;
    int place = 0;
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        size = numbers(plane, 4);
        break;
    case PL_SHAPE_BOX:
        size = numbers(shape->half_extents, 3);
        break;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        while (place + 1 < scene->polyhedron_count &&
               scene->polyhedra[place] != shape->polyhedron) {
            ++place;
        }
        size = json_integer(place);
        break;
    default:
        size = numbers(round, 2);
        break;
    }
    return json_pack("[s, o]", names[shape->kind], size);
}

static json_t *polyhedron_json(const pl_polyhedron *solid)
{
    json_t *triangles = json_array();
    for (int i = 0; i < 3 * solid->triangle_count; ++i) {
        json_array_append_new(triangles, json_integer(solid->triangles[i / 3][i % 3]));
    }
    return json_pack("{s:o, s:o}", "vertices",
                     numbers(&solid->vertices[0][0], 3 * solid->vertex_count), "triangles",
                     triangles);
}

json_t *pl_case_scene_json(const pl_scene *scene)
{
    json_t *bodies = json_array(), *polyhedra = json_array(), *rests = json_array();
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        json_array_append_new(
            bodies,
            json_pack("{s:o, s:b, s:o, s:o, s:o}", "name", pl_json_text(body->name), "static",
                      (int)body->is_static, "shape", shape_json(scene, &body->shape), "at",
                      numbers(body->position, 3), "turn", numbers(body->orientation, 4)));
    }
    for (int i = 0; i < scene->polyhedron_count; ++i) {
        json_array_append_new(polyhedra, polyhedron_json(scene->polyhedra[i]));
    }
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        json_array_append_new(
            rests,
            json_pack("{s:i, s:o, s:o}", "body", rest->body, "at", numbers(rest->position, 3),
                      "turn", rest->has_orientation ? numbers(rest->orientation, 4) : json_null()));
    }
    return json_pack("{s:o, s:o, s:o, s:o, s:f, s:f}", "gravity", numbers(scene->gravity, 3),
                     "bodies", bodies, "polyhedra", polyhedra, "rests", rests, "dt", scene->dt,
                     "duration", scene->duration);
}
