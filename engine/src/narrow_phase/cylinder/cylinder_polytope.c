/* A cylinder against a box, a hull and a capsule.
 *
 * The direction comes from pe_cylinder_polytope_gap. The points bound the overlap of the cylinder's
 * cap, or of the lowest line of its side, whichever faces the other shape, and the face, edge or
 * vertex there, as seen along the direction. On a cap these are the ends of the straight bounds of
 * the overlap, the lowest point of the cap, and four points of the rim in directions that stay with
 * the other shape, for the cap may spin. Where none of them realises the gap, the point that does is
 * added. A capsule is its segment, with its radius taken off the gap. */
#include "cylinder_gap.h"
#include "narrow_phase/feature_id.h"
#include "narrow_phase/points.h"
#include "narrow_phase/tolerances.h"

/* Kinds of points, for their feature ids. */
enum { RIM = 1, LOWEST, CORNER, CROSSING_IN, CROSSING_OUT, LINE_END, NEAREST };

/* The feature of the polytope that faces the cylinder: the corners of a face, or the ends of an
 * edge. */
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

/* An edge, whether or not it lies across the direction. */
static facing edge_of(const pe_polytope *p, int index)
{
    return (facing){p, NULL, p->edges[index].vertex, 2, p->face_count + index};
}

static facing facing_edge(const pe_polytope *p, int index, pe_vec3 d)
{
    facing edge = edge_of(p, index);
    pe_vec3 e = pe_sub(corner(&edge, 1), corner(&edge, 0));
    edge.count = fabs(pe_dot(e, d)) <= PE_EDGE_CROSSWISE * pe_length(e) ? 2 : 0;
    return edge;
}

/* The edge at the vertex that is most nearly across d, and of those most nearly along the axis. */
static int edge_at(const pe_polytope *p, int vertex, pe_vec3 d, pe_vec3 axis)
{
    int best = -1;
    double least = HUGE_VAL;
    for (int k = p->vertex_first[vertex]; k < p->vertex_first[vertex + 1]; ++k) {
        const pe_edge *edge = &p->edges[p->vertex_edges[k]];
        pe_vec3 e = pe_sub(p->vertices[edge->vertex[1]], p->vertices[edge->vertex[0]]);
        double score = (fabs(pe_dot(e, d)) - 1e-3 * fabs(pe_dot(e, axis))) / pe_length(e);
        if (score < least) {
            least = score;
            best = p->vertex_edges[k];
        }
    }
    return best;
}

static facing find_facing(const pe_polytope *p, const pe_cylinder *c, const pe_meeting_gap *gap,
                          bool cap)
{
    if (gap->kind == PE_FACE_CYLINDER) {
        return facing_face(p, gap->index);
    }
    int best = -1;
    double most = cap ? PE_FACE_ALONG_CAP : PE_FACE_ALONG_SIDE;
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
    int edge = at_edge ? gap->index : edge_at(p, gap->index, gap->normal, c->axis);
    return edge >= 0 ? facing_edge(p, edge, gap->normal) : (facing){.p = p};
}

/* The two shapes, with d from the polytope to the cylinder. */
typedef struct contact {
    const pe_cylinder *c;
    facing facing;
    pe_vec3 d;
    double radius; /* m, of the ball that sweeps the polytope */
    double rise;   /* axis . d */
    bool cap;      /* a cap faces the polytope, not the side */
    double slack;  /* m */
    double gap;    /* m, of the polytope's core */
    pe_point_list list;
} contact;

/* Height of a point of the cylinder over the face, along d. */
static double over_face(const contact *s, pe_vec3 x)
{
    const pe_face *face = s->facing.face;
    return (pe_dot(face->normal, x) - face->offset) / pe_dot(face->normal, s->d);
}

/* Adds a point of the cylinder, `gap` along d from the polytope's core. */
static void add(contact *s, pe_vec3 x, double gap, uint64_t feature)
{
    pe_point_list_add(&s->list, x, gap - s->radius, feature);
}

