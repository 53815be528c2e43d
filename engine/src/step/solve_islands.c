/* All islands of a step: which get soft contact, and the others one by one or swept together, shared
 * by the threads.
 *
 * Consecutive islands make a task, by their number of points alone. A task counts what it did by
 * itself, and the counts are added in the order of the tasks: so no number depends on the thread that
 * did the work. Each island writes to its own bodies and contacts. An island of many points is a task
 * that the calling thread takes first, and the threads share the loops inside it. */
#include "impact.h"
#include "model/view.h"
#include "solver/soft.h"

#include <string.h>

/* In the fast profile islands that hardly move are solved as in the others: soft contacts sag under
 * a load that lasts. */
static const double QUIET_SPEED = 0.05; /* m/s */

/* So are uneven islands, in which a light body may be jammed between a heavy one and the ground:
 * two bodies in contact differ in mass by more than this. A larger island costs too much. */
enum { MOST_UNEVEN = 400 }; /* bodies */

/* A sub-step's one pass of soft contacts does not stop a body that reaches a wall in one step with
 * more than its own size to go: small islands with such a body are solved. */
enum { SMALL_ISLAND = 60 };
static const double FAR = 0.5; /* a step's motion in units of the bounding radius */

static void count_island(pe_step *step, int k, pe_path path)
{
    step->stats.islands_by_path[path] += 1;
    for (int i = step->islands.body_start[k]; i < step->islands.body_start[k + 1]; ++i) {
        step->solved_directly[step->islands.bodies[i]] = path != PE_PATH_SWEEPS;
    }
}

static int body_count(const pe_islands *islands, int k)
{
    return islands->body_start[k + 1] - islands->body_start[k];
}

/* Whether a contact of the island rebounds in the step. */
static bool bounces(const pe_step *step, int k)
{
    return pe_may_bounce(step->world, &step->islands, k) &&
           pe_impact_is_due(step, &step->islands, k);
}

/* Steps an island that has impacts, whole or in parts, so that they have their own time. *done:
 * whether they do. */
static pe_status step_impacts(pe_step *step, int k, bool *done)
{
    const pe_islands *islands = &step->islands;
    const pe_world_def *def = &step->world->def;
    pe_status status = PE_OK;
    pe_path path = PE_PATH_NONE;
    *done = false;
    if (body_count(islands, k) > 1 && def->impact_bodies > 0 && bounces(step, k)) {
        status = pe_parts_step(step, k, done, &path);
        step->stats.islands_by_path[path] += *done;
    }
    if (status == PE_OK && !*done && pe_impact_has_own_time(step, islands, k)) {
        *done = true;
        status = pe_impact_step(step, islands, k, &path);
        if (status == PE_OK) {
            count_island(step, k, path);
        }
    }
    return status;
}

/* Ends an island whose sweeps, if it asked for any, are made. */
static pe_status end_island(pe_step *step, pe_island_item *item)
{
    const int k = item->interval.k;
    pe_status status = pe_island_end(step, item);
    if (status == PE_OK) {
        count_island(step, k, item->interval.path);
    }
    if (status == PE_OK && item->interval.path != PE_PATH_SWEEPS) {
        pe_hold_island(step, k);
    }
    return status;
}

/* Brings the bodies of an island to their velocities and poses at the end of the step, or leaves an
 * item that asks for sweeps. */
static pe_status begin_island(pe_step *step, int k, pe_island_item *item)
{
    *item = (pe_island_item){
        .interval = {.islands = &step->islands, .k = k, .free = step->free, .dt = step->dt},
    };
    if (pe_island_hold(step, k)) {
        count_island(step, k, PE_PATH_SWEEPS);
        return PE_OK;
    }
    bool done;
    pe_status status = step_impacts(step, k, &done);
    if (status != PE_OK || done) {
        return status;
    }
    status = pe_island_begin(step, item);
    return status == PE_OK && item->solving.sweeps == 0 ? end_island(step, item) : status;
}

/* Whether an island hardly moves. */
static bool is_quiet(const pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        pe_vec3 v = pe_twists(step->world)[islands->bodies[i]].velocity;
        if (pe_dot(v, v) > QUIET_SPEED * QUIET_SPEED) {
            return false;
        }
    }
    return true;
}

