#include "gap_mesh_cylinder.h"

#include "gap.h"
#include "solid.h"

/* Points are in the mesh's frame unless said otherwise. */
typedef struct meeting {
    const pl_surface *mesh;
    const pl_shape *cylinder;
    pl_axes axes;    /* the cylinder's */
    pl_vec offset;   /* the cylinder's centre */
    double distance; /* m, the least so far; 0 once a triangle crosses the cylinder */
    double depth;    /* m, the largest so far */
    pl_status status;
} meeting;

static pl_vec in_cylinder(const meeting *m, pl_vec point)
{
    return pl_to_local(&m->axes, pl_vec_sub(point, m->offset));
}

/* The hull of two or three vertices of the mesh beside the cylinder, in the cylinder's frame. It
 * points into itself. */
typedef struct flat_hull {
    double vertices[3][3];
    pl_polyhedron polyhedron;
    pl_shape shape;
    pl_placed_shape placed, cylinder;
} flat_hull;

static void set_hull(flat_hull *hull, const meeting *m, const int *corners, int count)
{
    pl_vec corner[3], middle = {0, 0, 0};
    *hull = (flat_hull){.polyhedron = {.convex = true, .vertex_count = count},
                        .shape = {.kind = PL_SHAPE_HULL}};
    for (int k = 0; k < count; ++k) {
        corner[k] = in_cylinder(m, m->mesh->vertices[corners[k]]);
        middle = pl_vec_mad(middle, 1.0 / count, corner[k]);
        pl_vec_store(corner[k], hull->vertices[k]);
    }
    for (int k = 0; k < count; ++k) {
        double arm = pl_vec_length(pl_vec_sub(corner[k], middle));
        hull->polyhedron.radius = fmax(hull->polyhedron.radius, arm);
    }
    pl_vec_store(middle, hull->polyhedron.centre);
    hull->polyhedron.vertices = hull->vertices;
    hull->shape.polyhedron = &hull->polyhedron;
    hull->placed = (pl_placed_shape){.shape = &hull->shape, .orientation = {1, 0, 0, 0}};
    hull->cylinder = (pl_placed_shape){.shape = m->cylinder, .orientation = {1, 0, 0, 0}};
}

static double triangle_distance(const meeting *m, int triangle)
{
    flat_hull hull;
    set_hull(&hull, m, m->mesh->triangles[triangle], 3);
    return pl_distance_convex(&hull.cylinder, &hull.placed, m->distance);
}

static void see_distance(void *context, int triangle)
{
    meeting *m = context;
    if (m->distance > 0) {
        m->distance = fmin(m->distance, triangle_distance(m, triangle));
    }
}

/* The cylinder's point farthest against a face, if it is inside the mesh. */
static void see_face(meeting *m, int triangle)
{
    pl_vec into = pl_to_local(&m->axes, pl_vec_scale(m->mesh->normals[triangle], -1));
    pl_vec point = pl_to_world(&m->axes, pl_core_support(m->cylinder, into));
    double distance = pl_surface_nearest(m->mesh, pl_vec_add(m->offset, point)).distance;
    m->depth = fmax(m->depth, -distance);
}

/* How deep an edge alone is in the cylinder, both convex. */
static pl_status see_edge(meeting *m, const pl_surface_edge *edge)
{
    flat_hull hull;
    const int corners[2] = {edge->start, edge->end};
    double gap = 0;
    set_hull(&hull, m, corners, 2);
    pl_status status = pl_gap_convex(&hull.cylinder, &hull.placed, 0, &gap);
    m->depth = fmax(m->depth, -gap);
    return status;
}

static void see_crossing(void *context, int triangle)
{
    meeting *m = context;
    if (triangle_distance(m, triangle) > 0) {
        return;
    }
    see_face(m, triangle);
    for (int k = 0; k < 3; ++k) {
        const pl_surface_edge *edge = &m->mesh->edges[m->mesh->sides[triangle][k]];
        pl_status status = edge->triangle == triangle ? see_edge(m, edge) : PL_OK;
        m->status = status != PL_OK ? status : m->status;
    }
}

/* Half the size of the box around the cylinder. */
static pl_vec half_size(const meeting *m)
{
    double half[3];
    for (int k = 0; k < 3; ++k) {
        const pl_vec unit = {k == 0, k == 1, k == 2};
        pl_vec d = pl_to_local(&m->axes, unit);
        half[k] = pl_vec_dot(d, pl_core_support(m->cylinder, d));
    }
    return pl_vec_of(half);
}

pl_status pl_gap_mesh_cylinder(const pl_surface *mesh, const pl_shape *cylinder,
                               const pl_axes *axes, pl_vec offset, double within, double *gap)
{
    meeting m = {.mesh = mesh, .cylinder = cylinder, .axes = *axes, .offset = offset};
    pl_vec half = half_size(&m);
    double reach = pl_bounding_radius(cylinder);
    if (within < HUGE_VAL && !pl_surface_box_holds(mesh, offset, within + reach)) {
        *gap = HUGE_VAL;
        return PL_OK;
    }
    double centre = pl_surface_nearest(mesh, offset).distance;
    double most = fmin(fmax(within, 0), fabs(centre));
    m.distance = nextafter(most, HUGE_VAL);
    pl_surface_each_near(mesh, offset, pl_vec_add(half, (pl_vec){most, most, most}), see_distance,
                         &m);
    bool crosses = m.distance <= 0;
    if (crosses) {
        pl_surface_each_near(mesh, offset, half, see_crossing, &m);
    } else if (centre < 0) {
        for (int t = 0; t < mesh->triangle_count; ++t) {
            see_face(&m, t);
        }
    }
    for (int i = 0; i < mesh->vertex_count && centre - reach < 0; ++i) {
        double distance =
            pl_cylinder_distance(cylinder, in_cylinder(&m, mesh->vertices[i]), NULL, NULL);
        m.depth = fmax(m.depth, -distance);
    }
    double apart = m.distance <= within ? m.distance : HUGE_VAL;
    *gap = m.depth > 0 || crosses ? -m.depth : apart;
    return m.status;
}
