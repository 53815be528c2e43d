/* An engine's table of functions, in the process that will call them: a built-in engine, or a
 * shared object that is loaded here. Loading runs code of the shared object. */
#ifndef PLUMB_LOAD_ENGINE_H
#define PLUMB_LOAD_ENGINE_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"

#include <fenv.h>

struct pl_engine_info;

/* A loaded engine. */
typedef struct pl_loaded_engine {
    pl_engine table;        /* complete: what a shorter table lacks is NULL or 0 */
    void *library;          /* of dlopen; NULL for the others */
    bool is_program;        /* adapters/process/adapter_process.h */
    unsigned changed_modes; /* PL_MODE_*: the floating-point modes that loading left changed */
} pl_loaded_engine;

/* Loads the shared object at the engine's path, starts the program of its command, or takes the built-in engine: the
 * first that it has. This and pl_unload_engine restore the floating-point environment.
 * PL_BAD_INPUT: it cannot be loaded, exports no engine, has another ABI version, or its table is
 * not valid; the message names the field. PL_FAILED: the program ended, or does not speak the
 * protocol. */
pl_status pl_load_engine(const struct pl_engine_info *info, pl_loaded_engine *loaded,
                         pl_error *error);

/* Unloads the shared object or ends the program, if there is one. */
void pl_unload_engine(pl_loaded_engine *loaded);

/* The number of files whose code this process has mapped: the program and its shared libraries. */
int pl_mapped_file_count(void);

/* Hashes the contents of the code of a loaded engine: the files of a program (pl_process_engine_file), this program
 * and the `libraries` of a built-in engine, or of a shared object the files that were mapped when pl_mapped_file_count
 * had reached `first` or later. PL_IO. */
pl_status pl_binary_hash(const struct pl_engine_info *info, int first, char hash[17],
                         pl_error *error);

/* Hashes what identifies the files of a shared object without reading them: their inodes, sizes and times of
 * change. The same stamp means the same contents. PL_IO. */
pl_status pl_binary_stamp(int first, char stamp[17], pl_error *error);

/* Hashes the contents of one file; "" when it cannot be read. */
void pl_file_hash(const char *path, char hash[17]);

/* ---- The floating-point environment around an engine's code (float_environment.c): saved before a call, restored
 * after it ---- */

/* The floating-point modes that code may leave changed, as bits. */
enum {
    PL_MODE_ROUNDING = 1u << 0, /* the rounding mode */
    PL_MODE_TRAPS = 1u << 1,    /* which exceptions trap */
    PL_MODE_FLUSH = 1u << 2     /* whether subnormal numbers are flushed to zero (x86) */
};

/* An environment that was saved. */
typedef struct pl_float_environment {
    fenv_t all;
    int rounding;     /* fegetround */
    int traps;        /* fegetexcept */
    unsigned control; /* the modes of MXCSR; 0 where there is none */
} pl_float_environment;

/* The environment now. */
pl_float_environment pl_float_environment_save(void);

/* Restores it all, and returns the PL_MODE_* bits of the modes that had changed. Raised flags are
 * restored, and are no mode. */
unsigned pl_float_environment_restore(const pl_float_environment *saved);

#endif
