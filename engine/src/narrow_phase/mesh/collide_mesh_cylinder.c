/* A cylinder against a mesh that is not convex: against each triangle near it, as a hull without
 * thickness, and each vertex in it.
 *
 * What a triangle gives counts when its direction is one that the mesh has there: the triangle's
 * own normal, or one between those of the faces at the edge or vertex that is nearest. Along a
 * face's normal the points are those of the face (collide_mesh_cylinder_face.c), also from its
 * triangles that lie beside what is lowest, whose own nearest points are at a rim inside the face:
 * so a cap upon a face that tilts a little keeps its points.
 *
 * Apart, the least distance of a triangle is that of the solids: where nothing else has it, the
 * nearest points of that triangle are the contact. Of overlaps, a triangle that is cut so deep that
 * the shortest way off it leads into the solid, or along it, gives nothing. Where no triangle gives
 * an overlap but some are cut, the cylinder is pushed out along the normal of one of these, by what
 * of it lies under the triangle there: the one where that is least. */
#include "collide_mesh_cylinder.h"

/* In units of the smaller shape: separations that differ by less are one. */
static const double TIE = 5e-10;
/* The same: where an edge overlaps by more, its own direction is the way out, however near to that
 * of a face. */
static const double DEEP = 5e-7;

typedef struct scene {
    pe_placed cylinder, mesh;
    pe_cylinder seen; /* in the mesh's axes */
    pe_solid solid;
    double size;
    pe_touches list;
    pe_touch nearest;     /* of the triangles that are apart; separation HUGE_VAL: none */
    double nearest_value; /* its separation, or a little more where it has no name of its own */
    bool cut;             /* a triangle passes through the cylinder */
    pe_touch fallback;    /* of triangles that give nothing, the least deep way out */
    bool is_over;         /* its point lies over its triangle: better than one that does not */
} scene;

/* Takes the way out if it is better than the one so far. */
static void offer(scene *s, bool is_over, pe_touch touch)
{
    if (is_over > s->is_over ||
        (is_over == s->is_over && touch.separation > s->fallback.separation)) {
        s->is_over = is_over;
        s->fallback = touch;
    }
}

/* Out along the triangle's normal: by the cylinder's last point below it, if over the triangle, or
 * else from a point of the triangle in the cylinder; or as it was found, where that leads less far
 * than the triangle's own way out. */
static void push_off(scene *s, const pe_facet *f, const pe_touch *found)
{
    pe_vec3 n = pe_scale(-1, f->normal), x = pe_cylinder_support(&s->seen, n);
    double height = pe_dot(f->normal, x) - f->offset;
    bool is_over = height < 0 && pe_facet_holds(f, x, PE_SLACK * s->size);
    pe_touch touch = *found;
    if (is_over) {
        touch = pe_cylinder_touch(f, PE_AT_NEAREST, x, height);
    } else if (s->is_over) {
        return; /* there is a better one */
    } else if (pe_cylinder_facet_point(&s->seen, f, &x)) {
        double way = pe_cylinder_translation(&s->seen, x, n);
        if (-way < found->separation) {
            touch = pe_cylinder_touch(f, PE_AT_NEAREST, pe_madd(x, way, n), -way);
        }
    }
    touch.feature = found->feature; /* the face's nearest point may be another */
    offer(s, is_over, touch);
}

/* From inside the solid, by the way that is shortest from the cylinder's centre. */
static void push_out_of_solid(scene *s)
{
    pe_vec3 x = s->seen.centre, in = pe_sub(x, pe_solid_nearest_point(&s->solid, x));
    double depth = pe_length(in);
    if (depth > 0) {
        pe_vec3 n = pe_scale(1 / depth, in);
        double way = pe_cylinder_translation(&s->seen, x, n);
        pe_touch touch = {
            .feature = pe_touch_feature(PE_VERTEX_FACE, PE_AT_NEAREST, 0),
            .kind = PE_VERTEX_FACE,
            .normal = n,
            .on_a = pe_madd(x, way, n),
            .separation = -way - depth,
            .strict = true,
        };
        pe_touches_add(&s->list, &touch);
    }
}

