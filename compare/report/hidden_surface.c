/* Hidden-surface removal by a depth buffer (Catmull 1974), and the painting order by a topological
 * sort.
 *
 * The buffer has a sample each half pixel and keeps the nearest face of each. A face that is
 * nearest nowhere is dropped. A seen face that covers a sample without being nearest there must be
 * painted before the one that is: these pairs are the edges of a graph, and any order that respects
 * them is right at every sample, whatever the bodies' shapes and sizes. Where bodies overlap there
 * may be a cycle; it is cut where the search meets it. */
#include "picture.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 2 /* a pixel, in each direction */, NOBODY = -1 };

static const double touching = 0.05; /* px: depths closer than this are not ordered */

typedef struct depth_buffer {
    int width, height; /* samples */
    int *nearest;      /* (height x width) face, or NOBODY */
    double *depth;     /* (height x width) px */
} depth_buffer;

/* Face `before` is painted before the face whose list this edge is in. */
typedef struct edge {
    int before, next;
} edge;

typedef struct paint_graph {
    int *first; /* (faces) head of each face's list of edges, or NOBODY */
    edge *edges;
    int count;
} paint_graph;

/* The samples that a face may cover, [x, x_end) x [y, y_end), and the one that was visited last. */
typedef struct sample_window {
    int x_begin, x_end, y_end;
    int x, y;
} sample_window;

static void extent(const pl_face *face, pl_pixel *low, pl_pixel *high)
{
    *low = (pl_pixel){face->corner[0].x - face->radius, face->corner[0].y - face->radius};
    *high = (pl_pixel){face->corner[0].x + face->radius, face->corner[0].y + face->radius};
    for (int i = 1; i < 4 && face->radius == 0; ++i) {
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
    int x = (int)fmin(raster->width, fmax(0, floor(low.x * SAMPLES)));
    return (sample_window){.x_begin = x,
                           .x_end = (int)fmax(0, fmin(raster->width, ceil(high.x * SAMPLES))),
                           .y_end = (int)fmax(0, fmin(raster->height, ceil(high.y * SAMPLES))),
                           .x = x - 1,
                           .y = (int)fmin(raster->height, fmax(0, floor(low.y * SAMPLES)))};
}

/* Computes the face's depth at a point, px; false where it does not cover the point. */
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
    for (int i = 0; i < 4; ++i) {
        double area = pl_pixel_turn(corner[i], corner[(i + 1) % 4], point);
        left |= area > 0;
        right |= area < 0;
    }
    if (left && right) {
        return false;
    }
    /* In its plane: point = corner 0 + u (corner 1 - corner 0) + v (corner 3 - corner 0). */
    double area = pl_pixel_turn(corner[0], corner[1], corner[3]);
    double u = pl_pixel_turn(corner[0], point, corner[3]) / area;
    double v = pl_pixel_turn(corner[0], corner[1], point) / area;
    *depth = face->depth[0] + u * (face->depth[1] - face->depth[0]) +
             v * (face->depth[3] - face->depth[0]);
    return area != 0;
}

/* Moves to the next sample that the face covers, row by row, and computes its depth there. Returns
 * the index of the sample; NOBODY when there is none left. */
static ptrdiff_t next_sample(const pl_face *face, const depth_buffer *raster, sample_window *window,
                             double *depth)
{
    for (; window->y < window->y_end; ++window->y, window->x = window->x_begin - 1) {
        while (++window->x < window->x_end) {
            const pl_pixel point = {(window->x + 0.5) / SAMPLES, (window->y + 0.5) / SAMPLES};
            if (depth_at(face, point, depth)) {
                return (ptrdiff_t)window->y * raster->width + window->x;
            }
        }
    }
    return NOBODY;
}

