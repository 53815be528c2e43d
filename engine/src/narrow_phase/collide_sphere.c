/* A sphere against a sphere and a box: one point on the line of least distance. */
#include "collide.h"

/* One point at `middle` when the shapes are near enough. */
static void one_point(pe_pair_manifold *hits, double separation, double margin, pe_vec3 normal,
                      pe_vec3 middle)
{
    if (separation <= margin) {
        hits->normal = normal;
        hits->least_margin = separation;
        hits->count = 1;
        hits->item[0] = (pe_pair_point){.position = middle, .separation = separation};
    }
}

void pe_collide_sphere_sphere(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    pe_vec3 d = pe_sub(b.pose->position, a.pose->position);
    double distance = pe_length(d);
    /* Concentric spheres have no direction of their own: any will do, up. */
    pe_vec3 n = distance > 0 ? pe_scale(1 / distance, d) : pe_v3(0, 0, 1);
    double separation = distance - a.shape->radius - b.shape->radius;
    one_point(hits, separation, margin, n,
              pe_madd(a.pose->position, a.shape->radius + 0.5 * separation, n));
}

void pe_collide_sphere_box(pe_placed sphere, pe_placed box, double margin, pe_pair_manifold *hits)
{
    pe_vec3 e = box.shape->half_extents;
    pe_vec3 c = pe_unrotate(&box.pose->rotation, pe_sub(sphere.pose->position, box.pose->position));
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
    double separation = distance - sphere.shape->radius;
    pe_vec3 n = pe_rotate(&box.pose->rotation, pe_scale(-1, out));
    one_point(hits, separation, margin, n,
              pe_madd(sphere.pose->position, sphere.shape->radius + 0.5 * separation, n));
}
