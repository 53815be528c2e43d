/* What finding the pairs costs: CPU time per body of four ways, relative to the engine's, and what
 * a test of bounding spheres before the narrow phase would save.
 *
 *   bench_broad_phase [MOST_BODIES]        default 50000; prints Markdown
 *
 * Every way sees the same poses in the same order, all of them at each step in turn (A B C D, A B C
 * D), and the table has the medians over the steps. The benchmark moves the bodies, either not at
 * all or freely, so that no solver matters. The pairs of each way must contain all pairs that the
 * narrow phase finds within their margin. */
#define _POSIX_C_SOURCE 199309L

#include "model/integrate.h"
#include "model/shape.h"
#include "narrow_phase/collide.h"
#include "rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double DT = 1.0 / 60;
enum { MOST_STEPS = 120, MOST_BRUTE = 10000 };

/* ---- Scenes ---- */

typedef struct scene {
    const char *name;
    void (*place)(int i, int n, pe_body_def *def);
} scene;

/* In 0 .. 1: the low bits of a hash (Steele and others 2014, its last step). */
static double chance(int i, int k)
{
    uint64_t z =
        (uint64_t)i * UINT64_C(0x9e3779b97f4a7c15) + (uint64_t)k * UINT64_C(0xd1b54a32d192ed03);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static int least_root(int n, int power)
{
    int k = 1;
    while ((power == 2 ? (double)k * k : (double)k * k * k) < n) {
        ++k;
    }
    return k;
}

static void place_block(int i, int n, pe_body_def *def)
{
    int k = least_root(n, 2);
    def->position = pe_v3(1.5 * (i % k), 1.5 * (i / k), 0.5);
}

static void place_brick(int i, int n, pe_body_def *def)
{
    int k = least_root(n, 2);
    def->position = pe_v3(i % k + 0.5 * (i / k % 2), 0, 0.5 + i / k);
}

/* The last one flies low over the others. */
static void place_fast(int i, int n, pe_body_def *def)
{
    place_block(i, n, def);
    if (i == n - 1) {
        def->position = pe_v3(0, 0, 1.6);
        def->velocity = pe_v3(20, 15, 0);
    }
}

/* Spread at random about a grid of 2 m, and let go with speeds of up to 2 m/s. */
static void place_drop(int i, int n, pe_body_def *def)
{
    int k = least_root(n, 3);
    def->position = pe_v3(2 * (i % k) + chance(i, 0), 2 * (i / k % k) + chance(i, 1),
                          30 + 2 * (i / k / k) + chance(i, 2));
    def->velocity = pe_v3(4 * chance(i, 3) - 2, 4 * chance(i, 4) - 2, 4 * chance(i, 5) - 2);
    def->angular_velocity = pe_v3(4 * chance(i, 6) - 2, 4 * chance(i, 7) - 2, 1);
}

static const scene SCENES[] = {
    {"blocks at rest on the floor", place_block},
    {"wall at rest", place_brick},
    {"one fast body over blocks at rest", place_fast},
    {"falling cloud", place_drop},
};

static void require(pe_status status, const pe_error *error)
{
    if (status != PE_OK) {
        fprintf(stderr, "bench_broad_phase: %s\n", error->message);
        exit(1);
    }
}

static pe_world *make_scene(const scene *s, int n)
{
    pe_error error;
    pe_world *world;
    pe_world_def world_def = pe_world_def_default();
    require(pe_world_create(&world_def, &world, &error), &error);
    pe_body_id id;
    pe_body_def floor_def = pe_body_def_default();
    floor_def.is_static = true;
    floor_def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    require(pe_body_create(world, &floor_def, &id, &error), &error);
    for (int i = 0; i < n; ++i) {
        pe_body_def def = pe_body_def_default();
        def.shape = (pe_shape){.kind = PE_SHAPE_BOX, .half_extents = {0.5, 0.5, 0.5}};
        s->place(i, n, &def);
        require(pe_body_create(world, &def, &id, &error), &error);
    }
    return world;
}

static void move_bodies(pe_world *world)
{
    for (int slot = 1; slot < world->slot_count; ++slot) {
        const pe_twist *motion = &pe_twists(world)[slot];
        pe_pose_move(&pe_poses(world)[slot], pe_scale(DT, motion->velocity),
                     pe_scale(DT, motion->angular_velocity));
    }
}

/* ---- Ways ---- */

typedef struct bench {
    pe_world *world;
    int *order, order_count; /* of the rows */
} bench;

typedef pe_status way(bench *b, pe_pair **pairs, int *count, pe_error *error);

/* The source paper's: all pairs, by the distance of their centres. */
static bool spheres_meet(const pe_world *world, int a, int b, double slack)
{
    const pe_body *body = &pe_bodies(world)[a], *other = &pe_bodies(world)[b];
    const pe_twist *ma = &pe_twists(world)[a], *mb = &pe_twists(world)[b];
    pe_vec3 x = pe_poses(world)[a].position, y = pe_poses(world)[b].position;
    double ra = body->bounding_radius, rb = other->bounding_radius;
    double speed = pe_length(pe_sub(ma->velocity, mb->velocity)) +
                   ra * pe_length(ma->angular_velocity) + rb * pe_length(mb->angular_velocity);
    double reach = ra + rb + DT * speed + slack;
    if (body->shape.kind == PE_SHAPE_PLANE) {
        return pe_dot(body->shape.normal, y) - body->shape.offset <= reach;
    }
    pe_vec3 d = pe_sub(x, y);
    return pe_dot(d, d) <= reach * reach;
}

static pe_status brute_spheres(bench *b, pe_pair **pairs, int *count, pe_error *error)
{
    pe_pair_list list = {.work = pe_step_memory(b->world)};
    double slack = pe_margin_slack(b->world, DT);
    pe_status status = PE_OK;
    for (int i = 1; i < b->world->slot_count; ++i) {
        for (int j = i + 1; j < b->world->slot_count && status == PE_OK; ++j) {
            if (spheres_meet(b->world, i, j, slack)) {
                status = pe_pair_list_add(&list, i, j, error);
            }
        }
    }
    *pairs = list.items;
    *count = list.count;
    return status;
}

static pe_aabb box_of(const pe_world *world, int slot, double margin)
{
    const pe_body *body = &pe_bodies(world)[slot];
    const pe_pose *pose = &pe_poses(world)[slot];
    pe_vec3 x = pose->position, m = pe_v3(margin, margin, margin);
    pe_vec3 half = pe_add(m, pe_shape_extent(&body->shape, NULL, &pose->rotation).half);
    return (pe_aabb){{x.x - half.x, x.y - half.y, x.z - half.z},
                     {x.x + half.x, x.y + half.y, x.z + half.z}};
}

/* All pairs, by their boxes with the margin; the floor, slot 1, by the boxes' low sides. */
static pe_status brute_boxes(bench *b, pe_pair **pairs, int *count, pe_error *error)
{
    pe_world *world = b->world;
    pe_pair_list list = {.work = pe_step_memory(world)};
    pe_aabb *box = pe_scratch(world, (size_t)world->slot_count, sizeof *box);
    if (box == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for boxes");
    }
    pe_status status = PE_OK;
    double slack = pe_margin_slack(world, DT);
    for (int i = 2; i < world->slot_count && status == PE_OK; ++i) {
        double speed = pe_length(pe_twists(world)[i].velocity) + pe_spin_speed(world, i);
        box[i] = box_of(world, i, DT * speed + slack);
        if (box[i].low[2] <= 0) {
            status = pe_pair_list_add(&list, 1, i, error);
        }
    }
    for (int i = 2; i < world->slot_count; ++i) {
        for (int j = i + 1; j < world->slot_count && status == PE_OK; ++j) {
            if (pe_aabb_overlaps(&box[i], &box[j])) {
                status = pe_pair_list_add(&list, i, j, error);
            }
        }
    }
    *pairs = list.items;
    *count = list.count;
    return status;
}

static pe_status sweep_rows(bench *b, pe_pair **pairs, int *count, pe_error *error)
{
    return pe_rows_find(b->world, b->order, b->order_count, DT, pairs, count, error);
}

static pe_status tree(bench *b, pe_pair **pairs, int *count, pe_error *error)
{
    pe_pair_list list;
    pe_status status = pe_broad_phase(b->world, DT, NULL, &list, error);
    *pairs = list.items;
    *count = list.count;
    return status;
}

enum { TREE, ROWS, BOXES, SPHERES, WAYS };

static way *const WAY[WAYS] = {tree, sweep_rows, brute_boxes, brute_spheres};

/* ---- Measuring ---- */

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare);
    return values[count / 2];
}

