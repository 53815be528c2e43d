/* The triangles of two solids that come near each other: from the trees, or where few of either one
 * come near the other at all, each with each. */
#include "collide_mesh.h"

/* Leaves of one solid at most, to be gathered. */
enum { MOST_LEAVES = 64 };

static int triangles_in(const pe_node *nodes, const int *leaves, int count)
{
    int sum = 0;
    for (int i = 0; i < count; ++i) {
        sum += nodes[leaves[i]].count;
    }
    return sum;
}

/* `sign`: 1 of a, -1 of b. */
static pe_facet_ball ball_of(const pe_facet *facet, pe_vec3 parting, double sign)
{
    const pe_vec3 *x = facet->x;
    pe_vec3 c = pe_scale(1.0 / 3, pe_add(x[0], pe_add(x[1], x[2])));
    double square = 0, along = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 d = pe_sub(x[k], c);
        square = pe_max(square, pe_dot(d, d));
        along = pe_max(along, sign * pe_dot(parting, x[k]));
    }
    return (pe_facet_ball){c, sqrt(square), sign * along};
}

bool pe_solid_pair_gather(pe_solid_pair *pair, double limit, pe_workspace work)
{
    int leaves_a[MOST_LEAVES], leaves_b[MOST_LEAVES];
    pair->near_a = pair->near_b = NULL;
    int count_a = pe_bvh_leaves(&pair->trees, true, limit, leaves_a, MOST_LEAVES);
    int count_b =
        count_a < 0 ? -1 : pe_bvh_leaves(&pair->trees, false, limit, leaves_b, MOST_LEAVES);
    if (count_b < 0) {
        return true;
    }
    pair->near_count_a = triangles_in(pair->a.nodes, leaves_a, count_a);
    pair->near_count_b = triangles_in(pair->b.nodes, leaves_b, count_b);
    pe_facet *a = pe_take(work, (size_t)pair->near_count_a + 1, sizeof *a);
    pe_facet *b = pe_take(work, (size_t)pair->near_count_b + 1, sizeof *b);
    pair->balls_a = pe_take(work, (size_t)pair->near_count_a + 1, sizeof *pair->balls_a);
    pair->balls_b = pe_take(work, (size_t)pair->near_count_b + 1, sizeof *pair->balls_b);
    if (a == NULL || b == NULL || pair->balls_a == NULL || pair->balls_b == NULL) {
        return false;
    }
    pe_vec3 n = pair->trees.parting;
    pair->near_a = a;
    pair->near_b = b;
    pe_facet_ball *ball = pair->balls_a;
    for (int i = 0; i < count_a; ++i) {
        const pe_node *leaf = &pair->a.nodes[leaves_a[i]];
        for (int k = 0; k < leaf->count; ++k) {
            pe_facet_of_a(pair, leaf->first + k, a);
            *ball++ = ball_of(a++, n, 1);
        }
    }
    ball = pair->balls_b;
    for (int i = 0; i < count_b; ++i) {
        const pe_node *leaf = &pair->b.nodes[leaves_b[i]];
        for (int k = 0; k < leaf->count; ++k) {
            pe_solid_facet(&pair->b, leaf->first + k, b);
            *ball++ = ball_of(b++, n, -1);
        }
    }
    return true;
}

static bool are_near(const pe_facet_ball *a, const pe_facet_ball *b, double bound)
{
    pe_vec3 d = pe_sub(a->centre, b->centre);
    double reach = a->radius + b->radius + bound;
    return pe_dot(d, d) <= reach * reach;
}

static void walk_trees(const pe_solid_pair *pair, const double *bound, pe_take_facets *take,
                       void *context)
{
    pe_bvh_walk walk;
    const pe_node *leaf_a, *leaf_b;
    pe_bvh_begin(&pair->trees, &walk);
    while (pe_bvh_next(&pair->trees, &walk, *bound, &leaf_a, &leaf_b)) {
        for (int i = 0; i < leaf_a->count; ++i) {
            pe_facet a, b;
            pe_facet_of_a(pair, leaf_a->first + i, &a);
            for (int j = 0; j < leaf_b->count; ++j) {
                pe_solid_facet(&pair->b, leaf_b->first + j, &b);
                if (!take(context, &a, &b)) {
                    return;
                }
            }
        }
    }
}

void pe_near_facets(const pe_solid_pair *pair, const double *bound, pe_take_facets *take,
                    void *context)
{
    if (pair->near_a == NULL) {
        walk_trees(pair, bound, take, context);
        return;
    }
    for (int i = 0; i < pair->near_count_a; ++i) {
        const pe_facet_ball *a = &pair->balls_a[i];
        for (int j = 0; j < pair->near_count_b; ++j) {
            const pe_facet_ball *b = &pair->balls_b[j];
            if (b->along - a->along <= *bound && are_near(a, b, *bound) &&
                !take(context, &pair->near_a[i], &pair->near_b[j])) {
                return;
            }
        }
    }
}
