/* The document of plumb.sweep/2. The rows of a table are elements of an array of the JSON. Its columns are one text,
 * "HEADING=PATH FORMAT|HEADING=PATH FORMAT ...": `formats` has the formats, value_at says what a path is. */
#include "analysis.h"

#include "base/heap.h"
#include "base/number_format.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The rows that text shows of a table that may be long. A page has all. */
enum { TEXT_ROWS = 20 };

static const char losses[] =
    "Scene=scene.name|>Error=level level|Home=first.name|>its cost=first_point.cost cost|"
    "Ahead=second.name|>its cost=second_point.cost cost|>Speed=speed ratio|Within "
    "noise=within_noise";
static const char means[] =
    "First=first.name|Second=second.name|>Error=level level|"
    ">Mean speed as shipped=as_shipped.mean_speed ratio|"
    ">Mean speed, each at its best=mean_speed ratio|>Scenes both reach=both integer|"
    ">First alone=first_only integer|>Second alone=second_only integer|>Neither=neither integer";
static const char factors[] =
    "Scene=name|>Error=level level|First=first.name|Second=second.name|"
    ">Speed as shipped=as_shipped.speed ratio|>Speed, each at its best=speed ratio|"
    "Reached by=reached|First at its best=first_point.label|>dt=first_point.dt step|"
    "Second at its best=second_point.label|>dt=second_point.dt step";
static const char costs[] =
    "Engine=engine.name|>1e-1=cheapest_at_level.0.cost cost|>1e-2=cheapest_at_level.1.cost cost|"
    ">1e-3=cheapest_at_level.2.cost cost|>1e-4=cheapest_at_level.3.cost cost|"
    ">1e-5=cheapest_at_level.4.cost cost|>1e-6=cheapest_at_level.5.cost cost|"
    ">1e-7=cheapest_at_level.6.cost cost|>1e-8=cheapest_at_level.7.cost cost|"
    ">least error=front.-1.error error|>settings=settings integer|>failed=failed integer|"
    ">not measured=unmeasured integer";
static const char shares[] =
    "Engine=engine.name|>the fastest=shares.0 percent|>within 1.5 of it=shares.1 percent|"
    ">2=shares.2 percent|>3=shares.3 percent|>5=shares.4 percent|>10=shares.5 percent|"
    ">100=shares.6 percent|>at any cost=shares.7 percent";
static const char orders[] =
    "Scene=scene.name|Engine=point.label|Finding=finding|>Order=order number|>From=dt_high step|"
    ">To=dt_low step|>Used=used integer|>Run=total integer|>Off fit=deviation number";
static const char points[] =
    "Scene=scene.name|Engine=label|>Time step=dt step|State=state|Outcome=outcome|Change=change|"
    "Reason=reason|>Cost=cost cost|>Error=error number";

