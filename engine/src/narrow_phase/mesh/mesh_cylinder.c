/* A cylinder against a mesh that is not convex: against each triangle near it, as a hull without
 * thickness, and each vertex inside it.
 *
 * The result of a triangle counts if the mesh faces its direction there: the triangle's own normal,
 * or one between those of the faces at the edge or vertex that is nearest. Along a face's normal
 * the touches are those of the whole face (mesh_cylinder_facet.c). Triangles next to the lowest one
 * add theirs, too, though their own nearest points are at a rim inside the face: a cap on a face
 * that tilts a little so keeps its points.
 *
 * Apart, the least distance of a triangle is that of the solids. If no touch has it, the nearest
 * points of that triangle are the touch. Of overlaps, a triangle that is cut so deeply that the
 * shortest translation off it leads into the solid, or along it, gives nothing. If no triangle
 * gives an overlap but some are cut, the cylinder is pushed out along the normal of one of these,
 * by its depth under the triangle: the one where that is least. */
#include "mesh_cylinder_facet.h"
#include "narrow_phase/tolerances.h"
#include "solid_query.h"

typedef struct contact {
    pe_cylinder_mesh pair;
    pe_touches list;
    pe_touch nearest;     /* of the triangles that are apart; separation HUGE_VAL: none */
    double nearest_value; /* its separation, or a little more if it is at no feature of its own */
    bool cut;             /* a triangle passes through the cylinder */
    pe_touch fallback;    /* of triangles that give nothing, the shallowest translation */
    bool is_over;         /* its point lies over its triangle: preferred */
} contact;

/* Takes the translation if it is better than the one so far. */
static void offer(contact *s, bool is_over, pe_touch touch)
{
    if (is_over > s->is_over ||
        (is_over == s->is_over && touch.separation > s->fallback.separation)) {
        s->is_over = is_over;
        s->fallback = touch;
    }
}

/* Offers a translation along the triangle's normal: of the cylinder's last point below it, if over
 * the triangle, or else from a point of the triangle in the cylinder. The touch found is offered
 * instead if it is shallower. */
static void push_off(contact *s, const pe_facet *f, const pe_touch *found)
{
    pe_vec3 n = pe_scale(-1, f->normal), x = pe_cylinder_support(&s->pair.c, n);
    double height = pe_dot(f->normal, x) - f->offset;
    bool is_over = height < 0 && pe_facet_contains(f, x, PE_MESH_SLACK * s->pair.size);
    pe_touch touch = *found;
    if (is_over) {
        touch = pe_cylinder_touch(f, PE_AT_NEAREST, x, height);
    } else if (s->is_over) {
        return; /* there is a better one */
    } else if (pe_cylinder_facet_point(&s->pair.c, f, &x)) {
        double depth = pe_cylinder_exit(&s->pair.c, x, n);
        if (-depth < found->separation) {
            touch = pe_cylinder_touch(f, PE_AT_NEAREST, pe_madd(x, depth, n), -depth);
        }
    }
    touch.feature = found->feature; /* the face's nearest point may be another */
    offer(s, is_over, touch);
}

/* Adds the translation that is shortest from the cylinder's centre, inside the solid. */
static void push_out_of_solid(contact *s)
{
    pe_vec3 x = s->pair.c.centre, in = pe_sub(x, pe_solid_nearest_point(&s->pair.solid, x));
    double depth = pe_length(in);
    if (depth > 0) {
        pe_vec3 n = pe_scale(1 / depth, in);
        double own = pe_cylinder_exit(&s->pair.c, x, n);
        pe_touch touch =
            pe_touch_make(PE_VERTEX_FACE, pe_touch_feature(PE_VERTEX_FACE, PE_AT_NEAREST, 0),
                          pe_madd(x, own, n), n, -own - depth);
        touch.strict = true;
        pe_touches_add(&s->list, &touch);
    }
}

/* Adds the touch of a vertex in the cylinder and the nearer one of the cap and the side that it
 * faces. */
static void try_vertex(contact *s, int vertex, pe_vec3 x)
{
    const pe_cylinder *c = &s->pair.c;
    pe_vec3 from = pe_sub(x, c->centre), across = pe_across(c->axis, from);
    double z = pe_dot(from, c->axis), from_axis;
    if (!(fabs(z) < c->half_height && pe_dot(across, across) < c->radius * c->radius)) {
        return;
    }
    pe_vec3 radial = pe_outward(c->axis, from, &from_axis);
    double to_cap = c->half_height - fabs(z), to_side = c->radius - from_axis;
    for (int side = 0; side < 2; ++side) {
        bool by_cap = (side == 0) == (to_cap <= to_side), strict;
        pe_vec3 n = by_cap ? pe_scale(z < 0 ? -1 : 1, c->axis) : radial;
        double depth = by_cap ? to_cap : to_side;
        if (pe_vertex_takes_normal(&s->pair.solid, vertex, n, &strict) && strict &&
            pe_dot(n, n) > 0.5) {
            /* Faces do not share a manifold for touches of this kind. */
            pe_touch touch =
                pe_touch_make(PE_EDGE_VERTEX, pe_touch_feature(PE_FACE_VERTEX, vertex, by_cap),
                              pe_madd(x, depth, n), n, -depth);
            touch.strict = true;
            pe_touches_add(&s->list, &touch);
            return;
        }
    }
}

