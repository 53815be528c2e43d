/* Distances by features, and depths by separating axes, without any shortcut. */
#include "polytope_truth.h"

#include "segment_distance.h"

#include <string.h>

static pe_vec3 to_world(const placed_shape *b, pe_vec3 x)
{
    return pe_add(b->pose.position, pe_rotate(&b->pose.rotation, x));
}

static void core_of_box(const placed_shape *b, polytope_core *c)
{
    pe_vec3 e = b->shape.half_extents;
    c->vertex_count = 8;
    for (int i = 0; i < 8; ++i) {
        c->vertices[i] =
            to_world(b, pe_v3(i & 1 ? e.x : -e.x, i & 2 ? e.y : -e.y, i & 4 ? e.z : -e.z));
        for (int k = 0; k < 3; ++k) {
            if (!(i >> k & 1)) {
                c->edges[c->edge_count][0] = i;
                c->edges[c->edge_count++][1] = i | 1 << k;
            }
        }
    }
    for (int k = 0; k < 3; ++k) {
        for (int side = 0; side < 2; ++side) {
            int u = 1 << (k + 1) % 3, v = 1 << (k + 2) % 3, base = side << k;
            int f = c->face_count++, corners[4] = {base, base | u, base | u | v, base | v};
            c->faces[f].normal = pe_scale(side ? 1 : -1, pe_axis(&b->pose.rotation, k));
            c->faces[f].count = 4;
            for (int i = 0; i < 4; ++i) {
                c->faces[f].corners[i] = corners[side ? i : 3 - i];
            }
        }
    }
}

static void core_of_hull(const placed_shape *b, polytope_core *c)
{
    const pe_geometry *g = b->geometry;
    c->vertex_count = g->vertex_count;
    c->edge_count = g->edge_count;
    c->face_count = g->face_count;
    for (int i = 0; i < g->vertex_count; ++i) {
        c->vertices[i] = to_world(b, g->vertices[i]);
    }
    for (int i = 0; i < g->edge_count; ++i) {
        c->edges[i][0] = g->edges[i].vertex[0];
        c->edges[i][1] = g->edges[i].vertex[1];
    }
    for (int i = 0; i < g->face_count; ++i) {
        c->faces[i].normal = pe_rotate(&b->pose.rotation, g->faces[i].normal);
        c->faces[i].count = g->faces[i].corner_count;
        for (int k = 0; k < g->faces[i].corner_count; ++k) {
            c->faces[i].corners[k] = g->corners[g->faces[i].first_corner + k];
        }
    }
}

void polytope_core_of(const placed_shape *b, polytope_core *c)
{
    memset(c, 0, sizeof *c);
    c->radius = b->shape.radius;
    if (b->shape.kind == PE_SHAPE_BOX) {
        core_of_box(b, c);
    } else if (b->shape.kind == PE_SHAPE_HULL) {
        core_of_hull(b, c);
    } else if (b->shape.kind == PE_SHAPE_CAPSULE) {
        c->vertex_count = 2;
        c->edge_count = 1;
        c->edges[0][1] = 1;
        c->vertices[0] = to_world(b, pe_v3(0, 0, -b->shape.half_height));
        c->vertices[1] = to_world(b, pe_v3(0, 0, b->shape.half_height));
    } else {
        c->vertex_count = 1;
        c->vertices[0] = b->pose.position;
    }
}

double core_farthest(const polytope_core *c, pe_vec3 d)
{
    double most = -HUGE_VAL;
    for (int i = 0; i < c->vertex_count; ++i) {
        most = pe_max(most, pe_dot(d, c->vertices[i]));
    }
    return most;
}

double core_gap_along(const polytope_core *a, const polytope_core *b, pe_vec3 d)
{
    return -core_farthest(b, pe_scale(-1, d)) - core_farthest(a, d) - a->radius - b->radius;
}

static pe_vec3 edge_of(const polytope_core *c, int i)
{
    return pe_sub(c->vertices[c->edges[i][1]], c->vertices[c->edges[i][0]]);
}

