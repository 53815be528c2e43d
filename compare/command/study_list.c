/* The list of all studies. */
#include "study_command.h"

#include <string.h>

const pl_study *const *pl_studies(int *count)
{
    static const pl_study *const studies[] = {
#define COMMAND(name)
#define STUDY(name) &pl_##name##_study,
#include "commands.def"
    };
    *count = (int)(sizeof studies / sizeof(const pl_study *));
    return studies;
}

const pl_study *pl_study_find(const char *kind)
{
    int count = 0;
    const pl_study *const *studies = pl_studies(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(studies[i]->kind, kind) == 0) {
            return studies[i];
        }
    }
    return NULL;
}
