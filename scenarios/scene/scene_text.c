/* Scene files: their text to a scene. */
#include "base/json_text.h"
#include "scene_read.h"

#include <stdlib.h>
#include <string.h>

/* A scene to fill, and the folder of files that it names. */
typedef struct request {
    pl_scene *scene;
    const char *folder;
} request;

static bool read_scene(const json_t *json, void *user, pl_diagnostic *diagnostic)
{
    const request *wanted = user;
    return pl_scene_from_json(json, wanted->folder, wanted->scene, diagnostic);
}

static const pl_json_kind scene_kind = {
    .noun = "scene", .most_bytes = PL_MAX_SCENE_BYTES, .read = read_scene};

static pl_status keep(pl_status status, pl_scene *scene)
{
    if (status != PL_OK) {
        pl_scene_free(scene);
    }
    return status;
}

pl_status pl_scene_read_text(const char *text, size_t length, const char *label, pl_scene *scene,
                             pl_error *error)
{
    *scene = pl_scene_default();
    request wanted = {.scene = scene};
    return keep(pl_json_read_text(&scene_kind, text, length, label, &wanted, error), scene);
}

/* The path up to its last slash; "" where it has none, as standard input has none. */
static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const size_t length = slash == NULL ? 0 : (size_t)(slash + 1 - path);
    char *folder = malloc(length + 1);
    if (folder != NULL) {
        memcpy(folder, path, length);
        folder[length] = '\0';
    }
    return folder;
}

pl_status pl_scene_read_file(const char *path, pl_scene *scene, pl_error *error)
{
    *scene = pl_scene_default();
    char *folder = folder_of(path);
    if (folder == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path);
    }
    request wanted = {.scene = scene, .folder = folder};
    const pl_status status = pl_json_read_file(&scene_kind, path, &wanted, error);
    free(folder);
    return keep(status, scene);
}
