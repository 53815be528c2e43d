/* A cylinder against a box, a hull and a capsule.
 *
 * The direction comes from pe_cylinder_polytope_gap. The points are those where the cylinder's cap
 * or the lowest line of its side, whichever faces the other shape, overlaps the face, edge or
 * corner there, as seen along that direction. On a cap these are the ends of the overlap's straight
 * bounds, the cap's lowest point, and four points of the rim in directions that stay with the other
 * shape: the cap may spin under them. A capsule is its segment, with its radius taken off the gap.
 */
#include "cylinder_polytope.h"
#include "narrow_phase/point_list.h"

/* Least cosine between a direction and the normal of a face that a cap or a side lies along. */
static const double FACES_CAP = 0.98, FACES_SIDE = 0.9999955;
/* Least cosine between the direction and the axis at which it is a cap that faces the other. */
static const double CAP_FACES = 0.7;
/* Most cosine between a direction and an edge that lies across it. */
static const double CROSSWISE = 0.2;
/* In units of the smaller shape: points of a cap, or of a side, this far outside a bound are moved
 * onto it. */
static const double SLACK = 1e-6, SIDE_SLACK = 1e-7;
/* In units of the smaller shape: a cap tilted by less, from end to end, has no lowest point. */
static const double LEVEL = 6e-9;

/* In units of the smaller shape: where a point is, but for rounding. */
static const double TIE = 4e-10;

/* In units of the smaller shape: a face or a cap is left only for what is better by this, so that
 * what rests on one does not leave it for rounding. */
static const double BIAS = 4e-10;

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

/* The edge at the corner that lies most nearly across d, and of those most nearly along the axis.
 */
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
    double most = cap ? FACES_CAP : FACES_SIDE;
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
typedef struct scene {
    const pe_cylinder *c;
    facing facing;
    pe_vec3 d;
    double radius; /* m, of the ball that sweeps the polytope */
    double rise;   /* axis . d */
    bool cap;      /* it is a cap that faces the polytope */
    double slack;  /* m */
    double gap;    /* m, of the polytope's core */
    pe_point_list patch;
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
    pe_point_list_add(&s->patch, x, gap - s->radius, feature);
}

/* How far the point, seen along d, is inside the face's bound that ends at corner i, in m. */
static double depth_at(const scene *s, int i, pe_vec3 x, pe_vec3 *inward)
{
    const facing *f = &s->facing;
    pe_vec3 from = corner(f, i > 0 ? i - 1 : f->count - 1);
    *inward = pe_cross(s->d, pe_sub(corner(f, i), from));
    *inward = pe_scale(1 / pe_length(*inward), *inward);
    return pe_dot(pe_sub(x, from), *inward);
}

/* Whether the point, seen along d, lies in the face. */
static bool is_in_face(const scene *s, pe_vec3 x)
{
    pe_vec3 unused;
    for (int i = 0; i < s->facing.count; ++i) {
        if (depth_at(s, i, x, &unused) < -TIE * s->patch.size) {
            return false;
        }
    }
    return true;
}

/* Whether the point, seen along d, lies in the face; if just outside, it is moved in. */
static bool move_into_face(const scene *s, pe_vec3 *x)
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

static void add_rim_point(scene *s, pe_vec3 middle, pe_vec3 arm, uint64_t feature)
{
    pe_vec3 x = pe_add(middle, arm), moved = x;
    if (move_into_face(s, &moved)) {
        /* Back into the cap's plane. */
        double rise = pe_dot(pe_sub(moved, x), s->c->axis) / s->rise;
        moved = pe_madd(moved, -rise, s->d);
        if (pe_length(pe_sub(moved, middle)) <= s->c->radius + TIE * s->patch.size) {
            add(s, moved, over_face(s, moved), feature);
        }
    }
}

/* Points of the rim about `middle` over the face: four in directions of the polytope's axes, and
 * the lowest one. */
static void add_rim(scene *s, pe_vec3 middle)
{
    const pe_cylinder *c = s->c;
    pe_vec3 t1, t2;
    double length, sine;
    pe_tangents(s->facing.face->normal, &t1, &t2);
    t1 = pe_scale(c->radius, pe_outward(c->axis, t1, &length));
    t2 = pe_cross(c->axis, t1);
    int face = s->facing.index;
    add_rim_point(s, middle, t1, name(RIM, face, 0));
    add_rim_point(s, middle, t2, name(RIM, face, 1));
    add_rim_point(s, middle, pe_scale(-1, t1), name(RIM, face, 2));
    add_rim_point(s, middle, pe_scale(-1, t2), name(RIM, face, 3));
    pe_vec3 up = pe_outward(c->axis, s->facing.face->normal, &sine);
    if (2 * c->radius * sine > LEVEL * s->patch.size) {
        add_rim_point(s, middle, pe_scale(-c->radius, up), name(LOWEST, face, 0));
    }
}

