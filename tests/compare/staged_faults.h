/* The faults of staged_engine.c: what it commits, and what its functions return from then on. */
#ifndef PLUMB_STAGED_FAULTS_H
#define PLUMB_STAGED_FAULTS_H

#include "plumb/engine_abi.h"

/* What a fault leaves behind for the engine's functions. */
typedef struct staged_state {
    pl_status returned;        /* by create and step */
    const char *message;       /* with it, 512 bytes that may lack their end; NULL: none */
    bool makes_nothing;        /* create leaves no instance */
    int contact_count;         /* what read_contacts returns */
    bool doubles_contacts;     /* it returns twice the capacity instead */
    bool changes_frame;        /* read_frame overwrites what is the harness's in the frame */
    bool changes_settings;     /* so does read_settings */
    const struct field *field; /* a number that is overwritten; NULL: none */
    double value;              /* by this */
} staged_state;

/* A number of what the engine hands out, by name. */
typedef struct field {
    const char *name;
    enum { FIELD_BODY, FIELD_STATS, FIELD_CONTACT, FIELD_SETTINGS, FIELD_PAIR } of;
    size_t offset;
} field;

extern staged_state staged;

/* A fault: a function, or, where that is NULL, a signal that is raised. */
typedef struct staged_fault {
    const char *name;
    void (*commit)(void);
    int signal;
} staged_fault;

/* Those that end, change, multiply or fill the process. Ends with a name that is NULL. */
extern const staged_fault staged_process_faults[];

/* Commits the fault of that name, which is one of the list or FIELD_VALUE: velocity_nan. */
void staged_commit(const char *name);

/* Overwrites the number that is to be wrong, where it is of `of`, in `object`. */
void staged_spoil(int of, void *object);

#endif
