/* Faults of a step: the inner engine is stepped otherwise, or is changed between its steps. */
#include "fault_variant.h"

#include <fenv.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static pl_status short_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    return variant_step(v, 0.9 * dt, stats, error);
}

static pl_status fixed_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    (void)dt;
    return variant_step(v, 1.0 / 60, stats, error);
}

static pl_status four_steps(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < 4 && status == PL_OK; ++i) {
        status = variant_step(v, dt / 4, stats, error);
    }
    for (int i = 0; i < v->contact_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            v->contacts[i].impulse[k] *= 4;
        }
    }
    return status;
}

/* Rounds the state to float after each step. */
static pl_status float_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    const pl_status status = variant_step(v, dt, stats, error);
    for (int i = 0; i < v->scene.body_count; ++i) {
        pl_body_state *state = &v->states[i];
        for (int k = 0; k < 3; ++k) {
            state->position[k] = (double)(float)state->position[k];
            state->velocity[k] = (double)(float)state->velocity[k];
            state->angular_velocity[k] = (double)(float)state->angular_velocity[k];
        }
        for (int k = 0; k < 4; ++k) {
            state->orientation[k] = (double)(float)state->orientation[k];
        }
    }
    return status != PL_OK ? status : variant_restart(v, error);
}

/* Multiplies velocities by 1 - c dt. */
static pl_status damped_step(variant_instance *v, double linear, double angular, pl_error *error)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            v->states[i].velocity[k] *= 1 - linear * v->given->dt;
            v->states[i].angular_velocity[k] *= 1 - angular * v->given->dt;
        }
    }
    return variant_restart(v, error);
}

static pl_status linear_damping(variant_instance *v, double dt, pl_step_stats *stats,
                                pl_error *error)
{
    const pl_status status = variant_step(v, dt, stats, error);
    return status != PL_OK ? status : damped_step(v, 0.01, 0, error);
}

static pl_status angular_damping(variant_instance *v, double dt, pl_step_stats *stats,
                                 pl_error *error)
{
    const pl_status status = variant_step(v, dt, stats, error);
    return status != PL_OK ? status : damped_step(v, 0, 0.01, error);
}

static double speed_of(const pl_body_state *state)
{
    return sqrt(state->velocity[0] * state->velocity[0] + state->velocity[1] * state->velocity[1] +
                state->velocity[2] * state->velocity[2]);
}

/* Every body has a material of its own, so that restitution can be changed for two bodies. */
static void own_materials(variant_instance *v)
{
    const int count = v->scene.body_count;
    variant_set_materials(v, count);
    for (int i = 0; i < count; ++i) {
        v->scene.bodies[i].material = i;
        snprintf(v->scene.materials[i].name, sizeof v->scene.materials[i].name, "%d", i);
    }
    for (int i = 0; i < count * count; ++i) {
        v->pairs[i] = pl_setup_pair(v->given, i / count, i % count);
    }
    variant_use_pairs(v);
}

/* Restitution of two bodies is 0 while their velocities differ by less than 0.5 m/s. */
static pl_status restitution_threshold(variant_instance *v, double dt, pl_step_stats *stats,
                                       pl_error *error)
{
    const int count = v->scene.body_count;
    for (int i = 0; i < count * count; ++i) {
        const double *a = v->states[i / count].velocity, *b = v->states[i % count].velocity;
        const double speed = hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
        const double given = pl_setup_pair(v->given, i / count, i % count).restitution;
        v->pairs[i].restitution = speed < 0.5 ? 0 : given;
    }
    variant_use_pairs(v);
    const pl_status status = variant_restart(v, error);
    return status != PL_OK ? status : variant_step(v, dt, stats, error);
}

/* A body that moves slowly for ten steps stops. */
static pl_status sleep_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    pl_status status = variant_step(v, dt, stats, error);
    bool sleeps = false;
    for (int i = 0; i < v->scene.body_count && status == PL_OK && v->steps > 10; ++i) {
        pl_body_state *state = &v->states[i];
        if (!v->scene.bodies[i].is_static && speed_of(state) < 0.05) {
            *state = v->before[i];
            memset(state->velocity, 0, sizeof state->velocity);
            memset(state->angular_velocity, 0, sizeof state->angular_velocity);
            sleeps = true;
        }
    }
    return sleeps ? variant_restart(v, error) : status;
}