/* A point of the triangle's manifold as a touch at its place. */
static pe_touch touch_of(const contact *s, const pe_pair_point *point, pe_vec3 n,
                         pe_cylinder_place at)
{
    pe_vec3 x = pe_pose_to_body(s->pair.mesh.pose, point->position);
    pe_touch touch =
        pe_touch_make(at.kind == PE_ON_FACE ? PE_VERTEX_FACE : PE_EDGE_VERTEX, at.feature,
                      pe_madd(x, -0.5 * point->separation, n), n, point->separation);
    touch.strict = true;
    return touch;
}

/* The touch of the nearest point. If it is so near to a face that the face's normal leads as well
 * to the mesh, it has that normal, and so shares the face's manifold. */
static pe_touch nearest_of(const contact *s, const pe_pair_point *point, pe_vec3 n,
                           pe_cylinder_place at)
{
    pe_touch touch = touch_of(s, point, n, at);
    if (at.kind == PE_NEXT_TO_EDGE &&
        PE_NEXT_TO_FACE * fabs(point->separation) <= PE_CYLINDER_MESH_TIE * s->pair.size) {
        touch.kind = PE_VERTEX_FACE;
        touch.normal = pe_scale(-1, s->pair.solid.faces[at.face].normal);
    }
    return touch;
}

/* Takes the manifold of the cylinder and one triangle. */
static void take_manifold(contact *s, pe_facet *f, const pe_pair_manifold *manifold, double bound)
{
    pe_vec3 n = pe_unrotate(&s->pair.mesh.pose->rotation, manifold->normal);
    pe_vec3 out = pe_scale(-1, n);
    const pe_pair_point *deepest = &manifold->item[0];
    for (int i = 1; i < manifold->count; ++i) {
        const pe_pair_point *point = &manifold->item[i];
        deepest = point->separation < deepest->separation ? point : deepest;
    }
    double slack = PE_MESH_SLACK * s->pair.size;
    bool cut = deepest->separation < -slack;
    bool by_faces = deepest->separation >= -PE_DEEP_EDGE * s->pair.size;
    pe_cylinder_place at = pe_cylinder_find_place(&s->pair, f, out, by_faces);
    bool at_feature = at.kind == PE_AT_EDGE || at.kind == PE_AT_VERTEX;
    pe_touch nearest = nearest_of(s, deepest, n, at);
    s->cut = s->cut || cut;
    /* Of the triangles at one edge, the one that owns it is preferred. */
    double tie = at.kind == PE_NOWHERE ? 0.2 * PE_CYLINDER_MESH_TIE * s->pair.size : 0;
    double value = nearest.separation + tie;
    if (!cut && value < s->nearest_value) {
        s->nearest_value = value;
        s->nearest = nearest;
    }
    if (!at_feature && (at.kind == PE_ON_FACE || pe_dot(out, f->normal) >= PE_FACE_ALONG_CAP)) {
        pe_cylinder_touches_on_facet(&s->pair, f, cut ? -HUGE_VAL : -slack, bound, &s->list);
    }
    if (at.kind == PE_ON_FACE) {
        pe_touches_add(&s->list, &nearest);
    } else if (at.kind == PE_NEXT_TO_EDGE && cut) {
        offer(s, true, nearest);
    } else if (at_feature) {
        for (int i = 0; i < manifold->count; ++i) {
            const pe_pair_point *point = &manifold->item[i];
            pe_touch touch = touch_of(s, point, n, at);
            /* Kinds of cylinder points start at 1, so that the id is not that of the place. */
            uint64_t of_cylinder = (point->feature >> 56) << 2 | (point->feature & 3);
            touch.feature |= of_cylinder << 30;
            pe_touches_add(&s->list, &touch);
        }
    } else if (cut) {
        push_off(s, f, &nearest);
    }
}

static void try_facet(contact *s, int triangle, double bound)
{
    pe_facet f;
    pe_solid_facet(&s->pair.solid, triangle, &f);
    double height = pe_dot(f.normal, s->pair.c.centre) - f.offset;
    if (fabs(height) - pe_cylinder_reach(&s->pair.c, f.normal) > bound) {
        return;
    }
    for (int k = 0; k < 3; ++k) {
        if (pe_facet_owns_corner(&f, k)) {
            try_vertex(s, f.vertices[k], f.x[k]);
        }
    }
    pe_pair_manifold manifold;
    pe_collide_cylinder_facet(&s->pair, &f, bound, &manifold);
    if (manifold.count > 0) {
        take_manifold(s, &f, &manifold, bound);
    }
}

static bool is_nearest_of_face(const pe_touch *t)
{
    return t->feature >> 30 == pe_touch_feature(PE_VERTEX_FACE, PE_AT_NEAREST, 0) >> 30;
}

