/* statistics_error: how far a run ended outside of what converged engines agree on.
 *
 * chaotic_error: the largest violation of what all right motions have in common, each part relative
 * to what can be seen:
 *
 *   penetration_p99    the overlap that 99 % of the touching pairs do not exceed, over L
 *   penetration_max    the deepest overlap, over 10 L: it may be seen for one frame only
 *   free_flight_error  of a body that meets no other
 *   energy_gain        over the energy of the scene
 *   momentum_error     over the momentum of the scene
 *   statistics_error   where the end statistics are known
 *
 * L is the least dimension of the smallest dynamic body: an overlap of L / 2 is a body half inside
 * another, and at L it has passed through. A bounding radius would hide that of thin bodies.
 *
 * The error is never below 1e-3. An overlap of a thousandth of a body is not visible, and below it
 * the error would measure constants that an engine's author chose, such as its slop.
 *
 * The residual of the contact law, natural_map, is no part: it needs impulses, so that engines
 * which report none would be spared. */
#include "expectations.h"

#include "plumb/jitter.h"
#include "plumb/vec.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The distance of a number from an interval. */
static double outside(double found, double low, double high)
{
    return fmax(fmax(low - found, found - high), 0);
}

/* ---- Chaotic motion ---- */

static const double RESOLUTION = 1e-3;
static const double WORST_FRAME = 10; /* how much deeper a single overlap may be */

static const pl_metric_id statistics[PL_STATISTIC_COUNT] = {
    [PL_STATISTIC_MASS_HEIGHT] = PL_METRIC_MASS_HEIGHT,
    [PL_STATISTIC_RUN_OUT_P95] = PL_METRIC_RUN_OUT_P95,
    [PL_STATISTIC_SPREAD_X] = PL_METRIC_SPREAD_X,
    [PL_STATISTIC_SPREAD_Y] = PL_METRIC_SPREAD_Y,
    [PL_STATISTIC_ENERGY_LOST] = PL_METRIC_ENERGY_LOST};

/* Raises `largest` to `value`, of the part called `name` (NULL: it has no parts). */
static void raise_to(pl_metric *largest, const char *name, double value)
{
    if (largest->state != PL_METRIC_VALUE || value > largest->value) {
        *largest = pl_metric_value(value);
        largest->part = name;
    }
}

static pl_metric statistics_error(const pl_scene *scene, const pl_metric *item)
{
    pl_metric largest = {.state = PL_METRIC_ABSENT};
    for (int i = 0; i < scene->statistic_count; ++i) {
        const pl_expect_statistic *expected = &scene->statistics[i];
        const pl_metric_id id = statistics[expected->metric];
        if (item[id].state == PL_METRIC_FAILED) {
            return item[id];
        }
        if (item[id].state != PL_METRIC_VALUE) {
            return pl_metric_failed("the run has no %s", pl_metric_table[id].name);
        }
        const double off = outside(item[id].value, expected->low, expected->high);
        raise_to(&largest, pl_metric_table[id].name, off / expected->scale);
    }
    return largest;
}

static pl_metric chaotic_error(double size, const pl_metric *item)
{
    static const pl_metric_id plain[] = {PL_METRIC_FREE_FLIGHT_ERROR, PL_METRIC_ENERGY_GAIN,
                                         PL_METRIC_MOMENTUM_ERROR, PL_METRIC_STATISTICS_ERROR};
    pl_metric largest = pl_metric_failed("no metric that it consists of has a value");
    const pl_metric *penetration = &item[PL_METRIC_PENETRATION_MAX];
    if (penetration->state == PL_METRIC_VALUE) {
        raise_to(&largest, "penetration_p99", penetration->p99 / size);
        raise_to(&largest, "penetration_max", penetration->value / (WORST_FRAME * size));
    }
    for (size_t i = 0; i < sizeof plain / sizeof *plain; ++i) {
        if (item[plain[i]].state == PL_METRIC_VALUE) {
            raise_to(&largest, pl_metric_table[plain[i]].name, item[plain[i]].value);
        }
    }
    if (largest.state == PL_METRIC_VALUE) {
        raise_to(&largest, "resolution", RESOLUTION);
    }
    return largest;
}

void pl_chaotic_metrics(const pl_scene *scene, pl_metric *item)
{
    item[PL_METRIC_STATISTICS_ERROR] = statistics_error(scene, item);
    if (strcmp(scene->primary_error, pl_metric_table[PL_METRIC_CHAOTIC_ERROR].name) == 0) {
        item[PL_METRIC_CHAOTIC_ERROR] = chaotic_error(pl_scene_least_size(scene), item);
    }
}

