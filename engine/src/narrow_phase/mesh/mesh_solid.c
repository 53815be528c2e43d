/* Solids made of shapes, their triangles and their edges. */
#include "mesh_solid.h"

#include "bvh.h"
#include "narrow_phase/tolerances.h"

/* ---- Solids ---- */

/* A box as in polytope.c, with two triangles a face. */
static const int BOX_TRIANGLES[12][3] = {{4, 6, 2}, {4, 2, 0}, {1, 3, 7}, {1, 7, 5},
                                         {1, 5, 4}, {1, 4, 0}, {2, 6, 7}, {2, 7, 3},
                                         {2, 3, 1}, {2, 1, 0}, {4, 5, 7}, {4, 7, 6}};
static const int BOX_TRIANGLE_EDGES[12][3] = {{0, 1, -1},  {-1, 2, 3}, {4, 5, -1},  {-1, 6, 7},
                                              {7, 8, -1},  {-1, 3, 9}, {1, 10, -1}, {-1, 5, 11},
                                              {11, 4, -1}, {-1, 9, 2}, {8, 6, -1},  {-1, 10, 0}};
static const int BOX_TRIANGLE_FACE[12] = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
static const unsigned char BOX_OWNS[12] = {31, 52, 31, 52, 16, 32, 16, 32, 0, 0, 0, 0};

/* A point is a segment of no length. */
static const int CORE_TRIANGLE[1][3] = {{0, 1, 1}};
static const int CORE_TRIANGLE_EDGES[1][3] = {{0, -1, -1}};
static const int CORE_TRIANGLE_FACE[1] = {-1};
static const unsigned char SEGMENT_OWNS[1] = {1 | 2 | 8}, POINT_OWNS[1] = {1 | 8};

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

/* The leaves are the faces, on a chain of boxes of the whole. */
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

pe_solid pe_solid_of(pe_placed placed, pe_small_solid *small)
{
    if (placed.geometry != NULL) {
        return pe_solid_of_geometry(placed.geometry);
    }
    const pe_shape *shape = placed.shape;
    const pe_polytope *p = &small->polytope;
    pe_polytope_make(placed, &small->polytope);
    pe_solid solid = {
        .core = shape->kind != PE_SHAPE_BOX,
        .convex = true,
        .nodes = small->nodes,
        .vertices = p->vertices,
        .triangles = CORE_TRIANGLE,
        .triangle_edges = CORE_TRIANGLE_EDGES,
        .triangle_face = CORE_TRIANGLE_FACE,
        .triangle_owns = p->vertex_count > 1 ? SEGMENT_OWNS : POINT_OWNS,
        .faces = p->faces,
        .edges = p->edges,
        .vertex_first = p->vertex_first,
        .vertex_edges = p->vertex_edges,
        .vertex_count = p->vertex_count,
        .triangle_count = 1,
    };
    if (solid.core) {
        small->nodes[0] = pe_box_node(pe_v3(0, 0, 0), pe_v3(0, 0, p->vertices[1].z));
        return solid;
    }
    pe_vec3 half = shape->half_extents;
    make_box_nodes(half, small->nodes);
    solid.triangles = BOX_TRIANGLES;
    solid.triangle_edges = BOX_TRIANGLE_EDGES;
    solid.triangle_face = BOX_TRIANGLE_FACE;
    solid.triangle_owns = BOX_OWNS;
    solid.triangle_count = 12;
    solid.volume = 8 * half.x * half.y * half.z;
    return solid;
}

/* ---- Triangles ---- */

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

void pe_solid_facet_placed(const pe_solid *solid, const pe_transform *placed, int triangle,
                           pe_facet *facet)
{
    pe_solid_facet(solid, triangle, facet);
    for (int k = 0; k < 3; ++k) {
        facet->x[k] = pe_transform_point(placed, facet->x[k]);
    }
    facet->normal = pe_rotate(&placed->turn, facet->normal);
    facet->offset += pe_dot(facet->normal, placed->offset);
}

void pe_facet_ridges(const pe_solid *solid, const pe_transform *placed, pe_facet *facet)
{
    if (facet->ridge_count >= 0) {
        return;
    }
    facet->ridge_count = 0;
    for (int k = 0; k < 3; ++k) {
        if (!pe_facet_owns_edge(facet, k)) {
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
            r->normal[1] = placed != NULL ? pe_rotate(&placed->turn, n) : n;
        }
    }
}

/* The distance of x inside the edge from corner k, along the plane, times the edge's length. */
static double inset(const pe_facet *facet, int k, pe_vec3 x, double *length2)
{
    pe_vec3 from = facet->x[k], u = pe_sub(facet->x[k < 2 ? k + 1 : 0], from);
    *length2 = pe_dot(u, u);
    return pe_dot(pe_cross(facet->normal, u), pe_sub(x, from));
}

/* Whether x, seen along the normal, is past an end of the side from corner k. At a sharp corner the
 * lines of both sides are near even far away. */
static bool is_past_an_end(const pe_facet *facet, int k, pe_vec3 x, double slack)
{
    pe_vec3 from = facet->x[k], u = pe_sub(facet->x[k < 2 ? k + 1 : 0], from);
    double along = pe_dot(u, pe_sub(x, from)), length2 = pe_dot(u, u);
    double past = pe_max(-along, along - length2);
    return past > 0 && past * past > slack * slack * length2;
}

/* How far, in units of the slack, a point may lie beyond the border of two triangles of one face. The
 * other triangle has what lies farther. */
static const double SEAM = PE_MESH_SEAM / PE_MESH_SLACK;

/* Whether x is over the facet, or beyond its rim by at most `slack` at an edge of the solid, and by
 * `seam` at a border inside a face. */
