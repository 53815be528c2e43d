/* Files of this folder that are built into the program: compare/CMakeLists.txt generates the
 * arrays, each with a zero at its end. */
#ifndef PLUMB_REPORT_EMBEDDED_H
#define PLUMB_REPORT_EMBEDDED_H

extern const char pl_known_causes_json[]; /* known_causes.json */
extern const char pl_method_html[];       /* page/method.html */
extern const char pl_page_css[];          /* page/page.css */
extern const char pl_sweep_css[];         /* page/sweep.css */

#endif
