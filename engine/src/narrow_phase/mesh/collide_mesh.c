/* A mesh against anything.
 *
 * The other shape is a solid of triangles too, or the core of a rounded one: a point or a segment,
 * swept by a ball whose radius is taken off every separation. Planes have no edges, cylinders no
 * vertices: they are collided below and in collide_mesh_cylinder.c.
 *
 * Contacts are pairs of features that face each other, the separation measured along their normal,
 * positive across a gap:
 *   - a vertex over a face: the face's normal. The vertex faces the face when no edge leads from it
 *     towards the face, but for a small angle, so that all corners of a face that lies upon another
 *     are found. Over the face is also what lies behind the face across a dent: in a corner of a
 *     room the floor goes on under the wall.
 *   - an edge across an edge, both convex: their common normal, which must lie between the normals
 *     of either edge's faces. Two faces that lie upon each other touch at vertices over faces and
 *     where their rims cross, which are the corners of their overlap.
 *   - apart, the nearest points: of all vertices and edges, the one pair whose distance is the
 *     solids'; its normal is the line between them. A rounded core has such contacts with each
 *     vertex and convex edge that faces it.
 * Edges inside a flat face are none, and dents touch nothing: what slides over triangles feels none
 * of their rims.
 *
 * Overlap. Of contacts at about one place but in different directions, only the shallowest counts:
 * it is the way out. (Of a corner that stands on a table's edge, the table's side says that it is
 * half a table deep.) Between convex solids that overlap little this is the shortest translation
 * that parts them. A vertex that lies deeper than PE_DEPTH is found from where the surfaces cross,
 * along edges that lie within, and touches the nearest face that it faces; so are all vertices of a
 * solid wholly inside another. Where thin parts have passed through each other no feature may show
 * a way out: then the solids part along that normal of the crossing triangles along which they
 * reach least past each other as a whole, which never leads further in; the depth is what lies
 * along it where they cross.
 *
 * Beyond the nearest contact by more than PE_BAND none is looked for, however wide the margin. */
#include "collide_mesh.h"

/* In units of the smaller solid: depths that differ by less are one. */
static const double TIE = 1e-9;
/* In units of the smaller solid: a line of least distance shorter than this has no direction. */
static const double LEAST_LINE = 1e-9;

static bool is_vertex_face(const pe_touch *t)
{
    return t->kind == PE_VERTEX_FACE || t->kind == PE_FACE_VERTEX;
}

/* Each touch once, and of overlaps those that show the way out. */
static void settle(const pe_solid_pair *pair, pe_touches *list)
{
    pe_touches_sort(list);
    int kept = 0;
    for (int i = 0; i < list->count; ++i) {
        pe_touch *t = &list->items[i];
        bool deep = t->separation + pair->radius < -TIE * pair->size;
        if ((kept > 0 && list->items[kept - 1].feature == t->feature) ||
            (deep && !t->dent && is_vertex_face(t) && pe_touch_is_blocked(pair, t))) {
            continue;
        }
        list->items[kept++] = *t;
    }
    list->count = kept;
    pe_touches_settle(list, pair->radius, pair->size);
}

/* Adds the nearest points of solids apart where no touch has their distance: vertices against
 * vertices and edges. */
static void add_nearest(const pe_solid_pair *pair, const pe_nearest *nearest, pe_touches *list)
{
    double least = pe_touches_least(list) + pair->radius, tie = LEAST_LINE * pair->size;
    if (least > nearest->distance + 0.1 * tie && (least == HUGE_VAL || nearest->distance > tie)) {
        pe_touch touch = nearest->touch;
        touch.separation = nearest->distance - pair->radius;
        touch.kind = touch.kind <= PE_EDGE_EDGE ? PE_VERTEX_VERTEX : touch.kind;
        pe_touches_add(list, &touch);
        pe_touches_sort(list);
    }
}

/* Whether the point, in the solid's axes, lies in it: most are not even in its box. */
static bool holds(const pe_solid *solid, pe_vec3 x)
{
    const pe_node *root = &solid->nodes[0];
    pe_vec3 local = pe_rotate(&root->axes, pe_sub(x, root->centre));
    return fabs(local.x) <= root->half.x && fabs(local.y) <= root->half.y &&
           fabs(local.z) <= root->half.z && pe_solid_holds(solid, x);
}

