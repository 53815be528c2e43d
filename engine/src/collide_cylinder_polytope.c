/* A cylinder against a box, a hull and a capsule.
 *
 * The direction comes from pe_cylinder_polytope_gap. The points are those where the cylinder's cap
 * or the lowest line of its side, whichever faces the other shape, overlaps the face, edge or
 * corner there, as seen along that direction. On a cap these are the ends of the overlap's straight
 * bounds, the cap's lowest point, and four points of the rim in directions that stay with the other
 * shape: the cap may spin under them. A capsule is its segment, with its radius taken off the gap. */
#include "cylinder_polytope.h"
#include "hit_list.h"

/* Least cosine between a direction and the normal of a face that lies across it. */
static const double FACING = 0.98;
/* Most cosine between a direction and an edge that lies across it. */
static const double CROSSWISE = 0.2;
/* In units of the smaller shape: points this far outside a bound are moved onto it. */
static const double SLACK = 1e-6;
/* In units of the smaller shape: a cap tilted by less, from end to end, has no lowest point. */
static const double LEVEL = 3e-9;

/* Kinds of points, for their names. */
enum { RIM = 1, LOWEST, CORNER, CROSSING_IN, CROSSING_OUT, LINE_END, NEAREST };

static uint64_t name(uint64_t kind, int feature, int point)
{
    return kind << 56 | (uint64_t)(uint32_t)feature << 28 | (uint64_t)(uint32_t)point;
}

/* What of the polytope faces the cylinder: the corners of a face, or the ends of an edge. */
typedef struct facing {
    const pe_polytope *p;
    const pe_face *face; /* NULL: an edge, or nothing */
    const int *corners;
    int count, index;
} facing;

static pe_vec3 corner(const facing *f, int i)
{
    return f->p->vertices[f->corners[i]];
}

static facing facing_face(const pe_polytope *p, int index)
{
    const pe_face *face = &p->faces[index];
    return (facing){p, face, p->corners + face->first_corner, face->corner_count, index};
}

static facing facing_edge(const pe_polytope *p, int index, pe_vec3 d)
{
    const pe_edge *edge = &p->edges[index];
    pe_vec3 e = pe_sub(p->vertices[edge->vertex[1]], p->vertices[edge->vertex[0]]);
    bool across = fabs(pe_dot(e, d)) <= CROSSWISE * pe_length(e);
    return (facing){p, NULL, edge->vertex, across ? 2 : 0, p->face_count + index};
}

/* The edge at the corner that lies most nearly across d. */
static int edge_at(const pe_polytope *p, int vertex, pe_vec3 d)
{
    int best = -1;
    double least = HUGE_VAL;
    for (int k = p->vertex_first[vertex]; k < p->vertex_first[vertex + 1]; ++k) {
        const pe_edge *edge = &p->edges[p->vertex_edges[k]];
        pe_vec3 e = pe_sub(p->vertices[edge->vertex[1]], p->vertices[edge->vertex[0]]);
        double cosine = fabs(pe_dot(e, d)) / pe_length(e);
        if (cosine < least) {
            least = cosine;
            best = p->vertex_edges[k];
        }
    }
    return best;
}

static facing find_facing(const pe_polytope *p, const pe_meeting_gap *gap)
{
    if (gap->kind == PE_FACE_CYLINDER) {
        return facing_face(p, gap->index);
    }
    int best = -1;
    double most = FACING;
    for (int i = 0; i < p->face_count; ++i) {
        double cosine = pe_dot(p->faces[i].normal, gap->normal);
        if (cosine >= most) {
            most = cosine;
            best = i;
        }
    }
    if (best >= 0) {
        return facing_face(p, best);
    }
    bool at_edge = gap->kind == PE_EDGE_SIDE || gap->kind == PE_EDGE_RIM;
    int edge = at_edge ? gap->index : edge_at(p, gap->index, gap->normal);
    return edge >= 0 ? facing_edge(p, edge, gap->normal) : (facing){.p = p};
}

