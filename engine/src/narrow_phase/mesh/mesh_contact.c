/* A mesh against a plane and against a solid.
 *
 * The other shape is a solid of triangles too, or the core of a rounded one: a point or a segment,
 * swept by a ball whose radius is taken off every separation. Planes have no edges and cylinders no
 * vertices: planes are handled below, cylinders in mesh_cylinder.c.
 *
 * Touches are pairs of features that face each other. Their separation is measured along their
 * normal and is positive across a gap:
 *
 *   - A vertex over a face: the face's normal. The vertex faces the face if no edge leads from it
 *     towards the face, except at a small angle, so that all corners of a face that lies upon
 *     another are found. A vertex behind the face, across a dent, is also over the face: in the
 *     corner of a room the floor continues under the wall.
 *   - An edge across an edge, both convex: their common normal, which must lie between the normals
 *     of either edge's faces. Two faces that lie upon each other touch at vertices over faces and
 *     where their rims cross, which are the corners of their overlap.
 *   - Apart, the nearest points: of all vertices and edges the one pair whose distance is that of
 *     the solids. Its normal is the line between them. A rounded core has such touches with each
 *     vertex and convex edge that faces it.
 *
 * Edges inside a flat face and dents do not touch, so that a body that slides over triangles does
 * not feel their rims.
 *
 * Overlap. Of touches at about one place but in different directions only the shallowest counts: it
 * is the minimum translation vector. (Of a corner that stands on a table's edge, the table's side
 * would say that it is half a table deep.) Between convex solids that overlap little this is the
 * shortest translation that parts them. A vertex that lies deeper than PE_MESH_DEPTH is found from
 * where the surfaces cross; see mesh_overlap.c, which also handles thin parts that have passed
 * through each other.
 *
 * Touches whose gap exceeds the least one by more than PE_BAND are not searched, however wide the
 * margin. */
#include "narrow_phase/tolerances.h"
#include "near_features.h"
#include "solid_query.h"

/* ---- Solids ---- */

/* Keeps each touch once, and of overlaps those that show the minimum translation. */
static void settle(const pe_solid_pair *pair, pe_touches *list)
{
    pe_touches_sort(list);
    int kept = 0;
    for (int i = 0; i < list->count; ++i) {
        pe_touch *t = &list->items[i];
        bool deep = t->separation + pair->radius < -PE_DEPTH_TIE * pair->size;
        if ((kept > 0 && list->items[kept - 1].feature == t->feature) ||
            (deep && !t->dent && t->kind <= PE_FACE_VERTEX && pe_touch_is_blocked(pair, t))) {
            continue;
        }
        list->items[kept++] = *t;
    }
    list->count = kept;
    pe_touches_drop_contradicted(list, pair->radius, pair->size);
}

/* Adds the nearest points of solids apart if no touch has their distance: vertices against vertices
 * and edges. */
static void add_nearest(const pe_solid_pair *pair, const pe_nearest *nearest, pe_touches *list)
{
    double least = pe_touches_least(list) + pair->radius, tie = PE_LEAST_LINE * pair->size;
    if (least > nearest->distance + 0.1 * tie && (least == HUGE_VAL || nearest->distance > tie)) {
        pe_touch touch = nearest->touch;
        touch.separation = nearest->distance - pair->radius;
        touch.kind = touch.kind <= PE_EDGE_EDGE ? PE_VERTEX_VERTEX : touch.kind;
        pe_touches_add(list, &touch);
        pe_touches_sort(list);
    }
}

/* Whether the smaller of two solids whose surfaces do not cross lies in the larger one: one vertex
 * shows it. */
static bool is_nested(const pe_solid_pair *pair)
{
    if (pair->a.volume < pair->b.volume) {
        return pe_solid_contains(&pair->b,
                                 pe_transform_point(&pair->trees.a_in_b, pair->a.vertices[0]));
    }
    return pair->b.volume < pair->a.volume &&
           pe_solid_contains(&pair->a, pe_transform_point(&pair->b_in_a, pair->b.vertices[0]));
}

/* The least gap of a touch that is not an overlap; HUGE_VAL: none. */
static double least_gap(const pe_solid_pair *pair, const pe_touches *list)
{
    double least = HUGE_VAL;
    for (int i = 0; i < list->count; ++i) {
        double height = list->items[i].separation + pair->radius;
        least = height >= -pair->slack ? pe_min(least, pe_max(0, height)) : least;
    }
    return least;
}

