/* Reads and writes contact problems, and writes captures. */
#include "problem_file.h"

#include "base/json_field.h"
#include "base/json_text.h"
#include "results/store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Reading: the structure of the format; pe_contact_problem_is_valid checks the numbers ---- */

static const char *const problem_keys[] = {"schema", "source", "bodies", "manifolds"};
static const char *const body_keys[] = {"mass", "inertia", "free_velocity"};
static const char *const manifold_keys[] = {"a",     "b",     "friction", "frame",
                                            "arm_a", "arm_b", "points"};
static const char *const point_keys[] = {"offset", "bias", "slip", "impulse"};
static const pl_key_set problem_set = PL_KEY_SET("problem", problem_keys);
static const pl_key_set body_set = PL_KEY_SET("body", body_keys);
static const pl_key_set manifold_set = PL_KEY_SET("manifold", manifold_keys);
static const pl_key_set point_set = PL_KEY_SET("point", point_keys);

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
           pl_diagnose_field(diagnostic, "schema", "expected \"%s\", found %s", expected,
                             pl_quoted(schema, quoted));
}

static bool read_source(const json_t *json, reading *r, pl_diagnostic *diagnostic)
{
    json_t *source = json_object_get(json, "source");
    char found[PL_FOUND_SIZE];
    if (source != NULL && !json_is_object(source)) {
        return pl_diagnose_field(diagnostic, "source", "expected an object, found %s",
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
        return pl_diagnose_field(diagnostic, key, "expected the index of a body, found %g", value);
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

/* The arm of a static body has no meaning. */
static pl_presence presence_of_arm(int body)
{
    return body == PE_STATIC ? PL_OPTIONAL : PL_REQUIRED;
}

/* `first` and `count` are set already. */
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

/* Counts the points of all manifolds; each must be an object with at least one. */
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
            return pl_diagnose_field(diagnostic, "points",
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

/* The engine's own check, reported at the position in the file. */
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
    return pl_diagnose_field(diagnostic, fault.field, "%s", fault.text);
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
        return pl_diagnose_no_memory(diagnostic);
    }
    return read_bodies(bodies, r->problem, diagnostic) &&
           read_manifolds(manifolds, r->problem, diagnostic) &&
           check_problem(r->problem, diagnostic);
}

static const pl_json_kind problem_kind = {
    .noun = "contact problem", .most_bytes = PL_MAX_PROBLEM_BYTES, .read = read_problem};

static pl_status hand_over(pl_status status, const reading *r, pe_contact_problem **problem,
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
    return hand_over(pl_json_read_text(&problem_kind, text, length, label, &r, error), &r, problem,
                     source);
}

pl_status pl_problem_read_file(const char *path, pe_contact_problem **problem, json_t **source,
                               pl_error *error)
{
    reading r = {.problem = NULL};
    return hand_over(pl_json_read_file(&problem_kind, path, &r, error), &r, problem, source);
}

/* ---- Writing: one body or point per line ---- */

/* 17 significant digits are enough for any double (IEEE 754, 5.12.2). */
enum { EXACT = JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17) };

static json_t *vector(const double *values, int count)
{
    json_t *array = json_array();
    for (int k = 0; k < count; ++k) {
        json_array_append_new(array, json_real(values[k]));
    }
    return array;
}

/* Writes `json` and releases it. NULL fails, because it means that memory ran out. */
static bool put(FILE *stream, const char *before, json_t *json)
{
    fputs(before, stream);
    bool done = json != NULL && json_dumpf(json, stream, EXACT) == 0;
    json_decref(json);
    return done;
}

static bool put_body(FILE *stream, const char *before, const pe_problem_body *body)
{
    return put(stream, before,
               json_pack("{s:f, s:o, s:o}", "mass", body->mass, "inertia", vector(body->inertia, 6),
                         "free_velocity", vector(body->free_velocity, 6)));
}

static bool put_point(FILE *stream, const char *before, const pe_problem_manifold_point *point)
{
    return put(stream, before,
               json_pack("{s:o, s:f, s:o, s:o}", "offset", vector(point->offset, 3), "bias",
                         point->bias, "slip", vector(point->slip, 2), "impulse",
                         vector(point->impulse, 3)));
}

static bool put_manifold(FILE *stream, const char *before, const pe_problem_manifold *m,
                         const pe_problem_manifold_point *points)
{
    fprintf(stream, "%s{\"a\":%d,\"b\":%d", before, m->a, m->b);
    bool done = put(stream, ",\"friction\":", json_real(m->friction)) &&
                put(stream, ",\"frame\":", vector(m->frame[0], 9)) &&
                (m->a == PE_STATIC || put(stream, ",\"arm_a\":", vector(m->arm_a, 3))) &&
                (m->b == PE_STATIC || put(stream, ",\"arm_b\":", vector(m->arm_b, 3)));
    fputs(",\"points\":[", stream);
    for (int j = 0; j < m->count && done; ++j) {
        done = put_point(stream, j == 0 ? "\n  " : ",\n  ", &points[m->first + j]);
    }
    fputs("]}", stream);
    return done;
}

static bool put_problem(FILE *stream, const pe_contact_problem *problem, const json_t *source)
{
    bool done = true;
    fputs("{\"schema\":\"plumb.contact_problem/1\"", stream);
    if (source != NULL) {
        done = put(stream, ",\n\"source\":", json_incref((json_t *)source));
    }
    fputs(",\n\"bodies\":[", stream);
    for (int i = 0; i < problem->body_count && done; ++i) {
        done = put_body(stream, i == 0 ? "\n " : ",\n ", &problem->bodies[i]);
    }
    fputs("],\n\"manifolds\":[", stream);
    for (int i = 0; i < problem->manifold_count && done; ++i) {
        done =
            put_manifold(stream, i == 0 ? "\n " : ",\n ", &problem->manifolds[i], problem->points);
    }
    fputs("]}\n", stream);
    return done;
}

char *pl_problem_to_text(const pe_contact_problem *problem, const json_t *source)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (stream == NULL) {
        return NULL;
    }
    bool done = put_problem(stream, problem, source);
    if (fclose(stream) != 0 || !done) {
        free(text);
        return NULL;
    }
    return text;
}

