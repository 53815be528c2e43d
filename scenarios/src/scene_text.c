/* Scene files: their text to a scene. */
#include "json_text.h"
#include "scene_read.h"

static bool read_scene(const json_t *json, void *scene, pl_complaint *complaint)
{
    return pl_scene_from_json(json, scene, complaint);
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
    return keep(pl_json_read_text(&scene_kind, text, length, label, scene, error), scene);
}

pl_status pl_scene_read_file(const char *path, pl_scene *scene, pl_error *error)
{
    *scene = pl_scene_default();
    return keep(pl_json_read_file(&scene_kind, path, scene, error), scene);
}
