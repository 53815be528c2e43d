/* What in another engine makes it err in a scenario, and how that was found. */
#ifndef PLUMB_CAUSES_H
#define PLUMB_CAUSES_H

typedef struct pl_cause {
    const char *engine;
    const char *profile;   /* NULL: any */
    const char *scenarios; /* names with a blank between two */
    const char *outcome;   /* NULL: any but crashed and timeout */
    const char *text;      /* what does it, in a line; NULL: not known */
    const char *evidence;  /* what was varied, and what changed */
} pl_cause;

/* The versions that the causes were found with, in words. */
extern const char pl_causes_versions[];

/* The first that fits a run; NULL where none does. */
const pl_cause *pl_cause_find(const char *engine, const char *profile, const char *scenario,
                              const char *outcome);

/* The table, for tests. */
const pl_cause *pl_causes(int *count);

#endif
