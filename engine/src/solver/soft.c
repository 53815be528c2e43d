#include "soft.h"

#include "kernels.h"

#include <math.h>
#include <string.h>

/* ---- The plan ---- */

enum {
    COLOURS = PE_COLOURS,       /* bits of a mask; the last one is serial */
    KINDS = 4 * PE_SOFT_POINTS, /* points x hard x rough */
    BATCHES = COLOURS * KINDS
};

/* Position of the lowest bit that is 0, or of the last one if there is none. In walls and piles it
 * is nearly always below 8. */
static int lowest_free(uint64_t mask)
{
    int colour = 0;
    while (colour < COLOURS - 1 && (mask >> colour & 1)) {
        ++colour;
    }
    return colour;
}

/* The batch of a contact: colour by colour, most points first. */
static int batch_of(int colour, const pe_soft_contact *contact, bool rough)
{
    bool hard = contact->a == 0 || contact->b == 0;
    return colour * KINDS + 4 * (PE_SOFT_POINTS - contact->count) + 2 * hard + rough;
}

/* The number of contacts that a manifold is solved as. */
static int parts_of(const pe_manifold *m)
{
    return (m->count + PE_SOFT_POINTS - 1) / PE_SOFT_POINTS;
}

/* The plan while it is made: contacts in the manifolds' order. */
typedef struct draft {
    const pe_solver_bodies *bodies;
    uint64_t *mask; /* (bodies): colours that each body has */
    pe_soft_contact *contacts;
    int *batch; /* of each contact */
} draft;

static void add_manifold(const pe_world *world, int index, const draft *d, pe_soft_plan *plan)
{
    const pe_manifold *m = &pe_manifolds(&world->contacts)[index];
    int a = d->bodies->index_of[m->a], b = d->bodies->index_of[m->b], parts = parts_of(m);
    for (int part = 0; part < parts; ++part) {
        pe_soft_contact *contact = &d->contacts[plan->count];
        *contact = (pe_soft_contact){.manifold = index, .a = a, .b = b};
        /* Points in turn, so that each part spans the whole. */
        for (int j = part; j < m->count; j += parts) {
            contact->point[contact->count++] = m->first + j;
        }
        int colour = lowest_free(d->mask[a] | d->mask[b]);
        d->mask[a] |= (uint64_t)(a != 0) << colour;
        d->mask[b] |= (uint64_t)(b != 0) << colour;
        d->batch[plan->count++] = batch_of(colour, contact, m->friction > 0);
        plan->colours = colour >= plan->colours ? colour + 1 : plan->colours;
        plan->points += contact->count;
    }
}

/* A counting sort of the contacts by batch, which keeps their order within a batch. */
static void sort_into_batches(const draft *d, pe_soft_plan *plan)
{
    int size[BATCHES] = {0}, next[BATCHES];
    for (int i = 0; i < plan->count; ++i) {
        size[d->batch[i]] += 1;
    }
    int first = 0;
    for (int q = 0; q < plan->colours * KINDS; ++q) {
        next[q] = first;
        if (size[q] > 0) {
            plan->batches[plan->batch_count++] = (pe_soft_batch){
                .first = first,
                .count = size[q],
                .points = PE_SOFT_POINTS - q % KINDS / 4,
                .hard = q / 2 % 2 == 1,
                .rough = q % 2 == 1,
                .serial = q / KINDS == COLOURS - 1,
                .colour = q / KINDS,
            };
            first += size[q];
        }
    }
    for (int i = 0; i < plan->count; ++i) {
        plan->contacts[next[d->batch[i]]++] = d->contacts[i];
    }
}

pe_status pe_soft_plan_make(pe_world *world, const pe_chosen_islands *chosen,
                            const pe_solver_bodies *bodies, pe_soft_plan *plan, pe_error *error)
{
    const pe_islands *islands = chosen->islands;
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    size_t count = 0;
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->start[k]; chosen->chosen[k] && i < islands->start[k + 1]; ++i) {
            count += (size_t)parts_of(&manifolds[islands->manifolds[i]]);
        }
    }
    *plan = (pe_soft_plan){
        .contacts = pe_scratch(world, count + 1, sizeof *plan->contacts),
        .batches = pe_scratch(world, BATCHES, sizeof *plan->batches),
    };
    draft d = {
        .bodies = bodies,
        .mask = pe_scratch(world, (size_t)bodies->count, sizeof *d.mask),
        .contacts = pe_scratch(world, count + 1, sizeof *d.contacts),
        .batch = pe_scratch(world, count + 1, sizeof *d.batch),
    };
    if (plan->contacts == NULL || plan->batches == NULL || d.mask == NULL || d.contacts == NULL ||
        d.batch == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the order of %zu contacts", count);
    }
    memset(d.mask, 0, (size_t)bodies->count * sizeof *d.mask);
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->start[k]; chosen->chosen[k] && i < islands->start[k + 1]; ++i) {
            add_manifold(world, islands->manifolds[i], &d, plan);
        }
    }
    sort_into_batches(&d, plan);
    return PE_OK;
}

