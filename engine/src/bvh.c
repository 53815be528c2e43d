#include "bvh.h"

static pe_vec3 absolute(pe_vec3 v)
{
    return pe_v3(fabs(v.x), fabs(v.y), fabs(v.z));
}

pe_bvh_pair pe_bvh_pair_of(const pe_node *a, const pe_node *b, const pe_mat3 *turn, pe_vec3 offset)
{
    return (pe_bvh_pair){
        .a = a,
        .b = b,
        .turn = *turn,
        .reach = {absolute(turn->r0), absolute(turn->r1), absolute(turn->r2)},
        .offset = offset,
    };
}

/* Square of the distance from the origin to the box of half extents `half` about c. */
static double square_out(pe_vec3 c, pe_vec3 half)
{
    double x = pe_max(0, fabs(c.x) - half.x), y = pe_max(0, fabs(c.y) - half.y);
    double z = pe_max(0, fabs(c.z) - half.z);
    return x * x + y * y + z * z;
}

/* Stops at the first bound above the limit. */
static double gap2(const pe_bvh_pair *p, const pe_node *a, const pe_node *b, double limit2)
{
    pe_vec3 c = pe_sub(pe_add(pe_rotate(&p->turn, a->centre), p->offset), b->centre);
    double along_b = square_out(c, pe_add(pe_rotate(&p->reach, a->half), b->half));
    if (along_b > limit2) {
        return along_b;
    }
    pe_vec3 half = pe_add(pe_unrotate(&p->reach, b->half), a->half);
    return pe_max(along_b, square_out(pe_unrotate(&p->turn, c), half));
}

static void push(const pe_bvh_pair *pair, pe_bvh_walk *walk, int a, int b, double limit2)
{
    double g = gap2(pair, &pair->a[a], &pair->b[b], limit2);
    if (g <= limit2) {
        walk->stack[walk->depth++] = (struct pe_bvh_entry){a, b, g};
    }
}

void pe_bvh_begin(const pe_bvh_pair *pair, pe_bvh_walk *walk)
{
    walk->depth = 0;
    push(pair, walk, 0, 0, HUGE_VAL);
}

static double girth(const pe_node *n)
{
    return n->half.x + n->half.y + n->half.z;
}

bool pe_bvh_next(const pe_bvh_pair *pair, pe_bvh_walk *walk, double bound, const pe_node **a,
                 const pe_node **b)
{
    double limit2 = bound * bound;
    while (walk->depth > 0) {
        struct pe_bvh_entry e = walk->stack[--walk->depth];
        if (e.gap2 > limit2) {
            continue;
        }
        const pe_node *na = &pair->a[e.a], *nb = &pair->b[e.b];
        if (na->right < 0 && nb->right < 0) {
            *a = na;
            *b = nb;
            return true;
        }
        int first = walk->depth;
        if (nb->right < 0 || (na->right >= 0 && girth(na) >= girth(nb))) {
            push(pair, walk, e.a + 1, e.b, limit2);
            push(pair, walk, na->right, e.b, limit2);
        } else {
            push(pair, walk, e.a, e.b + 1, limit2);
            push(pair, walk, e.a, nb->right, limit2);
        }
        struct pe_bvh_entry *pushed = &walk->stack[first];
        if (walk->depth == first + 2 && pushed[0].gap2 < pushed[1].gap2) {
            struct pe_bvh_entry nearer = pushed[0];
            pushed[0] = pushed[1];
            pushed[1] = nearer;
        }
    }
    return false;
}
