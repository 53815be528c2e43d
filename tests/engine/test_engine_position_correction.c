/* Position correction. */
#include "check.h"
#include "random_pose.h"
#include "step/step.h"
#include "world_for_tests.h"

#include <stdlib.h>
#include <string.h>

static const double H = 1.0 / 60;

/* ---- Scenes ---- */

static pe_world *make_weightless_world(void)
{
    pe_world_def def = pe_world_def_default();
    def.gravity = pe_v3(0, 0, 0);
    return make_world(&def);
}

/* The contacts at the poses now. */
static void find(pe_world *world)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    pe_arena_reset(&world->arena, &world->allocator);
    assert_int_equal(pe_contacts_update(world, &rules, NULL, H, NULL), PE_OK);
}

/* (slots): bodies that the last correction moved. */
static const bool *corrected;

static pe_correction_report correct_found(pe_world *world, const pe_correction_rules *rules)
{
    pe_correction_report report;
    pe_step step = {.world = world, .dt = H, .rules = pe_contact_rules_exact()};
    step.corrected = pe_scratch_zero(world, (size_t)world->slot_count, sizeof *step.corrected);
    assert_non_null(step.corrected);
    corrected = step.corrected;
    assert_int_equal(pe_correct_positions(&step, rules, &report), PE_OK);
    return report;
}

static pe_correction_report correct_by(pe_world *world, const pe_correction_rules *rules)
{
    find(world);
    return correct_found(world, rules);
}

static pe_correction_report correct(pe_world *world)
{
    pe_correction_rules rules = pe_correction_rules_default();
    return correct_by(world, &rules);
}

static double depth_of(const pe_world *world)
{
    double depth = 0;
    for (int j = 0; j < world->contacts.point_count; ++j) {
        depth = pe_max(depth, -pe_manifold_points(&world->contacts)[j].separation);
    }
    return depth;
}

/* Of depths below the aim. */
static double squares_of(const pe_world *world, double aim)
{
    double sum = 0;
    for (int j = 0; j < world->contacts.point_count; ++j) {
        double over = pe_max(-pe_manifold_points(&world->contacts)[j].separation - aim, 0);
        sum += over * over;
    }
    return sum;
}

static pe_vec3 centre_of_mass(const pe_world *world)
{
    pe_vec3 sum = {0};
    double mass = 0;
    for (int slot = 1; slot < world->slot_count; ++slot) {
        double m = pe_masses(world)[slot].mass;
        sum = pe_madd(sum, m, pe_poses(world)[slot].position);
        mass += m;
    }
    return pe_scale(1 / mass, sum);
}

/* Angular momentum of all bodies about their own centres. */
static pe_vec3 spin_of(const pe_world *world)
{
    pe_vec3 sum = {0};
    for (int slot = 1; slot < world->slot_count; ++slot) {
        const pe_mat3 *r = &pe_poses(world)[slot].rotation;
        pe_vec3 w = pe_unrotate(r, pe_twists(world)[slot].angular_velocity);
        sum = pe_add(sum, pe_rotate(r, pe_mul(pe_masses(world)[slot].inertia, w)));
    }
    return sum;
}

/* Boxes and spheres that overlap, in motion. */
static void add_heap(pe_world *world, check_random *random, int count, double reach)
{
    for (int i = 0; i < count; ++i) {
        pe_body_def def = box_def(0.4, 0.3, 0.5, random_vector(random, reach));
        if (i % 2 == 0) {
            def.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.4};
        }
        double q[4];
        check_quaternion(random, q);
        def.mass = check_uniform(random, 0.5, 3);
        def.orientation = (pe_quat){q[0], q[1], q[2], q[3]};
        def.velocity = random_vector(random, 1);
        def.angular_velocity = random_vector(random, 1);
        add_body(world, &def);
    }
}

/* ---- Correction ---- */

