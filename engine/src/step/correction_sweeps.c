/* The contact problem of a position correction, and the sweeps over the violated part of an island. */
#include "correction.h"

#include "solver/kernels.h"

#include <stdatomic.h>
#include <string.h>

/* Manifolds or bodies of a piece, when those to be swept are chosen. */
enum { CHOICE_GRAIN = 512 };

/* Sweeps between two looks at the violation, after which more bodies may be swept. */
enum { LOOK_INTERVAL = 10 };

/* A body takes its other contacts into the sweeps when a point of it has moved by this part of
 * rules->enough. */
static const double REACHED = 0.3;

/* In units of the deepest penetration of its island: a gap that no push closes. */
static const double FAR = 4;

/* A larger part of an island is swept as the whole of it. */
static const double MOST_CHOSEN = 0.5;

/* ---- The problem ---- */

/* The most depth that a contact asks to be removed, in m. */
static double most_removed(const pe_correction *c, const pe_correction_contact *contact)
{
    double a = contact->a < 0 ? HUGE_VAL : pe_correction_way(c, contact->a);
    double b = contact->b < 0 ? HUGE_VAL : pe_correction_way(c, contact->b);
    return contact->left_alone ? 0 : pe_min(a, b);
}

/* A problem of the correction. */
typedef struct building {
    const pe_correction *c;
    const pe_island_problem *built;
} building;

/* Takes friction from manifolds, and puts the gaps in the place of the biases. */
static void set_gaps(void *context, int worker, int begin, int end)
{
    (void)worker;
    const building *b = context;
    const pe_correction *c = b->c;
    const pe_problem *problem = &b->built->problem;
    for (int i = begin; i < end; ++i) {
        pe_solver_manifold *manifold = &problem->manifold[i];
        const double least = -most_removed(c, &c->contacts[b->built->source[i]]);
        manifold->friction = 0;
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            double gap = pe_manifold_points(&c->world->contacts)[b->built->point_of[j]].separation;
            problem->point[j].bias = pe_max(gap + c->rules->aim, least);
        }
    }
}

pe_status pe_correction_build(const pe_correction *c, const pe_islands *islands, int k,
                              pe_island_problem *built)
{
    pe_status status = pe_problem_build(
        c->world, &(pe_interval){.islands = islands, .k = k, .dt = 1}, built, c->error);
    if (status == PE_OK) {
        building b = {c, built};
        pe_pool_run(built->problem.pool, built->problem.manifold_count, PE_MANIFOLD_GRAIN, set_gaps,
                    &b);
    }
    return status;
}

/* Sums of squared violations, by pieces of the manifolds: at most so many, of at least so many
 * manifolds. */
typedef struct comparison {
    const pe_problem *problem;
    const bool *chosen;
    int grain;
    double after[PE_MOST_SUMS], before[PE_MOST_SUMS];
} comparison;

static void compare_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    comparison *s = context;
    const pe_problem *problem = s->problem;
    double after = 0, before = 0;
    for (int i = begin; i < end; ++i) {
        const pe_solver_manifold *m = &problem->manifold[i];
        double q[6], u[3];
        if (s->chosen != NULL && !s->chosen[i]) {
            continue;
        }
        pe_solver_manifold_twist(m, (const double(*)[6])problem->velocity, q);
        for (int j = m->first; j < m->first + m->count; ++j) {
            pe_point_velocity(&problem->point[j], q, u);
            double depth = pe_max(-u[0], 0), depth_before = pe_max(-problem->point[j].bias, 0);
            after += depth * depth;
            before += depth_before * depth_before;
        }
    }
    s->after[begin / s->grain] = after;
    s->before[begin / s->grain] = before;
}

bool pe_correction_is_better(const pe_problem *problem, const bool *chosen)
{
    const int count = problem->manifold_count;
    comparison s = {problem, chosen, pe_sum_grain(count), {0}, {0}};
    pe_pool_run(problem->pool, count, s.grain, compare_manifolds, &s);
    double after = 0, before = 0;
    for (int i = 0; i < pe_piece_count(count, s.grain); ++i) {
        after += s.after[i];
        before += s.before[i];
    }
    return after < before;
}