/* A free body keeps its angular velocity, although the engine declares the gyroscopic torque. */
static pl_status no_gyroscopic_torque(variant_instance *v, double dt, pl_step_stats *stats,
                                      pl_error *error)
{
    const pl_status status = variant_step(v, dt, stats, error);
    for (int i = 0; i < v->scene.body_count && v->contact_count == 0; ++i) {
        memcpy(v->states[i].angular_velocity, v->before[i].angular_velocity,
               sizeof v->states[i].angular_velocity);
    }
    return status != PL_OK ? status : variant_restart(v, error);
}

/* ---- Conduct ---- */

static char *volatile leaked;

static void leak(void)
{
    const size_t size = 100000;
    leaked = malloc(size);
    memset(leaked, 1, size);
}

static void leak_instance(variant_instance *v)
{
    (void)v;
    leak();
}

static pl_status leak_step(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    leak();
    return variant_step(v, dt, stats, error);
}

static pl_status leave_rounding(variant_instance *v, double dt, pl_step_stats *stats,
                                pl_error *error)
{
    const pl_status status = variant_step(v, dt, stats, error);
    fesetround(FE_UPWARD);
    return status;
}

/* The step is longer by a part in a thousand million after a division by zero. */
static pl_status read_flags(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    return variant_step(v, fetestexcept(FE_DIVBYZERO) != 0 ? dt * (1 + 1e-9) : dt, stats, error);
}

static void leave_rounding_of_create(variant_instance *v)
{
    (void)v;
    fesetround(FE_TOWARDZERO);
}

static pl_status negative_statistics(variant_instance *v, double dt, pl_step_stats *stats,
                                     pl_error *error)
{
    const pl_status status = variant_step(v, dt, stats, error);
    stats->contacts = -1;
    stats->iterations = -1;
    stats->time_solve = -1;
    return status;
}

static pl_status call_exit(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    if (v->steps == 2) {
        exit(0);
    }
    return variant_step(v, dt, stats, error);
}

static pl_status crash(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    if (v->steps == 2) {
        raise(SIGSEGV);
    }
    return variant_step(v, dt, stats, error);
}

static pl_status hang(variant_instance *v, double dt, pl_step_stats *stats, pl_error *error)
{
    while (v->steps == 2) {
        pause();
    }
    return variant_step(v, dt, stats, error);
}

static const variant faults[] = {
    {"step_short", "steps are 0.9 dt long", .step = short_step},
    {"step_fixed", "steps are 1/60 s long, whatever dt is", .step = fixed_step},
    {"substeps_hidden", "declares one sub-step and makes four", .step = four_steps},
    {"float_hidden", "declares doubles and keeps its state in floats", .step = float_step},
    {"damping_linear", "linear damping of 0.01 1/s", .step = linear_damping},
    {"damping_angular", "angular damping of 0.01 1/s", .step = angular_damping},
    {"restitution_threshold", "nothing bounces below 0.5 m/s", .change_setup = own_materials,
     .step = restitution_threshold},
    {"sleeping", "slow bodies stop", .step = sleep_step},
    {"gyroscopic_none", "declares the gyroscopic torque and leaves it out",
     .step = no_gyroscopic_torque},
    {"leak_instance", "each instance leaks 100 kB", .change_setup = leak_instance},
    {"leak_step", "each step leaks 100 kB", .step = leak_step},
    {"rounding_step", "a step leaves another rounding mode behind", .step = leave_rounding},
    {"rounding_create", "create leaves another rounding mode behind",
     .change_setup = leave_rounding_of_create},
    {"flags_read", "results depend on exception flags that earlier work has raised",
     .step = read_flags},
    {"statistics_negative", "numbers of the statistics are negative", .step = negative_statistics},
    {"exit", "calls exit(0) in the third step", .step = call_exit},
    {"crash", "crashes in the third step", .step = crash},
    {"hang", "never returns from the third step", .step = hang},
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    static pl_engine engine;
    engine = variant_engine("broken_step", faults, sizeof faults / sizeof *faults);
    return &engine;
}
