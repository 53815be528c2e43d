/* Reads bytes as a contact problem. Every solver of the engine, and one of Siconos where it is there:
 *
 * - the velocities are those that follow from the impulses by independent formulas, and finite;
 * - a solver that says it has converged obeys Signorini's and Coulomb's laws, also by independent formulas;
 * - where nothing has friction the velocities are unique (a convex problem): two that have solved it agree,
 *   and the direct solver solves what another one solves.
 *
 * The bytes: eight of a seed, the number of bodies, options, a scale of friction, and of the mass of the first
 * body, then two bodies for each manifold. */
#include "fuzz.h"

#include "contact_problem_for_tests.h"
#ifdef PLUMB_HAVE_SICONOS
#include "siconos_answer.h"

#include <Friction_cst.h>
#endif

#include <math.h>
#include <string.h>

enum { HEAD = 12, MOST_BODIES = 6, MOST_MANIFOLDS = 8, ITERATIONS = 2000 };

/* m/s; velocities in units of the largest one of the problem. */
static const double TOLERANCE = 1e-9, SOLVED = 1e-8, NEARLY_SOLVED = 1e-6, SAME_VELOCITY = 1e-5;

/* A residual of SOLVED leaves a slip of its root, and that of friction, in m/s by the lightest body, more by
 * the root of the ratio of masses: 1e3 at most. */
static const double LAWFUL = 1e-3;

static pe_contact_problem *problem_of(const uint8_t *data, size_t size)
{
    uint64_t seed;
    memcpy(&seed, data, sizeof seed);
    const int bodies = 1 + data[8] % MOST_BODIES;
    int pairs[MOST_MANIFOLDS][2], count = 0;
    for (size_t at = HEAD; at + 1 < size && count < MOST_MANIFOLDS; at += 2) {
        const int a = data[at] % (bodies + 1) - 1, b = data[at + 1] % bodies;
        if (a != b) {
            pairs[count][0] = a; /* -1 is PE_STATIC */
            pairs[count++][1] = b;
        }
    }
    if (count == 0) {
        return NULL;
    }
    pe_contact_problem *problem = problem_of_pairs(seed | 1, bodies, (const int(*)[2])pairs, count);
    const double friction = data[9] & 1 ? 0 : data[10] / 64.0;
    for (int i = 0; i < count; ++i) {
        problem->manifolds[i].friction *= friction;
    }
    for (int j = 0; j < problem->point_count; ++j) {
        pe_problem_manifold_point *p = &problem->points[j];
        if (data[9] & 2) { /* from no impulse */
            memset(p->impulse, 0, sizeof p->impulse);
        }
        if (data[9] & 4) { /* all touch and none bounces: at rest is a solution of the geometry */
            p->bias = fabs(p->bias);
            p->slip[0] = p->slip[1] = 0;
        }
    }
    const double scale = pow(10, (data[11] - 127.5) / 21.25); /* 1e-6 .. 1e6 */
    problem->bodies[0].mass *= scale;
    for (int k = 0; k < 6; ++k) {
        problem->bodies[0].inertia[k] *= scale;
    }
    return problem;
}

static double largest_velocity(const pe_contact_problem *problem)
{
    double most = 1;
    for (int i = 0; i < problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            most = fmax(most, fabs(problem->bodies[i].free_velocity[k]));
        }
    }
    return most;
}

static double difference(const pe_contact_problem *problem, const double (*v)[6],
                         const double (*w)[6])
{
    double worst = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            fuzz_check(isfinite(v[i][k]) && isfinite(w[i][k]), "velocities are finite");
            worst = fmax(worst, fabs(v[i][k] - w[i][k]));
        }
    }
    return worst;
}

/* What the velocities are a sum of, for its rounding. */
static double largest_change(const pe_contact_problem *problem, const double (*p)[3])
{
    double sum = 0, least = HUGE_VAL;
    for (int i = 0; i < problem->body_count; ++i) {
        const double *m = problem->bodies[i].inertia;
        least = fmin(least, fmin(problem->bodies[i].mass, fmin(m[0], fmin(m[3], m[5]))));
    }
    for (int j = 0; j < problem->point_count; ++j) {
        sum += fabs(p[j][0]) + fabs(p[j][1]) + fabs(p[j][2]);
    }
    return sum / least;
}

