#include "sweep_plot.h"

#include "sweep_axes.h"
#include "sweep_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { CROSSES_MOST = 40 };

const char *const pl_sweep_style[] = {
    ":root{--e0:#9a5b13;--e1:#2f6db3;--e2:#2d8a57;--e3:#8452b0;--e4:#b3423a;--e5:#5c6370}",
    "@media screen and (prefers-color-scheme:dark){:root{--e0:#e0a458;--e1:#7fb0ea;--e2:#6cc78c;"
    "--e3:#c09be6;--e4:#ff8a7d;--e5:#9aa2ad}}",
    ".plot text{fill:var(--soft);font-size:12px}",
    ".plot .name{fill:var(--ink);font-weight:600;font-size:13px}",
    ".plot .grid{stroke:var(--line);stroke-width:1}",
    ".plot .e0,.plot .e1,.plot .e2,.plot .e3,.plot .e4,.plot .e5{fill:none;stroke-width:1.6;"
    "stroke-linejoin:round}",
    ".plot .e0{stroke:var(--e0);stroke-width:3.2}",
    ".plot .e1{stroke:var(--e1)}",
    ".plot .e2{stroke:var(--e2)}",
    ".plot .e3{stroke:var(--e3)}",
    ".plot .e4{stroke:var(--e4)}",
    ".plot .e5{stroke:var(--e5)}",
    ".plot .m0{fill:var(--e0)}",
    ".plot .m1{fill:var(--e1)}",
    ".plot .m2{fill:var(--e2)}",
    ".plot .m3{fill:var(--e3)}",
    ".plot .m4{fill:var(--e4)}",
    ".plot .m5{fill:var(--e5)}",
    ".plot .off{opacity:.3}",
    NULL};

/* Our first engine of a kind has colour 0; the others of the kind take turns with the rest. */
static int colour_of(const pl_sweep_analysis *analysis, int engine)
{
    const pl_sweep_engine *engines = analysis->engines;
    int ours = 0, all = 0;
    for (int i = 0; i < engine; i++) {
        ours += engines[i].whole == engines[engine].whole && engines[i].ours;
        all += engines[i].whole == engines[engine].whole;
    }
    if (ours == 0 && engines[engine].ours)
        return 0;
    return 1 + (all - (ours > 0)) % (PL_SWEEP_COLOURS - 1);
}

/* --- A scene --- */

static void widen(double value, double *low, double *high)
{
    double decade = pow(10, floor(log10(value) + 1e-9));
    *low = fmin(*low, decade);
    *high = fmax(*high, value > decade * (1 + 1e-9) ? 10 * decade : decade);
}

/* False where there is nothing to plot. */
static bool lay_out(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                    pl_sweep_axes *axes)
{
    int ok = 0, strips = 0;
    *axes = (pl_sweep_axes){.left = 72,
                            .right = 710,
                            .x_low = (double)INFINITY,
                            .y_low = (double)INFINITY,
                            .log_y = true};
    for (int i = scene->first; i < scene->first + scene->count; i++) {
        const pl_sweep_point *point = &analysis->points[i];
        if (point->state != PL_SWEEP_OK)
            continue;
        ok++;
        widen(point->cost, &axes->x_low, &axes->x_high);
        widen(point->error, &axes->y_low, &axes->y_high);
    }
    for (int e = 0; e < analysis->engine_count; e++)
        strips += analysis->engines[e].whole && scene->curves[e].failed > 0;
    if (ok == 0)
        return false;
    if (axes->x_high <= axes->x_low)
        axes->x_high = 10 * axes->x_low;
    if (axes->y_high <= axes->y_low)
        axes->y_high = 10 * axes->y_low;
    axes->top = 16 + 16 * strips;
    axes->bottom = axes->top + 400;
    return true;
}

