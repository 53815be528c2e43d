#include "study_list.h"

#include "studies/threshold/threshold.h"

#include <string.h>

const pl_study *const *pl_studies(int *count)
{
    static const pl_study *const studies[] = {&pl_threshold_study};
    *count = (int)(sizeof studies / sizeof *studies);
    return studies;
}

const pl_study *pl_study_find(const char *name)
{
    int count = 0;
    const pl_study *const *studies = pl_studies(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(studies[i]->name, name) == 0) {
            return studies[i];
        }
    }
    return NULL;
}
