/* Pairs with a closed form: a half-space against every bounded convex shape, and a sphere against a
 * sphere, a box and a cylinder.
 *
 * A half-space touches at the support points of the other shape that lie within the margin. A
 * sphere touches at one point on the line of least distance from its centre. */
#include "narrow_phase/convex/polytope.h"
#include "narrow_phase/cylinder/cylinder.h"
#include "points.h"
#include "tolerances.h"

/* ---- A half-space ---- */

/* Adds the point x of the other shape if it lies within the margin. */
static void add_point(pe_pair_manifold *manifold, pe_vec3 x, double separation, double margin,
                      uint64_t feature)
{
    if (pe_pair_manifold_within(manifold, separation, margin)) {
        manifold->item[manifold->count++] = (pe_pair_point){x, separation, feature};
    }
}

void pe_collide_plane_sphere(pe_placed plane, pe_placed sphere, double margin,
                             pe_pair_manifold *manifold)
{
    pe_vec3 n = manifold->normal = plane.shape->normal;
    double radius = sphere.shape->radius;
    double separation = pe_dot(n, sphere.pose->position) - plane.shape->offset - radius;
    add_point(manifold, pe_madd(sphere.pose->position, -(radius + 0.5 * separation), n), separation,
              margin, 0);
}

void pe_collide_plane_box(pe_placed plane, pe_placed box, double margin, pe_pair_manifold *manifold)
{
    pe_vec3 n = manifold->normal = plane.shape->normal;
    for (int corner = 0; corner < 8; ++corner) {
        pe_vec3 x = pe_pose_to_world(box.pose, pe_box_corner(box.shape->half_extents, corner));
        double separation = pe_dot(n, x) - plane.shape->offset;
        add_point(manifold, pe_madd(x, -0.5 * separation, n), separation, margin, (uint64_t)corner);
    }
}

void pe_collide_plane_capsule(pe_placed plane, pe_placed capsule, double margin,
                              pe_pair_manifold *manifold)
{
    pe_vec3 n = manifold->normal = plane.shape->normal;
    pe_vec3 axis = pe_axis(&capsule.pose->rotation, 2);
    double r = capsule.shape->radius, half = capsule.shape->half_height;
    for (uint64_t end = 0; end < 2; ++end) {
        pe_vec3 x = pe_madd(capsule.pose->position, end == 0 ? -half : half, axis);
        double separation = pe_dot(n, x) - plane.shape->offset - r;
        add_point(manifold, pe_madd(x, -(r + 0.5 * separation), n), separation, margin, end);
    }
}

/* A cylinder on its cap stands on the lowest point of the rim and on four others, in directions
 * that stay with the plane while it spins. On its side or rim it stands on the ends of its lowest
 * line. */
