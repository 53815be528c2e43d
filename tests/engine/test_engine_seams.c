/* Bodies that slide, roll or fall along flush faces of other bodies do not collide with the edges of
 * these: they move as along one body in their place. */
#include "base/vec3.h"
#include "check.h"
#include "world_for_tests.h"

#include <math.h>

enum { TILES = 20, PHASES = 24 };

static const double H = 1.0 / 60;

typedef enum course { FLOOR, LOOSE_FLOOR, WALL } course;

/* A row of tiles along x, and a body that passes them. Each tile is twice as long as the body. */
typedef struct seam {
    const char *name;
    pe_shape_kind tile, body; /* a hull or a mesh is a box */
    course course;
    double half;  /* m, of the body */
    double speed; /* m/s */
    double friction;
    double gap;             /* m, between tiles */
    double rise;            /* m, of the body over the tiles, which then has no weight */
    double yaw;             /* rad */
    double tolerance, fast; /* of the speed, relative: with exact profiles, and the fast one */
} seam;

static const seam SEAMS[] = {
    {"cube over boxes", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 0, 0, 0, 1e-9, 1e-3},
    {"hull over hulls", PE_SHAPE_HULL, PE_SHAPE_HULL, FLOOR, 0.25, 2, 0, 0, 0, 0, 1e-9, 1e-3},
    {"mesh over meshes", PE_SHAPE_MESH, PE_SHAPE_MESH, FLOOR, 0.25, 2, 0, 0, 0, 0, 1e-9, 1e-3},
    {"upright cylinder", PE_SHAPE_BOX, PE_SHAPE_CYLINDER, FLOOR, 0.25, 2, 0, 0, 0, 0, 1e-6, 1e-3},
    {"ball over boxes", PE_SHAPE_BOX, PE_SHAPE_SPHERE, FLOOR, 0.1, 10, 0.5, 0, 0, 0, 1e-6, 1e-3},
    {"turned cube", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 0, 0, 0.3, 1e-9, 1e-3},
    {"small fast cube", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.05, 6, 0, 0, 0, 0, 1e-9, 1e-3},
    {"slow cube", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 0.5, 0, 0, 0, 0, 1e-9, 1e-3},
    {"rough tiles", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 8, 0.3, 0, 0, 0, 1e-9, 1e-3},
    {"tiles that can move", PE_SHAPE_BOX, PE_SHAPE_BOX, LOOSE_FLOOR, 0.25, 2, 0, 0, 0, 0, 1e-3,
     1e-3},
    {"tiles 1e-12 m apart", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 1e-12, 0, 0, 1e-9, 1e-3},
    {"tiles 1 mm apart", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 1e-3, 0, 0, 1e-9, 1e-3},
    {"1e-12 m over tiles", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 0, 1e-12, 0, 1e-9, 1e-9},
    {"1 um over tiles", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 0, 1e-6, 0, 1e-9, 1e-9},
    {"1 mm over tiles", PE_SHAPE_BOX, PE_SHAPE_BOX, FLOOR, 0.25, 2, 0, 0, 1e-3, 0, 1e-9, 1e-9},
    {"cube down a wall", PE_SHAPE_BOX, PE_SHAPE_BOX, WALL, 0.25, 2, 0, 0, 0, 0, 1e-9, 1e-9},
};

/* A box with these half extents, or a ball or an upright cylinder in their place. */
static pe_shape shape_of(pe_world *world, pe_shape_kind kind, pe_vec3 e)
{
    static const uint32_t triangles[12][3] = {{4, 6, 2}, {4, 2, 0}, {1, 3, 7}, {1, 7, 5},
                                              {1, 5, 4}, {1, 4, 0}, {2, 6, 7}, {2, 7, 3},
                                              {2, 3, 1}, {2, 1, 0}, {4, 5, 7}, {4, 7, 6}};
    pe_shape shape = {.kind = kind, .radius = e.x, .half_height = e.z, .half_extents = e};
    if (kind == PE_SHAPE_HULL || kind == PE_SHAPE_MESH) {
        pe_vec3 vertices[8];
        for (int i = 0; i < 8; ++i) {
            vertices[i] = pe_mul(pe_v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1), e);
        }
        const pe_geometry_def def = {vertices, triangles, 8, 12, kind == PE_SHAPE_HULL};
        assert_int_equal(pe_geometry_create(world, &def, &shape.geometry, NULL), PE_OK);
    }
    return shape;
}

