/* The referee's broad phase and candidate pairs against all pairs by their gaps. */
#include "referee/geometry/candidate_pairs.h"
#include "referee/geometry/gap.h"

#include "check.h"
#include "polyhedra.h"
#include "synthetic_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CROWD = 120 };

/* How often each pair was seen, the lower index first. */
typedef struct tally {
    int seen[CROWD][CROWD];
    int pairs;
} tally;

static void count_pair(void *context, int a, int b)
{
    tally *t = context;
    assert_int_not_equal(a, b);
    t->seen[a < b ? a : b][a < b ? b : a] += 1;
    t->pairs += 1;
}

static void scatter(check_random *random, double position[3], double orientation[4])
{
    for (int k = 0; k < 3; ++k) {
        position[k] = check_uniform(random, -3, 3);
    }
    check_quaternion(random, orientation);
}

static pl_shape random_shape(pl_scene *scene, check_random *random, int which)
{
    double r = check_uniform(random, 0.1, 0.6);
    switch (which % 6) {
    case 0:
        return pl_shape_sphere(r);
    case 1:
        return pl_shape_box(r, 0.2, 0.4);
    case 2:
        return pl_shape_capsule(0.2, r);
    case 3:
        return pl_shape_cylinder(0.3, r);
    case 4:
        return pl_shape_of(random_hull(scene, random, 12));
    default:
        return pl_shape_of(torus_mesh(scene, 0.4, 0.15, 6, 4));
    }
}

/* Random shapes of all kinds, a fifth of them static, and two planes. The dynamic ones have random
 * poses in each frame. All pairs are checked by their gaps, in every other frame with random
 * margins. */
static void test_broad_phase_finds_every_touching_pair_once(void **state)
{
    (void)state;
    check_random random = {UINT64_C(1442695040888963407)};
    pl_scene scene = pl_scene_default();
    static pl_body_state bodies[CROWD];
    static tally t;
    for (int i = 0; i < CROWD; ++i) {
        pl_body body = pl_body_default();
        (void)snprintf(body.name, sizeof body.name, "body %d", i);
        body.shape = random_shape(&scene, &random, i);
        body.is_static = i % 5 == 0;
        if (i % 60 == 7) {
            body.shape = i < 60 ? pl_shape_plane(0, 0, 1, -2) : pl_shape_plane(0.6, 0, -0.8, -1);
            body.is_static = true;
        }
        scatter(&random, body.position, body.orientation);
        assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
        memcpy(bodies[i].position, body.position, sizeof body.position);
        memcpy(bodies[i].orientation, body.orientation, sizeof body.orientation);
    }
    pl_arena arena = {0};
    pl_broad_phase *broad_phase = pl_broad_phase_create(&scene, &arena);
    assert_non_null(broad_phase);
    long found = 0;
    for (int frame = 0; frame < 8; ++frame) {
        memset(&t, 0, sizeof t);
        double margin[CROWD] = {0};
        for (int i = 0; i < CROWD; ++i) {
            bool has_margin = frame % 2 == 1 && !scene.bodies[i].is_static;
            margin[i] = has_margin ? check_uniform(&random, 0, 0.3) : 0;
        }
        pl_broad_phase_follow(broad_phase, bodies, frame % 2 == 1 ? margin : NULL);
        pl_broad_phase_see(broad_phase, 0, pl_broad_phase_rows(broad_phase), count_pair, &t);
        for (int a = 0; a < CROWD; ++a) {
            for (int b = a + 1; b < CROWD; ++b) {
                assert_in_range(t.seen[a][b], 0, 1);
                assert_false(t.seen[a][b] != 0 && scene.bodies[a].is_static &&
                             scene.bodies[b].is_static);
                pl_placed_shape pa = {.shape = &scene.bodies[a].shape};
                pl_placed_shape pb = {.shape = &scene.bodies[b].shape};
                memcpy(pa.position, bodies[a].position, sizeof pa.position);
                memcpy(pb.position, bodies[b].position, sizeof pb.position);
                memcpy(pa.orientation, bodies[a].orientation, sizeof pa.orientation);
                memcpy(pb.orientation, bodies[b].orientation, sizeof pb.orientation);
                double gap = HUGE_VAL;
                bool may_touch = !(scene.bodies[a].is_static && scene.bodies[b].is_static);
                double within = margin[a] + margin[b];
                if (may_touch && pl_gap(&pa, &pb, within, &gap) == PL_OK && gap <= within &&
                    (gap <= 0 || pl_gap_convex(&pa, &pb, HUGE_VAL, &gap) == PL_UNSUPPORTED ||
                     gap <= within)) {
                    assert_int_equal(t.seen[a][b], 1);
                    found += 1;
                }
            }
        }
        for (int i = 0; i < CROWD; ++i) {
            if (!scene.bodies[i].is_static) {
                scatter(&random, bodies[i].position, bodies[i].orientation);
            }
        }
    }
    assert_true(found > 500);
    pl_arena_free(&arena);
    pl_scene_free(&scene);
}

