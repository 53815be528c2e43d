/* Parallel edges that meet: two cards that lean on each other. Their planes are turned by known
 * angles, so that the ranges of normals that either edge has are known, too. */
#include "check.h"
#include "collide_convex.h"
#include "polytopes.h"
#include "world_for_tests.h"

static const double half_thickness = 0.01, half_width = 0.3, half_length = 0.5; /* m */
static const double reach = 1e-4 * 0.01; /* m: edges nearer than this meet */

/* Two cards, of which each may be a hull. */
typedef struct cards {
    placed_shape left, right;
} cards;

static cards make_cards(int hulls)
{
    const double t = half_thickness, w = half_width, l = half_length;
    return (cards){hulls & 1 ? hull_box(t, w, l) : box_of(t, w, l),
                   hulls & 2 ? hull_box(t, w, l) : box_of(t, w, l)};
}

static void release(cards *c)
{
    release_hull(&c->left);
    release_hull(&c->right);
}

/* Places a card, turned by `lean` about y towards the side 1 or -1, so that its upper edge on that
 * side is at x; then turns it all by `world` about the origin. */
static void lean_card(placed_shape *card, double lean, int side, pe_vec3 x, pe_quat world)
{
    pe_quat q = about(pe_v3(0, 1, 0), side * lean);
    pe_vec3 edge = pe_v3(side * half_thickness, 0, half_length);
    pe_mat3 turn = pe_matrix_of(q), whole = pe_matrix_of(world);
    q = pe_quat_product(world, q);
    if (card->geometry != NULL) {
        q = pe_quat_product(q, card->geometry->frame.orientation);
    }
    place(card, pe_rotate(&whole, pe_sub(x, pe_rotate(&turn, edge))), q);
}

/* The manifold of cards whose edges have a gap, in the axes of the cards. */
static pe_pair_manifold manifold_of(cards *c, double lean_left, double lean_right, pe_vec3 gap,
                                    pe_quat world)
{
    lean_card(&c->left, lean_left, 1, pe_v3(0, 0, 0), world);
    lean_card(&c->right, lean_right, -1, gap, world);
    pe_pair_manifold manifold;
    collide_convex(of(&c->left), of(&c->right), 1e-3, &manifold);
    pe_mat3 whole = pe_matrix_of(world);
    manifold.normal = pe_unrotate(&whole, manifold.normal);
    return manifold;
}

/* The normals that both edges have lie between the faces of the cards' undersides: leans from the
 * level of -left and right. */
static void test_edges_that_meet_have_the_middle_normal(void **state)
{
    (void)state;
    check_random random = {211};
    for (int hulls = 0; hulls < 4; ++hulls) {
        cards c = make_cards(hulls);
        for (int i = 0; i < 300; ++i) {
            const double left = check_uniform(&random, 0.11, 0.75),
                         right = check_uniform(&random, 0.11, 0.75);
            const pe_vec3 aside = {0, check_uniform(&random, -0.5, 0.5), 0};
            const pe_quat world = i == 0 ? unturned : pe_quat_unit(random_turn(&random));
            const pe_pair_manifold m = manifold_of(&c, left, right, aside, world);
            const double middle = 0.5 * (right - left), part = half_width - 0.5 * fabs(aside.y);
            assert_close(m.normal.x, cos(middle), 1e-8, 0);
            assert_close(m.normal.y, 0, 1e-9, 0);
            assert_close(m.normal.z, sin(middle), 1e-8, 0);
            assert_int_equal(m.count, 2);
            assert_close(least_separation(&m), 0, 1e-12, 0);
            const pe_vec3 d = pe_sub(m.item[1].position, m.item[0].position);
            assert_close(pe_length(d), 2 * part, 1e-9, 0);
        }
        release(&c);
    }
}

/* The largest angle by which the normal turns between neighbours on a path of gaps, in which the
 * right edge does not go behind the left one. */