pl_status pl_problem_write_file(const char *path, const pe_contact_problem *problem,
                                const json_t *source, pl_error *error)
{
    pe_problem_fault fault;
    if (!pe_contact_problem_is_valid(problem, &fault)) {
        return pl_fail(error, PL_FAILED, "%s: a contact problem that is none: %s[%d].%s: %s", path,
                       fault.list, fault.index, fault.field, fault.text);
    }
    char *text = pl_problem_to_text(problem, source);
    if (text == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path);
    }
    pl_status status = pl_write_text(path, text, strlen(text), error);
    free(text);
    return status;
}

bool pl_capture_parse(const char *text, long *step, const char **path)
{
    char *end;
    *step = strtol(text, &end, 10);
    if (end == text || *end != ':' || *step < 1 || end[1] == '\0') {
        return false;
    }
    *path = end + 1;
    return true;
}

int pl_capture_largest(pe_contact_problem *const *problems, int count)
{
    int largest = -1;
    for (int i = 0; i < count; ++i) {
        if (largest < 0 || problems[i]->point_count > problems[largest]->point_count) {
            largest = i;
        }
    }
    return largest;
}

char *pl_capture_path(const char *path, int number)
{
    const char *braces = path == NULL ? NULL : strstr(path, "{}");
    char *text = NULL;
    if (path == NULL) {
        return NULL;
    }
    return (braces == NULL
                ? asprintf(&text, "%s", path)
                : asprintf(&text, "%.*s%d%s", (int)(braces - path), path, number, braces + 2)) < 0
               ? NULL
               : text;
}

static pl_status write_island(const pl_capture_target *target, const char *path,
                              const pe_contact_problem *problem, int island, int islands,
                              pl_error *error)
{
    json_t *source = json_copy((json_t *)target->source);
    int failed = json_object_set_new(source, "step", json_integer(target->step));
    failed |= json_object_set_new(source, "island", json_integer(island));
    failed |= json_object_set_new(source, "islands", json_integer(islands));
    pl_status status = failed != 0 ? pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path)
                                   : pl_problem_write_file(path, problem, source, error);
    json_decref(source);
    return status;
}

pl_status pl_capture_write(void *user, pe_contact_problem **problems, int count, pl_error *error)
{
    const pl_capture_target *target = user;
    const char *braces = strstr(target->path, "{}");
    pl_status status = PL_OK;
    if (count == 0) {
        status =
            pl_fail(error, PL_FAILED, "nothing to capture: step %ld has no contact", target->step);
    } else if (braces == NULL) {
        int largest = pl_capture_largest(problems, count);
        status = write_island(target, target->path, problems[largest], largest + 1, count, error);
    }
    for (int i = 0; i < count && braces != NULL && status == PL_OK; ++i) {
        char *path = pl_capture_path(target->path, i + 1);
        status = path == NULL ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                              : write_island(target, path, problems[i], i + 1, count, error);
        free(path);
    }
    pe_contact_problems_destroy(problems, count);
    return status;
}
