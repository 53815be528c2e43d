/* The raw file of a recording, as its writer and its reader know it. */
#ifndef PLUMB_RECORDING_FILE_H
#define PLUMB_RECORDING_FILE_H

/* The first eight bytes of a raw file. */
#define PL_RAW_MAGIC "plumbrec"

#endif