/* Whether the face has another point as near as this nearest one. */
static bool is_covered(const contact *s, const pe_touch *t)
{
    for (int i = 0; i < s->list.count; ++i) {
        const pe_touch *other = &s->list.items[i];
        if (other->kind == PE_VERTEX_FACE && !is_nearest_of_face(other) &&
            pe_touch_second(other->feature) == pe_touch_second(t->feature) &&
            other->separation <= t->separation + PE_CYLINDER_MESH_TIE * s->pair.size) {
            return true;
        }
    }
    return false;
}

/* Keeps each feature once: triangles of one face find the same points. Keeps a face's nearest point
 * only if no other is as near. */
static void settle(contact *s)
{
    pe_touches_sort(&s->list);
    int kept = 0;
    for (int i = 0; i < s->list.count; ++i) {
        pe_touch *t = &s->list.items[i], *last = kept > 0 ? &s->list.items[kept - 1] : NULL;
        if (last == NULL || last->feature != t->feature) {
            s->list.items[kept++] = *t;
        } else if (t->separation < last->separation) {
            *last = *t;
        }
    }
    s->list.count = kept;
    for (int i = 0; i < s->list.count; ++i) {
        pe_touch *t = &s->list.items[i];
        t->merged = is_nearest_of_face(t) && is_covered(s, t);
    }
    pe_touches_drop_merged(&s->list);
    for (int i = 0; i < s->list.count; ++i) {
        if (s->list.items[i].separation < -PE_MESH_SLACK * s->pair.size) {
            offer(s, true, s->list.items[i]); /* used if no touch stays */
        }
    }
    pe_touches_drop_contradicted(&s->list, 0, s->pair.size);
}

static void add_sorted(contact *s, const pe_touch *touch)
{
    pe_touches_add(&s->list, touch);
    pe_touches_sort(&s->list);
}

/* Adds the nearest points at a dent, or a translation, if no other touch is as near or as deep. */
static void complete(contact *s)
{
    double least = pe_touches_least(&s->list);
    if (s->cut) {
        if (!(least < 0) && s->fallback.separation > -HUGE_VAL) {
            add_sorted(s, &s->fallback);
        }
        return;
    }
    /* A cylinder that is wholly inside may be near the other side of the solid, too. */
    bool is_short =
        s->list.count == 0 || least > s->nearest.separation + PE_CYLINDER_MESH_TIE * s->pair.size;
    if ((is_short || least > 0) && pe_solid_contains(&s->pair.solid, s->pair.c.centre)) {
        s->list.count = 0;
        push_out_of_solid(s);
    } else if (is_short && s->nearest.separation < HUGE_VAL) {
        add_sorted(s, &s->nearest);
    }
}

int pe_collide_cylinder_mesh(pe_placed cylinder, pe_placed mesh, double margin, pe_workspace work,
                             pe_pair_manifold *manifolds)
{
    if (mesh.geometry->convex) {
        /* A convex mesh is a hull, also one of many faces: the cost then grows with all faces, but
         * the results of single triangles are not exact where they overlap the cylinder. */
        pe_pair_manifold_clear(manifolds);
        pe_collide_cylinder_hull(cylinder, mesh, margin, manifolds);
        return manifolds->count > 0;
    }
    const pe_shape *shape = cylinder.shape;
    pe_node box =
        pe_box_node(pe_v3(0, 0, 0), pe_v3(shape->radius, shape->radius, shape->half_height));
    pe_bvh_pair trees = {.a = &box,
                         .b = mesh.geometry->nodes,
                         .a_in_b = pe_transform_between(cylinder.pose, mesh.pose)};
    contact s = {
        .pair = {cylinder, mesh, pe_cylinder_in_axes(cylinder, mesh.pose),
                 pe_solid_of_geometry(mesh.geometry), pe_min(cylinder.size, mesh.size)},
        .list = {.work = work},
        .nearest = {.separation = HUGE_VAL},
        .nearest_value = HUGE_VAL,
        .fallback = {.separation = -HUGE_VAL},
    };
    double size = s.pair.size;
    double band = PE_BAND * pe_min(box.radius, mesh.geometry->bounding_radius);
    double look = margin * (1 + PE_LOOK_AHEAD) + PE_MESH_SLACK * size, bound = look;
    pe_bvh_walk walk;
    const pe_node *leaf_a, *leaf;
    pe_bvh_begin(&trees, &walk);
    while (!s.list.failed && pe_bvh_next(&trees, &walk, bound, &leaf_a, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            try_facet(&s, leaf->first + i, bound);
        }
        bound = pe_min(look, (s.cut ? 0 : pe_max(0, s.nearest.separation)) + band);
    }
    settle(&s);
    complete(&s);
    double least = pe_touches_least(&s.list);
    pe_manifold_rules rules = {
        .size = size,
        .margin = margin,
        .limit = least + band,
        .least = s.cut || s.list.count == 0 ? -HUGE_VAL : pe_min(least, s.nearest.separation),
        .end_margin = bound < look ? HUGE_VAL : look,
    };
    return pe_touches_make_manifolds(&s.list, &rules, mesh.pose, manifolds);
}
