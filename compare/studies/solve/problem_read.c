/* JSON to contact problem: the structure of the format. What must hold of the numbers is
 * pe_contact_problem_is_valid's to say. */
#include "problem_file.h"

#include "base/json_field.h"
#include "base/json_text.h"

#include <math.h>
#include <string.h>

#define KEY_SET(name, array)                                                                       \
    {                                                                                              \
        .object = name, .keys = array, .count = sizeof array / sizeof array[0]                     \
    }

static const char *const problem_keys[] = {"schema", "source", "bodies", "manifolds"};
static const char *const body_keys[] = {"mass", "inertia", "free_velocity"};
static const char *const manifold_keys[] = {"a",     "b",     "friction", "frame",
                                            "arm_a", "arm_b", "points"};
static const char *const point_keys[] = {"offset", "bias", "slip", "impulse"};
static const pl_key_set problem_set = KEY_SET("problem", problem_keys);
static const pl_key_set body_set = KEY_SET("body", body_keys);
static const pl_key_set manifold_set = KEY_SET("manifold", manifold_keys);
static const pl_key_set point_set = KEY_SET("point", point_keys);

typedef struct reading {
    pe_contact_problem *problem;
    json_t *source;
} reading;

static bool read_schema(const json_t *json, pl_diagnostic *diagnostic)
{
    static const char expected[] = "plumb.contact_problem/1";
    const char *schema = NULL;
    char quoted[PL_QUOTED_SIZE];
    if (!pl_json_string(json, "schema", PL_REQUIRED, "\"plumb.contact_problem/1\"", &schema,
                        diagnostic)) {
        return false;
    }
    return strcmp(schema, expected) == 0 ||
           pl_complain_of(diagnostic, "schema", "expected \"%s\", found %s", expected,
                          pl_quoted(schema, quoted));
}

static bool read_source(const json_t *json, reading *r, pl_diagnostic *diagnostic)
{
    json_t *source = json_object_get(json, "source");
    char found[PL_FOUND_SIZE];
    if (source != NULL && !json_is_object(source)) {
        return pl_complain_of(diagnostic, "source", "expected an object, found %s",
                              pl_json_found(source, found));
    }
    r->source = json_incref(source);
    return true;
}

static bool read_index(const json_t *json, const char *key, int *index, pl_diagnostic *diagnostic)
{
    double value = 0;
    if (!pl_json_number(json, key, PL_REQUIRED, &value, diagnostic)) {
        return false;
    }
    if (value != floor(value) || fabs(value) > 1e9) {
        return pl_complain_of(diagnostic, key, "expected the index of a body, found %g", value);
    }
    *index = (int)value;
    return true;
}

static bool read_body(const json_t *json, pe_problem_body *body, pl_diagnostic *diagnostic)
{
    return pl_json_object(json, &body_set, diagnostic) &&
           pl_json_number(json, "mass", PL_REQUIRED, &body->mass, diagnostic) &&
           pl_json_vector(json, "inertia", PL_REQUIRED, body->inertia, 6, diagnostic) &&
           pl_json_vector(json, "free_velocity", PL_REQUIRED, body->free_velocity, 6, diagnostic);
}

static bool read_point(const json_t *json, pe_problem_manifold_point *point,
                       pl_diagnostic *diagnostic)
{
    return pl_json_object(json, &point_set, diagnostic) &&
           pl_json_vector(json, "offset", PL_REQUIRED, point->offset, 3, diagnostic) &&
           pl_json_number(json, "bias", PL_REQUIRED, &point->bias, diagnostic) &&
           pl_json_vector(json, "slip", PL_OPTIONAL, point->slip, 2, diagnostic) &&
           pl_json_vector(json, "impulse", PL_OPTIONAL, point->impulse, 3, diagnostic);
}