static double greatest_turn(cards *c, double lean, pe_vec3 from, pe_vec3 to)
{
    enum { STEPS = 4000 };
    double most = 0;
    pe_vec3 last = {0, 0, 0};
    for (int i = 0; i <= STEPS; ++i) {
        const pe_vec3 gap = pe_madd(from, (double)i / STEPS, pe_sub(to, from));
        const pe_pair_manifold m = manifold_of(c, lean, lean, gap, unturned);
        assert_in_range(m.count, 1, PE_MAX_POINTS);
        most = i == 0 ? 0 : pe_max(most, pe_length(pe_sub(m.normal, last)));
        last = m.normal;
    }
    return most;
}

static void test_edge_normal_turns_steadily_as_edges_pass(void **state)
{
    (void)state;
    for (int hulls = 0; hulls < 4; ++hulls) {
        cards c = make_cards(hulls);
        for (double lean = 0.11; lean < 0.7; lean += 0.1) {
            const double r = 2 * reach;
            /* Past each other, apart, and around each other at half the reach and at twice it. */
            assert_at_most(greatest_turn(&c, lean, pe_v3(0, 0, -r), pe_v3(0, 0, r)), 5e-3);
            assert_at_most(greatest_turn(&c, lean, pe_v3(0, 0, 0), pe_v3(r, 0, 0)), 5e-3);
            assert_at_most(greatest_turn(&c, lean, pe_v3(-r / 16, 0, -r), pe_v3(-r / 16, 0, r)),
                           5e-3);
            assert_at_most(greatest_turn(&c, lean, pe_v3(r / 4, 0, -r), pe_v3(r / 4, 0, r)), 5e-3);
            assert_at_most(greatest_turn(&c, lean, pe_v3(r, 0, -r), pe_v3(r, 0, r)), 5e-3);
        }
        release(&c);
    }
}

/* The same as the edges turn out of parallel. */
static void test_edge_normal_turns_steadily_as_edges_cross(void **state)
{
    (void)state;
    enum { STEPS = 2000 };
    for (int hulls = 0; hulls < 4; ++hulls) {
        cards c = make_cards(hulls);
        pe_vec3 last = {0, 0, 0};
        for (int i = 0; i <= STEPS; ++i) {
            /* About an axis between the faces, by which the ends come apart by twice the reach. */
            const double angle = 2 * reach / half_width * i / STEPS;
            manifold_of(&c, 0.35, 0.35, pe_v3(1e-2 * reach, 0, 0), unturned);
            const pe_quat q = about(pe_v3(1, 0, 0), angle);
            const pe_mat3 turn = pe_matrix_of(q);
            place(&c.right, pe_rotate(&turn, c.right.pose.position),
                  pe_quat_product(q, c.right.pose.orientation));
            pe_pair_manifold m;
            collide_convex(of(&c.left), of(&c.right), 1e-3, &m);
            assert_in_range(m.count, 1, PE_MAX_POINTS);
            assert_at_most(i == 0 ? 0 : pe_length(pe_sub(m.normal, last)), 5e-3);
            last = m.normal;
        }
        release(&c);
    }
}

/* Cubes with a common edge, of which one is tilted about it: the upper one of a stack, and one
 * beside which there is nothing but the edge. */
static void test_faces_on_each_other_keep_a_face_normal(void **state)
{
    (void)state;
    const double tilts[] = {0, 1e-9, 1e-6, 1e-3, 0.09};
    for (int hulls = 0; hulls < 2; ++hulls) {
        placed_shape a = hulls ? hull_box(0.5, 0.5, 0.5) : box_of(0.5, 0.5, 0.5), b = a;
        const pe_quat frame = hulls ? a.geometry->frame.orientation : unturned;
        for (int i = 0; i < 5; ++i) {
            const pe_quat q = about(pe_v3(0, 1, 0), tilts[i]);
            const pe_mat3 turn = pe_matrix_of(q);
            pe_pair_manifold m;
            place(&a, pe_v3(-0.5, 0, -0.5), frame);
            place(&b, pe_scale(-1, pe_rotate(&turn, pe_v3(0.5, 0, -0.5))),
                  pe_quat_product(q, frame));
            collide_convex(of(&a), of(&b), 1e-6, &m);
            assert_int_equal(m.count, tilts[i] > 1e-7 ? 2 : 4);
            const double turned = pe_unrotate(&turn, m.normal).z;
            assert_close(pe_max(m.normal.z, turned), 1, 1e-12, 0);
            place(&b, pe_scale(-1, pe_rotate(&turn, pe_v3(-0.5, 0, -0.5))),
                  pe_quat_product(q, frame));
            collide_convex(of(&a), of(&b), 1e-6, &m);
            const double middle = 0.25 * acos(-1) - 0.5 * tilts[i];
            assert_int_equal(m.count, 2);
            assert_close(m.normal.x, cos(middle), 1e-8, 0);
            assert_close(m.normal.z, sin(middle), 1e-8, 0);
        }
        release_hull(&a);
    }
}

