/* A study: it proposes runs, they are made, and from their results follow a conclusion and a document.
 *
 *     options ──propose──▶ plan ──execute──▶ results.jsonl ──conclude──▶ plumb.KIND/1 ──document──▶ text, page …
 *
 * Each run has what the conclusion needs to know of the study in its result, as the object `study`: "name", and the
 * settings of the study. So runs are resumed by their own keys, and `plumb report` concludes again from the results
 * alone. A study whose runs depend on earlier ones proposes them in rounds. */
#ifndef PLUMB_STUDY_H
#define PLUMB_STUDY_H

#include "base/document.h"
#include "plumb/base.h"

#include <jansson.h>

/* A kind of study. */
typedef struct pl_study {
    const char *name; /* of its command, and of its files NAME.json, NAME.md, NAME.html */
    const char *kind; /* of its conclusion, plumb.KIND/1 */
    /* Makes the conclusion from an array of results of the study, oldest first. `folder` has the files
     * that runs left next to results.jsonl. The conclusion is a new reference. PL_BAD_INPUT: a result lacks what the study needs.
     * NULL: the results are of no study, and the command concludes. */
    pl_status (*conclude)(const json_t *results, const char *folder, json_t **conclusion,
                          pl_error *error);
    /* Fills a document from a conclusion, which may be of a file. */
    void (*document)(const json_t *conclusion, pl_document *document);
} pl_study;

/* The values of these keys (up to a NULL) of a result, as a text that tells results apart. The caller frees. */
char *pl_study_key(const json_t *result, const char *const *keys);

/* "friction = 0.5, n = 60": parameters by name; "" for none. The caller frees. */
char *pl_study_params(const json_t *params);

#endif
