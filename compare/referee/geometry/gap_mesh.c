/* The gap of a mesh and any bounded shape; the definition is in gap.h.
 *
 * Two surfaces that do not cross have the distance of their triangles, unless one solid contains
 * the other. Where they cross, every edge that pierces the other surface is cut into segments, and
 * the midpoint of each shows whether it is inside. The ends of such a segment that are vertices are
 * then inside too, and so are all vertices that are reached from them by edges that pierce nothing.
 *
 * An edge segment inside a solid, along e, moves out of it over the ridge, the line in which the
 * tangent planes at its two ends meet. With n1, n2 their normals, the ridge is along L = n1 x n2,
 * and the translation is the distance of the two lines, along e x L. */
#include "base/arena.h"
#include "gap.h"
#include "solid.h"

#include <stdlib.h>

/* ---- Edge segments ---- */

/* Sines of angles below this are taken for those of parallel lines or planes. */
static const double PARALLEL = 1e-9;
/* The ridge is an edge of the surface if the surface is nearer to it than this x its height. */
static const double NEAR = 1e-3;

/* A plane that touches the solid's surface, {x : normal.x = offset}; the normal points outward. */
typedef struct tangent_plane {
    pl_vec normal;
    double offset; /* m */
} tangent_plane;

typedef struct edge_segment {
    pl_vec p, q; /* its ends, m */
    /* Tangents of the surface at that point, or at the surface point nearest to it. */
    tangent_plane at_p, at_q, at_midpoint;
    double midpoint_depth; /* m: the distance of the midpoint from the surface */
} edge_segment;

static tangent_plane tangent_through(pl_vec normal, pl_vec point)
{
    return (tangent_plane){normal, pl_vec_dot(normal, point)};
}

/* The point of the ridge nearest to the segment, m. False if the tangents do not meet, or if they
 * meet in a line parallel to the segment. */
static bool find_ridge(const edge_segment *s, pl_vec *ridge)
{
    const tangent_plane *a = &s->at_p, *b = &s->at_q;
    pl_vec e = pl_vec_sub(s->q, s->p), along = pl_vec_cross(a->normal, b->normal);
    double square = pl_vec_dot(along, along);
    pl_vec n = pl_vec_cross(e, along);
    double across = pl_vec_dot(n, n);
    if (square < PARALLEL * PARALLEL || across <= PARALLEL * PARALLEL * square * pl_vec_dot(e, e)) {
        return false;
    }
    pl_vec sum = pl_vec_add(pl_vec_scale(pl_vec_cross(b->normal, along), a->offset),
                            pl_vec_scale(pl_vec_cross(along, a->normal), b->offset));
    pl_vec on_line = pl_vec_scale(sum, 1 / square);
    double t = pl_vec_dot(pl_vec_cross(pl_vec_sub(s->p, on_line), e), n) / -across;
    *ridge = pl_vec_mad(on_line, t, along);
    return true;
}

/* How far the segment reaches below a tangent, m. */
static double below(const tangent_plane *tangent, const edge_segment *s)
{
    double least = fmin(pl_vec_dot(tangent->normal, s->p), pl_vec_dot(tangent->normal, s->q));
    return fmax(tangent->offset - least, 0);
}

/* The least translation, m >= 0, that moves the segment out through one of the tangents or over the
 * ridge, if the ridge is an edge of the surface; otherwise the depth of the midpoint. `on_surface`
 * is the point of the surface nearest to `ridge`. */
static double segment_depth(const edge_segment *s, pl_vec ridge, pl_vec on_surface)
{
    pl_vec e = pl_vec_sub(s->q, s->p);
    pl_vec n = pl_vec_cross(e, pl_vec_cross(s->at_p.normal, s->at_q.normal));
    double length = pl_vec_length(n);
    double height = fabs(pl_vec_dot(pl_vec_sub(ridge, s->p), n)) / length;
    double over_ridge = fabs(pl_vec_dot(pl_vec_sub(on_surface, s->p), n)) / length;
    if (!(pl_vec_length(pl_vec_sub(ridge, on_surface)) <= NEAR * height)) {
        return s->midpoint_depth;
    }
    double least = fmin(below(&s->at_p, s), fmin(below(&s->at_q, s), below(&s->at_midpoint, s)));
    return fmax(s->midpoint_depth, fmin(over_ridge, least));
}

/* ---- Flat faces ---- */