/* Faces that touch exactly, as in every tower, must not be lost by rounding; what does not touch is
 * not seen. */
static void test_broad_phase_keeps_pairs_that_just_touch(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0.05), true, 0, 0);
    for (int i = 1; i < MOST_BODIES; ++i) {
        char name[PL_NAME_SIZE];
        (void)snprintf(name, sizeof name, "cube %d", i);
        run_add_body(&r, name, pl_shape_box(0.05, 0.05, 0.05), false, 0, 0.1 * i);
    }
    run_begin(&r);
    pl_arena arena = {0};
    pl_broad_phase *broad_phase = pl_broad_phase_create(&r.scene, &arena);
    assert_non_null(broad_phase);
    static tally t;
    pl_broad_phase_follow(broad_phase, r.state, NULL);
    pl_broad_phase_see(broad_phase, 0, pl_broad_phase_rows(broad_phase), count_pair, &t);
    for (int i = 0; i + 1 < MOST_BODIES; ++i) {
        assert_int_equal(t.seen[i][i + 1], 1);
    }
    assert_int_equal(t.pairs, MOST_BODIES - 1);
    pl_arena_free(&arena);
    run_end(&r);
}

/* ---- Many spheres ---- */

enum { MANY = 600, SIDE_MOST = 24 };

/* A scene of `count` spheres, and their states. */
typedef struct spheres {
    pl_scene scene;
    pl_body_state *states; /* (count) */
    int count;
    pl_arena arena;
} spheres;

/* Spheres at place(context, i). */
static spheres make_spheres(int count, double radius,
                            void (*place)(void *context, int i, double *x), void *context)
{
    spheres s = {.scene = pl_scene_default(), .count = count};
    s.states = calloc((size_t)count, sizeof *s.states);
    assert_non_null(s.states);
    for (int i = 0; i < count; ++i) {
        pl_body body = pl_body_default();
        (void)snprintf(body.name, sizeof body.name, "%d", i);
        body.shape = pl_shape_sphere(radius);
        place(context, i, body.position);
        assert_int_equal(pl_scene_add_body(&s.scene, &body, NULL, NULL), PL_OK);
        memcpy(s.states[i].position, body.position, sizeof body.position);
        s.states[i].orientation[0] = 1;
    }
    return s;
}

static void free_spheres(spheres *s)
{
    pl_arena_free(&s->arena);
    pl_scene_free(&s->scene);
    free(s->states);
}

static void place_in_slab(void *context, int i, double *x)
{
    (void)i;
    x[0] = check_uniform(context, -50, 50);
    x[1] = check_uniform(context, -40, 40);
    x[2] = check_uniform(context, 0, 2);
}

static bool touch(const spheres *s, int a, int b)
{
    double square = 0;
    for (int k = 0; k < 3; ++k) {
        const double d = s->states[a].position[k] - s->states[b].position[k];
        square += d * d;
    }
    return square <= 4 * s->scene.bodies[a].shape.radius * s->scene.bodies[b].shape.radius;
}

typedef struct wide_tally {
    unsigned char seen[MANY][MANY];
} wide_tally;

static void count_wide(void *context, int a, int b)
{
    wide_tally *t = context;
    t->seen[a < b ? a : b][a < b ? b : a] += 1;
}

/* There are more places for columns than the table has, so that some share one. */
static void test_broad_phase_finds_pairs_of_wide_scenes(void **state)
{
    (void)state;
    static wide_tally t;
    check_random random = {UINT64_C(88172645463325252)};
    spheres s = make_spheres(MANY, 1.5, place_in_slab, &random);
    pl_broad_phase *broad_phase = pl_broad_phase_create(&s.scene, &s.arena);
    assert_non_null(broad_phase);
    int touching = 0;
    for (int frame = 0; frame < 3; ++frame) {
        memset(&t, 0, sizeof t);
        pl_broad_phase_follow(broad_phase, s.states, NULL);
        pl_broad_phase_see(broad_phase, 0, pl_broad_phase_rows(broad_phase), count_wide, &t);
        for (int a = 0; a < MANY; ++a) {
            for (int b = a + 1; b < MANY; ++b) {
                assert_in_range(t.seen[a][b], touch(&s, a, b), 1);
                touching += touch(&s, a, b);
            }
            /* All in other places, and one far away. */
            place_in_slab(&random, a, s.states[a].position);
        }
        s.states[frame].position[1] = 1e9;
    }
    assert_true(touching > 500);
    free_spheres(&s);
}

