/* The guard over energy. */
#include "check.h"
#include "random_pose.h"
#include "step/step.h"
#include "world_for_tests.h"

#include <math.h>
#include <string.h>

static const double H = 1.0 / 60;

static double kinetic_energy(const pe_world *world)
{
    double sum = 0;
    for (int slot = 1; slot < world->slot_count; ++slot) {
        const pe_mass *m = &pe_masses(world)[slot];
        const pe_twist *v = &pe_twists(world)[slot];
        pe_vec3 w = pe_unrotate(&pe_poses(world)[slot].rotation, v->angular_velocity);
        sum +=
            0.5 * (m->mass * pe_dot(v->velocity, v->velocity) + pe_dot(w, pe_mul(m->inertia, w)));
    }
    return sum;
}

/* ---- Growth ---- */

/* A step that has begun: the state that the guard compares with. */
typedef struct under_way {
    pe_saved_pose poses[8];
    pe_twist twists[8];
    pe_free_motion free[8];
    pe_islands islands;
} under_way;

static void remember(pe_world *world, under_way *u)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    pe_arena_reset(&world->arena, &world->allocator);
    assert_int_equal(pe_contacts_update(world, &rules, NULL, H, NULL), PE_OK);
    size_t slots = (size_t)world->slot_count;
    for (size_t slot = 0; slot < slots; ++slot) {
        u->poses[slot] = pe_pose_save(&pe_poses(world)[slot]);
    }
    memcpy(u->twists, pe_twists(world), slots * sizeof *u->twists);
    assert_int_equal(pe_islands_find(world, &u->islands, NULL), PE_OK);
    pe_predict_motion(world, u->islands.place, H, u->free);
}

/* Asserts that the body is where it was, to the bit. */
static void assert_restored(const pe_pose *pose, const pe_saved_pose *saved)
{
    const pe_pose was = pe_pose_restore(saved);
    assert_memory_equal(pose, &was, sizeof was);
}

/* Moves a body as if it touched nothing. */
static void move_freely(pe_world *world, const under_way *u, int slot)
{
    pe_twists(world)[slot] = u->free[slot].end;
    pe_pose_move(&pe_poses(world)[slot], pe_scale(H, u->free[slot].mean.velocity),
                 pe_scale(H, u->free[slot].mean.angular_velocity));
}

/* The step that the guard ends. */
static pe_step ending(pe_world *world, under_way *u, bool *solved)
{
    static int in_an_island[8];
    return (pe_step){.world = world,
                     .dt = H,
                     .islands.place = in_an_island,
                     .free = u->free,
                     .poses = u->poses,
                     .twists = u->twists,
                     .solved_directly = solved};
}

/* Guards bodies that were neither solved directly nor corrected. */
static pe_energy_report guard(pe_world *world, under_way *u)
{
    bool put_back[8] = {false}, solved[8] = {false};
    pe_step s = ending(world, u, solved);
    s.shallow = 1e-3;
    pe_energy_report report;
    pe_energy_guard(&s, &u->islands, put_back, &report);
    return report;
}

/* A body of 2 kg a little above the ground, near enough for a contact. */
static pe_world *make_world_with(pe_shape shape, pe_vec3 velocity, pe_vec3 spin, pe_body_id *id)
{
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), add_material(world, 0.5, 1));
    pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(3, 1, 0.5005));
    def.shape = shape;
    def.mass = 2;
    def.velocity = velocity;
    def.angular_velocity = spin;
    *id = add_body(world, &def);
    return world;
}

static const pe_shape CUBE = {.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}};

static void test_energy_guard_leaves_free_flight_unchanged(void **state)
{
    (void)state;
    static const pe_vec3 velocities[] = {{0, 0, 0}, {3, -2, 6}, {10, 0, 0}, {0, 0, -1}};
    for (int k = 0; k < 4; ++k) {
        pe_body_id id;
        pe_world *world = make_world_with(CUBE, velocities[k], pe_v3(0.3 * k, 0.1, -2), &id);
        under_way u;
        remember(world, &u);
        assert_int_equal(u.islands.count, 1);
        move_freely(world, &u, (int)id.index);
        pe_twist before = pe_twists(world)[id.index];
        pe_energy_report report = guard(world, &u);
        assert_memory_equal(&before, &pe_twists(world)[id.index], sizeof before);
        assert_int_equal(report.islands, 0);
        pe_world_destroy(world);
    }
}

