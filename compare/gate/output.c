/* The formats by name. */
#include "output.h"

const char *const pl_gate_format_names[PL_GATE_FORMAT_COUNT] = {"text", "junit", "github", "json"};

void pl_gate_write(pl_gate_format format, const pl_gate_report *report, pl_text_buffer *out)
{
    switch (format) {
    case PL_GATE_JUNIT:
        pl_gate_write_junit(report, out);
        break;
    case PL_GATE_GITHUB:
        pl_gate_write_github(report, out);
        break;
    case PL_GATE_JSON:
        pl_gate_write_json(report, out);
        break;
    default:
        pl_gate_write_text(report, out);
    }
}