/* ---- The step ---- */

enum { NARROW = 4 }; /* lanes */

/* A colour of fewer contacts is not worth sharing; bodies of a piece. */
enum { SHARED_CONTACTS = 256, BODY_GRAIN = 256 };

pe_soft_settings pe_soft_settings_default(void)
{
    return (pe_soft_settings){
        .substeps = 10,
        .least_substeps = 6,
        .most_substeps = 12,
        .cycles = 0.2,
        .damping = 5,
        .push_speed = 0.5,
    };
}

/* The slack keeps a sub-step that is too long only by rounding from costing another one. */
static int count_substeps(double dt, const pe_soft_settings *settings)
{
    int needed = (int)ceil(settings->substeps * sqrt(60 * dt) - 1e-6);
    needed = needed > settings->most_substeps ? settings->most_substeps : needed;
    return needed < settings->least_substeps ? settings->least_substeps : needed;
}

/* A spring of angular frequency w and damping ratio z, stepped by implicit Euler (Catto 2011): with
 * a = 2 z + h w, its coefficients are w/a, h w a/(1 + h w a) and 1/(1 + h w a). */
static pe_soft_spring make_spring(double frequency, double damping, double h)
{
    const double two_pi = 6.283185307179586;
    double w = two_pi * frequency, a = 2 * damping + h * w, scale = 1 / (1 + h * w * a);
    return (pe_soft_spring){w / a, h * w * a * scale, scale};
}

/* Takes the arrays of the kernel's own items, and plans the stages of the sweeps. */
static pe_status take_blocks(pe_world *world, const pe_kernels *kernels, pe_soft_task *task,
                             pe_error *error)
{
    const pe_soft_kernel *kernel = kernels->soft;
    size_t blocks = 0, rows = 0, friction_blocks = 0, friction_rows = 0, begin = 0;
    for (int q = 0; q < task->plan->batch_count; ++q) {
        const pe_soft_batch *batch = &task->plan->batches[q];
        const bool ends = q + 1 == task->plan->batch_count || batch[1].colour != batch->colour;
        size_t lanes = batch->serial ? 1 : (size_t)kernels->lanes;
        size_t count = ((size_t)batch->count + lanes - 1) / lanes, points = (size_t)batch->points;
        blocks += count;
        rows += count * points;
        friction_blocks += batch->rough ? count : 0;
        friction_rows += batch->rough ? count * points : 0;
        if (ends) {
            const bool shared = !batch->serial && (blocks - begin) * lanes >= SHARED_CONTACTS;
            pe_stages_add(&task->stages, (int)begin, (int)blocks, shared);
            begin = blocks;
        }
    }
    task->blocks = pe_scratch(world, blocks + 1, kernel->block_size);
    task->rows = pe_scratch(world, rows + 1, kernel->row_size);
    task->friction_blocks = pe_scratch(world, friction_blocks + 1, kernel->friction_block_size);
    task->friction_rows = pe_scratch(world, friction_rows + 1, kernel->friction_row_size);
    task->depth = pe_scratch(world, blocks / PE_SOFT_GRAIN + 1, sizeof *task->depth);
    if (pe_scratch_failed(world)) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points",
                       rows * (size_t)kernels->lanes);
    }
    return PE_OK;
}

/* A piece of the blocks or bodies. */
typedef struct pieces {
    const pe_soft_task *task;
    pe_soft_work *work;
} pieces;

static void run_piece(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pieces *p = context;
    p->work(p->task, begin, end);
}

/* Runs work on all blocks in any order. */
static void run_blocks(const pe_soft_task *task, pe_soft_work *work)
{
    pieces p = {task, work};
    pe_pool_run(task->pool, task->block_count, PE_SOFT_GRAIN, run_piece, &p);
}