static void test_energy_guard_leaves_work_of_forces_unchanged(void **state)
{
    (void)state;
    static const pe_frame frames[] = {PE_FRAME_WORLD, PE_FRAME_BODY};
    for (int k = 0; k < 4; ++k) {
        pe_body_id id;
        pe_world *world = make_world_with(CUBE, pe_v3(1, 0, 2), pe_v3(0, 0.5, 1), &id);
        pe_vec3 force = pe_scale(k < 2 ? 1 : -1, pe_v3(40, -7, 25));
        assert_int_equal(
            pe_body_apply_force(world, id, force, pe_v3(0.2, 0.1, -0.3), frames[k % 2], NULL),
            PE_OK);
        under_way u;
        remember(world, &u);
        move_freely(world, &u, (int)id.index);
        pe_twist before = pe_twists(world)[id.index];
        guard(world, &u);
        assert_memory_equal(&before, &pe_twists(world)[id.index], sizeof before);
        pe_world_destroy(world);
    }
}

static double energy_at(const pe_world *world, pe_body_id id)
{
    return kinetic_energy(world) + 2 * 9.81 * pe_poses(world)[id.index].position.z;
}

/* A bounce in mid-air, above the ground, would end higher than it began. */
static void test_a_bounce_keeps_the_energy(void **state)
{
    (void)state;
    pe_body_id id;
    pe_world *world = make_world_with(CUBE, pe_v3(1, 0, -5), pe_v3(0, 0, 1), &id);
    under_way u;
    remember(world, &u);
    double before = energy_at(world, id);
    pe_twist *motion = &pe_twists(world)[id.index];
    motion->velocity.z = 5;
    pe_pose_move(&pe_poses(world)[id.index], pe_scale(H, motion->velocity),
                 pe_scale(H, motion->angular_velocity));
    assert_true(energy_at(world, id) > before + 0.5);
    pe_energy_report report = guard(world, &u);
    assert_close(energy_at(world, id), before, 1e-12, 0);
    assert_int_equal(report.islands, 1);
    assert_close(report.removed, 2 * 9.81 * 5 * H, 1e-12, 0);
    assert_close(motion->angular_velocity.z / motion->velocity.z, 1.0 / 5, 1e-12, 0);
    pe_world_destroy(world);
}

static void test_energy_guard_removes_growth_that_motion_covers(void **state)
{
    (void)state;
    check_random random = {77};
    int acted = 0;
    for (int k = 0; k < 200; ++k) {
        pe_body_id id;
        pe_vec3 angular_velocity = random_vector(&random, 3), velocity = random_vector(&random, 3);
        pe_world *world = make_world_with(CUBE, velocity, angular_velocity, &id);
        under_way u;
        remember(world, &u);
        double begun = energy_at(world, id);
        pe_twist *motion = &pe_twists(world)[id.index];
        motion->velocity = pe_add(motion->velocity, random_vector(&random, 1));
        motion->angular_velocity = pe_add(motion->angular_velocity, random_vector(&random, 1));
        pe_vec3 rotation = random_vector(&random, 0.05), shift = random_vector(&random, 0.05);
        pe_pose_move(&pe_poses(world)[id.index], shift, rotation);
        double before = energy_at(world, id);
        pe_energy_report report = guard(world, &u);
        double after = energy_at(world, id);
        /* Rest where it was has no more than its energy of position. */
        assert_at_most(after, pe_max(before, begun));
        if (report.islands > 0) {
            assert_at_most(after, begun + 1e-12);
        }
        if (report.put_back == 0) {
            assert_close(before - after, report.removed, 1e-12, 0);
        }
        acted += report.islands;
        pe_world_destroy(world);
    }
    assert_true(acted > 40 && acted < 160);
}

