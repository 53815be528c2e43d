/* The page of a study, made of the JSON that its command writes. */
#ifndef PLUMB_STUDY_PAGE_H
#define PLUMB_STUDY_PAGE_H

#include "plumb/base.h"

#include <jansson.h>

enum { PL_STUDY_KIND_SIZE = 32 };

/* Reads the JSON of a study from a file: an object, an array, or objects in lines, which become an
 * array. *study is a new reference, and `kind` the word of its schema, such as "threshold" of
 * plumb.threshold/1. PL_BAD_INPUT: FILE:LINE:COLUMN, or that it is no study. PL_IO. */
pl_status pl_study_read(const char *path, json_t **study, char kind[PL_STUDY_KIND_SIZE],
                        pl_error *error);

/* Writes DIRECTORY/NAME.html, renamed to its place when it is complete. PL_IO. */
pl_status pl_study_page_write(const char *directory, const char *name, const char *kind,
                              json_t *study, pl_error *error);

#endif
