/* A tower that sinks into itself, or leans, may take its upper cubes far from their places while
 * every cube still stands on the one below. It has not collapsed. So what counts is how far two
 * bodies that touch in the reference have moved against each other: the change of the place of one
 * in the frame of the other. Of the two frames the one that sees less counts, because a body that
 * rolls on the spot moves everything in its own frame. */
#include "expectations.h"

#include "plumb/vec.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Of the speed of a fall by the collapse distance: what is slower stands, and creeps. */
static const double FALLING_SPEED = 0.05;

typedef struct standing {
    const pl_scene *scene;
    pl_body_state *rest; /* (body_count): the poses of the reference */
    bool *has_neighbour; /* (body_count): touches another body in the reference */
    const pl_body_state *last;
    double *shift; /* (body_count): the largest shift against a body that it should touch, m */
    double worst;  /* the largest shift of all */
} standing;

static standing create(const pl_scene *scene, const pl_body_state *last, pl_arena *arena)
{
    const size_t count = (size_t)scene->body_count;
    standing s = {.scene = scene,
                  .last = last,
                  .rest = pl_arena_take(arena, count, sizeof *s.rest),
                  .has_neighbour = pl_arena_take(arena, count, sizeof *s.has_neighbour),
                  .shift = pl_arena_take(arena, count, sizeof *s.shift)};
    for (size_t i = 0; i < count; ++i) {
        const pl_body *body = &scene->bodies[i];
        memcpy(s.rest[i].position, body->position, sizeof body->position);
        memcpy(s.rest[i].orientation, body->orientation, sizeof body->orientation);
    }
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        memcpy(s.rest[rest->body].position, rest->position, sizeof rest->position);
        if (rest->has_orientation) {
            memcpy(s.rest[rest->body].orientation, rest->orientation, sizeof rest->orientation);
        }
    }
    return s;
}

/* The place of one body in the frame of another, m. */
static pl_vec place_in(const pl_body_state *frame, const pl_body_state *body)
{
    const pl_axes axes = pl_axes_of(frame->orientation);
    return pl_to_local(&axes, pl_vec_sub(pl_vec_of(body->position), pl_vec_of(frame->position)));
}

/* How far `body` has moved in the frame of `of`, m. */
static double shift_in(const standing *s, int of, int body)
{
    const bool fixed = s->scene->bodies[of].is_static;
    const pl_body_state *frame = fixed ? &s->rest[of] : &s->last[of];
    return pl_vec_length(
        pl_vec_sub(place_in(frame, &s->last[body]), place_in(&s->rest[of], &s->rest[body])));
}

/* Nothing moves in the reference, so that bodies meet there if they touch. */
static void see_pair(void *context, const pl_near_pair *pair)
{
    standing *s = context;
    const pl_body *a = &s->scene->bodies[pair->a], *b = &s->scene->bodies[pair->b];
    const double in_a = a->is_static || !b->is_static ? shift_in(s, pair->a, pair->b) : HUGE_VAL;
    const double in_b = b->is_static || !a->is_static ? shift_in(s, pair->b, pair->a) : HUGE_VAL;
    const double shift = fmin(in_a, in_b);
    s->has_neighbour[pair->a] = s->has_neighbour[pair->b] = true;
    s->shift[pair->a] = fmax(s->shift[pair->a], shift);
    s->shift[pair->b] = fmax(s->shift[pair->b], shift);
    s->worst = fmax(s->worst, shift);
}

/* Whether something of the scene falls: a body that is far from its rest and fast, or alone. */
static bool falls(const standing *s)
{
    const double far = s->scene->collapse_distance;
    const double fast = FALLING_SPEED * sqrt(2 * pl_vec_length(pl_vec_of(s->scene->gravity)) * far);
    for (int i = 0; i < s->scene->rest_count; ++i) {
        const int body = s->scene->rests[i].body;
        const double distance = pl_vec_length(
            pl_vec_sub(pl_vec_of(s->last[body].position), pl_vec_of(s->rest[body].position)));
        const double speed = pl_vec_length(pl_vec_of(s->last[body].velocity));
        if (distance > far && (!s->has_neighbour[body] || speed > fast)) {
            return true;
        }
    }
    return false;
}

/* How far a body may be from its rest until a user sees it, m. */
static double visible(const pl_scene *scene)
{
    const bool judged = strcmp(scene->primary_error, "rest_position_error") == 0;
    return judged ? fmin(scene->acceptance, scene->collapse_distance) : scene->collapse_distance;
}

/* Says how `body` has moved by `distance`, m. A body that has moved by more than its size against its
 * support does not stand on it. */
static void describe(const standing *s, int body, double distance, pl_note *note)
{
    const pl_vec gravity = pl_vec_of(s->scene->gravity);
    const double g = pl_vec_length(gravity);
    const pl_vec moved =
        pl_vec_sub(pl_vec_of(s->last[body].position), pl_vec_of(s->rest[body].position));
    const double sunk = g > 0 ? pl_vec_dot(moved, gravity) / g : 0;
    const char *how = "has moved", *where = "away";
    const char *name = s->scene->bodies[body].name;
    if (s->shift[body] > 2 * pl_bounding_radius(&s->scene->bodies[body].shape)) {
        snprintf(note->text, sizeof note->text,
                 "has left its place: body \"%.100s\" ended %.3g m away", name, distance);
        return;
    }
    if (fabs(sunk) > 0.7 * distance) {
        how = sunk > 0 ? "is squashed" : "is lifted";
        where = sunk > 0 ? "too low" : "too high";
    } else if (s->shift[body] < 0.5 * distance) {
        how = "leans";
        where = "aside";
    }
    snprintf(note->text, sizeof note->text, "stands, but %s: body \"%.100s\" ended %.3g m %s", how,
             name, distance, where);
}

pl_ending pl_standing_judge(const pl_scene *scene, pl_candidate_pairs *pairs,
                            const pl_body_state *last, pl_note *note, pl_error *error)
{
    double distance = 0;
    const int farthest = pl_farthest_from_rest(scene, last, &distance);
    pl_ending ending = PL_ENDING_OK;
    note->text[0] = '\0';
    if (farthest < 0 || !(distance > visible(scene))) {
        return ending;
    }
    const int body = scene->rests[farthest].body;
    pl_arena arena = {0};
    standing s = create(scene, last, &arena);
    pl_candidate_pairs_find(pairs, s.rest, 1, NULL, NULL);
    pl_candidate_pairs_each(pairs, see_pair, &s);
    if (distance > scene->collapse_distance && (s.worst > scene->collapse_distance || falls(&s))) {
        (void)pl_fail(error, PL_FAILED,
                      "body \"%s\" ended %.3g m from its reference, beyond %.3g m",
                      scene->bodies[body].name, distance, scene->collapse_distance);
        ending = PL_ENDING_COLLAPSED;
    } else {
        describe(&s, body, distance, note);
    }
    pl_arena_free(&arena);
    return ending;
}
