/* What a transform carries is carried as the thing it is: places, vectors, pseudovectors, tensors,
 * solids; and copies and restarts are of the same problem. */
#include "check.h"
#include "plumb/vec.h"
#include "polyhedra.h"
#include "referee/geometry/solid.h"
#include "studies/metamorphic/transform.h"
#include "transformed.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

/* M in the long way: what a vector becomes, by the check's own words. */
static pl_vec carried(const pl_check *check, pl_vec v)
{
    const double c = cos(check->amount * 0.78539816339744831),
                 s = sin(check->amount * 0.78539816339744831);
    if (check->kind == PL_CHECK_MIRROR) {
        return (pl_vec){v.x, -v.y, v.z};
    }
    if (check->kind != PL_CHECK_ROTATE) {
        return v;
    }
    return check->axis == 2 ? (pl_vec){c * v.x - s * v.y, s * v.x + c * v.y, v.z}
                            : (pl_vec){v.x, c * v.y - s * v.z, s * v.y + c * v.z};
}

static void assert_vec(pl_vec actual, pl_vec expected)
{
    double a[3], e[3];
    pl_vec_store(actual, a);
    pl_vec_store(expected, e);
    assert_vectors(a, e, 1e-13, 1e-13);
}

/* A tilted plane, and a hull, a mesh, a box and a capsule askew in flight, all pushed. */
static pl_scene crooked_scene(void)
{
    check_random random = {11};
    pl_error error = {.message = ""};
    pl_scene scene = pl_scene_default();
    snprintf(scene.name, sizeof scene.name, "crooked");
    const pl_material material = {.name = "stone", .friction = 0.5};
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, &error), PL_OK);
    pl_vec_store((pl_vec){1.5, -2.5, -9}, scene.gravity);
    const pl_polyhedron *hull = random_hull(&scene, &random, 12);
    const pl_polyhedron *mesh = mesh_of(&scene, random_hull(&scene, &random, 9));
    const pl_shape shapes[] = {pl_shape_plane(0.6, 0, 0.8, -40), pl_shape_of(hull),
                               pl_shape_of(mesh), pl_shape_box(0.1, 0.2, 0.3),
                               pl_shape_capsule(0.2, 0.4)};
    for (int i = 0; i < 5; ++i) {
        pl_body body = pl_body_default();
        snprintf(body.name, sizeof body.name, "body %d", i);
        body.shape = shapes[i];
        body.is_static = i == 0;
        body.mass = 1 + i;
        for (int k = 0; k < 3 && i > 0; ++k) {
            body.position[k] = check_uniform(&random, -3, 3) + 9 * i;
            body.velocity[k] = check_uniform(&random, -3, 3);
            body.angular_velocity[k] = check_uniform(&random, -3, 3);
        }
        check_quaternion(&random, body.orientation);
        assert_int_equal(pl_scene_add_body(&scene, &body, NULL, &error), PL_OK);
        for (int frame = 0; frame < 2 && i > 0; ++frame) {
            pl_force force = {.body = i, .frame = (pl_force_frame)frame, .from = 0.5, .until = 2};
            for (int k = 0; k < 3; ++k) {
                force.force[k] = check_uniform(&random, -3, 3);
                force.at[k] = check_uniform(&random, -1, 1);
            }
            assert_int_equal(pl_scene_add_force(&scene, &force, &error), PL_OK);
        }
    }
    assert_int_equal(pl_scene_validate(&scene, &error), PL_OK);
    return scene;
}

/* The velocity of the material point at `arm` from the centre of mass. */
static pl_vec point_velocity(const pl_body *body, pl_vec arm)
{
    return pl_vec_add(pl_vec_of(body->velocity),
                      pl_vec_cross(pl_vec_of(body->angular_velocity), arm));
}

