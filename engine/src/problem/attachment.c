#include "attachment.h"

/* m, and of a unit normal: what moves by less in the axes of a body in a step is fixed there. */
static const double FIXED = 1e-9;

/* First of the list that is not before the pair of m. */
static int find_pair(const pe_contacts *list, const pe_manifold *m)
{
    int low = 0, high = list->manifold_count;
    while (low < high) {
        int at = low + (high - low) / 2;
        const pe_manifold *other = &pe_manifolds(list)[at];
        if (other->a < m->a || (other->a == m->a && other->b < m->b)) {
            low = at + 1;
        } else {
            high = at;
        }
    }
    return low;
}

static bool same(pe_vec3 a, pe_vec3 b)
{
    pe_vec3 d = pe_sub(a, b);
    return pe_dot(d, d) < FIXED * FIXED;
}

static const pe_manifold_point *find_point(const pe_contacts *list, const pe_manifold *m,
                                           uint64_t feature)
{
    const pe_manifold_point *points = pe_manifold_points(list) + m->first;
    for (int i = 0; i < m->count; ++i) {
        if (points[i].feature == feature) {
            return &points[i];
        }
    }
    return NULL;
}

static pe_attachment compare(const pe_world *world, const pe_manifold *m, const pe_manifold *then)
{
    const pe_manifold_point *points = pe_manifold_points(&world->contacts) + m->first;
    bool normal = then->built.normal_on_b == m->built.normal_on_b &&
                  same(then->built.normal, m->built.normal);
    pe_attachment f = {true, true, normal && !m->built.normal_on_b, normal && m->built.normal_on_b};
    for (int j = 0; j < m->count; ++j) {
        const pe_manifold_point *old = find_point(&world->solved, then, points[j].feature);
        f.in_a = f.in_a && old != NULL && same(old->anchor_a, points[j].anchor_a);
        f.in_b = f.in_b && old != NULL && same(old->anchor_b, points[j].anchor_b);
    }
    return f;
}

static bool is_polyhedron(const pe_world *world, int slot)
{
    pe_shape_kind kind = pe_bodies(world)[slot].shape.kind;
    return kind == PE_SHAPE_BOX || kind == PE_SHAPE_HULL || kind == PE_SHAPE_MESH;
}

static bool is_plane(const pe_world *world, int slot)
{
    return pe_bodies(world)[slot].shape.kind == PE_SHAPE_PLANE;
}

pe_attachment pe_attachment_of(const pe_world *world, const pe_manifold *manifold)
{
    const pe_contacts *list = &world->solved;
    uint64_t feature = pe_manifold_points(&world->contacts)[manifold->first].feature;
    bool known = false;
    for (int i = find_pair(list, manifold); i < list->manifold_count; ++i) {
        const pe_manifold *then = &pe_manifolds(list)[i];
        if (then->a != manifold->a || then->b != manifold->b) {
            break;
        }
        known = true;
        if (find_point(list, then, feature) != NULL) {
            return compare(world, manifold, then);
        }
    }
    bool a = !known && is_polyhedron(world, manifold->a) && is_plane(world, manifold->b);
    bool b = !known && is_polyhedron(world, manifold->b) && is_plane(world, manifold->a);
    return (pe_attachment){.in_a = a, .in_b = b, .normal_a = b, .normal_b = a};
}

static pe_vec3 vector(const double v[3])
{
    return pe_v3(v[0], v[1], v[2]);
}

/* Turned by 2 atan |v|/2, which is |v| to second order, about v: Rodrigues. */
static pe_vec3 turned(pe_vec3 v, pe_vec3 x)
{
    pe_vec3 t = pe_scale(0.5, v), c = pe_cross(t, x);
    return pe_madd(x, 2 / (1 + pe_dot(t, t)), pe_add(c, pe_cross(t, c)));
}

pe_transported pe_solver_manifold_transported(const pe_solver_manifold *manifold,
                                              const pe_attachment *fixture,
                                              const pe_displacement *way)
{
    pe_transported to;
    for (int k = 0; k < 3; ++k) {
        to.axis[k] =
            turned(fixture->normal_a ? way->turn_a : way->turn_b, vector(manifold->frame[k]));
    }
    pe_vec3 a = vector(manifold->arm_a), b = vector(manifold->arm_b);
    if (fixture->in_a) {
        to.arm_a = turned(way->turn_a, a);
        to.arm_b = pe_add(pe_add(b, way->shift), pe_sub(to.arm_a, a));
    } else {
        to.arm_b = turned(way->turn_b, b);
        to.arm_a = pe_add(pe_sub(a, way->shift), pe_sub(to.arm_b, b));
    }
    return to;
}

pe_vec3 pe_offset_transported(const pe_solver_manifold *manifold, const pe_solver_point *point,
                              const pe_attachment *fixture, const pe_displacement *way)
{
    pe_vec3 off = {0};
    for (int k = 0; k < 3; ++k) {
        off = pe_madd(off, point->s[k], vector(manifold->frame[k]));
    }
    return turned(fixture->in_a ? way->turn_a : way->turn_b, off);
}