static double number_of(const json_t *value)
{
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static bool is_true(const json_t *object, const char *key)
{
    return json_is_true(json_object_get(object, key));
}

/* ---- Values ---- */

/* What an index under that key names; NULL: it is null. */
static const json_t *element(const json_t *sweep, const char *key, const json_t *index)
{
    static const char *const of_engines[] = {"engine", "first", "second"};
    const char *array = strcmp(key, "scene") == 0 ? "scenes" : "points";
    for (int i = 0; i < 3; ++i) {
        array = strcmp(key, of_engines[i]) == 0 ? "engines" : array;
    }
    return json_is_integer(index)
               ? json_array_get(json_object_get(sweep, array), (size_t)json_integer_value(index))
               : NULL;
}

/* The value at a path: keys separated by dots. A key after an index is one of what that names, and a number after an
 * array is a place, from the end if it is negative. */
static const json_t *value_at(const json_t *sweep, const json_t *row, const char *path)
{
    char *keys = pl_heap_copy(path), *rest = keys;
    const char *key = strsep(&rest, "."), *next;
    const json_t *value = json_object_get(row, key);
    while ((next = strsep(&rest, ".")) != NULL) {
        if (json_is_array(value)) {
            const long place = strtol(next, NULL, 10);
            value = json_array_get(value, place < 0 ? json_array_size(value) + (size_t)place
                                                    : (size_t)place);
        } else {
            value =
                json_object_get(json_is_object(value) ? value : element(sweep, key, value), next);
            key = next;
        }
    }
    free(keys);
    return value;
}

/* ---- Tables ---- */

/* "×2.50 (2.31 to 2.74)" */
static void add_ratio(pl_table *table, const json_t *ratio)
{
    const double low = number_of(json_object_get(ratio, "low"));
    char value[PL_QUANTITY_SIZE], from[PL_QUANTITY_SIZE], to[PL_QUANTITY_SIZE];
    pl_format_ratio(number_of(json_object_get(ratio, "value")), value);
    pl_format_number(low, "1", from);
    pl_format_number(number_of(json_object_get(ratio, "high")), "1", to);
    if (isnan(low)) {
        pl_table_add(table, value);
    } else {
        pl_table_format_cell(table, "%s (%s to %s)", value, from, to);
    }
}

/* A cost that is null was reached by none of the settings; the row has their number. */
static void add_cell(pl_table *table, const json_t *row, const json_t *value, const char *format)
{
    const double number = number_of(value), tried = number_of(json_object_get(row, "settings"));
    char text[PL_QUANTITY_SIZE] = "";
    switch (format[0]) {
    case 'r': /* ratio */
        add_ratio(table, value);
        return;
    case 't': /* text */
        pl_table_add(table, json_is_string(value) ? json_string_value(value)
                            : json_is_true(value) ? "yes"
                                                  : "");
        return;
    case 's': /* step, s */
        if (json_is_number(value)) {
            pl_format_step(number, text);
        }
        break;
    case 'l': /* level, a power of ten */
        pl_format_power(number, text);
        break;
    case 'i': /* integer */
        snprintf(text, sizeof text, "%.0f", number);
        break;
    case 'p': /* percent */
        snprintf(text, sizeof text, "%.0f %%", 100 * number);
        break;
    default: /* number, or cost, s */
        pl_format_number(number, format[0] == 'c' ? "s" : "1", text);
        if (format[0] == 'c' && isnan(number) && isfinite(tried)) {
            snprintf(text, sizeof text, "not with %.0f setting%s", tried, tried == 1 ? "" : "s");
        }
    }
    pl_table_add(table, text);
}

typedef struct column {
    char heading[64], path[64], format[16];
} column;

/* Reads the first column, and returns what follows; NULL: there is none. */
static const char *read_column(const char *columns, column *read)
{
    int length = 0;
    *read = (column){.format = "text"};
    return sscanf(columns, "%63[^=]=%63[^ |]%n %15[a-z]%n", read->heading, read->path, &length,
                  read->format, &length) < 2
               ? NULL
               : columns + length + (columns[length] == '|');
}

static pl_table begin_table(const char *columns)
{
    pl_table table = {0};
    column c;
    while ((columns = read_column(columns, &c)) != NULL) {
        const bool right = c.heading[0] == '>';
        pl_table_column(&table, right ? PL_RIGHT : PL_LEFT, "%s", c.heading + right);
    }
    return table;
}

static void add_row(pl_table *table, const char *columns, const json_t *sweep, const json_t *row)
{
    column c;
    while ((columns = read_column(columns, &c)) != NULL) {
        add_cell(table, row, value_at(sweep, row, c.path), c.format);
    }
}

/* Whether a row comes first, 0, later, 1, or not at all. */
typedef int ranking(const json_t *sweep, const json_t *row);

/* The rows of an array by rank; NULL: all come first. Text shows the first, at most TEXT_ROWS and at least one. */
static pl_table table_of(const json_t *sweep, const json_t *array, const char *columns,
                         ranking *rank)
{
    pl_table table = begin_table(columns);
    size_t index;
    const json_t *row;
    for (int i = 0; i < 2; ++i) {
        json_array_foreach(array, index, row)
        {
            if ((rank == NULL ? 0 : rank(sweep, row)) == i) {
                add_row(&table, columns, sweep, row);
            }
        }
        const int rows = pl_table_rows(&table);
        table.last = i == 1 ? table.last : rows == 0 ? 1 : rows < TEXT_ROWS ? rows : TEXT_ROWS;
    }
    return table;
}

/* Curves: whole engines, then profiles. */
static int rank_curve(const json_t *sweep, const json_t *row)
{
    return json_is_true(value_at(sweep, row, "engine.as_shipped"))     ? 2
           : json_is_true(value_at(sweep, row, "engine.all_profiles")) ? 0
                                                                       : 1;
}

/* Points: those without numbers come first. */
static int rank_point(const json_t *sweep, const json_t *row)
{
    (void)sweep;
    return strcmp(pl_json_get_text(row, "state"), "ok") == 0;
}

/* Adds the pairs of `whole`, of a scene or of all, at a level: those that one of the two reached. */
static void add_pairs(pl_table *table, const char *columns, const json_t *sweep,
                      const json_t *whole, size_t level)
{
    size_t index;
    const json_t *pair;
    json_array_foreach(json_object_get(whole, "pairs"), index, pair)
    {
        json_t *row = json_copy(json_array_get(json_object_get(pair, "levels"), level));
        json_object_update_missing(row, (json_t *)pair);
        json_object_set(row, "name", json_object_get(whole, "name"));
        if (is_true(pair, "shown") &&
            !json_equal(json_object_get(row, "neither"), json_object_get(row, "scenes")) &&
            strcmp(pl_json_get_text(row, "reached"), "neither") != 0) {
            add_row(table, columns, sweep, row);
        }
        json_decref(row);
    }
}

/* A table of pairs, first at 1e-3. Text shows all pairs at that error. */
static pl_table pairs_table(const json_t *sweep, const json_t *wholes, const char *columns)
{
    pl_table table = begin_table(columns);
    size_t index;
    const json_t *whole;
    for (size_t i = 0; i < 1 + PL_SWEEP_LEVELS; ++i) {
        json_array_foreach(wholes, index, whole)
        {
            if (i == 0 || i - 1 != PL_SWEEP_MATCHED_LEVEL) {
                add_pairs(&table, columns, sweep, whole, i == 0 ? PL_SWEEP_MATCHED_LEVEL : i - 1);
            }
        }
        table.last = i == 0 ? pl_table_rows(&table) : table.last;
    }
    return table;
}

/* ---- Performance profiles ---- */

/* Adds an engine to a plot, with numbers that the plot takes. */
static void add_line(json_t *plot, const json_t *sweep, const json_t *row, json_t *numbers)
{
    if (json_array_size(numbers) > 0) {
        json_array_append_new(json_object_get(plot, "rows"),
                              json_pack("{s:O, s:O}", "name", value_at(sweep, row, "engine.name"),
                                        "numbers", numbers));
    }
    json_decref(numbers);
}

static void add_shares_plot(const json_t *sweep, const json_t *profile, pl_document *document)
{
    const double level = number_of(json_object_get(profile, "level")),
                 scenes = number_of(json_object_get(profile, "scenes"));
    char *caption = pl_heap_format("Scenes solved to %g, of %.0f", level, scenes);
    json_t *plot =
        pl_plot_make(PL_PLOT_COUNTS, caption, "factor of the cost of the fastest", "scenes solved");
    size_t index;
    const json_t *engine;
    json_array_foreach(json_object_get(profile, "engines"), index, engine)
    {
        add_line(plot, sweep, engine, json_copy(json_object_get(engine, "ratios")));
    }
    pl_document_plot(document, plot);
    free(caption);
}

/* ---- The document ---- */

/* Error over cost of the points of a scene, by engine. */
static void add_fronts(const json_t *sweep, const json_t *scene, size_t number,
                       pl_document *document)
{
    const char *error = pl_json_get_text(scene, "primary_error");
    char *caption = pl_heap_format("%s: %s over CPU time for a simulated second",
                                   pl_json_get_text(scene, "name"), error);
    char *axis = pl_heap_format("%s (%s)", error, pl_json_get_text(scene, "unit"));
    json_t *plot =
        pl_plot_make(PL_PLOT_FRONTS, caption, "CPU time for a simulated second (s)", axis);
    size_t index, i;
    const json_t *curve, *point;
    json_array_foreach(json_object_get(scene, "curves"), index, curve)
    {
        json_t *numbers = json_array();
        json_array_foreach(json_object_get(sweep, "points"), i, point)
        {
            if (json_integer_value(json_object_get(point, "scene")) == (json_int_t)number &&
                json_equal(json_object_get(point, "engine"), json_object_get(curve, "engine"))) {
                json_array_append(numbers, json_object_get(point, "cost"));
                json_array_append(numbers, json_object_get(point, "error"));
            }
        }
        add_line(plot, sweep, curve, numbers);
    }
    pl_document_plot(document, plot);
    free(axis);
    free(caption);
}

/* A section of one table, where that has rows. */
static void add_section(pl_document *document, const char *heading, pl_table table)
{
    if (pl_table_rows(&table) > 0) {
        pl_document_heading(document, "%s", heading);
    }
    pl_document_table(document, heading, &table);
}

static void add_scene(const json_t *sweep, const json_t *scene, size_t number,
                      pl_document *document)
{
    const char *unit = pl_json_get_text(scene, "unit"),
               *error = pl_json_get_text(scene, "primary_error");
    if (error[0] != '\0') {
        pl_table table = table_of(sweep, json_object_get(scene, "curves"), costs, rank_curve);
        pl_document_heading(document, "%s: least CPU time for a simulated second, by %s%s%s",
                            pl_json_get_text(scene, "name"), error, unit[0] == '\0' ? "" : ", ",
                            unit);
        add_fronts(sweep, scene, number, document);
        pl_document_table(document, "Cost at error", &table);
    }
}

static void add_method(const json_t *sweep, pl_document *document)
{
    char floor[PL_QUANTITY_SIZE];
    pl_format_power(number_of(json_object_get(sweep, "error_floor")), floor);
    pl_document_heading(document, "How speed and error are weighed");
    pl_document_paragraph(
        document,
        "A point is an engine with its options at a time step on a scene. Its cost is the CPU time "
        "of the engine's steps alone for a second of simulated time, the median over its repeats; "
        "its error is the scenario's primary error, and an error below %s counts as that. A point "
        "of which any repeat or change was not ok has failed and has no numbers. A mean speed is "
        "the geometric mean over the scenes that both reach. Ranges hold 95 %% of %.0f bootstrap "
        "replicates, in which the repeats of each point are drawn with replacement.",
        floor, number_of(json_object_get(sweep, "draws")));
}

static void fill_document(const json_t *sweep, pl_document *document)
{
    static const char *const said[] = {"statement", "unverified", "warning"};
    const json_t *profiles = json_object_get(sweep, "profiles"), *item;
    json_t *all = json_pack("[O]", sweep);
    size_t index;
    document->title = "Speed against error";
    for (int i = 0; i < 3; ++i) {
        if (pl_json_get_text(sweep, said[i])[0] != '\0') {
            pl_document_paragraph(document, "%s", pl_json_get_text(sweep, said[i]));
        }
    }
    char *heading = pl_heap_format("Where %s loses", pl_json_get_text(sweep, "home"));
    add_section(document, heading, table_of(sweep, json_object_get(sweep, "losses"), losses, NULL));
    add_section(document, "Speed of the first over the second at the same error, over all scenes",
                pairs_table(sweep, all, means));
    add_section(document, "Speed of the first over the second at the same error, scene by scene",
                pairs_table(sweep, json_object_get(sweep, "scenes"), factors));
    json_array_foreach(json_object_get(sweep, "scenes"), index, item)
    {
        add_scene(sweep, item, index, document);
    }
    item = json_array_get(profiles, PL_SWEEP_MATCHED_LEVEL);
    if (number_of(json_object_get(item, "scenes")) > 0) {
        add_section(document, "Scenes solved to 1e-3, within a factor of the fastest",
                    table_of(sweep, json_object_get(item, "engines"), shares, NULL));
    }
    json_array_foreach(profiles, index, item)
    {
        if (is_true(item, "all_profiles")) {
            add_shares_plot(sweep, item, document);
        }
    }
    add_section(document, "Order of convergence",
                table_of(sweep, json_object_get(sweep, "orders"), orders, NULL));
    add_section(document, "Points, those without numbers first",
                table_of(sweep, json_object_get(sweep, "points"), points, rank_point));
    add_method(sweep, document);
    json_decref(all);
    free(heading);
}

const pl_study pl_sweep_study = {.name = "sweep", .kind = "sweep", .document = fill_document};
