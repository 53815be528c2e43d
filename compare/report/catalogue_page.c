#include "report.h"

#include "page.h"
#include "picture.h"
#include "plumb/scenario.h"
#include "referee/metrics/metrics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PARAMS = PL_MAX_PARAMS };

/* Adds a name and its text; nothing where the text is NULL. */
static void add_fact(pl_text_buffer *out, const char *name, const char *text)
{
    if (text != NULL) {
        pl_text_add_element(out, "<dt>", name, "</dt>");
        pl_text_add_element(out, "<dd>", text, "</dd>\n");
    }
}

static void add_index(pl_text_buffer *out, const pl_scenario *const *scenarios, int count)
{
    for (int i = 0; i < count; ++i) {
        pl_text_add_element(out, i == 0 ? "<a href=\"#" : " · <a href=\"#", scenarios[i]->name,
                            "\">");
        pl_text_add_element(out, "", scenarios[i]->name, "</a>");
    }
    pl_text_add(out, "</p>\n");
}

/* Adds the picture of the scene with default parameters, at the start. */
static pl_status add_picture(pl_text_buffer *out, const pl_scenario *s, int index, pl_error *error)
{
    double values[MOST_PARAMS];
    pl_scene scene = pl_scene_default();
    pl_status status = pl_scenario_values(s, NULL, 0, values, error);
    if (status == PL_OK) {
        status = pl_scenario_build(s, values, 0, &scene, error);
    }
    pl_pose *poses = status == PL_OK ? calloc((size_t)scene.body_count + 1, sizeof *poses) : NULL;
    if (status == PL_OK && poses == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "no memory for a picture of %s", s->name);
    }
    if (status == PL_OK && poses != NULL) {
        for (int i = 0; i < scene.body_count; ++i) {
            poses[i] = pl_pose_of(&scene.bodies[i]);
        }
        pl_view view = pl_view_choose(&scene, NULL, 0);
        char id[32], title[160];
        snprintf(id, sizeof id, "expected-%d", index);
        snprintf(title, sizeof title, "%.100s at the start", s->name);
        pl_svg_expected(&scene, &view, id, out);
        pl_text_add(out, "<div class=\"pictures\"><figure>");
        pl_svg_picture(&scene, &view, poses, id, title, out);
        pl_text_format(
            out, "<figcaption>%d %s, %g s in steps of %g s</figcaption></figure></div>\n",
            scene.body_count, scene.body_count == 1 ? "body" : "bodies", scene.duration, scene.dt);
    }
    free(poses);
    pl_scene_free(&scene);
    return status;
}

static void add_needs(pl_text_buffer *out, uint32_t needs)
{
    pl_text_add(out, "<dt>Needs</dt><dd>");
    const char *between = "";
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((needs & bit) != 0) {
            pl_text_add_element(out, between, pl_needs_name(bit), "");
            between = ", ";
        }
    }
    pl_text_add(out, "</dd>\n");
}

static void add_suites(pl_text_buffer *out, const char *name)
{
    int count;
    const pl_suite *suites = pl_suites(&count);
    const char *between = "<dt>Suites</dt><dd>";
    for (int i = 0; i < count; ++i) {
        bool within = false;
        for (int k = 0; k < suites[i].entry_count; ++k) {
            within = within || strcmp(suites[i].entries[k].scenario, name) == 0;
        }
        if (within) {
            pl_text_add_element(out, between, suites[i].name, "");
            between = ", ";
        }
    }
    pl_text_add(out, between[0] == ',' ? "</dd>\n" : "");
}

/* The metric that judges a run, and the largest value of an accurate one. */
static void add_primary(pl_text_buffer *out, const pl_scenario *s)
{
    int id = pl_metric_by_name(s->primary_error);
    if (id >= 0) {
        const pl_metric_info *info = &pl_metric_table[id];
        pl_text_add_element(out, "<dt>Judged by</dt><dd><code>", info->name, "</code>");
        if (strcmp(info->unit, "1") != 0) {
            pl_text_add_element(out, ", ", info->unit, "");
        }
        pl_text_add_element(out, ": ", info->definition, "</dd>\n");
        pl_text_format(out, "<dt>Accurate</dt><dd>up to %g", s->acceptance);
        pl_text_add_element(out, strcmp(info->unit, "1") != 0 ? " " : "",
                            strcmp(info->unit, "1") != 0 ? info->unit : "", "");
        pl_text_add_element(out, ": ", s->acceptance_reason, "</dd>\n");
    }
}

static void add_threshold(pl_text_buffer *out, const pl_threshold *t)
{
    if (t == NULL) {
        return;
    }
    pl_text_add_element(out, "<dt>Threshold</dt><dd>holds ", t->holds_below ? "below" : "above",
                        " a critical ");
    pl_text_add_element(out, "<code>", t->param, "</code>: ");
    pl_text_add_html(out, t->formula != NULL ? t->formula : "no closed form");
    pl_text_add(out, "</dd>\n");
}

static void add_params(pl_text_buffer *out, const pl_scenario *s)
{
    const pl_page page = {.out = out, .html = true};
    pl_table table = {0};
    pl_table_columns(&table, "Parameter|>Default|Range|Unit|Meaning");
    for (int i = 0; i < s->param_count; ++i) {
        const pl_param *p = &s->params[i];
        pl_table_add(&table, p->name);
        pl_table_format_cell(&table, "%g", p->value);
        pl_table_format_cell(&table, "%g to %g%s", p->min, p->max, p->integer ? ", whole" : "");
        pl_table_add(&table, p->unit);
        pl_table_add(&table, p->help);
    }
    pl_page_table(&page, table, 0);
}

static pl_status add_scenario(pl_text_buffer *out, const pl_scenario *s, int index, pl_error *error)
{
    pl_text_add_element(out, "<h2 id=\"", s->name, "\">");
    pl_text_add_element(out, "", s->name, "");
    pl_text_add_element(out, " <span class=\"small\">", s->title, "</span></h2>\n");
    pl_status status = add_picture(out, s, index, error);
    pl_text_add_element(out, "<p>", s->description, "</p>\n<dl class=\"facts\">\n");
    add_fact(out, "Right answer", s->reference);
    add_fact(out, "Source", s->source);
    add_fact(out, "Expected", s->expected);
    add_fact(out, "Valid", s->validity);
    add_fact(out, "Provokes", s->provokes);
    add_threshold(out, s->threshold);
    add_primary(out, s);
    add_needs(out, pl_scenario_needs(s));
    add_suites(out, s->name);
    pl_text_add(out, "</dl>\n");
    add_params(out, s);
    return status;
}

pl_status pl_catalogue_page(pl_text_buffer *out, pl_error *error)
{
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    pl_page_open(out, "Plumb: the catalogue", NULL);
    pl_text_format(
        out,
        "<h1>The catalogue</h1>\n<p class=\"lead\">%d scenarios: what is built, what the "
        "right answer is, and where that is from.</p>\n<p>",
        count);
    add_index(out, scenarios, count);
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = add_scenario(out, scenarios[i], i, error);
    }
    pl_page_close(out);
    return status == PL_OK && out->failed
               ? pl_fail(error, PL_NO_MEMORY, "no memory for the catalogue's page")
               : status;
}
