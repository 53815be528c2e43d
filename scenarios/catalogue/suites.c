/* The suites: which scenarios are run together. */
#include "plumb/scenario.h"

#include <string.h>

static const char *const canonical[] = {"tower", "slope-stick",   "slope-slide",
                                        "wall",  "wall-collapse", NULL};

static const pl_suite suites[] = {
    {.name = "canonical",
     .description = "stacks, friction slope, wall and wall collapse: the default",
     .scenarios = canonical}};
enum { SUITE_COUNT = sizeof suites / sizeof suites[0] };

const pl_suite *pl_suites(int *count)
{
    *count = SUITE_COUNT;
    return suites;
}

const pl_suite *pl_suite_find(const char *name, pl_error *error)
{
    const char *names[SUITE_COUNT];
    for (int i = 0; i < SUITE_COUNT; i++) {
        names[i] = suites[i].name;
        if (strcmp(name, names[i]) == 0) {
            return &suites[i];
        }
    }
    const char *nearest = pl_nearest_name(name, names, SUITE_COUNT);
    pl_fail(error, PL_BAD_INPUT, "unknown suite \"%s\"; did you mean \"%s\"?", name,
            nearest != NULL ? nearest : names[0]);
    return NULL;
}
