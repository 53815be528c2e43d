/* The cost of finding the near triangles of two meshes, with trees of different bounding volumes.
 *
 *   bench_mesh_tree [PAIRS]        default 200 for each row; prints Markdown
 *
 * Boxes along the body's axes (one rotation serves all pairs of boxes), oriented boxes fitted by
 * principal components (Gottschalk, Lin, Manocha 1996), and flat discs: a middle, the mean normal,
 * a thickness along it and a radius. All trees are split in the same way, by number along the
 * longest extent, and get the same query: every pair of leaves that may come within a margin of
 * each other. The meshes are bumpy balls and tori at random orientations, at given distances. Times
 * are medians of interleaved runs (A B C A B C). A triangle pair is one that the volumes did not
 * separate. */
#define _POSIX_C_SOURCE 199309L

#include "model/geometry_build.h"
#include "narrow_phase/mesh/near_features.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef enum volume { BODY_BOX, ORIENTED_BOX, DISC, VOLUME_COUNT } volume;
static const char *const volume_names[VOLUME_COUNT] = {"box along the body's axes", "oriented box",
                                                       "disc"};

typedef struct node {
    pe_vec3 centre, half, normal; /* disc: half = (radius, thickness, 0) */
    pe_mat3 axes;
    double radius;
    int right, first, count;
} node;

typedef struct tree {
    node *nodes;
    int count, *order;
} tree;

typedef struct counts {
    double volume_tests, triangle_pairs;
} counts;

/* ---- Building ---- */

static pe_vec3 corner(const pe_geometry *g, const int *order, int i)
{
    return g->vertices[g->triangles[order[i / 3]][i % 3]];
}

static pe_mat3 principal_axes(const pe_geometry *g, const int *order, int count)
{
    pe_vec3 mean = pe_v3(0, 0, 0);
    for (int i = 0; i < 3 * count; ++i) {
        mean = pe_madd(mean, 1.0 / (3 * count), corner(g, order, i));
    }
    double a[3][3] = {{0}}, axes[3][3];
    for (int i = 0; i < 3 * count; ++i) {
        pe_vec3 d = pe_sub(corner(g, order, i), mean);
        const double x[3] = {d.x, d.y, d.z};
        for (int k = 0; k < 9; ++k) {
            a[k / 3][k % 3] += x[k / 3] * x[k % 3];
        }
    }
    pe_principal_axes(a, axes);
    return (pe_mat3){{axes[0][0], axes[1][0], axes[2][0]},
                     {axes[0][1], axes[1][1], axes[2][1]},
                     {axes[0][2], axes[1][2], axes[2][2]}};
}

static void fit_box(const pe_geometry *g, const int *order, node *n)
{
    pe_vec3 low = pe_v3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = pe_scale(-1, low);
    for (int i = 0; i < 3 * n->count; ++i) {
        pe_vec3 x = pe_rotate(&n->axes, corner(g, order, i));
        low = pe_v3(pe_min(low.x, x.x), pe_min(low.y, x.y), pe_min(low.z, x.z));
        high = pe_v3(pe_max(high.x, x.x), pe_max(high.y, x.y), pe_max(high.z, x.z));
    }
    n->centre = pe_unrotate(&n->axes, pe_scale(0.5, pe_add(low, high)));
    n->half = pe_scale(0.5, pe_sub(high, low));
    n->radius = pe_length(n->half);
}

static void fit_disc(const pe_geometry *g, const int *order, node *n)
{
    pe_vec3 sum = pe_v3(0, 0, 0);
    for (int i = 0; i < n->count; ++i) {
        pe_vec3 a = corner(g, order, 3 * i);
        sum = pe_add(sum, pe_cross(pe_sub(corner(g, order, 3 * i + 1), a),
                                   pe_sub(corner(g, order, 3 * i + 2), a)));
    }
    double length = pe_length(sum);
    n->normal = length > 0 ? pe_scale(1 / length, sum) : pe_v3(0, 0, 1);
    double low = HUGE_VAL, high = -HUGE_VAL, r2 = 0, s2 = 0;
    for (int i = 0; i < 3 * n->count; ++i) {
        double h = pe_dot(n->normal, pe_sub(corner(g, order, i), n->centre));
        low = pe_min(low, h);
        high = pe_max(high, h);
    }
    n->centre = pe_madd(n->centre, 0.5 * (low + high), n->normal);
    for (int i = 0; i < 3 * n->count; ++i) {
        pe_vec3 d = pe_sub(corner(g, order, i), n->centre);
        double h = pe_dot(n->normal, d);
        r2 = pe_max(r2, pe_dot(d, d) - h * h);
        s2 = pe_max(s2, pe_dot(d, d));
    }
    n->half = pe_v3(sqrt(r2), 0.5 * (high - low), 0);
    n->radius = sqrt(s2);
}

