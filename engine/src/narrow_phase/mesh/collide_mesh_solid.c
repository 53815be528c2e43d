/* The solids of a pair, their triangles and their edges, as the colliders of meshes see them. */
#include "collide_mesh.h"

/* In units of the band: a parting direction is good enough when its gap is within this of the
 * distance of the hulls. */
static const double PARTING_TOLERANCE = 0.03;

/* A box: corner i lies on the positive side of axis k where bit k of i is set; face 2 k + 1 is that
 * side, face 2 k the other one. */
static const int BOX_TRIANGLES[12][3] = {{4, 6, 2}, {4, 2, 0}, {1, 3, 7}, {1, 7, 5},
                                         {1, 5, 4}, {1, 4, 0}, {2, 6, 7}, {2, 7, 3},
                                         {2, 3, 1}, {2, 1, 0}, {4, 5, 7}, {4, 7, 6}};
static const int BOX_TRIANGLE_EDGES[12][3] = {{0, 1, -1},  {-1, 2, 3}, {4, 5, -1},  {-1, 6, 7},
                                              {7, 8, -1},  {-1, 3, 9}, {1, 10, -1}, {-1, 5, 11},
                                              {11, 4, -1}, {-1, 9, 2}, {8, 6, -1},  {-1, 10, 0}};
static const int BOX_TRIANGLE_FACE[12] = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
static const unsigned char BOX_OWNS[12] = {31, 52, 31, 52, 16, 32, 16, 32, 0, 0, 0, 0};
static const pe_edge BOX_EDGES[12] = {
    {{4, 6}, {0, 5}, true}, {{6, 2}, {0, 3}, true}, {{2, 0}, {0, 4}, true}, {{0, 4}, {0, 2}, true},
    {{1, 3}, {1, 4}, true}, {{3, 7}, {1, 3}, true}, {{7, 5}, {1, 5}, true}, {{5, 1}, {1, 2}, true},
    {{5, 4}, {2, 5}, true}, {{0, 1}, {2, 4}, true}, {{6, 7}, {3, 5}, true}, {{3, 2}, {3, 4}, true}};
static const int BOX_VERTEX_FIRST[9] = {0, 3, 6, 9, 12, 15, 18, 21, 24};
static const int BOX_VERTEX_EDGES[24] = {2, 3, 9, 4, 7, 9, 1, 2, 11, 4, 5, 11,
                                         0, 3, 8, 6, 7, 8, 0, 1, 10, 5, 6, 10};

/* A point is a segment of no length. */
static const int CORE_TRIANGLE[1][3] = {{0, 1, 1}};
static const int CORE_TRIANGLE_EDGES[1][3] = {{0, -1, -1}};
static const int CORE_TRIANGLE_FACE[1] = {-1};
static const unsigned char SEGMENT_OWNS[1] = {1 | 2 | 8}, POINT_OWNS[1] = {1 | 8};
static const pe_edge CORE_EDGE[1] = {{{0, 1}, {-1, -1}, true}};
static const int SEGMENT_VERTEX_FIRST[3] = {0, 1, 2}, POINT_VERTEX_FIRST[3] = {0, 0, 0};
static const int CORE_VERTEX_EDGES[2] = {0, 0};

pe_solid pe_solid_of_geometry(const pe_geometry *g)
{
    return (pe_solid){
        .convex = g->convex,
        .nodes = g->nodes,
        .vertices = g->vertices,
        .triangles = (const int(*)[3])g->triangles,
        .triangle_edges = (const int(*)[3])g->triangle_edges,
        .triangle_face = g->triangle_face,
        .triangle_owns = g->triangle_owns,
        .faces = g->faces,
        .edges = g->edges,
        .vertex_first = g->vertex_first,
        .vertex_edges = g->vertex_edges,
        .vertex_count = g->vertex_count,
        .triangle_count = g->triangle_count,
        .volume = g->frame.volume,
    };
}

pe_node pe_box_node(pe_vec3 centre, pe_vec3 half)
{
    return (pe_node){
        .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        .centre = centre,
        .half = half,
        .radius = pe_length(half),
        .right = -1,
        .count = 1,
    };
}