void pe_collide_plane_cylinder(pe_placed plane, pe_placed cylinder, double margin,
                               pe_pair_manifold *manifold)
{
    pe_vec3 n = plane.shape->normal;
    /* In the world's axes, from the cylinder's centre. */
    const pe_pose from_centre = {.position = cylinder.pose->position,
                                 .rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    pe_cylinder c = pe_cylinder_in_axes(cylinder, &from_centre);
    double r = c.radius, rise = pe_dot(n, c.axis), sine;
    pe_vec3 up = pe_outward(c.axis, n, &sine);
    double height = pe_dot(n, cylinder.pose->position) - plane.shape->offset;
    double gap = height - c.half_height * fabs(rise) - r * sine;
    if (gap > margin) {
        return;
    }
    pe_point_list list = pe_point_list_begin(n, gap, margin, cylinder.size);
    if (fabs(rise) < PE_CAP_FACING) {
        for (int k = 0; k < 2; ++k) {
            pe_vec3 centre = pe_scale(k == 0 ? -c.half_height : c.half_height, c.axis);
            pe_vec3 end = pe_madd(centre, -r, up);
            pe_point_list_add(&list, end, height + pe_dot(n, end), (uint64_t)k);
        }
    } else {
        pe_vec3 cap = pe_scale(rise > 0 ? -c.half_height : c.half_height, c.axis), t1, t2, arm[4];
        pe_tangents(n, &t1, &t2);
        pe_cylinder_rim(&c, t1, arm);
        for (int k = 0; k < (2 * r * sine > PE_LEVEL_CAP_ON_PLANE * cylinder.size ? 5 : 4); ++k) {
            pe_vec3 x = k < 4 ? pe_add(cap, arm[k]) : pe_madd(cap, -r, up);
            pe_point_list_add(&list, x, height + pe_dot(n, x), 2 + (uint64_t)k);
        }
    }
    pe_point_list_finish(&list, &from_centre, false, manifold);
}

/* All vertices of a small hull. Of a larger one, the corners of the face that looks at the plane:
 * the next face takes its place before its far corners come nearer. */
void pe_collide_plane_hull(pe_placed plane, pe_placed hull, double margin,
                           pe_pair_manifold *manifold)
{
    pe_vec3 n = plane.shape->normal, down = pe_scale(-1, pe_unrotate(&hull.pose->rotation, n));
    double height = pe_dot(n, hull.pose->position) - plane.shape->offset, cosine;
    pe_polytope p;
    pe_polytope_make(hull, &p);
    const pe_face *face = &p.faces[pe_polytope_facing(&p, down, &cosine)];
    bool small = p.vertex_count <= PE_MAX_POINTS, many = face->corner_count > PE_FACE_CORNERS;
    int count = small ? p.vertex_count : pe_face_corners(face);
    int lowest = many ? pe_polytope_support(&p, down, -1) : -1;
    pe_candidates found;
    pe_candidates_clear(&found);
    for (int i = 0; i < count + many; ++i) {
        int vertex = small ? i : i < count ? pe_face_corner(&p, face, i) : lowest;
        if (i < count && vertex == lowest) {
            continue;
        }
        pe_vec3 x = p.vertices[vertex];
        double separation = height - pe_dot(down, x);
        pe_candidates_add(&found, hull.pose, pe_madd(x, 0.5 * separation, down), separation,
                          (uint64_t)vertex);
    }
    manifold->normal = n;
    pe_candidates_keep(&found, hull.size, margin, manifold);
}

/* ---- A sphere ---- */

/* Adds the point of a sphere, if within the margin. `normal` points out of the sphere. */
static void touch_sphere(pe_placed sphere, double separation, double margin, pe_vec3 normal,
                         pe_pair_manifold *manifold)
{
    manifold->normal = normal;
    add_point(manifold,
              pe_madd(sphere.pose->position, sphere.shape->radius + 0.5 * separation, normal),
              separation, margin, 0);
}

void pe_collide_sphere_sphere(pe_placed a, pe_placed b, double margin, pe_pair_manifold *manifold)
{
    pe_vec3 d = pe_sub(b.pose->position, a.pose->position);
    double distance = pe_length(d);
    /* Concentric spheres have no direction of their own: any will do. */
    pe_vec3 n = distance > 0 ? pe_scale(1 / distance, d) : pe_v3(0, 0, 1);
    touch_sphere(a, distance - a.shape->radius - b.shape->radius, margin, n, manifold);
}

void pe_collide_sphere_box(pe_placed sphere, pe_placed box, double margin,
                           pe_pair_manifold *manifold)
{
    pe_vec3 e = box.shape->half_extents, c = pe_pose_to_body(box.pose, sphere.pose->position);
    pe_vec3 nearest = pe_v3(pe_max(-e.x, pe_min(e.x, c.x)), pe_max(-e.y, pe_min(e.y, c.y)),
                            pe_max(-e.z, pe_min(e.z, c.z)));
    pe_vec3 out = pe_sub(c, nearest); /* from the box to the centre */
    double distance = pe_length(out);
    if (distance > 0) {
        out = pe_scale(1 / distance, out);
    } else {
        /* The centre is inside: the nearest face pushes it out. */
        double dx = e.x - fabs(c.x), dy = e.y - fabs(c.y), dz = e.z - fabs(c.z);
        if (dx <= dy && dx <= dz) {
            distance = -dx;
            out = pe_v3(c.x < 0 ? -1 : 1, 0, 0);
        } else if (dy <= dz) {
            distance = -dy;
            out = pe_v3(0, c.y < 0 ? -1 : 1, 0);
        } else {
            distance = -dz;
            out = pe_v3(0, 0, c.z < 0 ? -1 : 1);
        }
    }
    touch_sphere(sphere, distance - sphere.shape->radius, margin,
                 pe_rotate(&box.pose->rotation, pe_scale(-1, out)), manifold);
}

void pe_collide_sphere_cylinder(pe_placed sphere, pe_placed cylinder, double margin,
                                pe_pair_manifold *manifold)
{
    pe_vec3 x = pe_pose_to_body(cylinder.pose, sphere.pose->position);
    double r = cylinder.shape->radius, half = cylinder.shape->half_height;
    double from_axis = sqrt(x.x * x.x + x.y * x.y), over = fabs(x.z) - half, past = from_axis - r;
    pe_vec3 up = pe_v3(0, 0, x.z < 0 ? -1 : 1);
    pe_vec3 outward = from_axis > 0 ? pe_v3(x.x / from_axis, x.y / from_axis, 0) : pe_v3(1, 0, 0);
    pe_vec3 out; /* unit, from the cylinder */
    double distance;
    if (over > 0 && past > 0) {
        distance = sqrt(over * over + past * past);
        out = pe_add(pe_scale(over / distance, up), pe_scale(past / distance, outward));
    } else {
        distance = pe_max(over, past);
        out = over >= past ? up : outward;
    }
    double separation = distance - sphere.shape->radius;
    if (separation > margin) {
        return;
    }
    pe_point_list list = pe_point_list_begin(pe_scale(-1, out), separation, margin,
                                             pe_min(sphere.size, cylinder.size));
    pe_point_list_add(&list, pe_madd(x, -distance, out), separation, 0);
    pe_point_list_finish(&list, cylinder.pose, false, manifold);
}
