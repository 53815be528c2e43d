/* Spheres in a row, apart; the first runs into the second, that into the third, and so on.
 *
 * Momentum and Newton's restitution give, for two that meet with v1 > v2,
 *   v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2),
 *   v2' = ((m2 - e m1) v2 + (1 + e) m1 v1) / (m1 + m2).
 * Which two meet next is found here from the motion between impacts, to the end of the run, so that
 * the masses, and how often a sphere is caught up with, may be any. */
#include "catalogue.h"
#include "uniform_motion.h"

#include <math.h>

enum { COUNT, RATIO, RESTITUTION, SPEED, DT, DURATION, PARAM_COUNT };
enum { MOST = 10, MOST_IMPACTS = 10000 };

static const double radius = 0.1, gap = 0.5; /* m */

static const pl_param params[PARAM_COUNT] = {
    [COUNT] = {.name = "n",
               .value = 4,
               .min = 2,
               .max = MOST,
               .integer = true,
               .unit = "1",
               .help = "spheres"},
    [RATIO] = {.name = "ratio",
               .value = 2,
               .min = 1e-3,
               .max = 1e3,
               .unit = "1",
               .help = "of each sphere's mass to the one before; the first has 1 kg"},
    [RESTITUTION] = PL_PARAM_RESTITUTION(0.8),
    [SPEED] = {.name = "speed",
               .value = 3,
               .min = 0.1,
               .max = 100,
               .unit = "m/s",
               .help = "of the first sphere; the others are at rest, 0.5 m apart"},
    [DT] = PL_PARAM_DT,
    [DURATION] = PL_PARAM_DURATION(2),
};

typedef struct train {
    int count;
    double mass[MOST], place[MOST], speed[MOST]; /* place: without the radii, m */
} train;

static train train_of(const double *values)
{
    train t = {.count = (int)values[COUNT]};
    for (int i = 0; i < t.count; i++) {
        t.mass[i] = i == 0 ? 1 : t.mass[i - 1] * values[RATIO];
        t.place[i] = gap * i;
    }
    t.speed[0] = values[SPEED];
    return t;
}

/* The time until sphere i meets the next; INFINITY: never. */
static double time_to_meet(const train *t, int i)
{
    const double approach = t->speed[i] - t->speed[i + 1];
    return approach > 0 ? fmax(0, t->place[i + 1] - t->place[i]) / approach : (double)INFINITY;
}

static void collide(train *t, int i, double e)
{
    const double m1 = t->mass[i], m2 = t->mass[i + 1], v1 = t->speed[i], v2 = t->speed[i + 1];
    t->speed[i] = ((m1 - e * m2) * v1 + (1 + e) * m2 * v2) / (m1 + m2);
    t->speed[i + 1] = e == 0 ? t->speed[i] : ((m2 - e * m1) * v2 + (1 + e) * m1 * v1) / (m1 + m2);
}

/* False: the impacts crowd without end. */
static bool run_until(train *t, double time, double e)
{
    for (int impacts = 0; impacts < MOST_IMPACTS; impacts++) {
        int next = 0;
        for (int i = 1; i < t->count - 1; i++) {
            next = time_to_meet(t, i) < time_to_meet(t, next) ? i : next;
        }
        const double wait = fmin(time, time_to_meet(t, next));
        for (int i = 0; i < t->count; i++) {
            t->place[i] += wait * t->speed[i];
        }
        time -= wait;
        if (time <= 0) {
            return true;
        }
        collide(t, next, e);
    }
    return false;
}

static pl_status build(const double *values, uint64_t seed, pl_scene *scene, pl_error *error)
{
    (void)seed;
    pl_builder builder = pl_build_begin(scene, pl_scenario_collision_train.name, values[DT],
                                        values[DURATION], 0, error);
    scene->gravity[2] = 0;
    if (builder.status == PL_OK) {
        scene->materials[0].restitution = values[RESTITUTION];
    }
    train t = train_of(values);
    for (int i = 0; i < t.count; i++) {
        pl_body ball = pl_body_default();
        ball.shape = pl_shape_sphere(radius);
        ball.mass = t.mass[i];
        ball.position[0] = t.place[i] + 2 * radius * i;
        ball.velocity[0] = t.speed[i];
        pl_build_body(&builder, &ball, "ball %d", i + 1);
    }
    if (!run_until(&t, (double)pl_scene_steps(scene) * scene->dt, values[RESTITUTION])) {
        pl_scene_free(scene);
        return pl_fail(error, PL_BAD_INPUT,
                       "collision-train: expected fewer than %d impacts within the run, found more "
                       "at restitution %g and ratio %g",
                       MOST_IMPACTS, values[RESTITUTION], values[RATIO]);
    }
    for (int i = 0; i < t.count; i++) {
        pl_build_at_end(&builder, i, PL_QUANTITY_VELOCITY, pl_axis_x, pl_exactly(t.speed[i]),
                        values[SPEED]);
    }
    pl_build_judge(&builder, pl_scenario_collision_train.primary_error, (double)INFINITY);
    return pl_build_end(&builder);
}

const pl_scenario pl_scenario_collision_train = {
    .name = "collision-train",
    .title = "Row of collisions",
    .description = "Spheres in a row, apart, of masses in any ratio, hand a push on from one to "
                   "the next: whether every impact keeps momentum and gives the restitution.",
    .reference = "at each impact v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2), and the same "
                 "with 1 and 2 changed",
    .expected =
        "ok: velocities at the end are those handed on from impact to impact; momentum stays",
    .source = "Newton 1687, Principia, scholium to the laws; from impact to impact",
    .primary_error = "value_error",
    .validity = "no impact falls within a step of the end, and no two of one sphere in one step",
    .needs = PL_NEEDS_RESTITUTION | PL_NEEDS_SPHERE,
    .params = params,
    .param_count = PARAM_COUNT,
    .build = build};
