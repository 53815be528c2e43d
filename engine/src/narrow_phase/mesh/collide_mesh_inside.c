/* Where a point is in a solid, and how far it is to come out. */
#include "collide_mesh.h"

/* Sine of the angle to a face from which a way crosses it. */
static const double LEAST_RISE = 1e-9;

pe_bvh_pair pe_solid_around(const pe_node *node, const pe_solid *solid)
{
    pe_mat3 same = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return pe_bvh_pair_of(node, solid->nodes, &same, pe_v3(0, 0, 0));
}

/* The point of the triangle nearest to x. */
static pe_vec3 nearest_point(const pe_facet *facet, pe_vec3 x)
{
    if (pe_facet_holds(facet, x, 0)) {
        return pe_madd(x, facet->offset - pe_dot(facet->normal, x), facet->normal);
    }
    pe_vec3 best = facet->x[0];
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 from = facet->x[k], u = pe_sub(facet->x[k < 2 ? k + 1 : 0], from);
        double t = pe_dot(pe_sub(x, from), u) / pe_dot(u, u);
        pe_vec3 y = pe_madd(from, pe_max(0, pe_min(1, t)), u), d = pe_sub(x, y);
        if (pe_dot(d, d) < least) {
            least = pe_dot(d, d);
            best = y;
        }
    }
    return best;
}

/* By the nearest triangle; of several that share the nearest point, the one whose normal is most
 * along the line to it has the sign right. */
bool pe_solid_holds(const pe_solid *solid, pe_vec3 x)
{
    const pe_node *root = &solid->nodes[0];
    pe_vec3 in = pe_rotate(&root->axes, pe_sub(x, root->centre));
    if (fabs(in.x) > root->half.x || fabs(in.y) > root->half.y || fabs(in.z) > root->half.z) {
        return false;
    }
    pe_node point = pe_box_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = pe_solid_around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double bound = HUGE_VAL, steepest = 0, height = 0;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, bound, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            pe_vec3 d = pe_sub(x, nearest_point(&facet, x));
            double distance = pe_length(d), h = pe_dot(facet.normal, d);
            double steep = distance > 0 ? fabs(h) / distance : 1;
            bool nearer = distance < bound * (1 - 1e-9);
            if (nearer || (distance <= bound * (1 + 1e-9) && steep > steepest)) {
                steepest = steep;
                height = h;
                bound = nearer ? distance : bound;
            }
        }
    }
    return height < 0;
}

pe_vec3 pe_solid_nearest_point(const pe_solid *solid, pe_vec3 x)
{
    pe_node point = pe_box_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = pe_solid_around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double bound = HUGE_VAL;
    pe_vec3 best = x;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, bound, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            pe_vec3 y = nearest_point(&facet, x);
            double distance = pe_length(pe_sub(y, x));
            if (distance < bound) {
                bound = distance;
                best = y;
            }
        }
    }
    return best;
}

double pe_solid_way_to_exit(const pe_solid *solid, pe_vec3 x, pe_vec3 d, double slack)
{
    double least_rise = LEAST_RISE * pe_length(d);
    pe_node segment =
        pe_box_node(pe_madd(x, 0.5, d), pe_scale(0.5, pe_v3(fabs(d.x), fabs(d.y), fabs(d.z))));
    pe_bvh_pair trees = pe_solid_around(&segment, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double first = HUGE_VAL;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, slack, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            double from = facet.offset - pe_dot(facet.normal, x), rise = pe_dot(facet.normal, d);
            if (from < -slack || from > rise + slack || rise < least_rise) {
                continue;
            }
            double t = pe_max(0, from) / rise;
            if (t < first && pe_facet_holds(&facet, pe_madd(x, t, d), slack)) {
                first = t;
            }
        }
    }
    return first < HUGE_VAL ? first : 0;
}
