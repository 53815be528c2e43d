/* What every layer of the harness shares: the status of a call and the error it fills.
 *
 * A function that can fail returns a pl_status and takes an optional `pl_error *` (NULL is
 * allowed). On PL_OK the error is untouched. No function prints, exits, or keeps global state. */
#ifndef PLUMB_BASE_H
#define PLUMB_BASE_H

#include "plumb/status.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Fills `error` (when not NULL) as printf does, cut to size, and returns `status`. The message is one
 * line that a terminal can show: '?' stands for control characters. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
pl_status
pl_fail(pl_error *error, pl_status status, const char *format, ...);

/* clang's static analyzer sees one file at a time: this tells it what pl_fail returns. */
#ifdef __clang_analyzer__
#define pl_fail(error, status, ...) (pl_fail(error, status, __VA_ARGS__), (status))
#endif

/* The candidate nearest to `word` by edit distance, or NULL when none is near enough to be what
 * was meant (distance at most 1 + a third of the word's length). `candidates` has `count` items. */
const char *pl_nearest_name(const char *word, const char *const *candidates, int count);

/* The size of a suggestion, in bytes. */
enum { PL_SUGGESTION_SIZE = 160 };

/* The end of a message about an unknown word: "; did you mean CANDIDATE?" with the candidate of
 * pl_nearest_name, or "" when there is none. Returns `text`. */
const char *pl_did_you_mean(const char *word, const char *const *candidates, int count,
                            char text[PL_SUGGESTION_SIZE]);

/* A number as people give it on a command line: a decimal ("0.5", "-1e-3") or a ratio of two
 * ("1/60"). False for anything else: blanks, hexadecimals, "inf", "nan", an overflow, a division by
 * zero. */
bool pl_parse_number(const char *text, double *value);

#ifdef __cplusplus
}
#endif
#endif
