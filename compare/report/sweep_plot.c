/* Plots of a sweep as inline SVG: error over cost, and performance profiles. */
#include "sweep_tables.h"

#include "number_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLOURS = 6, MOST_CROSSES = 40 };

/* ---- Axes ---- */

/* A plot: the plotted field in pixels, y downwards, and the range of numbers. */
typedef struct sweep_plot {
    pl_text_buffer *out;
    const pl_sweep_analysis *analysis;
    const pl_sweep_scene *scene; /* NULL in a performance profile */
    double left, right, top, bottom;
    double x_low, x_high, y_low, y_high; /* both ends are whole decades where logarithmic */
    bool log_y;                          /* x always is */
} sweep_plot;

static const double width = 900, bottom_margin = 48;

static double x_of(const sweep_plot *plot, double value)
{
    double share = log10(value / plot->x_low) / log10(plot->x_high / plot->x_low);
    return plot->left + share * (plot->right - plot->left);
}

static double y_of(const sweep_plot *plot, double value)
{
    double share = plot->log_y ? log10(value / plot->y_low) / log10(plot->y_high / plot->y_low)
                               : (value - plot->y_low) / (plot->y_high - plot->y_low);
    return plot->bottom - share * (plot->bottom - plot->top);
}

/* Adds a grid line. */
static void add_line(const sweep_plot *plot, double x0, double y0, double x1, double y1)
{
    pl_text_format(plot->out, "<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>", x0, y0, x1, y1);
}