/* ---- Sweeping the violated part of an island ---- */

/* Activates the bodies of violated contacts of island k. */
static void activate_violated(const pe_correction *c, int k)
{
    double depth = c->rules->aim + 0.5 * c->rules->enough;
    for (int i = c->islands->start[k]; i < c->islands->start[k + 1]; ++i) {
        const pe_correction_contact *contact = &c->contacts[c->islands->manifolds[i]];
        const int slots[2] = {contact->a, contact->b};
        for (int side = 0; side < 2 && pe_max(0, -contact->separation) > depth; ++side) {
            if (slots[side] >= 0) {
                c->active[slots[side]] = true;
            }
        }
    }
}

static void add_near_body(pe_correction *c, int slot)
{
    pe_islands *near = &c->near;
    if (slot >= 0 && near->place[slot] < 0) {
        near->place[slot] = near->body_start[1];
        near->bodies[near->body_start[1]++] = slot;
    }
}

/* Lists the manifolds of island k that a push may close, and their bodies, in c->near. */
static void list_near(pe_correction *c, int k)
{
    pe_islands *near = &c->near;
    const double far = FAR * pe_correction_depth(c, c->islands, k, false);
    for (int i = 0; i < near->body_start[1]; ++i) {
        near->place[near->bodies[i]] = -1;
    }
    near->start[1] = near->body_start[1] = 0;
    for (int i = c->islands->start[k]; i < c->islands->start[k + 1]; ++i) {
        const int index = c->islands->manifolds[i];
        const pe_correction_contact *contact = &c->contacts[index];
        if (contact->separation < far) {
            near->manifolds[near->start[1]++] = index;
            add_near_body(c, contact->a);
            add_near_body(c, contact->b);
        }
    }
}

/* Which part of the problem of c->near is swept. */
typedef struct choice {
    const pe_correction *c;
    const pe_island_problem *built;
    bool *chosen; /* (manifolds); NULL: all of them, which nothing can be added to */
    const pe_solver_body *displacement;
    atomic_bool grown;
} choice;

static void choose_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    const choice *s = context;
    const pe_problem *problem = &s->built->problem;
    const bool *active = s->c->active;
    for (int i = begin; i < end; ++i) {
        const int a = problem->manifold[i].a, b = problem->manifold[i].b;
        s->chosen[i] = (a < problem->body_count && active[s->built->slot[a]]) ||
                       (b < problem->body_count && active[s->built->slot[b]]);
    }
}

/* Chooses the manifolds of active bodies; all of them, where these are most: then it costs less to
 * sweep the others too than to lay out the problem again whenever the part grows. */
static void choose_swept(choice *s)
{
    const int count = s->built->problem.manifold_count;
    if (s->chosen == NULL) {
        return;
    }
    pe_pool_run(s->built->problem.pool, count, CHOICE_GRAIN, choose_manifolds, s);
    int chosen = 0;
    for (int i = 0; i < count; ++i) {
        chosen += s->chosen[i];
    }
    if (chosen > MOST_CHOSEN * count) {
        s->chosen = NULL;
    }
}

static void activate_pushed(void *context, int worker, int begin, int end)
{
    (void)worker;
    choice *s = context;
    const pe_correction *c = s->c;
    const double enough = REACHED * c->rules->enough;
    for (int i = begin; i < end; ++i) {
        int slot = s->built->slot[i];
        const double *d = s->displacement[i].linear, *r = s->displacement[i].angular;
        double radius = pe_bodies(c->world)[slot].bounding_radius;
        double most = sqrt(pe_dot3(d, d)) + radius * sqrt(pe_dot3(r, r));
        if (!c->active[slot] && most > enough) {
            c->active[slot] = true;
            atomic_store_explicit(&s->grown, true, memory_order_relaxed);
        }
    }
}

