#include "project.h"

#include "integrate.h"

#include <string.h>

/* Separation of a contact at the poses now: of its two surface points, along its normal. */
static double separation_now(const pe_world *world, const pe_manifold *m, const pe_point *point)
{
    const pe_pose *a = &pe_poses(world)[m->a], *b = &pe_poses(world)[m->b];
    pe_vec3 on_a = pe_add(a->position, pe_rotate(&a->rotation, point->anchor_a));
    pe_vec3 on_b = pe_add(b->position, pe_rotate(&b->rotation, point->anchor_b));
    return pe_dot(m->normal, pe_sub(on_b, on_a));
}

/* How far J_n d + bias >= 0 is from being met. */
typedef struct violation {
    double deepest, squares; /* m; sum of squares over the contacts, m^2 */
} violation;

static violation measure(const pe_problem *island)
{
    violation v = {0};
    for (int i = 0; i < island->count; ++i) {
        const pe_row *row = &island->rows[i];
        double u =
            row->bias + pe_row_velocity(row, 0, island->velocity[row->a], island->velocity[row->b]);
        if (u < 0) {
            v.deepest = pe_max(v.deepest, -u);
            v.squares += u * u;
        }
    }
    return v;
}

static void sweep(const pe_problem *island)
{
    for (int i = 0; i < island->count; ++i) {
        const pe_row *row = &island->rows[i];
        double *ya = island->velocity[row->a], *yb = island->velocity[row->b];
        double *p = island->impulse[i];
        double n =
            pe_max(0, p[0] - (row->bias + pe_row_velocity(row, 0, ya, yb)) * row->inverse_wnn);
        if (n != p[0]) {
            pe_row_add(ya, n - p[0], row->ja[0]);
            pe_row_add(yb, n - p[0], row->jb[0]);
            p[0] = n;
        }
    }
}

/* Sets one line of an array for every body of the island. */
static void copy_lines(const pe_problem *island, double (*to)[PE_LANES], double (*from)[PE_LANES])
{
    for (int i = 0; i < island->count; ++i) {
        memcpy(to[island->rows[i].a], from[island->rows[i].a], sizeof *to);
        memcpy(to[island->rows[i].b], from[island->rows[i].b], sizeof *to);
    }
}

static void clear(const pe_problem *island, double (*lines)[PE_LANES])
{
    for (int i = 0; i < island->count; ++i) {
        memset(lines[island->rows[i].a], 0, sizeof *lines);
        memset(lines[island->rows[i].b], 0, sizeof *lines);
    }
}

/* Sweeps between two looks at the violation, and the gain at a look without which it is not worth
 * more. */
enum { LOOK_INTERVAL = 5 };
static const double LEAST_GAIN = 0.05;

/* Finds displacements with the least sum of squared violations into `best`; returns the sweeps
 * made. The sum, not the deepest: one contact that is jammed must not keep the others from being
 * mended. */
static int solve(const pe_problem *island, double (*best)[PE_LANES], double enough, int most)
{
    clear(island, island->velocity);
    clear(island, best);
    memset(island->impulse, 0, (size_t)island->count * sizeof *island->impulse);
    violation least = measure(island);
    int iterations = 0;
    while (iterations < most && least.deepest > enough) {
        for (int i = 0; i < LOOK_INTERVAL && iterations < most; ++i, ++iterations) {
            sweep(island);
        }
        violation now = measure(island);
        bool worth_more = now.squares < (1 - LEAST_GAIN) * least.squares;
        if (now.squares < least.squares) {
            least = now;
            copy_lines(island, best, island->velocity);
        }
        if (!worth_more) {
            break;
        }
    }
    return iterations;
}

/* Applies the displacement of one body once: its line is cleared. The rows are in the axes that the
 * body had at the start of the step; to turn back by those of now errs by the rotation of one step,
 * on a correction that is of the order of the slop. */
static void displace(pe_world *world, int slot, double y[PE_LANES])
{
    const pe_mass *mass = &pe_masses(world)[slot];
    pe_pose *pose = &pe_poses(world)[slot];
    pe_vec3 turn = pe_mul(mass->inverse_root_inertia, pe_v3(y[3], y[4], y[5]));
    pe_pose_move(pose, pe_scale(mass->inverse_root_mass, pe_v3(y[0], y[1], y[2])),
                 pe_rotate(&pose->rotation, turn));
    memset(y, 0, PE_LANES * sizeof *y);
}

void pe_project_positions(pe_world *world, const pe_islands *islands, pe_problems *problems,
                          pe_project_report *report)
{
    *report = (pe_project_report){0};
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    const pe_point *points = pe_points(&world->contacts);
    double slop = world->def.penetration_slop, aim = slop / 3;
    for (int k = 0; k < islands->count; ++k) {
        pe_problem island = pe_problems_island(problems, k);
        int first = problems->row_start[k];
        double deepest = 0;
        for (int i = 0; i < island.count; ++i) {
            const pe_manifold *m = &manifolds[problems->manifold_of[first + i]];
            double gap = separation_now(world, m, &points[problems->point_of[first + i]]);
            island.rows[i].bias = gap + aim;
            deepest = pe_max(deepest, -gap);
        }
        report->penetration = pe_max(report->penetration, deepest);
        if (deepest <= slop) {
            continue;
        }
        int iterations =
            solve(&island, problems->spare, aim / 2, world->def.max_projection_iterations);
        report->iterations = iterations > report->iterations ? iterations : report->iterations;
        for (int i = 0; i < island.count; ++i) {
            displace(world, island.rows[i].a, problems->spare[island.rows[i].a]);
            displace(world, island.rows[i].b, problems->spare[island.rows[i].b]);
        }
    }
}
