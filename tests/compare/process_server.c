/* An engine that is built into Plumb, served by the protocol plumb.engine/1 over its adapter:
 *
 *     process_server NAME
 *
 * Its results are those of the engine without the protocol, bit for bit. */
#include "engines/engine_info.h"
#include "plumb/scenario.h"

#include "adapters/built_in.h"
#include "adapters/process/hello.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { NUMBERS = 3, MOST_MATERIALS = 16 };

typedef struct server {
    pl_loaded_engine loaded;
    pl_scene scene;
    pl_engine_setup setup;
    double values[PL_ENGINE_MAX_OPTIONS];
    pl_pair_coefficients pairs[MOST_MATERIALS * MOST_MATERIALS];
    pl_engine_instance *instance;
    pl_frame frame;
    pl_contact *contacts;
    double *contact_numbers;
    int contact_capacity;
} server;

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *vector(const double *values)
{
    return json_pack("[o, o, o]", number(values[0]), number(values[1]), number(values[2]));
}

/* Writes numbers into the file of numbers, and what refers to them. */
static json_t *put_numbers(const double *values, size_t count, long *offset)
{
    const size_t size = count * sizeof *values;
    for (size_t done = 0; done < size;) {
        const ssize_t length =
            pwrite(NUMBERS, (const char *)values + done, size - done, *offset + (long)done);
        if (length < 0) {
            exit(1);
        }
        done += (size_t)length;
    }
    json_t *part =
        json_pack("{s:I, s:I}", "offset", (json_int_t)*offset, "count", (json_int_t)count);
    *offset += (long)size;
    return part;
}

static int read_contacts(server *s)
{
    const pl_engine *engine = &s->loaded.table;
    if (engine->contacts == 0) {
        return 0;
    }
    for (;;) {
        const int count = engine->read_contacts(s->instance, s->contacts, s->contact_capacity);
        if (count <= s->contact_capacity) {
            return count;
        }
        s->contact_capacity = 2 * count;
        s->contacts = realloc(s->contacts, (size_t)s->contact_capacity * sizeof *s->contacts);
        s->contact_numbers = realloc(s->contact_numbers,
                                     (size_t)s->contact_capacity * 15 * sizeof *s->contact_numbers);
    }
}

static void add_state(server *s, json_t *answer)
{
    long offset = 0;
    const uint32_t reported = s->loaded.table.contacts;
    s->loaded.table.read_frame(s->instance, &s->frame);
    json_object_set_new(
        answer, "frame",
        put_numbers(s->frame.bodies[0].position, (size_t)s->frame.body_count * 13, &offset));
    const int count = read_contacts(s);
    double *to = s->contact_numbers;
    for (int i = 0; i < count; ++i) {
        const pl_contact *c = &s->contacts[i];
        *to++ = c->body_a;
        *to++ = c->body_b;
        memcpy(to, c->point, 7 * sizeof *to); /* point, normal, separation */
        to += 7;
        if ((reported & PL_CONTACTS_IMPULSES) != 0) {
            memcpy(to, c->impulse, sizeof c->impulse);
            to += 3;
        }
        if ((reported & PL_CONTACTS_TORQUES) != 0) {
            memcpy(to, c->torque, sizeof c->torque);
            to += 3;
        }
    }
    if (reported != 0) {
        json_object_set_new(
            answer, "contacts",
            put_numbers(s->contact_numbers, (size_t)(to - s->contact_numbers), &offset));
    }
}

/* ---- Requests ---- */

static json_t *describe(const server *s)
{
    const pl_engine *e = &s->loaded.table;
    double defaults[PL_ENGINE_MAX_PROFILES * PL_ENGINE_MAX_OPTIONS];
    for (int i = 0; i < e->profile_count; ++i) {
        double *values = defaults + i * e->option_count;
        for (int k = 0; k < e->option_count; ++k) {
            values[k] = e->options[k].value;
        }
        if (e->profile_defaults != NULL) {
            e->profile_defaults(i, values);
        }
    }
    json_t *answer = pl_hello_write(e, defaults);
    json_object_set_new(answer, "name", json_sprintf("served-%s", e->name));
    return answer;
}

