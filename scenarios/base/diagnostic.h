/* Diagnostics: what is wrong with structured input, and where. The place is the path of a field,
 * such as bodies[1].shape.radius. Checks and readers fill a diagnostic. A reader of JSON text turns
 * the path into a line and a column (json_text.h); data that code has made has the path only. */
#ifndef PLUMB_DIAGNOSTIC_H
#define PLUMB_DIAGNOSTIC_H

#include "plumb/base.h"

#include <stddef.h>

enum { PL_PATH_DEPTH = 8 };

/* One step of a path: a key of an object, or an index into an array. */
typedef struct pl_path_step {
    const char *key; /* borrowed; NULL for an index */
    int index;
} pl_path_step;

/* The steps from the outermost object inwards. */
typedef struct pl_path {
    pl_path_step steps[PL_PATH_DEPTH];
    int depth;
} pl_path;

/* Enters a member of an object. Steps beyond PL_PATH_DEPTH are counted but not kept. */
void pl_path_push_key(pl_path *path, const char *key);

/* Enters an item of an array, as pl_path_push_key does a member. */
void pl_path_push_index(pl_path *path, int index);

/* Leaves the member or item that was entered last. */
void pl_path_pop(pl_path *path);

/* Writes the path as text, cut to `size` bytes. An empty path is written as `whole`. */
void pl_path_text(const pl_path *path, const char *whole, char *text, size_t size);

/* The first fault found in a document, and where it is. */
typedef struct pl_diagnostic {
    pl_status status; /* PL_OK: nothing is wrong */
    pl_path path;     /* where the check or the reader stands, or stopped */
    bool at_key;      /* the fault is the last step's key itself, not its value */
    char text[360];   /* "expected ..., found ..." */
} pl_diagnostic;

/* Sets the status to PL_BAD_INPUT and the text as printf does. Returns false. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
bool pl_diagnose(pl_diagnostic *diagnostic, const char *format, ...);

/* The same for the field `key` of the object at the current path. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool pl_diagnose_field(pl_diagnostic *diagnostic, const char *key, const char *format, ...);

/* Reports that `name`, found at `key`, is not the name of a `kind`. `nearest` is a name that may
 * have been meant, or NULL. Returns false. */
bool pl_diagnose_reference(pl_diagnostic *diagnostic, const char *key, const char *kind,
                           const char *name, const char *nearest);

/* Sets the status to PL_NO_MEMORY. Returns false. */
bool pl_diagnose_no_memory(pl_diagnostic *diagnostic);

/* The size of a quoted text, in bytes. */
enum { PL_QUOTED_SIZE = 64 };

/* Copies text for a message: in quotes, plain as by pl_make_plain, at most 40 bytes with an ellipsis
 * after a cut. Returns `text`. */
const char *pl_quoted(const char *bytes, char text[PL_QUOTED_SIZE]);

/* ---- Checks ----
 * Each returns true when the value is right. Otherwise it fills the diagnostic for the field `key`
 * of the object at the current path, or for the path itself with key NULL, and returns false. */

/* How far the norm of a normal, direction or quaternion may be from 1. */
#define PL_UNIT_TOLERANCE 1e-9

/* The Euclidean norm of n numbers. */
double pl_norm(const double *vector, int n);

/* Reports an error unless `right` is true; `expected` names the expected value. */
bool pl_check_number(pl_diagnostic *diagnostic, const char *key, double value, bool right,
                     const char *expected);

/* A finite number. */
bool pl_check_is_finite(pl_diagnostic *diagnostic, const char *key, double value);

/* A finite number above zero. */
bool pl_check_positive(pl_diagnostic *diagnostic, const char *key, double value);

/* Three finite numbers. */
bool pl_check_vector(pl_diagnostic *diagnostic, const char *key, const double vector[3]);

/* A vector of n numbers with a norm within PL_UNIT_TOLERANCE of 1. */
bool pl_check_unit(pl_diagnostic *diagnostic, const char *key, const double *vector, int n,
                   const char *expected);

/* A name of `length` bytes, at the current path: 1 to 63 bytes without control characters. */
bool pl_check_name(const char *name, size_t length, pl_diagnostic *diagnostic);

#endif
