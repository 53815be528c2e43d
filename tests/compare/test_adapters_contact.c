/* Conformance of every adapter of this build, all profiles: that contacts do what they report.
 * Truths: momentum and torque balances, Coulomb's and Newton's laws. */
#include "check.h"
#include "engine_run.h"
#include "engine_shapes.h"
#include "rotation_for_tests.h"

#include <math.h>
#include <string.h>

/* World angular momentum about the centre of mass of a body with principal inertia I. */
static void spin_of(const double inertia[3], const double q[4], const double omega[3],
                    double out[3])
{
    double body[3];
    to_body(q, omega, body);
    for (int i = 0; i < 3; ++i) {
        body[i] *= inertia[i];
    }
    to_world(q, body, out);
}

/* Whether the engine moved the body out of another by hand, with what that changes of its motion: a
 * displacement by neither the old nor the new velocity nor one between. */
static bool was_pushed_out(const pl_body_state *before, const pl_body_state *now, double dt)
{
    double off[3], change[3];
    for (int k = 0; k < 3; ++k) {
        double mean = (before->velocity[k] + now->velocity[k]) / 2;
        off[k] = now->position[k] - before->position[k] - dt * mean;
        change[k] = now->velocity[k] - before->velocity[k];
    }
    const double none[3] = {0, 0, 0};
    return distance(off, none) > dt * distance(change, none) / 2 + 1e-9;
}

/* Whether the body's energy is what it was before, to rounding: an engine has bounded it. */
static bool has_kept_energy(const pl_body *body, const pl_body_state *before,
                            const pl_body_state *now)
{
    double spin[2][3], energy[2];
    const pl_body_state *states[2] = {before, now};
    for (int i = 0; i < 2; ++i) {
        to_body(states[i]->orientation, states[i]->angular_velocity, spin[i]);
        energy[i] = body->mass * g * states[i]->position[2];
        for (int k = 0; k < 3; ++k) {
            const double v = states[i]->velocity[k], w = spin[i][k];
            energy[i] += (body->mass * v * v + body->inertia[k] * w * w) / 2;
        }
    }
    return fabs(energy[1] - energy[0]) < 1e-11 * fabs(energy[0]);
}

/* Linear momentum: m dv = m g h + sum of reported impulses, over one step, for every moving body
 * that was not pushed out of another. An engine that bounds a body's energy may take momentum for
 * it, a ten-thousandth at most. */
static void check_momentum(const engine_run *r, double dt)
{
    for (int b = 0; b < r->scene->body_count; ++b) {
        const pl_body *body = &r->scene->bodies[b];
        const double none[3] = {0, 0, 0};
        if (body->is_static || was_pushed_out(&r->before[b], &r->now[b], dt)) {
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            double impulse = 0, scale = body->mass * g * dt;
            for (int i = 0; i < r->contact_count; ++i) {
                const pl_contact *contact = &r->contacts[i];
                int sign = contact->body_b == b ? 1 : contact->body_a == b ? -1 : 0;
                impulse += sign * contact->impulse[k];
                scale = fmax(scale, fabs(contact->impulse[k]));
            }
            double change = body->mass * (r->now[b].velocity[k] - r->before[b].velocity[k] -
                                          r->scene->gravity[k] * dt);
            const double bounded = has_kept_energy(body, &r->before[b], &r->now[b])
                                       ? 1e-4 * body->mass * distance(r->now[b].velocity, none)
                                       : 0;
            assert_close(change, impulse, (1e-10 + force_mismatch(&r->choice)) * scale + bounded,
                         0);
        }
    }
}

static void check_normals(const engine_run *r)
{
    for (int i = 0; i < r->contact_count; ++i) {
        const pl_contact *contact = &r->contacts[i];
        const double *n = contact->normal, *p = contact->impulse;
        assert_close(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-12, 0);
        /* Contacts push: on B, along the normal. */
        assert_at_most(-(n[0] * p[0] + n[1] * p[1] + n[2] * p[2]), 1e-12);
    }
}

static bool touched(const engine_run *r)
{
    for (int i = 0; i < r->contact_count; ++i) {
        if (distance(r->contacts[i].impulse, (double[]){0, 0, 0}) > 0) {
            return true;
        }
    }
    return false;
}

static void lowest_corner(const pl_shape *shape, const pl_body_state *state, double lowest[3])
{
    lowest[2] = INFINITY;
    for (int corner = 0; corner < 8; ++corner) {
        double local[3], world[3];
        for (int k = 0; k < 3; ++k) {
            local[k] = (corner >> k & 1 ? 1 : -1) * shape->half_extents[k];
        }
        to_world(state->orientation, local, world);
        for (int k = 0; k < 3; ++k) {
            world[k] += state->position[k];
        }
        if (world[2] < lowest[2]) {
            memcpy(lowest, world, 3 * sizeof *lowest);
        }
    }
}

