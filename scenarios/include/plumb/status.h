/* The result of a call and the error that it fills: plain types, for every layer and every adapter. */
#ifndef PLUMB_STATUS_H
#define PLUMB_STATUS_H

/* Longest name of a body, material, scenario, profile or option, with its terminating zero. */
enum { PL_NAME_SIZE = 64 };

/* The result of a function that can fail. */
typedef enum pl_status {
    PL_OK = 0,
    PL_BAD_INPUT,   /* the caller's text, file, name or number is wrong: exit code 2 */
    PL_UNSUPPORTED, /* right, but this engine cannot do it */
    PL_NO_MEMORY,
    PL_IO,    /* a file or a process could not be opened, read, written or started */
    PL_FAILED /* an engine failed in mid-run */
} pl_status;

/* An error and its message. */
typedef struct pl_error {
    pl_status status;  /* PL_OK: no error */
    char message[512]; /* what, which object, the number found, what to do; no trailing newline */
} pl_error;

#endif