static void world_force(const pl_scene *scene, const pl_force *force, pl_vec *f, pl_vec *at)
{
    pl_axes axes = pl_axes_of(scene->bodies[force->body].orientation);
    bool turns = force->frame == PL_FRAME_BODY;
    *f = turns ? pl_to_world(&axes, pl_vec_of(force->force)) : pl_vec_of(force->force);
    *at = turns ? pl_to_world(&axes, pl_vec_of(force->at)) : pl_vec_of(force->at);
}

/* v . I v */
static double inertia_along(const pl_body *body, pl_vec v)
{
    pl_axes axes = pl_principal_axes(&body->shape, body->orientation);
    pl_vec local = pl_to_local(&axes, v);
    return body->inertia[0] * local.x * local.x + body->inertia[1] * local.y * local.y +
           body->inertia[2] * local.z * local.z;
}

static void check_body_laws(const pl_check *check, const pl_transform *t, const pl_body *was,
                            const pl_body *is)
{
    const double s = t->scale;
    const pl_vec probes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, -0.7, 0.5}};
    pl_vec from = pl_centre_of_mass(&was->shape, was->position, was->orientation);
    pl_vec to = pl_centre_of_mass(&is->shape, is->position, is->orientation);
    assert_vec(to, pl_vec_add(pl_vec_scale(carried(check, from), s), pl_vec_of(t->shift)));
    for (int i = 0; i < 4; ++i) {
        pl_vec there = carried(check, probes[i]);
        assert_vec(point_velocity(is, pl_vec_scale(there, s)),
                   pl_vec_scale(carried(check, point_velocity(was, probes[i])), sqrt(s)));
        assert_close(inertia_along(is, there), pow(s, 5) * inertia_along(was, probes[i]), 0, 1e-13);
    }
}

/* Every vertex of a solid is where its image is, and its surface still faces outward. */
static void check_solid_laws(const pl_check *check, const pl_transform *t, const pl_body *was,
                             const pl_body *is)
{
    const pl_polyhedron *p = was->shape.polyhedron, *q = is->shape.polyhedron;
    pl_axes from = pl_axes_of(was->orientation), to = pl_axes_of(is->orientation);
    double volume = 0;
    for (int i = 0; i < p->vertex_count; ++i) {
        pl_vec x =
            pl_vec_add(pl_vec_of(was->position), pl_to_world(&from, pl_vec_of(p->vertices[i])));
        pl_vec y = pl_vec_add(pl_vec_of(is->position), pl_to_world(&to, pl_vec_of(q->vertices[i])));
        assert_vec(y, pl_vec_add(pl_vec_scale(carried(check, x), t->scale), pl_vec_of(t->shift)));
    }
    for (int i = 0; i < q->triangle_count; ++i) {
        const int *v = q->triangles[i];
        volume +=
            pl_vec_dot(pl_vec_of(q->vertices[v[0]]),
                       pl_vec_cross(pl_vec_of(q->vertices[v[1]]), pl_vec_of(q->vertices[v[2]]))) /
            6;
    }
    assert_close(volume, pow(t->scale, 3) * p->volume, 0, 1e-12);
    assert_close(q->volume, volume, 0, 1e-12);
}

static void check_force_laws(const pl_check *check, const pl_transform *t, const pl_scene *was,
                             const pl_scene *is)
{
    const double s = t->scale, handed = check->kind == PL_CHECK_MIRROR ? -1 : 1;
    for (int i = 0; i < was->force_count; ++i) {
        pl_vec f, at, g, to;
        world_force(was, &was->forces[i], &f, &at);
        world_force(is, &is->forces[i], &g, &to);
        assert_vec(g, pl_vec_scale(carried(check, f), s * s * s));
        assert_vec(pl_vec_cross(to, g),
                   pl_vec_scale(carried(check, pl_vec_cross(at, f)), handed * s * s * s * s));
        assert_close(is->forces[i].until / is->dt, was->forces[i].until / was->dt, 0, 1e-15);
    }
}

