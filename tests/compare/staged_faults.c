#include "staged_faults.h"

#include <dlfcn.h>
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

staged_state staged;

/* ---- Output ---- */

static void fail_print(void)
{
    printf("from the engine\n");
    fprintf(stderr, "and on its standard error\n");
}

static void flood(FILE *file, const char *end)
{
    for (int i = 0; i < 1 << 16; ++i) {
        fprintf(file, "%031d%s", i, end);
    }
    fflush(file);
}

static void fail_flood(void)
{
    flood(stdout, "\n");
}

static void fail_errors(void)
{
    static char buffer[1 << 16];
    setvbuf(stderr, buffer, _IOFBF, sizeof buffer);
    flood(stderr, "\n");
}

static void fail_line(void)
{
    flood(stdout, "");
}

static void fail_escape(void)
{
    const char text[] = "\033[31mred\0\a\177 \302\23331m\377\n";
    fwrite(text, 1, sizeof text, stdout);
    fflush(stdout);
}

/* ---- What functions return ---- */

static void fail_silent(void)
{
    staged.returned = PL_FAILED;
}

static void fail_status(void)
{
    staged.returned = (pl_status)77;
}

static void fail_refusal(void)
{
    staged.returned = PL_UNSUPPORTED;
}

static void fail_endless(void)
{
    static char text[512];
    memset(text, 'x', sizeof text);
    staged.returned = PL_FAILED;
    staged.message = text;
}

static void fail_nothing(void)
{
    staged.makes_nothing = true;
}

static void fail_frame(void)
{
    staged.changes_frame = true;
}

static void fail_arrays(void)
{
    staged.changes_settings = true;
}

static void fail_many(void)
{
    staged.contact_count = 2000000000;
}

static void fail_negative(void)
{
    staged.contact_count = -3;
}

static void fail_double(void)
{
    staged.doubles_contacts = true;
}

/* Puts replacement.so in the place of its own file. */
static void fail_replace(void)
{
    Dl_info info;
    if (dladdr(&staged, &info) != 0) {
        rename("replacement.so", info.dli_fname);
    }
}

static void fail_none(void)
{
}

static const staged_fault own_faults[] = {
    {"none", fail_none, 0},       {"print", fail_print, 0},     {"flood", fail_flood, 0},
    {"errors", fail_errors, 0},   {"line", fail_line, 0},       {"escape", fail_escape, 0},
    {"silent", fail_silent, 0},   {"status", fail_status, 0},   {"refusal", fail_refusal, 0},
    {"endless", fail_endless, 0}, {"nothing", fail_nothing, 0}, {"frame", fail_frame, 0},
    {"arrays", fail_arrays, 0},   {"many", fail_many, 0},       {"negative", fail_negative, 0},
    {"double", fail_double, 0},   {"replace", fail_replace, 0}, {NULL, NULL, 0},
};

/* ---- Numbers ---- */

static const field fields[] = {
    {"position", FIELD_BODY, offsetof(pl_body_state, position)},
    {"orientation", FIELD_BODY, offsetof(pl_body_state, orientation)},
    {"velocity", FIELD_BODY, offsetof(pl_body_state, velocity)},
    {"spin", FIELD_BODY, offsetof(pl_body_state, angular_velocity)},
    {"iterations", FIELD_STATS, offsetof(pl_step_stats, iterations)},
    {"residual", FIELD_STATS, offsetof(pl_step_stats, residual)},
    {"contacts", FIELD_STATS, offsetof(pl_step_stats, contacts)},
    {"islands", FIELD_STATS, offsetof(pl_step_stats, islands)},
    {"time", FIELD_STATS, offsetof(pl_step_stats, time_solve)},
    {"point", FIELD_CONTACT, offsetof(pl_contact, point)},
    {"normal", FIELD_CONTACT, offsetof(pl_contact, normal)},
    {"separation", FIELD_CONTACT, offsetof(pl_contact, separation)},
    {"body", FIELD_CONTACT, offsetof(pl_contact, body_b)},
    {"gravity", FIELD_SETTINGS, offsetof(pl_engine_settings, gravity)},
    {"dt", FIELD_SETTINGS, offsetof(pl_engine_settings, dt)},
    {"damping", FIELD_SETTINGS, offsetof(pl_engine_settings, linear_damping)},
    {"friction", FIELD_PAIR, offsetof(pl_pair_coefficients, friction)},
    {"restitution", FIELD_PAIR, offsetof(pl_pair_coefficients, restitution)},
};

static const struct {
    const char *name;
    double value;
} values[] = {{"nan", (double)NAN}, {"inf", (double)INFINITY},
              {"huge", 1e300},      {"negative", -3},
              {"zero", 0},          {"three", 3}};

static void commit_one(const staged_fault *of, const char *name)
{
    for (; of->name != NULL; ++of) {
        if (strcmp(of->name, name) == 0) {
            if (of->commit == NULL) {
                raise(of->signal);
            } else {
                of->commit();
            }
        }
    }
}

void staged_commit(const char *name)
{
    commit_one(staged_process_faults, name);
    commit_one(own_faults, name);
    const char *underscore = strchr(name, '_');
    for (size_t i = 0; underscore != NULL && i < sizeof fields / sizeof *fields; ++i) {
        const size_t length = strlen(fields[i].name);
        if (strncmp(fields[i].name, name, length) == 0 && name[length] == '_') {
            staged.field = &fields[i];
            staged.contact_count = fields[i].of == FIELD_CONTACT ? 1 : 0;
        }
    }
    for (size_t i = 0; underscore != NULL && i < sizeof values / sizeof *values; ++i) {
        staged.value = strcmp(values[i].name, underscore + 1) == 0 ? values[i].value : staged.value;
    }
}

void staged_spoil(int of, void *object)
{
    if (staged.field == NULL || (int)staged.field->of != of) {
        return;
    }
    char *at = (char *)object + staged.field->offset;
    if (of == FIELD_CONTACT && staged.field->offset == offsetof(pl_contact, body_b)) {
        const int index =
            isfinite(staged.value) && fabs(staged.value) < 100 ? (int)staged.value : 99;
        memcpy(at, &index, sizeof index);
    } else {
        memcpy(at, &staged.value, sizeof staged.value);
    }
}
