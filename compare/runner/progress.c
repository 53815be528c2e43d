#include "progress.h"

#include "base/folding.h"
#include "base/heap.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { WIDEST_BAR = 20 };

pl_progress pl_progress_begin(FILE *out, long total, double now)
{
    const char *plain = getenv("NO_COLOR");
    pl_progress progress = {.out = out,
                            .terminal = isatty(fileno(out)) == 1,
                            .width = 80,
                            .total = total,
                            .started = now};
    progress.colour = progress.terminal && (plain == NULL || plain[0] == '\0');
    struct winsize size;
    if (progress.terminal && ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
        progress.width = size.ws_col;
    }
    return progress;
}

/* "1:02:03" or "2:03". */
static void format_time(double seconds, char *text, size_t size)
{
    long s = (long)(seconds + 0.5);
    if (s >= 3600) {
        snprintf(text, size, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
    } else {
        snprintf(text, size, "%ld:%02ld", s / 60, s % 60);
    }
}

void pl_progress_draw(const pl_progress *progress, const char *running, double part, double now)
{
    if (!progress->terminal || progress->total == 0) {
        return;
    }
    double done = (double)progress->done + part;
    /* On a narrow terminal the names need the width more than the bar does. */
    int quarter = progress->width / 4;
    int length = quarter < WIDEST_BAR ? quarter : WIDEST_BAR;
    int filled = (int)(length * done / (double)progress->total);
    char bar[WIDEST_BAR + 1];
    memset(bar, '.', (size_t)length);
    memset(bar, '#', (size_t)(filled > length ? length : filled));
    bar[length] = '\0';
    char left[32] = "?";
    if (done > 0.01) {
        format_time((now - progress->started) * ((double)progress->total - done) / done, left,
                    sizeof left);
    }
    char line[512];
    snprintf(line, sizeof line, "%ld/%ld [%s] %s left  %s", progress->done, progress->total, bar,
             left, running);
    pl_make_plain(line);
    const size_t length_shown = pl_text_fitting(line, progress->width - 1);
    fprintf(progress->out, "\r%.*s\033[K", (int)length_shown, line);
    fflush(progress->out);
}

void pl_progress_run_ended(pl_progress *progress, const char *title, const json_t *result,
                           double seconds)
{
    static const char *const colours[PL_VERDICT_COUNT] = {"", "\033[33m", "\033[31m", ""};
    const pl_verdict verdict = pl_verdict_of(result);
    const char *outcome = pl_json_get_text(result, "outcome");
    const bool is_judged = verdict != PL_VERDICT_UNJUDGED;
    const bool good = is_judged ? verdict == PL_VERDICT_ACCURATE : strcmp(outcome, "ok") == 0;
    const char *word = is_judged ? pl_verdict_name(verdict) : outcome;
    const char *reason = pl_json_get_text(result, is_judged ? "verdict_reason" : "reason");
    const char *colour = progress->colour ? colours[verdict] : "";
    progress->done += 1;
    if (progress->terminal && good) {
        return;
    }
    pl_text_buffer line = {0};
    const char *label = pl_json_get_text(result, "label");
    pl_text_format(&line, "%s[%ld/%ld] ", progress->terminal ? "\r\033[K" : "", progress->done,
                   progress->total);
    pl_text_add_plain(&line, title, strlen(title));
    pl_text_add(&line, "  ");
    pl_text_add_plain(&line, label, strlen(label));
    pl_text_format(&line, "  %s%s%s  %.2f s%s", colour, word, colour[0] == '\0' ? "" : "\033[0m",
                   seconds, good || reason[0] == '\0' ? "" : ": ");
    pl_text_add_plain(&line, reason, good ? 0 : strlen(reason));
    pl_text_add(&line, "\n");
    pl_text_print(&line, progress->out);
}

void pl_progress_end(const pl_progress *progress)
{
    if (progress->terminal) {
        fprintf(progress->out, "\r\033[K");
    }
    fflush(progress->out);
}
