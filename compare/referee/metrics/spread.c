/* Of the dynamic bodies' centres of mass. The percentile lies between two order statistics, by
 * linear interpolation at (n - 1) p (Hyndman and Fan 1996, definition 7). */
#include "spread.h"

#include "referee/geometry/solid.h"

#include <stdlib.h>

struct pl_spread {
    const pl_scene *scene;
    int count;     /* dynamic bodies */
    pl_vec *start; /* (count) */
    pl_vec *last;  /* (count) */
    double *way;   /* (count) */
};

pl_spread *pl_spread_create(const pl_scene *scene)
{
    pl_spread *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return NULL;
    }
    s->scene = scene;
    for (int i = 0; i < scene->body_count; ++i) {
        s->count += !scene->bodies[i].is_static;
    }
    size_t room = (size_t)s->count + 1;
    s->start = calloc(room, sizeof *s->start);
    s->last = calloc(room, sizeof *s->last);
    s->way = calloc(room, sizeof *s->way);
    if (s->start == NULL || s->last == NULL || s->way == NULL) {
        pl_spread_destroy(s);
        return NULL;
    }
    return s;
}

void pl_spread_destroy(pl_spread *s)
{
    if (s == NULL) {
        return;
    }
    free(s->start);
    free(s->last);
    free(s->way);
    free(s);
}

bool pl_spread_applies(const pl_spread *s)
{
    return s->count > 1;
}

static void read_centres(const pl_spread *s, const pl_body_state *bodies, pl_vec *centres)
{
    int next = 0;
    for (int i = 0; i < s->scene->body_count; ++i) {
        if (!s->scene->bodies[i].is_static) {
            centres[next++] = pl_centre_of_mass(&s->scene->bodies[i].shape, bodies[i].position,
                                                bodies[i].orientation);
        }
    }
}

void pl_spread_start(pl_spread *s, const pl_body_state *bodies)
{
    read_centres(s, bodies, s->start);
}

/* Of the components along `axis`, about their mean: twice through, so that nothing cancels. */
static double deviation(const pl_spread *s, pl_vec axis)
{
    double mean = 0, square = 0;
    for (int i = 0; i < s->count; ++i) {
        mean += pl_vec_dot(s->last[i], axis) / s->count;
    }
    for (int i = 0; i < s->count; ++i) {
        double d = pl_vec_dot(s->last[i], axis) - mean;
        square += d * d / s->count;
    }
    return sqrt(square);
}

static double mass_height(const pl_spread *s, pl_vec up)
{
    double mass = 0, moment = 0;
    int next = 0;
    for (int i = 0; i < s->scene->body_count; ++i) {
        const pl_body *body = &s->scene->bodies[i];
        if (!body->is_static) {
            mass += body->mass;
            moment += body->mass * pl_vec_dot(s->last[next++], up);
        }
    }
    return moment / mass;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double run_out(const pl_spread *s, pl_vec up)
{
    for (int i = 0; i < s->count; ++i) {
        s->way[i] = pl_vec_length(pl_vec_reject(pl_vec_sub(s->last[i], s->start[i]), up));
    }
    qsort(s->way, (size_t)s->count, sizeof *s->way, ascending);
    double place = 0.95 * (s->count - 1);
    int below = (int)place;
    int above = below + 1 < s->count ? below + 1 : below;
    return s->way[below] + (place - below) * (s->way[above] - s->way[below]);
}

static pl_metric value_of(double value)
{
    return (pl_metric){.state = PL_METRIC_VALUE, .value = value};
}

void pl_spread_measure(pl_spread *s, const pl_body_state *bodies, pl_metric *item)
{
    pl_vec g = pl_vec_of(s->scene->gravity);
    double strength = pl_vec_length(g);
    pl_vec up = strength > 0 ? pl_vec_scale(g, -1 / strength) : (pl_vec){0, 0, 0};
    read_centres(s, bodies, s->last);
    item[PL_METRIC_SPREAD_X] = value_of(deviation(s, (pl_vec){1, 0, 0}));
    item[PL_METRIC_SPREAD_Y] = value_of(deviation(s, (pl_vec){0, 1, 0}));
    item[PL_METRIC_RUN_OUT_P95] = value_of(run_out(s, up));
    if (strength > 0) {
        item[PL_METRIC_MASS_HEIGHT] = value_of(mass_height(s, up));
    }
}
