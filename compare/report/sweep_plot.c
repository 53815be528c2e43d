/* Plots of a sweep as inline SVG: error over cost, and performance profiles. */
#include "sweep_tables.h"

#include "number_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLOURS = 6, MOST_CROSSES = 40 };

/* ---- Axes ---- */

/* The plotted field in pixels, y downwards, and the range of numbers. */
typedef struct axes {
    double left, right, top, bottom;
    double x_low, x_high, y_low, y_high; /* both ends are whole decades where logarithmic */
    bool log_y;                          /* x always is */
} axes;

static const double width = 900, bottom_margin = 48;

static double x_of(const axes *field, double value)
{
    double share = log10(value / field->x_low) / log10(field->x_high / field->x_low);
    return field->left + share * (field->right - field->left);
}

static double y_of(const axes *field, double value)
{
    double share = field->log_y ? log10(value / field->y_low) / log10(field->y_high / field->y_low)
                                : (value - field->y_low) / (field->y_high - field->y_low);
    return field->bottom - share * (field->bottom - field->top);
}

/* Adds a grid line. */
static void add_line(double x0, double y0, double x1, double y1, pl_text_buffer *out)
{
    pl_text_format(out, "<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>", x0, y0, x1, y1);
}

/* Adds a label; `anchor` is the SVG text-anchor. */
static void add_label(double x, double y, const char *anchor, const char *text, pl_text_buffer *out)
{
    pl_text_format(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    pl_text_add_html(out, text);
    pl_text_add(out, "</text>");
}

static void add_decades_of_x(const axes *field, pl_text_buffer *out)
{
    int first = (int)lround(log10(field->x_low)), last = (int)lround(log10(field->x_high));
    int every = (last - first) / 12 + 1;
    for (int i = first; i <= last; ++i) {
        char text[PL_NUMBER_SIZE];
        double x = x_of(field, pow(10, i));
        add_line(x, field->top, x, field->bottom, out);
        if (i >= 0 && i < 4) {
            snprintf(text, sizeof text, "%.0f", pow(10, i));
        } else {
            pl_format_power(pow(10, i), text);
        }
        if ((i - first) % every == 0) {
            add_label(x, field->bottom + 17, "middle", text, out);
        }
    }
}

static void add_steps_of_y(const axes *field, pl_text_buffer *out)
{
    int first = field->log_y ? (int)lround(log10(field->y_low)) : 0;
    int last = field->log_y ? (int)lround(log10(field->y_high)) : 4;
    int every = (last - first) / 15 + 1;
    for (int i = first; i <= last; ++i) {
        char text[PL_NUMBER_SIZE];
        double value = field->log_y ? pow(10, i) : 0.25 * i, y = y_of(field, value);
        add_line(field->left, y, field->right, y, out);
        if (field->log_y) {
            pl_format_power(value, text);
        } else {
            snprintf(text, sizeof text, "%.0f %%", 100 * value);
        }
        if ((i - first) % every == 0) {
            add_label(field->left - 6, y + 4, "end", text, out);
        }
    }
}

static void open_plot(const axes *field, const char *title, const char *x_name, const char *y_name,
                      pl_text_buffer *out)
{
    double height = field->bottom + bottom_margin, middle = 0.5 * (field->top + field->bottom);
    pl_text_format(out,
                   "<svg class=\"plot\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" "
                   "role=\"img\">",
                   width, height, width, height);
    pl_text_add_element(out, "<title>", title, "</title>");
    add_decades_of_x(field, out);
    add_steps_of_y(field, out);
    add_label(0.5 * (field->left + field->right), height - 10, "middle", x_name, out);
    pl_text_format(out, "<g transform=\"translate(16 %.1f) rotate(-90)\">", middle);
    add_label(0, 0, "middle", y_name, out);
    pl_text_add(out, "</g>\n");
}

static void add_marker(const char *classes, int colour, double x, double y, double r,
                       pl_text_buffer *out)
{
    if (colour == 0) {
        pl_text_format(out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\">", classes, x,
                       y, r);
        pl_text_add(out, "</circle>");
        return;
    }
    pl_text_format(out, "<path class=\"%s\" d=\"M", classes);
    static const double shapes[COLOURS][4][2] = {
        {{0}},
        {{-0.85, -0.85}, {0.85, -0.85}, {0.85, 0.85}, {-0.85, 0.85}},
        {{0, -1.1}, {1, 0.8}, {-1, 0.8}, {-1, 0.8}},
        {{0, -1.2}, {1.2, 0}, {0, 1.2}, {-1.2, 0}},
        {{0, 1.1}, {1, -0.8}, {-1, -0.8}, {-1, -0.8}},
        {{-0.5, -1.1}, {0.5, -1.1}, {0.5, 1.1}, {-0.5, 1.1}}};
    for (int i = 0; i < 4; ++i) {
        pl_text_format(out, "%s%.1f %.1f", i == 0 ? "" : "L", x + r * shapes[colour][i][0],
                       y + r * shapes[colour][i][1]);
    }
    pl_text_add(out, "z\"></path>");
}

static void add_legend(const axes *field, int line, int colour, const char *name, const char *note,
                       pl_text_buffer *out)
{
    char classes[16];
    double x = field->right + 24, y = field->top + 14 + 36 * line;
    snprintf(classes, sizeof classes, "m%d", colour);
    add_marker(classes, colour, x, y - 4, 5, out);
    pl_text_format(out, "<text class=\"name\" x=\"%.1f\" y=\"%.1f\">", x + 12, y);
    pl_text_add_html(out, name);
    pl_text_format(out, "</text><text x=\"%.1f\" y=\"%.1f\">", x + 12, y + 15);
    pl_text_add_html(out, note);
    pl_text_add(out, "</text>\n");
}

/* ---- Error over cost ---- */

/* Our first engine of a kind has colour 0; the others of the kind take turns with the rest. */
static int colour_of(const pl_sweep_analysis *analysis, int engine)
{
    const pl_sweep_engine *engines = analysis->engines;
    int ours = 0, all = 0;
    for (int i = 0; i < engine; ++i) {
        ours += engines[i].whole == engines[engine].whole && engines[i].ours;
        all += engines[i].whole == engines[engine].whole;
    }
    if (ours == 0 && engines[engine].ours) {
        return 0;
    }
    return 1 + (all - (ours > 0)) % (COLOURS - 1);
}

static void widen(double value, double *low, double *high)
{
    double decade = pow(10, floor(log10(value) + 1e-9));
    *low = fmin(*low, decade);
    *high = fmax(*high, value > decade * (1 + 1e-9) ? 10 * decade : decade);
}

/* Returns false where there is nothing to plot. */
static bool lay_out(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene, axes *field)
{
    int ok = 0, strips = 0;
    *field = (axes){.left = 72,
                    .right = 710,
                    .x_low = (double)INFINITY,
                    .y_low = (double)INFINITY,
                    .log_y = true};
    for (int i = scene->first; i < scene->first + scene->count; ++i) {
        const pl_sweep_point *point = &analysis->points[i];
        if (point->state != PL_SWEEP_OK) {
            continue;
        }
        ++ok;
        widen(point->cost, &field->x_low, &field->x_high);
        widen(point->error, &field->y_low, &field->y_high);
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        strips += analysis->engines[e].whole && scene->curves[e].failed > 0;
    }
    if (ok == 0) {
        return false;
    }
    if (field->x_high <= field->x_low) {
        field->x_high = 10 * field->x_low;
    }
    if (field->y_high <= field->y_low) {
        field->y_high = 10 * field->y_low;
    }
    field->top = 16 + 16 * strips;
    field->bottom = field->top + 400;
    return true;
}

/* Adds the marker of a point, with a tooltip. */
static void add_point(const pl_sweep_scene *scene, const pl_sweep_point *point, const axes *field,
                      const char *classes, int colour, double r, pl_text_buffer *out)
{
    char step[PL_NUMBER_SIZE], cost[PL_NUMBER_SIZE], error[PL_SWEEP_TEXT_SIZE];
    pl_format_step(point->dt, step);
    pl_format_number(point->cost, "s", cost);
    pl_sweep_error_text(point->error, scene->unit, error);
    pl_text_add_element(out, "<g><title>", point->label, "");
    pl_text_format(out, ", dt %s: ", step);
    pl_text_add_element(out, "", error, " at ");
    pl_text_format(out, "%s for a second</title>", cost);
    add_marker(classes, colour, x_of(field, point->cost), y_of(field, point->error), r, out);
    pl_text_add(out, "</g>");
}

static void add_curve(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                      const axes *field, int engine, pl_text_buffer *out)
{
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
            add_point(scene, point, field, classes, colour, 0.6 * r, out);
        }
    }
    if (curve->front_count > 1) {
        pl_text_format(out, "\n<path class=\"e%d\" d=\"", colour);
    }
    for (int i = 0; i < curve->front_count && curve->front_count > 1; ++i) {
        const pl_sweep_point *point = &analysis->points[curve->front[i]];
        pl_text_format(out, "%c%.1f %.1f", i == 0 ? 'M' : 'L', x_of(field, point->cost),
                       y_of(field, point->error));
    }
    if (curve->front_count > 1) {
        pl_text_add(out, "\"/>\n");
    }
    snprintf(classes, sizeof classes, "m%d", colour);
    for (int i = 0; i < curve->front_count; ++i) {
        add_point(scene, &analysis->points[curve->front[i]], field, classes, colour, r, out);
    }
}

