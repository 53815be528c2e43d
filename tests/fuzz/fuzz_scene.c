/* Any bytes as a scene file: they are read or refused with their place. What is read is written,
 * read and written again to the same text. */
#include "fuzz.h"
#include "plumb/scenario.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pl_scene scene, again;
    pl_error error = {.message = ""};
    if (pl_scene_read_text((const char *)data, size, "input", &scene, &error) != PL_OK) {
        int line = 0, column = 0;
        fuzz_check(sscanf(error.message, "input:%d:%d: ", &line, &column) == 2 && line >= 1 &&
                       column >= 1,
                   "what is refused has a line and a column");
        return 0;
    }
    fuzz_check(pl_scene_validate(&scene, NULL) == PL_OK, "what is read is valid");
    fuzz_check(pl_scene_needs(&scene) >= PL_NEEDS_PLANE, "every scene needs a shape");
    char *text = pl_scene_to_text(&scene);
    fuzz_check(text != NULL, "what is read can be written");
    fuzz_check(pl_scene_read_text(text, strlen(text), "again", &again, &error) == PL_OK,
               "what is written can be read");
    char *second = pl_scene_to_text(&again);
    fuzz_check(second != NULL && strcmp(text, second) == 0, "it reads back to the same");
    free(text);
    free(second);
    pl_scene_free(&scene);
    pl_scene_free(&again);
    return 0;
}