/* A tilted box, not spinning, drops on one corner. `floor_index` is 0 or 1: the order of the
 * bodies. The floor's top is at 0, whether it is a plane or a slab. */
static void corner_drop(const pl_engine_choice *choice, int floor_index, bool slab)
{
    pl_body ground = floor_body();
    if (slab) {
        /* As large as the box within a factor of two: ODE's space pairs such shapes in either
         * order. */
        ground.shape = pl_shape_box(0.45, 0.45, 0.45);
        ground.position[2] = -0.45;
    }
    int box_index = 1 - floor_index;
    double dt = 1.0 / 240;
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.4, 0);
    pl_body box = box_body(2, 0.5, 0.3, 0.2);
    check_random random = {5};
    check_quaternion(&random, box.orientation);
    memcpy(box.velocity, (double[]){0.7, -0.4, -1.5}, sizeof box.velocity);
    box.position[2] = 0.7;
    put_body(&scene, floor_index == 0 ? ground : box);
    put_body(&scene, floor_index == 0 ? box : ground);
    const pl_body *body = &scene.bodies[box_index];

    engine_run r;
    scene.dt = dt;
    engine_start(&r, choice, &scene);
    int steps = 0;
    do {
        engine_step(&r);
        check_momentum(&r, dt);
        assert_true(++steps < 240);
    } while (!touched(&r));

    double corner[3] = {0}, torque[3] = {0}, spin[3];
    lowest_corner(&body->shape, &r.before[box_index], corner);
    for (int i = 0; i < r.contact_count; ++i) {
        const pl_contact *contact = &r.contacts[i];
        double up = contact->body_b == box_index ? 1 : -1;
        assert_int_equal(contact->body_a + contact->body_b, 1);
        assert_close(up * contact->normal[2], 1, 1e-12, 0);
        assert_true(up * contact->impulse[2] > 0);
        assert_at_most(distance(contact->point, corner), 0.02);
        double share = depth_share(choice, PL_SHAPE_BOX, slab ? PL_SHAPE_BOX : PL_SHAPE_PLANE);
        const bool later = r.has_times && r.times[i].begin > 0; /* when the corner is there */
        assert_close(contact->separation, later ? 0 : share * corner[2], 1e-8, 0);
        double arm[3], twist[3];
        engine_contact_arm(&r, i, box_index, arm);
        cross(arm, contact->impulse, twist);
        for (int k = 0; k < 3; ++k) {
            torque[k] += up * twist[k];
        }
    }
    /* It did not spin before, so no gyroscopic torque takes part in this step. */
    spin_of(body->inertia, r.before[box_index].orientation, r.now[box_index].angular_velocity,
            spin);
    double size = distance(spin, (double[]){0, 0, 0});
    assert_true(size > 0.05);
    assert_at_most(distance(spin, torque), 0.05 * size);
    for (int n = 0; n < 120; ++n) {
        engine_step(&r);
        check_momentum(&r, dt);
        if (solves_coulomb(choice)) {
            check_normals(&r);
        }
    }
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void law_corner_drop(const pl_engine_choice *choice)
{
    if (choice->engine->contacts != 0) {
        for (int i = 0; i < 4; ++i) {
            corner_drop(choice, i % 2, i / 2 == 1);
        }
    }
}

static void test_corner_impact_balances_momentum_and_torque(void **state)
{
    (void)state;
    for_each_profile(law_corner_drop);
}

/* Two bodies meet off centre without gravity: what one gains the other loses. Two meshes touch
 * triangle by triangle, with normals of their own. */
