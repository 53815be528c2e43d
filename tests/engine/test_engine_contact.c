/* Contact dynamics of the engine against closed forms of mechanics. */
#include "base/vec3.h"
#include "check.h"
#include "world_for_tests.h"

static const double H = 1.0 / 60;

enum { MAX_CONTACTS = 4096 };

static pe_contact contacts[MAX_CONTACTS];

static void test_tower_contact_forces_carry_the_weight_above_them(void **state)
{
    (void)state;
    enum { N = 10 };
    pe_world *world = make_world(NULL);
    pe_body_id ids[N];
    add_tower(world, N, add_material(world, 0.5, 0), ids);
    for (int i = 0; i < 60; ++i) {
        pe_step_stats stats = step(world, H);
        assert_at_most(stats.residual, 1e-8);
        assert_int_equal(stats.contacts, 4 * N);
        assert_int_equal(stats.islands, 1);
    }
    double supported[N + 2] = {0};
    int count = pe_world_get_contacts(world, contacts, MAX_CONTACTS);
    for (int i = 0; i < count; ++i) {
        supported[contacts[i].body_b.index - 2] += contacts[i].impulse.z;
        assert_true(contacts[i].impulse.z >= 0);
    }
    for (int k = 0; k < N; ++k) {
        assert_close(supported[k], (N - k) * 9.81 * H, 1e-7, 0);
        pe_body_state s = state_of(world, ids[k]);
        assert_close(s.position.z, k + 0.5, 1e-8, 0);
    }
    pe_world_destroy(world);
}

/* A block on a slope of angle a through the origin, downhill along +x. */
static pe_world *slope_world(double angle, double friction, pe_body_id *block)
{
    pe_world *world = make_world(NULL);
    pe_material_id material = add_material(world, friction, 0);
    pe_vec3 n = pe_v3(sin(angle), 0, cos(angle));
    add_plane(world, n, material);
    pe_body_def def = box_def(0.5, 0.5, 0.25, pe_scale(0.25, n));
    def.orientation = (pe_quat){cos(angle / 2), 0, sin(angle / 2), 0};
    def.material = material;
    *block = add_body(world, &def);
    return world;
}

static void test_block_below_the_friction_threshold_stays(void **state)
{
    (void)state;
    pe_body_id block;
    pe_world *world = slope_world(0.44, 0.5, &block);
    pe_vec3 start = state_of(world, block).position;
    for (int i = 0; i < 3600; ++i) {
        step(world, H);
    }
    assert_at_most(pe_length(pe_sub(state_of(world, block).position, start)), 1e-6);
    pe_world_destroy(world);
}

static void test_block_above_the_friction_threshold_slides_by_coulomb(void **state)
{
    (void)state;
    const double angle = 0.6, mu = 0.5;
    pe_body_id block;
    pe_world *world = slope_world(angle, mu, &block);
    pe_vec3 start = state_of(world, block).position;
    double a = 9.81 * (sin(angle) - mu * cos(angle));
    for (int n = 1; n <= 120; ++n) {
        step(world, H);
        pe_vec3 moved = pe_sub(state_of(world, block).position, start);
        double along = pe_dot(moved, pe_v3(cos(angle), 0, -sin(angle)));
        assert_close(along, a * H * H * n * n / 2, 0, 1e-9);
        /* No lift: the convex relaxation of friction would raise it by mu times the slip. */
        assert_close(pe_dot(moved, pe_v3(sin(angle), 0, cos(angle))), 0, 1e-9, 0);
    }
    pe_world_destroy(world);
}

