/* What a position correction knows of the contacts of the world before each round. */
#include "correction.h"

/* In units of the least half extent of a body: how far a point of it moves in a step at most. */
static const double LONGEST_WAY = 0.4;

/* Manifolds of a piece. */
enum { GRAIN = 256 };

static void look_at_pieces(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_correction *c = context;
    const bool *among = c->rules->among;
    const pe_body *bodies = pe_bodies(c->world);
    for (int i = begin; i < end; ++i) {
        const pe_manifold *m = &pe_manifolds(&c->world->contacts)[i];
        c->contacts[i] = (pe_correction_contact){
            .separation = m->least_separation,
            .a = bodies[m->a].is_static ? -1 : m->a,
            .b = bodies[m->b].is_static ? -1 : m->b,
            .among = among == NULL || among[m->a] || among[m->b],
            .left_alone = pe_is_left_alone(c->world, m),
        };
    }
}

pe_status pe_correction_look(pe_correction *c)
{
    const int count = c->world->contacts.manifold_count;
    c->contacts = pe_scratch(c->world, (size_t)count + 1, sizeof *c->contacts);
    if (c->contacts == NULL) {
        return pe_fail(c->error, PE_NO_MEMORY, "no memory to correct %d contacts", count);
    }
    pe_pool_run(c->world->pool, count, GRAIN, look_at_pieces, c);
    return PE_OK;
}

double pe_correction_depth(const pe_correction *c, const pe_islands *islands, int k, bool among)
{
    double deepest = 0;
    for (int i = islands->start[k]; i < islands->start[k + 1]; ++i) {
        const pe_correction_contact *contact = &c->contacts[islands->manifolds[i]];
        const bool counts = !contact->left_alone && (contact->among || !among);
        deepest = counts ? pe_max(deepest, -contact->separation) : deepest;
    }
    return deepest;
}

double pe_correction_deepest(const pe_correction *c)
{
    double deepest = 0;
    for (int i = 0; i < c->world->contacts.manifold_count; ++i) {
        const pe_correction_contact *contact = &c->contacts[i];
        deepest = contact->among ? pe_max(deepest, -contact->separation) : deepest;
    }
    return deepest;
}

/* Violations of phi >= -aim, by pieces of the manifolds: at most so many, of at least so many
 * manifolds. */
typedef struct violations {
    const pe_correction *c;
    int grain;
    pe_violation of[PE_MOST_SUMS];
} violations;

static void find_violations(void *context, int worker, int begin, int end)
{
    (void)worker;
    violations *s = context;
    const pe_correction *c = s->c;
    pe_violation v = {0};
    for (int i = begin; i < end; ++i) {
        if (!c->contacts[i].among || c->contacts[i].left_alone) {
            continue;
        }
        const pe_manifold *m = &pe_manifolds(&c->world->contacts)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const double depth = -pe_manifold_points(&c->world->contacts)[j].separation;
            const double over = pe_max(depth - c->rules->aim, 0);
            v.deepest = pe_max(v.deepest, depth);
            v.squares += over * over;
        }
    }
    s->of[begin / s->grain] = v;
}

pe_violation pe_correction_violation(const pe_correction *c)
{
    const int count = c->world->contacts.manifold_count;
    violations s = {.c = c, .grain = pe_sum_grain(count)};
    pe_pool_run(c->world->pool, count, s.grain, find_violations, &s);
    pe_violation all = {0};
    for (int i = 0; i < pe_piece_count(count, s.grain); ++i) {
        all.deepest = pe_max(all.deepest, s.of[i].deepest);
        all.squares += s.of[i].squares;
    }
    return all;
}

double pe_correction_way(const pe_correction *c, int slot)
{
    const pe_twist *twist = &pe_twists(c->world)[slot];
    double speed = pe_length(twist->velocity);
    if (c->step->twists != NULL) {
        speed = pe_max(speed, pe_length(c->step->twists[slot].velocity));
    }
    return LONGEST_WAY * pe_bodies(c->world)[slot].size +
           c->step->dt * (speed + pe_spin_speed(c->world, slot));
}
