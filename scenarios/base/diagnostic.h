/* What is wrong with a scene, and where: the path of a field in the scene file, such as
 * bodies[1].shape.radius, and a sentence. The checks and the reader make it; the reader can then
 * say the line and column, while a scene made by code has the path alone. */
#ifndef PLUMB_DIAGNOSTIC_H
#define PLUMB_DIAGNOSTIC_H

#include "plumb/base.h"

#include <stddef.h>

enum { PL_PATH_DEPTH = 8 };

/* One step from the outside in: a key of an object, or an index into an array where key is NULL. */
typedef struct pl_path_step {
    const char *key; /* borrowed */
    int index;
} pl_path_step;

typedef struct pl_path {
    pl_path_step steps[PL_PATH_DEPTH];
    int depth;
} pl_path;

/* Steps beyond PL_PATH_DEPTH are counted but not kept. */
void pl_path_push_key(pl_path *path, const char *key);
void pl_path_push_index(pl_path *path, int index);
void pl_path_pop(pl_path *path);

/* The path as people read it, cut to `size`; `whole` when it is empty. */
void pl_path_text(const pl_path *path, const char *whole, char *text, size_t size);

typedef struct pl_diagnostic {
    pl_status status; /* PL_OK: nothing is wrong */
    pl_path path;     /* where the check or the reader stands, or stopped */
    bool at_key;      /* the fault is the last step's key itself, not its value */
    char text[360];   /* "expected ..., found ..." */
} pl_diagnostic;

/* Sets status and text, as printf does, and returns false. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
bool pl_complain(pl_diagnostic *diagnostic, const char *format, ...);

/* The same at the field `key` of the object where the path now stands. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool pl_complain_of(pl_diagnostic *diagnostic, const char *key, const char *format, ...);

/* That `name` at `key` is that of no `kind`; `nearest` is one that may have been meant, or NULL. */
bool pl_complain_of_reference(pl_diagnostic *diagnostic, const char *key, const char *kind,
                              const char *name, const char *nearest);

/* Sets status PL_NO_MEMORY and returns false. */
bool pl_complain_no_memory(pl_diagnostic *diagnostic);

/* `bytes` of UTF-8 in quotes, cut to at most 40 with an ellipsis, with a ? for every control
 * character: what was found, fit to stand in a message. Returns `text`. */
enum { PL_QUOTED_SIZE = 64 };
const char *pl_quoted(const char *bytes, char text[PL_QUOTED_SIZE]);

/* A name of a body, material or scene: 1 to 63 bytes of UTF-8 without control characters. Complains
 * at the path as it stands. */
bool pl_check_name(const char *name, size_t length, pl_diagnostic *diagnostic);

#endif