static void test_friction_does_not_depend_on_azimuth(void **state)
{
    (void)state;
    for (int k = 0; k <= 18; ++k) {
        double azimuth = k * 5 * 0.017453292519943295;
        pe_world *world = make_world(NULL);
        pe_material_id material = add_material(world, 0.3, 0);
        add_plane(world, pe_v3(0, 0, 1), material);
        pe_body_def def = box_def(0.5, 0.5, 0.1, (pe_vec3){0, 0, 0.1});
        def.velocity = (pe_vec3){2 * cos(azimuth), 2 * sin(azimuth), 0};
        def.material = material;
        pe_body_id block = add_body(world, &def);
        for (int i = 0; i < 60; ++i) {
            step(world, H);
        }
        /* v_n = v - mu g n h until it would change sign: stops in 40.77 steps, in the 41st. */
        double decrement = 0.3 * 9.81 * H, distance = 0;
        for (double v = 2; v > 0; v -= decrement) {
            distance += (v + fmax(v - decrement, 0)) / 2 * H;
        }
        pe_vec3 x = state_of(world, block).position;
        assert_close(x.x * cos(azimuth) + x.y * sin(azimuth), distance, 1e-9, 0);
        assert_close(x.y * cos(azimuth) - x.x * sin(azimuth), 0, 1e-9, 0);
        pe_world_destroy(world);
    }
}

static void test_ball_bounces_with_newtons_restitution(void **state)
{
    (void)state;
    for (int k = 0; k <= 10; ++k) {
        double e = 0.1 * k;
        pe_world *world = make_world(NULL);
        pe_material_id material = add_material(world, 0, e);
        add_plane(world, pe_v3(0, 0, 1), material);
        pe_body_def def = pe_body_def_default();
        def.position = (pe_vec3){0, 0, 0.5};
        def.velocity = (pe_vec3){0, 0, -3};
        def.material = material;
        pe_body_id ball = add_body(world, &def);
        step(world, H);
        /* To the residual that is solved to, a thousandth of the tolerance. */
        double left = e > 0 ? 3 * e - 9.81 * H : 0;
        assert_close(state_of(world, ball).velocity.z, left, 1e-11, 0);
        pe_world_destroy(world);
    }
}

static void test_collinear_spheres_collide_by_newtons_law(void **state)
{
    (void)state;
    for (double ratio = 1e-6; ratio < 2e6; ratio *= 100) {
        pe_world_def world_def = pe_world_def_default();
        world_def.gravity = (pe_vec3){0, 0, 0};
        world_def.tolerance = 1e-12;
        pe_world *world = make_world(&world_def);
        pe_material_id material = add_material(world, 0.3, 0.7);
        pe_body_def def = pe_body_def_default();
        def.material = material;
        def.velocity = (pe_vec3){1, 0, 0};
        pe_body_id a = add_body(world, &def);
        def.position = (pe_vec3){1, 0, 0};
        def.velocity = (pe_vec3){0};
        def.mass = ratio;
        pe_body_id b = add_body(world, &def);
        step(world, H);
        assert_close(state_of(world, a).velocity.x, (1 - 0.7 * ratio) / (1 + ratio), 1e-10, 0);
        assert_close(state_of(world, b).velocity.x, 1.7 / (1 + ratio), 1e-10, 0);
        pe_world_destroy(world);
    }
}

static void test_pair_overrides_the_mixing_rule(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_material_id ice = add_material(world, 0.1, 0.2), rubber = add_material(world, 0.9, 0.6);
    pe_body_id floor_body = add_plane(world, pe_v3(0, 0, 1), ice);
    pe_body_def def = box_def(0.5, 0.5, 0.5, (pe_vec3){0, 0, 0.5});
    def.material = rubber;
    pe_body_id box = add_body(world, &def);
    double friction, restitution;
    pe_body_get_pair(world, floor_body, box, &friction, &restitution, NULL);
    assert_close(friction, 0.3, 1e-15, 0);
    assert_close(restitution, 0.6, 0, 0);
    assert_int_equal(pe_world_set_pair(world, rubber, ice, 0.25, 0, NULL), PE_OK);
    pe_body_get_pair(world, floor_body, box, &friction, &restitution, NULL);
    assert_close(friction, 0.25, 0, 0);
    assert_close(restitution, 0, 0, 0);
    pe_world_destroy(world);
}

