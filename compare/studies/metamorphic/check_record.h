/* The result of a check as a study's journal keeps it, with every digit. */
#ifndef PLUMB_CHECK_RECORD_H
#define PLUMB_CHECK_RECORD_H

#include "metamorphic.h"

/* A new reference; NULL when out of memory. */
json_t *pl_check_record_make(const pl_check_result *result);

/* Fills all of *result but its check. False, which changes nothing, for JSON that is no record. */
bool pl_check_record_read(const json_t *record, pl_check_result *result);

#endif
