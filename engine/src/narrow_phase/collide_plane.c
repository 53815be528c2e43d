/* A half-space against the bounded shapes: the support points within the margin. */
#include "narrow_phase/convex/candidates.h"
#include "narrow_phase/convex/polytope.h"

void pe_collide_plane_sphere(pe_placed plane, pe_placed sphere, double margin,
                             pe_pair_manifold *hits)
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
    hits->item[0] = (pe_pair_point){
        .position = pe_madd(sphere.pose->position, -to_middle, n),
        .separation = separation,
    };
}

void pe_collide_plane_box(pe_placed plane, pe_placed box, double margin, pe_pair_manifold *hits)
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
            hits->item[hits->count++] = (pe_pair_point){
                .position = pe_madd(x, -0.5 * separation, n),
                .separation = separation,
                .feature = corner,
            };
        }
    }
}

/* Both ends of the segment carry a ball. */
void pe_collide_plane_capsule(pe_placed plane, pe_placed capsule, double margin,
                              pe_pair_manifold *hits)
{
    pe_vec3 n = plane.shape->normal, axis = pe_axis(&capsule.pose->rotation, 2);
    double r = capsule.shape->radius, half = capsule.shape->half_height;
    hits->normal = n;
    for (uint64_t end = 0; end < 2; ++end) {
        pe_vec3 x = pe_madd(capsule.pose->position, end == 0 ? -half : half, axis);
        double separation = pe_dot(n, x) - plane.shape->offset - r;
        if (separation > margin) {
            hits->end_margin = pe_min(hits->end_margin, separation);
        } else {
            hits->least_margin = pe_max(hits->least_margin, separation);
            hits->item[hits->count++] = (pe_pair_point){
                .position = pe_madd(x, -(r + 0.5 * separation), n),
                .separation = separation,
                .feature = end,
            };
        }
    }
}

/* All vertices of a small hull; of others, the corners of the face that looks at the plane: the
 * next face takes its place before its far corners come nearer. */
void pe_collide_plane_hull(pe_placed plane, pe_placed hull, double margin, pe_pair_manifold *hits)
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
    pe_candidates_none(&found);
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
    hits->normal = n;
    pe_candidates_keep(&found, hull.size, margin, hits);
}
