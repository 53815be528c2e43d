/* Opens a file only where it lies below a folder: for names that come from others. */
#ifndef PLUMB_FILE_BENEATH_H
#define PLUMB_FILE_BENEATH_H

#include "plumb/base.h"

/* Folders whose files scenes may name, apart by ':', as the option --allow-files sets them. */
#define PL_ALLOWED_VARIABLE "PLUMB_ALLOW_FILES"

/* Opens a plain file for reading, without waiting for anything: `path` begins at `folder` ("": the
 * working directory), unless it is absolute. The file lies below `folder`, or below one of those
 * that PL_ALLOWED_VARIABLE names, after all symbolic links. *descriptor is the caller's to close.
 * PL_BAD_INPUT says LABEL: "expected a NOUN file ..., found ..." and nothing of the file: it is
 * elsewhere, it is no plain file, or there is none. */
pl_status pl_file_open_beneath(const char *noun, const char *folder, const char *path,
                               const char *label, int *descriptor, pl_error *error);

/* As the system call openat2 with RESOLVE_BENEATH, which Linux has from 5.6 on, by the names that
 * links resolve to: `path` is relative to `folder`. Returns a descriptor, or -1 with errno, EXDEV
 * where the file is elsewhere. */
int pl_open_by_real_name(const char *folder, const char *path);

#endif