/* Activates the bodies that have been pushed; returns whether there is a new one. */
static bool activate_reached(choice *s, const pe_solver_body *displacement)
{
    s->displacement = displacement;
    s->grown = false;
    if (s->chosen == NULL) {
        return false;
    }
    pe_pool_run(s->built->problem.pool, s->built->problem.body_count, CHOICE_GRAIN, activate_pushed,
                s);
    return s->grown;
}

/* Sweeps the chosen manifolds of the problem until they are solved or other bodies are reached. Leaves
 * the best impulses found. */
static pe_status sweep_chosen(pe_correction *c, choice *s, pe_momentum *momentum, int *sweeps,
                              bool *grown)
{
    const pe_island_problem *built = s->built;
    pe_sweep sweep;
    if (*sweeps > 0) { /* until then impulses and velocities are 0 */
        pe_problem_rebuild_velocity(&built->problem);
    }
    pe_status status = pe_sweep_create_normals(&built->problem, s->chosen, pe_kernels_for(0)->sweep,
                                               pe_step_memory(c->world), &sweep, c->error);
    if (status != PE_OK) {
        return status;
    }
    const pe_sweep_part whole = pe_sweep_whole(&sweep);
    pe_violation best = pe_sweep_violation(&sweep);
    if (*sweeps == 0) {
        *momentum = pe_momentum_begin(best.deepest);
    }
    *grown = false;
    while (!*grown && *sweeps < c->rules->max_sweeps && best.deepest > c->rules->enough) {
        for (int i = 0; i < LOOK_INTERVAL; ++i) {
            pe_sweep_set_beta(&sweep, &whole, pe_momentum_next(momentum));
            pe_sweep_normals(&sweep);
        }
        *sweeps += LOOK_INTERVAL;
        pe_violation now = pe_sweep_violation(&sweep);
        pe_momentum_look(momentum, LOOK_INTERVAL, now.deepest);
        *grown = activate_reached(s, sweep.velocity);
        if (now.squares < best.squares || *grown) {
            best = now;
            pe_sweep_store(&sweep, &whole);
        }
    }
    return PE_OK;
}

pe_status pe_correction_sweep(pe_correction *c, int k, pe_island_problem *built, bool *better)
{
    activate_violated(c, k);
    list_near(c, k);
    pe_status status = pe_correction_build(c, &c->near, 0, built);
    if (status != PE_OK) {
        return status;
    }
    bool *chosen = pe_scratch(c->world, (size_t)built->problem.manifold_count + 1, sizeof *chosen);
    if (chosen == NULL) {
        return pe_fail(c->error, PE_NO_MEMORY, "no memory to sweep %d contact points",
                       built->problem.point_count);
    }
    choice s = {.c = c, .built = built, .chosen = chosen};
    choose_swept(&s);
    pe_momentum momentum;
    int sweeps = 0;
    pe_arena_mark before = pe_arena_fill(&c->world->arena);
    for (bool grown = true; grown && sweeps < c->rules->max_sweeps && status == PE_OK;) {
        pe_arena_rewind(&c->world->arena, &c->world->allocator, before);
        status = sweep_chosen(c, &s, &momentum, &sweeps, &grown);
        choose_swept(&s);
    }
    pe_problem_rebuild_velocity(&built->problem);
    *better = status == PE_OK && pe_correction_is_better(&built->problem, s.chosen);
    c->iterations = sweeps > c->iterations ? sweeps : c->iterations;
    return status;
}

pe_status pe_correction_begin_sweeps(pe_correction *c)
{
    pe_world *world = c->world;
    c->active = pe_scratch_zero(world, (size_t)world->slot_count, sizeof *c->active);
    pe_islands_take(world, (size_t)world->contacts.manifold_count, &c->near);
    c->near.count = 1;
    if (pe_scratch_failed(world)) {
        return pe_fail(c->error, PE_NO_MEMORY, "no memory to move %d contact points apart",
                       world->contacts.point_count);
    }
    c->near.start[0] = c->near.start[1] = c->near.body_start[0] = c->near.body_start[1] = 0;
    memset(c->near.place, -1, (size_t)world->slot_count * sizeof *c->near.place);
    return PE_OK;
}