/* The two shapes, with d from the polytope to the cylinder. */
typedef struct scene {
    const pe_cylinder *c;
    facing facing;
    pe_vec3 d;
    double radius; /* m, of the ball that sweeps the polytope */
    double slack;  /* m */
    pe_hit_list patch;
} scene;

/* Height of a point of the cylinder over the face, along d. */
static double over_face(const scene *s, pe_vec3 x)
{
    const pe_face *face = s->facing.face;
    return (pe_dot(face->normal, x) - face->offset) / pe_dot(face->normal, s->d);
}

/* A point of the cylinder, `gap` along d from the polytope's core. */
static void add(scene *s, pe_vec3 x, double gap, uint64_t feature)
{
    pe_hit_list_add(&s->patch, x, gap - s->radius, feature);
}

/* Whether the point, seen along d, lies in the face; if just outside, it is moved in. */
static bool move_into_face(const scene *s, pe_vec3 *x)
{
    const facing *f = &s->facing;
    pe_vec3 v = corner(f, f->count - 1);
    for (int i = 0; i < f->count; ++i) {
        pe_vec3 next = corner(f, i), inward = pe_cross(s->d, pe_sub(next, v));
        double depth = pe_dot(pe_sub(*x, v), inward);
        if (depth < 0) {
            double square = pe_dot(inward, inward), most = 1.001 * s->slack;
            if (depth * depth > most * most * square) {
                return false;
            }
            *x = pe_madd(*x, -depth / square, inward);
        }
        v = next;
    }
    return true;
}

static void add_rim_point(scene *s, pe_vec3 x, uint64_t feature)
{
    pe_vec3 moved = x;
    if (move_into_face(s, &moved)) {
        /* Back into the cap's plane. */
        double rise = pe_dot(pe_sub(moved, x), s->c->axis) / pe_dot(s->d, s->c->axis);
        moved = pe_madd(moved, -rise, s->d);
        add(s, moved, over_face(s, moved), feature);
    }
}

/* Points of the rim about `middle` over the face: four in directions of the polytope's axes, and
 * the lowest one. */
static void add_rim(scene *s, pe_vec3 middle)
{
    const pe_cylinder *c = s->c;
    pe_vec3 t1, t2;
    double length, sine;
    pe_tangents(s->d, &t1, &t2);
    t1 = pe_scale(c->radius, pe_cylinder_outward(c, t1, &length));
    t2 = pe_cross(c->axis, t1);
    int face = s->facing.index;
    add_rim_point(s, pe_add(middle, t1), name(RIM, face, 0));
    add_rim_point(s, pe_add(middle, t2), name(RIM, face, 1));
    add_rim_point(s, pe_sub(middle, t1), name(RIM, face, 2));
    add_rim_point(s, pe_sub(middle, t2), name(RIM, face, 3));
    pe_vec3 up = pe_cylinder_outward(c, s->facing.face->normal, &sine);
    if (2 * c->radius * sine > LEVEL * s->patch.size) {
        add_rim_point(s, pe_madd(middle, -c->radius, up), name(LOWEST, face, 0));
    }
}

/* Corners inside the cap about `middle`, and where the straight lines between them cross its rim.
 * All is projected along d into the cap's plane, where gaps are linear. */
