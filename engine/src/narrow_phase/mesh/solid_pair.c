/* Pairs of near triangles: from the trees, or, where few of either solid come near the other, each
 * with each. */
#include "solid_pair.h"

#include "narrow_phase/tolerances.h"
#include "solid_query.h"

static double bounding_radius(pe_placed p)
{
    return p.geometry != NULL                 ? p.geometry->bounding_radius
           : p.shape->kind == PE_SHAPE_BOX    ? pe_length(p.shape->half_extents)
           : p.shape->kind == PE_SHAPE_SPHERE ? p.shape->radius
                                              : p.shape->radius + p.shape->half_height;
}

void pe_solid_pair_make(pe_placed a, pe_placed b, pe_solid_pair *pair)
{
    bool rounded = a.shape->kind == PE_SHAPE_SPHERE || a.shape->kind == PE_SHAPE_CAPSULE;
    pair->a = pe_solid_of(a, &pair->small);
    pair->b = pe_solid_of_geometry(b.geometry);
    pair->near_a.facets = pair->near_b.facets = NULL;
    pair->radius = rounded ? a.shape->radius : 0;
    pair->size = pe_min(a.size, b.size);
    pair->slack = PE_MESH_SLACK * pair->size;
    pair->depth = PE_MESH_DEPTH * pair->size;
    pair->band = PE_BAND * pe_min(bounding_radius(a), bounding_radius(b));
    pair->b_in_a = pe_transform_between(b.pose, a.pose);
    pair->trees = (pe_bvh_pair){
        .a = pair->a.nodes, .b = pair->b.nodes, .a_in_b = pe_transform_between(a.pose, b.pose)};
}

bool pe_solid_pair_part(pe_solid_pair *pair, double limit)
{
    enum { MOST_STEPS = 6 };
    pe_bvh_pair *trees = &pair->trees;
    pe_vec3 v =
        pe_scale(-1, trees->a_in_b.offset); /* the point of b - a nearest to the origin so far */
    if (!(pe_dot(v, v) > 0)) {
        v = pe_v3(0, 0, pair->size); /* of concentric solids any direction will do */
    }
    double best = -HUGE_VAL;
    for (int step = 0; step < MOST_STEPS; ++step) {
        double length = pe_length(v);
        if (!(length > 0)) {
            break;
        }
        pe_vec3 n = pe_scale(1 / length, v), back = pe_unrotate(&trees->a_in_b.turn, n);
        pe_vec3 a = pe_transform_point(&trees->a_in_b, pe_solid_support(&pair->a, back));
        pe_vec3 b = pe_solid_support(&pair->b, pe_scale(-1, n)), w = pe_sub(b, a);
        double gap = pe_dot(n, w);
        if (gap > limit) {
            return false;
        }
        if (gap > best) {
            best = gap;
            trees->parting = n;
            trees->parting_a = back;
            trees->most_a = pe_dot(n, a) + pair->slack;
            trees->least_b = pe_dot(n, b) - pair->slack;
        }
        pe_vec3 u = pe_sub(w, v);
        double uu = pe_dot(u, u), t = uu > 0 ? -pe_dot(v, u) / uu : 0;
        if (!(t > 0) || length - gap < PE_PARTING_TOLERANCE * pair->band) {
            break;
        }
        v = pe_madd(v, pe_min(1, t), u);
    }
    pair->depth = pe_min(pair->depth, pe_max(0, -best) + pair->slack);
    return true;
}

/* `sign`: 1 of a, -1 of b. */
static struct pe_facet_ball ball_of(const pe_facet *facet, pe_vec3 parting, double sign)
{
    const pe_vec3 *x = facet->x;
    pe_vec3 c = pe_scale(1.0 / 3, pe_add(x[0], pe_add(x[1], x[2])));
    double square = 0, along = -HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 d = pe_sub(x[k], c);
        square = pe_max(square, pe_dot(d, d));
        along = pe_max(along, sign * pe_dot(parting, x[k]));
    }
    return (struct pe_facet_ball){c, sqrt(square), sign * along};
}