/* The distance (m) of the point, seen along d, inside the face's bound that ends at corner i. */
static double depth_at(const contact *s, int i, pe_vec3 x, pe_vec3 *inward)
{
    const facing *f = &s->facing;
    pe_vec3 from = corner(f, i > 0 ? i - 1 : f->count - 1);
    *inward = pe_cross(s->d, pe_sub(corner(f, i), from));
    *inward = pe_scale(1 / pe_length(*inward), *inward);
    return pe_dot(pe_sub(x, from), *inward);
}

/* Whether the point, seen along d, lies in the face. */
static bool is_in_face(const contact *s, pe_vec3 x)
{
    pe_vec3 unused;
    for (int i = 0; i < s->facing.count; ++i) {
        if (depth_at(s, i, x, &unused) < -PE_CYLINDER_TIE * s->list.size) {
            return false;
        }
    }
    return true;
}

/* Whether the point, seen along d, lies in the face. A point just outside is moved in. */
static bool move_into_face(const contact *s, pe_vec3 *x)
{
    bool moved = false;
    pe_vec3 inward;
    for (int i = 0; i < s->facing.count; ++i) {
        double depth = depth_at(s, i, *x, &inward);
        if (depth < -s->slack) {
            return false;
        }
        if (depth < 0) {
            *x = pe_madd(*x, -depth, inward);
            moved = true;
        }
    }
    return !moved || is_in_face(s, *x); /* near a corner one move may undo another */
}

/* Adds the point of the rim at `arm` from its centre if it lies over the face. */
static void add_rim_point(contact *s, pe_vec3 middle, pe_vec3 arm, uint64_t feature)
{
    pe_vec3 x = pe_add(middle, arm), moved = x;
    if (move_into_face(s, &moved)) {
        /* Back into the cap's plane. */
        double rise = pe_dot(pe_sub(moved, x), s->c->axis) / s->rise;
        moved = pe_madd(moved, -rise, s->d);
        if (pe_length(pe_sub(moved, middle)) <= s->c->radius + PE_CYLINDER_TIE * s->list.size) {
            add(s, moved, over_face(s, moved), feature);
        }
    }
}

/* Adds points of the rim about `middle` over the face: four in directions of the polytope's axes,
 * and the lowest one. */
static void add_rim(contact *s, pe_vec3 middle)
{
    const pe_cylinder *c = s->c;
    pe_vec3 normal = s->facing.face->normal, t1, t2, arm[4];
    double sine;
    pe_tangents(normal, &t1, &t2);
    pe_cylinder_rim(c, t1, arm);
    for (int k = 0; k < 4; ++k) {
        add_rim_point(s, middle, arm[k], pe_cylinder_feature(RIM, s->facing.index, k));
    }
    pe_vec3 up = pe_outward(c->axis, normal, &sine);
    if (2 * c->radius * sine > PE_LEVEL_CAP * s->list.size) {
        add_rim_point(s, middle, pe_scale(-c->radius, up),
                      pe_cylinder_feature(LOWEST, s->facing.index, 0));
    }
}

/* A corner as seen in the cap's plane. */
typedef struct mark {
    pe_vec3 at; /* from the cap's centre */
    double gap; /* from the corner there, along d: linear between corners */
    int corner;
} mark;

/* Adds the point at t of the straight line from p to q, if between them. Next to a corner it has
 * the corner's feature id, for it replaces the corner when that slips off the cap. */
static void add_on_bound(contact *s, pe_vec3 middle, const mark *p, const mark *q, double t,
                         uint64_t kind)
{
    if (!(t > 0 && t < 1)) {
        return;
    }
    pe_vec3 step = pe_sub(q->at, p->at);
    double length = pe_length(step), near = 1e-3 * s->list.size;
    bool is_p = t * length < near, is_q = (1 - t) * length < near;
    add(s, pe_add(middle, pe_madd(p->at, t, step)), p->gap + t * (q->gap - p->gap),
        pe_cylinder_feature(is_p || is_q ? CORNER : kind, s->facing.index,
                            is_p ? p->corner : q->corner));
}

/* Adds the points where the straight line from p to q crosses the rim; near a tangent only the
 * midpoint. */