static double mass_ratio(const pe_contact_problem *problem)
{
    double least = HUGE_VAL, most = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        least = fmin(least, problem->bodies[i].mass);
        most = fmax(most, problem->bodies[i].mass);
    }
    return most / least;
}

typedef struct answer {
    double velocities[MOST_BODIES][6];
    double residual; /* m/s */
} answer;

static answer answer_of(const pe_contact_problem *problem, const double (*p)[3],
                        const double (*v)[6], double residual)
{
    answer found = {.residual = residual};
    reference_velocities(problem, p, found.velocities);
    const double rounding = 1e-10 * (largest_velocity(problem) + largest_change(problem, p));
    if (v != NULL) {
        fuzz_check(difference(problem, v, (const double(*)[6])found.velocities) <= rounding,
                   "velocities follow from the impulses");
    }
    fuzz_check(!(residual <= SOLVED) ||
                   coulomb_fault(problem, p, (const double(*)[6])found.velocities) <=
                       LAWFUL * sqrt(mass_ratio(problem)) + rounding,
               "a solved problem obeys Coulomb's law");
    return found;
}

static answer solve(const pe_contact_problem *problem, const char *solver, int iterations)
{
    const pe_solve_limits limits = {.tolerance = TOLERANCE, .max_iterations = iterations};
    pe_contact_solution s;
    fuzz_check(pe_contact_problem_solve(problem, solver, &limits, NULL, &s, NULL) == PE_OK,
               "a valid problem is not refused");
    fuzz_check(isfinite(s.residual.max), "the residual is finite");
    fuzz_check(s.stop != PE_STOP_CONVERGED || s.residual.max <= TOLERANCE,
               "what has converged is within the tolerance");
    const answer found = answer_of(problem, (const double(*)[3])s.impulses,
                                   (const double(*)[6])s.velocities, s.residual.max);
    pe_contact_solution_free(&s);
    return found;
}

static answer solve_by_siconos(pe_contact_problem *problem)
{
#ifdef PLUMB_HAVE_SICONOS
    const pe_solve_limits look = {.tolerance = HUGE_VAL};
    pe_contact_solution s;
    fuzz_check(siconos_answer(problem, SICONOS_FRICTION_3D_NSGS), "there is memory");
    fuzz_check(pe_contact_problem_solve(problem, "gauss_seidel", &look, NULL, &s, NULL) == PE_OK,
               "a valid problem is not refused");
    const answer found = answer_of(problem, (const double(*)[3])s.impulses, NULL, s.start.max);
    pe_contact_solution_free(&s);
    return found;
#else
    (void)problem;
    return (answer){.residual = HUGE_VAL};
#endif
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pe_contact_problem *problem = size > HEAD ? problem_of(data, size) : NULL;
    if (problem == NULL) {
        return 0;
    }
    pe_problem_fault fault;
    fuzz_check(pe_contact_problem_is_valid(problem, &fault), "the problem is valid");
    bool slides = false;
    for (int i = 0; i < problem->manifold_count; ++i) {
        slides = slides || problem->manifolds[i].friction > 0;
    }
    const answer direct = solve(problem, "direct", ITERATIONS);
    answer others[8];
    int count = 0;
    for (int i = 0; i < pe_solver_count() && count < 7; ++i) {
        if (strcmp(pe_solver(i).name, "direct") != 0) {
            others[count++] = solve(problem, pe_solver(i).name, ITERATIONS);
        }
    }
    others[count++] = solve_by_siconos(problem);
    for (int i = 0; i < count && !slides; ++i) {
        if (others[i].residual <= SOLVED) {
            fuzz_check(direct.residual <= NEARLY_SOLVED,
                       "the direct solver solves what another one solves");
            fuzz_check(difference(problem, (const double(*)[6])direct.velocities,
                                  (const double(*)[6])others[i].velocities) <=
                           SAME_VELOCITY * largest_velocity(problem),
                       "solvers agree where the solution is unique");
        }
    }
    pe_contact_problem_destroy(problem);
    return 0;
}