static bool is_fast_and_small(const pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    if (body_count(islands, k) > SMALL_ISLAND) {
        return false;
    }
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        int slot = islands->bodies[i];
        double far = FAR * pe_bodies(step->world)[slot].bounding_radius;
        pe_vec3 v = pe_twists(step->world)[slot].velocity;
        if (step->dt * step->dt * pe_dot(v, v) > far * far) {
            return true;
        }
    }
    return false;
}

static bool suits_soft_contact(const pe_step *step, int k)
{
    const bool small = body_count(&step->islands, k) <= MOST_UNEVEN;
    return step->world->def.profile == PE_PROFILE_FAST && !is_quiet(step, k) && !bounces(step, k) &&
           !is_fast_and_small(step, k) &&
           !(small && pe_island_mass_ratio(step->world, &step->islands, k) > PE_UNEVEN);
}

/* Chooses the islands that get soft contacts. */
static pe_status choose_soft(pe_step *step)
{
    const pe_islands *islands = &step->islands;
    step->soft = pe_scratch(step->world, (size_t)islands->count + 1, sizeof *step->soft);
    if (step->soft == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for %d islands", islands->count);
    }
    for (int k = 0; k < islands->count; ++k) {
        step->soft[k] = suits_soft_contact(step, k);
        step->stats.islands_by_path[PE_PATH_SOFT] += step->soft[k];
    }
    return PE_OK;
}

/* ---- Tasks ---- */

/* Islands are gathered to tasks of at least so many points. One of LARGE_POINTS is a task by itself. */
enum { TASK_POINTS = 512, LARGE_POINTS = 4096 };

/* Islands of so few points are swept together, up to so many of them. */
enum { FEW_POINTS = 128, MANY_POINTS = 1024 };

/* Work on some islands, and what it came to. */
typedef struct task {
    int first, end; /* of the pass's islands or items */
    bool large;
    pe_status status;
    pe_error error;
    pe_step_stats stats;
    double residual_squares; /* as in pe_step */
    int residual_points;
    const pe_world *view; /* in which contacts were listed apart */
    int apart_begin, apart_end;
} task;

/* The tasks of one pass over the islands. */
typedef struct pass {
    pe_step *step;
    pe_status (*work)(pe_step *step, const struct pass *p, const task *t);
    const int *islands;     /* in the first pass: their numbers, those of a task after each other */
    pe_island_item **items; /* one for each island, NULL where it asks for no sweeps; in the second
                               pass all that do, those of a task after each other */
    task *tasks;
    int count;
} pass;

static void run_task(const pass *p, task *t, int worker)
{
    pe_world *view = pe_view_of(p->step->world, worker);
    pe_step step = *p->step;
    step.world = view;
    step.error = &t->error;
    step.stats = (pe_step_stats){0};
    step.residual_squares = 0;
    step.residual_points = 0;
    t->view = view;
    t->apart_begin = view->apart_count;
    t->status = p->work(&step, p, t);
    t->apart_end = view->apart_count;
    t->stats = step.stats;
    t->residual_squares = step.residual_squares;
    t->residual_points = step.residual_points;
}

static void run_small_tasks(void *context, int worker, int begin, int end)
{
    const pass *p = context;
    for (int i = begin; i < end; ++i) {
        if (!p->tasks[i].large) {
            run_task(p, &p->tasks[i], worker);
        }
    }
}

/* Adds what an island's solve, or a task, has counted to the counts of the step. */
static void add_counts(const pe_step_stats *one, pe_step_stats *all)
{
    all->iterations = one->iterations > all->iterations ? one->iterations : all->iterations;
    all->factor_flops += one->factor_flops;
    all->unconverged_islands += one->unconverged_islands;
    for (int i = 0; i < PE_PATH_COUNT; ++i) {
        all->islands_by_path[i] += one->islands_by_path[i];
    }
    if (one->path != PE_PATH_NONE &&
        (all->path == PE_PATH_NONE || !(one->residual <= all->residual))) {
        all->residual = one->residual;
        all->path = one->path;
        all->stop = one->stop;
        all->history_count = one->history_count;
        memcpy(all->history, one->history, sizeof all->history);
    }
}