/* A corner as seen in the cap's plane. */
typedef struct mark {
    pe_vec3 at; /* from the cap's middle */
    double gap; /* from the corner there, along d: linear between corners */
    int corner;
} mark;

/* Adds the point at t of the straight line from p to q, if between them. Next to a corner it has
 * the corner's name, for it takes its place when the corner slips off the cap. */
static void add_on_bound(scene *s, pe_vec3 middle, const mark *p, const mark *q, double t,
                         uint64_t kind)
{
    if (!(t > 0 && t < 1)) {
        return;
    }
    pe_vec3 step = pe_sub(q->at, p->at);
    double length = pe_length(step), near = 1e-3 * s->patch.size;
    bool is_p = t * length < near, is_q = (1 - t) * length < near;
    add(s, pe_add(middle, pe_madd(p->at, t, step)), p->gap + t * (q->gap - p->gap),
        name(is_p || is_q ? CORNER : kind, s->facing.index, is_p ? p->corner : q->corner));
}

/* Adds where the straight line from p to q crosses the rim; near its tangents only the middle. */
static void add_crossings(scene *s, pe_vec3 middle, const mark *p, const mark *q)
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
    } else if (inside > -TIE * s->patch.size) {
        add_on_bound(s, middle, p, q, along / length2, CROSSING_IN);
    }
}

/* Corners inside the cap about `middle`, and where the straight lines between them cross its rim.
 */
static void add_bounds(scene *s, pe_vec3 middle)
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
        if (i >= 0 && beyond <= (f->face == NULL ? TIE * s->patch.size : 0)) {
            add(s, pe_add(middle, m.at), m.gap, name(CORNER, f->index, k));
        } else if (i >= 0 && beyond <= s->slack && f->face != NULL) {
            pe_vec3 x = pe_madd(middle, c->radius / (c->radius + beyond), m.at);
            if (is_in_face(s, x)) {
                add(s, x, over_face(s, x), name(CORNER, f->index, k));
            }
        }
        if (i > 0 || (i == 0 && f->count > 2)) {
            add_crossings(s, middle, &last, &m);
        }
        last = m;
    }
}

/* The part of the line x + z axis that lies over the face, from end[0] to end[1]; empty if that is
 * not positive. */
static double clip_to_face(const scene *s, pe_vec3 x, double end[2])
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

/* Ends of the part of the side's lowest line that lies over the face. The side is flat enough to
 * move it about by the slack: so a line on the very bound of a face stays over it. */
static void add_line(scene *s)
{
    const pe_cylinder *c = s->c;
    double unused, end[2], other[2];
    pe_vec3 x = pe_madd(c->centre, -c->radius, pe_outward(c->axis, s->d, &unused));
    double length = clip_to_face(s, x, end);
    double size = s->patch.size;
    if (length < 2 * c->half_height) {
        pe_vec3 lateral = pe_cross(c->axis, s->d), middle = x;
        for (double side = -1; side < 2; side += 2) {
            pe_vec3 moved = pe_madd(middle, side * SIDE_SLACK * size, lateral);
            double there = clip_to_face(s, moved, other);
            if (there > length + 1e-3 * size) {
                length = there;
                x = moved;
                end[0] = other[0];
                end[1] = other[1];
            }
        }
    }
    if (length < 0 && length > -TIE * size) {
        end[0] = end[1] = 0.5 * (end[0] + end[1]);
        length = 0;
    }
    for (int k = 0; k < 2 && length >= 0; ++k) {
        pe_vec3 y = pe_madd(x, end[k], c->axis);
        add(s, y, over_face(s, y), name(LINE_END, 0, k));
    }
}

/* Whether a point, on the infinite cylinder, is between the planes of the caps. */
static bool is_between_caps(const scene *s, pe_vec3 x)
{
    double z = pe_dot(pe_sub(x, s->c->centre), s->c->axis);
    return fabs(z) <= s->c->half_height + TIE * s->patch.size;
}

/* The part of an edge, x = v + t step, beside the cylinder: from end[0] to end[1] if not empty. */
static void beside(const scene *s, pe_vec3 v, pe_vec3 step, double end[2])
{
    const pe_cylinder *c = s->c;
    pe_vec3 on_side = pe_sub(pe_madd(v, s->gap, s->d), c->centre);
    double z = pe_dot(on_side, c->axis), rise = pe_dot(step, c->axis);
    double t0 = (-c->half_height - z) / rise, t1 = (c->half_height - z) / rise;
    end[0] = rise == 0 ? 0 : pe_max(0, pe_min(t0, t1));
    end[1] = rise == 0 ? 1 : pe_min(1, pe_max(t0, t1));
}

/* Ends of the part of an edge that lies along the side. */
static void add_edge_along_side(scene *s)
{
    pe_vec3 v = corner(&s->facing, 0), step = pe_sub(corner(&s->facing, 1), v);
    double end[2];
    beside(s, v, step, end);
    for (int k = 0; k < 2 && end[0] <= end[1]; ++k) {
        pe_vec3 x = pe_madd(v, end[k], step);
        double gap, unused;
        if (pe_cylinder_pierce(s->c, x, s->d, &gap, &unused)) {
            x = pe_madd(x, gap, s->d);
            if (is_between_caps(s, x)) {
                add(s, x, gap, name(LINE_END, 0, k));
            }
        }
    }
}

