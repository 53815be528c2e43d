/* Long runs: memory and errors at the end are those at the start. The argument is the number of steps; CI
 * takes few, a soak a million:
 *
 *     build/release/test_soak_slow 1000000 */
#include "base/vec3.h"
#include "check.h"
#include "metered_allocator.h"
#include "random_pose.h"
#include "world_for_tests.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static long steps = 3000;

static const double H = 1.0 / 60;

/* The largest of each tenth of a run. */
enum { WINDOWS = 10 };
typedef struct windows {
    double error[WINDOWS];    /* m */
    double bytes[WINDOWS];    /* that the world holds */
    double resident[WINDOWS]; /* bytes of the process */
} windows;

static double resident_bytes(void)
{
    long pages = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file != NULL) {
        if (fscanf(file, "%ld %ld", &pages, &resident) != 2) {
            resident = 0;
        }
        fclose(file);
    }
    return (double)resident * (double)sysconf(_SC_PAGESIZE);
}

static void note(windows *w, long n, double error, const meter *m)
{
    const long k = n * WINDOWS / steps;
    w->error[k] = pe_max(w->error[k], error);
    w->bytes[k] = pe_max(w->bytes[k], (double)m->now);
    if ((n + 1) * WINDOWS / steps > k) {
        w->resident[k] = resident_bytes();
    }
}

/* Between the second and the last tenth memory does not double, as a rare heap may make it do, and the
 * error grows by no more than a tenth and `slack`, in m. */
static void check_flat(const char *name, const windows *w, double slack)
{
    for (int k = 0; k < WINDOWS; ++k) {
        print_message("%s, to step %ld: error %.3g m, world %.0f bytes, resident %.0f bytes\n",
                      name, steps * (k + 1) / WINDOWS, w->error[k], w->bytes[k], w->resident[k]);
    }
    const int last = WINDOWS - 1;
    assert_at_most(w->error[last], 1.1 * w->error[1] + slack);
    assert_at_most(w->bytes[last], 2 * w->bytes[1]);
    assert_at_most(w->resident[last], 2 * w->resident[1]);
}

static pe_world *make_metered_world(meter *m)
{
    pe_world_def def = pe_world_def_default();
    def.allocator = (pe_allocator){meter_allocate, meter_release, m};
    return make_world(&def);
}

/* A tower of 100 cubes, kept from rest by a force that is smaller than friction by far. */
static void test_tower_stands_with_flat_error_and_memory(void **state)
{
    (void)state;
    enum { CUBES = 100 };
    meter m = {0};
    windows w = {{0}, {0}, {0}};
    pe_world *world = make_metered_world(&m);
    pe_body_id ids[CUBES];
    add_tower(world, CUBES, add_material(world, 0.5, 0), ids);
    for (long n = 0; n < steps; ++n) {
        const pe_vec3 force = {n % 2 == 0 ? 1e-3 : -1e-3, 0, 0}, centre = {0, 0, 0};
        assert_int_equal(
            pe_body_apply_force(world, ids[CUBES - 1], force, centre, PE_FRAME_WORLD, NULL), PE_OK);
        step(world, H);
        const pe_vec3 top = state_of(world, ids[CUBES - 1]).position;
        note(&w, n, pe_length(pe_sub(top, pe_v3(0, 0, CUBES - 0.5))), &m);
    }
    pe_world_destroy(world);
    assert_int_equal(m.now, 0);
    check_flat("tower", &w, 1e-6);
}

/* A chute: things of all simple shapes are dropped at its upper end, slide down, and are taken away at the
 * lower one. */
enum { PLACES = 60, EVERY = 30 };
static const double CHUTE = 12; /* m */

static pe_body_def thing(check_random *random)
{
    pe_body_def def = pe_body_def_default();
    const double a = check_uniform(random, 0.1, 0.3), b = check_uniform(random, 0.1, 0.3);
    def.shape.kind = (pe_shape_kind)check_uniform(random, PE_SHAPE_SPHERE, PE_SHAPE_HULL);
    def.shape.radius = a;
    def.shape.half_height = b;
    def.shape.half_extents = pe_v3(a, b, check_uniform(random, 0.1, 0.3));
    def.mass = check_uniform(random, 0.5, 5);
    def.position = pe_v3(0, check_uniform(random, -0.5, 0.5), 1.5);
    def.orientation = random_turn(random);
    return def;
}

static void test_chute_runs_with_flat_error_and_memory(void **state)
{
    (void)state;
    meter m = {0};
    windows w = {{0}, {0}, {0}};
    check_random random = {1};
    pe_world *world = make_metered_world(&m);
    const pe_material_id slippery = add_material(world, 0.3, 0);
    add_plane(world, pe_v3(0.5, 0, sqrt(0.75)), slippery);
    pe_body_id ids[PLACES] = {{0, 0}};
    long added = 0, removed = 0;
    for (long n = 0; n < steps; ++n) {
        bool put = n % EVERY != 0;
        for (int i = 0; i < PLACES; ++i) {
            if (ids[i].index != 0 && state_of(world, ids[i]).position.x > CHUTE) {
                assert_int_equal(pe_body_destroy(world, ids[i], NULL), PE_OK);
                ids[i] = (pe_body_id){0};
                removed += 1;
            }
            if (ids[i].index == 0 && !put) {
                pe_body_def def = thing(&random);
                def.material = slippery;
                ids[i] = add_body(world, &def);
                put = true;
                added += 1;
            }
        }
        note(&w, n, step(world, H).penetration_left, &m);
    }
    pe_world_destroy(world);
    assert_int_equal(m.now, 0);
    print_message("chute: %ld things came and %ld went\n", added, removed);
    assert_true(removed > steps / EVERY / 2);
    check_flat("chute", &w, 5e-3);
}

int main(int argc, char **argv)
{
    if (argc > 1) {
        steps = strtol(argv[1], NULL, 10);
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tower_stands_with_flat_error_and_memory),
        cmocka_unit_test(test_chute_runs_with_flat_error_and_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
