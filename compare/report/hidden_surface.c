/* Hidden faces by a depth buffer (Catmull 1974), painting order by a topological sort.
 *
 * The buffer has a sample each half pixel and tells the nearest face of each. A face that is
 * nearest nowhere is dropped. At a sample that a seen face covers without being nearest, it must be
 * painted before the one that is: these pairs are the edges of a graph, and any order that respects
 * them is right at every sample, whatever the bodies' shapes and sizes. Where bodies overlap there
 * may be a cycle; it is cut where the search meets it. */
#include "hidden_surface.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 2 }; /* a pixel, in each direction */

static const uint32_t nobody = UINT32_MAX;
static const double touching = 0.05; /* px: depths closer than this are not ordered */

typedef struct depth_buffer {
    int width, height; /* samples */
    uint32_t *nearest; /* (height x width) face, or nobody */
    double *depth;     /* (height x width) px */
} depth_buffer;

/* Face `before` is painted before the face whose list this edge is in. */
typedef struct edge {
    uint32_t before, next;
} edge;

typedef struct paint_graph {
    uint32_t *first; /* (faces) head of each face's list of edges, or nobody */
    edge *edges;
    uint32_t count, capacity;
} paint_graph;

/* Samples [x0, x1) x [y0, y1) that a face may cover. */
typedef struct sample_window {
    int x0, y0, x1, y1;
} sample_window;

static void extent(const pl_face *face, pl_pixel *low, pl_pixel *high)
{
    *low = (pl_pixel){face->corner[0].x - face->radius, face->corner[0].y - face->radius};
    *high = (pl_pixel){face->corner[0].x + face->radius, face->corner[0].y + face->radius};
    for (int i = 1; i < 4 && face->radius == 0; i++) {
        *low = (pl_pixel){fmin(low->x, face->corner[i].x), fmin(low->y, face->corner[i].y)};
        *high = (pl_pixel){fmax(high->x, face->corner[i].x), fmax(high->y, face->corner[i].y)};
    }
}

bool pl_face_inside(const pl_face *face, double width, double height)
{
    pl_pixel low, high;
    extent(face, &low, &high);
    return high.x > 0 && high.y > 0 && low.x < width && low.y < height;
}

static sample_window window_of(const pl_face *face, const depth_buffer *raster)
{
    pl_pixel low, high;
    extent(face, &low, &high);
    return (sample_window){.x0 = (int)fmin(raster->width, fmax(0, floor(low.x * SAMPLES))),
                           .y0 = (int)fmin(raster->height, fmax(0, floor(low.y * SAMPLES))),
                           .x1 = (int)fmax(0, fmin(raster->width, ceil(high.x * SAMPLES))),
                           .y1 = (int)fmax(0, fmin(raster->height, ceil(high.y * SAMPLES)))};
}

/* The face's depth at a point, px; false where it does not cover the point. */
static bool depth_at(const pl_face *face, pl_pixel point, double *depth)
{
    const pl_pixel *corner = face->corner;
    if (face->radius > 0) {
        double x = point.x - corner[0].x, y = point.y - corner[0].y;
        double rest = face->radius * face->radius - x * x - y * y;
        *depth = face->depth[0] + sqrt(fmax(rest, 0));
        return rest >= 0;
    }
    bool left = false, right = false;
    for (int i = 0; i < 4; i++) {
        double area = pl_pixel_turn(corner[i], corner[(i + 1) % 4], point);
        left |= area > 0;
        right |= area < 0;
    }
    if (left && right)
        return false;
    /* In its plane: point = corner 0 + u (corner 1 - corner 0) + v (corner 3 - corner 0). */
    double area = pl_pixel_turn(corner[0], corner[1], corner[3]);
    double u = pl_pixel_turn(corner[0], point, corner[3]) / area;
    double v = pl_pixel_turn(corner[0], corner[1], point) / area;
    *depth = face->depth[0] + u * (face->depth[1] - face->depth[0]) +
             v * (face->depth[3] - face->depth[0]);
    return area != 0;
}

static pl_pixel sample_at(int x, int y)
{
    return (pl_pixel){(x + 0.5) / SAMPLES, (y + 0.5) / SAMPLES};
}

