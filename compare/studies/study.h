/* A study: it proposes runs, they are made, and from their results follow a conclusion and a document.
 *
 *     options ──propose──▶ plan ──execute──▶ results.jsonl ──conclude──▶ plumb.KIND/1 ──document──▶ text, page …
 *
 * Each run has what the conclusion needs to know of the study in its result, as the object `study`: "name", and the
 * settings of the study. So runs are resumed by their own keys, and `plumb report` concludes again from the results
 * alone. A study whose runs depend on earlier ones proposes them in rounds.
 *
 * A study is a file of its folder that defines pl_NAME_study, command/command_NAME.c, which calls pl_study_main, a line of
 * command/commands.def, and a test. */
#ifndef PLUMB_STUDY_H
#define PLUMB_STUDY_H

#include "base/document.h"
#include "plumb/base.h"

#include <jansson.h>

/* A kind of study. */
typedef struct pl_study {
    const char *name; /* of its command, and of its files NAME.json, NAME.md, NAME.csv, NAME.html */
    const char *kind; /* of its conclusion, plumb.KIND/1 */
    /* Makes the conclusion from an array of results of the study, oldest first. `folder` has the files
     * that runs left next to results.jsonl. The conclusion is a new reference. PL_BAD_INPUT: a result lacks what the study needs.
     * NULL if the results are of no study: the command then concludes. */
    pl_status (*conclude)(const json_t *results, const char *folder, json_t **conclusion,
                          pl_error *error);
    /* Fills a document from a conclusion, which may be of a file. */
    void (*document)(const json_t *conclusion, pl_document *document);
} pl_study;

/* ---- What results and conclusions say ----
 *
 * A path is a key, or several with dots between them: "study.case". */

/* The value at a path, borrowed; NULL: there is none. */
json_t *pl_study_get(const json_t *object, const char *path);

/* The number at a path; NAN: there is none. */
double pl_study_number(const json_t *object, const char *path);

/* The whole number at a path; 0: there is none. */
int pl_study_integer(const json_t *object, const char *path);

/* The text at a path, borrowed; "": there is none. */
const char *pl_study_text(const json_t *object, const char *path);

/* The values at these paths (up to a NULL), as a text that tells results apart. The caller frees. */
char *pl_study_key(const json_t *result, const char *const *paths);

/* The elements of an array by their pl_study_key, in the order of the first of each: an object of arrays, a new
 * reference. */
json_t *pl_study_groups(const json_t *items, const char *const *paths);

/* Adds to the document what `add` says of each of these groups. */
void pl_study_add_groups(pl_document *document, const json_t *items, const char *const *paths,
                         void (*add)(pl_document *document, const json_t *group));

/* Copies these keys (up to a NULL) of an object to another; absent ones are left out. */
void pl_study_copy(json_t *to, const json_t *from, const char *const *keys);

/* Whether the run of a result came to its end, as expected or collapsed. */
bool pl_study_ended(const json_t *result);

/* A new object with what a result says of its scene, its engine and its settings: the keys that all runs of a search
 * share, and the keys `more` (up to a NULL). */
json_t *pl_study_row(const json_t *result, const char *const *more);

/* The parameters by name, such as "friction = 0.5, n = 60"; "" for none. The caller frees. */
char *pl_study_params(const json_t *params);

#endif