/* The same marker, with a tooltip. */
static void add_point(const pl_sweep_scene *scene, const pl_sweep_point *point,
                      const pl_sweep_axes *axes, const char *classes, int colour, double r,
                      pl_text_buffer *out)
{
    char step[PL_SWEEP_TEXT_SIZE], cost[PL_SWEEP_TEXT_SIZE], error[PL_SWEEP_TEXT_SIZE];
    pl_sweep_step_text(point->dt, step);
    pl_sweep_cost_text(point->cost, cost);
    pl_sweep_error_text(point->error, scene->unit, error);
    pl_text_add_element(out, "<g><title>", point->label, "");
    pl_text_format(out, ", dt %s: ", step);
    pl_text_add_element(out, "", error, " at ");
    pl_text_format(out, "%s for a second</title>", cost);
    pl_sweep_marker(classes, colour, pl_sweep_x(axes, point->cost), pl_sweep_y(axes, point->error),
                    r, out);
    pl_text_add(out, "</g>");
}

static void add_curve(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                      const pl_sweep_axes *axes, int engine, pl_text_buffer *out)
{
    const pl_sweep_curve *curve = &scene->curves[engine];
    const int colour = colour_of(analysis, engine);
    const double r = colour == 0 ? 5 : 4;
    char classes[16];
    snprintf(classes, sizeof classes, "m%d off", colour);
    for (int i = scene->first, next = 0; i < scene->first + scene->count; i++) {
        const pl_sweep_point *point = &analysis->points[i];
        bool on_front = false;
        for (next = 0; next < curve->front_count && !on_front; next++)
            on_front = curve->front[next] == i;
        if (point->state == PL_SWEEP_OK && pl_sweep_point_is_of(point, engine) && !on_front)
            add_point(scene, point, axes, classes, colour, 0.6 * r, out);
    }
    if (curve->front_count > 1)
        pl_text_format(out, "\n<path class=\"e%d\" d=\"", colour);
    for (int i = 0; i < curve->front_count && curve->front_count > 1; i++) {
        const pl_sweep_point *point = &analysis->points[curve->front[i]];
        pl_text_format(out, "%c%.1f %.1f", i == 0 ? 'M' : 'L', pl_sweep_x(axes, point->cost),
                       pl_sweep_y(axes, point->error));
    }
    if (curve->front_count > 1)
        pl_text_add(out, "\"/>\n");
    snprintf(classes, sizeof classes, "m%d", colour);
    for (int i = 0; i < curve->front_count; i++)
        add_point(scene, &analysis->points[curve->front[i]], axes, classes, colour, r, out);
}

/* Failed points have no place: they stand in a row above the field, an engine a row, all of them
 * or as many as fit. */
static void add_crosses(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                        const pl_sweep_axes *axes, int engine, double y, pl_text_buffer *out)
{
    const int failed = scene->curves[engine].failed, colour = colour_of(analysis, engine);
    const int shown = failed < CROSSES_MOST ? failed : CROSSES_MOST;
    int met = 0, drawn = 0;
    for (int i = scene->first; i < scene->first + scene->count; i++) {
        const pl_sweep_point *point = &analysis->points[i];
        if (point->state != PL_SWEEP_FAILED || !pl_sweep_point_is_of(point, engine))
            continue;
        if (met++ * shown < drawn * failed)
            continue;
        char step[PL_SWEEP_TEXT_SIZE];
        double x = axes->left + 8 + 15.5 * drawn++;
        pl_sweep_step_text(point->dt, step);
        pl_text_add_element(out, "<g><title>", point->label, ", dt ");
        pl_text_add_element(out, step, ": ", "");
        pl_text_add_element(out, "", point->outcome, "</title>");
        pl_text_format(out, "<path class=\"e%d cross\" d=\"M%.1f %.1fl8 8m0 -8l-8 8\"/></g>",
                       colour, x - 4, y - 4);
    }
    pl_text_add(out, "\n");
}

