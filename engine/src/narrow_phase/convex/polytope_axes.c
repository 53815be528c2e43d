/* The separation of two polytopes over the normals of their Minkowski difference: faces of either,
 * and crosses of edges whose arcs on the Gauss sphere meet (Gregorius, The Separating Axis Test
 * between Convex Polyhedra, GDC 2013). An edge's arc joins the normals of its faces; that of a
 * segment is the whole circle.
 *
 * Most candidates are dropped without looking at the other core: it holds a ball about its origin,
 * so that no direction separates it by more than the ball is separated. */
#include "polytope.h"

/* In units of the smaller shape: among directions that tie by this, the first face of the first
 * shape is taken, then a face of the second, then edges. */
static const double TIE = 1e-10;
/* Sine of the angle between two edges below which their cross is rounding alone. */
static const double LEAST_SINE = 1e-12;
/* Below this the cross is so uncertain that the edges need not be the last and the first along it;
 * the separation is then measured, which holds for any direction. */
static const double SMALL_SINE = 1e-4;

/* The best face of p against q, placed in p's axes. */
typedef struct face_choice {
    double separation;
    int face, vertex; /* of p; of q, the first over it */
} face_choice;

static bool best_face_of(const pe_polytope *p, const pe_polytope *q, const pe_seen *placed,
                         double limit, double tie, face_choice *best)
{
    /* The face that q's origin is farthest out of gives a bound for the others. */
    double farthest = -HUGE_VAL;
    int first = 0;
    for (int i = 0; i < p->face_count; ++i) {
        double out = pe_dot(p->faces[i].normal, placed->offset) - p->faces[i].offset;
        if (out > farthest + tie) {
            farthest = out;
            first = i;
        }
    }
    int vertex = -1;
    for (int k = p->face_count > 0 ? -1 : 0; k < p->face_count; ++k) {
        int i = k < 0 ? first : k;
        const pe_face *face = &p->faces[i];
        double out = pe_dot(face->normal, placed->offset) - face->offset;
        if (k == first || out - q->inner <= best->separation + tie) {
            continue;
        }
        pe_vec3 back = pe_scale(-1, pe_unrotate(&placed->turn, face->normal));
        vertex = pe_polytope_support(q, back, vertex);
        double separation = out - pe_dot(back, q->vertices[vertex]);
        if (separation > limit) {
            return false;
        }
        if (separation > best->separation + tie) {
            *best = (face_choice){separation, i, vertex};
        }
    }
    return true;
}

static pe_vec3 place(const pe_seen *placed, pe_vec3 x)
{
    return pe_add(pe_rotate(&placed->turn, x), placed->offset);
}

bool pe_polytope_best_face(const pe_polytope_pair *pair, double limit, pe_separation *best)
{
    double tie = TIE * pair->size;
    face_choice of_a = {-HUGE_VAL, 0, 0};
    if (!best_face_of(&pair->a, &pair->b, &pair->b_from_a, limit, tie, &of_a)) {
        return false;
    }
    face_choice of_b = of_a;
    if (!best_face_of(&pair->b, &pair->a, &pair->a_from_b, limit, tie, &of_b)) {
        return false;
    }
    bool flipped = of_b.separation > of_a.separation;
    face_choice choice = flipped ? of_b : of_a;
    *best = (pe_separation){.distance = choice.separation};
    if (flipped) {
        pe_vec3 n = pe_rotate(&pair->b_from_a.turn, pair->b.faces[choice.face].normal);
        best->kind = PE_OF_FACE_B;
        best->b = choice.face;
        best->normal = pe_scale(-1, n);
        best->on_a = pair->a.vertices[choice.vertex];
        best->on_b = pe_madd(best->on_a, best->distance, best->normal);
    } else {
        best->kind = PE_OF_FACE_A;
        best->a = choice.face;
        best->normal = pair->a.faces[choice.face].normal;
        best->on_b = place(&pair->b_from_a, pair->b.vertices[choice.vertex]);
        best->on_a = pe_madd(best->on_b, -best->distance, best->normal);
    }
    best->ends_a[0] = best->ends_a[1] = flipped ? choice.vertex : 0;
    best->ends_b[0] = best->ends_b[1] = flipped ? 0 : choice.vertex;
    return true;
}

/* An edge of b in a's axes. */
typedef struct seen_edge {
    pe_vec3 start, along, normal[2];
    double along2; /* squared length */
    int index;
    bool has_faces;
} seen_edge;

/* The farthest that a point is out of the core along a direction of an edge's arc. With x and y its
 * distances from the two faces' planes, that along the arc is a sinusoid, largest at an end or at
 * its crest between. */
static double most_over_arc(const pe_face *f, const pe_face *g, pe_vec3 point)
{
    double x = pe_dot(f->normal, point) - f->offset, y = pe_dot(g->normal, point) - g->offset;
    double c = pe_dot(f->normal, g->normal), sine2 = 1 - c * c;
    return y - c * x > 0 && x - c * y > 0
               ? (sine2 > 0 ? sqrt((x * x + y * y - 2 * c * x * y) / sine2) : HUGE_VAL)
               : pe_max(x, y);
}

/* Points of one core as the other sees them: a ball about the origin, and where it is nearest by
 * the best face. */
typedef struct inside {
    pe_vec3 centre, nearest;
    double radius;
} inside;

/* `nearest` in the core's own axes; if it is off the core, by more than the slack, it tells nothing
 * and the origin takes its place. */
