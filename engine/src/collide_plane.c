/* A half-space against the bounded shapes: the support points within the margin. */
#include "collide.h"

void pe_collide_plane_sphere(pe_placed plane, pe_placed sphere, double margin, pe_hits *hits)
{
    pe_vec3 n = plane.shape->normal;
    double separation =
        pe_dot(n, sphere.pose->position) - plane.shape->offset - sphere.shape->radius;
    if (separation > margin) {
        return;
    }
    double to_middle = sphere.shape->radius + 0.5 * separation;
    hits->normal = n;
    hits->least_margin = separation;
    hits->count = 1;
    hits->item[0] = (pe_hit){
        .position = pe_madd(sphere.pose->position, -to_middle, n),
        .separation = separation,
    };
}

void pe_collide_plane_box(pe_placed plane, pe_placed box, double margin, pe_hits *hits)
{
    pe_vec3 n = plane.shape->normal;
    hits->normal = n;
    for (uint32_t corner = 0; corner < 8; ++corner) {
        pe_vec3 e = box.shape->half_extents;
        pe_vec3 local =
            pe_v3(corner & 1 ? e.x : -e.x, corner & 2 ? e.y : -e.y, corner & 4 ? e.z : -e.z);
        pe_vec3 x = pe_add(box.pose->position, pe_rotate(&box.pose->rotation, local));
        double separation = pe_dot(n, x) - plane.shape->offset;
        if (separation > margin) {
            hits->end_margin = pe_min(hits->end_margin, separation);
        } else {
            hits->least_margin = pe_max(hits->least_margin, separation);
            hits->item[hits->count++] = (pe_hit){
                .position = pe_madd(x, -0.5 * separation, n),
                .separation = separation,
                .feature = corner,
            };
        }
    }
}