static const pe_geometry *sorted_geometry;
static pe_vec3 sorted_axis;

static double key_of(int triangle)
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        sum +=
            pe_dot(sorted_axis, sorted_geometry->vertices[sorted_geometry->triangles[triangle][k]]);
    }
    return sum;
}

static int by_key(const void *a, const void *b)
{
    double p = key_of(*(const int *)a), q = key_of(*(const int *)b);
    return p < q ? -1 : p > q;
}

static void build(const pe_geometry *g, volume v, int leaf, tree *t, int first, int count)
{
    int index = t->count++, *order = t->order + first;
    node *n = &t->nodes[index];
    *n = (node){.right = -1, .first = first, .count = count};
    n->axes = principal_axes(g, order, count);
    fit_box(g, order, n);
    pe_vec3 h = n->half;
    sorted_geometry = g;
    sorted_axis = h.x >= h.y && h.x >= h.z ? n->axes.r0 : h.y >= h.z ? n->axes.r1 : n->axes.r2;
    if (v == BODY_BOX) {
        n->axes = (pe_mat3){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        fit_box(g, order, n);
    } else if (v == DISC) {
        fit_disc(g, order, n);
    }
    if (count > leaf) {
        qsort(order, (size_t)count, sizeof *order, by_key);
        build(g, v, leaf, t, first, count / 2);
        t->nodes[index].right = t->count;
        build(g, v, leaf, t, first + count / 2, count - count / 2);
    }
}

static tree make_tree(const pe_geometry *g, volume v, int leaf)
{
    size_t n = (size_t)g->triangle_count;
    tree t = {.nodes = malloc(2 * n * sizeof *t.nodes), .order = malloc(n * sizeof *t.order)};
    if (t.nodes == NULL || t.order == NULL) {
        fprintf(stderr, "bench_mesh_tree: out of memory\n");
        exit(1);
    }
    for (int i = 0; i < g->triangle_count; ++i) {
        t.order[i] = i;
    }
    build(g, v, leaf, &t, 0, g->triangle_count);
    return t;
}

/* ---- Tests: whether two volumes may be within the margin ---- */

typedef struct relative {
    pe_mat3 turn, reach;
    pe_vec3 offset;
    double margin;
} relative;

static pe_vec3 between(const relative *r, const node *a, const node *b)
{
    return pe_sub(pe_add(pe_rotate(&r->turn, a->centre), r->offset), b->centre);
}

static bool body_boxes_near(const relative *r, const node *a, const node *b)
{
    double limit2 = r->margin * r->margin;
    pe_vec3 c = between(r, a, b);
    if (pe_square_to_box(c, pe_add(pe_rotate(&r->reach, a->half), b->half)) > limit2) {
        return false;
    }
    pe_vec3 half = pe_add(pe_unrotate(&r->reach, b->half), a->half);
    return pe_square_to_box(pe_unrotate(&r->turn, c), half) <= limit2;
}

static bool oriented_boxes_near(const relative *r, const node *a, const node *b)
{
    pe_vec3 c = between(r, a, b);
    double near = a->radius + b->radius + r->margin, limit2 = r->margin * r->margin;
    if (pe_dot(c, c) > near * near) {
        return false;
    }
    pe_vec3 x = pe_rotate(&b->axes, pe_rotate(&r->turn, a->axes.r0));
    pe_vec3 y = pe_rotate(&b->axes, pe_rotate(&r->turn, a->axes.r1));
    pe_vec3 z = pe_rotate(&b->axes, pe_rotate(&r->turn, a->axes.r2));
    pe_vec3 ax = pe_absolute(x), ay = pe_absolute(y), az = pe_absolute(z), ha = a->half,
            hb = b->half;
    c = pe_rotate(&b->axes, c);
    if (pe_square_to_box(c, pe_madd(pe_madd(pe_madd(hb, ha.x, ax), ha.y, ay), ha.z, az)) > limit2) {
        return false;
    }
    pe_vec3 half = pe_add(ha, pe_v3(pe_dot(ax, hb), pe_dot(ay, hb), pe_dot(az, hb)));
    return pe_square_to_box(pe_v3(pe_dot(x, c), pe_dot(y, c), pe_dot(z, c)), half) <= limit2;
}

static bool discs_near(const relative *r, const node *a, const node *b)
{
    pe_vec3 c = between(r, a, b);
    double near = a->radius + b->radius + r->margin;
    if (pe_dot(c, c) > near * near) {
        return false;
    }
    pe_vec3 n = pe_rotate(&r->turn, a->normal);
    double cosine = fabs(pe_dot(n, b->normal)), sine = sqrt(pe_max(0, 1 - cosine * cosine));
    return fabs(pe_dot(n, c)) <= a->half.y + b->half.x * sine + b->half.y * cosine + r->margin &&
           fabs(pe_dot(b->normal, c)) <=
               b->half.y + a->half.x * sine + a->half.y * cosine + r->margin;
}

static bool near(volume v, const relative *r, const node *a, const node *b)
{
    return v == BODY_BOX       ? body_boxes_near(r, a, b)
           : v == ORIENTED_BOX ? oriented_boxes_near(r, a, b)
                               : discs_near(r, a, b);
}

static void count_pairs(volume v, const relative *r, const tree *ta, const tree *tb, counts *n)
{
    int stack[128][2] = {{0, 0}}, depth = 1;
    while (depth > 0) {
        int i = stack[--depth][0], j = stack[depth][1];
        const node *a = &ta->nodes[i], *b = &tb->nodes[j];
        n->volume_tests += 1;
        if (!near(v, r, a, b)) {
            continue;
        }
        if (a->right < 0 && b->right < 0) {
            n->triangle_pairs += a->count * b->count;
        } else if (b->right < 0 || (a->right >= 0 && a->radius >= b->radius)) {
            stack[depth][0] = i + 1, stack[depth++][1] = j;
            stack[depth][0] = a->right, stack[depth++][1] = j;
        } else {
            stack[depth][0] = i, stack[depth++][1] = j + 1;
            stack[depth][0] = i, stack[depth++][1] = b->right;
        }
    }
}

/* ---- Meshes and poses ---- */

static pe_geometry *finish(pe_vec3 *vertices, int vertex_count, uint32_t (*triangles)[3], int count)
{
    pe_geometry_def def = {vertices, (const uint32_t(*)[3])triangles, vertex_count, count, false};
    pe_allocator allocator = pe_allocator_default();
    pe_geometry *g = NULL;
    pe_error error;
    if (pe_geometry_make(&def, &allocator, &g, &error) != PE_OK) {
        fprintf(stderr, "bench_mesh_tree: %s\n", error.message);
        exit(1);
    }
    free(vertices);
    free(triangles);
    return g;
}

/* A grid of n x m corners wrapped both ways; `ball` pinches it to a bumpy ball of 1 m, else it is a
 * torus of 1 m across. */
static pe_geometry *make_mesh(int n, int m, bool ball)
{
    static const double pi = 3.141592653589793;
    int count = n * m + (ball ? 2 : 0), faces = 0;
    pe_vec3 *v = malloc((size_t)count * sizeof *v);
    uint32_t(*t)[3] = malloc((size_t)(2 * n * (m + 1)) * sizeof *t);
    if (v == NULL || t == NULL) {
        fprintf(stderr, "bench_mesh_tree: out of memory\n");
        exit(1);
    }
    for (int i = 0; i < n * m; ++i) {
        double u = 2 * pi * (i / m) / n;
        double w = ball ? pi * (i % m + 1) / (m + 1) : 2 * pi * (i % m) / m;
        double bump = 1 + 0.15 * sin(3 * u) * sin(w) * sin(2 * w);
        double r = ball ? 0.5 * bump * sin(w) : 0.35 + 0.15 * cos(w);
        v[i] = pe_v3(r * cos(u), r * sin(u), ball ? 0.5 * bump * cos(w) : -0.15 * sin(w));
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < (ball ? m - 1 : m); ++j) {
            uint32_t p = (uint32_t)(i * m + j), q = (uint32_t)(i * m + (j + 1) % m);
            uint32_t s = (uint32_t)((i + 1) % n * m + j);
            uint32_t o = (uint32_t)((i + 1) % n * m + (j + 1) % m);
            t[faces][0] = p, t[faces][1] = q, t[faces++][2] = o;
            t[faces][0] = p, t[faces][1] = o, t[faces++][2] = s;
        }
        if (ball) {
            uint32_t top = (uint32_t)(n * m), p = (uint32_t)(i * m),
                     s = (uint32_t)((i + 1) % n * m);
            t[faces][0] = top, t[faces][1] = p, t[faces++][2] = s;
            t[faces][0] = top + 1, t[faces][1] = s + (uint32_t)m - 1;
            t[faces++][2] = p + (uint32_t)m - 1;
        }
    }
    if (ball) {
        v[n * m] = pe_v3(0, 0, 0.5);
        v[n * m + 1] = pe_v3(0, 0, -0.5);
    }
    return finish(v, count, t, faces);
}

