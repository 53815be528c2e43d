/* The gap of a mesh and anything bounded; the definition is in gap.h.
 *
 * Two surfaces that are apart have the distance of their triangles, unless one solid holds the
 * other. Where they cross, every edge that pierces the other surface is cut into stretches, and the
 * middle of each tells whether it is inside. The ends that are vertices are then inside, too, and
 * so are all vertices that are reached from them by edges that pierce nothing. */
#include "edge_segment.h"
#include "gap.h"
#include "gap_mesh_cylinder.h"
#include "solid.h"
#include "surface_pair.h"

#include <stdlib.h>

/* One solid's vertices and edges inside another. */
typedef struct probe {
    const pl_surface_pair *pair;
    int of; /* 0: a's in b; 1: b's in a */
    const pl_surface *source, *target;
    double depth;  /* m, the largest so far */
    bool *reached; /* (source->vertex_count) seen to be inside */
    bool *pierces; /* (source->edge_count) */
    int *stack;    /* (source->vertex_count) reached, not yet measured */
    int height;
} probe;

/* A vertex of the source in the target's frame. */
static pl_vec vertex_of(const probe *p, int vertex)
{
    pl_vec v = p->source->vertices[vertex];
    return p->of == 0 ? pl_to_local(&p->pair->axes, pl_vec_sub(v, p->pair->offset))
                      : pl_vec_add(p->pair->offset, pl_to_world(&p->pair->axes, v));
}

static void reach(probe *p, int vertex)
{
    if (!p->reached[vertex]) {
        p->reached[vertex] = true;
        p->stack[p->height++] = vertex;
    }
}

static pl_tangent tangent_of(const probe *p, const pl_surface_point *nearest)
{
    return pl_tangent_at(p->target->normals[nearest->triangle], nearest->point);
}

/* At an end of a stretch: a piercing, or where there is none the vertex there, which is inside. */
static pl_tangent tangent_at_end(probe *p, pl_vec point, const pl_piercing *piercing, int vertex)
{
    if (piercing != NULL) {
        return pl_tangent_at(p->target->normals[piercing->triangle], point);
    }
    pl_surface_point nearest = pl_surface_nearest(p->target, point);
    reach(p, vertex);
    return tangent_of(p, &nearest);
}

static void see_stretch(probe *p, const pl_edge_segment *stretch)
{
    pl_vec ridge;
    double depth = stretch->middle_depth;
    if (pl_edge_segment_ridge(stretch, &ridge)) {
        pl_vec nearest = pl_surface_nearest(p->target, ridge).point;
        depth = pl_edge_segment_depth(stretch, ridge, nearest);
    }
    p->depth = fmax(p->depth, depth);
}

/* All stretches of one edge, with its piercings in their order. */
static void see_edge(probe *p, const pl_piercing *piercings, int count)
{
    const pl_surface_edge *edge = &p->source->edges[piercings[0].edge];
    pl_vec start = vertex_of(p, edge->start), end = vertex_of(p, edge->end);
    pl_vec along = pl_vec_sub(end, start), from = start;
    p->pierces[piercings[0].edge] = true;
    for (int i = 0; i <= count; ++i) {
        const pl_piercing *before = i > 0 ? &piercings[i - 1] : NULL;
        const pl_piercing *after = i < count ? &piercings[i] : NULL;
        pl_vec to = after != NULL ? pl_vec_mad(start, after->fraction, along) : end;
        pl_vec middle = pl_vec_scale(pl_vec_add(from, to), 0.5);
        pl_surface_point nearest = pl_surface_nearest(p->target, middle);
        if (nearest.distance < 0) {
            pl_edge_segment stretch = {.p = from,
                                       .q = to,
                                       .at_p = tangent_at_end(p, from, before, edge->start),
                                       .at_q = tangent_at_end(p, to, after, edge->end),
                                       .at_middle = tangent_of(p, &nearest),
                                       .middle_depth = -nearest.distance};
            see_stretch(p, &stretch);
        }
        from = to;
    }
}

/* Measures all vertices reached, and those reached from them. */
static void see_vertices(probe *p)
{
    while (p->height > 0) {
        int vertex = p->stack[--p->height];
        double distance = pl_surface_nearest(p->target, vertex_of(p, vertex)).distance;
        p->depth = fmax(p->depth, -distance);
        for (int k = p->source->ring_start[vertex]; k < p->source->ring_start[vertex + 1]; ++k) {
            int edge = p->source->ring[k];
            if (!p->pierces[edge]) {
                reach(p, p->source->edges[edge].start + p->source->edges[edge].end - vertex);
            }
        }
    }
}

static bool is_inside(const probe *p, int vertex)
{
    pl_vec point = vertex_of(p, vertex);
    return pl_surface_box_holds(p->target, point, 0) &&
           pl_surface_nearest(p->target, point).distance < 0;
}

/* All of the source is in the target's box: told soon where it is not. */
static bool box_holds_all(const probe *p)
{
    for (int i = 0; i < p->source->vertex_count; ++i) {
        if (!pl_surface_box_holds(p->target, vertex_of(p, i), 0)) {
            return false;
        }
    }
    return true;
}

/* Whether any connected part of the source, which pierces nothing, is inside. */
static bool any_part_inside(const probe *p)
{
    if (p->source->part_count == 1 && !box_holds_all(p)) {
        return false;
    }
    for (int i = 0; i < p->source->part_count; ++i) {
        if (is_inside(p, p->source->parts[i])) {
            return true;
        }
    }
    return false;
}

