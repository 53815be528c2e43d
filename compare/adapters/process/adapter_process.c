#include "adapter_process.h"

#include "base/array.h"
#include "base/json_field.h"
#include "channel.h"
#include "hello.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Numbers of a body in a frame: those of pl_body_state in its order. */
enum { FRAME_NUMBERS = sizeof(pl_body_state) / sizeof(double), MOST_CONTACT_NUMBERS = 15 };

/* How far the CPU time that a program reports for steps may exceed what the operating system counted:
 * a clock that ticks may count more in steps than was spent on them. */
static const double TIME_SHARE = 1.1;
static const double TIME_SLACK = 20e-3;

/* Steps, and the CPU time that was spent on them, s. */
typedef struct step_times {
    long steps;
    double reported, counted;
} step_times;

/* The engine of this process: see adapter_process.h. */
static struct {
    char *command;
    pl_channel channel;
    pl_hello hello;
    double steps_time;   /* s, reported */
    step_times doubtful; /* the last steps, in which it reports more than was counted */
    char path[PATH_MAX];
} program;

struct pl_engine_instance {
    const pl_scene *scene;
    json_t *settings; /* of the answer to create; NULL: none */
    pl_body_state *bodies;
    double *contacts; /* (contact_count x contact_numbers) */
    int contact_count, contact_capacity;
    long steps;
    double time; /* s */
};

/* ---- The state ---- */

static int contact_numbers(void)
{
    const uint32_t reported = program.hello.table.contacts;
    return reported == 0 ? 0
                         : 9 + ((reported & PL_CONTACTS_IMPULSES) != 0 ? 3 : 0) +
                               ((reported & PL_CONTACTS_TORQUES) != 0 ? 3 : 0);
}

/* Sets *object to the object at `key`; NULL: there is none, or null. */
static bool find_object(const json_t *answer, const char *key, json_t **object,
                        pl_diagnostic *diagnostic)
{
    json_t *found = json_object_get(answer, key);
    char text[PL_FOUND_SIZE];
    *object = json_is_object(found) ? found : NULL;
    return found == NULL || json_is_null(found) || json_is_object(found) ||
           pl_diagnose_field(diagnostic, key, "expected an object, found %s",
                             pl_json_found(found, text));
}

static bool read_bodies(const json_t *answer, pl_engine_instance *instance,
                        pl_diagnostic *diagnostic)
{
    const long expected = (long)instance->scene->body_count * FRAME_NUMBERS;
    long count;
    if (!pl_channel_count(&program.channel, answer, "frame", &count, diagnostic)) {
        return false;
    }
    if (count != expected) {
        return pl_diagnose_field(diagnostic, "frame", "expected %ld numbers, %d a body, found %ld",
                                 expected, (int)FRAME_NUMBERS, count < 0 ? 0 : count);
    }
    return pl_channel_numbers(&program.channel, answer, "frame", instance->bodies[0].position,
                              count, diagnostic);
}

static bool read_contact_list(const json_t *answer, pl_engine_instance *instance,
                              pl_diagnostic *diagnostic)
{
    const int width = contact_numbers();
    long count;
    instance->contact_count = 0;
    if (width == 0) {
        return true;
    }
    if (!pl_channel_count(&program.channel, answer, "contacts", &count, diagnostic)) {
        return false;
    }
    if (count <= 0) {
        return true;
    }
    if (count % width != 0) {
        return pl_diagnose_field(diagnostic, "contacts",
                                 "expected a multiple of %d numbers, found %ld", width, count);
    }
    instance->contact_count = (int)(count / width);
    if (pl_array_reserve(&instance->contacts, &instance->contact_capacity, instance->contact_count,
                         (size_t)width * sizeof *instance->contacts, NULL) != PL_OK) {
        return pl_diagnose_no_memory(diagnostic);
    }
    return pl_channel_numbers(&program.channel, answer, "contacts", instance->contacts, count,
                              diagnostic);
}

/* `user` is the instance. */
static bool read_state(const json_t *answer, void *user, pl_diagnostic *diagnostic)
{
    return read_bodies(answer, user, diagnostic) && read_contact_list(answer, user, diagnostic);
}

/* ---- Create and destroy ---- */

/* A member of the wrong type is the program's failure; in pl_status terms PL_BAD_INPUT is that of the
 * user. */