static bool read_points(const json_t *json, const pe_problem_manifold *m,
                        pe_problem_manifold_point *points, pl_diagnostic *diagnostic)
{
    const json_t *array = json_object_get(json, "points");
    pl_path_push_key(&diagnostic->path, "points");
    for (int j = 0; j < m->count; ++j) {
        pl_path_push_index(&diagnostic->path, j);
        if (!read_point(json_array_get(array, (size_t)j), &points[m->first + j], diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* An arm has no meaning where nothing moves. */
static pl_presence presence_of_arm(int body)
{
    return body == PE_STATIC ? PL_OPTIONAL : PL_REQUIRED;
}

/* `first` and `count` are there already. */
static bool read_manifold(const json_t *json, pe_problem_manifold *m,
                          pe_problem_manifold_point *points, pl_diagnostic *diagnostic)
{
    return read_index(json, "a", &m->a, diagnostic) && read_index(json, "b", &m->b, diagnostic) &&
           pl_json_number(json, "friction", PL_REQUIRED, &m->friction, diagnostic) &&
           pl_json_vector(json, "frame", PL_REQUIRED, m->frame[0], 9, diagnostic) &&
           pl_json_vector(json, "arm_a", presence_of_arm(m->a), m->arm_a, 3, diagnostic) &&
           pl_json_vector(json, "arm_b", presence_of_arm(m->b), m->arm_b, 3, diagnostic) &&
           read_points(json, m, points, diagnostic);
}

/* How many points all manifolds have; each must be an object with some. */
static bool count_points(const json_t *manifolds, int *count, pl_diagnostic *diagnostic)
{
    size_t i;
    json_t *manifold;
    *count = 0;
    pl_path_push_key(&diagnostic->path, "manifolds");
    json_array_foreach((json_t *)manifolds, i, manifold)
    {
        const json_t *points;
        pl_path_push_index(&diagnostic->path, (int)i);
        if (!pl_json_object(manifold, &manifold_set, diagnostic) ||
            !pl_json_array(manifold, "points", PL_REQUIRED, &points, diagnostic)) {
            return false;
        }
        if (json_array_size(points) == 0) {
            return pl_complain_of(diagnostic, "points",
                                  "expected at least one point, found an array of 0");
        }
        *count += (int)json_array_size(points);
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_bodies(const json_t *bodies, pe_contact_problem *problem,
                        pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "bodies");
    for (int i = 0; i < problem->body_count; ++i) {
        pl_path_push_index(&diagnostic->path, i);
        if (!read_body(json_array_get(bodies, (size_t)i), &problem->bodies[i], diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool read_manifolds(const json_t *manifolds, pe_contact_problem *problem,
                           pl_diagnostic *diagnostic)
{
    int first = 0;
    pl_path_push_key(&diagnostic->path, "manifolds");
    for (int i = 0; i < problem->manifold_count; ++i) {
        const json_t *json = json_array_get(manifolds, (size_t)i);
        pe_problem_manifold *m = &problem->manifolds[i];
        pl_path_push_index(&diagnostic->path, i);
        m->first = first;
        m->count = (int)json_array_size(json_object_get(json, "points"));
        first += m->count;
        if (!read_manifold(json, m, problem->points, diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* The engine's own judgement, at the place in the file. */
static bool check_problem(const pe_contact_problem *problem, pl_diagnostic *diagnostic)
{
    pe_problem_fault fault;
    if (pe_contact_problem_is_valid(problem, &fault)) {
        return true;
    }
    int index = fault.index;
    if (strcmp(fault.list, "points") == 0) {
        int i = 0;
        while (problem->manifolds[i].first + problem->manifolds[i].count <= index) {
            ++i;
        }
        pl_path_push_key(&diagnostic->path, "manifolds");
        pl_path_push_index(&diagnostic->path, i);
        index -= problem->manifolds[i].first;
    }
    pl_path_push_key(&diagnostic->path, fault.list);
    pl_path_push_index(&diagnostic->path, index);
    return pl_complain_of(diagnostic, fault.field, "%s", fault.text);
}

static bool read_problem(const json_t *json, void *user, pl_diagnostic *diagnostic)
{
    reading *r = user;
    const json_t *bodies, *manifolds;
    int points;
    if (!pl_json_object(json, &problem_set, diagnostic) || !read_schema(json, diagnostic) ||
        !read_source(json, r, diagnostic) ||
        !pl_json_array(json, "bodies", PL_REQUIRED, &bodies, diagnostic) ||
        !pl_json_array(json, "manifolds", PL_REQUIRED, &manifolds, diagnostic) ||
        !count_points(manifolds, &points, diagnostic)) {
        return false;
    }
    if (pe_contact_problem_create((int)json_array_size(bodies), (int)json_array_size(manifolds),
                                  points, NULL, &r->problem, NULL) != PE_OK) {
        return pl_complain_no_memory(diagnostic);
    }
    return read_bodies(bodies, r->problem, diagnostic) &&
           read_manifolds(manifolds, r->problem, diagnostic) &&
           check_problem(r->problem, diagnostic);
}

static const pl_json_kind problem_kind = {
    .noun = "contact problem", .most_bytes = PL_MAX_PROBLEM_BYTES, .read = read_problem};

static pl_status keep(pl_status status, const reading *r, pe_contact_problem **problem,
                      json_t **source)
{
    if (status == PL_OK) {
        *problem = r->problem;
        *source = r->source;
    } else {
        pe_contact_problem_destroy(r->problem);
        json_decref(r->source);
    }
    return status;
}

pl_status pl_problem_read_text(const char *text, size_t length, const char *label,
                               pe_contact_problem **problem, json_t **source, pl_error *error)
{
    reading r = {.problem = NULL};
    return keep(pl_json_read_text(&problem_kind, text, length, label, &r, error), &r, problem,
                source);
}

pl_status pl_problem_read_file(const char *path, pe_contact_problem **problem, json_t **source,
                               pl_error *error)
{
    reading r = {.problem = NULL};
    return keep(pl_json_read_file(&problem_kind, path, &r, error), &r, problem, source);
}