static void add_crossings(contact *s, pe_vec3 middle, const mark *p, const mark *q)
{
    double r = s->c->radius;
    pe_vec3 step = pe_sub(q->at, p->at);
    double length2 = pe_dot(step, step), along = -pe_dot(p->at, step);
    if (!(length2 > 0)) {
        return;
    }
    pe_vec3 foot = pe_madd(p->at, along / length2, step);
    double inside = r - pe_length(foot);
    if (inside > s->slack) {
        double reach = sqrt((2 * r - inside) * inside * length2);
        add_on_bound(s, middle, p, q, (along - reach) / length2, CROSSING_IN);
        add_on_bound(s, middle, p, q, (along + reach) / length2, CROSSING_OUT);
    } else if (inside > -PE_CYLINDER_TIE * s->list.size) {
        add_on_bound(s, middle, p, q, along / length2, CROSSING_IN);
    }
}

/* Adds corners inside the cap about `middle`, and points where the lines between them cross its
 * rim. */
static void add_bounds(contact *s, pe_vec3 middle)
{
    const pe_cylinder *c = s->c;
    const facing *f = &s->facing;
    mark last = {.gap = 0};
    for (int i = -1; i < f->count; ++i) {
        int k = i < 0 ? f->count - 1 : i;
        pe_vec3 v = pe_sub(corner(f, k), middle);
        mark m = {.gap = -pe_dot(v, c->axis) / s->rise, .corner = k};
        m.at = pe_madd(v, m.gap, s->d);
        double beyond = pe_length(m.at) - c->radius;
        if (i >= 0 && beyond <= (f->face == NULL ? PE_CYLINDER_TIE * s->list.size : 0)) {
            add(s, pe_add(middle, m.at), m.gap, pe_cylinder_feature(CORNER, f->index, k));
        } else if (i >= 0 && beyond <= s->slack && f->face != NULL) {
            pe_vec3 x = pe_madd(middle, c->radius / (c->radius + beyond), m.at);
            if (is_in_face(s, x)) {
                add(s, x, over_face(s, x), pe_cylinder_feature(CORNER, f->index, k));
            }
        }
        if (i > 0 || (i == 0 && f->count > 2)) {
            add_crossings(s, middle, &last, &m);
        }
        last = m;
    }
}

/* The part of the line x + z axis that lies over the face, from end[0] to end[1]. Returns its
 * length; it is empty if that is negative. */
static double clip_to_face(const contact *s, pe_vec3 x, double end[2])
{
    const pe_cylinder *c = s->c;
    end[0] = -c->half_height;
    end[1] = c->half_height;
    for (int i = 0; i < s->facing.count; ++i) {
        pe_vec3 inward;
        double depth = depth_at(s, i, x, &inward), rise = pe_dot(c->axis, inward);
        if (rise > 0) {
            end[0] = pe_max(end[0], -depth / rise);
        } else if (rise < 0) {
            end[1] = pe_min(end[1], -depth / rise);
        } else if (depth < 0) {
            return -1;
        }
    }
    return end[1] - end[0];
}

/* Whether the point lies beside the edge, not past an end, if an edge is all that faces. Where the
 * line of the side is nearly parallel to it, the two may cross past its ends. */
static bool is_beside_edge(const contact *s, pe_vec3 x)
{
    pe_vec3 v = corner(&s->facing, 0), step = pe_sub(corner(&s->facing, 1), v);
    double length = pe_length(step), along = pe_dot(pe_sub(x, v), step) / length;
    double tie = PE_CYLINDER_TIE * s->list.size;
    return s->facing.count != 2 || (along >= -tie && along <= length + tie);
}

/* Adds the ends of the part of the side's lowest line that lies over the face. The side is flat
 * enough to move the line by the slack, so that a line right on a bound of a face stays over the
 * face. */
