/* What `plumb check-engine` found, kept from one program run to the next: one file for each
 * engine binary and profile. Reports take from here whether an adapter was verified.
 *
 * The files are in $PLUMB_CACHE, else in $XDG_CACHE_HOME/plumb, else in $HOME/.cache/plumb, and are
 * called conformance-BINARY-ENGINE-PROFILE.json. Without any of these variables nothing is kept. A
 * changed binary has no record. */
#ifndef PLUMB_CONFORMANCE_RECORD_H
#define PLUMB_CONFORMANCE_RECORD_H

#include "engines/engine_info.h"

#include <jansson.h>

/* Keeps that `checks` checks were made and `failed` of them failed, and that `skipped` others were
 * skipped. For a run of all checks with the profile's default options only: `passed` is claimed of
 * the profile. An engine without a binary hash, because it could not be loaded, has no record.
 * PL_IO: the folder cannot be written. */
pl_status pl_conformance_record_write(const pl_engine_info *engine, const char *profile, int checks,
                                      int failed, int skipped, pl_error *error);

/* What is known of this binary of the engine with the profile, as results say it: {"outcome", "checks", "failed",
 * "plumb"}, where `checks` were made, and `plumb` is the version that made them. JSON null: there is no record, or it
 * is damaged or not of this engine. A new reference. */
json_t *pl_conformance_find(const pl_engine_info *engine, const char *profile);

#endif
