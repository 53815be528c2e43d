#include "study_list.h"

#include "studies/threshold/threshold.h"
#include "studies/tune/tune.h"

#include <string.h>

const pl_study *const *pl_studies(int *count)
{
    static const pl_study *const studies[] = {&pl_threshold_study, &pl_tune_study};
    *count = (int)(sizeof studies / sizeof *studies);
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
