/* What is known of the adapters of the engines in a report: whether conformance checks passed, and
 * which numbers were read back and compared. Reports claim no more than that. */
#ifndef PLUMB_ADAPTER_TRUST_H
#define PLUMB_ADAPTER_TRUST_H

#include "base/document.h"
#include "queries.h"

/* Adds what is known of a configuration's conformance: "conformance passed (31 checks, plumb 0.9.0)",
 * "conformance FAILED: 2 of 31 checks", or "not verified: run plumb check-engine SPEC". Checks are
 * made with a profile's default options: where its label is not that of the profile alone,
 * the text names the profile. */
void pl_conformance_text(const pl_result_table *results, int configuration, pl_text_buffer *out);

/* Adds, in words, whether the conformance of the configurations that are marked in `listed` (configuration_count)
 * was verified, and which numbers were read back from their engines. */
void pl_describe_adapters(const pl_result_table *results, const bool *listed,
                          pl_document *document);

#endif