/* ---- Verdicts ---- */

/* A number that was found, and the interval, with a tolerance on both sides, in which it is right. */
typedef struct judged {
    const char *name; /* of the quantity */
    const char *body; /* NULL: of the whole scene */
    const char *unit; /* with a space before it */
    int number;       /* of an apex, counted from 1; 0: none */
    bool lacks;       /* the run does not show what is expected */
    double found;     /* a distance from what is expected where low and high are 0 */
    double low, high; /* equal, except of a statistic */
    double tolerance; /* not finite: none */
} judged;

static const struct {
    const char *name, *unit;
} quantities[PL_QUANTITY_COUNT] = {[PL_QUANTITY_POSITION] = {"position", " m"},
                                   [PL_QUANTITY_VELOCITY] = {"velocity", " m/s"},
                                   [PL_QUANTITY_SPIN] = {"spin", " rad/s"},
                                   [PL_QUANTITY_TURN] = {"turn", " rad"},
                                   [PL_QUANTITY_APEX] = {"apex", " m"},
                                   [PL_QUANTITY_PERIOD] = {"period", " s"},
                                   [PL_QUANTITY_TOP_SPEED] = {"top speed", " m/s"},
                                   [PL_QUANTITY_EXCURSION] = {"excursion", " m"},
                                   [PL_QUANTITY_ENERGY] = {"energy", " J"}};

/* ---- Texts ---- */

/* Writes the number with so many digits, and returns it as a reader sees it. */
static double print_number(char text[32], int digits, double number)
{
    snprintf(text, 32, "%.*g", digits, number == 0 ? 0 : number);
    return strtod(text, NULL);
}

/* With as many digits, three or more, as a reader needs to see that the number is off. */
static void describe(const judged *j, char *text, size_t size)
{
    char found[32], low[32], high[32], bound[32], number[16] = "", of[PL_NAME_SIZE + 8] = "";
    for (int digits = 3; digits <= 17; ++digits) {
        const double f = print_number(found, digits, j->found);
        const double l = print_number(low, digits, j->low);
        const double h = print_number(high, digits, j->high);
        if (outside(f, l, h) > print_number(bound, digits, j->tolerance) || j->lacks) {
            break;
        }
    }
    if (j->number > 0) {
        snprintf(number, sizeof number, " %d", j->number);
    }
    if (j->body != NULL) {
        snprintf(of, sizeof of, " of \"%s\"", j->body);
    }
    char range[96] = "";
    if (isinf(j->low)) {
        snprintf(range, sizeof range, "at most %s%s ", high, j->unit);
    } else if (isinf(j->high)) {
        snprintf(range, sizeof range, "at least %s%s ", low, j->unit);
    } else if (j->low < j->high) {
        snprintf(range, sizeof range, "%s to %s%s ", low, high, j->unit);
    } else if (j->low != 0) {
        snprintf(range, sizeof range, "%s%s ", low, j->unit);
    }
    /* What is expected to be 0 is a distance. */
    const bool has_sign = found[0] == '-' && range[0] == '\0';
    snprintf(text, size, "%s%s%s: %s%s, expected %swithin %s%s", j->name, number, of,
             j->lacks ? "none" : found + has_sign, j->lacks ? "" : j->unit, range, bound, j->unit);
}

/* ---- Judging ---- */

/* In tolerances: the least by which an apex or a period that a run lacks is off. Any number above 1 does. */
static const double LACKING = 2;

/* Puts a deviation at its place among the worst ones. The room for its text; NULL: it is none of them. */
static char *place_of(pl_deviations *d, double ratio)
{
    int at = d->off < PL_MOST_DEVIATIONS ? d->off : PL_MOST_DEVIATIONS;
    d->off += 1;
    while (at > 0 && ratio > d->ratio[at - 1]) {
        --at;
    }
    if (at == PL_MOST_DEVIATIONS) {
        return NULL;
    }
    for (int i = PL_MOST_DEVIATIONS - 1; i > at; --i) {
        d->ratio[i] = d->ratio[i - 1];
        memcpy(d->text[i], d->text[i - 1], sizeof d->text[i]);
    }
    d->ratio[at] = ratio;
    return d->text[at];
}

