/* Memory that has its pages before it is used. */
#ifndef PLUMB_RESIDENT_H
#define PLUMB_RESIDENT_H

#include <stddef.h>

/* Has the system give the pages of memory just allocated, all in one call: page by page, as each is
 * first written, takes twice as long. A hint, for memory that is then written from end to end:
 * madvise(2) has it from Linux 5.14 on. */
void pl_make_resident(void *memory, size_t size);

#endif
