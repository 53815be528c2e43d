#include "positions.h"

#include "base/heap.h"
#include "recording.h"
#include "referee/geometry/solid.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct header {
    char magic[8];
    int64_t bodies;
    double interval; /* s */
} header;

static const char magic[8] = {'p', 'l', 'u', 'm', 'b', 'p', 's', '3'};

long pl_positions_stride(double dt)
{
    /* A step of 1/60 s, however it was rounded, is sampled at every step. */
    double steps = ceil(1.0 / (60 * dt) - 1e-6);
    return steps > 1 ? (long)steps : 1;
}

int pl_positions_bodies(const pl_scene *scene)
{
    int count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        count += !scene->bodies[i].is_static;
    }
    return count;
}

/* Stores the starts of the dynamic bodies, (3 x bodies). */
static void store_starts(const pl_scene *scene, double *start)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            pl_vec_store(pl_centre_of_mass(&body->shape, body->position, body->orientation), start);
            start += 3;
        }
    }
}

pl_status pl_positions_create(const char *path, const pl_scene *scene, long stride,
                              pl_positions_writer *writer, pl_error *error)
{
    stride = stride > 0 ? stride : pl_positions_stride(scene->dt);
    header h = {.bodies = pl_positions_bodies(scene), .interval = (double)stride * scene->dt};
    const size_t count = 3 * (size_t)h.bodies;
    memcpy(h.magic, magic, sizeof h.magic);
    *writer = (pl_positions_writer){.path = path, .scene = scene, .stride = stride};
    writer->start = pl_heap_new(count, sizeof *writer->start);
    writer->sample = pl_heap_new(count, sizeof *writer->sample);
    store_starts(scene, writer->start);
    writer->file = fopen(path, "we");
    if (writer->file == NULL || fwrite(&h, sizeof h, 1, writer->file) != 1 ||
        fwrite(writer->start, sizeof *writer->start, count, writer->file) != count) {
        return pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    return PL_OK;
}

pl_status pl_positions_write(pl_positions_writer *writer, long step, const pl_frame *frame,
                             pl_error *error)
{
    if (writer->file == NULL || step % writer->stride != 0) {
        return PL_OK;
    }
    size_t next = 0;
    for (int i = 0; i < frame->body_count; ++i) {
        const pl_body *body = &writer->scene->bodies[i];
        const pl_body_state *state = &frame->bodies[i];
        if (!body->is_static) {
            pl_vec now = pl_centre_of_mass(&body->shape, state->position, state->orientation);
            pl_vec displacement = pl_vec_sub(now, pl_vec_of(&writer->start[next]));
            writer->sample[next++] = displacement.x;
            writer->sample[next++] = displacement.y;
            writer->sample[next++] = displacement.z;
        }
    }
    if (fwrite(writer->sample, sizeof *writer->sample, next, writer->file) != next ||
        fflush(writer->file) != 0) {
        return pl_fail(error, PL_IO, "%s: %s", writer->path, strerror(errno));
    }
    return PL_OK;
}

void pl_positions_end(pl_positions_writer *writer)
{
    if (writer->file != NULL) {
        fclose(writer->file);
    }
    free(writer->start);
    free(writer->sample);
    *writer = (pl_positions_writer){.file = NULL};
}

bool pl_positions_open(const char *path, pl_positions_reader *reader)
{
    header h;
    *reader = (pl_positions_reader){.file = fopen(path, "re")};
    bool is_whole = reader->file != NULL && fread(&h, sizeof h, 1, reader->file) == 1 &&
                    memcmp(h.magic, magic, sizeof h.magic) == 0 && h.bodies >= 0 &&
                    h.bodies <= PL_MAX_BODIES;
    if (is_whole) {
        const size_t count = 3 * (size_t)h.bodies;
        reader->bodies = (int)h.bodies;
        reader->interval = h.interval;
        reader->start = pl_heap_new(count, sizeof *reader->start);
        is_whole = fread(reader->start, sizeof *reader->start, count, reader->file) == count;
    }
    if (!is_whole) {
        pl_positions_close(reader);
    }
    return is_whole;
}

bool pl_positions_read(pl_positions_reader *reader, double *sample)
{
    const size_t count = 3 * (size_t)reader->bodies;
    return fread(sample, sizeof *sample, count, reader->file) == count;
}

void pl_positions_close(pl_positions_reader *reader)
{
    if (reader->file != NULL) {
        fclose(reader->file);
    }
    free(reader->start);
    *reader = (pl_positions_reader){.file = NULL};
}

void pl_positions_clear(const char *folder)
{
    pl_run_files_remove(folder, "positions", NULL);
    rmdir(folder);
}