static pe_shape hull_shape(pe_world *world)
{
    form f = form_cube();
    form_scale(&f, pe_v3(half_thickness, half_width, half_length));
    const form *cube = &f;
    const pe_geometry_def def = {.vertices = f.vertices,
                                 .triangles = cube->triangles,
                                 .vertex_count = f.vertex_count,
                                 .triangle_count = f.triangle_count,
                                 .convex = true};
    pe_shape shape = {.kind = PE_SHAPE_HULL};
    assert_int_equal(pe_geometry_create(world, &def, &shape.geometry, NULL), PE_OK);
    return shape;
}

/* How far a pair of cards that lean on each other on a floor has sunk after 5 s. */
static double sinking_of_pair(pe_profile profile, bool hulls, double lean, double friction)
{
    pe_world_def settings = pe_world_def_default();
    settings.profile = profile;
    pe_world *world = make_world(&settings);
    const pe_material_id paper = add_material(world, friction, 0);
    add_plane(world, pe_v3(0, 0, 1), paper);
    const pe_vec3 ridge = {0, 0, 2 * (half_length * cos(lean) + half_thickness * sin(lean))};
    pe_body_id left = {0};
    double start = 0;
    for (int side = -1; side < 2; side += 2) {
        placed_shape card = box_of(half_thickness, half_width, half_length);
        /* The upper edge of the outer side is at the height of the ridge. */
        const pe_vec3 down = {0, 0, -2 * half_thickness * sin(lean)};
        lean_card(&card, lean, side, pe_add(ridge, down), unturned);
        pe_body_def def = box_def(half_thickness, half_width, half_length, card.pose.position);
        def.orientation = card.pose.orientation;
        def.shape = hulls ? hull_shape(world) : def.shape;
        def.material = paper;
        const pe_body_id id = add_body(world, &def);
        left = side < 0 ? id : left;
        start = card.pose.position.z;
    }
    for (int i = 0; i < 300; ++i) {
        step(world, 1.0 / 60);
    }
    const double sunk = start - state_of(world, left).position.z;
    pe_world_destroy(world);
    return sunk;
}

/* By moments about the lower edge, a pair needs the friction (tan(lean) - t / L) / 2. */
static void test_pair_of_cards_stands_by_friction_of_statics(void **state)
{
    (void)state;
    const pe_profile profiles[] = {PE_PROFILE_DEFAULT, PE_PROFILE_ACCURATE, PE_PROFILE_FAST};
    for (int i = 0; i < 12; ++i) {
        const bool hulls = i % 2 == 1;
        const double lean = i % 4 < 2 ? 0.35 : 0.6;
        const double needed = 0.5 * (tan(lean) - half_thickness / half_length);
        assert_at_most(fabs(sinking_of_pair(profiles[i / 4], hulls, lean, 1.001 * needed)), 1e-9);
        assert_true(sinking_of_pair(profiles[i / 4], hulls, lean, 0.99 * needed) > 0.1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edges_that_meet_have_the_middle_normal),
        cmocka_unit_test(test_edge_normal_turns_steadily_as_edges_pass),
        cmocka_unit_test(test_edge_normal_turns_steadily_as_edges_cross),
        cmocka_unit_test(test_faces_on_each_other_keep_a_face_normal),
        cmocka_unit_test(test_pair_of_cards_stands_by_friction_of_statics),
    };
    return cmocka_run_group_tests_name("engine_collide_edges", tests, NULL, NULL);
}