static bool collide(pe_world *world, pe_pair pair)
{
    const pe_body *a = &pe_bodies(world)[pair.a], *b = &pe_bodies(world)[pair.b];
    const pe_pose *poses = pe_poses(world);
    pe_pair_manifold manifolds[PE_MAX_MANIFOLDS];
    return pe_collide((pe_placed){&a->shape, NULL, &poses[pair.a], a->size},
                      (pe_placed){&b->shape, NULL, &poses[pair.b], b->size},
                      pe_pair_margin(world, pair.a, pair.b, DT), pe_step_memory(world),
                      manifolds) > 0;
}

/* The narrow phase over the pairs; returns how many it looked at. */
static int collide_pairs(pe_world *world, const pe_pair *pairs, int count, bool spheres)
{
    int passed = 0;
    double slack = pe_margin_slack(world, DT);
    for (int i = 0; i < count; ++i) {
        if (!spheres || spheres_meet(world, pairs[i].a, pairs[i].b, slack)) {
            collide(world, pairs[i]);
            passed += 1;
        }
    }
    return passed;
}

/* The number of pairs with contacts. Every way must give the same one. */
static int count_contacts(pe_world *world, const pe_pair *pairs, int count)
{
    int touching = 0;
    double slack = pe_margin_slack(world, DT);
    for (int i = 0; i < count; ++i) {
        int a = pairs[i].a, b = pairs[i].b;
        bool meet = a == 1; /* the floor has no box */
        if (!meet) {
            double margin = 0.5 * pe_pair_margin(world, a, b, DT);
            pe_aabb p = box_of(world, a, margin), q = box_of(world, b, margin);
            meet = pe_aabb_overlaps(&p, &q) && spheres_meet(world, a, b, slack);
        }
        touching += meet && collide(world, pairs[i]);
    }
    return touching;
}

