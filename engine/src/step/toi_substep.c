#include "toi_substep.h"

/* s per s: what strikes within this part of the step strikes together. */
static const double TOGETHER = 1e-3;

/* ---- Points ------------------------------------------------------------------------------------
 */

double pe_slow_closing(const pe_world *world, double dt)
{
    return pe_max(dt * pe_length(world->def.gravity), 1e-9);
}

static pe_vec3 point_velocity(const pe_world *world, int slot, const pe_twist *motion, pe_vec3 x)
{
    pe_vec3 arm = pe_sub(x, pe_poses(world)[slot].position);
    return pe_add(motion->velocity, pe_cross(motion->angular_velocity, arm));
}

double pe_opening(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point,
                  const pe_twist *of_a, const pe_twist *of_b)
{
    return pe_dot(m->normal, pe_sub(point_velocity(world, m->b, of_b, point->position),
                                    point_velocity(world, m->a, of_a, point->position)));
}

double pe_opening_now(const pe_world *world, const pe_manifold *m, const pe_manifold_point *point)
{
    const pe_twist *motions = pe_twists(world);
    return pe_opening(world, m, point, &motions[m->a], &motions[m->b]);
}

bool pe_strikes_now(const pe_substep *part, const pe_manifold_point *point, double speed)
{
    return speed < -part->slow &&
           point->separation <= pe_max(PE_CLOSED, -speed * TOGETHER * part->dt);
}

static bool is_chosen(const pe_substep *part, pe_choice which, const pe_manifold *m,
                      const pe_manifold_point *point)
{
    double speed = pe_opening_now(part->world, m, point);
    switch (which) {
    case PE_SEPARATING:
        return speed >= -part->slow;
    case PE_IMPACTING:
        return pe_strikes_now(part, point, speed) ||
               (speed >= -part->slow &&
                point->separation <= pe_max(PE_CLOSED, 0.5 * part->dt * part->slow));
    default:
        return true;
    }
}

/* Brings the chosen points of the manifold to its front; how many they are. The others carry no
 * impulse. */
static int bring_forward(const pe_substep *part, pe_choice which, const pe_manifold *m, int count)
{
    pe_manifold_point *points = pe_manifold_points(&part->world->contacts) + m->first;
    int chosen = 0;
    for (int j = 0; j < count; ++j) {
        if (is_chosen(part, which, m, &points[j])) {
            pe_manifold_point moved = points[j];
            points[j] = points[chosen];
            points[chosen++] = moved;
        } else {
            points[j].impulse = pe_v3(0, 0, 0);
        }
    }
    return chosen;
}

int pe_substep_choose(pe_substep *part, pe_choice which)
{
    pe_contacts *contacts = &part->world->contacts;
    int *listed = &part->island.start[1], total = 0;
    *listed = 0;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        pe_manifold *m = &pe_manifolds(contacts)[i];
        m->count = bring_forward(part, which, m, part->counts[i]);
        if (m->count > 0) {
            part->island.manifolds[(*listed)++] = i;
        }
        total += m->count;
    }
    return total;
}

/* ---- The lists ---------------------------------------------------------------------------------
 */

void pe_substep_exchange(pe_world *world)
{
    pe_contacts contacts = world->contacts, previous = world->previous;
    world->contacts = world->part;
    world->previous = world->part_previous;
    world->part = contacts;
    world->part_previous = previous;
}

static void count_points(pe_substep *part)
{
    const pe_contacts *contacts = &part->world->contacts;
    for (int i = 0; i < contacts->manifold_count; ++i) {
        part->counts[i] = pe_manifolds(contacts)[i].count;
    }
}

pe_status pe_substep_find(pe_substep *part)
{
    pe_substep_choose(part, PE_ALL);
    pe_status status = pe_contacts_find_by(part->world, part->rules, part->pairs, part->pair_count,
                                           part->dt, part->error);
    count_points(part);
    return status;
}

void pe_substep_unfind(pe_substep *part)
{
    pe_contacts found = part->world->contacts;
    part->world->contacts = part->world->previous;
    part->world->previous = found;
    count_points(part);
}

/* A point of the step's contacts, and its manifold. */
typedef struct step_point {
    pe_manifold *manifold;
    pe_manifold_point *point; /* NULL: none */
} step_point;

/* The one that stands for a point of a part: of the same pair, that of the same features, or else
 * the nearest. */
