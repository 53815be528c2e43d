/* The faces and edges of a surface of triangles.
 *
 * Half-edges, sorted by the vertices that they join, show which triangles meet. A closed surface
 * has each half-edge once, with its opposite. Connected triangles of one plane make a face: it
 * spreads from a triangle, in order, over neighbours that lie in its plane. */
#include "geometry_build.h"

#include <stdlib.h>

/* In units of the geometry's half extent: a triangle with all corners this near to a plane lies in
 * the plane, and a corner this far over a face makes a dent. */
static const double FLAT = 1e-9;
/* Twice the area of a triangle, in units of the square of its longest edge. */
static const double LEAST_AREA = 1e-12;

/* The half-edge 3 t + k leads from corner k of triangle t to the next corner. */
typedef struct half_edge {
    int low, high; /* the vertices in rising order */
    int index;
} half_edge;

typedef struct surface {
    pe_geometry *g;
    int *opposite;   /* (3 triangle_count): by half-edge */
    pe_vec3 *normal; /* (triangle_count): unit */
    int *stack;      /* (triangle_count) */
    double flat;     /* m */
    int dent;        /* a half-edge at which the solid is dented; -1: none */
    pe_error *error;
} surface;

static int start_of(const pe_geometry *g, int half)
{
    return g->triangles[half / 3][half % 3];
}

static int end_of(const pe_geometry *g, int half)
{
    return g->triangles[half / 3][(half % 3 + 1) % 3];
}

/* The next half-edge of the triangle. */
static int next_of(int half)
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

static int by_vertices(const void *a, const void *b)
{
    const half_edge *p = a, *q = b;
    if (p->low != q->low) {
        return p->low < q->low ? -1 : 1;
    }
    if (p->high != q->high) {
        return p->high < q->high ? -1 : 1;
    }
    return p->index < q->index ? -1 : p->index > q->index;
}

/* PE_BAD_ARGUMENT: the surface is not closed, or not oriented. */
static pe_status find_opposites(surface *s, half_edge *halves)
{
    const pe_geometry *g = s->g;
    int count = 3 * g->triangle_count;
    for (int i = 0; i < count; ++i) {
        int from = start_of(g, i), to = end_of(g, i);
        halves[i] = (half_edge){from < to ? from : to, from < to ? to : from, i};
    }
    qsort(halves, (size_t)count, sizeof *halves, by_vertices);
    for (int i = 0; i < count; i += 2) {
        const half_edge *p = &halves[i];
        bool paired = i + 1 < count && p[1].low == p->low && p[1].high == p->high;
        bool third = paired && i + 2 < count && p[2].low == p->low && p[2].high == p->high;
        if (!paired || third || start_of(g, p->index) != end_of(g, p[1].index)) {
            return pe_fail(s->error, PE_BAD_ARGUMENT,
                           "geometry: the edge between vertices %d and %d, at triangle %d, is %s",
                           p->low, p->high, p->index / 3,
                           !paired ? "open"
                           : third ? "shared by more than two triangles"
                                   : "passed in the same direction by both its triangles");
        }
        s->opposite[p->index] = p[1].index;
        s->opposite[p[1].index] = p->index;
    }
    return PE_OK;
}

static pe_status find_normals(surface *s)
{
    const pe_geometry *g = s->g;
    for (int i = 0; i < g->triangle_count; ++i) {
        const int *t = g->triangles[i];
        pe_vec3 u = pe_sub(g->vertices[t[1]], g->vertices[t[0]]);
        pe_vec3 v = pe_sub(g->vertices[t[2]], g->vertices[t[0]]), w = pe_sub(v, u);
        double longest = pe_max(pe_dot(u, u), pe_max(pe_dot(v, v), pe_dot(w, w)));
        pe_vec3 n = pe_cross(u, v);
        double area = pe_length(n);
        if (!(area > LEAST_AREA * longest)) {
            return pe_fail(s->error, PE_BAD_ARGUMENT,
                           "geometry: triangle %d (vertices %d, %d, %d) has no area", i, t[0], t[1],
                           t[2]);
        }
        s->normal[i] = pe_scale(1 / area, n);
    }
    return PE_OK;
}

/* Whether triangle t lies in the plane. */
static bool lies_in(const surface *s, int t, pe_vec3 normal, double offset)
{
    const pe_geometry *g = s->g;
    bool in = pe_dot(s->normal[t], normal) > 0;
    for (int k = 0; k < 3; ++k) {
        in = in && fabs(pe_dot(normal, g->vertices[g->triangles[t][k]]) - offset) <= s->flat;
    }
    return in;
}

