/* plumb __complete WORD...: what a shell may put in the place of the last word. Only the scripts of
 * compare/completion call it, so that `plumb help` does not list it. */
#ifndef PLUMB_COMPLETE_H
#define PLUMB_COMPLETE_H

#include "command.h"

/* Prints what can stand in the place of the last of `words`, the command line after `plumb`. Each
 * candidate is a line "CANDIDATE\tDESCRIPTION", where CANDIDATE is the whole word. After one that
 * ends in '=', ',' or ':' the word goes on. A line ":files SUFFIX" stands for all files whose names
 * end in SUFFIX, and for all folders; for folders alone where SUFFIX is "/", and for all files where
 * it is empty. Such a line comes only where no candidate fits. No engine is started. Never fails, and
 * returns PL_EXIT_OK. */
int pl_complete(const pl_command *const *commands, int command_count, int word_count,
                char *const *words);

#endif