/* Runs work on all bodies in any order. */
static void run_bodies(const pe_soft_task *task, pe_soft_work *work)
{
    pieces p = {task, work};
    pe_pool_run(task->pool, task->bodies->count, BODY_GRAIN, run_piece, &p);
}

/* Runs work on all blocks, colour by colour. */
static void run_colours(const pe_soft_task *task, pe_soft_work *work)
{
    pieces p = {task, work};
    pe_stages_run(&task->stages, task->pool, PE_SOFT_GRAIN, run_piece, &p);
}

static void run(const pe_soft_kernel *kernel, pe_soft_task *task)
{
    kernel->lay_out(task);
    run_blocks(task, kernel->prepare);
    for (int s = 0; s < task->substeps; ++s) {
        run_bodies(task, kernel->integrate_velocities);
        if (s == 0) {
            run_colours(task, kernel->warm_start);
        }
        run_colours(task, kernel->bias);
        run_bodies(task, kernel->integrate_positions);
        run_colours(task, kernel->relax);
    }
    run_blocks(task, kernel->store);
}

/* The deepest overlap, in m. */
static double penetration_of(const pe_soft_task *task)
{
    double deepest = 0;
    for (int i = 0; i < pe_piece_count(task->block_count, PE_SOFT_GRAIN); ++i) {
        deepest = pe_max(deepest, task->depth[i]);
    }
    return deepest;
}

/* How many blocks of so many lanes the plan takes. */
static int count_blocks(const pe_soft_plan *plan, int lanes)
{
    int blocks = 0;
    for (int q = 0; q < plan->batch_count; ++q) {
        blocks += pe_piece_count(plan->batches[q].count, plan->batches[q].serial ? 1 : lanes);
    }
    return blocks;
}

/* The kernels for so many lanes; 0: for the plan. Few contacts leave most of eight lanes empty, and a block
 * of four costs less. The bits are the same. */
static const pe_kernels *choose_kernels(const pe_soft_plan *plan, int lanes)
{
    const pe_kernels *widest = pe_kernels_for(lanes);
    const bool few = 4 * count_blocks(plan, NARROW) <= 5 * count_blocks(plan, widest->lanes);
    return lanes == 0 && widest->lanes > NARROW && few ? pe_kernels_for(NARROW) : widest;
}

pe_status pe_soft_step(pe_world *world, const pe_chosen_islands *islands, double dt,
                       const pe_soft_settings *given, pe_soft_report *report, pe_error *error)
{
    const pe_soft_settings settings = given != NULL ? *given : pe_soft_settings_default();
    const pe_kernels *kernels = NULL;
    int substeps = count_substeps(dt, &settings);
    double h = dt / substeps;
    pe_solver_bodies bodies;
    pe_soft_plan plan;
    pe_soft_task task = {
        .manifolds = pe_manifolds(&world->contacts),
        .points = pe_manifold_points(&world->contacts),
        .plan = &plan,
        .bodies = &bodies,
        .pool = world->pool,
        .substeps = substeps,
        .substep = h,
        .push_speed = settings.push_speed,
        .spring = make_spring(settings.cycles / h, settings.damping, h),
        /* A contact with the ground carries the most, and moves only one body. */
        .hard_spring = make_spring(2 * settings.cycles / h, 0.5 * settings.damping, h),
    };
    pe_status status = pe_solver_bodies_take(world, islands, &bodies, error);
    if (status == PE_OK) {
        status = pe_soft_plan_make(world, islands, &bodies, &plan, error);
    }
    if (status == PE_OK) {
        kernels = choose_kernels(&plan, settings.lanes);
        status = take_blocks(world, kernels, &task, error);
    }
    if (status != PE_OK) {
        return status;
    }
    pe_solver_bodies_fill(world, dt, h, &bodies);
    run(kernels->soft, &task);
    pe_solver_bodies_apply(world, &bodies);
    if (report != NULL) {
        *report = (pe_soft_report){
            .substeps = substeps,
            .lanes = kernels->lanes,
            .bodies = bodies.count - 1,
            .manifolds = plan.count,
            .points = plan.points,
            .colours = plan.colours,
            .penetration = penetration_of(&task),
        };
    }
    return PE_OK;
}
