/* The one table of results, which the report, the gate and every study read.
 *
 * A row is a result. Rows that are runs of one engine configuration on one case are the repeats of a cell. A case
 * is a scene at a time step; a small change of it is a case of the same scene.
 *
 *     results.jsonl ──▶ rows ──▶ scene ⊃ case × configuration ──▶ cell ⊃ repeats
 *
 * Results that were continued can be of a scene that was edited since, and of an engine that was built again since.
 * Within a snapshot (a file, or several that belong together) the newest count, by the time at which they started;
 * the others are left out and counted. Between snapshots each edition of a scene is a scene, and each build of an
 * engine a configuration.
 *
 * Texts are borrowed from the results. Memory that ends ends the program. */
#ifndef PLUMB_RESULT_TABLE_H
#define PLUMB_RESULT_TABLE_H

#include "result.h"

#include <stdio.h>

/* ---- Cases (case_name.c): their key and name are the same for results and for rows of a baseline. Parameters at their
 * defaults do not count, so that one that a scenario gets later makes no old row another case. ---- */

enum { PL_CASE_NAME_SIZE = 256 };

/* A case, by the values that identify it. Everything is borrowed. */
typedef struct pl_case_identity {
    const char *scenario;
    const pl_scenario *catalogue; /* NULL: a scene file, or unknown here */
    const json_t *params;         /* name -> number; NULL: none */
    double dt;                    /* s; NAN: any, and then the parameter dt does not count */
    double duration;              /* s */
    json_int_t seed;
    int member; /* -1: of no ensemble */
} pl_case_identity;

/* Returns "scenario\x01 a=1 b=2\x01dt\x01duration\x01seed\x01member\x01", parameters by name. The caller frees. */
char *pl_case_key(const pl_case_identity *identity);

/* Writes the scenario with the parameters that are off their defaults (of a scene file, whose defaults are not known
 * here, all), a seed other than 0, and the member: "slope angle=0.5 rad seed=3". */
void pl_case_name(const pl_case_identity *identity, char name[PL_CASE_NAME_SIZE]);

/* Appends formatted text to a name, as much as it has room for. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pl_case_name_add(char name[PL_CASE_NAME_SIZE], const char *format, ...);

/* The parameters that count, off their defaults: a new object. */
json_t *pl_case_params(const pl_case_identity *identity);

/* ---- The table ---- */

/* A metric summarised over the repeats of one run. Texts are borrowed from the results. */
typedef struct pl_metric_summary {
    pl_metric_state state; /* VALUE when any repeat has a number */
    double value;          /* the median of the repeats that have a number */
    double min, max, mad;  /* mad: median of |x - median| */
    int count;             /* repeats that have a number */
    const char *text;      /* state TEXT */
    const char *reason;    /* of the first repeat without a value; NULL: there is none */
    const char *unit;      /* the result's own, or the table's */
    int answer;            /* the number of the nearest of several right answers; 0: none */
    bool is_deterministic;
    bool disagrees; /* a deterministic metric whose repeats differ */
    bool has_percentiles;
    double p50, p95, p99, worst_step; /* medians over repeats */
} pl_metric_summary;

/* A result, checked and typed. Texts that are absent are "". */
typedef struct pl_result_row {
    const json_t *result;
    const char *run, *scenario, *scene_hash, *edition, *change, *primary_error;
    const char *engine, *profile, *label, *spec, *version, *binary, *git, *cpu, *started;
    const char *reason;             /* why the outcome is not ok */
    const json_t *params, *metrics; /* params: NULL where it is absent */
    const pl_scenario *catalogue;   /* NULL: a scene file, or unknown here */
    pl_outcome outcome;
    pl_verdict verdict;
    double dt, duration; /* s */
    json_int_t seed, repeat;
    int member;         /* -1: of no ensemble */
    int file, line;     /* where it is from: the index of the file, and from 1 */
    int snapshot;       /* of that file */
    int configuration;  /* index in the table */
    int catalogue_rank; /* place in the catalogue */
    char *key;          /* of its scene; the table's own */
} pl_result_row;

/* An engine with its profile and options, in one build. */
typedef struct pl_result_configuration {
    const char *label, *engine, *profile, *version, *git, *binary;
    const char
        *runtime;   /* what runs the engine's code; NULL: it is native, and its times are ranked */
    int threads;    /* that its runs ask for */
    bool is_home;   /* the report speaks for it */
    char name[256]; /* the label, with the build where labels alone are not unique */
} pl_result_configuration;

/* The repeats of a configuration on a case. */
typedef struct pl_result_cell {
    int test_case, configuration;
    const pl_result_row *rows; /* (count): by repeat, then by their start */
    int count;
    const pl_result_row *worst; /* the first of the worst repeats: pl_result_row_is_worse */
    int ok_count;               /* repeats with the outcome ok */
    bool outcomes_differ;
    bool hosts_differ;
    bool disagrees; /* the outcome or a deterministic metric of its repeats differs */
} pl_result_cell;

/* A scene at a time step, or a change of it. */
typedef struct pl_result_case {
    const pl_result_row
        *row; /* any of its rows: those of a case agree in all that tells cases apart */
    const pl_result_cell *cells; /* (count): by configuration; only those that were run */
    int count;
    int scene;
    char name
        [PL_CASE_NAME_SIZE]; /* pl_case_name, with the hash of the scene where that is not unique */
} pl_result_case;