static void test_overlapping_boxes_separate_in_mass_ratio(void **state)
{
    (void)state;
    pe_world *world = make_weightless_world();
    pe_body_def a = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0));
    pe_body_def b = box_def(0.5, 0.5, 0.5, pe_v3(0.99, 0, 0));
    b.mass = 3;
    pe_body_id one = add_body(world, &a), other = add_body(world, &b);
    pe_correction_rules rules = pe_correction_rules_default();
    pe_correction_report report = correct_by(world, &rules);
    assert_close(report.penetration, 0.01, 1e-12, 0);
    double parted = 0.01 - rules.aim, within = rules.enough;
    double x = state_of(world, one).position.x, y = state_of(world, other).position.x;
    assert_close(y - x, 0.99 + parted, within, 0);
    assert_close(-x, 3 * (y - 0.99), 1e-12, 0);
    assert_close(report.penetration_left, depth_of(world), 0, 0);
    pe_world_destroy(world);
}

static void test_what_is_shallow_stays_to_the_bit(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_correction_rules rules = pe_correction_rules_default();
    pe_material_id rough = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), rough);
    pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0.5 - 0.99 * rules.begin));
    pe_body_id box = add_body(world, &def);
    pe_body_state before = state_of(world, box);
    pe_correction_report report = correct_by(world, &rules);
    pe_body_state after = state_of(world, box);
    assert_memory_equal(&before, &after, sizeof before);
    assert_int_equal(report.rounds, 0);
    assert_false(corrected[box.index]);
    assert_close(report.penetration_left, 0.99 * rules.begin, 1e-12, 0);
    pe_world_destroy(world);
}

static void test_sunk_box_is_moved_out_of_ground(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_correction_rules rules = pe_correction_rules_default();
    add_plane(world, pe_v3(0, 0, 1), add_material(world, 0.5, 0));
    pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0.48));
    pe_body_id box = add_body(world, &def);
    correct_by(world, &rules);
    pe_body_state s = state_of(world, box);
    assert_close(s.position.z, 0.5 - rules.aim, rules.enough, 0);
    assert_close(s.position.x, 0, 1e-12, 0);
    assert_close(s.orientation.w, 1, 1e-12, 0);
    assert_close(s.velocity.z, 0, 0, 0);
    pe_world_destroy(world);
}

/* A push goes through a row of touching cubes: each cube pushes the next one. */
static void test_a_push_reaches_the_end_of_a_row(void **state)
{
    (void)state;
    enum { ROW = 8 };
    pe_world *world = make_weightless_world();
    pe_correction_rules rules = pe_correction_rules_default();
    pe_body_id ids[ROW];
    add_plane(world, pe_v3(1, 0, 0), add_material(world, 0.5, 0));
    for (int i = 0; i < ROW; ++i) {
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(0.5 + i - 0.005, 0, 0));
        ids[i] = add_body(world, &def);
    }
    correct_by(world, &rules);
    for (int i = 0; i < ROW; ++i) { /* each may be left as deep as the rules say */
        double x = state_of(world, ids[i]).position.x;
        assert_at_most(0.5 + i - (i + 1) * rules.begin, x);
    }
    assert_at_most(depth_of(world), rules.begin);
    pe_world_destroy(world);
}

static void test_untouched_bodies_stay_unchanged_exactly(void **state)
{
    (void)state;
    pe_world *world = make_weightless_world();
    pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0));
    pe_body_id a = add_body(world, &def);
    def.position.x = 1 - 6e-4;
    add_body(world, &def);
    def.position.x = 2; /* 6e-4 from its neighbour, which moves by less */
    pe_body_id c = add_body(world, &def);
    pe_body_state far = state_of(world, c), pushed = state_of(world, a);
    correct(world);
    pe_body_state now = state_of(world, c);
    assert_memory_equal(&far, &now, sizeof far);
    assert_false(corrected[c.index]);
    assert_true(corrected[a.index]);
    now = state_of(world, a);
    assert_true(now.position.x < pushed.position.x);
    pe_world_destroy(world);
}

