#include "session.h"

#include "base/array.h"
#include "base/heap.h"
#include "plumb/vec.h"
#include "referee/geometry/solid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More contact points than a scene of PL_MAX_BODIES can have. */
enum { MOST_CONTACTS = 1 << 24 };

pl_session pl_session_begin(const pl_engine_choice *choice)
{
    return (pl_session){.choice = choice, .timer = {.counter = -1}};
}

const char *pl_stage_name(pl_stage stage)
{
    static const char *const names[] = {
        [PL_STAGE_PREPARE] = "the harness", [PL_STAGE_LOAD] = "loading",
        [PL_STAGE_CREATE] = "create",       [PL_STAGE_SETTINGS] = "read_settings or read_pair",
        [PL_STAGE_CAPTURE] = "capture",     [PL_STAGE_STEP] = "step",
        [PL_STAGE_READ] = "reading",        [PL_STAGE_JUDGE] = "the referee",
        [PL_STAGE_DESTROY] = "destroy",     [PL_STAGE_UNLOAD] = "unloading",
        [PL_STAGE_REPORT] = "reporting"};
    return names[stage];
}

static void enter(const pl_session *session, pl_stage stage)
{
    if (session->enter != NULL) {
        session->enter(session->user, stage);
    }
}

/* The first call that left modes changed is kept. */
static void note_modes(pl_session *session, pl_stage stage, unsigned modes)
{
    if (modes != 0 && session->mode_change.modes == 0) {
        session->mode_change = (pl_mode_change){modes, stage};
    }
}

static void before_call(pl_session *session, pl_stage stage)
{
    enter(session, stage);
    session->stage = stage;
    session->environment = pl_float_environment_save();
    pl_call_timer_begin(&session->timer);
}

/* The cost of a call to a program: of a step what the program reports, and of another call what the
 * operating system counted for it. The rest of a step, which hands over the state, counts as reading. */
static pl_call_cost cost_of_program(pl_session *session, pl_call_group group, pl_call_cost own)
{
    const pl_process_engine_time now = pl_process_engine_times();
    const double all = own.cpu_time + fmax(0, now.all - session->program_time.all);
    const double step = now.steps - session->program_time.steps;
    own.cpu_time = group == PL_CALLS_STEP ? step : all;
    own.instructions = NAN;
    session->cost[PL_CALLS_READ].cpu_time += group == PL_CALLS_STEP ? fmax(0, all - step) : 0;
    session->program_time = now;
    return own;
}

/* Adds the cost of the call to its group and returns it. */
static pl_call_cost after_call(pl_session *session, pl_call_group group)
{
    pl_call_cost cost = pl_call_timer_end(&session->timer);
    note_modes(session, session->stage, pl_float_environment_restore(&session->environment));
    if (session->loaded.is_program) {
        cost = cost_of_program(session, group, cost);
    }
    session->cost[group].cpu_time += cost.cpu_time;
    session->cost[group].wall_time += cost.wall_time;
    session->cost[group].instructions += cost.instructions;
    return cost;
}

/* Whether the files that were mapped since are those that the engine had when it was described. */
static pl_status check_same_binary(const pl_engine_info *info, int mapped, pl_error *error)
{
    char stamp[17];
    char hash[17];
    pl_status status = pl_binary_stamp(mapped, stamp, error);
    if (status != PL_OK || strcmp(stamp, info->stamp) == 0) {
        return status;
    }
    status = pl_binary_hash(info, mapped, hash, error);
    if (status != PL_OK || strcmp(hash, info->binary) == 0) {
        return status;
    }
    return pl_fail(error, PL_FAILED, "%s has changed since it was first loaded", info->path);
}

pl_status pl_session_load(pl_session *session, pl_error *error)
{
    const pl_engine_info *info = session->choice->engine;
    const int mapped = pl_mapped_file_count();
    pl_error fault = {.message = ""};
    enter(session, PL_STAGE_LOAD);
    pl_status status = pl_load_engine(info, &session->loaded, &fault);
    note_modes(session, PL_STAGE_LOAD, session->loaded.changed_modes);
    session->program_time = pl_process_engine_times();
    if (status != PL_OK) {
        return pl_fail(error, status == PL_BAD_INPUT ? PL_FAILED : status, "%s", fault.message);
    }
    return info->path == NULL ? PL_OK : check_same_binary(info, mapped, error);
}

/* The message that an engine wrote ends, whatever it wrote. */
static pl_status end_message(pl_status status, pl_error *error)
{
    if (error != NULL) {
        error->message[sizeof error->message - 1] = '\0';
    }
    return status;
}

