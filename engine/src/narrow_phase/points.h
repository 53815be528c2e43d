/* Gathering the points of a manifold, before the choice of at most PE_MAX_POINTS of them.
 *
 * pe_candidates is for polytopes: a list of corners in the world. pe_point_list is for cylinders: a
 * list in the axes of one body, which merges points that are near each other. */
#ifndef PE_POINTS_H
#define PE_POINTS_H

#include "collide.h"

enum { PE_MOST_CANDIDATES = 130, PE_POINT_LIST_ROOM = 32 };

/* Candidates for the points of a manifold. */
typedef struct pe_candidates {
    int count;
    double least; /* separation, m */
    pe_pair_point item[PE_MOST_CANDIDATES];
} pe_candidates;

/* Removes all candidates. */
static inline void pe_candidates_clear(pe_candidates *found)
{
    found->count = 0;
    found->least = HUGE_VAL;
}

/* Adds a point; there must be room. `middle`: between the surfaces, in the axes of the pose. */
void pe_candidates_add(pe_candidates *found, const pe_pose *pose, pe_vec3 middle, double separation,
                       uint64_t feature);

/* Moves the points within the margin to the manifold, at most PE_MAX_POINTS, and narrows its range
 * of margins. Of more points it takes a deepest one, then repeatedly the one farthest from all
 * taken before. Ties within rounding and the motion of rest go to the lower feature. `size` is that
 * of the smaller shape. Changes *found. */
void pe_candidates_keep(pe_candidates *found, double size, double margin,
                        pe_pair_manifold *manifold);

/* The points found so far for a manifold with this normal. */
typedef struct pe_point_list {
    pe_vec3 normal;                  /* unit, from the first shape to the second */
    double least;                    /* m: the signed distance; no point is nearer */
    double margin;                   /* m */
    double size;                     /* m, of the smaller shape: the scale of tolerances */
    double least_margin, end_margin; /* as in pe_pair_manifold */
    int count;
    pe_pair_point item[PE_POINT_LIST_ROOM];
} pe_point_list;

/* An empty list; the parameters are the fields of pe_point_list. */
pe_point_list pe_point_list_begin(pe_vec3 normal, double least, double margin, double size);

/* Adds a point of the second shape, with its separation from the first. It is dropped if it lies
 * beyond the margin, or so near to an earlier point, which is no farther from touching, that it
 * adds nothing. Of two points with the same feature the one with the lesser separation stays. */
void pe_point_list_add(pe_point_list *list, pe_vec3 on_second, double separation, uint64_t feature);

/* Whether one of the points realises the signed distance. */
bool pe_point_list_has_nearest(const pe_point_list *list);

/* Fills the manifold, in the world. Of more than PE_MAX_POINTS points it keeps the nearest one and
 * those farthest apart. `pose` is that of the list's axes. `flip`: the list's second shape is the
 * first of the manifold. */
void pe_point_list_finish(pe_point_list *list, const pe_pose *pose, bool flip,
                          pe_pair_manifold *manifold);

#endif