/* The smaller solid may lie wholly in the larger, with no surface near: then one vertex shows it.
 */
static bool nested(const pe_solid_pair *pair)
{
    if (pair->a.volume < pair->b.volume) {
        pe_vec3 a = pe_rotate(&pair->trees.turn, pair->a.vertices[0]);
        return holds(&pair->b, pe_add(a, pair->trees.offset));
    }
    pe_vec3 b = pe_rotate(&pair->swapped.turn, pair->b.vertices[0]);
    return pair->b.volume < pair->a.volume && holds(&pair->a, pe_add(b, pair->swapped.offset));
}

/* The least gap of a touch that is no overlap; HUGE_VAL: none. */
static double least_gap(const pe_solid_pair *pair, const pe_touches *list)
{
    double least = HUGE_VAL;
    for (int i = 0; i < list->count; ++i) {
        double height = list->items[i].separation + pair->radius;
        least = height >= -pair->slack ? pe_min(least, pe_max(0, height)) : least;
    }
    return least;
}

/* Between solids that turned out to be apart, what seems to overlap is on another's far side. */
static void drop_overlaps(const pe_solid_pair *pair, pe_touches *list)
{
    int kept = 0;
    for (int i = 0; i < list->count; ++i) {
        if (list->items[i].separation + pair->radius >= -pair->slack) {
            list->items[kept++] = list->items[i];
        }
    }
    list->count = kept;
}

static int collide_solids(pe_solid_pair *pair, const pe_pose *pose, double margin,
                          pe_workspace work, pe_pair_manifold *patches)
{
    double wanted = margin + pair->radius;
    /* Not less than what settles an overlap, so that its contacts do not hang on the margin. */
    double look = pe_max(wanted * (1 + PE_LOOK_AHEAD) + pair->slack, pair->depth);
    if (!pe_solid_pair_part(pair, wanted + pair->slack)) {
        return 0;
    }
    if (!pe_solid_pair_gather(pair, look, work)) {
        return -1;
    }
    /* What is found first bounds the search for the nearest points. */
    pe_touches list = {.work = work};
    double bound = wanted + pair->slack;
    bool first = look <= pair->band;
    if (first) {
        pe_touches_find(pair, look, pair->depth, &list);
        bound = pe_min(bound, least_gap(pair, &list) + pair->slack);
    }
    pe_nearest nearest = pe_solids_nearest(pair, bound);
    bool wholly = !nearest.found && pair->depth > 2 * pair->slack && nested(pair);
    if (wholly) {
        pair->near_a = NULL;
        nearest = pe_solids_nearest(pair, HUGE_VAL);
        nearest.inside = true;
    } else if (!nearest.found && least_gap(pair, &list) == HUGE_VAL) {
        return list.failed ? -1 : 0;
    }
    bool overlap = nearest.cross || nearest.inside;
    double from = nearest.cross ? 0 : nearest.distance, depth = overlap ? pair->depth : 0;
    double reach = pe_min(look, from + pair->band);
    if (wholly || !first) {
        if (!wholly && !pe_solid_pair_gather(pair, pe_max(reach, depth), work)) {
            return -1;
        }
        list.count = 0;
        pe_touches_find(pair, reach, depth, &list);
    } else if (!overlap) {
        drop_overlaps(pair, &list);
    }
    if (overlap) {
        pe_touches_find_deep(pair, depth, nearest.inside, &list);
    }
    settle(pair, &list);
    if (!overlap && nearest.found) {
        add_nearest(pair, &nearest, &list);
    } else if (overlap && pe_touches_least(&list) > 0.5 * TIE * pair->size - pair->radius) {
        pe_touches_find_translation(pair, &nearest, &list);
        pe_touches_sort(&list);
    }
    pe_solver_manifold_rules rules = {
        .size = pair->size,
        .radius = pair->radius,
        .margin = margin,
        .limit = from + pair->band - pair->radius,
        .least = overlap || !nearest.found ? -HUGE_VAL : nearest.distance - pair->radius,
        .end_margin = reach < look ? HUGE_VAL : reach - pair->radius,
    };
    return list.failed ? -1 : pe_touches_make_patches(&list, &rules, pose, patches);
}

