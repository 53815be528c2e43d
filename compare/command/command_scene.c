/* plumb scene SCENARIO: the scene as JSON, to edit and run. */
#include "commands.h"
#include "selection.h"

#include <stdlib.h>

typedef struct options {
    pl_selection selection;
    pl_texts names;
} options;

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->selection;
        return 0;
    case ARGP_KEY_ARG:
        if (o->names.count > 0) {
            argp_error(state, "one scenario at a time; found also \"%s\"", text);
        }
        pl_texts_add(&o->names, text);
        return 0;
    case ARGP_KEY_NO_ARGS:
        argp_error(state, "which scenario? See plumb list scenarios");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&pl_selection_argp, 0, NULL, 0}, {0}};
static const struct argp argp = {.parser = parse,
                                 .args_doc = "SCENARIO|SCENE.json",
                                 .doc = "Prints a scenario as a scene file.\v"
                                        "Examples:\n"
                                        "  plumb scene tower --set n=3 > mine.json\n"
                                        "  plumb compare ./mine.json",
                                 .children = children};

int pl_command_scene(const pl_call *call)
{
    options o = {.selection = pl_selection_default()};
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    int code = PL_EXIT_OK;
    const pl_asked asked = {.name = o.names.items[0]};
    if (pl_selection_add(&o.selection, &asked, 1, &plan, &error) != PL_OK) {
        code = pl_call_fail(call, &error);
        goto cleanup;
    }
    char *text = pl_scene_to_text(&plan.cases[0].scene);
    if (text == NULL) {
        pl_fail(&error, PL_NO_MEMORY, "out of memory");
        code = pl_call_fail(call, &error);
        goto cleanup;
    }
    puts(text);
    free(text);

cleanup:
    pl_plan_free(&plan);
    pl_selection_free(&o.selection);
    free(o.names.items);
    return code;
}