static void judge(pl_metrics *to, const judged *j)
{
    if (!isfinite(j->tolerance) || isnan(j->found)) {
        return;
    }
    const double outside_by = outside(j->found, j->low, j->high);
    const double off = j->lacks ? fmax(outside_by, LACKING * j->tolerance) : outside_by;
    const double ratio = off / j->tolerance;
    raise_to(&to->item[PL_METRIC_EXPECTATION_ERROR], NULL, ratio);
    char *text = off > j->tolerance ? place_of(&to->deviations, ratio) : NULL;
    if (text != NULL) {
        describe(j, text, sizeof to->deviations.text[0]);
    }
}

/* The tolerance that is stated, else that many units of the scene's acceptance. */
static double tolerance_of(const pl_scene *scene, double stated, double units)
{
    return stated > 0 ? stated : scene->acceptance * units;
}

static void judge_rests(const pl_scene *scene, const pl_body_state *last, pl_metrics *to)
{
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        const pl_body *body = &scene->bodies[rest->body];
        const pl_body_state *now = &last[rest->body];
        judged j = {.name = "rest", .body = body->name, .unit = " m"};
        j.found = pl_vec_length(pl_vec_sub(pl_vec_of(now->position), pl_vec_of(rest->position)));
        j.tolerance = tolerance_of(scene, rest->tolerance, 1);
        judge(to, &j);
        if (rest->has_orientation && body->shape.kind != PL_SHAPE_SPHERE) {
            j = (judged){.name = "orientation", .body = body->name, .unit = " rad"};
            j.found = pl_angle_between(rest->orientation, now->orientation);
            j.tolerance = tolerance_of(scene, rest->orientation_tolerance, 1);
            judge(to, &j);
        }
    }
}

static void judge_travels(const pl_scene *scene, const pl_body_state *last, pl_metrics *to)
{
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        const judged j = {
            .name = "end of the travel",
            .body = scene->bodies[travel->body].name,
            .unit = " m",
            .found = pl_off_travel(scene, last, travel, travel->distance),
            .tolerance = tolerance_of(scene, travel->tolerance, fabs(travel->distance)),
        };
        judge(to, &j);
    }
}

/* Of several right answers the nearest one counts. */
static void judge_values(const pl_values *values, const pl_scene *scene, pl_metrics *to)
{
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *value = &scene->values[i];
        const judged j = {
            .name = quantities[value->quantity].name,
            .body = scene->bodies[value->body].name,
            .unit = quantities[value->quantity].unit,
            .number = (int)value->number,
            .lacks = value->bound != PL_BOUND_AT_MOST && pl_values_lack(values, i),
            .found = pl_values_found(values, i),
            .low = value->bound == PL_BOUND_AT_MOST ? -HUGE_VAL : value->value,
            .high = value->bound == PL_BOUND_AT_LEAST ? HUGE_VAL : value->value,
            .tolerance = tolerance_of(scene, value->tolerance, value->scale),
        };
        if (value->answer == 0 || (int)value->answer == to->item[PL_METRIC_VALUE_ERROR].answer) {
            judge(to, &j);
        }
    }
}

static void judge_statistics(const pl_scene *scene, pl_metrics *to)
{
    for (int i = 0; i < scene->statistic_count; ++i) {
        const pl_expect_statistic *statistic = &scene->statistics[i];
        const pl_metric_id id = statistics[statistic->metric];
        const judged j = {
            .name = pl_metric_table[id].name,
            .unit = statistic->metric == PL_STATISTIC_ENERGY_LOST ? " J" : " m",
            .found = to->item[id].state == PL_METRIC_VALUE ? to->item[id].value : (double)NAN,
            .low = statistic->low,
            .high = statistic->high,
            .tolerance = tolerance_of(scene, statistic->tolerance, statistic->scale),
        };
        judge(to, &j);
    }
}

void pl_expectations_judge(const pl_scene *scene, const pl_values *values,
                           const pl_body_state *last, pl_metrics *metrics)
{
    judge_rests(scene, last, metrics);
    judge_travels(scene, last, metrics);
    judge_values(values, scene, metrics);
    judge_statistics(scene, metrics);
}

/* One step is off, and none is not: the tolerance is a half. */
static const double STEPS_OFF = 0.5;

void pl_expectations_judge_bits(const pl_difference *difference, pl_metrics *metrics)
{
    const double ratio = (double)difference->steps / STEPS_OFF;
    raise_to(&metrics->item[PL_METRIC_EXPECTATION_ERROR], NULL, ratio);
    char *text = difference->steps > 0 ? place_of(&metrics->deviations, ratio) : NULL;
    if (text != NULL) {
        snprintf(text, sizeof metrics->deviations.text[0],
                 "bits: a second run differs in %ld step%s, from step %ld on, expected none",
                 difference->steps, difference->steps == 1 ? "" : "s", difference->first);
    }
}
