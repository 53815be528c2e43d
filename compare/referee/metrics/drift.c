/* Least squares in one pass: slope = sum (t - mean t)(d - mean d) / sum (t - mean t)^2, both sums
 * carried by their own updates so that nothing large is ever subtracted from something large.
 * Source: Welford 1962, with the cross sum treated as the square sum. */
#include "drift.h"

#include "plumb/vec.h"

#include <stdlib.h>

typedef struct followed {
    int body;
    pl_vec along; /* the reference moves along this unit vector; null where it stands */
    pl_vec baseline;
    pl_vec mean;
    pl_vec cross; /* sum of (t - mean t)(d - mean d) */
} followed;

struct pl_drift {
    followed *bodies; /* (count) */
    int count;
    long samples;
    double start;
    double mean_time, square_time; /* of t since the start, and the sum of squares about it */
    double largest;
};

static void follow(pl_drift *drift, bool *seen, int body, pl_vec along)
{
    if (!seen[body]) {
        seen[body] = true;
        drift->bodies[drift->count++] = (followed){.body = body, .along = along};
    }
}

pl_drift *pl_drift_create(const pl_scene *scene)
{
    size_t most = (size_t)scene->body_count + 1;
    pl_drift *drift = calloc(1, sizeof *drift);
    followed *bodies = calloc(most, sizeof *bodies);
    bool *seen = calloc(most, sizeof *seen);
    if (drift == NULL || bodies == NULL || seen == NULL) {
        free(drift);
        free(bodies);
        free(seen);
        return NULL;
    }
    drift->bodies = bodies;
    for (int i = 0; i < scene->travel_count; ++i) {
        const pl_expect_travel *travel = &scene->travels[i];
        follow(drift, seen, travel->body, pl_vec_of(travel->direction));
    }
    for (int i = 0; i < scene->rest_count; ++i) {
        follow(drift, seen, scene->rests[i].body, (pl_vec){0, 0, 0});
    }
    free(seen);
    return drift;
}

void pl_drift_destroy(pl_drift *drift)
{
    if (drift != NULL) {
        free(drift->bodies);
        free(drift);
    }
}

bool pl_drift_applies(const pl_drift *drift)
{
    return drift->count > 0;
}

void pl_drift_begin(pl_drift *drift, double time, const pl_body_state *bodies)
{
    drift->samples = 1;
    drift->start = time;
    drift->mean_time = drift->square_time = drift->largest = 0;
    for (int i = 0; i < drift->count; ++i) {
        followed *f = &drift->bodies[i];
        f->baseline = pl_vec_of(bodies[f->body].position);
        f->mean = f->cross = (pl_vec){0, 0, 0};
    }
}

void pl_drift_add(pl_drift *drift, double time, const pl_body_state *bodies)
{
    double t = time - drift->start;
    double n = (double)++drift->samples;
    double off_mean = t - drift->mean_time; /* from the mean of the samples before */
    drift->mean_time += off_mean / n;
    drift->square_time += off_mean * (t - drift->mean_time);
    for (int i = 0; i < drift->count; ++i) {
        followed *f = &drift->bodies[i];
        pl_vec d = pl_vec_sub(pl_vec_of(bodies[f->body].position), f->baseline);
        d = pl_vec_mad(d, -pl_vec_dot(d, f->along), f->along);
        drift->largest = fmax(drift->largest, pl_vec_length(d));
        f->mean = pl_vec_mad(f->mean, 1 / n, pl_vec_sub(d, f->mean));
        f->cross = pl_vec_mad(f->cross, off_mean, pl_vec_sub(d, f->mean));
    }
}

long pl_drift_samples(const pl_drift *drift)
{
    return drift->samples;
}

double pl_drift_largest(const pl_drift *drift)
{
    return drift->largest;
}

double pl_drift_slope(const pl_drift *drift)
{
    double fastest = 0;
    for (int i = 0; i < drift->count; ++i) {
        fastest = fmax(fastest, pl_vec_length(drift->bodies[i].cross) / drift->square_time);
    }
    return fastest;
}