static void test_heap_correction_keeps_mass_centre_and_momenta(void **state)
{
    (void)state;
    int mended = 0;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        check_random random = {seed};
        pe_world *world = make_weightless_world();
        pe_correction_rules rules = pe_correction_rules_default();
        rules.max_rounds = 1 + (int)(seed % 8);
        add_heap(world, &random, 24, seed % 2 ? 1.2 : 0.5);
        find(world);
        double before = squares_of(world, rules.aim);
        pe_vec3 spin = spin_of(world);
        double depth = depth_of(world);
        pe_vec3 centre = centre_of_mass(world);
        pe_correction_report report = correct_found(world, &rules);
        double after = squares_of(world, rules.aim);
        assert_at_most(after, before);
        assert_close(report.penetration, depth, 0, 0);
        assert_close(report.penetration_left, depth_of(world), 0, 0);
        assert_true(report.rounds <= rules.max_rounds);
        assert_at_most(pe_length(pe_sub(centre_of_mass(world), centre)), 1e-12);
        assert_at_most(pe_length(pe_sub(spin_of(world), spin)), 1e-12);
        for (int i = 0; i < 6; ++i) { /* a step moves bodies by a part of their size */
            correct_by(world, &rules);
        }
        mended += squares_of(world, rules.aim) < 0.5 * before;
        pe_world_destroy(world);
    }
    assert_true(mended > 10);
}

static void test_contacts_afterwards_are_those_of_the_final_poses(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        check_random random = {seed};
        pe_world *world = make_weightless_world();
        add_heap(world, &random, 20, 1.2);
        correct(world);
        int manifolds = world->contacts.manifold_count, points = world->contacts.point_count;
        double *gaps = malloc(sizeof *gaps * (size_t)points);
        for (int j = 0; j < points; ++j) {
            gaps[j] = pe_manifold_points(&world->contacts)[j].separation;
        }
        find(world);
        assert_int_equal(world->contacts.manifold_count, manifolds);
        assert_int_equal(world->contacts.point_count, points);
        for (int j = 0; j < points; ++j) {
            assert_close(pe_manifold_points(&world->contacts)[j].separation, gaps[j], 1e-12, 0);
        }
        free(gaps);
        pe_world_destroy(world);
    }
}

static void test_any_solver_may_take_the_place_of_sweeps(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_material_id rough = add_material(world, 0.5, 0);
    add_plane(world, pe_v3(0, 0, 1), rough);
    for (int i = 0; i < 4; ++i) {
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0.5 + i - 0.003 * (i + 1)));
        add_body(world, &def);
    }
    pe_correction_rules rules = pe_correction_rules_default();
    rules.solver = pe_solve_gauss_seidel;
    rules.solver_limits = (pe_solve_limits){1e-9, 20000};
    pe_correction_report report = correct_by(world, &rules);
    assert_int_equal(report.rounds, 1);
    for (int i = 0; i < 4; ++i) {
        double z = pe_poses(world)[2 + i].position.z;
        assert_close(z, 0.5 + i - (i + 1) * rules.aim, 1e-8, 0);
    }
    pe_world_destroy(world);
}

/* Flops that `spend` has made, and how often it was called. */
static double spent;
static int solves;

/* A solver that gains nothing, and takes as many flops as it may. */
static pe_status spend(const pe_problem *problem, const pe_solve_limits *limits, pe_workspace work,
                       pe_solve_report *report, pe_error *error)
{
    (void)problem;
    (void)limits;
    (void)work;
    (void)error;
    assert_true(report->most_flops > 0);
    const double begun = report->factor_flops;
    while (pe_solve_may_factor(report, 1e9)) {
        report->factor_flops += 1e9;
    }
    spent += report->factor_flops - begun;
    solves += 1;
    return PE_OK;
}

static void test_flops_of_all_islands_are_bounded_together(void **state)
{
    (void)state;
    pe_world *world = make_weightless_world();
    for (int i = 0; i < 10; ++i) { /* five overlapping pairs */
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(i / 2 * 10 + i % 2 * 0.999, 0, 0));
        add_body(world, &def);
    }
    pe_correction_rules rules = pe_correction_rules_default();
    rules.solver = spend;
    pe_correction_report report = correct_by(world, &rules);
    assert_at_most(report.penetration_left, rules.begin); /* by sweeps */
    assert_true(solves >= 5);
    assert_in_range((int)(spent / 1e9), 1, 5);
    pe_world_destroy(world);
}