/* Leaves are the faces, on a chain of boxes of the whole. */
static void make_box_nodes(pe_vec3 half, pe_node nodes[11])
{
    for (int face = 0; face < 6; ++face) {
        double side = face % 2 == 1 ? 1 : -1;
        pe_vec3 across = face < 2 ? pe_v3(1, 0, 0) : face < 4 ? pe_v3(0, 1, 0) : pe_v3(0, 0, 1);
        pe_vec3 out = pe_mul(across, half);
        int leaf = face < 5 ? 2 * face + 1 : 10;
        nodes[leaf] = pe_box_node(pe_scale(side, out), pe_sub(half, out));
        nodes[leaf].first = 2 * face;
        nodes[leaf].count = 2;
        if (face < 5) {
            nodes[2 * face] = pe_box_node(pe_v3(0, 0, 0), half);
            nodes[2 * face].right = 2 * face + 2;
        }
    }
}

static pe_solid solid_of_box(pe_vec3 half, pe_small_solid *small)
{
    for (int i = 0; i < 8; ++i) {
        small->vertices[i] = pe_v3((i & 1) != 0 ? half.x : -half.x, (i & 2) != 0 ? half.y : -half.y,
                                   (i & 4) != 0 ? half.z : -half.z);
    }
    for (int face = 0; face < 6; ++face) {
        double side = face % 2 == 1 ? 1 : -1;
        small->faces[face] = (pe_face){
            .normal =
                pe_v3(face / 2 == 0 ? side : 0, face / 2 == 1 ? side : 0, face / 2 == 2 ? side : 0),
            .offset = pe_component(half, face / 2),
        };
    }
    make_box_nodes(half, small->nodes);
    return (pe_solid){
        .convex = true,
        .nodes = small->nodes,
        .vertices = small->vertices,
        .triangles = BOX_TRIANGLES,
        .triangle_edges = BOX_TRIANGLE_EDGES,
        .triangle_face = BOX_TRIANGLE_FACE,
        .triangle_owns = BOX_OWNS,
        .faces = small->faces,
        .edges = BOX_EDGES,
        .vertex_first = BOX_VERTEX_FIRST,
        .vertex_edges = BOX_VERTEX_EDGES,
        .vertex_count = 8,
        .triangle_count = 12,
        .volume = 8 * half.x * half.y * half.z,
    };
}

static pe_solid solid_of_core(double half_height, pe_small_solid *small)
{
    small->vertices[0] = pe_v3(0, 0, -half_height);
    small->vertices[1] = pe_v3(0, 0, half_height);
    small->nodes[0] = pe_box_node(pe_v3(0, 0, 0), pe_v3(0, 0, half_height));
    return (pe_solid){
        .core = true,
        .convex = true,
        .nodes = small->nodes,
        .vertices = small->vertices,
        .triangles = CORE_TRIANGLE,
        .triangle_edges = CORE_TRIANGLE_EDGES,
        .triangle_face = CORE_TRIANGLE_FACE,
        .triangle_owns = half_height > 0 ? SEGMENT_OWNS : POINT_OWNS,
        .edges = CORE_EDGE,
        .vertex_first = half_height > 0 ? SEGMENT_VERTEX_FIRST : POINT_VERTEX_FIRST,
        .vertex_edges = CORE_VERTEX_EDGES,
        .vertex_count = half_height > 0 ? 2 : 1,
        .triangle_count = 1,
    };
}

static pe_solid solid_of(pe_placed placed, pe_small_solid *small)
{
    const pe_shape *shape = placed.shape;
    return placed.geometry != NULL           ? pe_solid_of_geometry(placed.geometry)
           : shape->kind == PE_SHAPE_BOX     ? solid_of_box(shape->half_extents, small)
           : shape->kind == PE_SHAPE_CAPSULE ? solid_of_core(shape->half_height, small)
                                             : solid_of_core(0, small);
}

static double bounding_radius(pe_placed p)
{
    return p.geometry != NULL                 ? p.geometry->bounding_radius
           : p.shape->kind == PE_SHAPE_BOX    ? pe_length(p.shape->half_extents)
           : p.shape->kind == PE_SHAPE_SPHERE ? p.shape->radius
                                              : p.shape->radius + p.shape->half_height;
}