/* The largest depth of the source's features, into *depth. The piercings are those of the source.
 */
static pl_status probe_depth(const pl_surface_pair *pair, int of, const pl_piercing *piercings,
                             int count, double *depth)
{
    probe p = {.pair = pair,
               .of = of,
               .source = of == 0 ? pair->a : pair->b,
               .target = of == 0 ? pair->b : pair->a};
    pl_status status = PL_NO_MEMORY;
    if (!p.target->closed || (count == 0 && !any_part_inside(&p))) {
        return PL_OK;
    }
    p.reached = calloc((size_t)p.source->vertex_count, sizeof *p.reached);
    p.pierces = calloc((size_t)p.source->edge_count, sizeof *p.pierces);
    p.stack = calloc((size_t)p.source->vertex_count, sizeof *p.stack);
    if (p.reached == NULL || p.pierces == NULL || p.stack == NULL) {
        goto cleanup;
    }
    for (int first = 0, next; first < count; first = next) {
        for (next = first + 1; next < count && piercings[next].edge == piercings[first].edge;) {
            next += 1;
        }
        see_edge(&p, &piercings[first], next - first);
    }
    see_vertices(&p);
    /* What pierces is known; other parts may lie inside whole. */
    for (int i = 0; i < p.source->part_count && (p.source->part_count > 1 || count == 0); ++i) {
        if (!p.reached[p.source->parts[i]] && is_inside(&p, p.source->parts[i])) {
            reach(&p, p.source->parts[i]);
            see_vertices(&p);
        }
    }
    *depth = fmax(*depth, p.depth);
    status = PL_OK;

cleanup:
    free(p.reached);
    free(p.pierces);
    free(p.stack);
    return status;
}

/* The gap of the solids within two surfaces. */
static pl_status surface_gap(const pl_surface_pair *pair, double within, double *gap)
{
    pl_piercing *piercings = NULL;
    int count = 0, of_a = 0;
    double depth = 0, distance = pl_surface_pair_distance(pair, within);
    pl_status status = PL_OK;
    if (distance <= 0) {
        status = pl_surface_pair_piercings(pair, &piercings, &count);
    }
    while (of_a < count && piercings[of_a].of == 0) {
        of_a += 1;
    }
    if (status == PL_OK) {
        status = probe_depth(pair, 0, piercings, of_a, &depth);
    }
    if (status == PL_OK) {
        status = probe_depth(pair, 1, count > of_a ? piercings + of_a : NULL, count - of_a, &depth);
    }
    free(piercings);
    *gap = depth > 0 ? -depth : distance;
    return status;
}

/* The pose of b in a's frame. */
static pl_surface_pair pair_of(const pl_placed_shape *a, const pl_placed_shape *b)
{
    pl_axes in_world = pl_axes_of(a->orientation), of_b = pl_axes_of(b->orientation);
    pl_surface_pair pair = {.a = a->surface, .b = b->surface};
    pl_vec offset = pl_vec_sub(pl_vec_of(b->position), pl_vec_of(a->position));
    pair.offset = pl_to_local(&in_world, offset);
    for (int k = 0; k < 3; ++k) {
        pair.axes.axis[k] = pl_to_local(&in_world, of_b.axis[k]);
    }
    return pair;
}

static double sphere_gap(const pl_surface *mesh, pl_vec centre, double radius, double within)
{
    if (within < HUGE_VAL && !pl_surface_box_holds(mesh, centre, within + radius)) {
        return HUGE_VAL;
    }
    return pl_surface_nearest(mesh, centre).distance - radius;
}

/* `mesh` has its surface. */
static pl_status mesh_gap(const pl_placed_shape *mesh, const pl_placed_shape *other, double within,
                          double *gap)
{
    pl_surface *made = NULL;
    pl_surface_pair pair = pair_of(mesh, other);
    double radius = pl_core_radius(other->shape);
    if (other->shape->kind == PL_SHAPE_SPHERE) {
        *gap = sphere_gap(mesh->surface, pair.offset, radius, within);
        return PL_OK;
    }
    if (other->shape->kind == PL_SHAPE_CYLINDER) {
        return pl_gap_mesh_cylinder(mesh->surface, other->shape, &pair.axes, pair.offset, within,
                                    gap);
    }
    pl_status status = PL_OK;
    if (other->surface == NULL) {
        status = pl_surface_create(other->shape, &made);
        pair.b = made;
    }
    if (status == PL_OK) {
        status = surface_gap(&pair, within + radius, gap);
        *gap -= radius;
    }
    pl_surface_destroy(made);
    return status;
}

pl_status pl_gap_mesh(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                      double *gap)
{
    bool a_is_mesh = a->shape->kind == PL_SHAPE_MESH;
    pl_placed_shape mesh = a_is_mesh ? *a : *b;
    const pl_placed_shape *other = a_is_mesh ? b : a;
    pl_surface *made = NULL;
    if (mesh.shape->kind != PL_SHAPE_MESH || other->shape->kind == PL_SHAPE_PLANE) {
        return PL_UNSUPPORTED;
    }
    pl_status status = PL_OK;
    if (mesh.surface == NULL) {
        status = pl_surface_create(mesh.shape, &made);
        mesh.surface = made;
    }
    if (status == PL_OK) {
        status = mesh_gap(&mesh, other, within, gap);
    }
    pl_surface_destroy(made);
    return status;
}
