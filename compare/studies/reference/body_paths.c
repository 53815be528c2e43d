#include "body_paths.h"

#include "base/heap.h"
#include "runner/positions.h"
#include "runner/recording.h"

#include <math.h>
#include <stdlib.h>

static bool all_finite(const double *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (!isfinite(values[i])) {
            return false;
        }
    }
    return true;
}

pl_body_paths pl_body_paths_read(const char *folder, const char *run, const pl_scene *scene,
                                 long stride)
{
    const long whole = pl_scene_steps(scene) / stride + 1;
    const double interval = (double)stride * scene->dt;
    pl_positions_reader reader;
    pl_body_paths paths = {.bodies = pl_positions_bodies(scene)};
    const size_t row = 3 * (size_t)paths.bodies;
    char *path = pl_run_file(folder, run, "positions");
    const bool is_open = pl_positions_open(path, &reader);
    free(path);
    if (!is_open || reader.bodies != paths.bodies || reader.interval != interval) {
        pl_positions_close(&reader);
        return paths;
    }
    paths.moved = pl_heap_new((size_t)whole * row, sizeof *paths.moved);
    while (paths.samples < whole) {
        double *sample = &paths.moved[(size_t)paths.samples * row];
        if (!pl_positions_read(&reader, sample) || !all_finite(sample, row)) {
            break;
        }
        paths.samples += 1;
    }
    pl_positions_close(&reader);
    paths.completed = paths.samples == whole;
    return paths;
}

void pl_body_paths_free(pl_body_paths *paths)
{
    free(paths->moved);
    *paths = (pl_body_paths){.bodies = 0};
}

double pl_body_paths_distance(const pl_body_paths *a, const pl_body_paths *b, int body, long sample)
{
    const size_t at = ((size_t)sample * (size_t)a->bodies + (size_t)body) * 3;
    double square = 0;
    for (size_t k = at; k < at + 3; ++k) {
        const double d = a->moved[k] - b->moved[k];
        square += d * d;
    }
    return sqrt(square);
}

/* ---- The error that halvings of the step leave ---- */

const double pl_halving_window = 0.1;

/* Of the last halvings this number counts. */
enum { TRUSTED = 2 };

static const double least_rate = 0.25;
static const double largest_rate = 0.70710678118654752;

long pl_halving_samples(const pl_body_paths *levels, int count)
{
    long samples = levels[0].samples;
    for (int k = 1; k < count; ++k) {
        samples = levels[k].samples < samples ? levels[k].samples : samples;
    }
    return samples;
}

/* changes[i] is the largest distance of a body between two levels within the window about i. */
static void windowed_changes(const pl_body_paths *fine, const pl_body_paths *coarse, int body,
                             long samples, long reach, double *changes)
{
    for (long i = 0; i < samples; ++i) {
        changes[i] = 0;
    }
    for (long i = 0; i < samples; ++i) {
        const double change = pl_body_paths_distance(fine, coarse, body, i);
        const long first = i > reach ? i - reach : 0;
        const long last = i + reach < samples ? i + reach : samples - 1;
        for (long k = first; k <= last; ++k) {
            changes[k] = fmax(changes[k], change);
        }
    }
}

/* The error that is left after the last of `count` changes, which stand `stride` apart, the last one
 * first. */
static double remaining(const double *changes, long stride, int count)
{
    const double before = count > 1 ? changes[stride] : 2 * changes[0];
    const double observed = before > 0 ? changes[0] / before : largest_rate;
    const double rate = fmin(fmax(observed, least_rate), largest_rate);
    double last = changes[0], trust = 1;
    for (int k = 1; k < count; ++k) {
        trust *= least_rate;
        last = fmax(last, trust * changes[k * stride]);
    }
    return last * rate / (1 - rate);
}

void pl_halving_error(const pl_body_paths *levels, int count, double interval, double *error)
{
    const long samples = pl_halving_samples(levels, count);
    const long reach = (long)ceil(pl_halving_window / interval);
    const int bodies = levels[0].bodies;
    const int halvings = count - 1 < TRUSTED ? count - 1 : TRUSTED;
    double *changes = pl_heap_new(TRUSTED * (size_t)samples, sizeof *changes);
    for (int body = 0; body < bodies; ++body) {
        for (int k = 0; k < halvings; ++k) {
            windowed_changes(&levels[count - 1 - k], &levels[count - 2 - k], body, samples, reach,
                             changes + k * samples);
        }
        for (long i = 0; i < samples; ++i) {
            error[i * bodies + body] = remaining(changes + i, samples, halvings);
        }
    }
    free(changes);
}
