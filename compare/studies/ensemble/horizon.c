/* The spread of an ensemble over time, read from its members' position files. */
#include "horizon.h"

#include "plumb/jitter.h"
#include "referee/geometry/solid.h"
#include "runner/execute.h"
#include "runner/positions.h"

#include <stdlib.h>

static const double share_of_size = 0.01;

/* One member's open trajectory. */
typedef struct track {
    FILE *file;
    double *moved; /* (3 x bodies): the displacement from the start, as read */
    double *start; /* (3 x bodies) */
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

static void close_track(track *t)
{
    if (t->file != NULL) {
        fclose(t->file);
    }
    free(t->moved);
    free(t->start);
    free(t->place);
    *t = (track){.file = NULL};
}

/* `t->file` stays NULL where there is no trajectory. */
static pl_status open_track(const char *folder, const char *run, const pl_scene *scene, track *t,
                            pl_error *error)
{
    const size_t count = 3 * (size_t)pl_positions_bodies(scene) + 1;
    char *path = pl_positions_path(folder, run);
    t->moved = calloc(count, sizeof *t->moved);
    t->start = calloc(count, sizeof *t->start);
    t->place = calloc(count, sizeof *t->place);
    if (path == NULL || t->moved == NULL || t->start == NULL || t->place == NULL) {
        free(path);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for a trajectory");
    }
    t->file = pl_positions_open(path, scene, 0);
    store_starts(scene, t->start);
    free(path);
    return PL_OK;
}

static bool read_sample(track *t, int bodies)
{
    if (!pl_positions_read(t->file, bodies, t->moved)) {
        return false;
    }
    for (int i = 0; i < 3 * bodies; ++i) {
        t->place[i] = t->start[i] + t->moved[i];
    }
    return true;
}

/* Reads all tracks in step, to the end of the shortest. */
static void follow(track *tracks, const double **places, int members, const pl_scene *scene,
                   pl_horizon *horizon)
{
    const int bodies = pl_positions_bodies(scene);
    const double interval = (double)pl_positions_stride(scene->dt) * scene->dt;
    horizon->threshold = share_of_size * pl_scene_least_size(scene);
    horizon->time = (double)INFINITY;
    for (long sample = 0;; ++sample) {
        for (int k = 0; k < members; ++k) {
            if (!read_sample(&tracks[k], bodies)) {
                return;
            }
            places[k] = tracks[k].place;
        }
        horizon->known = true;
        horizon->last_time = (double)sample * interval;
        horizon->last_spread = pl_ensemble_spread(places, members, bodies);
        if (isinf(horizon->time) && !(horizon->last_spread <= horizon->threshold)) {
            horizon->time = horizon->last_time;
        }
    }
}

pl_status pl_horizon_find(const pl_plan *plan, const pl_ensemble *ensemble, int members,
                          const char *folder, pl_horizon *horizon, pl_error *error)
{
    *horizon = (pl_horizon){.known = false};
    track *tracks = calloc((size_t)members, sizeof *tracks);
    const double **places = calloc((size_t)members, sizeof *places);
    pl_status status = tracks == NULL || places == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory for %d members", members)
                           : PL_OK;
    int open = 0;
    for (int k = 0; k < members && status == PL_OK; ++k) {
        char run[17];
        pl_member_run(plan, ensemble, k, run);
        status = open_track(folder, run, &plan->cases[ensemble->cases[k]].scene, &tracks[k], error);
        open += tracks[k].file != NULL;
    }
    if (status == PL_OK && open == members) {
        follow(tracks, places, members, &plan->cases[ensemble->cases[0]].scene, horizon);
    }
    if (!horizon->known) {
        snprintf(horizon->reason, sizeof horizon->reason,
                 "%d of %d members left a trajectory, and of some there is no frame", open,
                 members);
    }
    for (int k = 0; k < members && tracks != NULL; ++k) {
        close_track(&tracks[k]);
    }
    free(tracks);
    free(places);
    return status;
}