static step_point step_point_of(const pe_substep *part, const pe_manifold *m,
                                const pe_manifold_point *point)
{
    const pe_contacts *step = &part->world->part;
    step_point best = {0};
    double least = HUGE_VAL;
    for (int i = part->whole->start[part->k]; i < part->whole->start[part->k + 1]; ++i) {
        pe_manifold *of_step = &pe_manifolds(step)[part->whole->manifolds[i]];
        for (int j = 0; j < of_step->count && of_step->a == m->a && of_step->b == m->b; ++j) {
            pe_manifold_point *candidate = &pe_manifold_points(step)[of_step->first + j];
            pe_vec3 off = pe_sub(candidate->position, point->position);
            double distance = candidate->feature == point->feature ? -1 : pe_dot(off, off);
            if (distance < least) {
                least = distance;
                best = (step_point){of_step, candidate};
            }
        }
    }
    return best;
}

static bool is_larger(pe_vec3 a, pe_vec3 b)
{
    return pe_dot(a, a) > pe_dot(b, b);
}

void pe_substep_add_impulses(const pe_substep *part, const pe_contacts *list)
{
    for (int i = 0; i < list->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(list)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_manifold_point *point = &pe_manifold_points(list)[j];
            if (pe_dot(point->impulse, point->impulse) > 0) {
                step_point to = step_point_of(part, m, point);
                if (is_larger(point->impulse, to.point->impulse)) {
                    to.manifold->normal = m->normal;
                    to.point->position = point->position;
                }
                to.point->impulse = pe_add(to.point->impulse, point->impulse);
            }
        }
    }
}

void pe_substep_clear_impulses(const pe_substep *part)
{
    const pe_contacts *step = &part->world->contacts;
    for (int i = part->whole->start[part->k]; i < part->whole->start[part->k + 1]; ++i) {
        const pe_manifold *m = &pe_manifolds(step)[part->whole->manifolds[i]];
        for (int j = m->first; j < m->first + m->count; ++j) {
            pe_manifold_points(step)[j].impulse = pe_v3(0, 0, 0);
        }
    }
}

/* ---- The whole ---------------------------------------------------------------------------------
 */

static void list_pairs(pe_substep *part)
{
    for (int i = part->whole->start[part->k]; i < part->whole->start[part->k + 1]; ++i) {
        const pe_manifold *m = &pe_manifolds(&part->world->contacts)[part->whole->manifolds[i]];
        const pe_pair *last = part->pair_count > 0 ? &part->pairs[part->pair_count - 1] : NULL;
        if (last == NULL || last->a != m->a || last->b != m->b) {
            part->pairs[part->pair_count++] = (pe_pair){m->a, m->b};
        }
    }
}

pe_status pe_substep_begin(pe_substep *part)
{
    pe_world *world = part->world;
    size_t slots = (size_t)world->slot_count;
    const pe_islands *whole = part->whole;
    int *bodies = whole->bodies + whole->body_start[part->k];
    int count = whole->body_start[part->k + 1] - whole->body_start[part->k];
    size_t pairs = (size_t)(whole->start[part->k + 1] - whole->start[part->k]);
    part->pairs = pe_scratch(world, pairs, sizeof *part->pairs);
    part->counts = pe_scratch(world, pairs * PE_MAX_MANIFOLDS, sizeof *part->counts);
    part->free = pe_scratch(world, slots, sizeof *part->free);
    part->poses = pe_scratch(world, (size_t)count, sizeof *part->poses);
    part->motions = pe_scratch(world, (size_t)count, sizeof *part->motions);
    part->ends = pe_scratch(world, (size_t)count, sizeof *part->ends);
    part->island = (pe_islands){
        .count = 1,
        .start = pe_scratch(world, 2, sizeof(int)),
        .manifolds = pe_scratch(world, pairs * PE_MAX_MANIFOLDS, sizeof(int)),
        .body_start = pe_scratch(world, 2, sizeof(int)),
        .bodies = bodies,
        .place = whole->place,
    };
    if (part->pairs == NULL || part->counts == NULL || part->free == NULL || part->poses == NULL ||
        part->motions == NULL || part->ends == NULL || part->island.start == NULL ||
        part->island.manifolds == NULL || part->island.body_start == NULL) {
        return pe_fail(part->error, PE_NO_MEMORY, "no memory for the impacts of %d bodies", count);
    }
    part->island.start[0] = part->island.start[1] = 0;
    part->island.body_start[0] = 0;
    part->island.body_start[1] = count;
    list_pairs(part);
    return PE_OK;
}
