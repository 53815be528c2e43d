/* The raw file is a sequence of records in the byte order of the machine. A frame is 'F', the step,
 * the poses of the dynamic bodies, the number of contacts (-1: none are reported), and of each contact
 * its point, depth and force. A point of the curves is 'C', the step and the values. A run that ends
 * early leaves whole records, but for the last. The file is open only while a record is written, so
 * that the engine has no descriptor of it. */
#include "recording.h"

#include "base/heap.h"
#include "plumb/vec.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_FRAMES = 300, MOST_BUCKETS = 250, MOST_RAW_BYTES = 64 << 20 };

static long stride_of(long steps, long most)
{
    return steps <= most ? 1 : (steps + most - 1) / most;
}

static bool open_file(pl_recorder *r, const char *mode)
{
    r->file = fopen(r->path, mode);
    return r->file != NULL;
}

/* Closes the file; false when it could not be written. */
static bool close_file(pl_recorder *r)
{
    const bool failed = ferror(r->file) != 0;
    const bool closed = fclose(r->file) == 0;
    r->file = NULL;
    return closed && !failed;
}

pl_status pl_recorder_create(const char *path, const pl_scene *scene, pl_recorder *recorder,
                             pl_error *error)
{
    const long steps = pl_scene_steps(scene);
    size_t bytes = 64;
    for (int i = 0; i < scene->body_count; ++i) {
        /* With about four contacts of five numbers each. */
        bytes += scene->bodies[i].is_static ? 0 : (7 + 4 * 5) * sizeof(float);
    }
    const long fitting = (long)((size_t)MOST_RAW_BYTES / bytes);
    *recorder =
        (pl_recorder){.path = path,
                      .scene = scene,
                      .stride = stride_of(steps, fitting < MOST_FRAMES ? fitting + 1 : MOST_FRAMES),
                      .bucket = stride_of(steps, MOST_BUCKETS)};
    const size_t sample = (7 * (size_t)scene->body_count + 1) * sizeof *recorder->sample;
    recorder->sample = pl_heap_new(1, sample);
    memset(recorder->sample, 0xff, sample); /* resident before the engine is created */
    return open_file(recorder, "we") && fwrite(PL_RAW_MAGIC, 8, 1, recorder->file) == 1 &&
                   close_file(recorder)
               ? PL_OK
               : pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
}

static void write_contacts(pl_recorder *r, const pl_recorded_step *seen)
{
    const int32_t count = seen->contact_count;
    fwrite(&count, sizeof count, 1, r->file);
    for (int i = 0; i < count; ++i) {
        const pl_contact *c = &seen->contacts[i];
        const double force =
            seen->has_impulses ? pl_vec_length(pl_vec_of(c->impulse)) / r->scene->dt : (double)NAN;
        const float numbers[5] = {(float)c->point[0], (float)c->point[1], (float)c->point[2],
                                  (float)-c->separation, (float)force};
        fwrite(numbers, sizeof numbers, 1, r->file);
    }
}

static void write_frame(pl_recorder *r, const pl_recorded_step *seen)
{
    const int64_t step = seen->step;
    size_t next = 0;
    for (int i = 0; i < r->scene->body_count; ++i) {
        const pl_body_state *state = &seen->frame->bodies[i];
        for (int k = 0; k < 7 && !r->scene->bodies[i].is_static; ++k) {
            r->sample[next++] = (float)(k < 3 ? state->position[k] : state->orientation[k - 3]);
        }
    }
    fputc('F', r->file);
    fwrite(&step, sizeof step, 1, r->file);
    fwrite(r->sample, sizeof *r->sample, next, r->file);
    write_contacts(r, seen);
}

/* Adds a step to the open bucket: the energies of its last step, and the largest of the others. */
static void add_curves(pl_recorder *r, const pl_recorded_step *seen)
{
    double value[PL_CURVE_COUNT];
    pl_curves_of(r->scene, seen->frame->bodies, seen->contacts,
                 seen->has_impulses ? seen->contact_count : -1, value);
    value[PL_CURVE_PENETRATION] = seen->penetration;
    value[PL_CURVE_ITERATIONS] = seen->iterations;
    value[PL_CURVE_RESIDUAL] = seen->residual;
    for (int k = 0; k < PL_CURVE_COUNT; ++k) {
        const bool is_last = k == PL_CURVE_KINETIC_ENERGY || k == PL_CURVE_ENERGY;
        r->value[k] = r->first == 0 || is_last ? value[k] : fmax(r->value[k], value[k]);
    }
    r->first = r->first == 0 ? seen->step : r->first;
}

static void write_curves(pl_recorder *r, long last)
{
    const int64_t step = last;
    fputc('C', r->file);
    fwrite(&step, sizeof step, 1, r->file);
    fwrite(r->value, sizeof r->value, 1, r->file);
    r->first = 0;
}

void pl_recorder_step(pl_recorder *r, const pl_recorded_step *seen)
{
    if (r->path == NULL) {
        return;
    }
    const bool is_last = seen->step == pl_scene_steps(r->scene);
    const bool has_frame = seen->step % r->stride == 0 || is_last;
    const bool has_curves = seen->step % r->bucket == 0 || is_last;
    add_curves(r, seen);
    if (!has_frame && !has_curves) {
        return;
    }
    bool written = open_file(r, "ae");
    if (written && has_frame) {
        write_frame(r, seen);
    }
    if (written && has_curves) {
        write_curves(r, seen->step);
    }
    written = written && close_file(r);
    r->path = written ? r->path : NULL;
}

void pl_recorder_end(pl_recorder *recorder)
{
    if (recorder->file != NULL) {
        fclose(recorder->file);
    }
    free(recorder->sample);
    *recorder = (pl_recorder){.file = NULL};
}

char *pl_run_file(const char *folder, const char *run, const char *ending)
{
    return pl_heap_format("%s/%s.%s", folder, run, ending);
}

void pl_run_files_remove(const char *folder, const char *ending, const json_t *kept)
{
    DIR *directory = opendir(folder);
    const struct dirent *entry;
    while (directory != NULL && (entry = readdir(directory)) != NULL) {
        const char *name = entry->d_name;
        char run[17];
        snprintf(run, sizeof run, "%.16s", name);
        if (strspn(name, "0123456789abcdef") == 16 && name[16] == '.' &&
            strcmp(name + 17, ending) == 0 && json_object_get(kept, run) == NULL) {
            unlinkat(dirfd(directory), name, 0);
        }
    }
    if (directory != NULL) {
        closedir(directory);
    }
}

void pl_recordings_remove(const char *folder, const json_t *kept)
{
    pl_run_files_remove(folder, "json", kept);
    pl_run_files_remove(folder, "raw", kept);
}
