#include "convex_truth.h"

enum { NODES = 10000, CELLS = 20000 };

/* A direction and what M has there, without its ball. */
typedef struct node {
    pe_vec3 d, p;
    double f;
} node;

typedef struct cell {
    double bound; /* f is no lower on it */
    int corner[3];
} cell;

typedef struct search {
    const truth_difference *m;
    node nodes[NODES];
    int node_count;
    cell heap[CELLS]; /* the lowest bound first */
    int cell_count;
    double best; /* the least f seen */
    pe_vec3 best_direction;
    double nearest; /* the least |p| of points of M seen: no more than that apart */
    pe_vec3 nearest_point, nearest_triangle[3];
} search;

static void add_solid(truth_difference *m, truth_solid solid, double sign)
{
    const pe_shape *shape = solid.shape;
    pe_vec3 z = pe_axis(&solid.pose->rotation, 2);
    switch (shape->kind) {
    case PE_SHAPE_BOX:
        for (int k = 0; k < 3; ++k) {
            m->segment[m->segment_count++] =
                pe_scale(pe_component(shape->half_extents, k), pe_axis(&solid.pose->rotation, k));
        }
        break;
    case PE_SHAPE_CYLINDER:
        m->disc[m->disc_count][0] = pe_axis(&solid.pose->rotation, 0);
        m->disc[m->disc_count][1] = pe_axis(&solid.pose->rotation, 1);
        m->disc_radius[m->disc_count++] = shape->radius;
        m->segment[m->segment_count++] = pe_scale(shape->half_height, z);
        break;
    case PE_SHAPE_CAPSULE:
        m->segment[m->segment_count++] = pe_scale(shape->half_height, z);
        m->ball += shape->radius;
        break;
    case PE_SHAPE_SPHERE:
        m->ball += shape->radius;
        break;
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        m->hull[m->hull_count].vertices = solid.vertices;
        m->hull[m->hull_count].count = solid.vertex_count;
        m->hull[m->hull_count].rotation = &solid.pose->rotation;
        m->hull[m->hull_count++].sign = sign;
        break;
    case PE_SHAPE_PLANE:
    case PE_SHAPE_COUNT:
        break;
    }
}

truth_difference truth_subtract(truth_solid a, truth_solid b)
{
    truth_difference m = {.centre = pe_sub(a.pose->position, b.pose->position)};
    add_solid(&m, a, 1);
    add_solid(&m, b, -1);
    return m;
}

double truth_support(const truth_difference *m, pe_vec3 n, pe_vec3 *point)
{
    pe_vec3 p = m->centre;
    for (int i = 0; i < m->segment_count; ++i) {
        p = pe_madd(p, pe_dot(n, m->segment[i]) < 0 ? -1 : 1, m->segment[i]);
    }
    for (int i = 0; i < m->disc_count; ++i) {
        /* By two vectors of its plane: what is left of n across the axis may point anywhere. */
        const pe_vec3 *e = m->disc[i];
        double x = pe_dot(n, e[0]), y = pe_dot(n, e[1]), length = sqrt(x * x + y * y);
        double scale = length > 0 ? m->disc_radius[i] / length : 0;
        p = pe_madd(pe_madd(p, scale * x, e[0]), scale * y, e[1]);
    }
    for (int i = 0; i < m->hull_count; ++i) {
        pe_vec3 d = pe_scale(m->hull[i].sign, pe_unrotate(m->hull[i].rotation, n));
        int best = 0;
        double most = -HUGE_VAL;
        for (int j = 0; j < m->hull[i].count; ++j) {
            double height = pe_dot(d, m->hull[i].vertices[j]);
            best = height > most ? j : best;
            most = height > most ? height : most;
        }
        p = pe_madd(p, m->hull[i].sign, pe_rotate(m->hull[i].rotation, m->hull[i].vertices[best]));
    }
    if (point != NULL) {
        *point = p;
    }
    return pe_dot(n, p) + m->ball;
}

/* Looks along d, which need not be unit; returns the node. */
static node look(search *s, pe_vec3 d)
{
    node found = {.d = pe_scale(1 / pe_length(d), d)};
    found.f = truth_support(s->m, found.d, &found.p) - s->m->ball;
    if (found.f < s->best) {
        s->best = found.f;
        s->best_direction = found.d;
    }
    return found;
}

static int add_node(search *s, node found)
{
    s->nodes[s->node_count] = found;
    return s->node_count++;
}

/* Least of the three heights of the combination of columns. */
static double least_row(double g[3][3], const double weight[3])
{
    double least = HUGE_VAL;
    for (int r = 0; r < 3; ++r) {
        least = pe_min(least, g[r][0] * weight[0] + g[r][1] * weight[1] + g[r][2] * weight[2]);
    }
    return least;
}

