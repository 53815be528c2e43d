/* plumb scene SCENARIO: the scene as JSON, to edit and run, or as MJCF, for MuJoCo's tools. */
#include "adapters/mujoco/mjcf.h"
#include "base/heap.h"
#include "request.h"

#include <stdlib.h>
#include <string.h>

/* The options of the command. */
typedef struct scene_request {
    pl_request request; /* must be first */
    bool mjcf;
} scene_request;

static pl_status parse_format(void *options, const char *text, pl_error *error)
{
    scene_request *scene = options;
    if (strcmp(text, "json") != 0 && strcmp(text, "mjcf") != 0) {
        return pl_fail(error, PL_BAD_INPUT, "--format takes json or mjcf; found \"%s\"", text);
    }
    scene->mjcf = strcmp(text, "mjcf") == 0;
    return PL_OK;
}

static const pl_option format_options[] = {
    {"format", "FORMAT", "json (the default), or mjcf: a model for MuJoCo", PL_OPTION_PARSED,
     .parse = parse_format, .values = "json|mjcf"},
    {0}};

static pl_status check(void *options, pl_error *error)
{
    const pl_request *request = options;
    return request->names.count > 1
               ? pl_fail(error, PL_BAD_INPUT, "one scenario at a time; found also \"%s\"",
                         request->names.items[1])
               : pl_request_check(request, "which scenario? See plumb list scenarios", NULL, error);
}

static void print_json(const pl_scene *scene)
{
    char *text = pl_scene_to_text(scene);
    if (text == NULL) {
        pl_out_of_memory();
    }
    puts(text);
    free(text);
}

/* A scene that MJCF cannot express is bad input here: no engine was asked to run. */
static pl_status print_mjcf(const pl_scene *scene, pl_error *error)
{
    pl_text_buffer text = {0};
    pl_error why = {.message = ""};
    pl_status status = pl_mjcf_write(scene, &text, &why);
    if (status == PL_OK) {
        fputs(text.data, stdout);
    } else {
        status = status == PL_UNSUPPORTED ? PL_BAD_INPUT : status;
        status = pl_fail(error, status, "--format mjcf: %s", why.message);
    }
    pl_text_free(&text);
    return status;
}

static int run(const pl_call *call)
{
    scene_request own = {.request = pl_request_default()};
    pl_call_parse(call, &own);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    pl_status status = pl_request_add_cases(&own.request, &plan, &error);
    if (status == PL_OK && own.mjcf) {
        status = print_mjcf(&plan.cases[0].scene, &error);
    } else if (status == PL_OK) {
        print_json(&plan.cases[0].scene);
    }
    pl_plan_free(&plan);
    pl_request_free(&own.request);
    return pl_call_end(call, status, &error, 0, PL_EXIT_OK);
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
