#include "conformance_record.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "base/program_name.h"
#include "result.h"
#include "store.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const schema = "plumb.conformance_record/1";

/* ---- The file ---- */

static const char *variable(const char *name)
{
    const char *value = getenv(name);
    return value == NULL || value[0] == '\0' ? NULL : value;
}

/* The folder of the records, malloc'd; false when there is none. */
static bool cache_folder(char **folder)
{
    const char *own = variable("PLUMB_CACHE");
    const char *caches = variable("XDG_CACHE_HOME");
    const char *home = variable("HOME");
    *folder = own != NULL      ? pl_heap_copy(own)
              : caches != NULL ? pl_heap_format("%s/plumb", caches)
              : home != NULL   ? pl_heap_format("%s/.cache/plumb", home)
                               : NULL;
    return *folder != NULL;
}

/* The names in a record's path have only letters, digits, '_', '-' and '.'. */
static void make_safe(char *name)
{
    for (; *name != '\0'; ++name) {
        const unsigned char c = (unsigned char)*name;
        *name = (char)(isalnum(c) || strchr("_-.", c) != NULL ? c : '_');
    }
}

/* The path of a record: malloc'd. */
static char *record_path(const char *folder, const pl_engine_info *engine, const char *profile)
{
    char names[2][PL_NAME_SIZE];
    snprintf(names[0], sizeof names[0], "%s", engine->name);
    snprintf(names[1], sizeof names[1], "%s", profile);
    make_safe(names[0]);
    make_safe(names[1]);
    return pl_heap_format("%s/conformance-%s-%s-%s.json", folder, engine->binary, names[0],
                          names[1]);
}

/* ---- Writing ---- */

static json_t *record_of(const pl_engine_info *engine, const char *profile, int checks, int failed,
                         int skipped)
{
    char now[32];
    pl_timestamp(now);
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:{s:s, s:s}, s:s}", "schema",
                     schema, "engine", engine->name, "engine_version", engine->version,
                     "engine_binary", engine->binary, "profile", profile, "outcome",
                     failed > 0 ? "failed" : "passed", "checks", checks, "failed", failed,
                     "skipped", skipped, PL_PROGRAM, "version", PLUMB_VERSION, "git", PLUMB_GIT,
                     "time", now);
}

pl_status pl_conformance_record_write(const pl_engine_info *engine, const char *profile, int checks,
                                      int failed, int skipped, pl_error *error)
{
    char *folder;
    if (engine->binary[0] == '\0' || !cache_folder(&folder)) {
        return PL_OK;
    }
    char *path = record_path(folder, engine, profile);
    json_t *record = record_of(engine, profile, checks, failed, skipped);
    pl_status status = pl_make_directories(folder, error);
    if (status == PL_OK) {
        status = pl_results_write_json(path, record, error);
    }
    json_decref(record);
    free(path);
    free(folder);
    return status;
}

/* ---- Reading ---- */

static bool text_is(const json_t *record, const char *key, const char *expected)
{
    return strcmp(pl_json_get_text(record, key), expected) == 0;
}

static bool count_of(const json_t *record, const char *key, int *count)
{
    const json_t *value = json_object_get(record, key);
    const json_int_t found = json_integer_value(value);
    *count = (int)found;
    return json_is_integer(value) && found >= 0 && found <= 1000000;
}

/* Whether the record is whole, of this engine, and agrees with itself. */
static bool is_record(const json_t *record, const pl_engine_info *engine, const char *profile)
{
    int checks, failed, skipped;
    return text_is(record, "schema", schema) && text_is(record, "engine", engine->name) &&
           text_is(record, "engine_version", engine->version) &&
           text_is(record, "engine_binary", engine->binary) &&
           text_is(record, "profile", profile) && count_of(record, "checks", &checks) &&
           count_of(record, "failed", &failed) && count_of(record, "skipped", &skipped) &&
           checks > 0 && failed <= checks &&
           text_is(record, "outcome", failed > 0 ? "failed" : "passed") &&
           pl_json_get_text(json_object_get(record, PL_PROGRAM), "version")[0] != '\0';
}

json_t *pl_conformance_find(const pl_engine_info *engine, const char *profile)
{
    char *folder;
    if (engine->binary[0] == '\0' || !cache_folder(&folder)) {
        return json_null();
    }
    char *path = record_path(folder, engine, profile);
    json_t *record = json_load_file(path, JSON_REJECT_DUPLICATES, NULL);
    json_t *found =
        !is_record(record, engine, profile)
            ? json_null()
            : json_pack("{s:O, s:O, s:O, s:O}", "outcome", json_object_get(record, "outcome"),
                        "checks", json_object_get(record, "checks"), "failed",
                        json_object_get(record, "failed"), PL_PROGRAM,
                        json_object_get(json_object_get(record, PL_PROGRAM), "version"));
    json_decref(record);
    free(path);
    free(folder);
    return found;
}