/* Twice the area of triangle t as a vector. */
static pe_vec3 area_of(const pe_geometry *g, int t)
{
    pe_vec3 a = g->vertices[g->triangles[t][0]];
    return pe_cross(pe_sub(g->vertices[g->triangles[t][1]], a),
                    pe_sub(g->vertices[g->triangles[t][2]], a));
}

/* Spreads a new face from the triangle. */
static void find_face(surface *s, int seed)
{
    pe_geometry *g = s->g;
    int index = g->face_count++, depth = 0;
    pe_vec3 normal = s->normal[seed], area = pe_v3(0, 0, 0);
    double offset = pe_dot(normal, g->vertices[g->triangles[seed][0]]);
    pe_face *face = &g->faces[index];
    *face = (pe_face){.offset = -HUGE_VAL};
    g->triangle_face[seed] = index;
    s->stack[depth++] = seed;
    while (depth > 0) {
        int t = s->stack[--depth];
        area = pe_add(area, area_of(g, t));
        for (int k = 0; k < 3; ++k) {
            int neighbour = s->opposite[3 * t + k] / 3;
            if (g->triangle_face[neighbour] < 0 && lies_in(s, neighbour, normal, offset)) {
                g->triangle_face[neighbour] = index;
                s->stack[depth++] = neighbour;
            }
        }
    }
    face->normal = pe_scale(1 / pe_length(area), area);
}

static void find_faces(surface *s)
{
    pe_geometry *g = s->g;
    g->face_count = 0;
    for (int i = 0; i < g->triangle_count; ++i) {
        g->triangle_face[i] = -1;
    }
    for (int i = 0; i < g->triangle_count; ++i) {
        if (g->triangle_face[i] < 0) {
            find_face(s, i);
        }
    }
    for (int i = 0; i < g->triangle_count; ++i) {
        pe_face *face = &g->faces[g->triangle_face[i]];
        for (int k = 0; k < 3; ++k) {
            face->offset =
                pe_max(face->offset, pe_dot(face->normal, g->vertices[g->triangles[i][k]]));
        }
    }
}

static void find_edges(surface *s)
{
    pe_geometry *g = s->g;
    g->edge_count = 0;
    s->dent = -1;
    for (int i = 0; i < 3 * g->triangle_count; ++i) {
        int other = s->opposite[i];
        int face = g->triangle_face[i / 3], other_face = g->triangle_face[other / 3];
        if (face == other_face) {
            g->triangle_edges[i / 3][i % 3] = -1;
            continue;
        }
        if (other < i) {
            continue; /* made by its opposite */
        }
        /* How far the other face's triangle rises over this face. */
        pe_vec3 tip = g->vertices[end_of(g, next_of(other))], x = g->vertices[start_of(g, i)];
        double rise = pe_dot(g->faces[face].normal, pe_sub(tip, x));
        s->dent = s->dent < 0 && rise > s->flat ? i : s->dent;
        g->triangle_edges[i / 3][i % 3] = g->triangle_edges[other / 3][other % 3] = g->edge_count;
        g->edges[g->edge_count++] = (pe_edge){
            .vertex = {start_of(g, i), end_of(g, i)},
            .face = {face, other_face},
            .convex = rise < 0,
        };
    }
}

/* Lists the edges at each vertex. */
static void find_fans(pe_geometry *g)
{
    for (int v = 0; v <= g->vertex_count; ++v) {
        g->vertex_first[v] = 0;
    }
    for (int e = 0; e < g->edge_count; ++e) {
        g->vertex_first[g->edges[e].vertex[0]] += 1;
        g->vertex_first[g->edges[e].vertex[1]] += 1;
    }
    int sum = 0;
    for (int v = 0; v <= g->vertex_count; ++v) {
        sum += g->vertex_first[v];
        g->vertex_first[v] = sum; /* where the fan ends; filling it moves this to its start */
    }
    for (int e = g->edge_count - 1; e >= 0; --e) {
        g->vertex_edges[--g->vertex_first[g->edges[e].vertex[0]]] = e;
        g->vertex_edges[--g->vertex_first[g->edges[e].vertex[1]]] = e;
    }
}