/* A vertex in the cylinder, out through the nearer one of its cap and its side that it faces. */
static void try_vertex(scene *s, int vertex, pe_vec3 x)
{
    const pe_cylinder *c = &s->seen;
    pe_vec3 from = pe_sub(x, c->centre), across = pe_across(c->axis, from);
    double z = pe_dot(from, c->axis), from_axis;
    if (!(fabs(z) < c->half_height && pe_dot(across, across) < c->radius * c->radius)) {
        return;
    }
    pe_vec3 radial = pe_outward(c->axis, from, &from_axis);
    double to_cap = c->half_height - fabs(z), to_side = c->radius - from_axis;
    for (int side = 0; side < 2; ++side) {
        bool to_cap_now = (side == 0) == (to_cap <= to_side);
        pe_vec3 n = to_cap_now ? pe_scale(z < 0 ? -1 : 1, c->axis) : radial;
        double depth = to_cap_now ? to_cap : to_side;
        bool strict;
        if (pe_vertex_faces(&s->solid, vertex, n, &strict) && strict && pe_dot(n, n) > 0.5) {
            pe_touch touch = {
                .feature = pe_touch_feature(PE_FACE_VERTEX, vertex, to_cap_now),
                .kind = PE_EDGE_VERTEX, /* no face shares its patch */
                .normal = n,
                .on_a = pe_madd(x, depth, n),
                .separation = -depth,
                .strict = true,
            };
            pe_touches_add(&s->list, &touch);
            return;
        }
    }
}

static pe_touch touch_of(const scene *s, const pe_pair_point *hit, pe_vec3 n, pe_cylinder_place at)
{
    const pe_pose *pose = s->mesh.pose;
    pe_vec3 x = pe_unrotate(&pose->rotation, pe_sub(hit->position, pose->position));
    return (pe_touch){
        .feature = at.name,
        .kind = at.kind == PE_ON_FACE ? PE_VERTEX_FACE : PE_EDGE_VERTEX,
        .normal = n,
        .on_a = pe_madd(x, -0.5 * hit->separation, n),
        .separation = hit->separation,
        .strict = true,
    };
}

/* The nearest point, by the name of its place. Beside a face, so near that its normal leads as well
 * to the mesh, it has that normal, and so the face's patch. */
static pe_touch nearest_of(const scene *s, const pe_pair_point *hit, pe_vec3 n,
                           pe_cylinder_place at)
{
    pe_touch touch = touch_of(s, hit, n, at);
    if (at.kind == PE_BESIDE_FACE && PE_BESIDE * fabs(hit->separation) <= TIE * s->size) {
        touch.kind = PE_VERTEX_FACE;
        touch.normal = pe_scale(-1, s->solid.faces[at.face].normal);
    }
    return touch;
}

static const pe_pair_point *deepest_of(const pe_pair_manifold *hits)
{
    const pe_pair_point *deepest = &hits->item[0];
    for (int i = 1; i < hits->count; ++i) {
        deepest = hits->item[i].separation < deepest->separation ? &hits->item[i] : deepest;
    }
    return deepest;
}

/* What the triangle's hull gave. */
static void take_hits(scene *s, pe_facet *f, const pe_pair_manifold *hits, double bound)
{
    pe_vec3 n = pe_unrotate(&s->mesh.pose->rotation, hits->normal), out = pe_scale(-1, n);
    const pe_pair_point *deepest = deepest_of(hits);
    bool cut = deepest->separation < -PE_SLACK * s->size;
    bool by_faces = deepest->separation >= -DEEP * s->size;
    pe_cylinder_place at = pe_cylinder_find_place(&s->solid, s->size, f, out, by_faces);
    pe_touch nearest = nearest_of(s, deepest, n, at);
    s->cut = s->cut || cut;
    /* Of triangles at one edge, that which has its name. */
    double value = nearest.separation + (at.kind == PE_NOWHERE ? 0.2 * TIE * s->size : 0);
    if (!cut && value < s->nearest_value) {
        s->nearest_value = value;
        s->nearest = nearest;
    }
    if (at.kind != PE_AT_EDGE && at.kind != PE_AT_VERTEX &&
        (at.kind == PE_ON_FACE || pe_dot(out, f->normal) >= PE_CAP_ON_FACE)) {
        pe_cylinder_touches_on_facet(&s->seen, &s->solid, f, s->size,
                                     cut ? -HUGE_VAL : -PE_SLACK * s->size, bound, &s->list);
    }
    if (at.kind == PE_ON_FACE) {
        pe_touches_add(&s->list, &nearest);
    } else if (at.kind == PE_BESIDE_FACE && cut) {
        offer(s, true, nearest);
    } else if (at.kind == PE_AT_EDGE || at.kind == PE_AT_VERTEX) {
        for (int i = 0; i < hits->count; ++i) {
            const pe_pair_point *hit = &hits->item[i];
            pe_touch touch = touch_of(s, hit, n, at);
            uint64_t point = (hit->feature >> 56) << 2 | (hit->feature & 3);
            touch.feature |= point << 30; /* kinds start at 1, so that it is not the place's own */
            pe_touches_add(&s->list, &touch);
        }
    } else if (cut) {
        push_off(s, f, &nearest);
    }
}

