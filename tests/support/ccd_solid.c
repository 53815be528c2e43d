#include "ccd_solid.h"

void ccd_support(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out)
{
    const ccd_solid *s = object;
    const placed *p = s->p;
    pe_vec3 d = pe_unrotate(&p->pose.rotation, pe_v3(dir->v[0], dir->v[1], dir->v[2])), v;
    if (p->shape.kind == PE_SHAPE_CYLINDER) {
        double across = sqrt(d.x * d.x + d.y * d.y), f = across > 0 ? p->shape.radius / across : 0;
        v = pe_v3(f * d.x, f * d.y, d.z < 0 ? -p->shape.half_height : p->shape.half_height);
    } else if (p->shape.kind == PE_SHAPE_SPHERE || p->shape.kind == PE_SHAPE_CAPSULE) {
        const double end = p->shape.kind == PE_SHAPE_CAPSULE ? p->shape.half_height : 0;
        v = pe_scale(p->shape.radius / pe_max(pe_length(d), 1e-300), d);
        v.z += d.z < 0 ? -end : end;
    } else {
        v = p->solid->vertices[0];
        for (int i = 1; i < p->solid->vertex_count; ++i) {
            v = pe_dot(d, p->solid->vertices[i]) > pe_dot(d, v) ? p->solid->vertices[i] : v;
        }
    }
    v = pe_add(pe_sub(p->pose.position, s->origin), pe_rotate(&p->pose.rotation, v));
    v = pe_scale(1 / s->unit, v);
    ccdVec3Set(out, v.x, v.y, v.z);
}