static bool contains(const pe_facet *facet, pe_vec3 x, double slack, double seam)
{
    for (int k = 0; k < 3; ++k) {
        double length2, in = inset(facet, k, x, &length2);
        double most = facet->edges[k] >= 0 ? slack : seam;
        if (in < 0 &&
            (in * in > most * most * length2 || is_past_an_end(facet, k, x, pe_max(slack, seam)))) {
            return false;
        }
    }
    return true;
}

bool pe_facet_contains(const pe_facet *facet, pe_vec3 x, double slack)
{
    return contains(facet, x, slack, SEAM * slack);
}

bool pe_facet_covers(const pe_facet *facet, pe_vec3 x, double slack)
{
    return contains(facet, x, 0, SEAM * slack);
}

/* Whether x is behind the face of the solid, but by no more than `past`. */
static bool is_behind(const pe_solid *solid, const pe_transform *placed, int face, pe_vec3 x,
                      double slack, double past)
{
    pe_vec3 own = placed != NULL ? pe_transform_back(placed, x) : x;
    double height = pe_dot(solid->faces[face].normal, own) - solid->faces[face].offset;
    return height <= slack && height >= -past;
}

pe_facet_side pe_facet_contains_dented(const pe_solid *solid, const pe_transform *placed,
                                       const pe_facet *facet, pe_vec3 x, double slack, double past)
{
    bool dent = false;
    past = pe_max(past, slack);
    for (int k = 0; k < 3; ++k) {
        double length2, in = inset(facet, k, x, &length2);
        if (in > 0 && in * in > slack * slack * length2) {
            continue;
        }
        const pe_edge *edge = facet->edges[k] >= 0 ? &solid->edges[facet->edges[k]] : NULL;
        if (edge == NULL || edge->convex) {
            double most = edge == NULL ? SEAM * slack : slack;
            if (in < 0 && (in * in > most * most * length2 || is_past_an_end(facet, k, x, slack))) {
                return PE_OFF_FACET;
            }
            continue;
        }
        if (in * in > past * past * length2 ||
            !is_behind(solid, placed, edge->face[edge->face[0] == facet->face], x, slack, past)) {
            return PE_OFF_FACET;
        }
        dent = true;
    }
    return dent ? PE_BEHIND_DENT : PE_ON_FACET;
}

/* The heights of the corners of `of` over the plane of `over`. */
static bool heights(const pe_facet *over, const pe_facet *of, double bound, double height[3])
{
    for (int k = 0; k < 3; ++k) {
        height[k] = pe_dot(over->normal, of->x[k]) - over->offset;
    }
    return pe_min(height[0], pe_min(height[1], height[2])) <= bound &&
           pe_max(height[0], pe_max(height[1], height[2])) >= -bound;
}

bool pe_facets_heights(const pe_facet *a, const pe_facet *b, double bound, pe_facet_heights *h)
{
    h->above_a[0] = h->above_a[1] = h->above_a[2] = 0;
    return heights(b, a, bound, h->above_b) && (a->face < 0 || heights(a, b, bound, h->above_a));
}

/* Adds the points where edges of the facet `of` pierce the facet `over`. An edge that begins in the
 * plane of `over` pierces it there. */
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
            if (pe_facet_contains(over, x, slack)) {
                where[count++] = x;
            }
        }
    }
    return count;
}

int pe_facets_cross(const pe_facet *a, const pe_facet *b, const pe_facet_heights *h, double slack,
                    pe_vec3 where[PE_MOST_PIERCINGS])
{
    int count = add_piercings(b, a, h->above_b, slack, where, 0);
    return a->face >= 0 ? add_piercings(a, b, h->above_a, slack, where, count) : count;
}

/* ---- Edges and vertices ---- */

bool pe_ridge_faces(const pe_ridge *r, pe_vec3 n, double length, double sine)
{
    double most = sine * length * r->length;
    return pe_dot(n, pe_cross(r->normal[0], r->along)) <= most &&
           pe_dot(n, pe_cross(r->along, r->normal[1])) <= most;
}

bool pe_vertex_faces(const pe_solid *solid, int vertex, pe_vec3 d, double length, double sine)
{
    for (int i = solid->vertex_first[vertex]; i < solid->vertex_first[vertex + 1]; ++i) {
        const pe_edge *edge = &solid->edges[solid->vertex_edges[i]];
        int other = edge->vertex[edge->vertex[0] == vertex];
        pe_vec3 u = pe_sub(solid->vertices[other], solid->vertices[vertex]);
        double rise = pe_dot(d, u), least = sine * length;
        if (rise < 0 && rise * rise > least * least * pe_dot(u, u)) {
            return false;
        }
    }
    return true;
}

bool pe_vertex_takes_normal(const pe_solid *solid, int vertex, pe_vec3 normal, bool *strict)
{
    *strict = pe_vertex_faces(solid, vertex, normal, 1, PE_FACING_STRICT);
    return *strict || pe_vertex_faces(solid, vertex, normal, 1, PE_FACING);
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
    double det = uu * vv - uv * uv, above = du * vv - dv * uv;
    if (det < PE_SEGMENTS_NEAR_PARALLEL2 * uu * vv) { /* the same without loss of digits */
        pe_vec3 c = pe_cross(u, v);
        det = pe_dot(c, c);
        above = pe_dot(pe_cross(d, v), c);
    }
    /* The best s for the whole second line, then the best t for that s. If t is clamped to its
     * segment, the best s for that end. */
    *s = det > 0 ? clamp01(above / det) : 0;
    double best = vv > 0 ? (*s * uv - dv) / vv : 0;
    *t = clamp01(best);
    if (best != *t || !(det > 0)) {
        *s = uu > 0 ? clamp01((du + *t * uv) / uu) : 0;
    }
}
