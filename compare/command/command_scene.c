/* plumb scene SCENARIO: the scene as JSON, to edit and run, or as MJCF, for MuJoCo's tools. */
#include "adapters/mujoco/mjcf.h"
#include "base/heap.h"
#include "request.h"

#include <stdlib.h>
#include <string.h>

/* The options of the command. */
typedef struct scene_request {
    pl_request request;
    int is_mjcf;
} scene_request;

static const pl_option format_options[] = {
    {"format", "FORMAT", "json (the default), or mjcf: a model for MuJoCo", PL_OPTION_CHOICE,
     .field = offsetof(scene_request, is_mjcf), .values = "json|mjcf"},
    {0}};

static pl_status check(void *options, pl_error *error)
{
    const pl_request *request = options;
    return request->names.count > 1
               ? pl_fail(error, PL_BAD_INPUT, "one scenario at a time; found also \"%s\"",
                         request->names.items[1])
               : pl_request_check(request, "which scenario? See plumb list scenarios", NULL, error);
}

/* A scene that MJCF cannot express is bad input here: no engine was asked to run. */
static pl_status write_mjcf(const pl_scene *scene, pl_text_buffer *text, pl_error *error)
{
    pl_error why = {.message = ""};
    const pl_status status = pl_mjcf_write(scene, text, &why);
    return status == PL_OK ? PL_OK
                           : pl_fail(error, status == PL_UNSUPPORTED ? PL_BAD_INPUT : status,
                                     "--format mjcf: %s", why.message);
}

static int run(const pl_call *call)
{
    scene_request own = {.request = pl_request_default()};
    pl_call_parse(call, &own);
    pl_plan plan = {.repeats = 1};
    pl_text_buffer mjcf = {0};
    pl_call_need(call, pl_request_add_cases(&own.request, &plan, call->error));
    const pl_scene *scene = &plan.cases[0].scene;
    if (own.is_mjcf) {
        pl_call_need(call, write_mjcf(scene, &mjcf, call->error));
    }
    char *text = own.is_mjcf ? pl_text_take(&mjcf) : pl_scene_to_text(scene);
    if (text == NULL) {
        pl_out_of_memory();
    }
    printf("%s%s", text, own.is_mjcf ? "" : "\n");
    free(text);
    pl_plan_free(&plan);
    pl_request_free(&own.request);
    return PL_EXIT_OK;
}

const pl_command pl_command_scene = {.name = "scene",
                                     .summary = "print a scenario as a scene file, to edit and run",
                                     .arguments = "SCENARIO|SCENE.json",
                                     .description =
                                         "Prints a scenario as a scene file, or as a model in "
                                         "MuJoCo's format.",
                                     .notes = "Examples:\n"
                                              "  plumb scene tower --set n=3 > mine.json\n"
                                              "  plumb compare ./mine.json\n"
                                              "  plumb scene ramp.json --set mu=0.3 > low.json\n"
                                              "  plumb scene tower --format mjcf > tower.xml",
                                     .options = format_options,
                                     .shared = {pl_scene_options, pl_file_options},
                                     .check = check,
                                     .run = run};