static void pair_impact(const pl_engine_choice *choice, pl_shape_kind first, pl_shape_kind second)
{
    double dt = 1.0 / 120;
    bool meshes = first == PL_SHAPE_MESH && second == PL_SHAPE_MESH;
    /* btNNCGConstraintSolver ends every sweep, the last too, by a step beyond what the sweep
     * bounded, and the Lemke solver's rounding is large: of several points one may pull. */
    bool bounds = solves_coulomb(choice) && strcmp(choice->spec, "bullet:nncg") != 0;
    pl_scene scene = pl_scene_default();
    memset(scene.gravity, 0, sizeof scene.gravity);
    put_material(&scene, "stone", 0.3, 0);
    for (int i = 0; i < 2; ++i) {
        const double at[3] = {1.5 * i, 0.1 * i, 0.2 * i};
        pl_body body = solid_body(&scene, i == 0 ? first : second, 0.4, at, 1, 0.7 + 0.4 * i);
        body.mass = 1 + 2 * i;
        body.velocity[0] = i == 0 ? 2 : -1;
        put_body(&scene, body);
    }
    engine_run r;
    scene.dt = dt;
    engine_start(&r, choice, &scene);
    bool met = false;
    for (int n = 0; n < 120; ++n) {
        engine_step(&r);
        check_momentum(&r, dt);
        if (bounds || r.contact_count == 1) {
            check_normals(&r);
        }
        for (int i = 0; touched(&r) && i < r.contact_count; ++i) {
            /* The first body comes along x, and so does its outward normal. */
            const pl_contact *contact = &r.contacts[i];
            double from_first = contact->body_a == 0 ? 1 : -1;
            assert_true(meshes || met || from_first * contact->normal[0] > 0);
        }
        met = met || touched(&r);
    }
    assert_true(met);
    /* The Lemke solver once drew a hull and a mesh together in place of parting them. */
    assert_true(!solves_coulomb(choice) ||
                (r.now[0].velocity[0] < 1.5 && r.now[1].velocity[0] > -0.9));
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void law_pair_impact(const pl_engine_choice *choice)
{
    if (choice->engine->contacts == 0) {
        return;
    }
    for (int a = PL_SHAPE_SPHERE; a < PL_SHAPE_KIND_COUNT; ++a) {
        for (int b = PL_SHAPE_SPHERE; b < PL_SHAPE_KIND_COUNT; ++b) {
            if (knows(choice, (pl_shape_kind)a) && knows(choice, (pl_shape_kind)b)) {
                pair_impact(choice, (pl_shape_kind)a, (pl_shape_kind)b);
            }
        }
    }
}

static void test_pair_impact_reports_equal_and_opposite_impulses(void **state)
{
    (void)state;
    for_each_profile(law_pair_impact);
}

static void law_rest(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_with_block(0.5, 1, 0.5, 0.5);
    engine_run r;
    scene.dt = 1.0 / 60;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < 120; ++n) {
        engine_step(&r);
    }
    double sum[3] = {0}, weight = g / 60;
    for (int i = 0; i < r.contact_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            sum[k] += r.contacts[i].impulse[k];
        }
    }
    if (choice->engine->contacts != 0) {
        print_message("      weight off by %.1e, sideways %.1e\n", sum[2] / weight - 1,
                      hypot(sum[0], sum[1]) / weight);
        assert_close(sum[2], weight, 0, 1e-3);
        assert_close(hypot(sum[0], sum[1]), 0, 1e-3 * weight, 0);
    }
    assert_close(r.now[1].position[2], 0.5, 2e-3, 0);
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void test_contact_impulses_of_resting_box_balance_its_weight(void **state)
{
    (void)state;
    for_each_profile(law_rest);
}

/* A block on a slope of 20 degrees that friction holds: m g cos on the slab, m g sin up the slope.
 * The contacts act on the block as body A and as body B, and from a slab that stands turned. What
 * the block gains in the step is no part of the weight. */
static void slope_rest(const pl_engine_choice *choice, int block_index)
{
    const double angle = 20 * acos(-1) / 180, dt = 1.0 / 60;
    const double up[3] = {sin(angle), 0, cos(angle)}, along[3] = {-cos(angle), 0, sin(angle)};
    const double turned[4] = {cos(angle / 2), 0, sin(angle / 2), 0};
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.8, 0);
    pl_body slab = box_body(1, 5, 5, 0.5), block = box_body(2, 0.5, 0.5, 0.25);
    slab.is_static = true;
    for (int k = 0; k < 3; ++k) {
        slab.position[k] = -0.5 * up[k];
        block.position[k] = 0.25 * up[k];
    }
    memcpy(slab.orientation, turned, sizeof turned);
    memcpy(block.orientation, turned, sizeof turned);
    put_body(&scene, block_index == 0 ? block : slab);
    put_body(&scene, block_index == 0 ? slab : block);
    engine_run r;
    scene.dt = dt;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < 120; ++n) {
        engine_step(&r);
    }
    double normal = 0, tangent = 0, weight = scene.bodies[block_index].mass * g * dt;
    for (int i = 0; i < r.contact_count; ++i) {
        double sign = r.contacts[i].body_b == block_index ? 1 : -1;
        for (int k = 0; k < 3; ++k) {
            normal += sign * r.contacts[i].impulse[k] * up[k];
            tangent += sign * r.contacts[i].impulse[k] * along[k];
        }
    }
    for (int k = 0; k < 3; ++k) {
        double change = r.now[block_index].velocity[k] - r.before[block_index].velocity[k];
        normal -= scene.bodies[block_index].mass * change * up[k];
        tangent -= scene.bodies[block_index].mass * change * along[k];
    }
    print_message("      normal off by %.1e, tangential %.1e of the weight\n",
                  normal / weight - cos(angle), tangent / weight - sin(angle));
    double tolerance = 1e-12 + force_mismatch(choice);
    assert_close(normal, weight * cos(angle), tolerance * weight, 0);
    assert_close(tangent, weight * sin(angle), tolerance * weight, 0);
    const double *rest = scene.bodies[block_index].position;
    assert_at_most(distance(r.now[block_index].position, rest), 0.02);
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void law_slope_rest(const pl_engine_choice *choice)
{
    if (choice->engine->contacts != 0 && solves_coulomb(choice)) {
        slope_rest(choice, 1);
        slope_rest(choice, 0);
    }
}

