/* The spread of an ensemble over time, read from its members' position files. */
#include "sample.h"

#include "base/heap.h"
#include "results/result.h"
#include "runner/positions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double share_of_size = 0.01;

/* One member's open trajectory. */
typedef struct track {
    pl_positions_reader reader;
    double *place; /* (3 x bodies) */
} track;

double pl_ensemble_spread(const double *const *members, int member_count, int bodies)
{
    double largest = 0;
    for (int b = 0; b < bodies; ++b) {
        double variance = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const int at = 3 * b + axis;
            double mean = 0, square = 0;
            for (int k = 0; k < member_count; ++k) {
                mean += members[k][at] / member_count;
            }
            for (int k = 0; k < member_count; ++k) {
                double d = members[k][at] - mean;
                square += d * d;
            }
            variance += square / (member_count - 1);
        }
        largest = fmax(largest, variance);
    }
    return sqrt(largest);
}

static bool open_track(const char *folder, const char *run, track *t)
{
    char *path = pl_heap_format("%s/%s.positions", folder, run);
    const bool is_open = pl_positions_open(path, &t->reader);
    t->place = pl_heap_new(3 * (size_t)t->reader.bodies, sizeof *t->place);
    free(path);
    return is_open;
}

static void close_track(track *t)
{
    pl_positions_close(&t->reader);
    free(t->place);
}

static bool read_sample(track *t)
{
    const bool is_read = pl_positions_read(&t->reader, t->place);
    for (int i = 0; i < 3 * t->reader.bodies && is_read; ++i) {
        t->place[i] = t->reader.start[i] + t->place[i];
    }
    return is_read;
}

/* Reads all tracks in step, to the end of the shortest; NULL: there is no frame that all have. */
static json_t *follow(track *tracks, int members, double threshold)
{
    const pl_positions_reader *first = &tracks[0].reader;
    const double **places = pl_heap_new((size_t)members, sizeof *places);
    double time = (double)NAN, last_time = 0, spread = 0;
    long sample = 0;
    for (;; ++sample) {
        int read = 0;
        while (read < members && read_sample(&tracks[read])) {
            places[read] = tracks[read].place;
            ++read;
        }
        if (read < members) {
            break;
        }
        last_time = (double)sample * first->interval;
        spread = pl_ensemble_spread(places, members, first->bodies);
        if (isnan(time) && !(spread <= threshold)) {
            time = last_time;
        }
    }
    free(places);
    json_t *horizon = sample == 0
                          ? NULL
                          : json_pack("{s:o, s:f, s:o, s:f}", "time", pl_json_number_or_null(time),
                                      "threshold", threshold, "last_spread",
                                      pl_json_number_or_null(spread), "last_time", last_time);
    if (sample > 0 && isnan(time)) {
        json_object_set_new(horizon, "reason", json_sprintf("not passed within %.6g s", last_time));
    }
    return horizon;
}

json_t *pl_horizon_find(const char *folder, const json_t *runs, double least_size)
{
    const int members = (int)json_array_size(runs);
    track *tracks = pl_heap_new((size_t)members, sizeof *tracks);
    const track *first = NULL;
    json_t *horizon = NULL;
    int open = 0;
    for (int k = 0; k < members; ++k) {
        const char *run = json_string_value(json_array_get(runs, (size_t)k));
        if (open_track(folder, run, &tracks[k])) {
            first = first == NULL ? &tracks[k] : first;
            open += tracks[k].reader.bodies == first->reader.bodies &&
                    tracks[k].reader.interval == first->reader.interval;
        }
    }
    if (open == members && members > 1) {
        horizon = follow(tracks, members, share_of_size * least_size);
    }
    for (int k = 0; k < members; ++k) {
        close_track(&tracks[k]);
    }
    free(tracks);
    return horizon != NULL
               ? horizon
               : json_pack(
                     "{s:n, s:o}", "time", "reason",
                     json_sprintf("%d of %d members left a trajectory, and of some there is no "
                                  "frame",
                                  open, members));
}
