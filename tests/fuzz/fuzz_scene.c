/* Reads any bytes as a scene file. They are accepted, and then JSON, or refused with the line and
 * column of the fault. An accepted scene that is written, read and written again gives the same text. */
#include "base/file_text.h"
#include "fuzz.h"
#include "plumb/scenario.h"

#include <jansson.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pl_scene scene, again;
    pl_error error = {.message = ""};
    if (pl_scene_read_text((const char *)data, size, "input", &scene, &error) != PL_OK) {
        int line = 0, column = 0;
        fuzz_check(sscanf(error.message, "input:%d:%d: ", &line, &column) == 2 && line >= 1 &&
                       column >= 1,
                   "a refusal has a line and a column");
        return 0;
    }
    const size_t mark = pl_byte_order_mark((const char *)data, size);
    json_t *json = json_loadb((const char *)data + mark, size - mark,
                              JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, NULL);
    fuzz_check(json != NULL, "an accepted text is JSON");
    json_decref(json);
    fuzz_check(pl_scene_validate(&scene, NULL) == PL_OK, "an accepted scene is valid");
    fuzz_check(pl_scene_needs(&scene) >= PL_NEEDS_PLANE, "every scene needs a shape");
    char *text = pl_scene_to_text(&scene);
    fuzz_check(text != NULL, "an accepted scene can be written");
    fuzz_check(pl_scene_read_text(text, strlen(text), "again", &again, &error) == PL_OK,
               "a written scene can be read");
    char *second = pl_scene_to_text(&again);
    fuzz_check(second != NULL && strcmp(text, second) == 0, "the second text equals the first");
    free(text);
    free(second);
    pl_scene_free(&scene);
    pl_scene_free(&again);
    return 0;
}