/* The best of the combinations of two columns: where two rows cross. */
static double best_of_pairs(double g[3][3])
{
    double best = -HUGE_VAL;
    for (int a = 0; a < 3; ++a) {
        double weight[3] = {0, 0, 0};
        weight[a] = 1;
        best = pe_max(best, least_row(g, weight));
        int b = (a + 1) % 3;
        for (int r = 0; r < 3; ++r) {
            int q = (r + 1) % 3;
            double at_a = g[r][a] - g[q][a], at_b = g[r][b] - g[q][b];
            if (at_a * at_b < 0) {
                double pair[3] = {0, 0, 0};
                pair[b] = at_a / (at_a - at_b);
                pair[a] = 1 - pair[b];
                best = pe_max(best, least_row(g, pair));
            }
        }
    }
    return best;
}

/* The least height of the three directions along u. */
static double least_height(const node *const n[3], pe_vec3 u)
{
    double least = pe_min(pe_dot(u, n[0]->d), pe_min(pe_dot(u, n[1]->d), pe_dot(u, n[2]->d)));
    return least / pe_length(u);
}

/* A lower bound of rho, positive on cells of less than a half sphere however flat they are: what
 * the directions have in common along any unit vector is one. */
static double reach_of_plane(const node *const n[3], pe_vec3 w)
{
    double reach = 1e-9;
    for (int i = 0; i < 3; ++i) {
        double middle = least_height(n, pe_add(n[i]->d, n[(i + 1) % 3]->d));
        reach = middle > reach ? middle : reach; /* also where it is no number */
    }
    double plane = fabs(least_height(n, w));
    return plane > reach ? plane : reach;
}

/* Value of the game: rows are directions, columns points. */
static double bound_of(const search *s, const int corner[3])
{
    const node *n[3] = {&s->nodes[corner[0]], &s->nodes[corner[1]], &s->nodes[corner[2]]};
    double g[3][3];
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            g[r][c] = pe_dot(n[r]->d, n[c]->p);
        }
    }
    /* Fully mixed: where the normal of the directions' plane meets the plane of the points. */
    pe_vec3 w = pe_cross(pe_sub(n[1]->d, n[0]->d), pe_sub(n[2]->d, n[0]->d));
    double weight[3], sum = 0;
    bool inside = true;
    for (int c = 0; c < 3; ++c) {
        weight[c] = pe_dot(w, pe_cross(n[(c + 1) % 3]->p, n[(c + 2) % 3]->p));
        sum += weight[c];
    }
    for (int c = 0; c < 3; ++c) {
        weight[c] /= sum;
        inside = inside && weight[c] >= 0;
    }
    double value = inside ? least_row(g, weight) : best_of_pairs(g);
    return value >= 0 ? value : value / reach_of_plane(n, w);
}

static void push(search *s, int i, int j, int k)
{
    cell c = {.corner = {i, j, k}};
    c.bound = bound_of(s, c.corner);
    int at = s->cell_count++;
    for (; at > 0 && s->heap[(at - 1) / 2].bound > c.bound; at = (at - 1) / 2) {
        s->heap[at] = s->heap[(at - 1) / 2];
    }
    s->heap[at] = c;
}

static cell pop(search *s)
{
    cell top = s->heap[0], last = s->heap[--s->cell_count];
    int at = 0;
    for (int child = 1; child < s->cell_count; child = 2 * at + 1) {
        child += child + 1 < s->cell_count && s->heap[child + 1].bound < s->heap[child].bound;
        if (s->heap[child].bound >= last.bound) {
            break;
        }
        s->heap[at] = s->heap[child];
        at = child;
    }
    s->heap[at] = last;
    return top;
}

static bool is_inside(const search *s, const int c[3], pe_vec3 d)
{
    const node *n = s->nodes;
    pe_vec3 a = n[c[0]].d, b = n[c[1]].d, e = n[c[2]].d;
    double x = pe_dot(d, pe_cross(b, e)), y = pe_dot(d, pe_cross(e, a)),
           z = pe_dot(d, pe_cross(a, b)), least = 0.02 * (x + y + z);
    return x > least && y > least && z > least;
}

/* The point nearest to the origin of the segment p q. */
static pe_vec3 nearest_of_segment(pe_vec3 p, pe_vec3 q)
{
    pe_vec3 side = pe_sub(q, p);
    double length2 = pe_dot(side, side), t = length2 > 0 ? -pe_dot(p, side) / length2 : 0;
    return pe_madd(p, pe_min(1, pe_max(0, t)), side);
}