static uint64_t random_state = 88172645463325252u;

/* xorshift64*, Vigna 2016. */
static double uniform(double low, double high)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    double x = (double)((random_state * 2685821657736338717u) >> 11) * 0x1p-53;
    return low + x * (high - low);
}

static pe_pose random_pose(pe_vec3 x)
{
    pe_quat q = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    q = pe_quat_unit(q);
    return (pe_pose){x, q, pe_matrix_of(q)};
}

/* Two copies of the mesh with a gap of at least `gap`, within a thousandth. */
static relative random_pair(const pe_geometry *g, double gap, double margin)
{
    pe_shape shape = {.kind = PE_SHAPE_MESH};
    pe_vec3 d = pe_v3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    d = pe_scale(1 / pe_length(d), d);
    pe_pose a = random_pose(pe_v3(0, 0, 0)), b = random_pose(d);
    double low = 0, high = 1.2 + gap;
    pe_solid_pair pair;
    while (high - low > 1e-3) {
        double middle = 0.5 * (low + high);
        b.position = pe_scale(middle, d);
        pe_solid_pair_make((pe_placed){&shape, g, &a, g->size}, (pe_placed){&shape, g, &b, g->size},
                           &pair);
        pe_nearest nearest = pe_solids_nearest(&pair, HUGE_VAL);
        bool apart = !nearest.cross && !nearest.inside && nearest.distance >= gap;
        *(apart ? &high : &low) = middle;
    }
    b.position = pe_scale(high, d);
    pe_solid_pair_make((pe_placed){&shape, g, &a, g->size}, (pe_placed){&shape, g, &b, g->size},
                       &pair);
    pe_mat3 turn = pair.trees.a_in_b.turn;
    return (relative){turn,
                      {pe_absolute(turn.r0), pe_absolute(turn.r1), pe_absolute(turn.r2)},
                      pair.trees.a_in_b.offset,
                      margin};
}