/* The tiles, or one box in their place. The first tile's middle is at x = 0, and all tops at z = 0. */
static void add_tiles(pe_world *world, const seam *s, bool whole, pe_material_id material)
{
    const double half = 2 * s->half, pitch = 2 * half + s->gap;
    const int count = whole ? 1 : TILES;
    for (int i = 0; i < count; ++i) {
        pe_body_def def = pe_body_def_default();
        const double x = whole ? 0.5 * (TILES - 1) * pitch : i * pitch;
        const pe_vec3 e = pe_v3(whole ? x + half : half, 1.5 * half, half);
        def.shape = shape_of(world, s->tile, e);
        def.position = pe_v3(x, 0, -half);
        def.is_static = s->course != LOOSE_FLOOR;
        def.mass = 20;
        def.material = material;
        add_body(world, &def);
    }
    if (s->course == LOOSE_FLOOR) {
        pe_body_def ground = box_def(2 * TILES * half, 2, 1, pe_v3(TILES * half, 0, -2 * half - 1));
        ground.is_static = true;
        ground.material = material;
        add_body(world, &ground);
    }
}

/* How the body moves after it has passed most tiles. */
typedef struct passage {
    double speed; /* m/s, along x */
    double lift;  /* m, the largest deviation from its height */
} passage;

static passage pass(const seam *s, pe_profile profile, int phase, bool whole)
{
    pe_world_def world_def = pe_world_def_default();
    world_def.profile = profile;
    if (s->rise > 0) {
        world_def.gravity = pe_v3(0, 0, 0);
    } else if (s->course == WALL) {
        world_def.gravity = pe_v3(9.81, 0, 0);
    }
    pe_world *world = make_world(&world_def);
    const pe_material_id material = add_material(world, s->friction, 0);
    add_tiles(world, s, whole, material);
    pe_body_def def = pe_body_def_default();
    def.shape = shape_of(world, s->body, pe_v3(s->half, s->half, s->half));
    def.material = material;
    def.position = pe_v3(0.5 * s->half - s->speed * H * phase / PHASES, 0, s->half + s->rise);
    def.orientation = (pe_quat){cos(0.5 * s->yaw), 0, 0, sin(0.5 * s->yaw)};
    def.velocity = pe_v3(s->speed, 0, 0);
    def.angular_velocity.y = s->body == PE_SHAPE_SPHERE ? s->speed / s->half : 0;
    const pe_body_id id = add_body(world, &def);
    passage p = {s->speed, 0};
    /* A fall accelerates, and friction ends some slides before the last tile. */
    for (int n = 0; n < 600 && state_of(world, id).position.x < 3 * s->half * TILES; ++n) {
        step(world, H);
        const pe_body_state now = state_of(world, id);
        p.lift = fmax(p.lift, fabs(now.position.z - def.position.z));
        p.speed = now.velocity.x;
        if (fabs(p.speed) < 1e-9) {
            p.speed = now.position.x; /* of a body that friction has stopped, the place counts */
            break;
        }
    }
    pe_world_destroy(world);
    return p;
}

static void check_seam(const seam *s, pe_profile profile)
{
    const bool fast = profile == PE_PROFILE_FAST;
    const double tolerance = fast ? s->fast : s->tolerance;
    passage worst = {0, 0};
    for (int phase = 0; phase < PHASES; ++phase) {
        const passage over_tiles = pass(s, profile, phase, false);
        const bool keeps_speed = s->friction == 0 && s->course != WALL;
        const double right = keeps_speed ? s->speed : pass(s, profile, phase, true).speed;
        worst.speed = fmax(worst.speed, fabs(over_tiles.speed / right - 1));
        worst.lift = fmax(worst.lift, over_tiles.lift / s->half);
    }
    print_message("    %s, profile %d: speed off by %.1e, lift %.1e\n", s->name, (int)profile,
                  worst.speed, worst.lift);
    assert_at_most(worst.speed, tolerance);
    assert_at_most(worst.lift, fmax(tolerance, 2e-8));
}