static json_t *settings_of(server *s)
{
    const int count = s->scene.body_count;
    pl_engine_settings found = {.struct_size = sizeof found,
                                .body_count = count,
                                .gravity = {NAN, NAN, NAN},
                                .dt = NAN,
                                .substeps = s->loaded.table.substeps,
                                .linear_damping = NAN,
                                .angular_damping = NAN};
    found.mass = malloc((size_t)count * sizeof *found.mass);
    found.inertia = malloc((size_t)count * sizeof *found.inertia);
    for (int i = 0; i < count; ++i) {
        found.mass[i] = found.inertia[i][0] = found.inertia[i][1] = found.inertia[i][2] = NAN;
    }
    s->loaded.table.read_settings(s->instance, &found);
    json_t *masses = json_array(), *moments = json_array();
    for (int i = 0; i < count; ++i) {
        json_array_append_new(masses, number(found.mass[i]));
        json_array_append_new(moments, vector(found.inertia[i]));
    }
    json_t *settings =
        json_pack("{s:o, s:o, s:i, s:o, s:o, s:o, s:o}", "gravity", vector(found.gravity), "dt",
                  number(found.dt), "substeps", found.substeps, "linear_damping",
                  number(found.linear_damping), "angular_damping", number(found.angular_damping),
                  "mass", masses, "inertia", moments);
    free(found.mass);
    free(found.inertia);
    return settings;
}

static void read_vector(const json_t *request, const char *key, double values[3])
{
    for (size_t k = 0; k < 3; ++k) {
        values[k] = json_number_value(json_array_get(json_object_get(request, key), k));
    }
}

static pl_status read_scene(server *s, const json_t *request, pl_error *error)
{
    char *text = json_dumps(json_object_get(request, "scene"), JSON_REAL_PRECISION(17));
    const pl_status status =
        pl_scene_read_text(text, strlen(text), "the request", &s->scene, error);
    free(text);
    return status;
}

static pl_status create(server *s, const json_t *request, pl_error *error)
{
    const pl_engine *e = &s->loaded.table;
    const char *profile = json_string_value(json_object_get(request, "profile"));
    pl_status status = read_scene(s, request, error);
    if (status != PL_OK) {
        return status;
    }
    s->setup = (pl_engine_setup){.struct_size = sizeof s->setup,
                                 .scene = &s->scene,
                                 .dt = json_number_value(json_object_get(request, "dt")),
                                 .values = s->values,
                                 .pairs = s->pairs};
    for (int i = 0; i < e->profile_count; ++i) {
        s->setup.profile = strcmp(e->profiles[i].name, profile) == 0 ? i : s->setup.profile;
    }
    for (int i = 0; i < e->option_count; ++i) {
        s->values[i] = json_number_value(
            json_object_get(json_object_get(request, "options"), e->options[i].name));
    }
    const int count = s->scene.material_count;
    for (int i = 0; i < count && count <= MOST_MATERIALS; ++i) {
        for (int k = 0; k < count; ++k) {
            pl_pair_coefficients *pair = &s->pairs[i * count + k];
            pl_scene_pair(&s->scene, i, k, &pair->friction, &pair->restitution);
        }
    }
    read_vector(request, "lower", s->setup.lower);
    read_vector(request, "upper", s->setup.upper);
    s->frame = (pl_frame){.body_count = s->scene.body_count,
                          .bodies = calloc((size_t)s->scene.body_count, sizeof *s->frame.bodies)};
    return e->create(&s->setup, &s->instance, error);
}

static void destroy(server *s)
{
    s->loaded.table.destroy(s->instance);
    s->instance = NULL;
    free(s->frame.bodies);
    s->frame.bodies = NULL;
    pl_scene_free(&s->scene);
}