/* Adds a label; `anchor` is the SVG text-anchor. */
static void add_label(const sweep_plot *plot, double x, double y, const char *anchor,
                      const char *text)
{
    pl_text_format(plot->out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    pl_text_add_html(plot->out, text);
    pl_text_add(plot->out, "</text>");
}

static void add_decades_of_x(const sweep_plot *plot)
{
    int first = (int)lround(log10(plot->x_low)), last = (int)lround(log10(plot->x_high));
    int every = (last - first) / 12 + 1;
    for (int i = first; i <= last; ++i) {
        char text[PL_NUMBER_SIZE];
        double x = x_of(plot, pow(10, i));
        add_line(plot, x, plot->top, x, plot->bottom);
        if (i >= 0 && i < 4) {
            snprintf(text, sizeof text, "%.0f", pow(10, i));
        } else {
            pl_format_power(pow(10, i), text);
        }
        if ((i - first) % every == 0) {
            add_label(plot, x, plot->bottom + 17, "middle", text);
        }
    }
}

static void add_steps_of_y(const sweep_plot *plot)
{
    int first = plot->log_y ? (int)lround(log10(plot->y_low)) : 0;
    int last = plot->log_y ? (int)lround(log10(plot->y_high)) : 4;
    int every = (last - first) / 15 + 1;
    for (int i = first; i <= last; ++i) {
        char text[PL_NUMBER_SIZE];
        double value = plot->log_y ? pow(10, i) : 0.25 * i, y = y_of(plot, value);
        add_line(plot, plot->left, y, plot->right, y);
        if (plot->log_y) {
            pl_format_power(value, text);
        } else {
            snprintf(text, sizeof text, "%.0f %%", 100 * value);
        }
        if ((i - first) % every == 0) {
            add_label(plot, plot->left - 6, y + 4, "end", text);
        }
    }
}

static void open_plot(const sweep_plot *plot, const char *title, const char *x_name,
                      const char *y_name)
{
    double height = plot->bottom + bottom_margin, middle = 0.5 * (plot->top + plot->bottom);
    pl_text_format(plot->out,
                   "<svg class=\"plot\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" "
                   "role=\"img\">",
                   width, height, width, height);
    pl_text_add_element(plot->out, "<title>", title, "</title>");
    add_decades_of_x(plot);
    add_steps_of_y(plot);
    add_label(plot, 0.5 * (plot->left + plot->right), height - 10, "middle", x_name);
    pl_text_format(plot->out, "<g transform=\"translate(16 %.1f) rotate(-90)\">", middle);
    add_label(plot, 0, 0, "middle", y_name);
    pl_text_add(plot->out, "</g>\n");
}

/* Adds a marker of half-width r, px; each colour has its own shape. */
static void add_marker(const sweep_plot *plot, const char *classes, int colour, double x, double y,
                       double r)
{
    if (colour == 0) {
        pl_text_format(plot->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\">",
                       classes, x, y, r);
        pl_text_add(plot->out, "</circle>");
        return;
    }
    pl_text_format(plot->out, "<path class=\"%s\" d=\"M", classes);
    static const double shapes[COLOURS][4][2] = {
        {{0}},
        {{-0.85, -0.85}, {0.85, -0.85}, {0.85, 0.85}, {-0.85, 0.85}},
        {{0, -1.1}, {1, 0.8}, {-1, 0.8}, {-1, 0.8}},
        {{0, -1.2}, {1.2, 0}, {0, 1.2}, {-1.2, 0}},
        {{0, 1.1}, {1, -0.8}, {-1, -0.8}, {-1, -0.8}},
        {{-0.5, -1.1}, {0.5, -1.1}, {0.5, 1.1}, {-0.5, 1.1}}};
    for (int i = 0; i < 4; ++i) {
        pl_text_format(plot->out, "%s%.1f %.1f", i == 0 ? "" : "L", x + r * shapes[colour][i][0],
                       y + r * shapes[colour][i][1]);
    }
    pl_text_add(plot->out, "z\"></path>");
}

/* Our first engine of a kind has colour 0; the others of the kind take turns with the rest. */
static int colour_of(const pl_sweep_analysis *analysis, int engine)
{
    const pl_sweep_engine *engines = analysis->engines;
    int ours = 0, all = 0;
    for (int i = 0; i < engine; ++i) {
        ours += engines[i].kind == engines[engine].kind && engines[i].ours;
        all += engines[i].kind == engines[engine].kind;
    }
    if (ours == 0 && engines[engine].ours) {
        return 0;
    }
    return 1 + (all - (ours > 0)) % (COLOURS - 1);
}

/* Adds an engine to the legend. */
static void add_legend(const sweep_plot *plot, int line, int engine, const char *note)
{
    const int colour = colour_of(plot->analysis, engine);
    char classes[16];
    double x = plot->right + 24, y = plot->top + 14 + 36 * line;
    snprintf(classes, sizeof classes, "m%d", colour);
    add_marker(plot, classes, colour, x, y - 4, 5);
    pl_text_format(plot->out, "<text class=\"name\" x=\"%.1f\" y=\"%.1f\">", x + 12, y);
    pl_text_add_html(plot->out, plot->analysis->engines[engine].name);
    pl_text_format(plot->out, "</text><text x=\"%.1f\" y=\"%.1f\">", x + 12, y + 15);
    pl_text_add_html(plot->out, note);
    pl_text_add(plot->out, "</text>\n");
}

/* ---- Error over cost ---- */

static void widen(double value, double *low, double *high)
{
    double decade = pow(10, floor(log10(value) + 1e-9));
    *low = fmin(*low, decade);
    *high = fmax(*high, value > decade * (1 + 1e-9) ? 10 * decade : decade);
}

/* Returns false where there is nothing to plot. */
static bool lay_out(sweep_plot *plot)
{
    const pl_sweep_analysis *analysis = plot->analysis;
    const pl_sweep_scene *scene = plot->scene;
    int ok = 0, strips = 0;
    for (int i = scene->first; i < scene->first + scene->count; ++i) {
        const pl_sweep_point *point = &analysis->points[i];
        if (point->state != PL_SWEEP_OK) {
            continue;
        }
        ++ok;
        widen(point->cost, &plot->x_low, &plot->x_high);
        widen(point->error, &plot->y_low, &plot->y_high);
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        strips += analysis->engines[e].kind == PL_SWEEP_WHOLE && scene->curves[e].failed > 0;
    }
    if (ok == 0) {
        return false;
    }
    if (plot->x_high <= plot->x_low) {
        plot->x_high = 10 * plot->x_low;
    }
    if (plot->y_high <= plot->y_low) {
        plot->y_high = 10 * plot->y_low;
    }
    plot->top = 16 + 16 * strips;
    plot->bottom = plot->top + 400;
    return true;
}

/* Adds the marker of a point, with a tooltip. */
static void add_point(const sweep_plot *plot, const pl_sweep_point *point, const char *classes,
                      int colour, double r)
{
    char step[PL_NUMBER_SIZE], cost[PL_NUMBER_SIZE], error[PL_SWEEP_TEXT_SIZE];
    pl_format_step(point->dt, step);
    pl_format_number(point->cost, "s", cost);
    pl_sweep_error_text(point->error, plot->scene->unit, error);
    pl_text_add_element(plot->out, "<g><title>", point->label, "");
    pl_text_format(plot->out, ", dt %s: ", step);
    pl_text_add_element(plot->out, "", error, " at ");
    pl_text_format(plot->out, "%s for a second</title>", cost);
    add_marker(plot, classes, colour, x_of(plot, point->cost), y_of(plot, point->error), r);
    pl_text_add(plot->out, "</g>");
}

static void add_curve(const sweep_plot *plot, int engine)
{
    const pl_sweep_analysis *analysis = plot->analysis;
    const pl_sweep_scene *scene = plot->scene;
    const pl_sweep_curve *curve = &scene->curves[engine];
    const int colour = colour_of(analysis, engine);
    const double r = colour == 0 ? 5 : 4;
    char classes[16];
    snprintf(classes, sizeof classes, "m%d off", colour);
    for (int i = scene->first, next = 0; i < scene->first + scene->count; ++i) {
        const pl_sweep_point *point = &analysis->points[i];
        bool on_front = false;
        for (next = 0; next < curve->front_count && !on_front; ++next) {
            on_front = curve->front[next] == i;
        }
        if (point->state == PL_SWEEP_OK && pl_sweep_point_is_of(point, engine) && !on_front) {
            add_point(plot, point, classes, colour, 0.6 * r);
        }
    }
    if (curve->front_count > 1) {
        pl_text_format(plot->out, "\n<path class=\"e%d\" d=\"", colour);
    }
    for (int i = 0; i < curve->front_count && curve->front_count > 1; ++i) {
        const pl_sweep_point *point = &analysis->points[curve->front[i]];
        pl_text_format(plot->out, "%c%.1f %.1f", i == 0 ? 'M' : 'L', x_of(plot, point->cost),
                       y_of(plot, point->error));
    }
    if (curve->front_count > 1) {
        pl_text_add(plot->out, "\"/>\n");
    }
    snprintf(classes, sizeof classes, "m%d", colour);
    for (int i = 0; i < curve->front_count; ++i) {
        add_point(plot, &analysis->points[curve->front[i]], classes, colour, r);
    }
}

/* Failed points have no numbers. They are drawn above the field, in one row for each engine, as
 * many as fit. */
static void add_crosses(const sweep_plot *plot, int engine, double y)
{
    const pl_sweep_analysis *analysis = plot->analysis;
    const pl_sweep_scene *scene = plot->scene;
    pl_text_buffer *out = plot->out;
    const int failed = scene->curves[engine].failed, colour = colour_of(analysis, engine);
    const int shown = failed < MOST_CROSSES ? failed : MOST_CROSSES;
    int met = 0, drawn = 0;
    for (int i = scene->first; i < scene->first + scene->count; ++i) {
        const pl_sweep_point *point = &analysis->points[i];
        if (point->state != PL_SWEEP_FAILED || !pl_sweep_point_is_of(point, engine)) {
            continue;
        }
        if (met++ * shown < drawn * failed) {
            continue;
        }
        char step[PL_NUMBER_SIZE];
        double x = plot->left + 8 + 15.5 * drawn++;
        pl_format_step(point->dt, step);
        pl_text_add_element(out, "<g><title>", point->label, ", dt ");
        pl_text_add_element(out, step, ": ", "");
        pl_text_add_element(out, "", point->outcome, "</title>");
        pl_text_format(out, "<path class=\"e%d cross\" d=\"M%.1f %.1fl8 8m0 -8l-8 8\"/></g>",
                       colour, x - 4, y - 4);
    }
    pl_text_add(out, "\n");
}

void pl_sweep_plot_scene(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                         pl_text_buffer *out)
{
    sweep_plot plot = {.out = out,
                       .analysis = analysis,
                       .scene = scene,
                       .left = 72,
                       .right = 710,
                       .x_low = (double)INFINITY,
                       .y_low = (double)INFINITY,
                       .log_y = true};
    char y_name[PL_SWEEP_TEXT_SIZE], title[2 * PL_SWEEP_TEXT_SIZE];
    int line = 0, strip = 0;
    bool bare = scene->unit[0] == '\0' || strcmp(scene->unit, "1") == 0;
    if (!lay_out(&plot)) {
        return;
    }
    snprintf(y_name, sizeof y_name, "%.80s%s%.40s", scene->primary_error, bare ? "" : ", ",
             bare ? "" : scene->unit);
    snprintf(title, sizeof title, "%.250s: error over cost", scene->name);
    pl_text_add(out, "<figure>");
    open_plot(&plot, title, "CPU time for a simulated second, s", y_name);
    for (int e = analysis->engine_count - 1; e >= 0; --e) {
        if (analysis->engines[e].kind == PL_SWEEP_WHOLE) {
            add_curve(&plot, e);
        }
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        const pl_sweep_curve *curve = &scene->curves[e];
        char note[PL_SWEEP_TEXT_SIZE];
        if (analysis->engines[e].kind != PL_SWEEP_WHOLE || !pl_sweep_curve_was_run(curve)) {
            continue;
        }
        if (curve->failed > 0) {
            add_crosses(&plot, e, 14 + 16 * strip++);
        }
        snprintf(note, sizeof note, "%d %s, %d failed", curve->ok,
                 curve->ok == 1 ? "point" : "points", curve->failed);
        add_legend(&plot, line++, e, note);
    }
    pl_text_add(out, "</svg><figcaption>Towards the lower left is better. A line is an engine's "
                     "front; crosses along the upper edge are points that failed. An error below "
                     "1e-9 is drawn at 1e-9.</figcaption>"
                     "</figure>\n");
}

/* ---- Performance profiles ---- */

void pl_sweep_plot_profile(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile,
                           pl_text_buffer *out)
{
    const sweep_plot plot = {.out = out,
                             .analysis = analysis,
                             .left = 72,
                             .right = 710,
                             .top = 16,
                             .bottom = 266,
                             .x_low = 1,
                             .x_high = 100,
                             .y_high = 1};
    int solved = 0, line = 0;
    char title[PL_SWEEP_TEXT_SIZE], error[PL_NUMBER_SIZE];
    for (int e = 0; e < analysis->engine_count; ++e) {
        solved += profile->counts[e];
    }
    if (solved == 0) {
        return;
    }
    pl_format_power(pl_sweep_levels[profile->level], error);
    snprintf(title, sizeof title, "Performance profile at an error of %.20s", error);
    pl_text_add(out, "<figure>");
    open_plot(&plot, title, "factor within which of the fastest engine's cost", "scenes solved");
    for (int e = analysis->engine_count - 1; e >= 0; --e) {
        const double *ratios = profile->ratios + (size_t)e * (size_t)analysis->scene_count;
        if (analysis->engines[e].kind != profile->kind) {
            continue;
        }
        double share = pl_sweep_share(analysis, profile, e, 1);
        pl_text_format(out, "<path class=\"e%d\" d=\"M%.1f %.1f", colour_of(analysis, e), plot.left,
                       y_of(&plot, share));
        for (int i = 0; i < profile->counts[e] && ratios[i] <= plot.x_high; ++i) {
            if (ratios[i] <= 1) {
                continue;
            }
            share = (double)(i + 1) / profile->scenes;
            pl_text_format(out, "H%.1fV%.1f", x_of(&plot, ratios[i]), y_of(&plot, share));
        }
        pl_text_format(out, "H%.1f\"/>\n", plot.right);
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        char note[PL_SWEEP_TEXT_SIZE];
        if (analysis->engines[e].kind != profile->kind) {
            continue;
        }
        snprintf(note, sizeof note, "solves %d of %d", profile->counts[e], profile->scenes);
        add_legend(&plot, line++, e, note);
    }
    pl_text_add(out, "</svg></figure>\n");
}