pe_bvh_pair pe_bvh_pair_between(const pe_node *a, const pe_pose *pose_a, const pe_node *b,
                                const pe_pose *pose_b)
{
    const pe_mat3 *ra = &pose_a->rotation, *rb = &pose_b->rotation;
    return (pe_bvh_pair){
        .a = a,
        .b = b,
        .turn = {pe_unrotate(ra, pe_axis(rb, 0)), pe_unrotate(ra, pe_axis(rb, 1)),
                 pe_unrotate(ra, pe_axis(rb, 2))},
        .offset = pe_unrotate(rb, pe_sub(pose_a->position, pose_b->position)),
    };
}

void pe_solid_pair_make(pe_placed a, pe_placed b, pe_solid_pair *pair)
{
    bool rounded = a.shape->kind == PE_SHAPE_SPHERE || a.shape->kind == PE_SHAPE_CAPSULE;
    pair->a = solid_of(a, &pair->small);
    pair->b = pe_solid_of_geometry(b.geometry);
    pair->near_a = pair->near_b = NULL;
    pair->radius = rounded ? a.shape->radius : 0;
    pair->size = pe_min(a.size, b.size);
    pair->slack = PE_SLACK * pair->size;
    pair->depth = PE_DEPTH * pair->size;
    pair->band = PE_BAND * pe_min(bounding_radius(a), bounding_radius(b));

    pair->trees = pe_bvh_pair_between(pair->a.nodes, a.pose, pair->b.nodes, b.pose);
    pair->swapped = pe_bvh_pair_between(pair->b.nodes, b.pose, pair->a.nodes, a.pose);
}

void pe_solid_facet(const pe_solid *solid, int triangle, pe_facet *facet)
{
    facet->vertices = solid->triangles[triangle];
    facet->edges = solid->triangle_edges[triangle];
    facet->face = solid->triangle_face[triangle];
    facet->owns = solid->triangle_owns[triangle];
    for (int k = 0; k < 3; ++k) {
        facet->x[k] = solid->vertices[facet->vertices[k]];
    }
    facet->normal = facet->face >= 0 ? solid->faces[facet->face].normal : pe_v3(0, 0, 0);
    facet->offset = facet->face >= 0 ? solid->faces[facet->face].offset : 0;
    facet->ridge_count = -1;
}

void pe_facet_of_a(const pe_solid_pair *pair, int triangle, pe_facet *facet)
{
    const pe_bvh_pair *seen = &pair->trees;
    pe_solid_facet(&pair->a, triangle, facet);
    for (int k = 0; k < 3; ++k) {
        facet->x[k] = pe_add(pe_rotate(&seen->turn, facet->x[k]), seen->offset);
    }
    facet->normal = pe_rotate(&seen->turn, facet->normal);
    facet->offset += pe_dot(facet->normal, seen->offset);
}

/* How far x lies inside the edge from corner k, along the plane, in units of 1/length of it. */
static double inset(const pe_facet *facet, int k, pe_vec3 x, double *length2)
{
    pe_vec3 from = facet->x[k], u = pe_sub(facet->x[k < 2 ? k + 1 : 0], from);
    *length2 = pe_dot(u, u);
    return pe_dot(pe_cross(facet->normal, u), pe_sub(x, from));
}

/* Whether x, beyond the sides that are marked and seen along the normal, is farther from a corner
 * than the slack beyond both sides of a right angle: at a sharp one both lines are near far off. */
static bool is_past_a_corner(const pe_facet *facet, const bool beyond[3], pe_vec3 x, double slack)
{
    for (int k = 0; k < 3; ++k) {
        if (beyond[k] && beyond[k > 0 ? k - 1 : 2]) {
            pe_vec3 d = pe_sub(x, facet->x[k]);
            double height = pe_dot(facet->normal, d);
            return pe_dot(d, d) - height * height > 2 * slack * slack;
        }
    }
    return false;
}

bool pe_facet_holds(const pe_facet *facet, pe_vec3 x, double slack)
{
    bool beyond[3];
    for (int k = 0; k < 3; ++k) {
        double length2, in = inset(facet, k, x, &length2);
        beyond[k] = in < 0;
        if (beyond[k] && in * in > slack * slack * length2) {
            return false;
        }
    }
    return !is_past_a_corner(facet, beyond, x, slack);
}