static void test_contact_impulses_on_a_slope_balance_the_weight(void **state)
{
    (void)state;
    for_each_profile(law_slope_rest);
}

/* m dv_x = -mu N for a flat block that slides along x on a slab, where the impulse N of the slab is
 * m (g t + dv_z): MuJoCo's contacts lift a block that slides, so that it hops. The slab is a box, because
 * Bullet with default settings makes one point a step against a plane, and a block that hops on it
 * shows no clean friction. */
static void law_slide(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    pl_scene scene = scene_of_pairs(choice);
    scene.bodies[0].shape = pl_shape_box(20, 20, 0.5);
    scene.bodies[0].position[2] = -0.5;
    pl_body block = box_body(2, 0.5, 0.5, 0.1);
    block.material = 1;
    block.position[2] = 0.1;
    put_body(&scene, block);
    scene.bodies[1].velocity[0] = 4;
    engine_run r;
    scene.dt = 1.0 / 240;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < 24; ++n) {
        engine_step(&r);
    }
    double from = r.now[1].velocity[0], rise = r.now[1].velocity[2];
    for (int n = 0; n < 120; ++n) {
        engine_step(&r);
    }
    double pressed = g * 0.5 + r.now[1].velocity[2] - rise;
    double friction = (from - r.now[1].velocity[0]) / pressed;
    print_message("      friction %.6f, asked 0.35\n", friction);
    assert_close(friction, 0.35, 0, 0.01);
    assert_close(r.now[1].velocity[1], 0, 0.01, 0);
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void test_sliding_block_slows_by_the_pairs_friction(void **state)
{
    (void)state;
    for_each_profile(law_slide);
}

/* The ball starts at the floor: Bullet's contacts hold a ball back that would touch only within the
 * step, and so swallow part of a bounce at small steps. */
static void bounce_at(const pl_engine_choice *choice, double speed)
{
    if (!solves_coulomb(choice) || !has_restitution(choice)) {
        return;
    }
    pl_scene scene = scene_of_pairs(choice);
    pl_body ball = pl_body_default();
    ball.shape = pl_shape_sphere(0.5);
    ball.material = 1;
    ball.position[2] = 0.5;
    ball.velocity[2] = -speed;
    put_body(&scene, ball);
    engine_run r;
    const double dt = 1.0 / 1000;
    scene.dt = dt;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < 5; ++n) {
        engine_step(&r);
    }
    /* The impact takes one of these steps; engines count its gravity before the impact or after. */
    assert_close(r.now[1].velocity[2], 0.6 * speed - 4.5 * g * dt, 0.9 * g * dt, 0);
    engine_finish(&r);
    pl_scene_free(&scene);
}

/* Slow balls bounce as well. */
static void law_bounce(const pl_engine_choice *choice)
{
    bounce_at(choice, 4);
    bounce_at(choice, 0.4);
}

static void test_ball_bounces_with_the_pairs_restitution(void **state)
{
    (void)state;
    for_each_profile(law_bounce);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_corner_impact_balances_momentum_and_torque),
        cmocka_unit_test(test_pair_impact_reports_equal_and_opposite_impulses),
        cmocka_unit_test(test_contact_impulses_of_resting_box_balance_its_weight),
        cmocka_unit_test(test_contact_impulses_on_a_slope_balance_the_weight),
        cmocka_unit_test(test_sliding_block_slows_by_the_pairs_friction),
        cmocka_unit_test(test_ball_bounces_with_the_pairs_restitution),
    };
    return cmocka_run_group_tests_name("adapters contact", tests, NULL, NULL);
}
