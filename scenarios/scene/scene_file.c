/* Scene files and texts: where a text comes from, and the files that it may name. */
#include "scene_file.h"

#include "base/file_text.h"
#include "base/json_text.h"
#include "scene_read.h"

#include <stdlib.h>
#include <string.h>

static bool read_parameters(const json_t *json, void *user, pl_diagnostic *diagnostic)
{
    return pl_read_parameters(json, user, diagnostic);
}

static bool has_word(const pl_scene_file *file, const char *word)
{
    return memmem(file->text, file->length, word, strlen(word)) != NULL;
}

/* Most files have no such key, and no escapes that may hide it. They are not parsed for it. */
static pl_status find_parameters(pl_scene_file *file, pl_error *error)
{
    static const pl_json_kind kind = {
        .noun = "scene", .most_bytes = PL_MAX_SCENE_BYTES, .read = read_parameters};
    return !has_word(file, "\"parameters\"") && !has_word(file, "\\u")
               ? PL_OK
               : pl_json_read_text(&kind, file->text, file->length, pl_file_label(file->path),
                                   &file->parameters, error);
}

pl_status pl_scene_file_open(const char *path, pl_scene_file **file, pl_error *error)
{
    const pl_file_kind kind = {.noun = "scene", .most_bytes = PL_MAX_SCENE_BYTES};
    /* The path up to its last slash. */
    const char *slash = strrchr(path, '/');
    const size_t folder_length = slash == NULL ? 0 : (size_t)(slash + 1 - path);
    pl_scene_file *made = calloc(1, sizeof *made);
    *file = NULL;
    if (made != NULL) {
        made->path = strdup(path);
        made->folder = strndup(path, folder_length);
    }
    pl_status status = made == NULL || made->path == NULL || made->folder == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path)
                           : pl_file_read(&kind, path, &made->text, &made->length, error);
    if (status == PL_OK) {
        status = find_parameters(made, error);
    }
    if (status != PL_OK) {
        pl_scene_file_close(made);
        return status;
    }
    *file = made;
    return PL_OK;
}

pl_status pl_scene_file_read(const pl_scene_file *file, const double *values, pl_scene *scene,
                             pl_error *error)
{
    const pl_scene_text source = {.text = file->text,
                                  .length = file->length,
                                  .label = pl_file_label(file->path),
                                  .folder = file->folder,
                                  .values = values};
    return pl_scene_read(&source, scene, error);
}

void pl_scene_file_close(pl_scene_file *file)
{
    if (file != NULL) {
        free(file->path);
        free(file->folder);
        free(file->text);
        free(file);
    }
}

pl_status pl_scene_read_text(const char *text, size_t length, const char *label, pl_scene *scene,
                             pl_error *error)
{
    const pl_scene_text source = {.text = text, .length = length, .label = label};
    return pl_scene_read(&source, scene, error);
}

pl_status pl_scene_read_file(const char *path, pl_scene *scene, pl_error *error)
{
    pl_scene_file *file = NULL;
    *scene = pl_scene_default();
    pl_status status = pl_scene_file_open(path, &file, error);
    if (status == PL_OK) {
        status = pl_scene_file_read(file, NULL, scene, error);
    }
    pl_scene_file_close(file);
    return status;
}
