/* Two partitions by disjoint sets: of this frame, and of this frame and the last together. Source:
 * Galler and Fischer 1964; path halving, Tarjan and van Leeuwen 1984. */
#include "contact_groups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct pl_islands {
    const pl_scene *scene;
    int *now, *both; /* (body_count): parents; a root is its own, and the least of its set */
    double *sum;     /* (body_count): by root */
};

static void separate(int *parents, int count)
{
    for (int i = 0; i < count; ++i) {
        parents[i] = i;
    }
}

pl_islands *pl_islands_create(const pl_scene *scene)
{
    size_t count = (size_t)scene->body_count + 1;
    pl_islands *islands = calloc(1, sizeof *islands);
    if (islands == NULL) {
        return NULL;
    }
    islands->scene = scene;
    islands->now = calloc(count, sizeof *islands->now);
    islands->both = calloc(count, sizeof *islands->both);
    islands->sum = calloc(count, sizeof *islands->sum);
    if (islands->now == NULL || islands->both == NULL || islands->sum == NULL) {
        pl_islands_destroy(islands);
        return NULL;
    }
    separate(islands->now, scene->body_count);
    separate(islands->both, scene->body_count);
    return islands;
}

void pl_islands_destroy(pl_islands *islands)
{
    if (islands != NULL) {
        free(islands->now);
        free(islands->both);
        free(islands->sum);
        free(islands);
    }
}

static int root_of(int *parents, int body)
{
    while (parents[body] != body) {
        parents[body] = parents[parents[body]];
        body = parents[body];
    }
    return body;
}

static void unite(int *parents, int a, int b)
{
    int root_a = root_of(parents, a), root_b = root_of(parents, b);
    parents[root_a > root_b ? root_a : root_b] = root_a > root_b ? root_b : root_a;
}

void pl_islands_begin(pl_islands *islands)
{
    int count = islands->scene->body_count;
    memcpy(islands->both, islands->now, (size_t)count * sizeof *islands->both);
    separate(islands->now, count);
}

void pl_islands_join(pl_islands *islands, int a, int b)
{
    unite(islands->now, a, b);
    unite(islands->both, a, b);
}

double pl_islands_largest(pl_islands *islands, const double *growth)
{
    const pl_scene *scene = islands->scene;
    double largest = -HUGE_VAL;
    for (int i = 0; i < scene->body_count; ++i) {
        islands->sum[i] = 0;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            islands->sum[root_of(islands->both, i)] += growth[i];
        }
    }
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static && root_of(islands->both, i) == i) {
            largest = fmax(largest, isnan(islands->sum[i]) ? HUGE_VAL : islands->sum[i]);
        }
    }
    return largest > -HUGE_VAL ? largest : 0;
}
