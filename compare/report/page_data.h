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

#endif