static void test_a_rise_without_motion_is_taken_back(void **state)
{
    (void)state;
    pe_body_id id;
    pe_world *world = make_world_with(CUBE, pe_v3(0, 0, 0), pe_v3(0, 0, 0), &id);
    under_way u;
    remember(world, &u);
    pe_twists(world)[id.index].velocity.x = 1e-3;
    pe_pose_move(&pe_poses(world)[id.index], pe_v3(0, 0, 9e-4), pe_v3(0, 0, 0));
    pe_energy_report report = guard(world, &u);
    assert_int_equal(report.put_back, 1);
    assert_close(pe_twists(world)[id.index].velocity.x, 0, 0, 0);
    assert_restored(&pe_poses(world)[id.index], &u.poses[id.index]);
    pe_world_destroy(world);
}

/* A cube that slides with 100 J and gains `gain` of them in a step; what it is left with of that. */
static double gain_left(double gain, bool solved)
{
    pe_body_id id;
    pe_world *world = make_world_with(CUBE, pe_v3(10, 0, 0), pe_v3(0, 0, 0), &id);
    under_way u;
    remember(world, &u);
    double begun = energy_at(world, id);
    move_freely(world, &u, (int)id.index);
    pe_vec3 *velocity = &pe_twists(world)[id.index].velocity;
    velocity->x *= sqrt(1 + gain);
    bool put_back[8] = {false}, exact[8] = {false};
    exact[id.index] = solved;
    pe_step s = ending(world, &u, exact);
    pe_energy_report report;
    pe_energy_guard(&s, &u.islands, put_back, &report);
    double left = (energy_at(world, id) - begun) / 100;
    pe_world_destroy(world);
    return left;
}

/* A millionth of the energies before and after, where all bodies were solved directly. */
static void test_exact_motion_may_gain_a_millionth(void **state)
{
    (void)state;
    assert_close(gain_left(1.8e-6, true), 1.8e-6, 1e-9, 0);
    assert_close(gain_left(2.2e-6, true), 0, 1e-9, 0);
    assert_close(gain_left(1e-4, true), 0, 1e-9, 0);
    assert_close(gain_left(1.8e-6, false), 0, 1e-9, 0);
}

/* ---- Neighbours ---- */

/* Two cubes on the ground, `gap` apart, one of which gains speed. Whether the other loses some. */
static bool neighbour_pays(double gap)
{
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), add_material(world, 0.5, 0));
    pe_body_id ids[2];
    for (int k = 0; k < 2; ++k) {
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(k * (1 + gap), 0, 0.5));
        def.velocity = pe_v3(0, 1, 0);
        ids[k] = add_body(world, &def);
    }
    under_way u;
    remember(world, &u);
    for (int k = 0; k < 2; ++k) {
        pe_pose_move(&pe_poses(world)[ids[k].index], pe_v3(0, H, 0), pe_v3(0, 0, 0));
    }
    pe_twists(world)[ids[0].index].velocity.y = 1.1;
    pe_contact_rules rules = pe_contact_rules_exact();
    assert_int_equal(pe_contacts_update(world, &rules, NULL, H, NULL), PE_OK);
    assert_int_equal(world->contacts.manifold_count, 3); /* the two have one with each other too */
    pe_islands groups;
    assert_int_equal(pe_islands_find_touching(world, NULL, &groups, NULL), PE_OK);
    bool put_back[8] = {false}, solved[8] = {false};
    pe_step s = ending(world, &u, solved);
    pe_energy_report report;
    pe_energy_guard(&s, &groups, put_back, &report);
    assert_int_equal(report.islands, 1);
    assert_close(report.removed, 0.5 * (1.1 * 1.1 - 1), 1e-9, 0);
    bool pays = pe_twists(world)[ids[1].index].velocity.y != 1;
    assert_close(pe_twists(world)[ids[0].index].velocity.y, pays ? sqrt(2 / 2.21) * 1.1 : 1, 1e-9,
                 0);
    pe_world_destroy(world);
    return pays;
}

/* The momenta of all bodies about the origin. */
static void momenta_of(const pe_world *world, pe_vec3 *linear, pe_vec3 *angular)
{
    *linear = *angular = pe_v3(0, 0, 0);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        const pe_mass *m = &pe_masses(world)[slot];
        const pe_pose *pose = &pe_poses(world)[slot];
        const pe_twist *v = &pe_twists(world)[slot];
        pe_vec3 p = pe_scale(m->mass, v->velocity);
        pe_vec3 w = pe_unrotate(&pose->rotation, v->angular_velocity);
        pe_vec3 spin = pe_rotate(&pose->rotation, pe_mul(m->inertia, w));
        *linear = pe_add(*linear, p);
        *angular = pe_add(*angular, pe_add(pe_cross(pose->position, p), spin));
    }
}

