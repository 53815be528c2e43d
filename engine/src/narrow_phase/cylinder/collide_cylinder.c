/* A cylinder against a half-space and a sphere, in closed form. */
#include "cylinder.h"
#include "narrow_phase/point_list.h"

/* In units of the cylinder: a cap tilted by less, from end to end, has no lowest point. */
static const double LEVEL = 3e-9;

/* On its cap the cylinder stands on four points of the rim, in directions that stay with the plane
 * while it spins, and on the lowest one; on its side or rim on the ends of its lowest line. */
void pe_collide_plane_cylinder(pe_placed plane, pe_placed cylinder, double margin,
                               pe_pair_manifold *hits)
{
    pe_vec3 n = plane.shape->normal;
    /* In the world's axes, from the cylinder's centre. */
    const pe_pose from_centre = {.position = cylinder.pose->position,
                                 .rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    pe_cylinder c = pe_cylinder_seen(cylinder, &from_centre);
    double r = c.radius, rise = pe_dot(n, c.axis), sine;
    pe_vec3 up = pe_outward(c.axis, n, &sine);
    double height = pe_dot(n, cylinder.pose->position) - plane.shape->offset;
    double gap = height - c.half_height * fabs(rise) - r * sine;
    if (gap > margin) {
        return;
    }
    pe_point_list list = pe_point_list_begin(n, gap, margin, cylinder.size);
    pe_vec3 cap = pe_scale(rise > 0 ? -c.half_height : c.half_height, c.axis);
    if (fabs(rise) < 0.7) {
        /* The ends of the lowest line have names of their own while the axis is about level. */
        pe_vec3 end[2] = {pe_madd(pe_scale(-c.half_height, c.axis), -r, up),
                          pe_madd(pe_scale(c.half_height, c.axis), -r, up)};
        for (uint64_t i = 0; i < 2; ++i) {
            pe_point_list_add(&list, end[i], height + pe_dot(n, end[i]), i);
        }
    } else {
        double length;
        pe_vec3 t1, t2;
        pe_tangents(n, &t1, &t2);
        t1 = pe_scale(r, pe_outward(c.axis, t1, &length));
        t2 = pe_cross(c.axis, t1);
        pe_vec3 rim[5] = {pe_add(cap, t1), pe_add(cap, t2), pe_sub(cap, t1), pe_sub(cap, t2),
                          pe_madd(cap, -r, up)};
        int count = 2 * r * sine > LEVEL * cylinder.size ? 5 : 4;
        for (int i = 0; i < count; ++i) {
            pe_point_list_add(&list, rim[i], height + pe_dot(n, rim[i]), 2 + (uint64_t)i);
        }
    }
    pe_point_list_finish(&list, &from_centre, false, hits);
}

void pe_collide_sphere_cylinder(pe_placed sphere, pe_placed cylinder, double margin,
                                pe_pair_manifold *hits)
{
    pe_vec3 x = pe_unrotate(&cylinder.pose->rotation,
                            pe_sub(sphere.pose->position, cylinder.pose->position));
    double r = cylinder.shape->radius, half = cylinder.shape->half_height;
    double radius = sphere.shape->radius;
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
    double separation = distance - radius;
    if (separation > margin) {
        return;
    }
    pe_point_list list = pe_point_list_begin(pe_scale(-1, out), separation, margin,
                                             pe_min(sphere.size, cylinder.size));
    pe_point_list_add(&list, pe_madd(x, -distance, out), separation, 0);
    pe_point_list_finish(&list, cylinder.pose, false, hits);
}