/* Whether the triangle of points of M is nearer to the origin than any before; then it is kept. */
static bool comes_nearer(search *s, pe_vec3 a, pe_vec3 b, pe_vec3 c)
{
    const pe_vec3 v[3] = {a, b, c};
    pe_vec3 w = pe_cross(pe_sub(b, a), pe_sub(c, a)), nearest = a;
    double wa = pe_dot(w, pe_cross(b, c)), wb = pe_dot(w, pe_cross(c, a)),
           wc = pe_dot(w, pe_cross(a, b));
    if (wa > 0 && wb > 0 && wc > 0) {
        /* Uses its weights: however inexact they are, the combined point lies in M. */
        double sum = wa + wb + wc;
        nearest = pe_madd(pe_madd(pe_scale(wa / sum, a), wb / sum, b), wc / sum, c);
    } else {
        for (int i = 0; i < 3; ++i) {
            pe_vec3 p = nearest_of_segment(v[i], v[(i + 1) % 3]);
            nearest = pe_dot(p, p) < pe_dot(nearest, nearest) ? p : nearest;
        }
    }
    double distance = pe_length(nearest);
    if (distance >= s->nearest) {
        return false;
    }
    s->nearest = distance;
    s->nearest_point = nearest;
    for (int i = 0; i < 3; ++i) {
        s->nearest_triangle[i] = v[i];
    }
    return true;
}

/* Apart, the point of M nearest to the origin lies against the normal: look there, and go on from
 * the triangles that what is seen makes with the last one (Gilbert, Johnson and Keerthi 1988). */
static void walk_nearer(search *s)
{
    bool better = true;
    for (int i = 0; better && i < 100; ++i) {
        pe_vec3 last[3] = {s->nearest_triangle[0], s->nearest_triangle[1], s->nearest_triangle[2]};
        pe_vec3 p = look(s, pe_scale(-1, s->nearest_point)).p;
        better = false;
        for (int k = 0; k < 3; ++k) {
            better = comes_nearer(s, p, last[k], last[(k + 1) % 3]) || better;
        }
    }
}

/* Splits at the normal of the plane of the support points where the cell has it: of a polytope's
 * face that settles the matter; else at the middle of the longest side. */
static void split(search *s, const int c[3])
{
    const node *n[3] = {&s->nodes[c[0]], &s->nodes[c[1]], &s->nodes[c[2]]};
    if (s->best < 0 && comes_nearer(s, n[0]->p, n[1]->p, n[2]->p)) {
        walk_nearer(s);
    }
    pe_vec3 normal = pe_cross(pe_sub(n[1]->p, n[0]->p), pe_sub(n[2]->p, n[0]->p));
    double length = pe_length(normal);
    normal = pe_dot(normal, pe_add(n[0]->d, pe_add(n[1]->d, n[2]->d))) < 0 ? pe_scale(-1, normal)
                                                                           : normal;
    if (length > 0 && pe_dot(normal, n[0]->p) < s->best * length) {
        node found = look(s, normal);
        if (is_inside(s, c, normal)) {
            int k = add_node(s, found);
            push(s, c[0], c[1], k);
            push(s, c[1], c[2], k);
            push(s, c[2], c[0], k);
            return;
        }
    }
    int longest = 0;
    double most = 0;
    for (int i = 0; i < 3; ++i) {
        double side = pe_length(pe_sub(n[(i + 1) % 3]->d, n[i]->d));
        longest = side > most ? i : longest;
        most = pe_max(most, side);
    }
    int i = c[longest], j = c[(longest + 1) % 3], k = c[(longest + 2) % 3];
    int middle = add_node(s, look(s, pe_add(s->nodes[i].d, s->nodes[j].d)));
    push(s, i, middle, k);
    push(s, middle, j, k);
}

truth_distance truth_signed_distance(const truth_difference *m, double tolerance)
{
    search s;
    s.m = m;
    s.node_count = s.cell_count = 0;
    s.best = s.nearest = HUGE_VAL;
    s.best_direction = pe_v3(0, 0, 1);
    for (int k = 0; k < 3; ++k) {
        pe_vec3 e = k == 0 ? pe_v3(1, 0, 0) : k == 1 ? pe_v3(0, 1, 0) : pe_v3(0, 0, 1);
        add_node(&s, look(&s, e));
        add_node(&s, look(&s, pe_scale(-1, e)));
    }
    for (int octant = 0; octant < 8; ++octant) {
        push(&s, octant & 1, 2 + (octant >> 1 & 1), 4 + (octant >> 2));
    }
    while (s.heap[0].bound < s.best - tolerance && s.nearest + s.best > tolerance &&
           s.node_count < NODES && s.cell_count < CELLS - 3) {
        cell c = pop(&s);
        split(&s, c.corner);
    }
    return (truth_distance){
        .low = -s.best - m->ball,
        .high = pe_min(s.nearest, -pe_min(s.best, s.heap[0].bound)) - m->ball,
        .normal = s.best_direction,
        .supports = s.node_count,
    };
}