static void add_bounds(scene *s, pe_vec3 middle)
{
    const pe_cylinder *c = s->c;
    const facing *f = &s->facing;
    double r = c->radius, rise = pe_dot(s->d, c->axis);
    pe_vec3 last = pe_v3(0, 0, 0);
    double last_gap = 0;
    for (int i = -1; i < f->count; ++i) {
        int k = i < 0 ? f->count - 1 : i;
        pe_vec3 v = pe_sub(corner(f, k), middle);
        double gap = -pe_dot(v, c->axis) / rise;
        v = pe_madd(v, gap, s->d);
        double beyond = pe_length(v) - r;
        if (i >= 0 && beyond <= 0) {
            add(s, pe_add(middle, v), gap, name(CORNER, f->index, k));
        } else if (i >= 0 && beyond <= s->slack && f->face != NULL) {
            pe_vec3 x = pe_madd(middle, r / (r + beyond), v);
            add(s, x, over_face(s, x), name(CORNER, f->index, k));
        }
        pe_vec3 step = pe_sub(v, last);
        double length2 = pe_dot(step, step), along = -pe_dot(last, step);
        pe_vec3 foot = length2 > 0 ? pe_madd(last, along / length2, step) : last;
        double chord2 = r * r - pe_dot(foot, foot); /* half of it, squared */
        if (i >= (f->count == 2 ? 1 : 0) && length2 > 0 && chord2 > 2 * r * s->slack) {
            double reach = sqrt(chord2 * length2);
            for (int out = 0; out < 2; ++out) {
                double t = (out ? along + reach : along - reach) / length2;
                if (t > 0 && t < 1) {
                    add(s, pe_add(middle, pe_madd(last, t, step)),
                        last_gap + t * (gap - last_gap),
                        name(out ? CROSSING_OUT : CROSSING_IN, f->index, k));
                }
            }
        }
        last = v;
        last_gap = gap;
    }
}

/* Ends of the part of the side's lowest line that lies over the face. */
static void add_line(scene *s)
{
    const pe_cylinder *c = s->c;
    const facing *f = &s->facing;
    double length, low = -c->half_height, high = c->half_height;
    pe_vec3 middle = pe_madd(c->centre, -c->radius, pe_cylinder_outward(c, s->d, &length));
    pe_vec3 v = corner(f, f->count - 1);
    for (int i = 0; i < f->count; ++i) {
        pe_vec3 next = corner(f, i), inward = pe_cross(s->d, pe_sub(next, v));
        double depth = pe_dot(pe_sub(middle, v), inward) + s->slack * pe_length(inward);
        double rise = pe_dot(c->axis, inward);
        if (rise > 0) {
            low = pe_max(low, -depth / rise);
        } else if (rise < 0) {
            high = pe_min(high, -depth / rise);
        } else if (depth < 0) {
            return;
        }
        v = next;
    }
    /* The side is flat enough to move a point about on it by the slack. */
    pe_vec3 end[2] = {pe_madd(middle, low, c->axis), pe_madd(middle, high, c->axis)};
    for (int k = 0; k < 2 && low <= high; ++k) {
        if (move_into_face(s, &end[k])) {
            add(s, end[k], over_face(s, end[k]), name(LINE_END, 0, k));
        }
    }
}

/* Where the line x + t d enters the side, if it does so well off the side's silhouette. */
static bool reach_side(const scene *s, pe_vec3 x, double *t)
{
    const pe_cylinder *c = s->c;
    pe_vec3 p = pe_cylinder_across(c, pe_sub(x, c->centre)), e = pe_cylinder_across(c, s->d);
    double e2 = pe_dot(e, e), along = pe_dot(p, e), r2 = c->radius * c->radius;
    double root2 = along * along - e2 * (pe_dot(p, p) - r2);
    if (!(root2 > 0.75 * r2 * e2)) {
        return false;
    }
    *t = (-along - sqrt(root2)) / e2;
    double z = pe_dot(pe_sub(pe_madd(x, *t, s->d), c->centre), c->axis);
    return fabs(z) <= c->half_height + 1e-10 * s->patch.size;
}

/* The part of an edge, x = v + t step, beside the cylinder: from end[0] to end[1] if not empty. */
static void beside(const pe_cylinder *c, pe_vec3 v, pe_vec3 step, double end[2])
{
    double z = pe_dot(pe_sub(v, c->centre), c->axis), rise = pe_dot(step, c->axis);
    double t0 = (-c->half_height - z) / rise, t1 = (c->half_height - z) / rise;
    end[0] = rise == 0 ? 0 : pe_max(0, pe_min(t0, t1));
    end[1] = rise == 0 ? 1 : pe_min(1, pe_max(t0, t1));
}