/* The largest gap over the finitely many directions that can have it when the cores overlap. */
static double gap_by_axes(const polytope_core *a, const polytope_core *b)
{
    double most = -HUGE_VAL;
    for (int i = 0; i < a->face_count; ++i) {
        most = pe_max(most, core_gap_along(a, b, a->faces[i].normal));
    }
    for (int i = 0; i < b->face_count; ++i) {
        most = pe_max(most, core_gap_along(a, b, pe_scale(-1, b->faces[i].normal)));
    }
    for (int i = 0; i < a->edge_count; ++i) {
        for (int j = 0; j < b->edge_count; ++j) {
            pe_vec3 n = pe_cross(edge_of(a, i), edge_of(b, j));
            double length = pe_length(n);
            if (length > 1e-9) {
                n = pe_scale(1 / length, n);
                most = pe_max(
                    most, pe_max(core_gap_along(a, b, n), core_gap_along(a, b, pe_scale(-1, n))));
            }
        }
    }
    return most;
}

/* Ends against the other segment, and the inner crossing of the lines. */
static double segment_to_segment(pe_vec3 p, pe_vec3 q, pe_vec3 r, pe_vec3 s)
{
    double least = ends_to_segments(p, q, r, s);
    pe_vec3 u = pe_sub(q, p), v = pe_sub(s, r), d = pe_sub(r, p), w = pe_cross(u, v);
    double square = pe_dot(w, w);
    if (square > 1e-20) {
        double along_u = pe_dot(pe_cross(d, v), w) / square;
        double along_v = pe_dot(pe_cross(d, u), w) / square;
        if (along_u >= 0 && along_u <= 1 && along_v >= 0 && along_v <= 1) {
            least = pe_min(least, fabs(pe_dot(d, w)) / sqrt(square));
        }
    }
    return least;
}

/* Height of x over face f of c, if its foot is on the face. */
static double point_to_face(const polytope_core *c, int f, pe_vec3 x)
{
    pe_vec3 n = c->faces[f].normal;
    for (int k = 0; k < c->faces[f].count; ++k) {
        pe_vec3 p = c->vertices[c->faces[f].corners[k]];
        pe_vec3 q = c->vertices[c->faces[f].corners[(k + 1) % c->faces[f].count]];
        if (pe_dot(pe_cross(n, pe_sub(q, p)), pe_sub(x, p)) < 0) {
            return HUGE_VAL;
        }
    }
    double height = pe_dot(n, pe_sub(x, c->vertices[c->faces[f].corners[0]]));
    return height > -1e-12 ? pe_max(height, 0) : HUGE_VAL;
}

/* The distance of cores that are apart. */
static double distance_by_features(const polytope_core *a, const polytope_core *b)
{
    double least = HUGE_VAL;
    for (int swap = 0; swap < 2; ++swap) {
        const polytope_core *p = swap ? b : a, *q = swap ? a : b;
        for (int f = 0; f < p->face_count; ++f) {
            for (int v = 0; v < q->vertex_count; ++v) {
                least = pe_min(least, point_to_face(p, f, q->vertices[v]));
            }
        }
    }
    for (int i = 0; i < a->edge_count || i == 0; ++i) {
        for (int j = 0; j < b->edge_count || j == 0; ++j) {
            const pe_vec3 *va = a->vertices, *vb = b->vertices;
            const int *ea = a->edges[i], *eb = b->edges[j];
            least = pe_min(
                least, a->edge_count == 0 && b->edge_count == 0 ? pe_length(pe_sub(va[0], vb[0]))
                       : a->edge_count == 0 ? point_to_segment(va[0], vb[eb[0]], vb[eb[1]])
                       : b->edge_count == 0
                           ? point_to_segment(vb[0], va[ea[0]], va[ea[1]])
                           : segment_to_segment(va[ea[0]], va[ea[1]], vb[eb[0]], vb[eb[1]]));
        }
    }
    return least;
}

double core_gap(const polytope_core *a, const polytope_core *b)
{
    double gap = gap_by_axes(a, b), radii = a->radius + b->radius;
    return gap + radii > 0 || (a->face_count == 0 && b->face_count == 0)
               ? distance_by_features(a, b) - radii
               : gap;
}

double core_outside(const polytope_core *c, pe_vec3 x)
{
    double most = -HUGE_VAL;
    for (int f = 0; f < c->face_count; ++f) {
        pe_vec3 on = c->vertices[c->faces[f].corners[0]];
        most = pe_max(most, pe_dot(c->faces[f].normal, pe_sub(x, on)));
    }
    return c->face_count > 0   ? most
           : c->edge_count > 0 ? point_to_segment(x, c->vertices[0], c->vertices[1]) - c->radius
                               : pe_length(pe_sub(x, c->vertices[0])) - c->radius;
}