static void try_facet(scene *s, int triangle, double bound)
{
    pe_facet f;
    pe_solid_facet(&s->solid, triangle, &f);
    double height = pe_dot(f.normal, s->seen.centre) - f.offset;
    if (fabs(height) - pe_cylinder_reach(&s->seen, f.normal) > bound) {
        return;
    }
    for (int k = 0; k < 3; ++k) {
        if ((f.owns >> k & 1) != 0) {
            try_vertex(s, f.vertices[k], f.x[k]);
        }
    }
    pe_pair_manifold hits;
    pe_collide_cylinder_facet(s->cylinder, &f, s->mesh.pose, s->size, bound, &hits);
    if (hits.count > 0) {
        take_hits(s, &f, &hits, bound);
    }
}

static bool is_nearest_of_face(const pe_touch *t)
{
    return t->feature >> 30 == pe_touch_feature(PE_VERTEX_FACE, PE_AT_NEAREST, 0) >> 30;
}

/* Whether the face whose nearest point this is has another one as near. */
static bool is_said(const scene *s, const pe_touch *t)
{
    for (int i = 0; i < s->list.count; ++i) {
        const pe_touch *other = &s->list.items[i];
        if (other->kind == PE_VERTEX_FACE && !is_nearest_of_face(other) &&
            pe_touch_second(other->feature) == pe_touch_second(t->feature) &&
            other->separation <= t->separation + TIE * s->size) {
            return true;
        }
    }
    return false;
}

/* Each name once: triangles of one face find the same points. Of a face, its nearest point only
 * where no other is as near. */
static void settle(scene *s)
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
        t->merged = is_nearest_of_face(t) && is_said(s, t);
    }
    kept = 0;
    for (int i = 0; i < s->list.count; ++i) {
        if (!s->list.items[i].merged) {
            s->list.items[kept++] = s->list.items[i];
        }
    }
    s->list.count = kept;
    for (int i = 0; i < s->list.count; ++i) {
        if (s->list.items[i].separation < -PE_SLACK * s->size) {
            offer(s, true, s->list.items[i]); /* should nothing stay */
        }
    }
    pe_touches_settle(&s->list, 0, s->size);
}

static void add_alone(scene *s, const pe_touch *touch)
{
    pe_touches_add(&s->list, touch);
    pe_touches_sort(&s->list);
}

/* Nearest points at a dent, or a way out, where nothing else has as much. */
static void complete(scene *s)
{
    double least = pe_touches_least(&s->list);
    if (s->cut) {
        if (!(least < 0) && s->fallback.separation > -HUGE_VAL) {
            add_alone(s, &s->fallback);
        }
    } else if (s->list.count == 0 || least > s->nearest.separation + TIE * s->size) {
        if (pe_solid_holds(&s->solid, s->seen.centre)) {
            s->list.count = 0;
            push_out_of_solid(s);
        } else if (s->nearest.separation < HUGE_VAL) {
            add_alone(s, &s->nearest);
        }
    }
}

/* A convex mesh is the hull that it is, also one of many faces: the work then grows with them all,
 * but what its triangles tell one by one is not exact where they overlap the cylinder. */
static int collide_convex(pe_placed cylinder, pe_placed mesh, double margin,
                          pe_pair_manifold *patches)
{
    pe_pair_manifold_clear(patches);
    pe_collide_cylinder_hull(cylinder, mesh, margin, patches);
    return patches->count > 0;
}

int pe_collide_cylinder_mesh(pe_placed cylinder, pe_placed mesh, double margin, pe_workspace work,
                             pe_pair_manifold *patches)
{
    if (mesh.geometry->convex) {
        return collide_convex(cylinder, mesh, margin, patches);
    }
    const pe_shape *shape = cylinder.shape;
    pe_node box =
        pe_box_node(pe_v3(0, 0, 0), pe_v3(shape->radius, shape->radius, shape->half_height));
    pe_bvh_pair trees = pe_bvh_pair_between(&box, cylinder.pose, mesh.geometry->nodes, mesh.pose);
    scene s = {
        .cylinder = cylinder,
        .mesh = mesh,
        .seen = pe_cylinder_seen(cylinder, mesh.pose),
        .solid = pe_solid_of_geometry(mesh.geometry),
        .size = pe_min(cylinder.size, mesh.size),
        .list = {.work = work},
        .nearest = {.separation = HUGE_VAL},
        .nearest_value = HUGE_VAL,
        .fallback = {.separation = -HUGE_VAL},
    };
    double band = PE_BAND * pe_min(box.radius, mesh.geometry->bounding_radius);
    double look = margin * (1 + PE_LOOK_AHEAD) + PE_SLACK * s.size, bound = look;
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
    pe_solver_manifold_rules rules = {
        .size = s.size,
        .margin = margin,
        .limit = least + band,
        .least = s.cut || s.list.count == 0 ? -HUGE_VAL : pe_min(least, s.nearest.separation),
        .end_margin = bound < look ? HUGE_VAL : look,
    };
    return s.list.failed ? -1 : pe_touches_make_patches(&s.list, &rules, mesh.pose, patches);
}