/* The vertices and edges of one solid inside another. */
typedef struct probe {
    const pl_surface_pair *pair;
    int of; /* 0: a's in b; 1: b's in a */
    const pl_surface *source, *target;
    double depth;  /* m, the largest so far */
    bool *reached; /* (source->vertex_count) known to be inside */
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

static tangent_plane tangent_of(const probe *p, const pl_surface_point *nearest)
{
    return tangent_through(p->target->normals[nearest->triangle], nearest->point);
}

/* The tangent at an end of a segment: at a piercing, or if it is NULL, near the vertex there, which
 * is inside. */
static tangent_plane tangent_at_end(probe *p, pl_vec point, const pl_piercing *piercing, int vertex)
{
    if (piercing != NULL) {
        return tangent_through(p->target->normals[piercing->triangle], point);
    }
    pl_surface_point nearest = pl_surface_nearest(p->target, point);
    reach(p, vertex);
    return tangent_of(p, &nearest);
}

static void see_segment(probe *p, const edge_segment *segment)
{
    pl_vec ridge;
    double depth = segment->midpoint_depth;
    if (find_ridge(segment, &ridge)) {
        pl_vec nearest = pl_surface_nearest(p->target, ridge).point;
        depth = segment_depth(segment, ridge, nearest);
    }
    p->depth = fmax(p->depth, depth);
}

/* Measures the segments of one edge, whose piercings are in their order along it. */
static void see_pierced_edge(probe *p, const pl_piercing *piercings, int count)
{
    const pl_surface_edge *edge = &p->source->edges[piercings[0].edge];
    pl_vec start = vertex_of(p, edge->start), end = vertex_of(p, edge->end);
    pl_vec along = pl_vec_sub(end, start), from = start;
    p->pierces[piercings[0].edge] = true;
    for (int i = 0; i <= count; ++i) {
        const pl_piercing *before = i > 0 ? &piercings[i - 1] : NULL;
        const pl_piercing *after = i < count ? &piercings[i] : NULL;
        pl_vec to = after != NULL ? pl_vec_mad(start, after->fraction, along) : end;
        pl_vec midpoint = pl_vec_scale(pl_vec_add(from, to), 0.5);
        pl_surface_point nearest = pl_surface_nearest(p->target, midpoint);
        if (nearest.distance < 0) {
            edge_segment segment = {.p = from,
                                    .q = to,
                                    .at_p = tangent_at_end(p, from, before, edge->start),
                                    .at_q = tangent_at_end(p, to, after, edge->end),
                                    .at_midpoint = tangent_of(p, &nearest),
                                    .midpoint_depth = -nearest.distance};
            see_segment(p, &segment);
        }
        from = to;
    }
}

/* Measures all reached vertices, and those that are reached from them. */
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

/* Whether any connected part of the source is inside, if the source pierces nothing. */
static bool any_part_inside(const probe *p)
{
    for (int i = 0; i < p->source->part_count; ++i) {
        if (is_inside(p, p->source->parts[i])) {
            return true;
        }
    }
    return false;
}

/* Raises *depth to the largest depth of the source's features. The piercings are those of the
 * source. */
static void probe_depth(const pl_surface_pair *pair, int of, const pl_piercing *piercings,
                        int count, double *depth)
{
    probe p = {.pair = pair,
               .of = of,
               .source = of == 0 ? pair->a : pair->b,
               .target = of == 0 ? pair->b : pair->a};
    if (!p.target->closed || (count == 0 && !any_part_inside(&p))) {
        return;
    }
    pl_arena arena = {0};
    p.reached = pl_arena_take(&arena, (size_t)p.source->vertex_count, sizeof *p.reached);
    p.pierces = pl_arena_take(&arena, (size_t)p.source->edge_count, sizeof *p.pierces);
    p.stack = pl_arena_take(&arena, (size_t)p.source->vertex_count, sizeof *p.stack);
    for (int first = 0, next; first < count; first = next) {
        for (next = first + 1; next < count && piercings[next].edge == piercings[first].edge;) {
            next += 1;
        }
        see_pierced_edge(&p, &piercings[first], next - first);
    }
    see_vertices(&p);
    /* A part that pierces is done; another part may be inside as a whole. */
    for (int i = 0; i < p.source->part_count && (p.source->part_count > 1 || count == 0); ++i) {
        if (!p.reached[p.source->parts[i]] && is_inside(&p, p.source->parts[i])) {
            reach(&p, p.source->parts[i]);
            see_vertices(&p);
        }
    }
    *depth = fmax(*depth, p.depth);
    pl_arena_free(&arena);
}

/* The gap of the solids of two surfaces. */
static double surface_gap(const pl_surface_pair *pair, double within)
{
    int count = 0, of_a = 0;
    double depth = 0, distance = pl_surface_pair_distance(pair, within);
    pl_piercing *piercings = distance <= 0 ? pl_surface_pair_piercings(pair, &count) : NULL;
    while (of_a < count && piercings[of_a].of == 0) {
        of_a += 1;
    }
    probe_depth(pair, 0, piercings, of_a, &depth);
    probe_depth(pair, 1, count > of_a ? piercings + of_a : NULL, count - of_a, &depth);
    free(piercings);
    return depth > 0 ? -depth : distance;
}

/* ---- Cylinders, which have neither a flat surface nor a core with one ---- */

/* A mesh and a cylinder, in the mesh's frame. */
typedef struct meeting {
    const pl_surface *mesh;
    const pl_shape *cylinder;
    pl_axes axes;    /* of the cylinder */
    pl_vec offset;   /* centre of the cylinder */
    double distance; /* m, the least so far; 0 once a triangle crosses the cylinder */
    double depth;    /* m, the largest so far */
    pl_status status;
} meeting;

static pl_vec in_cylinder(const meeting *m, pl_vec point)
{
    return pl_to_local(&m->axes, pl_vec_sub(point, m->offset));
}

/* The hull of two or three vertices of the mesh as a shape, in the cylinder's frame. It contains
 * pointers into itself. */
typedef struct flat_hull {
    double vertices[3][3];
    pl_polyhedron polyhedron;
    pl_shape shape;
    pl_placed_shape placed, cylinder;
} flat_hull;

static void set_hull(flat_hull *hull, const meeting *m, const int *corners, int count)
{
    pl_vec corner[3], centroid = {0, 0, 0};
    *hull = (flat_hull){.polyhedron = {.convex = true, .vertex_count = count},
                        .shape = {.kind = PL_SHAPE_HULL}};
    for (int k = 0; k < count; ++k) {
        corner[k] = in_cylinder(m, m->mesh->vertices[corners[k]]);
        centroid = pl_vec_mad(centroid, 1.0 / count, corner[k]);
        pl_vec_store(corner[k], hull->vertices[k]);
    }
    for (int k = 0; k < count; ++k) {
        double arm = pl_vec_length(pl_vec_sub(corner[k], centroid));
        hull->polyhedron.radius = fmax(hull->polyhedron.radius, arm);
    }
    pl_vec_store(centroid, hull->polyhedron.centre);
    hull->polyhedron.vertices = hull->vertices;
    hull->shape.polyhedron = &hull->polyhedron;
    hull->placed = (pl_placed_shape){.shape = &hull->shape, .orientation = {1, 0, 0, 0}};
    hull->cylinder = (pl_placed_shape){.shape = m->cylinder, .orientation = {1, 0, 0, 0}};
}

static double triangle_distance(const meeting *m, int triangle)
{
    flat_hull hull;
    set_hull(&hull, m, m->mesh->triangles[triangle], 3);
    return pl_distance_convex(&hull.cylinder, &hull.placed, m->distance);
}

static void see_distance(void *context, int triangle)
{
    meeting *m = context;
    if (m->distance > 0) {
        m->distance = fmin(m->distance, triangle_distance(m, triangle));
    }
}

/* The depth of the cylinder's point that is farthest against a face, if it is inside the mesh. */
static void see_face(meeting *m, int triangle)
{
    pl_vec into = pl_to_local(&m->axes, pl_vec_scale(m->mesh->normals[triangle], -1));
    pl_vec point = pl_to_world(&m->axes, pl_core_support(m->cylinder, into));
    double distance = pl_surface_nearest(m->mesh, pl_vec_add(m->offset, point)).distance;
    m->depth = fmax(m->depth, -distance);
}

/* The depth of an edge in the cylinder, as that of two convex shapes. */
static pl_status see_crossing_edge(meeting *m, const pl_surface_edge *edge)
{
    flat_hull hull;
    const int corners[2] = {edge->start, edge->end};
    double gap = 0;
    set_hull(&hull, m, corners, 2);
    pl_status status = pl_gap_convex(&hull.cylinder, &hull.placed, 0, &gap);
    m->depth = fmax(m->depth, -gap);
    return status;
}

static void see_crossing(void *context, int triangle)
{
    meeting *m = context;
    if (triangle_distance(m, triangle) > 0) {
        return;
    }
    see_face(m, triangle);
    for (int k = 0; k < 3; ++k) {
        const pl_surface_edge *edge = &m->mesh->edges[m->mesh->sides[triangle][k]];
        pl_status status = edge->triangle == triangle ? see_crossing_edge(m, edge) : PL_OK;
        m->status = status != PL_OK ? status : m->status;
    }
}

/* Half the size of the box around the cylinder. */
static pl_vec half_size(const meeting *m)
{
    double half[3];
    for (int k = 0; k < 3; ++k) {
        const pl_vec unit = {k == 0, k == 1, k == 2};
        pl_vec d = pl_to_local(&m->axes, unit);
        half[k] = pl_vec_dot(d, pl_core_support(m->cylinder, d));
    }
    return pl_vec_of(half);
}

static pl_status cylinder_gap(const pl_surface_pair *pair, const pl_shape *cylinder, double within,
                              double *gap)
{
    const pl_surface *mesh = pair->a;
    const pl_vec offset = pair->offset;
    meeting m = {.mesh = mesh, .cylinder = cylinder, .axes = pair->axes, .offset = offset};
    pl_vec half = half_size(&m);
    double reach = pl_bounding_radius(cylinder);
    if (within < HUGE_VAL && !pl_surface_box_holds(mesh, offset, within + reach)) {
        *gap = HUGE_VAL;
        return PL_OK;
    }
    double centre = pl_surface_nearest(mesh, offset).distance;
    double most = fmin(fmax(within, 0), fabs(centre));
    m.distance = nextafter(most, HUGE_VAL);
    pl_surface_each_near(mesh, offset, pl_vec_add(half, (pl_vec){most, most, most}), see_distance,
                         &m);
    bool crosses = m.distance <= 0;
    if (crosses) {
        pl_surface_each_near(mesh, offset, half, see_crossing, &m);
    } else if (centre < 0) {
        for (int t = 0; t < mesh->triangle_count; ++t) {
            see_face(&m, t);
        }
    }
    for (int i = 0; i < mesh->vertex_count && centre - reach < 0; ++i) {
        double distance = pl_cylinder_distance(cylinder, in_cylinder(&m, mesh->vertices[i]));
        m.depth = fmax(m.depth, -distance);
    }
    double apart = m.distance <= within ? m.distance : HUGE_VAL;
    *gap = m.depth > 0 || crosses ? -m.depth : apart;
    return m.status;
}

/* ---- All shapes ---- */

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

/* `mesh` has its surface. A surface that `other` needs and lacks is made in the arena. */
static pl_status mesh_gap(const pl_placed_shape *mesh, const pl_placed_shape *other, double within,
                          pl_arena *arena, double *gap)
{
    pl_surface_pair pair = pair_of(mesh, other);
    double radius = pl_core_radius(other->shape);
    if (other->shape->kind == PL_SHAPE_SPHERE) {
        *gap = sphere_gap(mesh->surface, pair.offset, radius, within);
        return PL_OK;
    }
    if (other->shape->kind == PL_SHAPE_CYLINDER) {
        return cylinder_gap(&pair, other->shape, within, gap);
    }
    if (pair.b == NULL) {
        pair.b = pl_surface_create(other->shape, arena);
    }
    *gap = surface_gap(&pair, within + radius) - radius;
    return PL_OK;
}

pl_status pl_gap_mesh(const pl_placed_shape *a, const pl_placed_shape *b, double within,
                      double *gap)
{
    bool a_is_mesh = a->shape->kind == PL_SHAPE_MESH;
    pl_placed_shape mesh = a_is_mesh ? *a : *b;
    const pl_placed_shape *other = a_is_mesh ? b : a;
    pl_arena arena = {0};
    if (mesh.shape->kind != PL_SHAPE_MESH || other->shape->kind == PL_SHAPE_PLANE) {
        return PL_UNSUPPORTED;
    }
    if (mesh.surface == NULL) {
        mesh.surface = pl_surface_create(mesh.shape, &arena);
    }
    const pl_status status = mesh_gap(&mesh, other, within, &arena, gap);
    pl_arena_free(&arena);
    return status;
}