/* Moves the contacts that a task has listed apart from its view to the world. */
static pe_status gather_apart(pe_world *world, const task *t, pe_error *error)
{
    const int more = t->apart_end - t->apart_begin;
    if (t->view == world || more == 0) {
        return PE_OK;
    }
    const size_t used = (size_t)world->apart_count;
    pe_status status = pe_array_reserve(&world->apart_array, &world->allocator, sizeof(pe_contact),
                                        used + (size_t)more, used, error);
    if (status == PE_OK) {
        memcpy((pe_contact *)world->apart_array.items + used,
               (const pe_contact *)t->view->apart_array.items + t->apart_begin,
               (size_t)more * sizeof(pe_contact));
        world->apart_count += more;
    }
    return status;
}

static pe_status gather(pe_step *step, const pass *p)
{
    for (int i = 0; i < p->count; ++i) {
        const task *t = &p->tasks[i];
        if (t->status != PE_OK) {
            if (step->error != NULL) {
                *step->error = t->error;
            }
            return t->status;
        }
        add_counts(&t->stats, &step->stats);
        step->residual_squares += t->residual_squares;
        step->residual_points += t->residual_points;
        pe_status status = gather_apart(step->world, t, step->error);
        if (status != PE_OK) {
            return status;
        }
    }
    return PE_OK;
}

/* Runs the tasks: the large ones first, one after the other. */
static pe_status run_pass(const pass *p)
{
    pe_world *world = p->step->world;
    for (int i = 0; i < p->count; ++i) {
        if (p->tasks[i].large) {
            pe_view_of(world, 0)->pool = world->pool;
            run_task(p, &p->tasks[i], 0);
        }
    }
    if (world->views != NULL) {
        pe_view_of(world, 0)->pool = NULL;
    }
    pe_pool_run(world->pool, p->count, 1, run_small_tasks, (void *)p);
    return gather(p->step, p);
}

/* Appends an item with so many points to the tasks: to the last one, unless that is full or the item
 * is to be swept by another group. */
static void add_to_tasks(pass *p, int item, int points, bool begins)
{
    const bool large = points >= LARGE_POINTS;
    if (p->count == 0 || begins || large || p->tasks[p->count - 1].large) {
        p->tasks[p->count++] = (task){.first = item, .large = large};
    }
    p->tasks[p->count - 1].end = item + 1;
}

/* ---- The first pass: all islands, up to their sweeps ---- */

static pe_status begin_islands(pe_step *step, const pass *p, const task *t)
{
    pe_world *world = step->world;
    pe_status status = PE_OK;
    for (int i = t->first; i < t->end && status == PE_OK; ++i) {
        /* Each island's numbers in the memory of the one before: it is in the cache. */
        pe_arena_mark before = pe_arena_fill(&world->arena);
        pe_island_item *item = pe_scratch(world, 1, sizeof *item);
        if (item == NULL) {
            return pe_fail(step->error, PE_NO_MEMORY, "no memory for an island");
        }
        status = begin_island(step, p->islands[i], item);
        p->items[i] = item->solving.sweeps > 0 ? item : NULL;
        if (p->items[i] == NULL) {
            pe_arena_rewind(&world->arena, &world->allocator, before);
        }
    }
    return status;
}

/* The contact points of island k. */
static int point_count(const pe_step *step, int k)
{
    int points = 0;
    for (int i = step->islands.start[k]; i < step->islands.start[k + 1]; ++i) {
        points += pe_manifolds(&step->world->contacts)[step->islands.manifolds[i]].count;
    }
    return points;
}

/* Lists the islands without soft contact, and divides them into tasks. Returns how many there are. */
static int plan_islands(const pe_step *step, int *islands, pass *p)
{
    int count = 0, points = 0;
    for (int k = 0; k < step->islands.count; ++k) {
        if (step->soft[k]) {
            continue;
        }
        const int more = point_count(step, k);
        islands[count] = k;
        add_to_tasks(p, count, more, points >= TASK_POINTS);
        points = p->tasks[p->count - 1].first == count ? more : points + more;
        count += 1;
    }
    return count;
}

/* ---- The second pass: groups of islands that are swept together ---- */

/* Whether an item joins those that are swept together, which begin with `first` and have so many
 * points. */