static void test_points_vectors_and_tensors_are_carried_as_such(void **state)
{
    (void)state;
    pl_scene was = crooked_scene();
    for (int i = 0; i < PL_CHECK_COUNT; ++i) {
        const pl_check *check = &pl_checks[i];
        if (check->kind == PL_CHECK_ORDER || check->kind == PL_CHECK_SHIFT) {
            continue;
        }
        const pl_transform t = transform_of(check, &was);
        pl_scene is = transformed(&t, &was);
        assert_vec(pl_vec_of(is.gravity), carried(check, pl_vec_of(was.gravity)));
        const pl_shape *floor = &is.bodies[0].shape;
        assert_vec(pl_vec_of(floor->normal), carried(check, pl_vec_of(was.bodies[0].shape.normal)));
        assert_close(floor->offset, t.scale * was.bodies[0].shape.offset, 0, 1e-15);
        for (int k = 1; k < was.body_count; ++k) {
            check_body_laws(check, &t, &was.bodies[k], &is.bodies[k]);
        }
        check_solid_laws(check, &t, &was.bodies[1], &is.bodies[1]);
        check_solid_laws(check, &t, &was.bodies[2], &is.bodies[2]);
        check_force_laws(check, &t, &was, &is);
        pl_scene_free(&is);
    }
    pl_scene_free(&was);
}

static void test_quarter_turns_are_exact(void **state)
{
    (void)state;
    pl_scene was = crooked_scene();
    const pl_transform z = pl_transform_rotation(2, 2), x = pl_transform_rotation(0, 2);
    pl_scene turned = transformed(&z, &was), tipped = transformed(&x, &was);
    const double *g = was.gravity;
    assert_true(turned.gravity[0] == -g[1] && turned.gravity[1] == g[0] &&
                turned.gravity[2] == g[2]);
    assert_true(tipped.gravity[0] == g[0] && tipped.gravity[1] == -g[2] &&
                tipped.gravity[2] == g[1]);
    const double *n = turned.bodies[0].shape.normal;
    assert_true(n[0] == 0 && n[1] == 0.6 && n[2] == 0.8);
    pl_scene_free(&was);
    pl_scene_free(&turned);
    pl_scene_free(&tipped);
}

static void test_translated_plane_keeps_its_distance_from_bodies(void **state)
{
    (void)state;
    pl_scene was = crooked_scene();
    pl_transform t = pl_transform_identity();
    t.shift[0] = 1000;
    pl_scene is = transformed(&t, &was);
    for (int i = 1; i < was.body_count; ++i) {
        const pl_shape *a = &was.bodies[0].shape, *b = &is.bodies[0].shape;
        double before =
            pl_vec_dot(pl_vec_of(a->normal), pl_vec_of(was.bodies[i].position)) - a->offset;
        double after =
            pl_vec_dot(pl_vec_of(b->normal), pl_vec_of(is.bodies[i].position)) - b->offset;
        assert_close(after, before, 4 * DBL_EPSILON * 1000, 0);
    }
    pl_scene_free(&was);
    pl_scene_free(&is);
}

static void test_every_order_is_a_permutation(void **state)
{
    (void)state;
    const pl_body_order orders[] = {PL_ORDER_SAME, PL_ORDER_REVERSED, PL_ORDER_SHUFFLED};
    for (int k = 0; k < 3; ++k) {
        const pl_transform t = {.order = orders[k]};
        for (int n = 1; n <= 60; ++n) {
            bool seen[60] = {false};
            for (int i = 0; i < n; ++i) {
                int index = pl_transform_index(&t, i, n);
                assert_true(index >= 0 && index < n && !seen[index]);
                seen[index] = true;
            }
        }
    }
}

/* ---- Copies and restarts ---- */

