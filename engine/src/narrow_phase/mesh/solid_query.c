/* Queries of one solid by its tree: support vertex, nearest point, containment, rays. */
#include "solid_query.h"

#include "narrow_phase/tolerances.h"

/* ---- Walks ---- */

static void begin_walk(const pe_solid *solid, pe_node box, pe_facet_walk *walk)
{
    walk->solid = solid;
    walk->box = box;
    walk->trees = (pe_bvh_pair){
        .a = &walk->box, .b = solid->nodes, .a_in_b.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    walk->next = walk->end = 0;
    pe_bvh_begin(&walk->trees, &walk->walk);
}

void pe_walk_near_point(const pe_solid *solid, pe_vec3 x, pe_facet_walk *walk)
{
    begin_walk(solid, pe_box_node(x, pe_v3(0, 0, 0)), walk);
}

void pe_walk_near_segment(const pe_solid *solid, pe_vec3 x, pe_vec3 d, pe_facet_walk *walk)
{
    begin_walk(solid, pe_box_node(pe_madd(x, 0.5, d), pe_scale(0.5, pe_absolute(d))), walk);
}

bool pe_walk_next(pe_facet_walk *walk, double bound, pe_facet *facet)
{
    if (walk->next == walk->end) {
        const pe_node *box, *leaf;
        if (!pe_bvh_next(&walk->trees, &walk->walk, bound, &box, &leaf)) {
            return false;
        }
        walk->next = leaf->first;
        walk->end = leaf->first + leaf->count;
    }
    pe_solid_facet(walk->solid, walk->next++, facet);
    return true;
}

/* ---- Support ---- */

pe_vec3 pe_solid_support(const pe_solid *solid, pe_vec3 d)
{
    enum { FEW = 1000 }; /* a scan is quicker */
    double most = -HUGE_VAL;
    pe_vec3 best = solid->vertices[0];
    if (solid->vertex_count <= FEW) {
        for (int i = 0; i < solid->vertex_count; ++i) {
            double along = pe_dot(d, solid->vertices[i]);
            best = along > most ? solid->vertices[i] : best;
            most = pe_max(most, along);
        }
        return best;
    }
    int stack[PE_BVH_STACK] = {0}, depth = 1;
    while (depth > 0) {
        int index = stack[--depth];
        const pe_node *node = &solid->nodes[index];
        if (pe_dot(d, node->centre) + pe_node_reach(node, d) <= most) {
            continue;
        }
        if (node->right >= 0) {
            /* The child that is farther along is visited first. */
            int left = index + 1, right = node->right;
            bool left_first =
                pe_dot(d, solid->nodes[left].centre) > pe_dot(d, solid->nodes[right].centre);
            stack[depth++] = left_first ? right : left;
            stack[depth++] = left_first ? left : right;
            continue;
        }
        for (int i = 3 * node->first; i < 3 * (node->first + node->count); ++i) {
            pe_vec3 v = solid->vertices[solid->triangles[i / 3][i % 3]];
            if (pe_dot(d, v) > most) {
                most = pe_dot(d, v);
                best = v;
            }
        }
    }
    return best;
}

/* ---- Points ---- */

/* The point of the triangle nearest to x. */
static pe_vec3 nearest_on_facet(const pe_facet *facet, pe_vec3 x)
{
    if (pe_facet_contains(facet, x, 0)) {
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

/* By the nearest triangle. If several are equally near to within rounding, the one whose normal is
 * most along the line to the point has the right sign. */
bool pe_solid_contains(const pe_solid *solid, pe_vec3 x)
{
    const pe_node *root = &solid->nodes[0];
    pe_vec3 in = pe_rotate(&root->axes, pe_sub(x, root->centre));
    if (fabs(in.x) > root->half.x || fabs(in.y) > root->half.y || fabs(in.z) > root->half.z) {
        return false;
    }
    const double rounding =
        PE_COORDINATE_ROUNDING * (pe_length(root->centre) + pe_length(root->half));
    double bound = HUGE_VAL, steepest = 0, height = 0;
    pe_facet_walk walk;
    pe_facet facet;
    pe_walk_near_point(solid, x, &walk);
    while (pe_walk_next(&walk, bound * (1 + PE_SURFACE_TIE) + rounding, &facet)) {
        pe_vec3 d = pe_sub(x, nearest_on_facet(&facet, x));
        double distance = pe_length(d), h = pe_dot(facet.normal, d);
        double steep = distance > 0 ? fabs(h) / distance : 1;
        bool nearer = distance < bound * (1 - PE_SURFACE_TIE) - rounding;
        if (nearer || (distance <= bound * (1 + PE_SURFACE_TIE) + rounding && steep > steepest)) {
            steepest = steep;
            height = h;
            bound = nearer ? distance : bound;
        }
    }
    return height < 0;
}

pe_vec3 pe_solid_nearest_point(const pe_solid *solid, pe_vec3 x)
{
    double bound = HUGE_VAL;
    pe_vec3 best = x;
    pe_facet_walk walk;
    pe_facet facet;
    pe_walk_near_point(solid, x, &walk);
    while (pe_walk_next(&walk, bound, &facet)) {
        pe_vec3 y = nearest_on_facet(&facet, x);
        double distance = pe_length(pe_sub(y, x));
        if (distance < bound) {
            bound = distance;
            best = y;
        }
    }
    return best;
}

/* ---- Segments ---- */

double pe_solid_exit(const pe_solid *solid, pe_vec3 x, pe_vec3 d, double slack)
{
    double least_rise = PE_LEAST_RISE * pe_length(d), first = HUGE_VAL;
    pe_facet_walk walk;
    pe_facet facet;
    pe_walk_near_segment(solid, x, d, &walk);
    while (pe_walk_next(&walk, slack, &facet)) {
        double from = facet.offset - pe_dot(facet.normal, x), rise = pe_dot(facet.normal, d);
        if (from < -slack || from > rise + slack || rise < least_rise) {
            continue;
        }
        double t = pe_max(0, from) / rise;
        if (t < first && pe_facet_contains(&facet, pe_madd(x, t, d), slack)) {
            first = t;
        }
    }
    return first < HUGE_VAL ? first : 0;
}

/* Whether the face shares an edge, at one of the facet's corners, with the facet's own face. */
static bool are_neighbours(const pe_solid *solid, const pe_facet *facet, int face)
{
    for (int k = 0; k < 3; ++k) {
        int v = facet->vertices[k];
        for (int i = solid->vertex_first[v]; i < solid->vertex_first[v + 1]; ++i) {
            const int *f = solid->edges[solid->vertex_edges[i]].face;
            if ((f[0] == face && f[1] == facet->face) || (f[1] == face && f[0] == facet->face)) {
                return true;
            }
        }
    }
    return false;
}

bool pe_solid_blocks(const pe_solid *solid, pe_vec3 x, pe_vec3 d, int face, double slack)
{
    pe_facet_walk walk;
    pe_facet facet;
    pe_walk_near_segment(solid, x, d, &walk);
    while (pe_walk_next(&walk, 0, &facet)) {
        double from = pe_dot(facet.normal, x) - facet.offset;
        double to = from + pe_dot(facet.normal, d);
        bool crosses = (from > slack && to < -slack) || (from < -slack && to > slack);
        /* The point of crossing decides, not its projection. */
        if (crosses && facet.face != face &&
            pe_facet_covers(&facet, pe_madd(x, from / (from - to), d), slack) &&
            !are_neighbours(solid, &facet, face)) {
            return true;
        }
    }
    return false;
}