static pl_status ask(const char *what, pl_answer_reader read, void *user, pl_error *error)
{
    const pl_status status = pl_channel_ask(&program.channel, what, read, user, error);
    if (status == PL_BAD_INPUT && error != NULL) {
        error->status = PL_FAILED;
    }
    return status == PL_BAD_INPUT ? PL_FAILED : status;
}

static void free_instance(pl_engine_instance *instance)
{
    json_decref(instance->settings);
    free(instance->bodies);
    free(instance->contacts);
    free(instance);
}

static void process_destroy(pl_engine_instance *instance)
{
    if (instance != NULL) {
        pl_channel_begin(&program.channel, "destroy");
        (void)ask("destroy", NULL, NULL, NULL);
        free_instance(instance);
    }
}

/* `user` is the instance. */
static bool read_created(const json_t *answer, void *user, pl_diagnostic *diagnostic)
{
    pl_engine_instance *instance = user;
    json_t *settings;
    if (!find_object(answer, "settings", &settings, diagnostic)) {
        return false;
    }
    const json_t *substeps = json_object_get(settings, "substeps");
    const double number = json_number_value(substeps);
    if (json_is_number(substeps) && !(fabs(number) < 1e6 && number == floor(number))) {
        pl_path_push_key(&diagnostic->path, "settings");
        return pl_check_number(diagnostic, "substeps", number, false, "an integer");
    }
    instance->settings = json_incref(settings);
    return true;
}

pl_status pl_process_engine_ask_state(pl_engine_instance *instance, int count, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        pl_channel_begin(&program.channel, "frame");
        status = ask("frame", read_state, instance, error);
    }
    return status;
}

static pl_status process_create(const pl_engine_setup *setup, pl_engine_instance **out,
                                pl_error *error)
{
    const pl_scene *scene = setup->scene;
    *out = NULL;
    if (setup->profile >= program.hello.table.profile_count) {
        return pl_engine_error(error, PL_FAILED,
                               "it has fewer profiles than when it was first started");
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance != NULL) {
        instance->scene = scene;
        instance->bodies = calloc((size_t)scene->body_count + 1, sizeof *instance->bodies);
    }
    if (instance == NULL || instance->bodies == NULL) {
        free(instance);
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory for the scene");
    }
    pl_create_request_add(pl_channel_begin(&program.channel, "create"), setup,
                          &program.hello.table);
    pl_status status = ask("create", read_created, instance, error);
    if (status != PL_OK) {
        free_instance(instance);
        return status;
    }
    status = pl_process_engine_ask_state(instance, 1, error);
    if (status != PL_OK) {
        process_destroy(instance);
        return status;
    }
    *out = instance;
    return PL_OK;
}

/* ---- The step ---- */

typedef struct step_answer {
    pl_engine_instance *instance;
    pl_step_stats *stats;
    double cpu; /* s */
} step_answer;

static bool read_stats(const json_t *answer, pl_step_stats *stats, pl_diagnostic *diagnostic)
{
    json_t *object;
    const struct {
        const char *key;
        double *value;
    } members[] = {{"iterations", &stats->iterations},     {"residual", &stats->residual},
                   {"contacts", &stats->contacts},         {"islands", &stats->islands},
                   {"time_collide", &stats->time_collide}, {"time_solve", &stats->time_solve},
                   {"time_other", &stats->time_other}};
    if (!find_object(answer, "stats", &object, diagnostic)) {
        return false;
    }
    for (size_t i = 0; i < sizeof members / sizeof *members; ++i) {
        if (!json_is_null(json_object_get(object, members[i].key)) &&
            !pl_json_number(object, members[i].key, PL_OPTIONAL, members[i].value, diagnostic)) {
            return false;
        }
    }
    return true;
}

/* `user` is a step_answer. */
static bool read_step(const json_t *answer, void *user, pl_diagnostic *diagnostic)
{
    step_answer *step = user;
    if (!pl_json_number(answer, "cpu", PL_REQUIRED, &step->cpu, diagnostic)) {
        return false;
    }
    if (!(step->cpu >= 0)) {
        return pl_diagnose_field(diagnostic, "cpu", "expected at least 0 s, found %g", step->cpu);
    }
    return read_stats(answer, step->stats, diagnostic) &&
           read_state(answer, step->instance, diagnostic);
}

/* Compares what the program reports for a step with what was counted from its previous answer to this
 * one. A clock's rounding evens out over steps, so the excess is summed over successive steps. The sum
 * starts at 0 again when there is no excess: an honest step makes up for no later one. */
