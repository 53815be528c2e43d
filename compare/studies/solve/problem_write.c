/* Contact problem to JSON: a body or a point a line. */
#include "problem_file.h"

#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* Writes `json` and drops it; NULL, which stands for a lack of memory, fails. */
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

pl_status pl_engine_error(pe_status status, const pe_error *from, pl_error *error)
{
    return status == PE_OK ? PL_OK
                           : pl_fail(error, status == PE_NO_MEMORY ? PL_NO_MEMORY : PL_FAILED, "%s",
                                     from->message);
}
