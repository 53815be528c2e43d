/* The data of the report's page as JSON. page/README.md describes its keys. */
#ifndef PLUMB_PAGE_DATA_H
#define PLUMB_PAGE_DATA_H

#include "plumb/scenario.h"
#include "report_document.h"

/* The whole report: {"kind": "report", ...}, a new reference. */
json_t *pl_page_data(const pl_report *report);

/* What the words of a scene and of options mean in each built-in engine, {ENGINE: {WORD: TEXT}}, as the
 * engines' descriptions say (adapters/NAME/engine.json): a new reference. */
json_t *pl_engine_words(void);

/* Name, unit, direction and definition of every metric: a new array. */
json_t *pl_page_data_metrics(void);

/* ---- The scene of a case ---- */

/* Builds the scene of a case: from the catalogue, or from the scene file by its path (with the step
 * and the duration of the run). PL_FAILED when its hash is not that of the results, PL_IO when the
 * file is not there. The caller frees *scene, also on failure. */
pl_status pl_case_scene_build(const pl_result_case *test_case, pl_scene *scene, pl_error *error);

/* The scene as the page draws it: bodies, shapes and expected rests, a new reference. page/README.md
 * has its keys. */
json_t *pl_case_scene_json(const pl_scene *scene);

/* A number to six digits, which place a body to a millionth of the scene; null for one that is not
 * finite. A new reference. */
json_t *pl_rounded_json(double value);

#endif