/* Whether x is behind the face of the solid, but by no more than `past`. */
static bool is_behind(const pe_solid *solid, const pe_bvh_pair *seen, int face, pe_vec3 x,
                      double slack, double past)
{
    pe_vec3 own = seen != NULL ? pe_unrotate(&seen->turn, pe_sub(x, seen->offset)) : x;
    double height = pe_dot(solid->faces[face].normal, own) - solid->faces[face].offset;
    return height <= slack && height >= -past;
}

bool pe_facet_holds_dented(const pe_solid *solid, const pe_bvh_pair *seen, const pe_facet *facet,
                           pe_vec3 x, double slack, double past, bool *dent)
{
    bool beyond[3];
    *dent = false;
    past = pe_max(past, slack);
    for (int k = 0; k < 3; ++k) {
        double length2, in = inset(facet, k, x, &length2);
        beyond[k] = in < 0;
        if (in > 0 && in * in > slack * slack * length2) {
            continue;
        }
        const pe_edge *edge = facet->edges[k] >= 0 ? &solid->edges[facet->edges[k]] : NULL;
        if (edge == NULL || edge->convex) {
            if (in * in > slack * slack * length2) {
                return false;
            }
            continue;
        }
        if (in * in > past * past * length2 ||
            !is_behind(solid, seen, edge->face[edge->face[0] == facet->face], x, slack, past)) {
            return false;
        }
        *dent = true;
        beyond[k] = false;
    }
    return !is_past_a_corner(facet, beyond, x, slack);
}

bool pe_facet_heights(const pe_facet *over, const pe_facet *of, double bound, double height[3])
{
    for (int k = 0; k < 3; ++k) {
        height[k] = pe_dot(over->normal, of->x[k]) - over->offset;
    }
    return pe_min(height[0], pe_min(height[1], height[2])) <= bound &&
           pe_max(height[0], pe_max(height[1], height[2])) >= -bound;
}

/* Adds the points at which edges of the facet `of` pierce the other. An edge that begins in its
 * plane does so there. */
static int add_piercings(const pe_facet *over, const pe_facet *of, const double height[3],
                         double slack, pe_vec3 *where, int count)
{
    for (int k = 0; k < 3; ++k) {
        int next = k < 2 ? k + 1 : 0;
        double p = height[k], q = height[next];
        bool begins = fabs(p) <= slack, passes = fabs(q) > slack && (p > 0) != (q > 0);
        if (begins || passes) {
            double t = begins ? 0 : p / (p - q);
            pe_vec3 x = pe_madd(of->x[k], t, pe_sub(of->x[next], of->x[k]));
            if (pe_facet_holds(over, x, slack)) {
                where[count++] = x;
            }
        }
    }
    return count;
}

int pe_facets_cross(const pe_facet *a, const double above_b[3], const pe_facet *b,
                    const double above_a[3], double slack, pe_vec3 where[PE_MOST_PIERCINGS])
{
    int count = add_piercings(b, a, above_b, slack, where, 0);
    return a->face >= 0 ? add_piercings(a, b, above_a, slack, where, count) : count;
}

void pe_facet_ridges(const pe_solid *solid, const pe_bvh_pair *seen, pe_facet *facet)
{
    if (facet->ridge_count >= 0) {
        return;
    }
    facet->ridge_count = 0;
    for (int k = 0; k < 3; ++k) {
        if ((facet->owns >> (3 + k) & 1) == 0) {
            continue;
        }
        pe_ridge *r = &facet->ridges[facet->ridge_count++];
        r->edge = facet->edges[k];
        r->x = facet->x[k];
        r->along = pe_sub(facet->x[k < 2 ? k + 1 : 0], r->x);
        r->length2 = pe_dot(r->along, r->along);
        r->length = sqrt(r->length2);
        r->normal[0] = r->normal[1] = facet->normal;
        int face = solid->edges[facet->edges[k]].face[1];
        if (face >= 0) {
            pe_vec3 n = solid->faces[face].normal;
            r->normal[1] = seen != NULL ? pe_rotate(&seen->turn, n) : n;
        }
    }
}

