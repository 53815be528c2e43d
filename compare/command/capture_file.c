/* Writes contact problems, one body or point per line. */
#include "capture_file.h"

#include "base/heap.h"
#include "results/store.h"

#include <stdlib.h>
#include <string.h>

static json_t *vector(const double *values, int count)
{
    json_t *array = json_array();
    for (int k = 0; k < count; ++k) {
        json_array_append_new(array, json_real(values[k]));
    }
    return array;
}

/* Adds `json` and releases it. 17 significant digits are enough for any double (IEEE 754,
 * 5.12.2). */
static void put(pl_text_buffer *out, const char *before, json_t *json)
{
    char *text = json_dumps(json, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
    pl_text_add(out, before);
    pl_text_add(out, text);
    free(text);
    json_decref(json);
}

static void put_body(pl_text_buffer *out, const char *before, const pe_problem_body *body)
{
    put(out, before,
        json_pack("{s:f, s:o, s:o}", "mass", body->mass, "inertia", vector(body->inertia, 6),
                  "free_velocity", vector(body->free_velocity, 6)));
}

static void put_point(pl_text_buffer *out, const char *before,
                      const pe_problem_manifold_point *point)
{
    put(out, before,
        json_pack("{s:o, s:f, s:o, s:o}", "offset", vector(point->offset, 3), "bias", point->bias,
                  "slip", vector(point->slip, 2), "impulse", vector(point->impulse, 3)));
}

static void put_manifold(pl_text_buffer *out, const char *before, const pe_problem_manifold *m,
                         const pe_problem_manifold_point *points)
{
    pl_text_format(out, "%s{\"a\":%d,\"b\":%d", before, m->a, m->b);
    put(out, ",\"friction\":", json_real(m->friction));
    put(out, ",\"frame\":", vector(m->frame[0], 9));
    if (m->a != PE_STATIC) {
        put(out, ",\"arm_a\":", vector(m->arm_a, 3));
    }
    if (m->b != PE_STATIC) {
        put(out, ",\"arm_b\":", vector(m->arm_b, 3));
    }
    pl_text_add(out, ",\"points\":[");
    for (int j = 0; j < m->count; ++j) {
        put_point(out, j == 0 ? "\n  " : ",\n  ", &points[m->first + j]);
    }
    pl_text_add(out, "]}");
}

char *pl_capture_text(const pe_contact_problem *problem, const json_t *source)
{
    pl_text_buffer out = {0};
    pl_text_add(&out, "{\"schema\":\"plumb.contact_problem/1\"");
    if (source != NULL) {
        put(&out, ",\n\"source\":", json_incref((json_t *)source));
    }
    pl_text_add(&out, ",\n\"bodies\":[");
    for (int i = 0; i < problem->body_count; ++i) {
        put_body(&out, i == 0 ? "\n " : ",\n ", &problem->bodies[i]);
    }
    pl_text_add(&out, "],\n\"manifolds\":[");
    for (int i = 0; i < problem->manifold_count; ++i) {
        put_manifold(&out, i == 0 ? "\n " : ",\n ", &problem->manifolds[i], problem->points);
    }
    pl_text_add(&out, "]}\n");
    return pl_text_take(&out);
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

char *pl_capture_path(const char *path, int number)
{
    const char *braces = strstr(path, "{}");
    return braces == NULL
               ? pl_heap_copy(path)
               : pl_heap_format("%.*s%d%s", (int)(braces - path), path, number, braces + 2);
}

static pl_status write_island(const pl_capture_target *target, pe_contact_problem *const *problems,
                              int index, int count, pl_error *error)
{
    json_t *source = json_copy(target->source);
    json_object_set_new(source, "step", json_integer(target->step));
    json_object_set_new(source, "island", json_integer(index + 1));
    json_object_set_new(source, "islands", json_integer(count));
    char *text = pl_capture_text(problems[index], source);
    char *path = pl_capture_path(target->path, index + 1);
    const pl_status status = pl_write_text(path, text, strlen(text), error);
    free(text);
    free(path);
    json_decref(source);
    return status;
}

pl_status pl_capture_write(void *user, pe_contact_problem **problems, int count, pl_error *error)
{
    const pl_capture_target *target = user;
    const bool all = strstr(target->path, "{}") != NULL;
    int largest = 0;
    for (int i = 1; i < count; ++i) {
        largest = problems[i]->point_count > problems[largest]->point_count ? i : largest;
    }
    pl_status status = count > 0
                           ? PL_OK
                           : pl_fail(error, PL_FAILED,
                                     "nothing to capture: step %ld has no contact", target->step);
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (all || i == largest) {
            status = write_island(target, problems, i, count, error);
        }
    }
    pe_contact_problems_destroy(problems, count);
    return status;
}