/* Two bricks that touch in flight, and that an impulse between them has given energy or taken it. */
static void test_bodies_that_pay_together_keep_momenta(void **state)
{
    (void)state;
    check_random random = {21};
    int acted = 0;
    for (int k = 0; k < 50; ++k) {
        pe_world_def world_def = pe_world_def_default();
        world_def.gravity = pe_v3(0, 0, 0);
        pe_world *world = make_world(&world_def);
        pe_body_id ids[2];
        for (int i = 0; i < 2; ++i) {
            pe_body_def def = box_def(0.5, 0.3, 0.2, pe_v3(1.0 * i, 0, 0));
            def.mass = 1 + i;
            def.velocity = random_vector(&random, 3);
            def.angular_velocity = random_vector(&random, 3);
            ids[i] = add_body(world, &def);
        }
        under_way u;
        remember(world, &u);
        const double impulse = check_uniform(&random, -1, 1);
        for (int i = 0; i < 2; ++i) {
            move_freely(world, &u, (int)ids[i].index);
            pe_twists(world)[ids[i].index].velocity.x += (i == 0 ? 1 : -1) * impulse / (1 + i);
        }
        pe_vec3 linear, angular, linear_after, angular_after;
        momenta_of(world, &linear, &angular);
        const double before = kinetic_energy(world);
        const pe_energy_report report = guard(world, &u);
        momenta_of(world, &linear_after, &angular_after);
        assert_close(before - kinetic_energy(world), report.removed, 1e-12, 0);
        assert_close(pe_length(pe_sub(linear_after, linear)), 0, 1e-13, 0);
        assert_close(pe_length(pe_sub(angular_after, angular)), 0, 1e-13, 0);
        acted += report.islands;
        pe_world_destroy(world);
    }
    assert_true(acted > 10 && acted < 40);
}

static void test_energy_is_taken_from_touching_bodies_only(void **state)
{
    (void)state;
    assert_true(neighbour_pays(-1e-4));
    assert_true(neighbour_pays(0));
    assert_false(neighbour_pays(1e-5));
    assert_false(neighbour_pays(5e-4));
}

/* ---- Corrections that motion cannot pay for ---- */

/* A cube of 2 kg that moved freely in a step at whose begin it stood, and then was lifted. */
typedef struct lifted {
    pe_world *world;
    int slot;
    under_way begun;
    pe_saved_pose pose[8]; /* (slots): before the lift */
    pe_twist twist[8];
    pe_energy_report report;
    bool put_back[8];
} lifted;

/* `kept`: part of the speed of free fall. shallow: 3e-3 m. */
static lifted lift(double height, double kept, bool solved)
{
    lifted l = {0};
    pe_body_id id;
    l.world = make_world_with(CUBE, pe_v3(0, 0, 0), pe_v3(0, 0, 0), &id);
    l.slot = (int)id.index;
    remember(l.world, &l.begun);
    move_freely(l.world, &l.begun, l.slot);
    pe_twist *motion = &pe_twists(l.world)[l.slot];
    motion->velocity = pe_scale(kept, motion->velocity);
    l.pose[l.slot] = pe_pose_save(&pe_poses(l.world)[l.slot]);
    l.twist[l.slot] = *motion;
    pe_pose_move(&pe_poses(l.world)[l.slot], pe_v3(0, 0, height), pe_v3(0, 1e-3, 0));
    bool flags[8] = {false}, exact[8] = {false};
    flags[l.slot] = true;
    exact[l.slot] = solved;
    pe_step s = ending(l.world, &l.begun, exact);
    s.corrected = flags;
    s.uncorrected_poses = l.pose;
    s.uncorrected_twists = l.twist;
    s.shallow = 3e-3;
    pe_energy_guard(&s, &l.begun.islands, l.put_back, &l.report);
    return l;
}

