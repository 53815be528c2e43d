/* A report of the gate in the formats that people and machines read. */
#ifndef PLUMB_GATE_OUTPUT_H
#define PLUMB_GATE_OUTPUT_H

#include "base/text_buffer.h"
#include "gate_report.h"

typedef enum pl_gate_format {
    PL_GATE_TEXT,
    PL_GATE_JUNIT,
    PL_GATE_GITHUB,
    PL_GATE_JSON,
    PL_GATE_FORMAT_COUNT
} pl_gate_format;

/* "text", "junit", "github", "json". */
extern const char *const pl_gate_format_names[PL_GATE_FORMAT_COUNT];

void pl_gate_write(pl_gate_format format, const pl_gate_report *report, pl_text_buffer *out);

/* One line a finding, then the summary. */
void pl_gate_write_text(const pl_gate_report *report, pl_text_buffer *out);

/* A test case for each run and each rule that judged nothing. */
void pl_gate_write_junit(const pl_gate_report *report, pl_text_buffer *out);

/* Workflow commands of GitHub Actions, and the summary in plain text. */
void pl_gate_write_github(const pl_gate_report *report, pl_text_buffer *out);

/* The page of a job of GitHub Actions. */
void pl_gate_write_markdown(const pl_gate_report *report, pl_text_buffer *out);

/* plumb.gate/1 (SCHEMA.md). */
void pl_gate_write_json(const pl_gate_report *report, pl_text_buffer *out);

/* "tower n=10 / plumb:accurate", or of how many rows it is. */
void pl_gate_finding_place(const pl_gate_finding *finding, char *text, size_t size);

/* "1.000 m -> 1.010 m, allowed: ...; worse by 1 %", all that is not the place and the metric. */
void pl_gate_finding_words(const pl_gate_finding *finding, char *text, size_t size);

#endif