static void test_only_flagged_islands_are_corrected(void **state)
{
    (void)state;
    pe_world *world = make_weightless_world();
    pe_body_id ids[4];
    for (int i = 0; i < 4; ++i) { /* two overlapping pairs */
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(i / 2 * 10 + i % 2 * 0.999, 0, 0));
        ids[i] = add_body(world, &def);
    }
    bool flags[8] = {0};
    flags[ids[2].index] = flags[ids[3].index] = true;
    pe_correction_rules rules = pe_correction_rules_default();
    rules.among = flags;
    pe_correction_report report = correct_by(world, &rules);
    assert_false(corrected[ids[0].index] || corrected[ids[1].index]);
    assert_true(corrected[ids[2].index] && corrected[ids[3].index]);
    assert_at_most(report.penetration_left, rules.aim + rules.enough);
    pe_world_destroy(world);
}

/* A row whose first body is flagged, and whose other two overlap: with or without an overlap
 * elsewhere. */
static void test_excluded_bodies_stay_during_projection(void **state)
{
    (void)state;
    for (int elsewhere = 0; elsewhere < 2; ++elsewhere) {
        static const double x[] = {0, 1, 1.999, 10, 11};
        pe_world *world = make_weightless_world();
        pe_body_id ids[5];
        for (int i = 0; i < 5; ++i) {
            double overlap = i == 4 && elsewhere ? 1e-3 : 0;
            pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(x[i] - overlap, 0, 0));
            ids[i] = add_body(world, &def);
        }
        bool flags[8] = {0};
        flags[ids[0].index] = flags[ids[3].index] = flags[ids[4].index] = true;
        pe_correction_rules rules = pe_correction_rules_default();
        rules.among = flags;
        pe_correction_report report = correct_by(world, &rules);
        assert_int_equal(report.rounds > 0, elsewhere);
        for (int i = 0; i < 3; ++i) {
            assert_close(pe_poses(world)[ids[i].index].position.x, x[i], 0, 0);
        }
        pe_world_destroy(world);
    }
}

/* ---- Overlap ---- */

static pe_world *make_weightless_world_of(pe_profile profile)
{
    pe_world_def def = pe_world_def_default();
    def.gravity = pe_v3(0, 0, 0);
    def.profile = profile;
    return make_world(&def);
}

static void test_deep_overlap_is_parted_over_several_steps(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_ACCURATE; ++profile) {
        pe_world *world = make_weightless_world_of((pe_profile)profile);
        pe_body_def a = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0));
        pe_body_def b = box_def(0.5, 0.5, 0.5, pe_v3(0.2, 0, 0));
        b.mass = 3;
        pe_body_id one = add_body(world, &a), other = add_body(world, &b);
        double x = 0;
        for (int i = 0; i < 8; ++i) {
            pe_step_stats stats = step(world, H);
            double now = state_of(world, one).position.x;
            assert_at_most(x - now, 0.2 + 1e-12);
            assert_true(now < x || stats.overlapping == 0);
            assert_int_equal(stats.unparted, 0);
            x = now;
        }
        assert_int_equal(step(world, H).overlapping, 0);
        assert_at_most(depth_of(world), 1e-3);
        assert_close(-x, 3 * (state_of(world, other).position.x - 0.2), 1e-12, 0);
        pe_world_destroy(world);
    }
}

/* Its top has to be lifted by 1.5 of its side. */
static void test_an_overlapping_tower_is_lifted_upright(void **state)
{
    (void)state;
    enum { HIGH = 30 };
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_ACCURATE; ++profile) {
        pe_body_id ids[HIGH];
        pe_world_def def = pe_world_def_default();
        def.profile = (pe_profile)profile;
        pe_world *world = make_world(&def);
        add_tower(world, HIGH, add_material(world, 0.5, 0), ids);
        for (int i = 0; i < HIGH; ++i) {
            pe_body_state s = state_of(world, ids[i]);
            s.position.z -= 0.05 * (i + 1);
            assert_int_equal(pe_body_set_state(world, ids[i], &s, NULL), PE_OK);
        }
        for (int i = 0; i < 30; ++i) {
            step(world, H);
        }
        for (int i = 0; i < HIGH; ++i) {
            pe_vec3 x = state_of(world, ids[i]).position;
            assert_at_most(pe_length(pe_sub(x, pe_v3(0, 0, i + 0.5))), 1e-6);
        }
        pe_world_destroy(world);
    }
}

