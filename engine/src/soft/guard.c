#include "soft/guard.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Both are of the bodies with lines first .. end - 1. */
static double kinetic_energy(const pe_lines *lines, int first, int end)
{
    double twice = 0;
    for (int i = first; i < end; ++i) {
        const pe_line *v = &lines->velocity[i];
        twice += dot(v->linear, v->linear) / v->inverse_mass + dot(v->angular, v->angular);
    }
    return 0.5 * twice;
}

static double work_of_loads(const pe_lines *lines, int first, int end)
{
    double work = 0;
    for (int i = first; i < end; ++i) {
        const pe_line *load = &lines->load[i], *moved = &lines->displacement[i];
        work += dot(load->linear, moved->linear) / lines->velocity[i].inverse_mass +
                dot(load->angular, moved->angular);
    }
    return work;
}

static void scale(const pe_lines *lines, int first, int end, double factor)
{
    for (int i = first; i < end; ++i) {
        for (int k = 0; k < 3; ++k) {
            lines->velocity[i].linear[k] *= factor;
            lines->velocity[i].angular[k] *= factor;
        }
    }
}

static bool stands_on_ground(const pe_world *world, const pe_islands *islands, int k,
                             const pe_lines *lines)
{
    const pe_manifold *manifolds = pe_manifolds(&world->contacts);
    for (int i = islands->start[k]; i < islands->start[k + 1]; ++i) {
        const pe_manifold *m = &manifolds[islands->manifolds[i]];
        if (lines->line_of[m->a] == 0 || lines->line_of[m->b] == 0) {
            return true;
        }
    }
    return false;
}

void pe_guard_measure(const pe_islands *islands, const bool *chosen, const pe_lines *lines,
                      double *energy)
{
    for (int k = 0, first = 1; k < islands->count; ++k) {
        int end = first + (chosen[k] ? islands->body_start[k + 1] - islands->body_start[k] : 0);
        energy[k] = kinetic_energy(lines, first, end);
        first = end;
    }
}

int pe_guard_apply(const pe_world *world, const pe_islands *islands, const bool *chosen,
                   const pe_lines *lines, const double *energy)
{
    int scaled = 0;
    for (int k = 0, first = 1; k < islands->count; ++k) {
        int end = first + (chosen[k] ? islands->body_start[k + 1] - islands->body_start[k] : 0);
        double found = kinetic_energy(lines, first, end);
        double bound = energy[k] + pe_max(0, work_of_loads(lines, first, end));
        if (found > bound && stands_on_ground(world, islands, k, lines)) {
            scale(lines, first, end, sqrt(bound / found));
            ++scaled;
        }
        first = end;
    }
    return scaled;
}
