/* What the harness knows of an engine: data only. The engine's own table and its functions exist in
 * other processes (load_engine.h), one of which reports what is kept here. */
#ifndef PLUMB_ENGINE_INFO_H
#define PLUMB_ENGINE_INFO_H

#include "adapters/built_in.h"
#include "load_engine.h"
#include "plumb/engine_abi.h"
#include "plumb/scene.h"
#include "process.h"

/* A fault that an engine had before it could be asked anything. */
typedef struct pl_engine_fault {
    bool is_fault;
    bool timed_out;
    char reason[512];
} pl_engine_fault;

/* An engine. The fields from `name` to `source_count` are those of pl_engine. */
typedef struct pl_engine_info {
    const char *name, *version, *description, *residual_unit;
    uint32_t capabilities, contacts;
    pl_precision precision;
    pl_integrator integrator;
    pl_gyroscopic gyroscopic;
    int substeps;
    const pl_engine_profile *profiles; /* (profile_count) */
    int profile_count;
    const pl_engine_option *options; /* (option_count) */
    int option_count;
    const pl_engine_source *sources; /* (source_count) */
    int source_count;
    const double *defaults;      /* (profile_count x option_count) */
    bool reads_settings;         /* it reads back masses, gravity and the step */
    bool reads_pairs;            /* it reads back friction and restitution */
    bool gives_contact_problems; /* contact_problems.h */
    char binary[17];     /* hash of its binary: pl_binary_hash; of a faulty one, the file's */
    char stamp[17];      /* pl_binary_stamp of a shared object */
    const char *runtime; /* what runs its code; NULL: it is native */
    const char *path;    /* of the shared object; NULL: it is none */
    const char *command; /* of the program; NULL: it is none */
    const pl_built_in *built_in; /* NULL: the user's own */
    const char *spec;      /* how --engine names it: by name, path, or "exec:" and the command */
    pl_engine_fault fault; /* only name, version, one profile and this have a meaning */
} pl_engine_info;

/* Limits how long an engine may take to describe itself, and how much memory it may have: those of
 * a run, but at least 1 s and at most 30 s, which is the limit where this is not called. */
void pl_engine_describe_within(const pl_limits *limits);

/* Starts a process that loads the engine and reports what it is: the shared object at `path`, the
 * program of `command`, or the built-in engine; the others are NULL. The result lives until the
 * program ends, and is the same pointer for the same engine. A crash, an exit, a hang or a damaged
 * report becomes info->fault, and the status is PL_OK. PL_BAD_INPUT: it is no engine of this ABI, or
 * of this protocol. PL_IO. */
pl_status pl_engine_describe(const char *path, const char *command, const pl_built_in *built_in,
                             const pl_engine_info **info, pl_error *error);

/* Size of a SPEC, with its terminating zero. */
enum { PL_SPEC_SIZE = 1024 };

/* What runs its code: "native" where it says nothing else. */
const char *pl_engine_runtime(const pl_engine_info *info);

/* The index of the engine's option of that name; -1 when it has none. */
int pl_engine_option_index(const pl_engine_info *info, const char *name);

/* The index of the engine's profile of that name; -1 when it has none. */
int pl_engine_profile_index(const pl_engine_info *info, const char *name);

/* The threads that an engine is asked for by those values (option_count) of its options: that of
 * its option `threads`, at least 1; 1 where it has none. */
int pl_engine_threads(const pl_engine_info *info, const double *values);

/* The values (option_count) of a profile. */
const double *pl_engine_profile_values(const pl_engine_info *info, int profile);

#endif
