/* Patches of touches: those with one normal together, each with eight points at most. */
#include "collide_mesh.h"

/* Sine of the angle up to which normals are one. */
static const double ONE_NORMAL = 1e-3;
/* For touches that no plane has, whose normal is that of their line alone, it is less: by how far
 * the points move when the line turns so much about the core, in units of the smaller solid. */
static const double ONE_LINE = 5e-9;

/* In units of the smaller solid: */
static const double MERGE_DISTANCE = 1e-4; /* nearer points of a patch are one */
static const double TIE = 1e-8;            /* separations that differ by less are one */
static const double LEAST_WIDTH = 1e-5;    /* points that widen a patch by less add nothing */
/* Of the touches with the least separation but for this much, one on a face of the first solid
 * gives a patch its normal, or else one on a face of the second. A body at rest has the same normal
 * at every step then. */
static const double SECOND_FACE_BIAS = 1e-6, EDGE_BIAS = 1e-5;

/* Of many points in a patch the outer ones are kept; a point that is farther from touching than the
 * nearest one counts as so many times that much less far out. It would come into play when the
 * bodies tilt by the inverse, in rad. */
static const double HEIGHT_WEIGHT = 10;

typedef struct gatherer {
    const pe_solver_manifold_rules *rules;
    pe_vec3 normal;
    pe_pair_point *points; /* of one patch, in the touches' axes */
    int count;
} gatherer;

/* Points and lines alone are nearest, so that they face each other; of overlaps the ways out are
 * left. */
static bool leads(const pe_touch *t, const pe_solver_manifold_rules *rules)
{
    return t->strict || t->kind > PE_EDGE_EDGE ||
           t->separation + rules->radius < -TIE * rules->size;
}

static double bias(const pe_touch *t, double size)
{
    return t->kind == PE_FACE_VERTEX   ? 0
           : t->kind == PE_VERTEX_FACE ? SECOND_FACE_BIAS * size
                                       : EDGE_BIAS * size;
}

/* The touch that gives the next patch its normal; -1: none is left. What faces the other feature
 * but nearly joins a patch and leads none, unless nothing faces. */
static int find_leader(const pe_touches *list, const pe_solver_manifold_rules *rules,
                       bool must_face)
{
    int leader = -1;
    double least = HUGE_VAL;
    for (int i = 0; i < list->count; ++i) {
        const pe_touch *t = &list->items[i];
        double value = t->separation + bias(t, rules->size);
        if (!t->merged && (leads(t, rules) || !must_face) && value < least) {
            least = value;
            leader = i;
        }
    }
    return leader;
}

static bool has_leader(const pe_touches *list, const pe_solver_manifold_rules *rules)
{
    for (int i = 0; i < list->count; ++i) {
        if (leads(&list->items[i], rules)) {
            return true;
        }
    }
    return false;
}

static bool same_normal(const pe_touch *t, pe_vec3 n, const pe_solver_manifold_rules *rules)
{
    pe_vec3 c = pe_cross(t->normal, n);
    double length = rules->radius + fabs(t->separation), most = ONE_NORMAL;
    if (t->kind > PE_EDGE_EDGE && length > 0) {
        most = pe_min(most, ONE_LINE * rules->size / length);
    }
    return pe_dot(t->normal, n) > 0 && pe_dot(c, c) <= most * most;
}

/* The touch's points on either solid as seen along the patch's normal: the same vertex and another
 * point of the face, or other points of the two edges. */
static pe_pair_point point_of(const gatherer *g, const pe_touch *t)
{
    double radius = g->rules->radius, height = t->separation + radius;
    double along = height / pe_dot(t->normal, g->normal);
    pe_vec3 shift = pe_sub(pe_scale(height, t->normal), pe_scale(along, g->normal));
    pe_vec3 on_a = t->on_a;
    if (t->kind == PE_FACE_VERTEX) {
        on_a = pe_add(on_a, shift);
    } else if (t->kind == PE_EDGE_EDGE) {
        pe_vec3 c = pe_cross(t->along_a, t->along_b);
        double s = pe_dot(pe_cross(shift, t->along_b), c) / pe_dot(c, c);
        on_a = pe_madd(on_a, s, t->along_a);
    }
    double separation = pe_max(along - radius, g->rules->least);
    return (pe_pair_point){
        .position = pe_madd(on_a, radius + 0.5 * separation, g->normal),
        .separation = separation,
        .feature = t->feature,
    };
}

/* Points at one place become one: the deeper, or of equals the first. */
static void add_point(gatherer *g, pe_pair_point point)
{
    double merge = MERGE_DISTANCE * g->rules->size, tie = TIE * g->rules->size;
    for (int i = 0; i < g->count; ++i) {
        pe_pair_point *other = &g->points[i];
        pe_vec3 d = pe_sub(point.position, other->position);
        if (pe_dot(d, d) > merge * merge) {
            continue;
        }
        if (point.separation < other->separation - tie) {
            *other = point;
        } else {
            other->separation = pe_min(other->separation, point.separation);
        }
        return;
    }
    g->points[g->count++] = point;
}

/* The polygon of the points kept so far, in order around the normal. */
typedef struct polygon {
    int corner[PE_MAX_POINTS], count;
} polygon;

