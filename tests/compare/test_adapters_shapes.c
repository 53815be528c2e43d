/* Conformance of every adapter of this build, all profiles: capsules, cylinders, hulls and meshes.
 * Truths: the scene itself, and depths, normals and rest heights in closed form. */
#include "check.h"
#include "engine_run.h"
#include "engine_shapes.h"
#include "polyhedra.h"
#include "rotation_for_tests.h"

#include <dlfcn.h>
#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static pl_scene empty_scene(void)
{
    pl_scene scene = pl_scene_default();
    put_material(&scene, "stone", 0.5, 0);
    return scene;
}

/* Of hulls and meshes, which have random points, one moves and one is static. */
static pl_scene scene_of_shapes(const pl_engine_choice *choice)
{
    static const pl_shape_kind kinds[] = {PL_SHAPE_CAPSULE, PL_SHAPE_CYLINDER, PL_SHAPE_HULL,
                                          PL_SHAPE_HULL,    PL_SHAPE_MESH,     PL_SHAPE_MESH};
    pl_scene scene = empty_scene();
    check_random random = {77};
    for (int i = 0; i < (int)(sizeof kinds / sizeof *kinds); ++i) {
        if (!knows(choice, kinds[i])) {
            continue;
        }
        pl_body body = pl_body_default();
        body.mass = 1.7 + i;
        if (kinds[i] >= PL_SHAPE_HULL) {
            const pl_polyhedron *hull = random_hull(&scene, &random, 12);
            body.shape = pl_shape_of(kinds[i] == PL_SHAPE_HULL ? hull : mesh_of(&scene, hull));
            body.is_static = i % 2 == 1;
        } else {
            body = solid_body(&scene, kinds[i], 0.5, body.position, 0, 0);
        }
        check_quaternion(&random, body.orientation);
        memcpy(body.position, (double[]){4 * i, -3, 2}, sizeof body.position);
        if (!body.is_static) {
            memcpy(body.velocity, (double[]){0.1, -0.2, 0.3}, sizeof body.velocity);
            memcpy(body.angular_velocity, (double[]){1, -2, 0.5}, sizeof body.angular_velocity);
        }
        put_body(&scene, body);
    }
    return scene;
}

