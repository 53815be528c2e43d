/* What a step of the engine costs, by phase, and how much memory it takes.
 *
 *   bench_step SCENARIO[,NAME=VALUE]... [PROFILE [STEPS [THREADS...]]]
 *
 * For example `bench_step blocks,n=50000,mesh=0 fast 60 1 2`. Prints Markdown. Every number of threads
 * has its own world, all of which step in turn (A B A B), so that their ratios hold on a machine that
 * others use. Times are medians over the steps. Scenes of planes, spheres, boxes, capsules and cylinders
 * only. */
#define _POSIX_C_SOURCE 200809L

#include "base/vec3.h"
#include "metered_allocator.h"
#include "plumb/scenario.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST_WORLDS = 8 };

static const char *const phases[] = {"broad", "narrow", "contacts", "islands",
                                     "solve", "free",   "correct"};
enum { PHASES = sizeof phases / sizeof phases[0] };

static void require(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "bench_step: %s\n", what);
        exit(2);
    }
}

/* ---- The scene ---- */

static pe_vec3 vector(const double v[3])
{
    return pe_v3(v[0], v[1], v[2]);
}

static pe_shape shape_of(const pl_shape *s)
{
    static const pe_shape_kind kinds[PL_SHAPE_KIND_COUNT] = {
        [PL_SHAPE_PLANE] = PE_SHAPE_PLANE,       [PL_SHAPE_SPHERE] = PE_SHAPE_SPHERE,
        [PL_SHAPE_BOX] = PE_SHAPE_BOX,           [PL_SHAPE_CAPSULE] = PE_SHAPE_CAPSULE,
        [PL_SHAPE_CYLINDER] = PE_SHAPE_CYLINDER, [PL_SHAPE_HULL] = PE_SHAPE_COUNT,
        [PL_SHAPE_MESH] = PE_SHAPE_COUNT};
    require(kinds[s->kind] != PE_SHAPE_COUNT, "hulls and meshes are not supported");
    return (pe_shape){.kind = kinds[s->kind],
                      .normal = vector(s->normal),
                      .offset = s->offset,
                      .radius = s->radius,
                      .half_height = s->half_height,
                      .half_extents = vector(s->half_extents)};
}

static pe_world *make_world(const pl_scene *scene, const pe_world_def *def)
{
    pe_world *world;
    pe_error error;
    require(pe_world_create(def, &world, &error) == PE_OK, "no world");
    pe_material_id *materials = calloc((size_t)scene->material_count, sizeof *materials);
    require(materials != NULL, "no memory");
    for (int i = 0; i < scene->material_count; ++i) {
        const pl_material *m = &scene->materials[i];
        pe_material_create(world, m->friction, m->restitution, &materials[i], NULL);
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *b = &scene->bodies[i];
        const pe_body_def body = {
            .shape = shape_of(&b->shape),
            .is_static = b->is_static,
            .material = materials[b->material],
            .mass = b->mass,
            .inertia = vector(b->inertia),
            .position = vector(b->position),
            .orientation = {b->orientation[0], b->orientation[1], b->orientation[2],
                            b->orientation[3]},
            .velocity = vector(b->velocity),
            .angular_velocity = vector(b->angular_velocity),
        };
        pe_body_id id;
        require(pe_body_create(world, &body, &id, &error) == PE_OK, error.message);
    }
    free(materials);
    return world;
}

static void build_scene(const char *spec, pl_scene *scene)
{
    char *copy = strdup(spec);
    require(copy != NULL, "no memory");
    char *settings = strchr(copy, ',');
    if (settings != NULL) {
        *settings++ = '\0';
    }
    pl_error error;
    double values[PL_MAX_PARAMS + 2];
    const pl_scenario *scenario = pl_scenario_find(copy, &error);
    require(scenario != NULL, error.message);
    const char *given[] = {settings};
    require(pl_scenario_values(scenario, given, settings != NULL, values, &error) == PL_OK,
            error.message);
    require(pl_scenario_build(scenario, values, 0, scene, &error) == PL_OK, error.message);
    free(copy);
}

/* ---- Measuring ---- */

