/* What all formats say of a finding alike. */
#include "output.h"

#include <stdio.h>

void pl_gate_finding_place(const pl_gate_finding *finding, char *text, size_t size)
{
    if (finding->row != NULL) {
        snprintf(text, size, "%s / %s", finding->row->name, finding->row->label);
    } else if (finding->row_count > 0) {
        snprintf(text, size, "%d row%s", finding->row_count, finding->row_count == 1 ? "" : "s");
    } else {
        snprintf(text, size, "no row");
    }
}

void pl_gate_finding_words(const pl_gate_finding *finding, char *text, size_t size)
{
    bool has_before = finding->before[0] != '\0', has_after = finding->after[0] != '\0';
    bool has_values = has_before || has_after;
    char values[256], limit[160] = "";
    snprintf(values, sizeof values, "%s%s%s", finding->before,
             has_before && has_after ? " -> " : "", finding->after);
    if (finding->limit[0] != '\0') {
        snprintf(limit, sizeof limit, "%sallowed: %s", has_values ? ", " : "", finding->limit);
    }
    bool alone = !has_values && limit[0] == '\0';
    snprintf(text, size, "%s%s%s%s%s", values, limit, alone ? "" : " (", finding->what,
             alone ? "" : ")");
}