static void test_free_box_collision_conserves_momentum(void **state)
{
    (void)state;
    check_random random = {21};
    int collided = 0;
    for (int i = 0; i < 200; ++i) {
        pe_world_def world_def = pe_world_def_default();
        world_def.gravity = (pe_vec3){0, 0, 0};
        world_def.impact_bodies = 0; /* see test_engine_impact.c for those that have their time */
        pe_world *world = make_world(&world_def);
        pe_body_id ids[2];
        pe_vec3 p0 = {0}, l0 = {0}, p1 = {0}, l1 = {0};
        double kinetic[2] = {0, 0};
        for (int k = 0; k < 2; ++k) {
            pe_body_def def = box_def(0.4, 0.6, 0.5, (pe_vec3){k * 1.05, 0.3 * k, 0.1 * k});
            double q[4];
            check_quaternion(&random, q);
            def.orientation = (pe_quat){q[0], q[1], q[2], q[3]};
            def.velocity = (pe_vec3){k ? -2 : 2, check_uniform(&random, -1, 1), 0};
            def.angular_velocity = (pe_vec3){check_uniform(&random, -1, 1), 0, 1};
            def.inertia =
                (pe_vec3){0.1, 0.1, 0.1}; /* no gyroscopic term: the law is the impact's */
            ids[k] = add_body(world, &def);
            pe_body_state s = state_of(world, ids[k]);
            p0 = pe_add(p0, s.velocity);
            l0 = pe_add(l0, pe_madd(pe_cross(s.position, s.velocity), 0.1, s.angular_velocity));
            kinetic[0] += pe_dot(s.velocity, s.velocity) +
                          0.1 * pe_dot(s.angular_velocity, s.angular_velocity);
        }
        pe_body_state before[2] = {state_of(world, ids[0]), state_of(world, ids[1])};
        pe_step_stats stats = step(world, H);
        for (int k = 0; k < 2; ++k) {
            pe_body_state s = state_of(world, ids[k]);
            p1 = pe_add(p1, s.velocity);
            /* The impulses act at the positions before the step. */
            l1 = pe_add(l1,
                        pe_madd(pe_cross(before[k].position, s.velocity), 0.1, s.angular_velocity));
            kinetic[1] += pe_dot(s.velocity, s.velocity) +
                          0.1 * pe_dot(s.angular_velocity, s.angular_velocity);
        }
        collided += stats.contacts > 0 && kinetic[1] < kinetic[0] - 1e-6;
        assert_at_most(pe_length(pe_sub(p1, p0)), 1e-12);
        assert_at_most(pe_length(pe_sub(l1, l0)), 1e-12);
        assert_at_most(kinetic[1], kinetic[0] + 1e-9);
        pe_world_destroy(world);
    }
    assert_true(collided > 50);
}

static void test_coincident_bodies_separate_without_energy_gain(void **state)
{
    (void)state;
    for (int profile = PE_PROFILE_DEFAULT; profile <= PE_PROFILE_FAST; ++profile) {
        pe_world_def world_def = pe_world_def_default();
        world_def.profile = (pe_profile)profile;
        world_def.gravity = (pe_vec3){0, 0, 0};
        pe_world *world = make_world(&world_def);
        pe_body_def def = box_def(0.5, 0.5, 0.5, (pe_vec3){0, 0, 0});
        pe_body_id ids[2];
        for (int k = 0; k < 2; ++k) {
            def.mass = k ? 1e-6 : 1;
            def.angular_velocity = k ? (pe_vec3){0, 0, 0} : (pe_vec3){4, 3, 7};
            ids[k] = add_body(world, &def);
        }
        for (int i = 0; i < 200; ++i) {
            step(world, H);
        }
        pe_body_state a = state_of(world, ids[0]), b = state_of(world, ids[1]);
        assert_true(pe_is_finite(a.position) && pe_is_finite(b.position));
        /* The heavy one's rim moves at 8.6 m/s times 0.87 m; the light one cannot be made faster
         * than twice that. */
        assert_at_most(pe_length(a.angular_velocity), 8.7);
        assert_at_most(pe_length(b.velocity), 2 * 8.7 * 0.87);
        pe_world_destroy(world);
    }
}

