/* A heap: boxes, spheres and capsules fall into a corner of four walls. Prints the time of a step, and what the
 * engine says of its own accuracy.
 *
 *     ./heap [BODIES [THREADS]] */
#include <plumb/engine.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double seconds_now(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Ends the program if a call failed. */
static void check(pe_status status, const pe_error *error)
{
    if (status != PE_OK) {
        fprintf(stderr, "heap: %s\n", error->message);
        exit(1);
    }
}

static void add_walls(pe_world *world)
{
    static const pe_vec3 normals[] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    pe_error error;
    for (int i = 0; i < 5; ++i) {
        pe_body_def wall = pe_body_def_default();
        pe_body_id id;
        wall.is_static = true;
        wall.shape = (pe_shape){.kind = PE_SHAPE_PLANE,
                                .normal = normals[i],
                                .offset = i == 0 ? 0 : -3}; /* 6 m apart */
        check(pe_body_create(world, &wall, &id, &error), &error);
    }
}

static void add_bodies(pe_world *world, int count)
{
    static const pe_shape shapes[] = {
        {.kind = PE_SHAPE_BOX, .half_extents = {0.3, 0.2, 0.25}},
        {.kind = PE_SHAPE_SPHERE, .radius = 0.25},
        {.kind = PE_SHAPE_CAPSULE, .radius = 0.2, .half_height = 0.2},
    };
    pe_error error;
    for (int i = 0; i < count; ++i) {
        pe_body_def def = pe_body_def_default();
        pe_body_id id;
        const int column = i % 5, row = i / 5 % 5, layer = i / 25;
        def.shape = shapes[i % 3];
        def.position = (pe_vec3){-2 + column, -2 + row, 1 + 0.9 * layer};
        def.angular_velocity = (pe_vec3){0.1 * (i % 7), 0.1 * (i % 3), 0};
        check(pe_body_create(world, &def, &id, &error), &error);
    }
}

int main(int argc, char **argv)
{
    const int bodies = argc > 1 ? atoi(argv[1]) : 200;
    pe_world_def def = pe_world_def_default();
    def.threads = argc > 2 ? atoi(argv[2]) : 1;
    pe_world *world;
    pe_error error;
    check(pe_world_create(&def, &world, &error), &error);
    add_walls(world);
    add_bodies(world, bodies);
    double worst = 0;
    const double start = seconds_now();
    enum { STEPS = 300 };
    for (int step = 1; step <= STEPS; ++step) {
        pe_step_stats stats;
        check(pe_world_step(world, 1.0 / 60, &stats, &error), &error);
        worst = stats.penetration_left > worst ? stats.penetration_left : worst;
        if (step % 60 == 0) {
            printf(
                "t = %.0f s: %d contacts, %d iterations, residual %.1e m/s, penetration %.1e m\n",
                step / 60.0, stats.contacts, stats.iterations, stats.residual,
                stats.penetration_left);
        }
    }
    const double elapsed = seconds_now() - start;
    printf("%d bodies: %.3f ms a step, deepest penetration %.1e m\n", bodies, 1e3 * elapsed / STEPS,
           worst);
    pe_world_destroy(world);
}