static void law_read_back(const pl_engine_choice *choice)
{
    pl_scene scene = scene_of_shapes(choice);
    engine_run r;
    scene.dt = 1.0 / 60;
    engine_start(&r, choice, &scene);
    double mass[MOST_BODIES], inertia[MOST_BODIES][3];
    pl_engine_settings settings = {
        .mass = mass, .inertia = inertia, .body_count = scene.body_count};
    pl_session_read_settings(&r.session, &settings);
    for (int b = 0; b < scene.body_count; ++b) {
        const pl_body *body = &scene.bodies[b];
        double share = body->is_static ? 0 : 1;
        assert_close(mass[b], share * body->mass, 0, 1e-15);
        for (int k = 0; k < 3; ++k) {
            assert_close(inertia[b][k], share * body->inertia[k], 0, 1e-14);
        }
    }
    for (int n = 0; n < 3; ++n) {
        for (int b = 0; b < scene.body_count; ++b) {
            const pl_body *body = &scene.bodies[b];
            if (n == 0 || body->is_static) {
                assert_at_most(distance(r.now[b].position, body->position), 1e-14);
                assert_at_most(angle_between(r.now[b].orientation, body->orientation), 1e-14);
                assert_at_most(distance(r.now[b].velocity, body->velocity), 1e-15);
                assert_at_most(distance(r.now[b].angular_velocity, body->angular_velocity), 1e-15);
            }
        }
        engine_step(&r);
    }
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void test_every_shape_reads_back_pose_mass_and_inertia(void **state)
{
    (void)state;
    for_each_profile(law_read_back);
}

/* The deepest contact of a moving body above a static one, the normal towards the moving one. */
static pl_contact deepest_contact(const pl_engine_choice *choice, pl_scene *scene, pl_body below,
                                  pl_body above, bool below_is_first)
{
    pl_contact deepest = {.separation = INFINITY};
    memset(scene->gravity, 0, sizeof scene->gravity);
    below.is_static = true;
    int low = put_body(scene, below_is_first ? below : above);
    int high = put_body(scene, below_is_first ? above : below);
    engine_run r;
    scene->dt = 1e-4;
    engine_start(&r, choice, scene);
    engine_step(&r);
    for (int i = 0; i < r.contact_count; ++i) {
        assert_int_equal(r.contacts[i].body_a + r.contacts[i].body_b, low + high);
        if (r.contacts[i].separation < deepest.separation) {
            deepest = r.contacts[i];
        }
    }
    for (int k = 0; k < 3 && (deepest.body_a == low) != below_is_first; ++k) {
        deepest.normal[k] = -deepest.normal[k];
    }
    engine_finish(&r);
    return deepest;
}

static void check_contact(const char *below, const char *above, const pl_contact *contact,
                          double depth, double tolerance, double sideways)
{
    double aside = distance(contact->normal, (double[]){0, 0, 1});
    if (!(fabs(contact->separation + depth) <= tolerance && aside <= sideways)) {
        print_error("%s on %s: separation %.9g, normal %g %g %g\n", above, below,
                    contact->separation, contact->normal[0], contact->normal[1],
                    contact->normal[2]);
    }
    assert_close(contact->separation, -depth, tolerance, 0);
    assert_at_most(aside, sideways);
}

/* The upper body lies 1 cm deep in the top of the lower one, a little aside and turned about z, so
 * that no edges meet; a round top touches on its axis. ODE keeps meshes in single precision, and
 * its search in hulls stops at 1e-6. MuJoCo's search stops at 1e-6 too, with a normal that is less
 * exact. Two meshes are left out: engines meet them triangle by
 * triangle, and triangles that lie in each other have no one depth. */
static void law_faces(const pl_engine_choice *choice)
{
    double sideways = strcmp(choice->engine->name, "mujoco") == 0 ? 1e-3 : 1e-4;
    for (int low = PL_SHAPE_PLANE; low < PL_SHAPE_KIND_COUNT; ++low) {
        for (int high = PL_SHAPE_SPHERE; high < PL_SHAPE_KIND_COUNT; ++high) {
            pl_shape_kind a = (pl_shape_kind)low, b = (pl_shape_kind)high;
            if (a == PL_SHAPE_MESH && b == PL_SHAPE_MESH) {
                continue;
            }
            double aside = a == PL_SHAPE_SPHERE || a == PL_SHAPE_CAPSULE ? 0 : 0.1;
            const double at[3] = {aside, aside / 2, 0.5 + 0.3 - 0.01};
            for (int order = 0; order < 2 && knows(choice, a) && knows(choice, b); ++order) {
                pl_scene scene = empty_scene();
                pl_body below = solid_body(&scene, a, 0.5, (double[]){0, 0, 0}, 0, 0);
                pl_body above = solid_body(&scene, b, 0.3, at, 2, 0.3);
                pl_contact contact = deepest_contact(choice, &scene, below, above, order == 0);
                check_contact(kind_name(a), kind_name(b), &contact,
                              0.01 * depth_share(choice, a, b), 2e-6, sideways);
                pl_scene_free(&scene);
            }
        }
    }
}

static void test_face_contacts_have_true_depth_and_normal_direction(void **state)
{
    (void)state;
    for_each_profile(law_faces);
}

/* The lowest point of a solid of widths h upwards and r in the plane of the tilt is h cos + r sin
 * below its middle, of a capsule (h / 2) (cos + 1). Bullet rounds a cylinder's rim by its margin m,
 * which takes m (cos + sin - 1) from that. ODE's meshes are in single precision. */
static void law_tilted(const pl_engine_choice *choice)
{
    static const pl_shape_kind kinds[] = {PL_SHAPE_CAPSULE, PL_SHAPE_CYLINDER, PL_SHAPE_HULL,
                                          PL_SHAPE_MESH};
    double c = cos(0.5), s = sin(0.5), half = 0.5, depth = 0.03;
    for (int n = 0; n < 8; ++n) {
        pl_shape_kind kind = kinds[n / 2];
        int axis = n % 2;
        bool capsule = kind == PL_SHAPE_CAPSULE;
        bool rounded = kind == PL_SHAPE_CYLINDER && strcmp(choice->engine->name, "bullet") == 0;
        if (!knows(choice, kind)) {
            continue;
        }
        double side = solid_width(kind, half, 1 - axis), margin = rounded ? 0.04 : 0;
        double low = capsule ? half / 2 * (c + 1) : half * c + side * s;
        const double at[3] = {3, -1, low - depth};
        pl_scene scene = empty_scene();
        pl_body body = solid_body(&scene, kind, half, at, axis, 0.5);
        pl_contact contact = deepest_contact(choice, &scene, floor_body(), body, axis == 0);
        check_contact("plane", kind_name(kind), &contact, depth - margin * (c + s - 1), 3e-7, 1e-4);
        /* Turned about y, z leans towards x: a capsule's lower end is back, an edge ahead. */
        double lever = capsule ? -half / 2 * s : side * c - half * s;
        double along = contact.point[1 - axis] - at[1 - axis];
        assert_close(axis == 1 ? along : -along, lever, fmax(margin, 3e-7), 0);
        pl_scene_free(&scene);
    }
}

static void test_tilted_shapes_touch_planes_at_the_lowest_point(void **state)
{
    (void)state;
    for_each_profile(law_tilted);
}

/* The penetration that the engine does not push out, m. */
static double surface_layer(const pl_engine_choice *choice)
{
    const int option = pl_engine_option_index(choice->engine, "surface_layer");
    return option < 0 ? 0 : choice->values[option];
}

/* A body that starts 1 mm too high comes to rest, `raised` above where it should less the surface
 * layer, turned as it was. */
static void rest(const pl_engine_choice *choice, pl_shape_kind kind, double angle, double height,
                 double raised)
{
    if (!knows(choice, kind)) {
        return;
    }
    pl_scene scene = empty_scene();
    put_body(&scene, floor_body());
    pl_body body =
        solid_body(&scene, kind, 0.5, (double[]){0, 0, height + raised + 1e-3}, 1, angle);
    put_body(&scene, body);
    engine_run r;
    scene.dt = 1.0 / 120;
    engine_start(&r, choice, &scene);
    for (int n = 0; n < 360; ++n) {
        engine_step(&r);
    }
    double error = r.now[1].position[2] - (body.position[2] - raised - 1e-3);
    double turn = angle_between(r.now[1].orientation, body.orientation);
    print_message("      %-8s at %2.0f degrees: height off by %8.1e m, turned by %.1e, %.1e m/s\n",
                  kind_name(kind), angle * 180 / pi, error, turn,
                  distance(r.now[1].velocity, (double[]){0, 0, 0}));
    assert_close(error, raised - surface_layer(choice), 1e-3, 0);
    assert_at_most(turn, 5e-3);
    engine_finish(&r);
    pl_scene_free(&scene);
}

static void law_rest_heights(const pl_engine_choice *choice)
{
    if (!solves_coulomb(choice)) {
        return;
    }
    rest(choice, PL_SHAPE_CAPSULE, pi / 2, 0.25, 0);
    rest(choice, PL_SHAPE_CYLINDER, 0, 0.5, 0);
    rest(choice, PL_SHAPE_CYLINDER, pi / 2, 0.5, 0);
    rest(choice, PL_SHAPE_HULL, 0, 0.5, 0);
    rest(choice, PL_SHAPE_HULL, pi / 2, 0.4, 0);
    rest(choice, PL_SHAPE_MESH, 0, 0.5, 0);
    rest(choice, PL_SHAPE_MESH, pi / 2, 0.4, 0);
}

static void test_every_shape_rests_on_a_plane_correctly(void **state)
{
    (void)state;
    for_each_profile(law_rest_heights);
}

static void test_bullets_margin_raises_hulls_and_meshes(void **state)
{
    (void)state;
    pl_engine_choice choice;
    if (pl_engine_choose("bullet:si,solid_margin=0.04", &choice, NULL) != PL_OK) {
        skip();
    }
    rest(&choice, PL_SHAPE_HULL, 0, 0.5, 0.04);
    rest(&choice, PL_SHAPE_MESH, 0, 0.5, 0.04);
}

/* The declared type of ODE's colliders, with its handles as plain pointers. */
typedef int collider(void *first, void *second, int flags, void *contacts, int skip);

static int no_collider(void *first, void *second, int flags, void *contacts, int skip)
{
    (void)first, (void)second, (void)flags, (void)contacts, (void)skip;
    return 0;
}

/* The ODE of this build has a collider for every pair; one is taken out of it, as other builds lack
 * it. ODE forgets that when its last world goes. */
static void test_pair_without_an_ode_collider_is_declined(void **state)
{
    (void)state;
    enum { CYLINDER_CLASS = 3 }; /* dCylinderClass */
    void (*set_collider)(int first_class, int second_class, collider *) = NULL;
    void *found = dlsym(RTLD_DEFAULT, "dSetColliderOverride");
    pl_engine_choice choice;
    if (found == NULL || pl_engine_choose("ode", &choice, NULL) != PL_OK) {
        skip();
    }
    memcpy(&set_collider, &found, sizeof found);
    pl_scene plain = empty_scene();
    engine_run keeps_ode_open;
    engine_start(&keeps_ode_open, &choice, &plain);
    set_collider(CYLINDER_CLASS, CYLINDER_CLASS, no_collider);

    pl_scene scene = empty_scene();
    put_body(&scene, solid_body(&scene, PL_SHAPE_CYLINDER, 0.5, (double[]){0, 0, 0}, 0, 0));
    put_body(&scene, solid_body(&scene, PL_SHAPE_BOX, 0.5, (double[]){3, 0, 0}, 0, 0));
    pl_error error = {.message = ""};
    pl_session session = pl_session_begin(&choice);
    assert_int_equal(pl_session_load(&session, &error), PL_OK);
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_OK);
    pl_session_destroy(&session);
    pl_body second = solid_body(&scene, PL_SHAPE_CYLINDER, 0.5, (double[]){6, 0, 0}, 0, 0);
    second.is_static = true;
    put_body(&scene, second);
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_UNSUPPORTED);
    assert_null(session.instance);
    assert_contains(error.message, "no collider for cylinder-cylinder");
    /* Two static ones never meet. */
    scene.bodies[0].is_static = true;
    assert_int_equal(pl_session_create(&session, &scene, &error), PL_OK);
    pl_session_end(&session);
    engine_finish(&keeps_ode_open);
    pl_scene_free(&plain);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_shape_reads_back_pose_mass_and_inertia),
        cmocka_unit_test(test_face_contacts_have_true_depth_and_normal_direction),
        cmocka_unit_test(test_tilted_shapes_touch_planes_at_the_lowest_point),
        cmocka_unit_test(test_every_shape_rests_on_a_plane_correctly),
        cmocka_unit_test(test_bullets_margin_raises_hulls_and_meshes),
        cmocka_unit_test(test_pair_without_an_ode_collider_is_declined),
    };
    return cmocka_run_group_tests_name("adapters shapes", tests, NULL, NULL);
}
