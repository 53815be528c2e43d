/* The paired descent: bounds of two boxes, and a stack of pairs. */
#include "bvh.h"

pe_transform pe_transform_between(const pe_pose *a, const pe_pose *b)
{
    const pe_mat3 *ra = &a->rotation, *rb = &b->rotation;
    return (pe_transform){
        .turn = {pe_unrotate(ra, pe_axis(rb, 0)), pe_unrotate(ra, pe_axis(rb, 1)),
                 pe_unrotate(ra, pe_axis(rb, 2))},
        .offset = pe_pose_to_body(b, a->position),
    };
}

pe_node pe_box_node(pe_vec3 centre, pe_vec3 half)
{
    return (pe_node){
        .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        .centre = centre,
        .half = half,
        .radius = pe_length(half),
        .right = -1,
        .count = 1,
    };
}

double pe_node_reach(const pe_node *node, pe_vec3 d)
{
    pe_vec3 along = pe_rotate(&node->axes, d);
    return fabs(along.x) * node->half.x + fabs(along.y) * node->half.y +
           fabs(along.z) * node->half.z;
}

/* Whether all of the node lies farther from b than `limit`, along the parting direction. */
static bool a_is_far(const pe_bvh_pair *p, const pe_node *a, double limit)
{
    double middle = pe_dot(p->parting_a, a->centre) + pe_dot(p->parting, p->a_in_b.offset);
    return middle + pe_node_reach(a, p->parting_a) < p->least_b - limit;
}

static bool b_is_far(const pe_bvh_pair *p, const pe_node *b, double limit)
{
    return pe_dot(p->parting, b->centre) - pe_node_reach(b, p->parting) > p->most_a + limit;
}

/* A lower bound of the squared gap of two nodes. Stops at the first bound above the limit. */
static double gap2(const pe_bvh_pair *p, const pe_node *a, const pe_node *b, double limit)
{
    const pe_mat3 *turn = &p->a_in_b.turn;
    pe_vec3 c = pe_sub(pe_transform_point(&p->a_in_b, a->centre), b->centre);
    double near = a->radius + b->radius + limit;
    if (pe_dot(c, c) > near * near) {
        return HUGE_VAL;
    }
    /* Axes of a as columns in the axes of b. */
    pe_vec3 x = pe_rotate(&b->axes, pe_rotate(turn, a->axes.r0));
    pe_vec3 y = pe_rotate(&b->axes, pe_rotate(turn, a->axes.r1));
    pe_vec3 z = pe_rotate(&b->axes, pe_rotate(turn, a->axes.r2));
    pe_vec3 ax = pe_absolute(x), ay = pe_absolute(y), az = pe_absolute(z), ha = a->half,
            hb = b->half;
    c = pe_rotate(&b->axes, c);
    pe_vec3 reach = pe_madd(pe_madd(pe_madd(hb, ha.x, ax), ha.y, ay), ha.z, az);
    double along_b = pe_square_to_box(c, reach);
    if (along_b > limit * limit) {
        return along_b;
    }
    reach = pe_add(ha, pe_v3(pe_dot(ax, hb), pe_dot(ay, hb), pe_dot(az, hb)));
    return pe_max(along_b,
                  pe_square_to_box(pe_v3(pe_dot(x, c), pe_dot(y, c), pe_dot(z, c)), reach));
}

static void push(const pe_bvh_pair *pair, pe_bvh_walk *walk, int a, int b, double limit)
{
    double g = gap2(pair, &pair->a[a], &pair->b[b], limit);
    if (g <= limit * limit) {
        walk->stack[walk->depth++] = (struct pe_bvh_entry){a, b, g};
    }
}

void pe_bvh_begin(const pe_bvh_pair *pair, pe_bvh_walk *walk)
{
    walk->depth = 0;
    push(pair, walk, 0, 0, HUGE_VAL);
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
        if (nb->right < 0 || (na->right >= 0 && na->radius >= nb->radius)) {
            for (int k = 0; k < 2; ++k) {
                int child = k == 0 ? e.a + 1 : na->right;
                if (!a_is_far(pair, &pair->a[child], bound)) {
                    push(pair, walk, child, e.b, bound);
                }
            }
        } else {
            for (int k = 0; k < 2; ++k) {
                int child = k == 0 ? e.b + 1 : nb->right;
                if (!b_is_far(pair, &pair->b[child], bound)) {
                    push(pair, walk, e.a, child, bound);
                }
            }
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

int pe_bvh_leaves(const pe_bvh_pair *pair, bool of_a, double limit, int *leaves, int most)
{
    const pe_node *nodes = of_a ? pair->a : pair->b;
    int stack[PE_BVH_STACK] = {0}, depth = 1, count = 0;
    while (depth > 0) {
        int index = stack[--depth];
        const pe_node *node = &nodes[index];
        if (of_a ? a_is_far(pair, node, limit) : b_is_far(pair, node, limit)) {
            continue;
        }
        if (node->right >= 0) {
            stack[depth++] = node->right;
            stack[depth++] = index + 1;
            continue;
        }
        double g = of_a ? gap2(pair, node, pair->b, limit) : gap2(pair, pair->a, node, limit);
        if (g > limit * limit) {
            continue;
        }
        if (count == most) {
            return -1;
        }
        leaves[count++] = index;
    }
    return count;
}