/* Fills the buffer and moves the seen faces to the front of the list, in their order. */
static bool keep_seen(pl_painting *painting, depth_buffer *raster)
{
    size_t samples = (size_t)raster->width * (size_t)raster->height;
    uint32_t *place = malloc((painting->count + 1) * sizeof *place); /* new index, or nobody */
    if (place == NULL)
        return false;
    for (size_t i = 0; i < samples; i++)
        raster->nearest[i] = nobody;
    for (size_t f = 0; f < painting->count; f++) {
        sample_window window = window_of(&painting->faces[f], raster);
        place[f] = nobody;
        for (int y = window.y0; y < window.y1; y++) {
            for (int x = window.x0; x < window.x1; x++) {
                size_t i = (size_t)y * (size_t)raster->width + (size_t)x;
                double depth;
                if (depth_at(&painting->faces[f], sample_at(x, y), &depth) &&
                    (raster->nearest[i] == nobody || depth > raster->depth[i])) {
                    raster->nearest[i] = (uint32_t)f;
                    raster->depth[i] = depth;
                }
            }
        }
    }
    for (size_t i = 0; i < samples; i++)
        if (raster->nearest[i] != nobody)
            place[raster->nearest[i]] = 0;
    size_t kept = 0;
    for (size_t f = 0; f < painting->count; f++) {
        if (place[f] == nobody)
            continue;
        place[f] = (uint32_t)kept;
        painting->faces[kept++] = painting->faces[f];
    }
    painting->count = kept;
    for (size_t i = 0; i < samples; i++)
        if (raster->nearest[i] != nobody)
            raster->nearest[i] = place[raster->nearest[i]];
    free(place);
    return true;
}

static bool add_edge(paint_graph *graph, uint32_t before, uint32_t after)
{
    if (graph->count == graph->capacity) {
        uint32_t capacity = graph->capacity == 0 ? 1024 : graph->capacity * 2;
        edge *edges = realloc(graph->edges, capacity * sizeof *edges);
        if (edges == NULL)
            return false;
        graph->edges = edges;
        graph->capacity = capacity;
    }
    graph->edges[graph->count] = (edge){.before = before, .next = graph->first[after]};
    graph->first[after] = graph->count++;
    return true;
}

static bool find_edges(const pl_painting *painting, const depth_buffer *raster, paint_graph *graph)
{
    bool complete = true;
    uint32_t *known =
        malloc((painting->count + 1) * sizeof *known); /* last `before` of each face */
    if (known == NULL)
        return false;
    for (size_t f = 0; f < painting->count; f++)
        known[f] = graph->first[f] = nobody;
    for (size_t f = 0; f < painting->count; f++) {
        sample_window window = window_of(&painting->faces[f], raster);
        for (int y = window.y0; y < window.y1; y++) {
            for (int x = window.x0; x < window.x1; x++) {
                size_t i = (size_t)y * (size_t)raster->width + (size_t)x;
                uint32_t nearest = raster->nearest[i];
                double depth;
                if (nearest == nobody || nearest == f || known[nearest] == f ||
                    !depth_at(&painting->faces[f], sample_at(x, y), &depth) ||
                    depth > raster->depth[i] - touching)
                    continue;
                known[nearest] = (uint32_t)f;
                complete &= add_edge(graph, (uint32_t)f, nearest);
            }
        }
    }
    free(known);
    return complete;
}

/* Depth-first: everything that must come before a face is painted, then the face. */
static bool sort_faces(pl_painting *painting, const paint_graph *graph)
{
    size_t count = painting->count, painted = 0;
    pl_face *sorted = malloc((count + 1) * sizeof *sorted);
    uint32_t *stack = malloc((count + 1) * sizeof *stack);
    uint32_t *cursor = malloc((count + 1) * sizeof *cursor); /* next edge of each face */
    bool *entered = calloc(count + 1, sizeof *entered);
    bool complete = sorted != NULL && stack != NULL && cursor != NULL && entered != NULL;
    for (size_t f = 0; complete && f < count; f++) {
        size_t height = 0;
        if (!entered[f]) {
            entered[f] = true;
            cursor[f] = graph->first[f];
            stack[height++] = (uint32_t)f;
        }
        while (height > 0) {
            uint32_t top = stack[height - 1];
            if (cursor[top] == nobody) {
                sorted[painted++] = painting->faces[top];
                height--;
                continue;
            }
            edge next = graph->edges[cursor[top]];
            cursor[top] = next.next;
            if (entered[next.before])
                continue;
            entered[next.before] = true;
            cursor[next.before] = graph->first[next.before];
            stack[height++] = next.before;
        }
    }
    if (complete && count > 0)
        memcpy(painting->faces, sorted, count * sizeof *sorted);
    free(sorted);
    free(stack);
    free(cursor);
    free(entered);
    return complete;
}

bool pl_painting_arrange(pl_painting *painting, double width, double height)
{
    depth_buffer raster = {.width = (int)width * SAMPLES, .height = (int)height * SAMPLES};
    paint_graph graph = {0};
    size_t samples = (size_t)raster.width * (size_t)raster.height;
    raster.nearest = malloc((samples + 1) * sizeof *raster.nearest);
    raster.depth = malloc((samples + 1) * sizeof *raster.depth);
    graph.first = malloc((painting->count + 1) * sizeof *graph.first);
    bool complete = raster.nearest != NULL && raster.depth != NULL && graph.first != NULL &&
                    keep_seen(painting, &raster) && find_edges(painting, &raster, &graph) &&
                    sort_faces(painting, &graph);
    free(raster.nearest);
    free(raster.depth);
    free(graph.first);
    free(graph.edges);
    return complete;
}
