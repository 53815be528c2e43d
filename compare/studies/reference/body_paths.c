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

long pl_body_paths_common(const pl_body_paths *a, const pl_body_paths *b)
{
    return a->samples < b->samples ? a->samples : b->samples;
}