static inside points_of(const pe_polytope *p, const pe_seen *placed, pe_vec3 nearest, double slack)
{
    bool in = true;
    for (int i = 0; i < p->face_count && in; ++i) {
        in = pe_dot(p->faces[i].normal, nearest) <= p->faces[i].offset + slack;
    }
    pe_vec3 seen = in ? place(placed, nearest) : placed->offset;
    return (inside){.centre = placed->offset, .nearest = seen, .radius = p->inner};
}

/* Whether an edge of the core may separate those points by more than `least`. */
static bool may_separate(const pe_polytope *p, const pe_edge *edge, const inside *other,
                         double least)
{
    if (edge->face[0] < 0) {
        return true;
    }
    const pe_face *f = &p->faces[edge->face[0]], *g = &p->faces[edge->face[1]];
    return most_over_arc(f, g, other->nearest) > least &&
           most_over_arc(f, g, other->centre) - other->radius > least;
}

enum { CHUNK = 64 };

/* Puts the next edges of b that may separate more than `least` into `chunk`; *next moves on. */
static int gather(const pe_polytope_pair *pair, const inside *a, double least, int *next,
                  seen_edge *chunk)
{
    const pe_polytope *b = &pair->b;
    const pe_seen *placed = &pair->b_from_a;
    int count = 0;
    for (; *next < b->edge_count && count < CHUNK; ++*next) {
        const pe_edge *edge = &b->edges[*next];
        if (!may_separate(b, edge, a, least)) {
            continue;
        }
        pe_vec3 p = b->vertices[edge->vertex[0]], q = b->vertices[edge->vertex[1]];
        pe_vec3 along = pe_rotate(&placed->turn, pe_sub(q, p));
        seen_edge *seen = &chunk[count++];
        *seen = (seen_edge){
            .start = place(placed, p),
            .along = along,
            .along2 = pe_dot(along, along),
            .index = *next,
            .has_faces = edge->face[0] >= 0,
        };
        for (int k = 0; k < 2 && seen->has_faces; ++k) {
            seen->normal[k] = pe_rotate(&placed->turn, b->faces[edge->face[k]].normal);
        }
    }
    return count;
}

/* Whether s / sqrt(square) > t, for square > 0, without the root. */
static bool quotient_exceeds(double s, double square, double t)
{
    return t < 0 ? s >= 0 || s * s < t * t * square : s > 0 && s * s > t * t * square;
}

/* Tries edge i of a, whose arc is from normal m to n, against the chunk. False: more than the
 * limit. */
static bool try_edge(const pe_polytope_pair *pair, int i, const seen_edge *chunk, int count,
                     double limit, double tie, pe_separation *best)
{
    const pe_edge *edge = &pair->a.edges[i];
    pe_vec3 start = pair->a.vertices[edge->vertex[0]];
    pe_vec3 along = pe_sub(pair->a.vertices[edge->vertex[1]], start);
    bool has_faces = edge->face[0] >= 0;
    pe_vec3 m = has_faces ? pair->a.faces[edge->face[0]].normal : pe_v3(0, 0, 0);
    pe_vec3 n = has_faces ? pair->a.faces[edge->face[1]].normal : m;
    double along2 = pe_dot(along, along);
    for (int k = 0; k < count; ++k) {
        const seen_edge *other = &chunk[k];
        /* The arcs meet where either one's ends lie on both sides of the other's plane, and on the
         * same half of the sphere. */
        double mb = pe_dot(m, other->along), nb = pe_dot(n, other->along);
        double ma = pe_dot(other->normal[0], along), na = pe_dot(other->normal[1], along);
        if ((has_faces && mb * nb >= 0) || (other->has_faces && ma * na >= 0) ||
            (has_faces && other->has_faces && ma * nb >= 0)) {
            continue;
        }
        bool positive = has_faces ? mb > 0 : ma > 0;
        pe_vec3 cross = pe_scale(positive ? 1 : -1, pe_cross(along, other->along));
        double square = pe_dot(cross, cross), whole = along2 * other->along2;
        double s = pe_dot(cross, pe_sub(other->start, start));
        bool nearly_parallel = square < SMALL_SINE * SMALL_SINE * whole;
        if (square <= LEAST_SINE * LEAST_SINE * whole ||
            (!nearly_parallel && !quotient_exceeds(s, square, best->distance + tie))) {
            continue;
        }
        pe_vec3 normal = pe_scale(1 / sqrt(square), cross);
        double distance =
            nearly_parallel ? pe_polytope_separation_along(pair, normal) : s / sqrt(square);
        if (distance > limit) {
            return false;
        }
        if (distance > best->distance + tie) {
            *best = (pe_separation){distance, normal, PE_OF_EDGES, .a = i, .b = other->index};
        }
    }
    return true;
}

bool pe_polytope_best_edges(const pe_polytope_pair *pair, double limit, pe_separation *best)
{
    const pe_polytope *a = &pair->a;
    double tie = TIE * pair->size;
    pe_vec3 on_b = place(&pair->a_from_b, best->on_b);
    const inside of_a = points_of(a, &pair->a_from_b, best->on_a, 0.01 * tie);
    const inside of_b = points_of(&pair->b, &pair->b_from_a, on_b, 0.01 * tie);
    for (int next = 0; next < pair->b.edge_count && a->edge_count > 0;) {
        seen_edge chunk[CHUNK];
        int count = gather(pair, &of_a, best->distance + tie, &next, chunk);
        for (int i = 0; i < a->edge_count && count > 0; ++i) {
            if (may_separate(a, &a->edges[i], &of_b, best->distance + tie) &&
                !try_edge(pair, i, chunk, count, limit, tie, best)) {
                return false;
            }
        }
    }
    return true;
}