static void add_line(contact *s)
{
    const pe_cylinder *c = s->c;
    double unused, end[2], other[2];
    pe_vec3 x = pe_madd(c->centre, -c->radius, pe_outward(c->axis, s->d, &unused));
    double length = clip_to_face(s, x, end);
    double size = s->list.size;
    if (length < 2 * c->half_height) {
        pe_vec3 lateral = pe_cross(c->axis, s->d), middle = x;
        for (double side = -1; side < 2; side += 2) {
            pe_vec3 moved = pe_madd(middle, side * PE_SIDE_SLACK * size, lateral);
            double there = clip_to_face(s, moved, other);
            if (there > length + 1e-3 * size) {
                length = there;
                x = moved;
                end[0] = other[0];
                end[1] = other[1];
            }
        }
    }
    if (length < 0 && length > -PE_CYLINDER_TIE * size) {
        end[0] = end[1] = 0.5 * (end[0] + end[1]);
        length = 0;
    }
    for (int k = 0; k < 2 && length >= 0; ++k) {
        pe_vec3 y = pe_madd(x, end[k], c->axis);
        if (is_beside_edge(s, y)) {
            add(s, y, over_face(s, y), pe_cylinder_feature(LINE_END, 0, k));
        }
    }
}

/* Whether a point, on the infinite cylinder, is between the planes of the caps. */
static bool is_between_caps(const contact *s, pe_vec3 x)
{
    double z = pe_dot(pe_sub(x, s->c->centre), s->c->axis);
    return fabs(z) <= s->c->half_height + PE_CYLINDER_TIE * s->list.size;
}

/* The part of an edge, x = v + t step, along the cylinder: from end[0] to end[1] if not empty. */
static void along_cylinder(const contact *s, pe_vec3 v, pe_vec3 step, double end[2])
{
    const pe_cylinder *c = s->c;
    pe_vec3 on_side = pe_sub(pe_madd(v, s->gap, s->d), c->centre);
    double z = pe_dot(on_side, c->axis), rise = pe_dot(step, c->axis);
    double t0 = (-c->half_height - z) / rise, t1 = (c->half_height - z) / rise;
    end[0] = rise == 0 ? 0 : pe_max(0, pe_min(t0, t1));
    end[1] = rise == 0 ? 1 : pe_min(1, pe_max(t0, t1));
}

/* Adds the ends of the part of an edge that lies along the side. */
static void add_edge_along_side(contact *s)
{
    pe_vec3 v = corner(&s->facing, 0), step = pe_sub(corner(&s->facing, 1), v);
    double end[2];
    along_cylinder(s, v, step, end);
    for (int k = 0; k < 2 && end[0] <= end[1]; ++k) {
        pe_vec3 x = pe_madd(v, end[k], step);
        double gap, unused;
        if (pe_cylinder_pierce(s->c, x, s->d, &gap, &unused)) {
            x = pe_madd(x, gap, s->d);
            if (is_between_caps(s, x)) {
                add(s, x, gap, pe_cylinder_feature(LINE_END, 0, k));
            }
        }
    }
}

/* How far the point is outside the cylinder, m. */
static double outside_cylinder(const contact *s, pe_vec3 x)
{
    return pe_length(pe_sub(pe_cylinder_nearest(s->c, x), x));
}

/* The point of an edge that is nearest to the side, in the part of the edge between the caps. That
 * part may be reached only far along an edge that lies nearly in a cap's plane. The point is then
 * taken as it is, beyond the cap by rounding. */
static pe_vec3 place_along_side(const contact *s, const pe_polytope *p, const pe_meeting_gap *gap)
{
    const int *vertex = p->edges[gap->index].vertex;
    pe_vec3 v = p->vertices[vertex[0]], step = pe_sub(p->vertices[vertex[1]], v);
    double end[2], place = pe_cylinder_edge_place(p, s->c, gap);
    along_cylinder(s, v, step, end);
    pe_vec3 x = pe_madd(v, pe_max(end[0], pe_min(end[1], place)), step);
    pe_vec3 other = pe_madd(v, place, step);
    double outside = outside_cylinder(s, pe_madd(x, gap->distance, s->d));
    return outside > PE_CYLINDER_TIE * s->list.size &&
                   outside_cylinder(s, pe_madd(other, gap->distance, s->d)) < outside
               ? other
               : x;
}

