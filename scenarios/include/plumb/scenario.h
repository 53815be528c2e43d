/* Scenarios: families of scenes with parameters. Those of the catalogue are const descriptors; a scene
 * file is a scenario too, whose parameters are those of the file. */
#ifndef PLUMB_SCENARIO_H
#define PLUMB_SCENARIO_H

#include "plumb/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A numeric parameter of a scenario, set by `--set NAME=VALUE`. */
typedef struct pl_param {
    const char *name; /* as in --set */
    double value;     /* the default */
    double min;       /* the least value allowed */
    double max;       /* the largest value allowed */
    bool integer;     /* only whole numbers are allowed */
    const char *unit; /* "1" when dimensionless */
    const char *help; /* a line for people */
} pl_param;

/* The largest number of parameters of a scenario. */
enum { PL_MAX_PARAMS = 16 };

/* Derives from a scene the PL_NEEDS_* bits of scene_data.h: friction where any pair of bodies that may touch has it, and so
 * on. */
uint32_t pl_scene_needs(const pl_scene *scene);

/* The name of one bit of PL_NEEDS_*, such as "friction" or "box"; NULL for an unknown bit. */
const char *pl_needs_name(uint32_t bit);

/* A critical value of one parameter: on one side of it the scene holds (the outcome is `ok`), on
 * the other it does not. `plumb threshold` bisects it for each engine. */
typedef struct pl_threshold {
    const char *param; /* name of the parameter */
    double low;        /* lower end of the first bracket of that parameter */
    double high;       /* its upper end; the scene holds at one of the two and not at the other */
    bool holds_below;  /* the scene holds below the critical value; else above */
    bool either_side;  /* it is not known on which side: the ends of the bracket say so */
    double tolerance;  /* of the parameter: the width of the bracket at which the search ends */
    /* The critical value in closed form, of the other parameters' values; NULL: there is none. */
    double (*critical)(const double *values);
    const char *formula; /* the same as plain text; NULL where `critical` is */
} pl_threshold;

/* Builds a scene step by step; of the catalogue alone. */
typedef struct pl_builder pl_builder;

/* A scenario: a family of scenes with parameters, and its right answer. */
typedef struct pl_scenario {
    const char *name;        /* as on the command line: "slope-slide" */
    const char *title;       /* a line for people */
    const char *description; /* the scene, and what it shows */
    const char *reference;   /* the right answer, as a formula in plain text */
    const char *expected;    /* the outcome of a right engine, "ok: ..." and its appearance */
    const char *source; /* of that formula: author, year, equation; or "by symmetry", "statics" */
    const char *primary_error; /* the metric's name */
    /* The largest primary error of an accurate run, with every parameter value, in the metric's
     * unit. */
    double acceptance;
    const char *acceptance_reason; /* why this bound: what a user would see beyond it */
    const char *validity;          /* where the reference holds; NULL: for all parameters */
    const char *provokes; /* of a hard case: the failure that it provokes, and what a right engine
                             does; NULL: not one of them */
    /* The symptom that users of engines reported of such a scene, in one sentence. It is NULL for a
     * scenario that does not come from a report. */
    const char *symptom;
    const char *threads; /* where they reported it, "OWNER/REPOSITORY#NUMBER, ..."; NULL as above */
    const pl_threshold *threshold; /* NULL: none */
    /* Every scenario has, in addition to its own, the parameters "dt" and "duration" (s): its
     * reference may depend on them, and the command's --dt and --duration set them. */
    const pl_param *params; /* (param_count) */
    int param_count;        /* number of parameters */
    /* Adds the bodies and expectations. Called by pl_scenario_build alone. */
    void (*build)(pl_builder *builder, const double *values);
    /* The scene file that the scenes are read from, in place of `build`; NULL: none. The values of its
     * "dt" and "duration" are NAN unless they replace the file's own. */
    const struct pl_scene_file *file;
    /* Of a scene file that a plan opened: the hash of the scene as the file states it, with its own time step, duration
     * and parameters. "" elsewhere. */
    char edition[17];
} pl_scenario;

/* The features that the scene with default parameters needs: PL_NEEDS_*. 0 when out of memory. */
uint32_t pl_scenario_needs(const pl_scenario *scenario);

/* The whole catalogue, in the order of reports. */
const pl_scenario *const *pl_scenarios(int *count);

/* Finds a scenario by its exact name. NULL with an error that suggests the nearest name. */
const pl_scenario *pl_scenario_find(const char *name, pl_error *);

/* Opens a scene file as a scenario of that name ("-" is standard input). Its text is read once. The
 * parameters are those of the file, then "dt" and "duration". Only the members name, params,
 * param_count and file have a meaning. Errors as pl_scene_read_file, of the text's form and its
 * parameters. The caller closes *scenario; on failure there is nothing to close. */
pl_status pl_scenario_open_file(const char *path, pl_scenario **scenario, pl_error *);

/* Frees a scenario of pl_scenario_open_file. NULL is allowed. */
void pl_scenario_close_file(pl_scenario *scenario);

/* The index of the scenario's parameter of that name; -1 when it has none. */
int pl_scenario_param(const pl_scenario *scenario, const char *name);

/* Fills values[param_count] with defaults, then applies `count` texts of the form
 * "NAME=VALUE[,NAME=VALUE]...".
 * PL_BAD_INPUT names an unknown parameter (with the nearest one), a text that is no number, a
 * fraction where an integer is due, or a value out of range. */
pl_status pl_scenario_values(const pl_scenario *scenario, const char *const *settings, int count,
                             double *values, pl_error *);

/* Builds a scene. `values` has param_count numbers, already checked against their ranges. The same
 * seed and values give the same scene, bit for bit, on every machine. The parameters "dt" and
 * "duration" are those of the scene, "friction" and "restitution", where the scenario has them,
 * those of its first material. PL_BAD_INPUT: the values do not go together. On failure *scene is
 * left empty. The caller frees it.
 *
 * A "dt" that differs from a scene file's own removes the discrete answers. A "duration" that differs is
 * PL_BAD_INPUT for a file that expects travels, values or statistics, which hold for its own. */
pl_status pl_scenario_build(const pl_scenario *scenario, const double *values, uint64_t seed,
                            pl_scene *scene, pl_error *error);

/* A scenario of a suite. */
typedef struct pl_suite_entry {
    const char *scenario; /* its name */
    const char *setting;  /* "NAME=VALUE[,NAME=VALUE]..."; the other parameters keep their defaults.
                             NULL: none */
    double published;     /* of the suite's published_metric; no meaning where it has none */
} pl_suite_entry;

/* A named set of scenarios, and published numbers for them. */
typedef struct pl_suite {
    const char *name;              /* as in --suite */
    const char *description;       /* a line for people */
    const pl_suite_entry *entries; /* (entry_count) */
    int entry_count;               /* number of entries */
    const char *published_metric;  /* the metric that `published` gives; NULL: none is published */
    const char *source;            /* of the published numbers, and their open questions */
} pl_suite;

/* All suites. */
const pl_suite *pl_suites(int *count);

/* Finds a suite by its exact name. NULL with an error that suggests the nearest name. */
const pl_suite *pl_suite_find(const char *name, pl_error *);

#ifdef __cplusplus
}
#endif
#endif