static void test_separate_stacks_are_independent_islands(void **state)
{
    (void)state;
    pe_world *one = make_world(NULL), *two = make_world(NULL);
    pe_body_id a[5], b[5], far_id[5];
    add_tower(one, 5, (pe_material_id){0}, a);
    add_tower(two, 5, (pe_material_id){0}, b);
    for (int i = 0; i < 5; ++i) {
        pe_body_def def = box_def(0.5, 0.5, 0.5, (pe_vec3){50, 0.01 * i, i + 0.5});
        far_id[i] = add_body(two, &def);
    }
    for (int i = 0; i < 100; ++i) {
        assert_int_equal(step(one, H).islands, 1);
        assert_int_equal(step(two, H).islands, 2);
    }
    for (int i = 0; i < 5; ++i) {
        pe_body_state s = state_of(one, a[i]), t = state_of(two, b[i]);
        assert_memory_equal(&s, &t, sizeof s);
    }
    assert_close(state_of(two, far_id[4]).position.z, 4.5, 1e-6, 0);
    pe_world_destroy(one);
    pe_world_destroy(two);
}

static void test_resting_tower_needs_few_iterations(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[25];
    add_tower(world, 25, (pe_material_id){0}, ids);
    pe_step_stats first = step(world, H);
    assert_in_range(first.iterations, 1, 5);
    assert_int_equal(first.islands_by_path[PE_PATH_DIRECT], 1);
    assert_true(first.factor_flops > 0 && first.history_count > 0);
    long warm = 0, kept = 0;
    for (int i = 0; i < 100; ++i) {
        pe_step_stats stats = step(world, H);
        warm += stats.iterations;
        kept += stats.islands_by_path[PE_PATH_WARM];
    }
    assert_true(warm < 50);
    assert_true(kept > 80);
    pe_world_destroy(world);
}

static void test_resting_box_takes_few_sweeps_per_step(void **state)
{
    (void)state;
    /* Rounding of the four gaps must not ask for a motion that a rigid box does not have. */
    pe_world *world = make_world(NULL);
    pe_body_id id;
    add_tower(world, 1, (pe_material_id){0}, &id);
    for (int i = 0; i < 1200; ++i) {
        assert_true(step(world, H).iterations <= 100);
    }
    pe_world_destroy(world);
}

static void test_falling_ball_lands_on_the_surface(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    pe_body_def def = pe_body_def_default();
    def.position = (pe_vec3){0, 0, 0.52};
    def.velocity = (pe_vec3){0, 0, -3};
    pe_body_id ball = add_body(world, &def);
    step(world, H);
    assert_close(state_of(world, ball).position.z, 0.5, 1e-9, 0);
    step(world, H);
    assert_close(state_of(world, ball).velocity.z, 0, 1e-8, 0);
    pe_world_destroy(world);
}

static void test_contacts_come_sorted_by_pair(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    for (int i = 0; i < 12; ++i) {
        /* Made in an order that is not that of space. */
        int place = (5 * i) % 12;
        pe_body_def def =
            box_def(0.5, 0.5, 0.5, (pe_vec3){place % 3, place / 3 % 2, place / 6 + 0.5});
        add_body(world, &def);
    }
    step(world, H);
    int count = pe_world_get_contacts(world, contacts, MAX_CONTACTS);
    assert_true(count > 60);
    for (int i = 1; i < count; ++i) {
        const pe_contact *p = &contacts[i - 1], *q = &contacts[i];
        assert_true(p->body_a.index < q->body_a.index ||
                    (p->body_a.index == q->body_a.index && p->body_b.index <= q->body_b.index));
        assert_true(q->body_a.index < q->body_b.index);
    }
    pe_world_destroy(world);
}