/* Of the vertices that are as near as the given one, that whose opposite point is in the cylinder,
 * or least outside. */
static pe_vec3 corner_below(const contact *s, const pe_polytope *p, int vertex)
{
    pe_vec3 best = p->vertices[vertex];
    double height = pe_dot(s->d, best) - PE_CYLINDER_TIE * s->list.size, least = HUGE_VAL;
    for (int i = 0; i < p->vertex_count && least > 0; ++i) {
        pe_vec3 v = p->vertices[i], x = pe_madd(v, s->gap, s->d);
        double outside = outside_cylinder(s, x);
        if (pe_dot(s->d, v) >= height && outside < least) {
            least = outside;
            best = v;
        }
    }
    return best;
}

/* The point of the face, or of the edge, that is nearest to x. */
static pe_vec3 nearest_in(const facing *f, pe_vec3 x)
{
    pe_vec3 best = x;
    double least = HUGE_VAL;
    bool inside = f->face != NULL;
    for (int i = f->face != NULL ? 0 : 1; i < f->count; ++i) {
        pe_vec3 from = corner(f, i > 0 ? i - 1 : f->count - 1), step = pe_sub(corner(f, i), from);
        double t = pe_dot(pe_sub(x, from), step) / pe_dot(step, step);
        pe_vec3 y = pe_madd(from, pe_max(0, pe_min(1, t)), step), away = pe_sub(y, x);
        double square = pe_dot(away, away);
        if (square < least) {
            least = square;
            best = y;
        }
        inside = inside && pe_dot(pe_cross(f->face->normal, step), pe_sub(x, from)) >= 0;
    }
    return inside ? pe_madd(x, f->face->offset - pe_dot(f->face->normal, x), f->face->normal)
                  : best;
}

/* The point of the cylinder that realises the gap. False if it is not in both shapes, because of
 * the bias towards caps and faces, or because many points are equally near. */
static bool nearest_point(const contact *s, const pe_meeting_gap *gap, pe_vec3 *x)
{
    const pe_polytope *p = s->facing.p;
    const pe_cylinder *c = s->c;
    if (gap->kind == PE_FACE_CYLINDER || gap->kind == PE_EDGE_RIM) {
        *x = pe_cylinder_support(c, pe_scale(-1, s->d));
        if (gap->kind == PE_EDGE_RIM) {
            const facing edge = edge_of(p, gap->index);
            pe_vec3 opposite = pe_madd(*x, -s->gap, s->d);
            double beside = pe_length(pe_sub(nearest_in(&edge, opposite), opposite));
            return beside <= PE_CYLINDER_TIE * s->list.size;
        }
        return is_in_face(s, *x);
    }
    pe_vec3 v;
    if (gap->kind == PE_EDGE_SIDE) {
        v = place_along_side(s, p, gap);
    } else {
        v = corner_below(s, p, gap->index);
    }
    *x = pe_madd(v, gap->distance, s->d);
    pe_vec3 out = pe_across(c->axis, pe_sub(*x, c->centre));
    return is_between_caps(s, *x) && pe_length(out) <= c->radius + PE_CYLINDER_TIE * s->list.size;
}

/* Moves x to where the cylinder meets the face or edge when that is moved by the gap, by alternate
 * projection. Returns how far apart they are there, m. */
static double meet(const contact *s, const facing *f, pe_vec3 *x)
{
    enum { MOST = 40 };
    const pe_vec3 gap = pe_scale(s->gap, s->d);
    double apart = HUGE_VAL;
    for (int i = 0; i < MOST && apart > PE_CYLINDER_EXACT * s->list.size; ++i) {
        pe_vec3 opposite = pe_add(nearest_in(f, pe_sub(*x, gap)), gap);
        *x = pe_cylinder_nearest(s->c, opposite);
        apart = pe_length(pe_sub(opposite, *x));
    }
    return apart;
}

/* Of the points where the cylinder meets the face or edge that faces it, or the edge of the gap, the
 * best one. It is searched from x and from the cylinder's centre. */
