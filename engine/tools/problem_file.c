/* Reads contact problems: the structure of the format. pe_contact_problem_is_valid checks the
 * numbers. */
#include "problem_file.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct reading {
    const char *label;
    char place[64]; /* of the object that is read, such as "bodies[3]"; "" for the whole file */
    char *message;
} reading;

/* Always false. `field` may be NULL. */
static bool fail(const reading *r, const char *field, const char *text)
{
    const bool has_place = r->place[0] != '\0', has_field = field != NULL;
    snprintf(r->message, PROBLEM_MESSAGE_SIZE, "%.120s: %s%s%s%s%s", r->label, r->place,
             has_place && has_field ? "." : "", has_field ? field : "",
             has_place || has_field ? ": " : "", text);
    return false;
}

/* Reads the object as json_unpack does, its members in the order of `keys`. No other members are
 * allowed. */
static bool unpack(const reading *r, json_t *json, const char *const *keys, const char *format, ...)
{
    json_error_t error;
    va_list arguments;
    va_start(arguments, format);
    const bool done = json_vunpack_ex(json, &error, JSON_STRICT, format, arguments) == 0;
    va_end(arguments);
    /* The column counts characters of the format, which has an 's' for each key. */
    int key = -1;
    for (int i = 0; i < error.column - 1 && !done; ++i) {
        key += format[i] == 's';
    }
    const bool in_member = !done && key >= 0 && strchr("FIo[]", format[error.column - 1]) != NULL;
    return done || fail(r, in_member ? keys[key] : NULL, error.text);
}

#define TWO(v) &(v)[0], &(v)[1]
#define THREE(v) TWO(v), &(v)[2]
#define SIX(v) THREE(v), &(v)[3], &(v)[4], &(v)[5]
#define NINE(v) SIX(v), &(v)[6], &(v)[7], &(v)[8]

static bool read_body(const reading *r, json_t *json, pe_problem_body *body)
{
    static const char *const keys[] = {"mass", "inertia", "free_velocity"};
    return unpack(r, json, keys, "{sF s[FFFFFF] s[FFFFFF]}", keys[0], &body->mass, keys[1],
                  SIX(body->inertia), keys[2], SIX(body->free_velocity));
}

static bool read_point(const reading *r, json_t *json, pe_problem_manifold_point *point)
{
    static const char *const keys[] = {"offset", "bias", "slip", "impulse"};
    return unpack(r, json, keys, "{s[FFF] sF s?[FF] s?[FFF]}", keys[0], THREE(point->offset),
                  keys[1], &point->bias, keys[2], TWO(point->slip), keys[3], THREE(point->impulse));
}

/* All but its points. The arm of a static body has no meaning. */
static bool read_manifold(const reading *r, json_t *json, pe_problem_manifold *m)
{
    static const char *const keys[] = {"a", "b", "friction", "frame", "arm_a", "arm_b", "points"};
    const json_t *points;
    json_int_t a = 0, b = 0;
    char format[64];
    json_unpack(json, "{sI sI}", keys[0], &a, keys[1], &b);
    snprintf(format, sizeof format, "{sI sI sF s[FFFFFFFFF] s%s[FFF] s%s[FFF] so}",
             a == PE_STATIC ? "?" : "", b == PE_STATIC ? "?" : "");
    double *frame = m->frame[0];
    if (!unpack(r, json, keys, format, keys[0], &a, keys[1], &b, keys[2], &m->friction, keys[3],
                NINE(frame), keys[4], THREE(m->arm_a), keys[5], THREE(m->arm_b), keys[6],
                &points)) {
        return false;
    }
    if (a != (int)a || b != (int)b) {
        return fail(r, a != (int)a ? "a" : "b", "expected the index of a body");
    }
    m->a = (int)a;
    m->b = (int)b;
    return m->count > 0 || fail(r, "points", "expected an array of at least one point");
}