static void test_overlap_is_pushed_out_without_velocity(void **state)
{
    (void)state;
    pe_world_def def = pe_world_def_default();
    pe_world *world = make_world(&def);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    pe_body_def box = box_def(0.5, 0.5, 0.5, (pe_vec3){0, 0, 0.45});
    pe_body_id id = add_body(world, &box);
    pe_step_stats first = step(world, H);
    assert_close(first.penetration, 0.05, 1e-9, 0);
    assert_true(first.projection_iterations > 0);
    for (int i = 0; i < 10; ++i) {
        step(world, H);
        assert_at_most(pe_length(state_of(world, id).velocity), 1e-8);
    }
    assert_close(state_of(world, id).position.z, 0.5, def.penetration_slop, 0);
    pe_world_destroy(world);
}

static void test_fast_ball_does_not_tunnel(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    pe_body_def wall = box_def(0.005, 5, 5, (pe_vec3){3, 0, 5});
    wall.is_static = true;
    add_body(world, &wall);
    pe_body_def ball = pe_body_def_default();
    ball.position = (pe_vec3){0, 0, 3};
    ball.velocity = (pe_vec3){200, 0, -150};
    pe_body_id id = add_body(world, &ball);
    for (int i = 0; i < 60; ++i) {
        step(world, H);
        pe_vec3 x = state_of(world, id).position;
        assert_true(x.x <= 2.5 + 1e-3);
        assert_true(x.z >= 0.5 - 1e-3);
    }
    pe_world_destroy(world);
}

/* tr(W)/3 of a contact between a body at x with unit mass and cube inertia 1/6, and the ground or
 * another such cube: each adds 3/m for the translation and 2 |r|^2/I for the rotation. */
static double trace_of(pe_vec3 r)
{
    return 3 + 2 * pe_dot(r, r) * 6;
}

static void test_reported_residual_is_the_contacts_natural_map(void **state)
{
    (void)state;
    enum { N = 4 };
    for (int k = 0; k < 8; ++k) {
        double speed = k < 4 ? 2 : 8; /* slow: it sticks; fast: it slides */
        pe_world_def def = pe_world_def_default();
        pe_world *world = make_world(&def);
        pe_body_id ids[N];
        add_tower(world, N, (pe_material_id){0}, ids);
        pe_body_state push = state_of(world, ids[N - 1]);
        push.velocity = (pe_vec3){speed, 1, 0};
        push.angular_velocity = (pe_vec3){0, 0, 1};
        pe_body_set_state(world, ids[N - 1], &push, NULL);
        pe_vec3 x[N + 2];
        for (int i = 0; i < N; ++i) {
            x[ids[i].index] = state_of(world, ids[i]).position;
        }
        pe_step_stats stats = step(world, H);
        int count = pe_world_get_contacts(world, contacts, MAX_CONTACTS);
        double worst = 0;
        for (int i = 0; i < count; ++i) {
            const pe_contact *c = &contacts[i];
            pe_body_state b = state_of(world, c->body_b);
            pe_vec3 r = pe_sub(c->point, x[c->body_b.index]);
            pe_vec3 u = pe_add(b.velocity, pe_cross(b.angular_velocity, r));
            double w = trace_of(r);
            if (c->body_a.index > 1) {
                pe_body_state a = state_of(world, c->body_a);
                r = pe_sub(c->point, x[c->body_a.index]);
                u = pe_sub(u, pe_add(a.velocity, pe_cross(a.angular_velocity, r)));
                w += trace_of(r);
            }
            w /= 3;
            const double mu = 0.5;
            double un = pe_dot(u, c->normal);
            pe_vec3 ut = pe_madd(u, -un, c->normal);
            /* z = p - (u + mu |u_t| n)/w, and its projection on the cone |z_t| <= mu z_n. */
            pe_vec3 z = pe_madd(c->impulse, -1 / w, pe_madd(u, mu * pe_length(ut), c->normal));
            double zn = pe_dot(z, c->normal);
            pe_vec3 zt = pe_madd(z, -zn, c->normal), onto = z;
            if (mu * pe_length(zt) <= -zn) {
                onto = pe_v3(0, 0, 0);
            } else if (pe_length(zt) > mu * zn) {
                double n = (zn + mu * pe_length(zt)) / (1 + mu * mu);
                onto = pe_madd(pe_scale(n, c->normal), mu * n / pe_length(zt), zt);
            }
            worst = pe_max(worst, w * pe_length(pe_sub(c->impulse, onto)));
        }
        assert_true(stats.residual > 0);
        assert_close(stats.residual, worst, 1e-13, 0);
        pe_world_destroy(world);
    }
}