static pl_status check_step_time(double reported, double counted, pl_error *error)
{
    step_times *sum = &program.doubtful;
    sum->steps += 1;
    sum->reported += reported;
    sum->counted += counted;
    const double excess = sum->reported - TIME_SHARE * sum->counted;
    if (excess > TIME_SLACK) {
        char text[160];
        snprintf(text, sizeof text,
                 "it reports %.3g s of CPU time for %ld step%s, and the operating system counted "
                 "%.3g s",
                 sum->reported, sum->steps, sum->steps == 1 ? "" : "s", sum->counted);
        return pl_engine_error(error, PL_FAILED, text);
    }
    if (excess <= 0) {
        *sum = (step_times){.steps = 0};
    }
    return PL_OK;
}

static pl_status process_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                              pl_error *error)
{
    step_answer answer = {.instance = instance, .stats = stats};
    char what[48];
    instance->steps += 1;
    instance->time += dt;
    snprintf(what, sizeof what, "step %ld", instance->steps);
    pl_text_format(pl_channel_begin(&program.channel, "step"), ",\"step\":%ld", instance->steps);
    const double before = program.channel.cpu_time;
    const pl_status status = ask(what, read_step, &answer, error);
    if (status != PL_OK) {
        return status;
    }
    program.steps_time += answer.cpu;
    return check_step_time(answer.cpu, program.channel.cpu_time - before, error);
}

/* ---- Reading ---- */

static void process_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    frame->time = instance->time;
    memcpy(frame->bodies, instance->bodies, (size_t)frame->body_count * sizeof *frame->bodies);
}

/* An index of a body; -1 for what cannot be one. */
static int body_index(double number)
{
    return number >= 0 && number < PL_MAX_BODIES && number == floor(number) ? (int)number : -1;
}

static int process_read_contacts(const pl_engine_instance *instance, pl_contact *contacts,
                                 int capacity)
{
    const uint32_t reported = program.hello.table.contacts;
    const int width = contact_numbers();
    for (int i = 0; i < instance->contact_count && i < capacity; ++i) {
        const double *from = instance->contacts + (size_t)i * (size_t)width;
        pl_contact *to = &contacts[i];
        memset(to, 0, sizeof *to);
        to->body_a = body_index(from[0]);
        to->body_b = body_index(from[1]);
        memcpy(to->point, from + 2, sizeof to->point);
        memcpy(to->normal, from + 5, sizeof to->normal);
        to->separation = from[8];
        from += 9;
        if ((reported & PL_CONTACTS_IMPULSES) != 0) {
            memcpy(to->impulse, from, sizeof to->impulse);
            from += 3;
        }
        if ((reported & PL_CONTACTS_TORQUES) != 0) {
            memcpy(to->torque, from, sizeof to->torque);
        }
    }
    return instance->contact_count;
}

/* Overwrites a number where the program says one. */
static void take_number(const json_t *found, double *value)
{
    *value = json_is_number(found) ? json_number_value(found) : *value;
}

static void process_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    const json_t *s = instance->settings;
    const json_t *substeps = json_object_get(s, "substeps");
    const json_t *masses = json_object_get(s, "mass"), *moments = json_object_get(s, "inertia");
    take_number(json_object_get(s, "dt"), &settings->dt);
    take_number(json_object_get(s, "linear_damping"), &settings->linear_damping);
    take_number(json_object_get(s, "angular_damping"), &settings->angular_damping);
    if (json_is_number(substeps)) {
        settings->substeps = (int)json_number_value(substeps);
    }
    for (size_t k = 0; k < 3; ++k) {
        take_number(json_array_get(json_object_get(s, "gravity"), k), &settings->gravity[k]);
    }
    for (int i = 0; i < settings->body_count; ++i) {
        take_number(json_array_get(masses, (size_t)i), &settings->mass[i]);
        for (size_t k = 0; k < 3; ++k) {
            take_number(json_array_get(json_array_get(moments, (size_t)i), k),
                        &settings->inertia[i][k]);
        }
    }
}

/* `user` is a pl_pair_coefficients. */
static bool take_pair(const json_t *answer, void *user, pl_diagnostic *diagnostic)
{
    pl_pair_coefficients *found = user;
    (void)diagnostic;
    take_number(json_object_get(answer, "friction"), &found->friction);
    take_number(json_object_get(answer, "restitution"), &found->restitution);
    return true;
}