/* ---- Measuring ---- */

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_value(const void *a, const void *b)
{
    double p = *(const double *)a, q = *(const double *)b;
    return p < q ? -1 : p > q;
}

enum { ROUNDS = 21 };

static void measure(const char *name, const pe_geometry *g, int leaf, double gap, double margin,
                    int pairs)
{
    relative *list = malloc((size_t)pairs * sizeof *list);
    if (list == NULL) {
        fprintf(stderr, "bench_mesh_tree: out of memory\n");
        exit(1);
    }
    for (int i = 0; i < pairs; ++i) {
        list[i] = random_pair(g, gap, margin);
    }
    tree trees[VOLUME_COUNT];
    double seconds[VOLUME_COUNT][ROUNDS];
    counts n[VOLUME_COUNT];
    for (int v = 0; v < VOLUME_COUNT; ++v) {
        trees[v] = make_tree(g, (volume)v, leaf);
    }
    for (int round = 0; round < ROUNDS; ++round) {
        for (int v = 0; v < VOLUME_COUNT; ++v) {
            double start = cpu_seconds();
            n[v] = (counts){0};
            for (int i = 0; i < pairs; ++i) {
                count_pairs((volume)v, &list[i], &trees[v], &trees[v], &n[v]);
            }
            seconds[v][round] = cpu_seconds() - start;
        }
    }
    for (int v = 0; v < VOLUME_COUNT; ++v) {
        qsort(seconds[v], ROUNDS, sizeof seconds[v][0], by_value);
    }
    for (int v = 0; v < VOLUME_COUNT; ++v) {
        printf("| %s, %d | %g mm, %g mm | %d | %s | %.0f | %.1f | %.2f |\n", name,
               g->triangle_count, 1e3 * gap, 1e3 * margin, leaf, volume_names[v],
               n[v].volume_tests / pairs, n[v].triangle_pairs / pairs,
               seconds[v][ROUNDS / 2] / seconds[BODY_BOX][ROUNDS / 2]);
        free(trees[v].nodes);
        free(trees[v].order);
    }
    free(list);
}

int main(int argc, char **argv)
{
    int pairs = argc > 1 ? atoi(argv[1]) : 200;
    static const struct {
        const char *name;
        int n, m;
        bool ball;
    } meshes[] = {{"ball", 18, 14, true},
                  {"torus", 25, 10, false},
                  {"ball", 60, 41, true},
                  {"torus", 100, 25, false}};
    static const double gaps[][2] = {{0.03, 0.01}, {0.001, 0.005}, {0.001, 0.02}};
    printf("| mesh, triangles | gap, margin | leaf | volume | tests | triangle pairs | time |\n"
           "|---|---|---:|---|---:|---:|---:|\n");
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; ++i) {
        pe_geometry *g = make_mesh(meshes[i].n, meshes[i].m, meshes[i].ball);
        for (size_t k = 0; k < sizeof gaps / sizeof *gaps; ++k) {
            for (int leaf = 1; leaf <= 4; leaf *= 2) {
                measure(meshes[i].name, g, leaf, gaps[k][0], gaps[k][1], pairs);
            }
        }
        pe_allocator allocator = pe_allocator_default();
        pe_geometry_free(g, &allocator);
    }
    return 0;
}
