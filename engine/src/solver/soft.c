#include "soft.h"

#include "soft_kernel.h"

pe_soft_settings pe_soft_settings_default(void)
{
    return (pe_soft_settings){
        .longest_substep = 1.0 / 480,
        .max_substeps = 12,
        .cycles = 1.0 / 8,
        .damping = 10,
        .push_speed = 0.5,
    };
}

/* The widest kernel that the processor runs, up to `lanes` unless that is 0. */
static const pe_soft_kernel *choose_kernel(int lanes)
{
#ifdef PE_SOFT_X86
    if ((lanes == 0 || lanes >= 8) && __builtin_cpu_supports("avx512f")) {
        return &pe_soft_kernel_8;
    }
    if ((lanes == 0 || lanes >= 4) && __builtin_cpu_supports("avx2")) {
        return &pe_soft_kernel_4;
    }
#else
    (void)lanes;
#endif
    return &pe_soft_kernel_1;
}

/* A substep that is longer by rounding alone does not cost another. */
static int count_substeps(double dt, const pe_soft_settings *settings)
{
    double needed = ceil(dt / settings->longest_substep - 1e-6);
    return needed < 1 ? 1 : needed > settings->max_substeps ? settings->max_substeps : (int)needed;
}

/* A spring of angular frequency w and damping ratio z, stepped by implicit Euler (Catto 2011):
 * with a = 2 z + h w, its coefficients are w/a, h w a/(1 + h w a) and 1/(1 + h w a). */
static pe_soft_spring make_spring(double frequency, double damping, double h)
{
    const double two_pi = 6.283185307179586;
    double w = two_pi * frequency, a = 2 * damping + h * w, scale = 1 / (1 + h * w * a);
    return (pe_soft_spring){w / a, h * w * a * scale, scale};
}

/* Takes the arrays of the kernel's own items. */
static pe_status take_blocks(pe_world *world, const pe_soft_kernel *kernel, pe_soft_task *task,
                             pe_error *error)
{
    size_t blocks = 1, rows = 1, friction_blocks = 1, friction_rows = 1;
    for (int q = 0; q < task->plan->batch_count; ++q) {
        const pe_soft_batch *batch = &task->plan->batches[q];
        size_t lanes = batch->serial ? 1 : (size_t)kernel->lanes;
        size_t count = ((size_t)batch->count + lanes - 1) / lanes, points = (size_t)batch->points;
        blocks += count;
        rows += count * points;
        friction_blocks += batch->rough ? count : 0;
        friction_rows += batch->rough ? count * points : 0;
    }
    task->blocks = pe_scratch(world, blocks, kernel->block_size);
    task->rows = pe_scratch(world, rows, kernel->row_size);
    task->friction_blocks = pe_scratch(world, friction_blocks, kernel->friction_block_size);
    task->friction_rows = pe_scratch(world, friction_rows, kernel->friction_row_size);
    bool whole = task->blocks != NULL && task->rows != NULL && task->friction_blocks != NULL &&
                 task->friction_rows != NULL;
    if (whole && task->plan->bounces) {
        task->bounces = pe_scratch(world, rows, kernel->bounce_size);
        whole = task->bounces != NULL;
    }
    return whole ? PE_OK
                 : pe_fail(error, PE_NO_MEMORY, "no memory for %zu contact points",
                           rows * (size_t)kernel->lanes);
}

static void run(const pe_soft_kernel *kernel, pe_soft_task *task)
{
    kernel->prepare(task);
    for (int s = 0; s < task->substeps; ++s) {
        kernel->advance(task);
        if (s == 0) {
            kernel->warm(task);
        }
        kernel->bias(task);
        kernel->drift(task);
        kernel->relax(task);
    }
    if (task->bounces != NULL) {
        kernel->bounce(task);
    }
    kernel->store(task);
}

pe_status pe_soft_step_with(pe_world *world, const pe_islands *islands, const bool *chosen,
                            double dt, const pe_soft_settings *settings, pe_soft_report *report,
                            pe_error *error)
{
    const pe_soft_kernel *kernel = choose_kernel(settings->lanes);
    int substeps = count_substeps(dt, settings);
    double h = dt / substeps;
    pe_solver_bodies lines;
    pe_soft_plan plan;
    pe_soft_task task = {
        .manifolds = pe_manifolds(&world->contacts),
        .points = pe_manifold_points(&world->contacts),
        .plan = &plan,
        .lines = &lines,
        .substeps = substeps,
        .substep = h,
        .push_speed = settings->push_speed,
        .threshold = world->def.restitution_threshold,
        .spring = make_spring(settings->cycles / h, settings->damping, h),
        /* What stands on the ground carries the most, and has only one body to move. */
        .hard_spring = make_spring(2 * settings->cycles / h, 0.5 * settings->damping, h),
    };
    pe_status status = pe_solver_bodies_take(world, islands, chosen, &lines, error);
    if (status == PE_OK) {
        status = pe_soft_plan_make(world, islands, chosen, &lines, &plan, error);
    }
    if (status == PE_OK) {
        status = take_blocks(world, kernel, &task, error);
    }
    if (status != PE_OK) {
        return status;
    }
    pe_solver_bodies_fill(world, dt, h, &lines);
    run(kernel, &task);
    pe_solver_bodies_apply(world, &lines);
    if (report != NULL) {
        *report = (pe_soft_report){
            .substeps = substeps,
            .lanes = kernel->lanes,
            .bodies = lines.count - 1,
            .manifolds = plan.count,
            .points = plan.points,
            .colours = plan.colours,
            .penetration = task.penetration,
        };
    }
    return PE_OK;
}

pe_status pe_soft_step(pe_world *world, const pe_islands *islands, const bool *chosen, double dt,
                       pe_soft_report *report, pe_error *error)
{
    pe_soft_settings settings = pe_soft_settings_default();
    return pe_soft_step_with(world, islands, chosen, dt, &settings, report, error);
}