static void check_seams(pe_profile profile)
{
    for (size_t i = 0; i < sizeof SEAMS / sizeof *SEAMS; ++i) {
        check_seam(&SEAMS[i], profile);
    }
}

static void test_no_seam_stops_a_body_by_default(void **state)
{
    (void)state;
    check_seams(PE_PROFILE_DEFAULT);
}

static void test_no_seam_stops_a_body_accurately(void **state)
{
    (void)state;
    check_seams(PE_PROFILE_ACCURATE);
}

static void test_no_seam_stops_a_body_fast(void **state)
{
    (void)state;
    check_seams(PE_PROFILE_FAST);
}

/* Without gravity and friction: b is beside a, with their faces flush or 1 um apart. */
static void test_free_cubes_pass_side_by_side(void **state)
{
    (void)state;
    for (int k = 0; k < 3 * PHASES; ++k) {
        pe_world_def world_def = pe_world_def_default();
        world_def.profile = (pe_profile)(k % 3);
        world_def.gravity = pe_v3(0, 0, 0);
        pe_world *world = make_world(&world_def);
        const pe_material_id material = add_material(world, 0, 0);
        pe_body_id ids[2];
        for (int i = 0; i < 2; ++i) {
            const double side = i == 0 ? -1 : 1, shift = H * (double)(k / 3) / PHASES;
            pe_body_def def = box_def(0.25, 0.25, 0.25, pe_v3(0.6 * side + shift, 0.25 * side, 0));
            def.position.y += i * (k % 2) * 1e-6;
            def.velocity.x = -side;
            def.material = material;
            ids[i] = add_body(world, &def);
        }
        for (int n = 0; n < 80; ++n) {
            step(world, H);
        }
        for (int i = 0; i < 2; ++i) {
            const pe_body_state now = state_of(world, ids[i]);
            assert_close(now.velocity.x, i == 0 ? 1 : -1, 1e-9, 0);
            assert_at_most(fabs(now.velocity.y), 1e-9);
        }
        pe_world_destroy(world);
    }
}

/* The other side of the law: a step that is no rounding stops the body. */
static void test_a_raised_tile_stops_a_cube(void **state)
{
    (void)state;
    static const double rises[] = {1e-5, 1e-3, 0.1};
    for (int k = 0; k < 6; ++k) {
        pe_world_def world_def = pe_world_def_default();
        world_def.profile = k % 2 == 0 ? PE_PROFILE_DEFAULT : PE_PROFILE_ACCURATE;
        pe_world *world = make_world(&world_def);
        const pe_material_id material = add_material(world, 0, 0);
        for (int i = 0; i < 2; ++i) {
            pe_body_def tile = box_def(0.5, 0.5, 0.5, pe_v3(i, 0, -0.5 + i * rises[k / 2]));
            tile.is_static = true;
            tile.material = material;
            add_body(world, &tile);
        }
        pe_body_def cube = box_def(0.25, 0.25, 0.25, pe_v3(0, 0, 0.25));
        cube.velocity.x = 2;
        cube.material = material;
        const pe_body_id id = add_body(world, &cube);
        for (int n = 0; n < 15; ++n) {
            step(world, H);
        }
        assert_at_most(state_of(world, id).velocity.x, 1.5);
        pe_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_seam_stops_a_body_by_default),
        cmocka_unit_test(test_no_seam_stops_a_body_accurately),
        cmocka_unit_test(test_no_seam_stops_a_body_fast),
        cmocka_unit_test(test_free_cubes_pass_side_by_side),
        cmocka_unit_test(test_a_raised_tile_stops_a_cube),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