bool pe_ridge_faces(const pe_ridge *r, pe_vec3 n, double length, double sine)
{
    double most = sine * length * r->length;
    return pe_dot(n, pe_cross(r->normal[0], r->along)) <= most &&
           pe_dot(n, pe_cross(r->along, r->normal[1])) <= most;
}

static double clamp01(double x)
{
    return pe_max(0, pe_min(1, x));
}

void pe_segments_nearest(pe_vec3 x, pe_vec3 u, pe_vec3 y, pe_vec3 v, double *s, double *t)
{
    pe_vec3 d = pe_sub(y, x);
    double uu = pe_dot(u, u), vv = pe_dot(v, v), uv = pe_dot(u, v);
    double du = pe_dot(d, u), dv = pe_dot(d, v);
    double det = uu * vv - uv * uv;
    /* The best s for the whole second line; then the best t for it; where t had to be held to its
     * segment, the best s for that end. */
    *s = det > 0 ? clamp01((du * vv - dv * uv) / det) : 0;
    double best = vv > 0 ? (*s * uv - dv) / vv : 0;
    *t = clamp01(best);
    if (best != *t || !(det > 0)) {
        *s = uu > 0 ? clamp01((du + *t * uv) / uu) : 0;
    }
}

/* Of few vertices each is looked at. */
static pe_vec3 support_of_few(const pe_solid *solid, pe_vec3 d)
{
    int best = 0;
    double most = -HUGE_VAL;
    for (int i = 0; i < solid->vertex_count; ++i) {
        double along = pe_dot(d, solid->vertices[i]);
        best = along > most ? i : best;
        most = pe_max(most, along);
    }
    return solid->vertices[best];
}

pe_vec3 pe_solid_support(const pe_solid *solid, pe_vec3 d)
{
    enum { FEW = 1000 };
    if (solid->vertex_count <= FEW) {
        return support_of_few(solid, d);
    }
    int stack[PE_BVH_STACK] = {0}, depth = 1;
    double most = -HUGE_VAL;
    pe_vec3 best = solid->vertices[0];
    while (depth > 0) {
        int index = stack[--depth];
        const pe_node *node = &solid->nodes[index];
        if (pe_dot(d, node->centre) + pe_node_reach(node, d) <= most) {
            continue;
        }
        if (node->right >= 0) {
            /* The child that is farther along is looked at first. */
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

bool pe_solid_pair_part(pe_solid_pair *pair, double limit)
{
    enum { MOST_STEPS = 6 };
    pe_bvh_pair *trees = &pair->trees;
    pe_vec3 v = pe_scale(-1, trees->offset); /* of b - a, as near to the origin as is known */
    if (!(pe_dot(v, v) > 0)) {
        v = pe_v3(0, 0, pair->size); /* any direction tells something of concentric solids */
    }
    double best = -HUGE_VAL;
    for (int step = 0; step < MOST_STEPS; ++step) {
        double length = pe_length(v);
        if (!(length > 0)) {
            break;
        }
        pe_vec3 n = pe_scale(1 / length, v), back = pe_unrotate(&trees->turn, n);
        pe_vec3 a = pe_solid_support(&pair->a, back),
                b = pe_solid_support(&pair->b, pe_scale(-1, n));
        pe_vec3 in_b = pe_add(pe_rotate(&trees->turn, a), trees->offset), w = pe_sub(b, in_b);
        double gap = pe_dot(n, w);
        if (gap > limit) {
            return false;
        }
        if (gap > best) {
            best = gap;
            trees->parting = n;
            trees->parting_a = back;
            trees->most_a = pe_dot(n, in_b) + pair->slack;
            trees->least_b = pe_dot(n, b) - pair->slack;
        }
        pe_vec3 u = pe_sub(w, v);
        double uu = pe_dot(u, u), t = uu > 0 ? -pe_dot(v, u) / uu : 0;
        if (!(t > 0) || length - gap < PARTING_TOLERANCE * pair->band) {
            break;
        }
        v = pe_madd(v, pe_min(1, t), u);
    }
    pair->depth = pe_min(pair->depth, pe_max(0, -best) + pair->slack);
    return true;
}
