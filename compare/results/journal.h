/* What an unfinished study has found so far, so that it need not be found again after a kill: a file
 * of JSON lines, which is removed when the study ends. A study that goes on asks for the same things
 * in the same order as the one that was killed. */
#ifndef PLUMB_JOURNAL_H
#define PLUMB_JOURNAL_H

#include "store.h"

/* An open journal. */
typedef struct pl_journal pl_journal;

/* Opens the journal FOLDER/plumb-NAME-STUDY.unfinished.jsonl, where `study` is a hash that tells
 * studies of the command `name` apart. `*journal` stays NULL where the folder takes no
 * files: nothing is then kept. PL_BAD_INPUT, which changes nothing: with
 * PL_STORE_NEW, a study was not finished. PL_IO also when another process is making the study. */
pl_status pl_journal_open(const char *folder, const char *name, const char *study,
                          pl_store_mode mode, pl_journal **journal, pl_error *error);

/* The path of the journal without ".jsonl", for further files of the study. Borrowed. */
const char *pl_journal_path(const pl_journal *journal);

/* The oldest value of that key that was not taken yet, as a new reference; NULL: there is none, or no
 * journal. What the caller finds out instead goes to pl_journal_add. */
json_t *pl_journal_take(pl_journal *journal, const char *key);

/* Adds a value to the file, as pl_store_append; nothing where `journal` is NULL. Keeps its own
 * reference. */
pl_status pl_journal_add(pl_journal *journal, const char *key, json_t *value, pl_error *error);

/* The number of values in the file. */
size_t pl_journal_size(const pl_journal *journal);

/* Closes the journal, and removes its file when the study is `finished` or it is empty; NULL is
 * allowed. */
void pl_journal_close(pl_journal *journal, bool finished);

#endif