static double outside(const gatherer *g, int from, int to, int i)
{
    pe_vec3 u = pe_sub(g->points[to].position, g->points[from].position);
    pe_vec3 out = pe_cross(u, g->normal);
    double length2 = pe_dot(out, out);
    pe_vec3 d = pe_sub(g->points[i].position, g->points[from].position);
    return length2 > 0 ? pe_dot(out, d) / sqrt(length2) : pe_length(d);
}

/* Adds the point that widens the polygon most; false: none does. The growth of a hull by its
 * farthest points (Eddy 1977). */
static bool widen(const gatherer *g, double least, polygon *p)
{
    double most = LEAST_WIDTH * g->rules->size, tie = most;
    int best = -1, place = 0;
    for (int i = 0; i < g->count; ++i) {
        double discount = HEIGHT_WEIGHT * (g->points[i].separation - least);
        for (int k = 0; k < p->count; ++k) {
            int next = k + 1 < p->count ? k + 1 : 0;
            double width = outside(g, p->corner[k], p->corner[next], i) - discount;
            if (width > most + (best >= 0 ? tie : 0)) {
                most = width;
                best = i;
                place = k + 1;
            }
        }
    }
    if (best < 0) {
        return false;
    }
    for (int k = p->count; k > place; --k) {
        p->corner[k] = p->corner[k - 1];
    }
    p->corner[place] = best;
    p->count += 1;
    return true;
}

/* Keeps a deepest point and those that span the widest polygon, in the order that they had. */
static void reduce(gatherer *g)
{
    double least = HUGE_VAL;
    for (int i = 0; i < g->count; ++i) {
        least = pe_min(least, g->points[i].separation);
    }
    polygon p = {.count = 1};
    while (g->points[p.corner[0]].separation > least + TIE * g->rules->size) {
        p.corner[0] += 1;
    }
    g->points[p.corner[0]].separation = least;
    while (p.count < PE_MAX_POINTS && widen(g, least, &p)) {}
    int kept = 0;
    for (int i = 0; i < g->count; ++i) {
        for (int k = 0; k < p.count; ++k) {
            if (p.corner[k] == i) {
                g->points[kept++] = g->points[i];
                break;
            }
        }
    }
    g->count = kept;
}

static void gather(gatherer *g, pe_touches *list, int leader)
{
    g->normal = list->items[leader].normal;
    g->count = 0;
    for (int i = 0; i < list->count; ++i) {
        pe_touch *t = &list->items[i];
        if (!t->merged && same_normal(t, g->normal, g->rules)) {
            t->merged = true;
            add_point(g, point_of(g, t));
        }
    }
    if (g->count > PE_MAX_POINTS) {
        reduce(g);
    }
}

/* Drops what is beyond the margin, and notes at which margins the rest is the same. */
static void drop_far(pe_touches *list, const pe_solver_manifold_rules *rules, double *least_margin,
                     double *end_margin)
{
    int kept = 0;
    *least_margin = -HUGE_VAL;
    *end_margin = rules->end_margin;
    for (int i = 0; i < list->count; ++i) {
        double s = pe_max(list->items[i].separation, rules->least);
        if (s > rules->limit) {
            continue;
        }
        if (s > rules->margin) {
            *end_margin = pe_min(*end_margin, s);
            continue;
        }
        *least_margin = pe_max(*least_margin, s);
        list->items[kept++] = list->items[i];
    }
    list->count = kept;
}

/* By the first feature of each, so that the order does not follow rounding. */
static void sort_patches(pe_pair_manifold *patches, int count)
{
    for (int i = 1; i < count; ++i) {
        for (int j = i; j > 0 && patches[j].item[0].feature < patches[j - 1].item[0].feature; --j) {
            pe_pair_manifold swap = patches[j];
            patches[j] = patches[j - 1];
            patches[j - 1] = swap;
        }
    }
}

int pe_touches_make_patches(pe_touches *list, const pe_solver_manifold_rules *rules,
                            const pe_pose *pose, pe_pair_manifold *patches)
{
    double least_margin, end_margin;
    drop_far(list, rules, &least_margin, &end_margin);
    gatherer g = {.rules = rules};
    g.points = list->count > 0 ? pe_take(list->work, (size_t)list->count, sizeof *g.points) : NULL;
    list->failed = list->failed || (list->count > 0 && g.points == NULL);
    int count = 0;
    bool must_face = has_leader(list, rules);
    for (int leader; count < PE_MAX_MANIFOLDS && !list->failed; ++count) {
        leader = find_leader(list, rules, must_face);
        if (leader < 0) {
            break;
        }
        gather(&g, list, leader);
        pe_pair_manifold *hits = &patches[count];
        hits->normal = pe_rotate(&pose->rotation, g.normal);
        hits->normal_on_b = list->items[leader].kind == PE_VERTEX_FACE;
        hits->least_margin = least_margin;
        hits->end_margin = end_margin;
        hits->count = g.count;
        for (int i = 0; i < g.count; ++i) {
            hits->item[i] = g.points[i];
            hits->item[i].position =
                pe_add(pose->position, pe_rotate(&pose->rotation, g.points[i].position));
        }
    }
    sort_patches(patches, count);
    return list->failed ? -1 : count;
}