static double seconds(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One world, and what its steps took in s. */
typedef struct subject {
    pe_world *world;
    meter meter;
    int threads;
    double *wall, *cpu, *phase[PHASES]; /* (steps) */
    double contacts;
} subject;

static void measure(subject *s, double dt, int n)
{
    pe_step_stats stats;
    pe_error error;
    double wall = seconds(CLOCK_MONOTONIC), cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
    require(pe_world_step(s->world, dt, &stats, &error) == PE_OK, error.message);
    s->wall[n] = seconds(CLOCK_MONOTONIC) - wall;
    s->cpu[n] = seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    const double times[PHASES] = {
        stats.time_broad_phase, stats.time_narrow_phase, stats.time_contacts, stats.time_islands,
        stats.time_solve,       stats.time_integrate,    stats.time_project};
    for (int i = 0; i < PHASES; ++i) {
        s->phase[i][n] = times[i];
    }
    s->contacts += stats.contacts;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *numbers, int count)
{
    qsort(numbers, (size_t)count, sizeof *numbers, compare_doubles);
    return numbers[count / 2];
}

static double sum(const double *numbers, int count)
{
    double total = 0;
    for (int i = 0; i < count; ++i) {
        total += numbers[i];
    }
    return total;
}

static void print(subject *s, int steps, int bodies)
{
    const double first = s->wall[0], mean_wall = sum(s->wall, steps) / steps;
    const double mean_cpu = sum(s->cpu, steps) / steps, contacts = s->contacts / steps;
    const double wall = median(s->wall, steps), cpu = median(s->cpu, steps);
    printf("| %d | %.3g | %.3g | %.3g | %.3g | %.3g | %.3g |", s->threads, 1e3 * first,
           1e3 * mean_wall, 1e3 * mean_cpu, 1e3 * wall, 1e3 * cpu,
           1e9 * cpu / (contacts > 1 ? contacts : 1));
    for (int i = 0; i < PHASES; ++i) {
        printf(" %.3g |", 1e3 * median(s->phase[i], steps));
    }
    printf(" %.0f | %.0f |\n", (double)s->meter.now / bodies, (double)s->meter.most / bodies);
}

static void take_arrays(subject *s, int steps)
{
    double **arrays[2 + PHASES] = {&s->wall, &s->cpu};
    for (int i = 0; i < PHASES; ++i) {
        arrays[2 + i] = &s->phase[i];
    }
    for (int i = 0; i < 2 + PHASES; ++i) {
        *arrays[i] = calloc((size_t)steps, sizeof(double));
        require(*arrays[i] != NULL, "no memory");
    }
}

int main(int argc, char **argv)
{
    require(argc > 1, "usage: bench_step SCENARIO[,NAME=VALUE]... [PROFILE [STEPS [THREADS...]]]");
    static const char *const profiles[] = {"default", "accurate", "fast"};
    const char *profile = argc > 2 ? argv[2] : profiles[0];
    const int steps = argc > 3 ? atoi(argv[3]) : 60;
    static subject subjects[MOST_WORLDS];
    int worlds = argc > 4 ? argc - 4 : 1;
    require(steps > 0 && worlds <= MOST_WORLDS, "expected at least one step and at most 8 worlds");
    pl_scene scene;
    build_scene(argv[1], &scene);
    for (int i = 0; i < worlds; ++i) {
        subject *s = &subjects[i];
        pe_world_def def = pe_world_def_default();
        def.gravity = vector(scene.gravity);
        def.profile = (pe_profile)-1;
        for (int k = 0; k < 3; ++k) {
            def.profile = strcmp(profile, profiles[k]) == 0 ? (pe_profile)k : def.profile;
        }
        def.threads = argc > 4 ? atoi(argv[4 + i]) : 1;
        def.allocator = (pe_allocator){meter_allocate, meter_release, &s->meter};
        s->threads = def.threads;
        s->world = make_world(&scene, &def);
        take_arrays(s, steps);
    }
    for (int n = 0; n < steps; ++n) {
        for (int i = 0; i < worlds; ++i) {
            measure(&subjects[i], scene.dt, n);
        }
    }
    printf("%s, %s, %d bodies, %.0f contacts, %d steps; ms\n\n", argv[1], profile, scene.body_count,
           subjects[0].contacts / steps, steps);
    printf("| threads | first step | mean | mean CPU | median | median CPU | ns a contact |");
    for (int i = 0; i < PHASES; ++i) {
        printf(" %s |", phases[i]);
    }
    printf(" bytes a body | at most |\n|");
    for (int i = 0; i < 9 + PHASES; ++i) {
        printf("---:|");
    }
    printf("\n");
    for (int i = 0; i < worlds; ++i) {
        print(&subjects[i], steps, scene.body_count);
        pe_world_destroy(subjects[i].world);
    }
    pl_scene_free(&scene);
    return 0;
}