/* Free fall in a step gives m (g h)^2 / 2, which pays for a lift of g h^2 / 2, 1.36e-3 m. Of three
 * quarters of that half of the speed is left. */
static const double PAID = 9.81 / 60 / 60 / 2;

static void test_a_lift_that_motion_pays_for_stays(void **state)
{
    (void)state;
    for (int k = 0; k < 2; ++k) {
        const double height = (k == 0 ? 0.3 : 0.74) * PAID;
        lifted l = lift(height, 1, true);
        assert_int_equal(l.report.put_back, 0);
        double z = l.pose[l.slot].position.z + height;
        assert_close(pe_poses(l.world)[l.slot].position.z, z, 1e-15, 0);
        double v = pe_twists(l.world)[l.slot].velocity.z, fall = l.twist[l.slot].velocity.z;
        assert_true(fall < 0);
        assert_close(v * v, fall * fall - 2 * 9.81 * height, 1e-9, 0);
        pe_world_destroy(l.world);
    }
}

static void test_excess_lift_is_undone_and_motion_continues(void **state)
{
    (void)state;
    static const double kept[] = {1, 0.3, 0, 1};
    for (int k = 0; k < 4; ++k) {
        lifted l = lift(k < 3 ? 2e-3 : 0.76 * PAID, kept[k], true);
        assert_int_equal(l.report.put_back, 1);
        assert_true(l.put_back[l.slot]);
        assert_restored(&pe_poses(l.world)[l.slot], &l.pose[l.slot]);
        assert_memory_equal(&pe_twists(l.world)[l.slot], &l.twist[l.slot], sizeof(pe_twist));
        pe_world_destroy(l.world);
    }
}

/* Swept contacts yield: bodies on them would sink step by step. */
static void test_unsolved_bodies_come_to_rest_in_place(void **state)
{
    (void)state;
    lifted l = lift(2e-3, 0.3, false);
    assert_int_equal(l.report.put_back, 1);
    assert_true(l.put_back[l.slot]);
    assert_restored(&pe_poses(l.world)[l.slot], &l.begun.poses[l.slot]);
    assert_close(pe_length(pe_twists(l.world)[l.slot].velocity), 0, 0, 0);
    pe_world_destroy(l.world);
}

static void test_what_is_deep_is_lifted_at_any_price(void **state)
{
    (void)state;
    lifted l = lift(8e-3, 1, true);
    assert_false(l.put_back[l.slot]);
    assert_close(pe_poses(l.world)[l.slot].position.z, l.pose[l.slot].position.z + 8e-3, 1e-15, 0);
    assert_close(pe_length(pe_twists(l.world)[l.slot].velocity), 0, 0, 0);
    pe_world_destroy(l.world);
}

/* ---- Stacks that fall ---- */

enum { MOST_BLOCKS = 20 };

/* Blocks 1 by 0.5 by 0.25 m on a table whose edge is x = 0, its top z = 0, the k-th from the top
 * out over the next by factor / (2 k): they stay up if and only if factor <= 1. */
static void add_overhang(pe_world *world, int count, double factor, pe_vec3 at, pe_body_id *ids)
{
    pe_body_def def = box_def(0.5, 0.25, 0.125, pe_add(at, pe_v3(-0.5, 0, -0.125)));
    def.is_static = true;
    add_body(world, &def);
    def.is_static = false;
    double x = -0.5;
    for (int k = count; k >= 1; --k) {
        x += factor * 0.5 / k;
        def.position = pe_add(at, pe_v3(x, 0, 0.125 + 0.25 * (count - k)));
        ids[count - k] = add_body(world, &def);
    }
}

static double height_of(const pe_world *world, const pe_body_id *ids, int count)
{
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        sum += state_of(world, ids[i]).position.z;
    }
    return sum / count;
}

/* Less cannot be distinguished from standing. */
static const double FALLEN = 2e-5; /* m */

/* Without friction or blows nothing slows a fall that has begun: the way down in half
 * a second is longer than in the one before. */
