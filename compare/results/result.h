/* The result of one run in memory, and its form as a JSON object, plumb.result/1 (SCHEMA.md).
 *
 * A result has four parts, made in different places: which run it is (pl_planned_run_identity), its outcome
 * (pl_run_result, made in the run's own process), what it printed, and where it was made (host,
 * build, command). JSON values returned here are new references. */
#ifndef PLUMB_RESULT_H
#define PLUMB_RESULT_H

#include "base/json_field.h"
#include "base/text_buffer.h"
#include "engines/engine_info.h"
#include "plumb/engine_abi.h"
#include "plumb/scenario.h"
#include "plumb/scene.h"
#include "referee/metrics/metrics.h"

#include <jansson.h>

/* How a run ended. */
typedef enum pl_outcome {
    PL_OUTCOME_OK,
    PL_OUTCOME_COLLAPSED,
    PL_OUTCOME_DIVERGED,
    PL_OUTCOME_NONFINITE,
    PL_OUTCOME_CRASHED,
    PL_OUTCOME_TIMEOUT,
    PL_OUTCOME_UNSUPPORTED
} pl_outcome;
enum { PL_OUTCOME_COUNT = 7 };

/* "ok", "collapsed" ... as in the schema. */
const char *pl_outcome_name(pl_outcome outcome);

/* The outcome of that name; PL_OUTCOME_COUNT: none. */
pl_outcome pl_outcome_named(const char *name);

/* What engines can read back. */
typedef enum pl_read_back {
    PL_READ_BACK_STEP,
    PL_READ_BACK_GRAVITY,
    PL_READ_BACK_MASS,
    PL_READ_BACK_INERTIA,
    PL_READ_BACK_DAMPING,
    PL_READ_BACK_FRICTION,
    PL_READ_BACK_RESTITUTION
} pl_read_back;
enum { PL_READ_BACK_COUNT = 7 };

/* Its name in results, such as "mass". */
const char *pl_read_back_name(pl_read_back what);

/* What one run gave. */
typedef struct pl_run_result {
    pl_outcome outcome;
    char reason[512]; /* empty when the outcome is ok */
    pl_note note;     /* how bodies that stand have moved */
    long steps_asked, steps_done;
    int substeps; /* of the engine, in a step; 0: not known */
    unsigned
        read_back; /* kinds of numbers that were compared with the scene's: 1 << pl_read_back */
    pl_metrics metrics;
    int body_count;
    const pl_body_state *bodies; /* (body_count) at the last good frame; NULL when there is none */
} pl_run_result;

/* The keys outcome, reason, note, steps, substeps, read_back, off_count, off, metrics, final_poses: the number of the
 * bodies, or null, in the place of the poses, which the harness sets (isolated_run.c). */
json_t *pl_run_result_to_json(const pl_run_result *result);

/* The keys host, plumb, command: this machine, this build, this call. */
json_t *pl_provenance(int argc, char *const *argv);

/* The text `key` of the object `object` of a result; "" when it is absent or not a text. */
const char *pl_result_text(const json_t *result, const char *object, const char *key);

/* The value of a metric of a result; NAN where it has none. */
double pl_result_metric(const json_t *result, const char *name);

/* What runs the engine's code, such as "webassembly"; NULL: it is native, and its times are ranked. */
const char *pl_result_runtime(const json_t *result);

/* The threads that the run asked its engine for; 1 in results that do not say. */
int pl_result_threads(const json_t *result);

/* A JSON number, or null for one that is not finite. */
json_t *pl_json_number_or_null(double value);

/* The results of an array that are runs of the study `name`; NULL: of no study. A new array. */
json_t *pl_results_of_study(const json_t *results, const char *name);

/* Whether there are results, an array, and all have the outcome "unsupported". */
bool pl_results_all_unsupported(const json_t *results);

/* Now, UTC, ISO 8601 to the millisecond. */
void pl_timestamp(char text[32]);

/* One line without a newline: sorted keys, 17 significant digits. malloc'd. */
char *pl_result_to_line(const json_t *result);

/* Adds the same with a newline. NULL sets `failed` of the text. */
void pl_result_add_line(pl_text_buffer *text, const json_t *result);

/* Whether the metric `id`, with its object in a result, is deterministic: as the object says, else
 * as pl_metric_table says. True for a metric that this build does not know (id -1). */
bool pl_metric_is_deterministic(const json_t *metric, int id);

/* Returns the unit of a metric in pl_metric_table. "" for a plain number, for a metric that this
 * build does not know (id -1), and for metrics whose unit the result names. */
const char *pl_metric_table_unit(int id);

/* ---- The verdict: whether the answer is right (run_verdict.c) ---- */

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

/* The verdict of a result. A result without verdicts failed if its outcome is a failure, and
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

/* ---- What `plumb check-engine` found (conformance_record.c), kept from one program run to the next: one file for each
 * engine binary and profile. Reports take from here whether an adapter was verified. The files are in $PLUMB_CACHE,
 * else in $XDG_CACHE_HOME/plumb, else in $HOME/.cache/plumb, and are called conformance-BINARY-ENGINE-PROFILE.json.
 * Without any of these variables nothing is kept. A changed binary has no record. ---- */

/* Keeps that `checks` checks were made and `failed` of them failed, and that `skipped` others were
 * skipped. For a run of all checks with the profile's default options only: `passed` is claimed of
 * the profile. An engine without a binary hash, because it could not be loaded, has no record.
 * PL_IO: the folder cannot be written. */
pl_status pl_conformance_record_write(const pl_engine_info *engine, const char *profile, int checks,
                                      int failed, int skipped, pl_error *error);

/* What is known of this binary of the engine with the profile, as results say it: {"outcome", "checks", "failed",
 * "plumb"}, where `checks` were made, and `plumb` is the version that made them. JSON null: there is no record, or it
 * is damaged or not of this engine. A new reference. */
json_t *pl_conformance_find(const pl_engine_info *engine, const char *profile);

#endif
