/* The referee's broad phase against all pairs by their gaps. */
#include "referee/geometry/candidate_pairs.h"
#include "referee/geometry/gap.h"

#include "check.h"
#include "polyhedra.h"
#include "synthetic_run.h"

#include <math.h>
#include <stdio.h>
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
            body.shape = pl_shape_plane(0, 0, 1, -2);
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
        pl_broad_phase_each_pair(broad_phase, bodies, frame % 2 == 1 ? margin : NULL, count_pair,
                                 &t);
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

/* Faces that touch exactly, as in every tower, must not be lost by rounding. */
static void test_broad_phase_keeps_pairs_that_just_touch(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    for (int i = 0; i < MOST_BODIES; ++i) {
        char name[PL_NAME_SIZE];
        (void)snprintf(name, sizeof name, "cube %d", i);
        run_add_body(&r, name, pl_shape_box(0.05, 0.05, 0.05), false, 0, 0.1 * i);
    }
    run_begin(&r);
    pl_arena arena = {0};
    pl_broad_phase *broad_phase = pl_broad_phase_create(&r.scene, &arena);
    assert_non_null(broad_phase);
    static tally t;
    pl_broad_phase_each_pair(broad_phase, r.state, NULL, count_pair, &t);
    for (int i = 0; i + 1 < MOST_BODIES; ++i) {
        assert_int_equal(t.seen[i][i + 1], 1);
    }
    assert_int_equal(t.pairs, MOST_BODIES - 1);
    pl_arena_free(&arena);
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_broad_phase_finds_every_touching_pair_once),
        cmocka_unit_test(test_broad_phase_keeps_pairs_that_just_touch),
    };
    return cmocka_run_group_tests_name("broad phase", tests, NULL, NULL);
}