static void process_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                              pl_pair_coefficients *found)
{
    (void)instance;
    *found = (pl_pair_coefficients){NAN, NAN};
    pl_text_format(pl_channel_begin(&program.channel, "pair"), ",\"bodies\":[%d,%d]", body_a,
                   body_b);
    (void)ask("pair", take_pair, found, NULL);
}

/* ---- The engine ---- */

static void process_profile_defaults(int profile, double *values)
{
    pl_hello_profile_values(&program.hello, profile, values);
}

static bool read_hello(const json_t *answer, void *user, pl_diagnostic *diagnostic)
{
    return pl_hello_read(answer, user, diagnostic);
}

pl_status pl_process_engine_open(const char *command, pl_engine *table, pl_error *error)
{
    pl_status status = pl_channel_open(&program.channel, command, error);
    if (status != PL_OK) {
        return status;
    }
    program.steps_time = 0;
    program.doubtful = (step_times){.steps = 0};
    program.command = strdup(command);
    pl_text_add(pl_channel_begin(&program.channel, "hello"), ",\"protocol\":\"plumb.engine/1\"");
    status = pl_channel_ask(&program.channel, "hello", read_hello, &program.hello, error);
    if (status != PL_OK) {
        pl_process_engine_close();
        return status;
    }
    *table = program.hello.table;
    table->profile_defaults = process_profile_defaults;
    table->create = process_create;
    table->destroy = process_destroy;
    table->step = process_step;
    table->read_frame = process_read_frame;
    table->read_settings = program.hello.reads_settings ? process_read_settings : NULL;
    table->read_pair = program.hello.reads_pairs ? process_read_pair : NULL;
    table->read_contacts = table->contacts != 0 ? process_read_contacts : NULL;
    return PL_OK;
}

void pl_process_engine_close(void)
{
    if (program.channel.pid > 0) {
        pl_channel_close(&program.channel);
        pl_hello_free(&program.hello);
        free(program.command);
        program.command = NULL;
    }
}

pid_t pl_process_engine_pid(void)
{
    return program.channel.pid;
}

pl_process_engine_time pl_process_engine_times(void)
{
    return (pl_process_engine_time){.all = program.channel.cpu_time, .steps = program.steps_time};
}

/* ---- Files ---- */

static const char BLANKS[] = " \t\n";

static bool is_file(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && S_ISREG(found.st_mode);
}

/* Takes the next word of a command as a shell does, without its quotes and backslashes, cut to `size`.
 * Variables and patterns stay as they are. False: there are no more. */
static bool next_word(const char **at, char *word, size_t size)
{
    char quote = '\0';
    size_t length = 0;
    const char *c = *at + strspn(*at, BLANKS);
    const bool is_there = *c != '\0';
    for (; *c != '\0' && (quote != '\0' || strchr(BLANKS, *c) == NULL); ++c) {
        if (quote == '\0' ? *c == '\'' || *c == '"' : *c == quote) {
            quote = quote == '\0' ? *c : '\0';
            continue;
        }
        const bool escapes = *c == '\\' && c[1] != '\0' &&
                             (quote == '\0' || (quote == '"' && strchr("$`\"\\", c[1]) != NULL));
        c += escapes ? 1 : 0;
        if (length + 1 < size) {
            word[length++] = *c;
        }
    }
    word[length] = '\0';
    *at = c;
    return is_there;
}

/* Finds file number *index of those that a command names, and takes the files passed over off *index.
 * A word with blanks that is no file may be a command in its turn, as in sh -c 'python3 engine.py'. */
static bool find_file(const char *command, int *index, char path[PATH_MAX])
{
    char word[PATH_MAX];
    while (next_word(&command, word, sizeof word)) {
        if (is_file(word)) {
            if ((*index)-- == 0) {
                memcpy(path, word, sizeof word);
                return true;
            }
        } else if (strpbrk(word, BLANKS) != NULL && find_file(word, index, path)) {
            return true;
        }
    }
    return false;
}

const char *pl_process_engine_file(int index)
{
    const json_t *named = json_object_get(program.hello.answer, "files");
    if (index == 0) {
        snprintf(program.path, sizeof program.path, "/proc/%d/exe", (int)program.channel.pid);
        return program.path;
    }
    index -= 1;
    if (find_file(program.command, &index, program.path)) {
        return program.path;
    }
    for (size_t i = 0; i < json_array_size(named); ++i) {
        const char *path = json_string_value(json_array_get(named, i));
        if (path != NULL && is_file(path) && index-- == 0) {
            return path;
        }
    }
    return NULL;
}