static void test_no_island_takes_more_iterations_than_allowed(void **state)
{
    (void)state;
    double worst[4];
    for (int k = 0; k < 4; ++k) {
        const int most = 1 << 2 * k;
        pe_world_def def = pe_world_def_default();
        def.max_iterations = most;
        pe_world *world = make_world(&def);
        pe_material_id material = add_material(world, 0.5, 0);
        add_plane(world, pe_v3(0, 0, 1), material);
        /* Balls in a heap that falls apart: not solved in a step or two. */
        for (int i = 0; i < 27; ++i) {
            pe_body_def ball = pe_body_def_default();
            ball.position =
                pe_v3(0.95 * (i % 3) + 0.1 * (i / 9), 0.95 * (i / 3 % 3), 0.5 + 0.95 * (i / 9));
            ball.velocity = pe_v3(0, 0, -2);
            ball.material = material;
            add_body(world, &ball);
        }
        worst[k] = 0;
        for (int n = 0; n < 10; ++n) {
            pe_step_stats stats = step(world, H);
            assert_true(stats.iterations <= most);
            worst[k] = fmax(worst[k], stats.residual);
        }
        print_message("    %d iterations: %g m/s\n", most, worst[k]);
        pe_world_destroy(world);
    }
    assert_true(worst[3] < 0.1 * worst[0]);
    pe_world *world;
    pe_error error;
    pe_world_def def = pe_world_def_default();
    def.max_iterations = 0;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "max_iterations: expected at least 1, found 0");
    def = pe_world_def_default();
    def.impact_bodies = -1;
    assert_int_equal(pe_world_create(&def, &world, &error), PE_BAD_ARGUMENT);
    assert_contains(error.message, "impact_bodies: expected at least 0, found -1");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tower_contact_forces_carry_the_weight_above_them),
        cmocka_unit_test(test_block_below_the_friction_threshold_stays),
        cmocka_unit_test(test_block_above_the_friction_threshold_slides_by_coulomb),
        cmocka_unit_test(test_friction_does_not_depend_on_azimuth),
        cmocka_unit_test(test_ball_bounces_with_newtons_restitution),
        cmocka_unit_test(test_collinear_spheres_collide_by_newtons_law),
        cmocka_unit_test(test_pair_overrides_the_mixing_rule),
        cmocka_unit_test(test_free_box_collision_conserves_momentum),
        cmocka_unit_test(test_coincident_bodies_separate_without_energy_gain),
        cmocka_unit_test(test_separate_stacks_are_independent_islands),
        cmocka_unit_test(test_reported_residual_is_the_contacts_natural_map),
        cmocka_unit_test(test_resting_tower_needs_few_iterations),
        cmocka_unit_test(test_resting_box_takes_few_sweeps_per_step),
        cmocka_unit_test(test_falling_ball_lands_on_the_surface),
        cmocka_unit_test(test_contacts_come_sorted_by_pair),
        cmocka_unit_test(test_overlap_is_pushed_out_without_velocity),
        cmocka_unit_test(test_fast_ball_does_not_tunnel),
        cmocka_unit_test(test_no_island_takes_more_iterations_than_allowed),
    };
    return cmocka_run_group_tests_name("engine_contact", tests, NULL, NULL);
}