/* Of one scene at one size. Times in s, medians over the steps. */
typedef struct outcome {
    double time[WAYS], pairs[WAYS]; /* pairs: a step */
    double collide[2];              /* the narrow phase over the tree's pairs; [1]: spheres first */
    double passed;                  /* part of these pairs that the spheres let pass */
} outcome;

static void measure_step(bench *b, int ways, int step, double (*time)[MOST_STEPS], outcome *out)
{
    int touching[WAYS] = {0}, count;
    for (int k = 0; k < ways; ++k) {
        int w = (k + step) % ways;
        pe_pair *pairs;
        pe_error error;
        pe_arena_reset(&b->world->arena, &b->world->allocator);
        double begin = cpu_seconds();
        require(WAY[w](b, &pairs, &count, &error), &error);
        time[w][step] = cpu_seconds() - begin;
        out->pairs[w] += count;
        touching[w] = count_contacts(b->world, pairs, count);
        for (int i = 0; i < 2 && w == TREE; ++i) {
            bool spheres = (i + step) % 2 == 1;
            begin = cpu_seconds();
            int passed = collide_pairs(b->world, pairs, count, spheres);
            time[WAYS + spheres][step] = cpu_seconds() - begin;
            out->passed += spheres && count > 0 ? (double)passed / count : 0;
        }
    }
    for (int w = 1; w < ways; ++w) {
        if (touching[w] != touching[TREE]) {
            fprintf(stderr, "bench_broad_phase: %d and %d pairs with contacts\n", touching[w],
                    touching[TREE]);
            exit(1);
        }
    }
}

static outcome measure(const scene *s, int n)
{
    outcome out = {{0}, {0}, {0}, 0};
    double time[WAYS + 2][MOST_STEPS];
    bench b = {.world = make_scene(s, n), .order_count = n};
    b.order = malloc((size_t)n * sizeof *b.order);
    if (b.order == NULL) {
        exit(1);
    }
    for (int i = 0; i < n; ++i) {
        b.order[i] = i + 2; /* after the dummy and the floor */
    }
    int ways = n <= MOST_BRUTE ? WAYS : BOXES;
    int steps = n <= 1000 ? MOST_STEPS : n <= 10000 ? 24 : 36, warm = 6;
    for (int step = -warm; step < steps; ++step) {
        if (step == 0) {
            out = (outcome){{0}, {0}, {0}, 0};
        }
        int at = step < 0 ? step + warm : step;
        measure_step(&b, step < 0 ? BOXES : ways, at, time, &out);
        move_bodies(b.world);
    }
    for (int w = 0; w < ways; ++w) {
        out.time[w] = median(time[w], steps);
        out.pairs[w] /= steps;
    }
    for (int i = 0; i < 2; ++i) {
        out.collide[i] = median(time[WAYS + i], steps);
    }
    out.passed /= steps;
    pe_world_destroy(b.world);
    free(b.order);
    return out;
}

static void print_ratio(double value, double unit)
{
    if (value > 0) {
        printf(" %.3g |", value / unit);
    } else {
        printf(" |");
    }
}

int main(int argc, char **argv)
{
    int most = argc > 1 ? atoi(argv[1]) : 50000;
    printf("CPU time per body over that of the tree; pairs per body; and the narrow phase of the "
           "tree's pairs\nwith a test of bounding spheres first over that without.\n\n"
           "| scene | bodies | tree, ns | rows | boxes | spheres | pairs: tree | rows | boxes | "
           "spheres | narrow phase after spheres | pairs they pass |\n"
           "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t k = 0; k < sizeof SCENES / sizeof SCENES[0]; ++k) {
        for (int n = 100; n <= most; n = n == 10000 ? 50000 : 10 * n) {
            outcome out = measure(&SCENES[k], n);
            printf("| %s | %d | %.3g |", SCENES[k].name, n, 1e9 * out.time[TREE] / n);
            for (int w = ROWS; w < WAYS; ++w) {
                print_ratio(out.time[w], out.time[TREE]);
            }
            for (int w = 0; w < WAYS; ++w) {
                print_ratio(out.pairs[w], n);
            }
            print_ratio(out.collide[1], out.collide[0]);
            printf(" %.0f %% |\n", 100 * out.passed);
            (void)fflush(stdout);
        }
    }
    return 0;
}
