/* The table of colliders by kinds of shape. */
#include "collide.h"

typedef void collider(pe_placed a, pe_placed b, double margin, pe_hits *hits);

/* Rows and columns as in pe_shape_kind; the lower triangle is the upper one with the shapes
 * swapped. */
static collider *const colliders[3][3] = {
    {NULL, pe_collide_plane_sphere, pe_collide_plane_box},
    {NULL, pe_collide_sphere_sphere, pe_collide_sphere_box},
    {NULL, NULL, pe_collide_box_box},
};

void pe_collide(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    hits->count = 0;
    hits->normal_on_b = false;
    hits->least_margin = -HUGE_VAL;
    hits->end_margin = HUGE_VAL;
    if (a.shape->kind <= b.shape->kind) {
        colliders[a.shape->kind][b.shape->kind](a, b, margin, hits);
        return;
    }
    colliders[b.shape->kind][a.shape->kind](b, a, margin, hits);
    hits->normal = pe_scale(-1, hits->normal);
    hits->normal_on_b = !hits->normal_on_b;
}
