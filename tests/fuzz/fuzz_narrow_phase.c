/* Reads bytes as a pair of shapes and its pose, which further bytes nudge: the contacts that the engine finds
 * obey the laws of shape_pairs_laws.h. Convex shapes are held against the proven interval of their signed
 * distance and against libccd, meshes against brute force over all triangles.
 *
 * The bytes: two kinds, the sort of the pose, eight of a seed, then seven for each nudge. */
#include "fuzz.h"

#include "ccd_solid.h"
#include "shape_pairs_laws.h"

#include <string.h>

enum { HEAD = 11, NUDGE = 7, MOST_NUDGES = 8 };

/* Of the size: where libccd's answer is certain. Of flat hulls it misses shallow overlaps. */
static const double CERTAINLY_APART = 1e-2, CERTAINLY_OVERLAP = 0.25;

/* Of the reach: what directions between edges of a solid that is small across leave at its far corners. */
static const double ROUNDING = 1e-10;

static const char *const kind_names[] = {"plane",    "sphere", "box", "capsule",
                                         "cylinder", "hull",   "mesh"};

/* Moves and turns b by up to its size, or by powers of two less. */
static void nudge(pair *p, const uint8_t *bytes)
{
    double part[6];
    for (int k = 0; k < 6; ++k) {
        part[k] = (bytes[1 + k] - 127.5) / 127.5 * ldexp(1, -(bytes[0] % 52));
    }
    const pe_vec3 x = pe_v3(part[0], part[1], part[2]);
    const pe_quat turn = pe_quat_unit((pe_quat){1, part[3], part[4], part[5]});
    place(&p->b, pe_madd(p->b.pose.position, p->size, x),
          pe_quat_product(turn, p->b.pose.orientation));
}

static bool agrees_with_libccd(trial *t)
{
    const pair *p = &t->pair;
    const ccd_solid one = {&p->a, p->a.pose.position, p->size},
                    two = {&p->b, p->a.pose.position, p->size};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = ccd_support;
    ccd.max_iterations = 1000;
    pe_vec3 normal;
    const double gap = engine_gap(p, &normal);
    const bool overlap = ccdGJKIntersect(&one, &two, &ccd) != 0;
    if (gap > CERTAINLY_APART * p->size && overlap) {
        return fails(t, "separation where libccd finds an overlap", gap, 0);
    }
    return gap >= -CERTAINLY_OVERLAP * p->size || overlap ||
           fails(t, "overlap where libccd finds none", gap, 0);
}

static void check(trial *t, const char *name, law *holds)
{
    trial copy = *t;
    if (!holds(&copy)) {
        static char text[512];
        snprintf(text, sizeof text, "%s, %s x %s: %s: found %.17g, expected %.17g, tolerance %.3g",
                 name, kind_names[t->pair.a.shape.kind], kind_names[t->pair.b.shape.kind],
                 copy.what, copy.found, copy.expected, copy.tolerance);
        pair_print(&t->pair);
        fuzz_check(false, text);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static shape_pool *pool;
    if (pool == NULL) {
        pool = shape_pool_create(2024);
    }
    if (size < HEAD || pool == NULL) {
        return 0;
    }
    int a = data[0] % PE_SHAPE_COUNT, b = data[1] % PE_SHAPE_COUNT;
    if (a > b) {
        const int c = a;
        a = b;
        b = c;
    }
    if (b == PE_SHAPE_PLANE) {
        return 0;
    }
    /* Ledges are left to the tests: a search finds the deviation of box edges that LIMITS.md names. */
    trial t = {.pool = pool, .pose = (pair_pose)(data[2] % POSE_LEDGE)};
    memcpy(&t.random.state, data + 3, sizeof t.random.state);
    t.random.state |= 1;
    const bool mesh = b == PE_SHAPE_MESH;
    t.pair = random_pair(pool, (pe_shape_kind)a, (pe_shape_kind)b, t.pose, &t.random,
                         mesh ? engine_gap : true_gap);
    for (int i = 0; i < MOST_NUDGES && size >= HEAD + (size_t)(i + 1) * NUDGE; ++i) {
        nudge(&t.pair, data + HEAD + i * NUDGE);
        t.pose = POSE_ANY; /* as far apart as it may be */
    }
    trial_set(&t);
    t.tolerance += ROUNDING * (t.pair.a.solid->reach + t.pair.b.solid->reach);
    if (mesh) {
        check(&t, "equals_brute_force", equals_brute_force);
    } else {
        check(&t, "equals_the_truth", equals_the_truth);
        if (a != PE_SHAPE_PLANE) {
            check(&t, "agrees_with_libccd", agrees_with_libccd);
        }
    }
    check(&t, "has_sound_points", has_sound_points);
    check(&t, "is_symmetric", is_symmetric);
    return 0;
}