static pe_vec3 best_meeting(const contact *s, const pe_meeting_gap *gap, pe_vec3 x)
{
    const bool at_edge = gap->kind == PE_EDGE_SIDE || gap->kind == PE_EDGE_RIM;
    const facing features[2] = {s->facing, at_edge ? edge_of(s->facing.p, gap->index) : s->facing};
    const pe_vec3 starts[2] = {x, s->c->centre};
    double least = HUGE_VAL;
    for (int k = 0; k < 4 && least > PE_CYLINDER_EXACT * s->list.size; ++k) {
        pe_vec3 y = starts[k / 2];
        double apart = features[k % 2].count > 0 ? meet(s, &features[k % 2], &y) : HUGE_VAL;
        if (apart < least) {
            least = apart;
            x = y;
        }
    }
    return x;
}

/* False if the point that realises the gap is not in both shapes. Then it is added only
 * `at_any_rate`. */
static bool add_points(contact *s, const pe_meeting_gap *gap, bool at_any_rate)
{
    const pe_cylinder *c = s->c;
    if (s->cap) {
        double height = s->rise > 0 ? -c->half_height : c->half_height;
        pe_vec3 middle = pe_madd(c->centre, height, c->axis);
        /* Corners come first: a point of the rim that coincides with one would flicker. */
        if (s->facing.count > 0) {
            add_bounds(s, middle);
        }
        if (s->facing.face != NULL) {
            add_rim(s, middle);
        }
    } else if (s->facing.face != NULL) {
        add_line(s);
    } else if (s->facing.count == 2) {
        add_edge_along_side(s);
    }
    pe_vec3 nearest;
    if (pe_point_list_has_nearest(&s->list)) {
        return true;
    }
    bool sound = nearest_point(s, gap, &nearest);
    if (sound || at_any_rate) {
        nearest = sound ? nearest : best_meeting(s, gap, nearest);
        pe_point_list_add(&s->list, nearest, gap->distance - s->radius,
                          pe_cylinder_feature(NEAREST, 0, 0));
    }
    return sound;
}

void pe_cylinder_polytope_contact(const pe_polytope *p, const pe_pose *pose, pe_placed cylinder,
                                  pe_gap_query query, pe_pair_manifold *manifold)
{
    double margin = query.limit, size = query.size;
    pe_cylinder c = pe_cylinder_in_axes(cylinder, pose);
    query.bias = PE_FLAT_BIAS * size;
    query.limit = margin + p->radius;
    contact s = {.c = &c, .radius = p->radius, .slack = PE_CAP_SLACK * size};
    pe_meeting_gap gap;
    bool done = false;
    for (int pass = 0; pass < 2 && !done; ++pass) {
        if (!pe_cylinder_polytope_gap(p, &c, &query, &gap)) {
            return;
        }
        s.d = gap.normal;
        s.gap = gap.distance;
        s.rise = pe_dot(gap.normal, c.axis);
        s.cap = fabs(s.rise) >= PE_CAP_FACING;
        s.facing = find_facing(p, &c, &gap, s.cap);
        s.list = pe_point_list_begin(gap.normal, gap.distance - p->radius, margin, size);
        done = add_points(&s, &gap, pass == 1);
        query.bias = 0; /* the bias kept a face or cap that the other shape does not meet */
    }
    pe_point_list_finish(&s.list, pose, !query.face_first, manifold);
    manifold->normal_on_b = (gap.kind != PE_CORNER_CAP) != query.face_first;
}

void pe_collide_polytope_cylinder(pe_placed a, pe_placed b, double margin,
                                  pe_pair_manifold *manifold)
{
    pe_polytope p;
    pe_polytope_make(a, &p);
    pe_gap_query query = {.size = pe_min(a.size, b.size), .limit = margin, .face_first = true};
    pe_cylinder_polytope_contact(&p, a.pose, b, query, manifold);
}

void pe_collide_cylinder_hull(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold)
{
    pe_polytope p;
    pe_polytope_make(b, &p);
    pe_gap_query query = {.size = pe_min(b.size, a.size), .limit = margin};
    pe_cylinder_polytope_contact(&p, b.pose, a, query, manifold);
}