void pl_sweep_plot_problem(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                           pl_text_buffer *out)
{
    pl_sweep_axes axes;
    char y_name[PL_SWEEP_TEXT_SIZE], title[2 * PL_SWEEP_TEXT_SIZE];
    int line = 0, strip = 0;
    bool bare = scene->unit[0] == '\0' || strcmp(scene->unit, "1") == 0;
    if (!lay_out(analysis, scene, &axes))
        return;
    snprintf(y_name, sizeof y_name, "%.80s%s%.40s", scene->primary_error, bare ? "" : ", ",
             bare ? "" : scene->unit);
    snprintf(title, sizeof title, "%.250s: error over cost", scene->name);
    pl_text_add(out, "<figure>");
    pl_sweep_axes_open(&axes, title, "CPU time for a simulated second, s", y_name, out);
    for (int e = analysis->engine_count - 1; e >= 0; e--)
        if (analysis->engines[e].whole)
            add_curve(analysis, scene, &axes, e, out);
    for (int e = 0; e < analysis->engine_count; e++) {
        const pl_sweep_curve *curve = &scene->curves[e];
        char note[PL_SWEEP_TEXT_SIZE];
        if (!analysis->engines[e].whole || !pl_sweep_curve_was_run(curve))
            continue;
        if (curve->failed > 0)
            add_crosses(analysis, scene, &axes, e, 14 + 16 * strip++, out);
        snprintf(note, sizeof note, "%d %s, %d failed", curve->ok,
                 curve->ok == 1 ? "point" : "points", curve->failed);
        pl_sweep_legend(&axes, line++, colour_of(analysis, e), analysis->engines[e].name, note,
                        out);
    }
    pl_text_add(out, "</svg><figcaption>Towards the lower left is better. A line is an engine's "
                     "front; crosses along the upper edge are points that failed. An error below "
                     "1e-9 stands at 1e-9.</figcaption>"
                     "</figure>\n");
}

/* --- Performance profiles --- */

void pl_sweep_plot_profile(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile,
                           pl_text_buffer *out)
{
    const pl_sweep_axes axes = {
        .left = 72, .right = 710, .top = 16, .bottom = 266, .x_low = 1, .x_high = 100, .y_high = 1};
    int solved = 0, line = 0;
    char title[PL_SWEEP_TEXT_SIZE], error[PL_SWEEP_TEXT_SIZE];
    for (int e = 0; e < analysis->engine_count; e++)
        solved += profile->counts[e];
    if (solved == 0)
        return;
    pl_sweep_power_text(pl_sweep_levels[profile->level], error);
    snprintf(title, sizeof title, "Performance profile at an error of %.20s", error);
    pl_text_add(out, "<figure>");
    pl_sweep_axes_open(&axes, title, "factor within which of the fastest engine's cost",
                       "problems solved", out);
    for (int e = analysis->engine_count - 1; e >= 0; e--) {
        const double *ratios = profile->ratios + (size_t)e * (size_t)analysis->scene_count;
        if (analysis->engines[e].whole != profile->whole)
            continue;
        double share = pl_sweep_share(analysis, profile, e, 1);
        pl_text_format(out, "<path class=\"e%d\" d=\"M%.1f %.1f", colour_of(analysis, e), axes.left,
                       pl_sweep_y(&axes, share));
        for (int i = 0; i < profile->counts[e] && ratios[i] <= axes.x_high; i++) {
            if (ratios[i] <= 1)
                continue;
            share = (double)(i + 1) / profile->scenes;
            pl_text_format(out, "H%.1fV%.1f", pl_sweep_x(&axes, ratios[i]),
                           pl_sweep_y(&axes, share));
        }
        pl_text_format(out, "H%.1f\"/>\n", axes.right);
    }
    for (int e = 0; e < analysis->engine_count; e++) {
        char note[PL_SWEEP_TEXT_SIZE];
        if (analysis->engines[e].whole != profile->whole)
            continue;
        snprintf(note, sizeof note, "solves %d of %d", profile->counts[e], profile->scenes);
        pl_sweep_legend(&axes, line++, colour_of(analysis, e), analysis->engines[e].name, note,
                        out);
    }
    pl_text_add(out, "</svg></figure>\n");
}
