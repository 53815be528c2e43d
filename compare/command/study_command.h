/* How the command of a study runs: one way for all of them. Results are in DIR/results.jsonl, and the conclusion in
 * DIR/NAME.json, NAME.md, NAME.csv and NAME.html. */
#ifndef PLUMB_STUDY_COMMAND_H
#define PLUMB_STUDY_COMMAND_H

#include "request.h"
#include "runner/execute.h"
#include "studies/study.h"

/* All studies, each in its folder. */
#define COMMAND(name)
#define STUDY(name) extern const pl_study pl_##name##_study;
#include "commands.def"

/* The command of a study. Where a callback is NULL, the command does what most do. */
typedef struct pl_study_work {
    const pl_study *study;
    void *options; /* of the command, which begin with a pl_request; for the callbacks */
    /* Adds the cases and the engines to the plan, which has none. NULL: pl_request_plan, of runs whose `study` is the name
     * alone. */
    pl_status (*plan)(void *options, const pl_call *call, pl_plan *plan, pl_error *error);
    const char
        *nothing; /* the message where no run is planned; NULL: "there is nothing to compare" */
    /* Makes the runs: `how` has all that pl_execute needs, in rounds if need be. NULL: one round of pl_execute. */
    pl_status (*run)(void *options, pl_execution_def *how, int *signal_number, pl_error *error);
    const char *const
        *output; /* a further file that `finish` writes, known after `plan`; NULL: none */
    /* Does more with the conclusion, and can set the exit code. NULL: nothing. */
    pl_status (*finish)(void *options, const json_t *conclusion, int *code, pl_error *error);
} pl_study_work;

/* The whole command: parses its options, plans, makes the runs that are
 * missing, concludes from all that the folder has, delivers, and frees what the request has. The folder is named after
 * the study unless --out names another. Returns the exit code, which is that of nothing to compare where `run` returned
 * PL_UNSUPPORTED. */
int pl_study_main(const pl_call *call, const pl_study_work *work);

/* Writes the files of a conclusion into request->out, and its text on standard output, unless the JSON of --json goes
 * there. */
pl_status pl_study_write(const pl_request *request, const pl_study *study, const json_t *conclusion,
                         pl_error *error);

/* Concludes from an array of results of the study, whose files are in `folder`, and writes the files into request->out,
 * --json, and the text on standard output, unless the JSON is there. *conclusion is a new reference, NULL where there is
 * none. */
pl_status pl_study_deliver(const pl_request *request, const pl_study *study, const json_t *results,
                           const char *folder, json_t **conclusion, pl_error *error);

/* Writes DIRECTORY/NAME.html of a conclusion. */
pl_status pl_study_write_page(const char *directory, const pl_study *study,
                              const json_t *conclusion, pl_error *error);

#endif