/* Ends of the part of an edge that lies along the side. */
static void add_edge_along_side(scene *s)
{
    pe_vec3 v = corner(&s->facing, 0), step = pe_sub(corner(&s->facing, 1), v);
    double end[2];
    beside(s->c, v, step, end);
    for (int k = 0; k < 2 && end[0] <= end[1]; ++k) {
        pe_vec3 x = pe_madd(v, end[k], step);
        double gap;
        if (reach_side(s, x, &gap)) {
            add(s, pe_madd(x, gap, s->d), gap, name(LINE_END, 0, k));
        }
    }
}

/* The point of the cylinder that realises the gap. */
static pe_vec3 nearest_point(const scene *s, const pe_meeting_gap *gap)
{
    const pe_polytope *p = s->facing.p;
    const pe_cylinder *c = s->c;
    if (gap->kind == PE_FACE_CYLINDER || gap->kind == PE_EDGE_RIM) {
        return pe_cylinder_support(c, pe_scale(-1, s->d));
    }
    pe_vec3 v = p->vertices[gap->index];
    if (gap->kind == PE_EDGE_SIDE) {
        /* Where the edge is nearest to the axis. */
        const pe_edge *edge = &p->edges[gap->index];
        v = p->vertices[edge->vertex[0]];
        pe_vec3 step = pe_sub(p->vertices[edge->vertex[1]], v), across = pe_cylinder_across(c, step);
        double end[2], t = pe_dot(pe_sub(c->centre, v), across) / pe_dot(across, across);
        beside(c, v, step, end);
        v = pe_madd(v, pe_max(end[0], pe_min(end[1], t)), step);
    }
    return pe_madd(v, gap->distance, s->d);
}

static void add_points(scene *s, const pe_meeting_gap *gap)
{
    const pe_cylinder *c = s->c;
    double rise = pe_dot(s->d, c->axis);
    if (fabs(rise) >= 0.7) {
        pe_vec3 middle = pe_madd(c->centre, rise > 0 ? -c->half_height : c->half_height, c->axis);
        if (s->facing.face != NULL) {
            add_rim(s, middle);
        }
        if (s->facing.count > 0) {
            add_bounds(s, middle);
        }
    } else if (s->facing.face != NULL) {
        add_line(s);
    } else if (s->facing.count == 2) {
        add_edge_along_side(s);
    }
    pe_hit_list_add_nearest(&s->patch, nearest_point(s, gap), name(NEAREST, (int)gap->kind, gap->index));
}

/* `polytope_first`: the order of the shapes in *hits. */
static void collide(pe_placed polytope, pe_placed cylinder, bool polytope_first, double margin,
                    pe_hits *hits)
{
    pe_polytope p;
    pe_polytope_make(polytope, &p);
    pe_cylinder c = pe_cylinder_seen(cylinder, polytope.pose);
    double size = pe_min(polytope.size, cylinder.size);
    pe_meeting_gap gap;
    if (!pe_cylinder_polytope_gap(&p, &c, size, polytope_first, margin + p.radius, &gap)) {
        return;
    }
    scene s = {
        .c = &c,
        .facing = find_facing(&p, &gap),
        .d = gap.normal,
        .radius = p.radius,
        .slack = SLACK * size,
        .patch = pe_hit_list_begin(gap.normal, gap.distance - p.radius, margin, size),
    };
    add_points(&s, &gap);
    pe_hit_list_finish(&s.patch, polytope.pose, !polytope_first, hits);
    bool on_polytope = gap.kind != PE_CORNER_CAP;
    hits->normal_on_b = on_polytope != polytope_first;
}

void pe_collide_box_cylinder(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    collide(a, b, true, margin, hits);
}

void pe_collide_capsule_cylinder(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    collide(a, b, true, margin, hits);
}

void pe_collide_cylinder_hull(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    collide(b, a, false, margin, hits);
}