/* Of the corners that are as near as the one at the vertex, that whose opposite point is in the
 * cylinder, or least outside. */
static pe_vec3 corner_below(const scene *s, const pe_polytope *p, int vertex)
{
    pe_vec3 best = p->vertices[vertex];
    double height = pe_dot(s->d, best) - TIE * s->patch.size, least = HUGE_VAL;
    for (int i = 0; i < p->vertex_count && least > 0; ++i) {
        pe_vec3 v = p->vertices[i], x = pe_madd(v, s->gap, s->d);
        double outside = pe_length(pe_sub(pe_cylinder_nearest(s->c, x), x));
        if (pe_dot(s->d, v) >= height && outside < least) {
            least = outside;
            best = v;
        }
    }
    return best;
}

/* The point of the cylinder that realises the gap. False where, for the bias towards caps and faces
 * or because many corners are as near, it is not in both shapes. */
static bool nearest_point(const scene *s, const pe_meeting_gap *gap, pe_vec3 *x)
{
    const pe_polytope *p = s->facing.p;
    const pe_cylinder *c = s->c;
    if (gap->kind == PE_FACE_CYLINDER || gap->kind == PE_EDGE_RIM) {
        *x = pe_cylinder_support(c, pe_scale(-1, s->d));
        return gap->kind == PE_EDGE_RIM || is_in_face(s, *x);
    }
    pe_vec3 v;
    if (gap->kind == PE_EDGE_SIDE) {
        const pe_edge *edge = &p->edges[gap->index];
        v = p->vertices[edge->vertex[0]];
        pe_vec3 step = pe_sub(p->vertices[edge->vertex[1]], v);
        double end[2], place = pe_cylinder_edge_place(p, c, gap);
        beside(s, v, step, end);
        v = pe_madd(v, pe_max(end[0], pe_min(end[1], place)), step);
    } else {
        v = corner_below(s, p, gap->index);
    }
    *x = pe_madd(v, gap->distance, s->d);
    pe_vec3 out = pe_across(c->axis, pe_sub(*x, c->centre));
    return is_between_caps(s, *x) && pe_length(out) <= c->radius + TIE * s->patch.size;
}

/* False where the point that realises the gap was left out because it is not in both shapes. */
static bool add_points(scene *s, const pe_meeting_gap *gap, bool at_any_rate)
{
    const pe_cylinder *c = s->c;
    if (s->cap) {
        double height = s->rise > 0 ? -c->half_height : c->half_height;
        pe_vec3 middle = pe_madd(c->centre, height, c->axis);
        /* Corners first: a point of the rim that falls on one comes and goes. */
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
    if (pe_point_list_has_nearest(&s->patch)) {
        return true;
    }
    bool sound = nearest_point(s, gap, &nearest);
    if (sound || at_any_rate) {
        pe_point_list_add(&s->patch, nearest, gap->distance - s->radius, name(NEAREST, 0, 0));
    }
    return sound;
}

/* `polytope_first`: the order of the shapes in *hits. */
static void collide(pe_placed polytope, pe_placed cylinder, bool polytope_first, double margin,
                    pe_pair_manifold *hits)
{
    pe_polytope p;
    pe_polytope_make(polytope, &p);
    pe_cylinder c = pe_cylinder_seen(cylinder, polytope.pose);
    double size = pe_min(polytope.size, cylinder.size), bias = BIAS * size;
    scene s = {.c = &c, .radius = p.radius, .slack = SLACK * size};
    pe_meeting_gap gap;
    bool done = false;
    for (int pass = 0; pass < 2 && !done; ++pass) {
        if (!pe_cylinder_polytope_gap(&p, &c, size, bias, polytope_first, margin + p.radius,
                                      &gap)) {
            return;
        }
        s.d = gap.normal;
        s.gap = gap.distance;
        s.rise = pe_dot(gap.normal, c.axis);
        s.cap = fabs(s.rise) >= CAP_FACES;
        s.facing = find_facing(&p, &c, &gap, s.cap);
        s.patch = pe_point_list_begin(gap.normal, gap.distance - p.radius, margin, size);
        done = add_points(&s, &gap, pass == 1);
        bias = 0; /* it took a face or cap that the other shape only passes by */
    }
    pe_point_list_finish(&s.patch, polytope.pose, !polytope_first, hits);
    bool on_polytope = gap.kind != PE_CORNER_CAP;
    hits->normal_on_b = on_polytope != polytope_first;
}

void pe_collide_box_cylinder(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    collide(a, b, true, margin, hits);
}

void pe_collide_capsule_cylinder(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    collide(a, b, true, margin, hits);
}

void pe_collide_cylinder_hull(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    collide(b, a, false, margin, hits);
}
