/* plumb scene SCENARIO: the scene as JSON, to edit and run. */
#include "request.h"

#include <stdlib.h>

static pl_status check(void *options, pl_error *error)
{
    const pl_request *request = options;
    return request->names.count > 1
               ? pl_fail(error, PL_BAD_INPUT, "one scenario at a time; found also \"%s\"",
                         request->names.items[1])
               : pl_request_check(request, "which scenario? See plumb list scenarios", NULL, error);
}

static int run(const pl_call *call)
{
    pl_request request = pl_request_default();
    pl_call_parse(call, &request);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    pl_status status = pl_request_add_cases(&request, &plan, &error);
    if (status == PL_OK) {
        char *text = pl_scene_to_text(&plan.cases[0].scene);
        if (text == NULL) {
            status = pl_fail(&error, PL_NO_MEMORY, "out of memory");
        } else {
            puts(text);
        }
        free(text);
    }
    pl_plan_free(&plan);
    pl_request_free(&request);
    return pl_call_end(call, status, &error, 0, PL_EXIT_OK);
}

const pl_command pl_command_scene = {.name = "scene",
                                     .summary = "print a scenario as a scene file, to edit and run",
                                     .arguments = "SCENARIO|SCENE.json",
                                     .description = "Prints a scenario as a scene file.",
                                     .notes = "Examples:\n"
                                              "  plumb scene tower --set n=3 > mine.json\n"
                                              "  plumb compare ./mine.json",
                                     .shared = {pl_scene_options},
                                     .check = check,
                                     .run = run};