/* A ball of diameter 1 in a gap of 0.6, in which nothing can part it from both planes. */
static void test_a_body_that_cannot_be_parted_stays(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_ACCURATE; ++profile) {
        pe_world *world = make_weightless_world_of((pe_profile)profile);
        pe_material_id material = add_material(world, 0.5, 0);
        add_plane(world, pe_v3(0, 0, 1), material);
        pe_body_def ceiling = pe_body_def_default(), ball = ceiling;
        double tilt = 1e-4;
        ceiling.is_static = true;
        ceiling.shape = (pe_shape){.kind = PE_SHAPE_PLANE,
                                   .normal = {sin(tilt), 0, -cos(tilt)},
                                   .offset = -0.6 * cos(tilt)};
        add_body(world, &ceiling);
        ball.position.z = 0.35;
        pe_body_id id = add_body(world, &ball);
        int tried = 0, counted = 0;
        for (int i = 0; i < 100; ++i) {
            pe_step_stats stats = step(world, H);
            tried += stats.projection_iterations > 0;
            counted += stats.unparted == 1 && stats.overlapping == 1;
        }
        assert_true(counted > 80);
        assert_true(tried < 30);
        pe_vec3 x = state_of(world, id).position;
        assert_at_most(fabs(x.x), 1);
        assert_close(x.z, 0.3, 0.06, 0);
        pe_world_destroy(world);
    }
}

/* ---- Swept islands in a step ---- */

static const double SLOP = 1e-3;

/* A tower that stood for a step, and then is pressed together by `overlap` at every contact and
 * drops: it moves too much, and may use too few updates, to be solved directly. The deepest
 * penetration, in m, that a step leaves. */
static double pressed_tower_depth(pe_profile profile, int count, double overlap)
{
    pe_body_id ids[32];
    pe_world_def def = pe_world_def_default();
    def.profile = profile;
    def.max_contact_updates = 1;
    def.penetration_slop = SLOP;
    pe_world *world = make_world(&def);
    add_tower(world, count, add_material(world, 0.5, 0), ids);
    step(world, H);
    for (int i = 0; i < count; ++i) {
        pe_body_state s = state_of(world, ids[i]);
        s.position.z = 0.5 + i - (i + 1) * overlap;
        s.velocity.z = -0.01;
        assert_int_equal(pe_body_set_state(world, ids[i], &s, NULL), PE_OK);
    }
    assert_int_equal(step(world, H).islands_by_path[PE_PATH_SWEEPS], 1);
    double depth = depth_of(world);
    pe_world_destroy(world);
    return depth;
}

/* Position correction of swept islands begins at so many slops. */
static const double BEGIN[] = {[PE_PROFILE_DEFAULT] = 6, [PE_PROFILE_ACCURATE] = 3};

static void test_swept_tower_keeps_small_depths(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_ACCURATE; ++profile) {
        for (int count = 3; count <= 31; count += 4) {
            double overlap = (BEGIN[profile] - 0.1) * SLOP;
            double depth = pressed_tower_depth((pe_profile)profile, count, overlap);
            assert_close(depth, overlap, 0.02 * SLOP, 0);
        }
    }
}

/* In a tall tower sweeps come near the aim slowly, so that they end where they may. The default
 * profile makes few, and leaves the more the taller a tower is. The motion of a low tower does not
 * pay for the lift (energy_guard.c). */
static void test_swept_tower_is_freed_of_larger_depths(void **state)
{
    (void)state;
    static const struct {
        pe_profile profile;
        int most;
        double left; /* slops */
    } cases[] = {{PE_PROFILE_DEFAULT, 25, 6}, {PE_PROFILE_ACCURATE, 31, 1.5}};
    for (int k = 0; k < 2; ++k) {
        for (int count = 15; count <= cases[k].most; count += 2) {
            double overlap = (BEGIN[cases[k].profile] + 0.1) * SLOP;
            double depth = pressed_tower_depth(cases[k].profile, count, overlap);
            assert_at_most(SLOP, depth);
            assert_at_most(depth, cases[k].left * SLOP);
        }
    }
}

