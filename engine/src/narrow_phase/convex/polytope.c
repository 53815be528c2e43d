/* Cores of the convex shapes, their support vertices and their faces. */
#include "polytope.h"

#include "narrow_phase/tolerances.h"

/* Hulls with more vertices than this use hill climbing. A scan is quicker for fewer. */
enum { SCAN_MOST = 24 };

/* A box: vertices as in pe_box_corner; face 2 k + 1 is the positive one of axis k, face 2 k the
 * negative one. Corners and edges as in geometry.h. */
static const int box_corners[24] = {4, 6, 2, 0, 1, 3, 7, 5, 1, 5, 4, 0,
                                    2, 6, 7, 3, 2, 3, 1, 0, 4, 5, 7, 6};
static const pe_edge box_edges[12] = {
    {{4, 6}, {0, 5}, true}, {{6, 2}, {0, 3}, true}, {{2, 0}, {0, 4}, true}, {{0, 4}, {0, 2}, true},
    {{1, 3}, {1, 4}, true}, {{3, 7}, {1, 3}, true}, {{7, 5}, {1, 5}, true}, {{5, 1}, {1, 2}, true},
    {{5, 4}, {2, 5}, true}, {{0, 1}, {2, 4}, true}, {{6, 7}, {3, 5}, true}, {{3, 2}, {3, 4}, true},
};
static const int box_first[9] = {0, 3, 6, 9, 12, 15, 18, 21, 24};
static const int box_vertex_edges[24] = {2, 3, 9, 4, 7, 9, 1, 2, 11, 4, 5, 11,
                                         0, 3, 8, 6, 7, 8, 0, 1, 10, 5, 6, 10};

static const pe_edge segment_edge[1] = {{{0, 1}, {-1, -1}, true}};
static const int segment_first[3] = {0, 1, 2}, point_first[3] = {0, 0, 0};
static const int segment_vertex_edges[2] = {0, 0};

static void make_box(pe_vec3 e, pe_polytope *p)
{
    p->vertex_count = 8;
    p->edge_count = 12;
    p->face_count = 6;
    for (int i = 0; i < 8; ++i) {
        p->own_vertices[i] = pe_box_corner(e, i);
    }
    for (int i = 0; i < 6; ++i) {
        double side = i & 1 ? 1 : -1;
        p->own_faces[i] = (pe_face){
            .normal = pe_v3(i / 2 == 0 ? side : 0, i / 2 == 1 ? side : 0, i / 2 == 2 ? side : 0),
            .offset = pe_component(e, i / 2),
            .first_corner = 4 * i,
            .corner_count = 4,
        };
    }
    p->edges = box_edges;
    p->corners = box_corners;
    p->vertex_first = box_first;
    p->vertex_edges = box_vertex_edges;
    p->inner = pe_min(e.x, pe_min(e.y, e.z));
}

static void make_hull(const pe_geometry *g, pe_polytope *p)
{
    p->vertex_count = g->vertex_count;
    p->edge_count = g->edge_count;
    p->face_count = g->face_count;
    p->vertices = g->vertices;
    p->edges = g->edges;
    p->faces = g->faces;
    p->corners = g->corners;
    p->vertex_first = g->vertex_first;
    p->vertex_edges = g->vertex_edges;
    p->inner = HUGE_VAL;
    for (int i = 0; i < g->face_count; ++i) {
        p->inner = pe_min(p->inner, g->faces[i].offset);
    }
}

void pe_polytope_make(pe_placed placed, pe_polytope *p)
{
    const pe_shape *shape = placed.shape;
    p->vertices = p->own_vertices;
    p->faces = p->own_faces;
    p->radius = p->inner = 0;
    if (shape->kind == PE_SHAPE_BOX) {
        make_box(shape->half_extents, p);
    } else if (placed.geometry != NULL) {
        make_hull(placed.geometry, p);
    } else {
        bool segment = shape->kind == PE_SHAPE_CAPSULE;
        double half = segment ? shape->half_height : 0;
        p->vertex_count = segment ? 2 : 1;
        p->edge_count = segment ? 1 : 0;
        p->face_count = 0;
        p->own_vertices[0] = pe_v3(0, 0, -half);
        p->own_vertices[1] = pe_v3(0, 0, half);
        p->edges = segment_edge;
        p->corners = NULL;
        p->vertex_first = segment ? segment_first : point_first;
        p->vertex_edges = segment_vertex_edges;
        p->radius = shape->radius;
    }
}

