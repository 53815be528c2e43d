/* Pictures of a scenario for papers, drawn by the report's page in Chromium without a window. */
#ifndef PLUMB_FIGURE_H
#define PLUMB_FIGURE_H

#include "report/report.h"

/* The formats of a picture. */
typedef enum pl_figure_format { PL_FIGURE_SVG, PL_FIGURE_PNG, PL_FIGURE_PDF } pl_figure_format;

/* Writes DIRECTORY/NAME.svg, .png or .pdf of the scenario that `what` names: "NAME", a case's name in
 * the report, or "NAME:t=SECONDS". All engines stand side by side, at the end or at that time. *path
 * is the file that was written, malloc'd. The program is that of the environment variable CHROMIUM,
 * else chromium. PL_BAD_INPUT: there is no such case, it cannot be drawn, or without `force` the file
 * exists; PL_IO: Chromium is not there or failed. */
pl_status pl_figure_write(const pl_report_def *def, const char *what, pl_figure_format format,
                          bool force, char **path, pl_error *error);

#endif