/* Failed points have no numbers, so they are drawn above the field, a row for each engine, as many
 * as fit. */
static void add_crosses(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                        const axes *field, int engine, double y, pl_text_buffer *out)
{
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
        double x = field->left + 8 + 15.5 * drawn++;
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
    axes field;
    char y_name[PL_SWEEP_TEXT_SIZE], title[2 * PL_SWEEP_TEXT_SIZE];
    int line = 0, strip = 0;
    bool bare = scene->unit[0] == '\0' || strcmp(scene->unit, "1") == 0;
    if (!lay_out(analysis, scene, &field)) {
        return;
    }
    snprintf(y_name, sizeof y_name, "%.80s%s%.40s", scene->primary_error, bare ? "" : ", ",
             bare ? "" : scene->unit);
    snprintf(title, sizeof title, "%.250s: error over cost", scene->name);
    pl_text_add(out, "<figure>");
    open_plot(&field, title, "CPU time for a simulated second, s", y_name, out);
    for (int e = analysis->engine_count - 1; e >= 0; e--) {
        if (analysis->engines[e].whole) {
            add_curve(analysis, scene, &field, e, out);
        }
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        const pl_sweep_curve *curve = &scene->curves[e];
        char note[PL_SWEEP_TEXT_SIZE];
        if (!analysis->engines[e].whole || !pl_sweep_curve_was_run(curve)) {
            continue;
        }
        if (curve->failed > 0) {
            add_crosses(analysis, scene, &field, e, 14 + 16 * strip++, out);
        }
        snprintf(note, sizeof note, "%d %s, %d failed", curve->ok,
                 curve->ok == 1 ? "point" : "points", curve->failed);
        add_legend(&field, line++, colour_of(analysis, e), analysis->engines[e].name, note, out);
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
    const axes field = {
        .left = 72, .right = 710, .top = 16, .bottom = 266, .x_low = 1, .x_high = 100, .y_high = 1};
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
    open_plot(&field, title, "factor within which of the fastest engine's cost", "scenes solved",
              out);
    for (int e = analysis->engine_count - 1; e >= 0; e--) {
        const double *ratios = profile->ratios + (size_t)e * (size_t)analysis->scene_count;
        if (analysis->engines[e].whole != profile->whole) {
            continue;
        }
        double share = pl_sweep_share(analysis, profile, e, 1);
        pl_text_format(out, "<path class=\"e%d\" d=\"M%.1f %.1f", colour_of(analysis, e),
                       field.left, y_of(&field, share));
        for (int i = 0; i < profile->counts[e] && ratios[i] <= field.x_high; ++i) {
            if (ratios[i] <= 1) {
                continue;
            }
            share = (double)(i + 1) / profile->scenes;
            pl_text_format(out, "H%.1fV%.1f", x_of(&field, ratios[i]), y_of(&field, share));
        }
        pl_text_format(out, "H%.1f\"/>\n", field.right);
    }
    for (int e = 0; e < analysis->engine_count; ++e) {
        char note[PL_SWEEP_TEXT_SIZE];
        if (analysis->engines[e].whole != profile->whole) {
            continue;
        }
        snprintf(note, sizeof note, "solves %d of %d", profile->counts[e], profile->scenes);
        add_legend(&field, line++, colour_of(analysis, e), analysis->engines[e].name, note, out);
    }
    pl_text_add(out, "</svg></figure>\n");
}