/* The half-edge that follows `half` around its face. */
static int next_around(const surface *s, int half)
{
    const pe_geometry *g = s->g;
    int face = g->triangle_face[half / 3], next = next_of(half);
    while (g->triangle_face[s->opposite[next] / 3] == face) {
        next = next_of(s->opposite[next]);
    }
    return next;
}

/* Lists the corners of every face in order. False: a face has more than one rim. */
static bool find_corners(surface *s)
{
    pe_geometry *g = s->g;
    for (int i = 0; i < 3 * g->triangle_count; ++i) {
        pe_face *face = &g->faces[g->triangle_face[i / 3]];
        if (g->triangle_edges[i / 3][i % 3] < 0 || face->corner_count > 0) {
            continue;
        }
        face->first_corner = g->corner_count;
        int half = i;
        do {
            g->corners[g->corner_count++] = start_of(g, half);
            half = next_around(s, half);
        } while (half != i);
        face->corner_count = g->corner_count - face->first_corner;
    }
    return g->corner_count == 2 * g->edge_count;
}

/* Decides whether the solid is convex, and finds its faces' corners if so. PE_BAD_ARGUMENT: it is
 * not, but must be. A closed connected surface without dents is convex (van Heijenoort 1952). */
static pe_status find_convex(surface *s, bool must)
{
    pe_geometry *g = s->g;
    g->corner_count = 0;
    bool one_rim = s->dent < 0 && find_corners(s);
    g->convex = one_rim && g->vertex_count - g->edge_count + g->face_count <= 2;
    if (g->convex || !must) {
        return PE_OK;
    }
    if (s->dent >= 0) {
        return pe_fail(s->error, PE_BAD_ARGUMENT,
                       "geometry: expected a convex solid, but it is dented at the edge between "
                       "vertices %d and %d, at triangle %d",
                       start_of(g, s->dent), end_of(g, s->dent), s->dent / 3);
    }
    return pe_fail(s->error, PE_BAD_ARGUMENT, "geometry: expected a convex solid, found %s",
                   !one_rim ? "a face with more than one rim"
                            : "several pieces, or vertices that no edge has");
}

/* Takes all memory. False: there is not enough. */
static bool take(surface *s, half_edge **halves, const pe_allocator *allocator, pe_workspace work)
{
    pe_geometry *g = s->g;
    size_t n = (size_t)g->triangle_count, v = (size_t)g->vertex_count;
    *halves = pe_take(work, 3 * n, sizeof **halves);
    s->opposite = pe_take(work, 3 * n, sizeof *s->opposite);
    s->normal = pe_take(work, n, sizeof *s->normal);
    s->stack = pe_take(work, n, sizeof *s->stack);
    g->triangle_edges = pe_arena_take(&g->arena, allocator, n, sizeof *g->triangle_edges);
    g->triangle_face = pe_arena_take(&g->arena, allocator, n, sizeof *g->triangle_face);
    g->faces = pe_arena_take(&g->arena, allocator, n, sizeof *g->faces);
    g->edges = pe_arena_take(&g->arena, allocator, 2 * n, sizeof *g->edges);
    g->corners = pe_arena_take(&g->arena, allocator, 3 * n, sizeof *g->corners);
    g->vertex_first = pe_arena_take(&g->arena, allocator, v + 1, sizeof *g->vertex_first);
    g->vertex_edges = pe_arena_take(&g->arena, allocator, 3 * n, sizeof *g->vertex_edges);
    return *halves != NULL && s->opposite != NULL && s->normal != NULL && s->stack != NULL &&
           g->triangle_edges != NULL && g->triangle_face != NULL && g->faces != NULL &&
           g->edges != NULL && g->corners != NULL && g->vertex_first != NULL &&
           g->vertex_edges != NULL;
}

pe_status pe_geometry_find_surface(pe_geometry *g, bool must_be_convex,
                                   const pe_allocator *allocator, pe_workspace work,
                                   pe_error *error)
{
    surface s = {.g = g, .error = error};
    s.flat = FLAT * pe_max(g->box_half.x, pe_max(g->box_half.y, g->box_half.z));
    half_edge *halves;
    if (!take(&s, &halves, allocator, work)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for a geometry of %d triangles",
                       g->triangle_count);
    }
    pe_status status = find_opposites(&s, halves);
    if (status == PE_OK) {
        status = find_normals(&s);
    }
    if (status == PE_OK) {
        find_faces(&s);
        find_edges(&s);
        find_fans(g);
        status = find_convex(&s, must_be_convex);
    }
    return status;
}