static bool read_manifolds(reading *r, const json_t *manifolds, pe_contact_problem *problem)
{
    int first = 0;
    for (int i = 0; i < problem->manifold_count; ++i) {
        json_t *json = json_array_get(manifolds, (size_t)i);
        const json_t *points = json_object_get(json, "points");
        pe_problem_manifold *m = &problem->manifolds[i];
        m->first = first;
        m->count = (int)json_array_size(points);
        first += m->count;
        snprintf(r->place, sizeof r->place, "manifolds[%d]", i);
        if (!read_manifold(r, json, m)) {
            return false;
        }
        for (int j = 0; j < m->count; ++j) {
            snprintf(r->place, sizeof r->place, "manifolds[%d].points[%d]", i, j);
            if (!read_point(r, json_array_get(points, (size_t)j), &problem->points[m->first + j])) {
                return false;
            }
        }
    }
    return true;
}

static bool read_lists(reading *r, const json_t *bodies, const json_t *manifolds,
                       pe_contact_problem *problem)
{
    for (int i = 0; i < problem->body_count; ++i) {
        snprintf(r->place, sizeof r->place, "bodies[%d]", i);
        if (!read_body(r, json_array_get(bodies, (size_t)i), &problem->bodies[i])) {
            return false;
        }
    }
    return read_manifolds(r, manifolds, problem);
}

/* The engine's own check, reported at the place in the file. */
static bool check_numbers(reading *r, const pe_contact_problem *problem)
{
    pe_problem_fault fault;
    if (pe_contact_problem_is_valid(problem, &fault)) {
        return true;
    }
    snprintf(r->place, sizeof r->place, "%s[%d]", fault.list, fault.index);
    for (int i = 0; i < problem->manifold_count && strcmp(fault.list, "points") == 0; ++i) {
        const int point = fault.index - problem->manifolds[i].first;
        if (point >= 0 && point < problem->manifolds[i].count) {
            snprintf(r->place, sizeof r->place, "manifolds[%d].points[%d]", i, point);
        }
    }
    return fail(r, fault.field, fault.text);
}

static pe_contact_problem *read_problem(reading *r, json_t *json)
{
    static const char *const keys[] = {"schema", "source", "bodies", "manifolds"};
    const json_t *schema, *source, *bodies, *manifolds, *manifold;
    pe_contact_problem *problem = NULL;
    pe_error error;
    size_t i;
    int points = 0;
    if (!unpack(r, json, keys, "{so s?o so so}", keys[0], &schema, keys[1], &source, keys[2],
                &bodies, keys[3], &manifolds)) {
        return NULL;
    }
    const char *name = json_string_value(schema);
    if (name == NULL || strcmp(name, "plumb.contact_problem/1") != 0) {
        fail(r, "schema", "expected \"plumb.contact_problem/1\"");
        return NULL;
    }
    if (!json_is_array(bodies) || !json_is_array(manifolds)) {
        fail(r, json_is_array(bodies) ? "manifolds" : "bodies", "expected an array");
        return NULL;
    }
    for (i = 0; (manifold = json_array_get(manifolds, i)) != NULL; ++i) {
        points += (int)json_array_size(json_object_get(manifold, "points"));
    }
    if (pe_contact_problem_create((int)json_array_size(bodies), (int)i, points, NULL, &problem,
                                  &error) != PE_OK) {
        fail(r, NULL, error.message);
    } else if (!read_lists(r, bodies, manifolds, problem) || !check_numbers(r, problem)) {
        pe_contact_problem_destroy(problem);
        problem = NULL;
    }
    return problem;
}

/* Takes over `json`, which is NULL where the text is none: then `error` has the reason. */
static pe_contact_problem *read_json(const char *label, json_t *json, const json_error_t *error,
                                     char *message)
{
    reading r = {.label = label, .message = message};
    if (json == NULL && error->line > 0) {
        snprintf(message, PROBLEM_MESSAGE_SIZE, "%.120s:%d:%d: %s", label, error->line,
                 error->column, error->text);
    } else if (json == NULL) {
        fail(&r, NULL, error->text);
    }
    pe_contact_problem *problem = json == NULL ? NULL : read_problem(&r, json);
    json_decref(json);
    return problem;
}

pe_contact_problem *problem_read_text(const char *text, size_t length, const char *label,
                                      char message[PROBLEM_MESSAGE_SIZE])
{
    json_error_t error;
    json_t *json = json_loadb(text, length, JSON_REJECT_DUPLICATES, &error);
    return read_json(label, json, &error, message);
}

pe_contact_problem *problem_read_file(const char *path, char message[PROBLEM_MESSAGE_SIZE])
{
    json_error_t error;
    json_t *json = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    return read_json(path, json, &error, message);
}