static json_t *step(server *s, pl_error *error)
{
    pl_step_stats stats = {sizeof stats, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    const double before = cpu_seconds();
    const pl_status status = s->loaded.table.step(s->instance, s->setup.dt, &stats, error);
    const double used = cpu_seconds() - before;
    if (status != PL_OK) {
        return json_object();
    }
    json_t *answer =
        json_pack("{s:f, s:{s:o, s:o, s:o, s:o, s:o, s:o, s:o}}", "cpu", used, "stats",
                  "iterations", number(stats.iterations), "residual", number(stats.residual),
                  "contacts", number(stats.contacts), "islands", number(stats.islands),
                  "time_collide", number(stats.time_collide), "time_solve",
                  number(stats.time_solve), "time_other", number(stats.time_other));
    add_state(s, answer);
    return answer;
}

static json_t *read_pair(server *s, const json_t *request)
{
    const json_t *bodies = json_object_get(request, "bodies");
    pl_pair_coefficients found = {NAN, NAN};
    s->loaded.table.read_pair(s->instance, (int)json_integer_value(json_array_get(bodies, 0)),
                              (int)json_integer_value(json_array_get(bodies, 1)), &found);
    return json_pack("{s:o, s:o}", "friction", number(found.friction), "restitution",
                     number(found.restitution));
}

static json_t *answer_to(server *s, const char *name, const json_t *request, pl_error *error)
{
    json_t *answer = NULL;
    if (strcmp(name, "hello") == 0) {
        return describe(s);
    }
    if (strcmp(name, "step") == 0) {
        return step(s, error);
    }
    if (strcmp(name, "pair") == 0) {
        return read_pair(s, request);
    }
    answer = json_object();
    if (strcmp(name, "create") == 0 && create(s, request, error) == PL_OK &&
        s->loaded.table.read_settings != NULL) {
        json_object_set_new(answer, "settings", settings_of(s));
    } else if (strcmp(name, "frame") == 0) {
        add_state(s, answer);
    } else if (strcmp(name, "destroy") == 0) {
        destroy(s);
    }
    return answer;
}

int main(int argc, char **argv)
{
    static server s;
    char *line = NULL;
    size_t capacity = 0;
    int count = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    pl_error error = {.message = ""};
    for (int i = 0; i < count && argc == 2; ++i) {
        const pl_engine_info info = {.built_in = &known[i]};
        if (strcmp(known[i].name, argv[1]) == 0 && known[i].entry != NULL &&
            pl_load_engine(&info, &s.loaded, &error) != PL_OK) {
            fprintf(stderr, "%s\n", error.message);
            return 1;
        }
    }
    if (s.loaded.table.name == NULL) {
        fprintf(stderr, "usage: process_server NAME, of an engine in this build\n");
        return 2;
    }
    s.contact_capacity = 1024;
    s.contacts = malloc((size_t)s.contact_capacity * sizeof *s.contacts);
    s.contact_numbers = malloc((size_t)s.contact_capacity * 15 * sizeof *s.contact_numbers);
    while (getline(&line, &capacity, stdin) > 0) {
        json_t *request = json_loads(line, 0, NULL);
        const char *name = json_string_value(json_object_get(request, "request"));
        error = (pl_error){.message = ""};
        json_t *answer = answer_to(&s, name == NULL ? "" : name, request, &error);
        json_object_set(answer, "id", json_object_get(request, "id"));
        if (error.message[0] != '\0') {
            json_object_set_new(answer, "error", json_string(error.message));
            json_object_set_new(answer, "unsupported",
                                json_boolean(error.status == PL_UNSUPPORTED));
        }
        json_dumpf(answer, stdout, JSON_COMPACT | JSON_REAL_PRECISION(17));
        putchar('\n');
        fflush(stdout);
        json_decref(answer);
        json_decref(request);
    }
    free(line);
    free(s.contacts);
    free(s.contact_numbers);
    return 0;
}