static void fill_pairs(pl_session *session, const pl_scene *scene)
{
    const int count = scene->material_count;
    free(session->pairs);
    session->pairs = pl_heap_new((size_t)count * (size_t)count, sizeof *session->pairs);
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < count; ++k) {
            pl_pair_coefficients *pair = &session->pairs[i * count + k];
            pl_scene_pair(scene, i, k, &pair->friction, &pair->restitution);
        }
    }
}

pl_status pl_session_create(pl_session *session, const pl_scene *scene, pl_error *error)
{
    pl_status status = pl_needs_check(scene, session->choice->engine, error);
    if (status != PL_OK) {
        return status;
    }
    fill_pairs(session, scene);
    session->setup = (pl_engine_setup){.struct_size = sizeof session->setup,
                                       .scene = scene,
                                       .dt = scene->dt,
                                       .profile = session->choice->profile,
                                       .values = session->choice->values,
                                       .pairs = session->pairs};
    pl_scene_bounds(scene, session->setup.lower, session->setup.upper);
    session->steps = 0;
    before_call(session, PL_STAGE_CREATE);
    status = end_message(session->loaded.table.create(&session->setup, &session->instance, error),
                         error);
    after_call(session, PL_CALLS_CREATE);
    if (status == PL_OK && session->instance == NULL) {
        status = pl_fail(error, PL_FAILED, "create returned PL_OK, but made no instance");
    }
    return status;
}

pl_status pl_session_step(pl_session *session, pl_step_stats *stats, pl_call_cost *cost,
                          pl_error *error)
{
    *stats = (pl_step_stats){.struct_size = sizeof *stats,
                             .iterations = NAN,
                             .residual = NAN,
                             .contacts = NAN,
                             .islands = NAN,
                             .time_collide = NAN,
                             .time_solve = NAN,
                             .time_other = NAN};
    before_call(session, PL_STAGE_STEP);
    session->steps += 1;
    const pl_status status = end_message(
        session->loaded.table.step(session->instance, session->setup.dt, stats, error), error);
    const pl_call_cost spent = after_call(session, PL_CALLS_STEP);
    if (cost != NULL) {
        *cost = spent;
    }
    return status;
}

void pl_session_read_frame(pl_session *session, pl_frame *frame)
{
    const int count = frame->body_count;
    pl_body_state *bodies = frame->bodies;
    before_call(session, PL_STAGE_READ);
    session->loaded.table.read_frame(session->instance, frame);
    after_call(session, PL_CALLS_READ);
    frame->body_count = count;
    frame->bodies = bodies;
}

/* Room for `wanted` items; memory that ends ends the engine's process, as what the engine took. */
static void reserve(void *items, int *capacity, int wanted, size_t size)
{
    if (wanted > *capacity && pl_array_reserve(items, capacity, wanted, size, NULL) != PL_OK) {
        pl_out_of_memory();
    }
}

/* What the engine does not report has a defined value. */
static void clear_unreported(uint32_t reported, pl_contact *contacts, int count)
{
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            if ((reported & PL_CONTACTS_IMPULSES) == 0) {
                contacts[i].impulse[k] = NAN;
            }
            if ((reported & PL_CONTACTS_TORQUES) == 0) {
                contacts[i].torque[k] = 0;
            }
        }
    }
}

pl_status pl_session_read_contacts(pl_session *session, pl_contact **contacts, int *capacity,
                                   int *count, pl_error *error)
{
    const pl_engine *engine = &session->loaded.table;
    *count = -1;
    if (engine->read_contacts == NULL || engine->contacts == 0) {
        return PL_OK;
    }
    for (int attempt = 0; attempt < 2; ++attempt) {
        before_call(session, PL_STAGE_READ);
        *count = engine->read_contacts(session->instance, *contacts, *capacity);
        after_call(session, PL_CALLS_READ);
        if (*count >= 0 && *count <= *capacity) {
            clear_unreported(engine->contacts, *contacts, *count);
            return PL_OK;
        }
        if (*count < 0) {
            return pl_fail(error, PL_FAILED, "the engine reports %d contacts at step %ld", *count,
                           session->steps);
        }
        if (*count > MOST_CONTACTS || attempt > 0) {
            break;
        }
        reserve(contacts, capacity, *count, sizeof **contacts);
    }
    return pl_fail(error, PL_FAILED, "read_contacts returned %d for a capacity of %d", *count,
                   *capacity);
}

static const pl_contact_times *contact_times_of(const pl_engine *engine)
{
    return engine->extension != NULL ? engine->extension(PL_CONTACT_TIMES) : NULL;
}

