/* The points of a patch of contact while they are gathered, in the axes of one of the bodies. */
#ifndef PE_POINT_LIST_H
#define PE_POINT_LIST_H

#include "collide.h"

enum { PE_POINT_LIST_ROOM = 32 };

typedef struct pe_point_list {
    pe_vec3 normal;                  /* unit, from the first shape to the second */
    double least;                    /* m: the signed distance; no point is nearer */
    double margin;                   /* m */
    double size;                     /* m, of the smaller shape: the scale of tolerances */
    double least_margin, end_margin; /* as in pe_pair_manifold */
    int count;
    pe_pair_point item[PE_POINT_LIST_ROOM];
} pe_point_list;

pe_point_list pe_point_list_begin(pe_vec3 normal, double least, double margin, double size);

/* A point of the second shape, with the separation from the first at that place. Dropped when it
 * is beyond the margin, or so near to an earlier point, which is no farther from touching, that it
 * adds nothing. Of two points of one name the one with the lesser separation stays. */
void pe_point_list_add(pe_point_list *list, pe_vec3 on_second, double separation, uint64_t feature);

/* Whether one of the points realises the signed distance. */
bool pe_point_list_has_nearest(const pe_point_list *list);

/* Fills *hits, in the world; of more than PE_MAX_POINTS points the nearest one and those farthest
 * apart. `pose` has the axes of the patch; `flip`: the patch's second shape is the first of the
 * hits. */
void pe_point_list_finish(pe_point_list *list, const pe_pose *pose, bool flip,
                          pe_pair_manifold *hits);

#endif