int pe_collide_solid_mesh(pe_placed other, pe_placed mesh, double margin, pe_workspace work,
                          pe_pair_manifold *manifolds)
{
    pe_solid_pair solids, *pair = &solids;
    pe_solid_pair_make(other, mesh, pair);
    double wanted = margin + pair->radius;
    /* At least the depth that settles an overlap, so that touches do not depend on the margin. */
    double look = pe_max(wanted * (1 + PE_LOOK_AHEAD) + pair->slack, pair->depth);
    if (!pe_solid_pair_part(pair, wanted + pair->slack)) {
        return 0;
    }
    if (!pe_solid_pair_gather(pair, look, work)) {
        return -1;
    }
    /* The touches found first bound the search for the nearest points. */
    pe_touches list = {.work = work};
    double bound = wanted + pair->slack;
    bool first = look <= pair->band;
    if (first) {
        pe_touches_find(pair, look, pair->depth, &list);
        bound = pe_min(bound, least_gap(pair, &list) + pair->slack);
    }
    pe_nearest nearest = pe_solids_nearest(pair, bound);
    /* Features found near do not exclude it: from inside, the nearest may be a dent. */
    bool wholly =
        !nearest.cross && !nearest.inside && pair->depth > 2 * pair->slack && is_nested(pair);
    if (wholly) {
        pair->near_a.facets = NULL;
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
        /* The solids turned out to be apart: an apparent overlap is on the far side of another. */
        for (int i = 0; i < list.count; ++i) {
            list.items[i].merged = !(list.items[i].separation + pair->radius >= -pair->slack);
        }
        pe_touches_drop_merged(&list);
    }
    if (overlap) {
        pe_touches_find_deep(pair, depth, nearest.inside, &list);
    }
    settle(pair, &list);
    if (!overlap && nearest.found) {
        add_nearest(pair, &nearest, &list);
    } else if (overlap &&
               pe_touches_least(&list) > 0.5 * PE_DEPTH_TIE * pair->size - pair->radius) {
        pe_touches_find_translation(pair, &nearest, &list);
        pe_touches_sort(&list);
    }
    pe_manifold_rules rules = {
        .size = pair->size,
        .radius = pair->radius,
        .margin = margin,
        .limit = from + pair->band - pair->radius,
        .least = overlap || !nearest.found ? -HUGE_VAL : nearest.distance - pair->radius,
        .end_margin = reach < look ? HUGE_VAL : reach - pair->radius,
    };
    return pe_touches_make_manifolds(&list, &rules, mesh.pose, manifolds);
}

/* ---- A plane ---- */

/* A mesh over a plane, in the mesh's axes: n.x = offset. */
typedef struct plane_view {
    const pe_geometry *mesh;
    pe_vec3 normal;
    double offset;
    int stack[PE_BVH_STACK], depth; /* nodes to visit; starts with the root, 0 */
} plane_view;

/* The next leaf that reaches below `bound`; NULL: there are no more. */
static const pe_node *next_leaf(plane_view *view, double bound)
{
    pe_vec3 n = view->normal;
    while (view->depth > 0) {
        int index = view->stack[--view->depth];
        const pe_node *node = &view->mesh->nodes[index];
        if (pe_dot(n, node->centre) - pe_node_reach(node, n) - view->offset > bound) {
            continue;
        }
        if (node->right < 0) {
            return node;
        }
        view->stack[view->depth++] = node->right;
        view->stack[view->depth++] = index + 1;
    }
    return NULL;
}

/* The least height of a vertex, or `bound` if none is lower. */
static double lowest(plane_view view, double bound)
{
    const pe_geometry *g = view.mesh;
    for (const pe_node *leaf; (leaf = next_leaf(&view, bound)) != NULL;) {
        for (int i = 3 * leaf->first; i < 3 * (leaf->first + leaf->count); ++i) {
            pe_vec3 v = g->vertices[g->triangles[i / 3][i % 3]];
            bound = pe_min(bound, pe_dot(view.normal, v) - view.offset);
        }
    }
    return bound;
}

static void find_below(plane_view view, double bound, pe_touches *list)
{
    const pe_geometry *g = view.mesh;
    const pe_facet plane = {.normal = view.normal};
    for (const pe_node *leaf; (leaf = next_leaf(&view, bound)) != NULL;) {
        for (int i = 3 * leaf->first; i < 3 * (leaf->first + leaf->count); ++i) {
            int vertex = g->triangles[i / 3][i % 3];
            pe_vec3 x = g->vertices[vertex];
            double height = pe_dot(view.normal, x) - view.offset;
            if ((g->triangle_owns[i / 3] >> i % 3 & 1) != 0 && height <= bound) {
                pe_touch touch = pe_touch_on_face(PE_FACE_VERTEX, vertex, x, &plane, height);
                pe_touches_add(list, &touch);
            }
        }
    }
}

int pe_collide_plane_mesh(pe_placed plane, pe_placed mesh, double margin, pe_workspace work,
                          pe_pair_manifold *manifolds)
{
    plane_view view = {
        .mesh = mesh.geometry,
        .normal = pe_unrotate(&mesh.pose->rotation, plane.shape->normal),
        .offset = plane.shape->offset - pe_dot(plane.shape->normal, mesh.pose->position),
        .depth = 1,
    };
    double look = margin * (1 + PE_LOOK_AHEAD) + PE_MESH_SLACK * mesh.size;
    double band = PE_BAND * view.mesh->bounding_radius;
    double lowest_height = lowest(view, margin), reach = pe_min(look, lowest_height + band);
    pe_touches list = {.work = work};
    find_below(view, reach, &list);
    pe_touches_sort(&list);
    pe_manifold_rules rules = {
        .size = mesh.size,
        .margin = margin,
        .limit = lowest_height + band,
        .least = -HUGE_VAL,
        .end_margin = reach < look ? HUGE_VAL : look,
    };
    return pe_touches_make_manifolds(&list, &rules, mesh.pose, manifolds);
}