/* One box is sunk in the ground and stays in it for several steps. Another box falls next to it. */
static void test_statistics_count_depth_left_in_any_island(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
        pe_world_def world_def = pe_world_def_default();
        world_def.profile = (pe_profile)profile;
        pe_world *world = make_world(&world_def);
        const pe_material_id material = add_material(world, 0.5, 0);
        add_plane(world, pe_v3(0, 0, 1), material);
        pe_body_def sunk = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0));
        pe_body_def falling = box_def(0.5, 0.5, 0.5, pe_v3(5, 0, 0.52));
        falling.velocity.z = -2;
        const pe_body_id id = add_body(world, &sunk);
        add_body(world, &falling);
        for (int i = 0; i < 3; ++i) {
            const pe_step_stats stats = step(world, 1.0 / 60);
            const double left = 0.5 - state_of(world, id).position.z;
            assert_close(stats.penetration_left, left, 1e-3, 0);
        }
        pe_world_destroy(world);
    }
}

/* ---- Whole steps ---- */

/* Balls in a cubic grid that overlap by up to 1 % or are as far apart. */
static void add_falling_balls(pe_world *world, check_random *random)
{
    for (int i = 0; i < 8; ++i) {
        pe_body_def def = box_def(1, 1, 1, pe_v3(i & 1, i >> 1 & 1, i >> 2));
        def.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.5};
        def.mass = check_uniform(random, 0.5, 3);
        def.position = pe_add(def.position, random_vector(random, 0.005));
        add_body(world, &def);
    }
}

/* Position correction raises one ball and lowers the other. Nothing holds either of them. */
static void test_parted_balls_fall_freely(void **state)
{
    (void)state;
    static const double steps[] = {1.0 / 60, 1.0 / 240, 1.0 / 1000};
    static const pe_profile profiles[] = {PE_PROFILE_DEFAULT, PE_PROFILE_FAST, PE_PROFILE_ACCURATE};
    check_random random = {7};
    for (int i = 0; i < 9 * 24; ++i) {
        pe_world_def def = pe_world_def_default();
        def.profile = profiles[i / 3 % 3];
        pe_world *world = make_world(&def);
        const double dt = steps[i % 3], fallen = def.gravity.z * dt;
        add_falling_balls(world, &random);
        (void)step(world, dt);
        for (int slot = 1; slot < world->slot_count; ++slot) {
            const pe_vec3 v = pe_twists(world)[slot].velocity;
            assert_close(pe_length(pe_sub(v, pe_v3(0, 0, fallen))), 0, 1e-9 * fabs(fallen), i);
        }
        pe_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_overlapping_boxes_separate_in_mass_ratio),
        cmocka_unit_test(test_what_is_shallow_stays_to_the_bit),
        cmocka_unit_test(test_sunk_box_is_moved_out_of_ground),
        cmocka_unit_test(test_a_push_reaches_the_end_of_a_row),
        cmocka_unit_test(test_untouched_bodies_stay_unchanged_exactly),
        cmocka_unit_test(test_heap_correction_keeps_mass_centre_and_momenta),
        cmocka_unit_test(test_contacts_afterwards_are_those_of_the_final_poses),
        cmocka_unit_test(test_any_solver_may_take_the_place_of_sweeps),
        cmocka_unit_test(test_flops_of_all_islands_are_bounded_together),
        cmocka_unit_test(test_only_flagged_islands_are_corrected),
        cmocka_unit_test(test_excluded_bodies_stay_during_projection),
        cmocka_unit_test(test_deep_overlap_is_parted_over_several_steps),
        cmocka_unit_test(test_an_overlapping_tower_is_lifted_upright),
        cmocka_unit_test(test_a_body_that_cannot_be_parted_stays),
        cmocka_unit_test(test_swept_tower_keeps_small_depths),
        cmocka_unit_test(test_swept_tower_is_freed_of_larger_depths),
        cmocka_unit_test(test_statistics_count_depth_left_in_any_island),
        cmocka_unit_test(test_parted_balls_fall_freely),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
