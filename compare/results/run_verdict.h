/* The whole result of a run, with the verdict on it. The outcome says how the run ended, the verdict
 * whether its answer is right. */
#ifndef PLUMB_RUN_VERDICT_H
#define PLUMB_RUN_VERDICT_H

#include "result.h"

/* The three verdicts on a run, in the order in which they are counted. */
typedef enum pl_verdict {
    PL_VERDICT_ACCURATE,   /* its primary error is at most the scene's acceptance */
    PL_VERDICT_INACCURATE, /* it is larger */
    PL_VERDICT_FAILED,  /* the outcome is not ok, or a body moved in a way that nothing explains */
    PL_VERDICT_UNJUDGED /* unsupported; or the scene states no acceptance; or the primary error has
                             no value */
} pl_verdict;
enum { PL_VERDICT_COUNT = 4 };

/* "accurate", "inaccurate", "failed", and "not judged", which is null in results. */
const char *pl_verdict_name(pl_verdict verdict);

/* The verdict of a result. One that was made without verdicts failed where its outcome says so, and
 * is else not judged. */
pl_verdict pl_verdict_of(const json_t *result);

/* The whole result: the union of identity, outcome and provenance (each borrowed), with `schema`,
 * `output` (null when `output` is empty), `started`, and its verdict. */
json_t *pl_result_compose(json_t *identity, json_t *outcome, json_t *provenance, const char *output,
                          size_t output_length, const char *started);

/* The result of a run that is not made: its outcome, and the reason as that of the outcome. Memory that ends ends the
 * program. */
json_t *pl_result_unmade(json_t *identity, pl_outcome outcome, long steps_asked, const char *reason,
                         json_t *provenance);

#endif
