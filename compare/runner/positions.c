#include "positions.h"

#include "base/heap.h"
#include "referee/geometry/solid.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct header {
    char magic[8];
    int64_t bodies;
    double interval; /* s */
} header;

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

static long stride_of(const pl_scene *scene, long stride)
{
    return stride > 0 ? stride : pl_positions_stride(scene->dt);
}

static header header_of(const pl_scene *scene, long stride)
{
    header h = {.bodies = pl_positions_bodies(scene),
                .interval = (double)stride_of(scene, stride) * scene->dt};
    memcpy(h.magic, "plumbps2", sizeof h.magic);
    return h;
}

pl_status pl_positions_create(const char *path, const pl_scene *scene, long stride,
                              pl_positions_writer *writer, pl_error *error)
{
    const header h = header_of(scene, stride);
    *writer =
        (pl_positions_writer){.path = path, .scene = scene, .stride = stride_of(scene, stride)};
    writer->sample = pl_heap_new(3 * (size_t)h.bodies, sizeof *writer->sample);
    writer->file = fopen(path, "we");
    if (writer->file == NULL || fwrite(&h, sizeof h, 1, writer->file) != 1) {
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
            pl_vec start = pl_centre_of_mass(&body->shape, body->position, body->orientation);
            pl_vec now = pl_centre_of_mass(&body->shape, state->position, state->orientation);
            pl_vec displacement = pl_vec_sub(now, start);
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
    free(writer->sample);
    *writer = (pl_positions_writer){.file = NULL};
}

FILE *pl_positions_open(const char *path, const pl_scene *scene, long stride)
{
    const header expected = header_of(scene, stride);
    header found;
    FILE *file = fopen(path, "re");
    if (file != NULL && (fread(&found, sizeof found, 1, file) != 1 ||
                         memcmp(found.magic, expected.magic, sizeof found.magic) != 0 ||
                         found.bodies != expected.bodies || found.interval != expected.interval)) {
        fclose(file);
        return NULL;
    }
    return file;
}

bool pl_positions_read(FILE *file, int bodies, double *sample)
{
    size_t count = 3 * (size_t)bodies;
    return fread(sample, sizeof *sample, count, file) == count;
}
