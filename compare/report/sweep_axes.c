#include "report/sweep_axes.h"

#include "report/sweep_words.h"

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

static void add_line(double x0, double y0, double x1, double y1, pl_sheet *sheet)
{
    pl_sheet_format(sheet, "<path class=\"grid\" d=\"M%.1f %.1fL%.1f %.1f\"/>", x0, y0, x1, y1);
}

static void add_text(double x, double y, const char *anchor, const char *text, pl_sheet *sheet)
{
    pl_sheet_format(sheet, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    pl_sheet_add_html(sheet, text);
    pl_sheet_add(sheet, "</text>");
}

static void add_decades_of_x(const pl_sweep_axes *axes, pl_sheet *sheet)
{
    int first = (int)lround(log10(axes->x_low)), last = (int)lround(log10(axes->x_high));
    int every = (last - first) / 12 + 1;
    for (int i = first; i <= last; i++) {
        char text[PL_SWEEP_TEXT_SIZE];
        double x = pl_sweep_x(axes, pow(10, i));
        add_line(x, axes->top, x, axes->bottom, sheet);
        if (i >= 0 && i < 4)
            snprintf(text, sizeof text, "%.0f", pow(10, i));
        else
            pl_sweep_power_text(pow(10, i), text);
        if ((i - first) % every == 0)
            add_text(x, axes->bottom + 17, "middle", text, sheet);
    }
}

static void add_steps_of_y(const pl_sweep_axes *axes, pl_sheet *sheet)
{
    int first = axes->log_y ? (int)lround(log10(axes->y_low)) : 0;
    int last = axes->log_y ? (int)lround(log10(axes->y_high)) : 4;
    int every = (last - first) / 15 + 1;
    for (int i = first; i <= last; i++) {
        char text[PL_SWEEP_TEXT_SIZE];
        double value = axes->log_y ? pow(10, i) : 0.25 * i, y = pl_sweep_y(axes, value);
        add_line(axes->left, y, axes->right, y, sheet);
        if (axes->log_y)
            pl_sweep_power_text(value, text);
        else
            snprintf(text, sizeof text, "%.0f %%", 100 * value);
        if ((i - first) % every == 0)
            add_text(axes->left - 6, y + 4, "end", text, sheet);
    }
}

void pl_sweep_axes_open(const pl_sweep_axes *axes, const char *title, const char *x_name,
                        const char *y_name, pl_sheet *sheet)
{
    double height = axes->bottom + bottom_margin, middle = 0.5 * (axes->top + axes->bottom);
    pl_sheet_format(sheet,
                    "<svg class=\"plot\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" height=\"%.0f\" "
                    "role=\"img\">",
                    width, height, width, height);
    pl_sheet_add_element(sheet, "<title>", title, "</title>");
    add_decades_of_x(axes, sheet);
    add_steps_of_y(axes, sheet);
    add_text(0.5 * (axes->left + axes->right), height - 10, "middle", x_name, sheet);
    pl_sheet_format(sheet, "<g transform=\"translate(16 %.1f) rotate(-90)\">", middle);
    add_text(0, 0, "middle", y_name, sheet);
    pl_sheet_add(sheet, "</g>\n");
}

void pl_sweep_marker(const char *classes, int colour, double x, double y, double r, pl_sheet *sheet)
{
    if (colour == 0) {
        pl_sheet_format(sheet, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\">", classes,
                        x, y, r);
        pl_sheet_add(sheet, "</circle>");
        return;
    }
    pl_sheet_format(sheet, "<path class=\"%s\" d=\"M", classes);
    static const double shapes[PL_SWEEP_COLOURS][4][2] = {
        {{0}},
        {{-0.85, -0.85}, {0.85, -0.85}, {0.85, 0.85}, {-0.85, 0.85}},
        {{0, -1.1}, {1, 0.8}, {-1, 0.8}, {-1, 0.8}},
        {{0, -1.2}, {1.2, 0}, {0, 1.2}, {-1.2, 0}},
        {{0, 1.1}, {1, -0.8}, {-1, -0.8}, {-1, -0.8}},
        {{-0.5, -1.1}, {0.5, -1.1}, {0.5, 1.1}, {-0.5, 1.1}}};
    for (int i = 0; i < 4; i++)
        pl_sheet_format(sheet, "%s%.1f %.1f", i == 0 ? "" : "L", x + r * shapes[colour][i][0],
                        y + r * shapes[colour][i][1]);
    pl_sheet_add(sheet, "z\"></path>");
}

void pl_sweep_legend(const pl_sweep_axes *axes, int line, int colour, const char *name,
                     const char *note, pl_sheet *sheet)
{
    char classes[16];
    double x = axes->right + 24, y = axes->top + 14 + 36 * line;
    snprintf(classes, sizeof classes, "m%d", colour);
    pl_sweep_marker(classes, colour, x, y - 4, 5, sheet);
    pl_sheet_format(sheet, "<text class=\"name\" x=\"%.1f\" y=\"%.1f\">", x + 12, y);
    pl_sheet_add_html(sheet, name);
    pl_sheet_format(sheet, "</text><text x=\"%.1f\" y=\"%.1f\">", x + 12, y + 15);
    pl_sheet_add_html(sheet, note);
    pl_sheet_add(sheet, "</text>\n");
}