void pe_polytope_pair_make(pe_placed a, pe_placed b, pe_polytope_pair *pair)
{
    pe_polytope_make(a, &pair->a);
    pe_polytope_make(b, &pair->b);
    pair->pose_a = a.pose;
    pair->pose_b = b.pose;
    pair->size = pe_min(a.size, b.size);
    const pe_mat3 *ra = &a.pose->rotation, *rb = &b.pose->rotation;
    pe_vec3 offset = pe_sub(b.pose->position, a.pose->position);
    pe_vec3 x = pe_unrotate(ra, pe_axis(rb, 0)), y = pe_unrotate(ra, pe_axis(rb, 1)),
            z = pe_unrotate(ra, pe_axis(rb, 2));
    pair->a_in_b.turn = (pe_mat3){x, y, z};
    pair->b_in_a.turn = (pe_mat3){{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
    pair->b_in_a.offset = pe_unrotate(ra, offset);
    pair->a_in_b.offset = pe_unrotate(rb, pe_scale(-1, offset));
}

int pe_polytope_support(const pe_polytope *p, pe_vec3 d, int from)
{
    int best = -1;
    double most = -HUGE_VAL;
    if (p->vertex_count <= SCAN_MOST) {
        for (int i = 0; i < p->vertex_count; ++i) {
            double x = pe_dot(d, p->vertices[i]);
            if (x > most) {
                most = x;
                best = i;
            }
        }
        return best;
    }
    best = from >= 0 ? from : p->edges[0].vertex[0];
    most = pe_dot(d, p->vertices[best]);
    for (int at = -1; at != best;) {
        at = best;
        for (int k = p->vertex_first[at]; k < p->vertex_first[at + 1]; ++k) {
            const pe_edge *edge = &p->edges[p->vertex_edges[k]];
            int next = edge->vertex[0] == at ? edge->vertex[1] : edge->vertex[0];
            double x = pe_dot(d, p->vertices[next]);
            if (x > most) {
                most = x;
                best = next;
            }
        }
    }
    return best;
}

double pe_polytope_separation_along(const pe_polytope_pair *pair, pe_vec3 n)
{
    pe_vec3 back = pe_scale(-1, pe_unrotate(&pair->b_in_a.turn, n));
    pe_vec3 last = pair->a.vertices[pe_polytope_support(&pair->a, n, -1)];
    pe_vec3 first = pair->b.vertices[pe_polytope_support(&pair->b, back, -1)];
    return pe_dot(n, pair->b_in_a.offset) - pe_dot(back, first) - pe_dot(n, last);
}

int pe_polytope_facing(const pe_polytope *p, pe_vec3 d, double *cosine)
{
    int vertex = pe_polytope_support(p, d, -1), best = -1;
    bool found_level = false;
    *cosine = -2;
    for (int k = p->vertex_first[vertex]; k < p->vertex_first[vertex + 1]; ++k) {
        const pe_edge *edge = &p->edges[p->vertex_edges[k]];
        pe_vec3 along = pe_sub(p->vertices[edge->vertex[1]], p->vertices[edge->vertex[0]]);
        double rise = pe_dot(d, along);
        bool level = rise * rise < PE_LEVEL_EDGE * PE_LEVEL_EDGE * pe_dot(along, along);
        if (found_level && !level) {
            continue;
        }
        if (level && !found_level) {
            found_level = true;
            *cosine = -2;
            best = -1;
        }
        for (int side = 0; side < 2; ++side) {
            int face = edge->face[side];
            double c = pe_dot(d, p->faces[face].normal);
            if (c > *cosine + PE_FACING_TIE || (c > *cosine - PE_FACING_TIE && face < best)) {
                *cosine = pe_max(c, *cosine);
                best = face;
            }
        }
    }
    return best;
}

int pe_face_corners(const pe_face *face)
{
    return face->corner_count < PE_FACE_CORNERS ? face->corner_count : PE_FACE_CORNERS;
}

int pe_face_corner(const pe_polytope *p, const pe_face *face, int k)
{
    int count = face->corner_count;
    int at = count <= PE_FACE_CORNERS ? k : (int)((int64_t)k * count / PE_FACE_CORNERS);
    return p->corners[face->first_corner + at];
}