static bool joins(const pe_solving *first, int points, const pe_solving *s)
{
    int more = s->problem->point_count;
    return first->problem->point_count <= FEW_POINTS && more <= FEW_POINTS &&
           points + more <= MANY_POINTS && s->enough == first->enough && s->sweeps == first->sweeps;
}

/* Sweeps a group of items and ends them. */
static pe_status sweep_group(pe_step *step, const pass *p, const task *t)
{
    pe_world *world = step->world;
    pe_island_item **group = p->items + t->first;
    const int count = t->end - t->first;
    pe_arena_mark begun = pe_arena_fill(&world->arena);
    pe_solving **solving = pe_scratch(world, (size_t)count, sizeof(void *));
    if (solving == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to sweep %d islands", count);
    }
    for (int i = 0; i < count; ++i) {
        solving[i] = &group[i]->solving;
    }
    pe_arena_mark before = pe_arena_fill(&world->arena);
    pe_status status = pe_solving_sweep(solving, count, pe_step_memory(world), step->error);
    for (int i = 0; i < count && status == PE_OK; ++i) {
        pe_arena_rewind(&world->arena, &world->allocator, before);
        status = end_island(step, group[i]);
    }
    pe_arena_rewind(&world->arena, &world->allocator, begun);
    return status;
}

/* Makes tasks of the items that ask for sweeps: those that can be swept together are one. `items`
 * (count) is used up. */
static void plan_sweeps(pe_island_item **items, int count, pass *p)
{
    for (int left = 0, added = 0; count > 0; count = left) {
        const pe_solving *first = &items[0]->solving;
        int points = 0;
        bool begins = true;
        left = 0;
        for (int i = 0; i < count; ++i) {
            if (i == 0 || joins(first, points, &items[i]->solving)) {
                points += items[i]->solving.problem->point_count;
                p->items[added] = items[i];
                add_to_tasks(p, added++, first->problem->point_count, begins);
                begins = false;
            } else {
                items[left++] = items[i];
            }
        }
    }
}

/* Sweeps and ends the islands that asked for it in the first pass. */
static pe_status sweep_islands(pe_step *step, const pass *begun, int count)
{
    pe_island_item **asking = begun->items;
    int left = 0;
    for (int i = 0; i < count; ++i) {
        if (asking[i] != NULL) {
            asking[left++] = asking[i];
        }
    }
    pass p = {.step = step,
              .work = sweep_group,
              .items = pe_scratch(step->world, (size_t)left + 1, sizeof(void *)),
              .tasks = pe_scratch(step->world, (size_t)left + 1, sizeof(task))};
    if (pe_scratch_failed(step->world)) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to sweep %d islands", left);
    }
    plan_sweeps(asking, left, &p);
    return run_pass(&p);
}

pe_status pe_solve_islands(pe_step *step)
{
    pe_world *world = step->world;
    const size_t most = (size_t)step->islands.count + 1;
    /* Of two tasks that follow each other one is large, or the first is full. */
    const size_t tasks = 2 + 2 * (size_t)world->contacts.point_count / TASK_POINTS;
    pe_status status = choose_soft(step);
    int *islands = pe_scratch(world, most, sizeof *islands);
    step->held = pe_scratch_zero(world, most, sizeof *step->held);
    pass p = {.step = step,
              .work = begin_islands,
              .islands = islands,
              .items = pe_scratch(world, most, sizeof(void *)),
              .tasks = pe_scratch(world, tasks, sizeof(task))};
    if (status == PE_OK && pe_scratch_failed(world)) {
        status =
            pe_fail(step->error, PE_NO_MEMORY, "no memory for %d islands", step->islands.count);
    }
    if (status != PE_OK) {
        return status;
    }
    const int count = plan_islands(step, islands, &p);
    pe_views_open(world);
    status = run_pass(&p);
    if (status == PE_OK) {
        status = sweep_islands(step, &p, count);
    }
    if (status == PE_OK && step->stats.islands_by_path[PE_PATH_SOFT] > 0) {
        status = pe_soft_step(world, &(pe_chosen_islands){&step->islands, step->soft}, step->dt,
                              NULL, NULL, step->error);
    }
    if (step->residual_points > 0) {
        step->stats.residual_rms = sqrt(step->residual_squares / step->residual_points);
    }
    return status;
}