/* Fills the buffer and moves the seen faces to the front of the list, in their order. */
static bool keep_seen(pl_painting *painting, depth_buffer *raster)
{
    const size_t samples = (size_t)raster->width * (size_t)raster->height;
    int *place = malloc(((size_t)painting->count + 1) * sizeof *place); /* new index, or NOBODY */
    if (place == NULL) {
        return false;
    }
    for (size_t i = 0; i < samples; ++i) {
        raster->nearest[i] = NOBODY;
    }
    for (int f = 0; f < painting->count; ++f) {
        const pl_face *face = &painting->faces[f];
        sample_window window = window_of(face, raster);
        double depth;
        place[f] = NOBODY;
        for (ptrdiff_t i; (i = next_sample(face, raster, &window, &depth)) != NOBODY;) {
            if (raster->nearest[i] == NOBODY || depth > raster->depth[i]) {
                raster->nearest[i] = f;
                raster->depth[i] = depth;
            }
        }
    }
    for (size_t i = 0; i < samples; ++i) {
        if (raster->nearest[i] != NOBODY) {
            place[raster->nearest[i]] = 0;
        }
    }
    int kept = 0;
    for (int f = 0; f < painting->count; ++f) {
        if (place[f] != NOBODY) {
            place[f] = kept;
            painting->faces[kept++] = painting->faces[f];
        }
    }
    painting->count = kept;
    for (size_t i = 0; i < samples; ++i) {
        if (raster->nearest[i] != NOBODY) {
            raster->nearest[i] = place[raster->nearest[i]];
        }
    }
    free(place);
    return true;
}

static bool find_edges(const pl_painting *painting, const depth_buffer *raster, paint_graph *graph)
{
    bool complete = true;
    /* The last `before` of each face. */
    int *known = malloc(((size_t)painting->count + 1) * sizeof *known);
    if (known == NULL) {
        return false;
    }
    for (int f = 0; f < painting->count; ++f) {
        known[f] = graph->first[f] = NOBODY;
    }
    for (int f = 0; f < painting->count; ++f) {
        const pl_face *face = &painting->faces[f];
        sample_window window = window_of(face, raster);
        double depth;
        for (ptrdiff_t i; (i = next_sample(face, raster, &window, &depth)) != NOBODY;) {
            const int nearest = raster->nearest[i];
            if (nearest == NOBODY || nearest == f || known[nearest] == f ||
                depth > raster->depth[i] - touching) {
                continue;
            }
            const edge added = {.before = f, .next = graph->first[nearest]};
            known[nearest] = f;
            graph->first[nearest] = graph->count;
            complete &=
                pl_array_push(&graph->edges, &graph->count, &added, sizeof added, NULL) == PL_OK;
        }
    }
    free(known);
    return complete;
}

/* Depth-first: everything that must come before a face is painted, then the face. Uses up the lists
 * of the graph. */
static bool sort_faces(pl_painting *painting, paint_graph *graph)
{
    const size_t count = (size_t)painting->count;
    int painted = 0;
    pl_face *sorted = malloc((count + 1) * sizeof *sorted);
    int *stack = malloc((count + 1) * sizeof *stack);
    bool *entered = calloc(count + 1, sizeof *entered);
    const bool complete = sorted != NULL && stack != NULL && entered != NULL;
    for (int f = 0; complete && f < painting->count; ++f) {
        int height = 0;
        if (!entered[f]) {
            entered[f] = true;
            stack[height++] = f;
        }
        while (height > 0) {
            const int top = stack[height - 1], next = graph->first[top];
            if (next == NOBODY) {
                sorted[painted++] = painting->faces[top];
                --height;
                continue;
            }
            const int before = graph->edges[next].before;
            graph->first[top] = graph->edges[next].next;
            if (!entered[before]) {
                entered[before] = true;
                stack[height++] = before;
            }
        }
    }
    if (complete && count > 0) {
        memcpy(painting->faces, sorted, count * sizeof *sorted);
    }
    free(sorted);
    free(stack);
    free(entered);
    return complete;
}

bool pl_painting_arrange(pl_painting *painting, double width, double height)
{
    depth_buffer raster = {.width = (int)width * SAMPLES, .height = (int)height * SAMPLES};
    paint_graph graph = {0};
    const size_t samples = (size_t)raster.width * (size_t)raster.height;
    raster.nearest = malloc((samples + 1) * sizeof *raster.nearest);
    raster.depth = malloc((samples + 1) * sizeof *raster.depth);
    graph.first = malloc(((size_t)painting->count + 1) * sizeof *graph.first);
    const bool complete = raster.nearest != NULL && raster.depth != NULL && graph.first != NULL &&
                          keep_seen(painting, &raster) && find_edges(painting, &raster, &graph) &&
                          sort_faces(painting, &graph);
    free(raster.nearest);
    free(raster.depth);
    free(graph.first);
    free(graph.edges);
    return complete;
}
