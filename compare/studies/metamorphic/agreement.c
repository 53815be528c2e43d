/* Reads trajectories and compares them frame by frame. */
#include "metamorphic.h"

#include "base/heap.h"
#include "plumb/vec.h"
#include "results/result.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

pl_status pl_trajectory_open(pl_trajectory *trajectory, pl_error *error)
{
    *trajectory = (pl_trajectory){.file = tmpfile()};
    return trajectory->file == NULL
               ? pl_fail(error, PL_IO, "no temporary file for a trajectory: %s", strerror(errno))
               : PL_OK;
}

void pl_trajectory_close(pl_trajectory *trajectory)
{
    if (trajectory->file != NULL) {
        fclose(trajectory->file);
    }
    free(trajectory->frame.bodies);
    free(trajectory->line);
    *trajectory = (pl_trajectory){.file = NULL};
}

void pl_trajectory_rewind(pl_trajectory *trajectory, int body_count)
{
    pl_trajectory *t = trajectory;
    free(t->frame.bodies);
    t->frame = (pl_frame){.body_count = body_count,
                          .bodies = pl_heap_new((size_t)body_count + 1, sizeof *t->frame.bodies)};
    rewind(t->file);
    /* The header. */
    (void)!getline(&t->line, &t->capacity, t->file);
}

/* Reads a line: the time, the name of the body in quotes, and the numbers of its state. */
static bool read_line(pl_trajectory *t, pl_body_state *body)
{
    double *x = body->position, *q = body->orientation, *v = body->velocity,
           *w = body->angular_velocity;
    char end = '\0';
    if (getline(&t->line, &t->capacity, t->file) < 0) {
        return false;
    }
    t->frame.time = strtod(t->line, NULL);
    const char *numbers = strrchr(t->line, '"');
    return numbers != NULL &&
           sscanf(numbers, "\",%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf%c", &x[0], &x[1],
                  &x[2], &q[0], &q[1], &q[2], &q[3], &v[0], &v[1], &v[2], &w[0], &w[1], &w[2],
                  &end) == 14 &&
           end == '\n';
}

bool pl_trajectory_next(pl_trajectory *trajectory)
{
    bool whole = true;
    for (int i = 0; i < trajectory->frame.body_count && whole; ++i) {
        whole = read_line(trajectory, &trajectory->frame.bodies[i]);
    }
    return whole;
}

static const double EXACT = 1e-9, CLOSE = 1e-3, PASSES = 1e-6;

/* The largest difference over the dynamic bodies at one time. */
typedef struct difference {
    double position; /* over the size of the scene; 1 */
    double rotation; /* rad */
    bool same;       /* bitwise, up to that time */
} difference;

static json_t *difference_json(const difference *d)
{
    const double most = fmax(d->position, d->rotation);
    return json_pack("{s:o, s:o, s:s}", "position", pl_json_number_or_null(d->position), "rotation",
                     pl_json_number_or_null(d->rotation), "verdict",
                     d->same         ? "bitwise"
                     : most <= EXACT ? "exact"
                     : most <= CLOSE ? "close"
                                     : "differs");
}

static bool same_numbers(const double *a, const double *b, int count, double sign)
{
    bool same = true;
    for (int i = 0; i < count; ++i) {
        same = same && a[i] == sign * b[i];
    }
    return same;
}

static void compare_body(const pl_body_state *a, const pl_body_state *b, difference *d)
{
    double off = pl_vec_length(pl_vec_sub(pl_vec_of(a->position), pl_vec_of(b->position)));
    double turned = pl_angle_between(a->orientation, b->orientation);
    d->position = fmax(d->position, isnan(off) ? HUGE_VAL : off);
    d->rotation = fmax(d->rotation, isnan(turned) ? HUGE_VAL : turned);
    d->same = d->same && same_numbers(a->position, b->position, 3, 1) &&
              (same_numbers(a->orientation, b->orientation, 4, 1) ||
               same_numbers(a->orientation, b->orientation, 4, -1));
}

/* Goes to the next frame of the plain run, at the time of the other's next frame. A later frame lies
 * between two frames of the plain run. The second of them is read here; states[0 .. n) keeps it for the
 * next call, and states[n .. 2 n) has the first, for n bodies. */
static bool next_plain(const pl_trajectory_pair *c, bool is_first, pl_body_state *states)
{
    const int count = c->scene->body_count;
    const size_t size = (size_t)count * sizeof *states;
    pl_body_state *frame = c->plain->frame.bodies;
    if (c->later == 0) {
        return pl_trajectory_next(c->plain);
    }
    if (is_first && !pl_trajectory_next(c->plain)) {
        return false;
    }
    memcpy(states + count, is_first ? frame : states, size);
    if (!pl_trajectory_next(c->plain)) {
        return false;
    }
    memcpy(states, frame, size);
    for (int i = 0; i < count; ++i) {
        if (!c->scene->bodies[i].is_static) {
            pl_state_between(&c->scene->bodies[i], &states[count + i], &states[i], c->scene->dt,
                             c->later, &frame[i]);
        }
    }
    return true;
}

/* Compares the current frames of both runs. */
static difference compare_frames(const pl_trajectory_pair *c)
{
    difference d = {.same = true};
    for (int i = 0; i < c->scene->body_count; ++i) {
        if (!c->scene->bodies[i].is_static) {
            pl_body_state back;
            int index = pl_transform_index(c->transform, i, c->scene->body_count);
            pl_transform_state_back(c->transform, &c->other->frame.bodies[index], &back);
            compare_body(&c->plain->frame.bodies[i], &back, &d);
        }
    }
    d.position /= c->size;
    return d;
}

json_t *pl_agreement_of(const pl_trajectory_pair *comparison)
{
    const pl_trajectory_pair *c = comparison;
    const long last = pl_scene_steps(c->scene) - c->first - (c->later > 0);
    const long early = last < 10 ? 1 : last / 10;
    bool same = true;
    double passes_at = (double)NAN;
    json_t *agreement = json_object();
    pl_trajectory_rewind(c->plain, c->scene->body_count);
    pl_trajectory_rewind(c->other, c->other_body_count);
    pl_body_state *states = pl_heap_new(2 * (size_t)c->scene->body_count + 1, sizeof *states);
    for (long i = 0; i < c->first; ++i) {
        pl_trajectory_next(c->plain);
    }
    for (long i = 0; i <= last; ++i) {
        if (!next_plain(c, i == 0, states) || !pl_trajectory_next(c->other)) {
            json_object_clear(agreement);
            json_object_set_new(agreement, "reason",
                                json_sprintf("%ld of %ld frames to compare", i, last + 1));
            break;
        }
        difference now = compare_frames(c);
        same = same && now.same;
        now.same = same;
        if (isnan(passes_at) && !(now.position <= PASSES)) {
            passes_at = c->plain->frame.time;
        }
        if (i == early) {
            json_object_set_new(agreement, "early", difference_json(&now));
        }
        if (i == last) {
            json_object_set_new(agreement, "end", difference_json(&now));
            json_object_set_new(agreement, "passes_at", pl_json_number_or_null(passes_at));
        }
    }
    free(states);
    return agreement;
}
