#include "journal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char schema[] = "plumb.journal/1";

struct pl_journal {
    pl_store *store;
    char *path;
    json_t *left; /* key -> array of the values that were not taken, oldest first */
};

static pl_status sort_by_key(pl_journal *journal, pl_error *error)
{
    size_t index;
    json_t *line;
    json_array_foreach(pl_store_results(journal->store), index, line)
    {
        const char *key = json_string_value(json_object_get(line, "run"));
        json_t *values = json_object_get(journal->left, key);
        if (values == NULL) {
            values = json_array();
            if (json_object_set_new(journal->left, key, values) != 0) {
                return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", journal->path);
            }
        }
        if (json_array_append(values, json_object_get(line, "value")) != 0) {
            return pl_fail(error, PL_BAD_INPUT, "%s.jsonl:%zu:1: a line without a value",
                           journal->path, index + 1);
        }
    }
    return PL_OK;
}

pl_status pl_journal_open(const char *folder, const char *name, const char *study,
                          pl_store_mode mode, pl_journal **journal, pl_error *error)
{
    char *path = NULL;
    pl_journal *made = calloc(1, sizeof *made);
    *journal = NULL;
    if (access(folder, W_OK) != 0 && (errno == EACCES || errno == EROFS)) {
        free(made);
        return PL_OK;
    }
    if (made == NULL ||
        asprintf(&made->path, "%s/plumb-%s-%s.unfinished", folder, name, study) < 0) {
        free(made);
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    if (asprintf(&path, "%s.jsonl", made->path) < 0) {
        free(made->path);
        free(made);
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    made->left = json_object();
    pl_status status = pl_store_open_file(
        path, schema, mode,
        "has runs of an unfinished study: --resume continues it, and --force discards them",
        &made->store, error);
    if (status == PL_OK) {
        status = sort_by_key(made, error);
    }
    free(path);
    if (status != PL_OK) {
        pl_journal_close(made, false);
        return status;
    }
    *journal = made;
    return PL_OK;
}

const char *pl_journal_path(const pl_journal *journal)
{
    return journal->path;
}

json_t *pl_journal_take(pl_journal *journal, const char *key)
{
    json_t *values = journal == NULL ? NULL : json_object_get(journal->left, key);
    json_t *value = json_incref(json_array_get(values, 0));
    json_array_remove(values, 0);
    return value;
}

pl_status pl_journal_add(pl_journal *journal, const char *key, json_t *value, pl_error *error)
{
    if (journal == NULL) {
        return PL_OK;
    }
    json_t *line = json_pack("{s:s, s:s, s:O}", "schema", schema, "run", key, "value", value);
    pl_status status = line == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "%s: out of memory", journal->path)
                           : pl_store_append(journal->store, line, error);
    json_decref(line);
    return status;
}

size_t pl_journal_size(const pl_journal *journal)
{
    return json_array_size(pl_store_results(journal->store));
}

void pl_journal_close(pl_journal *journal, bool finished)
{
    if (journal == NULL) {
        return;
    }
    const bool is_empty = journal->store != NULL && pl_journal_size(journal) == 0;
    if (journal->store != NULL && (finished || is_empty)) {
        pl_store_remove(journal->store, finished);
    }
    pl_store_close(journal->store);
    json_decref(journal->left);
    free(journal->path);
    free(journal);
}