bool pl_session_read_contact_times(pl_session *session, int count, pl_contact_time **times,
                                   int *capacity)
{
    if (count <= 0) {
        return false;
    }
    before_call(session, PL_STAGE_READ);
    const pl_contact_times *table = contact_times_of(&session->loaded.table);
    after_call(session, PL_CALLS_READ);
    if (table == NULL) {
        return false;
    }
    reserve(times, capacity, count, sizeof **times);
    before_call(session, PL_STAGE_READ);
    table->read(session->instance, *times, count);
    after_call(session, PL_CALLS_READ);
    return true;
}

void pl_session_read_settings(pl_session *session, pl_engine_settings *settings)
{
    settings->struct_size = sizeof *settings;
    settings->dt = NAN;
    settings->substeps = session->loaded.table.substeps;
    settings->linear_damping = NAN;
    settings->angular_damping = NAN;
    for (int k = 0; k < 3; ++k) {
        settings->gravity[k] = NAN;
    }
    for (int i = 0; i < settings->body_count; ++i) {
        settings->mass[i] = NAN;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = NAN;
        }
    }
    if (session->loaded.table.read_settings != NULL) {
        pl_engine_settings given = *settings; /* the arrays are the caller's */
        before_call(session, PL_STAGE_SETTINGS);
        session->loaded.table.read_settings(session->instance, &given);
        after_call(session, PL_CALLS_OTHER);
        given.struct_size = settings->struct_size;
        given.body_count = settings->body_count;
        given.mass = settings->mass;
        given.inertia = settings->inertia;
        *settings = given;
    }
}

pl_pair_coefficients pl_session_read_pair(pl_session *session, int body_a, int body_b)
{
    pl_pair_coefficients found = {NAN, NAN};
    if (session->loaded.table.read_pair != NULL) {
        before_call(session, PL_STAGE_SETTINGS);
        session->loaded.table.read_pair(session->instance, body_a, body_b, &found);
        after_call(session, PL_CALLS_OTHER);
    }
    return found;
}

bool pl_session_is_over_limit(const pl_session *session, double cpu_limit)
{
    return cpu_limit > 0 &&
           session->cost[PL_CALLS_CREATE].cpu_time + session->cost[PL_CALLS_STEP].cpu_time >
               cpu_limit;
}

void pl_session_destroy(pl_session *session)
{
    if (session->instance != NULL) {
        before_call(session, PL_STAGE_DESTROY);
        session->loaded.table.destroy(session->instance);
        after_call(session, PL_CALLS_OTHER);
    }
    session->instance = NULL;
    free(session->pairs);
    session->pairs = NULL;
}

void pl_session_end(pl_session *session)
{
    pl_session_destroy(session);
    enter(session, PL_STAGE_UNLOAD);
    pl_unload_engine(&session->loaded);
}

/* ---- Scenes ---- */

pl_status pl_needs_check(const pl_scene *scene, const pl_engine_info *engine, pl_error *error)
{
    uint32_t missing = pl_scene_needs(scene) & ~engine->capabilities;
    char names[256] = "";
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((missing & bit) != 0) {
            const char *name = pl_needs_name(bit);
            size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%s", used == 0 ? "" : ", ",
                     name == NULL ? "something unknown" : name);
        }
    }
    return missing == 0 ? PL_OK
                        : pl_fail(error, PL_UNSUPPORTED, "%s lacks %s", engine->name, names);
}

/* How far the bounds of a scene go beyond where its bodies begin. A box that stands for a plane is as
 * large as the bounds: engines in single precision go wrong on one of a kilometre, and the motion must
 * not depend on how long it is watched. */
static const double ROOM = 100;     /* m */
static const double ROOM_TIME = 10; /* s, at the largest initial speed, where that is more */

void pl_scene_bounds(const pl_scene *scene, double lower[3], double upper[3])
{
    double fastest = 0;
    for (int k = 0; k < 3; ++k) {
        lower[k] = INFINITY;
        upper[k] = -INFINITY;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (body->shape.kind == PL_SHAPE_PLANE) {
            continue;
        }
        const double reach = pl_bounding_radius(&body->shape);
        double centre[3];
        pl_vec_store(pl_centre_of_mass(&body->shape, body->position, body->orientation), centre);
        fastest = fmax(fastest, pl_vec_length(pl_vec_of(body->velocity)));
        for (int k = 0; k < 3; ++k) {
            lower[k] = fmin(lower[k], centre[k] - reach);
            upper[k] = fmax(upper[k], centre[k] + reach);
        }
    }
    const double further = fmax(ROOM, ROOM_TIME * fastest);
    for (int k = 0; k < 3; ++k) {
        const bool empty = !(lower[k] <= upper[k]);
        lower[k] = (empty ? 0 : lower[k]) - further;
        upper[k] = (empty ? 0 : upper[k]) + further;
    }
}
