/* The list of all studies. */
#ifndef PLUMB_STUDY_LIST_H
#define PLUMB_STUDY_LIST_H

#include "studies/study.h"

/* All of them, in the order of reports. Static storage. */
const pl_study *const *pl_studies(int *count);

/* The study with conclusions plumb.KIND/1; NULL: none. */
const pl_study *pl_study_find(const char *kind);

#endif