static void test_what_has_begun_to_fall_falls_on(void **state)
{
    (void)state;
    static const struct {
        int count;
        double factor;
    } stacks[] = {
#ifdef PLUMB_TEST_AMD /* in another elimination order some stacks this near to their limit hang */
        {12, 1.0005}, {14, 1.0004}, {18, 1.0004},
#endif
        {14, 1.001},  {16, 1.001},  {16, 1.002},  {20, 1.0015}, {20, 1.002}};
    for (size_t k = 0; k < sizeof stacks / sizeof *stacks; ++k) {
        pe_body_id ids[MOST_BLOCKS];
        pe_world_def def = pe_world_def_default();
        def.profile = PE_PROFILE_ACCURATE;
        pe_world *world = make_world(&def);
        add_overhang(world, stacks[k].count, stacks[k].factor, pe_v3(0, 0, 0), ids);
        double begin = height_of(world, ids, stacks[k].count), before = begin;
        for (int n = 0; n < 12 && before > begin - 0.1; ++n) {
            for (int i = 0; i < 30; ++i) {
                step(world, H);
            }
            double now = height_of(world, ids, stacks[k].count);
            if (before < begin - FALLEN) {
                assert_true(now < before - FALLEN);
            }
            before = now;
        }
        assert_true(before < begin - 0.1);
        pe_world_destroy(world);
    }
}

/* ---- Distant bodies ---- */

/* Boxes that drop onto each other. */
static void add_falling_boxes(pe_world *world, pe_body_id *ids)
{
    check_random random = {5};
    for (int i = 0; i < MOST_BLOCKS; ++i) {
        pe_body_def def =
            box_def(0.3, 0.2, 0.25, pe_v3(0.1 * (i % 3), 0.1 * (i % 2), 0.4 + 0.7 * i));
        double q[4];
        check_quaternion(&random, q);
        def.orientation = (pe_quat){q[0], q[1], q[2], q[3]};
        ids[i] = add_body(world, &def);
    }
}

/* The stack, 1 km away, has its position correction taken back in many steps. */
static void test_restoring_bodies_leaves_far_bodies_unchanged(void **state)
{
    (void)state;
    pe_world *worlds[2];
    pe_body_id near_by[MOST_BLOCKS], far_off[MOST_BLOCKS];
    for (int k = 0; k < 2; ++k) {
        pe_world_def def = pe_world_def_default();
        def.profile = PE_PROFILE_ACCURATE;
        worlds[k] = make_world(&def);
        add_plane(worlds[k], pe_v3(0, 0, 1), add_material(worlds[k], 0.5, 0));
        add_falling_boxes(worlds[k], near_by);
    }
    add_overhang(worlds[1], 16, 1.001, pe_v3(1000, 0, 100), far_off);
    int guarded = 0;
    for (int n = 0; n < 180; ++n) {
        int standalone = step(worlds[0], H).guarded_islands;
        guarded += step(worlds[1], H).guarded_islands > standalone;
        for (int i = 0; i < MOST_BLOCKS; ++i) {
            pe_body_state a = state_of(worlds[0], near_by[i]), b = state_of(worlds[1], near_by[i]);
            assert_memory_equal(&a, &b, sizeof a);
        }
    }
    assert_true(guarded > 10);
    pe_world_destroy(worlds[0]);
    pe_world_destroy(worlds[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_energy_guard_leaves_free_flight_unchanged),
        cmocka_unit_test(test_energy_guard_leaves_work_of_forces_unchanged),
        cmocka_unit_test(test_a_bounce_keeps_the_energy),
        cmocka_unit_test(test_energy_guard_removes_growth_that_motion_covers),
        cmocka_unit_test(test_a_rise_without_motion_is_taken_back),
        cmocka_unit_test(test_exact_motion_may_gain_a_millionth),
        cmocka_unit_test(test_bodies_that_pay_together_keep_momenta),
        cmocka_unit_test(test_energy_is_taken_from_touching_bodies_only),
        cmocka_unit_test(test_a_lift_that_motion_pays_for_stays),
        cmocka_unit_test(test_excess_lift_is_undone_and_motion_continues),
        cmocka_unit_test(test_unsolved_bodies_come_to_rest_in_place),
        cmocka_unit_test(test_what_is_deep_is_lifted_at_any_price),
        cmocka_unit_test(test_what_has_begun_to_fall_falls_on),
        cmocka_unit_test(test_restoring_bodies_leaves_far_bodies_unchanged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