static void place_in_lattice(void *context, int i, double *x)
{
    const int side = *(int *)context;
    x[0] = 0.25 * (i % side);
    x[1] = 0.25 * (i / side % side);
    x[2] = 0.25 * (i / side / side); /* NOLINT(bugprone-integer-division): a layer */
}

static void count_nothing(void *context, int a, int b)
{
    (void)context, (void)a, (void)b;
}

/* The boxes that are compared in a cubic lattice of spheres that nearly touch. */
static long cost_of_lattice(int side)
{
    spheres s = make_spheres(side * side * side, 0.1, place_in_lattice, &side);
    pl_broad_phase *broad_phase = pl_broad_phase_create(&s.scene, &s.arena);
    assert_non_null(broad_phase);
    pl_broad_phase_follow(broad_phase, s.states, NULL);
    const long cost =
        pl_broad_phase_see(broad_phase, 0, pl_broad_phase_rows(broad_phase), count_nothing, NULL);
    free_spheres(&s);
    return cost;
}

/* By one axis alone, the cost for a body would grow with the area of a layer: by 4 here. */
static void test_broad_phase_cost_for_a_body_is_bounded(void **state)
{
    (void)state;
    const int half = SIDE_MOST / 2;
    const long small = cost_of_lattice(half), large = cost_of_lattice(SIDE_MOST);
    assert_in_range(small, 1, 40 * half * half * half);
    assert_in_range(large, 8, 10 * small);
}

/* ---- Candidate pairs ---- */

static void place_in_heap(void *context, int i, double *x)
{
    (void)i;
    for (int k = 0; k < 3; ++k) {
        x[k] = check_uniform(context, 0, 0.5);
    }
}

/* The pairs in the order in which they are seen. */
typedef struct pair_list {
    pl_near_pair *pairs; /* (MANY x MANY) */
    int count;
} pair_list;

static void list_pair(void *context, const pl_near_pair *pair)
{
    pair_list *list = context;
    assert_true(list->count < MANY * MANY);
    list->pairs[list->count++] = *pair;
}

static void assert_same_pairs(const pair_list *a, const pair_list *b)
{
    assert_int_equal(a->count, b->count);
    for (int i = 0; i < a->count; ++i) {
        assert_int_equal(a->pairs[i].a, b->pairs[i].a);
        assert_int_equal(a->pairs[i].b, b->pairs[i].b);
        assert_memory_equal(&a->pairs[i].gap, &b->pairs[i].gap, sizeof(double));
    }
}

/* In the heap each sphere touches most of the others: far more pairs than a piece has room for. */
static void test_candidate_pairs_are_the_same_for_any_threads(void **state)
{
    (void)state;
    pair_list lists[3];
    check_random random = {UINT64_C(362436069)};
    spheres heap = make_spheres(MANY / 2, 0.3, place_in_heap, &random);
    spheres slab = make_spheres(MANY, 1.5, place_in_slab, &random);
    spheres *const both[] = {&heap, &slab};
    for (int k = 0; k < 2; ++k) {
        spheres *s = both[k];
        int touching = 0;
        for (int i = 0; i < 3; ++i) {
            lists[i] = (pair_list){.pairs = calloc((size_t)MANY * MANY, sizeof *lists[i].pairs)};
            assert_non_null(lists[i].pairs);
            pl_candidate_pairs *pairs = pl_candidate_pairs_create(&s->scene, &s->arena);
            assert_non_null(pairs);
            pl_candidate_pairs_find(pairs, s->states, 1 + i, NULL, NULL);
            pl_candidate_pairs_each(pairs, list_pair, &lists[i]);
        }
        assert_same_pairs(&lists[0], &lists[1]);
        assert_same_pairs(&lists[0], &lists[2]);
        for (int a = 0; a < s->count; ++a) {
            for (int b = a + 1; b < s->count; ++b) {
                touching += touch(s, a, b);
            }
        }
        for (int i = 0; i < lists[0].count; ++i) {
            touching -= lists[0].pairs[i].gap <= 0;
        }
        assert_int_equal(touching, 0);
        for (int i = 0; i < 3; ++i) {
            free(lists[i].pairs);
        }
        free_spheres(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_broad_phase_finds_every_touching_pair_once),
        cmocka_unit_test(test_broad_phase_keeps_pairs_that_just_touch),
        cmocka_unit_test(test_broad_phase_finds_pairs_of_wide_scenes),
        cmocka_unit_test(test_broad_phase_cost_for_a_body_is_bounded),
        cmocka_unit_test(test_candidate_pairs_are_the_same_for_any_threads),
    };
    return cmocka_run_group_tests_name("broad phase", tests, NULL, NULL);
}