/* A mesh over a plane, in the mesh's axes: n.x = offset. */
typedef struct plane_view {
    const pe_geometry *mesh;
    pe_vec3 normal;
    double offset;
} plane_view;

/* The leaves that reach below `bound`, one at a call; `stack` starts with the root, 0. */
static const pe_node *next_leaf(const plane_view *view, double bound, int stack[PE_BVH_STACK],
                                int *depth)
{
    pe_vec3 n = view->normal;
    while (*depth > 0) {
        int index = stack[--*depth];
        const pe_node *node = &view->mesh->nodes[index];
        if (pe_dot(n, node->centre) - pe_node_reach(node, n) - view->offset > bound) {
            continue;
        }
        if (node->right < 0) {
            return node;
        }
        stack[(*depth)++] = node->right;
        stack[(*depth)++] = index + 1;
    }
    return NULL;
}

/* The least height of a vertex, or `bound` if none is lower. */
static double lowest(const plane_view *view, double bound)
{
    int stack[PE_BVH_STACK] = {0}, depth = 1;
    const pe_geometry *g = view->mesh;
    for (const pe_node *leaf; (leaf = next_leaf(view, bound, stack, &depth)) != NULL;) {
        for (int i = 3 * leaf->first; i < 3 * (leaf->first + leaf->count); ++i) {
            pe_vec3 v = g->vertices[g->triangles[i / 3][i % 3]];
            bound = pe_min(bound, pe_dot(view->normal, v) - view->offset);
        }
    }
    return bound;
}

static void find_below(const plane_view *view, double bound, pe_touches *list)
{
    int stack[PE_BVH_STACK] = {0}, depth = 1;
    const pe_geometry *g = view->mesh;
    for (const pe_node *leaf; (leaf = next_leaf(view, bound, stack, &depth)) != NULL;) {
        for (int i = 3 * leaf->first; i < 3 * (leaf->first + leaf->count); ++i) {
            int vertex = g->triangles[i / 3][i % 3];
            double height = pe_dot(view->normal, g->vertices[vertex]) - view->offset;
            if ((g->triangle_owns[i / 3] >> i % 3 & 1) == 0 || height > bound) {
                continue;
            }
            pe_touch touch = {
                .feature = pe_touch_feature(PE_FACE_VERTEX, vertex, 0),
                .kind = PE_FACE_VERTEX,
                .normal = view->normal,
                .on_a = pe_madd(g->vertices[vertex], -height, view->normal),
                .separation = height,
            };
            pe_touches_add(list, &touch);
        }
    }
}

static int collide_plane(pe_placed plane, pe_placed mesh, double margin, pe_workspace work,
                         pe_pair_manifold *patches)
{
    plane_view view = {
        .mesh = mesh.geometry,
        .normal = pe_unrotate(&mesh.pose->rotation, plane.shape->normal),
        .offset = plane.shape->offset - pe_dot(plane.shape->normal, mesh.pose->position),
    };
    double look = margin * (1 + PE_LOOK_AHEAD) + PE_SLACK * mesh.size,
           band = PE_BAND * view.mesh->bounding_radius;
    double lowest_height = lowest(&view, margin), reach = pe_min(look, lowest_height + band);
    pe_touches list = {.work = work};
    find_below(&view, reach, &list);
    pe_touches_sort(&list);
    pe_solver_manifold_rules rules = {
        .size = mesh.size,
        .margin = margin,
        .limit = lowest_height + band,
        .least = -HUGE_VAL,
        .end_margin = reach < look ? HUGE_VAL : look,
    };
    return list.failed ? -1 : pe_touches_make_patches(&list, &rules, mesh.pose, patches);
}

int pe_collide_with_mesh(pe_placed other, pe_placed mesh, double margin, pe_workspace work,
                         pe_pair_manifold *patches)
{
    if (other.shape->kind == PE_SHAPE_PLANE) {
        return collide_plane(other, mesh, margin, work, patches);
    }
    if (other.shape->kind == PE_SHAPE_CYLINDER) {
        return pe_collide_cylinder_mesh(other, mesh, margin, work, patches);
    }
    pe_solid_pair pair;
    pe_solid_pair_make(other, mesh, &pair);
    return collide_solids(&pair, mesh.pose, margin, work, patches);
}
