#include "sweep_axes.h"

#include "sweep_words.h"

#include <math.h>
#include <stdio.h>

static const double width = 900, bottom_margin = 48;

double pl_sweep_x(const pl_sweep_axes *axes, double value)
{
    double share = log10(value / axes->x_low) / log10(axes->x_high / axes->x_low);
    return axes->left + share * (axes->right - axes->left);
}

double pl_sweep_y(const pl_sweep_axes *axes, double value)
{
    double share = axes->log_y ? log10(value / axes->y_low) / log10(axes->y_high / axes->y_low)
                               : (value - axes->y_low) / (axes->y_high - axes->y_low);
    return axes->bottom - share * (axes->bottom - axes->top);
}

static void add_line(double x0, double y0, double x1, double y1, pl_text_buffer *out)
{
    pl_text_format(out, "<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>", x0, y0, x1, y1);
}

static void add_text(double x, double y, const char *anchor, const char *text, pl_text_buffer *out)
{
    pl_text_format(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    pl_text_add_html(out, text);
    pl_text_add(out, "</text>");
}

static void add_decades_of_x(const pl_sweep_axes *axes, pl_text_buffer *out)
{
    int first = (int)lround(log10(axes->x_low)), last = (int)lround(log10(axes->x_high));
    int every = (last - first) / 12 + 1;
    for (int i = first; i <= last; i++) {
        char text[PL_SWEEP_TEXT_SIZE];
        double x = pl_sweep_x(axes, pow(10, i));
        add_line(x, axes->top, x, axes->bottom, out);
        if (i >= 0 && i < 4)
            snprintf(text, sizeof text, "%.0f", pow(10, i));
        else
            pl_sweep_power_text(pow(10, i), text);
        if ((i - first) % every == 0)
            add_text(x, axes->bottom + 17, "middle", text, out);
    }
}

static void add_steps_of_y(const pl_sweep_axes *axes, pl_text_buffer *out)
{
    int first = axes->log_y ? (int)lround(log10(axes->y_low)) : 0;
    int last = axes->log_y ? (int)lround(log10(axes->y_high)) : 4;
    int every = (last - first) / 15 + 1;
    for (int i = first; i <= last; i++) {
        char text[PL_SWEEP_TEXT_SIZE];
        double value = axes->log_y ? pow(10, i) : 0.25 * i, y = pl_sweep_y(axes, value);
        add_line(axes->left, y, axes->right, y, out);
        if (axes->log_y)
            pl_sweep_power_text(value, text);
        else
            snprintf(text, sizeof text, "%.0f %%", 100 * value);
        if ((i - first) % every == 0)
            add_text(axes->left - 6, y + 4, "end", text, out);
    }
}

void pl_sweep_axes_open(const pl_sweep_axes *axes, const char *title, const char *x_name,
                        const char *y_name, pl_text_buffer *out)
{
    double height = axes->bottom + bottom_margin, middle = 0.5 * (axes->top + axes->bottom);
    pl_text_format(out,
                   "<svg class=\"plot\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" "
                   "role=\"img\">",
                   width, height, width, height);
    pl_text_add_element(out, "<title>", title, "</title>");
    add_decades_of_x(axes, out);
    add_steps_of_y(axes, out);
    add_text(0.5 * (axes->left + axes->right), height - 10, "middle", x_name, out);
    pl_text_format(out, "<g transform=\"translate(16 %.1f) rotate(-90)\">", middle);
    add_text(0, 0, "middle", y_name, out);
    pl_text_add(out, "</g>\n");
}

void pl_sweep_marker(const char *classes, int colour, double x, double y, double r,
                     pl_text_buffer *out)
{
    if (colour == 0) {
        pl_text_format(out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\">", classes, x,
                       y, r);
        pl_text_add(out, "</circle>");
        return;
    }
    pl_text_format(out, "<path class=\"%s\" d=\"M", classes);
    static const double shapes[PL_SWEEP_COLOURS][4][2] = {
        {{0}},
        {{-0.85, -0.85}, {0.85, -0.85}, {0.85, 0.85}, {-0.85, 0.85}},
        {{0, -1.1}, {1, 0.8}, {-1, 0.8}, {-1, 0.8}},
        {{0, -1.2}, {1.2, 0}, {0, 1.2}, {-1.2, 0}},
        {{0, 1.1}, {1, -0.8}, {-1, -0.8}, {-1, -0.8}},
        {{-0.5, -1.1}, {0.5, -1.1}, {0.5, 1.1}, {-0.5, 1.1}}};
    for (int i = 0; i < 4; i++)
        pl_text_format(out, "%s%.1f %.1f", i == 0 ? "" : "L", x + r * shapes[colour][i][0],
                       y + r * shapes[colour][i][1]);
    pl_text_add(out, "z\"></path>");
}

void pl_sweep_legend(const pl_sweep_axes *axes, int line, int colour, const char *name,
                     const char *note, pl_text_buffer *out)
{
    char classes[16];
    double x = axes->right + 24, y = axes->top + 14 + 36 * line;
    snprintf(classes, sizeof classes, "m%d", colour);
    pl_sweep_marker(classes, colour, x, y - 4, 5, out);
    pl_text_format(out, "<text class=\"name\" x=\"%.1f\" y=\"%.1f\">", x + 12, y);
    pl_text_add_html(out, name);
    pl_text_format(out, "</text><text x=\"%.1f\" y=\"%.1f\">", x + 12, y + 15);
    pl_text_add_html(out, note);
    pl_text_add(out, "</text>\n");
}