static void test_far_copy_is_on_the_same_planes(void **state)
{
    (void)state;
    pl_scene was = crooked_scene();
    pl_transform t = pl_transform_identity();
    const double *offset = t.copy_offset;
    t.has_copy = pl_far_offset(&was, 1e4, t.copy_offset);
    assert_true(t.has_copy);
    pl_scene is = transformed(&t, &was);
    assert_int_equal(is.body_count, 2 * was.body_count - 1);
    assert_int_equal(is.force_count, 2 * was.force_count);
    const double *normal = was.bodies[0].shape.normal;
    assert_close(pl_vec_dot(pl_vec_of(offset), pl_vec_of(normal)), 0, 0, 0);
    assert_close(pl_vec_length(pl_vec_of(offset)), 1e4 * pl_scene_size(&was), 0, 1e-12);
    for (int i = 1; i < was.body_count; ++i) {
        const pl_body *copy = &is.bodies[was.body_count + i - 1];
        assert_memory_equal(is.bodies[i].position, was.bodies[i].position, sizeof copy->position);
        assert_memory_equal(copy->velocity, was.bodies[i].velocity, sizeof copy->velocity);
        assert_ptr_equal(copy->shape.polyhedron, is.bodies[i].shape.polyhedron);
    }
    pl_scene_free(&was);
    pl_scene_free(&is);
}

static void test_planes_in_all_directions_prevent_a_copy(void **state)
{
    (void)state;
    double offset[3];
    pl_error error = {.message = ""};
    pl_scene scene = crooked_scene();
    const double normals[][3] = {{0, 0.6, 0.8}, {0.8, 0, -0.6}};
    for (int i = 0; i < 2; ++i) {
        pl_body wall = pl_body_default();
        snprintf(wall.name, sizeof wall.name, "wall %d", i);
        wall.is_static = true;
        wall.shape = pl_shape_plane(normals[i][0], normals[i][1], normals[i][2], -50);
        assert_int_equal(pl_scene_add_body(&scene, &wall, NULL, &error), PL_OK);
        /* Two planes leave the line in which they meet. */
        assert_int_equal(pl_far_offset(&scene, 1e4, offset), i == 0);
        for (int k = 0; k < 2 && i == 0; ++k) {
            const double *n = scene.bodies[k == 0 ? 0 : 5].shape.normal;
            assert_close(pl_vec_dot(pl_vec_of(offset), pl_vec_of(n)), 0, 1e-9, 0);
        }
    }
    pl_scene_free(&scene);
}

static void test_a_restart_goes_on_with_states_and_forces(void **state)
{
    (void)state;
    pl_error error = {.message = ""};
    pl_scene was = crooked_scene(), is;
    pl_body_state states[5];
    was.duration = 4;
    for (int i = 0; i < 5; ++i) {
        states[i] = pl_body_start(&was.bodies[i]);
        states[i].position[1] += 3;
    }
    was.forces[0].until = 1;
    was.forces[1].from = 1.5;
    assert_int_equal(pl_restart_scene(&was, states, 60, &is, &error), PL_OK);
    assert_int_equal(pl_scene_steps(&is), pl_scene_steps(&was) - 60);
    assert_int_equal(is.force_count, was.force_count - 1); /* the first ended at that time */
    assert_close(is.forces[0].from, 0.5, 1e-12, 0);
    assert_close(is.forces[0].until, 1, 1e-12, 0);
    assert_close(is.forces[1].from, 0, 0, 0);
    for (int i = 1; i < 5; ++i) {
        assert_memory_equal(is.bodies[i].position, states[i].position, sizeof states[i].position);
        assert_memory_equal(is.bodies[i].angular_velocity, states[i].angular_velocity,
                            sizeof states[i].angular_velocity);
    }
    pl_scene_free(&was);
    pl_scene_free(&is);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_vectors_and_tensors_are_carried_as_such),
        cmocka_unit_test(test_quarter_turns_are_exact),
        cmocka_unit_test(test_translated_plane_keeps_its_distance_from_bodies),
        cmocka_unit_test(test_every_order_is_a_permutation),
        cmocka_unit_test(test_far_copy_is_on_the_same_planes),
        cmocka_unit_test(test_planes_in_all_directions_prevent_a_copy),
        cmocka_unit_test(test_a_restart_goes_on_with_states_and_forces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
