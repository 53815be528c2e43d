/* plumb view: opens the page of a report or of a study. */
#include "base/heap.h"
#include "request.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The pages that commands write, the first that is there is opened. */
static const char *const pages[] = {"index.html",     "sweep.html",       "ensemble.html",
                                    "threshold.html", "metamorphic.html", "tune.html"};

static bool is_file(const char *path)
{
    struct stat information;
    return stat(path, &information) == 0 && S_ISREG(information.st_mode);
}

static pl_status find_page(const char *name, char **path, pl_error *error)
{
    for (size_t i = 0; i <= sizeof pages / sizeof pages[0]; ++i) {
        *path = i == 0 ? pl_heap_copy(name) : pl_heap_format("%s/%s", name, pages[i - 1]);
        const char *ending = strrchr(*path, '.');
        if (is_file(*path) && ending != NULL && strcmp(ending, ".html") == 0) {
            return PL_OK;
        }
        free(*path);
        *path = NULL;
    }
    return pl_fail(error, PL_BAD_INPUT, "%.200s has no page; plumb report %.200s makes one", name,
                   name);
}

static pl_status check(void *user, pl_error *error)
{
    const pl_request *request = user;
    return request->names.count > 1
               ? pl_fail(error, PL_BAD_INPUT, "one page at a time; found also \"%s\"",
                         request->names.items[1])
               : PL_OK;
}

static int run(const pl_call *call)
{
    pl_request request = pl_request_default();
    char *path = NULL;
    pl_call_parse(call, &request);
    const char *name = request.names.count == 0 ? "report" : request.names.items[0];
    pl_call_need(call, find_page(name, &path, call->error));
    printf("%s\n", path);
    pl_call_need(call, pl_open_page(path, call->error));
    free(path);
    pl_request_free(&request);
    return PL_EXIT_OK;
}

const pl_command pl_command_view = {
    .name = "view",
    .summary = "open the page of a report or a study",
    .arguments = "[RESULTS]",
    .description =
        "Opens the page of RESULTS, a folder that a command wrote (default report) or an "
        "HTML file, with the program of the environment variable BROWSER, else with "
        "xdg-open, and prints its path.",
    .notes = "Examples:\n"
             "  plumb view\n"
             "  plumb view sweep",
    .check = check,
    .run = run};