/* A scenario with its parameters, except for the time step. */
typedef struct pl_result_scene {
    const pl_result_row *row; /* any of its rows */
    const pl_result_case
        *cases; /* (count): by falling dt; at each dt first the unchanged scene, then by change */
    int count;
    char name[PL_CASE_NAME_SIZE]; /* as that of a case, without the time step */
} pl_result_scene;

/* All of it. Scenes are in the catalogue's order, then by name and parameters. Configurations are by label, those of
 * the home engine first. */
typedef struct pl_result_table {
    pl_result_row *rows; /* (row_count): by cell */
    int row_count;
    pl_result_cell *cells; /* (cell_count): by case, then configuration */
    int cell_count;
    pl_result_case *cases; /* (case_count): by scene */
    int case_count;
    pl_result_scene *scenes;
    int scene_count;
    pl_result_configuration *configurations;
    int configuration_count;
    const char *home;           /* as given; NULL: none */
    int old_scenes, old_builds; /* results that were left out because newer ones count */
    bool several_hosts;         /* results come from different processors */
    bool disagrees;             /* those of some cell do */
} pl_result_table;

/* Results that were read. */
typedef struct pl_result_file {
    const char *path;      /* for messages */
    const json_t *results; /* array of plumb.result/1, borrowed; it outlives the table */
    const int *lines;      /* of each result, from 1; NULL: they are all lines of the file */
    int snapshot;          /* files of one number belong together */
} pl_result_file;

/* What to tabulate. */
typedef struct pl_result_table_def {
    const pl_result_file *files; /* (file_count) */
    int file_count;
    const char *study; /* runs of the study of that name alone; NULL: of no study */
    bool has_changes;  /* runs on changed scenes too, which only a sweep asks for */
    const char
        *home; /* the label, engine:profile or engine that the report speaks for; NULL: none */
} pl_result_table_def;

/* Makes the table. Results that are equal in every key count once, and the order of the results has no effect.
 * PL_BAD_INPUT: FILE:LINE:1: the key that is missing or of the wrong type; or there are results, and none is of the
 * home engine. The caller frees, also on failure. */
pl_status pl_result_table_build(const pl_result_table_def *def, pl_result_table *table,
                                pl_error *error);

/* Frees the table. */
void pl_result_table_free(pl_result_table *table);

/* Prints how many results were left out, and why; nothing where none were. */
void pl_result_table_print_left_out(const pl_result_table *table, FILE *out);

/* The rows in the order of their files. The caller frees. */
const pl_result_row **pl_result_table_by_place(const pl_result_table *table);

/* The results that count of those to tabulate, in the order of their files, for what needs no table: a new array.
 * Prints what was left out on standard error. Errors as of pl_result_table_build, and *results is then NULL. */
pl_status pl_results_that_count(const pl_result_table_def *def, json_t **results, pl_error *error);

/* The cell of a configuration on a case; NULL: it was not run. */
const pl_result_cell *pl_result_case_cell(const pl_result_case *test_case, int configuration);

/* The one rule of the worst repeat. From bad to good: an outcome that is not ok, the verdict failed, inaccurate,
 * not judged, accurate. */
bool pl_result_row_is_worse(const pl_result_row *row, const pl_result_row *other);

/* The number of a metric; NAN: none. */
double pl_result_row_metric(const pl_result_row *row, int id);

/* A metric summarised over the repeats. */
pl_metric_summary pl_result_cell_metric(const pl_result_cell *cell, int id);

/* Whether the outcome of all repeats is ok. */
bool pl_result_cell_is_ok(const pl_result_cell *cell);

/* What tells the row's case from others. */
pl_case_identity pl_result_row_identity(const pl_result_row *row);

/* ---- Rows before they are laid out, and their orders (result_rows.c) ---- */

/* Reads the rows of all files into the table, without those that newer ones replace, which it counts. Errors as of
 * pl_result_table_build. */
pl_status pl_result_rows_read(const pl_result_table_def *def, pl_result_table *table,
                              pl_error *error);

/* What tells the row's scene from others. */
pl_case_identity pl_result_row_scene(const pl_result_row *row);

/* Order by scene, as of strcmp: 0 for rows of one scene. */
int pl_result_rows_compare_scenes(const pl_result_row *a, const pl_result_row *b);

/* Order by case: by scene, then by falling time step, change and hash. */
int pl_result_rows_compare_cases(const pl_result_row *a, const pl_result_row *b);

/* Order by build, of rows of one engine. */
int pl_result_rows_compare_builds(const pl_result_row *a, const pl_result_row *b);

/* ---- Metrics over repeats (metric_summary.c) ---- */

enum { PL_METRIC_TEXT_SIZE = 160 };

/* Summarises the metric of that name over the results of one run, which must outlive the summary. */
pl_metric_summary pl_metric_summarise(const pl_result_row *rows, int count, const char *name);

/* Writes the value as in a table; "–" when there is none. */
void pl_metric_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE]);

/* The same, with the spread where repeats differ: "12.3 ± 0.4 µs" has the median and `mad`. */
void pl_metric_spread_text(const pl_metric_summary *summary, char text[PL_METRIC_TEXT_SIZE]);

/* Returns the text of a tooltip, which the caller frees: why there is no value, or spread and percentiles; "" where
 * there is nothing to say. */
char *pl_metric_note(const pl_metric_summary *summary);

#endif
