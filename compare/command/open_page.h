/* Opens a page in the user's browser. */
#ifndef PLUMB_OPEN_PAGE_H
#define PLUMB_OPEN_PAGE_H

#include "plumb/base.h"

/* Opens a file with the program of the environment variable BROWSER, else with xdg-open. PL_IO when
 * neither can be started: the message names the file. */
pl_status pl_open_page(const char *path, pl_error *error);

#endif
