/* A row of dominoes along x, shared by the scenarios dominoes and domino-into-pile. */
#ifndef PLUMB_DOMINO_H
#define PLUMB_DOMINO_H

#include "scene_builder.h"

/* `count` of 1 kg and `size` m of height, upright on the floor, the first at x = 0 and `spacing`
 * times the size from each to the next; the first turns about its leading lower edge with `push`
 * times the spin that just tips it. */
void pl_build_dominoes(pl_builder *builder, int count, double size, double spacing, double push);

/* Half extents of a domino, over its height. */
extern const double pl_domino_half[3];

#endif