bool pe_solid_pair_gather(pe_solid_pair *pair, double limit, pe_workspace work)
{
    enum { MOST_LEAVES = 64 }; /* of either solid, to be gathered */
    int leaves[2][MOST_LEAVES], count[2] = {0, 0};
    pair->near_a.facets = pair->near_b.facets = NULL;
    for (int side = 0; side < 2; ++side) {
        count[side] = pe_bvh_leaves(&pair->trees, side == 0, limit, leaves[side], MOST_LEAVES);
        if (count[side] < 0) {
            return true;
        }
    }
    for (int side = 0; side < 2; ++side) {
        const pe_node *nodes = side == 0 ? pair->a.nodes : pair->b.nodes;
        pe_near_facets *near = side == 0 ? &pair->near_a : &pair->near_b;
        near->count = 0;
        for (int i = 0; i < count[side]; ++i) {
            near->count += nodes[leaves[side][i]].count;
        }
        near->facets = pe_take(work, (size_t)near->count + 1, sizeof *near->facets);
        near->balls = pe_take(work, (size_t)near->count + 1, sizeof *near->balls);
        if (near->facets == NULL || near->balls == NULL) {
            pair->near_a.facets = pair->near_b.facets = NULL;
            return false;
        }
        pe_facet *facet = near->facets;
        struct pe_facet_ball *ball = near->balls;
        for (int i = 0; i < count[side]; ++i) {
            const pe_node *leaf = &nodes[leaves[side][i]];
            for (int k = leaf->first; k < leaf->first + leaf->count; ++k) {
                if (side == 0) {
                    pe_solid_facet_placed(&pair->a, &pair->trees.a_in_b, k, facet);
                } else {
                    pe_solid_facet(&pair->b, k, facet);
                }
                *ball++ = ball_of(facet++, pair->trees.parting, side == 0 ? 1 : -1);
            }
        }
    }
    return true;
}

static bool are_near(const struct pe_facet_ball *a, const struct pe_facet_ball *b, double bound)
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
            pe_solid_facet_placed(&pair->a, &pair->trees.a_in_b, leaf_a->first + i, &a);
            for (int j = 0; j < leaf_b->count; ++j) {
                pe_solid_facet(&pair->b, leaf_b->first + j, &b);
                if (!take(context, &a, &b)) {
                    return;
                }
            }
        }
    }
}

void pe_each_near_facets(const pe_solid_pair *pair, const double *bound, pe_take_facets *take,
                         void *context)
{
    if (pair->near_a.facets == NULL) {
        walk_trees(pair, bound, take, context);
        return;
    }
    for (int i = 0; i < pair->near_a.count; ++i) {
        const struct pe_facet_ball *a = &pair->near_a.balls[i];
        for (int j = 0; j < pair->near_b.count; ++j) {
            const struct pe_facet_ball *b = &pair->near_b.balls[j];
            if (b->along - a->along <= *bound && are_near(a, b, *bound) &&
                !take(context, &pair->near_a.facets[i], &pair->near_b.facets[j])) {
                return;
            }
        }
    }
}

typedef struct crossings {
    double slack;
    pe_take_crossing *take;
    void *context;
} crossings;

static bool take_if_crossing(void *context, pe_facet *a, pe_facet *b)
{
    const crossings *c = context;
    pe_facet_heights heights;
    pe_vec3 where[PE_MOST_PIERCINGS];
    if (pe_facets_heights(a, b, c->slack, &heights)) {
        int count = pe_facets_cross(a, b, &heights, c->slack, where);
        if (count > 0) {
            c->take(c->context, &(pe_crossing){a, b, &heights, count, where});
        }
    }
    return true;
}

void pe_each_crossing(const pe_solid_pair *pair, pe_take_crossing *take, void *context)
{
    crossings c = {pair->slack, take, context};
    pe_each_near_facets(pair, &c.slack, take_if_crossing, &c);
}
