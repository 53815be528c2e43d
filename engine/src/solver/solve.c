#include "solve.h"

void pe_solve_note(pe_solve_report *report, int iterations, double residual)
{
    pe_solve_history *history = report->history;
    if (history == NULL || history->count == history->capacity) {
        return;
    }
    history->marks[history->count++] = (pe_solve_mark){
        .iterations = iterations,
        .residual = residual,
        .seconds = history->clock != NULL ? history->clock() - history->began : 0,
    };
}
