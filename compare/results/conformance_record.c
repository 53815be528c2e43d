#include "result.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "base/program_name.h"
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

/* The folder of the records, malloc'd; NULL: there is none, or the engine has no hash. */
static char *cache_folder(const pl_engine_info *engine)
{
    const char *own = variable("PLUMB_CACHE");
    const char *caches = variable("XDG_CACHE_HOME");
    const char *home = variable("HOME");
    return engine->binary[0] == '\0' ? NULL
           : own != NULL             ? pl_heap_copy(own)
           : caches != NULL          ? pl_heap_format("%s/plumb", caches)
           : home != NULL            ? pl_heap_format("%s/.cache/plumb", home)
                                     : NULL;
}

/* The path of a record: malloc'd. Its name has only letters, digits, '_', '-' and '.'. */
static char *record_path(const char *folder, const pl_engine_info *engine, const char *profile)
{
    char *name = pl_heap_format("conformance-%s-%s-%s.json", engine->binary, engine->name, profile);
    for (char *c = name; *c != '\0'; ++c) {
        *c = (char)(isalnum((unsigned char)*c) || strchr("_-.", *c) != NULL ? *c : '_');
    }
    char *path = pl_heap_format("%s/%s", folder, name);
    free(name);
    return path;
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
    char *folder = cache_folder(engine);
    if (folder == NULL) {
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

/* Whether the record is whole, of this engine, and agrees with itself: what it must say changes nothing. */
static bool is_record(json_t *record, const pl_engine_info *engine, const char *profile)
{
    int checks, failed, skipped;
    if (json_unpack(record, "{s:i, s:i, s:i}", "checks", &checks, "failed", &failed, "skipped",
                    &skipped) != 0) {
        return false;
    }
    json_t *said = json_copy(record);
    json_t *expected = record_of(engine, profile, checks, failed, skipped);
    json_object_del(expected, PL_PROGRAM);
    json_object_del(expected, "time");
    json_object_update_new(said, expected);
    const bool is_whole =
        checks > 0 && failed >= 0 && failed <= checks && skipped >= 0 && json_equal(said, record) &&
        pl_json_get_text(json_object_get(record, PL_PROGRAM), "version")[0] != '\0';
    json_decref(said);
    return is_whole;
}

json_t *pl_conformance_find(const pl_engine_info *engine, const char *profile)
{
    char *folder = cache_folder(engine);
    if (folder == NULL) {
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
